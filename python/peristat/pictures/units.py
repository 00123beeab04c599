"""Numbers and units that are easy to read."""

import numpy as np

PREFIXES = (("T", 1e12), ("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9),
            ("p", 1e-12), ("f", 1e-15))  # fmt: skip


def scaled(unit: str):
    """The unit with all prefixes and their sizes, the largest first."""
    return tuple((prefix + unit, size) for prefix, size in PREFIXES)


LENGTHS = (("km", 1e3), *scaled("m")[4:])
FORCES, ENERGIES, ENERGY_DENSITIES, STRESSES = scaled("N"), scaled("J"), scaled("J/m³"), scaled("Pa")
UNITS = {"m": LENGTHS, "N": FORCES, "J": ENERGIES, "J/m3": ENERGY_DENSITIES, "Pa": STRESSES}  # as results.h5 spells them
TIMES = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9))


def units_of(unit: str):
    """The units for values that a results folder has in `unit`; a dimensionless number has none."""
    return UNITS.get(unit, (("" if unit == "1" else unit, 1.0),))


def unit_for(largest: float, units, least: float = 0.3) -> tuple[str, float]:
    """Name and size of the largest unit in which the largest value is at least `least`."""
    for name, size in units:
        if largest >= least * size:
            return name, size
    return units[-1] if largest > 1e-30 else next(unit for unit in units if unit[1] == 1.0)


def time_unit(longest: float) -> tuple[str, float]:
    """The unit for a time [s], and its size."""
    return next(((unit, size) for unit, size in TIMES if abs(longest) >= size), TIMES[-1 if longest else 0])


def round_factor(wanted: float) -> float:
    """Largest of 1, 2, 5, 10, 20, 50, ... that does not exceed the wanted factor; at least 1."""
    if not np.isfinite(wanted) or wanted <= 1.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(wanted))
    return max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= wanted * (1 + 1e-12))


def number(value: float, digits: int = 4) -> str:
    """A number in readable form: 7 500, 0.25, 1.2e-7."""
    if value == int(value) and abs(value) < 1e9:
        return f"{int(value):,}".replace(",", "\u2009")
    return f"{value:.{digits}g}"


def load_axis(values) -> tuple[str, float]:
    """Label of an axis of load factors, and the divisor of its values: a load in metres has tiny ones."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest == 0.0 or 1e-2 <= largest < 1e5:
        return "load factor", 1.0
    power = 3 * int(np.floor(np.log10(largest) / 3.0))
    return f"load factor [$10^{{{power}}}$]", 10.0**power
