"""Voronoi cells that tile a plane cloud of points, in the reference and in the deformed configuration."""

import numpy as np

from .crossings import crosses
from .voronoi import Polygons

MOST_STRAIN = 0.5  # drawn of a cell at a crack
SAME = 1e-3  # share of a cell's size; corners that are closer count as one


class CloudCells:
    """One polygon per point of a cloud, the counterpart of `Cells` for lattices. Neighbours share corners unless they
    have been parted.

    polygons   in the reference configuration, and the points that they belong to (count x 2)
    size       of a cell
    """

    dimension = 2
    is_lattice = is_image = False

    def __init__(self, polygons: Polygons, points: np.ndarray, size: float):
        self._polygons, self._points = polygons, points
        self._parted = np.zeros(polygons.beyond.shape, dtype=bool)
        key = np.rint((polygons.corners - points.min(axis=0)) / (SAME * size) + 0.3).astype(np.int64)
        self._knot = np.unique((key[:, :, 0] << 32) + key[:, :, 1], return_inverse=True)[1].reshape(key.shape[:2])

    @property
    def polygons(self) -> Polygons:
        return self._polygons

    @property
    def knots(self) -> np.ndarray:
        """A number per corner, which all cells share that meet there, count x most."""
        return self._knot

    @property
    def parted(self) -> np.ndarray:
        """Whether each cell has been parted from the one beyond each side, count x most."""
        return self._parted

    def part(self, cracks, broken: np.ndarray, piece: np.ndarray) -> None:
        """Parts neighbours whose bond is broken (`broken`, count x 2) or meets a crack, or that belong to different
        pieces."""
        cell, side = np.nonzero(self._is_inner())
        other, count = self._polygons.beyond[cell, side], len(self._points)
        keys = np.sort(broken, axis=1) @ [count, 1]
        gone = np.isin(np.minimum(cell, other) * count + np.maximum(cell, other), keys) | (piece[cell] != piece[other])
        for crack in cracks:
            gone |= crosses(self._points[cell], self._points[other], crack)
        self._parted[cell, side] = gone

    def sides(self):
        """For each side: the corners at its ends, the neighbours beyond it, and whether these have been parted."""
        most = self._parted.shape[1]
        for side in range(most):
            yield [side, (side + 1) % most], self._polygons.beyond[:, side], self._parted[:, side]

    def outlines(self, reference: np.ndarray, displacement: np.ndarray, loose: np.ndarray) -> np.ndarray:
        """Displaced corners, count x most x 2. As in `Cells.corners`, displacements are extrapolated linearly to the
        corners and averaged there. Loose cells, and cells at a corner where cells have been parted, move alone."""
        gradient = self._gradient(displacement, loose)
        corners = self._polygons.corners
        moved = displacement[:, None] + (corners - self._points[:, None]) @ gradient
        apart = np.zeros(self._knot.max() + 1, dtype=bool)
        apart[self._knot[loose]] = True
        apart[self._knot[self._parted]] = True
        is_side = self._polygons.is_side
        knot, together = self._knot[is_side], ~apart[self._knot]
        number = np.maximum(np.bincount(knot, minlength=len(apart)), 1)
        for axis in range(2):
            mean = np.bincount(knot, moved[:, :, axis][is_side], minlength=len(apart)) / number
            moved[:, :, axis] = np.where(together, mean[self._knot], moved[:, :, axis])
        return corners + moved

    def _is_inner(self) -> np.ndarray:
        """Sides between two cells, count x most."""
        return (self._polygons.beyond >= 0) & self._polygons.is_side

    def _gradient(self, displacement, loose) -> np.ndarray:
        """Displacement gradient, count x 2 (direction) x 2 (component), by least squares over joined neighbours."""
        cell, side = np.nonzero(self._is_inner() & ~self._parted)
        other = self._polygons.beyond[cell, side]
        usable = ~loose[cell] & ~loose[other]
        cell, other = cell[usable], other[usable]
        apart, change = self._points[other] - self._points[cell], displacement[other] - displacement[cell]
        products = np.stack([a * b for a in apart.T for b in (*apart.T, *change.T)])
        sums = np.stack([np.bincount(cell, row, minlength=len(loose)) for row in products], axis=1).reshape(-1, 2, 4)
        gradient = np.linalg.pinv(sums[:, :, :2], rcond=1e-2) @ sums[:, :, 2:]
        # A cell at a crack has few neighbours left, whose differences would draw it out to a needle.
        strain = np.linalg.norm(gradient, axis=(1, 2))
        most = np.where(self._parted.any(axis=1), MOST_STRAIN, np.inf)
        return gradient * np.minimum(1.0, most / np.maximum(strain, 1e-300))[:, None, None]
