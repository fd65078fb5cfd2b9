# SPDX-License-Identifier: GPL-3.0-or-later
"""What `softfall fit compression` writes of a form or a hyperfoam, and the page of every compression fit: curves, deviations, parameters with their errors."""
from __future__ import annotations

import json
import math
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from .. import library, output as output_files
from ..array import Array
from ..sweep_page import PLAIN
from ..template import base64_of, png, render
from .compression import Test
from .curve_fit import GOOD, MEMORY, POOR, UNLOADING, FormFit, number, returned
from .hyperfoam_fit import HyperfoamFit

POOR_FORM = "the form does not describe these tests: a deviation exceeds 10 % of the largest stress"
STATES = {"good": "the law fits the tests", "fair": "the law misses the tests in part", "bad": "the law does not describe the tests"}
TERM = ("mu", "alpha", "nu")
NOTE = "± is one standard error."


class Series(NamedTuple):
    """A curve with the law along it: `x` and values of one quantity."""

    label: str
    strain: Array
    measured: Array
    law: Array
    predicted: bool = False


class Page(NamedTuple):
    """The page of a fit: `worst` is the largest rms of a branch over the largest stress, `doubts` what forbids a green word."""

    title: str
    worst: float
    doubts: list[str]
    text: str
    series: list[Series]
    unit: str
    tables: list[tuple[str, list[str], list[list[str]], str]]  # heading, columns, rows, note
    notes: list[str]
    energies: list[list[tuple[float, float]]] = []  # of each record and cycle: measured, by the law

    def lines(self) -> list[str]:
        """Returns the page in words, for the terminal and the comments of a material file."""
        tables = [line for heading, heads, rows, _ in self.tables if heading != "Correlation" for line in [f"{heading}: {', '.join(heads)}", *("  " + "  ".join(row) for row in rows)]]
        return [f"{self.text}.", *(f"WARNING: {doubt}." for doubt in self.doubts), *tables, *self.notes]

    @property
    def kind(self) -> str:
        return "bad" if not self.worst <= POOR else "fair" if not self.worst <= GOOD or self.doubts else "good"


def _percent(value: float, digits: int = 2) -> str:
    return f"{100 * value:.{digits}g} %" if math.isfinite(value) else "–"


def _bound(fit: FormFit, k: int) -> str:
    p = fit.given.form.parameters[fit.given.form.index[fit.given.unknown[k]]]  # type: ignore[union-attr]
    return "lower" if fit.at(p.name) < math.sqrt(p.low * p.high) else "upper"


def _tests(fit: FormFit) -> list[tuple[Test, str]]:
    return [*((test, "fitted") for test in fit.given.tests), *((test, "predicted") for test in fit.given.predicted)]


# ---- a form

def form_doubts(fit: FormFit) -> list[str]:
    """Returns warnings."""
    given = fit.given
    made = [f"these tests do not determine {name}: {f'it stands at its {_bound(fit, k)} bound' if fit.at_bound[k] else 'its standard error exceeds 100 %'}"
            for k, name in enumerate(given.unknown) if not fit.is_determined(k)]
    return made + [f"the predicted test {test.path} at {test.rate:g} 1/s is below rate_reference = {fit.at('rate_reference'):g} 1/s, where the law has no effect of the rate"
                   for test in given.predicted if fit.is_below_reference(test)]


def form_summary(fit: FormFit) -> dict[str, Any]:
    """Returns fit.json."""
    given, form = fit.given, fit.given.form
    assert form
    made: dict[str, Any] = {"program": f"softfall fit compression {library.version()}", "input": given.path, "law": "low_density_foam", "name": given.name, "curve_form": form.curve,
                            "rate_model": given.rate, "parameter_count": len(given.unknown), "loading_rms": number(fit.loading_rms), "describes_the_tests": fit.worst <= POOR, "parameters": []}
    for k, name in enumerate(given.unknown):
        p = form.parameters[form.index[name]]
        made["parameters"].append({"name": name, "unit": p.unit, "value": fit.at(name) / p.per_unit, "relative_error": number(fit.error[k]), "at_bound": fit.at_bound[k],
                                   **({"bound": _bound(fit, k)} if fit.at_bound[k] else {}), "determined": fit.is_determined(k)})
    made["correlation"] = [[round(float(v), 6) for v in row] for row in fit.correlation]
    if fit.one and fit.unloading:
        made |= {"unloading_with_ALPHA_1": fit.one.json(), "unloading": fit.unloading.json()}
    if given.cycles:
        made["memory"] = {key: value for name, error in zip(MEMORY, fit.memory_error) for key, value in ((name, fit.at(name)), (f"{name}_standard_error", number(error)))}
        made["memory"] |= dict(zip(("set", "set_standard_error", "set_time_s"), map(number, fit.set)))
        made["memory"]["records"] = [{"file": r.path, "cycles": r.whole, "fitted": r.fitted, "pauses": int(np.sum(r.pause[:r.turn[2 * r.fitted] + 1] > 0)), "relaxation": r.relaxation,
                                      "loading_rms": fit.cycle_rms(n, 0), "unloading_rms": fit.cycle_rms(n, 1), "returned_energy_measured": [a for a, _ in fit.energies(n)],
                                      "returned_energy_fitted": [b for _, b in fit.energies(n)]} for n, r in enumerate(given.cycles)]
    made |= {"tests": [], "predicted": []}
    for k, (test, use) in enumerate(_tests(fit)):
        loading, unloading = fit.misfits(k)
        made["tests" if use == "fitted" else "predicted"].append(
            {"file": test.path, "rate_1_s": test.rate, "below_rate_reference": fit.is_below_reference(test), "largest_strain": test.data.largest_strain,
             "largest_stress_Pa": test.data.largest_stress, "loading_rms": number(loading), "unloading_rms": number(unloading),
             "returned_energy_measured": number(returned(test, test.data.stress) if fit.unloading else math.nan), "returned_energy_fitted": number(returned(test, fit.stress[k]))})
    return made


def form_table(fit: FormFit) -> list[list[Any]]:
    """Returns fit.csv."""
    rows: list[list[Any]] = [["test", "use", "rate_1_s", "branch", "strain", "measured_kPa", "law_kPa"]]
    for k, (test, use) in enumerate(_tests(fit)):
        rows += [[k + 1, use, f"{test.rate:.9g}", "loading" if i < test.data.loading else "unloading", *_digits(e, 1e-3 * a, 1e-3 * b)]
                 for i, (e, a, b) in enumerate(zip(test.data.strain, test.data.stress, fit.stress[k]))]
    for n, (r, law) in enumerate(zip(fit.given.cycles, fit.cycles)):
        for c, (a, b) in enumerate(zip(r.turn, r.turn[1:])):
            rows += [[f"record {n + 1} cycle {c // 2 + 1}", "fitted" if c // 2 < r.fitted else "predicted", "", "unloading" if c % 2 else "loading",
                      *_digits(r.strain[i], 1e-3 * r.stress[i], 1e-3 * law[i])] for i in range(a + (c > 0), b + 1)]
    return rows


def _digits(*values: float) -> list[str]:
    return [f"{value:.9g}" if math.isfinite(value) else "" for value in values]


def form_page(fit: FormFit) -> Page:
    given, form = fit.given, fit.given.form
    assert form
    rows = []
    for k, name in enumerate(given.unknown):
        p, value = form.parameters[form.index[name]], fit.at(name) / form.parameters[form.index[name]].per_unit
        doubt = f"at its {_bound(fit, k)} bound" if fit.at_bound[k] else f"± {_percent(fit.error[k])}"
        interval = " to ".join(f"{value * math.exp(sign * 1.96 * fit.error[k]):.4g}" for sign in (-1, 1)) if fit.is_determined(k) else "these tests do not determine it"
        rows.append([name + (f" ({p.unit})" if p.unit else ""), f"{value:.5g}", doubt, interval, p.description])
    for one, words in ((None if given.cycles else fit.one, "of unloading, ALPHA = 1"), (fit.unloading, "of unloading")):
        rows += [[name, f"{value:.4g}", f"at its {'lower' if value < 0.5 else 'upper'} bound" if name in one.at_bound else "–", "–", words] for name, value in zip(UNLOADING, one.value)] if one else []
    if given.cycles:
        rows += [[name, f"{fit.at(name):.3g}", f"± {error:.2g}" if math.isfinite(error) else "at its bound, or no record tells it", "–", "of the memory"] for name, error in zip(MEMORY, fit.memory_error)]
        rows.append(["set", f"{fit.set[0]:.2g}", f"± {fit.set[1]:.1g}", "–", f"not written: of the largest strain, by which reloads take up stress late, after {fit.set[2]:.3g} s without load"])
    tests = [[test.path, use + (", below rate_reference" if fit.is_below_reference(test) else ""), f"{test.rate:.4g}", *map(_percent, fit.misfits(k)), _percent(returned(test, test.data.stress), 3),
              _percent(returned(test, fit.stress[k]), 3)] for k, (test, use) in enumerate(_tests(fit))]
    tables = [("Parameters", ["parameter", "value", "standard error", "95 %, linearised", "meaning"], rows, NOTE),
              ("Correlation", ["", *given.unknown], [[name, *(f"{v:+.2f}" for v in row)] for name, row in zip(given.unknown, fit.correlation)], ""),
              ("Tests", ["test", "use", "rate (1/s)", "loading", "unloading", "energy returned, measured", "by the law"], tests, "Root mean square of the deviations over the largest stress.")]
    notes = [f"Curve: {form.formula}.", f"Beyond the strain {given.informed:.4g} and outside these rates it is extrapolation.", *offers(given.tests if not given.cycles else [])]
    series = [Series(f"{test.rate:.4g} 1/s", test.data.strain, 1e-3 * test.data.stress, 1e-3 * fit.stress[k], use == "predicted") for k, (test, use) in enumerate(_tests(fit))]
    worst = [fit.worst]
    for n, (r, law) in enumerate(zip(given.cycles, fit.cycles)):
        misfits, use = [fit.cycle_rms(n, branch) for branch in (0, 1)], ["fitted" if c < r.fitted else "predicted" for c in range(r.whole)]
        worst += [max(one[:r.fitted]) for one in misfits]
        tables.append((f"Cycles of {Path(r.path).name}", ["cycle", "use", "loading", "unloading", "energy returned, measured", "by the law"],
                       [[str(c + 1), use[c], _percent(a), _percent(b), *(_percent(e, 3) for e in energy)] for c, (a, b, energy) in enumerate(zip(*misfits, fit.energies(n)))], ""))
        series += [Series(f"{Path(r.path).name}, cycle {c + 1}", r.strain[a:b + 1], 1e-3 * r.stress[a:b + 1], 1e-3 * law[a:b + 1], c >= r.fitted)
                   for c, (a, b) in enumerate(zip(r.turn[::2], r.turn[2::2])) if c]
        notes += [f"{r.path}: the stress falls by up to {_percent(r.relaxation)} at constant strain at the reversals: relaxation; {np.sum(r.held)} points are left out."] if np.any(r.held) else []
    notes += ["Not in the law: permanent set within a test, and relaxation at the largest strain."] if given.cycles else []
    doubts = [POOR_FORM] * (fit.worst > POOR) + form_doubts(fit)
    return Page(given.name, max(worst), doubts, f"{form.curve}, rate {given.rate}, rms of loading {_percent(fit.loading_rms)} with {len(given.unknown)} parameters", series, "nominal stress (kPa)", tables,
                notes, [fit.energies(n) for n in range(len(given.cycles))])


def offers(tests: list[Test]) -> list[str]:
    """Returns a sentence for each test that has more than the cycle that is fitted."""
    return [f'{test.path} has {test.data.cycles} cycles: cycles = {{ file = "{Path(test.path).name}"; }}; beside the keys of a form fits what the foam remembers.' for test in tests if test.data.cycles > 1]


# ---- a hyperfoam

def _term(fit: HyperfoamFit, k: int, j: int) -> str:
    low = fit.terms[k, j] < (0.2 if j == 2 else 1.0)
    error = fit.error[k, j]
    return f"at its {'lower' if low else 'upper'} bound" if fit.at_bound[k, j] else ("± " + (_percent(error) if j == 0 else f"{error:.2g}")) if math.isfinite(error) else "given"


def hyperfoam_doubts(fit: HyperfoamFit) -> list[str]:
    told = ", ".join(f"{name} {_percent(value)}" for name, value in fit.misfits.items())
    return [] if fit.is_good else [f"the fit does not describe this test, rms over the largest value: {told}"]


def hyperfoam_summary(fit: HyperfoamFit) -> dict[str, Any]:
    test = fit.given.tests[0]
    terms = [{"mu_Pa": mu, "mu_relative_error": number(e[0]), "alpha": alpha, "alpha_error": number(e[1]), "nu": nu, "nu_error": number(e[2]), "alpha_at_bound": bool(b[1]), "nu_at_bound": bool(b[2])}
             for (mu, alpha, nu), e, b in zip(fit.terms, fit.error, fit.at_bound)]
    return {"program": f"softfall fit compression {library.version()}", "input": fit.given.path, "law": "hyperfoam", "name": fit.given.name, "test": test.path, "rate_1_s": test.rate,
            "largest_strain": test.data.largest_strain, "terms": terms, "poisson_at_1_percent": fit.poisson[0], "poisson_at_largest_strain": fit.poisson[1],
            "stress_rms": fit.stress_rms, "lateral_rms": number(fit.lateral_rms), "describes_the_test": fit.is_good, **dict(zip(UNLOADING, fit.unloading)),
            **{f"{name}_at_bound": name in fit.unloading_at_bound for name in UNLOADING}, "unloading_rms": number(fit.unloading_rms)}


def hyperfoam_table(fit: HyperfoamFit) -> list[list[Any]]:
    test = fit.given.tests[0]
    rows: list[list[Any]] = [["quantity", "branch", "strain", "measured", "fit"]]
    rows += [["stress_kPa", "loading" if i < test.data.loading else "unloading", *_digits(e, 1e-3 * a, 1e-3 * b)] for i, (e, a, b) in enumerate(zip(test.data.strain, test.data.stress, fit.stress))]
    return rows + [["lateral_strain", "loading", *_digits(*values)] for values in (zip(*fit.given.lateral, fit.lateral) if fit.given.lateral else [])]


def hyperfoam_page(fit: HyperfoamFit) -> Page:
    test, size = fit.given.tests[0], fit.given.tests[0].data.largest_stress
    names = [f"{name} {k + 1}" for k in range(len(fit.terms)) for name in TERM[:3 if fit.given.lateral else 2]]
    rows = [[f"{name} {k + 1}" + (" (kPa)" if j == 0 else ""), f"{fit.terms[k, j] * (1e-3 if j == 0 else 1):.5g}", _term(fit, k, j)] for k in range(len(fit.terms)) for j, name in enumerate(TERM)]
    rows += [[name, f"{value:.4g}", "at its bound" if name in fit.unloading_at_bound else "–"] for name, value in zip(UNLOADING, fit.unloading)]
    series = [Series(f"{test.rate:.4g} 1/s", test.data.strain, 1e-3 * test.data.stress, 1e-3 * fit.stress)]
    if fit.given.lateral:
        at, measured = fit.given.lateral
        scale = 1e-3 * size / max(0.01, float(np.max(np.abs(measured))))
        series.append(Series(f"lateral strain × {scale:.4g} kPa", at, scale * measured, scale * fit.lateral))
    bounds = [f"{name} stands {row}" for name, _, row in rows[:-3] if "bound" in row]
    return Page(fit.given.name, max(fit.misfits.values()), [*hyperfoam_doubts(fit), *bounds], f"hyperfoam of {len(fit.terms)} terms", series, "nominal stress (kPa), free sides",
                [("Parameters", ["parameter", "value", "standard error"], rows, NOTE), ("Correlation", ["", *names], [[n, *(f"{v:+.2f}" for v in row)] for n, row in zip(names, fit.correlation)], ""),
                 ("What the fit leaves", ["quantity", "rms over the largest value"], [[name, _percent(value)] for name, value in fit.misfits.items()], "")],
                [f"-ln(lateral stretch)/ln(axial stretch): {fit.poisson[0]:.3g} at 1 % strain, {fit.poisson[1]:.3g} at {100 * fit.given.informed:.3g} %.", f"Beyond the strain {fit.given.informed:.4g} and at other rates it is extrapolation.", *offers(fit.given.tests)])


# ---- the free curve, which softfall-fit has fitted

def free_page(folder: Path) -> Page:
    """Returns the page of what softfall-fit wrote."""
    import csv
    found = json.loads(output_files.read(folder / "fit.json"))
    with (folder / "fit.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    series, tests = list[Series](), list[list[str]]()
    for k, test in enumerate(found["tests"], 1):
        own = [row for row in rows if int(row["test"]) == k]
        label = f"{test['temperature_K'] - 273.15:.3g} °C" if "temperature_K" in test else f"{test['rate_1_s']:.3g} 1/s"
        strain, measured, law = (np.array([float(row[name]) for row in own]) for name in ("strain", "measured_kPa", "fit_kPa"))
        series.append(Series(label, strain, measured, law))
        tests.append([Path(test["file"]).name, label, *(f"{test[f'{side}_rms_over_sigma']:.3g} ({test[f'{side}_rms_percent']:.2g} %)" if test.get(f"{side}_rms_over_sigma") is not None else "–"
                                                        for side in ("loading", "unloading")), test["understood"]])
    scale = {"E_Pa": ("E (kPa)", 1e-3), "ED_Pa": ("ED (kPa)", 1e-3), "BETA1_1_s": ("BETA1 (1/s)", 1.0), "log_rate_c": ("c of the logarithm of the rate", 1.0)}
    parameters = []
    for key, e in found["parameters"].items():
        name, per = scale.get(key, (key, 1.0))
        value, error, low, high = (per * e[part] if e.get(part) is not None else math.nan for part in ("value", "standard_error", "low", "high"))
        known = math.isfinite(error)
        parameters.append([name, f"{value:.5g}", f"± {error:.2g}" if known else "–", f"{low:.5g} to {high:.5g}" if known else "–", e.get("note") or ""])
    candidates = [[kind, form, str(one["parameters"]), f"{one['chi2']:.6g}", f"{one['bic'] - min(o['bic'] for o in found[key].values()):.1f}"]
                  for kind, key in (("rate", "rate_models_tried"), ("densification", "densifications_tried")) for form, one in found[key].items()]
    sides = [found[f"{side}_rms_of_largest"] for side in ("loading", "unloading") if found.get(f"{side}_rms_of_largest") is not None]
    doubts = [f"the law misses the {side} by {math.sqrt(found[f'misfit_{side}']):.3g} times its scatter; the errors are widened by as much" for side in ("loading", "unloading")
              if (found.get(f"misfit_{side}") or 0.0) > 2]
    tables = [("Parameters", ["parameter", "value", "standard error", f"{100 * found['confidence']:g} % interval", "note"], parameters, NOTE),
              ("Tests", ["test", "rate or temperature", "loading", "unloading", "read as"], tests, "Root mean square of the deviations over the scatter (1: nothing but scatter) and of the stress."),
              *([("Choice of the law", ["term", "form", "parameters", "chi2", "BIC above the lowest"], candidates, "10 above the lowest: the data are clearly against it.")] if candidates else [])]
    end, fastest = max(test["largest_strain"] for test in found["tests"]), max(test["rate_1_s"] for test in found["tests"])
    return Page(found["name"], max(sides), doubts, f"free curve, rate model {found['rate_model']}, densification {found['densification']} from the strain {found['densification_start']:.3g}; "
                f"chi2/(n − p) = {found['misfit']:.3g}", series, "nominal stress (kPa)", tables,
                [f"The scatter of the data about a free smooth curve is {1e-3 * found['scatter_absolute_Pa']:.3g} kPa and {100 * found['scatter_relative']:.3g} % of the stress.",
                 f"Beyond the strain {end:.4g} and the rate {fastest:.3g} 1/s it is extrapolation: a drop is faster by orders of magnitude. DAMP is not identified."])


# ---- the page

def _picture(page: Page) -> bytes:
    from matplotlib.figure import Figure
    figure = Figure(figsize=(10, 7.5 if page.energies else 4), dpi=150, layout="constrained")
    axes = figure.subplots(2 if page.energies else 1, 2, squeeze=False)
    for k, s in enumerate(page.series):
        colour, size = f"C{k % 10}", max(1e-12, float(np.nanmax(np.abs(s.measured))))
        axes[0][0].plot(s.strain, s.measured, ".", ms=3, color=colour)
        axes[0][0].plot(s.strain, s.law, color=colour, lw=1.2, ls="--" if s.predicted else "-", label=s.label + (" (predicted)" if s.predicted else ""))
        axes[0][1].plot(s.strain, 100 * (s.law - s.measured) / size, ".", ms=2.5, lw=0.5, color=colour, ls="--" if s.predicted else "-")
    axes[0][0].set(xlabel="compressive strain", ylabel=page.unit, title="measured (points) and law (lines)")
    axes[0][0].legend(fontsize=7)
    axes[0][1].axhspan(-100 * GOOD, 100 * GOOD, color="0.93")
    axes[0][1].axhline(0, color="0.5", lw=0.7)
    axes[0][1].set(xlabel="compressive strain", ylabel="law − measured (% of the largest)", title=f"deviations; grey: ± {100 * GOOD:g} %")
    for k, record in enumerate(page.energies):
        ax = axes[1][min(k, 1)]
        cycles = np.arange(1, len(record) + 1)
        ax.plot(cycles, [100 * a for a, _ in record], "o", color=PLAIN, label="measured")
        ax.plot(cycles, [100 * b for _, b in record], "-", color=PLAIN, label="law")
        ax.set(xlabel="cycle", ylabel="energy returned (%)", title=f"record {k + 1}")
        ax.legend(fontsize=7)
    if len(page.energies) == 1:
        axes[1][1].set_axis_off()
    return png(figure)


def write_page(page: Page, folder: Path, program: str) -> None:
    """Writes fit.png and report.html."""
    image = _picture(page)
    output_files.write(folder / "fit.png", image)
    output_files.write(folder / "report.html", render(
        "fit-compression.html", page=page, state=STATES[page.kind], worst=_percent(page.worst), picture=base64_of(image), program=program))
