"""Directions in which a crack goes on in mixed mode, on lattices and between points without rows.

  ./peristat build && /usr/bin/python3 -m benchmarks.lattice_rows

The rim of a disk of 36 spacings moves with Williams' fields of K_II/K_I = 0.344 and a T-stress; bonds soften linearly.
"""

import csv
import math
import pathlib
import subprocess
import tempfile

import h5py
import numpy

from tests.reference.program import PROGRAM

E, NU, ENERGY = 70e9, 1 / 3, 10.0
SPACING, RADIUS, MIX = 1e-3, 0.036, 0.344
HORIZON = 3.015 * SPACING
LARGEST = 1.8  # K at load 1 over sqrt(E G_c)
CASE = """\
dimension = 2
[lattice]
spacing = {spacing}
thickness = 1e-3
{points}
[[lattice.shape]]
add = "disk"
centre = [0, 0]
radius = {radius}
[[set]]
name = "rim"
where = "sqrt(x^2+y^2) > {inner}"
[[crack]]
from = [-0.05, 0]
to = [0, 0]
[material]
youngs_modulus = {modulus}
[material.damage]
law = "linear"
fracture_energy = {energy}
no_fail = ["rim"]
[quadrature]
volume_correction = "linear"
[[support]]
set = "rim"
displacement = ["{along}", "{across}"]
[loading]
steps = 40
[[crack_tip]]
name = "tip"
at = [0, 0]
direction = [1, 0]
"""


def case(points, t_star):
    k = LARGEST * math.sqrt(E * ENERGY)
    one, two, strain = k / math.hypot(1, MIX), -k * MIX / math.hypot(1, MIX), t_star * k / math.sqrt(math.pi * HORIZON) / E
    shear, kolosov = E / (2 * (1 + NU)), (3 - NU) / (1 + NU)
    size, sine, cosine = f"sqrt(sqrt(x^2+y^2)/(2*pi))/{2 * shear}", "sin(atan2(y,x)/2)", "cos(atan2(y,x)/2)"
    along = f"{one}*{cosine}*({kolosov - 1}+2*{sine}^2)+{two}*{sine}*({kolosov + 1}+2*{cosine}^2)"
    across = f"{one}*{sine}*({kolosov + 1}-2*{cosine}^2)-{two}*{cosine}*({kolosov - 1}-2*{sine}^2)"
    return CASE.format(spacing=SPACING, points=points, radius=RADIUS, inner=RADIUS - HORIZON, modulus=E, energy=ENERGY,
                       along=f"load*({size}*({along})+{strain}*x)", across=f"load*({size}*({across})-{NU * strain}*y)")  # fmt: skip


def run(text):
    """T*, and the slope of a line through the broken bonds 2 to 7 horizons from the tip [degrees]."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "case.toml").write_text(text)
        subprocess.run([PROGRAM, "run", folder / "case.toml", "--quiet", "--no-plots", "--output", folder / "out"], check=True)
        with open(folder / "out/history.csv") as file:
            t_star = float(list(csv.DictReader(file))[1]["tip_T_star"])
        with h5py.File(folder / "out/results.h5") as file:
            place = file["points/reference"][:]
            middle = (place[file["broken_bonds/first_point"][:]] + place[file["broken_bonds/second_point"][:]]) / 2
    distance = numpy.hypot(*middle.T) / HORIZON
    x, y = middle[(distance > 2) & (distance < 7) & (middle[:, 0] > 0)].T
    return t_star, math.degrees(math.atan(numpy.polyfit(x, y, 1)[0])), distance.max()


def main():
    print("| points | T* given | T* found | direction [degrees] | farthest broken bond [horizons] |\n|---|---|---|---|---|")
    for points, name in (("angle = 0", "lattice, 0°"), ("angle = 18", "lattice, 18°"), ('points = "blue_noise"', "blue noise, seed 1"),
                         ('points = "blue_noise"\nseed = 2', "blue noise, seed 2")):  # fmt: skip
        for t_star in (0.0, -0.1, -0.2):
            found, angle, farthest = run(case(points, t_star))
            print(f"| {name} | {t_star} | {found:.3f} | {angle:.1f} | {farthest:.1f} |", flush=True)


if __name__ == "__main__":
    main()
