"""L-shaped panel of concrete, 500 x 500 x 100 mm less a quarter, held at its foot and lifted near the end of its arm:

a crack starts at the corner [Winkler 2001]. It runs with the strength that the horizon gives, and with the measured
one. Elasticity alone gives 60 kN/mm at the loaded point, in plane stress with a clamped foot, where 40 were
measured. So loads can be compared, and displacements cannot."""

from pathlib import Path

from other_setting import of_material
from setting import setting
from specimen import Lattice, Measure, Specimen, peak, rows

MODULUS, FRACTURE_ENERGY, TENSILE = 25.85e9, 89.0, 2.7e6
SIDE, THICKNESS, ARM_END = 0.5, 0.1, 0.47
# Largest measured load and the displacement of the loaded point there: series A, digitised in
# github.com/PSAAPGroupLinder/lShapedPanelBenchmark.
LOAD, DISPLACEMENT = 7219.1, 0.207754e-3


def case(tensile: float | None):
    def text(lattice: Lattice, h: float) -> str:
        concrete = of_material(setting(h, lattice, THICKNESS, ["foot", "tip"]), MODULUS, FRACTURE_ENERGY, tensile)
        half = 0.5 * SIDE
        return concrete + f"""
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [{SIDE}, {SIDE}]

[[lattice.shape]]
subtract = "box"
min = [{half * (1 + 1e-9)}, 0.0]
max = [{SIDE}, {half * (1 - 1e-9)}]

[[set]]
name = "foot"
where = "y < {0.1 * SIDE}"

[[set]]
name = "held"
where = "y < {1.5 * h}"

[[set]]
name = "tip"
where = "x > {0.84 * SIDE}"

[[set]]
name = "above"
where = "abs(x - {half}) < {1.1 * h} && abs(y - {0.62 * SIDE}) < {1.1 * h}"

[[set]]
name = "below"
where = "x > {half - 2.2 * h} && x < {half} && abs(y - {0.42 * SIDE}) < {1.1 * h}"

[[support]]
set = "held"
displacement = [0, 0]

[[roller]]
name = "load"
at = [{ARM_END}, {half}]
normal = [0, 1]
displacement = "load"

[[control]]
set = "above"
weights = [0, 1]

[[control]]
set = "below"
weights = [0, -1]

[loading]
table = [0, {0.5 * DISPLACEMENT}, {1.5 * DISPLACEMENT}]
steps = 30
stop_below = 0.85
"""  # fmt: skip

    return text


def at_peak(folder: Path) -> tuple[float, float]:
    """Load [N] and displacement of the loaded point [m]."""
    found = rows(folder)
    top = max(found, key=lambda row: abs(row["reaction_y:load"]))
    return peak([abs(row["reaction_y:load"]) for row in found]), top["load_factor"]


def specimen(name: str, tensile: float | None) -> Specimen:
    title = "L-shaped panel" + (", strength as measured" if tensile else "")
    measures = (
        Measure("peak load", lambda folder: at_peak(folder)[0] / LOAD, allowed=0.1),
        Measure("displacement at the peak", lambda folder: at_peak(folder)[1] / DISPLACEMENT, allowed=0.1),
    )
    return Specimen(name, title, "Winkler, series A", SIDE / 24, case(tensile), measures)


SPECIMENS = [specimen("l_panel", None), specimen("l_panel_strength", TENSILE)]
