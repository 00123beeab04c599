"""Points of a body from arrays."""

from collections.abc import Mapping

import numpy
from numpy.typing import ArrayLike

from ._numbers import real_numbers
from .errors import input_error


class Points:
    """Points in memory, in the place of a lattice or a file of points.

    Args:
        positions: points x dimension, in the case's unit of length (default: m).
        volumes: one per point, or one for all; in 2D with the thickness (unit of length cubed).
        sets: names of points: numbers from 0, or a truth value per point.
        columns: further numbers of each point by name, which expressions of the case may use.

    The arrays are copied. The body numbers the points anew, so that neighbours are near each other
    in memory; `Body.given_numbers` has their numbers here. The keys of `[points]`, horizon and thickness first of all, are given
    beside: `ps.Case(dimension=2, points={"horizon": "3 mm"}, given_points=ps.Points(...))`.
    """

    def __init__(
        self,
        positions: ArrayLike,
        volumes: ArrayLike,
        sets: Mapping[str, ArrayLike] | None = None,
        columns: Mapping[str, ArrayLike] | None = None,
    ) -> None:
        self.positions = real_numbers("positions", positions)
        if self.positions.ndim != 2 or self.positions.shape[1] not in (1, 2, 3):
            raise input_error(
                "positions", str(self.positions.shape), "must have the shape points x dimension"
            )
        self.volumes = self._of_points("volumes", volumes)
        self.sets = {name: self._members(name, members) for name, members in _named("sets", sets)}
        self.columns = {
            name: self._of_points(f"columns[{name!r}]", values)
            for name, values in _named("columns", columns)
        }

    def __len__(self) -> int:
        return len(self.positions)

    def _of_points(self, key, values):
        values = real_numbers(key, values)
        if values.shape not in {(), (len(self),)}:
            raise input_error(
                key, str(values.shape), f"must have a number for each of the {len(self)} points"
            )
        return numpy.array(numpy.broadcast_to(values, (len(self),)))

    def _members(self, name, members):
        members = numpy.asarray(members)
        key = f"sets[{name!r}]"
        if members.dtype == bool:
            if members.shape != (len(self),):
                raise input_error(key, str(members.shape), f"must have {len(self)} truth values")
            members = numpy.flatnonzero(members)
        if members.ndim != 1 or members.dtype.kind not in "iu" or not members.size:
            raise input_error(key, "", "must have point numbers from 0, or a truth value per point")
        if members.min() < 0 or members.max() >= len(self):
            raise input_error(key, "", f"has a number that is none of 0 to {len(self) - 1}")
        return members.astype(numpy.int32)


def _named(key, given):
    given = {} if given is None else given
    if not isinstance(given, Mapping) or not all(isinstance(name, str) for name in given):
        raise input_error(key, repr(given)[:60], "must be a dict of arrays by their names")
    return given.items()
