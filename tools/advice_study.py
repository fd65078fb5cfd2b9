#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How many drops until a decision: the advice of softfall protocol against a fixed plan, on synthetic foams (docs/protocols.md).

    tools/advice_study.py [FOAMS] [-o DIR]

A foam is a draw of examples/materials/eva35_posterior whose loading curve is bent by a smooth random factor of 6 % (standard deviation), which no
form of the fit has. Its drops are simulated and read between their heights, with random errors of the model and, from drop to drop, the scatter of
speed and thickness. A quarter of the foams locks up earlier than any draw, between 60 and 100 % of the height asked for: above it the figures
are higher by the third to twelfth power of the ratio of heights. The question is whether the pad passes from a height, drawn between the 5 and 95 % quantiles of the critical height
that the posterior expects. Fixed plan: three drops from that height, decided by the mean of the second and the third. The last plan is decided by the
larger probability after three drops, where the bound is not met.
"""
import argparse
import csv
import dataclasses
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "python"))

import numpy as np  # noqa: E402

from softfall import advice, cfh_command  # noqa: E402
from softfall.protocol_places import place_of  # noqa: E402

POSTERIOR = ROOT / "examples/materials/eva35_posterior"
LIMITS = (200.0, 1000.0)
BEND, LOCKED = 0.06, 0.25
# bound of a wrong decision (None: fixed), the most drops, and whether the larger probability decides after them
PLANS = ((None, 3, True), (0.05, 12, False), (0.1, 3, True))
COARSE = ["--set=geometry.parameters.fine_spacing=10", "--set=pad.mesh_error_limit=1"]


def bend(strain, random):
    """Returns a smooth random factor over the strain."""
    log = sum(random.standard_normal() * np.cos(np.pi * k * strain + random.uniform(0, 2 * np.pi)) for k in range(1, 5))
    return np.exp(BEND * log / np.sqrt(2))


def make_foams(folder, count, random):
    """Writes `count` foams as draws of a posterior."""
    folder.mkdir(parents=True, exist_ok=True)
    sources = sorted(POSTERIOR.glob("draw-*.cfg"))
    for k in range(1, count + 1):
        source = sources[random.integers(len(sources))]
        lines = source.with_suffix(".csv").read_text().splitlines()
        rows = list(csv.reader(line for line in lines if not line.startswith("#")))
        table = np.array(rows[1:], float)
        stress = np.maximum.accumulate(table[:, 1] * bend(table[:, 0], random))
        text = "\n".join([",".join(rows[0]), *(f"{e:.9g},{s:.9g}" for e, s in zip(table[:, 0], stress))])
        (folder / f"draw-{k:03d}.csv").write_text(text + "\n")
        (folder / f"draw-{k:03d}.cfg").write_text(source.read_text().replace(source.with_suffix(".csv").name, f"draw-{k:03d}.csv"))


def search(output, posterior):
    """Simulates the 50 mm pad with every draw of a posterior."""
    words = [str(ROOT / "examples/eva50-axisymmetric/case.cfg"), f"--output={output}", "--force", f"--posterior={posterior}", *COARSE]
    return place_of("centre", cfh_command.find(cfh_command.parser("advice_study").parse_args(words), lambda text: None, lambda text: None, "advice_study"))


def measure(foam, pad, height, random):
    """Returns the figures of a drop of a foam."""
    return tuple(np.exp(np.minimum(foam.predict("centre", height)[:, pad] + foam.scatter("centre", height) * random.standard_normal(), 50)))


def passes(figures):
    return all(value < limit for value, limit in zip(figures, LIMITS))


def decide(place, question, most, forced, foam, pad, random):
    """Measures as advised until a decision; returns it (None: none), the number of drops and the last advice."""
    pads = advice.Pads([place], limits=LIMITS)
    for count in range(most + 1):
        told = advice.advise(pads, question)
        if told.stop or told.problem:
            return told.decision, count, told
        if count == most:
            return told.probability > 0.5 if forced else None, count, told
        height = next(choice.height for choice in told.choices if choice.place)
        pads.learn(advice.Drop("centre", height, measure(foam, pad, height, random)))


def try_plan(place, foam, pads, required, bound, most, forced, seed):
    """Returns the counts of a plan of PLANS over the pads."""
    random, count = np.random.default_rng(seed), dict.fromkeys(("drops", "wrong", "open", "no foam", "held", "passed", "passed wrongly", "stated"), 0)
    truth = foam.crossing("centre", LIMITS)
    for pad, height in zip(pads, required):
        right = bool(truth[pad] > height)
        if bound is None:
            figures = [measure(foam, pad, height, random) for _ in range(3)]
            count["drops"] += 3
            count["wrong"] += passes(np.mean(figures[1:], axis=0)) != right
            continue
        decision, drops, last = decide(place, advice.Question(LIMITS, required=height, bound=bound), most, forced, foam, pad, random)
        count["drops"] += drops
        count["no foam"] += bool(last.problem)
        count["open"] += decision is None and not last.problem
        count["wrong"] += decision is not None and decision != right
        if decision:
            count["passed"] += 1
            count["passed wrongly"] += not right
            count["stated"] += 1 - last.probability
        count["held"] += not last.problem and last.height[0] <= truth[pad] <= last.height[2]
    return count


def distances(place, synthetic, low, high):
    """Returns the root mean squares of ln(figure) between foams and the draws nearest to them, at heights between two."""
    heights = np.linspace(np.log(low), np.log(high), 9)
    foams, draws = (np.array([[np.interp(heights, p.log_height, row) for row in p.value[c]] for c in range(2)]) for p in (synthetic, place))
    away = foams[:, :, None] - draws[:, None]  # [2][foams][draws][heights]
    square = (away**2).mean(axis=3)
    nearest = (square / np.reshape(advice.FORM, (2, 1, 1)) ** 2).sum(axis=0).argmin(axis=1)
    return np.sqrt(square[:, np.arange(nearest.size), nearest].mean(axis=1))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("foams", nargs="?", type=int, default=200)
    parser.add_argument("-o", default=str(ROOT / "out/advice"))
    o = parser.parse_args()
    output, random, n = pathlib.Path(o.o), np.random.default_rng(7), o.foams
    make_foams(output / "foams", max(n, 100), random)  # an interval needs 100
    place, synthetic = search(output / "posterior", POSTERIOR), search(output / "synthetic", output / "foams")
    synthetic = dataclasses.replace(synthetic, bound=np.full(synthetic.bound.shape, np.inf))  # a real drop has figures at every height
    foam = advice.Pads([synthetic], seed=11, form=(0, 0))  # it has a form of its own
    low, high = np.quantile(advice.Pads([place]).crossing("centre", LIMITS), [0.05, 0.95])
    pads = np.arange(n) * advice.REPEATS + random.integers(advice.REPEATS, size=n)
    required = random.uniform(low, high, n)
    locked = random.permutation(n)[:round(LOCKED * n)]
    foam.lock["centre"][pads[locked]] = required[locked] * random.uniform(0.6, 1, locked.size)
    print(f"{n} foams; limits {LIMITS[0]:g} g and HIC {LIMITS[1]:g}; heights required {low:.2f} to {high:.2f} m")
    print("from the nearest draw: {:.1%} of a_max, {:.1%} of HIC".format(*distances(place, synthetic, low, high)))
    print("| plan | drops for each pad | with three more where nothing is decided | wrong decisions (%) | open after 12 drops (%) | foam is none of the draws (%) | interval holds the height (%) | expected to pass | of these wrong, stated |\n"
          "|---|---:|---:|---:|---:|---:|---:|---:|---:|")
    for bound, most, forced in PLANS:
        count = try_plan(place, foam, pads, required, bound, most, forced, 5)
        held = "–" if bound is None else f"{100 * count['held'] / max(n - count['no foam'], 1):.1f}"
        name = "three drops from the height" if bound is None else f"as advised, to {100 * bound:g} % of a wrong decision"
        name += f", at most {most} drops" if bound and forced else ""
        charged = count["drops"] + 3 * (count["open"] + count["no foam"])
        print(f"| {name} | {count['drops'] / n:.2f} | {charged / n:.2f} | " + " | ".join(f"{100 * count[key] / n:.1f}" for key in ("wrong", "open", "no foam")) + f" | {held} |"
              + (" – | – |" if bound is None else f" {count['passed']} | {count['passed wrongly']}, {count['stated']:.1f} |"),
              flush=True)


if __name__ == "__main__":
    main()
