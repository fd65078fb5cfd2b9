#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fits the library of examples/foams with what each foam predicts without having been fitted to it, and every form of the loading
# curve to every foam of examples/data that was pressed, into out/foams, and prints tables: the library, measured
# curves against each other, loops, the free curve, loading, predictions, rates. docs/foams.md has the first and the last three.
#
#     tools/foams_table.sh                  100 s of processor time
#     tools/foams_table.sh --docs           the same, and writes the tables into docs/foams.md
#     tools/foams_table.sh --materials      the library alone, and copies its materials to examples/materials
#
# The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

case ${1:-} in
'' | --docs | --materials) ;;
*) echo 'usage: tools/foams_table.sh [--docs | --materials]' >&2 && exit 2 ;;
esac
PYTHONPATH=tools PYTHONDONTWRITEBYTECODE=1 exec python3 - "${SF_BIN_DIR:-build/bin}/softfall" "${1:-}" <<'PYTHON'
import csv
import json
import math
import os
import shutil
import subprocess
import sys

from results_table import replace_table

PROGRAM, OUT, DATA = sys.argv[1], "out/foams", os.path.abspath("examples/data")
DOCUMENT = "docs/foams.md"

# name in the tables: files with their rates (1/s); density (kg/m3), which no figure here depends on but where solid_density is given
FOAMS = {
    "LEAP, cycle 1": [("leap_cycle1", 0.01)],
    "LEAP, cycle 3": [("leap_cycle3", 0.01)],
    "LEAP confined, cycle 1": [("leap_confined_cycle1", 0.01)],
    "LEAP confined, cycle 3": [("leap_confined_cycle3", 0.01)],
    "VN600, quasi-static": [("vn600_quasistatic", 0.001)],
    "VN600, 10/s": [("vn600_10_per_s", 10)],
    "Zorbium, 0.0002/s": [("zorbium_0.0002_per_s", 0.0002)],
    "Zorbium, 0.02/s": [("zorbium_0.02_per_s", 0.02)],
    "Zorbium, 0.2/s": [("zorbium_0.2_per_s", 0.2)],
}
VN600, ZORBIUM = [f for n in FOAMS if "VN600" in n for f in FOAMS[n]], [f for n in FOAMS if "Zorbium" in n for f in FOAMS[n]]
NO_B = 'start = { B = "1 Pa"; };'
FREE_RUSCH = 'unknown = ( "rusch_A", "rusch_m", "rusch_B", "rusch_n" ); start = { E = "1000 MPa"; };'
# name in the tables: form, further keys
FORMS = {
    "gas, p0 = 101 kPa, no B": ("gas", 'unknown = ( "E", "s0" ); ' + NO_B),
    "gas": ("gas", ""),
    "gas_solid, Phi free, p0 = 101 kPa, no B": ("gas_solid", 'unknown = ( "E", "s0", "solid_fraction" ); ' + NO_B),
    "gas_solid, Phi free, p0 = 101 kPa": ("gas_solid", 'unknown = ( "E", "s0", "solid_fraction", "B", "m" );'),
    "rusch, without E": ("rusch", FREE_RUSCH),
    "rusch": ("rusch", ""),
    "avalle": ("avalle", ""),
    "spline": ("spline", ""),
}


def fit(tests, form, keys="", predict=()):
    """fit.json and fit.csv of a fit, or the sentence of its refusal; without a form that of the free curve."""
    number = fit.count = getattr(fit, "count", 0) + 1
    folder = "%s/%03d" % (OUT, number)
    entries = lambda files: ", ".join('{ file = "%s/%s.csv"; rate = "%g 1/s"; }' % (DATA, f, r) for f, r in files)
    os.makedirs(OUT, exist_ok=True)
    curve = 'curve_form = "%s";' % form if form else "E_range = 0.1;"
    with open(folder + ".cfg", "w") as stream:
        stream.write('name = "foam"; density = "105 kg/m3"; %s %s\ntests = ( %s );\n' % (curve, keys, entries(tests)))
        if predict:
            stream.write("predict = ( %s );\n" % entries(predict))
    done = subprocess.run([PROGRAM, "fit", "compression", folder + ".cfg", "-o", folder, "--force"], capture_output=True, text=True)
    if done.returncode != 0:
        return None, done.stderr.strip().split("\n")[-1]
    with open(folder + "/fit.json") as stream:
        found = json.load(stream)
    with open(folder + "/fit.csv") as stream:
        return found, list(csv.DictReader(stream))


def percent(part):
    return "%.2g" % (100 * part) if part is not None else "-"


def table_of(head, rows):
    align = ["---"] + ["---:"] * (len(head) - 1)
    return ["| " + " | ".join(row) + " |" for row in [head, align] + rows]


def measured_loading(name):
    """Strains and stresses of a file's loading, to the largest strain."""
    with open("%s/%s.csv" % (DATA, name)) as stream:
        rows = list(csv.DictReader(line for line in stream if not line.startswith("#")))
    column = "strain_percent" if "strain_percent" in rows[0] else "strain"
    points = [(float(r[column]) / (100 if column == "strain_percent" else 1), float(r["stress_kPa"])) for r in rows]
    turn = max(range(len(points)), key=lambda k: points[k][0])
    return points[:turn + 1]


def stress_at(points, strain):
    """By straight lines; None beyond the test."""
    for (e0, s0), (e1, s1) in zip(points, points[1:]):
        if e0 <= strain <= e1 and e1 > e0:
            return s0 + (s1 - s0) * (strain - e0) / (e1 - e0)
    return None


def compared():
    """How many times the stress of one measured curve is that of another."""
    strains = (0.02, 0.1, 0.2, 0.3, 0.4, 0.5)
    pairs = [("LEAP, cycle 1", "leap_cycle1", "cycle 3", "leap_cycle3"),
             ("LEAP confined, cycle 1", "leap_confined_cycle1", "with free sides", "leap_cycle1"),
             ("LEAP confined, cycle 3", "leap_confined_cycle3", "with free sides", "leap_cycle3"),
             ("VN600, 10/s", "vn600_10_per_s", "quasi-static", "vn600_quasistatic"),
             ("Zorbium, 0.2/s", "zorbium_0.2_per_s", "0.0002/s", "zorbium_0.0002_per_s")]
    rows = []
    for name, file, other, other_file in pairs:
        values = [(stress_at(measured_loading(file), e), stress_at(measured_loading(other_file), e)) for e in strains]
        rows.append([name, other] + ["%.2f" % (a / b) if a and b and b > 0 else "-" for a, b in values])
    return table_of(["measured stress of loading", "over that of"] + ["at %g %% strain" % (100 * e) for e in strains], rows)


def loading():
    refused, rows = [], []
    for name, (form, keys) in FORMS.items():
        cells, count = [], "-"
        for foam, files in FOAMS.items():
            found, sentence = fit(files, form, keys)
            if found:
                count = "%d" % found["parameter_count"]
                cells.append(percent(found["loading_rms"]))
            else:
                cells.append("none")
                refused.append("%s, %s: %s" % (name, foam, sentence))
        rows.append([name, count] + cells)
    return table_of(["rms of loading (%)", "parameters"] + list(FOAMS), rows), refused


def loops():
    rows = []
    for foam, files in FOAMS.items():
        if "Zorbium" in foam:
            continue
        found, sentence = fit(files, "avalle")
        if not found:
            sys.exit("foams_table: %s: %s" % (foam, sentence))
        one, free, test = found["unloading_with_ALPHA_1"], found["unloading"], found["tests"][0]
        rows.append([foam, percent(one["rms"]), percent(free["rms"]), "%.2g" % one["factor_rms"], "%.2g" % free["factor_rms"],
                     *["%.2g%s" % (free[n], "*" if n in free["at_bound"] else "") for n in ("HU", "SHAPE", "ALPHA")],
                     "%.0f" % (100 * test["returned_energy_measured"]), "%.0f" % (100 * test["returned_energy_fitted"])])
    head = ["rms of unloading", "% of the largest stress, ALPHA = 1", "ALPHA free", "of f, ALPHA = 1", "of f, ALPHA free", "HU", "SHAPE",
            "ALPHA", "energy returned (%)", "by the law (%)"]
    return table_of(head, rows)


def free_curve():
    loops = [foam for foam in FOAMS if "Zorbium" not in foam]
    found = [fit(FOAMS[foam], None)[0] for foam in loops]
    rows = [[part] + [percent(f and f[part + "_rms_of_largest"]) for f in found] for part in ("loading", "unloading")]
    return table_of(["free curve, rms over the largest stress (%)"] + loops, rows)


def predicted():
    rows = []
    cases = [("LEAP, cycle 1", "LEAP, cycle 3", "gas_solid", FORMS["gas_solid, Phi free, p0 = 101 kPa, no B"][1]),
             ("LEAP, cycle 1", "LEAP confined, cycle 1", "gas_solid", FORMS["gas_solid, Phi free, p0 = 101 kPa, no B"][1]),
             ("LEAP, cycle 3", "LEAP confined, cycle 3", "gas_solid", FORMS["gas_solid, Phi free, p0 = 101 kPa, no B"][1])]
    for fitted, other, form, keys in cases:
        found, sentence = fit(FOAMS[fitted], form, keys, FOAMS[other])
        if not found:
            sys.exit("foams_table: %s: %s" % (fitted, sentence))
        test = found["predicted"][0]
        rows.append([fitted, other, form, percent(test["loading_rms"]), percent(test["unloading_rms"]),
                     "%.0f" % (100 * test["returned_energy_measured"]), "%.0f" % (100 * test["returned_energy_fitted"])])
    for left_out, reference in [(f, None) for f in ZORBIUM] + [(ZORBIUM[0], ZORBIUM[0][1])]:
        keys = 'rate_model = "factor";' + (' rate_reference = "%g 1/s";' % reference if reference else "")
        found, sentence = fit([f for f in ZORBIUM if f != left_out], "avalle", keys, [left_out])
        if not found:
            sys.exit("foams_table: Zorbium: %s" % sentence)
        rows.append(["Zorbium, the other two rates", "Zorbium, %g/s" % left_out[1],
                     "avalle, factor" + (", rate_reference %g 1/s" % reference if reference else ""),
                     percent(found["predicted"][0]["loading_rms"]), "-", "-", "-"])
    return table_of(["fitted", "predicted", "form", "rms of loading (%)", "of unloading (%)", "energy returned (%)", "by the law (%)"], rows)


def rates():
    rows, refused = [], []
    for foam, files in (("Zorbium, three rates", ZORBIUM), ("VN600, 0.001 and 10/s", VN600)):
        for rate in ("none", "factor", "maxwell", "both"):
            found, points = fit(files, "avalle", 'rate_model = "%s";' % rate)
            if not found:
                refused.append("%s, %s: %s" % (foam, rate, points))
                continue
            value = {p["name"]: p["value"] for p in found["parameters"]}
            rows.append([foam, "avalle", rate, "%d" % found["parameter_count"], percent(found["loading_rms"]),
                         ", ".join(percent(t["loading_rms"]) for t in found["tests"]),
                         "%.3g" % value["rate_factor"] if "rate_factor" in value else "-", fast_plateau(foam, points, value)])
    head = ["rates", "form", "rate", "parameters", "rms of loading (%)", "of each rate", "rate_factor", "at 3000/s and a strain of 0.2 (kPa)"]
    return table_of(head, rows), refused


def fast_plateau(foam, points, value):
    """Stress of the law in a test at a rate of Zorbium beyond the tests, where 330 kPa were measured; behind the low pass of the rate."""
    if "Zorbium" not in foam or "ED" in value:
        return "-"
    slow = [p for p in points if p["test"] == "1" and p["branch"] == "loading"]
    nearest = min(slow, key=lambda p: abs(float(p["strain"]) - 0.2))
    rate = -3000 * math.expm1(-0.2 / (3000 * 0.5e-3))
    return "%.0f" % (float(nearest["law_kPa"]) * (1 + value.get("rate_factor", 0) * math.log10(rate / 0.0002)))


def run(*command):
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 5):
        sys.exit("foams_table: %s: %s" % (" ".join(command), done.stderr.strip()))


def fitted(name, kind):
    """fit.json of examples/foams/NAME.cfg."""
    folder = "%s/%s" % (OUT, name)
    run(PROGRAM, "fit", *kind, "examples/foams/%s.cfg" % name, "-o", folder, "--force")
    with open(folder + "/fit.json") as stream:
        return json.load(stream)


def compression_row(name, foam, held_out):
    found = fitted(name, ["compression"])
    test = found["predicted"][0]
    return [foam, "`%s.cfg`" % name, found["curve_form"], "loading %s %%, unloading %s %% of the largest stress" % (
        percent(found["loading_rms"]), percent(found["unloading"]["rms"])), held_out + ": loading %s %%, unloading %s %%" % (
        percent(test["loading_rms"]), percent(test["unloading_rms"]))]


def zorbium_row():
    rms = fitted("zorbium", ["compression"])["loading_rms"]
    others, sentence = fit([f for f in ZORBIUM if f[1] != 0.02], "avalle", 'rate_model = "factor";', [ZORBIUM[1]])
    if not others:
        sys.exit("foams_table: Zorbium: %s" % sentence)
    return ["Zorbium, open cells", "`zorbium.cfg`", "avalle, factor", "loading %s %%, three rates" % percent(rms),
            "0.02 1/s from the other two rates: %s %%" % percent(others["predicted"][0]["loading_rms"])]


def flat_drop(stress):
    """Peak (g) of the block of pe-block.cfg at this static stress (kPa), simulated with the foam of pe.cfg."""
    folder, programs = OUT + "/pe", os.path.dirname(PROGRAM)
    model, results = folder + "/block.h5", folder + "/block-results.h5"
    run(programs + "/softfall-pre", "examples/foams/pe-block.cfg", "-o", model, "--force", "--set", "material=@%s/pe.cfg" % folder,
        "--set", "missile.mass=%.6g kg" % (stress * 10 / 9.80665))
    run(programs + "/softfall-solve", model, "-o", results, "--force")
    run(programs + "/softfall-post", results, "-o", folder + "/block", "--force")
    with open(folder + "/block/summary.json") as stream:
        return json.load(stream)["a_max_g"]


def pe_row():
    worst = max(abs(p["peak_g"] / p["peak_measured_g"] - 1) for p in fitted("pe", [])["cushions"])
    a, b, ratio = 68.04, 0.015664, 0.9 / 0.1
    errors = [flat_drop(s) / (a * math.exp(b * s * ratio) / s) - 1 for s in (3, 6, 9, 12)]
    return ["Polyethylene, by its cushion curves", "`pe.cfg`", "rusch", "peaks within %.1f %%" % (100 * worst),
            "100 mm from 0.9 m, simulated, at 3, 6, 9, 12 kPa: " + ", ".join("%+.1f %%" % (100 * e) for e in errors)]


def tile_row():
    found = fitted("tile", [])
    hic = {d["name"]: d["hic"] for d in found["drops"]}
    interval = next(p for p in found["inference"]["predictions"] if p["quantity"] == "HIC")
    return ["Rubber tile with a cored base, by its critical heights", "`tile.cfg`", "rusch",
            "HIC %.0f and %.0f on 45 and 60 mm (1000)" % (hic["tile-45"], hic["tile-60"]),
            "80 mm from its critical height of 2.2 m (1000): HIC %.0f, 95 %%: %.0f to %.0f" % (
                interval["median"], interval["low95"], interval["high95"])]


def library():
    rows = [compression_row("leap", "FF LEAP, running-shoe foam", "third cycle"),
            compression_row("vn600", "VN600, vinyl nitrile", "10 1/s from 0.001 1/s"), zorbium_row(), pe_row(), tile_row()]
    return table_of(["foam", "examples/foams", "form", "misfit", "predicted, not fitted"], rows)


os.makedirs(OUT, exist_ok=True)
table = library()
print("\n".join(table) + "\n")
if sys.argv[2] == "--docs":
    replace_table(DOCUMENT, table)
if sys.argv[2] == "--materials":
    for name in ("leap", "vn600", "zorbium", "pe", "tile"):
        own = "%s/%s/%s" % (OUT, name, name if name in ("pe", "tile") else "material")
        shutil.copy(own + ".csv", "examples/materials/%s.csv" % name)
        with open(own + ".cfg") as source, open("examples/materials/%s.cfg" % name, "w") as copy:
            copy.write(source.read().replace('"material.csv"', '"%s.csv"' % name).replace("material.cfg", name + ".cfg"))
    sys.exit()
first, refused = loading()
last, refused_rates = rates()
on_page = (first, predicted(), last)
for table in (compared(), loops(), free_curve(), *on_page):
    print("\n".join(table) + "\n")
    if sys.argv[2] == "--docs" and table in on_page:
        replace_table(DOCUMENT, table)
print("\n".join(["no curve:"] + refused + refused_rates))
PYTHON
