#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does the error by the mesh that an axisymmetric drop prints hold? Drops of different foams, thicknesses, spheres and discs, against ever finer meshes.

    verify/study_section_errors.py [DIR] [--only NAME...] [--spacings MM...] [--truth MM]

Every drop runs on each spacing (10 and 5 mm) with the errors that softfall-pre finds, and on two finer meshes, of twice --truth (1.25 mm) and of that: the truth is the last
plus a third of the step to it (order 2). An error holds if it is at least the true one; it is narrow if it is at most three times the true one, or below 0.3 % of the figure,
where the truth itself is hardly known. It writes DIR/section_errors.md. Exit code 1: of a figure fewer than nine of ten errors hold, or are narrow.
"""
import argparse
import json
import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = pathlib.Path(os.environ.get("SF_BIN_DIR", ROOT / "build/bin"))
FIGURES = {"a_max_g": "a_max_mesh_error", "hic": "hic_mesh_error", "max_indentation_mm": "max_indentation_mesh_error"}
WIDE, UNKNOWN, PART = 3, 0.003, 0.9
PAD = ["geometry.parameters.radius=150.0", "geometry.parameters.zone_radius=80.0"]


def foam(name):
    return [f"material=@{ROOT}/examples/materials/{name}.cfg"]


def sphere(thickness, diameter, mass, speed):
    return [*PAD, f"geometry.parameters.thickness={thickness:.1f}", f"geometry.missile_parameters.diameter={diameter:.1f}", f'missile.mass="{mass} kg"', f'missile.velocity="{speed} m/s"']


def disc(thickness, diameter, mass, speed):
    return [f'geometry.missile_file="{ROOT}/geo/missiles/disc.geo"',
            f"geometry.missile_parameters={{diameter={diameter:.1f}; thickness=40.0; edge_radius=6.0; element_size=5.0; quarter=1;}}", "missile.friction=0.3",
            *[text for text in sphere(thickness, diameter, mass, speed) if "missile_parameters" not in text]]


CASES = {
    "sphere 160, EVA 50, 4.5 m/s": sphere(50, 160, 4.6, 4.5),
    "sphere 160, EVA 50, 5.2 m/s": sphere(50, 160, 4.6, 5.2),
    "sphere 160, EVA 70, 6.2 m/s": sphere(70, 160, 4.6, 6.2),
    "sphere 100, EVA 40, 3 m/s": sphere(40, 100, 3, 3),
    "sphere 160, VN600 60, 3 m/s": [*foam("vn600"), *sphere(60, 160, 4.6, 3)],
    "sphere 160, PE 50, 4 m/s": [*foam("pe"), *sphere(50, 160, 4.6, 4)],
    "sphere 120, LEAP 60, 3 m/s": [*foam("leap"), *sphere(60, 120, 3, 3)],
    "disc 130, EVA 50, 4 m/s": disc(50, 130, 5, 4),
    "disc 100, LEAP 30, 2.5 m/s": [*foam("leap"), *disc(30, 100, 5, 2.5)],
    "disc 100, PE 70, 4 m/s": [*foam("pe"), *disc(70, 100, 5, 4)],
}


def drop(folder, overrides, spacing, *options):
    """Returns summary.json of an axisymmetric drop; raises with what a program says."""
    def call(program, *words):
        done = subprocess.run([str(BIN / program), *map(str, words)], capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"{program}: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode}")
    folder.mkdir(parents=True, exist_ok=True)
    sets = ["pad.mesh_error_limit=10", 'output.frame_interval="30 ms"', f"geometry.parameters.fine_spacing={float(spacing)}",
            f"geometry.parameters.outer_spacing={2.0 * spacing}", *overrides]
    call("softfall-pre", ROOT / "examples/eva50-axisymmetric/case.cfg", "-o", folder / "model.h5", "--force", *options, *[word for text in sets for word in ("--set", text)])
    call("softfall-solve", folder / "model.h5", "-o", folder / "results.h5", "--force")
    call("softfall-post", folder / "results.h5", "-o", folder / "out", "--force", "--view", "0")
    told = json.loads((folder / "out/summary.json").read_text())
    for big in ("model.h5", "results.h5", "results.h5.restart"):
        (folder / big).unlink(missing_ok=True)
    return told


def judge(folder, name, spacings, finest):
    """Yields spacing, figure, value, printed and true error of a drop."""
    finer = [drop(folder, CASES[name], h, "--estimate") for h in (2 * finest, finest)]
    for spacing in spacings:
        told = drop(folder, CASES[name], spacing)
        for figure, key in FIGURES.items():
            truth = finer[1][figure] + (finer[1][figure] - finer[0][figure]) / 3
            if told[key] is None:
                raise RuntimeError(f"{name}: softfall-pre found no error of {figure}")
            yield spacing, figure, told[figure], told[key], abs(truth / told[figure] - 1)


def holds(printed, true):
    return printed >= true


def is_narrow(printed, true):
    return printed <= max(WIDE * true, UNKNOWN)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", nargs="?", default="out/section_errors")
    parser.add_argument("--only", nargs="*", default=[])
    parser.add_argument("--spacings", nargs="*", type=float, default=[10.0, 5.0])
    parser.add_argument("--truth", type=float, default=1.25)
    o = parser.parse_args()
    folder = pathlib.Path(o.folder)
    lines = ["| drop | spacing, mm | figure | value | printed error, % | true error, % | |", "|---|---|---|---|---|---|---|"]
    print("\n".join(lines))
    found = {figure: [] for figure in FIGURES}
    for name in o.only or CASES:
        for spacing, figure, value, printed, true in judge(folder, name, o.spacings, o.truth):
            row = holds(printed, true), is_narrow(printed, true)
            found[figure].append(row)
            remark = " ".join(text for text, good in zip(("too small", "too wide"), row) if not good)
            lines.append(f"| {name} | {spacing:g} | {figure} | {value:.2f} | {100 * printed:.2f} | {100 * true:.2f} | {remark} |")
            print(lines[-1], flush=True)
    parts = {figure: [sum(row[k] for row in rows) / len(rows) for k in (0, 1)] for figure, rows in found.items()}
    folder.mkdir(parents=True, exist_ok=True)
    lines += ["", *(f"{figure}: {len(found[figure])} errors, {100 * part[0]:.0f} % hold, {100 * part[1]:.0f} % are narrow" for figure, part in parts.items())]
    (folder / "section_errors.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines[-len(parts):]))
    return min(min(part) for part in parts.values()) < PART


if __name__ == "__main__":
    sys.exit(main())
