"""Finds neighbouring cells of a body that are parted by pre-cracks and broken bonds."""

import numpy as np

from .cells import Cells, at_the_rim, merged
from .cloud_cells import CloudCells
from .crossings import crosses
from .mesh_cells import element_cells
from .rim import fitted, rim_offsets
from .separations_from_images import separate_from_images
from .voronoi import voronoi_cells

LOOSE_DAMAGE = 0.35  # damage of a cell at a crack; it moves with its point alone if the broken bonds are unknown
LEAST_VOLUME = 0.01  # share of the mean volume; a smaller cell is drawn with this one
LOST_DAMAGE = 0.65  # damage beyond that of a crack's flank; such a cell moves with its point alone


def separate(cells, reference: np.ndarray, cracks, broken: np.ndarray | None = None, reach: int = 2) -> None:
    """Parts the cells (cells.Cells) between which no bond is left: pre-cracks have cut them, or they broke.

    Only bonds that go straight from cell to cell, over the face between them, count: from one cell to the other and,
    if the horizon reaches two spacings, from one cell to the cell behind the other. Beside a crack single bonds
    break, and the cells still stay joined.

    reference  count x dimension, centres of the cells [m]
    cracks     ends of a segment (2D), vertices of a plane polygon (3D) [m]
    broken     count x 2, points of the broken bonds; None if cells are averages over points
    reach      of the horizon in whole spacings
    """
    count = len(reference)
    pairs = np.sort(broken, axis=1) if broken is not None else np.zeros((0, 2), dtype=np.int64)
    keys = np.unique(pairs[:, 0] * count + pairs[:, 1])

    def is_gone(one, other):
        """Whether there is no bond between cells; true where there is no cell (-1)."""
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


def cells_of(results, step, limit: int, size: float, *fields: np.ndarray):
    """The cells of a step, parted at its cracks, and the data that belongs to them.

    At most `limit` cells; lengths in units of `size` metres. Returns the cells, the centres, displacements, whether
    each floats, whether each moves with its point alone, and the fields. If the folder does not list broken bonds,
    or if cells are averages over points, damage decides which cells are loose.
    """
    edges, reference, displacement, damage, floating, in_layers, *fields = merged(
        results.reference, results.edges, limit, step.displacement, step.damage, step.floating.astype(float),
        results.in_layers.astype(float), *fields
    )  # fmt: skip
    floating = floating > 0.5
    cells = Cells(reference / size, edges / size)
    is_whole = len(reference) == len(results.reference) and results.tells_broken_bonds
    broken = results.broken_bonds().until(step.number) if is_whole else None
    loose = damage > (LOST_DAMAGE if is_whole else LOOSE_DAMAGE)
    is_cloud = results.elements is not None or not cells.is_lattice
    if cells.dimension == 2 and is_cloud and len(reference) == len(results.reference):
        cells = CloudCells(_polygons(results).scaled(1.0 / size), reference / size, results.spacing / size)
        inner = broken.inner() if is_whole else np.zeros((0, 2), dtype=np.int64)
        cells.part([crack / size for crack in results.cracks], inner, np.rint(step.fragment))
        return cells, reference / size, displacement / size, floating, loose, *fields
    _separate_lattice(results, step, cells, reference, broken)
    if results.outline and cells.is_lattice:
        cells.offsets = _offsets(results, reference, edges, in_layers > 0.0)
    if floating.any() and not is_whole:
        loose |= at_the_rim(cells, floating)
    return cells, reference / size, displacement / size, floating, loose, *fields


def _separate_lattice(results, step, cells, reference, broken) -> None:
    """Parts cells of a lattice by cracks and, if these are known, by broken bonds."""
    separate(cells, reference, results.cracks, broken.inner() if broken else None, results.listed_reach)
    if broken and results.image_kinds and cells.is_lattice:
        separate_from_images(results, cells, broken)
    if broken:
        _separate_pieces(cells, np.rint(step.fragment))


def _polygons(results):
    """Cells of a cloud [m], computed once."""
    if results.elements is not None:
        return element_cells(results.elements)
    if "polygons" not in results.drawn:
        positive = np.maximum(np.nan_to_num(results.volume, posinf=0.0), 0.0)
        sizes = results.spacing * np.sqrt(np.clip(positive / (positive.mean() or 1.0), LEAST_VOLUME, 1.0 / LEAST_VOLUME))
        polygons = voronoi_cells(results.reference, sizes)
        results.drawn["polygons"] = fitted(polygons, results.outline, sizes) if results.outline else polygons
    return results.drawn["polygons"]


def _offsets(results, reference, edges, in_layers):
    """Offsets of the corners of a lattice's cells [edges], fitted to the outline once for each number of cells."""
    name = f"offsets of {len(reference)}"
    if name not in results.drawn:
        cells = Cells(reference, edges)
        results.drawn[name] = rim_offsets(cells, cells.centres(reference), results.outline, in_layers)
    return results.drawn[name]


def _separate_pieces(cells, piece: np.ndarray) -> None:
    """Parts cells of different pieces, between which there is no bond."""
    for axis in range(cells.dimension):
        other = cells.neighbours(axis, 1)
        cells.part(axis, np.flatnonzero((other >= 0) & (piece != piece[other])))
