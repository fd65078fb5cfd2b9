# SPDX-License-Identifier: GPL-3.0-or-later
"""Cases: values, refusals, runs that are ended, killed and resumed."""
import json
import os
import pathlib
import signal
import subprocess
import sys

import h5py
import numpy as np
import pytest

import softfall
from softfall import programs
from conftest import program


def test_values_are_read_set_and_taken_back(case):
    assert case["missile.velocity"] == "4.5 m/s" and case["geometry.parameters.thickness"] == 50
    assert case["pad.self_contact"] == "auto" and case["kernel.support_ratio"] > 1  # defaults
    case["missile.velocity"] = "5.2 m/s"
    case["kernel.support_ratio"] = np.float64(1.9)
    assert case["missile.velocity"] == "5.2 m/s" and case["kernel.support_ratio"] == 1.9
    assert case.copy().overrides == case.overrides == {"missile.velocity": "5.2 m/s", "kernel.support_ratio": "1.9"}
    del case["missile.velocity"]
    assert case["missile.velocity"] == "4.5 m/s"
    with pytest.raises(KeyError, match="value that was set"):
        del case["missile.velocity"]
    assert "pad.base" in case and "pad.bass" not in case and len(case) == len(list(case))


@pytest.mark.parametrize("key, value, sentence", [
    ("missile.velocty", "5 m/s", 'unknown key "velocty" in group missile .did you mean "velocity"'),
    ("missle.velocity", "5 m/s", 'unknown group "missle"'),
    ("missile.velocity", "5 kg", '"5 kg" is a mass; expected a speed'),
    ("missile.velocity", 5.0, "expected a speed"),
    ("missile.velocity", "-5 m/s", "out of bounds"),
    ("missile.velocity", float("nan"), "expected a speed"),
    ("kernel.support_ratio", float("nan"), "kernel.support_ratio"),
    ("pad.base", "soft", '"soft" is none of: glued, smooth, resting'),
    ("pad.base", "a\nb", "pad.base"),
    ("pad.base", "a\0b", "zero byte"),
    ("material", "@nowhere.cfg", "nowhere.cfg"),
    ("missile.velocity=1 m/s;missile", "x", "no key of a case"),
    (7, "x", "no key of a case"),
])
def test_a_wrong_value_is_refused_at_once_and_nothing_changes(case, key, value, sentence):
    before = case.overrides
    with pytest.raises(softfall.InputError, match=sentence):
        case[key] = value
    assert case.overrides == before


def test_values_of_no_type_of_a_case_are_refused(case):
    for value in (None, {"a": 1}, object(), [None]):
        with pytest.raises(TypeError, match="a value is a text"):
            case["missile.velocity"] = value
    with pytest.raises(KeyError, match='did you mean "missile.velocity"'):
        case["missile.velocit"]
    with pytest.raises(softfall.InputError, match="nowhere.cfg cannot be read"):
        softfall.Case("nowhere.cfg")
    with pytest.raises(softfall.InputError):
        softfall.Case("pad")


def test_a_decimal_comma_is_refused(case, monkeypatch):
    monkeypatch.setattr("locale.localeconv", lambda: {"decimal_point": ","})
    with pytest.raises(softfall.Error, match="decimal comma"):
        case["missile.velocity"] = "5.2 m/s"


def test_update_sets_all_or_nothing(case):
    with pytest.raises(softfall.InputError):
        case.update({"missile.velocity": "5 m/s", "missile.mass": "5 m"})
    assert case.overrides == {}


def test_the_programs_are_found_or_missed_with_a_sentence(case, monkeypatch, tmp_path):
    monkeypatch.setenv("SF_BIN_DIR", str(tmp_path))
    with pytest.raises(softfall.Error, match="no program softfall-solve in it"):
        case.run()
    monkeypatch.delenv("SF_BIN_DIR")
    monkeypatch.setattr(programs, "_HERE", tmp_path / "a/b/c/d")
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(softfall.Error, match="neither beside the Python package nor on PATH"):
        programs.folder()


def test_a_run_is_refused_with_the_sentence_of_the_program(case, tmp_path):
    case["geometry.parameters.thicknes"] = 4
    with pytest.raises(softfall.InputError, match='softfall-pre: .* has no parameter "thicknes" .did you mean "thickness".*; its DefineConstant parameters are'):
        case.run(output=tmp_path / "out")
    assert not (tmp_path / "out").exists()
    for threads in (0, -1, 1.5, True, "2"):
        with pytest.raises(softfall.InputError, match="threads"):
            case.run(threads=threads)
    with pytest.raises(softfall.InputError, match="on_step: 3 is no function"):
        case.run(on_step=3)
    with pytest.raises(softfall.Error, match="cannot be written to"):
        softfall.Case("pad/case.cfg").run(output="pad/case.cfg/out")


def test_warnings_of_the_programs_are_warnings(case, tmp_path):
    case["kernel.support_ratio"] = 2.0
    with pytest.warns(softfall.SoftfallWarning, match="support_ratio"):
        case.run(output=tmp_path / "out")


def test_a_failure_of_the_solution_has_its_results(case, tmp_path):
    case.update({"missile.velocity": "30 m/s"})
    with pytest.raises(softfall.NumericError, match="anvil") as caught:
        case.run(output=tmp_path / "out")
    assert caught.value.code == 5
    assert softfall.read_results(caught.value.results).verdict == "do not use"


def test_a_drop_that_is_there_is_not_computed_again(case, tmp_path):
    first = case.run(output=tmp_path)
    stamp = first.results.stat().st_mtime_ns
    assert case.run(output=tmp_path).results.stat().st_mtime_ns == stamp
    case["missile.velocity"] = "4 m/s"
    with pytest.raises(softfall.InputError, match="holds a run of other values; force=True replaces it"):
        case.run(output=tmp_path)
    assert first.results.stat().st_mtime_ns == stamp
    case.run(output=tmp_path, force=True)
    assert first.results.stat().st_mtime_ns > stamp


@pytest.mark.slow
def test_names_with_blanks_and_umlauts(case, tmp_path):
    source = tmp_path / "my päd"
    program("new", source, "--from", "eva50-v4.5", cwd=".")
    drop = softfall.Case(source / "case.cfg", {key: case[key] for key in (
        "geometry.parameters.fine_spacing", "geometry.parameters.outer_spacing", "geometry.missile_parameters.element_size",
        "pad.mesh_error_limit")}).run(output=tmp_path / "aus gang/ü")
    assert drop.figures["hic"] == case.run().figures["hic"] and drop.report().exists()


@pytest.mark.slow
def test_other_values_get_another_folder(case):
    """Also two round values, whose changes could cancel in the hash of a model."""
    places = set()
    for speed, mass in ((4.0, 4.0), (4.5, 4.0), (4.0, 4.5)):
        case.update({"missile.velocity": f"{speed} m/s", "missile.mass": f"{mass} kg"})
        places.add(case.run().results.parent)
    assert len(places) == 3


def test_the_motion_of_a_later_drop_counts(case):
    """The text of the list is the same, the points of its file are not."""
    motion, places = case.path.parent / "later.csv", set()
    case.update({"series.drops": '({ }, { interval = "90 s"; motion = "later.csv"; })'})
    for depth in (10, 12, 10):
        motion.write_text(f"time (ms),displacement (mm)\n0,0\n5,{depth}\n")
        places.add(case._folder_in(case.path.parent))
    assert len(places) == 2


def same(one, other):
    return [name for name in one.history if not np.array_equal(one.history[name], other.history[name], equal_nan=True)] == []


def test_ctrl_c_ends_cleanly_and_the_same_call_resumes_bit_for_bit(slow, tmp_path):
    whole = slow.run(output=tmp_path / "whole", threads=1)
    steps = []

    def interrupt(step):
        steps.append(step)
        os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        slow.run(output=tmp_path / "part", threads=1, on_step=interrupt)
    assert steps and not programs._running
    part = softfall.read_results(tmp_path / "part", output=tmp_path / "post")
    assert part.data("summary/status") == "interrupted"
    assert part.verdict == "do not use" or part.figures["hic"] == whole.figures["hic"]  # a fast machine ends the contact before
    resumed = slow.run(output=tmp_path / "part", threads=2)
    assert resumed.data("summary/restarts") == 1 and same(whole, resumed)
    assert resumed.figures["hic"] == whole.figures["hic"]


def test_what_a_callback_raises_ends_the_run_and_reaches_the_caller(slow, tmp_path):
    def end(step):
        assert step.time >= 0 and step.step >= 0
        raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        slow.run(output=tmp_path, on_step=end)
    assert softfall.read_results(tmp_path).data("summary/status") == "interrupted"


def test_progress_is_that_of_the_history(slow, tmp_path):
    steps = []
    drop = slow.run(output=tmp_path, on_step=steps.append)
    assert len(steps) >= 2 and steps[-1].step == drop.figures["steps"]
    for step in steps:
        assert abs(drop.history["time"][step.step] - step.time) <= 1e-6
        assert abs(drop.history["indentation"][step.step] - step.indentation) <= 1e-4


def test_a_killed_python_leaves_a_run_that_the_next_one_waits_for_or_resumes(slow, tmp_path):
    whole = slow.run(output=tmp_path / "whole")
    text = (f"import softfall; case = softfall.Case('pad/case.cfg', {slow.overrides!r})\n"
            f"case.run(output={str(tmp_path / 'killed')!r}, threads=1, on_step=lambda step: print('step', flush=True))")
    child = subprocess.Popen([sys.executable, "-W", "ignore", "-c", text], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "step\n"
    child.kill()
    child.wait()
    assert same(whole, slow.run(output=tmp_path / "killed", threads=2))


@pytest.mark.slow
def test_runs_of_one_folder_at_the_same_time_are_one(case, tmp_path):
    text = f"import softfall; softfall.Case('pad/case.cfg', {{'missile.mass': '5 kg'}}).run(output={str(tmp_path)!r})"
    children = [subprocess.Popen([sys.executable, "-W", "ignore", "-c", text]) for _ in range(3)]
    assert [child.wait() for child in children] == [0, 0, 0]
    assert softfall.read_results(tmp_path).verdict != "do not use"


def test_a_run_is_that_of_the_programs_to_the_last_digit(case, drop, tmp_path):
    program("pre", "pad/case.cfg", "-o", tmp_path / "model.h5", cwd=".")
    program("solve", tmp_path / "model.h5", "-o", tmp_path / "results.h5", cwd=".")
    program("post", tmp_path / "results.h5", "-o", tmp_path / "out", cwd=".")
    theirs = json.loads(pathlib.Path(tmp_path / "out/summary.json").read_text())
    ours = drop.figures
    for key, value in theirs.items():
        if key in ours and key not in ("wall_s", "threads"):
            assert ours[key] == value or (value is None and np.isnan(ours[key])), key
    assert len(ours) > 60
    with h5py.File(tmp_path / "results.h5") as file:
        assert set(file["history"]) == set(drop.history)
        for name, data in file["history"].items():
            assert np.array_equal(data[()], drop.history[name], equal_nan=True)
            assert drop.history[name].units == data.attrs["units"].decode()
