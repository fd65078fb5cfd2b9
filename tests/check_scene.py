# SPDX-License-Identifier: GPL-3.0-or-later
"""Opens the state for ParaView that softfall-post wrote into DIR, draws PICTURE and checks what it shows.

    xvfb-run -a -s -noreset pvbatch --force-offscreen-rendering check_scene.py DIR PICTURE PEAK PAD MISSILE

PEAK is the time of the frame shown, in ms; PAD and MISSILE are X0,X1,Y0,Y1, the extents in mm of the whole bodies, which
may be wrong by 2 mm. Nothing may be cut off by the border of the picture; a sphere's points lie on it. Prints "scene is
right" and ends with exit code 0 if all is well.
"""
import importlib.util
import math
import sys

import vtk
from paraview import servermanager, simple
from vtk.util.numpy_support import vtk_to_numpy


def fail(text):
    print("check_scene: " + text)
    sys.stdout.flush()
    sys.exit(1)


def check_extent(name, source, time, expected):
    source.UpdatePipeline(time)
    found = [1e3 * v for v in source.GetDataInformation().GetBounds()[:4]]
    if any(abs(a - b) > 2 for a, b in zip(found, [float(v) for v in expected.split(",")])):
        fail("the %s spans %s mm, expected %s" % (name, found, expected))


def check_sphere(drop, radius, time):
    drop.missile.UpdatePipeline(time)
    data = servermanager.Fetch(drop.missile)
    points = vtk_to_numpy(data.GetPoints().GetData())
    centre = vtk_to_numpy(data.GetPointData().GetArray("sphere_centre_m"))
    off = abs(((points - centre) ** 2).sum(axis=1) ** 0.5 - radius).max()
    if off > 1e-4 * radius:
        fail("the missile is off its sphere by %g m" % off)


def check_picture(path):
    reader = vtk.vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    wide, high, _ = image.GetDimensions()
    pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(high, wide, -1)[:, :, :3].astype(int)
    ink = (pixels < 250).any(axis=2)
    if ink[0].any() or ink[-1].any() or ink[:, 0].any() or ink[:, -1].any():
        fail("%s: something is cut off at the border" % path)
    coloured = (pixels.max(axis=2) - pixels.min(axis=2) > 60).mean()
    if ink.mean() < 0.1 or coloured < 0.01:
        fail("%s: %g of the picture is drawn, %g of it in colour" % (path, ink.mean(), coloured))


def main():
    folder, picture, peak, pad, missile = sys.argv[1:]
    sys.dont_write_bytecode = True
    spec = importlib.util.spec_from_file_location("pad_paraview", folder + "/pad_paraview.py")
    scene = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(scene)
    drop = scene.Drop(folder + "/pad.xdmf")
    time = simple.GetAnimationScene().AnimationTime
    if not math.isclose(time, 1e-3 * float(peak), abs_tol=1e-6):
        fail("the state opens at %g ms, expected %s" % (1e3 * time, peak))
    check_extent("pad", drop.pad, time, pad)
    check_extent("missile", drop.missile, time, missile)
    if scene.DROP["sphere"]:
        check_sphere(drop, scene.DROP["sphere"], time)
    if not simple.GetColorTransferFunction(scene.DROP["label"]).UseLogScale:
        fail("the colours are not logarithmic")
    drop.picture(picture, time)
    check_picture(picture)
    print("scene is right")


main()
