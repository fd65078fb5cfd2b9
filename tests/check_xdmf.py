# SPDX-License-Identifier: GPL-3.0-or-later
"""Loads a pad.xdmf with all three XDMF readers of ParaView, every time step and every array.

    pvpython check_xdmf.py PATH STEPS PAD_NODES PAD_CELLS MISSILE_CELLS [--bounds STEP X0 X1 Y0 Y1 Z0 Z1]
                           [--range ARRAY STEP LOW HIGH]... [--times T0 T1 ...] [--full]

Checks the number of time steps, nodes and cells, that every value is finite, that the readers agree, and, if asked, the
times of the steps, the bounds of pad and missile together and the range of an array (its first component; an array of the
missile or of the cells as "missile NAME" or "cell NAME"). Numbers are floats, or with --full doubles. Exit code 0 if all
is well.
"""
import argparse
import math
import sys

from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
import numpy

TOLERANCE = {False: 1e-6, True: 1e-9}  # relative to the largest magnitude of floats; of doubles absolute
READERS = ("XDMFReader", "Xdmf3ReaderS", "Xdmf3ReaderT")


def fail(text):
    print("check_xdmf: " + text)
    sys.stdout.flush()
    sys.exit(1)


def copy_of(array):
    """The values, safe from the release of the VTK array that they come from."""
    return numpy.array(vtk_to_numpy(array), copy=True)


def blocks(data):
    """Leaf data sets of a composite, in order."""
    if data is None:
        return []
    if not data.IsA("vtkCompositeDataSet"):
        return [data]
    iterator = data.NewIterator()
    leaves = []
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        leaves.append(iterator.GetCurrentDataObject())
        iterator.GoToNextItem()
    return leaves


def open_reader(name, path):
    if name == "XDMFReader":
        return simple.XDMFReader(FileNames=[path])
    return getattr(simple, name)(FileName=[path])


def load(name, path, options):
    """List over steps of (time, bounds, {array: values}) as this reader gives them."""
    reader = open_reader(name, path)
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues) if hasattr(reader.TimestepValues, "__len__") else [reader.TimestepValues]
    if len(times) != options.steps:
        fail("%s: %d time steps, expected %d" % (name, len(times), options.steps))
    result = []
    for time in times:
        reader.UpdatePipeline(time)
        leaves = blocks(servermanager.Fetch(reader))
        leaves.sort(key=lambda leaf: leaf.GetCellData().HasArray("material"), reverse=True)
        if len(leaves) != (2 if options.missile_cells else 1):
            fail("%s, t = %g: %d grids" % (name, time, len(leaves)))
        counts = [(leaf.GetNumberOfPoints(), leaf.GetNumberOfCells()) for leaf in leaves]
        if counts[0] != (options.pad_nodes, options.pad_cells):
            fail("%s, t = %g: the pad has %d nodes and %d cells" % ((name, time) + counts[0]))
        if options.missile_cells and counts[1][1] != options.missile_cells:
            fail("%s, t = %g: the missile has %d cells" % (name, time, counts[1][1]))
        arrays = {}
        for leaf, kind in zip(leaves, ("pad", "missile")):
            arrays[kind + " points"] = copy_of(leaf.GetPoints().GetData())
            if not leaf.IsA("vtkUnstructuredGrid"):
                fail("%s, t = %g: the %s is a %s" % (name, time, kind, leaf.GetClassName()))
            arrays[kind + " cell types"] = copy_of(leaf.GetCellTypesArray())
            arrays[kind + " connectivity"] = copy_of(leaf.GetCells().GetConnectivityArray())
            expected = numpy.float64 if options.full else numpy.float32
            if arrays[kind + " points"].dtype != expected:
                fail("%s: the %s's points are %s" % (name, kind, arrays[kind + " points"].dtype))
        data = [("", leaves[0].GetPointData()), ("cell ", leaves[0].GetCellData())]
        data += [("missile ", leaf.GetPointData()) for leaf in leaves[1:]]
        for kind, source in data:
            for k in range(source.GetNumberOfArrays()):
                arrays[kind + source.GetArrayName(k)] = copy_of(source.GetArray(k))
        for key, values in arrays.items():
            if not numpy.isfinite(values).all():
                fail("%s, t = %g: %s is not finite" % (name, time, key))
        points = numpy.vstack([arrays[key] for key in ("pad points", "missile points") if key in arrays])
        result.append((time, [v for k in range(3) for v in (points[:, k].min(), points[:, k].max())], arrays))
    simple.Delete(reader)
    return result


def compare(name, steps, reference_name, reference):
    for (time, _, arrays), (other_time, _, other) in zip(steps, reference):
        if not math.isclose(time, other_time, abs_tol=1e-12):
            fail("%s has t = %g where %s has %g" % (name, time, reference_name, other_time))
        if sorted(arrays) != sorted(other):
            fail("%s has %s, %s has %s" % (name, sorted(arrays), reference_name, sorted(other)))
        for key in arrays:
            if arrays[key].shape != other[key].shape or not numpy.array_equal(arrays[key], other[key]):
                fail("t = %g: %s differs between %s and %s" % (time, key, name, reference_name))


def differ(found, expected, options):
    scale = 1 if options.full else max(abs(expected), 0.1)
    return abs(found - expected) > TOLERANCE[options.full] * scale


def check_expected(name, steps, options):
    times = [step[0] for step in steps]
    if options.times and [round(t, 9) for t in times] != options.times:
        fail("%s: the times are %s, expected %s" % (name, times, options.times))
    for bounds in options.bounds or []:
        found = steps[int(bounds[0])][1]
        expected = [float(v) for v in bounds[1:]]
        if any(differ(a, b, options) for a, b in zip(found, expected)):
            fail("%s, step %s: bounds %s, expected %s" % (name, bounds[0], found, expected))
    for array, step, low, high in options.range or []:
        values = steps[int(step)][2].get(array)
        if values is None:
            fail("%s has no array %s, but %s" % (name, array, sorted(steps[int(step)][2])))
        values = values.reshape(len(values), -1)[:, 0]
        if differ(values.min(), float(low), options) or differ(values.max(), float(high), options):
            fail("%s, step %s: %s is in %.17g to %.17g" % (name, step, array, values.min(), values.max()))


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("path")
    parser.add_argument("steps", type=int)
    parser.add_argument("pad_nodes", type=int)
    parser.add_argument("pad_cells", type=int)
    parser.add_argument("missile_cells", type=int)
    parser.add_argument("--bounds", nargs=7, action="append")
    parser.add_argument("--range", nargs=4, action="append")
    parser.add_argument("--times", nargs="+", type=float)
    parser.add_argument("--full", action="store_true")
    options = parser.parse_args()
    loaded = []
    for name in READERS:
        steps = load(name, options.path, options)
        check_expected(name, steps, options)
        if loaded:
            compare(name, steps, READERS[0], loaded[0])
        loaded.append(steps)
        print("check_xdmf: %s: %d steps, arrays %s" % (name, len(steps), ", ".join(sorted(steps[0][2]))))


main()
