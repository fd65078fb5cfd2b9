#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes chapters of docs/verification.md of the sections that the studies of verify/ have written.

    tools/verification_page.py build/verification/NAME...

A chapter whose section is not there, or was skipped, stays. A study writes each check as a row "quantity | measured | required |
pass". Checks "case: quantity" that several cases share become the range of each quantity. Of more than two checks the two nearest to
their bounds stand on the page. Tables that KEPT does not name stay whole; of paragraphs the page has the first sentence, of those in
WHOLE all, of later ones under a heading none unless a table or checks follow. The line after a title, by which the chapter is found,
names the command that writes everything."""
import pathlib
import re
import shutil
import sys

PAGE = pathlib.Path(__file__).resolve().parent.parent / "docs/verification.md"

WHOLE = ("At 42 mm the difference", "With a prescribed depth", "The sphere and the quarter pad", "There is no contact stiffness",
         "Each row has one change", "Quarter models with", "The reference is CalculiX", "no rate effect, H2: 1 of")
SENTENCE_END = re.compile(r"(?<=[.)]) (?=[A-Z*])")
HEAD = "| quantity | measured | required | |"
KEPT = {  # first column of a table: the rows of which one of the first two cells matches; None if the checks below it say enough
    "mesh": None, "body force": None, "foam law": None, "cloud": None, "cells along L": None, "Δt / limit": None, "k h / π": None,
    "spacing h, mm": None, "depth, mm": None, "friction coefficient": None, "mean strain": None, "Z₂/Z₁": None,
    "depth": r"(20|30|38|42) mm",
    "change": r"stabilisation 0\.5|smooth .*|friction .*|DAMP 0|no (rate|hyst|grav).*|tension .*|(speed|mass) .*"}


def checks(lines):
    """[(quantity, measured, required)], or None if a check of the table has not passed."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    return None if any(len(row) != 4 or row[3] != "pass" for row in rows) else [tuple(row[:3]) for row in rows]


def split_case(quantity):
    """("case", "quantity"): the case ends with the first ": "."""
    case, colon, name = quantity.partition(": ")
    return (case, name) if colon else (None, quantity)


def take_matrices(rows):
    """[(case, [row])] of neighbours with one case, grouped by their quantities: {quantities: {case: {quantity: (measured,
    required)}}}. A group of one case stays only if its quantities, six or more, have one bound. Then the other rows."""
    blocks, groups, plain = [], {}, []
    for row in rows:
        case = split_case(row[0])[0]
        if case is None or not blocks or blocks[-1][0] != case:
            blocks.append((case, []))
        blocks[-1][1].append(row)
    for case, block in blocks:
        if case is not None and len(block) > 1:
            names = tuple(split_case(row[0])[1] for row in block)
            groups.setdefault(names, {})[case] = {name: row[1:] for name, row in zip(names, block)}
    for names, cases in list(groups.items()):
        if len(cases) < 2 and (len(names) < 6 or len({row[1] for row in next(iter(cases.values())).values()}) > 1):
            del groups[names]
    for case, block in blocks:
        if case not in groups.get(tuple(split_case(row[0])[1] for row in block), {}):
            plain += block
    return groups, plain


def nearness(measured, required):
    """How near a value is to its bound: 0 far within, 1 at the bound, 2 if the bound cannot be read."""
    value, bounds = float(measured), [float(number) for number in re.findall(r"-?[\d.]+(?:e[-+]?\d+)?", required)]
    if len(bounds) == 2 and bounds[0] == 0:
        return abs(value) / bounds[1]
    if len(bounds) == 2 and bounds[0] < bounds[1]:
        return abs(2 * value - bounds[0] - bounds[1]) / (bounds[1] - bounds[0])
    if len(bounds) == 1 and value != 0 and bounds[0] != 0:
        return bounds[0] / value if required.startswith("≥") else value / bounds[0]
    return 2 if value != bounds[0] else 0


def write_list(what, items):
    """A sentence of the checks, each (name, value as shown, required, nearness): of more than two the two nearest to their bounds."""
    shown = items if len(items) <= 2 else sorted(items, key=lambda item: -item[3])[:2]
    share = "" if len(shown) == len(items) else f" ({len(shown)} of {len(items)} checks)"
    return [f"Required{what}{share}: " + "; ".join(f"{name}: **{value}** ({required})" for name, value, required, _ in shown) + ".", ""]


def write_matrix(names, cases):
    """One table of two cases; of one, or of more with a bound for all, a sentence with the range of each quantity."""
    bound = {name: {cases[case][name][1] for case in cases} for name in names}

    def span(name):
        values = sorted({cases[case][name][0] for case in cases}, key=float)
        required = next(iter(bound[name]))
        return name, " to ".join(dict.fromkeys((values[0], values[-1]))), required, max(nearness(value, required) for value in values)

    if len(cases) != 2 and all(len(required) == 1 for required in bound.values()):
        listed = f" ({'; '.join(cases)})" if len(cases) <= 5 else ""
        return write_list(f", {next(iter(cases))}" if len(cases) == 1 else f", range over {len(cases)} cases{listed}", list(map(span, names)))

    def cell(case, name):
        measured, required = cases[case][name]
        return measured if len(bound[name]) == 1 else f"{measured} ({required})"

    lines = ["| quantity | " + " | ".join(cases) + " | required |", "|---" * (len(cases) + 2) + "|"]
    lines += [f"| {name} | " + " | ".join(cell(case, name) for case in cases) +
              f" | {next(iter(bound[name])) if len(bound[name]) == 1 else ''} |" for name in names]
    return lines + [""]


def write_checks(lines):
    rows = checks(lines)
    if rows is None:
        return [HEAD, "|---|---|---|---|", *lines, ""]
    groups, plain = take_matrices(rows)
    page = write_list("", [(*row, nearness(*row[1:])) for row in plain]) if plain else []
    for names, cases in groups.items():
        page += write_matrix(names, cases)
    return page


def keep(head, lines):
    """The rows that KEPT leaves of a table."""
    title = head.strip("|").split("|")[0].strip()
    if title not in KEPT:
        return [head, *lines]
    rows, pattern = lines[1:], KEPT[title]
    kept = [row for row in rows if pattern and any(re.fullmatch(pattern, cell.strip()) for cell in row.strip("|").split("|")[:2])]
    left_out = [] if len(kept) == len(rows) else ["", f"({len(kept)} of {len(rows)} rows.)"]
    return [head, lines[0], *kept, *left_out] if kept else []


def shorten(text, command):
    """The section as the page has it: headings, pictures, lists, checks, tables and the prose that belongs to them."""
    page, first = [], True  # first: no paragraph since the heading
    blocks = [block for block in re.split(r"\n{2,}", text.strip()) if block]
    for k, block in enumerate(blocks):
        lines = block.split("\n")
        if lines[0].startswith("|"):
            page += [*(write_checks(lines[2:]) if lines[0] == HEAD else keep(lines[0], lines[1:])), ""]
        elif lines[0].startswith("#"):
            page += [lines[0], ""]
            first = True
        elif re.match(r"- |!\[|\d+\.", lines[0]):
            page += [*lines, ""]
        else:
            follows = blocks[k + 1].split("\n") if k + 1 < len(blocks) else [""]
            leads = follows[0] == HEAD or (follows[0].startswith("|") and keep(follows[0], follows[1:]))
            if block.startswith(WHOLE):
                page += [block, ""]
            elif first or leads or block.endswith(":"):
                page += [SENTENCE_END.split(block)[0], ""]
            first = False
    page[2:2] = [f"All checks and tables: {command}", ""]
    return re.sub(r"\n{3,}", "\n\n", "\n".join(page)).strip()


def main():
    chapters = [chapter.strip() for chapter in re.split(r"(?m)^(?=## )", PAGE.read_text(encoding="utf-8"))]
    for path in map(pathlib.Path, sys.argv[1:]):
        section, command = path.with_suffix(".md"), f"`build/verify/study_{path.name} DIR`"
        if not section.exists() or "\nSkipped: " in (text := section.read_text(encoding="utf-8")):
            print(f"{path.name} stays")
            continue
        place = next((k for k, chapter in enumerate(chapters) if command in chapter), len(chapters))
        chapters[place:place + 1] = [shorten(text, command)]
        for picture in re.findall(r"\(images/verification/(.*?)\)", text):
            shutil.copy(path.parent / picture, PAGE.parent / "images/verification")
        print(f"{path.name} is new")
    PAGE.write_text("\n\n".join(chapters) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
