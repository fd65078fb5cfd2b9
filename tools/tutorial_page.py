#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the commands of a page of Markdown, and puts into the page what they print.

    tools/tutorial_page.py PAGE FOLDER [--check]

In the page, from top to bottom, one folder after the other as `cd` leaves it:
  ```sh ... ```                commands, run by bash; the first that fails ends all
  <!-- run ... -->             commands that a reader does not see
  ```text ... ``` behind them  becomes what they printed to the standard output
  <!-- picture: FILE -->       the picture in the next line, ![...](PATH), becomes that file, at most 100 kB
--check writes nothing, and exits 1 if a text of the page differs: a number by more than 2 %, or anything else."""
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

MOST_BYTES = 100_000
TOLERANCE = 0.02
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
PIECE = re.compile(r"^```(?P<kind>\w*)\n(?P<body>.*?)^```$|^<!-- run\n(?P<hidden>.*?)^-->$"
                   r"|^<!-- picture: (?P<from>\S+) -->\n!\[[^]]*\]\((?P<to>[^)]+)\)$", re.MULTILINE | re.DOTALL)


def run(commands, folder):
    """What they print, and the folder in which they end."""
    with tempfile.NamedTemporaryFile("r") as place:
        script = f'set -euo pipefail\n{commands}\nprintf "%s" "$PWD" > {place.name}\n'
        result = subprocess.run(["bash", "-c", script], cwd=folder, stdout=subprocess.PIPE, text=True)
        if result.returncode != 0:
            sys.exit(f"tutorial_page: these commands failed with exit code {result.returncode}:\n{commands}")
        return result.stdout, place.read()


def differs(old, new):
    """Other words, or a number that differs by more than the tolerance."""
    if NUMBER.sub("N", old).split() != NUMBER.sub("N", new).split():
        return True
    pairs = zip(map(float, NUMBER.findall(old)), map(float, NUMBER.findall(new)))
    return any(abs(a - b) > TOLERANCE * max(abs(a), abs(b)) for a, b in pairs)


def main():
    if len(sys.argv) not in (3, 4) or (len(sys.argv) == 4 and sys.argv[3] != "--check"):
        sys.exit(__doc__)
    path, root, check = sys.argv[1], os.path.abspath(sys.argv[2]), len(sys.argv) == 4
    with open(path, encoding="utf-8") as stream:
        page = stream.read()
    begin, folder, printed, out, at, wrong = time.time(), root, None, [], 0, 0
    for piece in PIECE.finditer(page):
        out.append(page[at:piece.start()])
        at, text = piece.end(), piece.group()
        commands = piece["hidden"] or (piece["body"] if piece["kind"] == "sh" else None)
        if commands:
            printed, folder = run(commands, folder)
        elif piece["kind"] == "text" and printed is not None:
            if check and differs(piece["body"], printed):
                wrong += 1
                print(f"{path} has\n{piece['body']}and the commands print\n{printed}")
            text, printed = "```text\n" + printed + "```", None
        elif piece["from"]:
            source, target = os.path.join(root, piece["from"]), os.path.join(os.path.dirname(path), piece["to"])
            if os.path.getsize(source) > MOST_BYTES:
                wrong += 1
                print(f"tutorial_page: {piece['from']} has {os.path.getsize(source)} bytes, more than {MOST_BYTES}")
            elif not check:
                shutil.copyfile(source, target)
        out.append(text)
    out.append(page[at:])
    if not check:
        with open(path, "w", encoding="utf-8") as stream:
            stream.write("".join(out))
    print(f"{time.time() - begin:.0f} s", file=sys.stderr)
    sys.exit(wrong > 0)


if __name__ == "__main__":
    main()
