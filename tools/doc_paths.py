#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks that the files which the documents and the comments of the sources name are there.

    tools/doc_paths.py          prints each path that is not there, and exits 1

A path is relative to the project's root, to src/, or (a link of a page) to the page. A C file may be named by the end of its
path: `contact.h`, `run/output.c`, `missile.{h,c}`. NAME, DIR and the like in capitals stand for a choice of the reader and are
not looked for."""
import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
FOLDERS = "src|tests|verify|tools|bench|include|cmake|packaging|" + "|".join(
    sorted(path.name for path in (ROOT / "src").iterdir() if path.is_dir()))
PATH = re.compile(rf"(?<![\w./-])((?:{FOLDERS})/[\w./-]*\w\.(?:c|h|\{{h,c\}}|def|py|sh|cmake|yml))(?![\w/])")
C_FILE = re.compile(r"(?<![\w./<$}*-])((?:[\w-]+/)*[\w-]+\.(?:c|h|\{h,c\}))(?![\w/])")
GENERATED = ("build_info.h", "report_style.h")  # by cmake/version.cmake
LINK = re.compile(r"\]\(([^)#:]+)(?:#[^)]*)?\)")


def choices_of(path):
    return [path.replace("{h,c}", end) for end in "hc"] if "{" in path else [path]


def prose(file, text):
    """The lines of a page, or those of a source with all blank that is no comment."""
    if file.suffix in (".c", ".h"):
        text = re.sub(r"(/\*.*?\*/)|[^\n/]+|/", r"\1", text, flags=re.DOTALL)
    elif file.suffix != ".md":
        text = re.sub(r"(#.*)|[^\n#]+", r"\1", text)
    return text.splitlines()


def exists(path, beside):
    choices = choices_of(path)
    return all(any((folder / choice).exists() for folder in (ROOT, ROOT / "src", beside)) for choice in choices)


def main():
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    pages = [path for pattern in ("*.md", "docs/*.md", "docs/adr/*.md", "src/*/README.md") for path in sorted(ROOT.glob(pattern))]
    sources = [path for folder in ("src", "include", "tests", "verify", "bench", "cmake", "tools")
               for path in sorted((ROOT / folder).rglob("*")) if path.suffix in (".c", ".h", ".txt", ".cmake", ".py", ".sh")]
    c_files = set(GENERATED)
    for folder in ("src", "include", "tests", "verify", "bench", "examples"):
        for path in (ROOT / folder).rglob("*.[ch]"):
            parts = path.relative_to(ROOT).parts
            c_files.update("/".join(parts[k:]) for k in range(len(parts)))
    missing = set()
    for file in pages + sources:
        text = file.read_text(encoding="utf-8", errors="replace")
        for number, line in enumerate(text.splitlines(), 1):
            for path in PATH.findall(line) + (LINK.findall(line) if file.suffix == ".md" else []):
                if not exists(path, file.parent):
                    missing.add((str(file.relative_to(ROOT)), number, path))
        for number, line in enumerate(prose(file, text), 1):
            for path in C_FILE.findall(line):
                if not c_files.issuperset(choices_of(path)):
                    missing.add((str(file.relative_to(ROOT)), number, path))
    missing = {place for place in missing if re.search(r"\b[A-Z]{3,}\b", place[2].removesuffix(".md")) is None}
    for name, number, path in sorted(missing):
        print(f"{name}:{number}: {path} is not there")
    sys.exit(len(missing) > 0)


if __name__ == "__main__":
    main()
