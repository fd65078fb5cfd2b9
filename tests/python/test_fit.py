# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall fit: synthetic foams are found again, cushion curves and tests beside drops, interruption, bad input."""
from __future__ import annotations

import csv
import json
import math
import os
import re
import subprocess
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from scipy.optimize import least_squares

import softfall
from conftest import command_here
from softfall import cfh_draws, library, memory
from softfall.fit import input as fit_input, posterior
from softfall.fit.drops import COARSE, OWN, SECTION, Bench, Outcome
from softfall.fit.search import Found, Problem

BIN, ROOT = Path(os.environ["SF_BIN_DIR"]), Path(__file__).resolve().parents[2]
START = 'law = "low_density_foam"; density = "35 kg/m3"; E = "0.4136 MPa"; curve = "start.csv"; HU = 0.3; SHAPE = 3.0; DAMP = 0.05; rate_factor = 0.2; rate_reference = "1 1/s"; rate_filter_time = "0.5 ms";\n'
TRUE_SCALE, TRUE_HU = 1.2, 0.45


def run(*words: object, code: int = 0) -> str:
    ended = command_here("fit", *words)
    assert ended.returncode == code, ended.stdout + ended.stderr
    return str(ended.stdout if code in (0, 5) else ended.stderr)


def case_text(speed: str, extra: str = "") -> str:
    return f'''geometry: {{ model = "axisymmetric"; file = "{ROOT}/geo/section.geo"; missile_file = "{ROOT}/geo/hemisphere.geo"; length_unit = "mm";
    parameters = {{ radius = 200.0; thickness = 50.0; zone_radius = 100.0; fine_spacing = 12.5; outer_spacing = 25.0; }};
    missile_parameters = {{ diameter = 160.0; element_size = 10.0; quarter = 1; }}; }};
material: {{
@include "start.cfg"
}};
missile: {{ mass = "4.6 kg"; velocity = "{speed} m/s"; }};
pad: {{ mesh_error_limit = 9.0; }};
solver: {{ end_time = "60 ms"; }};
{extra}'''


@pytest.fixture(scope="module")
def lab(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two drops on a coarse section, whose numbers are those of a foam 1.2 times as stiff as the start, with another HU."""
    folder = tmp_path_factory.mktemp("fit")
    (folder / "start.csv").write_text((ROOT / "examples/fit/eva35_start.csv").read_text())
    (folder / "start.cfg").write_text(START)
    for name, speed in (("slow", "3.0"), ("fast", "4.0"), ("other", "3.5"), ("hard", "4.5")):
        (folder / f"{name}.cfg").write_text(case_text(speed))
    form = library.Form(str(folder / "start.cfg"), "table", 0.0)
    values = form.start({"stress_scale": TRUE_SCALE, "HU": TRUE_HU}, [])
    form.foam(values).write(str(folder), "true", "The foam that is to be found.", "")
    truth = {}
    for name in ("slow", "fast", "other"):
        with memory.Inputs(str(folder / f"{name}.cfg"), [f"material=@{folder / 'true.cfg'}"]) as inputs:
            truth[name] = inputs.run(str(folder / "share")).drops[0].figures
    (folder / "truth.json").write_text(json.dumps(truth))
    measured = "".join(f'{{ name = "{name}"; case = "{name}.cfg"; a_max_g = {truth[name]["a_max_g"]:.6g}; HIC = {truth[name]["hic"]:.6g}; v_rebound_m_s = '
                       f'{truth[name]["v_rebound_m_s"]:.6g}; }},' for name in ("slow", "fast"))
    (folder / "fit.cfg").write_text(f'name = "found"; material = "start.cfg"; curve_form = "table"; posterior = false;\nunknown = ( {{ name = "stress_scale"; }}, {{ name = "HU"; prior_sd = 1.0; }} );\n'
                                    f'drops = ( {measured[:-1]} );\npredict = ( {{ name = "other"; case = "other.cfg"; }}, {{ name = "hard"; case = "hard.cfg"; }} );\n')
    return folder


@pytest.fixture(scope="module")
def found(lab: Path) -> dict[str, Any]:
    """fit.json of the fit to them."""
    run(lab / "fit.cfg", "-o", lab / "out", "-j", 1)
    return dict(json.loads((lab / "out/fit.json").read_text()))


def test_a_synthetic_foam_is_found_again_and_foretells_another_drop(lab: Path, found: dict[str, Any]) -> None:
    scale, hu = found["parameters"]
    assert found["converged"] and found["expected_gain"] <= 0.1 and not found["on_bounds"]
    assert scale["value_SI"] == pytest.approx(TRUE_SCALE, rel=0.02) and scale["low95_SI"] < TRUE_SCALE < scale["high95_SI"]
    assert hu["value_SI"] == pytest.approx(TRUE_HU, rel=0.05)
    truth, other = json.loads((lab / "truth.json").read_text())["other"], found["drops"][2]
    assert other["a_max_g"] == pytest.approx(truth["a_max_g"], rel=0.01) and other["hic"] == pytest.approx(truth["hic"], rel=0.02)
    objectives = [one["objective"] for one in found["starts"]]
    assert len(objectives) == 3 and max(objectives) - min(objectives) < 0.01 and found["misfit"] < 0.1


def test_its_material_makes_the_drops_that_the_fit_tells(lab: Path, found: dict[str, Any]) -> None:
    with memory.Inputs(str(lab / "fast.cfg"), [f"material=@{lab / 'out/found.cfg'}"]) as inputs:
        figures = inputs.run(str(lab / "share")).drops[0].figures
    assert found["drops"][1]["a_max_g"] == pytest.approx(figures["a_max_g"], rel=1e-5) and found["drops"][1]["hic"] == pytest.approx(figures["hic"], rel=1e-5)
    assert found["drops"][1]["v_rebound_m_s"] == pytest.approx(figures["v_rebound_m_s"], rel=1e-5)
    assert 1.0 < found["drops"][1]["contact_time_ms"] < 60.0


def test_files_of_a_fit(lab: Path, found: dict[str, Any]) -> None:
    text, page = (lab / "out/found.cfg").read_text(), (lab / "out/report.html").read_text()
    assert "stress_scale = 1.1" in text or "stress_scale = 1.2" in text
    assert "informed_strain" in text and "Predictions by simulation" in page and "converged" in page and (lab / "out/fit.png").stat().st_size > 10000
    beyond, = found["extrapolated"]  # the harder drop alone strains the foam more than those of the fit
    assert beyond.startswith("hard strains the foam to 0.") and "times as wide" not in beyond and page.count("beyond the data") == 1 and found["drops"][3]["max_local_strain"] > found["drops"][1]["max_local_strain"]
    with open(lab / "out/fit-curve.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 19 and all(float(row["low95_kPa"]) < float(row["stress_kPa"]) < float(row["high95_kPa"]) for row in rows)
    with open(lab / "out/fit-drops.csv", newline="") as stream:
        peak = max(float(row["fast_g"]) for row in csv.DictReader(stream))
    assert peak == pytest.approx(found["drops"][1]["a_max_g"], rel=0.02)


def test_the_same_command_simulates_nothing_again(lab: Path, found: dict[str, Any]) -> None:
    (lab / "again").mkdir()
    (lab / "again/drops.sqlite").write_bytes((lab / "out/drops.sqlite").read_bytes())
    run(lab / "fit.cfg", "-o", lab / "again", "-j", 2)
    again = json.loads((lab / "again/fit.json").read_text())
    assert again["simulations"] == 0 and again["parameters"] == found["parameters"]
    assert "already holds" in run(lab / "fit.cfg", "-o", lab / "out", code=2)


def test_a_drop_in_memory_is_that_of_the_case_on_every_mesh(lab: Path, tmp_path: Path) -> None:
    given = fit_input.read(str(lab / "fit.cfg"))
    with Bench(given, tmp_path, 1, lambda text: None) as bench:
        problem = Problem(given, given.models[0], bench)
        own, section, coarse = (problem.outcomes([(problem.start, [1])], mesh)[0][0] for mesh in (OWN, SECTION, COARSE))
    with memory.Inputs(str(lab / "fast.cfg"), []) as inputs:
        figures = inputs.run(str(lab / "share")).drops[0].figures
    assert own.get("a_max_g") == pytest.approx(figures["a_max_g"], rel=1e-5) == pytest.approx(section.get("a_max_g"), rel=1e-5)
    assert coarse.get("a_max_g") != pytest.approx(figures["a_max_g"], rel=1e-4)
    assert np.max(own.shown()) == pytest.approx(figures["a_max_g"], rel=0.02)


def test_later_drops_of_a_series_and_a_measured_curve(lab: Path, tmp_path: Path) -> None:
    """The second drop of a series in memory is that of the case; a curve read through a mount is compared from contact on."""
    (lab / "memory.cfg").write_text(START + "memory = { reload = 0.4; recovery = 0.05; };\n")
    (lab / "series.cfg").write_text(case_text("3.0", 'series: { drops = ( {}, { interval = "60 s"; } ); };').replace("start.cfg", "memory.cfg"))
    with memory.Inputs(str(lab / "series.cfg"), []) as inputs:
        drops = inputs.run(str(lab / "share")).drops
    curve = "".join(f"{t},{40 * math.sin(math.pi * (t - 5) / 20) if 5 < t < 25 else 0}\n" for t in np.arange(0, 40, 0.1))
    (lab / "curve.csv").write_text("time_ms,acceleration_g\n" + curve)
    (lab / "later.cfg").write_text(
        'name = "later"; material = "memory.cfg"; curve_form = "table"; posterior = false; mount = "f = 400 Hz, damping = 0.05"; mount_frequency_sd = 0.1;\n'
        'unknown = ( { name = "stress_scale"; }, { name = "reload"; } );\n'
        'drops = ( { name = "second"; case = "series.cfg"; drop = 2; a_max_g = 30.0; }, { name = "curve"; case = "slow.cfg"; curve = "curve.csv"; speed_sd = 0.01; } );\n')
    given = fit_input.read(str(lab / "later.cfg"))
    with Bench(given, tmp_path, 1, lambda text: None) as bench:
        problem = Problem(given, given.models[0], bench)
        assert problem.names == ["stress_scale", "reload", "mount_frequency", "speed of curve"]
        mounted, slow = problem.outcomes([(problem.start, [0, 1])], OWN)[0]
        given.chain = [0.0, 0.5, 0.0]
        second = problem.outcomes([(problem.start, [0])], OWN)[0][0]
        residual = problem.residual(problem.start, OWN)
    assert second.get("a_max_g") == pytest.approx(drops[1].figures["a_max_g"], rel=1e-5) and drops[1].figures["a_max_g"] > drops[0].figures["a_max_g"]
    assert second.get("a_max_g") < mounted.get("a_max_g") < 1.2 * second.get("a_max_g")  # the mount adds its own oscillation
    measured = given.drops[1].curve
    assert measured and measured.peak == pytest.approx(40, rel=0.01) and len(measured.time) > 30
    assert len(residual) == (1 + 1) + (len(measured.time) + 1) + 4 and np.isfinite(residual).all()
    assert slow.samples(len(measured.time)).max() == pytest.approx(slow.get("a_max_g"), rel=0.02)


def polyethylene() -> str:
    """examples/foams/pe.cfg without a posterior, to be read from another folder."""
    return (ROOT / "examples/foams/pe.cfg").read_text().replace("pe_start.cfg", str(ROOT / "examples/foams/pe_start.cfg")) + "posterior = false;\n"


def test_a_search_that_ends_on_a_bound_says_which(tmp_path: Path) -> None:
    """Peaks far above what the exponent of the plateau alone can reach: rusch_m goes to its bound."""
    text = polyethylene().replace('"68.04 kPa"', '"150 kPa"')
    (tmp_path / "bound.cfg").write_text(re.sub(r"unknown = .*", 'unknown = ( { name = "rusch_m"; prior_sd = 10.0; } );', text))
    told = command_here("fit", tmp_path / "bound.cfg", "-o", tmp_path / "out", "-j", 1)
    assert json.loads((tmp_path / "out/fit.json").read_text())["on_bounds"] == ["rusch_m stands at its upper bound"]
    assert "rusch_m stands at its upper bound" in told.stdout and "rusch_m stands at its upper bound" in (tmp_path / "out/pe.cfg").read_text()


@pytest.fixture(scope="module")
def sampled(lab: Path, found: dict[str, Any]) -> dict[str, Any]:
    """fit.json of the same fit with a small posterior; its drops are those of the fit at first."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(posterior, "USUAL", posterior.Effort(first=24, second=16, draws=40, rounds=2, steps=300, burn=100))
        (lab / "post.cfg").write_text((lab / "fit.cfg").read_text().replace("posterior = false;", ""))
        (lab / "post").mkdir()
        (lab / "post/drops.sqlite").write_bytes((lab / "out/drops.sqlite").read_bytes())
        run(lab / "post.cfg", "-o", lab / "post", "-j", 1)
    return dict(json.loads((lab / "post/fit.json").read_text()))


def test_the_posterior_holds_the_truth(lab: Path, found: dict[str, Any], sampled: dict[str, Any]) -> None:
    model, truth = sampled["inference"]["models"][0], json.loads((lab / "truth.json").read_text())["other"]
    scale, hu = model["parameters"][:2]
    assert scale["low95"] < TRUE_SCALE < scale["high95"] and hu["low95"] < TRUE_HU < hu["high95"]
    assert model["largest_rhat"] < 1.1 and model["effective_simulated_draws"] > 8 and model["emulator_rms"] < 0.02
    for one in sampled["inference"]["predictions"][:2]:
        value = truth["a_max_g" if one["quantity"] == "a_max_g" else "hic"]
        assert one["low95"] < one["low90"] < value < one["high90"] < one["high95"] and one["share_of_draws_without_value"] == 0
    linear = found["parameters"][0]
    assert 0.5 < (scale["high95"] - scale["low95"]) / (linear["high95_SI"] - linear["low95_SI"]) < 2.5  # kappa widens it


def test_draws_are_materials_of_every_model_with_errors_of_the_responses(lab: Path, sampled: dict[str, Any]) -> None:
    with open(lab / "post/posterior.csv", newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert len(rows) == 200 and {row["model"] for row in rows} == {sampled["model"]} and len({row["stress_scale"] for row in rows}) > 10
    draws = cfh_draws.read(lab / "post/posterior", softfall.Case(lab / "other.cfg"), {})
    assert len(draws) == 200 and draws[7].response is not None and draws[7].form == sampled["model"]
    assert float(draws[7].values["HU"]) == pytest.approx(float(rows[7]["HU"]), rel=1e-6)
    assert draws[7].response[0] == pytest.approx(float(rows[7]["a_max_error"]), rel=1e-6)


def test_an_interval_beyond_the_measured_strains_is_wider() -> None:
    average, value = object.__new__(posterior.Average), np.exp(0.1 * np.random.default_rng(5).standard_normal(999))
    average.seed, average.values, average.sizes, average.model_of = 1, {(0, 0): value, (1, 0): value, (2, 0): np.where(value > 1.1, np.inf, value)}, np.ones(999), np.zeros(999)
    drops = [SimpleNamespace(predicted=d > 0) for d in range(4)]
    own = [Outcome({} if failure else {"max_local_strain": strain}, 0, "", failure) for strain, failure in ((0.7, ""), (0.8, ""), (0.0, "it collapses"), (0.69, ""))]
    problem = SimpleNamespace(drops=drops, given=SimpleNamespace(compressions=[]))
    found = Found(problem, *[None] * 13, own=own, fitted=own[:1])  # type: ignore[arg-type]
    assert found.deepest == 0.7 and [found.is_beyond(d) for d in range(4)] == [False, True, True, False]
    average.posteriors, average.weights = [None, SimpleNamespace(found=found)], [0.0, 1.0]  # type: ignore[list-item]
    within, beyond, open_above = (np.log(average.quantile(d, 0, 0.0)) for d in range(3))
    assert beyond[2] == within[2] and beyond - beyond[2] == pytest.approx(1.6 * (within - within[2]))
    assert open_above[:3] == pytest.approx(beyond[:3]) and np.isinf(open_above[3:]).all()


def test_importance_weights_are_those_of_the_densities() -> None:
    """Draws of a normal of width 1.3 weighed for one of width 1: mean square 1, and a small k."""
    x = 1.3 * np.random.default_rng(3).standard_normal(4000)
    weights, k = posterior.pareto(-0.5 * x**2 + 0.5 * (x / 1.3) ** 2)
    assert float(weights @ x**2) == pytest.approx(1.0, rel=0.05) and k < 0.5
    assert posterior.pareto(2.0 * np.abs(x) ** 1.5)[1] > 0.7  # a tail that no weight makes up for


def test_a_bend_of_the_whole_curve_is_a_scale_of_its_stress(lab: Path, tmp_path: Path) -> None:
    given = fit_input.read(str(lab / "fit.cfg"))
    foams = [given.models[0].form.foam(given.models[0].start) for _ in range(2)]
    foams[0].bend([0.5], [0.0])
    foams[1].bend([0.2, 0.4], [0.1, 0.3])
    (_, strain, stress), (_, _, bent) = foams[0].curves[0], foams[1].curves[0]
    with pytest.raises(softfall.InputError, match="at 1 strain or more"):
        foams[1].bend([], [])
    assert len(strain) > 100 and bent[1:] / stress[1:] == pytest.approx(np.exp(np.interp(strain[1:], [0.2, 0.4], [0.1, 0.3])), rel=1e-12)
    with Bench(given, tmp_path, 1, lambda text: None) as bench:
        problem = Problem(given, given.models[0], bench)
        scale, x = problem.names.index("stress_scale"), problem.start
        step = 0.03 * np.eye(len(x))[scale]
        base, more = (problem.outcomes([(point, [0])], COARSE)[0][0].logs() for point in (x, x + step))
        slopes = problem.bend_slopes(x)[0]
    assert slopes.sum(axis=1)[:3] == pytest.approx((more - base)[:3] / 0.03, rel=0.08, abs=0.01)  # second order
    assert abs(slopes[0, 9]) < 1e-2 * abs(slopes[0]).max()  # no node is compressed so far


def test_a_pole_at_1_leaves_most_beyond_what_was_fitted() -> None:
    """Forms fitted by ln(stress) up to a strain of 0.83 to the gas_solid of another solid density: what they leave up to there, and at 0.9."""
    strain, truth = np.append(np.linspace(0.05, 0.83, 60), 0.9), library.Form(35.0, "gas_solid", 940.0)
    stress = truth.loading(truth.start({}, []), 0.0, strain)

    def left(curve: str, solid: float, sd: dict[str, float]) -> Any:
        form = library.Form(35.0, curve, solid)
        places = [form.index[name] for name in sd]

        def off(u: Any) -> Any:
            values = form.start({}, [])
            values[places] *= np.exp(u)
            return np.log(stress / form.loading(values, 0.0, strain))
        return off(least_squares(lambda u: np.append(off(u)[:-1] / 0.1, u / list(sd.values())), np.zeros(len(sd))).x)
    shape = {"s0": 0.7, "p0": 0.15, "B": 1.0, "m": 0.3}
    gas, known, unknown = left("gas", 940.0, shape), left("gas_solid", 700.0, shape), left("gas_solid", 700.0, {**shape, "solid_fraction": 0.7})
    assert np.abs(gas[:-1]).max() < 0.06 and gas[-1] > 0.4
    assert abs(unknown[-1]) < 0.5 * abs(known[-1]) < 0.5 * 0.6


def test_cushion_curves_alone(tmp_path: Path) -> None:
    """Polyethylene by its cushion curves: the foam of the C program, 2026-11, whose peaks are in tests/reference."""
    reference = json.loads((ROOT / "tests/reference/fit-drop-cushion.json").read_text())["figures"]["fit.json"]
    (tmp_path / "pe.cfg").write_text(polyethylene())
    run(tmp_path / "pe.cfg", "-o", tmp_path / "out", "-j", 1)
    told = json.loads((tmp_path / "out/fit.json").read_text())
    assert told["converged"] and told["misfit"] <= 1.02 * reference["misfit"]
    for mine, theirs in zip(told["cushions"], reference["cushions"]):
        assert mine["peak_g"] == pytest.approx(theirs["peak_g"], rel=0.01)
    assert softfall.Case(ROOT / "examples/eva50-axisymmetric/case.cfg", {"material": f"@{tmp_path / 'out/pe.cfg'}"})["material.density"]


def test_a_posterior_needs_no_drops(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(posterior, "USUAL", posterior.Effort(first=40, second=10, draws=20, rounds=2, steps=300, burn=100))
    (tmp_path / "pe.cfg").write_text(polyethylene().replace("posterior = false;", ""))
    run(tmp_path / "pe.cfg", "-o", tmp_path / "out", "-j", 1)
    told = json.loads((tmp_path / "out/fit.json").read_text())["inference"]
    assert not told["predictions"] and told["models"][0]["simulated_draws"] == 20 and len(list((tmp_path / "out/posterior").glob("draw-*.cfg"))) == 200


@pytest.mark.parametrize("made, said", [
    ("cp fit.cfg found.cfg", "would replace an input"), ("cp start.cfg found.csv; sed -i s/start.cfg/found.csv/ fit.cfg", "would replace an input"),
    ("mkdir posterior; sed s:start.cfg:../start.cfg: slow.cfg > posterior/draw-001.cfg; sed -i s:slow.cfg:posterior/draw-001.cfg: fit.cfg", "would replace an input"),
    ("echo mine > report.html", "is not of softfall, and is not replaced"), ("ln -s /dev/null found.cfg", "it is no plain file"), ("mkdir fit.json", "it is a folder")])
def test_no_input_and_no_file_of_somebody_else_is_replaced(lab: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, made: str, said: str) -> None:
    for name in ("fit.cfg", "start.cfg", "start.csv", "slow.cfg", "fast.cfg", "other.cfg", "hard.cfg"):
        (tmp_path / name).write_bytes((lab / name).read_bytes())
    monkeypatch.chdir(tmp_path)
    subprocess.run(["sh", "-c", made], cwd=tmp_path, check=True)
    source = "found.cfg" if made.startswith("cp fit.cfg") else "fit.cfg"
    before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file() and not path.is_symlink()}
    refused = command_here("fit", source, "-o", ".", "--force")
    assert refused.returncode == 2 and said in refused.stderr, refused.stderr
    assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file() and not path.is_symlink()} == before


def test_points_of_a_compression_test_are_clear_of_its_ends() -> None:
    """LEAP, to a strain of 0.6 and back to 0.04: the 22 points of the C program, 2026-11 (tests/reference/fit-drop-joint.json)."""
    test = fit_input.read(str(ROOT / "examples/fit/joint/leap_joint.cfg")).compressions[0]
    assert (test.loading, len(test.strain), test.turn) == (12, 22, 0.6)
    assert test.strain[:test.loading].tolist() == pytest.approx([0.025, *(0.05 * k for k in range(1, 12))]) and test.strain[-1] == pytest.approx(0.1)


def test_a_gas_stiffer_than_E_is_no_dead_end(lab: Path) -> None:
    form = library.Form(str(lab / "start.cfg"), "gas", 0.0)
    values = form.start({"p0": 6e5}, [])  # E is 4.1e5 Pa
    _, strain, stress = form.foam(values).curves[0]
    assert np.all(np.diff(stress) > 0) and stress[-1] > 1e6
    assert math.isclose(values[form.index["p0"]], 6e5)


GOOD = 'name = "foam"; material = "start.cfg"; '
DROP = 'drops = ( { name = "a"; case = "slow.cfg"; a_max_g = 30.0; } ); '


@pytest.mark.parametrize("text, said", [
    (GOOD, "drops is missing"),
    (GOOD + DROP + 'curve_form = "foam";', "expected one of gas|"),
    (GOOD + DROP + 'curve_form = "gas_solid";', "needs solid_density"),
    (GOOD + DROP + 'solid_density = "60 kg/m3";', "solids that foams are made of"),
    (GOOD + DROP + 'unknown = ( { name = "avalle_A"; } );', 'is not a parameter of the form "gas"'),
    (GOOD + DROP + 'unknown = ( { name = "p0"; }, { name = "p0"; } );', "p0 is given twice"),
    (GOOD + DROP + 'unknown = ( { name = "ED"; } );', "is 0 in the start material: give a start value"),
    (GOOD + DROP + 'start: { p0 = "3 kg"; };', "p0"),
    (GOOD + DROP + 'start: { q0 = "3 kPa"; };', 'unknown parameter "q0" of the foam'),
    (GOOD + DROP + 'colour = "red";', 'unknown key "colour"'),
    ('density = "35 kg/m3"; tests = ( { file = "a.csv"; rate = "1 1/s"; } );', "softfall fit compression "),
    (GOOD + DROP + 'forms = ( { curve = "gas"; } ); curve_form = "gas";', "give either forms or curve_form"),
    (GOOD + DROP + 'forms = ( { curve = "gas"; }, { curve = "avalle"; } ); posterior = false;', "posterior must be true"),
    (GOOD + DROP + 'forms = ( { curve = "gas"; rate = "none"; start: { ED = "1 MPa"; }; } );', "term of the rate"),
    (GOOD + DROP + "mount_frequency_sd = 0.1;", "given without mount"),
    (GOOD + DROP + 'mount = "420 Hz";', "mount must be like"),
    (GOOD + DROP + 'coarse_set = ["missile.mass=2 kg"];', "not a key of geometry, pad or solver"),
    (GOOD + DROP + 'predict = ( { name = "a"; case = "fast.cfg"; } );', 'two drops are called "a"'),
    (GOOD + 'drops = ( { name = "a"; case = "slow.cfg"; } );', "nothing else measured and no curve"),
    (GOOD + 'drops = ( { name = "a"; case = "slow.cfg"; HIC_sd = 0.1; a_max_g = 30.0; } );', "HIC_sd is given, but no HIC"),
    (GOOD + 'drops = ( { name = "a"; case = "slow.cfg"; drop = 2; a_max_g = 30.0; } );', "the case has no series"),
    (GOOD + 'drops = ( { name = "a"; case = "slow.cfg"; a_max_g = 30.0; }, { name = "b"; case = "slow.cfg"; a_max_g = 30.0; } );', "give the same data once"),
    (GOOD + 'drops = ( { name = "a"; case = "none.cfg"; a_max_g = 30.0; } );', "No such file"),
    ('name = "fit-1"; material = "start.cfg"; ' + DROP, "not fit..., which other files are called")])
def test_bad_input_is_refused_with_its_line(lab: Path, tmp_path: Path, text: str, said: str) -> None:
    (lab / "bad.cfg").write_text(text)
    told = run(lab / "bad.cfg", "-o", tmp_path / "out", code=2)
    assert said in told, told
    assert "Traceback" not in told and not (tmp_path / "out").exists()
