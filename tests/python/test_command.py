# SPDX-License-Identifier: GPL-3.0-or-later
"""The command softfall: its help, its words, and failures in one sentence."""
import os
import pathlib
import re
import shutil
import subprocess

import pytest

import softfall
from conftest import BIN, command_here
from softfall.command import COMMANDS, PROGRAMS

SOURCE = pathlib.Path(os.environ["SF_SOURCE_DIR"])


def says(*words, program="softfall"):
    """What a program says; a command of Python runs within this process."""
    here = program == "softfall" and words and words[0] in COMMANDS
    told = command_here(*words) if here else subprocess.run([str(BIN / program), *words], capture_output=True, text=True)
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


@pytest.mark.parametrize("content, said", [
    (b"a = " + b"[" * 100000, "nested too deep"), (b"\0", "TOML|Illegal|Invalid|invalid"), (b"\xff", "utf-8"), (b"title = 3", "title = 3 is not a text"),
    (b"title = 'a'\nstandard = 'b'\n[missile]\n[drops]\ncount = 1000000000\n[result]\nkind = 'pass'\n[[figure]]\nkey = 'hic'\n"
     b"[[clause]]\nof = 'drops'\ntext = 'a'\nsource = 'b'\nstatus = 'unconfirmed'\n", "from 1 to 20"),
    (b"title = 'a'\nstandard = 'b'\n[missile]\n[drops]\n[result]\nkind = 'pass'\n[[figure]]\nkey = 'hic'\nlimit = 1" + b"0" * 400, "limit is not a finite"),
    (b"title = 'a'\n'\\u001b[31m' = 1", "no key"),
])
def test_a_protocol_that_cannot_be_meant_is_refused_in_one_sentence(tmp_path, content, said):
    (tmp_path / "p.toml").write_bytes(content)
    code, out, text = says("protocol", str(tmp_path / "p.toml"), "-o", str(tmp_path / "out"), "--measured", str(tmp_path))
    assert (code, out) == (2, "") and re.search(said, text) and text.count("\n") == 1 and "Traceback" not in text and "\x1b" not in text, text


def test_what_is_no_plain_file_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "device.toml").symlink_to("/dev/zero")
    os.mkfifo(tmp_path / "list.csv")
    for words in (["protocol", "own", "--measured", tmp_path, "-o", tmp_path / "out"], ["protocol", tmp_path / "device.toml", "--measured", tmp_path, "-o", tmp_path / "out"],
                  ["protocol", "own", "--measured", tmp_path, "-o", tmp_path / "out", "--laboratory", tmp_path / "pipe"], ["read", tmp_path / "pipe"],
                  ["foam", "show", tmp_path / "pipe"], ["foam", "convert", tmp_path / "pipe", "-o", tmp_path / "out"]):
        code, out, text = says(*map(str, words))
        assert (code, out) == (2, "") and text.count("\n") == 1, text


def test_a_line_of_a_hundred_thousand_columns_is_refused(tmp_path):
    (tmp_path / "wide.csv").write_text(",".join(["a (g)"] * 100000) + "\n")
    code, _, text = says("read", str(tmp_path / "wide.csv"))
    assert code == 2 and "100000 columns" in text and text.count("\n") == 1


def test_an_output_is_no_input_however_it_is_spelled(tmp_path):
    for name in ("eva35.cfg", "eva35.csv"):
        shutil.copy(SOURCE / "examples/materials" / name, tmp_path)
    (tmp_path / "soft.csv").symlink_to("eva35.csv")
    os.link(tmp_path / "eva35.csv", tmp_path / "hard.csv")
    before = (tmp_path / "eva35.csv").read_bytes()
    for name in ("eva35.cfg", "eva35.csv", "soft.csv", "hard.csv", f"../{tmp_path.name}/eva35.csv"):
        code, _, text = says("foam", "export", str(tmp_path / "eva35.cfg"), "--format=dyna", "--units=mm-ms-kg-GPa", "-f", "-o", f"{tmp_path}/{name}")
        assert code == 2 and "would replace an input" in text, text
    code, _, text = says("read", str(tmp_path / "eva35.csv"), "--kind=compression", "-f", "-o", str(tmp_path / "hard.csv"))
    assert code == 2 and text.count("\n") == 1
    assert (tmp_path / "eva35.csv").read_bytes() == before


@pytest.mark.drawn
def test_a_name_with_a_dollar_is_no_formula(tmp_path):
    shutil.copy(SOURCE / "examples/materials/eva35.csv", tmp_path)
    (tmp_path / "d.cfg").write_text("# $x_{$ foam\n" + (SOURCE / "examples/materials/eva35.cfg").read_text())
    assert says("foam", "plot", str(tmp_path / "d.cfg"), "-o", str(tmp_path / "d.png"))[0] == 0


def test_a_full_disk_is_one_sentence():
    with open("/dev/full", "w") as full:
        told = subprocess.run([str(BIN / "softfall"), "protocol", "--list"], stdout=full, stderr=subprocess.PIPE, text=True)
    assert told.returncode == 3 and told.stderr == "softfall protocol: No space left on device\n"
