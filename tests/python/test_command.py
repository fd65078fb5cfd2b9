# SPDX-License-Identifier: GPL-3.0-or-later
"""The command softfall: its help, its words, and failures in one sentence."""
import os
import re
import subprocess

import pytest

import softfall
from conftest import BIN
from softfall.command import COMMANDS, PROGRAMS


def says(*words, program="softfall"):
    told = subprocess.run([str(BIN / program), *words], capture_output=True, text=True)
    return told.returncode, told.stdout, told.stderr


def test_the_help_lists_every_command():
    code, text, _ = says("--help")
    assert code == 0 and all(f"\n  {name} " in text for name in [*COMMANDS, *PROGRAMS])
    code, _, text = says()
    assert code == 64 and text.startswith("Usage: softfall WORD")


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_help_and_version(name):
    code, text, _ = says(name, "--help")
    assert code == 0 and text.startswith(f"Usage: softfall {name}") and "--version" in text
    assert says(name, "--version") == (0, f"softfall {name} {softfall.version()}\n", "")


def test_a_word_that_is_none_is_refused_with_the_nearest_one():
    assert says("protcol") == (64, "", "softfall: unknown command 'protcol'; did you mean 'protocol'?\n")
    code, _, text = says("xyzzy")
    assert code == 64 and all(name in text for name in COMMANDS) and text.count("\n") == 1
    assert says("protocol", "--frobnicate")[0] == 64


def test_a_failure_is_one_sentence():
    code, out, text = says("protocol", "nowhere.toml", "-o", "out", "--pad", "pad/case.cfg")
    assert (code, out) == (2, "") and text == "softfall protocol: nowhere.toml cannot be read: No such file or directory\n"


def test_the_old_name_is_the_same_command():
    assert says("--list", program="softfall-protocol") == says("protocol", "--list")


@pytest.mark.parametrize("name", PROGRAMS)
def test_a_word_is_the_program_of_its_name(name):
    assert says(name, "--help") == says("--help", program=f"softfall-{name}")
    assert says(name, "--frobnicate")[0] == says("--frobnicate", program=f"softfall-{name}")[0] != 0


def test_a_python_without_a_module_is_told_its_package(tmp_path):
    (tmp_path / "sitecustomize.py").write_text("import sys; sys.modules['h5py'] = None\n")
    told = subprocess.run([str(BIN / "softfall"), "run"], capture_output=True, text=True, env={**os.environ, "PYTHONPATH": str(tmp_path)})
    assert told.returncode == 1 and told.stderr.count("\n") == 1
    assert re.match(r"softfall: softfall needs h5py, which \S+ does not have: apt-get install python3-h5py, or take the Python that has it", told.stderr)
