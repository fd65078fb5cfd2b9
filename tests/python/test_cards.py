# SPDX-License-Identifier: GPL-3.0-or-later
"""softfall foam: cards of LS-DYNA, Abaqus and OpenRadioss to foams and back, and foams before any drop."""
import random
import re
import shutil
import subprocess

import numpy as np
import pytest

import softfall
from conftest import BIN, program
from softfall import library
from softfall.cards import export, read_card, write_material
from softfall.foam_command import foams

POINTS = [(0, 0), (0.02, 10), (0.1, 30), (0.3, 45), (0.5, 90), (0.7, 320)]  # strain, kPa


def card10(*fields):
    return "".join(f"{field:>10}" for field in fields)


def curve20(points, scale=1.0):
    return "\n".join(f"{a:20.6g}{scale * b:20.6g}" for a, b in points)


def deck(tmp_path, text, name="deck.k"):
    (tmp_path / name).write_text(text)
    return str(tmp_path / name)


def convert(tmp_path, text, name="deck.k", **more):
    """Returns the foam of a deck as softfall-pre reads it, and the notes."""
    foam = read_card(deck(tmp_path, text, name), **more)
    write_material(foam, tmp_path / "out", "test", force=True)
    return library.Material(str(tmp_path / "out/material.cfg")), "\n".join(foam.notes)


def kpa(data, k=0):
    return [(round(a, 9), round(1e-3 * b, 6)) for a, b in zip(*data.curves[k][1:])]


def mat57(card1=None, card2="", curve=curve20(POINTS, 1e-6), head="*KEYWORD", lcid="         7"):
    card1 = card1 or card10(3, "3.0E-8", "4.0E-4", 7)
    return f"{head}\n$ a comment\n*MAT_LOW_DENSITY_FOAM_TITLE\nfoam, of 3 words\n{card1}\n{card2}\n*DEFINE_CURVE\n{lcid}\n{curve}\n*END\nnothing here"


# ---- LS-DYNA ----

def test_mat57_in_columns_of_10_with_its_defaults(tmp_path):
    data, notes = convert(tmp_path, mat57())
    assert data.values["density"] == 30 and data.values["E"] == 4e5 and kpa(data) == POINTS
    assert data.values["HU"] == 1 and data.values["DAMP"] == 0.05 and data.values["tension_cutoff"] == "none" and data.values["informed_strain"] == 0.7
    for word in ("mm-ms-kg-GPa", "HU is blank: 1 in MAT_057", "informed_strain = 0.7", "DAMP is blank"):
        assert word in notes


def test_fields_that_touch_and_the_second_card_map(tmp_path):
    card1 = card10(3, "3.000E-008", "4.000E-004", 7, "2.000E-004", "1.000E-001", "1.500E-001", "2.000E-001")
    card2 = card10("5.0", "1.0", "1.0", "3.00E-0003", "4.0E+00000", "2.0E-3", "1.0")
    data, notes = convert(tmp_path, mat57(card1, card2))
    assert " " not in card1[20:].strip().replace("         7", "")
    assert data.values["ED"] == pytest.approx(3e6) and data.values["BETA1"] == pytest.approx(4000) and data.values["tension_cutoff"] == pytest.approx(2e5)
    assert data.values["HU"] == 0.1 and data.values["SHAPE"] == 5 and data.values["DAMP"] == 0.2
    for word in ("BETA = 0.15", "FAIL = 1", "BVFLAG = 1", "KCON = 0.002", "REF = 1"):
        assert word in notes


@pytest.mark.parametrize("keyword, head", [("*MAT_057_TITLE +", "*KEYWORD"), ("*MAT_LOW_DENSITY_FOAM_TITLE", "*KEYWORD LONG=Y"), ("*MAT_57_TITLE", "*KEYWORD long=s")])
def test_long_fields_are_20_columns_wide(tmp_path, keyword, head):
    long = "".join(f"{field:>20}" for field in (3, "3.00000001E-8", "4.0E-4", 7, "", "0.25"))
    plain = "*KEYWORD" == head
    text = mat57(long, head=head, lcid=f"{7:>10}" if plain else f"{7:>20}").replace("*MAT_LOW_DENSITY_FOAM_TITLE", keyword)
    data, _ = convert(tmp_path, text)
    assert data.values["density"] == pytest.approx(30.0000001, rel=1e-10) and data.values["HU"] == 0.25 and kpa(data) == POINTS


def test_commas_parameters_and_scales(tmp_path):
    """A parameter of the deck is used in its include, -&name turns the sign; value = SF (x + OFF), and a scale of 0 is 1."""
    (tmp_path / "curves").mkdir()
    (tmp_path / "curves/c.inc").write_text("*DEFINE_CURVE_TITLE\nin percent, kPa\n&lc,0,&sfa,1E-6,-&off,0.0\n" + "\n".join(f"{100 * a + 5},{b}" for a, b in POINTS) + "\n\n")
    text = "*KEYWORD\n*INCLUDE\ncurves/c.inc\n*PARAMETER\n" + card10("I  LC", 7, "R sfa", 0.01, "R  off ", "5.0") + "\nR rho,3E-8\n*MAT_057\n3,&RHO,4.-4,&lc,,.3\n"
    data, notes = convert(tmp_path, text)
    assert kpa(data) == POINTS and data.values["E"] == 4e5 and data.values["HU"] == 0.3 and "strain = 0.01 (a + -5)" in notes


@pytest.mark.parametrize("name, words", [("../c.k", "leads out of the folder"), ("/etc/passwd", "leads out of the folder"), ("link.k", "is or passes a link"), ("none.k", "there is no file"),
                                         ("deck.k", "is read twice"), ("a/../deck.k", "leads out")])
def test_includes_stay_in_the_folder(tmp_path, name, words):
    (tmp_path / "link.k").symlink_to("/etc/passwd")
    with pytest.raises(softfall.InputError, match=rf"deck.k:3: .*{words}"):
        read_card(deck(tmp_path, f"*KEYWORD\n*INCLUDE\n{name}\n" + mat57()))


MAT83 = "*MAT_FU_CHANG_FOAM{kind}\n{card1}\n{card2}\n{rest}\n"
FAST = [(a, 1.5 * b) for a, b in POINTS]


def tables(kind, rates=(0.001, 0.1)):
    curves = [f"*DEFINE_CURVE\n{ident:10}\n{curve20(points, 1e-6)}\n" for ident, points in ((90, POINTS), (8, FAST))]
    if kind == "follow":
        return f"*DEFINE_TABLE\n{5:10}\n" + "".join(f"{rate:20}\n" for rate in rates) + "".join(curves) + "*DEFINE_CURVE\n         1\n0,0\n1,9\n"
    return "".join(curves[::-1]) + f"*DEFINE_TABLE_2D\n{5:10}{1000:10}{1:10}\n" + "".join(f"{rate / 1000 - 1:20}{ident:20}\n" for rate, ident in zip(rates, (90, 8)))


@pytest.mark.parametrize("kind", ["follow", "2d"])
@pytest.mark.parametrize("sign", [1, -1])
def test_mat83_takes_the_curves_of_its_table_by_their_rates(tmp_path, kind, sign):
    text = "*KEYWORD\n" + MAT83.format(kind="", card1=card10(31, "3.0E-8", "4.0E-4", "", "", "", "", 5 * sign), card2="", rest="\n" + card10(*[""] * 7, "6.0")) + tables(kind)
    data, notes = convert(tmp_path, text)
    assert [rate for rate, _, _ in data.curves] == pytest.approx([1, 100]) and kpa(data) == POINTS and kpa(data, 1) == FAST
    assert data.values["HU"] == 1 and data.values["SHAPE"] == 6 and data.values["DAMP"] == 0.05
    for word in ("HU is blank", "0.001, 0.1 are 1, 100 1/s", "SFLAG = 0", "RFLAG = 0"):
        assert word in notes
    assert ("negative" in notes) == (sign < 0)


def test_mat83_with_hysteresis_decay_and_tension(tmp_path):
    both = "".join(f"*DEFINE_CURVE\n{ident:10}\n{curve20([(-0.2, -20 * f), (-0.1, -15 * f), *((a, f * b) for a, b in POINTS)], 1e-6)}\n" for ident, f in ((90, 1), (8, 1.5)))
    text = "*KEYWORD\n" + MAT83.format(kind="_DAMAGE_DECAY", card1=card10(31, "3.0E-8", "4.0E-4", "", "1.0E-4", "1.0", "0.1", 5), card2=card10("", "1.0", "1.0", "1.0", "", "", "", "0.2"),
                                       rest=card10("", "", "4.0", "0.5", "0.6") + "\n" + card10("0.7")) + "*DEFINE_TABLE\n         5\n               0.001\n                 0.1\n" + both
    data, notes = convert(tmp_path, text)
    assert (data.values["HU"], data.values["SHAPE"], data.values["ALPHA"], data.values["DAMP"]) == (0.2, 4, 0.7, 0.1) and kpa(data, 1) == FAST
    for word in ("BETAT = 0.5", "BETAC = 0.6", "TFLAG = 1", "2 points of tension", "SFLAG = 1"):
        assert word in notes


def test_damp_below_0_is_a_curve_and_lcid_may_be_a_table(tmp_path):
    text = mat57(card10(3, "3.0E-8", "4.0E-4", 5, "", "", "", -6)) + ""
    text = text.replace("*END", tables("follow") + "*DEFINE_CURVE\n         6\n0,0.3\n1,0.5\n*END")
    data, notes = convert(tmp_path, text)
    assert len(data.curves) == 2 and data.values["DAMP"] == 0.3 and "DAMP = -6 is the curve 6" in notes and "LCID is a table" in notes


def test_crushable_foam_is_elastic_to_its_yield_stress(tmp_path):
    points = [(0, 20), (0.2, 30), (0.5, 60), (0.7, 200)]
    text = f"*KEYWORD\n*MAT_CRUSHABLE_FOAM\n{card10(3, '3.0E-8', '4.0E-4', '0.1', 7, '1.0E-4')}\n*DEFINE_CURVE\n         7\n{curve20(points, 1e-6)}\n"
    data, notes = convert(tmp_path, text)
    at = 20 / (400 - 50)  # where 400 kPa x meets 20 kPa + 50 kPa x
    assert kpa(data)[1] == pytest.approx((at, 400 * at)) and kpa(data)[2:] == points[1:] and data.values["tension_cutoff"] == pytest.approx(1e5) and "PR = 0.1" in notes


def test_hill_foam_is_a_hyperfoam(tmp_path):
    text = "*KEYWORD\n*MAT_HILL_FOAM\n9,3E-11,1.0,0.5,0.1\n.02,.01\n8.,-2.\n0.5,1.0\n"
    data, notes = convert(tmp_path, text)
    assert data.values["term_1.mu"] == pytest.approx(80e3) and data.values["term_2.mu"] == pytest.approx(-10e3) and data.values["term_2.beta"] == 0.5 and "R = 0.5" in notes


# ---- Abaqus ----

@pytest.mark.parametrize("n", range(1, 7))
def test_hyperfoam_has_mu_and_alpha_in_turn_then_nu_eight_a_line(tmp_path, n):
    terms = [(0.05 / k, 2.0 + k, 0.05 * k) for k in range(1, n + 1)]
    numbers = [x for mu, alpha, _ in terms for x in (mu, alpha)] + [nu for _, _, nu in terms] + [20.0]
    rows = "\n".join(", ".join(map(str, numbers[k:k + 8])) for k in range(0, len(numbers), 8))
    text = f"*Material, name=STEEL\n*Density\n7.85e-9,\n*MATERIAL, NAME=\"pad, B\"\n*Hyper Foam,\n N={n}\n** comment\n{rows}\n*DENSITY\n 5.D-11,\n"
    data, notes = convert(tmp_path, text, "deck.inp")
    for k, (mu, alpha, nu) in enumerate(terms, 1):
        assert (data.values[f"term_{k}.mu"], data.values[f"term_{k}.alpha"], data.values[f"term_{k}.nu"]) == pytest.approx((1e6 * mu, alpha, nu))
    assert data.values["density"] == pytest.approx(50) and data.values["law"] == "hyperfoam" and "nu1" in notes


def test_low_density_foam_with_rates_and_unloading(tmp_path):
    rows = [f"{-1e-3 * f * b:g}, {-a:g}, {rate}" for f, rate in ((1, 0.01), (1.5, 10), (0.25, -0.01)) for a, b in POINTS]
    text = "*MATERIAL, NAME=soft\n*DENSITY\n5e-11\n*LOW DENSITY FOAM, STRAIN RATE=PRINCIPAL, TENSION CUTOFF=0.1\n1e-4, 5e-3, 2\n*UNIAXIAL TEST DATA, DIRECTION=TENSION\n0,0,0\n0.3,1.0,0\n" + \
        "*UNIAXIAL TEST DATA, DIRECTION=COMPRESSION\n" + "\n".join(rows)
    data, notes = convert(tmp_path, text, "deck.inp")
    assert [rate for rate, _, _ in data.curves] == [0.01, 10] and kpa(data) == POINTS and kpa(data, 1) == FAST
    assert data.values["E"] == pytest.approx(3e5) and data.values["tension_cutoff"] == pytest.approx(1e5)
    assert data.values["HU"] + (1 - data.values["HU"]) / (1 + data.values["SHAPE"]) == pytest.approx(0.25, rel=1e-6) and "returns 25 %" in notes


def test_hyperfoam_by_test_data_is_its_curve(tmp_path):
    text = "*MATERIAL, NAME=x\n*HYPERFOAM, N=2, TEST DATA INPUT, POISSON=0.1\n*UNIAXIAL TEST DATA\n" + "\n".join(f"{-1e-3 * b:g}, {-a:g}, 0.01" for a, b in POINTS[::-1]) + \
        "\n0.02, 0.1\n0.05, 0.4\n*DENSITY\n5e-11\n"
    data, notes = convert(tmp_path, text, "deck.inp")
    assert kpa(data) == POINTS and "POISSON = 0.1" in notes and "2 points of tension" in notes and "lateral strain of the test" in notes
    with pytest.raises(softfall.InputError, match="no compression"):
        convert(tmp_path, text.replace("-", "").replace("5e11", "5e-11"), "deck.inp")


# ---- OpenRadioss ----

def row(*fields):
    return "".join(f"{text:>{width}}" for text, width in fields)


def rad(law, begin=("kg", "mm", "ms"), extra="", header=""):
    line = row(*((unit, 20) for unit in begin))
    return f"#RADIOSS STARTER\n/BEGIN\nname\n      2022         0\n{line}\n{row(('g', 20), ('m', 20), ('s', 20))}\n#comment\n{law}\n/FUNCT/12\ntitle, kPa\n{curve20([(-0.1, -5), *POINTS])}\n{extra}/END\nno more"


def law90(hys="0.1", scale="1E-6", rates=("0.001", "0.1"), head="/MAT/LAW90/4"):
    functions = "\n".join(row((12, 10), (rate, 20), (factor, 20)) for rate, factor in zip(rates, (scale, f"{1.5 * float(scale):g}")))
    return f"{head}\na foam\n# a comment\n{'3E-8':>20}\n{row(('4E-4', 20), ('0', 20), (2, 10), (0, 10), (0, 20), ('1E-4', 20))}\n" \
        f"{row((len(rates), 10), (1, 10), ('0.5', 20), ('3.', 20), (hys, 20), ('.6', 20))}\n{functions}"


def test_law90_is_the_law_of_softfall(tmp_path):
    data, notes = convert(tmp_path, rad(law90()), "deck.rad")
    assert (data.values["HU"], data.values["SHAPE"], data.values["ALPHA"], data.values["DAMP"]) == (0.1, 3, 0.6, 0) and data.values["tension_cutoff"] == pytest.approx(1e5)
    assert [rate for rate, _, _ in data.curves] == pytest.approx([1, 100]) and kpa(data) == POINTS and kpa(data, 1) == FAST
    assert data.values["rate_filter_time"] == pytest.approx(1 / (2 * np.pi * 500)) and "1 points of tension" in notes
    assert convert(tmp_path, rad(law90("0")), "deck.rad")[0].values["HU"] == 1


def test_units_of_a_material_override_those_of_the_deck(tmp_path):
    unit = f"/UNIT/9\nunits\n{row(('kg', 20), ('mm', 20), ('ms', 20))}\n"
    data, _ = convert(tmp_path, rad(law90(head="/MAT/LAW90/4/9"), ("kg", "m", "s"), unit), "deck.rad")
    assert data.values["density"] == pytest.approx(30) and data.curves[1][0] == pytest.approx(100)
    with pytest.raises(softfall.InputError, match=r"m-s-kg, declared by the deck, make no foam .*--units=mm-ms-kg-GPa: density 30 kg/m3"):
        convert(tmp_path, rad(law90(), ("kg", "m", "s")), "deck.rad")


def test_smooth_functions_and_tables_of_functions(tmp_path):
    smooth = f"/FUNCT_SMOOTH/13\nt\n{row((0.01, 20), (0, 20), (-0.05, 20), (0, 20))}\n{curve20([(100 * a + 5, b) for a, b in POINTS])}\n"
    data, _ = convert(tmp_path, rad(law90(rates=("0",)).replace("        12   ", "        13   "), extra=smooth), "deck.rad")
    assert kpa(data) == POINTS
    table = f"/TABLE/1/15\nt\n         2\n{row((12, 10), ('', 10), (0.001, 20), ('', 40), (1, 20))}\n{row((12, 10), ('', 10), (0.1, 20), ('', 40), (1.5, 20))}\n"
    data, _ = convert(tmp_path, rad(law90(rates=("0",)).replace("        12   ", "        15   "), extra=table), "deck.rad")
    assert [rate for rate, _, _ in data.curves] == pytest.approx([1, 100]) and kpa(data, 1) == FAST


def test_law62_is_a_hyperfoam(tmp_path):
    law = f"/MAT/LAW62/4\na foam\n{'3E-8':>20}\n{row(('0.2', 20), (6, 10), (1, 10), (0, 20), (0, 10), (2, 10))}\n" + \
        "\n".join(curve for values in ([6e-5, 5e-5, 4e-5, 3e-5, 2e-5, 1e-5], [8, 7, 6, 5, 4, 3], [0.5], [2.0], [0, 0.1, 0, 0, 0, 0]) for curve in
                  (row(*((value, 20) for value in values[k:k + 5])) for k in range(0, len(values), 5)))
    data, notes = convert(tmp_path, rad(law), "deck.rad")
    assert data.values["term_6.mu"] == pytest.approx(10e3) and data.values["term_1.nu"] == 0 and data.values["term_2.nu"] == 0.1 and "gamma = 0.5" in notes and "= 2 of them" in notes


# ---- units, warnings and refusals ----

@pytest.mark.parametrize("name, density, modulus", [("mm-ms-kg-GPa", 30, 4e5), ("mm-s-t-MPa", 3e4, None), ("kg-mm-ms", 30, 4e5), ("GPa-mm-ms", 30, 4e5), ("mm-ms-kN", 30, 4e5)])
def test_units_are_given_in_any_order(tmp_path, name, density, modulus):
    if modulus is None:
        with pytest.raises(softfall.InputError, match=r"deck.k:3: units mm-s-t-MPa, as given, make no foam of the card: density 3e\+04 kg/m3"):
            convert(tmp_path, mat57(), given=name)
    else:
        data, _ = convert(tmp_path, mat57(), given=name)
        assert (data.values["density"], data.values["E"]) == pytest.approx((density, modulus))


def test_units_that_are_not_known_are_asked_for_with_candidates(tmp_path):
    for rho, stress, word in (("3.0E-3", 1e-6, "not known"), ("1.0E-5", 7e-3, "ambiguous")):
        with pytest.raises(softfall.InputError, match=f"deck.k:3: the units of the card are {word}; give them by --units. Candidates: --units=.*density"):
            read_card(deck(tmp_path, mat57(card10(3, rho, "4.0E-4", 7), curve=curve20(POINTS, stress))))
    for name in ("mm-kg", "mm-ms-kg-MPa", "mm-parsec-kg", ""):
        with pytest.raises(softfall.InputError, match="units"):
            read_card(deck(tmp_path, mat57()), given=name)


@pytest.mark.parametrize("points, words", [
    ([*POINTS, (0.7, 400), (0.65, 300), (0.72, 500)], r"the strain repeats or falls at 0.7 \(400 kPa\): 2 such points are left out"), ([*POINTS[:4], (0.4, 40), *POINTS[4:]], "its stress falls by 5 kPa at a strain of 0.4"),
    ([*POINTS, (0.75, 100)], "it is cut there"), ([*POINTS, (0.75, 320), (0.8, 320)], "it is level from a strain of 0.7"), ([(0, 0), (0.5, 90), (0.7, 320)], "fewer than 4"), ([*POINTS, (1.0, 5000)], "a compression to nothing is meant by the strain 1 "),
    (POINTS[1:], r"\(0, 0\) is put before it"), ([(0, 5), *POINTS[1:]], "is taken for 0")])
def test_curves_are_mended_and_it_is_told(tmp_path, points, words):
    data, notes = convert(tmp_path, mat57(curve=curve20(points, 1e-6)))
    assert re.search(words, notes) and len(data.curves[0][1]) >= 4 and data.compress(np.array([0, 0.1]), np.array([0, 0.5]))[1] == pytest.approx(90e3, rel=1e-6)


def test_a_curve_with_its_unloading_is_refused(tmp_path):
    with pytest.raises(softfall.InputError, match="deck.k:7: the strain falls at 0.5, and 5 of 11 points do not lie above all before them"):
        convert(tmp_path, mat57(curve=curve20(POINTS + [(a, 0.3 * b) for a, b in POINTS[-2::-1]], 1e-6)))


def test_crossing_curves_are_lifted_and_exchanged_ones_refused(tmp_path):
    text = "*KEYWORD\n" + MAT83.format(kind="", card1=card10(31, "3.0E-8", "4.0E-4", "", "", "", "", 5), card2="", rest="") + tables("follow")
    crossing = text.replace(curve20(FAST, 1e-6), curve20([(0, 0), (0.02, 15), (0.1, 40), (0.3, 40), (0.5, 100), (0.7, 330)], 1e-6))
    data, notes = convert(tmp_path, crossing)
    assert "it crosses that of 1 1/s" in notes and all(np.interp(0.3, *data.curves[k][1:]) == pytest.approx(45e3) for k in (0, 1))
    with pytest.raises(softfall.InputError, match="are the rates or the curves exchanged"):
        convert(tmp_path, text.replace(curve20(FAST, 1e-6), curve20([(a, 0.3 * b) for a, b in POINTS], 1e-6)))


def test_several_foams_are_listed_and_chosen(tmp_path):
    text = mat57().replace("*END", mat57(card10(8, "5.0E-8", "4.0E-4", 7)).replace("*DEFINE_CURVE\n", "*DEFINE_CURVE\n        99\n*DEFINE_CURVE\n").partition("*DEFINE")[0] + "*END")
    with pytest.raises(softfall.InputError, match=r"2 foams are in it: 3 \(foam, of 3 words\), \*MAT_LOW_DENSITY_FOAM at .*deck.k:3; 8 .*--material='3'"):
        read_card(deck(tmp_path, text))
    assert read_card(deck(tmp_path, text), "8").density == pytest.approx(50)
    with pytest.raises(softfall.InputError, match="there is no foam 'x' in it"):
        read_card(deck(tmp_path, text), "x")


@pytest.mark.parametrize("text, name, words", [
    ("*KEYWORD\n*MAT_ELASTIC\n1,2,3\n", "d.k", "there is no foam that softfall reads"), ("*KEYWORD\n*MAT_SIMPLIFIED_RUBBER/FOAM\n1\n", "d.k", r"only \*MAT_SIMPLIFIED_RUBBER/FOAM at .*:2"),
    ("*KEYWORD\n*MAT_083\n1,4E-8,1\n\n1,2\n", "d.k", r"d.k:2: \*MAT_083 is read with a table"), ("*KEYWORD\n*MAT_057\n1,4E-8,1,44\n", "d.k", "LCID = 44: the deck has no"),
    ("*KEYWORD\n*PARAMETER_EXPRESSION\nR rho     1+2\n*MAT_057\n1,&rho,1,44\n", "d.k", "d.k:5: the parameter rho of RO is an expression"), ("", "d.k", "no foam"), ("\0\xff", "d.txt", "there is no material of LS-DYNA"),
    ("*Material\n*Hyperfoam\n0,2,0\n*Density\n1", "d.inp", "no term with a modulus"), ("*Material\n*Hyperfoam, N=3\n1,2,3\n*Density\n1", "d.inp", "d.inp:2: .*needs 9 coefficients"), ("*Material\n*Hyperfoam, N=7\n", "d.inp", "1 to 6 terms|no \\*DENSITY"),
    ("/MAT/LAW36/1\n", "d.rad", "only /MAT/LAW36/1"), ("/MAT/LAW90/1\nt\n1\n1\n         3\n", "d.rad", "its lines end before")])
def test_what_is_not_read_is_refused_in_one_sentence_with_its_place(tmp_path, text, name, words):
    with pytest.raises(softfall.InputError, match=words) as told:
        read_card(deck(tmp_path, text, name))
    assert "\n" not in str(told.value)


def test_garbage_never_leaves_a_traceback(tmp_path):
    """Mutations of cards of each format give a foam, or one sentence."""
    cards = [("d.k", mat57()), ("d.k", "*KEYWORD\n" + MAT83.format(kind="", card1="31,3E-8,4E-4,,,,,5", card2="", rest="") + tables("2d")),
             ("d.inp", "*MATERIAL, NAME=x\n*DENSITY\n5e-11\n*HYPERFOAM, N=2\n.05, 4, .01, -2, .1, .2\n"), ("d.rad", rad(law90()))]
    dice, found = random.Random(7), 0
    for _ in range(400):
        name, text = dice.choice(cards)
        for _ in range(dice.choice((1, 1, 2, 6))):
            at, more = dice.randrange(len(text)), dice.choice(("", "\n", ",", "1e99", "-1", "&x", "*", "/", "$", "\0", "nan", "9" * 50, "*END\n", text[:40], "\n\n", "0"))
            text = text[:at] + more + text[at + dice.choice((0, 1, 1, 10, 60)):]
        try:
            convert(tmp_path, text, name)
            found += 1
        except softfall.Error as error:
            assert "\n" not in str(error) and len(str(error)) < 2000
    assert 20 < found < 380


# ---- export ----

def same(a, b, keys):
    assert all(f"{a.values[key]:.6g}" == f"{b.values[key]:.6g}" for key in keys)
    assert len(a.curves) == len(b.curves)
    for one, other in zip(a.curves, b.curves):
        assert one[0] == pytest.approx(other[0], rel=5e-7) and np.allclose(one[1], other[1], rtol=5e-7, atol=0) and np.allclose(one[2], other[2], rtol=5e-7, atol=0)


SOURCE = 'law = "low_density_foam"; density = "43.21 kg/m3"; E = "0.31234567 MPa"; HU = 0.123456789; SHAPE = 3.456789; {more}\n'


@pytest.mark.parametrize("units", ["mm-ms-kg-GPa", "mm-s-t-MPa", "in-s-slinch-psi"])
@pytest.mark.parametrize("kind, suffix, more, keys", [
    ("dyna", "k", 'DAMP = 0.234567; ED = "1.234567 MPa"; BETA1 = "4321 1/s"; tension_cutoff = "87.65432 kPa"; curve = "a.csv";', "E HU SHAPE DAMP ED BETA1 tension_cutoff"),
    ("dyna", "k", 'ALPHA = 0.654321; curves = ( { rate = "0.0123456 1/s"; file = "a.csv"; }, { rate = "98.7654 1/s"; file = "b.csv"; } );', "E HU SHAPE ALPHA DAMP"),
    ("radioss", "rad", 'ALPHA = 0.654321; tension_cutoff = "87.65432 kPa"; curve = "a.csv";', "E HU SHAPE ALPHA tension_cutoff"),
    ("radioss", "rad", 'rate_filter_time = "0.3456789 ms"; curves = ( { rate = "0.0123456 1/s"; file = "a.csv"; }, { rate = "98.7654 1/s"; file = "b.csv"; } );', "E HU SHAPE rate_filter_time"),
    ("abaqus", "inp", 'tension_cutoff = "87.65432 kPa"; curves = ( { rate = "0.0123456 1/s"; file = "a.csv"; }, { rate = "98.7654 1/s"; file = "b.csv"; } );', "E tension_cutoff")])
def test_cards_come_back_to_six_digits(tmp_path, kind, suffix, more, keys, units):
    for name, factor in (("a", 1), ("b", 1.6)):
        (tmp_path / f"{name}.csv").write_text("strain,stress_kPa\n" + "\n".join(f"{a * 1.0123456},{factor * b * 1.0234567}" for a, b in POINTS))
    (tmp_path / "foam.cfg").write_text(SOURCE.format(more=more))
    text, told = export(str(tmp_path / "foam.cfg"), kind, units)
    back, _ = convert(tmp_path, text, f"back.{suffix}", given=units)
    same(library.Material(str(tmp_path / "foam.cfg")), back, ["density", *keys.split()])
    assert any("densification" in line for line in told) and ("HU" in keys or any(line.startswith("HU") for line in told))


@pytest.mark.parametrize("kind, suffix", [("abaqus", "inp"), ("radioss", "rad"), ("dyna", "k")])
def test_hyperfoams_come_back_to_six_digits(tmp_path, kind, suffix):
    terms = [(50.12345 / k, 8.765432 - 2.3 * k, 0.1234567 if kind == "dyna" else 0.0234567 * k) for k in range(1, 7)]
    (tmp_path / "foam.cfg").write_text('law = "hyperfoam"; density = "43.21 kg/m3";\n' + "\n".join(
        f'term_{k} = {{ mu = "{mu} kPa"; alpha = {alpha}; nu = {nu}; }};' for k, (mu, alpha, nu) in enumerate(terms, 1)))
    back, _ = convert(tmp_path, export(str(tmp_path / "foam.cfg"), kind, "mm-ms-kg-GPa")[0], f"back.{suffix}", given="mm-ms-kg-GPa")
    for k, (mu, alpha, nu) in enumerate(terms, 1):
        found = back.values[f"term_{k}.beta"]
        assert (back.values[f"term_{k}.mu"], back.values[f"term_{k}.alpha"], back.values[f"term_{k}.nu"] or found / (1 + 2 * found)) == pytest.approx((1e3 * mu, alpha, nu), rel=5e-7)


def test_a_rate_factor_becomes_curves_of_the_same_law(tmp_path):
    """eva35_all has a rate factor and no Maxwell branch: LAW90 says all of its loading and unloading."""
    source = str(foams()["eva35_all"])
    text, told = export(source, "radioss", "mm-s-t-MPa")
    back, _ = convert(tmp_path, text, "back.rad", given="mm-s-t-MPa")
    strain = np.concatenate((np.linspace(0, 0.7, 200), np.linspace(0.7, 0, 200)[1:]))
    stress = [data.compress(np.arange(399) * 1e-4, strain) for data in (library.Material(source), back)]
    assert np.allclose(*stress, atol=1e-9 * stress[0].max()) and any("becomes 7 curves" in line for line in told)


# ---- the command, and drops ----

def command(*words):
    told = subprocess.run([str(BIN / "softfall"), "foam", *map(str, words)], capture_output=True, text=True)
    assert "Traceback" not in told.stderr
    return told.returncode, told.stdout, told.stderr


def test_a_plate_of_a_converted_foam_is_built_and_dropped_on(tmp_path):
    for name, text in (("deck.k", mat57(card10(3, "3.0E-8", "4.0E-4", 7, "", "0.1"))), ("deck.rad", rad(law90()))):
        code, out, err = command("convert", deck(tmp_path, text, name), "-o", tmp_path / name[-3:].strip("."))
        assert (code, err) == (0, "") and "KCON" not in out and "Written" in out and "units mm-ms-kg" in out
        program("pre", "pad/case.cfg", "-o", tmp_path / "model.h5", "--force", "--set", f"material=@{tmp_path / name[-3:].strip('.')}/material.cfg", "--set", 'missile.velocity="2 m/s"', cwd=".")
        said = program("solve", tmp_path / "model.h5", "-o", tmp_path / "results.h5", "--force", cwd=".")
        assert "largest specific force" in said


def test_files_that_are_there_are_kept(tmp_path):
    path, out = deck(tmp_path, mat57()), tmp_path / "foam.cfg"
    assert command("convert", path, "-o", out)[0] == 0 and out.exists() and (tmp_path / "foam.csv").exists()
    code, _, err = command("convert", path, "-o", out)
    assert code == 2 and err.startswith("softfall foam: ") and "--force" in err and err.count("\n") == 1
    assert command("convert", path, "-o", out, "--force")[0] == 0
    assert command("convert", path)[0] == 2 and command("convert", tmp_path / "none.k", "-o", out)[0] == 2 and command("frobnicate")[0] == 64


@pytest.mark.drawn
def test_foams_are_listed_shown_and_drawn(tmp_path):
    code, out, _ = command("list")
    assert code == 0 and all(name in out for name in foams()) and "Landauer" in out
    code, out, _ = command("show", "leap", "--rates=1")
    assert code == 0 and "ASICS FF LEAP" in out and float(re.search(r"returned\s+([\d.]+)%", out)[1]) == pytest.approx(70.2, abs=0.3)
    for name in ("zorbium", foams()["vn600_slow"]):
        assert command("plot", name, "-o", tmp_path / "a.png", "--force")[0] == 0 and (tmp_path / "a.png").read_bytes()[:4] == b"\x89PNG"
    assert command("show", "leep")[2].startswith('softfall foam: there is no foam "leep" (did you mean "leap"?)')
    code, out, _ = command("export", "leap", "--format=radioss", "--units=mm-ms-kg-GPa", "-o", tmp_path / "leap.rad")
    assert code == 0 and "informed_strain = 0.6 is not in the card" in out and "/MAT/LAW90/1" in (tmp_path / "leap.rad").read_text()
    shutil.rmtree(tmp_path)
