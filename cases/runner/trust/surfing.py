"""Surfing boundary condition: the field of a crack moves steadily through a strip, and the crack after it
[Hossain, Hsueh, Bourdin and Bhattacharya 2014]. J on the way is what the crack resists with."""

from pathlib import Path

import lefm
from setting import FRACTURE_ENERGY, MODULUS, POISSON_RATIO, setting
from specimen import Lattice, Measure, Specimen, aside, rows

THICKNESS, HORIZON = 1e-3, 3.015e-3
# In horizons of the coarsest lattice: half height, half length, and how far the field goes.
HEIGHT, LENGTH, WAY = 10.0, 13.0, 8.0
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)


def text(lattice: Lattice, h: float) -> str:
    y, unit = aside(lattice, h), h * lattice.ratio
    height, length, way = HEIGHT * unit, LENGTH * unit, WAY * unit
    x, across = f"x-({-0.5 * way:.17g}+{way:.17g}*load)", f"y-({y:.17g})"
    u, v = lefm.williams_opening(TOUGHNESS, MODULUS, POISSON_RATIO, x, across)
    start = -0.5 * way
    return setting(h, lattice, THICKNESS, ["rim"]) + f"""
[[lattice.shape]]
add = "box"
min = [{-length}, {-height}]
max = [{length}, {height}]

[[crack]]
from = [{-2 * length}, {y}]
to = [{start}, {y}]

[[set]]
name = "rim"
where = "abs(x) > {length - 1.05 * unit} || abs(y) > {height - 1.05 * unit}"

[[support]]
set = "rim"
displacement = ["{u}", "{v}"]

[[crack_tip]]
name = "tip"
at = [0.0, {y}]
direction = [1, 0]
inner = {6.5 * unit}
outer = {8.5 * unit}

[loading]
steps = 40
"""  # fmt: skip


def resistance(folder: Path) -> float:
    """sqrt(J / G_c) where the crack runs steadily: mean over the last half of the way."""
    found = [row["tip_J"] for row in rows(folder)]
    steady = found[len(found) // 2 :]
    return (sum(steady) / len(steady) / FRACTURE_ENERGY) ** 0.5


SPECIMENS = [
    Specimen(
        name="surfing",
        title="Steady crack in a strip",
        reference="G_c as given",
        coarsest=1e-3,
        case=text,
        measures=(Measure("sqrt(J / G_c)", resistance, allowed=0.03, on_every_lattice=True),),
    )
]
