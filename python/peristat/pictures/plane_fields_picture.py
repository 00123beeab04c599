"""Picture of the fields of a plate on its reference configuration: displacement components and energy density."""

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from .framing import few_ticks
from .plane import MOST_CELLS, SEAM, crack_lines, rims
from .ranges import Shades, beyond, held_values, shades, span
from .separations import cells_of
from .state_words import piece_words, step_words
from .style import (
    FAINT, INK, PIECE, colour_bar, heading, is_narrow, new_figure, page_height, page_width, piece_legend, points, room_above,
    size_of, text_width,
)  # fmt: skip
from .units import ENERGY_DENSITIES, LENGTHS, unit_for


def _panels(displacement, energy, floating) -> list[tuple[str, Shades]]:
    """Title and colours of each component of the displacement, and of the energy density; 0 for components that are
    round-off."""
    largest = np.abs(held_values(displacement, floating)).max()
    found = []
    for axis, values in zip("xy", displacement.T):
        if np.abs(held_values(values, floating)).max() < 1e-9 * largest:
            values = np.zeros_like(values)
        whole = span(held_values(values, floating))
        low, high = whole[2:]
        if low == high == 0.0:
            low, high = 0.0, largest
        found.append((f"displacement in {axis}", shades(values, (low, high, low, high), f"$u_{axis}$", LENGTHS)))
    found.append(("energy density", shades(energy, span(held_values(energy, floating)), "", ENERGY_DENSITIES, "inferno")))
    return found


def draw_plane_fields(results, step):
    """Displacement components and energy density on the reference configuration."""
    unit, size = unit_for(np.ptp(results.reference, axis=0).max(), LENGTHS)
    cells, reference, displacement, floating, loose, energy = cells_of(
        results, step, MOST_CELLS, size, step.energy_density
    )
    still = cells.outlines(reference, np.zeros_like(reference), loose)
    panels = _panels(displacement * size, energy, floating)
    low, high = still.min(axis=(0, 1)), still.max(axis=(0, 1))
    words = ["fields on the reference configuration", *step_words(results, step)]
    figure, places, columns = _small_multiples(len(panels), (high - low)[1] / (high - low)[0], words, bool(floating.any()))
    for number_of_panel, ((title, colours), (place, bar_place)) in enumerate(zip(panels, places)):
        axes = figure.add_axes(place)
        norm = colours.norm
        extend = beyond(colours.values, norm.vmin, norm.vmax)
        if cells.is_image:
            picture = axes.imshow(cells.image(colours.values), extent=(low[0], high[0], low[1], high[1]), origin="lower",
                                  interpolation="nearest", cmap=colours.colours, norm=norm)  # fmt: skip
        else:
            picture = PolyCollection(still, array=colours.values, cmap=colours.colours, norm=norm, edgecolors="face",
                                     linewidths=points(SEAM))  # fmt: skip
            axes.add_collection(picture, autolim=False)
        is_dark = colours.colours == "inferno"
        axes.add_collection(crack_lines(cells, still, FAINT if is_dark else INK), autolim=False)
        if floating.any():
            axes.add_collection(LineCollection(rims(cells, still, floating), colors=PIECE, linewidths=points(1.4), zorder=4),
                                autolim=False)  # fmt: skip
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.grid(False)
        few_ticks(axes)
        note = f", {colours.words[-1]}" if colours.words else ""
        if text_width(title + note, "small") > place[2] * size_of(figure)[0] + 0.3:
            note = note.replace(", ", "\n")
        axes.set_title(title + note, loc="left", fontsize="small")
        if number_of_panel % columns == 0:
            axes.set_ylabel(f"y [{unit}]")
        if number_of_panel + columns >= len(panels):
            axes.set_xlabel(f"x [{unit}]")
        colour_bar(figure, bar_place, picture, colours.label.strip(), extend=extend)
    if floating.any():
        piece_legend(figure, piece_words(step) + ", loose: outside the scale of colours", hatch=None)
    heading(figure, results, words)
    return figure


def _small_multiples(count: int, aspect: float, words, has_legend: bool):
    """A figure, the places of `count` panels with their colour bars, and the number of columns.

    Panels stand side by side, with the bars below, if the body is tall or the page low; else below each other, with the
    bars on the right.
    """
    page, above, foot = page_width(), room_above(words, page_width()), 0.35 * has_legend
    room = page_height() - above - foot - 0.35

    def sizes(columns: int, left: float, right: float, bottom: float, top: float):
        width = page / columns - left - right
        width = min(width, ((room / (count // columns)) - bottom - top) / aspect)
        return columns, width, width * aspect, left, right, bottom, top

    stacked, beside = sizes(1, 0.9, 1.5, 0.35, 0.5), sizes(count, 0.9, 0.25, 1.35, 0.5)
    is_stacked = is_narrow() or (aspect <= 0.8 and stacked[2] >= 0.75)
    columns, width, height, left, right, bottom, top = stacked if is_stacked else beside
    height = max(height, 0.5)
    across, up = page / columns, bottom + height + top
    tall = above + (count // columns) * up + foot + 0.35
    figure, places = new_figure(page, tall), []
    for panel in range(count):
        x = (panel % columns) * across + left + 0.5 * (across - left - right - width)
        y = tall - above - (panel // columns + 1) * up + bottom
        tall_bar = max(height, 0.95)  # three ticks
        bar = [x + width + 0.2, y + 0.5 * (height - tall_bar), 0.18, tall_bar] if is_stacked else [x, y - 0.85, width, 0.16]
        places.append(([x / page, y / tall, width / page, height / tall],
                       [bar[0] / page, bar[1] / tall, bar[2] / page, bar[3] / tall]))  # fmt: skip
    return figure, places, columns
