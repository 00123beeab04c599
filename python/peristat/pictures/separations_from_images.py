"""Finds cells at the rim of a body that are parted from its images beyond planes of symmetry and periods."""

import numpy as np

from .crossings import crosses

NEAR = 2  # range, in cells, of the bonds that decide whether two cells are joined


class Beyond:
    """The lattice positions of a body's images, and the straight bonds to them that are broken or cut."""

    def __init__(self, results, cells, bonds):
        self._reference, self._edges, self._cracks = results.reference, results.edges, results.cracks
        self._index, inverse = cells.index, np.linalg.inv(results.edges)
        self._shape = self._index.max(axis=0) + 1 + 2 * NEAR
        phase = (self._reference @ inverse - self._index).mean(axis=0)
        low, high = self._reference.min(axis=0), self._reference.max(axis=0)
        edge = (NEAR + 0.5) * np.abs(results.edges).sum(axis=0)
        images = results.image_kinds.all_places(self._reference, low - edge, high + edge)
        self._images = np.unique(self._key(np.rint(images @ inverse - phase).astype(np.int64)))
        across = bonds.image > 0
        start, end = bonds.ends(self._reference, results.image_kinds)[across].transpose(1, 0, 2)
        away = np.rint((end - start) @ inverse).astype(np.int64)
        self._broken = []
        for axis in range(cells.dimension):
            straight = (np.delete(away, axis, axis=1) == 0).all(axis=1) & (np.abs(away[:, axis]) <= NEAR)
            points = bonds.points[across, 0]
            self._broken.append(np.unique(points[straight] * (2 * NEAR + 1) + away[straight, axis]))

    def _key(self, index: np.ndarray) -> np.ndarray:
        """A number for each lattice position; -1 for those that lie farther from the body."""
        inside = ((index >= -NEAR) & (index < self._shape - NEAR)).all(axis=1)
        return np.where(inside, np.ravel_multi_index((index + NEAR).T, self._shape, mode="clip"), -1)

    def _place(self, cell, axis, away):
        return self._index[cell] + away * np.eye(self._index.shape[1], dtype=np.int64)[axis]

    def is_image(self, cell, axis, away) -> np.ndarray:
        """Whether there is an image at the given number of cells along an axis from cells."""
        return np.isin(self._key(self._place(cell, axis, away)), self._images)

    def is_gone(self, cell, axis, away) -> np.ndarray:
        """Whether there is no bond from cells to the image there; true where there is no image."""
        gone = np.isin(cell * (2 * NEAR + 1) + away, self._broken[axis]) | ~self.is_image(cell, axis, away)
        start = self._reference[cell]
        for crack in self._cracks:
            gone |= crosses(start, start + away * self._edges[axis], crack)
        return gone


def separate_from_images(results, cells, bonds) -> None:
    """Parts cells at the rim from the body's images if no straight bond to them is left, by the rule of `separate`."""
    beyond = Beyond(results, cells, bonds)
    for axis in range(cells.dimension):
        for sign in (-1, 1):
            cell = np.flatnonzero(cells.neighbours(axis, sign) < 0)
            cell = cell[beyond.is_image(cell, axis, sign)]
            cell = cell[beyond.is_gone(cell, axis, sign)]
            if results.reach > 1:
                cell = cell[beyond.is_gone(cell, axis, 2 * sign)]
                behind = cells.neighbours(axis, -sign)[cell]
                cell = cell[(behind < 0) | beyond.is_gone(behind, axis, 2 * sign)]
            cells.part_from_images(axis, sign, cell)
        if results.reach > 1:
            _join_over_images(cells, beyond, axis)


def _join_over_images(cells, beyond: Beyond, axis: int) -> None:
    """Rejoins the last two cells of a row that `separate` has parted although one of them is bonded to the
    image behind the other."""
    before, after = cells.neighbours(axis, -1), cells.neighbours(axis, 1)
    first = np.flatnonzero((before < 0) & (after >= 0))
    cells.join(axis, first[~beyond.is_gone(after[first], axis, -2)])
    last = np.flatnonzero((after < 0) & (before >= 0))
    cells.join(axis, before[last[~beyond.is_gone(before[last], axis, 2)]])
