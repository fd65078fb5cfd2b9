# SPDX-License-Identifier: GPL-3.0-or-later
"""Exceptions: each has the sentence of the program that failed."""
from __future__ import annotations

import difflib
import os
import sys
from typing import Any, Iterable, Mapping, TypeVar

V = TypeVar("V")


class Error(Exception):
    """A program or the library of softfall failed; its text is that program's sentence.

    `code` is the exit code: 2 wrong input, 3 a file, 4 the model, 5 a numerical failure, 6 memory, 7 a library.
    """

    def __init__(self, sentence: str, code: int = 2) -> None:
        super().__init__(sentence)
        self.code = code


class InputError(Error, ValueError):
    """A key, a value, a file or an argument is wrong: the user can mend it."""


class NumericError(Error, ArithmeticError):
    """The solution failed, or the missile reached the anvil. `results` is the path of the results so far, or None."""

    results: str | None = None


class Interrupted(Error):
    """A program was told to end by somebody else. The same call again resumes the run."""


class SoftfallWarning(UserWarning):
    """A warning of a program: legal, but probably not intended."""


def lacking(modules: Iterable[str]) -> str:
    """Returns the sentence about modules that this Python does not have.

    >>> lacking(["h5py"]).partition(": ")[2]
    'apt-get install python3-h5py, or take the Python that has it, usually /usr/bin/python3'
    """
    names = list(modules)
    return (f"softfall needs {' and '.join(names)}, which {sys.executable} does not have: apt-get install {' '.join(f'python3-{name}' for name in names)}, "
            f"or take the Python that has {'it' if len(names) == 1 else 'them'}, usually /usr/bin/python3")


def failure(sentence: str, code: int) -> Error:
    """Returns the exception of an exit code (2 and 64: wrong input)."""
    kind = {2: InputError, 5: NumericError, 64: InputError, 130: Interrupted}.get(code, Error)
    return kind(sentence, code)


def missing(what: str, key: object, known: Iterable[str]) -> KeyError:
    """Returns the KeyError of an unknown name, which lists those that there are."""
    names = list(known)
    near = difflib.get_close_matches(str(key), names, 1)
    hint = f' (did you mean "{near[0]}"?)' if near else ""
    return KeyError(f'there is no {what} "{key}"{hint}; there are {", ".join(names)}')


def find(table: Mapping[str, V], what: str, key: str) -> V:
    """Returns the entry of a table, or raises the KeyError that lists its keys.

    >>> find({"hic": 297.0}, "figure", "hicc")
    Traceback (most recent call last):
    KeyError: 'there is no figure "hicc" (did you mean "hic"?); there are hic'
    """
    if key not in table:
        raise missing(what, key, table)
    return table[key]


def path_of(value: Any, what: str) -> str:
    """Returns the path of a file as a text; InputError if it is none, such as None.

    >>> path_of("case.cfg", "a case")
    'case.cfg'
    """
    if not isinstance(value, (str, os.PathLike)) or not os.fspath(value):
        raise InputError(f"{what} is the path of its file, not {value!r}")
    return os.fsdecode(value)
