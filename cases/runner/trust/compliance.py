"""The apparent toughness of a specimen while its crack grows, with the crack length from its compliance (ASTM E561),
which includes the effect of the process zone."""

from collections.abc import Callable
from pathlib import Path

from specimen import rows

LEAST_GROWTH = 2.0  # horizons, until the process zone has developed


def crack_of(compliance: float, of_crack: Callable[[float], float], first: float, last: float) -> float:
    """The crack length with the given compliance, by bisection of an increasing function."""
    low, high = first, last
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if of_crack(middle) < compliance else (low, middle)
    return low


def elastic_factor(folder: Path, force: str, opening_over_load: float) -> float:
    """Opening of the elastic specimen over that of its closed form, because parts of the specimen may be stiffer."""
    first = next(row for row in rows(folder) if row[force] != 0.0)
    return first["control"] / abs(first[force]) / opening_over_load


def toughness(folder: Path, force: str, opening_over_load: Callable[[float], float],
              load: Callable[[float], float], first: float, last: float, least_growth: float) -> float:  # fmt: skip
    """K over K_Ic, averaged while the crack grows from `first` + `least_growth` to `last` [m].

    @param force column of the history; the opening is the controlled quantity
    @param opening_over_load of a crack [m/N]
    @param load at which K of a crack is K_Ic
    @raise ValueError if the crack never grew that far
    """
    found = []
    for row in rows(folder):
        if row[force] == 0.0:
            continue
        crack = crack_of(row["control"] / abs(row[force]), opening_over_load, first, last)
        if first + least_growth < crack < 0.999 * last:
            found.append(abs(row[force]) / load(crack))
    if not found:
        raise ValueError(f"its crack has not grown by {least_growth:.3g} m")
    return sum(found) / len(found)
