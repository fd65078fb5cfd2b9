# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the deformed pad, coloured by von Mises stress, under the missile.

    xvfb-run -a -s -noreset pvbatch --force-offscreen-rendering tools/draw_pad.py DIR/pad.xdmf PICTURE.png [--time MS] [--whole]

Draws the frame nearest to MS, in ms of the run; by default the peak. The pad is cut through the missile's axis, or with
--whole it is shown as it is. softfall-post wrote the scene, pad_paraview.py, beside the .xdmf.
"""
import argparse
import importlib.util
import os
import sys

SIZE = [1160, 530]


def fail(text):
    sys.stderr.write("draw_pad: %s\n" % text)
    sys.stderr.flush()
    sys.exit(1)


def parse_options():
    parser = argparse.ArgumentParser(prog="draw_pad", description=__doc__.split("\n")[0])
    parser.add_argument("xdmf", help="pad.xdmf of softfall-post")
    parser.add_argument("picture", help="PNG to write")
    parser.add_argument("--time", type=float, metavar="MS", help="time of the run in ms (default: the peak)")
    parser.add_argument("--whole", action="store_true", help="the whole pad and missile, not cut")
    return parser.parse_args()


def load_scene(xdmf):
    path = os.path.join(os.path.dirname(os.path.abspath(xdmf)), "pad_paraview.py")
    for needed in (xdmf, path):
        if not os.path.isfile(needed):
            fail("%s: no such file; softfall-post writes it" % needed)
    sys.dont_write_bytecode = True
    spec = importlib.util.spec_from_file_location("pad_paraview", path)
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    return scene


def main():
    options = parse_options()
    drop = load_scene(options.xdmf).Drop(options.xdmf, options.whole)
    time = drop.peak if options.time is None else drop.nearest(1e-3 * options.time)
    drop.picture(options.picture, time, SIZE)
    print(options.picture)


main()
