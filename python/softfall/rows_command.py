# SPDX-License-Identifier: GPL-3.0-or-later
"""`softfall rows MANIFEST --group GROUP`: what an engine (Snakemake, Slurm) starts for each block of rows of a sweep, and that engine.

A job simulates the drops of its block and appends each answer to GROUP.rows as soon as it is there, so that a job that is killed goes on
where it was; GROUP.done says that all have been answered. The campaign takes the answers into its store.
"""
from __future__ import annotations

import argparse
import fcntl
import json
import os
import shutil
import signal
import subprocess
import time
from pathlib import Path
from typing import Iterator, Sequence

from . import memory, output as output_files, programs
from .command import Parser, say
from .errors import Error, InputError
from .memory import DropFigures
from .worker import OF_THE_MACHINE, Answer, Pool, Task

HEAD, BATCH, MANIFEST = "softfall-rows 1", "batch", "manifest.tsv"
_HEAD_LINES = 4  # which the Snakefile skips
_JOB_SECONDS, _MOST_PER_JOB = 180.0, 1000


def parser(prog: str) -> Parser:
    """Returns the options of the command."""
    made = Parser(prog, "[OPTION...] MANIFEST --group GROUP", "Simulates a block of rows of a sweep, as an engine starts it.")
    made.add_argument("manifest", metavar="MANIFEST", help=argparse.SUPPRESS)
    made.options.add_argument("-g", "--group", metavar="GROUP", required=True, help="the block (required)")
    made.options.add_argument("-t", "--threads", metavar="N", type=int, default=1, help="drops side by side (default 1)")
    return made


def run(options: argparse.Namespace) -> int:
    """Runs the command and returns its exit code."""
    manifest = Path(options.manifest).absolute()
    os.chdir(folder_of(manifest))  # to which the paths of the tasks are relative
    tasks = [task for group, task in read_manifest(manifest) if group == options.group]
    if not tasks:
        raise InputError(f"{manifest} has no group {options.group}")
    memory.hold_units()
    rows = manifest.with_name(f"{options.group}.rows")
    known = {answer.key for answer in read_rows(rows)}
    failed: Answer | None = None
    with Pool(max(1, options.threads), manifest.parent.parent / "shared") as pool, open(rows, "ab") as out:
        for future in [pool.start(task) for task in tasks if task.key not in known]:
            answer = future.result()
            if answer.code in OF_THE_MACHINE:
                failed = answer
                continue
            out.write(b"\n" + json.dumps(answer).encode() + b"\n")  # the first ends a line that a killed job has left
            out.flush()
            os.fsync(out.fileno())
    if failed:
        raise Error(failed.message, failed.code)
    output_files.write(manifest.with_name(f"{options.group}.done"), f"{len(tasks)} drops\n")
    say(f"group {options.group}: {len(tasks)} drops, {len(known)} were there")
    return 0


def read_manifest(path: Path) -> Iterator[tuple[str, Task]]:
    """Returns the tasks of a manifest with their groups."""
    lines = output_files.read(path, 1 << 32).decode().splitlines()
    if not lines or lines[0] != HEAD:
        raise InputError(f"{path} is no manifest of rows")
    for line in lines[_HEAD_LINES:]:
        _, group, task = line.split("\t", 2)
        yield group, Task(*json.loads(task))


def folder_of(path: Path) -> str:
    """Returns the folder in which the campaign of a manifest was started."""
    for line in output_files.read(path, 1 << 32).decode().splitlines()[1:_HEAD_LINES]:
        if line.startswith("folder\t"):
            return line.split("\t", 1)[1]
    raise InputError(f"{path} names no folder")


def read_rows(path: Path) -> Iterator[Answer]:
    """Returns the answers of a block so far; a line that is not whole is none."""
    for line in output_files.read(path, 1 << 32).splitlines() if path.exists() else ():
        try:
            key, drops, *rest = json.loads(line)
            yield Answer(key, [DropFigures(*drop) for drop in drops], *rest)
        except (ValueError, TypeError):
            continue


def check_engine(engine: str, profile: str | None, per_job: int | None) -> None:
    """Refuses an engine that is not there, and options of none."""
    if engine not in ("local", "snakemake"):
        raise InputError(f"--engine {engine}: the engines are local and snakemake")
    for name, value in (("profile", profile), ("per-job", per_job)):
        if engine == "local" and value is not None:
            raise InputError(f"--{name} {value}: {name}s are Snakemake's: add --engine snakemake" if name == "profile" else f"--{name} {value}: jobs are Snakemake's: add --engine snakemake")
    if engine == "snakemake" and not shutil.which("snakemake"):
        raise Error("--engine snakemake: Snakemake is not installed (package snakemake of Debian)", 3)
    if profile == "slurm" and not shutil.which("sbatch"):
        raise Error("--profile slurm: Slurm's commands (sbatch) are not installed (package slurm-client of Debian)", 3)


def simulate(folder: Path, tasks: Sequence[Task], per_job: int, jobs: int, profile: str | None, lock: int) -> Iterator[Answer]:
    """Runs the tasks in blocks by Snakemake; returns the answers, also those of blocks that did not end."""
    batch, share = folder / BATCH, programs.folder().parent / "share/softfall"
    own = output_files.open_lock(folder / f"{BATCH}.lock")
    try:
        fcntl.flock(own, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        os.close(own)
        raise Error(f"an engine of another command is at work in {batch}: wait until it has ended, or give another directory", 3) from None
    try:
        yield from _simulate(batch, share, tasks, per_job, jobs, profile, (lock, own))
    finally:
        os.close(own)


def _simulate(batch: Path, share: Path, tasks: Sequence[Task], per_job: int, jobs: int, profile: str | None, locks: Sequence[int]) -> Iterator[Answer]:
    """Runs the tasks as `simulate` does, in a folder that is this command's; a Snakemake that outlives it keeps the locks."""
    shutil.rmtree(batch, ignore_errors=True)
    batch.mkdir()
    groups = [f"{k // per_job}-{tasks[k // per_job * per_job].key[:16]}" for k in range(len(tasks))]
    lines = [HEAD, f"folder\t{os.getcwd()}", f"rows\t{batch.parent.absolute()}", f"count\t{len(tasks)}", *(f"{task.key}\t{group}\t{json.dumps(task)}" for task, group in zip(tasks, groups))]
    output_files.write(batch / MANIFEST, "\n".join(lines) + "\n")
    place = ["--profile", str(share / "slurm") if profile == "slurm" else profile] if profile else ["--cores", str(jobs)]
    with open(batch / "log.txt", "wb") as log:
        process = subprocess.Popen(["snakemake", "--snakefile", str(share / "Snakefile"), "--directory", str(batch.absolute()), "--nolock", "--keep-going", "--rerun-incomplete",
                                    "--config", f"manifest={(batch / MANIFEST).absolute()}", f"program={programs.folder() / 'softfall-rows'}", "threads=1", *place],
                                   stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT, start_new_session=True, pass_fds=locks,
                                   preexec_fn=_take_interrupts,
                                   env={**os.environ, "SOFTFALL_SHARE": str(share)})
        try:
            while process.poll() is None:
                time.sleep(0.1)
        except BaseException:
            process.send_signal(signal.SIGINT)  # it cancels its jobs
            process.wait()
            raise
    yield from answers(batch.parent)


def _take_interrupts() -> None:
    """Lets SIGINT end a program that is started, also where this one runs in the background of a shell, which ignores it."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def answers(folder: Path) -> Iterator[Answer]:
    """Returns all answers of the last batch of a folder."""
    for path in sorted((folder / BATCH).glob("*.rows")):
        yield from read_rows(path)


def block_size(seconds: float, count: int, jobs: int) -> int:
    """Returns the drops of a job: as many as take three minutes, but enough jobs for all processors.

    >>> block_size(0.1, 10000, 2), block_size(20.0, 10000, 2), block_size(0.1, 10, 2)
    (1000, 9, 5)
    """
    return max(1, min(_MOST_PER_JOB, int(_JOB_SECONDS / max(seconds, 1e-3)), -(-count // jobs)))
