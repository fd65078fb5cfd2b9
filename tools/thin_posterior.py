#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Takes COUNT draws of a posterior of softfall fit, in the middle of equal parts of it (the draws stand model by
model), as a posterior of its own.

    tools/thin_posterior.py out/eva35/posterior 100 examples/materials/eva35_posterior"""
import pathlib
import sys

if len(sys.argv) != 4 or not sys.argv[2].isdigit():
    sys.exit(__doc__)
source, count, target = pathlib.Path(sys.argv[1]), int(sys.argv[2]), pathlib.Path(sys.argv[3])
there = len(list(source.glob("draw-*.cfg")))
if missing := [k for k in range(1, there + 1) if not (source / f"draw-{k:03d}.cfg").exists()]:
    sys.exit(f"{source} is not a whole posterior: it holds {there} draws, but no draw-{missing[0]:03d}.cfg")
if not 0 < count <= there:
    sys.exit(f"{source} holds {there} draws, not {count}")
target.mkdir(parents=True, exist_ok=True)
for old in target.glob("draw-*"):
    old.unlink()
for k in range(count):
    old, new = f"draw-{(2 * k + 1) * there // (2 * count) + 1:03d}", f"draw-{k + 1:03d}"
    (target / f"{new}.cfg").write_text((source / f"{old}.cfg").read_text().replace(old, new))
    (target / f"{new}.csv").write_text((source / f"{old}.csv").read_text())
