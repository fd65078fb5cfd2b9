#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does a run end by its physics? Random drops of odd foams, thicknesses, missiles and meshes, and how each of them ends.

    verify/study_robustness.py [DIR] [--drops N] [--seed N] [--only K...]

A drop is answerable where uncoupled columns of the loading curve below the missile take up the energy of the impact before any of them is compressed by 90 %, or
within a tenth of the solid's height of the end of the curve: less than the pad takes up, as neighbours, rate and viscosity help. It writes DIR/robustness.md (the table), DIR/robustness.csv
(a row for each drop) and the folder of each drop that ended without a verdict. Exit code: the number of bounds that do not hold.
"""
import argparse
import concurrent.futures
import csv
import json
import math
import os
import pathlib
import subprocess
import sys

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = pathlib.Path(os.environ.get("SF_BIN_DIR", ROOT / "build/bin"))
G = 9.80665
KINDS = ("eva", "pole", "linear", "rate", "hyperfoam")


def make_foam(kind, scale, random):
    """Returns the lines of a material, and its loading curve as strains and stresses (kPa); the file of the curve ends before its last 40 points."""
    pole = float(random.uniform(0.85, 0.95))
    strain = np.concatenate([np.linspace(0, 0.7, 71), pole - (pole - 0.7) * np.logspace(0, -3, 120)[1:]])
    lines = ['density = "%.4g kg/m3";' % random.uniform(25, 150), f"DAMP = {random.choice([0.0, 0.05, 0.2, 0.5])};"]
    if kind == "hyperfoam":  # one term, in uniaxial compression: theory, section "Hyperfoam"
        nu, mu, alpha = float(random.choice([0.0, 0.15, 0.3, 0.45])), 120 * scale, 8.0
        beta = nu / (1 - 2 * nu)
        stretch = 1 - strain
        lateral = stretch ** (-beta / (1 + 2 * beta))
        stress = 2 * mu / alpha / stretch * ((stretch * lateral**2) ** (-alpha * beta) - stretch**alpha)
        lines += ['law = "hyperfoam"; stable_to = 0.9;', f'term_1 = {{ mu = "{mu:.5g} kPa"; alpha = {alpha:g}; nu = {nu:g}; }};', "HU = 0.3; SHAPE = 2.0;"]
        return lines, strain, stress
    stress = scale * (60 * (1 - np.exp(-strain / 0.05)) + 90 * strain / (1.0001 * pole - strain))
    if kind == "linear":  # a few points, joined by straight lines of the table
        few = np.array([0, 0.03, 0.1, 0.3, 0.5, 0.65, 0.75, 0.8, 0.84, pole - 0.0005])
        stress = np.interp(strain, few, np.interp(few, strain, stress)) + 1e-6 * strain
    modulus = 1.05 * float(stress[1] / strain[1])
    lines += [f'E = "{modulus:.6g} kPa";', 'curve = "curve.csv";', f"HU = {random.choice([1e-4, 0.1, 0.9])}; SHAPE = {random.choice([0.11, 1.0, 3.0])};",
              f'densification = {{ rule = "H2"; start = 0; exponent = 1; limit = {1.0001 * pole:.6g}; }};']
    if kind in ("eva", "rate"):
        factor = 0.39 if kind == "eva" else float(random.uniform(0.5, 1.5))
        lines += [f'rate_factor = {factor:.3g}; rate_reference = "1 1/s"; rate_filter_time = "0.5 ms";', f'ED = "{1700 * scale:.5g} kPa"; BETA1 = "5000 1/s";']
    if kind == "linear":
        lines[-1] = 'densification = { rule = "H1"; start = 0; exponent = 0; limit = 1; };'
    return lines, strain, stress


def make_case(number, seed):
    """Returns the text of a case, its curve, and whether columns take up its energy."""
    random = np.random.default_rng([seed, number])
    oblique = number % 8 == 7
    kind = KINDS[number % len(KINDS)]
    scale, speed, mass = float(np.exp(random.uniform(math.log(0.2), math.log(5)))), float(random.uniform(2, 9)), float(random.uniform(2, 8))
    thickness = float(random.uniform(20, 100))
    spacing = float(random.uniform(6, 14)) if not oblique else float(random.uniform(10, 14))
    disc = random.random() < 0.3
    diameter = float(random.choice([80, 120, 160, 200]))
    if not disc:
        diameter = max(diameter, 1.6 * thickness)  # deeper than its radius a hemisphere has no surface
    foam, strain, stress = make_foam(kind, scale, random)
    missile = (f'missile_file = "{ROOT}/geo/missiles/disc.geo"; missile_parameters = {{ diameter = {diameter}; element_size = {diameter / 16}; quarter = QUARTER; }};' if disc else
               f'missile_file = "{ROOT}/geo/hemisphere.geo"; missile_parameters = {{ diameter = {diameter}; element_size = {diameter / 16}; quarter = QUARTER; }};')
    extra = ""
    if oblique:
        angle = math.radians(random.uniform(5, 40))
        free = random.random() < 0.5
        extra = f"direction = [{math.sin(angle):.9f}, 0.0, {-math.cos(angle):.9f}]; friction = {random.choice([0.0, 0.3, 0.8])};" + (' freedom = "free";' if free else "")
    fine = min(spacing, thickness / 2)
    text = "\n".join([
        f'geometry: {{ file = "{ROOT}/geo/pad.geo"; length_unit = "mm"; {missile.replace("QUARTER", "0" if oblique else "1")}',
        f"  parameters = {{ side = 280.0; thickness = {thickness:.3f}; zone_side = 180.0; fine_spacing = {fine:.3f}; outer_spacing = {min(2 * fine, 26):.3f}; quarter = {0 if oblique else 1}; }}; }};",
        "material: {", *foam, "};",
        f'missile: {{ mass = "{mass:.3f} kg"; velocity = "{speed:.3f} m/s"; {extra} }};',
        'solver: { end_time = "80 ms"; };', "pad: { mesh_error_limit = 1.0; };", 'output: { frame_interval = "20 ms"; };', ""])
    return kind, text, (strain, stress), columns_hold(strain, stress, thickness / 1e3, diameter / 2e3, disc, 0.5 * mass * speed**2, mass)


def columns_hold(strain, stress, thickness, radius, disc, kinetic, mass):
    """Returns the greatest strain of columns that take up the energy; inf: none within the curve."""
    work = np.concatenate([[0], np.cumsum(0.5 * (stress[1:] + stress[:-1]) * 1e3 * np.diff(strain))])  # J/m3
    for most in np.linspace(0.05, 1, 96):
        depth = most * strain[-1] * thickness
        reach = radius if disc else math.sqrt(max(0.0, 2 * radius * depth - depth**2)) if depth < radius else radius
        r = (np.arange(200) + 0.5) / 200 * reach
        at = (depth - (0 if disc else radius - np.sqrt(np.maximum(radius**2 - r**2, 0)))) / thickness
        taken = float(np.sum(np.interp(np.maximum(at, 0), strain, work) * 2 * np.pi * r * reach / 200)) * thickness
        if taken > kinetic + mass * G * depth:
            return most * strain[-1]
    return math.inf


def run(number, seed, folder):
    """Runs a drop; returns its row."""
    place = folder / f"{number:03d}"
    place.mkdir(parents=True, exist_ok=True)
    kind, text, curve, strain = make_case(number, seed)
    (place / "case.cfg").write_text(text)
    (place / "curve.csv").write_text("strain,stress_kPa\n" + "".join(f"{e:.9g},{s:.9g}\n" for e, s in list(zip(*curve))[:-40]))
    row = {"number": number, "kind": kind, "columns_strain": strain, "answerable": strain < min(0.9, curve[0][-1] - 0.1 * (1 - curve[0][-1]))}

    def call(*words):
        return subprocess.run([str(BIN / words[0]), *words[1:]], cwd=place, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    pre = call("softfall-pre", "case.cfg", "-o", "model.h5", "--force", "--estimate")
    solve = call("softfall-solve", "model.h5", "-o", "results.h5", "--force") if pre.returncode == 0 else pre
    post = call("softfall-post", "results.h5", "-o", "out", "--force") if pre.returncode == 0 else pre
    said = [line for line in solve.stderr.splitlines() if line.startswith("softfall-") and "warning" not in line]
    row |= {"code": solve.returncode, "said": said[-1] if said else "", "ending": "rebound", "a_max_g": "", "grade": ""}
    if post.returncode == 0:
        told = json.loads((place / "out/summary.json").read_text())
        row["a_max_g"], row["grade"] = told["a_max_g"], told["verdict"]["grade"] if isinstance(told["verdict"], dict) else told["verdict"]
    for name, mark in (("refused by softfall-pre", "softfall-pre:"), ("reached the anvil", "reached the anvil"), ("beyond the missile's surface", "beyond its touching surface"), ("fed by contact or stabilisation", "has put"), ("collapsed", "has collapsed"),
                       ("passed through", "passed through"), ("time step", "stable time step fell"), ("energy balance", "energy balance"), ("other", "softfall-solve:")):
        if solve.returncode and mark in row["said"]:
            row["ending"] = name
            break
    for big in ("model.h5", "results.h5"):
        if not solve.returncode and (place / big).exists():
            (place / big).unlink()
    print(f"{number:03d} {kind:9} {row['ending']:32} a_max {row['a_max_g']!s:.6} columns' strain {strain:.3f} {row['said'][:160] if solve.returncode else ''}", flush=True)
    return row


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", nargs="?", default="out/robustness")
    parser.add_argument("--drops", type=int, default=300)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", type=int, nargs="*")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    o = parser.parse_args()
    folder = pathlib.Path(o.folder)
    with concurrent.futures.ThreadPoolExecutor(o.jobs) as pool:
        rows = list(pool.map(lambda k: run(k, o.seed, folder), o.only or range(o.drops)))
    with open(folder / "robustness.csv", "w", newline="") as stream:
        table = csv.DictWriter(stream, rows[0])
        table.writeheader()
        table.writerows(rows)
    endings = sorted({row["ending"] for row in rows})
    answerable = [row for row in rows if row["answerable"]]
    lines = ["| ending | drops | of these answerable |", "|---|---:|---:|",
             *(f"| {e} | {sum(r['ending'] == e for r in rows)} | {sum(r['ending'] == e for r in answerable)} |" for e in endings)]
    share = sum(row["ending"] == "rebound" for row in answerable) / max(1, len(answerable))
    fed = sum(row["ending"].startswith("fed") for row in rows)
    lines += ["", f"{100 * share:.1f} % of {len(answerable)} answerable drops end with a verdict (goal: at least 99 %); {fed} end as contact or stabilisation fed the pad (goal: none)."]
    (folder / "robustness.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return (share < 0.99) + (fed > 0)


if __name__ == "__main__":
    sys.exit(main())
