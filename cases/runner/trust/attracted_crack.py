"""Beam with three holes in three-point bending, whose eccentric crack ends in the middle hole, as in beams of PMMA
[Ingraffea and Grigoriu 1990]. The measured path is not available as numbers, so the criterion is whether the crack
meets that hole."""

import math
from pathlib import Path

import crack_path
from bending import mouth_sets, rollers
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import Lattice, Measure, Specimen, aside, lattice_of

INCH, THICKNESS = 0.0254, 0.0127
HALF, DEPTH, SUPPORT = 10 * INCH, 8 * INCH, 9 * INCH
HOLES, RADIUS = [(-4 * INCH, y * INCH) for y in (2.75, 4.75, 6.75)], 0.25 * INCH
NOTCH, ASIDE = 1.5 * INCH, -5 * INCH
OPENING = 4 * math.sqrt(FRACTURE_ENERGY * NOTCH / (math.pi * MODULUS))  # such a crack in a wide plate at failure


def text(lattice: Lattice, h: float) -> str:
    x = ASIDE + aside(lattice, h)
    holes = "".join(f'[[lattice.shape]]\nsubtract = "disk"\ncentre = [{a}, {b}]\nradius = {RADIUS}\n\n' for a, b in HOLES)
    return setting(h, lattice, THICKNESS, ["contacts"]) + f"""
[[lattice.shape]]
add = "box"
min = [{-HALF}, 0.0]
max = [{HALF}, {DEPTH}]

{holes}[[crack]]
from = [{x}, {-NOTCH}]
to = [{x}, {NOTCH}]

[[set]]
name = "contacts"
where = "(abs(x) > {0.8 * HALF} && y < {0.2 * DEPTH}) || (abs(x) < {0.1 * HALF} && y > {0.85 * DEPTH})"

{mouth_sets(x, h)}{rollers(SUPPORT, DEPTH)}[[control]]
set = "mouth_right"
weights = [1, 0]

[[control]]
set = "mouth_left"
weights = [-1, 0]

[loading]
table = [0, {OPENING:.6g}, {2 * OPENING:.6g}, {4 * OPENING:.6g}, {8 * OPENING:.6g}, {16 * OPENING:.6g}]
steps = 12
stop_below = 0.25
"""  # fmt: skip


def missed_by(folder: Path) -> float:
    """1 + the distance of the crack from the rim of the middle hole, in horizons."""
    lattice = lattice_of(folder)
    away = [math.dist(place, HOLES[1]) - RADIUS for place in crack_path.broken_middles(folder)]
    return 1 + max(min(away), 0.0) / (lattice["spacing"] * lattice["horizon_ratio"])


SPECIMENS = [
    Specimen(
        name="attracted_crack",
        title="Beam with three holes",
        reference="Ingraffea and Grigoriu, PMMA",
        coarsest=0.2 * INCH,
        case=text,
        measures=(Measure("1 + distance from the middle hole in horizons", missed_by, allowed=1.0, at=0.64),),
        spacings=(1.0, 0.8, 0.64),
    )
]
