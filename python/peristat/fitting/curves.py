"""Curves: measured ones of a table, computed ones of a results folder."""

import csv
import re
from dataclasses import dataclass
from pathlib import Path

import numpy

from .._names import unknown
from ..errors import InputError

# Units of measured values, in SI units.
UNITS = {"1": 1.0, "%": 1e-2, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "nm": 1e-9, "N": 1.0, "kN": 1e3,
         "MN": 1e6, "mN": 1e-3, "Pa": 1.0, "kPa": 1e3, "MPa": 1e6, "GPa": 1e9, "s": 1.0, "ms": 1e-3, "J": 1.0, "mJ": 1e-3,
         "kJ": 1e3}  # fmt: skip
TABLES = ("history.csv", "load_displacement.csv")  # of a run, with the same rows
FEWEST = 3  # points of a curve
LARGEST_RATIO = 30.0  # of the largest values of measured and computed curves; other units differ by more


@dataclass(frozen=True)
class Curve:
    x: numpy.ndarray
    y: numpy.ndarray


@dataclass(frozen=True)
class Measured:
    """A measured curve in SI units."""

    name: str  # of its table
    curve: Curve
    noise: numpy.ndarray | None = None  # standard deviation of each y, if it is known
    columns: str = ""  # names of its columns, if they have any


# ---------------------------------------------------------------------------------------- measured


def read_measured(path: Path, columns: list[str] | None = None, units: tuple[str, str] = ("", "")) -> Measured:
    """Reads a table of numbers: separated by commas, semicolons or blanks; with or without a line of names.

    Args:
        columns: names of x, y and, if it is known, the standard deviation of y; default: the first two columns.
        units: those of x and y; default: SI units.

    Raises:
        InputError: file, line or column, and what is wrong.
    """
    try:
        lines = path.read_text("utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"{path}: can't be read ({getattr(error, 'strerror', None) or error})") from None
    rows = [(number, _cells(line)) for number, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not rows:
        raise InputError(f"{path}: has no rows")
    names = None if _number(rows[0][1][0]) is not None else rows.pop(0)[1]
    places = _places(path, columns, names)
    table = numpy.array([_numbers(path, number, cells, places) for number, cells in rows]).reshape(-1, len(places))
    return measured(table, str(path), units, ", ".join(names[place] for place in places) if names else "")


def measured(table: numpy.ndarray, name: str, units: tuple[str, str] = ("", ""), columns: str = "") -> Measured:
    """A measured curve of an array of two or three columns: x, y and the standard deviation of y."""
    if table.ndim != 2 or table.shape[1] not in (2, 3) or len(table) < FEWEST:
        raise InputError(f"{name}: must have two or three columns and at least {FEWEST} rows; it has the shape {table.shape}")
    if not numpy.isfinite(table).all():
        raise InputError(f"{name}: has values that are not finite")
    size = [_unit(unit) for unit in units]
    curve = Curve(table[:, 0] * size[0], table[:, 1] * size[1])
    if numpy.ptp(curve.x) == 0.0 or not curve.y.any():
        raise InputError(f"{name}: is no curve: " + ("y is zero everywhere" if numpy.ptp(curve.x) else "all x are equal"))
    noise = table[:, 2] * size[1] if table.shape[1] == 3 else None
    if noise is not None and noise.min() <= 0.0:
        raise InputError(f"{name}: a standard deviation is {noise.min():g}; must be positive")
    return Measured(name, curve, noise, columns)


def require_one_system(units: list[object]) -> None:
    """Refuses specimens whose plain numbers have different units: the tables `units` of their cases."""
    if any(each != units[0] for each in units):
        raise InputError("the specimens' cases have different [units], so that one number would mean different values: give them the same")


def _unit(name: str) -> float:
    if name and name not in UNITS:
        raise InputError(f"unit {name}: must be one of {', '.join(UNITS)}")
    return UNITS[name] if name else 1.0


def _cells(line: str) -> list[str]:
    separator = next((sign for sign in ";,\t" if sign in line), None)
    return [cell.strip().strip('"') for cell in line.split(separator)]


def _number(text: str) -> float | None:
    try:
        return float(text)
    except ValueError:
        return None


def _places(path: Path, columns: list[str] | None, names: list[str] | None) -> list[int]:
    if columns is None:
        return [0, 1]
    if names is None:
        raise InputError(f"{path}: has no line of names, so its columns are the first two; {', '.join(columns)} can't be found")
    for name in columns:
        if name not in names:
            raise unknown("column", name, names, path)
    return [names.index(name) for name in columns]


def _numbers(path: Path, line: int, cells: list[str], places: list[int]) -> list[float]:
    if len(cells) <= max(places):
        raise InputError(f"{path}:{line}: has {len(cells)} columns, column {max(places) + 1} is needed")
    found = [_number(cells[place]) for place in places]
    if None in found:
        raise InputError(f"{path}:{line}: {cells[places[found.index(None)]]!r} is not a number")
    return [value for value in found if value is not None]


# ---------------------------------------------------------------------------------------- computed


@dataclass(frozen=True)
class Columns:
    """Which columns of a run are compared: sums of them such as "right - left" and "-2*reaction_y:top"."""

    x: str
    y: str


def computed(folder: Path, columns: Columns) -> Curve:
    """The curve of a run; it may have no points.

    Raises:
        InputError: there is no such column.
    """
    table = read_tables(folder)
    return Curve(_sum(columns.x, table), _sum(columns.y, table))


def read_tables(folder: Path) -> dict[str, numpy.ndarray]:
    """The columns of numbers of a run, by name."""
    table: dict[str, numpy.ndarray] = {}
    for name in TABLES:
        try:
            with open(folder / name, newline="", encoding="utf-8") as file:
                names, *rows = csv.reader(file)
        except (OSError, ValueError):
            continue
        rows = [row for row in rows if len(row) == len(names)]  # a killed run may have half a row
        for column, cells in zip(names, zip(*rows) if rows else [()] * len(names), strict=True):
            numbers = [_number(cell) for cell in cells]
            if None not in numbers:
                table.setdefault(column, numpy.array(numbers, dtype=float))
    return table


def _sum(text: str, table: dict[str, numpy.ndarray]) -> numpy.ndarray:
    rows = {len(values) for values in table.values()}
    total = numpy.zeros(min(rows, default=0))
    for sign, factor, name in _terms(text, table):
        total = total + sign * factor * table[name][: len(total)]
    return total


def _terms(text: str, table: dict[str, numpy.ndarray]) -> list[tuple[int, float, str]]:
    parts = re.split(r"\s+([+-])\s+", text.strip())
    terms = []
    for sign, part in zip(["+", *parts[1::2]], parts[::2]):
        found = re.fullmatch(r"([+-]?)\s*(?:([0-9.]+(?:e[+-]?[0-9]+)?)\s*\*\s*)?(.*)", part, re.IGNORECASE)
        minus, factor, name = found.groups()  # type: ignore[union-attr]  # the last group takes anything
        if name not in table:
            raise unknown("column", name, table, "the history of a run")
        terms.append((-1 if (sign == "-") != (minus == "-") else 1, float(factor or 1.0), name))
    return terms


def default_columns(folder: Path, given: Columns, curve: Curve) -> Columns:
    """Names the columns that are not given: those of what the case drives, with the sign of the measured curve.

    Raises:
        InputError: nothing is driven, or a given column has another sign.
    """
    driven = []
    path = folder / "load_displacement.csv"
    if path.is_file():
        with open(path, newline="", encoding="utf-8") as file:
            driven = next(csv.reader(file), [])
    x = given.x or _first(driven, ("control", "displacement_"), "--x")
    y = given.y or _first(driven, ("force_",), "--y")
    found = computed(folder, Columns(x, y))
    signs = []
    for name, is_given, ours, theirs in ((x, given.x, found.x, curve.x), (y, given.y, found.y, curve.y)):
        is_opposite = _direction(ours) * _direction(theirs) < 0.0
        if is_opposite and is_given:
            raise InputError(f"column {name} has the other sign than the measured values: write -{name}" if name[0] not in "+-"
                             else f"column {name} has the other sign than the measured values")  # fmt: skip
        signs.append(f"-{name}" if is_opposite else name)
    return Columns(*signs)


def _direction(values: numpy.ndarray) -> float:
    """The sign of the values; 0 if the largest ones have both."""
    least, most = values.min(initial=0.0), values.max(initial=0.0)
    return 0.0 if max(-least, most) < 2.0 * min(-least, most) else 1.0 if most > -least else -1.0


def _first(columns: list[str], starts: tuple[str, ...], option: str) -> str:
    for start in starts:
        for name in columns:
            if name == start or (start.endswith("_") and name.startswith(start)):
                return name
    raise InputError(f"the case drives nothing that has a column: name a column of history.csv by {option}")


def require_same_units(name: str, curve: Curve, found: Curve) -> None:
    """Refuses curves whose largest values differ as those of different units do."""
    for axis, ours, theirs in (("x", found.x, curve.x), ("y", found.y, curve.y)):
        run, data = (float(numpy.abs(values).max(initial=0.0)) for values in (ours, theirs))
        if run > 0.0 and not 1.0 / LARGEST_RATIO < data / run < LARGEST_RATIO:
            raise InputError(f"{name}: {axis} reaches {data:.4g}, the run {run:.4g} (SI units): give the units of the data, "
                             "as by --units mm,kN, or other starting values")  # fmt: skip
