"""Pictures of damage and cracks in two-dimensional bodies."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize

from cells import merged
from field_pictures import (
    DAMAGE_COLOURS, MOST_CELLS, SEAM,
    crack_lines, deformed_plate, draw_plane, exaggeration, exaggeration_words, framed, mark_pieces, rims,
)  # fmt: skip
from images import ImageKinds
from style import (
    GHOST, INK, LENGTHS, PIECE, bond_words, colour_bar, heading, new_figure, number, step_words, time_unit, unit_for,
)  # fmt: skip

OPENING = 0.05  # largest displacement over the body's size: a crack is seen to open, the body keeps its shape
MOST_BONDS = 150_000  # more broken bonds are thinned out
MOST_TICKS = 8
POINT_COLOUR = "#d8dde2"
STEP_COLOURS = LinearSegmentedColormap.from_list(  # as dark at the end as to be seen on the points
    "steps", ["#20104f", "#6a1b83", "#b5305f", "#e0602c", "#eda31b"]
)


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
    aspect = (high - low)[1] / (high - low)[0]
    columns = _columns(len(steps), aspect)
    rows = -(-len(steps) // columns)
    panel_width = 14.6 / columns
    panel_height = max(min(panel_width * aspect, 7.5), 0.8)
    width, height = 16.0, 1.5 + rows * (panel_height + 0.45)
    figure = new_figure(width, height)
    for place, (step, plate) in enumerate(zip(steps, plates)):
        x = 0.3 + (place % columns) * panel_width
        y = height - 1.15 - (place // columns + 1) * (panel_height + 0.45)
        axes = figure.add_axes([x / width, y / height, 0.96 * panel_width / width, panel_height / height])
        axes.add_collection(
            PolyCollection(plate.moved, array=plate.values, cmap=DAMAGE_COLOURS, norm=Normalize(0, 1),
                           edgecolors="face", linewidths=SEAM, zorder=2), autolim=False,
        )  # fmt: skip
        everybody = np.ones(len(plate.still), dtype=bool)
        outline = rims(plate.cells, plate.still, everybody) if plate.cells.is_lattice else []
        axes.add_collection(LineCollection(outline, colors=GHOST, linewidths=1.0, zorder=1), autolim=False)
        axes.add_collection(crack_lines(plate.cells, plate.moved), autolim=False)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.axis("off")
        axes.set_title(", ".join(step_words(step)), fontsize=13, loc="left")
    mappable = ScalarMappable(Normalize(0, 1), DAMAGE_COLOURS)
    colour_bar(figure, [15.0 / width, 0.3 / height, 0.2 / width, (height - 1.9) / height], mappable, "damage")
    heading(figure, results, ["damage as it grows", exaggeration_words(factor), "outline: undeformed body"])
    return figure


def _columns(count: int, aspect: float) -> int:
    """Of panels: as few as the height of a page allows, of which at most a third of the last row is empty."""
    fits = lambda columns: -(-count // columns) * (14.6 / columns * aspect + 0.45) <= 11.0
    return next((columns for columns in range(1, count) if fits(columns) and -count % columns <= columns / 3), count)


def draw_broken_bonds(results, broken):
    """Bonds that broke as lines between their points in the reference configuration: the cracks' paths.

    Those across a plane of symmetry or a period go to where the image stands.
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
    # A colour per step in which bonds broke: steps in between would only take colours away.
    distinct, rank = np.unique(steps, return_inverse=True)
    lines = LineCollection(ends[::every] / size, array=rank[::every].astype(float),
                           norm=Normalize(-0.5, len(distinct) - 0.5), cmap=STEP_COLOURS, linewidths=width,
                           capstyle="round", zorder=2)  # fmt: skip
    axes.add_collection(lines, autolim=False)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    marked = np.unique(np.linspace(0, len(distinct) - 1, min(MOST_TICKS, len(distinct))).round().astype(int))
    what = "time [s]" if results.is_of_motion else "load factor"
    if len(distinct) > 1:  # one colour needs no bar
        bar = colour_bar(figure, bar_place, lines, f"step: {what} at which it broke", ticks=marked)
        bar.set_ticks(marked, labels=[_step_label(results, int(distinct[place])) for place in marked])
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


def _step_label(results, step: int) -> str:
    load = results.in_history(step, "load_factor")
    return f"{step}" if load is None else f"{step}: {number(load, 3)}"
