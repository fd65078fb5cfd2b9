# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of laboratories: `read` turns one into a table with our headings, and says how it was read (docs/formats.md)."""
from __future__ import annotations

import os
from typing import Any

from ..errors import missing
from .advice import Advice as Advice
from .advice import advised as advised
from .kinds import Options
from .reading import Reading
from .reading import read as _read

_NAMES = tuple(name for name in Options.__dataclass_fields__ if name != "stated_at")
RECORD = ("column", "columns", "heading", "units", "scale", "rate", "specimen", "cycle", "sheet")  # options of a record's file
_LISTS = ("column", "columns", "units", "scale")


def options(given: dict[str, Any]) -> Options:
    """Returns options from keywords; None and False mean that an option is not given."""
    made: dict[str, Any] = {}
    for name, value in given.items():
        if name not in _NAMES:
            raise missing("option of a laboratory's file", name, _NAMES[:-1])
        if value is None or value is False or value == ():
            continue
        if name in ("columns", "units") and isinstance(value, str):
            value = tuple(part.strip() for part in value.split(";" if ";" in value else ","))
        made[name] = (value if isinstance(value, tuple) else (value,)) if name in _LISTS else value if callable(value) else str(value)
    return Options(**made)


def read(path: str | os.PathLike[str], **given: Any) -> Reading:
    """Reads a laboratory's file, whatever wrote it, as the table that the programs read.

    `given` are the options of `softfall read` (docs/python.md): kind="compression", column="Strain 1 (%)", rate="20 kHz", ... A file that could
    be read in two ways, or that is of another quantity, is an InputError.
    """
    return _read(path, options({"spell": lambda option, value: f'{option}="{value}"', **given}))
