# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a drop, from the files of softfall-post: the answer first, then curves, pad, checks, case, figures and provenance.

Every number is one of summary.json, of the CSV files or of results.h5. What is missing, or does not belong to the rest, is told at the top of the page.
"""
from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any, Mapping

import h5py
import numpy as np

from . import library, output as output_files, report_pictures as pictures
from .array import Array
from .drop import Drop, as_str
from .errors import Error, InputError
from .library import GRADES
from .study import Table
from .template import render

KINDS = dict(zip(GRADES, ("good", "fair", "bad")))
CAUTION = "Indicative, not a certification: figures of simulated impacts, not the test of EN 1177 or ASTM F1292."
TEST = ("sample", "laboratory", "conditions")  # words of the case about the test
MISSILE = {"geometry.missile_file": "shape", "geometry.missile_parameters": "its parameters", "geometry.missile_length_unit": "their unit",
           "missile.motion": "prescribed motion", "missile.friction": "friction on the pad"}
PAD = {"geometry.file": "shape", "geometry.parameters": "its parameters", "geometry.length_unit": "their unit", "pad.fixed": "surfaces of the base",
       "pad.sliding": "sliding surfaces", "pad.base": "base", "pad.sliding_interfaces": "sliding layers", "pad.loose_interfaces": "loose layers"}
ANVIL = {"pad.friction": "friction on the anvil", "pad.gravity": "gravity on the pad"}
CELLS = {4: "triangles", 5: "quadrangles", 6: "tetrahedra", 7: "pyramids", 8: "prisms", 9: "hexahedra"}
COMPARED = ("a_max_g", "a_max_time_ms", "hic", "hic_t1_ms", "hic_t2_ms", "v0_m_s", "v_rebound_m_s", "absorbed_energy_fraction", "max_indentation_mm",
            "max_local_strain", "energy_error", "nodes", "steps")
LINE = re.compile(r'(\S+)\s+("(?:\\.|[^"\\])*"|\{.*\}|\[.*\]|\S+)\s+(?:(.*?)\s+)?(given|default)$')  # of the list of parameters


class Parameters(dict[str, tuple[str, bool]]):
    """The values of a case by their keys, as its file spells them, and whether the case gives them."""

    def __init__(self, text: str) -> None:
        found = [match for match in map(LINE.match, text.splitlines()) if match]
        super().__init__((match[1], (re.sub(r"\\(.)", r"\1", match[2][1:-1]) if match[2].startswith('"') else match[2], match[4] == "given")) for match in found)

    def rows(self, names: Mapping[str, str]) -> list[tuple[str, str]]:
        """Returns the titles and values of the keys that have one."""
        values = [(title, re.sub(r'[{}\[\]"]', "", self[key][0]).strip(" ;")) for key, title in names.items() if key in self and self[key][0] != "(absent)"]
        return [(title, value) for title, value in values if value]


def comments(case: str, layer: str | None) -> str:
    """Returns the comments of a material in the text of a case, which name its origin and the range of its data."""
    lines = case.splitlines()
    replacing = f"# --set material{f's.{layer}' if layer else ''}=@"
    at = max((k for k, text in enumerate(lines) if text.startswith(replacing)), default=None)
    prefix = "" if at is None else "#     "
    if at is None:
        at = max((k for k, text in enumerate(lines) if text.startswith("materials" if layer else "material")), default=len(lines))
        if layer:
            at = next((k for k, text in enumerate(lines) if k > at and re.match(rf"\s*{re.escape(layer)}\s*[:=]", text)), len(lines))
    said = []
    for text in lines[at + 1:]:
        inner = text[len(prefix):].strip()
        if not text.startswith(prefix) or inner.startswith("}"):
            break
        if inner.startswith("#") and not re.fullmatch(r"# from .*:", text[len(prefix):]):
            said.append(inner[1:].strip())
    return "\n".join(said)


def _text(value: Any) -> str:
    """Returns a figure as it is shown."""
    if value is None or isinstance(value, float) and not math.isfinite(value):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.6g}" if abs(value) >= 1e4 else f"{value:.4g}"
    return str(value)


class Page:
    """The inputs of a page; `problems` are sentences about those that are missing, damaged or of something else."""

    def __init__(self, folder: Path, drop: Drop | None = None) -> None:
        self.folder, self.problems = folder, list[str]()
        path = folder / "summary.json"
        remedy = f"`softfall-post RESULTS.h5 -o {folder} --force' makes it anew"
        try:
            self.summary: dict[str, Any] = json.loads(output_files.read(path))
            s, verdict = self.summary, self.summary["verdict"]
            self.checks, self.limits, self.grade = verdict["checks"], verdict["limits"], GRADES[GRADES.index(verdict["grade"])]
            worst = max((GRADES.index(check["grade"]) for check in self.checks if check["grade"]), default=0)
            s["command_line"], s["git_revision"], s["a_max_mesh_error"], s["thickness_mm"], s["notes"], s["prescribed_motion"]
        except (ValueError, KeyError, TypeError) as error:
            raise InputError(f"{path} is not whole, or of another version of softfall-post ({type(error).__name__}: {error}): {remedy}") from None
        if worst != GRADES.index(self.grade):
            self._refuse("summary.json", f"its verdict is \"{self.grade}\", its checks are \"{GRADES[worst]}\"")
        for limit in self.limits:
            if limit["passed"] and not (limit["value"] is not None and limit["value"] <= limit["bound"]):
                self._refuse("summary.json", f"{limit['key']} has \"passed\" at {_text(limit['value'])}, its limit is {limit['bound']:g}")
        if s["program"].split()[-1] != library.version().split()[0]:
            self.problems.append(f"The figures are of {s['program']}, this page is of softfall {library.version()}")
        self.driven = bool(s["prescribed_motion"])
        self.drop = drop if drop and drop._kept(folder) is not None else self._find()
        self.curve = self._table("compression.csv" if self.driven else "acceleration.csv")
        self.history = self._table("history.csv")
        self.measured = self._table("reference.csv") if "reference" in s else None
        self._compare("acceleration.csv", self.curve, "a_max_g", "a_max_g")
        self._compare("history.csv", self.history, "max_indentation_mm", "largest indentation", "indentation_mm")
        if self.measured:
            self._compare("reference.csv", self.measured, "a_max_g", "measured a_max", "acceleration_measured_g", s["reference"])
        self.parameters, self.case, self._origin = Parameters(""), "", dict[str, str]()
        if self.drop:
            with self.drop.open() as file:
                if isinstance(file.get("provenance"), h5py.Group):
                    file["provenance"].visititems(lambda name, data: self._origin.update({name: as_str(data[()])} if isinstance(data, h5py.Dataset) else {}))
            self.parameters, self.case = Parameters(self._origin.get("model/parameters", "")), self._origin.get("model/case_text", "")

    def _refuse(self, name: str, reason: str) -> None:
        """Notes an input that contradicts itself: no figure of the page may be used."""
        self.problems.append(f"{name} contradicts itself: {reason}. Nothing on this page may be used; run softfall-post again")
        self.grade = GRADES[-1]

    def _find(self) -> Drop | None:
        """Returns the drop of the results that summary.json names; None and a problem if it is not there or another one."""
        named = Path(self.summary["results"])
        places = [named, self.folder / named, *(place / named.name for place in (self.folder, self.folder.parent))]
        for place in places:
            if place.is_file():
                try:
                    found = Drop(place, self.folder)
                    if found._is_run(self.summary):
                        return found
                except (Error, KeyError, TypeError):
                    pass
        other = next((f"{place} is damaged or of another run" for place in places if place.is_file()), f"{named} is not there")
        self.problems.append(f"{other}: this page has no pictures of the pad, no values of the case and no provenance")
        return None

    def _table(self, name: str) -> dict[str, Array] | None:
        path = self.folder / name
        try:
            table = Table(path)
            if len(table) < 2 or not all(table[column].dtype.kind == "f" for column in table):
                raise ValueError("a row or a number is missing")
            return {column: table[column] for column in table}
        except (OSError, ValueError) as error:
            self.problems.append(f"{name} cannot be read: {error.strerror if isinstance(error, OSError) else error}. What it shows is left out; `softfall-post' makes it anew")
            return None

    def _compare(self, name: str, table: dict[str, Array] | None, key: str, title: str, column: str | None = None, figures: Mapping[str, Any] | None = None) -> None:
        """Notes a table that is not of these figures."""
        value = (figures or self.summary)[key]
        if table is None or value is None or self.driven and key == "a_max_g":
            return
        array = table.get(column or list(table)[-1])
        largest = math.nan if array is None else float(np.nanmax(array))
        if not math.isclose(largest, value, rel_tol=2e-3, abs_tol=1e-6):
            self.problems.append(f"{name} is of another run: its largest value is {largest:.5g}, {title} of summary.json {value:.5g}. It is not shown")
            if name == "history.csv":
                self.history = None
            elif name == "reference.csv":
                self.measured = None
            else:
                self.curve = None

    # ---- the answer ----

    @property
    def title(self) -> str:
        s = self.summary
        if self.driven:
            return f"Compression of a foam specimen of {s['thickness_mm']:.4g} mm"
        return f"Drop of {s['missile_mass_kg']:.4g} kg at {s['v0_m_s']:.4g} m/s on a foam pad of {s['thickness_mm']:.4g} mm"

    @property
    def subtitle(self) -> str:
        """What fell on what, by the values of the run: comments of a case may be older."""
        s, value = self.summary, {key: text for key, (text, _) in self.parameters.items()}
        missile = Path(value.get("geometry.missile_file", "") if value.get("geometry.missile_file") != "(absent)" else "").name or "missile"
        moves = "moved as given" if self.driven else "free to turn" if s["free_missile"] else "guided along a line"
        layers = f" in {len(s['layers'])} layers" if s.get("layers") else ""
        base = f", base {value['pad.base']}" if "pad.base" in value else ""
        model = "section of a body of revolution" if value.get("geometry.model") == "axisymmetric" else {1: "whole model", 2: "half model", 4: "quarter model"}.get(s["symmetry_factor"], "")
        height = "" if self.driven else f"; free fall from {s['v0_m_s'] ** 2 / (2 * 9.80665):.3f} m"
        return f"{missile}, {moves}, on foam of {s['density_kg_m3']:.4g} kg/m³{layers}{base}; {model}{height}."

    def tiles(self) -> list[dict[str, Any]]:
        """Returns the few figures in large type, with their errors by the mesh and their limits."""
        s, limits = self.summary, {limit["key"]: limit for limit in self.limits}
        made = []

        def add(name: str, key: str, digits: int, unit: str, remark: str = "", error: str = "") -> None:
            value, part, limit, kind = s[key], s.get(error), limits.get(key), "plain"
            lines = [remark] if remark else []
            if limit and limit["passed"] is not None and value is not None:
                sides = {True: ("good", "below"), False: ("bad", "ABOVE")}[bool(limit["passed"]) and self.grade != GRADES[-1]]
                close = part is not None and abs(value - limit["bound"]) <= abs(part) * value
                kind, lines = ("fair" if close and sides[0] == "good" else sides[0]), [f"{sides[1]} the limit of {limit['bound']:g}{unit}{' by less than the error of the mesh' if close else ''}"]
            elif limit:
                lines = [f"limit of {limit['bound']:g}{unit}: not judged"]
            if self.grade == GRADES[-1]:
                kind = "bad" if kind == "bad" else "plain"
            if error and value is not None:
                lines.append(f"mesh ± {100 * abs(part):.2g} %" if part is not None else "error of the mesh not known")
            made.append({"name": name, "value": "–" if value is None else f"{value:.{digits}f}{unit}", "kind": kind, "lines": lines})

        def percent(key: str, words: str) -> str:
            return "" if s[key] is None else f"{100 * s[key]:.0f} % {words}"
        if self.driven:
            add("largest force", "peak_force_N", 1, " N", "" if s["peak_force_time_ms"] is None else f"at {s['peak_force_time_ms']:.2f} ms")
            add("largest stress", "peak_stress_kPa", 1, " kPa", f"over {s['section_mm2'] / 100:.4g} cm² at rest")
        else:
            add("a_max", "a_max_g", 1, " g", error="a_max_mesh_error")
            add("HIC", "hic", 1, "", error="hic_mesh_error")
        add("largest indentation", "max_indentation_mm", 1, " mm", percent("max_mean_strain", "of the thickness"), "" if self.driven else "max_indentation_mesh_error")
        if self.driven:
            add("work", "work_J", 3, " J", percent("returned_energy_fraction", "given back"))
        else:
            add("rebound", "v_rebound_m_s", 2, " m/s", percent("absorbed_energy_fraction", "of the energy absorbed"))
        return made

    def findings(self) -> list[str]:
        """Returns the findings of the checks that are not valid, the worst first, with why they matter."""
        found = sorted((check for check in self.checks if check["grade"] not in (GRADES[0], None)), key=lambda check: -GRADES.index(check["grade"]))
        return [f"{check['finding']}: {check['why']}" for check in found] or ["every check of the run is within its bounds"]

    def comparison(self) -> dict[str, Any] | None:
        """Returns the sentence about a measured curve, and its table."""
        reference = self.summary.get("reference")
        if reference is None:
            return None
        record = reference["record"]
        unusual = [f"{check['finding']}: {check['why']}" for check in record["checks"] if check["grade"] not in (GRADES[0], None)]
        kind = {"agrees": "good", "does not agree": "bad"}.get(reference["agreement"], "fair")
        return {"kind": "fair" if kind == "good" and record["grade"] != GRADES[0] else kind if self.grade != GRADES[-1] else "bad", "sentence": reference["finding"],
                "agreement": reference["agreement"] if self.grade != GRADES[-1] else "not judged", "reference": reference, "unusual": unusual, "record": record["grade"]}

    # ---- pictures ----

    def curves(self) -> dict[str, tuple[bytes, str]]:
        """Returns the pictures of curves with their captions."""
        s, made, shown = self.summary, dict[str, tuple[bytes, str]](), (0.0, s_end) if (s_end := self.summary["end_time_ms"]) else (0.0, 1.0)
        if self.curve and self.driven:
            made["curve"] = pictures.line(self.curve["strain_1"], self.curve["stress_kPa"], ("strain", "nominal stress (kPa)")), "Nominal stress over strain (indentation over thickness)."
        elif self.curve:
            made["curve"] = pictures.acceleration(s, self.curve, self.history, self.measured), f"Missile: {s['acceleration']}, filtered with CFC {s['cfc']:g}{'; shaded: the window of HIC' if s['hic'] else ''}."
            shown = pictures._range(self.curve["time_ms"], list(self.curve.values())[-1], None)
        if self.history:
            made["force"] = (pictures.line(self.history["indentation_mm"], self.history["contact_force_N"] / 1e3, ("indentation (mm)", "contact force (kN)")),
                             "Force on the missile over its indentation.")
            made["energies"] = pictures.energies(self.history, shown), "Energies of the whole pad and missile; those below 1 % are left out."
        return made

    def pad(self) -> tuple[list[tuple[bytes, str]], list[str]]:
        """Returns the pictures of the pad with their captions, and sentences about those that cannot be made."""
        s = self.summary
        if not self.drop:
            return [], []
        load = self.history or {}
        if not load or not (peak := s["peak_force_time_ms"] if self.driven else s["a_max_time_ms"]):
            return [], ["No pictures of the pad: the instant of the peak is not known"]
        time, value = load["time_ms"], load["contact_force_N" if self.driven else "acceleration_raw_g"]
        first = float(time[np.argmax(load["contact_nodes_1"] > 0)])
        after = np.flatnonzero((time > peak) & (value <= 0.5 * np.interp(peak, time, value)))
        found, lacking = pictures.instants(self.drop, [first + (peak - first) / 3, peak, float(time[after[0]]) if after.size else None], (time, value), "N" if self.driven else "g")
        said = [f"No picture of the pad at: {', '.join(lacking)}. results.h5 has no frame with displacement and stress there (output.frame_interval, output.fields)"] if lacking else []
        with self.drop.open() as file:
            softened = "frames/000000/softening" in file and float(file["frames/000000/time"][()]) <= 0
        if not found and not softened:
            return [], said
        try:
            section = pictures.Section(self.drop)
            made = self._sections(section, found)
            if softened:
                before = pictures.Instant("before the drop", self.drop.frames[0])
                top = max(float(np.max(before.frame.softening)), 1e-9) / 1e3
                made.insert(0, (section.picture(before, "softening", "softening (kJ/m³)", 1e-3, top, 5.4), "The pad before the drop: energy by which loading takes up less than that of new foam."
                                + ("" if s["set_mm"] is None else f" Its permanent set is {s['set_mm']:.3g} mm deep at the impact point.")))
            return made, said
        except (KeyError, AttributeError, ValueError, IndexError) as error:
            return [], [*said, f"No pictures of the pad: {self.drop.results.name} does not hold what they need ({error})"]

    def _sections(self, section: pictures.Section, found: list[pictures.Instant]) -> list[tuple[bytes, str]]:
        made = []
        mirror = " and mirrored there" if section.mirrored else ""
        for instant in found:
            if "peak" in instant.title and "largest_compression" in instant.frame.fields:
                top = float(section.value(instant.frame.largest_compression).max())
                made.append((section.picture(instant, "largest_compression", "largest compression (strain)", 1, max(top, 1e-9), 5.4, cells=True),
                             f"The pad at the peak ({instant.title.partition(',')[0]}), cut through the missile's axis{mirror}, with the cells of the mesh."))
        top = max((float(section.value(instant.frame.von_mises).max()) / 1e3 for instant in found), default=0)
        if top > 0:
            half = 1.25 * float(np.ptp(section._missile[:, 0])) / (1 if section.mirrored and section._missile[:, 0].min() >= section.axis - 1e-9 else 2)
            made += [(section.picture(instant, "von_mises", "von Mises stress (kPa), logarithmic", 1e-3, top, 3.4, logarithmic=True, half=half), f"{instant.title}.") for instant in found]
            profile = section.profile(found, "von_mises", "von Mises stress (kPa)", 1e-3)
            made += [(profile, "Von Mises stress through the thickness, under the missile's axis.")] if profile else []
        return made

    # ---- the case, and where it comes from ----

    def facts(self) -> dict[str, list[tuple[str, str]]]:
        """Returns tables of the case's values: title and value."""
        s, p = self.summary, self.parameters
        anvil = ANVIL if self.history and self.history["anvil_nodes_1"][0] > 0 else {}
        missile = [] if self.driven else [("mass", f"{s['missile_mass_kg']:.4g} kg, of the whole missile"), ("speed at contact", f"{s['v0_m_s']:.4g} m/s"),
                                          ("kinetic energy", f"{s['missile_mass_kg'] * s['v0_m_s'] ** 2 / 2:.4g} J")]
        place = [("impact point", f"x = {s['impact_x_mm']:.4g} mm, y = {s['impact_y_mm']:.4g} mm")] if s["impact_x_mm"] is not None else []
        pad = [("thickness", f"{s['thickness_mm']:.4g} mm"), ("mean cross-section", f"{s['section_mm2'] / 100:.4g} cm²"),
               ("density", f"{s['density_kg_m3']:.4g} kg/m³, undeformed{', mean of the layers' if s.get('layers') else ''}")]
        pad += [("permanent set", f"{s['set_mm']:.3g} mm deep at the impact point before this drop")] if s["set_mm"] is not None else []
        for k in range(1, 1000):
            if (between := dict(p.rows({f"interfaces.{k}.between": "x"})).get("x")) is None:
                break
            friction = f", friction {p[f'interfaces.{k}.friction'][0]}" if p.get(f"interfaces.{k}.friction", ("", False))[1] else ""
            pad.append(("interface", f"{between}: {p.get(f'interfaces.{k}.kind', ('', False))[0]}{friction}"))
        test = [(key, s[key]) for key in TEST if s[key]]
        return ({"Test": test} if test else {}) | {"Missile": missile + p.rows(MISSILE) + place, "Pad": pad + p.rows(PAD | anvil)}

    def materials(self) -> list[dict[str, Any]]:
        """Returns the values and comments of each material."""
        layers: list[str | None] = [*dict.fromkeys(key.split(".")[1] for key in self.parameters if key.startswith("materials."))] or [None]
        made = []
        for layer in layers if self.parameters else []:
            group = f"materials.{layer}." if layer else "material."
            rows = [(key.removeprefix(group), value) for key, (value, given) in self.parameters.items() if given and key.startswith(group)]
            if not self.parameters.get(f"{group}informed_strain", ("", True))[1]:
                rows.insert(0, ("informed_strain", "not given: the end of the curve is taken for it"))
            made.append({"title": f"Material of the layer {layer}" if layer else "Material", "rows": rows,
                         "origin": comments(self.case, layer) or "The case says nothing about the origin of the material."})
        return made

    def provenance(self) -> tuple[list[tuple[str, str]], list[str]]:
        """Returns mesh, versions and hashes, and the commands that repeat the page."""
        s, lost = self.summary, "not recorded in this file"

        def version(group: str) -> str:
            words = [self._origin.get(f"{group}{name}", "") for name in ("version", "git_revision", "created")]
            return f"{words[0]} ({words[1]}), {words[2]}" if all(words) else lost
        cells = ""
        if self.drop:
            kinds, counts = np.unique(np.asarray(self.drop.data("model/cell_type")), return_counts=True)
            cells = ": " + ", ".join(f"{count} {CELLS.get(int(kind), 'cells')}" for kind, count in zip(kinds, counts))
            if not set(kinds) <= {4, 5}:  # the nodes of a section have rings
                size = 1e3 * np.cbrt(np.asarray(self.drop.data("model/volume")))
                cells += f"; nodal spacing {size.min():.1f} to {size.max():.1f} mm (cube root of the volumes)"
        facts = [("nodes and cells", f"{s['nodes']} nodes, {s['cells']} cells{cells}"), ("hash of the mesh", self._origin.get("model/mesh_hash") or lost),
                 ("hash of the model", self._origin.get("model_hash") or lost), ("softfall-pre", version("model/")), ("softfall-solve", version("")),
                 ("softfall-post", f"{s['program'].split()[-1]} ({s['git_revision']})"), ("compiler", self._origin.get("compiler") or lost), ("libraries", self._origin.get("libraries") or lost)]
        commands = [self._origin.get("model/command_line") or "(softfall-pre: not recorded)", self._origin.get("command_line") or "(softfall-solve: not recorded)", s["command_line"]]
        return facts, [*commands, f"softfall report {self.folder}"]

    def figures(self) -> list[tuple[str, str]]:
        """Returns the figures of summary.json that the run defines."""
        left_out = ("program", "git_revision", "command_line", "results", "caution", "acceleration", *TEST)
        return [(key, _text(value)) for key, value in self.summary.items() if key not in left_out and value is not None and not isinstance(value, (list, dict))]


def _render(name: str, **values: Any) -> str:
    return render(name, caution=CAUTION, text=_text, kinds=KINDS, program=f"softfall report {library.version()}", **values)


def _put(path: Path, content: str) -> Path:
    """Writes a page; one that softfall did not write is not replaced."""
    if path.is_file() and path.stat().st_size and b"softfall" not in output_files.read(path):
        raise InputError(f"{path} is no page of softfall, and is not replaced: move it away")
    output_files.write(path, re.sub("[\x00-\x08\x0b-\x1f\x7f\ud800-\udfff]", "\ufffd", content))
    return path


def write(folder: Path, drop: Drop | None = None) -> Path:
    """Writes report.html and the picture of its curve into a folder with the output of softfall-post, and returns the page's path."""
    if not (folder / "summary.json").exists():
        if (folder / "compare.json").exists():
            return _write_comparison(folder)
        raise InputError(f"there is no output of softfall-post in {folder}: `softfall-post RESULTS.h5 -o {folder}' makes it")
    page = Page(folder, drop)
    curves, (pad, lacking) = page.curves(), page.pad()
    facts, commands = page.provenance()
    scene = folder / "pad.png"
    content = _render("report.html", page=page, s=page.summary, curves=curves, pad=pad, lacking=lacking, facts=page.facts(), provenance=facts, commands=commands, layers=page.summary.get("layers") or [],
                      compared=page.comparison(), view=(folder / "view.html").exists(), scene=output_files.read(scene) if scene.exists() else None)
    if "curve" in curves:
        output_files.write(folder / f"{'compression' if page.driven else 'acceleration'}.png", curves["curve"][0])
    return _put(folder / "report.html", content)


def _write_comparison(folder: Path) -> Path:
    """Writes the page of `softfall-post compare` or `series`."""
    import pandas  # half a second, for this page alone
    try:
        told = json.loads(output_files.read(folder / "compare.json"))
        curves, table = pandas.read_csv(folder / "compare_curves.csv"), pandas.read_csv(folder / "compare.csv", index_col="figure", dtype=str, keep_default_na=False)
        runs = told["runs"]
        shown = {f"{run['name']}": (part["time_ms"].to_numpy(), part["acceleration_cfc1000_g"].to_numpy()) for k, run in enumerate(runs, 1) for part in [curves[curves["run"] == k]]}
        figures = [(key, [_text(float(value)) if value else "–" for value in table.loc[key]]) for key in COMPARED]
        worst = GRADES[max(GRADES.index(run["grade"]) for run in runs)]
        if list(table.loc["grade"]) != [run["grade"] for run in runs] or len(shown) != len({run["name"] for run in runs}):
            raise ValueError("compare.csv and compare.json are of different runs")
        series = pandas.read_csv(folder / "series.csv", dtype={"drop": str}) if (folder / "series.csv").exists() else None
        rows = [[text if text else "–" for text in (str(row["drop"]), "" if np.isnan(row["v0_m_s"]) else f"{row['v0_m_s']:.4g} at ({row['x_mm']:.4g}, {row['y_mm']:.4g})", f"{row['a_max_g']:.5g}",
                 f"{100 * row['a_max_g_growth']:+.1f} %", f"{row['hic']:.5g}", f"{100 * row['hic_growth']:+.1f} %")] for _, row in series.iterrows()] if series is not None else []
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{folder} holds no whole comparison ({error}): make it anew by `softfall-post compare' or `softfall-post series' with --force") from None
    differ = series is not None and any(series[name].nunique() > 1 for name in ("v0_m_s", "x_mm", "y_mm"))
    image = pictures.several(shown)
    output_files.write(folder / "compare.png", image)
    return _put(folder / "report.html", _render("compare.html", told=told, runs=runs, figures=figures, worst=worst, image=image, series=rows, differ=differ,
                                                commands=[told["command_line"], f"softfall report {folder}"]))


def current(folder: Path, drop: Drop | None = None) -> Path:
    """Returns the page of a folder, which is made if it is absent, older than summary.json or of another version."""
    page = folder / "report.html"
    try:
        if page.stat().st_mtime_ns >= (folder / "summary.json").stat().st_mtime_ns and f'content="softfall report {library.version()}"' in page.open(encoding="utf-8").read(2000):
            return page
    except (OSError, UnicodeDecodeError):
        pass
    return write(folder, drop)
