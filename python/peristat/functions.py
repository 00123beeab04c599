"""Functions of Python in the place of expressions."""

import inspect
import re

import numpy

from .errors import input_error

PREFIX = "python_"
CALL = re.compile(rf"\b{PREFIX}\w+")
NUMBER = re.compile(r"load\d?|t")


class GivenFunctions:
    """The functions of a case by the names that its text has for them.

    The parameters of a function say what it depends on: `x`, `y`, `z` [m, or the case's unit], the
    load parameters `load`, `load2`, ... or the time `t`, and columns of the points. In the text of
    the case it is a call such as `python_pull(x, load)`.
    """

    def __init__(self):
        self._functions = {}

    def call_text(self, function, key):
        """The call that stands for a function in the text of the case."""
        name = self._name_of(function)
        return f"{name}({', '.join(_parameters(function, key))})"

    def used_in(self, text):
        """What C++ calls, by name: (number of arguments, fill). `fill(arguments)` returns values."""
        names = set(CALL.findall(text))
        return {
            name: (len(_parameters(function, name)), _filler(name, function))
            for name, function in self._functions.items()
            if name in names
        }

    def _name_of(self, function):
        for name, known in self._functions.items():
            if known is function:
                return name
        own = re.sub(r"\W", "", getattr(function, "__name__", type(function).__name__), flags=re.ASCII)[:60] or "function"
        name, count = f"{PREFIX}{own}", 1
        while name in self._functions:
            count += 1
            name = f"{PREFIX}{own}_{count}"
        self._functions[name] = function
        return name


def _parameters(function, key):
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        raise input_error(key, repr(function)[:80], "has no parameters that could be read") from None
    kinds = {inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD}
    free = [each for each in parameters if each.default is inspect.Parameter.empty]
    if not free or any(parameter.kind not in kinds for parameter in free):
        raise input_error(
            key,
            repr(function)[:80],
            "must have parameters by name, such as x, y, z, load or t, and no others; those with a "
            "default keep it",
        )
    return [parameter.name for parameter in free]


def _filler(name, function):
    # Loads and times are numbers; places and columns are arrays, also of one point.
    are_numbers = [bool(NUMBER.fullmatch(each)) for each in _parameters(function, name)]

    def fill(arguments, count):
        given = [
            float(argument[0]) if is_number else argument
            for argument, is_number in zip(arguments, are_numbers, strict=True)
        ]
        values = numpy.asanyarray(function(*given))
        if numpy.ma.is_masked(values):
            raise ValueError(f"{name} returned masked values, which are no numbers")
        if values.dtype.kind not in "bifu":
            raise TypeError(f"{name} returned {values.dtype} in place of numbers")
        if values.shape not in {(), (1,), (count,)}:
            raise ValueError(
                f"{name} returned an array of shape {values.shape} for {count} points; allowed are "
                "a number, or a value per point"
            )
        return numpy.ascontiguousarray(numpy.broadcast_to(values.astype(float), (count,)))

    return fill
