# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of a drop's report: curves over time, force, energies, and the pad cut through the missile's axis. Each is a PNG."""
from __future__ import annotations

from typing import Any, Mapping, NamedTuple, Sequence

import numpy as np

from .array import Array
from .drop import Drop, Frame
from .template import png

LEFT, ROW = 45, 13  # points: the margin of the y axis, a row of the key
SEEN = 0.01  # of the largest value: a curve this far from another is seen beside it
MODEL, MEASURED, PALE, LIMIT, SHADE = "#08519c", "#202020", "#a0a0a0", "#cb181d", "#c6dbef"
COLOURS = ("#eef0ec", "#b0d0e4", "#5496c8", "#3ea58c", "#ecd454", "#f08a34", "#c42428", "#60001e")  # those of view.html
INSTANTS = ("a third of the way", "peak", "half of it")
LINES = ("#6baed6", LIMIT, "#41ab5d")  # of the instants
ENERGIES = {"energy_kinetic_missile_J": ("missile", "#303030"), "energy_stored_J": ("stored", "#08519c"), "energy_hysteresis_J": ("hysteresis", "#cb181d"),
            "energy_viscous_J": ("viscous", "#f08030"), "energy_kinetic_pad_J": ("pad in motion", "#a6761d"), "energy_friction_J": ("friction", "#e7298a"),
            "energy_stabilisation_J": ("stabilisation", "#8856a7"), "energy_contact_J": ("contact", "#41ab5d")}
TETRAHEDRA = {6: ((0, 1, 2, 3),), 7: ((0, 1, 2, 4), (0, 2, 3, 4)), 8: ((0, 1, 2, 5), (0, 1, 4, 5), (0, 4, 3, 5)),
              9: ((0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6))}  # of a cell, by its code in XDMF
FACES = {6: ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)), 7: ((0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)),
         8: ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
         9: ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))}
Table = Mapping[str, Array]


def _figure(width: float, height: float) -> tuple[Any, Any]:
    """Returns a figure (inches) with axes in margins for the labels of _tidy: a layout that measures every text takes a third of the time of a page."""
    from matplotlib.figure import Figure
    figure = Figure(figsize=(width, height), dpi=170)
    ax = figure.add_axes((0, 0, 1, 1))
    _place(ax, LEFT, 36)
    return figure, ax


def _place(ax: Any, left: float, bottom: float, right: float = 10, top: float = 11) -> None:
    """Gives the axes their margins, in points."""
    width, height = 72 * ax.figure.get_size_inches()
    ax.set_position((left / width, bottom / height, 1 - (left + right) / width, 1 - (bottom + top) / height))


def _tidy(ax: Any) -> None:
    ax.tick_params(labelsize=8)
    if ax.get_yscale() == "linear":
        ax.ticklabel_format(axis="y", scilimits=(-2, 4))  # at most five characters
        ax.yaxis.get_offset_text().set_fontsize(7)
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)


def _key(figure: Any, ax: Any, columns: int) -> None:
    """Puts the key below the axes, where it lies over nothing."""
    rows = -(-len(ax.get_legend_handles_labels()[1]) // columns)
    _place(ax, LEFT, 38 + ROW * rows)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 0), bbox_transform=figure.transFigure, ncols=columns, fontsize=8, frameon=False, borderaxespad=0.2)


def _range(time: Array, model: Array, measured: tuple[Array, Array] | None) -> tuple[float, float]:
    """Returns the part of the time that is shown: where the model is above 2 % of its largest value or the measurement above 5 %, and a margin."""
    high = np.flatnonzero(model > 0.02 * model.max(initial=0))
    if high.size < 2:
        return float(time[0]), float(time[-1])
    first, last = time[high[0]], time[high[-1]]
    margin, low, end = 0.06 * (last - first), first, last
    if measured:
        seen = measured[0][measured[1] > 0.05 * measured[1].max(initial=0)]
        low, end = min(low, max(seen.min(initial=first), first - 3 * margin)), max(end, min(seen.max(initial=last), last + 3 * margin))
    return float(max(low - margin, min(time[0], low))), float(end + margin)


def _is_seen(time: Array, value: Array, other: Array, shown: tuple[float, float]) -> bool:
    part = (time >= shown[0]) & (time <= shown[1]) & np.isfinite(value) & np.isfinite(other)
    return bool(part.any() and np.abs(value - other)[part].max() > SEEN * max(np.abs(value[part]).max(), 1e-12))


def acceleration(summary: Mapping[str, Any], curve: Table, history: Table | None, measured: Table | None) -> bytes:
    """Returns the curve of a_max and HIC with the window of HIC, the measured curve and the limit, where these are near."""
    figure, ax = _figure(5.4, 3.3)
    time, value = curve["time_ms"], next(array for name, array in curve.items() if name != "time_ms")
    known = measured["acceleration_measured_g"] if measured else None
    shown = _range(time, value, (measured["time_ms"], known) if measured and known is not None else None)
    if summary["hic"] and summary["hic_t1_ms"] is not None:
        window = (time >= summary["hic_t1_ms"]) & (time <= summary["hic_t2_ms"])
        ax.fill_between(time[window], value[window], color=SHADE, lw=0, label=f"HIC {summary['hic']:.1f}: {summary['hic_t1_ms']:.2f} to {summary['hic_t2_ms']:.2f} ms")
    if measured and known is not None:
        if _is_seen(measured["time_ms"], measured["acceleration_measured_raw_g"], known, shown):
            ax.plot(measured["time_ms"], measured["acceleration_measured_raw_g"], color=PALE, lw=0.6, label="measured, as in its file")
    if history and _is_seen(history["time_ms"], history["acceleration_raw_g"], np.interp(history["time_ms"], time, value), shown):
        ax.plot(history["time_ms"], history["acceleration_raw_g"], color="#fd8d3c", lw=0.6, label="not filtered")
    ax.plot(time, value, color=MODEL, lw=2, label=f"{'model, ' if measured else ''}CFC {summary['cfc']:g}")
    if measured:
        reference = summary["reference"]
        ax.plot(measured["time_ms"], known, color=MEASURED, lw=1.2, ls="--",
                label=f"measured{'' if reference['cfc'] is None else ', CFC %g' % reference['cfc']}: a_max {reference['a_max_g']:.1f} g")
    if summary["a_max_g"] and summary["a_max_time_ms"] is not None:
        ax.plot(summary["a_max_time_ms"], summary["a_max_g"], "o", color="#08306b", ms=4, label=f"a_max {summary['a_max_g']:.1f} g at {summary['a_max_time_ms']:.2f} ms")
    limit = next((one["bound"] for one in summary["verdict"]["limits"] if one["key"] == "a_max_g"), np.inf)
    if value.max(initial=0) > 0.4 * limit:
        ax.axhline(limit, color=LIMIT, lw=1, ls=(0, (5, 3)), label=f"limit {limit:g} g")
    ax.set(xlim=shown, xlabel="time (ms)", ylabel="acceleration (g)")
    ax.margins(y=0.06)
    ax.set_ylim(bottom=min(0.0, ax.get_ylim()[0]) if value.min(initial=0) < -0.02 * value.max(initial=0) else 0)
    _tidy(ax)
    _key(figure, ax, 2)
    return png(figure)


def line(x: Array, y: Array, labels: tuple[str, str]) -> bytes:
    """Returns one curve of a pair of columns."""
    figure, ax = _figure(3.6, 2.8)
    ax.plot(x, y, color=MODEL, lw=1.6)
    ax.set(xlabel=labels[0], ylabel=labels[1], xlim=(0, None), ylim=(0, None))
    _tidy(ax)
    return png(figure)


def energies(history: Table, shown: tuple[float, float]) -> bytes:
    """Returns the energies that are seen beside the largest one, over time."""
    figure, ax = _figure(3.6, 2.8)
    top = max((np.nanmax(history[name]) for name in ("energy_kinetic_missile_J", "energy_stored_J")), default=0)
    for name, (title, colour) in ENERGIES.items():
        if np.nanmax(history[name]) >= SEEN * top:
            ax.plot(history["time_ms"], history[name], color=colour, lw=1.4, label=title)
    ax.set(xlim=shown, ylim=(0, None), xlabel="time (ms)", ylabel="energy (J)")
    _tidy(ax)
    _key(figure, ax, 3)
    return png(figure)


def several(curves: Mapping[str, tuple[Array, Array]]) -> bytes:
    """Returns the accelerations of several runs over the time from first contact."""
    figure, ax = _figure(7.2, 3.4 + ROW * len(curves) / 72)
    for title, (time, value) in curves.items():
        ax.plot(time, value, lw=1.4, label=title.replace("$", r"\$"))
    ax.set(xlabel="time from first contact (ms)", ylabel="acceleration (g)")
    _tidy(ax)
    _key(figure, ax, 1)  # names of runs may be long
    return png(figure)


# ---- the pad ----

class Instant(NamedTuple):
    """A frame, and what it shows."""

    title: str
    frame: Frame


class Section:
    """The undeformed pad cut by the vertical plane through the missile's axis.

    `first`, `second`, `weight`: points of the cut on edges of the mesh, (1 - weight) of the first node and weight of the second; `triangle` (n, 3) of
    points fill it, `side` (n, 2) are the outlines of the cells.
    """

    def __init__(self, drop: Drop) -> None:
        self._position = np.asarray(drop.data("model/position"))
        self._surface, self._missile = np.asarray(drop.data("model/surface_triangle")), np.asarray(drop.data("model/surface_position"))
        low, high = self._position.min(0), self._position.max(0)
        place = [float(drop.data(f"model/symmetry_{axis}")) for axis in "xy"]
        middle = (self._missile.min(0) + self._missile.max(0)) / 2
        plane = middle[1] if np.isnan(place[1]) else place[1]
        self.axis, self.mirrored = float(middle[0] if np.isnan(place[0]) else place[0]), not np.isnan(place[0])
        near = 1e-6 * max(high[:2] - low[:2])  # a plane of symmetry is an end of the pad
        self._plane = plane + (near if plane + near < high[1] else -near)
        self.thickness = high[2] - low[2]
        self._bounds = low, high
        kind, start, node = (np.asarray(drop.data(f"model/cell_{name}")) for name in ("type", "ptr", "node"))
        cells = {int(code): node[start[:-1][kind == code][:, None] + np.arange(np.diff(start)[kind == code][0])] for code in np.unique(kind)}
        if set(cells) <= {4, 5}:
            self._take_plane(cells)
            self._plane = near
        else:
            self._cut(cells)
        self._support = None
        with drop.open() as file:
            if "model/support_position" in file:
                self._support = np.asarray(file["model/support_position"]), np.asarray(file["model/support_triangle"])

    def _take_plane(self, cells: Mapping[int, Array]) -> None:
        """Takes the cells of an axisymmetric model, which lie in the plane."""
        self.first = self.second = np.arange(len(self._position))
        self.weight = np.zeros(len(self._position))
        self.triangle = np.concatenate([table[:, list(corners)] for code, table in cells.items() for corners in ((0, 1, 2), (0, 2, 3))[:code - 3]])
        self.side = np.concatenate([np.stack([table, np.roll(table, -1, axis=1)], axis=-1).reshape(-1, 2) for table in cells.values()])
        self.mirrored, self.axis = True, 0.0

    def _cut(self, cells: Mapping[int, Array]) -> None:
        """Cuts solid cells, as tetrahedra: three crossed edges make a triangle, four make two."""
        above, count = self._position[:, 1] >= self._plane, len(self._position)
        cut = {code: table[above[table].any(1) & ~above[table].all(1)] for code, table in cells.items()}
        solid = np.concatenate([table[:, list(corners)] for code, table in cut.items() for corners in TETRAHEDRA[code]])
        edge = np.sort(solid[:, [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]]], axis=2)
        crossed = above[edge[..., 0]] != above[edge[..., 1]]
        name = edge[..., 0].astype(np.int64) * count + edge[..., 1]
        points = np.unique(name[crossed])
        three, four = (name[crossed.sum(1) == number][crossed[crossed.sum(1) == number]].reshape(-1, number) for number in (3, 4))
        self.triangle = np.searchsorted(points, np.concatenate([three, four[:, [0, 1, 3]], four[:, [0, 3, 2]]]))
        sides = [np.zeros((0, 2), np.int64)]
        for code, table in cut.items():
            for corners in FACES[code]:
                face = table[:, list(corners)]
                ring = np.sort(np.stack([face, np.roll(face, -1, axis=1)], axis=-1), axis=2)
                through = above[ring[..., 0]] != above[ring[..., 1]]
                two = through.sum(1) == 2
                sides.append((ring[..., 0].astype(np.int64) * count + ring[..., 1])[two][through[two]].reshape(-1, 2))
        self.side = np.searchsorted(points, np.unique(np.concatenate(sides), axis=0))
        self.first, self.second = points // count, points % count
        height = self._position[:, 1] - self._plane
        self.weight = height[self.first] / (height[self.first] - height[self.second])

    def value(self, field: Any) -> Array:
        """Returns a field of the nodes at the points."""
        array = np.asarray(field)
        weight = self.weight.reshape(-1, *(1,) * (array.ndim - 1))
        return np.asarray(array[self.first] + weight * (array[self.second] - array[self.first]))

    def _outline(self, position: Array, triangle: Array) -> Array:
        """Returns the parts (n, 2, 2) of a surface's triangles in the plane, x and z."""
        a = position[triangle]
        b = np.roll(a, -1, axis=1)
        over, under = a[..., 1] - self._plane, b[..., 1] - self._plane
        crossed = (over < 0) != (under < 0)
        two = crossed.sum(1) == 2
        part = (over[two] / np.where(crossed[two], over[two] - under[two], 1))[..., None]
        return np.asarray((a[two] + part * (b[two] - a[two]))[crossed[two]].reshape(-1, 2, 3)[..., [0, 2]])

    def _sides(self, x: Array) -> list[Array]:
        return [x, 2 * self.axis - x] if self.mirrored else [x]

    def picture(self, instant: Instant, field: str, label: str, factor: float, top: float, width: float, logarithmic: bool = False, cells: bool = False, half: float = np.inf) -> bytes:
        """Returns the deformed pad and the missile at an instant, coloured by a field up to `top`, to `half` m beside the axis."""
        from matplotlib.collections import LineCollection
        from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap
        from matplotlib.tri import Triangulation
        frame = instant.frame
        place = 1e3 * (self.value(self._position) + self.value(frame.displacement))
        levels = np.geomspace(top / 10 ** 2.5, top, 17) if logarithmic else np.linspace(0, top, 17)
        colours = LinearSegmentedColormap.from_list("pad", COLOURS)
        value = np.clip(factor * self.value(getattr(frame, field)), levels[0] * (1 + 1e-9) + 1e-12 * top, levels[-1])
        (low, high), axis, scale = self._bounds, 1e3 * self.axis, 1e3
        reach = min(half, max(self.axis - low[0], high[0] - self.axis)) * scale
        left, right = axis - (reach if self.mirrored else min(reach, axis - scale * low[0])), axis + min(reach, scale * high[0] - axis)
        missile = scale * self._outline(np.asarray(frame.missile), self._surface)
        bottom, up = scale * low[2] - 0.02 * scale * self.thickness, min(missile[..., 1].max(initial=scale * high[2]), scale * high[2] + (0.35 if np.isfinite(half) else 0.6) * scale * self.thickness)
        if self._support:
            bottom -= 0.13 * scale * self.thickness
        figure, ax = _figure(width, (width - 28 / 72) * min(max((up - bottom) / (right - left), 0.15), 1.3) + 78 / 72)
        _place(ax, 14, 73, 14, 5)
        for x in self._sides(place[:, 0] / scale):
            shape = Triangulation(scale * x, place[:, 2], self.triangle)
            drawn = ax.tricontourf(shape, value, levels=levels, cmap=colours, norm=BoundaryNorm(levels, colours.N))
            if cells:
                ax.add_collection(LineCollection(np.stack([scale * x, place[:, 2]], axis=-1)[self.side], colors="#30404f", linewidths=0.25, alpha=0.4))
        bodies = [(missile, "#101820"), *([(scale * self._outline(*self._support), "#7a5c3a")] if self._support else [])]
        for outline, colour in bodies:
            for x in self._sides(outline[..., 0] / scale):
                ax.add_collection(LineCollection(np.stack([scale * x, outline[..., 1]], axis=-1), colors=colour, linewidths=1.2))
        ax.set(xlim=(left, right), ylim=(bottom, up), aspect="equal", xlabel="x (mm)")
        ax.tick_params(labelsize=8, left=False, labelleft=False)
        for side in ("top", "right", "left"):
            ax.spines[side].set_visible(False)
        scale_axes = figure.add_axes((0, 0, 1, 1))
        _place(scale_axes, 14, 30, 14, 72 * figure.get_figheight() - 38)
        bar = figure.colorbar(drawn, cax=scale_axes, orientation="horizontal", ticks=levels[::4], format=lambda tick, _: f"{tick:.3g}" if tick < 1000 else f"{tick:.0f}")
        bar.set_label(label, fontsize=8)
        bar.ax.tick_params(labelsize=8)
        bar.ax.minorticks_off()
        return png(figure)

    def profile(self, instants: Sequence[Instant], field: str, label: str, factor: float) -> bytes | None:
        """Returns a field over the undeformed depth under the missile's axis; None where the cut has no such line."""
        from matplotlib.tri import LinearTriInterpolator, Triangulation
        place = self.value(self._position)
        near = np.abs(place[:, 0] - self.axis) < 0.5 * self.thickness
        depth = np.linspace(0, self.thickness, 60)[1:-1]
        figure, ax = _figure(3.6, 2.8)
        try:
            shape = Triangulation(place[near, 0], place[near, 2])
            for instant, colour in zip(instants, LINES):
                value = LinearTriInterpolator(shape, factor * self.value(getattr(instant.frame, field))[near])
                inside = value(np.full(depth.size, self.axis + 1e-6 * self.thickness), self._bounds[1][2] - depth)
                ax.plot(inside, 1e3 * depth, color=colour, lw=1.6, label=f"{1e3 * instant.frame.time:.1f} ms")
        except (RuntimeError, ValueError):
            return None
        ax.set(xlabel=label, ylabel="undeformed depth (mm)", ylim=(1e3 * self.thickness, 0), xscale="log")
        _tidy(ax)
        _key(figure, ax, 3)
        return png(figure)


def instants(drop: Drop, times: Sequence[float | None], load: tuple[Array, Array], unit: str) -> tuple[list[Instant], list[str]]:
    """Returns the frames near the times (ms), of which the second is the peak, and what there is no frame for. `load`: ms and values of the curve in the titles."""
    frames, found, lacking = list(drop.frames), [], []
    with drop.open() as file:
        has_peak = "peak" in file
    peak, third = times[1], times[0]
    reach = 0.3 * (peak - third) if peak is not None and third is not None else 0
    for time, name in zip(times, INSTANTS):
        near = min(frames, key=lambda frame: abs(1e3 * frame.time - (time or 0)), default=None)
        frame = drop.peak if has_peak and name == "peak" else near if time is not None and near and abs(1e3 * near.time - time) <= reach else None
        if frame is None or not {"displacement", "von_mises"} <= set(frame.fields):
            lacking.append(name + (f" ({time:.1f} ms)" if time is not None else ""))
        else:
            at = 1e3 * frame.time
            found.append(Instant(f"{at:.1f} ms: {np.interp(at, *load):.3g} {unit}, {name}", frame))
    return found, lacking
