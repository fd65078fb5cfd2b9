# SPDX-License-Identifier: GPL-3.0-or-later
"""Extreme values of a case: each is refused, simulated, or ends with a numerical failure that is said.

The keys and their bounds are those that `softfall-pre --keys` lists; values are drawn over the whole range of each, now and then from
beyond it."""
import math
import re
import subprocess

from place import COARSE, MESH_SECONDS

GEOMETRY = {"geometry.parameters.thickness": (1e-6, 1e12), "geometry.parameters.side": (1e-6, 1e12),
            "geometry.missile_parameters.diameter": (1e-6, 1e300)}
NUMBER = r"([-+0-9.e]+)"


def bounds(place):
    """{key: (lowest, highest, unit)} of the numbers of a case."""
    text = subprocess.run(place.command("pre", "--keys"), stdout=subprocess.PIPE, check=True).stdout.decode()
    group, found = "", {}
    for line in text.splitlines():
        if line.startswith("### "):
            group = line[4:].strip()
        match = re.match(r"\| `(\w+)` \| [^|]*?(?:from|above) %s to %s ?([^|]*) \|" % (NUMBER, NUMBER), line)
        if match:
            key, low, high, unit = match.groups()
            found[group + "." + key] = (float(low), float(high), unit.strip())
    return found


def draw(random, low, high):
    """A value over the decades from low to high; one of ten from beyond them."""
    least = low if low > 0 else high * 1e-12
    power = random.uniform(math.log10(least), math.log10(high))
    if random.random() < 0.1:
        power = random.choice([math.log10(least) - 2, min(math.log10(high) + 2, 307)])
    return 10 ** power


def attack(place, tally, random, turns):
    ranges = {**bounds(place), **{key: (*value, None) for key, value in GEOMETRY.items()}}
    for _ in range(turns):
        words = []
        for key in random.sample(sorted(ranges), random.choice([1, 1, 2, 3])):
            low, high, unit = ranges[key]
            value = "%.6e" % draw(random, low, high)
            words += ["--set", "%s=%s" % (key, '"%s %s"' % (value, unit) if unit else value)]
        attempt = " ".join(words)
        outcome = place.run(place.command("pre", "good.cfg", "-o", "model.h5", "--force", *COARSE, "--set",
                                          "geometry.time_limit=20 s", *words), seconds=MESH_SECONDS)
        if outcome.code == 0 and not outcome.fault():
            # A drop may last long by its values alone: interrupted after a while, it ends in the agreed form.
            solve = place.command("solve", "model.h5", "-o", "results.h5", "--force", "--threads", "1")
            outcome = place.run(["timeout", "--preserve-status", "-s", "INT", "15", *solve])
            if outcome.code in (0, 130) and not outcome.fault():
                after = place.run(place.command("post", "results.h5", "-o", "out", "--force"))
                if after.fault():
                    outcome = after
        tally.judge(outcome, attempt)
