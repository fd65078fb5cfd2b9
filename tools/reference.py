#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Records what the programs give for the entries of tests/reference, and compares it with what they give now.

    tools/reference.py list
    tools/reference.py record [NAME...]
    tools/reference.py compare [NAME...]

An entry is a file tests/reference/NAME.json: its `commands`, programs of build/bin or $SF_BIN_DIR, run from the project's root
and write to OUT, a folder of their own; `figures` holds what they wrote there, "#..." is a digest. NAME may be a pattern, such as
'sweep-*'; without a NAME all entries run. For a new entry write a file that has `commands` alone, and record it.

compare prints each figure that differs: its place, the old and the new value, the relative difference. Exit code: 0 if none
differs, 1 if any does, 2 if an entry cannot run, 77 with --same-system if the set was recorded on another release."""
import argparse
import csv
import fnmatch
import hashlib
import json
import os
import pathlib
import platform
import re
import resource
import shlex
import subprocess
import sys
import tempfile

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDER = ROOT / "tests/reference"
TABLES = ("runs.csv", "drops.csv", "series.csv")  # recorded as columns; of other CSV files the digest is recorded

# Keys and columns that differ from run to run, and texts of the programs or of the entry's own input.
LEFT_OUT = {"program", "git_revision", "command_line", "folder", "wall_s", "threads", "caution", "finding", "why", "input_text", "reading"}
# Figures of a table that are recorded of all rows; the others are of the first row, and a digest stands for all.
IN_FULL = re.compile(r"a_max_g|hic|max_indentation_mm|v_rebound_m_s|steps|.*_(low|high|refined|refined_error|note)")
CHECK = ("value", "bound", "use_bound", "grade", "passed")  # a row for each check and each limit of a verdict
# Datasets of a model of which digests, and numbers that are recorded.
MODEL = ("cloud/position", "cloud/volume", "cloud/support", "shape/value", "domain/b", "mesh/cell_node", "missile/surface_position")
COUNTED = ("cloud/count", "mesh/cell_count", "fixed/count", "contact/count", "tie/count", "anvil/count", "skin/count", "support/triangle_count",
           "membrane/count", "missile/surface_triangle_count")
SYSTEM = platform.freedesktop_os_release()["PRETTY_NAME"]  # another release has another gmsh, and other meshes


def fail(message):
    print(f"reference: {message}", file=sys.stderr)
    sys.exit(2)


def digest(data):
    """Returns "#" and the first 12 digits of the SHA-256 of bytes."""
    return "#" + hashlib.sha256(data).hexdigest()[:12]


def number(text):
    """Returns the number that a cell of a table holds, None if it is empty, or its text."""
    try:
        return json.loads(text) if text else None
    except ValueError:
        return text


def without_provenance(value):
    """Returns a value of a JSON file without the keys that are left out or null; the checks of a verdict become rows under their keys."""
    if isinstance(value, dict):
        return {key: without_provenance(part) for key, part in value.items() if key not in LEFT_OUT and part is not None}
    if isinstance(value, list) and value and all(isinstance(part, dict) and {"key", "value", "bound"} <= part.keys() for part in value):
        return {part["key"]: [part[key] for key in CHECK if key in part] for part in value}
    return [without_provenance(part) for part in value] if isinstance(value, list) else value


def read_table(path):
    """Returns the columns of a CSV file; a column of one value is that value, and an empty one is left out."""
    with open(path, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    names = [name for name in (rows[0] if rows else ()) if name not in LEFT_OUT]
    # A message is that of a failed run; the remarks of a drop that is done follow from its figures.
    table = {name: [None if name == "message" and row["grade"] else number(row[name]) for row in rows] for name in names}
    figures = names[names.index("a_max_g"):] if "a_max_g" in names else []
    short = [name for name in names if table[name].count(table[name][0]) == len(rows) or name in figures and not IN_FULL.fullmatch(name)]
    columns = {name: cells[0] if name in short else cells for name, cells in table.items()}
    columns |= {"rows": len(rows), "digest": digest(json.dumps([table[name] for name in figures]).encode())}
    return {name: cells for name, cells in columns.items() if cells is not None}


def read_results(path):
    """Returns 20 values of the curve at equal times, and digests of the columns of /history that are not zero and of the last fields."""
    with h5py.File(path) as file:
        history = {name: data[()] for name, data in file["history"].items()}
        last = file["frames"][max(file["frames"])]
        fields = {name: digest(last[name][()].tobytes()) for name in ("displacement", "cauchy_stress", "contact_pressure") if name in last}
    time, zero = history["time"], [name for name in history if not history[name].view(np.int64).any()]
    shown = "contact_force" if "acceleration" in zero else "acceleration"  # of a prescribed motion the force
    curve = np.interp(np.linspace(time[0], time[-1], 20), time, history[shown])
    return {"rows": len(time), shown: [float(f"{value:.9g}") for value in curve], "zero_columns": len(zero), "last_fields": fields,
            "history": {name: digest(data.tobytes()) for name, data in history.items() if name not in zero}}


def read_model(path):
    """Returns counts of a model, and digests of its positions, shape functions and gradients."""
    with h5py.File(path) as file:
        counts = {name: int(file[name][()]) for name in COUNTED if name in file and file[name][()] != 0}
        types, numbers = np.unique(file["mesh/cell_type"][()], return_counts=True)
        return {"counts": counts, "cells_of_types": {str(t): int(n) for t, n in zip(types, numbers)},
                "bits": {name: digest(file[name][()].tobytes()) for name in MODEL if name in file}}


def read_file(path, out):
    """Returns what is recorded of a file of OUT, None if nothing is."""
    if path.suffix == ".json":
        return without_provenance(json.loads(path.read_text(encoding="utf-8")))
    if path.name in TABLES and not (out / "protocol.json").exists():  # which has the same drops
        return read_table(path)
    if path.suffix == ".csv":
        lines = path.read_text(encoding="utf-8").splitlines(keepends=True)
        return digest(plain("".join(line for line in lines if line.partition(",")[0] not in LEFT_OUT), out).encode())
    if path.suffix == ".cfg":
        return [line for line in path.read_text(encoding="utf-8").splitlines() if not line.startswith("#")]
    if path.suffix == ".h5" and path.stem.startswith("model"):
        return read_model(path)
    return read_results(path) if path.suffix == ".h5" and path.stem.startswith("results") else None


def plain(value, out):
    """Returns a value whose texts have OUT for the folder of the run, no path of the project, and KEY in names of drops' folders."""
    if isinstance(value, dict):
        return {plain(key, out): plain(part, out) for key, part in value.items()}
    if isinstance(value, list):
        return [plain(part, out) for part in value]
    if isinstance(value, str):
        return re.sub(r"-[0-9a-f]{16}\b", "-KEY", value.replace(str(out), "OUT").replace(f"{ROOT}/", ""))
    return value


def run(name, commands):
    """Runs the commands of an entry; returns its figures and the processor time that it took, s."""
    programs = pathlib.Path(os.environ.get("SF_BIN_DIR", ROOT / "build/bin")).resolve()
    environment = {"OMP_WAIT_POLICY": "passive"} | os.environ | {"LC_ALL": "C.UTF-8"}
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory(prefix="reference-") as folder:
        out, codes, said = pathlib.Path(folder).resolve() / "out", [], ""
        out.mkdir()
        for command in commands:
            words = [word.replace("OUT", str(out)) for word in shlex.split(command)]
            if not (programs / words[0]).exists():
                fail(f"{name}: no program {words[0]} in {programs}; build it, or set SF_BIN_DIR")
            done = subprocess.run([programs / words[0], *words[1:]], cwd=ROOT, env=environment, stdin=subprocess.DEVNULL, capture_output=True,
                                  text=True, check=False)
            codes.append(done.returncode)
            said += done.stderr
        figures = {file.name: read_file(file, out) for file in sorted(out.iterdir()) if file.is_file()}
        figures = plain({key: value for key, value in figures.items() if value is not None}, out)
    if not figures:
        fail(f"{name}: the commands left nothing that is recorded in OUT; exit codes {codes}\n{said}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return figures | {"exit_codes": codes}, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def written(value, indent=""):
    """Returns a value as JSON with sorted keys, a key or a short group to a line."""
    line = json.dumps(value, ensure_ascii=False, sort_keys=True)
    is_flat = "{" not in line[1:] and "[" not in line[1:] and (len(line) < 240 or isinstance(value, list))
    if is_flat or not isinstance(value, (dict, list)):
        return line
    if isinstance(value, dict):
        parts = [f"{json.dumps(key, ensure_ascii=False)}: {written(value[key], indent + ' ')}" for key in sorted(value)]
    else:
        parts = [written(part, indent + " ") for part in value]
    return f"{line[0]}\n{indent} " + f",\n{indent} ".join(parts) + f"\n{indent}{line[-1]}"


def leaves(value, place=""):
    """Yields the place and the value of each number and text."""
    parts = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else None
    if parts is None:
        yield place, value
    else:
        for key, part in parts:
            yield from leaves(part, f"{place}/{key}")


def differences(old, new, options):
    """Yields a line for each figure that differs: place, both values ("-": not there), relative difference."""
    old, new = dict(leaves(old)), dict(leaves(new))
    for place in sorted(old.keys() | new.keys()):
        a, b, relative = old.get(place, "-"), new.get(place, "-"), ""
        if {type(a), type(b)} <= {int, float}:
            largest = max(abs(a), abs(b), 1e-9 if options.tolerance else 0.0)  # what is smaller is rounding
            differs = a != b and not abs(b - a) <= options.tolerance * largest
            relative = f"  ({abs(b - a) / largest:.2g})" if differs else ""
        else:
            is_bits = options.tolerance and str(a).startswith("#") and str(b).startswith("#")
            is_sentence = options.figures and ".cfg/" not in place and len(str(a).split()) > 4 and len(str(b).split()) > 4
            differs = json.dumps(a) != json.dumps(b) and not is_bits and not is_sentence
        if differs:
            yield f"{place}: {json.dumps(a)} -> {json.dumps(b)}{relative}"


def compare(name, entry, figures, options):
    """Prints the figures of an entry that differ; returns their number."""
    found = list(differences(entry["figures"], figures, options))
    print(*(name + line for line in found[:options.lines]), sep="\n", end="\n" if found else "")
    if len(found) > options.lines:
        print(f"{name}: {len(found) - options.lines} more differ; --lines {len(found)} prints them")
    return len(found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("word", choices=("list", "record", "compare"))
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--tolerance", type=float, default=0.0, help="relative difference that a number may have; with one, digests are not compared")
    parser.add_argument("--figures", action="store_true", help="differences between texts of more than four words do not count")
    parser.add_argument("--lines", type=int, default=40, help="differences printed for each entry (default 40)")
    parser.add_argument("--same-system", action="store_true", help="end with exit code 77 if the set was recorded on another release")
    options = parser.parse_args()
    files = {path.stem: path for path in sorted(FOLDER.glob("*.json"))}
    for name in options.names:
        if not fnmatch.filter(files, name):
            fail(f"no entry {name} in tests/reference; tools/reference.py list prints all")
    differing = count = 0
    chosen = [name for name in files if any(fnmatch.fnmatch(name, pattern) for pattern in options.names or "*")]
    for name in chosen:
        entry = json.loads(files[name].read_text(encoding="utf-8"))
        if options.word == "list":
            print(name, *entry["commands"], sep="\n    ")
            continue
        if options.same_system and entry.get("system") != SYSTEM:
            print(f"{name} was recorded on {entry.get('system')}; this is {SYSTEM}")
            sys.exit(77)
        if options.word == "compare" and "figures" not in entry:
            fail(f"{name} has no figures yet: tools/reference.py record {name}")
        figures, seconds = run(name, entry["commands"])
        if options.word == "record":
            files[name].write_text(written({"commands": entry["commands"], "figures": figures, "system": SYSTEM}) + "\n", encoding="utf-8")
            print(f"{name}: recorded, exit codes {figures['exit_codes']}, {seconds:.0f} s of processor time", flush=True)
        else:
            found = compare(name, entry, figures, options)
            print(f"{name}: {found or 'none'} of {len(dict(leaves(figures)))} figures differ, {seconds:.0f} s of processor time", flush=True)
            count, differing = count + found, differing + (found > 0)
    if options.word == "compare":
        print(f"{count or 'no'} figures differ, in {differing} of {len(chosen)} entries")
    sys.exit(count > 0)


if __name__ == "__main__":
    main()
