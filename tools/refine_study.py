#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks softfall.refine on drops of different shape: the value that a pair of coarse meshes gives against that of the pair of half
their spacings (docs/python.md, "Two meshes for one answer").

    PYTHONPATH=build/lib/python3/dist-packages tools/refine_study.py [EXAMPLE...]

EVA: with the foam of examples/materials/eva35.cfg. Each example runs at its own spacings, twice and four times as large, or, where that is refused, 1.5 and 2.25 times (some eight
minutes of processor time for all). The programs are
those in build/bin, or in $SF_BIN_DIR; drops are kept below out/refine.
"""
import functools
import os
import sys
import warnings

import softfall
from softfall.refinement import SPACING_FACTOR, extrapolate

EXAMPLES = ("eva50-v4.5", "flat-disc", "layers", "cored", "post", "honeycomb", "channels", "tile-feet", "mat-cover", "wall", "headform-oblique",
            "channels, EVA", "tile-feet, EVA")
FIGURES = ("a_max_g", "hic")


@functools.lru_cache(maxsize=None)
def drop(example, factor):
    """Figures of an example with its spacings times `factor`, or the sentence of a refusal."""
    name, foam = example.split(",")[0], "," in example
    case = softfall.Case("examples/%s/case.cfg" % name, {"material": "@examples/materials/eva35.cfg", "geometry.parameters.spacing": "5.0"} if foam else {})
    case["pad.mesh_error_limit"] = 1.0
    case[SPACING_FACTOR] = float(factor)
    try:
        made = case.run(output="out/refine/%s-%g" % (example, factor), force=True)
    except softfall.Error as error:
        return None, str(error)
    if made.verdict == "do not use":
        return None, "do not use: %s" % "; ".join(made.verdict.remarks)
    return [made.figures[key] for key in FIGURES], None


def main():
    print("| drop | ratio r | figure | at h | at r h | at r² h | from r h and r² h | from h and r h | within half of the stated error |")
    print("|---|---:|---|---:|---:|---:|---:|---:|---|")
    for example in sys.argv[1:] or EXAMPLES:
        for ratio in (2, 1.5):
            rows = [drop(example, factor) for factor in (ratio * ratio, ratio, 1)]
            refused = [sentence for figures, sentence in rows if figures is None]
            if not refused:
                break
        else:
            print("| %s | – | – | – | – | – | – | – | %s |" % (example, refused[0]), flush=True)
            continue
        for k, name in enumerate(("a_max (g)", "HIC")):
            coarsest, coarse, fine = (figures[k] for figures, sentence in rows)
            early, late = extrapolate(coarse, coarsest, ratio), extrapolate(fine, coarse, ratio)
            held = abs(early.value - late.value) <= 0.5 * early.error + late.error
            print("| %s | %g | %s | %.4g | %.4g | %.4g | %.4g ± %.2g | %.4g ± %.2g | %s |" % (
                example, ratio, name, fine, coarse, coarsest, early.value, early.error, late.value, late.error, "yes" if held else "**no**"), flush=True)


if __name__ == "__main__":
    warnings.simplefilter("ignore")  # coarse meshes are the matter here
    os.chdir(os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
    main()
