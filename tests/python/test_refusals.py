# SPDX-License-Identifier: GPL-3.0-or-later
"""What the programs and the package refuse, or tell, in one sentence: damaged results, contradicting options, files of others, wrong arguments."""
import json
import pathlib
import shutil
import subprocess

import h5py
import numpy as np
import pytest

import softfall
from softfall import laboratory
from conftest import BIN, command_here


def started(name, *arguments, cwd="."):
    return subprocess.run([str(BIN / f"softfall-{name}"), *map(str, arguments)], cwd=cwd, capture_output=True, text=True)


# ---- results that are not as softfall-solve wrote them ----

def edited(path):
    with h5py.File(path, "r+") as file:
        file["history/acceleration"][...] = 0.5 * file["history/acceleration"][...]


def a_byte_short(path):
    path.write_bytes(path.read_bytes()[:-1])


def without_checksum(path):
    path.write_bytes(path.read_bytes()[:-24])


@pytest.mark.parametrize("change", [edited, a_byte_short, without_checksum])
def test_results_without_their_checksum_are_refused(drop, tmp_path, change):
    path = tmp_path / "results.h5"
    shutil.copy(drop.results, path)
    assert started("post", path, "-o", tmp_path / "sound").returncode == 0
    change(path)
    told = started("post", path, "-o", tmp_path / "out")
    assert told.returncode == 3 and "does not end with its checksum: it was cut, or another program has changed it" in told.stderr
    assert not (tmp_path / "out").exists()
    with pytest.raises(softfall.Error, match="does not end with its checksum"):
        softfall.read_results(path)


# ---- options that contradict each other ----

def test_an_option_is_given_once(case, tmp_path):
    told = started("pre", case.path, "-o", tmp_path / "a.h5", "-o", tmp_path / "b.h5")
    assert told.returncode == 64 and "--output is given twice" in told.stderr and not list(tmp_path.iterdir())
    told = command_here("read", "x.csv", "-o", "a.csv", "-o", "b.csv")
    assert told.returncode == 64 and "-o is given twice: a.csv and b.csv" in told.stderr
    told = command_here("run", case.path, "--output=a", "-o", "b")
    assert told.returncode == 64 and "is given twice: a and b" in told.stderr
    told = command_here("protocol", "own", "--pad", case.path, "--set", "missile.mass=4 kg", "--set", "missile.mass=5 kg", "-o", tmp_path / "out")
    assert told.returncode == 2 and "--set missile.mass=5 kg contradicts --set missile.mass=4 kg" in told.stderr


def test_a_value_that_a_later_one_replaces_is_told(case, tmp_path):
    told = started("pre", case.path, "-o", tmp_path / "a.h5", "--set", "missile.mass=4 kg", "--set", "missile.mass=4 kg", "--set", "missile.mass=5 kg")
    assert told.returncode == 0 and "warning: --set missile.mass=4 kg is replaced by the later --set missile.mass=5 kg" in told.stderr
    told = started("pre", case.path, "-o", tmp_path / "b.h5", "--axisymmetric", "--set", 'geometry.model="solid"')
    assert told.returncode == 2 and '--axisymmetric contradicts --set geometry.model="solid"' in told.stderr


@pytest.mark.parametrize("word, near", [("compress", "compression"), ("compresion", "compression")])
def test_a_command_that_is_nearly_known_is_named(word, near):
    told = started("fit", word)
    assert told.returncode == 2 and f"unknown command '{word}' (did you mean \"{near}\"?)" in told.stderr


def test_an_empty_name_is_refused(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "case.cfg").write_text("")
    told = command_here("run", "")
    assert told.returncode == 2 and "CASE is empty" in told.stderr
    for words in (["run", "-o", ""], ["read", "x.csv", "--output="], ["protocol", "own", "-o", ""]):
        told = command_here(*words)
        assert told.returncode == 64 and "is empty: give a value" in told.stderr, words


# ---- arguments of the package ----

def test_wrong_arguments_of_the_package_get_a_sentence(case):
    for wrong in (None, 3, "", b""):
        with pytest.raises(softfall.InputError, match="is the path of its file, not"):
            softfall.Case(wrong)
        with pytest.raises(softfall.InputError, match="is the path of its file, not"):
            softfall.read_results(wrong)
        with pytest.raises(softfall.InputError, match="is the path of its file, not"):
            softfall.read_record(wrong)
    assert softfall.function(str(case.path), "missile.velocity [m/s]", "hic").case["missile.mass"] == case["missile.mass"]
    assert softfall.cards.Foam


@pytest.mark.parametrize("name, said", [
    ("missile.velocity", 'write "missile.velocity [m/s]"'), ("missile.velocity [kg]", 'write "missile.velocity [m/s]"'), ("material.HU [m]", "without a unit: leave"),
    ("material.law", "is no number that could be an input"), ("pad.fixed", "is no number that could be an input"),
    ("geometry.parameters.thicknes", "there is no parameter of the geometry"), ("geometry.parameters.thickness [mm]", "is a number without a unit"),
    ("missile.velocitty [m/s]", "there is no key of the case"), ("missile.velocity [furlong]", "furlong"),
])
def test_an_input_that_no_drop_can_take_is_refused_at_once(case, name, said):
    with pytest.raises((softfall.InputError, KeyError)) as refused:
        softfall.function(case, [name], "hic")
    assert said in str(refused.value)
    told = command_here("serve", case.path, "--input", name, "--output", "hic")
    assert told.returncode == 2 and said in told.stderr


@pytest.mark.parametrize("name", ["missile.velocity [m/s]", "missile.velocity [mph]", "material.HU", "geometry.parameters.thickness", "material.ED [MPa]", "material.density [kg/m3]"])
def test_an_input_that_a_drop_can_take_is_taken(case, name):
    assert softfall.function(case, name, "hic").inputs[0][0] == name.partition(" ")[0]


# ---- files of laboratories ----

def record(path, time, heading="Time (ms),Acceleration (g)"):
    value = 50 * np.exp(-((time - time.mean()) / 2) ** 2)
    np.savetxt(path, np.column_stack([time, value]), delimiter=",", header=heading, comments="", fmt="%.7g")
    return path


def test_lost_samples_are_told(tmp_path):
    time = np.arange(0, 40, 0.05)
    assert "gap" not in laboratory.read(record(tmp_path / "whole.csv", time)).words
    words = laboratory.read(record(tmp_path / "gap.csv", np.delete(time, range(100, 131)))).words
    assert "1 gap in the times, of 1.6 ms at 4.95 ms, where samples are 0.05 ms apart: 31 samples are lost" in words
    words = laboratory.read(record(tmp_path / "gaps.csv", np.delete(time, [*range(100, 131), 400]))).words
    assert "2 gaps in the times, the longest of 1.6 ms" in words and "32 samples are lost" in words
    with pytest.raises(softfall.InputError, match="does not follow"):
        laboratory.read(record(tmp_path / "twice.csv", np.insert(time, 300, time[300])))
    (tmp_path / "press.csv").write_text("time_s,strain,stress_kPa\n" + "".join(f"{t},{0.01 * k},{k}\n" for k, t in enumerate([0, 1, 2, 3, 3, 4, 5, 6, 20, 21])))
    words = laboratory.read(tmp_path / "press.csv").words
    assert "1 time not after the one before, first 3000 ms" in words and "1 gap in the times, of 1.4e+04 ms at 6000 ms" in words


@pytest.mark.parametrize("options, said", [
    (["--area=25 cm2"], "area has no meaning"), (["--thickness=50 mm"], "thickness has no meaning"), (["--lateral=x"], "lateral has no meaning"),
    (["--invert=stress"], 'leave --invert "stress" out, or give acceleration'), (["--units=ms,g,N"], "3 units for 2 columns"), (["--scale=5 kN/V"], 'takes the scale "5 kN/V"'),
    (["--column=nothing"], 'no column is called "nothing"'),
])
def test_an_option_that_nothing_is_read_by_is_refused(tmp_path, options, said):
    path = record(tmp_path / "whole.csv", np.arange(0, 40, 0.05))
    told = command_here("read", path, *options)
    assert told.returncode == 2 and said in told.stderr


def test_a_speed_without_a_unit_is_asked_for_one(tmp_path):
    from test_protocol import MAT
    folder = pathlib.Path(shutil.copytree(MAT.parent, tmp_path / "measured"))
    lines = (folder / "list.csv").read_text().splitlines()
    lines[0] += ";speed" if ";" in lines[0] else ",speed"
    (folder / "list.csv").write_text("\n".join([lines[0], *(line + (";3.4" if ";" in lines[0] else ",3.4") for line in lines[1:])]))
    told = command_here("protocol", MAT, "--measured", folder, "-o", tmp_path / "out")
    assert told.returncode == 2 and 'speed: "3.4" has no unit; expected a speed, such as "3.4 m/s"' in told.stderr


def test_only_what_comes_again_says_so(tmp_path, monkeypatch):
    monkeypatch.setattr("softfall.read_program.perform", lambda o: (_ for _ in ()).throw(KeyboardInterrupt))
    told = command_here("read", record(tmp_path / "whole.csv", np.arange(0, 40, 0.05)))
    assert told.returncode == 130 and told.stderr == "softfall read: interrupted\n"


# ---- folders of others ----

def test_a_protocol_leaves_the_folder_of_its_drops_alone(tmp_path):
    from test_protocol import MAT
    folder = pathlib.Path(shutil.copytree(MAT.parent, tmp_path / "measured"))
    before = sorted(path.name for path in folder.iterdir())
    for output in (folder, tmp_path / "none" / ".." / "measured"):
        told = command_here("protocol", MAT, "--measured", folder, "-o", output)
        assert told.returncode == 2 and "is the folder of the measured drops" in told.stderr
    assert sorted(path.name for path in folder.iterdir()) == before


def test_a_protocol_replaces_its_own_report_alone(tmp_path):
    from test_protocol import MAT
    out = tmp_path / "out"
    out.mkdir()
    (out / "report.html").write_text("mine")
    told = command_here("protocol", MAT, "--measured", MAT.parent, "-o", out, "--force")
    assert told.returncode == 2 and "no protocol.json of softfall" in told.stderr and (out / "report.html").read_text() == "mine"
    (out / "report.html").unlink()
    assert command_here("protocol", MAT, "--measured", MAT.parent, "-o", out).returncode == 0
    assert command_here("protocol", MAT, "--measured", MAT.parent, "-o", out, "--force").returncode == 0
    assert json.loads((out / "protocol.json").read_text())["protocol"] == "mat"
