# SPDX-License-Identifier: GPL-3.0-or-later
"""Bit flips, cuts and swapped bytes in every file that a program reads."""
import shutil

from place import COARSE

RIG = "h_m,v_test_m_s\n0.5,3.0\n1.0,4.3\n1.5,5.3\n2.0,6.1\n"


def damage(data, random):
    """A damaged copy of the bytes, and the word for it."""
    data = bytearray(data)
    kind = random.choice(["bit"] * 6 + ["cut", "double", "zeros"])
    at = random.randrange(len(data))
    if kind == "bit":
        data[at] ^= 1 << random.randrange(8)
    elif kind == "cut":
        del data[at:]
    elif kind == "double":
        data[at:at] = data[at:at + random.randrange(1, 200)]
    else:
        length = min(random.randrange(1, 200), len(data) - at)
        data[at:at + length] = bytes(length)
    return bytes(data), "%s at byte %d" % (kind, at)


def reference(place):
    """acceleration.csv as a laboratory would send it."""
    rows = place.read("out/history.csv").decode().splitlines()
    names = rows[0].split(",")
    time = next(k for k, name in enumerate(names) if name.startswith("time"))
    value = next(k for k, name in enumerate(names) if name.startswith("acceleration"))
    out = ["time_ms,acceleration_m_s2"]
    for row in rows[1::2]:
        cells = row.split(",")
        out.append("%.4f,%s" % (float(cells[time]) * (1 if "ms" in names[time] else 1e3), cells[value]))
    return "\n".join(out) + "\n"


def prepare(place):
    """The undisturbed drop, the state of an interrupted run, and a measured curve."""
    place.chain()
    place.write("reference.csv", reference(place))
    place.write("rig.csv", RIG)
    place.good("solve", "model.h5", "-o", "half.h5", "--threads", "1", "--end-time", "9 ms")
    place.good("post", "results.h5", "-o", "compared", "--reference", "reference.csv")
    return place.figures()


def targets(place, clean):
    """Files, the commands that read them, and whether success must give the figures of the undisturbed drop."""
    pre = place.command("pre", "good.cfg", "-o", "m.h5", "--force", *COARSE)
    solve = place.command("solve", "model.h5", "-o", "r.h5", "--force", "--threads", "1")
    post_of_solve = place.command("post", "r.h5", "-o", "o", "--force")
    resume = place.command("solve", "--restart", "half.h5", "--end-time", "40 ms", "--threads", "1")
    post_of_half = place.command("post", "half.h5", "-o", "o", "--force")
    post = place.command("post", "results.h5", "-o", "o", "--force")
    compare = place.command("post", "results.h5", "-o", "o", "--force", "--reference", "reference.csv")
    return [
        ("good.cfg", [pre], None), ("materials/eva35.cfg", [pre], None), ("geo/pad.geo", [pre], None),
        ("geo/hemisphere.geo", [pre], None), ("model.h5", [solve, post_of_solve], clean),
        ("results.h5", [post], clean), ("half.h5", [resume, post_of_half], clean),
        ("half.h5.restart", [resume, post_of_half], clean), ("reference.csv", [compare], None),
    ]


def attack(place, tally, random, turns):
    clean = prepare(place)
    kept = {name: place.read(name) for name in ("half.h5", "half.h5.restart")}
    files = targets(place, clean)
    for turn in range(turns):
        name, commands, figures = files[turn % len(files)]
        whole = place.read(name)
        broken, word = damage(whole, random)
        place.write(name, broken)
        for command in commands[:-1]:
            outcome = place.run(command)
            if outcome.fault() or outcome.code != 0:
                break
        else:
            outcome = place.run(commands[-1])

        def same():
            if figures is not None and place.figures("o") != figures:
                return "succeeds with other figures"
            return None

        tally.judge(outcome, "%s, %s" % (name, word), same)
        place.write(name, whole)
        for kept_name, data in kept.items():
            place.write(kept_name, data)
        shutil.rmtree(place.path("o"), ignore_errors=True)
        shutil.rmtree(place.path("half.h5.run"), ignore_errors=True)
