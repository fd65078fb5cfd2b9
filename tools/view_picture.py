#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Draws a view.html, or another page, as a PNG by headless Chromium.

    tools/view_picture.py PAGE.html PICTURE.png [WIDTHxHEIGHT] [CONTROL=VALUE]...

The size is 1200x680 unless given; below 700 it is a phone's. A control is one of view.html by its id: time=12, field=1, cut=2."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests"))
import browse  # noqa: E402


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    width, height = map(int, (sys.argv[3] if len(sys.argv) > 3 else "1200x680").split("x"))
    page = browse.Page(sys.argv[1], width, height, phone=width < 700)
    for control in sys.argv[4:]:
        page.choose(*control.split("=", 1))
    page.picture(sys.argv[2])
    page.close()


main()
