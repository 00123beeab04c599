"""The states of a run that the page shows, over the cells that it draws."""

from dataclasses import dataclass

import numpy as np

from ..pictures.cells import Cells
from ..pictures.cloud_cells import CloudCells
from ..pictures.separations import LOOSE_DAMAGE, LOST_DAMAGE, cells_of
from .fields import FIELDS, Field, values_of

SAME = 1e-6  # share of a spacing within which points stand on their lattice


@dataclass
class Frames:
    """Steps of a body over its cells, which are in the order of the grid.

    cells        of the last step
    order        that puts cells in the order of the grid: without thinning the numbers of their points
    is_whole     whether every point has a cell of its own; otherwise cells are means over blocks of points
    places       of the cells in a grid of the shape `shape`
    displacement frames x dimension x cells [m]
    fields       frames x cells, by Field
    parted       the first frame in which a cell is parted from its neighbours, or the number of frames: axes x cells of
                 a lattice for the next one along each axis, sides x cells of polygons; None for marks
    """

    numbers: list[int]
    cells: object
    reference: np.ndarray
    order: np.ndarray
    is_whole: bool
    places: np.ndarray
    shape: tuple[int, ...]
    displacement: np.ndarray
    fields: dict[Field, np.ndarray]
    parted: np.ndarray | None
    loose_damage: float

    @property
    def is_lattice(self) -> bool:
        return isinstance(self.cells, Cells) and self.cells.is_lattice

    @property
    def stands_on_lattice(self) -> bool:
        """Whether the points are the centres of the cells, which the page computes."""
        return (
            self.is_lattice
            and np.abs(self.cells.centres(self.reference) - self.reference).max() <= SAME * self.cells.spacing
        )

    @property
    def size(self) -> int:
        """Numbers that the page needs."""
        return self.displacement.size + sum(values.size for values in self.fields.values())


def read_frames(results, numbers: list[int], limit: int) -> Frames:
    """The given steps over at most `limit` cells."""
    present = _fields_of_all(results, numbers)
    states = [_state(results, number, limit, present) for number in numbers]
    cells, reference = states[-1].cells, states[-1].reference
    places, shape = _grid(cells, reference)
    order = np.argsort(places, kind="stable")
    is_whole = len(reference) == len(results.reference)
    partings = [_partings(state.cells) for state in states]
    parted = None if partings[0] is None else _first_parting(partings)[:, order]
    fields = {field: np.stack([state.fields[field][order] for state in states]) for field in present}
    return Frames(
        numbers, cells, reference, order, is_whole, places[order], shape,
        np.stack([state.displacement[order].T for state in states]),
        {field: values for field, values in fields.items() if values.any()}, parted,
        LOST_DAMAGE if is_whole and results.tells_broken_bonds else LOOSE_DAMAGE,
    )  # fmt: skip


@dataclass
class _State:
    cells: object
    reference: np.ndarray
    displacement: np.ndarray
    fields: dict[Field, np.ndarray]


def _fields_of_all(results, numbers: list[int]) -> list[Field]:
    """Fields that every step has: a step without one would seem to have zeros."""
    present = []
    for field in FIELDS:
        lacking = [number for number in numbers if values_of(results, number, field) is None]
        if not lacking:
            present.append(field)
        elif len(lacking) < len(numbers):
            results.missing.append(f"{field.label} is left out: it is missing or not finite in step {lacking[0]}")
    return present


def _state(results, number: int, limit: int, present: list[Field]) -> _State:
    step = results.step(number)
    values = [values_of(results, number, field) for field in present]
    cells, reference, displacement, _, _, *values = cells_of(results, step, limit, 1.0, *values)
    return _State(cells, reference, displacement, dict(zip(present, values)))


def _grid(cells, reference: np.ndarray) -> tuple[np.ndarray, tuple[int, ...]]:
    """Places in a grid: that of the lattice, or else a row along which neighbours are near."""
    if isinstance(cells, Cells) and cells.is_lattice:
        shape = tuple(int(n) for n in cells.index.max(axis=0) + 1)
        return np.ravel_multi_index(tuple(cells.index.T), shape), shape
    places = np.empty(len(reference), dtype=np.int64)
    places[_along_a_curve(reference)] = np.arange(len(reference))
    return places, (len(reference),)


def _along_a_curve(reference: np.ndarray) -> np.ndarray:
    """Order along Morton's curve."""
    size = np.ptp(reference, axis=0).max() or 1.0
    along = np.floor((reference - reference.min(axis=0)) / size * 1023.0).astype(np.int64)
    key = np.zeros(len(reference), dtype=np.int64)
    dimension = reference.shape[1]
    for bit in range(10):
        for axis in range(dimension):
            key |= ((along[:, axis] >> bit) & 1) << (dimension * bit + axis)
    return np.argsort(key, kind="stable")


def _partings(cells) -> np.ndarray | None:
    """Whether cells are parted from their neighbours, axes or sides x cells."""
    if isinstance(cells, CloudCells):
        return cells.parted.T
    return np.stack([cells.parted(axis, 1) for axis in range(cells.dimension)]) if cells.is_lattice else None


def _first_parting(masks: list[np.ndarray]) -> np.ndarray:
    """The first frame in which each cell is parted; cracks never close again."""
    first = np.full(masks[0].shape, len(masks))
    for frame in reversed(range(len(masks))):
        first[masks[frame]] = frame
    return first


def chosen(results, most: int) -> list[int]:
    """Up to `most` of the steps with fields: the first, the last, and others with about equal progress in between.

    Half of the progress is that of the steps, half that of the broken bonds.
    """
    numbers = results.step_numbers
    if len(numbers) <= most:
        return numbers
    broken = np.array([results.in_history(number, "broken_bonds") or 0.0 for number in numbers])
    grown = np.maximum.accumulate(broken)
    progress = np.linspace(0.0, 1.0, len(numbers)) + (grown / grown[-1] if grown[-1] > 0.0 else 0.0)
    wanted = np.linspace(progress[0], progress[-1], most)
    return [numbers[place] for place in sorted({int(np.abs(progress - value).argmin()) for value in wanted})]
