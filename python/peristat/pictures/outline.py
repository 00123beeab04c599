"""The outline of a plane body from its case: shapes that are added and subtracted."""

import numpy as np

from .crossings import inside_polygon

BESIDE = 0.02  # distance of test points from an outline, in spacings; larger than the error of the polygon for a circle
MOST_PIECES = 20_000  # limit per shape's boundary
FARTHEST = 1e9  # limit on the distance of a shape's corners from the origin, in spacings
KINK = np.radians(30.0)  # smallest turn of a boundary that counts as a corner
AROUND = 3.0  # margin around the points within which an outline matters, in spacings


class Shape:
    """A polygon, or a disk as a polygon of short sides; added or subtracted.

    window  corners of a box outside which the shape does not matter
    """

    def __init__(self, table: dict, spacing: float, window: tuple[np.ndarray, np.ndarray]):
        self.adds = "add" in table
        kind = table["add"] if self.adds else table["subtract"]
        self._disk = None
        if kind == "box":
            (a, b), (c, d) = table["min"], table["max"]
            self.vertices = np.clip(np.array([[a, b], [c, b], [c, d], [a, d]], dtype=float), *window)
        elif kind == "disk":
            centre, radius = self._disk = np.array(table["centre"], dtype=float), float(table["radius"])
            corners = np.clip(2.0 * np.pi * radius / (0.25 * spacing), 64, MOST_PIECES)
            angle = np.linspace(0.0, 2.0 * np.pi, int(corners), endpoint=False)
            self.vertices = centre + radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
        else:
            self.vertices = np.array(table["vertices"], dtype=float)
        if self.vertices.ndim != 2 or self.vertices.shape[1] != 2 or not np.abs(self.vertices).max() < FARTHEST * spacing:
            raise ValueError(kind)

    def holds(self, places: np.ndarray) -> np.ndarray:
        """Whether positions (count x 2) lie inside."""
        if self._disk:
            return np.linalg.norm(places - self._disk[0], axis=1) <= self._disk[1]
        return inside_polygon(places, self.vertices)

    def corners(self) -> np.ndarray:
        """Vertices at which the boundary turns sharply, count x 2."""
        along = np.roll(self.vertices, -1, axis=0) - self.vertices
        along /= np.maximum(np.linalg.norm(along, axis=1), 1e-300)[:, None]
        return self.vertices[(along * np.roll(along, 1, axis=0)).sum(axis=1) < np.cos(KINK)]

    def pieces(self, spacing: float) -> np.ndarray:
        """The boundary in pieces of at most about half a spacing, count x 2 ends x 2."""
        begin, end = self.vertices, np.roll(self.vertices, -1, axis=0)
        length = np.linalg.norm(end - begin, axis=1)
        count = np.ceil(length / max(0.5 * spacing, length.sum() / MOST_PIECES)).astype(int)
        side = np.repeat(np.arange(len(begin)), count)
        share = ((np.arange(len(side)) - np.searchsorted(side, side)) / count[side])[:, None]
        step = (end - begin)[side] / count[side, None]
        first = begin[side] + share * (end - begin)[side]
        return np.stack([first, first + step], axis=1)


class Outline:
    """The boundary of a body.

    pieces   of its outline, count x 2 ends x 2 [m]
    corners  its kinks, count x 2 [m]
    """

    def __init__(self, shapes: list[Shape], spacing: float):
        self._shapes = shapes
        pieces = np.concatenate([shape.pieces(spacing) for shape in shapes])
        middle, along = pieces.mean(axis=1), pieces[:, 1] - pieces[:, 0]
        aside = np.stack([-along[:, 1], along[:, 0]], axis=1)
        aside *= BESIDE * spacing / np.linalg.norm(aside, axis=1)[:, None]
        self.pieces = pieces[self.holds(middle - aside) != self.holds(middle + aside)]
        self.corners = np.unique(np.concatenate([shape.corners() for shape in shapes]), axis=0)
        apart = [np.linalg.norm(self.pieces - corner, axis=2).min(initial=np.inf) for corner in self.corners]
        self.corners = self.corners[np.array(apart) < BESIDE * spacing]

    def holds(self, places: np.ndarray) -> np.ndarray:
        """Whether positions (count x 2) lie in the body."""
        held = np.zeros(len(places), dtype=bool)
        for shape in self._shapes:
            held[shape.holds(places)] = shape.adds
        return held

    def nearest(self, places: np.ndarray, most) -> np.ndarray:
        """Nearest points of the outline; positions farther away than `most` stay."""
        begin, end = self.pieces.transpose(1, 0, 2)
        found = places.copy()
        for part in np.array_split(np.arange(len(places)), 1 + len(places) // 500):
            own = places[part]
            piece = ((own[:, None] - 0.5 * (begin + end)) ** 2).sum(axis=2).argmin(axis=1)
            along = (end - begin)[piece]
            share = ((own - begin[piece]) * along).sum(axis=1) / (along**2).sum(axis=1)
            found[part] = begin[piece] + np.clip(share, 0.0, 1.0)[:, None] * along
        return np.where((np.linalg.norm(found - places, axis=1) <= most)[:, None], found, places)

    def with_corners(self, places: np.ndarray, most: float) -> np.ndarray:
        """Positions after moving the nearest one to each corner of the outline onto it, if it is no farther than
        `most`."""
        found = places.copy()
        for corner in self.corners if len(places) else []:
            distance = np.linalg.norm(found - corner, axis=1)
            if distance.min() <= most:
                found[np.linalg.norm(found - found[distance.argmin()], axis=1) <= BESIDE * most] = corner
        return found


def read_outline(tables: list, spacing: float, points: np.ndarray) -> Outline | None:
    """The outline from the tables lattice.shape near the points; None if there are no shapes or they are invalid."""
    window = points.min(axis=0) - AROUND * spacing, points.max(axis=0) + AROUND * spacing
    try:
        outline = Outline([Shape(table, spacing, window) for table in tables], spacing)
    except (KeyError, TypeError, ValueError):
        return None
    return outline if len(outline.pieces) else None
