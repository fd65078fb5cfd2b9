#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Public functions are declared in the header of their file: those of NAME.c in NAME.h. Looks for the functions that the
object files of src/ define, and for their declarations in the headers.

    tools/headers.py BUILD       from the project's root

Prints each function that is declared elsewhere or in no header although other files use it, each that is public although
no other object file uses it, and each file without a header of its name, programs apart; exits 1 if there is one.
The functions softfall_* of src/api/NAME.c stand in include/softfall/NAME.h."""
import os
import re
import subprocess
import sys

import circles

LIBRARY = "include/softfall"


def declared_functions(path):
    """The names that lines without indentation declare, and the beginnings of names that a macro of the header completes."""
    with open(path, encoding="utf-8") as file:
        text = re.sub(r"/\*.*?\*/", " ", file.read(), flags=re.DOTALL)
    lines = re.findall(r"^\w.*", text, re.MULTILINE)
    return {name for line in lines for name in re.findall(r"\b(\w+)(?=[(,;])", line)}, set(re.findall(r"\b(\w+)##\w+\(", text))


def declarations():
    """What each header declares."""
    paths = [os.path.join(folder, name) for root in (circles.ROOT, LIBRARY) for folder, _, names in os.walk(root)
             for name in names if name.endswith(".h")]
    return {path: declared_functions(path) for path in sorted(paths)}


def functions_and_uses(build):
    """The units that define each function, and the object files that use each symbol without defining it. Objects whose
    source is gone are left over from an older tree and use nothing."""
    objects = [os.path.join(folder, name) for folder, _, names in os.walk(build) for name in names if name.endswith(".c.o")]
    objects = [path for path in objects if os.path.exists(re.sub(r"CMakeFiles/[^/]*\.dir/|\.o$", "", os.path.relpath(path, build)))]
    unit_of_object = {path: unit for unit, path in circles.object_files(build).items()}
    listing = subprocess.run(["nm", "-A", *objects], capture_output=True, text=True, check=True).stdout
    functions, uses = {}, {}
    for line in listing.splitlines():
        path, symbol_line = line.rsplit(":", 1)
        kind, symbol = symbol_line.split()[-2:]
        if kind == "U":
            uses.setdefault(symbol, set()).add(path)
        elif kind in "TWi" and path in unit_of_object:  # i: a kernel with a version for each processor
            functions[symbol] = unit_of_object[path]
    return functions, uses


def main():
    if len(sys.argv) != 2 or not os.path.isdir(circles.ROOT):
        sys.exit(__doc__)
    headers = declarations()
    functions, uses = functions_and_uses(sys.argv[1])
    wrong = 0
    for name, unit in sorted(functions.items(), key=lambda item: (item[1], item[0])):
        public = name.startswith("softfall_")
        own = f"{LIBRARY}/{os.path.basename(unit)}.h" if public else f"{circles.ROOT}/{unit}.h"
        where = [path for path, (names, begins) in headers.items() if name in names or name.startswith(tuple(begins))]
        problem = ""
        if where and where != [own]:
            problem = f"is declared in {' and '.join(where)}, its place is {own}"
        elif not where and name in uses:
            problem = f"is used by other files, but no header declares it; its place is {own}"
        elif where and not public and name not in uses:
            problem = "is declared for other files, but none uses it: make it static"
        if problem and name != "main":
            print(f"{circles.ROOT}/{unit}.c: {name} {problem}")
            wrong += 1
    for unit in sorted(unit for unit in circles.object_files(sys.argv[1]) if not unit.startswith("programs/")):
        name = f"{LIBRARY}/{os.path.basename(unit)}.h" if unit.startswith("api/") else f"{circles.ROOT}/{unit}.h"
        if name not in headers:
            print(f"{circles.ROOT}/{unit}.c has no {name}")
            wrong += 1
    if not functions:
        sys.exit(f"{sys.argv[1]}: no object file of src/ stands there")
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
