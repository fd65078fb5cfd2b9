# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of a drop: the answer first, every number of the files, nothing to load, and what is wrong in the inputs is told in the page itself."""
import base64
import json
import os
import pathlib
import re
import shutil
import sys
import xml.etree.ElementTree as tree

import h5py
import numpy as np
import pytest

import softfall
from conftest import command_here, program
from softfall import report

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))


def shown(folder):
    """Returns the text of a page, which is well-formed and has nothing to load or to run."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    assert not re.search(r"<script|<link|https?:|@import|url\(|src=\"(?!data:image/png;base64,)", text)
    return " ".join(" ".join(part.split()) for part in tree.fromstring(text.removeprefix("<!DOCTYPE html>\n")).find("body").itertext() if part.strip())


@pytest.fixture
def out(drop, tmp_path):
    """A copy of a drop's folder with the output of softfall-post in out/, which a test may spoil."""
    drop.summary
    shutil.copytree(drop.results.parent, tmp_path / "drop", ignore=shutil.ignore_patterns("report.html", "view.html", "pad*", "lock"))
    return tmp_path / "drop/out"


def made(folder):
    done = command_here("report", folder)
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"Written: {folder}/report.html\n"
    return shown(folder)


def changed(folder, change, name="summary.json"):
    summary = json.loads((folder / name).read_text())
    change(summary)
    (folder / name).write_text(json.dumps(summary))


def kinds(folder):
    """Returns the classes of the banners and tiles of a page."""
    return re.findall(r'<div class="(?:banner|tile) (\w+)"', (folder / "report.html").read_text())


@pytest.mark.drawn
def test_the_page_shows_the_figures_of_the_summary_the_answer_first(out):
    page, s = made(out), json.loads((out / "summary.json").read_text())
    verdict = s["verdict"]
    places = [page.index(text) for text in (s["verdict"]["grade"], f"{s['a_max_g']:.1f} g", f"{s['hic']:.1f}", "Force and indentation", "The pad at the peak", "Checks of the run",
                                            "Missile mass", "Material law", "Figures a_max_g", "Mesh, versions and commands")]
    assert places == sorted(places)
    assert "below the limit of 200 g" in page and f"mesh ± {100 * s['a_max_mesh_error']:.2g} %" in page and "Indicative, not a certification" in page
    for key, value in s.items():
        if isinstance(value, float):
            assert f"{key} {report._text(value)}" in page, key
    for check in verdict["checks"]:
        assert f"{check['title']} " in page and (check["grade"] in ("valid", None) or f"{check['finding']}: {check['why']}" in page), check
    assert "a third of the way" in page and "half of it" in page and "No picture" not in page and "not recorded" not in page
    for command in ("softfall-pre ", "softfall-solve ", "softfall-post ", "softfall report "):
        assert command in page[page.index("The commands that repeat this page"):]
    assert "EVA foam of 35 kg/m3" in page and (out / "acceleration.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.slow
def test_the_title_is_made_of_the_values_and_not_of_the_comments_of_the_case(case, tmp_path):
    case.update({"geometry.parameters.thickness": 60, "missile.velocity": "5 m/s", "report.sample": 'tile "A" {1} [x] \\ </script> & co'})
    drop = case.run()
    page = shown(drop.report().parent)
    head = page[:page.index("Indicative")]
    assert head.startswith("Drop of 4.6 kg at 5 m/s on a foam pad of 60 mm hemisphere.geo, guided along a line, on foam of 35 kg/m³, base glued; quarter model; free fall from 1.275 m.")
    assert "50 mm" not in head and "4.5" not in head
    assert 'sample tile "A" {1} [x] \\ </script> & co' in page and "conditions" not in page


def reference(drop, path, factor):
    time, value = drop.curve()
    time, value = np.asarray(time)[::10] / factor, factor * np.asarray(value)[::10]  # the same change of velocity
    path.write_text("time_ms,acceleration_g\n" + "".join(f"{1e3 * t:.4f},{v:.5f}\n" for t, v in zip(time, value)))
    return str(path)


def test_a_comparison_ends_in_a_sentence(drop, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for factor, agreement, kind in ((1.0, "agrees", "good"), (1.4, "does not agree", "bad"), (0.8, "does not agree", "bad")):
        told = drop.post(tmp_path / "out", reference=reference(drop, tmp_path / "<b>&.csv", factor), reference_filter="none", force=True)["reference"]
        page = shown(drop.report().parent)
        assert told["agreement"] == agreement and f"{agreement} {told['finding']}." in page and "<b>&.csv: a_max" in page
        assert told["hic_error"] == pytest.approx(factor ** -1.5 - 1, abs=0.01) and told["a_max_error"] == pytest.approx(1 / factor - 1, abs=0.01)
        assert re.fullmatch(rf"model [\d.]+ % (above|below) the measured a_max, [\d.]+ % (above|below) the measured HIC, R² -?[\d.]+: {agreement} \(bounds: .*\)", told["finding"])
        assert kinds(tmp_path / "out")[-1] == kind and "record valid" not in page and "measured time (ms)" in page
    changed(tmp_path / "out", lambda s: s["verdict"].update(grade="do not use", checks=[s["verdict"]["checks"][0] | {"grade": "do not use"}]))
    report.write(tmp_path / "out")
    assert kinds(tmp_path / "out")[-1] == "bad" and "does not agree model" not in shown(tmp_path / "out")
    program("post", drop.results, "-o", tmp_path / "clipped", "--reference", tmp_path / "<b>&.csv", "--reference-filter", "none", "--reference-range", "20 g", cwd=tmp_path)
    assert ": not judged, as the record is not to be used" in made(tmp_path / "clipped") and "good" not in kinds(tmp_path / "clipped")[-1:]


def test_no_limit_is_passed_in_a_run_that_is_not_to_be_used_or_not_judged(out):
    changed(out, lambda s: [limit.update(passed=None) for limit in s["verdict"]["limits"]])
    assert made(out).count(": not judged") == 2 and "below the limit" not in shown(out)
    changed(out, lambda s: [s["verdict"].update(grade="do not use"), s["verdict"]["checks"][0].update(grade="do not use"), *(limit.update(passed=True) for limit in s["verdict"]["limits"])])
    page = made(out)
    assert "below the limit" not in page and page.index("do not use") < page.index("a_max") and "good" not in kinds(out)


@pytest.mark.parametrize("change, sentence", [
    (lambda s: s["verdict"]["limits"][0].update(bound=20), 'a_max_g has "passed" at'),
    (lambda s: s["verdict"]["checks"][2].update(grade="do not use"), 'its checks are "do not use"')])
def test_a_summary_that_contradicts_itself_is_told(out, change, sentence):
    changed(out, change)
    page = made(out)
    assert sentence in page and "contradicts itself" in page and "good" not in kinds(out)


def test_a_limit_nearer_than_the_error_of_the_mesh_is_not_green(out):
    changed(out, lambda s: [s.update(a_max_mesh_error=0.1), s["verdict"]["limits"][0].update(bound=1.05 * s["a_max_g"])])
    assert "by less than the error of the mesh" in made(out)
    tiles = re.findall(r'class="tile (\w+)"', (out / "report.html").read_text())
    assert tiles[:2] == ["fair", "good"]


def test_what_is_missing_or_of_another_run_is_told(out, drop):
    (out / "acceleration.csv").unlink()
    history = (out / "history.csv").read_text().splitlines()
    (out / "history.csv").write_text("\n".join(history[:len(history) // 3]) + "\n")
    page = made(out)
    assert "acceleration.csv cannot be read" in page and "No curve" in page and "history.csv is of another run" in page and "No curves" in page
    (out / "history.csv").write_text(history[0] + "\nnonsense\n")
    assert "history.csv cannot be read" in made(out)
    with h5py.File(out.parent / "results.h5", "r+") as file:
        file["summary/wall_time"][()] = 1e9
    changed(out, lambda s: s.update(results="results.h5"))
    assert "is damaged or of another run: this page has no pictures of the pad" in made(out)
    (out.parent / "results.h5").unlink()
    assert "results.h5 is not there: this page has no pictures of the pad, no values of the case and no provenance" in made(out)
    changed(out, lambda s: s.update(program="softfall-post 0.9.0"))
    assert "The figures are of softfall-post 0.9.0, this page is of softfall" in made(out)


def test_a_picture_that_cannot_be_made_is_replaced_by_the_reason(out):
    changed(out, lambda s: s.update(results="results.h5"))
    with h5py.File(out.parent / "results.h5", "r+") as file:
        for frame in [*file["frames"].values(), file["peak"]]:
            del frame["von_mises"]
    page = made(out)
    assert "No picture of the pad at: a third of the way" in page and "results.h5 has no frame with displacement and stress there" in page
    with h5py.File(out.parent / "results.h5", "r+") as file:
        del file["provenance"], file["model/cell_ptr"]
    assert made(out).count("not recorded in this file") >= 4


def test_a_summary_that_cannot_be_used_is_an_error_with_a_command(out, tmp_path):
    for spoil, sentence in (((out / "summary.json").unlink, "there is no output of softfall-post in"), (lambda: (out / "summary.json").write_text('{"verdict": {}}'), "is not whole, or of another version"),
                            (lambda: (out / "summary.json").write_text('{"verd'), "is not whole")):
        spoil()
        done = command_here("report", out)
        assert done.returncode == 2 and sentence in done.stderr and f"`softfall-post RESULTS.h5 -o {out}" in done.stderr and not (out / "report.html").exists()
    done = command_here("report", tmp_path / "nothing")
    assert done.returncode == 2 and "is no folder" in done.stderr


def test_a_page_of_somebody_else_is_not_replaced(out):
    (out / "report.html").write_text("mine")
    done = command_here("report", out)
    assert done.returncode == 2 and "is no page of softfall" in done.stderr and (out / "report.html").read_text() == "mine"


def test_a_page_is_made_again_if_the_figures_are_newer(out):
    page = report.current(out)
    first = page.stat().st_mtime_ns
    assert report.current(out).stat().st_mtime_ns == first
    os.utime(page, ns=(first - 10**9, first - 10**9))  # clearly older: the file system's clock has ticks of milliseconds
    os.utime(out / "summary.json", ns=(first - 10**8, first - 10**8))
    assert report.current(out).stat().st_mtime_ns > first
    page.write_text(page.read_text().replace("softfall report ", "softfall report 0", 1))
    first = page.stat().st_mtime_ns
    assert report.current(out).stat().st_mtime_ns > first


@pytest.mark.drawn
def test_runs_and_series_are_compared_on_a_page(drop, case, tmp_path):
    case["missile.velocity"] = "4 m/s"
    slower = case.run()
    program("post", "compare", drop.results, slower.results, "-o", tmp_path / "two", cwd=tmp_path)
    page = made(tmp_path / "two")
    assert page.startswith("Comparison of runs") and all(f"{each.figures['a_max_g']:.4g}" in page for each in (drop, slower)) and "valid with remarks" in page
    changed(tmp_path / "two", lambda told: told["runs"].reverse() or told["runs"][0].update(grade="valid"), "compare.json")
    done = command_here("report", tmp_path / "two")
    assert done.returncode == 2 and "compare.csv and compare.json are of different runs" in done.stderr


def test_layers_interfaces_and_comments_of_a_case_are_read():
    values = report.Parameters('geometry.parameters                { side = 400; name = "a } b"; } -                        given\n'
                               'pad.fixed                          ["base", "side"]       -                        default\n'
                               'material.E                         "0.4136 MPa"           413600 Pa                given\n'
                               'report.sample                      "a \\"b\\""  -  given\nmissile.motion (absent) - default\nbroken\n')
    assert values["pad.fixed"] == ('["base", "side"]', False) and values["material.E"] == ("0.4136 MPa", True) and values["report.sample"] == ('a "b"', True)
    assert values.rows({"pad.fixed": "base", "missile.motion": "motion", "nothing": "x"}) == [("base", "base, side")] and len(values) == 5
    text = ("# EVA pad\ngeometry: {\n# nor this\n};\nmaterial: {\n# from ../foam.cfg:\n# from the supplier's data sheet\n# Foam of 35 kg/m3\nE = \"1 MPa\";\n# informed to 0.8\n};\n"
            "missile: { # nor this\n};\n")
    assert report.comments(text, None) == "from the supplier's data sheet\nFoam of 35 kg/m3\ninformed to 0.8"
    assert report.comments(text + '# --set material=@other.cfg\n#     # Other foam\n#     E = "2 MPa";\n', None) == "Other foam"
    assert report.comments("materials: {\nupper: {\n# the one\n};\nlower: {\n# the other\n};\n};\n", "lower") == "the other" and report.comments("", None) == ""


@pytest.mark.drawn
@pytest.mark.skipif(not shutil.which("chromium"), reason="no chromium")
def test_the_page_prints_on_two_sides_of_a4_and_fits_a_phone(tmp_path):
    from browse import Page
    drop = softfall.example("eva50-axisymmetric").run(runs=tmp_path / "runs")
    page = drop.report()
    assert "section of a body of revolution" in shown(page.parent)
    browser = Page(str(page), width=390, height=800, phone=True)
    try:
        assert browser.value("document.documentElement.scrollWidth") <= 390
        printed = base64.b64decode(browser.call("Page.printToPDF", paperWidth=8.27, paperHeight=11.69, preferCSSPageSize=True)["data"])
        assert len(re.findall(rb"/Type */Page\b", printed)) == 2
    finally:
        browser.close()
