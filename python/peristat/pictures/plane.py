"""A deformed plate, coloured by a value per point."""

from dataclasses import dataclass

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from .cells import Cells
from .cloud_cells import CloudCells
from .framing import framed
from .ranges import Shades, beyond, exaggeration_words
from .separations import cells_of
from .state_words import piece_words, step_words
from .style import GHOST, INK, PIECE, colour_bar, heading, piece_legend, points
from .units import LENGTHS, number, unit_for

MOST_CELLS = 60_000  # drawn in one panel; more points are averaged over blocks
FLIGHT = 0.25  # distance, as a share of the body's size, that floating pieces may lie outside it in a picture
SEAM = 0.75  # width of a cell's own edge [point]; it covers the hairline between neighbours


@dataclass
class Plate:
    """The cells of a deformed plate; fewer than the points if these are too many to draw."""

    cells: Cells | CloudCells
    still: np.ndarray  # corners in the reference configuration: count x most x 2
    moved: np.ndarray  # corners after the deformation
    floating: np.ndarray  # whether the cell belongs to a detached piece
    values: np.ndarray  # values that colour the cells

    def frame(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of a box around the plate in both configurations; pieces that flew far stay outside."""
        low, high = self.still.min(axis=(0, 1)), self.still.max(axis=(0, 1))
        air = FLIGHT * (high - low).max()
        shown = self.moved
        if self.floating.any():
            near = ((self.moved > low - air) & (self.moved < high + air)).all(axis=(1, 2))
            shown = self.moved[~self.floating | near]
        both = np.concatenate([self.still, shown])
        return both.min(axis=(0, 1)), both.max(axis=(0, 1))


def deformed_plate(results, step, factor: float, values: np.ndarray, size: float = 1.0,
                   limit: int = MOST_CELLS) -> Plate:  # fmt: skip
    """Cells with displacements times a factor; lengths are in units of `size` metres."""
    cells, reference, displacement, floating, loose, values = cells_of(results, step, limit, size, values)
    still = cells.outlines(reference, np.zeros_like(reference), loose)
    moved = cells.outlines(reference, factor * displacement, loose) if factor else still
    return Plate(cells, still, moved, floating, values)


def draw_plane(results, step, factor: float, shades: Shades, words=(), window=None):
    """Deformed plate coloured by a value per point, with extra words in the heading.

    window  low and high corner of what is shown, in the drawn configuration [m]; None: everything
    """
    unit, size = unit_for(np.ptp(window if window is not None else results.reference, axis=0).max(), LENGTHS)
    plate = deformed_plate(results, step, factor, shades.values, size)
    if window is None:
        low, high = plate.frame()
        margin = 0.03 * (high - low).max()
        low, high = low - margin, high + margin
    else:
        low, high = np.asarray(window) / size
    words = [exaggeration_words(factor), *step_words(results, step), *shades.words, *words,
             f"{number(len(results.volume))} points"]  # fmt: skip
    figure, axes, bar_place = framed(low, high, words, shades.label, 0.35 * bool(plate.floating.any()))
    if factor:
        _draw_outline(axes, plate)
    collection = PolyCollection(plate.moved, array=plate.values, cmap=shades.colours, norm=shades.norm,
                                edgecolors="face", linewidths=points(SEAM), zorder=2)  # fmt: skip
    axes.add_collection(collection, autolim=False)
    axes.add_collection(crack_lines(plate.cells, plate.moved), autolim=False)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    inside = ((plate.moved > low) & (plate.moved < high)).all(axis=2).any(axis=1)
    seen = plate.values[inside] if inside.any() else plate.values
    colour_bar(figure, bar_place, collection, shades.label, extend=beyond(seen, shades.low, shades.high))
    mark_pieces(figure, axes, step, plate)
    heading(figure, results, words)
    return figure


def _draw_outline(axes, plate: Plate) -> None:
    """Outline of the reference configuration, filled faintly so that the motion is visible."""
    everybody = np.ones(len(plate.still), dtype=bool)
    axes.add_collection(
        LineCollection(rims(plate.cells, plate.still, everybody), colors=GHOST, linewidths=points(1.4), zorder=3,
                       capstyle="projecting"), autolim=False,
    )  # fmt: skip
    axes.add_collection(PolyCollection(plate.still, facecolors="#f1f3f5", edgecolors="#f1f3f5",
                                       linewidths=points(SEAM), zorder=0), autolim=False)  # fmt: skip


def rims(cells: Cells | CloudCells, corners: np.ndarray, members: np.ndarray) -> np.ndarray:
    """Sides between member cells and the rest or the outside: count x 2 ends x 2."""
    outer = lambda other: members & ((other < 0) | ~members[other])
    return np.concatenate([corners[outer(other)][:, ends] for ends, other, _ in cells.sides()])


def crack_lines(cells: Cells | CloudCells, corners: np.ndarray, colour: str = INK) -> LineCollection:
    """Both faces of every crack: sides between cells that have been parted."""
    edges = [corners[parted][:, ends] for ends, _, parted in cells.sides()]
    return LineCollection(np.concatenate(edges), colors=colour, linewidths=points(0.9), capstyle="projecting", zorder=3)


def mark_pieces(figure, axes, step, plate: Plate) -> None:
    """Hatches and outlines detached pieces, and prints their number."""
    if not plate.floating.any():
        return
    axes.add_collection(
        PolyCollection(plate.moved[plate.floating], facecolors="none", edgecolors=PIECE, hatch="////",
                       linewidths=0.0, zorder=4), autolim=False,
    )  # fmt: skip
    axes.add_collection(
        LineCollection(rims(plate.cells, plate.moved, plate.floating), colors=PIECE, linewidths=points(1.6),
                       capstyle="projecting", zorder=5), autolim=False,
    )  # fmt: skip
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    outside = ((plate.moved < low) | (plate.moved > high)).any()
    piece_legend(figure, piece_words(step) + ", in part outside the picture" * bool(outside))
