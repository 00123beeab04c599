"""Strength of a bar and a notched plate of concrete over `strength`: ./peristat build && /usr/bin/python3
benchmarks/strength.py"""

import os
import re
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.reference.case import Case  # noqa: E402
from tests.reference.laws import Law  # noqa: E402
from tests.reference.program import peristat  # noqa: E402
from tests.reference.pull import Pull, uniaxial  # noqa: E402
from tests.reference.results import Results  # noqa: E402
from tests.reference.sheets import Bulk  # noqa: E402

CONCRETE = """[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[material]
youngs_modulus = 30e9
[material.damage]
law = "linear"
fracture_energy = ENERGY
strength = 3e6
"""
BAR = f"""
title = "Bar of concrete, uniform tension"
dimension = 2
[lattice]
spacing = SPACING
thickness = 0.05
angle = ANGLE
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.2, 0.1]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
{CONCRETE}no_fail = ["left", "right"]
[[set]]
name = "mid"
where = "abs(x - 0.1) < spacing && abs(y - 0.05) < spacing"
[[support]]
set = "left"
displacement = [0, "free"]
[[support]]
set = "right"
displacement = ["1.2e-4*load", "free"]
[[support]]
set = "mid"
displacement = ["free", 0]
[loading]
steps = 30
stop_below = 0.8
[solver]
mode = "adaptive"
[relaxation]
steps = 60
"""
PLATE = f"""
title = "Plate of concrete with two edge notches under tension"
dimension = 2
[lattice]
spacing = 2.5e-3
thickness = 0.05
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.2, 0.2]
[[lattice.layer]]
name = "bottom"
side = "y-"
[[lattice.layer]]
name = "top"
side = "y+"
[[crack]]
from = [-0.01, 0.1]
to = [0.025, 0.1]
[[crack]]
from = [0.175, 0.1]
to = [0.21, 0.1]
{CONCRETE}no_fail = ["bottom", "top"]
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = [0, "1e-4*load"]
[loading]
steps = 20
[solver]
mode = "adaptive"
"""
STRENGTH, THICKNESS = 3e6, 0.05
LIGAMENT, MOST = 0.15 * THICKNESS, 1.03  # of the plate [m2], and largest stress over the strength
MODULUS, ACROSS = 30e9, uniaxial([1, 0])
# Rows of points at 18.43 degrees to the lattice are nearly parallel to the bar. With 5 mm, the distance between rows
# that end on a free face is 0.21 m at 18 degrees and 0.39 m at 18.2.
BARS = [(angle, energy, 5e-3) for angle in (0, 18, 18.2, 45) for energy in (30, 110, 440)] + [(18, 110, 2.5e-3), (18.2, 110, 2.5e-3)]


def run(text, reaction):
    """The largest reaction [N], the points of the body, and the stretches and strengths [Pa] printed by `check`."""
    with tempfile.TemporaryDirectory() as folder:
        case, output = Path(folder, "case.toml"), Path(folder, "out")
        case.write_text(text)
        check = peristat("check", case)
        ended = peristat("run", case, "--output", output, "--threads", 1, "--quiet", "--no-plots", seconds=1800)
        assert check.code == ended.code == 0, check.said + ended.said
        results = Results(output)
        force = max(row[f"reaction_{reaction}"] for row in results.table("history"))
        number = r"([0-9.e+-]+)"
        told = re.search(rf"onset {number}, critical stretch {number}: .* directions of a pull \({number} to {number}\)", check.output)
        return force, results.steps[0].damage.size, [float(word) for word in told.groups()]


def bulk(text, onset, critical):
    """Largest stress of bonds deep inside a lattice under uniaxial tension along x, by independent means [Pa]."""
    inside = Bulk(Case(text))
    return MODULUS * inside.of_modulus * Pull.of_bulk(inside).peak(Law("linear", onset, critical, 3.0), ACROSS)


def bar(angle, energy, spacing):
    text = BAR.replace("ANGLE", str(angle)).replace("ENERGY", str(energy)).replace("SPACING", str(spacing))
    force, points, (onset, critical, least, most) = run(text, "x:right")
    area = points * spacing**2 * THICKNESS / (0.2 + 2 * 3 * spacing)  # with the layers
    figures = [force / 5e-3, force / area, bulk(text, onset, critical), least, most]
    words = "| {} | {} | {:g} | {:.3f} | {:.3f} | {:.3f} | {:.3f} to {:.3f} |"
    return words.format(angle, energy, 1e3 * spacing, *(figure / 1e6 for figure in figures))


def plate():
    force, _, (_, _, least, most) = run(PLATE.replace("ENERGY", "110"), "y:top")
    nominal = STRENGTH * LIGAMENT
    word = "met" if force <= MOST * nominal else "missed"
    return (f"plate with notches: {force / 1e3:.2f} kN, {force / nominal:.3f} of strength times ligament; at most {MOST}: {word}; "
            f"`check` tells {least / 1e6:.3f} to {most / 1e6:.3f} MPa")  # fmt: skip


def main():
    print("| angle [°] | fracture_energy [J/m2] | spacing [mm] | over 5e-3 m2 [MPa] | over the area by volume [MPa] "
          "| bulk along the bar [MPa] | `check` tells over directions [MPa] |\n|---|---|---|---|---|---|---|")  # fmt: skip
    for case in BARS:
        print(bar(*case), flush=True)
    print(f"\n{plate()}")


if __name__ == "__main__":
    main()
