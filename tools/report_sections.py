#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Writes sections of a report.html as Markdown into a document.

    tools/report_sections.py report.html document.md [OTHER...]

Replaces the text between the lines `<!-- NAME -->` and `<!-- end -->` of the document by the paragraphs and tables of the
section whose heading, in small letters with hyphens, is NAME. A name that the report does not have is an error,
unless it is one of OTHER: those sections come from elsewhere and stay as they are.
"""
import re
import sys
import xml.etree.ElementTree as tree

XHTML = "{http://www.w3.org/1999/xhtml}"


def text_of(element):
    return re.sub(r"\s+", " ", "".join(element.itertext())).strip()


def table_lines(table):
    heads = list(table.find(f"{XHTML}thead").iter(f"{XHTML}th"))
    lines = ["| " + " | ".join(text_of(h) for h in heads) + " |"]
    lines.append("|" + "|".join("---:" if h.get("class") == "r" else "---" for h in heads) + "|")
    for row in table.find(f"{XHTML}tbody").iter(f"{XHTML}tr"):
        lines.append("| " + " | ".join(text_of(c) for c in row) + " |")
    return lines


def sections(path):
    found, lines = {}, []
    for element in tree.parse(path).getroot().iter():
        if element.tag == f"{XHTML}h2":
            lines = found.setdefault(text_of(element).lower().replace(" ", "-"), [])
        elif element.tag == f"{XHTML}p":
            lines += [text_of(element), ""]
        elif element.tag == f"{XHTML}table" and element.find(f"{XHTML}thead") is not None:
            lines += [*table_lines(element), ""]
    return found


def main(report, document, *others):
    found, inside, out = sections(report), False, []
    for line in open(document, encoding="utf-8").read().splitlines():
        if line == "<!-- end -->":
            inside = False
        if not inside:
            out.append(line)
        name = re.fullmatch(r"<!-- ([a-z,-]+) -->", line)
        if name and name[1] not in ("end", *others):
            if name[1] not in found:
                sys.exit(f"report_sections.py: {report} has no section {name[1]}")
            out += "\n".join(found[name[1]]).strip().splitlines()
            inside = True
    with open(document, "w", encoding="utf-8") as file:
        file.write("\n".join(out) + "\n")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit("usage: tools/report_sections.py report.html document.md [OTHER...]")
    main(*sys.argv[1:])
