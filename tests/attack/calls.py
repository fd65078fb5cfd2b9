# SPDX-License-Identifier: GPL-3.0-or-later
"""Kills and faults at system calls, by strace: each program is ended by SIGKILL, or gets an error, at its n-th call.

After a kill the earlier files are whole, and the same command (or --restart) gives the figures of the undisturbed drop. After an error
the program either succeeds with those figures or refuses in one sentence."""
import os
import re
import shutil

from place import COARSE, LOADER

CALLS = ["openat", "write", "pwrite64", "fsync", "rename", "unlink", "ftruncate", "mkdir", "read", "mmap"]  # not close: strace
# would leave the file open, which no system does
ERRORS = {"openat": ["EMFILE", "EACCES", "EIO"], "write": ["ENOSPC", "EIO", "EINTR"], "pwrite64": ["ENOSPC", "EIO", "EINTR"],
          "fsync": ["EIO", "ENOSPC"], "rename": ["EIO", "ENOSPC", "EXDEV"], "unlink": ["EIO", "EPERM"],
          "ftruncate": ["EIO", "ENOSPC"], "mkdir": ["ENOSPC", "EPERM"], "read": ["EIO", "EINTR"],
          "mmap": ["ENOMEM"]}
PROGRAMS = ["pre", "solve", "post"]


def words(program):
    """The command of a program, in the place's folder, and the product that it replaces."""
    if program == "pre":
        return ["good.cfg", "-o", "model.h5", "--force", *COARSE], "model.h5"
    if program == "solve":
        return ["model.h5", "-o", "results.h5", "--force", "--threads", "1", "--checkpoint-time", "3 ms"], "results.h5"
    return ["results.h5", "-o", "out", "--force"], "out/history.csv"


def listing(place, program, call):
    """Numbers of the calls that the program itself makes (not the loader, which reads .so files, and not its children)."""
    log = place.path("calls.log")
    place.run(["strace", "-qq", "-o", log, "-e", "trace=" + call, *place.command(program, *words(program)[0])])
    with open(log, encoding="utf-8", errors="replace") as file:
        lines = [line for line in file if line.startswith(call + "(")]
    os.remove(log)
    last = max([k for k, line in enumerate(lines) if re.search(r"\.so\b|ld\.so", line)], default=-1)
    if call in ("read", "mmap"):  # of the loader as well: those of the first part are left out by their number
        last = max(last, len(lines) // 2)
    return list(range(last + 2, len(lines) + 1))


def finished(place, clean):
    """Runs what is missing after a disturbance, and says what is then wrong."""
    for program in PROGRAMS:
        outcome = place.run(place.command(program, *words(program)[0]))
        if outcome.fault() or outcome.code != 0:
            return "afterwards: " + (outcome.fault() or outcome.err.strip())
    if place.figures() != clean:
        return "afterwards: other figures"
    left = [name for name in os.listdir(place.folder)
            if re.search(r"partial|\.run$", name) or (name.startswith(".softfall") and "lock" not in name)]
    return "afterwards: %s is left" % left[0] if left else None


def usable(place, clean):
    """The files at this instant: each is absent or can be read, and what is complete has the figures of the drop."""
    if os.path.exists(place.path("results.h5")):
        outcome = place.run(place.command("post", "results.h5", "-o", "check", "--force"))
        shutil.rmtree(place.path("check"), ignore_errors=True)
        if outcome.fault():
            return "results.h5 at that instant: " + outcome.fault()
        if outcome.code != 0 and not re.search(r"row|history|contact|peak|frame", outcome.err):
            return "results.h5 at that instant: " + outcome.err.strip()
    return None


def resumed(place, clean):
    """A killed softfall-solve resumes where it has a checkpoint."""
    if os.path.exists(place.path("results.h5.run")) and os.path.exists(place.path("results.h5.restart")):
        outcome = place.run(place.command("solve", "--restart", "results.h5", "--threads", "1"))
        if outcome.fault():
            return "resuming: " + outcome.fault()
        if outcome.code == 0:
            place.run(place.command("post", "results.h5", "-o", "out", "--force"))
            if place.figures() != clean:
                return "resuming: other figures"
    return None


def attack(place, tally, random, turns, kill):
    place.chain()
    clean = place.figures()
    numbers = {}
    for turn in range(turns):
        program = PROGRAMS[turn % 3]
        while True:
            call = random.choice(CALLS)
            if kill and call in ("read", "mmap"):
                continue
            if (program, call) not in numbers:
                numbers[program, call] = listing(place, program, call)
            if numbers[program, call]:
                break
        number = random.choice(numbers[program, call])
        error = None if kill else random.choice(ERRORS[call])
        inject = "inject=%s:%s:when=%d" % (call, "signal=KILL" if kill else "error=" + error, number)
        attempt = "softfall-%s, %s" % (program, inject)
        product = words(program)[1]
        before = place.read(product)
        log = place.path("calls.log")
        outcome = place.run(["strace", "-qq", "-o", log, "-e", "trace=" + call, "-e", inject,
                             *place.command(program, *words(program)[0])])
        if os.path.exists(log):
            os.remove(log)
        if kill:
            fault = None if outcome.code == -9 else outcome.fault()
            fault = fault or usable(place, clean) or resumed(place, clean) or finished(place, clean)
            tally.count("faults" if fault else "killed" if outcome.code == -9 else "ended before")
            if fault:
                tally.fault(fault, attempt)
        else:
            refused = outcome.code != 0
            gone = refused and product == "model.h5" and place.read(product) != before
            if gone and place.run(place.command("solve", "model.h5", "-o", "check.h5", "--force", "--end-time", "1 ms",
                                                "--no-checkpoint")).code != 0:
                tally.fault("model.h5 is not whole after the refusal", attempt)
            if LOADER in outcome.err:
                tally.count("not started")
            else:
                tally.judge(outcome, attempt)
            fault = finished(place, clean)
            if fault:
                tally.fault(fault, attempt)
                place.chain()
        for name in ("check.h5", "check.h5.restart"):
            if os.path.exists(place.path(name)):
                os.remove(place.path(name))


def kills(place, tally, random, turns):
    attack(place, tally, random, turns, True)


def faults(place, tally, random, turns):
    attack(place, tally, random, turns, False)
