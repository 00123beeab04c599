"""Disk with a central crack along the line on which two points compress it, under control of the opening at the crack's
middle [Atkinson et al. 1982]. The run ends at its peak: once split, the halves bear more than the whole disk. One of
the two tips cannot grow: otherwise round-off would decide which tip runs."""

import math
from pathlib import Path

import lefm
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import Lattice, Measure, Specimen, aside, peak, rows

RADIUS, THICKNESS, SHARE = 0.02, 1e-3, 0.5
CRACK = SHARE * RADIUS  # half length
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)
FACTORS = {0.0: 1.0, 0.2: 1.0600, 0.3: 1.1356, 0.4: 1.2431, 0.5: 1.3872, 0.6: 1.5783}  # by a / R


def factor(share: float) -> float:
    """N_I of K = P sqrt(a) N_I / (sqrt(pi) R B): the polynomial of (a/R)^2 through the table."""
    x = {at**2: value for at, value in FACTORS.items()}
    return sum(value * math.prod((share**2 - other) / (at - other) for other in x if other != at) for at, value in x.items())


def load(crack: float) -> float:
    return TOUGHNESS * math.sqrt(math.pi / crack) * RADIUS * THICKNESS / factor(crack / RADIUS)


def text(lattice: Lattice, h: float) -> str:
    x = aside(lattice, h)
    opening = 4 * load(CRACK) / (math.pi * RADIUS * THICKNESS) * CRACK / MODULUS  # such a crack in a wide plate
    return setting(h, lattice, THICKNESS, ["elastic"]) + f"""
[[lattice.shape]]
add = "disk"
centre = [0.0, 0.0]
radius = {RADIUS}

[[crack]]
from = [{x}, {-CRACK}]
to = [{x}, {CRACK}]

[[set]]
name = "elastic"
where = "abs(y) > {0.8 * RADIUS} || y < 0"

[[set]]
name = "right"
where = "x > {x} && x < {x + 1.5 * h} && abs(y - {0.7 * CRACK}) < {1.5 * h}"

[[set]]
name = "left"
where = "x < {x} && x > {x - 1.5 * h} && abs(y - {0.7 * CRACK}) < {1.5 * h}"

[[roller]]
name = "load"
at = [0.0, {RADIUS}]
normal = [0, 1]
displacement = "-load"

[[roller]]
name = "top_middle"
at = [0.0, {RADIUS}]
normal = [1, 0]

[[roller]]
name = "bottom"
at = [0.0, {-RADIUS}]
normal = [0, 1]

[[roller]]
name = "bottom_middle"
at = [0.0, {-RADIUS}]
normal = [1, 0]

[[control]]
set = "right"
weights = [1, 0]

[[control]]
set = "left"
weights = [-1, 0]

[loading]
table = [0, {2.2 * opening:.6g}]
steps = 22
stop_below = 0.985
"""  # fmt: skip


def value(folder: Path) -> float:
    return peak([abs(row["reaction_y:load"]) for row in rows(folder)]) / load(CRACK)


SPECIMENS = [
    Specimen(
        name="brazilian_disk",
        title="Brazilian disk, a/R = 0.5",
        reference="Atkinson et al.",
        coarsest=RADIUS / 16,
        case=text,
        measures=(Measure("peak load", value, of_longer_crack=lambda by: load(CRACK + by) / load(CRACK)),),
    )
]
