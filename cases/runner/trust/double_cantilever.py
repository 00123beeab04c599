"""Double cantilever, whose ends are driven apart: its crack grows stably along a groove."""

from pathlib import Path

import lefm
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import Lattice, Measure, Specimen, aside, rows

ARM, LENGTH, THICKNESS = 0.01, 0.08, 1e-3
FIRST, LAST = 0.025, 0.038  # crack lengths from and to which it is followed


def opening(crack: float) -> float:
    """At which the crack is that long: the inverse of lefm.cantilever_crack."""
    return 4 * (crack + 0.64 * ARM) ** 2 * (FRACTURE_ENERGY / (3 * MODULUS * ARM**3)) ** 0.5


def text(lattice: Lattice, h: float) -> str:
    y = aside(lattice, h)
    groove = 1.05 * h * lattice.ratio
    return setting(h, lattice, THICKNESS, ["outside"]) + f"""
[[lattice.shape]]
add = "box"
min = [0.0, {-ARM}]
max = [{LENGTH}, {ARM}]

[[crack]]
from = [{-ARM}, {y}]
to = [{FIRST}, {y}]

[[set]]
name = "outside"
where = "abs(y - {y}) > {groove}"

[[set]]
name = "upper"
where = "x < {1.5 * h} && abs(y - {0.5 * ARM}) < {1.01 * h}"

[[set]]
name = "lower"
where = "x < {1.5 * h} && abs(y + {0.5 * ARM}) < {1.01 * h}"

[[set]]
name = "end"
where = "x > {LENGTH - 1.5 * h} && abs(y) < {1.01 * h}"

[[support]]
set = "upper"
displacement = ["free", "{0.5 * opening(LAST):.9g}*load"]

[[support]]
set = "lower"
displacement = ["free", "{-0.5 * opening(LAST):.9g}*load"]

[[support]]
set = "end"
displacement = [0, "free"]

[loading]
steps = 40
"""  # fmt: skip


def value(folder: Path) -> float:
    """Mean of P over that of the cantilever at the same opening, where the crack has grown by half an arm."""
    found = []
    for row in rows(folder):
        apart = row["load_factor"] * opening(LAST)
        crack = lefm.cantilever_crack(MODULUS, FRACTURE_ENERGY, ARM, apart)
        if crack > FIRST + 0.5 * ARM:
            found.append(row["reaction_y:upper"] / lefm.cantilever_load(MODULUS, ARM, THICKNESS, crack, apart))
    return sum(found) / len(found)


SPECIMENS = [
    Specimen(
        name="double_cantilever",
        title="Double cantilever",
        reference="Kanninen",
        coarsest=ARM / 10,
        case=text,
        measures=(Measure("load while the crack grows", value, allowed=0.01, on_every_lattice=True),),
    )
]
