"""Pictures of damage and cracks in two-dimensional bodies."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize

from .cells import merged
from .framing import framed
from .images import ImageKinds
from .panels import step_panels
from .plane import MOST_CELLS, SEAM, crack_lines, deformed_plate, draw_plane, rims
from .ranges import DAMAGE_COLOURS, Shades, exaggeration, exaggeration_words
from .state_words import bond_words, progress
from .step_colours import STEP_COLOURS, ranks_of_steps, step_bar
from .style import GHOST, INK, PIECE, heading, points
from .units import LENGTHS, number, unit_for

OPENING = 0.05  # largest displacement over the body's size: cracks open visibly and the body keeps its shape
MOST_BONDS = 150_000  # more broken bonds are thinned out
POINT_COLOUR = "#d8dde2"


def draw_damaged_plane(results, step):
    """Deformed plate coloured by damage, floating pieces outlined."""
    factor = exaggeration(results.reference, step, OPENING)
    colours = Shades(step.damage, "damage", 0.0, 1.0, DAMAGE_COLOURS)
    return draw_plane(results, step, factor, colours, bond_words(results, step))


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
                           edgecolors="face", linewidths=points(SEAM), zorder=2), autolim=False,
        )  # fmt: skip
        everybody = np.ones(len(plate.still), dtype=bool)
        outline = rims(plate.cells, plate.still, everybody)
        axes.add_collection(LineCollection(outline, colors=GHOST, linewidths=points(1.0), zorder=1), autolim=False)
        axes.add_collection(crack_lines(plate.cells, plate.moved), autolim=False)
    return figure


def draw_broken_bonds(results, broken):
    """Broken bonds as lines between their points in the reference configuration: the cracks' paths.

    Bonds across a plane of symmetry or a period end at the image.
    """
    steps, kinds = broken.steps, results.image_kinds
    ends = broken.ends(results.reference, kinds or ImageKinds.none(2))
    unit, size = unit_for(np.ptp(results.reference, axis=0).max(), LENGTHS)
    spacing, centres = merged(results.reference, results.spacing, MOST_CELLS)
    shown = np.concatenate([centres, ends[:, 1]])
    low, high = shown.min(axis=0) - spacing, shown.max(axis=0) + spacing
    distinct, rank, norm = ranks_of_steps(steps)
    every = -(-len(steps) // MOST_BONDS)
    words = ["broken bonds in the reference configuration", f"{number(len(steps))} bond{'s' * (len(steps) != 1)}",
             *_when(results, distinct)]  # fmt: skip
    if every > 1:
        words.append(f"one line in {every} drawn")
    bar = "step at which it broke" if len(distinct) > 1 else None  # a single colour needs no bar
    figure, axes, bar_place = framed(low / size, high / size, words, bar, 0.35 * bool(results.cracks or results.sides), 1.5)
    scale = (axes.get_position().width * figure.get_size_inches()[0]) / (high - low)[0]  # inches per metre
    dot = np.clip(0.45 * scale * spacing * 72.0, points(0.6), points(9.0))
    axes.scatter(*centres.T / size, s=dot**2, color=POINT_COLOUR, linewidths=0, zorder=1)
    if kinds:
        images = kinds.all_places(centres, low, high)
        axes.scatter(*images.T / size, s=dot**2, facecolors="none", edgecolors=POINT_COLOUR, linewidths=points(0.6), zorder=1)
    for place, (axis, at) in enumerate(results.sides):
        draw = axes.axvline if axis == 0 else axes.axhline
        draw(at / size, color=PIECE, linewidth=points(1.0), linestyle=(0, (9, 3, 2, 3)), zorder=1.5,
             label="plane of symmetry, or side of the cell" if place == 0 else None)  # fmt: skip
    if results.cracks:
        axes.add_collection(LineCollection([crack / size for crack in results.cracks], colors=INK, linewidths=points(2.0),
                                           zorder=3, label="pre-crack"), autolim=False)  # fmt: skip
    if results.cracks or results.sides:
        figure.legend(*axes.get_legend_handles_labels(), loc="lower left", borderaxespad=0.4, ncols=2)
    width = np.clip(0.10 * scale * results.spacing * 72.0, points(0.35), points(1.6))
    lines = LineCollection(ends[::every] / size, array=rank[::every].astype(float), norm=norm, cmap=STEP_COLOURS,
                           linewidths=width, capstyle="round", zorder=2)  # fmt: skip
    axes.add_collection(lines, autolim=False)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    if bar:
        step_bar(figure, bar_place, results, distinct, norm)
    heading(figure, results, words)
    return figure


def _when(results, distinct) -> list[str]:
    """When bonds broke: from the first to the last step."""
    told = []
    for step in (int(distinct[0]), int(distinct[-1])):
        load = results.in_history(step, "load_factor")
        if load is None:
            return []
        told.append(progress(results, step, load))
    (what, first, unit), (_, last, _) = told
    words = [f"{what} {first}{f' to {last}' if last != first else ''} {unit}".strip()]
    return words + [f"all in step {int(distinct[0])}"] * (len(distinct) == 1)
