# SPDX-License-Identifier: GPL-3.0-or-later
"""Drops in memory: keys by content, figures as of the programs, and what a study refuses."""
from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import softfall
from softfall import library, memory, programs, worker

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
COARSE = ["geometry.parameters.fine_spacing=20.0", "geometry.parameters.outer_spacing=40.0", "pad.mesh_error_limit=9.0"]


def test_a_drop_in_memory_has_the_figures_of_the_programs(tmp_path: Path) -> None:
    path = str(EXAMPLES / "eva50-v4.5/case.cfg")
    with memory.Inputs(path, COARSE) as inputs:
        run = inputs.run(str(tmp_path / "shared"), section=True)
        assert inputs.has_files(run.files) and not inputs.has_files(run.files.replace("pad.geo", "gone.geo"))
    drop = softfall.Case(path, dict(text.split("=") for text in [*COARSE, "output.frame_interval=1000 s"])).run(output=tmp_path / "run", threads=1)
    own = run.drops[0]
    assert library.GRADES[own.grade] == drop.verdict and own.verdict.startswith(drop.verdict)
    assert {"hic", "local_collapse", "cells", "a_max_mesh_error"} <= own.figures.keys()
    for key, value in own.figures.items():
        if key not in ("wall_s", "threads"):
            assert value == pytest.approx(float(drop.figures[key]), rel=1e-8, nan_ok=True), key


def test_the_key_is_of_the_content(tmp_path: Path) -> None:
    shutil.copytree(EXAMPLES.parent / "geo", tmp_path / "geo")
    shutil.copytree(EXAMPLES / "eva50-v4.5", tmp_path / "examples/eva50-v4.5")
    shutil.copytree(EXAMPLES / "materials", tmp_path / "examples/materials", ignore=shutil.ignore_patterns("*posterior*"))

    def key(folder: Path, *overrides: str) -> str:
        with memory.Inputs(str(folder / "eva50-v4.5/case.cfg"), overrides) as inputs:
            inputs.check()
            return inputs.key()

    here = key(EXAMPLES)
    assert here == key(tmp_path / "examples") != key(EXAMPLES, "missile.velocity=4.6 m/s")
    (tmp_path / "geo/pad.geo").write_text((tmp_path / "geo/pad.geo").read_text() + "// another\n")
    assert key(tmp_path / "examples") != here
    with memory.Inputs(str(EXAMPLES / "eva50-v4.5/case.cfg"), ["geometry.parameters.thicknes=40"]) as inputs:
        with pytest.raises(softfall.InputError, match="thicknes"):
            inputs.check()


def test_a_series_is_judged_by_the_drops_that_count(tmp_path: Path) -> None:
    with memory.Inputs(str(EXAMPLES / "series/case.cfg"), [*COARSE, "series.drops=2", "series.counted=[2]"]) as inputs:
        counted, run = inputs.counted(), inputs.run(str(tmp_path / "shared"))
    assert counted == [False, True]
    judged = memory.judge(run.drops, counted)
    assert judged.figures["hic"] == run.drops[1].figures["hic"] > run.drops[0].figures["hic"]
    assert judged.figures["steps"] == sum(drop.figures["steps"] for drop in run.drops)


def test_a_later_drop_without_keys_of_its_own_has_the_first_missile(tmp_path: Path) -> None:
    """Not that of the drop before it, which here is slower."""
    drops = ["{ }", '{ velocity = "2 m/s"; }', "{ }"]
    with memory.Inputs(str(EXAMPLES / "eva50-axisymmetric/case.cfg"), ["pad.mesh_error_limit=9.0", "geometry.parameters.fine_spacing=20.0", 'series.interval="3 s"', 'solver.end_time="90 ms"',
                                                                       f"series.drops=({', '.join(drops)})"]) as inputs:
        first, slow, last = (drop.figures["a_max_g"] for drop in inputs.run(str(tmp_path / "shared")).drops)
    assert slow < 0.5 * first and last == pytest.approx(first, rel=0.1)


def test_the_programs_are_part_of_the_key() -> None:
    assert len(memory.programs_hash()) == 16 and (programs.folder() / "softfall-mesh").exists()


def test_another_library_takes_no_domains_of_the_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Python is the program of both, and a newer library may make other domains of the same mesh."""
    monkeypatch.delenv("SOFTFALL_SHARE", raising=False)
    case, shared = str(EXAMPLES / "eva50-axisymmetric/case.cfg"), tmp_path / "shared"
    for part in ("bin", "lib"):
        shutil.copytree(programs.folder().parent / part, tmp_path / "copy" / part, symlinks=True)
    monkeypatch.setenv("SF_BIN_DIR", str(tmp_path / "copy/bin"))
    text = f"from softfall import memory\nwith memory.Inputs({case!r}, {COARSE!r}) as drop: drop.run({str(shared)!r})"
    made = []
    for _ in range(3):
        subprocess.run([sys.executable, "-c", text], check=True)
        made.append(len(list(shared.glob("domains-*"))))
        if len(made) == 2:
            with open(tmp_path / "copy/lib/libsoftfall-build.so", "ab") as library_file:
                library_file.write(b"another")
    assert made == [1, 1, 2]


def test_a_free_worker_serves_the_next_pool(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that has ended, or began with other settings, does not, nor one of a fit, which keeps models."""
    def process() -> int:
        with worker.Pool(1, tmp_path / "shared") as pool:
            assert pool.start(worker.Task("key", "absent.cfg", [])).result().message
            return pool._all[0]._process.pid

    with worker.kept():
        first = process()
        assert process() == first
        monkeypatch.setenv("SOFTFALL_MEMORY_MB", "4000")
        second = process()
        assert second != first and process() == second
        os.kill(second, signal.SIGKILL)
        os.waitid(os.P_PID, second, os.WEXITED | os.WNOWAIT)
        assert process() != second
        with worker.Pool(1, tmp_path / "shared", "softfall.fit.work") as pool:
            pool._all.append(fits := worker._begin("softfall.fit.work"))
            pool._free.get()
            pool._free.put(fits)
        assert not fits.is_alive()


def test_what_the_solver_notes_of_a_foam_is_part_of_the_verdict(tmp_path: Path) -> None:
    """The library that solves is another one than that which has read the foam."""
    values = ["geometry.parameters.thickness=40", f"material=@{EXAMPLES}/materials/leap.cfg", *COARSE]
    with memory.Inputs(str(EXAMPLES / "eva50-v4.5/case.cfg"), values) as inputs:
        own = inputs.run(str(tmp_path / "shared"), section=True).drops[0]
    case = softfall.Case(EXAMPLES / "eva50-v4.5/case.cfg", dict(text.split("=") for text in values))
    remarks = case.run(output=tmp_path / "run", threads=1).verdict.remarks
    assert any("near the pole" in remark for remark in remarks) and own.verdict.endswith(f"; and {len(remarks) - 3} more")
