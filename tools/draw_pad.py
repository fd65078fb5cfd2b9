# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws the deformed pad, coloured by von Mises stress, under the missile.

    xvfb-run -a pvbatch --force-offscreen-rendering tools/draw_pad.py DIR/pad.xdmf PICTURE.png [--time MS]

Draws the frame nearest to MS, in ms of the run; by default the frame nearest to the largest acceleration, from
summary.json beside the .xdmf. The picture shows half of the pad, cut through the axis of the drop: a quarter model is
mirrored at x = 0, a full model is cut at y = 0. Needs the .xdmf with the field von_mises.
"""
import argparse
import json
import os
import sys

from paraview import servermanager, simple

SIZE = [1160, 530]
INK = [0.13, 0.13, 0.15]
COLOURS = ["ecece6", "9ecae1", "3d85c6", "35a583", "f2d24b", "ec7a32", "b2182b", "67001f"]
MISSILE_COLOUR = [0.70, 0.72, 0.75]
STRESS = "von_mises_kPa"
LOWEST_KPA = 3.0  # below it the foam is practically unloaded


def fail(text):
    sys.stderr.write("draw_pad: %s\n" % text)
    sys.exit(1)


def parse_options():
    parser = argparse.ArgumentParser(prog="draw_pad", description=__doc__.split("\n")[0])
    parser.add_argument("xdmf", help="pad.xdmf of softfall-post")
    parser.add_argument("picture", help="PNG to write")
    parser.add_argument("--time", type=float, metavar="MS", help="time of the run in ms (default: the peak)")
    return parser.parse_args()


def read_summary(xdmf):
    path = os.path.join(os.path.dirname(os.path.abspath(xdmf)), "summary.json")
    try:
        with open(path) as stream:
            return json.load(stream)
    except (OSError, ValueError):
        return {}


def read_blocks(xdmf, wanted):
    """The data sets of the frame nearest to `wanted` (s), and that frame's time (s)."""
    reader = simple.XDMFReader(FileNames=[xdmf])
    reader.UpdatePipelineInformation()
    times = reader.TimestepValues
    times = list(times) if hasattr(times, "__len__") else [times]
    time = min(times, key=lambda t: abs(t - wanted))
    reader.UpdatePipeline(time)
    iterator = servermanager.Fetch(reader).NewIterator()
    blocks = []
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        blocks.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return blocks, time


def source_of(block):
    """A pipeline source for one data set, in mm."""
    producer = simple.TrivialProducer()
    producer.GetClientSideObject().SetOutput(block)
    in_mm = simple.Transform(Input=producer)
    in_mm.Transform = "Transform"
    in_mm.Transform.Scale = [1e3, 1e3, 1e3]
    return in_mm


def half_of(source, bounds):
    """The half y >= 0 of the pad or of the missile, whichever part of it is modelled."""
    tolerance = 1e-3 * (bounds[1] - bounds[0])
    if bounds[2] * 1e3 < -tolerance:
        source = simple.Clip(Input=source, ClipType="Plane", Invert=0)
        source.ClipType.Origin = [0, 0, 0]
        source.ClipType.Normal = [0, 1, 0]
    if bounds[0] * 1e3 > -tolerance:
        source = simple.Reflect(Input=source, Plane="X", Center=0.0, CopyInput=1)
    return source


def show_missile(view, source):
    """The missile's surface, translucent, as the facets cut the foam that follows the exact sphere; and its rim."""
    shown = simple.Show(source, view)
    shown.Representation = "Surface"
    shown.ColorArrayName = ["POINTS", ""]
    shown.DiffuseColor = shown.AmbientColor = MISSILE_COLOUR
    shown.Opacity = 0.2
    merged = simple.Clean(Input=simple.ExtractSurface(Input=source), Tolerance=1e-5)
    rim = simple.FeatureEdges(Input=merged, BoundaryEdges=1, FeatureEdges=0,
                              ManifoldEdges=0, NonManifoldEdges=0)
    line = simple.Show(rim, view)
    line.ColorArrayName = ["POINTS", ""]
    line.DiffuseColor = line.AmbientColor = INK
    line.LineWidth = 3


def show_pad(view, source):
    in_kpa = simple.Calculator(Input=source, AttributeType="Point Data", ResultArrayName=STRESS,
                               Function="max(von_mises_Pa/1000,%g)" % LOWEST_KPA)
    surface = simple.ExtractSurface(Input=in_kpa)
    shown = simple.Show(surface, view)
    shown.Representation = "Surface With Edges"
    shown.EdgeColor = [0.45, 0.45, 0.48]
    shown.LineWidth = 0.3
    shown.Specular = 0.0
    shown.Ambient = 0.35
    shown.Diffuse = 0.75
    surface.UpdatePipeline()
    highest = max(surface.PointData[STRESS].GetRange()[1], 10 * LOWEST_KPA)
    simple.ColorBy(shown, ("POINTS", STRESS))
    colours = simple.GetColorTransferFunction(STRESS)
    colours.RGBPoints = control_points(LOWEST_KPA, highest)
    colours.ColorSpace = "Lab"
    colours.UseLogScale = 1
    show_bar(view, colours, highest)


def control_points(low, high):
    """COLOURS at equal ratios from low to high, as ParaView wants them."""
    points = []
    for k, colour in enumerate(COLOURS):
        points.append(low * (high / low) ** (k / (len(COLOURS) - 1)))
        points.extend(int(colour[i:i + 2], 16) / 255 for i in (0, 2, 4))
    return points


def show_bar(view, colours, highest):
    bar = simple.GetScalarBar(colours, view)
    bar.Title = "von Mises stress (kPa), logarithmic"
    bar.ComponentTitle = ""
    bar.Orientation = "Horizontal"
    bar.WindowLocation = "Any Location"
    bar.Position = [0.3, 0.03]
    bar.ScalarBarLength = 0.4
    bar.ScalarBarThickness = 18
    bar.TitleColor = bar.LabelColor = INK
    bar.TitleFontSize = 18
    bar.LabelFontSize = 16
    bar.AutomaticLabelFormat = 0
    bar.LabelFormat = bar.RangeLabelFormat = "%-.0f"
    bar.UseCustomLabels = 1
    bar.CustomLabels = [v for v in (10, 100, 1000, 10000) if LOWEST_KPA < v < 0.8 * highest]
    bar.Visibility = 1


def draw(blocks, caption, picture):
    view = simple.CreateView("RenderView")
    view.ViewSize = SIZE
    view.UseColorPaletteForBackground = 0
    view.BackgroundColorMode = "Single Color"
    view.Background = [1, 1, 1]
    view.OrientationAxesVisibility = 0
    found = False
    for block in blocks:
        half = half_of(source_of(block), block.GetBounds())
        if block.GetPointData().HasArray("von_mises_Pa"):
            found = True
            show_pad(view, half)
        else:
            show_missile(view, half)
    if not found:
        fail("no field von_mises_Pa in this file: add von_mises to output.fields of the case")
    text = simple.Text(Text=caption)
    shown = simple.Show(text, view)
    shown.Color = INK
    shown.FontSize = 18
    shown.WindowLocation = "Upper Center"
    simple.Render(view)  # the first rendering places the camera
    view.CameraPosition = [-200, -900, 420]
    view.CameraFocalPoint = [0, 60, 18]
    view.CameraViewUp = [0, 0, 1]
    view.CameraViewAngle = 14.5
    simple.Render(view)
    simple.SaveScreenshot(picture, view, ImageResolution=SIZE, CompressionLevel="9")


def main():
    options = parse_options()
    if not os.path.isfile(options.xdmf):
        fail("%s: no such file" % options.xdmf)
    summary = read_summary(options.xdmf)
    if options.time is None and summary.get("a_max_time_ms") is None:
        fail("no summary.json with a_max_time_ms beside %s: give --time MS" % options.xdmf)
    wanted = options.time if options.time is not None else summary["a_max_time_ms"]
    blocks, time = read_blocks(options.xdmf, wanted * 1e-3)
    caption = "t = %.1f ms" % (time * 1e3)
    if {"missile_mass_kg", "v0_m_s", "thickness_mm"} <= set(summary):
        caption = "%.3g kg at %.3g m/s on %.3g mm of foam, %s" % (
            summary["missile_mass_kg"], summary["v0_m_s"], summary["thickness_mm"], caption)
    draw(blocks, caption, options.picture)
    print(options.picture)


main()
