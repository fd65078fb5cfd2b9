#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes the records of this example: pulses of a spring that stiffens, with noise; later drops on a spot are harder.

python3 make.py, in this folder; the random numbers have a fixed seed.
"""
import math
import random

random.seed(1)
POSITIONS = {"centre": 1.0, "edge": 1.06, "corner": 1.15}  # factors of the peak
RATE, MASS = 10000, 4.6

with open("list.csv", "w", encoding="utf-8") as table:
    table.write("file,position,height,drop\n")
    for position, hard in POSITIONS.items():
        for height in (0.6, 0.9, 1.2):
            for drop in (1, 2, 3):
                name = f"{position}-{height:g}-{drop}.csv"
                table.write(f"{name},{position},{height:g} m,{drop}\n")
                peak = hard * (1, 1.06, 1.08)[drop - 1] * 82 * (height / 0.9) ** 0.9
                duration = 2 * math.sqrt(2 * 9.80665 * height) / (0.55 * peak * 9.80665)
                with open(name, "w", encoding="utf-8") as file:
                    file.write("time (ms),acceleration (g)\n")
                    for k in range(-50, 250):
                        t = k / RATE
                        a = peak * math.sin(math.pi * t / duration) ** 1.5 if 0 < t < duration else 0
                        file.write(f"{1e3 * t:.1f},{a + random.gauss(0, 0.15):.2f}\n")
