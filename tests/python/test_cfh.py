# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall cfh: the search on closed forms and on drops, kills, draws of the foam, bad input."""
from __future__ import annotations

import contextlib
import csv
import json
import math
import os
import re
import signal
import sqlite3
import subprocess
import time
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import softfall
from conftest import command_here
from softfall import cfh, cfh_draws, memory
from softfall.cfh import Point, Search

BIN, EXAMPLES = Path(os.environ["SF_BIN_DIR"]), Path(__file__).resolve().parents[2] / "examples"
CASE = EXAMPLES / "eva50-axisymmetric/case.cfg"
COARSE = {"geometry.parameters.fine_spacing": "25.0", "geometry.parameters.outer_spacing": "40.0", "pad.mesh_error_limit": "9.0"}
SET = [f"--set={key}={value}" for key, value in COARSE.items()]
LIMITS = (200.0, 1000.0)


def run(*words: object, code: int = 0) -> str:
    ended = command_here("cfh", *words)
    assert ended.returncode == code, ended.stdout + ended.stderr
    return str(ended.stdout if code == 0 else ended.stderr)


def summary(folder: Path) -> dict[str, Any]:
    return dict(json.loads((folder / "cfh.json").read_text()))


def law(a: float, p: float, b: float, q: float) -> Callable[[float], Point]:
    """A pad whose figures are powers of the height."""
    return lambda h: Point(h, (a * h**p, b * h**q))


def drive(search: Search, drop: Callable[[float], Point]) -> tuple[list[Point], str, int]:
    """Runs a search on closed forms."""
    way, rounds = search.steps(), 0
    heights = next(way)
    while True:
        rounds += 1
        assert 1 <= len(heights) <= max(search.at_once, len(search.heights))
        try:
            heights = way.send([drop(h) for h in heights])
        except StopIteration as end:
            return *end.value, rounds


# ---- the search on closed forms

@pytest.mark.parametrize("at_once", [1, 2])
def test_a_search_finds_the_height_of_a_closed_form(at_once: int) -> None:
    random = np.random.default_rng(7)
    for _ in range(300):
        p, q = random.uniform(0.7, 2), random.uniform(1.5, 4)
        first, second = np.exp(random.uniform(math.log(0.05), math.log(8), 2))
        search = Search(LIMITS, float(np.exp(random.uniform(math.log(0.02), math.log(9)))), 10.0, 0.005, at_once=at_once)
        points, ending, _ = drive(search, law(200 / first**p, p, 1000 / second**q, q))
        result = cfh.evaluate(points, LIMITS)
        assert (ending, result.verdict) == ("enough", "found") and len(points) <= 20
        assert result.height == pytest.approx(min(first, second), rel=1e-4)
        one = result.crossings[result.deciding]
        assert one.below < min(first, second) * (1 + 1e-9) and one.above > min(first, second) * (1 - 1e-9) and one.above / one.below < 1.0051
        assert result.deciding == (0 if first < second else 1)


def test_a_foam_that_locks_up_is_held_between_two_drops() -> None:
    def drop(h: float) -> Point:
        return Point(h, (80 * h * math.exp(60 * max(0.0, math.log(h / 1.4))), 100 * h))
    points, ending, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), drop)
    result = cfh.evaluate(points, LIMITS)
    true = math.exp((math.log(2.5) + 60 * math.log(1.4)) / 61)
    one = result.crossings[0]
    assert ending == "enough" and one.below <= true <= one.above <= 1.0051 * one.below and result.height == pytest.approx(true, rel=2e-3)


def test_drops_without_figures_bound_the_height() -> None:
    nothing = (math.nan, math.nan)

    def stops(at: float, **what: Any) -> Callable[[float], Point]:
        return lambda h: Point(h, (50 * h, 100 * h)) if h < at else Point(h, nothing, **what)
    points, ending, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), stops(1.7, on_anvil=True))  # it reaches the anvil
    result = cfh.evaluate(points, LIMITS)
    assert (ending, result.verdict) == ("collapsed", "above the highest point") and result.exceeding is not None
    assert 1.66 < result.highest < 1.7 <= result.exceeding.height < 1.74
    points, ending, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), stops(1.7))  # it tells nothing: no bound from above
    result = cfh.evaluate(points, LIMITS)
    assert (ending, result.verdict, result.exceeding) == ("collapsed", "above the highest point", None)
    points, _, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), stops(1.7, least=(150.0, 900.0)))  # its figures do not pass the limit
    assert cfh.evaluate(points, LIMITS).exceeding is None
    points, _, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), stops(1.7, least=(150.0, 1100.0)))
    assert cfh.evaluate(points, LIMITS).exceeding is not None
    points, ending, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), lambda h: Point(h, nothing, note="why"))
    result = cfh.evaluate(points, LIMITS)
    assert (ending, result.verdict, result.problem) == ("collapsed", "not determined", "no drop can be used: why") and math.isnan(result.height)


def test_ends_of_the_range_and_figures_that_fall() -> None:
    points, ending, _ = drive(Search(LIMITS, 1.0, 3.0, 0.005), law(20, 1, 20, 1))
    assert ending == "max" and cfh.evaluate(points, LIMITS).verdict == "above the highest point" and points[-1].height == 3
    points, ending, _ = drive(Search((0.1, 1000), 1.0, 3.0, 0.005), law(200, 1, 20, 1))
    assert ending == "min" and cfh.evaluate(points, (0.1, 1000)).verdict == "below the lowest point"
    result = cfh.evaluate([Point(h, (a, 1.0)) for h, a in ((1, 100), (1.5, 180), (2, 150), (3, 250))], LIMITS)
    assert result.verdict == "not determined" and "a_max falls from 180 at 1.5 m to 150 at 2 m" in result.problem
    nothing = (math.nan, math.nan)
    points, _, _ = drive(Search(LIMITS, 1.0, 10.0, 0.005), lambda h: Point(h, nothing if 1.9 < h < 2.1 else (100 * h, 1.0)))
    assert cfh.evaluate(points, LIMITS).verdict == "above the highest point" and points[-1].height > 1.9  # it stays below a drop that tells nothing
    gap = [Point(h, nothing if 1.9 < h < 2.1 else (100 * h, 1.0)) for h in (1.0, 1.8, 1.95, 2.05, 2.2)]
    assert cfh.evaluate(gap, LIMITS).crossings[0][1:] == pytest.approx((2, 1.8, 2.2), rel=1e-6)  # of a list: read across the gap, which is stated


# ---- drops

@pytest.mark.drawn
def test_the_height_is_that_whose_own_drop_reaches_the_limit(tmp_path: Path) -> None:
    said = run(CASE, "-o", tmp_path / "out", *SET, "-j", 2)
    made = summary(tmp_path / "out")
    found = made["critical_fall_height"]
    assert found["verdict"] == "found" and f"Critical fall height {found['height_m']:.3f} m" in said and "uncertainty of the foam is not included" in said
    drop = softfall.Case(CASE, {**COARSE, "missile.velocity": f"{found['speed_m_s']:.9g} m/s"}).run(output=tmp_path / "drop")
    ratios = {"a_max": drop.figures["a_max_g"] / 200, "HIC": drop.figures["hic"] / 1000}
    assert ratios[found["deciding"]] == pytest.approx(1, abs=2e-3) and max(ratios.values()) == ratios[found["deciding"]]
    one = next(one for one in made["criteria"] if one["criterion"] == found["deciding"])
    assert one["below_m"] <= found["height_m"] <= one["above_m"] <= 1.0051 * one["below_m"]
    page = (tmp_path / "out/report.html").read_text()
    assert f"Critical fall height {found['height_m']:.3f} m" in page and "cfh.html" not in page and (tmp_path / "out/cfh.png").stat().st_size > 10000
    with open(tmp_path / "out/cfh.csv", newline="") as stream:
        assert [float(row["hic_1"]) for row in csv.DictReader(stream)] == [point["hic"] for point in made["points"]]
    assert "already holds report.html" in run(CASE, "-o", tmp_path / "out", *SET, code=2)
    again = run(CASE, "-o", tmp_path / "out", *SET, "--force")
    assert "0 drops simulated" in again and summary(tmp_path / "out")["points"] == made["points"]
    assert (tmp_path / "out/report.html").read_text() == page  # of the same figures
    lower = run(CASE, "-o", tmp_path / "out", *SET, "--force", "--limit-hic", 500)  # drops that are there serve another limit
    assert summary(tmp_path / "out")["critical_fall_height"]["height_m"] < found["height_m"] and "HIC = 500" in (tmp_path / "out/report.html").read_text() and int(re.search(r"(\d+) were there", lower)[1]) >= 2  # type: ignore[index]
    rig = tmp_path / "rig.csv"
    rig.write_text("height_m,speed_m_s\n1,4\n2,5.6568542\n")  # g_eff = 8 m/s2
    run(CASE, "-o", tmp_path / "rig", *SET, "--rig", rig)
    on_rig = summary(tmp_path / "rig")
    assert on_rig["rig"]["g_eff_m_s2"] == pytest.approx(8) and on_rig["critical_fall_height"]["rig_height_m"] == pytest.approx(found["height_m"] * 9.80665 / 8, rel=1e-3)


@pytest.mark.slow
def test_the_earlier_name_is_the_command(tmp_path: Path) -> None:
    """softfall-cfh has the options, the files and the exit codes of `softfall cfh`."""
    ended = subprocess.run([BIN / "softfall-cfh", CASE, "-o", tmp_path, *SET, "--heights", "0.5 m,1 m"], capture_output=True, text=True)
    assert ended.returncode == 0 and "2 drops simulated" in ended.stdout, ended.stderr
    assert [point["height_m"] for point in summary(tmp_path)["points"]] == [0.5, 1]
    assert subprocess.run([BIN / "softfall-cfh", CASE, "--nonsense"], capture_output=True).returncode == 64


@pytest.mark.slow
def test_a_series_is_judged_by_the_drops_that_count(tmp_path: Path) -> None:
    """The mean of drops 2 and 3 from the height has the limit, the first drop is softer; a draw of a foam without memory has no place."""
    series, coarse = EXAMPLES / "series/case.cfg", ["--set=geometry.parameters.fine_spacing=25.0", "--set=geometry.parameters.outer_spacing=40.0", "--set=pad.mesh_error_limit=9.0"]
    said = run(series, "-o", tmp_path / "out", *coarse, "--limit-g", 150, "--limit-hic", 1e6, "--height", "1.3 m", "-j", 2)
    made = summary(tmp_path / "out")
    assert "of free fall, by the mean of drops 2, 3 of 3: a_max reaches 150 g first" in said and made["judged_by"] == "the mean of drops 2, 3 of 3"
    with memory.Inputs(str(series), [text.removeprefix("--set=") for text in coarse] + [f"missile.velocity={made['critical_fall_height']['speed_m_s']} m/s"]) as inputs:
        drops = [drop.figures["a_max_g"] for drop in inputs.run(str(tmp_path / "shared")).drops]
    assert np.mean(drops[1:]) == pytest.approx(150, rel=5e-3) and drops[0] < 0.97 * 150
    for words, sentence in ((["--posterior", "."], "--posterior is for first drops"), (["--set", 'series.drops=( { }, { mass = "3 kg"; } )'], "a drop has keys of its own"),
                            (["--set", "material.memory={ reload = 0.0; }"], "the foam has no material.memory")):
        assert sentence in run(series, "-o", tmp_path / "none", *coarse, *words, code=2)


@pytest.mark.slow
def test_a_pad_of_layers_has_a_height_and_no_place_for_one_material(tmp_path: Path) -> None:
    layers = EXAMPLES / "layers/case.cfg"
    words = [f"--set=geometry.parameters.{key}" for key in ("fine_spacing=20.0", "outer_spacing=20.0", "side=160.0", "zone_side=160.0", "upper=40.0", "cover=20.0")]
    run(layers, "-o", tmp_path / "out", *words, "--set=pad.mesh_error_limit=1", "--heights", "0.2 m,0.4 m", "-j", 2)
    assert len(summary(tmp_path / "out")["points"]) == 2
    refused = run(layers, "-o", tmp_path / "no", *words, "--material", EXAMPLES / "layers/hard_foam.cfg", code=2)
    assert "no place for one material" in refused and "--set materials.NAME=@FILE" in refused
    assert "the pad" in run(layers, "-o", tmp_path / "no", *words, "--posterior", EXAMPLES / "materials/eva35_posterior", code=2)


def test_no_input_and_no_file_of_somebody_else_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "cfh.csv").write_text("height_m,speed_m_s\n1,4\n2,5.6568542\n")
    assert "would replace an input" in run(CASE, "-o", tmp_path, *SET, "--rig", tmp_path / "cfh.csv", "--force", code=2)
    for name, make, sentence in (("page", lambda at: (at / "report.html").write_text("mine"), "is not of softfall, and is not replaced"),
                                 ("folder", lambda at: (at / "cfh.png").mkdir(), "it is a folder")):
        (tmp_path / name).mkdir()
        make(tmp_path / name)
        assert sentence in run(CASE, "-o", tmp_path / name, *SET, "--force", code=2)
    (tmp_path / "file").write_text("mine")
    assert "is not a folder" in run(CASE, "-o", tmp_path / "file", *SET, "--force", code=2)
    assert (tmp_path / "file").read_text() == (tmp_path / "page/report.html").read_text() == "mine" and not (tmp_path / "page/drops.sqlite").exists()


def test_hostile_files_are_refused_in_a_sentence(tmp_path: Path) -> None:
    (tmp_path / "noise").write_bytes(bytes(range(256)) * 40)
    os.mkfifo(tmp_path / "pipe")
    for name in ("noise", "pipe", "."):
        hostile = tmp_path / name
        for words in ([hostile], [CASE, *SET, "--material", hostile], [CASE, *SET, "--rig", hostile], [CASE, *SET, f"--set=material.curve={hostile}"]):
            ended = command_here("cfh", *words, "-o", tmp_path / "out")
            assert ended.returncode in (2, 3) and ended.stderr.count("\n") == 1 and "Traceback" not in ended.stderr, (words, ended.stderr)


def test_heights_of_a_list_and_a_pad_without_a_height(tmp_path: Path) -> None:
    run(CASE, "-o", tmp_path, *SET, "--heights", "0.5 m, 1 m,150 cm", "--limit-hic", 300)
    made = summary(tmp_path)
    assert [point["height_m"] for point in made["points"]] == [0.5, 1, 1.5] and made["critical_fall_height"]["search_ended"].startswith("every height of the list")
    assert "m: the height there is interpolated" in (tmp_path / "report.html").read_text()
    run(CASE, "-o", tmp_path, *SET, "--force", "--max-height", "50 cm")
    found = summary(tmp_path)["critical_fall_height"]
    assert (found["verdict"], found["height_m"], found["highest_simulated_m"]) == ("above the highest point", None, 0.5)
    assert found["answer"].startswith("Critical fall height above 0.500 m")


@pytest.mark.slow
def test_a_search_that_was_killed_goes_on(tmp_path: Path) -> None:
    words = [str(BIN / "softfall"), "cfh", str(CASE), "-o", str(tmp_path / "out"), *SET, "-j", "2"]
    run(CASE, "-o", tmp_path / "whole", *SET, "-j", 1)
    kills = 0
    for least in (1, 3):
        process = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True)
        while process.poll() is None and _done(tmp_path / "out") < least:
            time.sleep(0.02)
        kills += process.poll() is None
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    before = _done(tmp_path / "out")
    said = run(CASE, "-o", tmp_path / "out", *SET, *(["--force"] if (tmp_path / "out/cfh.json").exists() else []))
    assert kills and before >= 1 and f"{before} were there" in said
    ours, whole = summary(tmp_path / "out"), summary(tmp_path / "whole")
    assert ours["points"] == whole["points"] and ours["critical_fall_height"] == whole["critical_fall_height"]


@pytest.mark.slow
def test_two_commands_in_one_folder_share_their_drops(tmp_path: Path) -> None:
    words = [str(BIN / "softfall"), "cfh", str(CASE), "-o", str(tmp_path), *SET, "--force", "-j", "1"]
    both = [subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) for _ in range(2)]
    said = [process.communicate() for process in both]
    assert [process.returncode for process in both] == [0, 0], said
    simulated = [int(re.search(r"(\d+) drops simulated", out)[1]) for out, _ in said]  # type: ignore[index]
    assert sum(simulated) == _done(tmp_path) == len(summary(tmp_path)["points"])


def _done(folder: Path) -> int:
    if not (folder / "drops.sqlite").exists():
        return 0
    with contextlib.closing(sqlite3.connect(folder / "drops.sqlite", timeout=60)) as data:
        if not data.execute("SELECT name FROM sqlite_master WHERE name = 'drops'").fetchone():
            return 0
        return int(data.execute("SELECT count(*) FROM drops WHERE state = 'done'").fetchone()[0])


# ---- draws of the foam

def posterior(folder: Path, scales: np.ndarray[Any, Any], more: str = "") -> Path:
    """Writes 100 draws: eva35 with its stresses scaled."""
    folder.mkdir(parents=True)
    text = (EXAMPLES / "materials/eva35.cfg").read_text()
    lines = (EXAMPLES / "materials/eva35.csv").read_text().splitlines()
    begin = next(k for k, line in enumerate(lines) if line.startswith("strain")) + 1
    for k, scale in enumerate(scales, 1):
        rows = [line.split(",") for line in lines[begin:]]
        (folder / f"draw-{k:03d}.csv").write_text("\n".join([*lines[:begin], *(f"{strain},{float(stress) * scale:.9g}" for strain, stress in rows)]) + "\n")
        (folder / f"draw-{k:03d}.cfg").write_text(f"# Draw {k} of 100\n" + re.sub(r'curve *= *"[^"]*"', f'curve = "draw-{k:03d}.csv"', text) + more)
    return folder


def test_the_headline_is_the_safe_quantile_of_the_draws(tmp_path: Path) -> None:
    scales = np.repeat([0.9, 0.95, 1.0, 1.05, 1.1], 20)
    folder = posterior(tmp_path / "fit/draws", scales)
    (tmp_path / "fit/posterior.csv").write_text("draw_1,model\n" + "".join(f"{k},{'low' if k <= 20 else 'high'}\n" for k in range(1, 101)))
    said = run(CASE, "-o", tmp_path / "out", *SET, "--posterior", folder, "-j", 2)
    made = summary(tmp_path / "out")
    found, spread = made["critical_fall_height"], made["posterior"]
    with open(tmp_path / "out/cfh_draws.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    heights = np.array([float(row["height_m"]) for row in rows]).reshape(5, 20)
    assert (heights == heights[:, :1]).all() and len(set(heights[:, 0])) == 5  # equal foams have equal heights
    own = softfall.Case(CASE, {**COARSE, "material": f"@{folder}/draw-001.cfg", "missile.velocity": f"{cfh.speed_of(heights[0, 0]):.9g} m/s"}).run(output=tmp_path / "one")
    assert max(own.figures["a_max_g"] / 200, own.figures["hic"] / 1000) == pytest.approx(1, abs=5e-3)
    for share, key in ((0.025, "foam_low_m"), (0.975, "foam_high_m")):
        assert spread[key] == pytest.approx(np.quantile(heights, share), rel=1e-6)
    assert found["at_least_m"] <= np.quantile(heights, 0.05) and found["height_low_m"] <= found["at_least_m"] < found["height_median_m"] < found["height_high_m"]
    least = math.floor(100 * found["at_least_m"]) / 100
    assert f"At least {least:.2f} m of free fall (95 %)" in said.splitlines()[said.splitlines().index(found["answer"])] and found["answer"] in (tmp_path / "out/report.html").read_text().replace("&lt;", "<")
    assert spread["included"] == ["the curve"] and "the pole" in spread["same_in_all_draws"] and not spread["response_errors"]
    low = "low" if heights[0, 0] < heights[4, 0] else "high"
    assert spread["lowest_forms"].startswith(f"{low} (")
    assert "0 drops simulated" in run(CASE, "-o", tmp_path / "out", *SET, "--posterior", folder, "--force")


def _spread(response: tuple[float, ...] | None, mesh: float, quantile: float = 0.05) -> cfh_draws.Spread:
    scale = np.linspace(0.8, 1.25, 200)
    points = [[law(100 * a, 1.0, 1.0, 1.0)(h) for h in (1.0, 1.98 / a, 2.02 / a)] for a in scale]
    draws = [cfh_draws.Draw("", {}, response, "") for _ in scale]
    return cfh_draws.spread(draws, [(sorted(one, key=lambda p: p.height), "enough") for one in points], (200.0, 1e9), mesh, (math.nan, math.nan), (8.0, 0.0, 2), quantile)


def test_errors_move_and_widen_the_heights_as_their_closed_form_does() -> None:
    """a_max = 100 a h: the height is 2 / a, an error x of ln(a_max) makes it 2 / a e^-x."""
    true = 2 / np.linspace(0.8, 1.25, 200)
    assert _spread(None, 0.0).parts["foam"].at_least == pytest.approx(np.quantile(true, 0.05, method="lower"), rel=1e-6)
    shifted = _spread((0.05, 0.0, 0.0, 0.0), 0.0)
    assert shifted.parts["foam_response_mesh"].median == pytest.approx(np.quantile(true, 0.5, method="lower") * math.exp(-0.05), rel=1e-6)
    wide = _spread(None, 0.1)
    errors = cfh_draws.MESH_SIZE * 0.1 * np.random.default_rng(3).standard_normal((4000, 1))
    assert wide.parts["foam_response_mesh"].at_least == pytest.approx(np.quantile(true * np.exp(-errors), 0.05), rel=0.01)
    assert wide.parts["foam"].at_least > wide.parts["foam_response_mesh"].at_least
    assert wide.rig and wide.rig.at_least == pytest.approx(wide.parts["foam_response_mesh"].at_least * 9.80665 / 8, rel=1e-9)


def test_draws_without_a_height_are_on_the_safe_side() -> None:
    good = [[law(100, 1.0, 1.0, 1.0)(h) for h in (1.9, 2.1)] for _ in range(100)]
    draws = [cfh_draws.Draw("", {}, None, "") for _ in good]

    def least(bad: list[Point], count: int, ending: str = "collapsed") -> cfh_draws.Spread:
        return cfh_draws.spread(draws, [(bad, ending)] * count + [(one, "enough") for one in good[count:]], (200.0, 1e9), 0.0, (math.nan, math.nan), (8.0, 0.0, 0), 0.05)
    nothing = Point(2.0, (math.nan, math.nan))
    assert least([nothing], 10).parts["foam"].at_least == 0 and least([nothing], 10).unknown == 10  # no height can be promised
    assert least([nothing], 3).parts["foam"].at_least == pytest.approx(2, rel=1e-3)
    bounded = least([law(100, 1.0, 1.0, 1.0)(1.5), nothing._replace(on_anvil=True)], 10)
    assert bounded.parts["foam"].at_least == 1.5 and bounded.bounded == 10
    silent = least([law(100, 1.0, 1.0, 1.0)(1.5), nothing], 60)  # the drop above tells nothing: that is no height without a limit
    assert silent.parts["foam"].high == pytest.approx(2, rel=1e-3) and silent.parts["foam"].median == 1.5 and silent.bounded == 60
    free = least([law(100, 1.0, 1.0, 1.0)(1.5)], 60, "max")  # no limit is reached up to the greatest height
    assert math.isinf(free.parts["foam"].median) and free.bounded == 0


# ---- bad input

@pytest.mark.parametrize("words, sentence", [
    (["--limit-g", "-3"], "--limit-g -3 is outside of 0"), (["--limit-hic", "nan"], "--limit-hic nan is outside of 0"), (["--height", "3"], '--height: "3" has no unit'),
    (["--height", "3 kg"], '"3 kg" is no length'), (["--height", "1 mm"], "outside of 1 cm to 100 m"), (["--height", "3 m", "--max-height", "2 m"], "raise --max-height"),
    (["--heights", "1 m"], "1 heights; 2 to 16"), (["--heights", "1 m,100 cm"], "1 m is given twice"), (["--heights", "1 m,2 m", "--height", "1 m"], "--height does not go with it"),
    (["--set", "missile.velocity=3 m/s"], "the drop height decides the speed"), (["--set", "missile.direction=[1, 0, -1]"], "missile.direction is not [0, 0, -1]"),
    (["--set", "pad.nonsense=1"], "nonsense"), (["--tolerance", "0"], "--tolerance 0 is outside"), (["--quantile", "0.9"], "--quantile 0.9 is outside"),
    (["--jobs", "0"], "--jobs 0 is outside"), (["--posterior", "nowhere"], "there is no draw-001.cfg"), (["--rig", "fast.csv"], "is faster than free fall"),
    (["--rig", "nowhere.csv"], "nowhere.csv"), (["--material", "nowhere.cfg"], "nowhere.cfg")])
def test_bad_input_is_one_sentence(words: list[str], sentence: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("fast.csv").write_text("height_m,speed_m_s\n1,4\n2,9\n")
    said = run(CASE, "-o", "out", *SET, *words, code=2)
    assert sentence in said and said.startswith("softfall cfh: ") and said.count("\n") == 1
    assert not Path("out/cfh.json").exists()


def test_draws_that_are_wrong_are_refused(tmp_path: Path) -> None:
    case = softfall.Case(CASE)

    def refuse(name: str, sentence: str, scales: Any = np.linspace(0.9, 1.1, 100), more: str = "", sets: dict[str, str] | None = None, change: Callable[[Path], Any] = str) -> None:
        folder = posterior(tmp_path / name, np.asarray(scales), more)
        change(folder)
        with pytest.raises(softfall.InputError, match=re.escape(sentence)):
            cfh_draws.read(folder, case, sets or {})
    refuse("few", "99 draws; an interval needs 100 to 2000", np.linspace(0.9, 1.1, 99))
    refuse("same", "all 100 draws are the same material", np.ones(100), change=lambda folder: None)
    refuse("gap", "draw-006.cfg is there, but draw-005.cfg is not", change=lambda folder: (folder / "draw-005.cfg").unlink())
    refuse("set", "would be the same in every one of them", sets={"material.E": "1 MPa"})
    refuse("half", "has no HIC_sd", more="response_error = { a_max = 0.1; a_max_sd = 0.1; HIC = 0.1; };\n")
    refuse("some", "has a response_error", change=lambda folder: (folder / "draw-007.cfg").write_text(
        (folder / "draw-007.cfg").read_text() + "response_error = { a_max = 0.1; a_max_sd = 0.1; HIC = 0.1; HIC_sd = 0.1; };\n"))
    refuse("dense", "the density of", change=lambda folder: (folder / "draw-003.cfg").write_text((folder / "draw-003.cfg").read_text().replace("35 kg/m3", "36 kg/m3")))
