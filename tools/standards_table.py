# SPDX-License-Identifier: GPL-3.0-or-later
"""The table of docs/standards.md, from docs/standards.csv.

    python3 tools/standards_table.py            writes the table into docs/standards.md
    python3 tools/standards_table.py --check    only compares: exit code 1 if the document says anything else
"""
import csv
import os
import sys

DOCS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../docs")
COLUMNS = ["standard", "item", "value", "status", "source"]
SHOWN = COLUMNS[:4]  # the page links the sources in the CSV file
STATUS = {"C": "confirmed", "M": "**not confirmed**", "?": "**not found**"}
BEGIN, END = "<!-- generated: standards -->\n", "<!-- end -->\n"


def fail(text):
    sys.exit("standards_table: " + text)


def read_rows():
    with open(os.path.join(DOCS, "standards.csv"), newline="") as stream:
        reader = csv.DictReader((line for line in stream if not line.startswith("#")), strict=True)
        rows = list(reader)
    if reader.fieldnames != COLUMNS:
        fail("standards.csv has the columns %s" % reader.fieldnames)
    for number, row in enumerate(rows, 1):
        if None in row or None in row.values() or row["status"] not in STATUS:
            fail("row %d of standards.csv: %s" % (number, row))
        if row["status"] == "C" and not row["source"]:
            fail("row %d of standards.csv is confirmed, but names no source" % number)
    return rows


def make_table(rows):
    def cell(text):
        return "not found" if text == "?" else text.replace("|", "\\|")

    lines = ["| " + " | ".join(SHOWN) + " |", "|" + "---|" * len(SHOWN)]
    for row in rows:
        cells = [STATUS[row[key]] if key == "status" else cell(row[key]) for key in SHOWN]
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines) + "\n"


def main():
    if sys.argv[1:] not in ([], ["--check"]):
        fail("usage: tools/standards_table.py [--check]")
    path = os.path.join(DOCS, "standards.md")
    with open(path) as stream:
        old = stream.read()
    if old.count(BEGIN) != 1 or END not in old[old.index(BEGIN):]:
        fail("docs/standards.md has no place for the table")
    head, rest = old.split(BEGIN)
    new = head + BEGIN + make_table(read_rows()) + rest[rest.index(END):]
    if sys.argv[1:] == []:
        with open(path, "w") as stream:
            stream.write(new)
    elif new != old:
        fail("docs/standards.md differs from docs/standards.csv: run tools/standards_table.py")


main()
