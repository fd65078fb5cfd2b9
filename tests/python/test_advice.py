# SPDX-License-Identifier: GPL-3.0-or-later
"""The advice which drop to do next: against closed forms of normal distributions, and as a program."""
import json
import math
import os
import pathlib
import re

import numpy as np
import pytest

import softfall
from softfall import advice, protocol
from test_protocol import MAT, softfall_protocol

SOURCE = pathlib.Path(os.environ["SF_SOURCE_DIR"])
POSTERIOR = SOURCE / "examples/materials/eva35_posterior"
NO_TREND = {"degrees_of_freedom": 0, "scatter": None, "shift": None, "slope": None, "centre_m": None}
SPREAD, SCATTER, SLOPE = 0.2, 0.05, 2.0


def place(count=500, name="centre", scatter=SCATTER):
    """ln y = ln 1000 + SLOPE ln h + SPREAD z, z at the quantiles of a normal distribution: the height at 1000 is exp(-SPREAD z / SLOPE) m."""
    z = np.sqrt(2) * np.array([inverse_erf(2 * (k + 0.5) / count - 1) for k in range(count)])
    log_height = np.linspace(math.log(0.2), math.log(5), 80)
    value = math.log(1000) + SLOPE * log_height[None, None, :] + SPREAD * z[None, :, None] + np.zeros((2, 1, 1))
    zero = np.zeros((2, count))
    return advice.Place(name, log_height, value, zero, zero, np.full((2, 80), scatter), 0.0, np.zeros(2), (NO_TREND, NO_TREND))


def inverse_erf(y):
    """By Newton's method."""
    x = 0.0
    for _ in range(60):
        x -= (math.erf(x) - y) / (2 / math.sqrt(math.pi) * math.exp(-x * x)) if abs(x) < 4 else 0.0
    return x


def normal(x):
    return 0.5 * (1 + math.erf(x / math.sqrt(2)))


QUESTION = advice.Question((None, 1000.0), required=1.1)


def test_the_prior_has_its_quantiles_and_probability():
    told = advice.advise(advice.Pads([place()]), QUESTION)
    for found, z in zip(told.height, (-1.96, 0, 1.96)):
        assert found == pytest.approx(math.exp(SPREAD * z / SLOPE), rel=3e-3)
    assert told.probability == pytest.approx(normal(-SLOPE * math.log(1.1) / SPREAD), abs=2e-3)
    assert told.loss == min(told.probability, 1 - told.probability) and not told.stop and told.decision is None


def test_a_measured_drop_has_the_weights_of_bayes():
    """The posterior of a normal prior and a normal measurement."""
    pads = advice.Pads([place()])
    pads.learn(advice.Drop("centre", 0.8, (math.nan, 700.0)))
    error = math.log(700 / 1000) - SLOPE * math.log(0.8)
    part = SPREAD**2 / (SPREAD**2 + SCATTER**2)
    mean, sd = part * error, SPREAD * math.sqrt(1 - part)
    told = advice.advise(pads, QUESTION)
    assert told.height[1] == pytest.approx(math.exp(-mean / SLOPE), rel=2e-3)
    assert told.height[2] / told.height[0] == pytest.approx(math.exp(2 * 1.96 * sd / SLOPE), rel=3e-3)
    assert told.probability == pytest.approx(normal((-SLOPE * math.log(1.1) - mean) / sd), abs=5e-3)
    again = advice.Pads([place()])
    again.learn(advice.Drop("centre", 0.8, (700.0, 700.0)))  # two figures of one drop tell no more than one
    assert advice.advise(again, QUESTION).height == told.height


def test_means_of_more_drops_tell_more():
    one, four = advice.Pads([place()]), advice.Pads([place()])
    one.learn(advice.Drop("centre", 1.0, (math.nan, 1000.0)))
    four.learn(advice.Drop("centre", 1.0, (math.nan, 1000.0), 4))
    widths = [math.log(told.height[2] / told.height[0]) for told in (advice.advise(one, QUESTION), advice.advise(four, QUESTION))]
    sds = [1 / math.sqrt(1 / SPREAD**2 + n / SCATTER**2) for n in (1, 4)]
    assert widths[1] / widths[0] == pytest.approx(sds[1] / sds[0], rel=0.02)


def test_the_expected_loss_of_a_drop_has_its_value():
    """E min(P, 1 - P) after a measurement, by quadrature over the measurement."""
    pads = advice.Pads([place()])
    told = advice.advise(pads, QUESTION)
    total, part = math.sqrt(SPREAD**2 + SCATTER**2), SPREAD**2 / (SPREAD**2 + SCATTER**2)
    z = np.linspace(-6, 6, 4001)
    p = np.array([normal((-SLOPE * math.log(1.1) - part * total * x) / (SPREAD * math.sqrt(1 - part))) for x in z])
    density = np.exp(-z * z / 2) / math.sqrt(2 * math.pi)
    expected = float((np.minimum(p, 1 - p) * density).sum() * (z[1] - z[0]))
    for choice in told.choices:
        assert choice.loss == pytest.approx(expected, abs=0.015)  # the same at all heights: 128 drawn measurements
        assert choice.gain == pytest.approx(told.loss - choice.loss, abs=1e-12)


def test_what_tells_more_comes_first():
    """A place with more scatter tells less; a dear test comes behind."""
    pads = advice.Pads([place(), place(name="corner", scatter=0.4)])
    stress = np.exp(0.3 * np.linspace(-2, 2, 500))[:, None] * np.ones((1, 3))
    told = advice.advise(pads, advice.Question((None, 1000.0), heights=(1.0,)), stress=stress, test_cost=50)
    names = [choice.name for choice in told.choices]
    assert names[0].endswith("centre") and names[-1] == "a slow compression test"
    assert max(k for k, name in enumerate(names) if "centre" in name) < min(k for k, name in enumerate(names) if "corner" in name)


def test_measuring_stops_and_decides():
    pads = advice.Pads([place()])
    pads.learn(advice.Drop("centre", 1.1, (math.nan, 850.0), 4))
    told = advice.advise(pads, QUESTION)
    assert told.stop and told.decision is True and told.loss < 0.05 and not told.choices
    pads = advice.Pads([place()])
    pads.learn(advice.Drop("centre", 1.1, (math.nan, 1600.0), 4))
    assert advice.advise(pads, QUESTION).decision is False
    width = advice.Question((None, 1000.0), bound=0.12)
    assert not advice.advise(advice.Pads([place()]), width).stop
    pads = advice.Pads([place()])
    pads.learn(advice.Drop("centre", 1.0, (math.nan, 1000.0)))
    told = advice.advise(pads, width)
    assert told.stop and told.decision is None and told.loss == pytest.approx(2 * 1.96 * SCATTER / SLOPE, rel=0.1)


def test_a_foam_that_is_none_of_the_draws_is_told():
    pads = advice.Pads([place(count=200)])
    pads.learn(advice.Drop("centre", 1.0, (math.nan, 3000.0), 9))
    told = advice.advise(pads, QUESTION)
    assert "softfall-fit drop" in told.problem and told.decision is None and not told.stop


def test_collapsed_columns_are_beyond_every_limit():
    p = place(count=100)
    p.value[:, 50:, 40:] = np.inf
    pads = advice.Pads([p])
    edge = math.exp(p.log_height[39])
    assert (pads.crossing("centre", (None, 1e9))[50 * advice.REPEATS:] <= math.exp(p.log_height[40]) + 1e-9).all()
    assert np.isinf(pads.crossing("centre", (None, 1e9))[: 50 * advice.REPEATS]).all()
    pads.learn(advice.Drop("centre", 2 * edge, (math.nan, math.nan)))  # the drop had no figures
    assert pads.weight[: 50 * advice.REPEATS].sum() < 1e-12


# ---- the program ----

@pytest.fixture(scope="module")
def asked(tmp_path_factory):
    """A protocol of a critical height at one place, of one drop at each height."""
    text = re.sub(r"positions = \[.*?\]\n", "", MAT.read_text(), flags=re.S).replace("count = 3", "count = 1").replace("counted = [2, 3]", "counted = [1]")
    text = re.sub(r'limit = 100\.0', "limit = 200.0", re.sub(r"least_window_ms = .*\n", "", text)).replace("limit = 400.0", "limit = 1000.0")
    path = tmp_path_factory.mktemp("asked") / "mine.toml"
    path.write_text(re.sub(r"heights = \[.*?\]\n", "", text))
    return path


def test_a_protocol_is_advised_and_learns(asked, case, tmp_path):
    """After a drop as the pad is expected to make it, the interval is shorter; the draws' foam is that of the case."""
    common = ["--pad", case.path, "--posterior", POSTERIOR, "--advise", "--required", "1.2 m", "-j", "2"]
    first = softfall_protocol(asked, *common, "-o", tmp_path / "out")
    assert first.returncode == 0, first.stderr
    told = json.loads((tmp_path / "out/protocol.json").read_text())["advice"]
    assert told["choices"] and not told["stop"] or told["stop"]
    low, median, high = told["height_m"]
    assert low < median < high
    curves = advice.read_place("x", next((tmp_path / "out/drops").iterdir()))
    k = int(np.argmin(abs(curves.log_height - math.log(median))))
    height, a_max = math.exp(curves.log_height[k]), math.exp(np.median(curves.value[0][:, k]))
    t = np.arange(0, 0.03, 1e-4)
    pulse = np.where((t > 0.005) & (t < 0.02), a_max * np.sin(np.pi * (t - 0.005) / 0.015), 0)
    (tmp_path / "lab").mkdir()
    np.savetxt(tmp_path / "lab/1.csv", np.column_stack([t, pulse]), delimiter=",", header="time (s),acceleration (g)", comments="", fmt="%.9g")
    (tmp_path / "lab/list.csv").write_text(f"file,height,drop\n1.csv,{height:.6g} m,1\n")
    second = softfall_protocol(asked, *common, "--measured", tmp_path / "lab", "-o", tmp_path / "out", "--force")
    assert second.returncode == 0, second.stderr
    after = json.loads((tmp_path / "out/protocol.json").read_text())
    assert after["advice"]["height_m"][2] - after["advice"]["height_m"][0] < high - low or "none of them" in after["advice"]["problem"]
    page = (tmp_path / "out/report.html").read_text()
    assert "advice:" in page and (after["advice"]["stop"] or after["advice"]["problem"] or "The next measurement" in page)


@pytest.mark.parametrize("arguments, said", [
    (["--advise"], "--advise needs --pad=CASE and --posterior=FOLDER"),
    (["--required", "1.5 m"], "--required and --bound belong to --advise"),
    (["--advise", "--posterior", str(POSTERIOR), "--bound", "0.7"], "is not between 0 and 0.5"),
    (["--advise", "--posterior", str(POSTERIOR), "--required", "1.5"], "is no length"),
    (["--advise", "--posterior", "nowhere"], "nowhere"),
])
def test_what_cannot_be_advised_is_refused(asked, case, tmp_path, arguments, said):
    result = softfall_protocol(asked, "--pad", case.path, *arguments, "-o", tmp_path / "out")
    assert result.returncode != 0 and result.stderr.count("\n") == 1 and said in result.stderr, result.stderr
    assert not (tmp_path / "out/protocol.json").exists()


def test_other_limits_and_kinds_are_refused(case, tmp_path):
    text = (protocol.folder() / "own.toml").read_text().replace('key = "a_max_g"', 'key = "max_indentation_mm"').replace(
        '[[figure]]\nkey = "max_indentation_mm"\n\n', "", 1)
    (tmp_path / "mine.toml").write_text(text)
    for name, said in ((tmp_path / "mine.toml", "knows limits of"), ("d1596", "a cushion curve has none")):
        result = softfall_protocol(name, "--pad", case.path, "--posterior", POSTERIOR, "--advise", "-o", tmp_path / "out")
        assert result.returncode == 2 and said in result.stderr, result.stderr
