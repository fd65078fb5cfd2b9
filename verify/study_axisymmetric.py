#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Does an axisymmetric drop give the figures of the solid one? Ten drops of different missiles, thicknesses, foams and layers, each as a section and as a quarter.

    verify/study_axisymmetric.py [DIR] [--only NAME...]

The quarter runs on 10 and on 5 mm; its value for ever finer meshes is f5 + (f5 - f10) / (2^p - 1), with the orders p = 2.9, 2.2 and 1.95 of a_max, HIC and indentation
that finer meshes of the first drop show. A disc shows no such order: it is compared with its own section on 1.25 mm, which says nothing of its quarter.
The section on 5 mm is compared with that value. It writes DIR/axisymmetric.md. Exit code: the number of differences from the value for
ever finer meshes above 0.3 % of a_max, 0.5 % of HIC and 0.5 % of the indentation.
"""
import argparse
import json
import os
import pathlib
import resource
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BIN = pathlib.Path(os.environ.get("SF_BIN_DIR", ROOT / "build/bin"))
FIGURES = (("a_max_g", 0.003, 2.9), ("hic", 0.005, 2.2), ("max_indentation_mm", 0.005, 1.95))  # name, bound, order
PAD = ["geometry.parameters.side=300.0", "geometry.parameters.zone_side=180.0"]


def material(name):
    return f"material=@{ROOT}/examples/materials/{name}.cfg"


CASES = {
    "sphere 160, EVA 50, 4.5 m/s": ("eva50-v4.5", []),
    "sphere 160, EVA 50, 5.2 m/s": ("eva50-v5.2", []),
    "sphere 160, EVA 70, 6.2 m/s": ("eva70-v6.2", []),
    "sphere 100, EVA 40, 3 m/s": ("eva50-v4.5", [*PAD, "geometry.parameters.thickness=40.0", "geometry.missile_parameters.diameter=100.0", 'missile.mass="3 kg"',
                                                 'missile.velocity="3 m/s"']),
    "disc 130, EVA 50, 4 m/s": ("flat-disc", []),
    "disc 100, LEAP 30, 2.5 m/s": ("flat-disc", [material("leap"), "geometry.parameters.thickness=30.0", "geometry.missile_parameters.diameter=100.0",
                                                'missile.velocity="2.5 m/s"']),
    "sphere 160, VN600 60, 3 m/s": ("eva50-v4.5", [material("vn600"), "geometry.parameters.thickness=60.0", 'missile.velocity="3 m/s"']),
    "sphere 160, PE 50, 4 m/s": ("eva50-v4.5", [*PAD, material("pe"), 'missile.velocity="4 m/s"']),
    "sphere 160, three layers, 4.5 m/s": ("layers", []),
    "sphere 160, EVA 50 resting, 4.5 m/s": ("eva50-resting", []),
}


def run(folder, case, overrides, *options):
    """Returns the figures of a drop, its verdict and the processor time of its solution; raises with what a program says."""
    def call(program, *words):
        done = subprocess.run([str(BIN / program), *words], capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"}, check=False)
        if done.returncode:
            raise RuntimeError(f"{program}: {done.stderr.strip().splitlines()[-1] if done.stderr.strip() else done.returncode}")
    folder.mkdir(parents=True, exist_ok=True)
    sets = [word for text in ["pad.mesh_error_limit=1", 'output.frame_interval="30 ms"', *overrides] for word in ("--set", text)]
    call("softfall-pre", str(ROOT / "examples" / case / "case.cfg"), "-o", str(folder / "model.h5"), "--force", "--estimate", *options, *sets)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    call("softfall-solve", str(folder / "model.h5"), "-o", str(folder / "results.h5"), "--force")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    call("softfall-post", str(folder / "results.h5"), "-o", str(folder / "out"), "--force")
    told = json.loads((folder / "out/summary.json").read_text())
    for big in ("model.h5", "results.h5", "results.h5.restart"):
        (folder / big).unlink(missing_ok=True)
    return [told[key] for key, *_ in FIGURES], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("folder", nargs="?", default="out/axisymmetric")
    parser.add_argument("--only", nargs="*", default=[])
    o = parser.parse_args()
    folder = pathlib.Path(o.folder)
    lines = ["| drop | a_max, HIC, indentation on 5 mm | the quarter's | its limit | section against the limit | CPU of the solution, s |", "|---|---|---|---|---|---|"]
    beyond = 0
    for number, (name, (case, overrides)) in enumerate(CASES.items()):
        if o.only and name not in o.only:
            continue
        fine = ["geometry.parameters.fine_spacing=5.0"]
        coarse = ["geometry.parameters.fine_spacing=10.0", "geometry.parameters.outer_spacing=12.0"]
        section, quick = run(folder / f"{number}-section", case, overrides + fine, "--axisymmetric")
        quarter, slow = run(folder / f"{number}-quarter", case, overrides + fine)
        rough, _ = run(folder / f"{number}-rough", case, overrides + coarse)
        limit = [f + (f - c) / (2 ** order - 1) for f, c, (_, _, order) in zip(quarter, rough, FIGURES)]
        if case == "flat-disc":  # on 1.25 mm the section's own value stands still
            limit, _ = run(folder / f"{number}-limit", case, [*overrides, "geometry.parameters.fine_spacing=1.25", "geometry.parameters.outer_spacing=3.0"], "--axisymmetric")
        off = [s / v - 1 for s, v in zip(section, limit)]
        beyond += sum(abs(x) > bound for x, (_, bound, _) in zip(off, FIGURES))
        three = "{:.2f} g, {:.1f}, {:.2f} mm".format
        lines.append(f"| {name} | {three(*section)} | {three(*quarter)} | {three(*limit)} | " + ", ".join(f"{100 * x:+.2f} %" for x in off) + f" | {quick:.2f} against {slow:.1f} |")
        print(lines[-1], flush=True)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "axisymmetric.md").write_text("\n".join(lines) + "\n")
    print(f"{beyond} differences beyond 0.3 % of a_max, 0.5 % of HIC and of the indentation")
    return beyond


if __name__ == "__main__":
    sys.exit(main())
