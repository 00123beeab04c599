"""A steady crack in a strip: J along the way is its resistance, and the dissipated energy is G_c times its area."""

from pathlib import Path

from setting import FRACTURE_ENERGY
from specimen import Measure, Specimen, lattice_of, rows
from strip import Strip


def resistance(folder: Path) -> float:
    """sqrt(J / G_c) while the crack runs steadily: mean over the second half of the way."""
    found = [row["tip_J"] for row in rows(folder)]
    steady = found[len(found) // 2 :]
    return (sum(steady) / len(steady) / FRACTURE_ENERGY) ** 0.5


def dissipation(folder: Path) -> float:
    """Energy dissipated by bonds per area, over G_c, on the second half of the way."""
    lattice = lattice_of(folder)
    area = STRIP.crack_area(lattice["spacing"] * lattice["horizon_ratio"])
    found = rows(folder)
    middle = min(found, key=lambda row: abs(row["load_factor"] - 0.5))
    grown = (found[-1]["load_factor"] - middle["load_factor"]) * area
    return (found[-1]["dissipated_energy"] - middle["dissipated_energy"]) / grown / FRACTURE_ENERGY


STRIP = Strip()


def specimen(strip: Strip) -> Specimen:
    return Specimen(
        name="surfing",
        title="Steady crack in a strip",
        reference="G_c as given",
        coarsest=1e-3,
        case=strip.text,
        measures=(
            Measure("sqrt(J / G_c)", resistance, allowed=0.03, on_every_lattice=True),
            Measure("dissipated energy over area", dissipation, allowed=0.01, on_every_lattice=True),
        ),
    )


SPECIMENS = [specimen(STRIP)]
