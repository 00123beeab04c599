"""Directions of kinked cracks beside those of fracture mechanics, as a table and as values."""

import csv
import io
import math
import statistics

import lefm
from kinked_disk import Found, Loading, Points

# Chords of paths with K_II = 0 in the same disk [degrees], as `/usr/bin/python3 -BEs -m tests.reference.kinked_crack`
# prints them in its column `disk`.
REFERENCE = {
    Loading(0.176, 0.0): -18.24,
    Loading(0.364, 0.0): -33.21,
    Loading(0.577, 0.0): -44.32,
    Loading(0.859, 0.0): -53.10,
    Loading(0.364, 0.2): -44.87,
    Loading(0.364, -0.1): -28.32,
    Loading(0.364, -0.2): -24.35,
    Loading(0.577, -0.2): -34.44,
}
ALLOWED, ALLOWED_WITH_T = 5.0, 8.0  # degrees
NOISE, FINER = "blue noise", "finer"
HEADING = [f"| K_II / K_I | T* | largest hoop stress | path with K_II = 0 | lattice 0° | 18° | 27° | 45° | {NOISE} | {FINER} | |",
           "|---|---|---|---|---|---|---|---|---|---|---|"]  # fmt: skip
TABLE = HEADING[0].encode()  # the signature of the table
COLUMNS = ["sliding_over_opening", "T_star", "points", "reference", "direction", "K1_over_given", "K2_over_given", "elastic_T_star", "note"]
SIGN = ",".join(COLUMNS).encode()  # signature of the values

Results = dict[tuple[Loading, Points], Found]


def allowed(loading: Loading) -> float:
    return ALLOWED_WITH_T if loading.stress else ALLOWED


def column(points: Points) -> str:
    return f"{points.angle:.0f}°" if not points.seed else FINER if points.finer > 1 else NOISE


def columns(found: Results, loading: Loading) -> dict[str, list[Found]]:
    """What was found on each lattice, and on all points of blue noise together."""
    by_column: dict[str, list[Found]] = {}
    for (of, points), one in found.items():
        if of == loading:
            by_column.setdefault(column(points), []).append(one)
    return by_column


def faults(found: Results, loading: Loading) -> list[str]:
    """Columns that are farther off than allowed, or failed."""
    told = []
    for name, ones in columns(found, loading).items():
        off = statistics.fmean(one.direction for one in ones) - REFERENCE[loading]
        failed = [one.note for one in ones if one.note]
        if failed:
            told.append(f"{name}: {failed[0][:100]}")
        elif not abs(off) <= allowed(loading):
            told.append(f"{name} by {off:+.1f}°")
    return told


def cell(ones: list[Found]) -> str:
    """A direction, or mean ± standard deviation of several."""
    values = [one.direction for one in ones if not math.isnan(one.direction)]
    if not values:
        return ""
    return f"{statistics.fmean(values):.1f}" + (f" ± {statistics.stdev(values):.1f}" if len(values) > 1 else "")


def table(found: Results) -> str:
    lines = []
    for loading in dict.fromkeys(of for of, _ in found):
        by_column, off = columns(found, loading), faults(found, loading)
        cells = [cell(by_column.get(name, [])) for name in ("0°", "18°", "27°", "45°", NOISE, FINER)]
        hoop = math.degrees(lefm.hoop_direction(1.0, loading.sliding))
        word = "**red**: " + ", ".join(off) if off else "pass"
        lines.append(f"| {loading.sliding:g} | {loading.stress:g} | {hoop:.1f} | {REFERENCE[loading]:.1f} | {' | '.join(cells)} | {word} |")
    return "\n".join([*HEADING, *lines]) + f"\n\nDirections in degrees; {ALLOWED:g} are allowed, with a T-stress {ALLOWED_WITH_T:g}.\n"


def values(found: Results) -> str:
    lines = [[loading.sliding, loading.stress, points.name, REFERENCE[loading],
              one.direction, one.opening, one.sliding, one.stress, one.note]
             for (loading, points), one in found.items()]  # fmt: skip
    text = io.StringIO(newline="")
    csv.writer(text).writerows([COLUMNS, *lines])
    return text.getvalue()
