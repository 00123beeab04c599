"""Single-edge notched beams in three-point bending, ASTM E399 (S = 4 W), under control of their mouth opening."""

from pathlib import Path

import lefm
from bending import mouth_sets, rollers
from compliance import LEAST_GROWTH, toughness
from setting import FRACTURE_ENERGY, MODULUS, setting, under_opening
from specimen import MIDDLE, RATIOS, Lattice, Measure, Specimen, aside, peak, rows

WIDTH, THICKNESS = 0.04, 1e-3
GROWN = LEAST_GROWTH * RATIOS[0] * MIDDLE * WIDTH / 20
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)


def case(ratio: float):
    crack = ratio * WIDTH

    def text(lattice: Lattice, h: float) -> str:
        mouth = lefm.bend_load(TOUGHNESS, WIDTH, crack, THICKNESS) * lefm.bend_opening(ratio) / (MODULUS * THICKNESS)
        x = aside(lattice, h)
        return setting(h, lattice, THICKNESS, ["ends"]) + f"""
[[lattice.shape]]
add = "box"
min = [{-2.1 * WIDTH}, 0.0]
max = [{2.1 * WIDTH}, {WIDTH}]

[[crack]]
from = [{x}, {-WIDTH}]
to = [{x}, {crack}]

[[set]]
name = "ends"
where = "(abs(x) > {1.75 * WIDTH} && y < {0.25 * WIDTH}) || (abs(x) < {0.25 * WIDTH} && y > {0.85 * WIDTH})"

{mouth_sets(x, h)}{rollers(2 * WIDTH, WIDTH)}""" + under_opening("mouth_right", "mouth_left", "[1, 0]", 2 * mouth, lattice.refinement >= MIDDLE)  # fmt: skip

    return text


def specimen(ratio: float) -> Specimen:
    load = lambda crack: lefm.bend_load(TOUGHNESS, WIDTH, crack, THICKNESS)
    crack = ratio * WIDTH

    def highest(folder: Path) -> float:
        return peak([abs(row["reaction_y:load"]) for row in rows(folder)]) / load(crack)

    def growing(folder: Path) -> float:
        opening = lambda a: lefm.bend_opening(a / WIDTH) / (MODULUS * THICKNESS)
        return toughness(folder, "reaction_y:load", opening, load, crack, 0.85 * WIDTH, GROWN)

    return Specimen(
        name=f"senb_{10 * ratio:02.0f}",
        title=f"Notched beam, a/W = {ratio}",
        reference="ASTM E399",
        coarsest=WIDTH / 20,
        case=case(ratio),
        measures=(
            Measure("peak load", highest, of_longer_crack=lambda by: load(crack + by) / load(crack)),
            Measure("toughness by compliance", growing, allowed=0.03, at=MIDDLE),
        ),
    )


SPECIMENS = [specimen(ratio) for ratio in (0.3, 0.4, 0.5, 0.6)]
