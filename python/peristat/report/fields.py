"""The fields that the page can colour the body by, from the datasets of a step (docs/results.md)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np


def _norm(values: np.ndarray) -> np.ndarray:
    return np.linalg.norm(values, axis=1)


def _first(values: np.ndarray) -> np.ndarray:
    return values[:, 0]


@dataclass(frozen=True)
class Field:
    name: str  # of the dataset
    label: str
    unit: str
    take: Callable[[np.ndarray], np.ndarray] | None = None  # one number per point from a vector


# The first ones matter most: later ones are left out where the page would become too large.
FIELDS = (
    Field("damage", "damage", "1"),
    Field("energy_density", "energy density", "J/m3"),
    Field("von_mises", "von Mises stress", "Pa"),
    Field("principal_stress", "largest principal stress", "Pa", _first),
    Field("velocity", "speed", "m/s", _norm),
    Field("stretch", "largest stretch of a bond", "1"),
    Field("fragment", "loose piece (0: held)", "1"),
    Field("force", "internal force", "N", _norm),
    Field("missing_neighbourhood", "missing share of the neighbourhood", "1"),
)


def values_of(results, number: int, field: Field) -> np.ndarray | None:
    """A field of a step, one number per point; None if the step does not have it."""
    dimension = results.dimension
    width = () if field.take is None else (dimension,)
    values = results.field(number, field.name, *width)
    return None if values is None else field.take(values) if field.take else values
