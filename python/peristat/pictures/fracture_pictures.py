"""Pictures of damage and cracks in two-dimensional bodies."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize

from .cells import merged
from .field_pictures import (
    DAMAGE_COLOURS, MOST_CELLS, SEAM,
    crack_lines, deformed_plate, draw_plane, exaggeration, exaggeration_words, framed, mark_pieces, rims,
)  # fmt: skip
from .images import ImageKinds
from .panels import step_panels
from .step_colours import STEP_COLOURS, ranks_of_steps, step_bar
from .style import (
    GHOST, INK, LENGTHS, PIECE, bond_words, heading, number, time_unit, unit_for,
)  # fmt: skip

OPENING = 0.05  # largest displacement over the body's size: cracks open visibly and the body keeps its shape
MOST_BONDS = 150_000  # more broken bonds are thinned out
POINT_COLOUR = "#d8dde2"


def draw_damaged_plane(results, step):
    """Deformed plate coloured by damage, floating pieces outlined."""
    factor = exaggeration(results.reference, step, OPENING)
    figure, axes, plate = draw_plane(results, step, factor, step.damage, (0.0, 1.0), "damage", DAMAGE_COLOURS,
                                     bond_words(results, step))  # fmt: skip
    mark_pieces(figure, axes, step, plate)
    return figure


def draw_damage_sequence(results, steps):
    """Damage on the deformed plate in up to six steps."""
    factor = exaggeration(results.reference, steps[-1], OPENING)
    plates = [deformed_plate(results, step, factor, step.damage, limit=MOST_CELLS // 3) for step in steps]
    frames = [plate.frame() for plate in plates]
    low = np.min([low for low, _ in frames], axis=0)
    high = np.max([high for _, high in frames], axis=0)
    words = [exaggeration_words(factor), "outline: undeformed body"]
    figure, panels = step_panels(results, steps, low, high, DAMAGE_COLOURS, words)
    for axes, plate in zip(panels, plates):
        axes.add_collection(
            PolyCollection(plate.moved, array=plate.values, cmap=DAMAGE_COLOURS, norm=Normalize(0, 1),
                           edgecolors="face", linewidths=SEAM, zorder=2), autolim=False,
        )  # fmt: skip
        everybody = np.ones(len(plate.still), dtype=bool)
        outline = rims(plate.cells, plate.still, everybody)
        axes.add_collection(LineCollection(outline, colors=GHOST, linewidths=1.0, zorder=1), autolim=False)
        axes.add_collection(crack_lines(plate.cells, plate.moved), autolim=False)
    return figure


def draw_broken_bonds(results, broken):
    """Broken bonds as lines between their points in the reference configuration: the cracks' paths.

    Bonds across a plane of symmetry or a period end at the image.
    """
    steps, kinds = broken.steps, results.image_kinds
    ends = broken.ends(results.reference, kinds or ImageKinds.none(2))
    unit, size = unit_for(np.ptp(results.reference, axis=0).max(), LENGTHS)
    spacing, points = merged(results.reference, results.spacing, MOST_CELLS)
    shown = np.concatenate([points, ends[:, 1]])
    low, high = shown.min(axis=0) - spacing, shown.max(axis=0) + spacing
    figure, axes, bar_place = framed(low / size, high / size, right=2.05 if len(np.unique(steps)) > 1 else 0.5)
    inches = (axes.get_position().width * figure.get_size_inches()[0]) / (high - low)[0]
    dot = np.clip(0.45 * inches * spacing * 72.0, 0.6, 9.0)
    axes.scatter(*points.T / size, s=dot**2, color=POINT_COLOUR, linewidths=0, zorder=1)
    if kinds:
        images = kinds.all_places(points, low, high)
        axes.scatter(*images.T / size, s=dot**2, facecolors="none", edgecolors=POINT_COLOUR, linewidths=0.6, zorder=1)
    for place, (axis, at) in enumerate(results.sides):
        draw = axes.axvline if axis == 0 else axes.axhline
        draw(at / size, color=PIECE, linewidth=1.0, linestyle=(0, (9, 3, 2, 3)), zorder=1.5,
             label="plane of symmetry, or side of the cell" if place == 0 else None)  # fmt: skip
    if results.cracks:
        axes.add_collection(LineCollection([crack / size for crack in results.cracks], colors=INK, linewidths=2.0,
                                           zorder=3, label="pre-crack"), autolim=False)  # fmt: skip
    if results.cracks or results.sides:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), fontsize=12, borderaxespad=0.1, ncols=2)
    every = -(-len(steps) // MOST_BONDS)
    width = np.clip(0.10 * inches * results.spacing * 72.0, 0.35, 1.6)
    distinct, rank, norm = ranks_of_steps(steps)
    lines = LineCollection(ends[::every] / size, array=rank[::every].astype(float), norm=norm, cmap=STEP_COLOURS,
                           linewidths=width, capstyle="round", zorder=2)  # fmt: skip
    axes.add_collection(lines, autolim=False)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    if len(distinct) > 1:  # a single colour needs no bar
        step_bar(figure, bar_place, results, distinct, norm)
    first, last = (results.in_history(int(step), "load_factor") for step in (steps[0], steps[-1]))
    words = ["broken bonds in the reference configuration", f"{number(len(steps))} bond{'s' * (len(steps) != 1)}"]
    if first is not None and last is not None:
        several = first != last
        if results.is_of_motion:
            unit, size = time_unit(last)
            first, last = first / size, last / size
        end = f" to {number(last)}" * several + (f" {unit}" if results.is_of_motion else "")
        words.append(("time" if results.is_of_motion else "load factor") + f" {number(first)}{end}")
    if len(distinct) == 1:
        words.append(f"all in step {int(distinct[0])}")
    if every > 1:
        words.append(f"one line in {every} drawn")
    heading(figure, results, words)
    return figure
