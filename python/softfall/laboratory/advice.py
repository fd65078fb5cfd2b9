# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of another form than the programs read: their sentence names `softfall read`, which Python runs itself."""
from __future__ import annotations

import json
import os
import re
import shlex
import zlib
from pathlib import Path
from typing import NamedTuple

from .kinds import Options
from .reading import read

_COMMAND = re.compile(r"softfall read (.+?) -o clean2?\.csv")
_TABLES = os.path.join("softfall-runs", "tables")  # the folder of tables that were read for programs


class Advice(NamedTuple):
    """The file for which a program's sentence names `softfall read`, and the kind of its table."""

    path: str
    kind: str

    def is_file(self, path: str, folder: str | Path = "") -> bool:
        """True if the path, which begins in the folder, is that of the file."""
        return os.path.abspath(os.path.join(folder, path)) == os.path.abspath(self.path)

    def clean(self) -> str:
        """Writes what `softfall read` makes of the file, and returns its path; one name for one table, so that a run is found again."""
        reading = read(self.path, Options(kind=self.kind, spell=self._spell))
        folder = Path(_TABLES)
        folder.mkdir(parents=True, exist_ok=True)
        return str(reading.write(folder / f"{Path(self.path).stem}-{zlib.crc32(reading.text().encode()):08x}.csv").absolute())

    def _spell(self, option: str, value: str) -> str:
        return f"softfall read {shlex.quote(self.path)} --kind {self.kind} -o clean.csv --{option} {shlex.quote(value)}"

    def stands_in(self, text: str, folder: str | Path) -> bool:
        """True if the text is the path of the file, or has it in quotation marks."""
        return any(self.is_file(path, folder) for path in (text, *re.findall(r'"([^"]*)"', text)))

    def swap(self, text: str, folder: str | Path) -> str:
        """Returns a configuration with the clean table in place of the file, its other paths absolute."""
        def swapped(found: re.Match[str]) -> str:
            own = self.is_file(found[3], folder) and (found[2] == "lateral") == (self.kind == "lateral")
            return found[1] + json.dumps(self.clean() if own else os.path.abspath(os.path.join(folder, found[3])), ensure_ascii=False)
        return re.sub(r'(\b(file|lateral)\s*=\s*)"([^"]*)"', swapped, text)


def advised(sentence: object) -> Advice | None:
    """Returns the advice of a program's sentence, or None if it has none.

    >>> advised("lab.csv:1: ...: softfall read 'my lab.csv' --kind motion -o clean.csv reads other forms, or says why not")
    Advice(path='my lab.csv', kind='motion')
    """
    found = _COMMAND.search(str(sentence))
    words = shlex.split(found[1]) if found else []
    return Advice(words[0], words[2]) if len(words) == 3 and words[1] == "--kind" else None
