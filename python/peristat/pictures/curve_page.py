"""Page of curves: panels side by side, or below each other on a narrow page; the legend below, the heading above.

The panels are placed last, when all labels are known, so that none is cut off.
"""

import textwrap
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from .style import GHOST, heading, is_narrow, new_figure, page_height, page_width, room_above, size_of, text_width

PANEL = 4.6  # height of a panel with its labels [inch of the code]
MOST_COLUMNS = 4  # of a legend


def curve_page(count: int = 1, heights: float = PANEL, is_stacked: bool = False, wide: dict | None = None, **options):
    """A figure with `count` panels; finish it with `settle`.

    heights     of a row of panels
    is_stacked  whether the panels are below each other on a wide page, too
    wide        options of matplotlib's `subplots` for panels side by side
    options     for every arrangement
    """
    rows = count if is_stacked or is_narrow() else 1
    heights = min(heights, (page_height() - 1.0) / rows)
    figure = new_figure(page_width(), rows * heights)
    options |= wide or {} if rows < count else {}
    panels = figure.subplots(rows, count // rows, squeeze=False, **options)
    return figure, list(panels.flat)


def draw_zeros(axes) -> None:
    """Lines at zero of both axes."""
    for draw in (axes.axhline, axes.axvline):
        draw(0.0, color=GHOST, linewidth=axes.spines["left"].get_linewidth() * 1.3, zorder=1)


def settle(figure: Figure, results, words: list[str], handles=(), labels=()) -> None:
    """Adds heading and legend, and places the panels into the room between them."""
    width, height = size_of(figure)
    foot, above = legend_below(figure, handles, labels) if handles else 0.0, room_above(words, width)
    figure.set_size_inches(*(figure.get_size_inches() * [1.0, (height + foot + above) / height]))
    height += foot + above
    if handles:
        figure.legends[-1].set_bbox_to_anchor((0.5, 0.08 / height), transform=figure.transFigure)
    heading(figure, results, words)
    place = partial(figure.tight_layout, rect=(0.0, foot / height, 1.0, 1.0 - above / height), pad=0.6, w_pad=2.0, h_pad=1.5)
    place()
    for axes in figure.axes:
        wrap_labels(axes)
    place()  # with the ticks and labels that the first placing has given


def wrap_labels(axes) -> None:
    """Breaks labels into lines that are no longer than their axes."""
    width, height = axes.get_position().size * size_of(axes.figure)
    for label, room in ((axes.xaxis.label, width), (axes.yaxis.label, height)):
        text = label.get_text()
        if "$10^{" not in text:  # a name may have the mark of formulas
            text = text.replace(r"\$", "$").replace("$", r"\$")
            label.set_text(text)
        share = text_width(text.replace("\n", " ")) / max(room, 0.5)
        if share > 1.0 and "\n" not in text:
            label.set_text("\n".join(textwrap.wrap(text, max(int(len(text) / np.ceil(share)) + 4, 10))))


def legend_below(figure: Figure, handles, labels) -> float:
    """Draws the legend in as few rows as fit the page; returns its height."""
    room = page_width() - 0.3
    letters = max(int(0.8 * (room - 0.6) / text_width("n", "small")), 10)
    labels = ["\n".join(textwrap.wrap(label, letters)).replace("$", r"\$") for label in labels]
    renderer = figure.canvas.get_renderer()
    for columns in range(min(len(labels), MOST_COLUMNS), 0, -1):
        legend = figure.legend(handles, labels, loc="lower center", ncols=columns, borderaxespad=0.0)
        extent = legend.get_window_extent(renderer).transformed(figure.dpi_scale_trans.inverted())
        scale = figure.get_size_inches()[0] / size_of(figure)[0]
        if columns == 1 or extent.width / scale <= room:
            return extent.height / scale + 0.12
        legend.remove()
    return 0.0
