#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assembles the sections that the studies of verify/ write into one page, and shortens their tables of checks.

    tools/verification_page.py SECTION.md... >docs/verification.md

A study writes each check as a row "quantity | measured | required | pass". Checks "case: quantity" that several cases
share become one table of cases against quantities; up to six checks become a sentence. A table named in TURNED gets one
row for all values of its column. Every figure and every bound stays."""
import re
import sys

HEAD = "| quantity | measured | required | |"
SENTENCE = 6  # checks: a longer table stays one
TURNED = {"cloud": 3, "body force": 5, "foam law": 4}  # first column: figures at the end of a row that stand beside those of its other values


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


def write_matrix(names, cases):
    bound = {name: {cases[case][name][1] for case in cases} for name in names}

    def head(name):
        return f"{name} ({next(iter(bound[name]))})" if len(bound[name]) == 1 else name

    def cell(case, name):
        measured, required = cases[case][name]
        return measured if len(bound[name]) == 1 else f"{measured} ({required})"

    if len(cases) == 1:
        case = next(iter(cases))
        required = next(iter(bound[names[0]]))
        return [f"| {case} | {' | '.join(names)} |", "|---" * (len(names) + 1) + "|",
                f"| {required} | " + " | ".join(cases[case][name][0] for name in names) + " |", ""]
    if len(cases) >= len(names):
        lines = ["| | " + " | ".join(head(name) for name in names) + " |", "|---" * (len(names) + 1) + "|"]
        lines += [f"| {case} | " + " | ".join(cell(case, name) for name in names) + " |" for case in cases]
    else:
        lines = ["| quantity | " + " | ".join(cases) + " | required |", "|---" * (len(cases) + 2) + "|"]
        lines += [f"| {name} | " + " | ".join(cell(case, name) for case in cases) +
                  f" | {next(iter(bound[name])) if len(bound[name]) == 1 else ''} |" for name in names]
    return lines + [""]


def write_rows(rows):
    if not rows:
        return []
    if len(rows) <= SENTENCE:
        return ["Required: " + "; ".join(f"{name}: **{measured}** ({required})" for name, measured, required in rows) + ".", ""]
    return ["| quantity | measured | required |", "|---|---|---|"] + [f"| {' | '.join(row)} |" for row in rows] + [""]


def write_checks(lines):
    rows = checks(lines)
    if rows is None:
        return [HEAD, "|---|---|---|---|", *lines, ""]
    groups, plain = take_matrices(rows)
    page = write_rows(plain)
    for names, cases in groups.items():
        page += write_matrix(names, cases)
    return page


def turn(head, lines):
    """The table with the figures of all values of its first column side by side, or the table itself."""
    titles, *rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in [head, *lines[1:]]]
    figures = TURNED.get(titles[0])
    if not figures:
        return [head, *lines]
    groups = list(dict.fromkeys(row[0] for row in rows))
    table = {}
    for row in rows:
        table.setdefault(tuple(row[1:-figures]), {})[row[0]] = row[-figures:]
    title = titles[1:-figures]
    for group in groups:
        title += [f"{group}: {titles[-figures]}", *titles[1 - figures:]]
    return [f"| {' | '.join(title)} |", "|---" * len(title) + "|"] + [
        "| " + " | ".join([*key, *(cell for group in groups for cell in table[key].get(group, [""] * figures))]) + " |" for key in table]


def shorten(text):
    page, lines = [], text.split("\n")
    while lines:
        line = lines.pop(0)
        if not line.startswith("|"):
            page.append(line)
            continue
        table = []
        while lines and lines[0].startswith("|"):
            table.append(lines.pop(0))
        page += write_checks(table[1:]) if line == HEAD else turn(line, table)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(page)).strip() + "\n"


def main():
    print("\n".join(shorten(open(path, encoding="utf-8").read()) for path in sys.argv[1:]), end="")


if __name__ == "__main__":
    main()
