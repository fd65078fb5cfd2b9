#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the files which the documents and the comments of the sources name are there.

    tools/doc_paths.py          prints each path that is not there, and exits 1

A path is relative to the project's root, to src/, or (a link of a page) to the page. NAME, DIR and the like in capitals stand
for a choice of the reader and are not looked for."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = "src|tests|verify|tools|bench|include|cmake|packaging|" + "|".join(
    sorted(path.name for path in (ROOT / "src").iterdir() if path.is_dir()))
PATH = re.compile(rf"(?<![\w./-])((?:{FOLDERS})/[\w./-]*\w\.(?:c|h|\{{h,c\}}|def|py|sh|cmake|yml))(?![\w/])")
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")


def exists(path, beside):
    choices = [path.replace("{h,c}", end) for end in "hc"] if "{" in path else [path]
    return all(any((folder / choice).exists() for folder in (ROOT, ROOT / "src", beside)) for choice in choices)


def main():
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    pages = [path for pattern in ("*.md", "docs/*.md", "docs/adr/*.md") for path in sorted(ROOT.glob(pattern))]
    sources = [path for folder in ("src", "include", "tests", "verify", "bench", "cmake", "tools")
               for path in sorted((ROOT / folder).rglob("*")) if path.suffix in (".c", ".h", ".txt", ".cmake", ".py", ".sh")]
    missing = 0
    for file in pages + sources:
        for number, line in enumerate(file.read_text(encoding="utf-8", errors="replace").splitlines(), 1):
            named = PATH.findall(line) + (LINK.findall(line) if file.suffix == ".md" else [])
            for path in named:
                if re.search(r"\b[A-Z]{3,}\b", path.removesuffix(".md")) is None and not exists(path, file.parent):
                    print(f"{file.relative_to(ROOT)}:{number}: {path} is not there")
                    missing += 1
    sys.exit(missing > 0)


if __name__ == "__main__":
    main()
