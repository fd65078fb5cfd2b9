# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall sweep and softfall fit compression as functions: many drops by a plan, a material from compression tests."""
from __future__ import annotations

import csv
import importlib.util
import json
import os
from pathlib import Path
from typing import Any, Iterator, Mapping

import numpy as np

from . import laboratory, output as output_files, programs
from .array import Array
from .case import as_text
from .errors import InputError, find

_MARK = "# Written by the Python package softfall; it is replaced.\n"


class Table:
    """A table by columns, as far as a DataFrame goes: `table["hic"]` is an array, `table.columns` the names, `len(table)` the rows.

    Numbers are floats with all digits of the file, NaN where the field is empty; other columns are texts.
    """

    def __init__(self, path: Path) -> None:
        with open(path, newline="", encoding="utf-8") as stream:
            try:
                lines = list(csv.reader(stream, strict=True))
            except csv.Error as error:
                raise ValueError(str(error)) from None
        if not lines or any(len(line) != len(lines[0]) for line in lines):
            raise ValueError("a field is missing")
        self.columns, *self.rows = lines
        self._data = {name: _typed([row[k] for row in self.rows]) for k, name in enumerate(self.columns)}

    def __getitem__(self, key: str) -> Array:
        return find(self._data, "column", key)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __len__(self) -> int:
        return len(self.rows)


def _typed(fields: list[str]) -> Array:
    try:
        return np.array([float(field) if field else np.nan for field in fields])
    except ValueError:
        return np.array(fields)


def read_table(path: Path) -> Any:
    """Returns a CSV file of the programs as a pandas DataFrame if pandas is installed, else as a Table."""
    if importlib.util.find_spec("pandas"):
        import pandas
        return pandas.read_csv(path, float_precision="round_trip")
    return Table(path)


def as_config(value: Mapping[str, Any]) -> str:
    """Returns a dict as the text of a configuration file (libconfig).

    >>> print(as_config({"name": "foam", "tests": [{"file": "slow.csv", "rate": "0.1 1/min"}], "values": [1.0, 2.0]}))
    name = "foam";
    tests = ( { file = "slow.csv"; rate = "0.1 1/min"; } );
    values = [ 1.0, 2.0 ];
    """
    def item(entry: Any) -> str:
        if isinstance(entry, Mapping):
            return "{ " + " ".join(f"{key} = {item(part)};" for key, part in entry.items()) + " }"
        if isinstance(entry, (list, tuple, np.ndarray)):
            nested = any(isinstance(part, (Mapping, list, tuple)) for part in entry)
            return ("( {} )" if nested else "[ {} ]").format(", ".join(item(part) for part in entry))
        return json.dumps(os.fspath(entry), ensure_ascii=False) if isinstance(entry, (str, os.PathLike)) else as_text(entry)
    return "\n".join(f"{key} = {item(part)};" for key, part in value.items())


def _prepare(what: Any, output: str | os.PathLike[str] | None, ending: str) -> tuple[Path, Path]:
    """Returns the configuration file, which is written for a dict, and the output folder."""
    if not isinstance(what, Mapping):
        config = Path(what)
        return config, Path(output) if output is not None else Path(f"{config.stem}-{ending}")
    if output is None:
        raise InputError("a dict needs output, the folder for the results: its configuration becomes OUTPUT.cfg beside it")
    folder = Path(output)
    config, text = folder.with_name(folder.name + ".cfg"), _MARK + as_config(what) + "\n"
    if os.path.lexists(config) and (config.is_symlink() or not config.is_file() or not config.read_text(encoding="utf-8", errors="replace").startswith(_MARK)):
        raise InputError(f"{config} is not replaced: it was not written by this function; take another output")
    output_files.write(config, text)
    return config, folder


def sweep(plan: str | os.PathLike[str] | Mapping[str, Any], output: str | os.PathLike[str] | None = None, **options: Any) -> Any:
    """Runs `softfall sweep` (docs/campaigns.md) in this process and returns runs.csv: a row for each drop, a column for each factor and figure.

    `plan`: a plan file, or a dict with its words, such as {"case": "case.cfg", "factors": [{"key": "missile.velocity",
    "values": ["5.2 m/s", "5.4 m/s"]}]}, whose paths begin beside `output`. `output`: a folder, by default PLAN-sweep in the present
    one. `options` are those of the command: jobs=2, views="worst", retry=True. A pandas DataFrame if pandas is installed, else a `Table`.
    After Ctrl-C the same call resumes; drops that are done are not run again.
    """
    from . import sweep_command  # with scipy and matplotlib, which take a second
    config, folder = _prepare(plan, output, "sweep")
    words = [f"--output={folder}", *programs.options({"force": (folder / "runs.csv").exists(), **options}), "--", str(config)]
    sweep_command.run(sweep_command.parser("softfall sweep").parse_args(words), lambda text: None, f"softfall.sweep({str(config)!r}, {str(folder)!r})")
    return read_table(folder / "runs.csv")


class Fit:
    """A material that was fitted: `material` is its file, for case["material"]; `summary` is fit.json."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder.absolute()
        self.summary: dict[str, Any] = json.loads((folder / "fit.json").read_text(encoding="utf-8"))

    def __repr__(self) -> str:
        return f"<softfall.Fit {self.folder}>"

    @property
    def material(self) -> str:
        """The material as a value of a case: case["material"] = fit.material."""
        return f"@{self.folder / 'material.cfg'}"

    @property
    def parameters(self) -> Any:
        """The fitted parameters as fit.json has them, with their errors."""
        return self.summary.get("parameters", self.summary.get("terms"))

    @property
    def points(self) -> Any:
        """fit.csv: the measured points and the fitted values there."""
        return read_table(self.folder / "fit.csv")

    def report(self) -> Path:
        """Returns the path of report.html."""
        return self.folder / "report.html"


def fit_compression(tests: str | os.PathLike[str] | Mapping[str, Any], output: str | os.PathLike[str] | None = None,
                    **options: Any) -> Fit:
    """Runs `softfall fit compression` (docs/identification.md) and returns the fitted material.

    `tests`: a configuration file, or a dict with its words, such as {"name": "foam", "density": "35 kg/m3", "specimen": {"side": "50 mm",
    "thickness": "50 mm"}, "tests": [{"file": "slow.csv", "rate": "0.1 1/min"}]}, whose paths begin beside `output`. `output`: a folder, by
    default NAME-fit in the present one, whose files are replaced with force=True. `options` are those of the command. Files of another
    form than it reads are read by `softfall read` first.
    """
    from .fit import compression_command  # with scipy, which takes a second
    config, folder = _prepare(tests, output, "fit")
    with output_files.scratch() as scratch:
        while True:
            try:
                words = [f"--output={folder}", *programs.options(options), "--", str(config)]
                compression_command.run(compression_command.parser("softfall fit compression").parse_args(words), lambda text: None)
                return Fit(folder)
            except InputError as error:
                advice = laboratory.advised(error)
                if advice is None:
                    raise
                text = config.read_text(encoding="utf-8")
                if not advice.stands_in(text, config.parent):
                    raise
                clean, config = advice.swap(text, config.parent), scratch / config.name
                config.write_text(clean, encoding="utf-8")
