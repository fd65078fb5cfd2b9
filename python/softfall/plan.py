# SPDX-License-Identifier: GPL-3.0-or-later
"""The plan of a sweep: a base case, factors in blocks, and what is asked of the results (docs/campaigns.md has the keys).

The rows are the full product of the blocks, the last block the fastest. A block is one list, a group of lists of one length (zip), or a
sample of several factors.
"""
from __future__ import annotations

import functools
import hashlib
import json
import math
import os
import re
from pathlib import Path
from typing import Any, Callable, NamedTuple

import numpy as np
from scipy.special import ndtri

from . import library, memory, samples, settings
from .array import Array
from .errors import Error, InputError
from .settings import Setting

MOST_FACTORS, MOST_KEYS, MOST_FIGURES, MOST_ROWS, MOST_DRAWS = 15, 16, 6, 20000, 1000
LEAST_SALTELLI = 8
RATIO = 2  # spacing of the coarse drop of a row on two meshes, over that of the row
_COARSE = ("geometry.spacing_factor=2", "pad.mesh_error_limit=0.125")
_NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*$")
_OWN = {text.partition("=")[0] for text in memory.LEAN}
_COLUMNS = {"id", "run_status", "grade", "message", "folder"}
DISTRIBUTIONS: dict[str, tuple[str, str, Callable[[float, float, Array], Any], str]] = {
    "uniform": ("low", "high", lambda a, b, u: a + u * (b - a), "uniform, {:.6g} to {:.6g} {}"),
    "normal": ("mean", "deviation", lambda a, b, u: a + b * ndtri(u), "normal, mean {:.6g}, standard deviation {:.6g} {}"),
    "lognormal": ("median", "deviation_ln", lambda a, b, u: a * np.exp(b * ndtri(u)), "lognormal, median {:.6g}, deviation of the logarithm {:.6g} ({})"),
}


class Limit(NamedTuple):
    """A figure of summary.json, and the limit to stay below; NaN: none."""

    figure: str
    limit: float


class Factor:
    """A key of the case and the values that it takes: numbers in one unit, or words (names, files, lists) with numbered levels."""

    def __init__(self, group: Setting, sampled: bool) -> None:
        self.group, self.where = group, group.place
        self.key, self.unit = group.text("key"), ""
        self.name = group.text("name", self.key)
        if len(self.key) >= 200 or re.search(r'[= \t"@]', self.key) or len(self.name) >= 200:
            group.refuse(f'unknown key "{self.key[:80]}" of a case')
        self.uncertain, self.posterior, self.words, self.distribution = sampled, False, False, ""
        self.numbers: list[float] = []
        self.texts: list[str] = []  # of words: as --set takes them after '='
        self.labels: list[str] = []  # and as the plan has them
        self.ends = (math.nan, math.nan)  # numbers of the distribution
        self.values: Array = np.empty(0)  # of each row of the block: the number, or the index of the level
        self._begun, self._kind, self._scale, self._zero = False, "", 1.0, 0.0
        self._read(sampled)
        self.uncertain = group.flag("uncertain", self.uncertain)

    @property
    def is_group(self) -> bool:
        """True if a file replaces a whole group of the case."""
        dot = self.key.find(".")
        return dot < 0 or (self.key.startswith("materials.") and "." not in self.key[10:])

    def _read(self, sampled: bool) -> None:
        kinds: dict[str, tuple[list[str], Callable[[Setting], None]]] = {
            "values": ([], self._values), "files": ([], self._files), "posterior": (["draws"], self._posterior)}
        if not sampled:
            kinds["from"] = (["to", "count", "spacing"], self._range)
        own = ["key", "name"] + ([] if sampled else ["uncertain"])
        found = [name for name in kinds if self.group.get(name)]
        every = own + [word for name, (more, _) in kinds.items() for word in (name, *more)]
        self.group.names(every + (["distribution", *(word for d in DISTRIBUTIONS.values() for word in d[:2])] if sampled else []))
        if len(found) > 1:
            self.group.member(found[1]).refuse(f"{self.key}: {found[0]} and {found[1]} exclude each other")
        if found:
            self.group.names([*own, found[0], *kinds[found[0]][0]])
            kinds[found[0]][1](self.group.member(found[0]))
        elif sampled:
            self._take_distribution()
        else:
            self.group.refuse(f"{self.key}: give values, files, posterior, or from, to and count; a distribution belongs into a group with sample")

    # ---- numbers

    def _number(self, s: Setting) -> float:
        """Returns a number, with or without a unit; the first one sets the unit of all."""
        if s.is_number:
            if self.unit:
                s.refuse(f"{self.key}: {s.value:g} has no unit, the values before it have one")
            self._begun = True
            return float(s.value) if math.isfinite(s.value) else s.refuse(f"{self.key} is not finite")
        found = _NUMBER.match(s.value) if s.kind == "text" else None
        if not found:
            s.refuse(f"{self.key}: expected a number, with its unit as a text")
        number, unit = float(found[1]), found[2]
        try:
            si, kind = library.quantity(s.value)
            zero, scale = (library.quantity(f"{one} {unit}")[0] for one in (0, 1))
        except Error as error:
            s.refuse(f'{self.key}: unknown unit in "{s.value}"' if not self._begun else f"{self.key}: {error}")
        if not self._begun:
            self.unit, self._kind, self._scale, self._zero, self._begun = unit, kind, scale, zero, True
        if not self.unit:
            s.refuse(f'{self.key}: "{s.value}" has a unit, the values before it have none')
        if kind != self._kind:
            s.refuse(f'{self.key}: "{s.value}" is not of the kind of {self.unit}')
        if unit != self.unit and (zero != 0 or self._zero != 0):
            s.refuse(f"{self.key}: {unit} and {self.unit} have different zeros: give all values in one of them")
        return number if unit == self.unit else si / self._scale

    def _is_numeric(self, s: Setting) -> bool:
        if s.kind != "text" or not _NUMBER.match(s.value) or not _NUMBER.match(s.value)[2]:  # type: ignore[index]
            return s.is_number
        try:
            library.quantity(s.value)
            return True
        except Error:
            return False

    # ---- words

    def _word(self, text: str, label: str) -> None:
        self.words = True
        self.texts.append(text)
        self.labels.append(label)

    def _file(self, s: Setting, label: str) -> None:
        path = settings.existing(self.group.folder / label, s, self.key).resolve()
        if not self.is_group and re.search(r'["\\]', str(path)):
            s.refuse(f"{self.key}: a path with a quote or a backslash cannot be used: {path}")
        self._word(f"@{path}" if self.is_group else f'"{path}"', label)

    def _entries(self, s: Setting) -> list[Setting]:
        if s.kind not in ("array", "list"):
            s.refuse(f"{s.name} must be a list, [ ... ] or ( ... )")
        if not s.items:
            s.refuse(f"{s.name}: the list of {self.key} is empty: there is no run to do")
        return s.items

    def _files(self, s: Setting) -> None:
        for item in self._entries(s):
            if item.kind != "text" or not item.value:
                item.refuse("files must be texts, the names of files")
            self._file(item, item.value)

    def _values(self, s: Setting) -> None:
        items = self._entries(s)
        numeric = self._is_numeric(items[0])
        for item in items:
            relative = item.kind == "text" and item.value and not item.value.startswith("/")
            if self.is_group or (relative and re.search(r"(^|\.)(file|missile_file|curves?|motion)$", self.key)):
                item.refuse(f"{self.key} is given by a file: give files, relative to the plan, in place of values")
            if numeric:
                self.numbers.append(self._number(item))
            else:
                text = _plain(item)
                self._word(text, str(item.value) if item.kind == "text" else text)

    def _range(self, first: Setting) -> None:
        last = self.group.get("to") or self.group.refuse(f"{self.key}: from needs to and count")
        low, high = self._number(first), self._number(last)
        count = int(self.group.number("count", 2, 1e6, whole=True))
        logarithmic = self.group.choice("spacing", ("linear", "log")) == "log"
        if logarithmic and not (low > 0 and high > 0):
            first.refuse(f"{self.key}: a logarithmic range needs values above 0")
        parts = [k / (count - 1) for k in range(count)]
        self.numbers = [math.exp(math.log(low) + s * (math.log(high) - math.log(low))) if logarithmic else low + s * (high - low) for s in parts]

    def _posterior(self, s: Setting) -> None:
        if s.kind != "text" or not s.value:
            s.refuse("posterior must be a text, the name of a folder of draws")
        if not self.is_group:
            s.refuse(f'a posterior is of key = "material" or of a layer, not of {self.key}')
        folder, there = self.group.folder / s.value, 0
        while there < MOST_DRAWS and (folder / f"draw-{there + 1:03d}.cfg").exists():
            there += 1
        if not there:
            s.refuse(f"posterior: there is no draw-001.cfg in {folder}")
        count = int(self.group.number("draws", 1, MOST_DRAWS, there, whole=True))
        if there < count:
            s.refuse(f"draws is {count}, but {folder} holds {there}")
        self.uncertain = self.posterior = True
        for k in range(count):  # in the middle of equal parts of those that are there: softfall-fit writes them model by model
            self._file(s, f"{s.value}/draw-{(2 * k + 1) * there // (2 * count) + 1:03d}.cfg")

    def _take_distribution(self) -> None:
        self.distribution = self.group.choice("distribution", list(DISTRIBUTIONS))
        first, second = DISTRIBUTIONS[self.distribution][:2]
        self.group.names(["key", "name", "distribution", first, second])
        one, two = self.group.get(first), self.group.get(second)
        if not one or not two:
            self.group.refuse(f"{self.key}: give {first} and {second}, or values, files or posterior")
        a = self._number(one)
        b = self.group.number(second, 0, 10) if self.distribution == "lognormal" else self._number(two)
        wrong = {"uniform": "" if a < b else "low must be below high"}.get(self.distribution, "" if b > 0 else "the deviation must be above 0")
        if self.distribution == "lognormal" and not wrong and a <= 0:
            wrong = "the median must be above 0"
        if wrong:
            self.group.refuse(f"{self.key}: {wrong}")
        self.ends = (a, b)

    # ---- the values of the rows

    def take_levels(self) -> None:
        """Gives each row of a list its level; a word that the list repeats, as that of a zip may, is one level."""
        if not self.words:
            self.values = np.array(self.numbers)
            return
        levels = list(dict.fromkeys(self.texts))
        self.values = np.array([levels.index(text) for text in self.texts], dtype=float)
        self.labels = [self.labels[self.texts.index(text)] for text in levels]
        self.texts = levels

    def take_points(self, u: Array) -> None:
        """Gives each row the value at its place in (0, 1) of the distribution, or of the levels, all equally probable."""
        if self.distribution:
            self.values = DISTRIBUTIONS[self.distribution][2](*self.ends, u)
            return
        count = len(self.texts) if self.words else len(self.numbers)
        level = np.minimum((u * count).astype(int), count - 1)
        self.values = level.astype(float) if self.words else np.array(self.numbers)[level]

    @property
    def count(self) -> int:
        """Levels, or values in the plan."""
        return len(self.texts) if self.words else len(self.numbers)

    def override(self, value: float) -> str:
        """Returns "key=value" as --set takes it."""
        if self.words:
            return f"{self.key}={self.texts[int(value)]}"
        return f'{self.key}="{value:.12g} {self.unit}"' if self.unit else f"{self.key}={value:.12g}"

    def text(self, value: float) -> str:
        """Returns the value for a table."""
        return self.labels[int(value)] if self.words else f"{value:.12g}"

    @property
    def heading(self) -> str:
        return f"{self.name} ({self.unit})" if self.unit else self.name


def _plain(s: Setting) -> str:
    """Returns a setting in libconfig's syntax, in one line."""
    if s.kind == "bool":
        return "true" if s.value else "false"
    if s.kind == "int":
        return str(s.value)
    if s.kind == "float":
        text = f"{s.value:.12g}"
        return text if re.search(r"[.e]", text) else text + ".0"
    if s.kind == "text":
        return json.dumps(s.value, ensure_ascii=False)
    inner = ", ".join(_plain(item) for item in s.items) if s.kind != "group" else " ".join(f"{item.name} = {_plain(item)};" for item in s.items)
    return {"array": f"[{inner}]", "list": f"( {inner} )", "group": f"{{ {inner} }}"}[s.kind]


class Block:
    """Factors whose values go together: `kind` list, zip or sample, with its rows."""

    def __init__(self, group: Setting, factors: list[Factor], first: int, allowed: int) -> None:
        self.kind = "zip" if group.get("zip") else "sample" if group.get("sample") else "list"
        self.first, self.method, self.samples, self.seed, self.stride = first, "", 0, 1, 1
        if self.kind == "list":
            members = [group]
        elif self.kind == "zip":
            group.names(["zip"])
            members = group.groups("zip", MOST_FACTORS)
        else:
            group.names(["sample", "count", "seed", "of"])
            self.method = group.choice("sample", list(samples.METHODS))
            self.samples = int(group.number("count", 1, 1e8, whole=True))
            self.seed = int(group.number("seed", 0, 4294967295, 1, whole=True))
            members = group.groups("of", MOST_FACTORS)
        own = []
        for member in members:
            factor = Factor(member, self.kind == "sample")
            own.append(factor)
            factors.append(factor)
        self.count = len(own)
        if self.kind == "sample":
            if self.method == "saltelli" and self.samples < LEAST_SALTELLI:
                group.member("count").refuse(f"count: Sobol' indices need {LEAST_SALTELLI} samples, and some hundreds to tell anything")
            self.rows = samples.rows_of(self.method, self.count, self.samples)
            if self.rows > allowed:
                group.refuse(f"the sample has {self.rows} rows, more than {allowed}: give --yes if it is meant")
            for factor, u in zip(own, samples.points(self.method, self.count, self.samples, self.seed).T):
                factor.take_points(u)
            return
        self.rows = len(own[0].texts) if own[0].words else len(own[0].numbers)
        for factor in own:
            length = len(factor.texts) if factor.words else len(factor.numbers)
            if length != self.rows:
                group.member("zip").refuse(f"zip: {own[0].key} has {self.rows} values and {factor.key} {length}; the lists must have one length")
            if factor.uncertain != own[0].uncertain:
                group.member("zip").refuse(f"zip: one of {own[0].key} and {factor.key} is chosen and the other uncertain, so that no probability belongs to a "
                                           "choice: give the chosen one uncertain = true, or cross them")
            factor.take_levels()


class Plan:
    """A plan file with the values of all its rows."""

    def __init__(self, path: str | os.PathLike[str], huge: bool = False) -> None:
        root = settings.read(path)
        self.path, self.folder, self._root = os.fspath(path), root.folder, root
        gone = root.get("coarse")
        if gone:
            gone.refuse("coarse: rows are simulated, and predicted no more: leave it out, and the accuracies")
        root.names(["case", "title", "set", "refine", "factors", "figures"])
        self.case = str(root.file("case"))
        self.title = root.text("title", "Sweep of " + Path(self.case).name)
        self.factors: list[Factor] = []
        self.blocks: list[Block] = []
        self.refine = root.choice("refine", ("richardson",)) if root.get("refine") else ""
        allowed = 10 ** 8 if huge else MOST_ROWS
        for group in root.groups("factors", MOST_FACTORS):
            if len(self.factors) >= MOST_FACTORS:
                group.refuse(f"more than {MOST_FACTORS} factors")
            self.blocks.append(Block(group, self.factors, len(self.factors), 10 ** 8 if huge else 10 ** 6))
        self._check_factors()
        self.block_of = [block for block in self.blocks for _ in range(block.count)]
        self.set = self._read_set()
        self.figures = self._read_figures()
        self.rows = math.prod(block.rows for block in self.blocks)
        self.huge, self.allowed = self.rows > allowed, allowed
        if self.rows > 10 ** 8:
            root.member("factors").refuse(f"the plan has {self.rows:.3g} runs; at most {10 ** 8} are taken")
        stride = 1
        for block in reversed(self.blocks):
            block.stride, stride = stride, stride * block.rows
        self.saltelli = next((block for block in self.blocks if block.method == "saltelli"), None)
        if self.saltelli and len(self.blocks) > 1:
            root.member("factors").refuse("a sample for Sobol' indices (saltelli) stands alone: move the other factors into it, or make a plan for each of "
                                          "their values")

    def _check_factors(self) -> None:
        names = memory.figure_keys()
        for k, factor in enumerate(self.factors):
            if factor.name in _COLUMNS or factor.name in names:
                factor.group.refuse(f'"{factor.name}" is a column of runs.csv already: give the factor another name')
            if factor.key in _OWN:
                factor.group.refuse(f"{factor.key} has no effect in a campaign, which keeps the curve of a run and none of its fields")
            if self.refine and factor.key in [text.partition("=")[0] for text in _COARSE]:
                factor.group.refuse(f"{factor.key} is set by `refine`, for the coarse drops: leave it out")
            for other in self.factors[:k]:
                if other.key == factor.key:
                    factor.group.refuse(f"{factor.key} is a factor already, at {other.where}")
                if other.name == factor.name:
                    factor.group.refuse(f'two factors have the name "{factor.name}"')

    def _read_set(self) -> list[str]:
        found = self._root.get("set")
        if found is None:
            return []
        most = MOST_KEYS - (len(_COARSE) if self.refine else 0)
        if found.kind not in ("array", "list"):
            found.refuse('set must be a list of texts, ["group.key=value", ...]')
        if len(found.items) + len(self.factors) > most:
            found.refuse(f"set and the factors change more than {most} keys")
        texts = []
        for item in found.items:
            if item.kind != "text" or "=" not in item.value:
                item.refuse('set: each entry must be a text "group.key=value"')
            key, _, value = (part.strip() for part in item.value.partition("="))
            if key in _OWN:
                item.refuse(f"set: {key} has no effect in a campaign, which keeps the curve of a run and none of its fields")
            for factor in self.factors:
                if factor.key == key:
                    item.refuse(f"set: {key} is a factor, at {factor.where}")
            file = value[1:] if value.startswith("@") else ""
            texts.append(f"{key}=@{(self.folder / file)}" if file and not file.startswith("/") else item.value)
        return texts

    def _read_figures(self) -> list[Limit]:
        found = self._root.get("figures")
        if found is None:
            return [Limit("a_max_g", 200.0), Limit("hic", 1000.0)]
        if found.kind != "list" or not found.items:
            found.refuse('figures must be a list: ( { key = "a_max_g"; limit = 200.0; } )')
        limits = []
        for item in found.items:
            if item.kind != "group":
                item.refuse("figures: each entry must be a group: { ... }")
            gone = item.get("accuracy")
            if gone:
                gone.refuse("accuracy: rows are simulated, and predicted no more: leave it out")
            item.names(["key", "limit"])
            key = item.text("key")
            if key not in memory.figure_keys():
                item.refuse(f'unknown figure "{key[:80]}" of summary.json (docs/formats.md lists them)')
            limits.append(Limit(key, item.number("limit", -1e300, 1e300, math.nan)))
        if len(limits) > MOST_FIGURES:
            found.refuse(f"{len(limits)} figures; at most {MOST_FIGURES} are taken")
        return limits

    def value(self, factor: int, row: int) -> float:
        """Returns the value of a factor in a row, from 0: a number in its unit, or the index of a word."""
        block = self.block_of[factor]
        return float(self.factors[factor].values[row // block.stride % block.rows])

    def column(self, factor: int) -> Array:
        """Returns the values of a factor in all rows."""
        block = self.block_of[factor]
        column: Array = self.factors[factor].values[np.arange(self.rows) // block.stride % block.rows]
        return column

    def overrides(self, row: int, coarse: bool = False) -> list[str]:
        """Returns the overrides of a row in the order in which they apply: files of whole groups, `set`, single keys."""
        texts = [(factor.is_group, factor.override(self.value(k, row))) for k, factor in enumerate(self.factors)]
        return [text for group, text in texts if group] + self.set + list(_COARSE if coarse else ()) + [text for group, text in texts if not group]

    def is_chosen(self, block: Block) -> bool:
        """True if every factor of the block is a choice, not an unknown."""
        return not any(factor.uncertain for factor in self.factors[block.first:block.first + block.count])

    def hash(self) -> str:
        """Returns a hash of the rows: of keys, units and values."""
        text = json.dumps([self.rows, self.set, self.refine, [[f.key, f.unit, f.name, f.labels, f.values.tolist()] for f in self.factors],
                           [block.stride for block in self.blocks]])
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def check(self, coarse: bool = False) -> None:
        """Reads the case of a row with each level of each factor, of many numbers the least and the greatest; a sentence names the line of the factor."""
        series = False
        for k, factor in enumerate(self.factors):
            block = self.block_of[k]
            places = [int(np.flatnonzero(factor.values == level)[0]) for level in range(factor.count) if (factor.values == level).any()] if factor.words else \
                [int(factor.values.argmin()), int(factor.values.argmax())]
            keys: dict[str, str] = {}
            for place in places:
                try:
                    with memory.Inputs(self.case, self.overrides(place * block.stride, coarse)) as inputs:
                        inputs.check()
                        series = series or len(inputs.counted()) > 1
                        key = inputs.key()
                except Error as error:
                    raise type(error)(f"{self._blame(str(error), factor)}: {error}", error.code) from None
                if factor.words and factor.key.startswith("geometry."):
                    text = factor.texts[int(factor.values[place])]
                    other = keys.setdefault(key, text)
                    if os.path.dirname(other) != os.path.dirname(text):
                        factor.group.refuse(f"{other} and {text} have the same text in different folders: they may merge different files; make a difference "
                                            "in their text, a comment for example")
        if series and self.refine:
            self._root.member("refine").refuse("series.drops: only first drops are refined; leave `refine` out")

    def _blame(self, sentence: str, factor: Factor) -> str:
        """Returns the line of the factor, or of `set` if that alone gives this sentence."""
        try:
            for text in self.set:
                with memory.Inputs(self.case, [text]):
                    pass
        except Error as error:
            if str(error) == sentence:
                return self._root.member("set").place
        return factor.where

    def series_text(self) -> str:
        """Returns by what the rows are judged, where they are series of drops; else ""."""
        if any(factor.key in ("series.drops", "series.counted") for factor in self.factors):
            return "the mean of the drops of series.counted"
        try:
            with memory.Inputs(self.case, self.overrides(0)) as inputs:
                counted = inputs.counted()
        except InputError:
            return ""
        numbers = [str(k) for k, counts in enumerate(counted, 1) if counts]
        if len(counted) == 1:
            return ""
        return f"the mean of drops {', '.join(numbers)} of {len(counted)}" if len(numbers) > 1 else f"drop {numbers[0]} of {len(counted)}"

    @functools.cached_property
    def length_unit(self) -> str:
        """The unit of lengths that stand without one, those of the geometry."""
        found = re.search(r'^geometry\.length_unit\s+"([^"]+)"', library.case_parameters(self.case, self.overrides(0)), re.MULTILINE)
        return found[1] if found else ""

    def describe(self, k: int) -> str:
        """Returns the values of a factor in a few words."""
        factor, block = self.factors[k], self.block_of[k]
        if factor.distribution:
            text = DISTRIBUTIONS[factor.distribution][3].format(*factor.ends, factor.unit).strip()
        elif factor.words:
            text = f"{factor.count} {'draws' if factor.uncertain else 'levels'}"
        else:
            text = f"{factor.count} values, {min(factor.numbers):.6g} to {max(factor.numbers):.6g} {factor.unit}".strip()
        if block.kind == "zip":
            last = block.first + block.count - 1
            text += f", with {self.factors[last if k == block.first else block.first].name}"
        return text + (f"; {samples.METHODS[block.method]} of {block.rows} rows" if block.kind == "sample" else "")
