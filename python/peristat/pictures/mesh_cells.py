"""The elements of a plane mesh as the cells of its points."""

from typing import NamedTuple

import numpy as np

from .voronoi import Polygons

TRIANGLE, QUADRILATERAL = 5, 9  # VTK's numbers


class Elements(NamedTuple):
    """Triangles and quadrilaterals, one per point, with corners of their own."""

    corners: np.ndarray  # count x 2, anticlockwise [m]
    offset: np.ndarray  # first corner of each element, and the end


def are_sound(elements: Elements, count: int) -> bool:
    """Whether elements read from a file are cells of as many points."""
    corners, offset = elements
    return (
        corners.ndim == 2
        and bool(np.isfinite(corners).all())
        and offset.shape == (count + 1,)
        and offset[0] == 0
        and offset[-1] == len(corners)
        and bool(np.isin(np.diff(offset), (3, 4)).all())
    )


def element_cells(elements: Elements) -> Polygons:
    """The elements, with the element beyond each side."""
    nodes, corners = np.unique(elements.corners, axis=0, return_inverse=True)
    offset = elements.offset
    number = np.diff(offset)
    place = np.arange(number.max())
    is_corner = place < number[:, None]
    of = corners[offset[:-1, None] + np.where(is_corner, place, 0)]  # the first corner again at the end
    after = np.take_along_axis(of, np.where(place + 1 < number[:, None], place + 1, 0), axis=1)
    owner = np.broadcast_to(np.arange(len(of))[:, None], of.shape)
    key = np.minimum(of, after)[is_corner].astype(np.int64) * len(nodes) + np.maximum(of, after)[is_corner]
    order = np.argsort(key, kind="stable")
    is_pair = np.flatnonzero(key[order][1:] == key[order][:-1])
    one, other = order[is_pair], order[is_pair + 1]
    beyond_side = np.full(len(key), -1)
    owners = owner[is_corner]
    beyond_side[one], beyond_side[other] = owners[other], owners[one]
    beyond = owner.copy()  # its own point: no side
    beyond[is_corner] = beyond_side
    return Polygons(nodes[of], beyond)
