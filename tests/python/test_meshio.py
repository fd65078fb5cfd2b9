# SPDX-License-Identifier: GPL-3.0-or-later
"""pad.xdmf in meshio, a reader that knows nothing of ParaView: mesh, frames and fields are those of results.h5."""
import numpy
import pytest

series = pytest.importorskip("meshio.xdmf.time_series")


def test_meshio_reads_the_pad_of_every_frame(drop):
    page = drop.report()
    with drop.open() as file, series.TimeSeriesReader(page.with_name("pad.xdmf")) as frames:
        points, cells = frames.read_points_cells()
        rest, groups = file["model/position"][()], [file["frames"][name] for name in sorted(file["frames"])]
        assert sum(len(block.data) for block in cells) == len(file["model/cell_type"])
        assert numpy.allclose(points, rest, atol=1e-6 * numpy.abs(rest).max())
        assert frames.num_steps >= len(groups)
        shown = [frames.read_data(k) for k in range(frames.num_steps)]
        for group in groups:
            time, nodes, materials = min(shown, key=lambda frame: abs(frame[0] - group["time"][()]))
            assert time == pytest.approx(float(group["time"][()]), rel=1e-6, abs=1e-12)
            assert numpy.allclose(nodes["displacement_m"], group["displacement"][()], atol=1e-6)
            assert sum(map(len, materials["material"])) == len(file["model/cell_type"])
