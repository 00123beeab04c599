"""Three specimens of elastic brittle fracture beside phase fields: a square plate with a notch to its middle under

tension and under shear, and a notched beam in three-point bending [Miehe et al. 2010]. The references are the largest
loads that PhaseFieldX computes with its own length, which stands for a strength: no experiment, and no closed form.
The material is that of the papers, with model `state` for its Poisson's ratio.
"""

from pathlib import Path

from bending import mouth_sets, rollers
from other_setting import of_material, of_ratio
from setting import setting, under_opening
from specimen import Lattice, Measure, Specimen, aside, peak, rows

RATIO, MM = 0.3, 1e-3
STEEL, STEEL_ENERGY = 210e9, 2700.0  # Pa, J/m2
SOFT, SOFT_ENERGY = 20.8e9, 500.0
SIDE, CLAMP = 1.0 * MM, 0.04 * MM
SPAN, HEIGHT, NOTCH = 8.0 * MM, 2.0 * MM, 0.4 * MM
# Largest loads per thickness [N/m] and displacements there [m], PhaseFieldX, examples 1711, 1712 and 1714.
TENSION = (0.6915e6, 5.58e-6)
SHEAR = (0.495e6, 8.7e-6)
BENDING = (0.0352e6, 38.6e-6)


def material(text: str, modulus: float, energy: float) -> str:
    return of_ratio(of_material(text, modulus, energy), RATIO, "strain")


def square(direction: int, largest: float):
    """The plate; its upper edge moves along x (0) or y (1) by up to `largest`, and not across that."""

    def text(lattice: Lattice, h: float) -> str:
        moved = ["0", "0"]
        moved[direction] = "load"
        half = 0.5 * SIDE
        sets = "".join(
            f'[[set]]\nname = "{name}"\nwhere = "{where}"\n\n'
            for name, where in (("foot", f"y < {CLAMP}"), ("head", f"y > {SIDE - CLAMP}"))
        )
        opening = "".join(
            f'[[set]]\nname = "{name}"\nwhere = "x < {3 * h} && y {sign} {half} && abs(y - {half}) < {1.2 * h}"\n\n'
            f'[[control]]\nset = "{name}"\nweights = {[way * (1 - direction), way * direction]}\n\n'
            for name, sign, way in (("upper", ">", 1), ("lower", "<", -1))
        )
        return material(setting(h, lattice, 1.0, ["foot", "head"]), STEEL, STEEL_ENERGY) + f"""
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [{SIDE}, {SIDE}]

[[crack]]
from = [{-SIDE}, {half}]
to = [{half}, {half}]

{sets}[[support]]
set = "foot"
displacement = [0, 0]

[[support]]
set = "head"
displacement = ["{moved[0]}", "{moved[1]}"]

{opening}[loading]
table = [0, {0.7 * largest}, {3 * largest}]
steps = 25
stop_below = 0.85
"""  # fmt: skip

    return text


def beam(lattice: Lattice, h: float) -> str:
    x = aside(lattice, h)
    text = material(setting(h, lattice, 1.0, ["ends"]), SOFT, SOFT_ENERGY)
    return text + f"""
[[lattice.shape]]
add = "box"
min = [{-0.5 * SPAN - HEIGHT / 10}, 0.0]
max = [{0.5 * SPAN + HEIGHT / 10}, {HEIGHT}]

[[crack]]
from = [{x}, {-HEIGHT}]
to = [{x}, {NOTCH}]

[[set]]
name = "ends"
where = "abs(x) > {0.4 * SPAN} || (abs(x) < {0.3 * HEIGHT} && y > {0.8 * HEIGHT})"

{mouth_sets(x, h)}{rollers(0.5 * SPAN, HEIGHT)}""" + under_opening("mouth_right", "mouth_left", "[1, 0]", 0.7 * BENDING[1], False)  # fmt: skip


def specimen(name: str, title: str, case, force: str, known: tuple[float, float], coarsest: float) -> Specimen:
    load, _ = known

    def highest(folder: Path) -> float:
        return peak([abs(row[force]) for row in rows(folder)]) / load

    return Specimen(
        name=name, title=title, reference="PhaseFieldX", coarsest=coarsest, case=case,
        measures=(Measure("peak load", highest, allowed=0.1, at=0.5),), spacings=(1.0, 0.7, 0.5),
    )  # fmt: skip


SPECIMENS = [
    specimen("square_tension", "Notched square, tension", square(1, TENSION[1]), "reaction_y:head", TENSION, SIDE / 40),
    specimen("square_shear", "Notched square, shear", square(0, SHEAR[1]), "reaction_x:head", SHEAR, SIDE / 40),
    specimen("bending_phase_field", "Notched beam of the phase fields", beam, "reaction_y:load", BENDING, HEIGHT / 20),
]
