# SPDX-License-Identifier: GPL-3.0-or-later
"""A place of an attack: a folder with a coarse drop (a second for the whole chain), and the judgement of what a program did.

The contract that every attack checks (docs/reliability.md): a program ends by itself within its time; it either succeeds, with the
results of the undisturbed drop where nothing may change them, or it says one sentence, `softfall-NAME: ...`, exits with a code of its
own, and leaves earlier files whole.
"""
import os
import re
import shutil
import signal
import subprocess
import tempfile
import threading

COARSE = ["--set", "geometry.parameters.fine_spacing=20.0", "--set", "geometry.parameters.outer_spacing=20.0",
          "--set", "geometry.missile_parameters.element_size=20.0", "--set", "pad.mesh_error_limit=1",
          "--set", "output.frame_interval=4 ms"]
CODES = {2, 3, 4, 5, 6, 7, 8, 9, 64, 130}  # of the programs; everything else is a crash or an accident
OUTCOMES = {0: "succeeded", 5: "numerical failure", 130: "interrupted"}  # all others: refused
SECONDS = 60  # a command of the coarse drop takes half a second; a slow machine is not a hang
MESH_SECONDS = 600  # where gmsh may take 20 s of processor time: a starved process takes ten times that and more on the clock
SANITIZERS = re.compile(r"(Address|Leak|Thread|UndefinedBehavior)Sanitizer|runtime error:")
LOADER = "error while loading shared libraries"  # the attack ends the program before its first line
SENTENCE = re.compile(r"^(softfall-\w+): (?!warning: |note: )")  # of an error; warnings and notes may stand before it

_source = os.path.realpath(os.path.join(os.path.dirname(__file__), "..", ".."))
_bin = os.environ.get("SF_BIN_DIR", os.path.join(_source, "build", "bin"))


class Outcome:
    """What a command did: code (negative: a signal), text of stderr, and whether it ran out of time."""

    def __init__(self, code, err, hung):
        self.code, self.err, self.hung = code, err, hung

    def fault(self):
        """What is wrong with it, or None: it succeeded, or it refused in the agreed form."""
        if self.hung:
            return "hangs"
        if SANITIZERS.search(self.err):
            return "sanitizer: " + SANITIZERS.search(self.err).group(0)
        if self.code == 0:
            return None
        if self.code < 0:
            return "ended by " + signal.Signals(-self.code).name
        if self.code not in CODES:
            return "exit code %d: %s" % (self.code, self.err.strip()[-200:])
        lines = self.err.splitlines()
        errors = [line for line in lines if SENTENCE.match(line)]
        others = [line for line in lines if not line.startswith("softfall-")]
        if len(errors) != 1:
            return "%d sentences with exit code %d: %s" % (len(errors), self.code, self.err.strip()[-300:])
        if others:
            return "lines that are not ours: %s" % others[0][:200]
        return None


class Place:
    """A temporary folder with good.cfg, its geometry and materials; chain() makes model.h5, results.h5 and out."""

    def __init__(self):
        self.folder = tempfile.mkdtemp(prefix="softfall-attack-")
        self.home = tempfile.mkdtemp(prefix="softfall-home-")
        for part in ("geo", "examples/materials"):
            shutil.copytree(os.path.join(_source, part), self.path(os.path.basename(part)))
        with open(os.path.join(_source, "examples/eva50-v4.5/case.cfg"), encoding="utf-8") as file:
            text = file.read().replace("../../geo", "geo").replace("../materials", "materials")
        self.write("good.cfg", text)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        shutil.rmtree(self.folder, ignore_errors=True)
        shutil.rmtree(self.home, ignore_errors=True)

    def path(self, name):
        return os.path.join(self.folder, name)

    def write(self, name, data):
        with open(self.path(name), "wb") as file:
            file.write(data.encode() if isinstance(data, str) else data)

    def read(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def command(self, program, *words):
        return [os.path.join(_bin, "softfall-" + program), *words]

    def run(self, command, seconds=SECONDS, shell_limits=None, **environment):
        """Runs a command in the folder. shell_limits: words of ulimit set before it, such as "-f 8"."""
        if shell_limits:
            command = ["bash", "-c", "ulimit %s && exec \"$@\"" % shell_limits, "bash", *command]
        values = {**os.environ, "OMP_NUM_THREADS": "1", "HOME": self.home, **environment}
        process = subprocess.Popen(command, cwd=self.folder, env=values, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                   stderr=subprocess.PIPE, start_new_session=True)
        hung = threading.Event()

        def end():
            hung.set()
            os.killpg(process.pid, signal.SIGKILL)

        clock = threading.Timer(seconds, end)
        clock.start()
        err = process.communicate()[1].decode(errors="replace")
        clock.cancel()
        return Outcome(process.returncode, err, hung.is_set())

    def good(self, program, *words):
        """Runs a program that must succeed."""
        outcome = self.run(self.command(program, *words))
        if outcome.code != 0:
            raise RuntimeError("softfall-%s: the undisturbed drop fails: %s" % (program, outcome.err))

    def chain(self):
        self.good("pre", "good.cfg", "-o", "model.h5", "--force", *COARSE)
        self.good("solve", "model.h5", "-o", "results.h5", "--force", "--threads", "1")
        self.good("post", "results.h5", "-o", "out", "--force")

    def figures(self, out="out"):
        """What two drops must have in common to the bit: the history and the section through the pad at the peak."""
        return self.read(out + "/history.csv") + self.read(out + "/section.csv")

    def tree(self):
        """Names and contents of all files of the folder and the home (small: the drop is coarse)."""
        found = {}
        for root in (self.folder, self.home):
            for folder, folders, names in os.walk(root):
                for name in folders:
                    found[os.path.join(folder, name)] = "folder"
                for name in names:
                    path = os.path.join(folder, name)
                    if os.path.islink(path) or not os.path.isfile(path):
                        found[path] = "other"
                        continue
                    with open(path, "rb") as file:
                        found[path] = file.read()
        return found


def changed(before, after):
    """Paths that were made, changed or removed between two trees."""
    return sorted(path for path in before.keys() | after.keys() if before.get(path) != after.get(path))


class Tally:
    """Counts of one attack, by outcome; faults are kept with what repeats them."""

    def __init__(self, name):
        self.name, self.counts, self.faults = name, {}, []
        self.lock = threading.Lock()

    def count(self, outcome):
        with self.lock:
            self.counts[outcome] = self.counts.get(outcome, 0) + 1

    def fault(self, what, attempt):
        with self.lock:
            self.faults.append("%s: %s: %s" % (self.name, attempt, what))

    def judge(self, outcome, attempt, further=None):
        """Counts an outcome: refused, succeeded, or a fault. `further` is a check of what a success left, which returns a fault
        or None."""
        fault = outcome.fault()
        if not fault and outcome.code == 0 and further:
            fault = further()
        if fault:
            self.fault(fault, attempt)
        self.count("faults" if fault else OUTCOMES.get(outcome.code, "refused"))
        return not fault
