"""Intersections of bonds with cracks: segments in a plane, plane polygons in space."""

import numpy as np

TOUCHING = 1e-9  # share of a length; a crack cuts a bond that it only touches


def crosses(start: np.ndarray, end: np.ndarray, crack: np.ndarray) -> np.ndarray:
    """Whether straight lines (count x dimension) meet a crack; touching with an end counts."""
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
    # Collinear segments meet if they overlap.
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
    flat = np.delete(np.arange(3), np.argmax(np.abs(normal)))  # coordinates that remain in its projection
    return passes & inside_polygon(place[:, flat], vertices[:, flat])


def inside_polygon(places, vertices) -> np.ndarray:
    """Whether positions are inside a polygon of the plane, by the number of its edges above them."""
    inside = np.zeros(len(places), dtype=bool)
    x, y = places.T
    for (ax, ay), (bx, by) in zip(vertices, np.roll(vertices, -1, axis=0)):
        if ay != by:
            inside ^= ((ay > y) != (by > y)) & (x < ax + (y - ay) / (by - ay) * (bx - ax))
    return inside
