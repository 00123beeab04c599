"""Panel with a central crack, pulled at its ends, under control of the opening at the crack's middle. Along the
lattice only half of it up to a plane of symmetry is modelled, with one tip; a turned lattice cannot continue beyond
such a plane."""

from pathlib import Path

import lefm
from setting import FRACTURE_ENERGY, MODULUS, setting, under_opening
from specimen import Lattice, Measure, Specimen, aside, peak, rows

WIDTH, HEIGHT, THICKNESS = 0.04, 0.1, 1e-3
CRACK = 0.25 * WIDTH  # half length
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)


def load(crack: float) -> float:
    return lefm.panel_load(TOUGHNESS, WIDTH, crack, THICKNESS)


def has_one_tip(lattice: Lattice) -> bool:
    return lattice.angle == 0.0


HALF = """\
[[symmetry]]
axis = "x"
"""
WHOLE = f"""\
[[set]]
name = "corner"
where = "abs(x) < 1.1 * spacing && y < {-0.5 * HEIGHT} + 1.5 * spacing"

[[support]]
set = "corner"
displacement = [0, "-load"]
"""


def text(lattice: Lattice, h: float) -> str:
    y = aside(lattice, h)
    opening = 4 * load(CRACK) / (WIDTH * THICKNESS) * CRACK / MODULUS  # at the middle of a crack in a wide panel
    return setting(h, lattice, THICKNESS, ["ends"]) + f"""
[[lattice.shape]]
add = "box"
min = [{0.0 if has_one_tip(lattice) else -0.5 * WIDTH}, {-0.5 * HEIGHT}]
max = [{0.5 * WIDTH}, {0.5 * HEIGHT}]

[[crack]]
from = [{-CRACK}, {y}]
to = [{CRACK}, {y}]

[[set]]
name = "ends"
where = "abs(y) > {0.3 * HEIGHT}"

[[set]]
name = "top"
where = "y > {0.5 * HEIGHT - 1.5 * h}"

[[set]]
name = "bottom"
where = "y < {-0.5 * HEIGHT + 1.5 * h}"

[[set]]
name = "above"
where = "abs(x) < {1.5 * h} && y > {y} && y < {y + 1.5 * h}"

[[set]]
name = "below"
where = "abs(x) < {1.5 * h} && y < {y} && y > {y - 1.5 * h}"

[[support]]
set = "top"
displacement = ["free", "load"]

[[support]]
set = "bottom"
displacement = ["free", "-load"]

{HALF if has_one_tip(lattice) else WHOLE}
""" + under_opening("above", "below", "[0, 1]", 2.5 * opening, follow_growth=False)  # fmt: skip


def value(folder: Path) -> float:
    history = rows(folder)
    share = 0.5 if "reaction_y:symmetry_x" in history[0] else 1.0
    return peak([abs(row["reaction_y:top"]) for row in history]) / (share * load(CRACK))


SPECIMENS = [
    Specimen(
        name="centre_crack",
        title="Panel with a central crack, 2a/W = 0.5",
        reference="Tada, Paris and Irwin",
        coarsest=WIDTH / 20,
        case=text,
        measures=(Measure("peak load", value, of_longer_crack=lambda by: load(CRACK + by) / load(CRACK)),),
    )
]
