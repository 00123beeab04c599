"""Stress concentration at a hole: ./peristat build && /usr/bin/python3 benchmarks/stress_concentration.py

A quarter of a plate of 40 x 80 mm with a hole of radius R = 8 mm under tension, with planes of symmetry. The
quantity is the stress along the load over the gross stress, in the row of points beside the ligament's middle line.
It is extrapolated to the rim from the points with complete neighbourhoods, at least a horizon away from it: by the
three terms of Kirsch's solution, 1, (R/r)^2 and (R/r)^4, up to 1.75 R, and by a cubic polynomial in r, up to half a
radius farther. The unextrapolated values of the points are printed, too. Finite elements give 3.75 for this length,
Peterson's chart 3.73 for a long plate.
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
RADIUS, WIDTH, LENGTH, THICKNESS = 8e-3, 40e-3, 80e-3, 1e-3  # m
RATIO, EXPECTED = 3.015, 3.75  # horizon over spacing; stress concentration
GROSS = 1e6  # stress at the ends [Pa]


def case(spacing: float, surface: str) -> str:
    return f"""\
title = "Stress concentration at a hole"
dimension = 2
[lattice]
spacing = {spacing!r}
horizon_ratio = {RATIO}
thickness = {THICKNESS}
shape = [{{ add = "box", min = [0, 0], max = [{WIDTH / 2}, {LENGTH / 2}] }}, {{ subtract = "disk", centre = [0, 0], radius = {RADIUS} }}]
[quadrature]
surface_correction = "{surface}"
[material]
youngs_modulus = 200e9
[[symmetry]]
axis = "x"
[[symmetry]]
axis = "y"
[[load]]
side = "y+"
traction = ["0", "{GROSS}*load"]
depth = "horizon"
[[probe]]
name = "ligament"
from = [{RADIUS - spacing}, {spacing / 2}]
to = [{WIDTH / 2}, {spacing / 2}]
field = "stress"
component = "yy"
[[probe]]
name = "missing"
from = [{RADIUS - spacing}, {spacing / 2}]
to = [{WIDTH / 2}, {spacing / 2}]
field = "missing_neighbourhood"
"""


def table(path: Path, *columns: str):
    """Columns of a file as arrays."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return [numpy.array([float(row[name]) for row in rows]) for name in columns]


def kirsch(r):
    ratio = RADIUS / numpy.asarray(r)
    return numpy.stack([numpy.ones_like(ratio), ratio**2, ratio**4], axis=-1)


def cubic(r):
    off = numpy.asarray(r) / RADIUS - 1
    return numpy.stack([numpy.ones_like(off), off, off**2, off**3], axis=-1)


def at_rim(terms, r, factor):
    """Value of the least-squares fit at a position."""
    return terms(RADIUS) @ numpy.linalg.lstsq(terms(r), factor, rcond=None)[0]


def row_of_points(folder: Path, spacing: float, surface: str):
    """Distance from the hole's centre, stress over the gross stress, and the missing share of the points'
    neighbourhoods."""
    path = folder / "case.toml"
    path.write_text(case(spacing, surface))
    subprocess.run([PROGRAM, "run", path, "--output", folder / "out", "--overwrite", "--quiet", "--no-plots"], check=True)
    x, y, stress = table(folder / "out/line_ligament.csv", "x", "y", "stress_yy")
    (missing,) = table(folder / "out/line_missing.csv", "missing_neighbourhood")
    (reaction,) = table(folder / "out/history.csv", "reaction_y:symmetry_y")
    gross = abs(reaction[-1]) / (WIDTH / 2 * THICKNESS)
    assert abs(gross / GROSS - 1) < 1e-8, gross
    row = numpy.abs(y - spacing / 2) < 0.1 * spacing
    return numpy.hypot(x, y)[row], stress[row] / gross, missing[row]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--levels", type=int, default=4, help="lattices, each twice as fine as the one before")
    levels = parser.parse_args().levels
    with tempfile.TemporaryDirectory() as name:
        for surface in ("none", "energy"):
            print(f"Surface correction `{surface}`\n")
            print("| radius / spacing | by Kirsch's terms | error | by a cubic | error | first point | it lacks | largest | a horizon off |")
            print("|---|---|---|---|---|---|---|---|---|")
            for level in range(levels):
                cells = 16 * 2**level
                r, factor, missing = row_of_points(Path(name), RADIUS / cells, surface)
                start = RADIUS + RATIO * RADIUS / cells
                told = []
                for terms, end in ((kirsch, 1.75 * RADIUS), (cubic, start + 0.5 * RADIUS)):
                    inside = (r > start) & (r < end)
                    assert numpy.abs(missing[inside]).max() < 1e-9
                    value = at_rim(terms, r[inside], factor[inside])
                    told.append(f"{value:.3f} | {100 * (value / EXPECTED - 1):+.1f} %")
                print(f"| {cells} | {' | '.join(told)} | {factor[0]:.2f} | {100 * missing[0]:.0f} % | {factor.max():.2f} "
                      f"| {factor[r > start][0]:.2f} |", flush=True)  # fmt: skip
            print()


if __name__ == "__main__":
    sys.exit(main())
