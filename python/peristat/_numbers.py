"""Numbers that a program gives."""

import math

import numpy
from numpy.typing import ArrayLike, NDArray

from .errors import input_error


def real_numbers(key: str, values: ArrayLike) -> NDArray[numpy.float64]:
    """A copy of an array, as real numbers: nothing is dropped, such as a mask or imaginary parts.

    Raises:
        InputError: the values are no real numbers.
    """
    try:
        given = numpy.asanyarray(values)
    except ValueError:  # rows of different lengths
        raise input_error(key, repr(values)[:60], "must be numbers, in rows of one length") from None
    if given.dtype.kind not in "buif" or numpy.ma.is_masked(given):
        what = "masked values" if numpy.ma.is_masked(given) else str(given.dtype)
        raise input_error(key, repr(values)[:60], f"must be numbers, not {what}")
    return numpy.array(given, dtype=float)


def real_number(key: str, value: object) -> float:
    """One finite number.

    Raises:
        InputError: it is none.
    """
    number = real_numbers(key, value)  # type: ignore[arg-type]
    if number.ndim != 0 or not math.isfinite(number):
        raise input_error(key, repr(value)[:60], "must be a finite number")
    return float(number)


def truth(key: str, value: object) -> bool:
    """A truth value: that a text such as "no" is true would be a surprise.

    Raises:
        InputError: it is none.
    """
    if not isinstance(value, (bool, numpy.bool_)):
        raise input_error(key, repr(value)[:60], "must be True or False")
    return bool(value)
