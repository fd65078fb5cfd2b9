# SPDX-License-Identifier: GPL-3.0-or-later
"""Settings of a file in the syntax of a case, each with its place, and sentences about them."""
from __future__ import annotations

import contextlib
import math
import os
from pathlib import Path
from typing import Any, NoReturn, Sequence

from . import memory
from .errors import Error, InputError


class Setting:
    """A group, list, array or value: `kind`, `value` and `place` ("file:line")."""

    def __init__(self, data: dict[str, Any], folder: Path) -> None:
        self.name: str = data["name"] or ""
        self.place, self.kind, self.folder = str(data["place"]), str(data["kind"]), folder
        inner = self.kind in ("group", "list", "array")
        self.items: list[Setting] = [Setting(item, folder) for item in data["value"]] if inner else []
        self.value: Any = float(data["value"]) if self.kind == "float" else data["value"]

    def refuse(self, sentence: str) -> NoReturn:
        """Raises an InputError that begins with the place."""
        raise InputError(f"{self.place.removesuffix(':0')}: {sentence}")

    @property
    def is_number(self) -> bool:
        return self.kind in ("int", "float")

    def get(self, name: str) -> Setting | None:
        """Returns the member of a group; None if there is none."""
        return next((item for item in self.items if item.name == name), None)

    def names(self, known: Sequence[str]) -> None:
        """Refuses members of other names."""
        unknown = [item for item in self.items if item.name not in known]
        if unknown:
            others = f"; unknown too: {', '.join(item.name[:24] for item in unknown[1:10])}" if unknown[1:] else ""
            more = f" and {len(unknown) - 10} more" if len(unknown) > 10 else ""
            unknown[0].refuse(f'unknown key "{unknown[0].name[:80]}"{others}{more}; the keys here are {", ".join(known)}')

    def member(self, name: str) -> Setting:
        found = self.get(name)
        return found if found else self.refuse(f"{name} is missing")

    def text(self, name: str, default: str | None = None) -> str:
        """Returns a text; without a default it is required."""
        found = self.get(name)
        if found is None and default is not None:
            return default
        found = found or self.member(name)
        return str(found.value) if found.kind == "text" and found.value else found.refuse(f"{name} must be a text")

    def choice(self, name: str, words: Sequence[str], default: str | None = None) -> str:
        """Returns one of the words; the first one by default."""
        text = self.text(name, default or words[0])
        if text not in words:
            self.member(name).refuse(f'{name} is "{text[:80]}"; it must be one of {", ".join(words)}')
        return text

    def number(self, name: str, low: float, high: float, default: float | None = None, whole: bool = False) -> float:
        """Returns a number within bounds; without a default it is required."""
        found = self.get(name)
        if found is None and default is not None:
            return default
        found = found or self.member(name)
        if not found.is_number:
            found.refuse(f"{name} must be a number")
        value = float(found.value)
        if not low <= value <= high:
            found.refuse(f"{name} is {value:g}, outside of {low:g} to {high:g}")
        if whole and value != math.floor(value):
            found.refuse(f"{name} is {value:g}; it must be a whole number")
        return value

    def flag(self, name: str, default: bool) -> bool:
        found = self.get(name)
        if found is not None and found.kind != "bool":
            found.refuse(f"{name} must be true or false")
        return bool(found.value) if found else default

    def groups(self, name: str, most: int) -> list[Setting]:
        """Returns the groups of a list that is required."""
        found = self.member(name)
        if found.kind != "list" or not found.items:
            found.refuse(f"{name} must be a list: {name} = ( {{ ... }}, {{ ... }} )")
        if len(found.items) > most:
            found.refuse(f"{name} has {len(found.items)} entries; at most {most} are taken")
        for item in found.items:
            if item.kind != "group":
                item.refuse(f"{name}: each entry must be a group: {{ ... }}")
        return found.items

    def file(self, name: str) -> Path:
        """Returns the path of a file that is there; a relative one begins at the folder of the settings."""
        text = self.text(name)
        return existing(self.folder / text, self.member(name), name)


def existing(path: Path, setting: Setting, name: str) -> Path:
    """Returns the path of a plain file, which must be there."""
    if not path.exists():
        setting.refuse(f"{name}: the file {path} cannot be read: No such file or directory")
    if not path.is_file():
        setting.refuse(f"{name}: {path} is not a plain file")
    return path


def read(path: str | os.PathLike[str]) -> Setting:
    """Returns the settings of a file as a group."""
    text = os.fspath(path)
    if "\0" in text:
        raise InputError(f"{text!r} is no name of a file")
    return Setting(memory.settings(text), Path(text).parent)


def files(path: str | os.PathLike[str]) -> list[Path]:
    """Returns a file in the syntax of a case with all files that are there and that it names, and those of the .cfg files among them: what an output must not replace."""
    found, open_ends = [Path(path)], [Path(path)]

    def take(item: Setting) -> None:
        source = Path(item.place.rpartition(":")[0])  # an included file has names of its own
        for named in (source, *(folder / str(item.value).lstrip("@") for folder in (source.parent, item.folder) if item.kind == "text" and "\0" not in str(item.value))):
            if named.is_file() and named not in found:
                found.append(named)
                open_ends.extend([named] * (named.suffix == ".cfg"))
        for inner in item.items:
            take(inner)
    while open_ends:
        with contextlib.suppress(Error, OSError):
            take(read(open_ends.pop()))
    return found
