"""Square plate of concrete with a notch in each of two sides, sheared between two frames that stay parallel, one along

its upper and its left upper side, the other opposite: load path 4c of [Nooru-Mohamed 1992], which first bears the
largest shear force without a force across. Constants and that force as in the gallery of OOFEM, the fracture energy as
in other simulations of this test."""

from pathlib import Path

from other_setting import of_material
from setting import setting
from specimen import Lattice, Measure, Specimen, aside, peak, rows

MODULUS, FRACTURE_ENERGY, TENSILE = 29e9, 110.0, 3e6
SIDE, NOTCH, SLIT, THICKNESS = 0.2, 0.025, 0.005, 0.05
LARGEST = 0.2e-3  # m, opening and slip of both notches
FORCE = 27.5e3  # N, measured


def text(lattice: Lattice, h: float) -> str:
    half, edge, y = 0.5 * SIDE, 1.1 * h, aside(lattice, h)
    concrete = of_material(setting(h, lattice, THICKNESS, ["upper", "lower"]), MODULUS, FRACTURE_ENERGY, TENSILE)
    return concrete + f"""
[[lattice.shape]]
add = "box"
min = [{-half}, {-half}]
max = [{half}, {half}]

[[crack]]
from = [{-SIDE}, {y}]
to = [{-half + NOTCH}, {y}]

[[crack]]
from = [{half - NOTCH}, {y}]
to = [{SIDE}, {y}]

[[set]]
name = "upper"
where = "y > {half - edge} || (x < {-half + edge} && y > {0.5 * SLIT})"

[[set]]
name = "lower"
where = "y < {-half + edge} || (x > {half - edge} && y < {-0.5 * SLIT})"

[[rigid]]
set = "upper"
displacement = ["load", "free"]
rotation = [0]

[[rigid]]
set = "lower"
displacement = [0, 0]
rotation = [0]

{controls(h, y)}[loading]
table = [0, {LARGEST}]
steps = 30
stop_below = 0.95
"""  # fmt: skip


def controls(h: float, y: float) -> str:
    """Opening plus slip of both notches near their tips, across them."""
    tip = 0.5 * SIDE - NOTCH
    sides = {"left": f"x < {-tip} && x > {-tip - 2 * h}", "right": f"x > {tip} && x < {tip + 2 * h}"}
    return "".join(
        f'[[set]]\nname = "{name}_{place}"\nwhere = "{where} && {sign}*(y-({y})) > 0 && {sign}*(y-({y})) < {1.1 * h}"\n\n'
        f'[[control]]\nset = "{name}_{place}"\nweights = [{sign}, {sign}]\n\n'
        for name, where in sides.items() for place, sign in (("above", 1), ("below", -1))
    )  # fmt: skip


def load(folder: Path) -> float:
    return peak([abs(row["reaction_x:upper"]) for row in rows(folder)]) / FORCE


SPECIMENS = [
    Specimen("double_edge_notch", "Sheared plate with two notches", "Nooru-Mohamed, path 4c", SIDE / 42, text,
             (Measure("largest shear force", load, allowed=0.1, at=0.5),), spacings=(1.0, 0.7, 0.5)),
]  # fmt: skip
