"""Fatigue: a strip's S-N line, and the growth of a crack in a compact-tension specimen.

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -B benchmarks/fatigue.py [strip|calibrate|growth|tolerance]

The crack length is the initial one and the broken bonds across the plane of the crack, over those that are across a
spacing of it. Stress intensity factors are those of ASTM E399 for this length. Rates are means over a spacing, because the crack goes from
row to row; the first three spacings, in which the bonds' lives become those of a growing crack, are left out.
"""

import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", ROOT / "build/release/peristat")
SPECIMEN = ROOT / "cases/fatigue/compact_tension.toml"
WIDTH, THICKNESS, NOTCH, RATIO = 0.04, 0.01, 0.012, 0.1  # m, and R
PARIS, EXPONENT = 6.9e-12, 3  # da/dN [m] = PARIS (dK [MPa sqrt(m)])^EXPONENT: ferritic-pearlitic steel

STRIP = """\
dimension = 1
[lattice]
spacing = 1e-3
horizon_ratio = 2.015
area = 1e-4
[[lattice.shape]]
add = "box"
min = [0.0]
max = [0.02]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 0.1
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = ["1e-5*load"]
[solver]
mode = "fatigue"
[fatigue]
load_ratio = 0.1
"""


def run(case, *changes):
    """Rows of the history and the summary of a run."""
    with tempfile.TemporaryDirectory() as folder:
        if not isinstance(case, pathlib.Path):
            text, case = case, pathlib.Path(folder) / "case.toml"
            case.write_text(text)
        sets = [word for change in changes for word in ("--set", change)]
        out = pathlib.Path(folder) / "out"
        words = [PROGRAM, "run", case, "--output", out, "--no-plots", "--quiet", *sets]
        subprocess.run(words, check=True, cwd=folder, stdout=subprocess.DEVNULL)
        return with_broken_bonds(out), json.loads((out / "summary.json").read_text())


def table(path):
    with open(path, newline="", encoding="utf-8") as file:
        return [{key: value if key == "mode" else float(value) for key, value in row.items()} for row in csv.DictReader(file)]


def with_broken_bonds(folder):
    """Rows of the history with the number of broken bonds across the plane y = 0."""
    with h5py.File(folder / "results.h5") as file:
        height = file["points/reference"][:, -1]
    steps = [row["step"] for row in table(folder / "broken_bonds.csv")
             if height[int(row["first_point"])] * height[int(row["second_point"])] < 0.0]  # fmt: skip
    rows = table(folder / "history.csv")
    for row in rows:
        row["across"] = sum(step <= row["step"] for step in steps)
    return rows


def strip():
    """Cycles of the first bond over its range: N = 1 / (A eps^m)."""
    print("range      cycles        1 / (A eps^m)  error")
    lives = []
    for pull in (5e-6, 1e-5, 2e-5, 4e-5, 8e-5):
        rows, _ = run(STRIP, f'support[1].displacement=["{pull}*load"]', "fatigue.blocks=1",
                      "fatigue.nucleation={coefficient=1e9, exponent=5}")  # fmt: skip
        reach = 0.9 * rows[1]["max_stretch"]
        cycles, exact = rows[-1]["cycles"], 1.0 / (1e9 * reach**5)
        lives.append((math.log(cycles), math.log(reach)))
        print(f"{reach:.4e} {cycles:.6e}  {exact:.6e}   {cycles / exact - 1.0:.1e}")
    (first, low), (last, high) = lives[0], lives[-1]
    print(f"slope of log eps over log N: {(high - low) / (last - first):.9f}, -1/m = {-1 / 5:.9f}")


def intensity(ratio):
    """K B sqrt(W) / P of ASTM E399."""
    a = ratio
    return (2 + a) / (1 - a) ** 1.5 * (0.886 + 4.64 * a - 13.32 * a**2 + 14.72 * a**3 - 5.6 * a**4)


def rates(rows, load, spacing, horizon=3.015):
    """a/W, range of K [MPa sqrt(m)] and da/dN [m] per spacing of growth."""
    reach = numpy.arange(-4, 5)
    pairs = [(i, j) for i in reach for j in reach if j > 0 and math.hypot(i, j) <= horizon]
    per_spacing = sum(j for _, j in pairs)  # bonds across a plane between rows, per spacing of it
    grown = [(row["cycles"], NOTCH + spacing * row["across"] / per_spacing) for row in rows if row["cycles"] > 0]
    cycles, length = numpy.array(grown).T
    marks = numpy.arange(NOTCH + 3 * spacing, length[-1], spacing)
    at = numpy.interp(marks, length, cycles)
    middle = 0.5 * (marks[1:] + marks[:-1]) / WIDTH
    stress = (1 - RATIO) * load / (THICKNESS * math.sqrt(WIDTH)) * 1e-6
    return middle, stress * intensity(middle), spacing / numpy.diff(at)


def fit(ranges, growth, exponent=None):
    """Exponent and constant of da/dN = c dK^m, by least squares of logarithms."""
    x, y = numpy.log(ranges), numpy.log(growth)
    if exponent is not None:
        return exponent, math.exp((y - exponent * x).mean())
    slope, constant = numpy.polyfit(x, y, 1)
    return slope, math.exp(constant)


def specimen(load, coefficient, exponent=EXPONENT, spacing=1e-3, tolerance=0.0):
    law = f"fatigue.growth={{coefficient={coefficient!r}, exponent={exponent}}}"
    return run(SPECIMEN, f'load[0].total_force=["0","{load}*load"]', law, f"lattice.spacing={spacing}",
               f"fatigue.life_tolerance={tolerance}")  # fmt: skip


def used(ratio, ranges, growth):
    """The range of lengths of ASTM's formula in which the specimen is far from its end."""
    keep = (ratio > 0.35) & (ratio < 0.65)
    return ranges[keep], growth[keep]


def calibrate():
    """The coefficient for Paris' constant, by one trial at another load."""
    trial, load = 1e6, 3e3
    rows, _ = specimen(load, trial)
    _, constant = fit(*used(*rates(rows, load, 1e-3)), EXPONENT)
    print(f"trial at {load:g} N with A = {trial:g}: c = {constant:.4e}; A = {trial * PARIS / constant:.6e}")
    return trial * PARIS / constant


def growth():
    print("load N  spacing mm  m    A            exponent        c (of m)        da/dN from, to      failure: cycles, a/W, K_max")
    for load, exponent, spacing, coefficient in runs_of_growth():
        rows, summary = specimen(load, coefficient, exponent, spacing)
        ratio, ranges, growing = rates(rows, load, spacing)
        kept = used(ratio, ranges, growing)
        slope, _ = fit(*kept)
        _, constant = fit(*kept, exponent)
        end = ratio[-1]
        print(f"{load:6g}  {1e3 * spacing:4g}  {exponent}  {coefficient:.4e}  {slope:.4f}  {constant:.4e}  "
              f"{kept[1].min():.2e} {kept[1].max():.2e}  {rows[-1]['cycles']:.6g} {end:.3f} {ranges[-1] / (1 - RATIO):.3g}  "
              f"{len(rows)} rows, {summary['seconds']['total']:.0f} s")  # fmt: skip


def runs_of_growth():
    shipped = coefficient_of_case()
    yield 4e3, EXPONENT, 1e-3, shipped
    yield 4e3, 4, 1e-3, 1e9
    yield 4e3, 2, 1e-3, 1e3
    # A grows as (horizon)^(m/2 - 1): the stretch ahead of a tip is K over the root of the horizon, and a bond dies
    # while the tip goes through a horizon.
    yield 4e3, EXPONENT, 0.5e-3, shipped * 0.5 ** (EXPONENT / 2 - 1)  # by far the longest


def coefficient_of_case():
    import tomllib

    return tomllib.loads(SPECIMEN.read_text())["fatigue"]["growth"]["coefficient"]


def tolerance():
    """Bonds that break together: the life of the specimen."""
    print("life_tolerance  cycles       blocks")
    for share in (0.0, 0.025, 0.05, 0.1):
        rows, _ = specimen(4e3, coefficient_of_case(), tolerance=share)
        print(f"{share:14g}  {rows[-1]['cycles']:.6g}  {sum(row['mode'] == 'fatigue' for row in rows)}")


if __name__ == "__main__":
    for name in sys.argv[1:] or ("strip", "calibrate", "growth", "tolerance"):
        print(f"\n{name}: {globals()[name].__doc__ or ''}")
        globals()[name]()
        sys.stdout.flush()
