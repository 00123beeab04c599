"""The parameters of a fit: keys of the case, their units, starting values and bounds."""

import math
import re
from dataclasses import dataclass

import numpy

from ..errors import InputError

DIGITS = 10  # of values: a run is found again by them


@dataclass(frozen=True)
class Parameter:
    """A value of a key, in the unit of the case.

    The search has the coordinate q = log(value / start) + 1 if value and bounds are positive, otherwise
    q = value / size with the size of the starting value.
    """

    key: str
    unit: str  # empty: a plain number
    start: float
    low: float = -math.inf
    high: float = math.inf

    @property
    def is_log(self) -> bool:
        return self.start > 0.0 and self.low >= 0.0

    @property
    def size(self) -> float:
        """Of values, where they may be zero."""
        bounds = [abs(value) for value in (self.low, self.high) if math.isfinite(value)]
        return abs(self.start) or max(bounds, default=0.0) or 1.0

    def coordinate(self, value: float) -> float:
        if not self.is_log:
            return value / self.size
        return -math.inf if value <= 0.0 else math.log(value / self.start) + 1.0 if math.isfinite(value) else math.inf

    def value(self, coordinate: float) -> float:
        return self.start * math.exp(coordinate - 1.0) if self.is_log else coordinate * self.size

    def text(self, value: float) -> str:
        """The value in the form of a case file."""
        number = f"{value:.{DIGITS}g}"
        number = number if re.search(r"[.e]", number) else f"{number}.0"
        return f'"{number} {self.unit}"' if self.unit else number


def parameter(key: str, in_case: object, start: object = None, bounds: tuple[object, object] | None = None) -> Parameter:
    """A parameter from its value in the case, or `start`: a number, or a text with its unit.

    Raises:
        InputError: there is no number, units differ, or the start is outside of the bounds.
    """
    first = start if in_case is None else in_case
    if first is None:
        raise InputError(f"{key}: has no value in the case; give a starting value, as by --start {key}=1.0")
    unit = _quantity(key, first)[1]
    value = _in_unit(key, first if start is None else start, unit)
    low, high = (-math.inf if bounds is None or bounds[0] is None else _in_unit(key, bounds[0], unit),
                 math.inf if bounds is None or bounds[1] is None else _in_unit(key, bounds[1], unit))  # fmt: skip
    if value > 0.0 and bounds is None:
        low = 0.0
    if not low < high:
        raise InputError(f"{key}: the bounds {low:g} and {high:g} must ascend")
    if not low <= value <= high:
        raise InputError(f"{key}: the starting value {value:g} must be from {low:g} to {high:g}, the bounds")
    return Parameter(key, unit, value, low, high)


def _in_unit(key: str, given: object, unit: str) -> float:
    value, own = _quantity(key, given)
    if own and own != unit:
        raise InputError(f"{key}: {given} must be " + (f"in {unit}, as in the case" if unit else "a plain number, as in the case"))
    return value


def _quantity(key: str, given: object) -> tuple[float, str]:
    text = str(given).strip().strip("\"'").strip()
    found = re.fullmatch(r"([+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)\s*(\S.*)?", text)
    if isinstance(given, bool) or not found or not math.isfinite(float(found[1])):
        raise InputError(f"{key}: {text[:60]!r} must be a number, which may have a unit")
    return float(found[1]), found[2] or ""


def scattered(parameters: list[Parameter], starts: int, seed: int) -> list[numpy.ndarray]:
    """Coordinates to start from: the given ones, and others spread evenly between the bounds, or from a third of the
    starting value to three times it (Latin hypercube)."""
    first = numpy.array([each.coordinate(each.start) for each in parameters])
    if starts == 1:
        return [first]
    from scipy.stats import qmc

    ends = []
    for each in parameters:
        near = (each.start / 3.0, each.start * 3.0) if each.is_log else (each.start - each.size, each.start + each.size)
        has_both = math.isfinite(each.low) and math.isfinite(each.high) and not (each.is_log and each.low == 0.0)
        low, high = (each.low, each.high) if has_both else (max(near[0], each.low), min(near[1], each.high))
        ends.append((each.coordinate(low), each.coordinate(high)))
    low, high = numpy.array(ends).T
    shares = qmc.LatinHypercube(len(parameters), seed=seed).random(starts - 1)
    return [first, *(low + shares * (high - low))]
