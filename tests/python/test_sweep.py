# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall sweep: rows as of softfall-pre, -solve and -post, kills, two processes, moved folders, full disks, changed inputs; what the report states."""
from __future__ import annotations

import ast
import contextlib
import csv
import fcntl
import json
import os
import random
import re
import resource
import shutil
import signal
import sqlite3
import subprocess
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import softfall
from softfall import campaign, effects, memory, plan as plans, rows_command, samples, sweep_page
from softfall.store import Store
from conftest import command_here

BIN, EXAMPLES = Path(os.environ["SF_BIN_DIR"]), Path(__file__).resolve().parents[2] / "examples"
SET = '"geometry.parameters.fine_spacing=25.0", "geometry.parameters.outer_spacing=40.0", "pad.mesh_error_limit=9.0"'
SPEEDS = '{ key = "missile.velocity"; name = "speed"; from = "3 m/s"; to = "4 m/s"; count = %d; }'


def write_plan(folder: Path, factors: str, more: str = "", case: str = "eva50-axisymmetric") -> Path:
    path = folder / "plan.cfg"
    path.write_text(f'case = "{EXAMPLES}/{case}/case.cfg"; title = "A <plan>";\nset = [{SET}];\nfactors = (\n{factors} );\n{more}\n')
    return path


def start(*words: object, **options: Any) -> subprocess.Popen[str]:
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    return subprocess.Popen([str(BIN / "softfall"), "sweep", *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment, **options)


def sweep(*words: object, code: int = 0, cwd: Path | None = None) -> str:
    """Runs the command within this process, and returns what it prints."""
    with contextlib.chdir(cwd or "."):
        done = command_here("sweep", *words)
    assert done.returncode == code, done.stdout + done.stderr
    return done.stdout if code == 0 else done.stderr


def table(folder: Path, *left_out: str) -> list[dict[str, str]]:
    """Returns runs.csv without what is of the machine."""
    with open(folder / "runs.csv", encoding="utf-8", newline="") as file:
        return [{key: text for key, text in row.items() if key not in ("wall_s", "threads", "folder", *left_out)} for row in csv.DictReader(file)]


def done(folder: Path) -> dict[str, float]:
    """Returns the finished drops of a store with their times."""
    if not (folder / "drops.sqlite").exists():
        return {}
    with contextlib.closing(sqlite3.connect(folder / "drops.sqlite", timeout=60)) as data:
        if not data.execute("SELECT name FROM sqlite_master WHERE name = 'drops'").fetchone():
            return {}  # it was begun just now
        return dict(data.execute("SELECT key, seconds FROM drops WHERE state = 'done'").fetchall())


def _of_programs(key: str) -> bool:
    """True of figures that do not depend on the machine, nor on drops of the section, which a study leaves out."""
    return not re.search(r"mesh|scatter|change|wall_s|threads|frames|below_anvil", key)


@pytest.mark.drawn
def test_rows_are_those_of_the_programs_and_are_found_again(tmp_path: Path) -> None:
    foams = f'{{ key = "material"; name = "foam"; uncertain = true; files = ["{EXAMPLES}/materials/eva35.cfg", "{EXAMPLES}/materials/leap.cfg"]; }}'
    path = write_plan(tmp_path, f'{{ key = "missile.velocity"; name = "speed"; values = ["3 m/s", "30 m/s"]; }}, {foams}')
    said = sweep(path, "-o", tmp_path / "out", "--jobs", "1", "--views", "worst")
    assert "4 drops simulated, 0 were there" in said and "4 runs: " in said
    ours = table(tmp_path / "out")
    for row in ours:
        values = dict(text.split("=", 1) for text in ast.literal_eval(f"[{SET}]")) | {"material": f"@{row['foam']}", "missile.velocity": f"{row['speed (m/s)']} m/s"}
        case = softfall.Case(EXAMPLES / "eva50-axisymmetric/case.cfg", values)
        if row["run_status"] == "failed":
            with pytest.raises(softfall.NumericError) as caught:
                case.run(runs=tmp_path / "programs")
            assert row["message"] in str(caught.value)
            continue
        figures = case.run(runs=tmp_path / "programs").figures
        different = [key for key in memory.figure_keys() if _of_programs(key) and row[key] != campaign._cell(float(figures[key]))]
        assert not different and row["status"] == figures["status"]
    assert {row["run_status"] for row in ours} == {"done", "failed"}
    page, summary = (tmp_path / "out/report.html").read_text(), json.loads((tmp_path / "out/sweep.json").read_text())
    assert "A &lt;plan&gt;" in page and "Probability of staying below the limits" in page and summary["runs"] == 4
    view = summary["views"][0]
    assert (tmp_path / "out/views" / view["folder"] / "report.html").exists() and f"views/{view['folder']}/report.html" in page
    assert "0 drops simulated, " in sweep(path, "-o", tmp_path / "out")
    shutil.copytree(EXAMPLES / "materials", tmp_path / "materials")
    path.write_text(path.read_text().replace(f"{EXAMPLES}/materials", "materials"))
    os.rename(tmp_path / "out", tmp_path / "moved")
    assert "0 drops simulated, " in sweep(path, "-o", tmp_path / "moved", "--force")  # other paths, the same content
    assert table(tmp_path / "moved", "foam", "message") == [{key: text for key, text in row.items() if key not in ("foam", "message")} for row in ours]


def _kill(path: Path, out: Path, times: int, seed: int) -> int:
    """Kills the command at random instants; returns how often it was killed before it had ended."""
    chance, killed, kept = random.Random(seed), 0, {}
    for _ in range(times):
        process = start(path, "-o", out, "--jobs", "2", start_new_session=True)
        while not (out / "drops.sqlite").exists():
            time.sleep(0.01)
        time.sleep(chance.uniform(0, 3))
        killed += process.poll() is None
        process.send_signal(signal.SIGKILL)
        process.communicate()
        now = done(out)
        assert kept.items() <= now.items()  # nothing that was finished is lost, or done again
        kept = now
    return killed


@pytest.mark.parametrize("times", [3, pytest.param(50, marks=pytest.mark.slow)])
def test_nothing_is_lost_or_done_twice_by_kills(tmp_path: Path, times: int) -> None:
    path = write_plan(tmp_path, SPEEDS % (10 * times))
    assert _kill(path, tmp_path / "out", times, times) > times // 2
    kept = done(tmp_path / "out")
    said = sweep(path, "-o", tmp_path / "out", "--jobs", "2")
    assert f"{10 * times - len(kept)} drops simulated, {len(kept)} were there" in said
    assert kept.items() <= done(tmp_path / "out").items() and len(done(tmp_path / "out")) == 10 * times
    assert not list((tmp_path / "out/at-work").iterdir())


@pytest.mark.slow
def test_two_processes_share_the_work_of_a_study(tmp_path: Path) -> None:
    path = write_plan(tmp_path, SPEEDS % 12)
    both = [start(path, "-o", tmp_path / "out", "--jobs", "1") for _ in range(2)]
    said = [process.communicate() for process in both]
    assert [process.returncode for process in both] == [0, 0], said
    simulated = [int(line.split()[0]) for out, _ in said for line in out.splitlines() if "drops simulated" in line]
    assert sum(simulated) == 12 and len(done(tmp_path / "out")) == 12
    assert all(row["run_status"] == "done" for row in table(tmp_path / "out"))


@pytest.mark.slow
@pytest.mark.skipif(not shutil.which("snakemake"), reason="Snakemake is not installed")
def test_an_engine_gives_blocks_of_rows_to_jobs(tmp_path: Path) -> None:
    path = write_plan(tmp_path, SPEEDS % 9)
    said = sweep(path, "-o", tmp_path / "out", "--engine", "snakemake", "--jobs", "2", "--per-job", "4")
    assert "9 drops simulated, 0 were there" in said and len(list((tmp_path / "out/batch").glob("*.done"))) == 3
    sweep(path.name, "-o", "here", cwd=tmp_path)
    sweep(path.name, "-o", "near", "--engine", "snakemake", cwd=tmp_path)  # paths of the plan that are relative
    assert table(tmp_path / "out") == table(tmp_path / "here") == table(tmp_path / "near")
    with contextlib.closing(sqlite3.connect(tmp_path / "out/drops.sqlite")) as data, data:  # as if the campaign had been killed before it took the answers
        data.execute("UPDATE drops SET state = 'running', owner = 'dead', figures = NULL")
    block = sorted((tmp_path / "out/batch").glob("*.rows"))[0]
    block.write_bytes(block.read_bytes()[:-20])  # and a job while it wrote
    assert "9 drops simulated, 8 were there" in sweep(path, "-o", tmp_path / "out", "--engine", "snakemake", "--jobs", "2")
    assert table(tmp_path / "out") == table(tmp_path / "here")
    assert "the engines are local and snakemake" in sweep(path, "-o", tmp_path / "new", "--engine", "x", code=2)
    assert "add --engine snakemake" in sweep(path, "-o", tmp_path / "new", "--profile", "slurm", code=2)


@pytest.mark.slow
def test_a_full_disk_ends_the_campaign_and_loses_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("SOFTFALL_SHARE", raising=False)
    path = write_plan(tmp_path, SPEEDS % 12)

    def limit() -> None:
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, resource.RLIM_INFINITY))

    sweep(path, "-o", tmp_path / "first", "--jobs", "1")  # meshes are larger than the limit
    (tmp_path / "out").mkdir()
    shutil.copytree(tmp_path / "first/shared", tmp_path / "out/shared")
    process = start(path, "-o", tmp_path / "out", "--jobs", "1", preexec_fn=limit)
    _, said = process.communicate()
    assert process.returncode == 3 and "cannot be" in said and "Traceback" not in said
    kept = done(tmp_path / "out")
    assert f"{12 - len(kept)} drops simulated, {len(kept)} were there" in sweep(path, "-o", tmp_path / "out", "--jobs", "1")
    assert table(tmp_path / "out") == table(tmp_path / "first")


def test_inputs_that_change_meanwhile_end_the_campaign(tmp_path: Path) -> None:
    shutil.copy(EXAMPLES / "materials/eva35.csv", tmp_path)
    foam = (EXAMPLES / "materials/eva35.cfg").read_text()
    (tmp_path / "foam.cfg").write_text(foam)
    path = write_plan(tmp_path, SPEEDS % 16 + ', { key = "material"; files = ["foam.cfg"]; }')
    process = start(path, "-o", tmp_path / "out", "--jobs", "1")
    while not done(tmp_path / "out"):
        assert process.poll() is None
        time.sleep(0.02)
    (tmp_path / "foam.cfg").write_text(foam + "HU = 0.3;\n" if "HU" not in foam else "".join("HU = 0.3;\n" if line.startswith("HU") else line for line in foam.splitlines(True)))
    _, err = process.communicate()
    assert process.returncode == 3 and "changed" in err and "repeat the command" in err
    assert not (tmp_path / "out/report.html").exists()
    kept = len(done(tmp_path / "out"))
    (tmp_path / "foam.cfg").write_text(foam)
    assert f"{16 - kept} drops simulated, {kept} were there" in sweep(path, "-o", tmp_path / "out")


def test_series_and_two_meshes(tmp_path: Path) -> None:
    path = write_plan(tmp_path, SPEEDS % 2, 'refine = "richardson";')
    path.write_text(path.read_text().replace(SET, '"geometry.parameters.fine_spacing=8.0", "geometry.parameters.outer_spacing=16.0"'))
    sweep(path, "-o", tmp_path / "two", "--jobs", "1")
    rows, coarse = table(tmp_path / "two"), json.loads((tmp_path / "two/sweep.json").read_text())
    assert coarse["coarse_drops"] == 2 and all(float(row["hic_refined_error"]) > 0 or row["refined_note"] for row in rows)
    path = write_plan(tmp_path, '{ key = "missile.velocity"; values = ["3 m/s"]; }', case="series")
    path.write_text(path.read_text().replace('"pad.mesh_error_limit=9.0"', '"pad.mesh_error_limit=9.0", "series.drops=2", "series.counted=[2]"'))
    sweep(path, "-o", tmp_path / "series", "--jobs", "1")
    with open(tmp_path / "series/drops.csv", encoding="utf-8", newline="") as file:
        drops = list(csv.DictReader(file))
    assert [drop["counted"] for drop in drops] == ["no", "yes"] and drops[1]["hic"] == table(tmp_path / "series")[0]["hic"]
    assert json.loads((tmp_path / "series/sweep.json").read_text())["judged_by"] == "drop 2 of 2"
    path.write_text(path.read_text().replace("counted=[2]", "counted=[1, 2]"))
    assert "0 drops simulated, 1 were there" in sweep(path, "-o", tmp_path / "series", "--force")  # other drops may count
    assert float(table(tmp_path / "series")[0]["hic"]) == pytest.approx(sum(float(drop["hic"]) for drop in drops) / 2)
    path.write_text(path.read_text().replace("counted=[1, 2]", "counted=[4]"))
    assert "is not the last of the series" in sweep(path, "-o", tmp_path / "series", "--force", code=2)
    path.write_text(path.read_text().replace("counted=[4]", "counted=[2]").replace('"series.drops=2"', '"series.drops=2", "material.memory={ reload = 0.0; }"'))
    assert "the foam has no material.memory" in sweep(path, "-o", tmp_path / "series", "--force", code=2)


def test_a_failed_run_keeps_its_sentence_and_is_done_again_on_request(tmp_path: Path) -> None:
    path = write_plan(tmp_path, '{ key = "missile.velocity"; values = ["3 m/s", "30 m/s"]; }, { key = "geometry.parameters.fine_spacing"; values = [25.0, 40.0]; }')
    path.write_text(path.read_text().replace('"geometry.parameters.fine_spacing=25.0", ', "").replace("mesh_error_limit=9.0", "mesh_error_limit=0.2"))
    assert "4 runs: 1 done, 3 failed, 0 open" in sweep(path, "-o", tmp_path / "out")
    rows = table(tmp_path / "out")
    assert "anvil" in rows[2]["message"] and "pad.mesh_error_limit" in rows[1]["message"] == rows[3]["message"]
    again = sweep(path, "-o", tmp_path / "out", "--retry")
    assert "drops simulated, 1 were there" in again and table(tmp_path / "out") == rows


@pytest.mark.slow
def test_a_geometry_that_changes_is_looked_at_again(tmp_path: Path) -> None:
    """A file that only the mesher reads, while the campaign runs and afterwards."""
    (tmp_path / "section.geo").write_text('Include "size.geo";\n' + (EXAMPLES.parent / "geo/section.geo").read_text())
    (tmp_path / "size.geo").write_text("// one\n")
    path = write_plan(tmp_path, SPEEDS % 16)
    path.write_text(path.read_text().replace(SET, f'{SET}, "geometry.file={tmp_path}/section.geo"'))
    process = start(path, "-o", tmp_path / "out", "--jobs", "1")
    while not done(tmp_path / "out"):
        assert process.poll() is None, process.communicate()
        time.sleep(0.02)
    (tmp_path / "size.geo").write_text("// two\n")
    _, err = process.communicate()
    assert process.returncode == 3 and "changed" in err and not (tmp_path / "out/report.html").exists()
    assert "16 runs: 16 done, 0 failed, 0 open" in sweep(path, "-o", tmp_path / "out")
    assert "\n0 drops simulated, 16 were there" in sweep(path, "-o", tmp_path / "out")
    (tmp_path / "size.geo").write_text("// three\n")
    assert "\n16 drops simulated, 0 were there" in sweep(path, "-o", tmp_path / "out")


@pytest.mark.parametrize("kind", ["pipe", "folder", "empty", "bytes", "missing"])
@pytest.mark.parametrize("named_by", ["plan", "case", "file", "set"])
def test_hostile_files_are_refused(tmp_path: Path, kind: str, named_by: str) -> None:
    hostile = tmp_path / "hostile"
    {"pipe": lambda: os.mkfifo(hostile), "folder": hostile.mkdir, "empty": hostile.touch, "bytes": lambda: hostile.write_bytes(bytes(range(256)) * 8), "missing": lambda: None}[kind]()
    foam = '{ key = "material"; files = ["hostile"]; }' if named_by == "file" else SPEEDS % 2
    path = write_plan(tmp_path, foam)
    text = path.read_text().replace(SET, '"material=@hostile"') if named_by == "set" else path.read_text()
    path.write_text(re.sub('case = ".*?"', 'case = "hostile"', text) if named_by == "case" else text)
    with pytest.raises(softfall.InputError) as caught:
        plans.Plan(hostile if named_by == "plan" else path).check()
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_the_earlier_name_takes_the_same_options(tmp_path: Path) -> None:
    path = write_plan(tmp_path, SPEEDS % 2)
    def old(*words: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run([str(BIN / "softfall-sweep"), *map(str, words)], capture_output=True, text=True)
    assert "2 drops simulated, 0 were there" in old(path, "-o", tmp_path / "out", "-j", "2").stdout
    gone = old(path, "-o", tmp_path / "out", "--threads", "2")
    assert gone.returncode == 2 and gone.stderr == "softfall sweep: --threads=2: each drop takes one thread; give --jobs, the number of drops side by side\n"
    wrong = old(path, "-o", tmp_path / "out", "--thread", "2")
    assert wrong.returncode == 64 and wrong.stderr.startswith("softfall sweep: unrecognized arguments: --thread") and "Try `softfall sweep --help'" in wrong.stderr


WRONG = [
    ('{ key = "missile.velocity"; values = ["3 kg"]; }', "", "plan.cfg:4: "), ('{ key = "missile.velocity"; values = []; }', "", "is empty"),
    ('{ key = "missile.velocity"; values = ("3 m/s", 4.0); }', "", "has no unit"), ('{ key = "missile.speed"; values = ["3 m/s"]; }', "", "plan.cfg:4: "),
    ('{ key = "material"; files = ["gone.cfg"]; }', "", "plan.cfg:4: material: "), ('{ key = "missile.velocity"; value = 3; }', "", 'unknown key "value"'),
    ('{ key = "missile.velocity"; values = ["3 m/s"]; low = 1.0; }', "", 'unknown key "low"'), ('{ key = "output.fields"; values = ["a"]; }', "", "has no effect in a campaign"),
    ('{ key = "pad.temperature"; values = ["20 degC", "300 K"]; }', "", "different zeros"),
    (SPEEDS % 2, 'coarse = ["geometry.parameters.fine_spacing=30.0"];', "predicted no more"), (SPEEDS % 2, 'figures = ( { key = "hic"; accuracy = 0.1; } );', "predicted no more"),
    (SPEEDS % 2, 'figures = ( { key = "hicc"; } );', 'unknown figure "hicc"'), (SPEEDS % 2 + ", " + SPEEDS % 3, "", "is a factor already, at"),
    ('{ zip = ( { key = "missile.velocity"; values = ["3 m/s"]; }, { key = "missile.mass"; values = ["3 kg", "4 kg"]; } ); }', "", "must have one length"),
    ('{ sample = "saltelli"; count = 4; of = ( { key = "missile.velocity"; low = "3 m/s"; high = "4 m/s"; } ); }', "", "need 8 samples"),
    ('{ sample = "sobol"; count = 4; of = ( { key = "missile.velocity"; low = "4 m/s"; high = "3 m/s"; } ); }', "", "low must be below high"),
    ('{ key = "geometry.parameters.thicknes"; values = [40.0]; }', "", "thicknes"), ('{ key = "missile.velocity"; values = ["3 m/s" ', "", "plan.cfg:")]


@pytest.mark.parametrize(("factors", "more", "part"), WRONG)
def test_wrong_plans_are_refused_with_their_line(tmp_path: Path, factors: str, more: str, part: str) -> None:
    with pytest.raises(softfall.InputError, match=r"(?s).*") as caught:
        plans.Plan(write_plan(tmp_path, factors, more)).check()
    assert part in str(caught.value)


def test_very_many_rows_are_refused_with_their_time(tmp_path: Path) -> None:
    path = write_plan(tmp_path, '{ sample = "sobol"; count = 100000; of = ( { key = "missile.velocity"; low = "3 m/s"; high = "4 m/s"; } ); }')
    said = sweep(path, "-o", tmp_path / "out", code=2)
    assert "100000 runs take about " in said and "--yes" in said and not (tmp_path / "out").exists()


def test_folders_of_something_else_are_refused(tmp_path: Path) -> None:
    path = write_plan(tmp_path, '{ key = "missile.velocity"; values = ["3 m/s"]; }')
    sweep(path, "-o", tmp_path / "out")
    path.write_text(path.read_text().replace('"3 m/s"', '"3.1 m/s"'))
    assert "holds the runs of another plan" in sweep(path, "-o", tmp_path / "out", code=2)
    assert "1 drops simulated" in sweep(path, "-o", tmp_path / "out", "--force")
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/runs.csv").write_text("mine\n")
    assert "already holds runs.csv" in sweep(path, "-o", tmp_path / "mine", code=2)
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken/drops.sqlite").write_text("no database, but a text of some length" * 100)
    assert "cannot be used" in sweep(path, "-o", tmp_path / "broken", code=3)
    assert "neither worst, limit, all nor" in sweep(path, "-o", tmp_path / "new", "--views", "2x", code=2)
    assert "0 to" not in sweep(path, "-o", tmp_path / "new", "--dry-run") and not (tmp_path / "new").exists()


def test_a_store_gives_a_drop_to_one_process(tmp_path: Path) -> None:
    one, two = Store(tmp_path), Store(tmp_path)
    assert one.take(["a", "b", "c"], 2) == ["a", "b"] and two.take(["a", "b", "c"], 3) == ["c"]
    assert two.others() and two.entries(["a"])["a"].state == "running"
    one.finish("a", [], "files", 1.0)
    os.close(one._lock)  # as if its process had died
    one._lock = -1
    assert not two.others() and two.entries(["a", "b"])["b"].state == "open" and two.entries(["a"])["a"].state == "done"
    two.close()
    one.close()


def test_samples_are_the_same_on_every_machine() -> None:
    assert samples.points("latin_hypercube", 3, 16, 2)[:2, 2] == pytest.approx([(0.314357059755 - 0.3) / 0.2, (0.483759404294 - 0.3) / 0.2], abs=1e-10)
    points = samples.points("sobol", 3, 64, 3)
    assert all(len(np.unique((points[:, k] * 8).astype(int))) == 8 for k in range(3)) and (points > 0).all() and (points < 1).all()
    block = samples.points("saltelli", 2, 8, 1).reshape(4, 8, 2)
    assert (block[2][:, 0] == block[1][:, 0]).all() and (block[2][:, 1] == block[0][:, 1]).all()


def _sampled(tmp_path: Path, method: str, count: int) -> plans.Plan:
    of = ", ".join(f'{{ key = "{key}"; name = "{name}"; low = "1 {unit}"; high = "3 {unit}"; }}' for key, name, unit in
                   (("missile.velocity", "speed", "m/s"), ("missile.mass", "mass", "kg"), ("solver.end_time", "end", "s")))
    return plans.Plan(write_plan(tmp_path, f'{{ sample = "{method}"; count = {count}; of = ( {of} ); }}'))


def test_effects_and_surface_of_a_known_function(tmp_path: Path) -> None:
    plan = _sampled(tmp_path, "sobol", 256)
    a, b = plan.column(0), plan.column(1)
    y = 3 + 2 * a + a * b - 0.5 * b ** 2
    fit, x = effects.surface(plan, y)
    assert fit.q2 == pytest.approx(1) and fit.left_out_rms < 1e-10 and dict(zip(fit.names, fit.coefficients))["speed × mass"] == pytest.approx(fit.half[0] * fit.half[1])
    found = effects.effect(plan, 0, y, fit, x)
    assert found.last - found.first == pytest.approx(2 * fit.half[0] * (2 + b.mean())) and effects.effect(plan, 2, y, fit, x).high - effects.effect(plan, 2, y, fit, x).low < 1e-9


def test_sobol_indices_of_a_known_function(tmp_path: Path) -> None:
    plan = _sampled(tmp_path, "saltelli", 4096)
    a, b = plan.column(0) - 2, plan.column(1) - 2
    found, used = effects.indices(plan.saltelli, a + a * b)  # variances 1/3 and 1/9
    assert used == 4096 and found[0].first == pytest.approx(0.75, abs=0.03) and found[0].total == pytest.approx(1, abs=0.03)
    assert found[1].first == pytest.approx(0, abs=0.03) and found[1].total == pytest.approx(0.25, abs=0.03) and found[2].total == pytest.approx(0, abs=1e-9)
    assert found[0].first_low < 0.75 < found[0].first_high
    y = a + a * b
    y[:1000] = np.nan
    assert np.isnan(effects.indices(plan.saltelli, y)[0][0].first)


def test_unknown_runs_are_not_taken_as_below(tmp_path: Path) -> None:
    plan = _sampled(tmp_path, "random", 20)
    y = np.full(20, 100.0)
    y[:3] = np.nan
    anvil = np.arange(20) == 0
    chance, = effects.chances(plan, 200.0, y, anvil=anvil, is_open=np.zeros(20, bool), scatter=np.zeros(20))
    assert (chance.below, chance.above, chance.unknown) == (17, 1, 2) and chance.share == 17 / 20 and chance.low < 0.85 < chance.high < 1


def test_the_answer_names_the_thinnest_pad(tmp_path: Path) -> None:
    path = write_plan(tmp_path, '{ key = "geometry.parameters.thickness"; values = [40.0, 50.0, 60.0]; }, { key = "missile.velocity"; values = ["4 m/s", "5 m/s", "6 m/s"]; }')
    plan = plans.Plan(path)
    keys = memory.figure_keys()

    def row(hic: float) -> campaign.Row:
        figures = {key: {"hic": hic, "a_max_g": 100.0}.get(key, 0.0) for key in keys}
        return campaign.Row("k", state="done", judged=campaign.DropFigures(figures, 0, "valid", "rebound"))

    rows = [row(hic) for hic in (900, 1100, 1500, 500, 900, 1200, 300, 900, 950)]
    assert sweep_page.answer(campaign.Table(plan, rows)) == "thinnest pad below a_max < 200 g and HIC < 1000 up to 6 m/s: 60 mm"
    rows[8] = campaign.Row("k", state="failed", message="the energy balance is off")
    assert sweep_page.answer(campaign.Table(plan, rows)).endswith("up to 5 m/s: 50 mm")
    rows[7] = rows[4] = row(float("nan"))
    assert sweep_page.answer(campaign.Table(plan, rows)).endswith("up to 4 m/s: 40 mm")
    zipped = plans.Plan(write_plan(tmp_path, '{ zip = ( { key = "geometry.parameters.thickness"; values = [40.0, 60.0]; }, { key = "missile.velocity"; values = ["4 m/s", "6 m/s"]; } ); }'))
    assert sweep_page.answer(campaign.Table(zipped, [row(900), row(900)])).startswith("2 of 2 runs stay below")


def test_an_engine_leaves_the_batch_of_another_command_alone(tmp_path: Path) -> None:
    """While a Snakemake is at work in the folder its manifest and answers stay: a second one is refused."""
    batch = tmp_path / rows_command.BATCH
    batch.mkdir()
    (batch / "manifest.tsv").write_text("of another command")
    with open(tmp_path / f"{rows_command.BATCH}.lock", "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(softfall.Error, match="an engine of another command is at work"):
            list(rows_command.simulate(tmp_path, [], 1, 1, None, lock.fileno()))
    assert (batch / "manifest.tsv").read_text() == "of another command"
