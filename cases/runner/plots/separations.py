"""Which neighbouring cells of a body no longer hang together: pre-cracks and broken bonds lie between them."""

import numpy as np

from cells import Cells, at_the_rim, merged

LOOSE_DAMAGE = 0.35  # a cell this damaged lies at a crack; it moves with its point alone if more isn't known
LOST_DAMAGE = 0.65  # a cell this damaged has lost more than a crack takes from it, and moves with its point alone
NEAR = 2  # cells over which bonds part or join two of them
TOUCHING = 1e-9  # share of a length: a crack that only touches a bond cuts it


def separate(cells, reference: np.ndarray, cracks, broken: np.ndarray | None = None, reach: int = 2) -> None:
    """Parts the cells (cells.Cells) between which no bond is left: pre-cracks have cut them, or they broke.

    Of the bonds those count that go straight from cell to cell, over the face between them: from one to the
    other, and where the horizon reaches two spacings also from one to the cell behind the other. Beside a
    crack single bonds break; the cells hang together all the same.

    reference  count x dimension, centres of the cells [m]
    cracks     ends of a segment (2D), vertices of a plane polygon (3D) [m]
    broken     count x 2, points of the broken bonds; None where cells are no points
    reach      of the horizon in whole spacings
    """
    count = len(reference)
    pairs = np.sort(broken, axis=1) if broken is not None else np.zeros((0, 2), dtype=np.int64)
    keys = np.unique(pairs[:, 0] * count + pairs[:, 1])

    def is_gone(one, other):
        """Whether there is no bond between cells, be it that there is no cell (-1)."""
        gone = np.isin(np.minimum(one, other) * count + np.maximum(one, other), keys)
        for crack in cracks:
            gone |= crosses(reference[one], reference[other], crack)
        return gone | (one < 0) | (other < 0)

    for axis in range(cells.dimension):
        before, after = cells.neighbours(axis, -1), cells.neighbours(axis, 1)
        cell = np.flatnonzero(after >= 0)
        cell = cell[is_gone(cell, after[cell])]
        if reach > 1 and broken is not None:
            cell = cell[is_gone(cell, after[after[cell]])]
            cell = cell[is_gone(before[cell], after[cell])]
        cells.part(axis, cell)


class _Beyond:
    """The lattice places of a body's images, and which straight bonds to them are broken or cut."""

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
        """A number of each lattice place; -1 of those that lie farther from the body."""
        inside = ((index >= -NEAR) & (index < self._shape - NEAR)).all(axis=1)
        return np.where(inside, np.ravel_multi_index((index + NEAR).T, self._shape, mode="clip"), -1)

    def _place(self, cell, axis, away):
        return self._index[cell] + away * np.eye(self._index.shape[1], dtype=np.int64)[axis]

    def is_image(self, cell, axis, away) -> np.ndarray:
        """Whether an image stands so many cells away from cells along an axis."""
        return np.isin(self._key(self._place(cell, axis, away)), self._images)

    def is_gone(self, cell, axis, away) -> np.ndarray:
        """Whether there is no bond from cells to the image there, be it that there is none."""
        gone = np.isin(cell * (2 * NEAR + 1) + away, self._broken[axis]) | ~self.is_image(cell, axis, away)
        start = self._reference[cell]
        for crack in self._cracks:
            gone |= crosses(start, start + away * self._edges[axis], crack)
        return gone


def separate_from_images(results, cells, bonds) -> None:
    """Parts cells at the rim from the body's images if no bond that goes straight to them is left, by the
    rule of `separate`."""
    beyond = _Beyond(results, cells, bonds)
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


def crosses(start: np.ndarray, end: np.ndarray, crack: np.ndarray) -> np.ndarray:
    """Whether straight lines (count x dimension) meet a crack, be it with an end."""
    return _crosses_segment(start, end, *crack) if crack.shape[1] == 2 else _crosses_polygon(start, end, crack)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def _crosses_segment(start, end, tip, other_tip) -> np.ndarray:
    line, crack, apart = end - start, other_tip - tip, tip - start
    length, crack_length = np.linalg.norm(line, axis=1), np.linalg.norm(crack)
    turn = _cross(line, crack)
    parallel = np.abs(turn) <= TOUCHING * length * crack_length
    turn = np.where(parallel, 1.0, turn)
    along, on_crack = _cross(apart, crack) / turn, _cross(apart, line) / turn
    slack = TOUCHING * length / crack_length
    met = (np.abs(along - 0.5) <= 0.5 + TOUCHING) & (on_crack >= -slack) & (on_crack <= 1.0 + slack)
    # On one line they meet where they overlap.
    beside = np.abs(_cross(apart, line)) <= TOUCHING * length**2
    places = np.stack([((end_of - start) * line).sum(axis=1) for end_of in (tip, other_tip)]) / length**2
    overlap = (places.min(axis=0) <= 1.0 + TOUCHING) & (places.max(axis=0) >= -TOUCHING)
    return np.where(parallel, beside & overlap, met)


def _crosses_polygon(start, end, vertices) -> np.ndarray:
    middle = vertices.mean(axis=0)
    spokes = vertices - middle
    normal = np.cross(spokes, np.roll(spokes, -1, axis=0)).sum(axis=0)
    if not np.linalg.norm(normal) > 0.0:
        return np.zeros(len(start), dtype=bool)
    normal /= np.linalg.norm(normal)
    below, above = (start - middle) @ normal, (end - middle) @ normal
    slack = TOUCHING * np.linalg.norm(end - start, axis=1)
    passes = (np.minimum(below, above) <= slack) & (np.maximum(below, above) >= -slack)
    rise = np.where(np.abs(above - below) > slack, above - below, 1.0)
    share = np.where(np.abs(above - below) > slack, np.clip(-below / rise, 0.0, 1.0), 0.0)
    place = start + share[:, None] * (end - start)
    flat = np.delete(np.arange(3), np.argmax(np.abs(normal)))  # coordinates in which the polygon is not flat
    return passes & _inside(place[:, flat], vertices[:, flat])


def _inside(places, vertices) -> np.ndarray:
    """Whether places are inside a polygon of the plane, by the number of its edges above them."""
    inside = np.zeros(len(places), dtype=bool)
    x, y = places.T
    for (ax, ay), (bx, by) in zip(vertices, np.roll(vertices, -1, axis=0)):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return inside


def cells_of(results, step, limit: int, size: float, *fields: np.ndarray):
    """The cells of a step, parted where its cracks are, and what belongs to them.

    At most `limit` cells; lengths in units of `size` metres. Gives the cells, the centres, displacements,
    whether each floats, whether each moves with its point alone, and the fields. Where the folder does not
    list broken bonds, or cells stand for many points, damage tells what is loose.
    """
    edges, reference, displacement, damage, floating, *fields = merged(
        results.reference, results.edges, limit, step.displacement, step.damage, step.floating.astype(float), *fields
    )
    floating = floating > 0.5
    cells = Cells(reference / size, edges / size)
    is_whole = len(reference) == len(results.reference) and results.tells_broken_bonds
    broken = results.broken_bonds().until(step.number) if is_whole else None
    separate(cells, reference, results.cracks, broken.inner() if is_whole else None, results.reach)
    if is_whole and results.image_kinds and cells.is_lattice:
        separate_from_images(results, cells, broken)
    if is_whole:
        _separate_pieces(cells, np.rint(step.fragment))
    loose = damage > (LOST_DAMAGE if is_whole else LOOSE_DAMAGE)
    if floating.any() and not is_whole:
        loose |= at_the_rim(cells, floating)
    return cells, reference / size, displacement / size, floating, loose, *fields


def _separate_pieces(cells, piece: np.ndarray) -> None:
    """Parts cells of different pieces: between these there is no bond at all."""
    for axis in range(cells.dimension):
        other = cells.neighbours(axis, 1)
        cells.part(axis, np.flatnonzero((other >= 0) & (piece != piece[other])))
