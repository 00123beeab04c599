"""Pieces of a broken body, counted by their intact bonds."""

import h5py
import numpy as np


def pieces(folder, horizon, damage=0.5, least=10):
    """Sizes in points, descending, of the pieces with at least `least` points. Pieces consist of points with damage
    below a value that unbroken bonds connect."""
    with h5py.File(folder / "results.h5") as file:
        places = file["points/reference"][...]
        damages = list(file["steps"].values())[-1]["damage"][...]
        broken = np.column_stack([file["broken_bonds/first_point"][...], file["broken_bonds/second_point"][...]])
    whole = np.flatnonzero(damages < damage)
    count = len(places)
    gone = {(min(pair), max(pair)) for pair in broken.tolist()}
    root = list(range(count))

    def find(point):
        while root[point] != point:
            root[point] = root[root[point]]
            point = root[point]
        return point

    for number, point in enumerate(whole):
        others = whole[number + 1 :]
        near = others[np.linalg.norm(places[others] - places[point], axis=1) <= horizon * (1 + 1e-8)]
        for other in near.tolist():
            if (int(point), other) not in gone:
                root[find(other)] = find(int(point))
    sizes = np.bincount([find(int(point)) for point in whole], minlength=count)
    return sorted((int(size) for size in sizes if size >= least), reverse=True)
