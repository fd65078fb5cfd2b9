#!/usr/bin/env bash
# SPDX-License-Identifier: GPL-3.0-or-later
# Fits each model of examples/fit/eva35_lock_70.cfg alone, without chains: to the five drops of eva35_five_drops.inc, to them with a lock-up
# of its own, also with the accelerometer's mount as an unknown, and to the three drops on the 70 mm pad with a lock-up, on meshes of SPACING
# under the missile. Prints a table (docs/validation.md, "Fits that converge"): simulations, misfit, the largest differences of a_max,
# HIC and its window to the measured ones over the drops of the fit, at the speeds as given and as fitted, and whether the fit converged. Below 10 mm each fit begins with
# drops on meshes of 10 mm (coarse_set); their simulations stand behind a plus. Resumes.
#
#     tools/fit_forms.sh [SPACING_MM=10 [OUT=out/fit_forms [REGEX [posterior]]]]     REGEX: only the fits whose name it finds;
#                                     posterior: with chains, and the 95 % intervals that they give to the drops of the fit
#
# The programs are those in build/bin, or in $SF_BIN_DIR.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
PYTHONDONTWRITEBYTECODE=1 exec python3 - "${SF_BIN_DIR:-build/bin}/softfall-fit" "${1:-10}" "${2:-out/fit_forms}" "${3:-}" "${4:-}" <<'PYTHON'
import json
import os
import re
import shutil
import subprocess
import sys

program, spacing, out = os.path.abspath(sys.argv[1]), float(sys.argv[2]), os.path.abspath(sys.argv[3])


def read(path):
    with open(path, encoding="utf-8") as file:
        return file.read()


def write(path, text):
    os.makedirs(os.path.dirname(path), exist_ok=True)
    with open(path, "w", encoding="utf-8") as file:
        file.write(text)


# The examples with another spacing.
for folder in ("materials", "fit"):
    shutil.copytree(f"examples/{folder}", f"{out}/examples/{folder}", dirs_exist_ok=True)
shutil.copytree("geo", f"{out}/geo", dirs_exist_ok=True)
for drop in ("eva70-v4.5", "eva70-v5.2", "eva70-v6.2", "eva50-v4.5", "eva50-v5.2"):
    case = read(f"examples/{drop}/case.cfg")
    case = case.replace("fine_spacing = 5.0", f"fine_spacing = {spacing}").replace("outer_spacing = 10.0", f"outer_spacing = {2 * spacing}")
    write(f"{out}/examples/{drop}/case.cfg", case + "pad: { mesh_error_limit = 1.0; };\n")

source = read("examples/fit/eva35_lock_70.cfg")
models = re.findall(r'\{ curve = "(\w+)"; rate = "(\w+)";(.*)\}', source)
three = source[source.index("drops = ("):source.index("predict = (")]
five, lock = '@include "eva35_five_drops.inc"\n', '{ name = "locked_fraction"; }, '
mount = 'mount = "f = 420 Hz, damping = 0.05"; mount_frequency_sd = 0.2; mount_damping_sd = 0.5;\n'
sets = {"five drops": (five, ""), "five drops, lock-up": (five, lock), "five drops, lock-up, mount": (mount + five, lock),
        "three drops, lock-up": (three, lock)}


coarse = ("" if spacing >= 10 else 'coarse_set = ["geometry.parameters.fine_spacing=10.0", "geometry.parameters.outer_spacing=20.0", '
          '"pad.mesh_error_limit=1.0"];\n')


def largest(result, name, suffix=""):
    """The difference of the simulated to the measured value, in percent, that is the largest of all drops of the fit: at the speeds
    as given, and (in brackets) at those of the fit."""
    used = [drop for drop in result["drops"] if drop["used"]]
    given, fitted = ([100 * (drop[name + at + suffix] / drop[f"{name}_measured{suffix}"] - 1) for drop in used] for at in ("", "_at_fitted_speed"))
    return f"{max(given, key=abs):+.1f} ({max(fitted, key=abs):+.1f})"


print("| drops | model | simulations of each drop | misfit | objective | a_max (%) | HIC (%) | window (%) | status |")
print("|---|---|---:|---:|---:|---:|---:|---:|---|")
for name, (drops, lock) in sets.items():
    for curve, rate, rest in models:
        label = f"{name}, {curve}, {rate}{', posterior' if sys.argv[5] else ''}".replace(", ", "-").replace(" ", "_")
        if not re.search(sys.argv[4], label):
            continue
        chains = "posterior = false;\n" if not sys.argv[5] else "predict = ( " + ", ".join(
            f'{{ name = "again-{drop}"; case = "../{drop}/case.cfg"; }}' for drop in re.findall(r'name = "(eva\d\S*)"', drops if "name" in drops else read(
                "examples/fit/eva35_five_drops.inc"))) + " );\n"
        folder, fit = f"{out}/{label}", f"{out}/examples/fit/{label}.cfg"
        write(fit, f"""name = "foam";
material = "eva35_forms_start.cfg";
solid_density = "940 kg/m3";
unknown = ( {lock}{{ name = "HU"; prior_sd = 0.5; }}, {{ name = "SHAPE"; prior_sd = 0.6; }} );
forms = ( {{ curve = "{curve}"; rate = "{rate}"; {rest} }} );
{chains}{coarse}{drops}""")
        if not os.path.exists(f"{folder}/fit.json"):
            with open(f"{folder}.log", "w", encoding="utf-8") as log:
                subprocess.run([program, "drop", fit, "-o", folder, "--force"], stdout=log, stderr=subprocess.STDOUT)
        log = read(f"{folder}.log")
        if not os.path.exists(f"{folder}/fit.json"):
            print(f"| {name} | {curve}, {rate} | - | - | - | - | - | - | failed: {log.strip().splitlines()[-1]} |", flush=True)
            continue
        result = json.loads(read(f"{folder}/fit.json"))
        objective = min(float(x) for x in re.findall(r"objective (\S+);", log))
        status = "converged" if result["converged"] else f"{result.get('reason', 'not converged')}, expected gain {result['expected_gain']:.2g}"
        print(f"| {name} | {curve}, {rate} | {result['iterations']}{' + %d' % result['coarse_iterations'] if coarse else ''} | {result['misfit']:.3g} | {objective:.4g} | {largest(result, 'a_max', '_g')} | {largest(result, 'hic')} | "
              f"{largest(result, 'hic_window', '_ms')} | {status} |", flush=True)
        if sys.argv[5]:
            print(*re.findall(r"\n  again-.* \(95 %: .*", log), sep="", flush=True)
PYTHON
