"""Squares (2D) and cubes (3D) that tile a body of lattice points, in the reference and in the deformed
configuration."""

from itertools import product

import numpy as np

ROUND = [0, 2, 3, 1]  # corners of a square in circular order
SIDES = {(0, -1): [3, 0], (0, 1): [1, 2], (1, -1): [0, 1], (1, 1): [2, 3]}  # the corners at the ends of each side
# Corners of the faces of a cube, in the circular order that makes the normal point outwards.
FACES = {
    (0, -1): [0, 1, 3, 2],
    (0, 1): [4, 6, 7, 5],
    (1, -1): [0, 4, 5, 1],
    (1, 1): [2, 3, 7, 6],
    (2, -1): [0, 2, 6, 4],
    (2, 1): [1, 5, 7, 3],
}


class Cells:
    """One cell per point. Neighbouring cells share corners, so that a picture has no gaps, unless they have been parted
    (separations.py).

    A lattice, also a perturbed one, is recognised by its cells of one spacing: every point must have a cell of its
    own. Points that form no lattice get a separate square or cube each, without neighbours (in a plane:
    cloud_cells.py).

    index      count x dimension, lattice position of the cell
    edges      of a cell, one row per lattice axis [m]
    spacing    edge length of a square or cube of the same volume [m]
    offsets    of the corners from the cell's position, in edges: one row per corner, for all cells or for each
    is_lattice whether the points form a lattice
    """

    def __init__(self, reference: np.ndarray, spacing):
        self.dimension = reference.shape[1]
        self.edges = as_edges(spacing, self.dimension)
        self.spacing = float(abs(np.linalg.det(self.edges)) ** (1.0 / self.dimension))
        self.offsets = 0.5 * corner_signs(self.dimension)
        places = reference @ np.linalg.inv(self.edges)
        phase = np.angle(np.exp(2j * np.pi * places).mean(axis=0)) / (2 * np.pi)
        index = np.rint(places - phase).astype(np.int64)
        index -= index.min(axis=0)
        self._shape = index.max(axis=0) + 3  # one empty layer around, so that every index has neighbours
        count = len(index)
        self.is_lattice = float(np.prod(self._shape.astype(float))) < 60.0 * count + 1e6
        if self.is_lattice:
            self._number(index)
            self.is_lattice = np.count_nonzero(self._grid >= 0) == count
        if not self.is_lattice:  # every second cell of a row, so that no cell has a neighbour
            index = np.zeros_like(index)
            index[:, 0] = 2 * np.arange(count)
            self._shape = index.max(axis=0) + 3
            self._number(index)

    def _number(self, index: np.ndarray) -> None:
        """Numbers the cells in a dense grid; -1 is empty."""
        self.index = index
        self._parted = np.zeros((self.dimension, len(index)), dtype=bool)  # from the next cell along the axis
        self._open: dict = {}  # by axis and sign: cells parted from the body's images in that direction
        self._strides = np.array([int(np.prod(self._shape[axis + 1 :])) for axis in range(self.dimension)])
        self._flat = (index + 1) @ self._strides
        self._grid = np.full(int(np.prod(self._shape)), -1, dtype=np.int64)
        self._grid[self._flat] = np.arange(len(index))

    def neighbours(self, axis: int, sign: int) -> np.ndarray:
        """Number of every cell's neighbour in a direction, -1 if it has none."""
        return self.cells_at(sign * np.eye(self.dimension, dtype=np.int64)[axis])

    def cells_at(self, away: np.ndarray) -> np.ndarray:
        """Number of the cell at the given lattice offset (at most one along each axis) from every cell, or -1."""
        return self._grid[self._flat + away @ self._strides]

    def part(self, axis: int, cells: np.ndarray) -> None:
        """Parts cells from their next neighbours along an axis."""
        self._parted[axis, cells] = True

    def join(self, axis: int, cells: np.ndarray) -> None:
        """Rejoins cells with their next neighbours along an axis."""
        self._parted[axis, cells] = False

    def part_from_images(self, axis: int, sign: int, cells: np.ndarray) -> None:
        """Parts cells at the rim from the images beyond a plane of symmetry or a period."""
        self._open[axis, sign] = cells

    def joined(self, axis: int, sign: int) -> np.ndarray:
        """Number of every cell's neighbour in a direction if the two are joined, else -1."""
        other = self.neighbours(axis, sign)
        lower = np.arange(len(other)) if sign > 0 else other  # index -1 reads the last entry, and the result stays -1
        return np.where(self._parted[axis, lower], -1, other)

    def parted(self, axis: int, sign: int) -> np.ndarray:
        """Whether every cell has a neighbour (a cell or an image) in a direction from which it has been parted."""
        parted = (self.neighbours(axis, sign) >= 0) & (self.joined(axis, sign) < 0)
        parted[self._open.get((axis, sign), [])] = True
        return parted

    def sides(self):
        """For each side of a square: the corners of `outlines` at its ends, the neighbours beyond it, and whether these
        have been parted."""
        for side, ends in SIDES.items():
            yield ends, self.neighbours(*side), self.parted(*side)

    @property
    def is_image(self) -> bool:
        """Whether the cells can be drawn as the pixels of an image: axis-parallel squares, none of them fitted to an
        outline."""
        return self.is_lattice and self.offsets.ndim == 2 and bool((self.edges == np.diag(np.diag(self.edges))).all())

    def image(self, values: np.ndarray) -> np.ndarray:
        """Values of a plane lattice as an image, rows along y from below; NaN where there is no point."""
        image = np.full(self.index.max(axis=0) + 1, np.nan)
        image[tuple(self.index.T)] = values
        return image.T

    def corners(self, reference: np.ndarray, displacement: np.ndarray, loose: np.ndarray) -> np.ndarray:
        """Displaced corners, count x 2^dimension x dimension; corner bits are those of `signs()`.

        Displacements are extrapolated linearly from the points to the corners and averaged there over the cells that
        are joined. Loose cells (those of broken material) move with their point alone.
        """
        moved = displacement[:, None, :] + self.offsets @ self._change(displacement, loose)
        knot = self._knots(loose)
        number_of_cells = np.maximum(np.bincount(knot.ravel(), minlength=knot.size), 1)
        for component in range(self.dimension):
            sums = np.bincount(knot.ravel(), moved[:, :, component].ravel(), minlength=knot.size)
            moved[:, :, component] = (sums / number_of_cells)[knot]
        return self.centres(reference)[:, None, :] + self.offsets @ self.edges + moved

    def outlines(self, reference: np.ndarray, displacement: np.ndarray, loose: np.ndarray) -> np.ndarray:
        """Displaced corners of squares in circular order, count x 4 x 2."""
        return self.corners(reference, displacement, loose)[:, ROUND]

    def centres(self, reference: np.ndarray) -> np.ndarray:
        """Centres of the cells; for a perturbed lattice, the unperturbed positions."""
        if not self.is_lattice:
            return reference
        places = self.index @ self.edges
        return places + (reference - places).mean(axis=0)

    def _knots(self, loose: np.ndarray) -> np.ndarray:
        """A number per corner, which joined cells share at their common corners."""
        corners = 2**self.dimension
        knot = np.arange(len(loose) * corners).reshape(-1, corners)
        for _ in range(corners):  # at most this many cells meet in a corner
            before = knot.copy()
            for axis in range(self.dimension):
                other = self.joined(axis, 1)
                lower = np.flatnonzero((other >= 0) & ~loose & ~loose[other])
                bit = corners >> (axis + 1)
                high = np.flatnonzero(np.arange(corners) & bit)
                least = np.minimum(knot[lower[:, None], high], knot[other[lower][:, None], high - bit])
                knot[lower[:, None], high] = knot[other[lower][:, None], high - bit] = least
            if (knot == before).all():
                break
        return knot

    def _change(self, displacement: np.ndarray, loose: np.ndarray) -> np.ndarray:
        """Change of the displacement along each edge, from differences to the neighbours: count x axis x component."""
        change = np.zeros((len(displacement), self.dimension, self.dimension))
        for axis in range(self.dimension):
            number = np.zeros(len(displacement))
            for sign in (-1, 1):
                other = self.joined(axis, sign)
                usable = (other >= 0) & ~loose & ~loose[other]
                difference = sign * (displacement[other] - displacement)
                change[:, axis] += np.where(usable[:, None], difference, 0.0)
                number += usable
            change[:, axis] /= np.maximum(number, 1.0)[:, None]
        return change


def at_the_rim(cells: Cells, floating: np.ndarray) -> np.ndarray:
    """Cells that float while a neighbour does not, or the other way round."""
    rim = np.zeros(len(floating), dtype=bool)
    for axis, sign in product(range(cells.dimension), (-1, 1)):
        other = cells.neighbours(axis, sign)
        rim |= (other >= 0) & (floating != floating[other])
    return rim


def as_edges(spacing, dimension: int) -> np.ndarray:
    """Edges of a cell, one row per axis, from a single spacing or as given."""
    return spacing * np.eye(dimension) if np.ndim(spacing) == 0 else np.asarray(spacing, float)


def corner_signs(dimension: int) -> np.ndarray:
    """Signs of a cell's corners, 2^dimension x dimension; the last axis changes fastest."""
    return np.array(list(product((-1.0, 1.0), repeat=dimension)))


def merged(reference: np.ndarray, spacing, limit: int, *fields: np.ndarray):
    """Fewer points for a picture: means over blocks of lattice cells until at most `limit` remain.

    Returns spacing (or edges, as given), reference and fields, unchanged if there are few enough points. A screen
    cannot resolve a million cells, and they take long to draw.
    """
    if len(reference) <= limit:
        return spacing, reference, *fields
    dimension = reference.shape[1]
    factor = int(np.ceil((len(reference) / limit) ** (1.0 / dimension)))
    edges = as_edges(spacing, dimension)
    along = reference @ np.linalg.inv(edges)  # coordinates along the lattice's axes, in spacings
    block = np.floor((along - along.min(axis=0)) / factor + 1e-6).astype(np.int64)
    shape = block.max(axis=0) + 1
    key = block @ np.array([int(np.prod(shape[axis + 1 :])) for axis in range(dimension)])
    _, group = np.unique(key, return_inverse=True)
    number = np.bincount(group)

    def mean(values):
        if values.ndim == 1:
            return np.bincount(group, values) / number
        return np.stack([np.bincount(group, column) / number for column in values.T], axis=1)

    # Blocks that are only partly filled keep the position of a full block, so that blocks tile without gaps.
    first = np.zeros((len(number), dimension))
    first[group] = block
    places = (along.min(axis=0) + (first + 0.5) * factor - 0.5) @ edges
    return factor * spacing, places, *(mean(values) for values in fields)
