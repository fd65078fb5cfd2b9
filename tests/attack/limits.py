# SPDX-License-Identifier: GPL-3.0-or-later
"""Resource limits and environments under which each program runs or refuses."""
from place import COARSE, LOADER

LIMITS = ["-f 0", "-f 1", "-f 8", "-f 64", "-f 512", "-f 2000", "-s 64", "-s 100", "-s 256", "-s 1024", "-s unlimited", "-n 8", "-n 12",
          "-n 16", "-n 24", "-v 300000", "-v 500000", "-v 800000", "-c 0", "-u 1", "-u 20", "-t 1", "-m 1000", "-l 0"]
ENVIRONMENTS = [{"OMP_NUM_THREADS": "999999"}, {"OMP_NUM_THREADS": "-1"}, {"OMP_NUM_THREADS": "abc"}, {"OMP_NUM_THREADS": "2,3"},
                {"OMP_NUM_THREADS": ""}, {"OMP_STACKSIZE": "1"}, {"OMP_STACKSIZE": "99999G"}, {"OMP_THREAD_LIMIT": "1"},
                {"OMP_DYNAMIC": "true"}, {"GOMP_SPINCOUNT": "x"}, {"OMP_SCHEDULE": "what"}, {"LC_ALL": "de_DE.UTF-8"}, {"LC_ALL": "xx"},
                {"LANG": "C"}, {"HOME": "/nonexistent"}, {"HOME": ""}, {"PATH": ""}, {"TMPDIR": "/nonexistent"}, {"TERM": ""},
                {"COLUMNS": "0"}, {"HDF5_USE_FILE_LOCKING": "BEST_EFFORT"}, {"HDF5_PLUGIN_PATH": "/nonexistent"},
                {"UDUNITS2_XML_PATH": "/nonexistent"}, {"GSL_RNG_TYPE": "what"}, {"GNUPLOT_LIB": "/nonexistent"},
                {"SOFTFALL_MEMORY_MB": "0"}, {"SOFTFALL_MEMORY_MB": "abc"}, {"SOFTFALL_MEMORY_MB": "1e300"}]


def attack(place, tally, random, turns):
    place.chain()
    clean = place.figures()
    commands = {
        "pre": place.command("pre", "good.cfg", "-o", "model.h5", "--force", *COARSE),
        "solve": place.command("solve", "model.h5", "-o", "results.h5", "--force"),
        "post": place.command("post", "results.h5", "-o", "out", "--force"),
    }
    attempts = [(program, limit, {}) for program in commands for limit in LIMITS]
    attempts += [(program, None, values) for program in commands for values in ENVIRONMENTS]
    random.shuffle(attempts)
    for program, limit, values in attempts[:turns]:
        outcome = place.run(commands[program], shell_limits=limit, **values)
        attempt = "softfall-%s with %s" % (program, "ulimit " + limit if limit else values)
        if LOADER in outcome.err or "Cannot fork" in outcome.err:
            tally.count("not started")
        elif limit == "-t 1" and outcome.code in (-9, -24):
            tally.count("not started")  # the kernel's own end; nothing can be said
        else:
            tally.judge(outcome, attempt)
        if outcome.code != 0:  # earlier files are whole, and the drop can be run
            for name in ("solve", "post"):
                after = place.run(commands[name])
                if after.code != 0:
                    tally.fault("afterwards softfall-%s fails: %s" % (name, after.err.strip()), attempt)
                    place.chain()
            if place.figures() != clean:
                tally.fault("afterwards other figures", attempt)
