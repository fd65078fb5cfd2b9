# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops: figures, history, frames, verdict, plot, report; HIC and filters."""
import doctest
import importlib
import inspect
import json
import os
import pathlib
import pkgutil
import shutil
import subprocess
import sys
import typing

import numpy as np
import pytest

import softfall
from softfall import output
from softfall import curves
from conftest import program


def test_figures_are_found_or_listed(drop):
    assert drop.figures["hic"] > 0 and drop.figures["rebounded"] is True and drop.figures["status"] == "rebound"
    assert np.isnan(drop.figures["peak_force_N"])  # of a prescribed motion
    with pytest.raises(KeyError, match='there is no figure "hicc" .did you mean "hic".*a_max_g, a_max_time_ms, hic, '):
        drop.figures["hicc"]
    with pytest.raises(KeyError, match='no column "accel".*acceleration'):
        drop.history["accel"]
    assert "hicc" not in drop.figures and "figures" in repr(drop.figures) and drop.layers == []


def test_verdict_is_a_text_with_reasons(drop):
    assert drop.verdict == "valid with remarks" and isinstance(drop.verdict, str)
    assert any("mesh" in remark for remark in drop.verdict.remarks)  # 20 mm
    assert {limit["key"] for limit in drop.verdict.limits} == {"a_max_g", "hic"}


def test_columns_have_units_that_arithmetic_drops(drop):
    a = drop.history["acceleration"]
    assert a.units == "m s-2" and a[3:9].units == "m s-2" and "specific force" in a.description
    assert type(a / 9.80665) is np.ndarray and isinstance(a.max(), float)
    assert drop.history["time"].units == "s" and len(drop.history) > 40


def test_frames_have_positions_and_stress(drop):
    frame = drop.frames[len(drop.frames) // 2]
    assert np.array_equal(frame.position, drop.data("model/position") + frame.displacement) and frame.position.units == "m"
    stress = np.asarray(drop.peak.stress)
    assert stress.shape == (drop.figures["nodes"], 3, 3) and drop.peak.stress.units == "Pa"
    part = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    assert np.allclose(np.sqrt(1.5 * (part ** 2).sum((1, 2))), drop.peak.von_mises, rtol=1e-9, atol=1e-6)
    moved = drop.peak.missile - np.asarray(drop.data("model/surface_position"))
    assert np.allclose(moved, drop.peak.missile_displacement) and moved[0, 2] < -0.02
    assert drop.frames[0].time == 0 and drop.frames[-1].time > drop.frames[-2].time and len(drop.frames[1:3]) == 2
    assert [f.time for f in drop.frames] == sorted(f.time for f in drop.frames)
    with pytest.raises(AttributeError, match='no field of this frame "stres" .did you mean "stress"'):
        frame.stres
    with pytest.raises(IndexError, match="there is no frame 9999"):
        drop.frames[9999]
    with pytest.raises(KeyError, match="dataset in model"):
        drop.data("model/positions")
    with pytest.raises(KeyError, match="group in results.h5"):
        drop.data("modell/position")


@pytest.mark.drawn
def test_plot_shows_the_curve_and_the_window(drop, tmp_path):
    ax = drop.plot()
    time, curve = drop.curve()
    shown = ax.lines[-1]
    assert np.allclose(shown.get_xdata(), 1e3 * np.asarray(time)) and np.array_equal(shown.get_ydata(), curve)
    assert max(curve) == pytest.approx(drop.figures["a_max_g"], rel=1e-3)
    window = ax.patches[0].get_extents().transformed(ax.transData.inverted())
    assert window.x0 == pytest.approx(drop.figures["hic_t1_ms"]) and window.x1 == pytest.approx(drop.figures["hic_t2_ms"])
    ax.figure.savefig(tmp_path / "plot.png")
    assert (tmp_path / "plot.png").stat().st_size > 10_000
    assert drop.plot(ax) is ax
    with pytest.raises(softfall.Error, match="there is no display"):
        drop.plot(show=True)


def test_a_drop_prints_its_verdict(drop):
    assert str(drop) == f"{drop.verdict}: a_max {drop.figures['a_max_g']:.4g} g, HIC {drop.figures['hic']:.4g}"
    assert repr(drop).startswith(f"<softfall.Drop {drop} (") and str(drop.results) in repr(drop)


def test_report_and_files(drop):
    assert drop.report().read_text(encoding="utf-8").startswith("<") and drop.file("pad.xdmf").exists()
    with pytest.raises(KeyError, match="no file of softfall-post"):
        drop.file("pad.mp4")


def test_read_results_leaves_the_folder_alone(drop, tmp_path):
    hic, before = drop.figures["hic"], sorted(drop.results.parent.iterdir())
    again = softfall.read_results(drop.results)
    assert again.figures["hic"] == hic and again.report().exists()
    assert sorted(drop.results.parent.iterdir()) == before
    limits = {limit["key"]: limit["bound"] for limit in again.post(tmp_path / "post", limit_g=10)["verdict"]["limits"]}
    assert limits["a_max_g"] == 10 and again.verdict.limits[0]["passed"] is False and (tmp_path / "post/summary.json").exists()
    with pytest.raises(softfall.InputError, match="unrecognized option"):
        again.post(tmp_path / "more", limitt=10)


def test_files_of_other_results_are_neither_used_nor_replaced(case, drop, tmp_path):
    drop.post(tmp_path / "post")
    case["missile.velocity"] = "4 m/s"
    other = softfall.read_results(case.run().results, output=tmp_path / "post")
    with pytest.raises(softfall.InputError, match="force"):
        other.figures
    other.post(tmp_path / "other")
    assert other.figures["hic"] < drop.figures["hic"]
    again = softfall.read_results(other.results, output=tmp_path / "other")
    assert other.report() == tmp_path / "other/report.html"
    stamp = (tmp_path / "other/report.html").stat().st_mtime_ns
    assert again.figures["hic"] == other.figures["hic"] and again.report().stat().st_mtime_ns == stamp


def test_options_of_softfall_post_do_not_stay(drop, tmp_path):
    before = drop.figures["a_max_g"]
    assert drop.post(filter=60)["cfc"] == 60 and drop.figures["a_max_g"] < before  # the last call
    assert softfall.read_results(drop.results, output=drop.results.parent / "out").figures["a_max_g"] == before
    assert drop.post()["cfc"] == 1000 and drop.figures["a_max_g"] == before
    with pytest.raises(softfall.InputError, match="without options"):
        drop.post(drop.results.parent / "out", filter=60)


def test_replaced_results_are_not_taken_for_the_drop(case, tmp_path):
    first = case.run(output=tmp_path)
    case["missile.velocity"] = "4 m/s"
    second = case.run(output=tmp_path, force=True)
    for read in (lambda: first.figures, lambda: first.history, lambda: first.frames[0]):
        with pytest.raises(softfall.Error, match="has been replaced since"):
            read()
    assert second.figures["hic"] > 0
    (tmp_path / "results.h5").unlink()
    with pytest.raises(softfall.Error, match="cannot be read"):
        second.figures


def test_prescribed_motion_is_drawn_as_stress_over_strain(place, tmp_path):
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"]) / "examples/compression/case.cfg"
    pressed = softfall.Case(source, {"geometry.parameters.spacing": 25, "solver.end_time": "20 ms"}).run(output=tmp_path)
    assert pressed.figures["prescribed_motion"] is True and pressed.figures["peak_force_N"] > 0
    ax = pressed.plot()
    assert ax.get_xlabel() == "indentation / thickness" and max(ax.lines[0].get_ydata()) == pytest.approx(pressed.figures["peak_stress_kPa"])


@pytest.mark.parametrize("content", [b"", b"text", b"\x89HDF\r\n\x1a\n" + 100 * b"\0"])
def test_no_results_are_refused(tmp_path, content):
    (tmp_path / "results.h5").write_bytes(content)
    with pytest.raises(softfall.Error, match="cannot be read as results"):
        softfall.read_results(tmp_path)


def test_other_files_are_refused(drop, tmp_path):
    with pytest.raises(softfall.InputError, match='its format is "softfall-model"'):
        softfall.read_results(drop.results.parent / "model.h5")
    with pytest.raises(softfall.InputError, match="there are no results"):
        softfall.read_results(tmp_path)
    damaged = bytearray(drop.results.read_bytes())
    damaged[len(damaged) // 2] ^= 255
    (tmp_path / "results.h5").write_bytes(damaged)
    with pytest.raises(softfall.Error, match="softfall-post: "):
        softfall.read_results(tmp_path).figures


def pulse(rate=10e3):
    """A half sine of 80 g over 20 ms with a ringing, in free flight before and after."""
    t = np.round(np.arange(0, 0.05, 1 / rate), 9)
    inside = (t > 0.01) & (t < 0.03)
    return t, np.where(inside, 80 * np.sin(np.pi * (t - 0.01) / 0.02) + 3 * np.sin(9000 * t), 0)


def test_hic_of_pulses_with_a_closed_form():
    assert softfall.hic([0, 0.01], [100, 100]) == pytest.approx(1000, rel=1e-12)
    assert softfall.hic([0, 0.01], [100, 100], window=0.004) == pytest.approx(400, rel=1e-9)
    t = np.linspace(0, 0.02, 2001)
    half_sine = softfall.hic(t, 100 * np.sin(np.pi * t / 0.02))
    assert half_sine == pytest.approx(0.4146 * 0.02 * 100 ** 2.5, rel=1e-3) and half_sine.t1 + half_sine.t2 == pytest.approx(0.02)
    a = curves.column(100 * 9.80665 * np.ones(2), "m s-2")
    assert softfall.hic([0, 0.01], a) == pytest.approx(1000, rel=1e-12)
    assert softfall.hic([0, 0.01], [-1, -1]) == 0


def test_hic_of_the_filtered_curve_is_that_of_the_report(drop):
    time, curve = drop.curve()
    value = softfall.hic(time, curve)
    assert value == pytest.approx(drop.figures["hic"], rel=1e-7) and 1e3 * value.t1 == pytest.approx(drop.figures["hic_t1_ms"], rel=1e-5)
    assert softfall.hic(time, curve, 0.015) == pytest.approx(drop.figures["hic15"], rel=1e-7)


def test_filter_and_hic_are_those_of_a_reference_to_the_last_digit(drop, tmp_path):
    t, a = pulse()
    lines = "".join(f"{1e3 * x:.9g},{y:.17g}\n" for x, y in zip(t, a))
    (tmp_path / "lab.csv").write_text("time_ms,acceleration_g\n" + lines)
    told = drop.post(tmp_path / "post", reference=tmp_path / "lab.csv", reference_filter=180)["reference"]
    table = np.genfromtxt(tmp_path / "post/reference.csv", delimiter=",", names=True)
    filtered = softfall.cfc(t, a, 180)
    theirs = table["acceleration_measured_g"]
    assert [f"{x:.9g}" for x in filtered] == [f"{x:.9g}" for x in theirs]
    assert softfall.hic(t, filtered) == pytest.approx(told["hic"], rel=1e-9)
    drop.post()


def test_filter_keeps_units_and_constants():
    t, a = pulse()
    assert softfall.cfc(t, curves.column(a, "m s-2")).units == "m s-2"
    assert abs(softfall.cfc(t, np.ones_like(t), 60) - 1).max() < 1e-12
    assert abs(softfall.cfc(t, a, 60)).max() < abs(softfall.cfc(t, a, 600)).max()
    uneven = np.sort(np.concatenate([t, t[:-1] + 3e-5]))
    assert np.allclose(softfall.cfc(uneven, np.interp(uneven, t, a), 60), np.interp(uneven, t, softfall.cfc(t, a, 60)), atol=0.3)


@pytest.mark.parametrize("arguments, sentence", [
    (([0, 1, 2], [1, 2]), "one length"),
    (([], []), "at least 2 are needed"),
    (([0, 0.001], ["a", 2]), "must be numbers"),
    (([0, 0.001, 0.001], [1, 2, 3]), "does not follow"),
    (([0, 0.001, float("nan")], [1, 2, 3]), "finite"),
    (([0, 0.001, 0.002], [1, float("inf"), 3]), "finite"),
    ((np.arange(20.0), np.ones(20)), "is the time in ms"),
    (([[0, 1]], [[0, 1]]), "shapes"),
])
def test_wrong_curves_are_refused(arguments, sentence):
    for function in (softfall.hic, softfall.cfc):
        with pytest.raises(softfall.InputError, match=sentence):
            function(*arguments)


def test_wrong_classes_windows_and_units_are_refused():
    t, a = pulse()
    for channel_class in (100, 0, -60, float("nan")):
        with pytest.raises(softfall.InputError, match="60, 180, 600 and 1000"):
            softfall.cfc(t, a, channel_class)
    for window in (0, -1, float("nan")):
        with pytest.raises(softfall.InputError, match="window"):
            softfall.hic(t, a, window)
    with pytest.raises(softfall.InputError, match="unit m, neither g nor m s-2"):
        softfall.hic(t, curves.column(a, "m"))
    with pytest.raises(softfall.InputError, match="unit ms, not s"):
        softfall.hic(curves.column(t, "ms"), a)
    with pytest.raises(softfall.InputError, match="CFC 1000 cannot be applied"):
        softfall.cfc(t[::20], a[::20], 1000)


def test_doctests():
    tried = 0
    for module in pkgutil.iter_modules(softfall.__path__, "softfall."):
        outcome = doctest.testmod(importlib.import_module(module.name), optionflags=doctest.ELLIPSIS)
        assert outcome.failed == 0, module.name
        tried += outcome.attempted
    assert tried >= 10


def test_all_that_is_public_has_type_hints_and_a_docstring():
    count = 0
    for name in softfall.__all__:
        item = getattr(softfall, name)
        members = vars(item).items() if inspect.isclass(item) else [(name, item)]
        assert item.__doc__, name
        for key, member in members:
            code = member.fget if isinstance(member, property) else member
            if key.startswith("_") or not inspect.isfunction(code):
                continue
            hints = typing.get_type_hints(code)
            assert code.__doc__ and set(inspect.signature(code).parameters) - {"self"} | {"return"} <= set(hints), (name, key)
            count += 1
    assert count > 30
    assert (pathlib.Path(softfall.__file__).parent / "py.typed").exists()


def test_the_version_is_that_of_the_programs(place):
    assert program("solve", "--version", cwd=place).strip() == f"softfall-solve {softfall.version()}"
    assert json.loads((softfall.Case("pad/case.cfg").run().file("summary.json")).read_text())["program"].split()[-1] == softfall.version().split()[0]


# ---- folders ----

@pytest.mark.slow
def test_a_folder_that_moves_keeps_its_drop(case, tmp_path):
    first = case.run(output=tmp_path / "a")
    hic = first.figures["hic"]
    (tmp_path / "a").rename(tmp_path / "b")
    when = (tmp_path / "b/out/summary.json").stat().st_mtime_ns, (tmp_path / "b/results.h5").stat().st_mtime_ns
    assert case.run(output=tmp_path / "b").figures["hic"] == hic
    assert when == ((tmp_path / "b/out/summary.json").stat().st_mtime_ns, (tmp_path / "b/results.h5").stat().st_mtime_ns)
    (tmp_path / "b/out/summary.json").unlink()  # softfall-post was killed
    assert case.run(output=tmp_path / "b").figures["hic"] == hic
    with pytest.raises(softfall.InputError, match="already holds"):
        softfall.read_results(case.run().results, output=tmp_path / "b/out").post(tmp_path / "b/out")


def test_no_link_is_followed_and_no_pipe_waited_for(case, tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("mine")
    (tmp_path / "run").mkdir()
    (tmp_path / "run/lock").symlink_to(victim)
    with pytest.raises(softfall.Error, match="lock"):
        case.run(output=tmp_path / "run")
    (tmp_path / "plan.cfg").symlink_to(victim)
    with pytest.raises(softfall.InputError, match="is not replaced"):
        softfall.sweep({"case": str(case.path)}, output=tmp_path / "plan")
    os.mkfifo(tmp_path / "pipe.cfg")
    with pytest.raises(softfall.InputError, match="is not replaced"):
        softfall.sweep({"case": str(case.path)}, output=tmp_path / "pipe")
    (tmp_path / "soft").symlink_to(victim)
    output.write(tmp_path / "soft", "new")
    assert victim.read_text() == "mine" and (tmp_path / "soft").read_text() == "new" and not (tmp_path / "soft").is_symlink()
    with pytest.raises(softfall.InputError, match="would replace an input"):
        output.write(tmp_path / "soft", "new", victim, tmp_path / "../" / tmp_path.name / "soft")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["pipe.cfg", "plan.cfg", "run", "soft", "victim"]


def test_folders_of_killed_processes_go(tmp_path):
    child = subprocess.run([sys.executable, "-c", "import os, sys; from softfall import output; from pathlib import Path; place = Path(sys.argv[1]); "
                            "made = output.Scratch(place); (place / f'x.partial-{os.getpid()}-01234567').touch(); os.kill(os.getpid(), 9)", str(tmp_path)])
    assert child.returncode == -9 and len(list(tmp_path.iterdir())) == 2
    with output.scratch(tmp_path) as folder:
        output.write(tmp_path / "x", "whole")
        assert sorted(path.name for path in tmp_path.iterdir()) == [folder.name, "x"]
    assert [path.name for path in tmp_path.iterdir()] == ["x"]


# ---- series ----

def test_a_series_has_all_its_drops(tmp_path):
    """Each later drop is harder, a series that is there is not run again, and one that lacks a drop is."""
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"])
    coarse = {"geometry.parameters.fine_spacing": 20, "geometry.parameters.outer_spacing": 20, "geometry.missile_parameters.element_size": 20,
              "pad.mesh_error_limit": 1, "series.drops": 3}
    case = softfall.Case(source / "examples/series/case.cfg", coarse)
    drops = case.run(output=tmp_path / "run").series
    a = [drop.figures["a_max_g"] for drop in drops]
    assert len(a) == 3 and a[0] < a[1] < a[2]
    last = drops[2].results
    before = last.stat().st_mtime_ns
    case.run(output=tmp_path / "run")
    assert last.stat().st_mtime_ns == before
    last.unlink()
    again = case.run(output=tmp_path / "run").series
    assert [drop.figures["a_max_g"] for drop in again] == a
    case.update({"missile.velocity": "3 m/s", "series.drops": 2})
    other = case.run(output=tmp_path / "other")
    shutil.copy(drops[1].results, other.series[1].results)
    with pytest.raises(softfall.Error, match="is of another run"):
        other.series


@pytest.mark.slow
def test_a_listed_series_has_the_models_of_its_drops(tmp_path):
    """Drops of their own speed have models of their own beside the first, and a series that is there is not run again."""
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"])
    coarse = {"geometry.parameters.fine_spacing": 20, "geometry.parameters.outer_spacing": 20, "geometry.missile_parameters.element_size": 20,
              "pad.mesh_error_limit": 1, "series.drops": '( { }, { velocity = "3 m/s"; } )'}
    case = softfall.Case(source / "examples/series/case.cfg", coarse)
    drops = case.run(output=tmp_path / "run").series
    assert [drop.figures["v0_m_s"] for drop in drops] == [4.5, 3] and (tmp_path / "run/model-2.h5").exists()
    before = drops[1].results.stat().st_mtime_ns
    case.run(output=tmp_path / "run")
    assert drops[1].results.stat().st_mtime_ns == before


@pytest.mark.slow
def test_a_series_that_was_stopped_in_a_later_drop_is_resumed_there(tmp_path):
    """The drops before it stay as they are, and all are those of a series without a stop."""
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"])
    coarse = {"geometry.parameters.fine_spacing": 16, "geometry.parameters.outer_spacing": 20, "geometry.missile_parameters.element_size": 20,
              "pad.mesh_error_limit": 1, "series.drops": 2, "missile.velocity": "3 m/s"}
    case = softfall.Case(source / "examples/series/case.cfg", coarse)

    class Stop(Exception):
        pass

    def stop(step):
        if (tmp_path / "run/results-2.h5").exists() and step.time > 2e-3:
            raise Stop

    with pytest.raises(Stop):
        case.run(output=tmp_path / "run", on_step=stop)
    first = (tmp_path / "run/results.h5").stat().st_mtime_ns
    drops = case.run(output=tmp_path / "run").series
    assert (tmp_path / "run/results.h5").stat().st_mtime_ns == first
    assert sorted(path.name for path in (tmp_path / "run").glob("results*.h5")) == ["results-2.h5", "results.h5"]
    whole = case.run(output=tmp_path / "whole").series
    assert [drop.figures["a_max_g"] for drop in drops] == [drop.figures["a_max_g"] for drop in whole]
