"""The function that a fit makes small: residuals of all specimens, from runs with given values."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy

from ..errors import InputError
from .comparison import Comparison, Residual
from .curves import Columns, Curve, Measured, computed, default_columns, require_same_units
from .parameters import Parameter

REFUSED = "refused"
_NOTHING = Curve(numpy.empty(0), numpy.empty(0))


class NoDerivative(Exception):
    """Both sides of a value are refused, or have no curve."""


@dataclass(frozen=True)
class Ran:
    """A run of a specimen with some values."""

    folder: Path
    status: str  # that of summary.json, or REFUSED
    reason: str = ""


@dataclass
class Specimen:
    name: str
    measured: Measured
    comparison: Comparison
    columns: Columns  # empty names are found from the first run


@dataclass(frozen=True)
class Point:
    """Values of the parameters and what their runs gave."""

    texts: tuple[str, ...]  # values in the form of a case file
    runs: tuple[Ran, ...]
    residuals: tuple[Residual, ...]

    @property
    def values(self) -> numpy.ndarray:
        return numpy.concatenate([each.values for each in self.residuals])

    @property
    def sum_of_squares(self) -> float:
        return float((self.values**2).sum())


# Runs specimens, given by number, with values of the parameters; in any order, side by side.
Runner = Callable[[Sequence[tuple[int, tuple[str, ...]]]], list[Ran]]


@dataclass
class Problem:
    specimens: list[Specimen]
    parameters: list[Parameter]
    run: Runner
    difference: float  # of central differences, in the coordinates
    tell: Callable[[str], None]
    _known: dict[tuple[str, ...], Point] = field(default_factory=dict)

    @property
    def points(self) -> int:
        return sum(each.comparison.points for each in self.specimens)

    def texts(self, coordinates: numpy.ndarray) -> tuple[str, ...]:
        return tuple(each.text(each.value(q)) for each, q in zip(self.parameters, coordinates, strict=True))

    def at(self, places: Sequence[numpy.ndarray]) -> list[Point]:
        """Runs whatever has not been run with these values; all runs at once."""
        asked = [self.texts(place) for place in places]
        missing = list(dict.fromkeys(texts for texts in asked if texts not in self._known))
        runs = iter(self.run([(k, texts) for texts in missing for k in range(len(self.specimens))]))
        for texts in missing:
            own = tuple(next(runs) for _ in self.specimens)
            self._known[texts] = Point(texts, own, tuple(map(self._residual, self.specimens, own)))
        return [self._known[texts] for texts in asked]

    def _residual(self, specimen: Specimen, ran: Ran) -> Residual:
        comparison = specimen.comparison
        if ran.status == REFUSED:
            return comparison.residual(_NOTHING)
        return comparison.residual(computed(ran.folder, specimen.columns))

    def begin(self, place: numpy.ndarray) -> None:
        """Runs the starting values and finds the columns to compare.

        Raises:
            InputError: the case is refused, has no such columns, or other units than the data.
        """
        texts = self.texts(place)
        runs = self.run([(k, texts) for k in range(len(self.specimens))])
        for specimen, ran in zip(self.specimens, runs, strict=True):
            if ran.status == REFUSED:
                raise InputError(ran.reason)
            given, curve = specimen.columns, specimen.measured.curve
            specimen.columns = default_columns(ran.folder, given, curve)
            if ran.status == "completed":
                require_same_units(specimen.measured.name, curve, computed(ran.folder, specimen.columns))


def gradient_of(problem: Problem, place: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Derivatives of the residuals with respect to the coordinates, and their scatter.

    By central differences of runs: curves of breaking bonds are smooth only piecewise, so the difference must span
    several pieces. At a bound, or beside values that a case refuses, the difference is one-sided. This is the one place
    that knows how derivatives are found.

    The scatter of a column is that of its values by the pieces, estimated from what the two sides do not have in common
    with a straight line: (r+ + r- - 2 r) / 2 has sqrt(3) times the scatter of (r+ - r-) / 2.

    Returns:
        derivatives: residuals x parameters.
        scatter: for each parameter, the norm of its column's scatter over the norm of the column; NaN if one-sided.
    """
    steps = numpy.zeros((2, len(place)))  # backwards, forwards
    for k, each in enumerate(problem.parameters):
        low, high = each.coordinate(each.low), each.coordinate(each.high)
        steps[:, k] = max(place[k] - problem.difference, low) - place[k], min(place[k] + problem.difference, high) - place[k]
    unit = numpy.eye(len(place))
    centre, *sides = problem.at([place, *(place + steps[side, k] * unit[k] for k in range(len(place)) for side in (0, 1))])
    derivatives = numpy.empty((len(centre.values), len(place)))
    scatter = numpy.full(len(place), numpy.nan)
    for k, (before, after) in enumerate(zip(sides[::2], sides[1::2], strict=True)):
        back, forth = steps[0, k], steps[1, k]
        back, low = (back, before.values) if numpy.isfinite(before.values).all() else (0.0, centre.values)
        forth, high = (forth, after.values) if numpy.isfinite(after.values).all() else (0.0, centre.values)
        if forth - back < 0.1 * problem.difference:
            raise NoDerivative(f"{problem.parameters[k].key}: the case is refused or has no curve on both sides of {centre.texts[k]}")
        derivatives[:, k] = (high - low) / (forth - back)
        odd = numpy.linalg.norm(high - low) / 2.0
        if numpy.isclose(forth, -back) and odd > 0.0:
            scatter[k] = numpy.linalg.norm(high + low - 2.0 * centre.values) / 2.0 / 3.0**0.5 / odd
    return derivatives, scatter
