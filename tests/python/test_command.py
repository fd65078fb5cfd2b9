# SPDX-License-Identifier: GPL-3.0-or-later
"""The command softfall: its help, its words, and failures in one sentence."""
import subprocess

import pytest

import softfall
from conftest import BIN
from softfall.command import COMMANDS


def says(*words, program="softfall"):
    told = subprocess.run([str(BIN / program), *words], capture_output=True, text=True)
    return told.returncode, told.stdout, told.stderr


def test_the_help_lists_every_command():
    code, text, _ = says("--help")
    assert code == 0 and all(f"\n  {name} " in text for name in COMMANDS)
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
