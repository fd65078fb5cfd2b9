# SPDX-License-Identifier: GPL-3.0-or-later
"""Files of laboratories: what is read of them, as which values, what is refused with its name, and that every remedy works."""
import gzip
import os
import re
import shlex
import subprocess

import numpy as np
import pytest

import softfall
from softfall import laboratory
from conftest import BIN
from test_command import says

TIME = np.linspace(0, 0.05, 61)  # s, at 1.2 kHz
ACCELERATION = 80 * np.sin(np.pi * np.clip((TIME - 0.01) / 0.02, 0, 1))  # g
STRAIN = np.linspace(0.01, 0.6, 60)
STRESS = 20 * STRAIN + 100 * STRAIN**4  # kPa
GAP = 50 * (1 - STRAIN)  # mm
FORCE = 2.5 * STRESS  # N, over 50 x 50 mm


def table(heading, *columns, separator=",", form="{:.9g}", footer=""):
    rows = (separator.join(value if isinstance(value, str) else form.format(value) for value in row) for row in zip(*columns))
    return heading + "\n" + "\n".join(rows) + "\n" + footer


@pytest.fixture
def read(tmp_path):
    def read_text(text, name="lab.csv", **options):
        (tmp_path / name).write_bytes(text if isinstance(text, bytes) else text.encode())
        return laboratory.read(tmp_path / name, **options)
    return read_text


def is_record(reading, time=TIME, value=ACCELERATION, most=1e-6):
    assert reading.kind == "acceleration" and list(reading.frame) == ["time_s", "acceleration_g"]
    assert np.allclose(reading.frame["time_s"], time, atol=1e-6) and np.allclose(reading.frame["acceleration_g"], value, atol=most * 80)


def is_curve(reading):
    assert reading.kind == "compression" and list(reading.frame)[:2] == ["strain", "stress_kPa"]
    assert np.allclose(reading.frame["strain"], STRAIN, rtol=1e-7) and np.allclose(reading.frame["stress_kPa"], STRESS, rtol=1e-7)
    assert "nominal stress over nominal strain in compression, columns " in reading.words


def clock(step=1e-6):
    return [f"2024-02-01 23:59:59.{int(round(t / step)):0{round(-np.log10(step))}d}" if t < 1 else "" for t in TIME]


# ---- records ----

@pytest.mark.parametrize("heading, time, value, told", [
    ("Time (Sec),Acceleration (g's)", 1, 1, "time in Sec, acceleration in g's"),
    ("Time (mSec),Accel (ms-2)", 1e3, 9.80665, "acceleration in ms-2"),
    ("timestamp_us,acc_g", 1e6, 1, "time in us"),
    ("t / ms,a/(m/s2)", 1e3, 9.80665, "acceleration in m/s2"),
    ("Time in ms,Deceleration [m/s²]", 1e3, 9.80665, "m/s²"),
    ("Zeit [µs],Verzögerung [km/s²]", 1e6, 9.80665e-3, "time in µs"),
    ("Time (ms),CH1 (g)", 1e3, 1, 'acceleration in g ("CH1 (g)")'),
    ("Time,Acceleration\n[ms],[g]", 1e3, 1, "time in ms"),
    ("# time (ms), acc (ft/s2)", 1e3, 9.80665 / 0.3048, "acceleration in ft/s2"),
    ("Time (ms),Drop weight acceleration (g)", 1e3, 1, "acceleration in g"),
    ("Time (ms),Acc (mg)", 1e3, 1e3, "acceleration in mg"),
])
def test_headings_of_records_are_read(read, heading, time, value, told):
    reading = read(table(heading, time * TIME, value * ACCELERATION))
    is_record(reading)
    assert told in reading.words


def test_a_slice_export_is_read_with_its_units_and_its_rate(read):
    """22 rows above the data, a unit in a row of its own, and a time without one, whose unit follows from the rate."""
    head = "\ufeff" + "\n".join([
        "Headers,,,", "Test Date,01/02/2024,01/02/2024,", "Test Time,10:00:00,10:00:00,", "Test Description,mat drop,mat drop,", "Sample Rate (Hz),1200,1200,",
        "Hardware AA Filter (-3dB),4000,4000,", "ISO Channel Code,D0HEADCG0000AVZC,D0HEADCG0000ACZA,", "Channel Description,Head CG AV Z,Head CG AC Z,",
        "Software Filter (SAE Class),NONE,NONE,", "Engineering Unit,deg/sec ,g ,", "User Comment,,,", "Data Zero (CNTS),58,10,", "Scale Factor (EU/CNT),0.39,0.0181,",
        "Data Starts Here,,,", "Time,Chan 0:S1-AV1,Chan 3:S1-AC1,"])
    reading = read(table(head, TIME, 0 * TIME, ACCELERATION, form="{:.6f}"))
    is_record(reading, most=1e-5)
    assert "time in s, which agrees with the rate of 1200 Hz" in reading.words and "heading in line 15, units in line 10" in reading.words
    axes = read(table(head.replace("deg/sec", "g"), TIME, 0 * TIME, ACCELERATION, form="{:.6f}"))
    assert axes.axes == ["Chan 0:S1-AV1", "Chan 3:S1-AC1"] and list(axes.frame) == ["time_s", "Chan 0:S1-AV1 (g)", "Chan 3:S1-AC1 (g)"]
    is_record(read(table(head.replace("deg/sec", "g"), TIME, 0 * TIME, ACCELERATION, form="{:.6f}"), column="Chan 3:S1-AC1"), most=1e-5)


@pytest.mark.parametrize("heading, unit, told", [
    ("# scale: 0.0122 g/count\nTime (ms),Acc (counts)", 0.0122, "0.0122 g/count"),
    ("Scale factor,0.0122 g/LSB\nTime (ms),Acc (counts)", 0.0122, "0.0122 g/count"),
    ("Time (ms),Acc (0.0122 g/count)", 0.0122, "0.0122 g/count"),
    ("Engineering Unit,g\nScale Factor (EU/CNT),0.0122\nTime (ms),Acc (counts)", 0.0122, "0.0122 g/count"),
])
def test_counts_take_the_scale_that_the_file_states(read, heading, unit, told):
    reading = read(table(heading, 1e3 * TIME, np.round(ACCELERATION / unit)))
    is_record(reading, most=1e-4)
    assert told in reading.words


@pytest.mark.parametrize("text, options", [
    (table("Time (ms),Acc (counts)", 1e3 * TIME, ACCELERATION / 0.01), {"scale": "0.01 g/count"}),
    (table("Time (ms),ADC", 1e3 * TIME, ACCELERATION / 0.01), {"scale": "0.01 g/LSB"}),
    (table("Time (ms),CH1 (mV)", 1e3 * TIME, 10 * ACCELERATION), {"scale": "10 mV/g"}),
    (table("Time (ms),Signal (V)", 1e3 * TIME, 0.01 * ACCELERATION), {"scale": "100 g/V"}),
    (table("Sample;CH1 (mV)", np.arange(61), 10 * ACCELERATION, separator=";"), {"scale": "10 mV/g", "rate": "1.2 kHz"}),
    (table("Sampling interval: 833.3333333 us\nSample,Acc (g)", np.arange(61), ACCELERATION), {}),
    (table("Abtastrate;1,2 kHz\nMesswert;Beschleunigung (g)", np.arange(61), ACCELERATION, separator=";"), {}),
    ("\n".join(f"{value:.9g}" for value in ACCELERATION), {"rate": "1200 Hz", "heading": "a (g)"}),
    (table("1;2;3", 1e3 * TIME, ACCELERATION, 0 * TIME, separator=";").partition("\n")[2], {"heading": "Time (ms);Acc (g);x"}),
    (table("Time,Acc", 1e3 * TIME, ACCELERATION), {"units": "ms,g"}),
    (table("Date,Acc (g)", clock(), ACCELERATION), {}),
    (table("Date,Time,Acc (g)", [c[:10] for c in clock()], [c[11:] for c in clock()], ACCELERATION), {}),
    (table("Timestamp,Acc (g)", [c[:19] for c in clock()], ACCELERATION), {"rate": "1.2 kHz"}),
    (table("Sample rate (Hz),1200\nTimestamp,Acc (g)", [c[:19] for c in clock()], ACCELERATION), {}),
    (table("Time (s),Time (ms),Acc (g)", TIME, 1e3 * TIME, ACCELERATION), {}),
    (table("Time (s),Relative time (s),Acc (g)", 100 + TIME, TIME, ACCELERATION), {}),
    (table("Time (s),Acc X (g),Time (s),Acc Y (g)", 5 + TIME, 0 * TIME, TIME, ACCELERATION), {"column": "Acc Y (g)"}),
    (table("Time (s),Acc (g),Time (s),Acc (g)", 5 + TIME, 0 * TIME, TIME, ACCELERATION), {"specimen": "2"}),
    (table("Time (ms),Mass (g),Acc (m/s2)", 1e3 * TIME, 0 * TIME + 500, 9.80665 * ACCELERATION), {}),
    (table("Time (ms),Acc (g)", 1e3 * TIME, -ACCELERATION), {"invert": "acceleration"}),
    (table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION, footer="\nMax,80\nHIC,300\n"), {}),
    (table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION, footer="---,---\nMean,12,\n"), {}),
    (table("Zeit [ms];a [m/s²]", 1e3 * TIME, 9.80665 * ACCELERATION, separator=";").replace(".", ",").encode("utf-16"), {}),
    (table("Zeit [ms];a [m/s²]", 1e3 * TIME, 9.80665 * ACCELERATION, separator=";").replace(".", ",").encode("latin-1"), {}),
    (gzip.compress(table("Time (ms)\tAcc (g)", 1e3 * TIME, ACCELERATION, separator="\t").encode()), {}),
])
def test_forms_of_a_record_are_one_record(read, text, options):
    reading = read(text, **options)
    is_record(reading, reading.frame["time_s"], most=1e-4)
    assert np.allclose(np.diff(reading.frame["time_s"]), 1 / 1200, atol=2e-6)


def test_times_that_a_spreadsheet_rounded_are_even_again(read):
    time = np.arange(1001) / 20e3
    value = np.interp(time, TIME, ACCELERATION)
    reading = read(table("Time (ms),Acc (g)", [f"{1e3 * t:.1f}" for t in time], value))
    is_record(reading, time, value)
    assert "even times at 20 kHz, as those in the file are rounded to 0.0001 s" in reading.words


def test_a_rate_that_the_times_contradict_is_refused_and_the_remedies_work(read):
    """20 kHz for a record whose times are 0.1 ms apart halved its HIC."""
    text = table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION)
    with pytest.raises(softfall.InputError, match='its times are those of 1.2 kHz, not of 20 kHz as given: leave rate="20 kHz" out, or give rate="1.2 kHz"'):
        read(text, rate="20 kHz")
    is_record(read(text, rate="1.2 kHz"))
    stated = "Sample rate,20000,Hz\n" + text
    with pytest.raises(softfall.InputError, match='line 1 states 20 kHz, but the times are those of 1.2 kHz.* give rate="1.2 kHz"'):
        read(stated)
    is_record(read(stated, rate="1.2 kHz"))
    rounded = table("Time (s),Acc (g)", [f"{t:.1f}" for t in TIME], ACCELERATION)
    with pytest.raises(softfall.InputError, match='too coarse for the samples: give the rate of the logger, such as rate='):
        read(rounded)
    is_record(read(rounded, rate="1.2 kHz"))


# ---- curves ----

@pytest.mark.parametrize("heading, strain, stress", [
    ("Strain (in/in),Stress (psi)", 1, 1 / 6.894757293168), ("Compression (%),Stress (kPa)", 100, 1), ("Deflection (%),Pressure (kPa)", 100, 1),
    ("Strain (µm/m),Stress (kPa)", 1e6, 1), ("Strain (µε),Stress (MPa)", 1e6, 1e-3), ("Strain (microstrain),Stress (kPa)", 1e6, 1), ("Axial strain (%),Stress (kPa)", 100, 1),
    ("Compressive strain [%],Compressive stress [kPa]", 100, 1), ("Engineering strain (-),Engineering stress (N/mm²)", 1, 1e-3),
    ("Stauchung in %,Druckspannung in kPa", 100, 1), ("strain,stress_kPa", 1, 1), ("strain_percent,stress_MPa", 100, 1e-3), ("strain_1,stress_kPa", 1, 1),
    ("Compressive strain,Compressive stress\n%,kPa", 100, 1), ("Engineering strain [1],Engineering stress (kPa)", 1, 1),
    ("Strain (%),Quasi-static stress (kPa)", 100, 1), ("Compressive strain (Displacement),Compressive stress\n(%),(MPa)", 100, 1e-3),
    ("Déformation (%),Contrainte (kPa)", 100, 1),
])
def test_headings_of_curves_are_read(read, heading, strain, stress):
    reading = read(table(heading, strain * STRAIN, stress * STRESS, form="{:.12g}"))
    is_curve(reading)
    assert "columns 1 and 2" in reading.words


@pytest.mark.parametrize("heading, what", [
    ("Yield stress (MPa),Plastic strain (-)", "a plastic"), ("Yield stress (MPa),Plastic strain (-)", "a yield stress"), ("Strain (%),Flow stress (MPa)", "a yield stress"),
    ("Volumetric strain,Pressure (MPa)", "a volumetric strain"), ("Volumetric compression (-),Pressure (kPa)", "a volumetric strain"),
    ("True strain (-),True stress (MPa)", r"nominal one is 1 - exp\(-true strain\)"), ("True strain (-),True stress (MPa)", "present area / first area"),
    ("Log strain (1),Stress (kPa)", "a true"), ("Hencky strain (1),Cauchy stress (kPa)", "a true"), ("Strain (1),Cauchy stress (kPa)", "a true stress"),
    ("Tensile strain (%),Tensile stress (MPa)", "a tensile strain"), ("Elongation (%),Stress (kPa)", "a tensile strain"), ("Strain (%),Tension (kPa)", "a tensile stress"),
    ("Shear strain (-),Shear stress (kPa)", "a shear strain"), ("Strain (%),Shear stress (kPa)", "a shear stress"), ("Lateral strain (%),Stress (kPa)", "a lateral strain"),
    ("Strain (%),Energy (kJ/m3)", "an energy"), ("Strain (%),Energy absorbed (MJ/m3)", "an energy"), ("Strain (%),Work (J)", "an energy"),
    ("Strain rate (1/s),Stress (MPa)", "a strain rate"), ("mu (-),Pressure (GPa)", "mu = density / first density - 1"), ("μ = ρ/ρ0 − 1,P (MPa)", "mu = density"),
    ("rho/rho0-1 (-),Pressure (MPa)", "mu = density"), ("Stretch (-),Stress (kPa)", "nominal strain = 1 - stretch"), ("Strain (%),Tangent modulus (MPa)", "a modulus"),
    ("Strain (%),von Mises stress (MPa)", "another measure"), ("Green-Lagrange strain (-),PK2 stress (MPa)", "another measure"), ("Strain (%),Hydrostatic pressure (kPa)", "a hydrostatic"),
    ("Strain (%),Stress SD (kPa)", "a scatter"), ("Compression set (%),Stress (kPa)", "a plastic"), ("Querdehnung (%),Spannung (kPa)", "a lateral strain"),
    ("eps_p (-),sigma_y (MPa)", "a plastic"), ("strain,sigma_y (MPa)", "a yield stress"), ("ε_p,σ_y", "a yield stress"), ("PEEQ (-),Stress (MPa)", "a plastic"),
    ("LE22 (-),Stress (MPa)", "a true"), ("Strain (-),S22 (MPa)", "a true stress"), ("eps_v (-),p (MPa)", "a volumetric strain"),
    ("Extension (mm),Tensile force (N)", "a tensile force"), ("Elongation (mm),Force (N)", "a tensile displacement"), ("Velocity (m/s),Acceleration (g)", "has no column of time"),
    ("Plastische Dehnung (-),Fließspannung (MPa)", "a yield stress"), ("Wahre Dehnung (1),Spannung (kPa)", "a true"), ("Dehnung (%),Schubspannung (kPa)", "a shear stress"),
])
def test_another_quantity_is_refused_with_its_name(read, heading, what):
    with pytest.raises(softfall.InputError, match=f'lab.csv:1: .*" is {what}|{what}.*" is |{what}'):
        read(table(heading, STRAIN, STRESS))


@pytest.mark.parametrize("title", ["True stress - true strain curve", "# yield stress, plastic strain", "*PLASTIC, Yield stress"])
def test_a_title_of_another_curve_is_refused(read, title):
    text = table("Strain (-),Stress (MPa)", STRAIN, STRESS / 1e3)
    with pytest.raises(softfall.InputError, match="lab.csv:1: .* stands above the table, and .* is no nominal stress or strain.*: .* leave that line out"):
        read(f"{title}\n{text}")
    is_curve(read(text))
    is_curve(read(f"Test report\nYield stress: 12 kPa\n\n{text}"))


def test_the_nominal_pair_is_taken_beside_the_true_one(read):
    reading = read(table("True strain (%),Engineering strain (%),True stress (kPa),Engineering stress (kPa)", STRAIN, 100 * STRAIN, STRESS / 2, STRESS))
    is_curve(reading)
    assert "columns 2 and 4" in reading.words


@pytest.mark.parametrize("heading, columns, options, told", [
    ("Displacement (mm),Force (N)", (50 * STRAIN, FORCE), {"side": "50 mm", "thickness": "50 mm"}, "over 2500 mm2 and 50 mm"),
    ("Deflection (in),Load (lb)", (50 * STRAIN / 25.4, FORCE / 4.4482216152605), {"area": "25 cm2", "thickness": "50 mm"}, "force in lb"),
    ("Strain (%),Force (N)", (100 * STRAIN, FORCE), {"area": "25 cm2"}, "over 2500 mm2"),
    ("Deflection (%),Load (lbf)", (100 * STRAIN, FORCE / 4.4482216152605), {"side": "25 mm", "width": "100 mm"}, "force in lbf"),
    ("Extension (mm),Compressive stress (kPa)", (50 * STRAIN, STRESS), {"thickness": "5 cm"}, "over 50 mm"),
    ("Strain (%),Stress (kPa)", (-100 * STRAIN, -STRESS), {"invert": "both"}, "strain inverted as asked for"),
    ("Strain 1 (%),Strain 2 (%),Stress (kPa)", (100 * STRAIN, 30 * STRAIN, STRESS), {"column": "Strain 1 (%)"}, "columns 1 and 3"),
    ("Strain 1 (%),Strain 2 (%),Stress (kPa)", (30 * STRAIN, 100 * STRAIN, STRESS), {"specimen": "2"}, "columns 2 and 3"),
    ("Load signal (mV),Strain (%)", (FORCE / 100, 100 * STRAIN), {"scale": "100 N/mV", "area": "25 cm2"}, "columns 2 and 1"),
    ("Cycle,Strain (%),Stress (kPa)", (["1"] * 20 + ["2"] * 60, np.append(STRAIN[:20], 100 * STRAIN), np.append(STRESS[:20], STRESS)), {"cycle": "2"}, "columns 2 and 3"),
])
def test_tests_become_curves(read, heading, columns, options, told):
    reading = read(table(heading, *columns, form="{:.12g}"), **options)
    is_curve(reading)
    assert told in reading.words


@pytest.mark.parametrize("heading", ["Gap (mm)", "Position (mm)", "Specimen height (mm)", "Plattenabstand in mm", "Platen separation (mm)", "Thickness (mm)"])
def test_the_gap_of_the_platens_is_a_displacement_from_the_first(read, heading):
    reading = read(table(f"{heading},Force (N)", GAP, FORCE))
    assert list(reading.frame) == ["displacement_mm", "force_N"] and np.allclose(reading.frame["displacement_mm"], GAP[0] - GAP)
    assert f'displacement = 49.5 mm, the first gap, less "{heading}"' in reading.words
    with pytest.raises(softfall.InputError, match="no gap of the platens"):
        read(table("Gap (mm),Force (N)", 50 - GAP, FORCE))


def test_axial_and_lateral_strain_are_told_apart(read):
    lateral = 0.3 * STRAIN
    for heading, options in (("Axial strain (%),Lateral strain (%),Stress (kPa)", {}), ("Strain (%),Transverse strain (%),Stress (kPa)", {}),
                             ("Eyy (%),Exx (%),Stress (kPa)", {"column": "Eyy (%)", "lateral": "Exx (%)"})):
        reading = read(table(heading, 100 * STRAIN, 100 * lateral, STRESS), **options)
        is_curve(reading)
        assert np.allclose(reading.frame["lateral_strain"], lateral)


@pytest.mark.parametrize("kind, text, frame", [
    ("motion", "time_ms,displacement_mm\n0,0\n80,40\n", {"time_s": [0, 0.08], "displacement_mm": [0, 40]}),
    ("rig", "Höhe (m);Geschwindigkeit (m/s)\n0,5;3,1\n1,0;4,4\n", {"height_m": [0.5, 1], "speed_m_s": [3.1, 4.4]}),
    ("lateral", "Strain (%);Transverse strain (%)\n1;0.3\n2;0.6\n", {"strain": [0.01, 0.02], "lateral_strain": [0.003, 0.006]}),
    ("cushion", "Static stress (kPa),Peak deceleration (g)\n2,68.67\n3,54.76\n", {"static_stress_kPa": [2, 3], "peak_g": [68.67, 54.76]}),
])
def test_other_kinds_are_read_when_asked_for(read, kind, text, frame):
    reading = read(text, kind=kind)
    assert {name: list(np.round(values, 12)) for name, values in reading.frame.items()} == frame


# ---- what laboratories' files are like (the cases of the programs' own reader) ----

@pytest.mark.parametrize("text, told, time, value", [
    ("Time (ms);Acc (km/s2)\n1,5;0,2451662500\n", 'separator ";", decimal comma, time in ms, acceleration in km/s2', 1.5e-3, 25),
    ("\ufeffTime [ms]\tAcc [g]\r\n1.5\t250\r\n", "separator tab, decimal point, time in ms, acceleration in g", 1.5e-3, 250),
    ("t/ms a/g\n1.5 0.25\n", "separator blanks, decimal point, time in ms, acceleration in g", 1.5e-3, 0.25),
    ("Messzeit;Kopfbeschleunigung\nms;g\n1,5;250\n", "decimal comma, time in ms, acceleration in g", 1.5e-3, 250),
    ("Machine 7;;\nDate;1.2.2024;\n\nTime (s);Pos;Acc (g)\n0,0015;1;250\n", "heading in line 4", 1.5e-3, 250),
    ('Time in ms;"Acc, g"\r1,5;250\r', "decimal comma", 1.5e-3, 250),
    ('"Time\n(ms)","Acc\n(g)"\n1.5,250\n', "time in ms", 1.5e-3, 250),
    ('Results Table 1\n,Maximum Acc\n,(g)\n1,"1682.35"\n\nTime,Displacement,Acc\n(s),(mm),(g)\n"0.0","0.0","0.5"\n"2.0","1.0","1,017.76"\n', "heading in line 6", 2, 1017.76),
    ('Time,Compressive acc (Load cell)\n(s),(g)\n"1.5","1,017"\n', "acceleration in g", 1.5, 1017),
    ("Zeit (s);Acc (g)\n1,5;1.017,76\n", "decimal comma", 1.5, 1017.76),
    ("Time (s),Acc (g)\n1,2\n2,3\n\nPeak,150.0\nHIC,1142.6\n", "without what stands from line 5 on", 2, 3),
    ("Time (s),Acc (g)\n1,2\n2,NaN\n3,4\n", "1 lost samples (NaN)", 3, 4),
    ("Test object number :1\r\nName of the channel :Load, cell\r\nUnit :m/(s*s)\r\nSampling interval :5.0E-05\r\nTime of first sample :-1.0E-04\r\nNumber of samples :3\r\n"
     "1.0\r\nNOVALUE\r\n98.0665\r\n", "a channel in ISO-MME, time in s, acceleration in m/(s*s)", 0, 10),
    ("Specimen;Time (s);Acc (g)\n1;3;30\nMean;-;\n", "from line 3 on", 3, 30),
    ("Time (s);Acc (g);Specimen height (mm);cycle height (mm)\n1;1;50;3\n3;30;49;4\n", "acceleration in g", 3, 30),
    ("Cycle;Time (s);Acc (g)\n" + "".join(f"{k};{2 + k / 10};2\n" for k in range(1, 9)) + "9;3;30\n", "acceleration in g", 3, 30),
])
def test_exports_are_read(read, text, told, time, value):
    reading = read(text, kind="acceleration")
    assert told in reading.words, reading.words
    assert reading.frame["time_s"].iloc[-1] == pytest.approx(time, abs=1e-15) and reading.frame["acceleration_g"].iloc[-1] == pytest.approx(value, rel=1e-12)


PARTS = {
    "column": "Specimen;Time (s);Acc (g)\n1;1;1\n1;2;2\n2;1;10\n2;3;30\n",
    "names": "Specimen No;Time (s);Acc (g)\nA-7;1;1\nB;3;30\n",
    "cycles": "Time (s);Acc (g);Cycle count\n1;1;1\n2;2;1\n2.5;5;2\n3;30;2.0\n",
    "both": "Specimen;Cycle;Time (s);Acc (g)\n1;1;1;1\n1;2;2;2\n2;1;3;30\n2;2;4;40\n",
    "beside": "Time (s);Acc (g);Time (s);Acc (g)\n1;1;3;30\n",
    "beside one time": "Time (s);Acc (g);Acc (g)\n3;1;30\n",
    "below": "Test 1\nTime (s);Acc (g)\n1;1\n2;2\nTest 2\nTime;Acc\n(s);(g)\n1;10\n3;30\n\nMean;9\n\nTest 3\nTime (s);Acc (g)\n1;5\n",
    "two below": "Time (s);Acc (g)\n1;1\nTime (s);Acc (g)\n3;30\n",
}


@pytest.mark.parametrize("text, options, refused", [
    ("column", {"specimen": "2"}, None), ("names", {"specimen": "B"}, None), ("cycles", {"cycle": "2"}, None), ("both", {"specimen": "2", "cycle": "1"}, None),
    ("beside", {"specimen": "2"}, None), ("beside one time", {"specimen": "2"}, None), ("below", {"specimen": "2"}, None), ("two below", {"specimen": "2"}, None),
    ("column", {}, 'holds the specimens 1, 2: choose one with specimen="1"'), ("column", {"specimen": "3"}, '"3" was asked for; it holds the specimens 1, 2'),
    ("cycles", {}, 'holds the cycles 1, 2: choose one with cycle="1"'), ("both", {"specimen": "2"}, 'holds the cycles 1, 2: choose one with cycle="1"'),
    ("beside", {"specimen": "3"}, "the heading has columns of 2"), ("beside", {}, 'choose a specimen with specimen="1"'),
    ("two below", {}, ':3: another table begins here, the file holds 2: choose one with specimen="1"'), ("two below", {"specimen": "4"}, "the file holds 2 tables"),
])
def test_parts_are_chosen_and_listed(read, text, options, refused):
    if refused:
        with pytest.raises(softfall.InputError, match=re.escape(refused)):
            read(PARTS[text], **options)
    else:
        assert list(read(PARTS[text], **options).frame.iloc[-1]) == [3, 30]


@pytest.mark.parametrize("text, refused", [
    ("b\n1\n", ":1: the heading has no column"), ("Time (s),Acc (g)\n1\n", ":2: 1 values where the heading has 2 columns"),
    ("Time (s),Acc (g)\n1,2,3\n", ":2: 3 values where the heading has 2 columns"), ("Time (s),Acc (g)\n1,2\n#\n1.5.1,2\n", ':4: time "1.5.1" is not a number'),
    ("Time (s),Acc (g)\n1,\n", "(the cell is empty)"), ("Time (s),Acc (g)\n1,inf\n", '"inf" is not finite'),
    ("Time (s),Acc (g)\n1,5,2,5\n", ":2: 4 values where the heading has 2 columns (with decimal commas, separate the columns by semicolons)"),
    ('time_s,acceleration_g\n1,"1,234"\n', "holds a comma, which separates the columns"),
    ("time_s;acceleration_g\n1;1,234\n2;5,678\n", ':2: "1,234" and every other number with a comma could hold'),
    ("time_s;acceleration_g\n1.5;2\n2;5,67\n", ':3: acceleration "5,67" has a comma where the file has decimal points'),
    ("time_s;acceleration_g\n1,5;2\n2;5.67\n", ':3: acceleration "5.67" has a decimal point after numbers with a decimal comma (line 2, "1,5")'),
    ("time_s;acceleration_g\n1;1,234,567\n", '"1,234,567" is not a number'), ("Time (s);Acc\n1;2\n", '"Acc" names no unit'),
    ("Time (s);Acc (mm)\n1;2\n", 'is in "mm", which is not a unit of an acceleration'), ("Time;Acc\ns;kg\n1;2\n", 'is in "kg", which is not a unit'),
    ("1;2\nTime (s);Acc (g)\n1;2\n", ":1: numbers begin here without a heading"), ("Time (s),Acc (g)\n1,2\nPeak,3\n3,4\n", ':3: time "Peak" is not a number'),
    ("Time (s),Acc (g)\n1,2\n2,x\n", ':3: acceleration "x" is not a number'), ("Time (s);Acc (g)\n1,5;0.123,4\n", ':2: acceleration "0.123,4" is not a number'),
    ("Time (ms);Acc (g)\ns;g\n0;1\n", "give different units"), ("Time (ms),Mass (g)\n1,2\n", '"Mass (g)" is a mass'),
    ("Time (s),Time 2 (s),Acc (g)\n0,0,1\n1,3,2\n", 'that do not agree: name one with column="Time 2 (s)"'), ("", "is empty"), ("Time (s),Acc (g)\n", "no row of numbers"),
    ("Test object number :1\nUnit :N\nSampling interval :1E-3\nNumber of samples :3\n1\n2\n", "3 samples; it holds 2 samples"),
    (b"\xff\xfet\0_\0s\0\0\xd8", "begins like UTF-16, but is not"), (b"Time (s),Acc (g)\n1,\0\n", "holds zero bytes"),
    (gzip.compress(b"Time (s),Acc (g)\n1,2\n")[:-9], "is compressed, and damaged"), (b"PK\x03\x04nonsense", "cannot be read as a spreadsheet"),
    ("Time (s),Acc (g)\n0,1\n0.001,2\n0.0005,2\n", ":4: time 0.5 ms does not follow 1 ms"),
])
def test_what_could_be_read_in_two_ways_is_refused(read, text, refused):
    with pytest.raises(softfall.InputError, match=re.escape(refused)) as caught:
        read(text, kind="acceleration")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("text, options, refused", [
    (table("Time (ms),Acc (g)", TIME, ACCELERATION), {"scale": "10 mV/g"}, 'is in "g", which is neither volts nor counts'),
    (table("Time (ms),Acc (g)", TIME, ACCELERATION), {"scale": "10 mV"}, "is no scale of a channel"), (table("Time (ms),CH1 (mV)", TIME, ACCELERATION), {"scale": "-10 mV/g"}, "is not above 0"),
    (table("Time (ms),Acc (g)", TIME, ACCELERATION), {"rate": "20"}, "is not a sampling rate"), (table("Time (ms),Acc (g)", TIME, ACCELERATION), {"column": "Axx"}, "there are 'Time (ms)'"),
    (table("Time (ms),Acc (g)", TIME, ACCELERATION), {"heading": "Time (ms), Acc (g)"}, ":1: the file has a heading of its own"),
    (table("1;2;3", TIME, TIME, TIME, separator=";"), {"heading": "Time (ms);Acc (g)"}, ":1: 3 values where heading names 2 columns"),
    (table("1;2", TIME, TIME, separator=";"), {"heading": "Time (ms);Mass (kg)"}, "the heading has no column"), (table("Strain (%),Stress (kPa)", STRAIN, STRESS), {"side": "5 cm"}, "leave the area"),
    (table("Displacement (mm),Force (N)", STRAIN, STRESS), {"side": "5 cm"}, "give the thickness of the specimen, too"), (table("Strain (%),Stress (kPa)", STRAIN, STRESS), {"specimen": "1"}, "holds one specimen"),
    (table("Displacement (mm),Force (N)", STRAIN, STRESS), {"side": "5 cm", "diameter": "5 cm", "thickness": "5 cm"}, "give side"), (table("Strain (%),Stress (kPa)", STRAIN, STRESS), {"sheet": "A"}, "no spreadsheet"),
    (table("Time (s),Displacement (mm),Force (N),Acc (g)", STRAIN, STRAIN, STRESS, STRESS), {}, 'choose one with kind="acceleration" or kind="compression"'),
    (table("Strain (%),Stress (kPa)", -STRAIN, -STRESS), {}, 'strain and stress are negative; compression is positive: change the sign with invert="both"'),
    (table("Time (ms),Acc (g)", TIME, ACCELERATION), {"kind": "drop"}, 'there is no kind of table "drop"'),
])
def test_options_that_contradict_the_file_are_refused(read, text, options, refused):
    with pytest.raises(softfall.InputError, match=re.escape(refused)):
        read(text, **options)


# ---- spreadsheets and MATLAB ----

def test_a_spreadsheet_is_read(tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    book.active.title = "Notes"
    book.active.append(["Mat 7", None])
    for name, sign in (("Drop 1", 1), ("Drop 2", 0.5)):
        sheet = book.create_sheet(name)
        for row in [["Made by", "rig 7"], ["Time (ms)", "Acceleration (g)"], *zip(1e3 * TIME, sign * ACCELERATION)]:
            sheet.append(list(map(lambda cell: cell if isinstance(cell, str) else float(cell), row)))
    book.save(tmp_path / "lab.xlsx")
    with pytest.raises(softfall.InputError, match=re.escape('holds several tables (sheet "Drop 1", sheet "Drop 2"): choose one with sheet="Drop 1"')):
        laboratory.read(tmp_path / "lab.xlsx")
    reading = laboratory.read(tmp_path / "lab.xlsx", sheet="Drop 1")
    is_record(reading)
    assert 'sheet "Drop 1"' in reading.words


def test_a_matlab_file_is_read(tmp_path):
    io = pytest.importorskip("scipy.io")
    io.savemat(tmp_path / "lab.mat", {"t_ms": 1e3 * TIME, "a_g": ACCELERATION, "fs": 1200.0})
    is_record(laboratory.read(tmp_path / "lab.mat"))
    io.savemat(tmp_path / "lab.mat", {"data": np.column_stack([TIME, ACCELERATION])})
    with pytest.raises(softfall.InputError, match="numbers begin here without a heading"):
        laboratory.read(tmp_path / "lab.mat")
    is_record(laboratory.read(tmp_path / "lab.mat", heading="Time (s), Acc (g)"))


# ---- the command ----

def test_the_command_writes_what_it_has_read(tmp_path):
    path, clean = tmp_path / "lab.csv", tmp_path / "clean.csv"
    path.write_text(table("Time (ms);Acc X (g);Acc, Y (g)", 1e3 * TIME, ACCELERATION, 0 * TIME, separator=";"))
    code, out, _ = says("read", str(path), "-o", str(clean))
    assert code == 0 and f"acceleration of {path}: separator" in out and "--reference-columns='Acc X,Acc Y'" in out and f"Written: {clean}" in out
    assert clean.read_text().splitlines()[1] == "time_s,Acc X (g),Acc Y (g)" and clean.read_text().startswith("# softfall read lab.csv: separator")
    code, _, err = says("read", str(path), "-o", str(clean))
    assert code == 2 and "clean.csv is there already: give --force" in err and err.count("\n") == 1
    assert says("read", str(path), "-o", str(clean), "--force", "--column", "Acc X (g)")[0] == 0
    assert clean.read_text().splitlines()[1] == "time_s,acceleration_g"
    again = laboratory.read(clean)
    assert np.allclose(again.frame["acceleration_g"], laboratory.read(path, column="Acc X (g)").frame["acceleration_g"], rtol=1e-14, atol=0)
    assert says("read", str(path), "-o", str(path), "--force")[0] == 2 and says("read", "nowhere.csv")[2].startswith("softfall read: nowhere.csv cannot be read")


# ---- records in Python ----

def test_a_record_of_any_file_is_judged(tmp_path):
    time = np.arange(0, 0.06, 5e-5)
    pulse = 150 * np.sin(np.pi * np.clip((time - 0.02) / 0.012, 0, 1))
    axes = [share * pulse for share in (0.6, -0.64, 0.48)]
    (tmp_path / "axes.csv").write_text(table("Time (ms);ax (g);ay (g);az (m/s2)", 1e3 * time, axes[0], axes[1], 9.80665 * axes[2], separator=";"))
    with pytest.raises(softfall.InputError, match='holds 3 accelerations: take one with column="ax", or the resultant of two or three with columns="ax,ay,az"'):
        softfall.read_record(tmp_path / "axes.csv")
    record = softfall.read_record(tmp_path / "axes.csv", columns="ax,ay,az", zero=True)
    assert record.verdict == "valid" and record.figures["a_max_g"] == pytest.approx(150, rel=1e-3) and "resultant of the axes" in record.interpretation
    assert softfall.read_record(tmp_path / "axes.csv", column="ax").figures["a_max_g"] == pytest.approx(90, rel=1e-3)
    with pytest.raises(softfall.InputError, match='called "aq"|no column is called "aq"'):
        softfall.read_record(tmp_path / "axes.csv", columns="ax,ay,aq")


def test_an_offset_is_taken_away_as_the_report_advises(tmp_path):
    time = np.arange(-0.02, 0.04, 1e-4)
    (tmp_path / "lab.csv").write_text(table("time_s,acceleration_g", time, 5 + 90 * np.sin(np.pi * np.clip(time / 0.012, 0, 1))))
    before, after = softfall.read_record(tmp_path / "lab.csv"), softfall.read_record(tmp_path / "lab.csv", zero=True)
    assert "offset before contact" in before.verdict.remarks[0] and after.verdict == "valid"
    assert before.figures["a_max_g"] - after.figures["a_max_g"] == pytest.approx(5, rel=0.01)


# ---- every remedy that a sentence names works ----

@pytest.mark.parametrize("text, options", [
    (table("Time,Acc", 1e3 * TIME, ACCELERATION), {}), (table("Time,Acc (g)", 1e3 * TIME, ACCELERATION), {}), (table("Strain,Stress (kPa)", 100 * STRAIN, STRESS), {}),
    (table("Strain 1 (%),Strain 2 (%),Stress (kPa)", 100 * STRAIN, 30 * STRAIN, STRESS), {}), (table("Eyy (%),Stress (kPa)", 100 * STRAIN, STRESS), {}),
    (table("Time (s),Acc X (g),Time (s),Acc Y (g)", TIME, ACCELERATION, TIME, ACCELERATION), {}), (table("Time (s),Time 2 (s),Acc (g)", TIME, 2 * TIME, ACCELERATION), {}),
    (table("Time (ms),Acc (counts)", 1e3 * TIME, ACCELERATION), {}), (table("Time (ms),Acc (mV)", 1e3 * TIME, ACCELERATION), {}), (table("Strain (%),Force (mV)", 100 * STRAIN, FORCE), {}),
    (table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION), {"rate": "20 kHz"}), (table("Sample rate: 5 kHz\nTime (ms),Acc (g)", 1e3 * TIME, ACCELERATION), {}),
    (table("Time (s),Acc (g)", [f"{t:.1f}" for t in TIME], ACCELERATION), {}), (table("Time (s),Acc (g)", [f"{t:.3f}" for t in TIME], ACCELERATION), {}),
    (table("Strain (%),Stress (kPa)", -100 * STRAIN, -STRESS), {}), (table("Strain (%),Stress (kPa)", -100 * STRAIN, STRESS), {}), (PARTS["column"], {}), (PARTS["cycles"], {}),
    (PARTS["two below"], {}), (PARTS["beside"], {}), (table("Time (s),Displacement (mm),Force (N),Acc (g)", TIME, TIME, ACCELERATION, ACCELERATION), {}),
    (table("", 1e3 * TIME, ACCELERATION)[1:], {}), (table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION), {"heading": "Time (ms), Acc (g)"}),
    (table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION), {"scale": "10 mV/g"}), (table("Strain (%),Stress (kPa)", 100 * STRAIN, STRESS), {"specimen": "2"}),
    (table("Time (ms),Acc (g)", 1e3 * TIME, ACCELERATION), {"cycle": "2"}),
])
def test_a_remedy_that_is_named_works(read, text, options):
    try:
        reading = read(text, **options)
        assert not options and "even times" in reading.words  # needs no remedy
        return
    except softfall.InputError as error:
        said = str(error)
    left_out = re.search(r'leave (\w+)(?:="[^"]*")? out', said)
    tried = [{name: value for name, value in options.items() if name != left_out[1]}] if left_out else []
    offered = re.findall(r'(?<!leave )\b(\w+)="([^"]*)"', said)
    tried += [{**options, name: value} for name, value in offered if name in ("column", "specimen", "cycle", "kind", "units", "scale", "rate", "invert", "heading")]
    assert tried, said
    for changed in tried:
        try:
            read(text, **changed)
        except softfall.InputError as error:  # one of several steps: another sentence
            assert str(error) != said and changed != options, str(error)
            more = dict(re.findall(r'\b(units|invert)="([^"]*)"', str(error)))
            if "units" in more:
                more["units"] = ",".join(a or b for a, b in zip((changed["units"] + ",,").split(","), (more["units"] + ",,").split(",")))
            read(text, **{**changed, **more})


def advised(text, place, *more):
    """Runs the command that a sentence names, and returns what it made."""
    words = shlex.split(re.search(r"(softfall read .+? -o clean2?\.csv(?: --(?!column NAME)\w+ \S+)?)", text)[1])
    subprocess.run([str(BIN / words[0]), *words[1:], *more, "--force"], cwd=place, check=True, capture_output=True)
    return place / words[words.index("-o") + 1]


def test_programs_name_the_command_that_reads_the_file(drop, tmp_path):
    time = np.arange(-0.02, 0.04, 1e-4)
    pulse = 90 * np.sin(np.pi * np.clip((time - 0.0) / 0.012, 0, 1))
    (tmp_path / "Kai's lab.csv").write_text(table("Zeit [ms];a [m/s²]", 1e3 * time, 9.80665 * pulse, separator=";").replace(".", ","))
    (tmp_path / "axes.csv").write_text(table("Time (ms);Acc X (g);Acc Y (g)", 1e3 * time, pulse, 0 * time, separator=";"))

    def post(reference, *more):
        return subprocess.run([str(BIN / "softfall-post"), drop.results, "-o", "out", "--view", "0", "--force", "--reference", reference, *more], cwd=tmp_path, capture_output=True, text=True)
    refused = post("Kai's lab.csv")
    assert refused.returncode == 2
    accepted = post(advised(refused.stderr, tmp_path))
    assert accepted.returncode == 0 and "(softfall read Kai's lab.csv: separator" in accepted.stdout, accepted.stderr
    axes = post(advised(post("axes.csv").stderr, tmp_path))
    assert axes.returncode == 2 and 'name one of "Acc X", "Acc Y" with --reference-column' in axes.stderr
    assert post("clean.csv", "--reference-column", "Acc X").returncode == 0 and post("clean.csv", "--reference-columns", "Acc X,Acc Y").returncode == 0
    assert drop.post(tmp_path / "python", view=0, reference=tmp_path / "Kai's lab.csv")["reference"]["a_max_g"] == pytest.approx(90, rel=0.01)
    with pytest.raises(softfall.InputError, match='leave reference_rate="20 kHz" out, or give reference_rate="10 kHz"'):
        drop.post(tmp_path / "python", view=0, reference=tmp_path / "axes.csv", reference_column="Acc X (g)", reference_rate="20 kHz")
    drop.post(tmp_path / "python", view=0, force=True, reference=tmp_path / "axes.csv", reference_column="Acc X (g)", reference_rate="10 kHz")


@pytest.mark.parametrize("change, option", [
    (lambda t, a: (t, -a), "invert"), (lambda t, a: (t[::4], a[::4]), "filter"), (lambda t, a: (t[::40], a[::40]), "filter"),
])
def test_remedies_for_records_change_the_outcome(drop, tmp_path, change, option):
    """Each option that a refused record names is tried, as softfall-post and Python spell it."""
    time = np.arange(-0.02, 0.04, 1e-4)
    time, value = change(time, 90 * np.sin(np.pi * np.clip(time / 0.012, 0, 1)))
    (tmp_path / "lab.csv").write_text(table("time_s,acceleration_g", time, value))
    command = [str(BIN / "softfall-post"), drop.results, "-o", "out", "--view", "0", "--force", "--reference", "lab.csv"]
    refused = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True)
    named = re.findall(rf"--reference-{option}(?: \w+)?(?=,| if|$)", refused.stderr.strip(), re.M)
    assert refused.returncode == 2 and named, refused.stderr
    for words in named:
        made = subprocess.run([*command, *words.split()], cwd=tmp_path, capture_output=True, text=True)
        assert made.returncode == 0, made.stderr
    with pytest.raises(softfall.InputError) as caught:
        softfall.read_record(tmp_path / "lab.csv")
    for name, text in re.findall(rf"\b({option})(?:=(\w+))?(?=,| if|$)", str(caught.value)):
        softfall.read_record(tmp_path / "lab.csv", **{name: text or True})


def test_a_zero_line_that_cannot_be_taken_away_is_left_out(tmp_path):
    (tmp_path / "lab.csv").write_text(table("time_s,acceleration_g", TIME[12:], ACCELERATION[12:]))
    with pytest.raises(softfall.InputError, match="take the zero line from: leave zero out"):
        softfall.read_record(tmp_path / "lab.csv", zero=True, filter="none")
    softfall.read_record(tmp_path / "lab.csv", filter="none")


def test_a_curve_of_a_case_is_read_from_any_file(case, tmp_path):
    case = case.copy()
    (tmp_path / "lab.csv").write_text(table("Compression (%);Druckspannung (kPa)", 100 * STRAIN, STRESS, separator=";").replace(".", ","))
    (tmp_path / "yield.csv").write_text(table("Yield stress (MPa),Plastic strain (-)", STRESS / 1e3, STRAIN))
    refused = subprocess.run([str(BIN / "softfall-pre"), case.path, "-o", tmp_path / "m.h5", "--set", f"material.curve={tmp_path}/lab.csv"], capture_output=True, text=True)
    assert refused.returncode == 2 and "what is read is nominal stress over nominal strain in compression" in refused.stderr
    clean = advised(refused.stderr, tmp_path)
    accepted = subprocess.run([str(BIN / "softfall-pre"), case.path, "-o", tmp_path / "m.h5", "--set", f"material.curve={clean}"], capture_output=True, text=True)
    assert accepted.returncode == 0 and "nominal stress over nominal strain in compression, columns 1 and 2" in accepted.stdout
    case["material.curve"] = tmp_path / "lab.csv"
    assert np.allclose(laboratory.read(case["material.curve"]).frame["stress_kPa"], STRESS, rtol=1e-7)
    with pytest.raises(softfall.InputError, match='"Plastic strain \\(-\\)" is a plastic .* strain.*"Yield stress \\(MPa\\)" is a yield stress'):
        case["material.curve"] = tmp_path / "yield.csv"
    (tmp_path / "two.csv").write_text("Specimen;Strain (%);Stress (kPa)\n" + "".join(f"{k};{100 * a:.9g};{b:.9g}\n" for k in (1, 2) for a, b in zip(STRAIN, STRESS)))
    with pytest.raises(softfall.InputError, match="holds the specimens 1, 2: choose one with softfall read") as caught:
        case["material.curve"] = tmp_path / "two.csv"
    case["material.curve"] = advised(str(caught.value), tmp_path)


def test_the_file_of_a_case_may_name_curves_of_any_form(case, tmp_path):
    (tmp_path / "slow.csv").write_text(table("Compression (%);Druckspannung (kPa)", 100 * STRAIN, STRESS, separator=";").replace(".", ","))
    (tmp_path / "fast.csv").write_text(table("Deflection (%),Stress (kPa)", 100 * STRAIN, 2 * STRESS))
    text, lists = case.path.read_text(), 'curves = ( { rate = "0.01 1/s"; file = "slow.csv"; }, { rate = "1 1/s"; file = "fast.csv"; } );'
    folder = case.path.parent
    for name, curve in (("one.cfg", 'curve = "slow.csv";'), ("both.cfg", lists)):
        for file in ("slow.csv", "fast.csv"):
            (folder / file).write_bytes((tmp_path / file).read_bytes())
        (folder / name).write_text(re.sub(r"(?s)material\s*[=:]\s*(\{.*?\}|\"[^\"]*\")\s*;", f'material = {{ law = "low_density_foam"; density = "35 kg/m3"; E = "1 MPa"; {curve} }};', text))
        made = softfall.Case(folder / name)
        clean = made.overrides["material.curve" if name == "one.cfg" else "material.curves"]
        assert clean.count("softfall-runs/tables/") == (1 if name == "one.cfg" else 2)
        assert made.copy().overrides == made.overrides


@pytest.mark.parametrize("heading, columns, specimen", [
    ("Gap (mm),Force (N)", (GAP, FORCE), True), ("Strain (%),Force (N)", (100 * STRAIN, FORCE), True), ("Displacement (mm),Stress (kPa)", (50 * STRAIN, STRESS), True),
    ("Deflection (%);Druckspannung (kPa)", (100 * STRAIN, STRESS), False),
])
def test_fits_read_any_file(tmp_path, heading, columns, specimen):
    rows = [np.interp(np.linspace(0, 1, 200), np.linspace(0, 1, STRAIN.size), column) for column in columns]
    (tmp_path / "lab.csv").write_text(table(heading, *rows, separator=";" if ";" in heading else ","))
    size = 'specimen = { side = "50 mm"; thickness = "50 mm"; }; ' if specimen else ""
    (tmp_path / "fit.cfg").write_text(f'name = "t"; density = "35 kg/m3"; {size}rate_model = "none"; E_range = 0.1;\ntests = ( {{ file = "lab.csv"; rate = "0.1 1/min"; }} );\n')
    made = softfall.fit_compression(tmp_path / "fit.cfg", tmp_path / "out")
    assert made.summary["tests"][0]["largest_strain"] == pytest.approx(0.59 if "Gap" in heading else 0.6, abs=1e-3)
    if "Gap" in heading:
        assert "the first gap, less" in (tmp_path / "out/report.html").read_text()
    assert os.path.exists(made.summary["tests"][0]["file"])


def test_a_hyperfoam_takes_axial_and_lateral_strain_from_one_file(tmp_path):
    """The file of which a message once named an unknown key as the remedy."""
    rows = [np.linspace(0.004, 0.6, 150), 0.25 * np.linspace(0.004, 0.6, 150), 600 * (1 - (1 - np.linspace(0.004, 0.6, 150)) ** 0.5)]
    (tmp_path / "dic.csv").write_text(table("Axial strain (%),Lateral strain (%),Stress (kPa)", 100 * rows[0], 100 * rows[1], rows[2]))
    (tmp_path / "fit.cfg").write_text('law = "hyperfoam"; name = "t"; density = "100 kg/m3"; terms = 1;\ntests = ( { file = "dic.csv"; rate = "0.01 1/s"; lateral = "dic.csv"; } );\n')
    (tmp_path / "old.cfg").write_text((tmp_path / "fit.cfg").read_text().replace("lateral =", 'specimen_number = "1"; lateral ='))
    with pytest.raises(softfall.InputError, match='unknown key "specimen_number"'):
        softfall.fit_compression(tmp_path / "old.cfg", tmp_path / "old")
    assert softfall.fit_compression(tmp_path / "fit.cfg", tmp_path / "python").summary["law"] == "hyperfoam"
