#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes the synthetic compression tests of this folder: no foam was measured.

The truth is the law of docs/theory.md, section 3, with a logarithmic rate effect:
    loading    (1 + C ln(rate / slowest rate)) sigma(e),  sigma(e) = S0 (1 - exp(-K e / S0)) + B ((1 - e)^-M - 1)
    unloading  sigma(e) (HU + (1 - HU) (W(e) / W(0.8))^SHAPE),  W the integral of sigma
Scatter: normal, standard deviation sqrt(ABSOLUTE^2 + (RELATIVE stress)^2), independent.
"""
import math
import random

K, S0, B, M = 410.0, 9.0, 24.0, 2.6  # kPa, kPa, kPa, -
HU, SHAPE, C = 0.03, 3.0, 0.035
ABSOLUTE, RELATIVE = 0.3, 0.006  # kPa, -
TURN = 0.8
TESTS = (("slow", 0.1), ("medium", 2.0), ("fast", 10.0))  # 1/min


def stress(e):
    return S0 * (1 - math.exp(-K * e / S0)) + B * ((1 - e) ** -M - 1)


def energy(e):
    yielding = S0 * e - S0**2 / K * (1 - math.exp(-K * e / S0))
    return yielding + B * (((1 - e) ** (1 - M) - 1) / (M - 1) - e)


def unloading(e):
    return stress(e) * (HU + (1 - HU) * (energy(e) / energy(TURN)) ** SHAPE)


def write(name, rate, noise):
    factor = 1 + C * math.log(rate / TESTS[0][1])
    up = [0.8 * k / 320 for k in range(1, 321)]
    with open(f"{name}.csv", "w", encoding="ascii") as out:
        out.write(f"# SYNTHETIC compression test at {rate:g} per minute, written by make_tests.py: not a measurement\n")
        out.write("strain_percent,stress_kPa\n")
        for e, value in [(e, factor * stress(e)) for e in up] + [(e, unloading(e)) for e in reversed(up[:-1])]:
            value += noise.gauss(0, math.hypot(ABSOLUTE, RELATIVE * value))
            out.write(f"{100 * e:.3f},{value:.3f}\n")


random_numbers = random.Random(1)
for test in TESTS:
    write(*test, random_numbers)
