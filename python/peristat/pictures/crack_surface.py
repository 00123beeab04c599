"""Faces of a solid's cells through which its cracks run."""

from typing import NamedTuple

import numpy as np

from .cells import FACES
from .images import ImageKinds
from .separations import LOOSE_DAMAGE, cells_of
from .solid_pictures import MOST_CELLS


class CrackSurface(NamedTuple):
    """Crack faces of a solid in its reference configuration."""

    body: np.ndarray  # outer faces of the body, count x 4 x 3 [m]
    faces: np.ndarray  # crack faces, count x 4 x 3 [m]
    damage: np.ndarray  # of the more damaged of the two cells beside each face
    steps: np.ndarray  # in which the bond straight across each face broke; 0: cut by a pre-crack, -1: unknown

    @property
    def has_grown(self) -> bool:
        return bool((self.steps > 0).any() or (self.damage > LOOSE_DAMAGE).any())


def crack_surface(results, step) -> CrackSurface:
    """Faces between cells that have been parted (separations.py). Where the broken bonds are unknown: the outer faces
    of the cells that are as damaged as those beside a crack."""
    cells, reference, displacement, _, _, damage = cells_of(results, step, MOST_CELLS, 1.0, step.damage)
    nobody = np.zeros(len(damage), dtype=bool)
    corners = cells.corners(reference, np.zeros_like(displacement), nobody)
    tells_bonds = len(reference) == len(results.reference) and len(results.broken_bonds().steps) > 0
    lost = nobody if tells_bonds else damage > LOOSE_DAMAGE
    broke = _steps_of_faces(results, cells) if tells_bonds else {side: np.full(len(damage), -1) for side in FACES}
    body, faces, damages, steps = [], [], [], []
    for side, order in FACES.items():
        other = cells.neighbours(*side)
        body.append(corners[other < 0][:, order])
        own = cells.parted(*side) & ((other < 0) | (side[1] > 0)) | lost & ((other < 0) | ~lost[other])
        faces.append(corners[own][:, order])
        damages.append(np.maximum(damage, np.where(other < 0, 0.0, damage[other]))[own])
        steps.append(broke[side][own])
    return CrackSurface(*(np.concatenate(parts) for parts in (body, faces, damages, steps)))


def _steps_of_faces(results, cells) -> dict:
    """By axis and sign: for each point, the step in which its bond to the next point in that direction broke, 0 if
    never."""
    bonds = results.broken_bonds()
    begin, end = bonds.ends(results.reference, results.image_kinds or ImageKinds.none(3)).transpose(1, 0, 2)
    away = np.rint((end - begin) @ np.linalg.inv(cells.edges)).astype(np.int64)
    inner = bonds.image == 0
    points = np.concatenate([bonds.points[:, 0], bonds.points[inner, 1]])
    away, steps = np.concatenate([away, -away[inner]]), np.concatenate([bonds.steps, bonds.steps[inner]])
    broke = {}
    for axis, sign in FACES:
        straight = (away == sign * np.eye(3, dtype=np.int64)[axis]).all(axis=1)
        broke[axis, sign] = np.zeros(len(results.reference), dtype=np.int64)
        broke[axis, sign][points[straight]] = steps[straight]
    return broke
