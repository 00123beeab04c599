"""Voronoi cells of the points of a plane cloud, bounded at the cloud's rim."""

from typing import NamedTuple

import numpy as np

WIDEST = 0.95  # radius over cell size of the largest gap that is filled; one missing point leaves more


class Polygons(NamedTuple):
    """A convex polygon per point; those with fewer corners repeat their first one at the end."""

    corners: np.ndarray  # count x most x 2
    beyond: np.ndarray  # count x most: point beyond the side that begins at a corner; -1: none, own point: no side

    def scaled(self, factor: float) -> "Polygons":
        return Polygons(factor * self.corners, self.beyond)

    def widened(self, most: int) -> "Polygons":
        """The same polygons with room for the given number of corners."""
        count, new = len(self.beyond), most - self.beyond.shape[1]
        corners = np.concatenate([self.corners, np.repeat(self.corners[:, :1], new, axis=1)], axis=1)
        own = np.repeat(np.arange(count)[:, None], new, axis=1)
        return Polygons(corners, np.concatenate([self.beyond, own], axis=1))

    @property
    def is_side(self) -> np.ndarray:
        """Which sides have a length, count x most."""
        return self.beyond != np.arange(len(self.beyond))[:, None]

    def before(self, values: np.ndarray) -> np.ndarray:
        """For each corner, the value (count x most) of the side that ends there."""
        last = self.is_side.sum(axis=1) - 1
        return np.concatenate([values[np.arange(len(values)), last][:, None], values[:, :-1]], axis=1)


def voronoi_cells(points: np.ndarray, sizes: np.ndarray) -> Polygons:
    """Cells of points (count x 2), each of which fills about a square of its size.

    A cell is its square cut by the bisectors between the point and its neighbours. At the cloud's rim it is cut half
    a size beyond the outermost points, parallel to the line through these.
    """
    triangles, is_filled = _triangles(points, sizes)
    owner, normal, height, label = _cuts(points, sizes, triangles, triangles[is_filled])
    is_alone = np.bincount(triangles[is_filled].ravel(), minlength=len(points)) == 0
    reach = np.where(is_alone, 0.5, WIDEST) * sizes
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    cells = Polygons(reach[:, None, None] * square, np.full((len(points), 4), -1))  # corners relative to points

    near = height < np.sqrt(2.0) * reach[owner]
    order = np.flatnonzero(near)[np.lexsort((height[near], owner[near]))]
    turn = np.arange(len(order)) - np.searchsorted(owner[order], owner[order])
    for number in range(turn.max(initial=-1) + 1):
        now = order[turn == number]
        cells = _cut(cells, owner[now], normal[now], height[now], label[now])
    return Polygons(points[:, None, :] + cells.corners, cells.beyond)


def _cuts(points, sizes, triangles, filled):
    """Lines that bound cells: the cell's point, the normal away from it, the distance, and the point beyond (-1:
    none)."""
    count = len(points)
    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    begin, end = np.divmod(np.unique(sides @ [count, 1]), count)
    apart = points[end] - points[begin]
    distance = np.linalg.norm(apart, axis=1)
    normal = apart / distance[:, None]

    filled = filled[:, [0, 1, 2, 1, 2, 0, 2, 0, 1]].reshape(-1, 3)  # a side, anticlockwise, and the opposite corner
    outer = filled[~np.isin(filled[:, 0] * count + filled[:, 1], filled[:, 1] * count + filled[:, 0])]
    along = points[outer[:, 1]] - points[outer[:, 0]]
    outwards = np.stack([along[:, 1], -along[:, 0]], axis=1) / np.linalg.norm(along, axis=1)[:, None]
    depth = ((points[outer[:, :1]] - points[outer]) * outwards[:, None]).sum(axis=2)
    owner = np.concatenate([begin, end, *outer.T])
    return (
        owner,
        np.concatenate([normal, -normal, outwards, outwards, outwards]),
        np.concatenate([distance / 2, distance / 2, *(sizes[outer.T] / 2 + depth.T)]),
        np.concatenate([end, begin, np.full(outer.size, -1)]),
    )


def _triangles(points, sizes):
    """Delaunay triangles (anticlockwise), and whether the cloud fills each; none for collinear points."""
    try:
        from matplotlib.tri import Triangulation

        triangles = Triangulation(*(points - points.mean(axis=0)).T).triangles.astype(np.int64)
    except (RuntimeError, ValueError):
        return np.zeros((0, 3), dtype=np.int64), np.zeros(0, dtype=bool)
    a, b, c = points[triangles].transpose(1, 0, 2)
    area = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    lengths = np.prod([np.linalg.norm(end - begin, axis=1) for begin, end in ((a, b), (b, c), (c, a))], axis=0)
    return triangles, lengths <= 4.0 * area * WIDEST * sizes[triangles].mean(axis=1)


def _cut(cells: Polygons, rows, normal, height, label) -> Polygons:
    """Cuts off the parts of some cells (rows) beyond one line each."""
    corners, beyond = cells.corners[rows], cells.beyond[rows]
    above = np.einsum("nkc,nc->nk", corners, normal) - height[:, None]
    after, above_after = np.roll(corners, -1, axis=1), np.roll(above, -1, axis=1)
    is_side, stays = beyond != rows[:, None], above <= 0.0
    crosses = is_side & (stays != (above_after <= 0.0))
    share = above / np.where(crosses, above - above_after, 1.0)
    met = corners + share[:, :, None] * (after - corners)

    # Two entries per corner: the corner itself if it stays, and the crossing of its side with the line.
    keep = np.stack([is_side & stays, crosses], axis=2).reshape(len(rows), -1)
    place = np.stack([corners, met], axis=2).reshape(len(rows), -1, 2)
    own = np.stack([beyond, np.where(stays, label[:, None], beyond)], axis=2).reshape(len(rows), -1)
    width = keep.sum(axis=1)
    most = max(width.max(), cells.beyond.shape[1])
    order = np.argsort(~keep, axis=1, kind="stable")[:, :most]
    is_used = np.arange(order.shape[1]) < width[:, None]
    order = np.where(is_used, order, order[:, :1])
    row = np.arange(len(rows))[:, None]
    cells = cells.widened(most)
    cells.corners[rows], cells.beyond[rows] = place[row, order], np.where(is_used, own[row, order], rows[:, None])
    return cells
