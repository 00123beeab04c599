"""Compact-tension specimen on two rotating pins, ASTM E399, under control of its mouth opening."""

from pathlib import Path

import lefm
from compliance import LEAST_GROWTH, elastic_factor, toughness
from setting import FRACTURE_ENERGY, MODULUS, setting, under_opening
from specimen import MIDDLE, RATIOS, SPACINGS, Lattice, Measure, Specimen, aside, peak, rows

WIDTH, THICKNESS = 0.04, 1e-3
CRACK = 0.5 * WIDTH
GROWN = LEAST_GROWTH * RATIOS[0] * MIDDLE * WIDTH / 20
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)


def load(crack: float) -> float:
    return lefm.tension_load(TOUGHNESS, WIDTH, crack, THICKNESS)


def text(lattice: Lattice, h: float) -> str:
    y = aside(lattice, h)
    mouth = load(CRACK) * lefm.tension_opening(CRACK / WIDTH) / (MODULUS * THICKNESS)
    return setting(h, lattice, THICKNESS, ["arms"]) + f"""
[[lattice.shape]]
add = "box"
min = [{-0.25 * WIDTH}, {-0.6 * WIDTH}]
max = [{WIDTH}, {0.6 * WIDTH}]

[[crack]]
from = [{-WIDTH}, {y}]
to = [{CRACK}, {y}]

[[set]]
name = "arms"
where = "x < {0.3 * WIDTH}"

[[set]]
name = "upper"
where = "x^2 + (y - {0.275 * WIDTH})^2 < {0.125 * WIDTH}^2"

[[set]]
name = "lower"
where = "x^2 + (y + {0.275 * WIDTH})^2 < {0.125 * WIDTH}^2"

[[set]]
name = "mouth_above"
where = "x < {-0.25 * WIDTH + 1.5 * h} && y > {y} && y < {y + 1.5 * h}"

[[set]]
name = "mouth_below"
where = "x < {-0.25 * WIDTH + 1.5 * h} && y < {y} && y > {y - 1.5 * h}"

[[rigid]]
set = "upper"
centre = [0.0, {0.275 * WIDTH}]
displacement = [0, "load"]

[[rigid]]
set = "lower"
centre = [0.0, {-0.275 * WIDTH}]
displacement = [0, "-load"]

""" + under_opening("mouth_above", "mouth_below", "[0, 1]", 2 * mouth, lattice.refinement >= MIDDLE)  # fmt: skip


def highest(folder: Path) -> float:
    return peak([abs(row["reaction_y:upper"]) for row in rows(folder)]) / load(CRACK)


def growing(folder: Path) -> float:
    """Stiffness of the whole specimen relative to its closed form: the discs around the pins rotate rigidly and stiffen
    the arms."""
    force, opening = "reaction_y:upper", lambda a: lefm.tension_opening(a / WIDTH) / (MODULUS * THICKNESS)
    stiffer = elastic_factor(folder, force, opening(CRACK))
    return toughness(folder, force, lambda a: stiffer * opening(a), load, CRACK, 0.85 * WIDTH, GROWN)


SPECIMENS = [
    Specimen(
        name="compact_tension",
        title="Compact tension, a/W = 0.5",
        reference="ASTM E399",
        coarsest=WIDTH / 20,
        case=text,
        measures=(
            Measure("peak load", highest, of_longer_crack=lambda by: load(CRACK + by) / load(CRACK)),
            Measure("toughness by compliance", growing, allowed=0.03, at=MIDDLE),
        ),
        spacings=(*SPACINGS, 0.125),
    )
]
