"""Stairs and fractional volumes at a hole: ./peristat build && /usr/bin/python3 benchmarks/hole_rim.py

A square cut out of an infinite plate under tension surrounds a circular hole, and its frame moves by Kirsch's
solution. The rim strain is the hoop strain at the two places where it is highest, by a linear fit to the
displacements within 0.4 radii of the place. Its error is relative to the same fit to Kirsch's displacements of the
same points, so that only the error of the displacements counts. Lattices have a fixed horizon ratio and four
positions under the hole. A second table shows the volume of a body under a lattice that turns.
"""

import argparse
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
RADIUS, HALF = 1.0, 4.0  # m; of the hole, and of the square
KAPPA, STRAIN = 2.0, 1e-6  # (3 - nu) / (1 + nu) at nu = 1/3; far-field strain
SHIFTS = [(0.0, 0.0), (0.31, 0.17), (0.43, 0.38), (0.12, 0.47)]  # of the hole's centre, in spacings

# Kirsch's displacements over 2 STRAIN (1 + nu) / 8 = STRAIN / 3 at nu = 1/3, with RADIUS = 1 and R = r^2
RADIAL = "(sqrt(R)*({k}-1+2*C)+2*(1+(1+{k})*C)/sqrt(R)-2*C/R^1.5)".replace("{k}", f"{KAPPA:g}")
HOOP = "(-2*sqrt(R)+2*(1-{k})/sqrt(R)-2/R^1.5)*S".replace("{k}", f"{KAPPA:g}")
AMPLITUDE = STRAIN / 3


def kirsch(component: str) -> str:
    """Displacement along x or y as an expression of the position."""
    radial, hoop = (text.replace("C", "((x^2-y^2)/R)").replace("S", "(2*x*y/R)").replace("R", "(x^2+y^2)")
                    for text in (RADIAL, HOOP))  # fmt: skip
    along, across = ("x", "-y") if component == "x" else ("y", "x")
    return f"{AMPLITUDE!r}*(({radial})*{along}+({hoop})*({across}))/sqrt(x^2+y^2)"


def case(spacing: float, shift: tuple, volumes: str, surface: str, angle: float = 0.0) -> str:
    frame = 3.1 * spacing
    low = [-HALF - frame - part * spacing for part in shift]
    rows = math.ceil(2 * (HALF + frame) / spacing) + 1
    high = [at + rows * spacing for at in low]
    return f"""\
title = "Hole in an infinite plate"
dimension = 2
[lattice]
spacing = {spacing!r}
angle = {angle!r}
volumes = "{volumes}"
shape = [{{ add = "box", min = {low}, max = {high} }}, {{ subtract = "disk", centre = [0, 0], radius = {RADIUS} }}]
[quadrature]
surface_correction = "{surface}"
[material]
youngs_modulus = 1e9
[[set]]
name = "frame"
where = "max(abs(x), abs(y)) > {HALF}"
[[support]]
set = "frame"
displacement = ["{kirsch('x')}*load", "{kirsch('y')}*load"]
"""


def run(folder: Path, text: str):
    """Positions, volumes and displacements of a case."""
    path = folder / "case.toml"
    path.write_text(text)
    subprocess.run([PROGRAM, "run", path, "--output", folder / "out", "--overwrite", "--quiet", "--no-plots"], check=True)
    with h5py.File(folder / "out/results.h5") as file:
        step = file["steps"][sorted(file["steps"])[-1]]
        return file["points/reference"][:], file["points/volume"][:], step["displacement"][:]


def exact(places):
    x, y = places.T
    return numpy.stack([eval(kirsch(axis).replace("^", "**"), {"sqrt": numpy.sqrt, "x": x, "y": y}) for axis in "xy"], 1)


def rim_strain(places, displacement):
    """Mean over both places."""
    found = []
    for side in (-1, 1):
        near = numpy.hypot(places[:, 0], places[:, 1] - side * RADIUS) < 0.4 * RADIUS
        at = places[near] - [0, side * RADIUS]
        terms = numpy.column_stack([numpy.ones(len(at)), at, at[:, 0] ** 2, at[:, 0] * at[:, 1], at[:, 1] ** 2])
        terms = numpy.column_stack([terms, *(at[:, 0] ** k * at[:, 1] ** (3 - k) for k in range(4))])
        found.append(numpy.linalg.lstsq(terms, displacement[near, 0], rcond=None)[0][1])
    return numpy.mean(found)


def rim_errors(folder: Path, spacing: float, volumes: str, surface: str, angle: float):
    """Relative errors of the rim strain, one for each position of the lattice."""
    errors = []
    for shift in SHIFTS:
        places, _, displacement = run(folder, case(spacing, shift, volumes, surface, angle))
        errors.append(rim_strain(places, displacement) / rim_strain(places, exact(places)) - 1)
    return numpy.array(errors)


def tell_rim(folder: Path, levels: int, surface: str, angle: float) -> None:
    print(f"Rim strain, surface correction {surface}, lattice turned by {angle:g} degrees\n")
    print("| radius / spacing | stairs: mean | rms | order | spread | fractional: mean | rms | order | spread |")
    print("|---|---|---|---|---|---|---|---|---|")
    before = {}
    for level in range(levels):
        ratio = 5 * 2**level
        cells = []
        for volumes in ("cells", "fractional"):
            errors = rim_errors(folder, RADIUS / ratio, volumes, surface, angle)
            size = math.sqrt((errors**2).mean())
            order = f"{math.log2(before[volumes] / size):.2f}" if volumes in before else ""
            told = (f"{100 * errors.mean():+.2f} %", f"{100 * size:.2f} %", order, f"{100 * numpy.ptp(errors):.2f} %")
            cells += told
            before[volumes] = size
        print(f"| {ratio} | " + " | ".join(cells) + " |", flush=True)
    print()


def tell_volumes(folder: Path) -> None:
    """Volume of a plate with a hole, 4 x 2 with a hole of radius 0.6."""
    print("| angle | stairs | fractional |\n|---|---|---|")
    exactly = 8 - math.pi * 0.36
    for angle in (0, 10, 30, 45, 77, 90):
        cells = []
        for volumes in ("cells", "fractional"):
            text = f"""\
dimension = 2
lattice = {{ spacing = 0.1, angle = {angle}, volumes = "{volumes}", shape = [
  {{ add = "box", min = [-2, -1], max = [2, 1] }}, {{ subtract = "disk", centre = [0.03, 0.04], radius = 0.6 }}] }}
material = {{ youngs_modulus = 1e9 }}
set = [{{ name = "end", where = "x < -1.5" }}]
support = [{{ set = "end", displacement = [0, 0] }}]
"""
            _, volume, _ = run(folder, text)
            cells.append(f"{volume.sum() / exactly - 1:+.1e}")
        print(f"| {angle}° | " + " | ".join(cells) + " |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--levels", type=int, default=4, help="lattices, each twice as fine as the one before")
    levels = parser.parse_args().levels
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for surface, angle in (("none", 0.0), ("none", 25.0), ("energy", 0.0)):
            tell_rim(folder, levels, surface, angle)
        tell_volumes(folder)


if __name__ == "__main__":
    sys.exit(main())
