# SPDX-License-Identifier: GPL-3.0-or-later
"""The drop in ParaView: the pad cut through the missile's axis, coloured by von Mises stress, and the missile.

    paraview --script=pad_paraview.py                  opens the drop in ParaView's window, at the peak
    xvfb-run -a -s -noreset pvpython pad_paraview.py --state drop.pvsm       writes it as a state file of ParaView
    xvfb-run -a -s -noreset pvbatch --force-offscreen-rendering pad_paraview.py --picture P.png [--time MS] [--whole]
    xvfb-run -a -s -noreset pvbatch --force-offscreen-rendering pad_paraview.py --film F.mp4 [--whole]

softfall-post writes this file beside pad.xdmf, with the facts of the drop; the two and pad-....h5 belong together. The
pad of a half or quarter model is reflected to the whole: "pad" is all of it, "cut" what lies behind the missile's axis.
A missile that contact takes for an exact sphere is drawn as one, any other by its triangles. A film is an MP4 or, by the
ending of its name, a GIF; ffmpeg makes it. Lengths are in m.
"""
import argparse
import math
import os
import subprocess
import sys
import tempfile

from paraview import simple

# What softfall-post knows of the drop. mirrors: symmetry planes, [axis, place in m]; axis: x and y of the missile's axis
# in m; sphere: radius in m, or None; peak: time of its frame in s, or None; array: what colours the pad, or None, and its
# largest value in all frames.
DROP = {}  # written by softfall-post

SIZE = [1280, 720]
INK = [0.13, 0.13, 0.15]
GREY = [0.45, 0.45, 0.48]
COLOURS = ["ecece6", "9ecae1", "3d85c6", "35a583", "f2d24b", "ec7a32", "b2182b", "67001f"]
MISSILE_COLOUR = [0.62, 0.65, 0.70]
SUPPORT_COLOUR = [0.66, 0.58, 0.47]
DECADES = 3            # of the logarithmic scale
EYE = [-0.2, -0.9, 0.36]  # direction from the drop to the camera
ANGLE = 20.0           # degrees, of the camera
# Shares of the picture's height that the drop leaves to title and colour bar.
TOP, BOTTOM, SIDE = 0.12, 0.19, 0.03
FILM_SECONDS = 6


def fail(text):
    sys.stderr.write("pad_paraview: %s\n" % text)
    sys.stderr.flush()
    sys.exit(1)


def folder():
    """Of this file; ParaView's window does not always tell its name."""
    try:
        return os.path.dirname(os.path.abspath(__file__))
    except NameError:
        return os.getcwd()


class Drop:
    """Pipeline and view of a drop."""

    def __init__(self, xdmf, whole=False):
        self.reader = simple.XDMFReader(registrationName="pad.xdmf", FileNames=[xdmf])
        self.reader.UpdatePipelineInformation()
        steps = self.reader.TimestepValues
        self.times = list(steps) if hasattr(steps, "__len__") else [steps]
        self.whole = whole
        self.peak = DROP["peak"] if DROP["peak"] is not None else self.times[0]
        self.view = self.make_view()
        self.pad, self.cut = self.parts(self.block("pad"), "pad")
        self.show_pad()
        self.missile = self.missile_cut = None
        if DROP.get("support"):
            self.show_support(*self.parts(self.block("support"), "support"))
        if DROP["missile"]:
            body = self.block("missile")
            self.missile, self.missile_cut = self.parts(self.smooth(body), "missile")
            self.show_missile()
            self.show_reading(body)
        self.show_title()
        self.go_to(self.peak)

    # ---- sources ----

    def block(self, name):
        """A body as one data set. The reader numbers the names of its blocks from the second frame on."""
        block = simple.ExtractBlock(registrationName=name + " block", Input=self.reader, Assembly="Hierarchy",
                                    Selectors=["//*[starts-with(@label,'%s')]" % name])
        return simple.MergeBlocks(registrationName=name + " as modelled", Input=block, MergePoints=0)

    def parts(self, source, name):
        """All of a body, and its half behind the missile's axis. A symmetry plane y = constant leads through the axis."""
        behind = None
        for axis, place in DROP["mirrors"]:
            if axis == "Y":
                behind = source
            source = simple.Reflect(registrationName="%s reflected at %s" % (name, axis.lower()), Input=source,
                                    Plane=axis, Center=place, CopyInput=1)
        if behind is None:
            behind = simple.Clip(registrationName=name + " cut", Input=source, ClipType="Plane", Invert=0)
            behind.ClipType.Origin = [DROP["axis"][0], DROP["axis"][1], 0]
            behind.ClipType.Normal = [0, 1, 0]
        return source, behind

    def smooth(self, body):
        """The missile with as many points as its picture needs, on the exact sphere if it is one."""
        surface = simple.ExtractSurface(registrationName="missile surface", Input=body)
        if DROP["sphere"] is None:
            return simple.GenerateSurfaceNormals(registrationName="missile shaded", Input=surface, FeatureAngle=30)
        fine = simple.Subdivide(registrationName="missile subdivided", Input=surface, NumberofSubdivisions=3)
        on_sphere = simple.Calculator(registrationName="missile on its sphere", Input=fine, AttributeType="Point Data",
                                      CoordinateResults=1,
                                      Function="sphere_centre_m+%.9g*norm(coords-sphere_centre_m)" % DROP["sphere"])
        return simple.Calculator(registrationName="missile shaded", Input=on_sphere, AttributeType="Point Data",
                                 ResultArrayName="Normals", ResultNormals=1, Function="norm(coords-sphere_centre_m)")

    # ---- what is seen ----

    def make_view(self):
        view = simple.GetActiveView() or simple.CreateView("RenderView")
        view.UseColorPaletteForBackground = 0
        view.BackgroundColorMode = "Single Color"
        view.Background = [1, 1, 1]
        view.OrientationAxesVisibility = 0
        return view

    def show_pad(self):
        shown = [self.pad, self.cut]
        name = None
        if DROP["array"]:
            name = DROP["label"]
            lowest = DROP["largest"] * DROP["factor"] * 10.0 ** -DECADES
            function = "max(%s*%g,%.9g)" % (DROP["array"], DROP["factor"], lowest)
            shown = [simple.Calculator(registrationName=title, Input=source, AttributeType="Point Data",
                                       ResultArrayName=name, Function=function)
                     for title, source in zip(("pad", "cut"), shown)]
        for source in shown:
            display = simple.Show(source, self.view)
            display.Representation = "Surface With Edges"
            display.EdgeColor = GREY
            display.LineWidth = 0.5
            display.Specular = 0.0
            display.Ambient = 0.35
            display.Diffuse = 0.75
            if name:
                simple.ColorBy(display, ("POINTS", name))
            else:
                display.ColorArrayName = ["POINTS", ""]
            display.Visibility = int((source is shown[0]) == self.whole)
        self.pad, self.cut = shown
        if name:
            colours = simple.GetColorTransferFunction(name)
            colours.RGBPoints = control_points(lowest, 10.0 ** DECADES * lowest)
            colours.ColorSpace = "Lab"
            colours.UseLogScale = 1
            colours.AutomaticRescaleRangeMode = "Never"
            self.show_bar(colours, lowest)

    def show_bar(self, colours, lowest):
        bar = simple.GetScalarBar(colours, self.view)
        bar.Title = DROP["label"] + ", logarithmic"
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
        bar.LabelFormat = bar.RangeLabelFormat = "%-.4g"
        bar.UseCustomLabels = 1
        powers = [10.0 ** k for k in range(-9, 12)]
        bar.CustomLabels = [v for v in powers if 1.3 * lowest < v < 0.7 * lowest * 10.0 ** DECADES]
        bar.Visibility = 1

    def show_missile(self):
        for source in (self.missile, self.missile_cut):
            display = simple.Show(source, self.view)
            display.Representation = "Surface"
            display.ColorArrayName = ["POINTS", ""]
            display.DiffuseColor = display.AmbientColor = MISSILE_COLOUR
            display.Ambient = 0.25
            display.Specular = 0.15
            # The facets of the pad lie a little inside a sphere that its nodes touch.
            display.Opacity = 1.0 if source is self.missile else 0.3
            display.Visibility = int((source is self.missile) == self.whole)
        merged = simple.Clean(registrationName="missile cut merged", Input=simple.ExtractSurface(
            registrationName="missile cut surface", Input=self.missile_cut), Tolerance=1e-5)
        rim = simple.FeatureEdges(registrationName="missile cut rim", Input=merged, BoundaryEdges=1, FeatureEdges=0,
                                  ManifoldEdges=0, NonManifoldEdges=0)
        line = simple.Show(rim, self.view)
        line.ColorArrayName = ["POINTS", ""]
        line.DiffuseColor = line.AmbientColor = INK
        line.LineWidth = 2.5
        line.Visibility = int(not self.whole)

    def show_support(self, whole, behind):
        for source in (whole, behind):
            display = simple.Show(source, self.view)
            display.Representation = "Surface"
            display.ColorArrayName = ["POINTS", ""]
            display.DiffuseColor = display.AmbientColor = SUPPORT_COLOUR
            display.Ambient = 0.25
            display.Visibility = int((source is whole) == self.whole)

    def show_text(self, source, location, size):
        shown = simple.Show(source, self.view)
        shown.Color = INK
        shown.FontSize = size
        shown.WindowLocation = location

    def show_title(self):
        title = simple.Text(registrationName="title", Text=DROP["title"])
        self.show_text(title, "Upper Left Corner", 16)
        if not DROP["missile"]:
            clock = simple.AnnotateTimeFilter(registrationName="time", Input=self.reader, Format="%.2f ms", Scale=1e3)
            self.show_text(clock, "Upper Right Corner", 16)

    def show_reading(self, body):
        """Time, deceleration or force, and speed of the missile as it was modelled."""
        second = "'%.0f N' % max(contact_force_N)" if DROP["driven"] else "'%.1f g' % max(acceleration_g)"
        reading = simple.PythonAnnotation(
            registrationName="reading", Input=body, ArrayAssociation="Point Data",
            Expression="('%.2f ms' % (1e3 * time_value)) + '   ' + ({}) + '   ' + ('%.2f m/s' % max(speed_m_s))".format(
                second))
        self.show_text(reading, "Upper Right Corner", 16)

    # ---- time and camera ----

    def nearest(self, time):
        return min(self.times, key=lambda t: abs(t - time))

    def go_to(self, time):
        scene = simple.GetAnimationScene()
        scene.UpdateAnimationUsingDataTimeSteps()
        scene.AnimationTime = time
        self.view.ViewTime = time

    def box(self, times):
        """Bounds of what is shown at these times: low and high corner."""
        low, high = [math.inf] * 3, [-math.inf] * 3
        sources = [self.pad if self.whole else self.cut]
        if self.missile:
            sources.append(self.missile if self.whole else self.missile_cut)
        for time in times:
            for source in sources:
                source.UpdatePipeline(time)
                bounds = source.GetDataInformation().GetBounds()
                for k in range(3):
                    low[k] = min(low[k], bounds[2 * k])
                    high[k] = max(high[k], bounds[2 * k + 1])
        return low, high

    def aim(self, times, size):
        """Places the camera so that the whole drop is in the picture at these times."""
        low, high = self.box(times)
        eye = unit(EYE)
        right = unit(cross([0, 0, 1], eye))
        up = cross(eye, right)
        corners = [[(low, high)[k >> c & 1][c] for c in range(3)] for k in range(8)]
        middle = [(a + b) / 2 for a, b in zip(low, high)]
        tangent = math.tan(math.radians(ANGLE) / 2)
        wide = tangent * size[0] / size[1] * (1 - 2 * SIDE)
        ahead, reach = 0.0, []
        for corner in corners:
            r = [a - b for a, b in zip(corner, middle)]
            reach.append((dot(right, r), dot(up, r), dot(eye, r)))
        # From the distance d a point at (x, y, z) is seen at y / (d - z): between -tangent (1 - 2 BOTTOM) + shift and
        # tangent (1 - 2 TOP), the focal point moved down by `shift` d.
        shift = tangent * (TOP - BOTTOM)
        free = tangent * (1 - TOP - BOTTOM)
        for x, y, z in reach:
            ahead = max(ahead, z + abs(x) / wide, z + abs(y) / free * 1.02)
        focus = [m + u * shift * ahead for m, u in zip(middle, up)]
        self.view.CameraViewAngle = ANGLE
        self.view.CameraFocalPoint = focus
        self.view.CameraPosition = [f + e * ahead for f, e in zip(focus, eye)]
        self.view.CameraViewUp = [0, 0, 1]
        self.view.CenterOfRotation = middle

    # ---- products ----

    def show(self, times, size):
        """What is in the picture at these times."""
        simple.Render(self.view)  # the first rendering places the camera
        self.aim(times, size)
        simple.Render(self.view)

    def save(self, path):
        """A state file; a view that is in no layout would not be seen in the window."""
        if simple.GetLayout(self.view) is None:
            simple.AssignViewToLayout(self.view)
        simple.SaveState(path)

    def picture(self, path, time, size=None):
        size = size or SIZE
        self.view.ViewSize = size
        self.go_to(time)
        self.show([time], size)
        simple.SaveScreenshot(path, self.view, ImageResolution=size, CompressionLevel="9")

    def film(self, path):
        times = self.film_times()
        rate = min(max(len(times) / FILM_SECONDS, 5), 30)
        self.view.ViewSize = SIZE
        self.show([times[0], self.peak], SIZE)
        with tempfile.TemporaryDirectory() as place:
            for k, time in enumerate(times):
                self.go_to(time)
                simple.Render(self.view)
                simple.SaveScreenshot(os.path.join(place, "%05d.png" % k), self.view, ImageResolution=SIZE)
            run_ffmpeg(os.path.join(place, "%05d.png"), rate, path)

    def film_times(self):
        """Those of the frames, at even intervals: of the one at the peak and a frame close to it, only the peak's."""
        if len(self.times) < 3:
            return self.times
        steps = sorted(b - a for a, b in zip(self.times, self.times[1:]))
        close = 0.5 * steps[len(steps) // 2]
        return [t for t in self.times if t == self.peak or abs(t - self.peak) > close]


def run_ffmpeg(frames, rate, path):
    command = ["ffmpeg", "-y", "-loglevel", "error", "-framerate", "%g" % rate, "-i", frames]
    if path.endswith(".gif"):
        command += ["-filter_complex", "split[a][b];[a]palettegen=stats_mode=full[p];[b][p]paletteuse"]
    else:
        command += ["-pix_fmt", "yuv420p", "-movflags", "+faststart"]
    try:
        done = subprocess.run(command + [path], stdin=subprocess.DEVNULL)
    except OSError as error:
        fail("ffmpeg cannot be run (%s): install the package ffmpeg" % error)
    if done.returncode != 0:
        fail("ffmpeg ended with code %d" % done.returncode)


def control_points(low, high):
    """COLOURS at equal ratios from low to high, as ParaView wants them."""
    points = []
    for k, colour in enumerate(COLOURS):
        points.append(low * (high / low) ** (k / (len(COLOURS) - 1)))
        points.extend(int(colour[i:i + 2], 16) / 255 for i in (0, 2, 4))
    return points


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    length = math.sqrt(dot(a, a))
    return [x / length for x in a]


def parse_options():
    parser = argparse.ArgumentParser(prog="pad_paraview", description=__doc__.split("\n")[0])
    parser.add_argument("--picture", metavar="PNG", help="write a picture")
    parser.add_argument("--film", metavar="FILE", help="write a film, .mp4 or .gif")
    parser.add_argument("--state", metavar="PVSM", help="write a state file of ParaView")
    parser.add_argument("--time", type=float, metavar="MS", help="of the picture, in ms of the run (default: the peak)")
    parser.add_argument("--whole", action="store_true", help="the whole pad and missile, not cut")
    return parser.parse_args()


def main():
    options = parse_options()
    xdmf = os.path.join(folder(), "pad.xdmf")
    if not os.path.isfile(xdmf):
        fail("%s: no such file; it belongs beside this script" % xdmf)
    if not DROP:
        fail("this is the template of softfall-post, which writes the facts of a drop into it")
    drop = Drop(xdmf, options.whole)
    if options.picture:
        time = drop.peak if options.time is None else drop.nearest(1e-3 * options.time)
        drop.picture(options.picture, time)
    if options.film:
        drop.film(options.film)
    if not options.picture and not options.film:
        drop.show([drop.times[0], drop.peak], SIZE)
    if options.state:
        drop.save(options.state)


if __name__ in ("__main__", "__vtkconsole__"):
    main()
