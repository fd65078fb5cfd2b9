#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Attacks the programs and prints counts: tests/attack/attack.py [--seed N] [--scale F] [PART...]

Parts: flips kills faults limits physics geometries (all of them by default). The programs are those of SF_BIN_DIR, or of build/bin.
Exit code 0 if no attack found a fault; docs/reliability.md has the counts of the last run."""
import argparse
import concurrent.futures
import os
import random
import shutil
import sys
import time

import calls
import flips
import geometries
import limits
import physics
from place import Place, Tally

PARTS = {  # name: function and turns at scale 1
    "flips": (flips.attack, 270),
    "kills": (calls.kills, 50),
    "faults": (calls.faults, 80),
    "limits": (limits.attack, 200),
    "physics": (physics.attack, 60),
    "geometries": (geometries.attack, 200),
}


def run(name, seed, scale):
    function, turns = PARTS[name]
    tally, start = Tally(name), time.monotonic()
    with Place() as place:
        try:
            function(place, tally, random.Random("%d %s" % (seed, name)), max(1, round(turns * scale)))
        except RuntimeError as error:  # the undisturbed drop fails afterwards: a fault that ends the part
            tally.fault(str(error), "after %d attempts" % sum(tally.counts.values()))
    for fault in tally.faults:
        print("FAULT " + fault, flush=True)
    tally.seconds = time.monotonic() - start
    return tally


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=" ".join(PARTS))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--scale", type=float, default=1.0, help="factor on the number of attempts")
    arguments = parser.parse_args()
    unknown = [name for name in arguments.parts if name not in PARTS]
    if unknown:
        parser.error("unknown part %s" % unknown[0])
    names = arguments.parts or list(PARTS)
    if not shutil.which("strace"):
        print("strace is not installed: kills and faults are left out")
        names = [name for name in names if name not in ("kills", "faults")]
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        tallies = list(pool.map(lambda name: run(name, arguments.seed, arguments.scale), names))
    print("| attack | attempts | outcomes | faults | s |\n|---|---:|---|---:|---:|")
    for tally in tallies:
        outcomes = ", ".join("%s %d" % item for item in sorted(tally.counts.items()) if item[0] != "faults")
        print("| %s | %d | %s | %d | %.0f |" % (tally.name, sum(tally.counts.values()), outcomes, len(tally.faults), tally.seconds))
    return 1 if any(tally.faults for tally in tallies) else 0


if __name__ == "__main__":
    sys.exit(main())
