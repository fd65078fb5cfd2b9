#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Circles among the units of src/, and among its rooms. A unit is a .c file with its .h, a room a folder of src/. A unit
depends on the units whose headers it includes and, by calls, on the units that define the functions and objects its
object file uses; a room depends on the rooms of its units.

    tools/circles.py [BUILD]     from the project's root; BUILD: a build directory, without it calls are not looked at

Prints each circle with the includes and symbols that close it and exits 1; prints nothing and exits 0 if there is none."""
import os
import re
import subprocess
import sys

ROOT = "src"
# Circles that are still there, as they are printed; none may be added.
KNOWN = set()


def unit_of(path):
    return os.path.splitext(os.path.relpath(path, ROOT))[0]


def edges_by_includes():
    files = [os.path.join(folder, name) for folder, _, names in os.walk(ROOT) for name in names if name.endswith((".c", ".h"))]
    units = {unit_of(path) for path in files}
    edges = {}
    for path in files:
        with open(path, encoding="utf-8", errors="replace") as text:
            for name in re.findall(r'^\s*#\s*include\s+"([^"]+)"', text.read(), re.MULTILINE):
                stem = os.path.splitext(name)[0]
                for target in (stem, os.path.join(os.path.dirname(unit_of(path)), stem)):
                    if target in units and target != unit_of(path):
                        edges.setdefault(unit_of(path), {}).setdefault(target, []).append(f'"{name}"')
    return edges


def object_files(build):
    """The newest object of each unit: a file stands in one target, but an old build tree may hold others."""
    found = {}
    for folder, _, names in os.walk(build):
        for name in names:
            match = re.search(r"\.dir/src/(.*)\.c\.o$", os.path.join(folder, name))
            if match and os.path.exists(os.path.join(ROOT, match.group(1) + ".c")):
                path = os.path.join(folder, name)
                if match.group(1) not in found or os.path.getmtime(path) > os.path.getmtime(found[match.group(1)]):
                    found[match.group(1)] = path
    return found


def symbols(build):
    """The unit that defines each symbol, and the symbols that each unit uses and does not define."""
    objects = object_files(build)
    if not objects:
        sys.exit(f"{build}: no object file of src/ stands there")
    unit_of_object = {path: unit for unit, path in objects.items()}
    listing = subprocess.run(["nm", "-A", *unit_of_object], capture_output=True, text=True, check=True).stdout
    defined, used = {}, {}
    for line in listing.splitlines():
        path, symbol_line = line.rsplit(":", 1)
        kind, symbol = symbol_line.split()[-2:]
        if kind == "U":
            used.setdefault(unit_of_object[path], set()).add(symbol)
        elif (kind.isupper() or kind == "i") and symbol != "main":  # i: a kernel with a version for each processor
            defined[symbol] = unit_of_object[path]
    if not defined:
        sys.exit(f"{build}: its object files name no symbol (link-time optimisation?)")
    return defined, used


def edges_by_calls(build):
    defined, used = symbols(build)
    edges = {}
    for unit, names in used.items():
        for symbol in sorted(names):
            if defined.get(symbol, unit) != unit:
                edges.setdefault(unit, {}).setdefault(defined[symbol], []).append(symbol)
    return edges


def circles(edges):
    """Strongly connected components of more than one unit (Tarjan 1972)."""
    index, low, stack, found = {}, {}, [], []

    def visit(unit):
        index[unit] = low[unit] = len(index)
        stack.append(unit)
        for target in sorted(edges.get(unit, ())):
            if target not in index:
                visit(target)
                low[unit] = min(low[unit], low[target])
            elif target in stack:
                low[unit] = min(low[unit], index[target])
        if low[unit] == index[unit]:
            at = stack.index(unit)
            if len(stack) - at > 1:
                found.append(sorted(stack[at:]))
            del stack[at:]

    for unit in sorted(edges):
        if unit not in index:
            visit(unit)
    return found


def room_of(unit):
    return unit.split("/")[0]


def rooms(edges):
    """The same edges between rooms; each is told by the units that make it."""
    between = {}
    for unit, targets in edges.items():
        for target in targets:
            room, other = room_of(unit), room_of(target)
            if room != other:
                between.setdefault(room, {}).setdefault(other, []).append(f"{unit}-{target}")
    return between


def report(way, edges):
    """Prints the circles that are not known; returns the names of all."""
    names = set()
    for group in circles(edges):
        names.add(" ".join(group))
        if " ".join(group) in KNOWN:
            continue
        print(f"circle by {way}:", " ".join(group))
        for unit in group:
            for target in sorted(set(edges[unit]) & set(group)):
                print(f"    {unit} -> {target}:", " ".join(edges[unit][target]))
    return names


def main():
    if len(sys.argv) > 2 or not os.path.isdir(ROOT):
        sys.exit(__doc__)
    edges = {"includes": edges_by_includes()}
    if len(sys.argv) == 2:
        edges["calls"] = edges_by_calls(sys.argv[1])
    found = set()
    for way, of_units in edges.items():
        found |= report(way, of_units) | report(f"{way} of rooms", rooms(of_units))
    gone = KNOWN - found if "calls" in edges else set()
    for name in sorted(gone):
        print(f"no longer a circle, take it out of KNOWN: {name}")
    sys.exit(found != KNOWN if "calls" in edges else bool(found - KNOWN))


if __name__ == "__main__":
    main()
