# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall run: values of the command line, drops that are kept by content, kills, terminals and logs."""
import contextlib
import os
import pty
import re
import shutil
import signal
import subprocess

import pytest

import softfall
from softfall import run_keys
from conftest import BIN, command_here

SLOW = ("fine_spacing=10",)  # long enough to be ended in between


def command(*words):
    return [str(BIN / "softfall"), *map(str, words)]


def told(*words, cwd):
    """Runs a drop within this process, and returns its exit code and what it prints."""
    with contextlib.chdir(cwd):
        return command_here("run", *words)


def run(*words, cwd, code=0):
    """Runs a drop, and returns what it prints."""
    done = told(*words, cwd=cwd)
    assert done.returncode == code, done.stderr
    return done.stdout if code == 0 else done.stderr


def stamps(folder):
    """Returns the times of change of all results and summaries below a folder."""
    return {path: path.stat().st_mtime_ns for name in ("results*.h5", "summary.json") for path in folder.rglob(name)}


def page(printed):
    return re.search(r"^  page +(\S+report.html)", printed, re.MULTILINE)[1]


@pytest.fixture(scope="module")
def dropped(place, tmp_path_factory):
    """A folder with a coarse case and its drop."""
    folder = shutil.copytree(place / "pad", tmp_path_factory.mktemp("dropped") / "pad", ignore=shutil.ignore_patterns("softfall-runs"))
    run(cwd=folder)
    return folder


@pytest.fixture
def pad(dropped, tmp_path):
    """A copy of that folder, whose drop is found by its content."""
    return shutil.copytree(dropped, tmp_path / "pad", symlinks=True)


def test_a_first_drop_prints_verdict_figures_and_page(pad):
    shutil.rmtree(pad / "softfall-runs")
    printed = run(cwd=pad)
    drop = softfall.read_results(pad / "softfall-runs/latest", output=pad / "softfall-runs/latest/out")
    lines = printed.splitlines()
    assert f"Verdict: {drop.verdict}" in lines and len(lines) < 14
    assert f"a_max  {drop.figures['a_max_g']:.4g} g" in printed and f"HIC    {drop.figures['hic']:.4g}" in printed
    assert "below the limit of 200 g" in printed and (pad / page(printed)).is_file() and "not a certification" in lines[-1]
    with_others = run("velocity=5.4 m/s", "thickness=40", cwd=pad)
    assert re.search(r"(ABOVE|not comparable with) the limit of 200 g", with_others)  # the latter where it locks up


def test_a_repeat_computes_nothing_and_a_changed_value_runs_again(pad):
    first = run("case.cfg", cwd=pad)
    before = stamps(pad)
    assert run("case.cfg", cwd=pad) == first and stamps(pad) == before
    assert run(".", "velocity=4.5 m/s", cwd=pad).splitlines()[-6:] == first.splitlines()[-6:] and stamps(pad) == before
    other = run("case.cfg", "thickness=60", cwd=pad)
    assert page(other) != page(first) and len(stamps(pad)) == 2 * len(before)
    assert run("case.cfg", cwd=pad) == first  # that of the first values is there still
    (pad / "geo/pad.geo").write_text((pad / "geo/pad.geo").read_text() + "\n// changed\n")
    assert page(run("case.cfg", cwd=pad)) != page(first)


def test_a_drop_that_is_found_warns_again_and_gets_lost_pages_back(pad):
    words = ("fine_spacing=25", "outer_spacing=25", "-q")
    first = told(*words, cwd=pad)
    assert "the nodal spacing under the missile is 25 mm" in first.stderr
    out = (pad / page(first.stdout)).parent
    for lost in ("report.html", "summary.json"):  # the latter as after a kill between files
        (out / lost).unlink()
        again = told(*words, cwd=pad)
        assert again.returncode == 0 and again.stdout == first.stdout and "the nodal spacing under the missile is 25 mm" in again.stderr and (out / lost).exists()


def test_a_drop_is_found_by_its_content_wherever_the_case_stands(pad, tmp_path):
    first = run("case.cfg", cwd=pad)
    other = tmp_path / "another place"
    pad.rename(other)
    before = stamps(other)
    assert run("case.cfg", cwd=other) == first and stamps(other) == before
    shutil.copytree(other, tmp_path / "copied")
    assert run("case.cfg", cwd=tmp_path / "copied") == first
    shared = run("copied/case.cfg", "-o", other / "softfall-runs", cwd=tmp_path)
    assert stamps(other) == before and shared.splitlines()[-6:-2] == first.splitlines()[-6:-2]


@pytest.mark.slow
def test_a_file_that_a_geometry_includes_counts(pad):
    geo = pad / "geo/pad.geo"
    (pad / "geo/whole.geo").write_text(geo.read_text())
    geo.write_text("DefineConstant[ side = 400, thickness = 50, zone_side = 200, fine_spacing = 5, outer_spacing = 10, quarter = 0 ];\nInclude \"whole.geo\";\n")
    first = run(cwd=pad)
    whole = (pad / "geo/whole.geo").read_text()
    before = stamps(pad)
    (pad / "geo/whole.geo").write_text("thickness = 1.2 * thickness;\n" + whole.replace("thickness = {50,", "unused = {50,"))
    assert run(cwd=pad).splitlines()[-5:-3] != first.splitlines()[-5:-3] and stamps(pad).keys() == before.keys()
    (pad / "geo/whole.geo").write_text(whole)
    assert run(cwd=pad) == first


STAGES = ("building the model", "solving the drop", "solving the drop", "figures and report")


@pytest.mark.parametrize("number, stages", [
    (signal.SIGINT, STAGES[1:2]), (signal.SIGKILL, STAGES[1:2]),
    *(pytest.param(number, STAGES, marks=pytest.mark.slow) for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL))])
def test_a_run_that_is_ended_in_the_middle_goes_on_or_starts_again(pad, number, stages):
    whole = run(*SLOW, "-o", "whole", cwd=pad)
    for stage in stages:
        child = subprocess.Popen(command("run", *SLOW), cwd=pad, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        while (line := child.stderr.readline()) and stage not in line:
            pass
        child.send_signal(number)
        _, said = child.communicate()
        assert child.returncode in (0, 130 if number != signal.SIGKILL else -number)
        if child.returncode == 130:
            assert said.endswith("softfall run: interrupted; the same command resumes\n") and "Traceback" not in said
            assert not list(pad.glob("softfall-runs/.softfall-*"))
    assert run(*SLOW, cwd=pad).splitlines()[-5:-2] == whole.splitlines()[-5:-2]


@pytest.mark.slow
def test_processes_on_one_folder_at_the_same_time_compute_a_drop_once(pad):
    shutil.rmtree(pad / "softfall-runs")
    children = [subprocess.Popen(command("run", *more), cwd=pad, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
                for more in ([], [], ["thickness=60"])]
    printed = [child.communicate()[0] for child in children]
    assert [child.returncode for child in children] == [0] * 3
    assert printed[0] == printed[1] != printed[2]
    assert len({path.parent for path in pad.rglob("results.h5") if "latest" not in path.parts}) == 2


def test_a_link_as_the_output_is_followed_and_kept(pad, tmp_path):
    (tmp_path / "disk").mkdir()
    (pad / "out").symlink_to(tmp_path / "disk")
    printed = run("-o", "out", cwd=pad)
    assert (pad / "out").is_symlink() and (pad / page(printed)).is_file() and list((tmp_path / "disk").rglob("results.h5"))
    (pad / "away").symlink_to(tmp_path / "nowhere")
    assert "away cannot be written to" in run("-o", "away", cwd=pad, code=3)
    assert "case.cfg cannot be written to" in run("-o", "case.cfg", cwd=pad, code=3)


def test_a_users_own_folder_called_latest_stays(pad):
    (pad / "softfall-runs/latest").unlink()
    (pad / "softfall-runs/latest").mkdir()
    run(cwd=pad)
    assert not (pad / "softfall-runs/latest").is_symlink()


def test_a_drop_onto_the_anvil_fails_with_its_page_and_is_not_computed_again(pad):
    first = told("velocity=30 m/s", cwd=pad)
    assert first.returncode == 5 and "Verdict: do not use" in first.stdout and "anvil" in first.stderr and (pad / page(first.stdout)).is_file()
    assert "\r" not in first.stderr and [stage for stage in STAGES[:2] if stage not in first.stderr] == []  # a log has plain lines
    before = stamps(pad)
    again = told("velocity=30 m/s", cwd=pad)
    assert (again.returncode, again.stdout) == (5, first.stdout) and again.stderr.splitlines()[-1] == first.stderr.splitlines()[-1] and stamps(pad) == before


def test_strict_has_the_exit_codes_of_softfall_post(pad):
    run("--strict", cwd=pad, code=8)
    run(cwd=pad)


@pytest.mark.slow
def test_every_drop_of_a_series_is_told(tmp_path):
    coarse = ("series", "drops=2", "fine_spacing=20", "outer_spacing=20", "element_size=20", "mesh_error_limit=1")
    printed = run(*coarse, cwd=tmp_path)
    assert "Verdict, drop 1 of 2:" in printed and "Verdict, drop 2 of 2:" in printed
    assert run(*coarse, cwd=tmp_path) == printed


def test_a_prescribed_motion_has_a_stress(tmp_path):
    assert "peak stress" in run("compression", "geometry.parameters.spacing=25", "end_time=20 ms", cwd=tmp_path)


@pytest.mark.parametrize("words, code, sentence", [
    (["thicknes=60"], 2, "unknown key 'thicknes'; did you mean 'thickness'?"),
    (["Velocity=5 m/s"], 2, "unknown key 'Velocity'; did you mean 'velocity'?"),
    (["hight=1 m"], 2, "did you mean 'height'?"),
    (["group=pad"], 2, "'group' is the end of several keys: missile.group, pad.group, support.group; write one of them in full"),
    (["missile.velocty=3 m/s"], 2, 'unknown key "velocty" in group missile (did you mean "velocity"?)'),
    (["velocity=5 kg"], 2, 'softfall run: missile.velocity: "5 kg" is a mass; expected a speed, for example "4.5 m/s"'),
    (["velocity=5"], 2, "softfall run: missile.velocity: the value is a plain number; expected a speed"),
    (["velocity=-5 m/s"], 2, "missile.velocity"),
    (["thickness=60 kg"], 2, 'geometry.parameters.thickness must be a number without a unit (this geometry is in mm), or a length such as "60 mm", not "60 kg"'),
    (["thickness=thick"], 2, 'or a length such as "60 mm", not "thick"'),
    (["velocity=5.2", "m/s"], 64, 'unexpected \'m/s\': quote values that contain blanks: velocity="5.2 m/s"'),
    (["thickness=60", "thickness=70"], 2, "thickness is given twice: 60 and 70"),
    (["thickness=60", "geometry.parameters.thickness=70"], 2, "geometry.parameters.thickness is given twice: 60 and 70"),
    (["thickness="], 2, "thickness= has no value"),
    (["height=3 kg"], 2, 'height="3 kg" is outside 0 to 100 m; expected a length, such as "1.3 m"'),
    (["height=-1 m"], 2, "outside 0 to 100 m"),
    (["height=1 m", "velocity=3 m/s"], 2, "both set the speed"),
    (["rig=8 m/s2"], 2, 'rig= belongs to a height'),
    (["height=1 m", "rig=12 m/s2"], 2, "is outside 0 to 9.80665 m/s2"),
    (["height=1 m", "rig=nowhere.csv"], 2, "nowhere.csv"),
    (["--threads=0"], 2, "--threads=0 is not a number from 1 on"),
    (["--frobnicate"], 64, "unrecognized arguments: --frobnicate"),
])
def test_what_is_wrong_is_told_in_one_sentence(tmp_path, place, words, code, sentence):
    said = told(place / "pad/case.cfg", *words, cwd=tmp_path)
    assert said.returncode == code and sentence in said.stderr
    assert said.stderr.startswith("softfall run: ") and said.stderr.count("\n") == (2 if "--frob" in words[0] else 1)
    assert not said.stdout and not list(tmp_path.iterdir())


def test_a_case_that_is_not_there_is_told(tmp_path):
    assert "`softfall new pad` makes one" in run(cwd=tmp_path, code=2)
    assert "nowhere.cfg cannot be read" in run("nowhere.cfg", cwd=tmp_path, code=2)
    assert 'no example "eva50-v45" (did you mean "eva50-v4.5"?)' in run("eva50-v45", cwd=tmp_path, code=2)


def test_lengths_heights_and_short_keys(case, tmp_path):
    values, said = run_keys.resolve(case, {"thickness": "6 cm", "height": "1.3 m", "mass": "5 kg"})
    assert values == {"geometry.parameters.thickness": "60", "missile.mass": "5 kg", "missile.velocity": f"{(2 * 9.80665 * 1.3) ** 0.5:.9g} m/s"}
    assert len(said) == 3 and "free fall" in said[-1]
    assert run_keys.find_key(case, "density") == "material.density"  # a membrane is absent
    assert run_keys.find_key(case, "geometry.parameters.side") == "geometry.parameters.side" and run_keys.find_key(case, "material") == "material"
    (tmp_path / "rig.csv").write_text("height (m),speed (m/s)\n1,4\n2,5.6568542\n")
    assert run_keys.fall_speed("0.5 m", str(tmp_path / "rig.csv"))[0] == pytest.approx(8 ** 0.5, rel=1e-6)
    case.update({**values})


def test_a_length_has_the_unit_of_its_own_geometry(case):
    lengths = {"diameter": "16 cm", "thickness": "6 cm"}
    for given, expected in (({}, ("160", "60")), ({"missile_length_unit": "cm"}, ("16", "60")), ({"geometry.length_unit": "m"}, ("0.16", "0.06")),
                            ({"length_unit": "m", "missile_length_unit": "cm"}, ("16", "0.06"))):
        values, _ = run_keys.resolve(case, {**lengths, **given})
        assert (values["geometry.missile_parameters.diameter"], values["geometry.parameters.thickness"]) == expected, given


def test_a_parameter_that_only_the_geometry_names_is_found(pad):
    text = (pad / "case.cfg").read_text()
    (pad / "case.cfg").write_text(re.sub(r"  parameters = .*", "  parameters = { quarter = 1; };", text, count=1))
    case = softfall.Case(pad / "case.cfg")
    assert run_keys.find_key(case, "zone_side") == "geometry.parameters.zone_side"
    assert {"geometry.parameters.thickness", "geometry.parameters.quarter", "geometry.missile_parameters.diameter"} <= run_keys.defined(case)


def on_a_terminal(*words, cwd, columns=80):
    """Runs a drop on a terminal of so many columns, and returns what it writes there."""
    ours, theirs = pty.openpty()
    child = subprocess.Popen(command("run", *words), cwd=cwd, stdin=theirs, stdout=theirs, stderr=theirs, env={**os.environ, "COLUMNS": str(columns)})
    os.close(theirs)
    written = b""
    while True:
        try:
            piece = os.read(ours, 65536)
        except OSError:
            break
        written += piece
        if not piece:
            break
    os.close(ours)
    assert child.wait() == 0
    return written.decode()


@pytest.mark.slow
def test_a_terminal_has_one_line_of_progress(pad):
    written = on_a_terminal(*SLOW, "thickness=55", cwd=pad)
    bars = [piece for piece in re.split(r"[\r\n]+", written) if " %" in piece and "[" in piece]
    percents = [int(re.search(r"(\d+) %", bar)[1]) for bar in bars]
    assert len(bars) >= 3 and percents == sorted(percents) and all(len(bar) <= 79 for bar in bars)
    assert any("left" in bar for bar in bars) and written.rstrip().endswith("not a certification.")
    assert "%" not in on_a_terminal(*SLOW, "thickness=55", cwd=pad).partition("Verdict")[0]  # it is there


@pytest.mark.slow
def test_a_narrow_terminal_and_a_log(pad):
    narrow = on_a_terminal("thickness=54", cwd=pad, columns=40)
    assert all(len(bar) <= 39 for bar in re.split(r"[\r\n]+", narrow) if "[" in bar)
    log = subprocess.run(command("run", "thickness=56"), cwd=pad, capture_output=True, text=True)
    assert "\r" not in log.stderr + log.stdout and [line.split(":")[0].split(",")[0] for line in log.stderr.splitlines() if "%" in line and "warning" not in line] == \
        ["building the model", "solving the drop", "figures and report"]
    assert told("thickness=57", "-q", cwd=pad).stderr.count("%") <= 1  # a warning
