"""Three specimens of elastic brittle fracture beside phase fields: a square plate with a notch to its middle under

tension and under shear, and a notched beam in three-point bending [Miehe et al. 2010]. The references are the largest
loads that PhaseFieldX computes, and the displacements there, with its own length, which stands for a strength: no
experiment, and no closed form. Supports are those of its examples: under tension the moved edge is free across, under
shear the sides do not move across it. The material is that of the papers, with model `state` for its Poisson's ratio.
"""

import math
from pathlib import Path

from bending import mouth_sets
from other_setting import of_material, of_ratio
from setting import setting, under_opening
from specimen import Lattice, Measure, Specimen, aside, peak, rows

RATIO, MM = 0.3, 1e-3
STEEL, STEEL_ENERGY = 210e9, 2700.0  # Pa, J/m2
SOFT, SOFT_ENERGY = 20.8e9, 500.0
SIDE = 1.0 * MM
CLAMPED = 3  # spacings beyond the square, which are a horizon
HEIGHT, NOTCH, OUTER, INNER, PUSHED = 2.0 * MM, 0.4 * MM, 4.0 * MM, 3.9 * MM, 0.26 * MM
# Largest loads per thickness [N/m] and displacements there [m], PhaseFieldX, examples 1711, 1712 and 1714.
TENSION = (0.6915e6, 5.58e-6)
SHEAR = (0.495e6, 8.7e-6)
BENDING = (0.0352e6, 38.6e-6)


def material(text: str, modulus: float, energy: float) -> str:
    return of_ratio(of_material(text, modulus, energy), RATIO, "strain")


def square(moved: str, sides: str, weights: list[int], table: list[float], below: float):
    """The plate; `moved` is the displacement of its upper edge, and the opening and slip beside the notch's tip, by
    `weights`, take the values of `table` [m]."""

    def text(lattice: Lattice, h: float) -> str:
        half, clamp = 0.5 * SIDE, CLAMPED * h
        y = half + aside(lattice, h)
        edges = [("foot", "y < 0"), ("head", f"y > {SIDE}")]
        sets = "".join(f'[[set]]\nname = "{name}"\nwhere = "{where}"\n\n' for name, where in edges)
        behind = f"x > {half - 2.2 * h} && x < {half}"
        control = "".join(
            f'[[set]]\nname = "{name}"\nwhere = "{behind} && {way}*(y-{y}) > 0 && {way}*(y-{y}) < {1.1 * h}"\n\n'
            f'[[control]]\nset = "{name}"\nweights = {[way * weight for weight in weights]}\n\n'
            for name, way in (("above", 1), ("below", -1))
        )
        return material(setting(h, lattice, 1.0, ["foot", "head"]), STEEL, STEEL_ENERGY) + f"""
[[lattice.shape]]
add = "box"
min = [0.0, {-clamp}]
max = [{SIDE}, {SIDE + clamp}]

[[crack]]
from = [{-SIDE}, {y}]
to = [{half}, {y}]

{sets}[[support]]
set = "foot"
displacement = [0, 0]

[[support]]
set = "head"
displacement = {moved}

{sides.format(edge=1.1 * h, other=SIDE - 1.1 * h, top=SIDE)}{control}[loading]
table = {table}
steps = 25
stop_below = {below}
"""  # fmt: skip

    return text


HELD_SIDES = """\
[[set]]
name = "sides"
where = "(x < {edge} || x > {other}) && y > 0 && y < {top}"

[[support]]
set = "sides"
displacement = ["free", 0]

"""


def beam(lattice: Lattice, h: float) -> str:
    x = aside(lattice, h)
    half = h * math.ceil(OUTER / h)  # the notch lies between columns of points
    text = material(setting(h, lattice, 1.0, ["ends"]), SOFT, SOFT_ENERGY)
    places = {"left": (f"x < {-INNER} && y < {1.1 * h}", "[0, 0]"), "right": (f"x > {INNER} && y < {1.1 * h}", '["free", 0]'),
              "load": (f"abs(x) < {PUSHED} && y > {HEIGHT - 1.1 * h}", '["free", "-load"]')}  # fmt: skip
    supports = "".join(
        f'[[set]]\nname = "{name}"\nwhere = "{where}"\n\n[[support]]\nset = "{name}"\ndisplacement = {displacement}\n\n'
        for name, (where, displacement) in places.items()
    )
    return text + f"""
[[lattice.shape]]
add = "box"
min = [{-half}, 0.0]
max = [{half}, {HEIGHT}]

[[crack]]
from = [{x}, {-HEIGHT}]
to = [{x}, {NOTCH}]

[[set]]
name = "ends"
where = "abs(x) > {0.8 * OUTER} || (abs(x) < {0.3 * HEIGHT} && y > {0.8 * HEIGHT})"

{mouth_sets(x, h)}{supports}""" + under_opening("mouth_right", "mouth_left", "[1, 0]", 0.7 * BENDING[1], False)  # fmt: skip


def specimen(name: str, title: str, case, force: str, known: tuple[float, float], coarsest: float) -> Specimen:
    load, displacement = known

    def highest(folder: Path) -> float:
        return peak([abs(row[force]) for row in rows(folder)]) / load

    def moved(folder: Path) -> float:
        return max(rows(folder), key=lambda row: abs(row[force]))["load_factor"] / displacement

    measures = (
        Measure("peak load", highest, allowed=0.1, at=0.5),
        Measure("displacement at the peak", moved, allowed=0.1, at=0.5),
    )
    return Specimen(name, title, "PhaseFieldX", coarsest, case, measures, spacings=(1.0, 0.8, 0.5))


PULLED = square('["free", "load"]', "", [0, 1], [0, 1.5e-6, 6e-6], 0.85)
SHEARED = square('["load", 0]', HELD_SIDES, [1, 1], [0, 3e-6, 12e-6], 0.85)
SPECIMENS = [
    specimen("square_tension", "Notched square, tension", PULLED, "reaction_y:head", TENSION, SIDE / 40),
    specimen("square_shear", "Notched square, shear", SHEARED, "reaction_x:head", SHEAR, SIDE / 40),
    specimen("bending_phase_field", "Notched beam of the phase fields", beam, "reaction_y:load", BENDING, HEIGHT / 20),
]
