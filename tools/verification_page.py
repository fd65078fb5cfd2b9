#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Assembles the sections that the studies of verify/ write into one page, and shortens their tables of checks.

    tools/verification_page.py SECTION.md... >docs/verification.md

A study writes each check as a row "quantity | measured | required | pass". Checks "case: quantity" that several cases
share become one table of cases against quantities; a table of up to four checks becomes a sentence. Every figure and
every bound stays."""
import re
import sys

HEAD = "| quantity | measured | required | |"
SENTENCE = 4  # checks: a longer table stays one


def checks(lines):
    """[(quantity, measured, required)], or None if a check of the table has not passed."""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")] for line in lines]
    return None if any(len(row) != 4 or row[3] != "pass" for row in rows) else [tuple(row[:3]) for row in rows]


def split_case(quantity):
    """("case", "quantity"): the case ends with the first ": "."""
    case, colon, name = quantity.partition(": ")
    return (case, name) if colon else (None, quantity)


def take_matrix(rows):
    """The cases at the beginning of the rows that have the same quantities with the same bounds: ([case], [(name, required)],
    {(case, name): measured}), and the rows after them."""
    cases, names, values, rest = [], [], {}, list(rows)
    while rest:
        case = split_case(rest[0][0])[0]
        size = 0
        while case is not None and size < len(rest) and split_case(rest[size][0])[0] == case:
            size += 1
        own = [(split_case(row[0])[1], row[2]) for row in rest[:size]]
        if case is None or size < 2 or (names and own != names):
            break
        names = own
        cases.append(case)
        values.update({(case, split_case(row[0])[1]): row[1] for row in rest[:size]})
        rest = rest[size:]
    return cases, names, values, rest


def write_matrix(cases, names, values):
    if len(cases) >= len(names):
        lines = ["| | " + " | ".join(f"{name} ({required})" for name, required in names) + " |", "|---" * (len(names) + 1) + "|"]
        lines += [f"| {case} | " + " | ".join(values[case, name] for name, _ in names) + " |" for case in cases]
    else:
        lines = ["| quantity | " + " | ".join(cases) + " | required |", "|---" * (len(cases) + 2) + "|"]
        lines += [f"| {name} | " + " | ".join(values[case, name] for case in cases) + f" | {required} |" for name, required in names]
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
    plain, page = [], []
    while rows:
        cases, names, values, rest = take_matrix(rows)
        if len(cases) > 1:
            page += write_rows(plain) + write_matrix(cases, names, values)
            plain, rows = [], rest
        else:
            plain.append(rows[0])
            rows = rows[1:]
    return page + write_rows(plain)


def shorten(text):
    page, lines = [], text.split("\n")
    while lines:
        line = lines.pop(0)
        if line != HEAD:
            page.append(line)
            continue
        table = []
        lines.pop(0)
        while lines and lines[0].startswith("|"):
            table.append(lines.pop(0))
        page += write_checks(table)
    return re.sub(r"\n{3,}", "\n\n", "\n".join(page)).strip() + "\n"


def main():
    print("\n".join(shorten(open(path, encoding="utf-8").read()) for path in sys.argv[1:]), end="")


if __name__ == "__main__":
    main()
