"""Cells at the rim of a plane body, fitted to its outline, so that round or slanted sides have no stairs."""

from itertools import product

import numpy as np

from .cells import corner_signs
from .outline import Outline
from .voronoi import Polygons

FARTHEST = 0.75  # largest distance of a cloud cell's corner inside the outline, over the mean cell size


def rim_offsets(cells, centres: np.ndarray, outline: Outline, fixed: np.ndarray) -> np.ndarray:
    """Offsets of corners (cells.Cells), with those at the rim moved onto the outline.

    A corner is at the rim if a place around it is empty and outside the body; a place that an image beyond a plane
    of symmetry takes is not empty. Corners of fixed cells, such as those of layers outside the body, stay.
    """
    signs = corner_signs(2)
    at_rim, stays = np.zeros((2, len(centres), 4), dtype=bool)
    for corner, sign in enumerate(signs.astype(int)):
        for share in product((0, 1), repeat=2):
            away = sign * share
            other = cells.cells_at(away)
            empty = np.flatnonzero(other < 0)
            at_rim[empty, corner] |= ~outline.holds(centres[empty] + away @ cells.edges)
            stays[:, corner] |= (other >= 0) & fixed[other]
    offsets = np.tile(0.5 * signs, (len(centres), 1, 1))
    moved = at_rim & ~stays
    places = (centres[:, None] + offsets @ cells.edges)[moved]
    diagonal = np.linalg.norm(signs @ cells.edges, axis=1).max()  # reach of a partly filled cell
    there = outline.with_corners(outline.nearest(places, diagonal), diagonal)
    offsets[moved] += (there - places) @ np.linalg.inv(cells.edges)
    return offsets


def fitted(polygons: Polygons, outline: Outline, sizes: np.ndarray) -> Polygons:
    """A cloud's cells; corners at the cloud's end move onto the outline if they are near it or outside the body."""
    outer = polygons.beyond == -1
    ends = outer | polygons.before(outer)
    inner = np.where(polygons.beyond < 0, np.arange(len(outer))[:, None], polygons.beyond)
    near_end = outer.any(axis=1)[inner].any(axis=1)
    outside = np.zeros_like(outer)
    outside[near_end] = ~outline.holds(polygons.corners[near_end].reshape(-1, 2)).reshape(-1, outer.shape[1])
    moved = (ends | outside) & polygons.is_side
    size = FARTHEST * sizes.mean()
    places = outline.nearest(_met(polygons)[moved], np.where(outside[moved], np.inf, size))
    corners = polygons.corners.copy()
    corners[moved] = outline.with_corners(places, size)
    return Polygons(np.where(polygons.is_side[:, :, None], corners, corners[:, :1]), polygons.beyond)


def _met(polygons: Polygons) -> np.ndarray:
    """Corners, with the two copies of each end of a side shared by two cells at the rim replaced by their mean."""
    own, after = np.arange(len(polygons.beyond))[:, None], polygons.beyond
    before = polygons.before(after)
    ends_side, begins_side = (before >= 0) & (after == -1), (before == -1) & (after >= 0) & (after != own)
    other = np.where(ends_side, before, after)
    pair = np.minimum(own, other) * len(own) + np.maximum(own, other)
    shared = ends_side | begins_side
    _, knot, number = np.unique((2 * pair + (ends_side == (own < other)))[shared], return_inverse=True, return_counts=True)
    corners = polygons.corners.copy()
    sums = np.stack([np.bincount(knot, column) for column in corners[shared].T], axis=1)
    corners[shared] = (sums / number[:, None])[knot]
    return corners
