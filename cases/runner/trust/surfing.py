"""A steady crack in a strip: J on its way is what it resists with."""

from pathlib import Path

from setting import FRACTURE_ENERGY
from specimen import Measure, Specimen, rows
from strip import Strip


def resistance(folder: Path) -> float:
    """sqrt(J / G_c) where the crack runs steadily: mean over the last half of the way."""
    found = [row["tip_J"] for row in rows(folder)]
    steady = found[len(found) // 2 :]
    return (sum(steady) / len(steady) / FRACTURE_ENERGY) ** 0.5


SPECIMENS = [
    Specimen(
        name="surfing",
        title="Steady crack in a strip",
        reference="G_c as given",
        coarsest=1e-3,
        case=Strip().text,
        measures=(Measure("sqrt(J / G_c)", resistance, allowed=0.03, on_every_lattice=True),),
    )
]
