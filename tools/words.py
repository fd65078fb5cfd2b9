#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Counts the comments of src/ and include/ that begin with a fragment or a question ("Of the ...", "What ...", "Is it ...?")
instead of a sentence with subject and verb. Exits 1 if there are more than the bounds below, which only fall.

    tools/words.py             the count and each place beyond the bounds
    tools/words.py --list      every place"""
import pathlib
import re
import sys

BOUNDS = {".h": 0, ".c": 0}
FIRST = "Of|What|Whether|Is|Are|Does|Do|Has|How|Where|Those|That|From|As|Beside|Nothing|None"
COMMENT = re.compile(rf"(?:/\*+|//)\s*({FIRST})\b")


def places(root):
    """Yields (suffix, "file:line: text") of each comment that begins with one of the words."""
    for folder in ("src", "include"):
        for path in sorted((root / folder).rglob("*.[ch]")):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                if COMMENT.search(line):
                    yield path.suffix, f"{path.relative_to(root)}:{number}: {line.strip()[:120]}"


def main():
    if sys.argv[1:] not in ([], ["--list"]):
        sys.exit(__doc__)
    found = {suffix: [] for suffix in BOUNDS}
    for suffix, place in places(pathlib.Path(__file__).resolve().parent.parent):
        found[suffix].append(place)
    failed = False
    for suffix, bound in BOUNDS.items():
        too_many = len(found[suffix]) > bound
        failed |= too_many
        if too_many or sys.argv[1:]:
            print("\n".join(found[suffix]))
        print(f"{len(found[suffix])} comments of {suffix} files begin with a fragment or a question (bound {bound})")
    sys.exit(failed)


if __name__ == "__main__":
    main()
