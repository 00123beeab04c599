"""Double cantilever whose ends are driven apart: its crack grows stably along a groove, because only bonds that cross
the groove can fail. Compared are the load and the energy dissipated by bonds."""

import math
from pathlib import Path

from other_setting import grooved
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import Lattice, Measure, Specimen, aside, lattice_of, rows

ARM, LENGTH, THICKNESS = 0.01, 0.066, 1e-3
FIRST, LAST = 0.025, 0.044  # crack lengths between which the growth is followed
ROOT = 0.673  # extra crack length for the rotation of an arm's root, over the arm's height [Foote and Buchwald 1985]


def longer(crack: float) -> float:
    return crack + ROOT * ARM


def opening(crack: float, modulus: float = MODULUS) -> float:
    """Opening at which G = 3 E h^3 D^2 / (16 a'^4) is the fracture energy."""
    return 4 * longer(crack) ** 2 * (FRACTURE_ENERGY / (3 * modulus * ARM**3)) ** 0.5


def elastic_load(crack: float, apart: float, modulus: float = MODULUS) -> float:
    return modulus * THICKNESS * ARM**3 * apart / (8 * longer(crack) ** 3)


def growing_load(apart: float, modulus: float) -> float:
    """P of arms whose ends are `apart` while G is the fracture energy, for any compliance of their root."""
    arm = (3 * modulus * ARM**3 * apart**2 / (16 * FRACTURE_ENERGY)) ** 0.25
    return modulus * THICKNESS * ARM**3 * apart / (8 * arm**3)


def text(lattice: Lattice, h: float) -> str:
    y = aside(lattice, h)
    case = setting(h, lattice, THICKNESS, []) + f"""
[[lattice.shape]]
add = "box"
min = [0.0, {-ARM}]
max = [{LENGTH}, {ARM}]

[[crack]]
from = [{-ARM}, {y}]
to = [{FIRST}, {y}]

[[set]]
name = "upper"
where = "x < {1.5 * h} && abs(y - {0.5 * ARM}) < {1.01 * h}"

[[set]]
name = "lower"
where = "x < {1.5 * h} && abs(y + {0.5 * ARM}) < {1.01 * h}"

[[set]]
name = "end"
where = "x > {LENGTH - 1.5 * h} && abs(y) < {1.01 * h}"

[[set]]
name = "beside"
where = "abs(y) < {2 * h * lattice.ratio}"

[[support]]
set = "upper"
displacement = ["free", "{0.5 * opening(LAST):.9g}*load"]

[[support]]
set = "lower"
displacement = ["free", "{-0.5 * opening(LAST):.9g}*load"]

[[support]]
set = "end"
displacement = [0, "free"]

[[probe]]
name = "tip"
set = "beside"
field = "crack_end"
axis = "x"

[loading]
table = [0, 0.4, 0.55, 0.7, 0.85, 1.0]
steps = 7
"""  # fmt: skip
    return grooved(case, y)


def load_while_growing(folder: Path) -> float:
    """Mean of P over that of a cantilever with the same initial stiffness, once the crack has grown by half an arm."""
    found = rows(folder)
    apart = [row["load_factor"] * opening(LAST) for row in found]
    modulus = MODULUS * found[0]["reaction_y:upper"] / elastic_load(FIRST, apart[0])
    shares = [row["reaction_y:upper"] / growing_load(gap, modulus) for row, gap in zip(found, apart)
              if gap > opening(FIRST + 0.5 * ARM, modulus)]  # fmt: skip
    return sum(shares) / len(shares)


def energy_over_area(folder: Path) -> float:
    """Slope of the dissipated energy over the tip's position once the crack has grown by a quarter of an arm, over the
    energy of a straight tear in the direction of the crack: G_c is the mean over all directions."""
    found = [row for row in rows(folder) if row["tip"] > FIRST + 0.25 * ARM]
    taken = slope([row["tip"] for row in found], [row["dissipated_energy"] for row in found]) / THICKNESS
    lattice = lattice_of(folder)
    return taken / (FRACTURE_ENERGY * share_of_direction(lattice["horizon_ratio"], math.radians(lattice["angle"])))


def share_of_direction(ratio: float, angle: float, samples: int = 720) -> float:
    """Energy of a straight tear at an angle to the lattice over the mean of all angles. The number of bonds across it
    is proportional to |xi . n|, and the energy of each to |xi| times its volume weight."""
    reach = range(-math.ceil(ratio), math.ceil(ratio) + 1)
    bonds = [(i, j, math.hypot(i, j)) for i in reach for j in reach if (i, j) != (0, 0)]
    weighted = [(i, j, length * min(max(ratio + 0.5 - length, 0.0), 1.0)) for i, j, length in bonds]
    taken = lambda turn: sum(weight * abs(j * math.cos(turn) - i * math.sin(turn)) for i, j, weight in weighted)
    return taken(angle) / (sum(taken(math.pi * (k + 0.5) / samples) for k in range(samples)) / samples)


def slope(x: list[float], y: list[float]) -> float:
    """Slope of the least-squares line."""
    x_mean, y_mean = sum(x) / len(x), sum(y) / len(y)
    return sum((a - x_mean) * (b - y_mean) for a, b in zip(x, y)) / sum((a - x_mean) ** 2 for a in x)


SPECIMENS = [
    Specimen(
        name="double_cantilever",
        title="Double cantilever",
        reference="beam theory, stiffness as measured; G_c of a straight tear",
        coarsest=ARM / 10,
        case=text,
        measures=(
            Measure("load while the crack grows", load_while_growing, allowed=0.01, on_every_lattice=True),
            Measure("dissipated energy over area", energy_over_area, allowed=0.01, on_every_lattice=True),
        ),
    )
]
