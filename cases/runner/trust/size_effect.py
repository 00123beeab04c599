"""Size effect: notched beams of four sizes, S = 4 D, of concrete with its strength and toughness, on one spacing. Their
nominal strengths follow Bažant's law, whose slope gives the toughness. That law holds for bodies that are large beside
the process zone; the cohesive crack with the same curve has no such limit."""

import math
from pathlib import Path

import lefm
from bending import mouth_sets, rollers
from other_setting import of_material
from setting import setting, under_opening
from specimen import Lattice, Measure, Specimen, aside, peak, resolved, rows

MODULUS, FRACTURE_ENERGY, TENSILE = 25.85e9, 89.0, 2.7e6  # concrete of the panels of [Winkler 2001]
DEPTHS, NOTCH, THICKNESS, COARSEST = (0.2, 0.32, 0.52, 0.8), 0.3, 0.1, 0.04
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)
# Nominal strengths [MPa] by depth of beams with a cohesive crack, as `/usr/bin/python3 -BEs -m
# tests.reference.cohesive_beam` prints them for 60 rows of elements.
COHESIVE = {
    "linear": (0.3230, 0.2866, 0.2494, 0.2174),
    "bilinear": (0.2833, 0.2473, 0.2123, 0.1844),
    "cornelissen": (0.2666, 0.2345, 0.2033, 0.1774),
}
# Share of the length E G / f_t^2 by which a process zone with linear softening extends long cracks [Cusatis and
# Schauffert 2009].
ZONE = 0.44 * MODULUS * FRACTURE_ENERGY / TENSILE**2


def law(depth: float) -> float:
    """Bažant's nominal strength P / (B D) for the data: K_Ic / sqrt(g D + g' c) with g = (4 f)^2 [Bažant and Planas
    1998]."""
    shape = lambda notch: (4 * lefm.bend_factor(notch)) ** 2
    growth = (shape(NOTCH + 1e-5) - shape(NOTCH - 1e-5)) / 2e-5
    return TOUGHNESS / math.sqrt(shape(NOTCH) * depth + growth * ZONE)


def toughness_of(depths: list[float], strengths: list[float]) -> tuple[float, float]:
    """K_Ic from the slope (4 f / K_Ic)^2 of 1 / strength^2 over the depth, and r^2 of that line."""
    inverse = [1 / strength**2 for strength in strengths]
    x_mean, y_mean = sum(depths) / len(depths), sum(inverse) / len(inverse)
    xx = sum((x - x_mean) ** 2 for x in depths)
    xy = sum((x - x_mean) * (y - y_mean) for x, y in zip(depths, inverse))
    yy = sum((y - y_mean) ** 2 for y in inverse)
    return 4 * lefm.bend_factor(NOTCH) / math.sqrt(xy / xx), xy**2 / (xx * yy)


def case(depth: float):
    def text(lattice: Lattice, h: float) -> str:
        x, crack = aside(lattice, h), NOTCH * depth
        half = h * math.ceil(2.1 * depth / h)  # the same number of points on each side of the notch
        mouth = 24 * law(depth) * crack / MODULUS * (0.76 - 2.28 * NOTCH + 3.87 * NOTCH**2 - 2.04 * NOTCH**3 + 0.66 / (1 - NOTCH) ** 2)
        concrete = of_material(setting(h, lattice, THICKNESS, ["ends"]), MODULUS, FRACTURE_ENERGY, TENSILE)
        return concrete + f"""
[[lattice.shape]]
add = "box"
min = [{-half}, 0.0]
max = [{half}, {depth}]

[[crack]]
from = [{x}, {-depth}]
to = [{x}, {crack}]

[[set]]
name = "ends"
where = "(abs(x) > {1.75 * depth} && y < {0.25 * depth}) || (abs(x) < {0.25 * depth} && y > {0.85 * depth})"

{mouth_sets(x, h)}{rollers(2 * depth, depth)}""" + under_opening("mouth_right", "mouth_left", "[1, 0]", 4 * mouth, follow_growth=False)  # fmt: skip

    return text


def nominal_strength(folder: Path, depth: float) -> float:
    return peak([abs(row["reaction_y:load"]) for row in rows(folder)]) / (THICKNESS * depth)


def over_cohesive(folder: Path, depth: float) -> float:
    """Over the strength of a cohesive crack with the curve of the run's law.

    @raise LookupError for laws without one
    """
    law_of_run = resolved(folder)["material"]["damage"]["law"]
    if law_of_run not in COHESIVE:
        raise LookupError(f"no cohesive crack was computed for law {law_of_run}")
    return nominal_strength(folder, depth) / (1e6 * COHESIVE[law_of_run][DEPTHS.index(depth)])


def name(depth: float) -> str:
    return f"size_effect_{1000 * depth:.0f}"


def of_all_sizes(folder: Path) -> tuple[float, float]:
    """K_Ic from the slope of the law through all sizes, over the given one, and r^2; reads the other sizes' runs.

    @raise ValueError if one has not run
    """
    strengths = []
    for depth in DEPTHS:
        beside = folder.parents[2] / name(depth) / folder.parent.name / folder.name
        if not (beside / "summary.json").is_file():
            raise ValueError(f"run it with {name(depth)}")
        strengths.append(nominal_strength(beside, depth))
    found, r_squared = toughness_of(list(DEPTHS), strengths)
    return found / TOUGHNESS, r_squared


def specimen(depth: float) -> Specimen:
    measures = [
        Measure("nominal strength", lambda folder: nominal_strength(folder, depth) / law(depth), allowed=0.1),
        Measure("nominal strength over that of a cohesive crack", lambda folder: over_cohesive(folder, depth), allowed=0.1),
    ]
    if depth == DEPTHS[-1]:
        measures += [
            Measure("toughness by the slope of the law through four sizes", lambda folder: of_all_sizes(folder)[0], allowed=0.1),
            Measure("r^2 of that line", lambda folder: of_all_sizes(folder)[1], allowed=0.01),
        ]
    title = f"Notched beam of concrete, {1000 * depth:.0f} mm deep"
    return Specimen(name(depth), title, "Bažant's law", COARSEST, case(depth), tuple(measures))


SPECIMENS = [specimen(depth) for depth in DEPTHS]
