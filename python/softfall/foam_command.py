# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall foam: cards of other solvers to foams and back, and the foams that come with softfall."""
from __future__ import annotations

import argparse
import csv
import io
import os
import re
from pathlib import Path
from typing import Any, Callable

import numpy as np

from . import library, programs
from .cards import export, read_card, write_material
from .cards.material import FORMATS
from .command import Parser, say
from .errors import InputError, find
from .output import check, read, write

RATES = (0.01, 1.0, 10.0, 100.0)  # 1/s, of show and plot, unless the foam has no terms of the rate
LEAST, POINTS = 0.2, 400  # strain up to which a foam is shown at least; points of a loading


def library_folder() -> Path:
    """Returns the folder of the foams that come with softfall."""
    return programs.folder().parent / "share/softfall/examples/materials"


def foams() -> dict[str, Path]:
    """Returns the material files of these foams by name."""
    return {path.stem: path for path in sorted(library_folder().glob("*.cfg"))}


def material_file(text: str) -> str:
    """Returns the material file of a path, or of the name of a foam that comes with softfall."""
    if Path(text).suffix.lower() in (".k", ".key", ".dyn", ".inp", ".rad"):
        raise InputError(f"{text} is a deck: `softfall foam convert {text} -o OUT` makes a material file of it")
    return text if text.endswith(".cfg") or os.path.exists(text) else str(find(foams(), "foam", text))


def _head(path: str | Path) -> list[str]:
    return [line[1:].strip() for line in read(path).decode("utf-8", "replace").splitlines() if line.startswith("#")]


def _list() -> str:
    with (library_folder() / "sources.csv").open(newline="", encoding="utf-8") as file:
        known = {row["name"]: row for row in csv.DictReader(line for line in file if not line.startswith("#"))}
    rows = [("name", "foam", "kg/m3", "law", "strain to", "rate (1/s)", "source")]
    for name, path in foams().items():
        data, row = library.Material(str(path)), known.get(name, {})
        rows.append((name, row.get("foam") or _head(path)[0][:40], f"{data.values['density']:g}", str(data.values["law"]), f"{_informed(data):.3g}", row.get("rate", "-"), row.get("source", "-")))
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    return "\n".join("  ".join(text.ljust(width) for text, width in zip(row, widths)).rstrip() for row in rows) + \
        "\nBeyond these strains and rates a drop is extrapolation; docs/foams.md says how well each foam is known."


def _informed(data: library.Material) -> float:
    """Returns the strain up to which the foam is known."""
    given = data.values.get("informed_strain") or data.values.get("stable_to") or 0.0
    return float(given) or min(strain[-1] for _, strain, _ in data.curves)


def loop(data: library.Material, rate: float, most: float, free_sides: bool = False) -> tuple[Any, Any]:
    """Returns strain and stress (Pa) of a loading to a strain and its unloading, at a constant rate."""
    way = np.linspace(0, 2, 2 * POINTS + 1)
    strain = most * np.minimum(way, 2 - way)
    return strain, data.compress(most * way / rate, strain, free_sides)


def rates_of(data: library.Material, given: str | None) -> tuple[float, ...]:
    """Returns the rates at which a foam is shown."""
    if given:
        try:
            rates = tuple(float(text) for text in given.split(","))
        except ValueError:
            rates = ()
        if not rates or not all(1e-9 <= rate <= 1e6 for rate in rates):
            raise InputError(f"--rates={given}: rates in 1/s between commas are expected, such as --rates=0.01,1,100")
        return rates
    depends = len(data.curves) > 1 or any(data.values.get(key) for key in ("rate_factor", "ED", "eta"))
    return RATES if depends else RATES[1:2]


def _show(path: str, o: argparse.Namespace) -> str:
    data = library.Material(path)
    most, rates = min(0.95, max(LEAST, _informed(data))), rates_of(data, o.rates)
    said = [*_head(path), "", *(f"  {key:18} {value:g}" if isinstance(value, float) else f"  {key:18} {value}" for key, value in data.values.items() if key in data.given), "",
            f"  (SI units) nominal stress of loading in kPa{', sides held' if data.values['law'] == 'hyperfoam' else ''}, at the rate in 1/s:", "  strain  " + "".join(f"{rate:>10g}" for rate in rates)]
    loops = [loop(data, rate, most) for rate in rates]
    for strain in [*np.arange(0.1, most, 0.1), most]:
        said.append(f"  {strain:6.2f}  " + "".join(f"{1e-3 * np.interp(strain, a[:POINTS + 1], b[:POINTS + 1]):10.4g}" for a, b in loops))
    works = [0.5 * (b[1:] + b[:-1]) * np.diff(a) for a, b in loops]
    returned = [-work[POINTS:].sum() / work[:POINTS].sum() for work in works]
    return "\n".join([*said, "  returned" + "".join(f"{100 * part:9.3g}%" for part in returned)])


def _inputs(path: str) -> list[Path]:
    """Returns the material file and the files that it names."""
    names = re.findall(r'"([^"\n]+)"', read(path).decode("utf-8", "replace"))
    return [Path(path), *(Path(path).parent / name for name in names)]


def _plot(path: str, o: argparse.Namespace) -> str:
    import matplotlib
    matplotlib.use("agg")
    matplotlib.rcParams["text.parse_math"] = False  # a name with $ is no formula
    from matplotlib import pyplot
    data, output = library.Material(path), Path(o.output or f"{Path(path).stem}.png")
    informed, is_free = _informed(data), data.values["law"] == "hyperfoam"
    most = min(0.95, max(LEAST, informed))
    if output.suffix.lower() not in (".png", ".svg", ".pdf"):
        raise InputError(f"--output={output}: the picture is a .png, .svg or .pdf file")
    if check(output, *_inputs(path)).exists() and not o.force:
        raise InputError(f"{output} exists already: give --force to replace it")
    figure, axes = pyplot.subplots(figsize=(7, 4.5), layout="constrained")
    for k, rate in enumerate(rates_of(data, o.rates)):
        for free_sides in ([False, True] if is_free else [False]):
            strain, stress = loop(data, rate, most, free_sides)
            axes.plot(100 * strain, 1e-3 * stress, color=f"C{k}", linestyle="--" if free_sides else "-", label=f"{rate:g} 1/s" + (", free sides" if free_sides else ", sides held" if is_free else ""))
    for _, strain, stress in data.curves:
        axes.plot(100 * strain[strain <= most], 1e-3 * stress[strain <= most], ".", color="0.5", markersize=3)
    axes.set(xlabel="compression (%)", ylabel="nominal stress (kPa)")
    axes.set_title(f"{(_head(path) or [Path(path).stem])[0][:90]}\nloading and unloading at constant rates; the data end at {100 * informed:.0f} %", fontsize=9)
    axes.set_xlim(0)
    axes.set_ylim(0)
    axes.legend()
    axes.grid(alpha=0.3)
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=130, format=output.suffix.lower()[1:])
    pyplot.close(figure)
    write(output, drawn.getvalue(), *_inputs(path))
    return f"Written: {output}"


def _convert(path: str, o: argparse.Namespace) -> str:
    if not o.output:
        raise InputError("--output=OUT is needed: a folder for material.cfg and its curves, or a file NAME.cfg")
    foam = read_card(path, o.material, o.units, o.format)
    files = write_material(foam, Path(o.output), f"{Path(path).name}: {foam.card} {foam.key}", o.force, path)
    return "\n".join([f"{foam.place}: {foam.card} {foam.key}{f' ({foam.name})' if foam.name and foam.name != foam.key else ''} becomes a {foam.law}", *(f"  {note}" for note in foam.notes),
                      f"Written: {', '.join(map(str, files))}"])


def _export(path: str, o: argparse.Namespace) -> str:
    if not o.format or not o.units or not o.output:
        raise InputError("--format=dyna|abaqus|radioss, --units=NAME (such as mm-ms-kg-GPa) and --output=FILE are needed")
    path = material_file(path)
    if check(o.output, *_inputs(path)).exists() and not o.force:
        raise InputError(f"{o.output} exists already: give --force to replace it")
    text, listed = export(path, o.format, o.units)
    write(o.output, text, *_inputs(path))
    return "\n".join([*(f"  {line}" for line in listed), f"Written: {o.output}"])


def perform(o: argparse.Namespace) -> str:
    """Runs the command; returns what it prints."""
    if o.word == "list":
        return _list()
    if not o.file:
        raise InputError(f"{o.word} needs {'a deck' if o.word == 'convert' else 'a material file'}, or the name of a foam: softfall foam list")
    words: dict[str, Callable[[str, argparse.Namespace], str]] = {
        "convert": _convert, "export": _export, "show": lambda path, o: _show(material_file(path), o), "plot": lambda path, o: _plot(material_file(path), o)}
    return words[o.word](o.file, o)


def parser(prog: str) -> Parser:
    """Returns the command line."""
    made = Parser(prog, "convert DECK -o OUT\n  or:  softfall foam export FOAM --format=FORMAT --units=UNITS -o FILE\n  or:  softfall foam list | show FOAM | plot FOAM -o FILE.png",
                  "Reads a foam card of LS-DYNA, Abaqus, CalculiX or OpenRadioss into a material\nfile with its curves, writes one of these cards, and shows foams before any drop.",
                  "FOAM is a material file, or a name of `softfall foam list`. docs/cards.md has the\nmapping of every field.")
    made.add_argument("word", metavar="WORD", choices=("convert", "export", "list", "show", "plot"), help=argparse.SUPPRESS)
    made.add_argument("file", metavar="FILE", nargs="?", help=argparse.SUPPRESS)
    add = made.options.add_argument
    add("-f", "--force", action="store_true", help="replace files that are there")
    add("--format", metavar="FORMAT", choices=tuple(FORMATS), help="dyna, abaqus or radioss (of convert: by the name of the file, or its first material)")
    add("--material", metavar="FOAM", help="of convert: number or name of the foam, of a deck with several")
    add("-o", "--output", metavar="OUT", help="a folder, or NAME.cfg (convert); the deck (export); the picture (plot)")
    add("--rates", metavar="LIST", help="of show and plot: rates in 1/s, such as 0.01,1,100")
    add("--units", metavar="UNITS", help="units of the deck, such as mm-ms-kg-GPa: length, time, and mass, stress or force; convert finds them where one system makes a foam of the card")
    return made


def run(o: argparse.Namespace) -> int:
    """Runs a word of the command and returns the exit code."""
    say(perform(o))
    return 0
