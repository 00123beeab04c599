"""An entry of the suite: runs of one setting, and quantities of each that have a reference."""

import csv
import tomllib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

SPACINGS, RATIOS, ANGLES = (1.0, 0.5, 0.25), (3.015, 4.015), (0.0, 18.4349488, 26.5650512, 45.0)
MIDDLE = SPACINGS[1]


@dataclass(frozen=True)
class Lattice:
    """Lattice of one run: its refinement relative to the specimen's coarsest spacing, and choices that must not affect
    the answer."""

    refinement: float = 1.0
    ratio: float = RATIOS[0]
    angle: float = 0.0

    @property
    def name(self) -> str:
        return f"h{self.refinement:g}_m{self.ratio:g}_{self.angle:.0f}"

    @property
    def is_straight(self) -> bool:
        """Whether it differs from the reference lattice by its spacing alone."""
        return (self.ratio, self.angle) == (RATIOS[0], 0.0)


def aside(lattice: Lattice, spacing: float) -> float:
    """Offset of a crack along a side of the lattice [m]; on a turned lattice points lie on the crack."""
    return 0.0 if lattice.angle == 0.0 else 0.23 * spacing


@dataclass
class Measure:
    """A quantity of a run over its reference: 1 is exact."""

    quantity: str
    value: Callable[[Path], float]
    allowed: float = 0.02
    at: float = SPACINGS[-1]  # refinement at which it is judged
    on_every_lattice: bool = False  # also on the other lattices of that spacing, of which the worst counts
    # Reference of a specimen with a crack longer by the argument, over the reference itself: the error of a crack of
    # finite width.
    of_longer_crack: Callable[[float], float] | None = None


@dataclass
class Specimen:
    name: str
    title: str
    reference: str  # source of the reference
    coarsest: float  # spacing [m]
    case: Callable[[Lattice, float], str]  # of lattice and spacing
    measures: tuple[Measure, ...]
    # Refinements, the coarsest first: finer where runs are cheap, closer together where cracks run far.
    spacings: tuple[float, ...] = SPACINGS

    def lattices(self, quick: bool) -> list[Lattice]:
        """Three spacings or more, two horizons, four angles; quick: the coarsest only."""
        if quick:
            return [Lattice()]
        others = [Lattice(self.middle, RATIOS[1]), *(Lattice(self.middle, angle=angle) for angle in ANGLES[1:])]
        return [*map(Lattice, self.spacings), *others]

    @property
    def middle(self) -> float:
        """The refinement for the other horizon and the angles."""
        return self.spacings[1]

    def spacing(self, lattice: Lattice) -> float:
        return self.coarsest * lattice.refinement

    def text(self, lattice: Lattice) -> str:
        return self.case(lattice, self.spacing(lattice))


def rows(folder: Path, name: str = "history") -> list[dict]:
    """Rows of a table, with numbers as such; rows of the history without step 0, the body at rest."""

    def value(text):
        try:
            return float(text)
        except ValueError:
            return text

    with open(folder / f"{name}.csv", newline="") as table:
        found = [{key: value(text) for key, text in row.items()} for row in csv.DictReader(table)]
    return [row for row in found if name != "history" or row.get("step") != 0]


def resolved(folder: Path) -> dict:
    """The case that a run had, with the values of `--set`."""
    import h5py

    with h5py.File(folder / "results.h5") as file:
        return tomllib.loads(file["case/as_resolved"][()].decode())


def lattice_of(folder: Path) -> dict:
    return resolved(folder)["lattice"]


SMOOTH = 0.05  # share of the peak by which its neighbours may fall short of it


def peak(values: list[float]) -> float:
    """Largest value, interpolated by the parabola through the three highest rows. A row beside which the load falls at
    once is the largest itself: a parabola through a snap overshoots by an eighth of the fall."""
    top = max(range(len(values)), key=lambda k: values[k])
    if top in (0, len(values) - 1):
        return values[top]
    before, here, after = values[top - 1 : top + 2]
    if min(before, after) < (1 - SMOOTH) * here:
        return here
    bend = before - 2 * here + after
    return here - (after - before) ** 2 / (8 * bend) if bend < 0 else here
