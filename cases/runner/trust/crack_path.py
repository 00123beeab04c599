"""The path of a crack from the broken bonds, and its distance from a measured path."""

import csv
import math
from pathlib import Path

Place = tuple[float, float]


def broken_middles(folder: Path) -> list[Place]:
    """Midpoints of the broken bonds [m]."""
    import h5py

    with h5py.File(folder / "results.h5") as file:
        places = file["points/reference"][...].tolist()
    with open(folder / "broken_bonds.csv", newline="") as table:
        ends = [(int(row["first_point"]), int(row["second_point"])) for row in csv.DictReader(table)]
    return [tuple(0.5 * (p + q) for p, q in zip(places[first], places[second])) for first, second in ends]


def line(middles: list[Place], along: int, step: float, least: int = 3) -> list[Place]:
    """The crack's centre line: mean midpoints in slices of thickness `step` across an axis, with a least number of
    bonds each."""
    slices: dict[int, list[Place]] = {}
    for middle in middles:
        slices.setdefault(math.floor(middle[along] / step), []).append(middle)
    return [(sum(x for x, _ in of) / len(of), sum(y for _, y in of) / len(of)) for _, of in sorted(slices.items()) if len(of) >= least]


def distance(place: Place, path: list[Place]) -> float:
    """Distance to the nearest point of a polyline."""
    return min(_to_piece(place, *piece) for piece in zip(path, path[1:]))


def _to_piece(place: Place, start: Place, end: Place) -> float:
    across, along = end[0] - start[0], end[1] - start[1]
    share = ((place[0] - start[0]) * across + (place[1] - start[1]) * along) / (across**2 + along**2)
    share = min(max(share, 0.0), 1.0)
    return math.hypot(place[0] - start[0] - share * across, place[1] - start[1] - share * along)
