# SPDX-License-Identifier: GPL-3.0-or-later
"""Sweeps, fits and functions."""
import csv
import json
import os
import pathlib

import numpy as np
import pytest
import scipy.optimize

import softfall
from softfall import study
from conftest import program

SPEEDS = {"case": "pad/case.cfg", "factors": [{"key": "missile.velocity", "name": "speed", "values": ["4 m/s", "4.5 m/s"]}],
          "figures": [{"key": "hic", "limit": 800.0}]}


def test_a_sweep_is_a_table_of_the_program_to_the_last_digit(drop):
    table = softfall.sweep(SPEEDS, output="speeds", jobs=2)
    assert list(table["speed (m/s)"]) == [4, 4.5] and list(table["run_status"]) == ["done", "done"]
    assert table["hic"][1] == drop.figures["hic"] and table["a_max_g"][1] == drop.figures["a_max_g"]
    again = softfall.sweep("speeds.cfg", output="speeds")  # nothing is computed again
    assert list(again["wall_s"]) == list(table["wall_s"])
    plain = study.Table(pathlib.Path("speeds/runs.csv"))
    assert list(plain.columns) == list(table.columns) and len(plain) == len(table) == 2 and list(plain) == plain.columns
    assert plain["hic"].tolist() == list(table["hic"]) and plain["grade"].tolist() == list(table["grade"])
    with pytest.raises(KeyError, match='no column "hicc"'):
        plain["hicc"]


def test_without_pandas_a_sweep_is_a_plain_table(monkeypatch, drop):
    softfall.sweep(SPEEDS, output="speeds")
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    assert isinstance(softfall.sweep(SPEEDS, output="speeds"), softfall.Table)


def test_wrong_plans_are_refused(tmp_path):
    with pytest.raises(softfall.InputError, match="^the file nowhere.cfg cannot be read"):
        softfall.sweep("nowhere.cfg")
    with pytest.raises(softfall.InputError, match="a dict needs output"):
        softfall.sweep(SPEEDS)
    with pytest.raises(softfall.InputError, match="factors is missing"):
        softfall.sweep({"case": "pad/case.cfg"}, output="nothing")
    with pytest.raises(softfall.InputError, match='"hicc"'):
        softfall.sweep({**SPEEDS, "figures": [{"key": "hicc"}]}, output="nothing")
    with pytest.raises(softfall.InputError, match="unrecognized arguments: --joobs=2"):
        softfall.sweep(SPEEDS, output="nothing", joobs=2)
    with pytest.raises(softfall.InputError, match="give --jobs"):
        softfall.sweep(SPEEDS, output="nothing", threads=2)
    with pytest.raises(TypeError, match="a value is a text"):
        softfall.sweep({**SPEEDS, "title": None}, output="nothing")
    pathlib.Path("mine.cfg").write_text("title = 1;\n")
    with pytest.raises(softfall.InputError, match="mine.cfg is not replaced"):
        softfall.sweep(SPEEDS, output="mine")
    assert pathlib.Path("mine.cfg").read_text() == "title = 1;\n"


def test_a_fit_is_that_of_the_program(case, tmp_path):
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"]) / "examples/fit/compression"
    tests = [{"file": str(source / f"{name}.csv"), "rate": rate} for name, rate in (("slow", "0.1 1/min"), ("fast", "10 1/min"))]
    words = {"name": "foam", "density": "35 kg/m3", "specimen": {"side": "50 mm", "thickness": "50 mm"}, "tests": tests}
    fit = softfall.fit_compression(words, output=tmp_path / "foam")
    program("fit", "compression", tmp_path / "foam.cfg", "-o", tmp_path / "theirs", cwd=".")
    theirs = json.loads((tmp_path / "theirs/fit.json").read_text())
    assert fit.parameters == theirs["parameters"] and fit.parameters["HU"]["value"] > 0 and len(fit.points) > 10
    case["material"] = fit.material
    assert case["material.E"].endswith("MPa") and fit.report().exists()
    with pytest.raises(softfall.InputError, match="already holds"):
        softfall.fit_compression(words, output=tmp_path / "foam")
    softfall.fit_compression(words, output=tmp_path / "foam", force=True)
    with pytest.raises(softfall.InputError, match="density: .*35 m"):
        softfall.fit_compression({**words, "density": "35 m"}, output=tmp_path / "foam", force=True)


def test_a_function_is_the_figure_of_the_drop(case, drop):
    f = softfall.function(case, ["missile.velocity [m/s]"], "hic")
    assert f(4.5) == f([4.5]) == drop.figures["hic"] and isinstance(f(4.5), float)
    g = softfall.function(case, {"missile.velocity": "m/s", "geometry.parameters.thickness": ""}, ["a_max_g", "hic"])
    both = g([[4.5, 50], [4.0, 50]])
    assert both.shape == (2, 2) and both[0].tolist() == [drop.figures["a_max_g"], drop.figures["hic"]] and both[1, 1] < both[0, 1]
    assert g.drop([4.5, 50]).results == g.drop([4.5, 50]).results


@pytest.mark.slow
def test_scipy_finds_the_speed_of_a_limit(case):
    f = softfall.function(case, "missile.velocity [m/s]", "hic")
    speed = scipy.optimize.brentq(lambda v: f(v) - 200, 3.5, 4.5, xtol=1e-3)
    assert 3.5 < speed < 4.5 and f(speed) == pytest.approx(200, rel=2e-3)
    g = softfall.function(case, ["missile.velocity [m/s]", "geometry.parameters.thickness"], ["a_max_g", "hic"])
    slope = scipy.optimize.approx_fprime([4.0, 50.0], lambda x: g(x)[0], [1e-3, 1e-2])
    assert slope[0] > 0 > slope[1]  # faster is harder, thicker is softer


@pytest.mark.parametrize("x, sentence", [
    ([4.5, 50], "1 numbers are expected"), ([], "1 numbers are expected"), (float("nan"), "not all of it is finite"), (-3, "out of bounds"),
])
def test_a_wrong_point_is_refused(case, x, sentence):
    with pytest.raises(softfall.InputError, match=sentence):
        softfall.function(case, ["missile.velocity [m/s]"], "hic")(x)


def test_wrong_functions_are_refused(case):
    with pytest.raises(KeyError, match='did you mean "missile.velocity"'):
        softfall.function(case, ["missile.velocit [m/s]"], "hic")
    with pytest.raises(softfall.InputError, match="is no input such as"):
        softfall.function(case, ["missile.velocity [m/s"], "hic")
    with pytest.raises(softfall.InputError, match="one output at least"):
        softfall.function(case, ["missile.velocity [m/s]"], [])
    with pytest.raises(softfall.InputError, match='neither "raise" nor "nan"'):
        softfall.function(case, ["missile.velocity [m/s]"], "hic", unusable="zero")
    with pytest.raises(softfall.InputError, match='has a unit of another kind: write "missile.velocity'):
        softfall.function(case, ["missile.velocity [kg]"], "hic")
    with pytest.raises(KeyError, match='no figure with a number "hicc"'):
        softfall.function(case, ["missile.velocity [m/s]"], "hicc")(4.5)


def test_a_drop_that_is_not_to_be_used_raises_or_is_nan(case):
    with pytest.raises(softfall.NumericError, match="anvil"):
        softfall.function(case, ["missile.velocity [m/s]"], "hic")(30)
    assert np.isnan(softfall.function(case, ["missile.velocity [m/s]"], "hic", unusable="nan")(30))
    with pytest.raises(softfall.Error, match="does not define peak_force_N"):
        softfall.function(case, ["missile.velocity [m/s]"], "peak_force_N")(4.5)


def test_a_series_is_judged_by_the_drops_that_count(tmp_path):
    """A sweep takes all drops of a series; what has the figures of one drop refuses it, and does not take the first."""
    source = pathlib.Path(os.environ["SF_SOURCE_DIR"]) / "examples/series/case.cfg"
    plan = {"case": str(source), "factors": [{"key": "missile.velocity", "values": ["3 m/s"]}], "figures": [{"key": "a_max_g"}],
            "set": ["geometry.parameters.fine_spacing=20.0", "geometry.parameters.outer_spacing=40.0", "pad.mesh_error_limit=9.0"]}
    row = softfall.sweep(plan, output=tmp_path / "sweep")
    with open(tmp_path / "sweep/drops.csv", encoding="utf-8", newline="") as file:
        first, second, third = (float(drop["a_max_g"]) for drop in csv.DictReader(file))
    assert first < min(second, third)
    assert float(row["a_max_g"][0]) == pytest.approx((second + third) / 2, rel=1e-8)
    series = softfall.Case(source)
    with pytest.raises(softfall.InputError, match="a function has the figures of a single drop"):
        softfall.function(series, ["missile.velocity [m/s]"], "hic")(3)
    with pytest.raises(softfall.InputError, match="a refinement has the figures of a single drop"):
        softfall.refine(series)
    program("new", tmp_path / "pad", "--from", "series", cwd=tmp_path)
    assert softfall.Case(tmp_path / "pad/case.cfg")["series.drops"] == 3
