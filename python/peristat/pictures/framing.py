"""Places of a body and its colour bar on the page, in true proportion."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from .style import new_figure, page_height, page_width, present_style, room_above, size_of, text_width

LEAST = 0.6  # height and width of a body [inch of the code]


def placed(low, high, words, bar: str | None, left: float, bottom: float, room: float = 1.1, foot: float = 0.0):
    """A figure for a box: figure, rectangle of the box, rectangle of the colour bar (fractions), inches per unit.

    The bar stands on the right, or lies below where it would take too much of the width or is too short for its label.

    words         of the heading
    bar           label of the colour bar; None: there is none
    left, bottom  margins for labels [inch of the code]
    room          width of the ticks' labels of an upright bar
    foot          height below everything for a legend
    """
    bottom += foot
    size = np.maximum(high - low, 1e-300)
    page, most, above = page_width(), page_height(), room_above(words, page_width())
    upright = _fit(size, page - left - (0.3 if bar is None else 0.75 + room), most - bottom - above)
    lying = _fit(size, page - left - 0.4, most - bottom - above - 0.95)
    is_upright = bar is None or (lying < 1.15 * upright and text_width(bar) < upright * size[1] + bottom)
    scale = upright if is_upright else lying
    width, height = np.maximum(scale * size, LEAST)
    right = 0.3 if bar is None else 0.75 + room if is_upright else 0.4
    total = page
    if present_style().may_be_narrower:
        total = min(page, max(left + width + right, 7.0, text_width(bar or "") + 1.0))
    under = bottom + (0.0 if is_upright else 0.95)
    tall = under + height + above
    x = left + 0.5 * (total - left - width - right)
    figure = new_figure(total, tall)
    box = [x / total, under / tall, width / total, height / tall]
    if is_upright:
        place = [(x + width + 0.25) / total, (under + 0.02 * height) / tall, 0.2 / total, 0.96 * height / tall]
    else:
        place = [max(x, 0.5) / total, (0.65 + foot) / tall, min(width, total - 1.0) / total, 0.18 / tall]
    return figure, box, place, scale


def _fit(size, width: float, height: float) -> float:
    return float(min(width / size[0], height / size[1]))


def framed(low, high, words, bar: str | None, foot: float = 0.0, room: float = 1.1):
    """A figure with axes that show a box in true proportion: figure, axes, place of the colour bar.

    foot  height below for a legend [inch of the code]
    """
    figure, box, place, _ = placed(low, high, words, bar, 0.95, 0.7, room, foot)
    axes = figure.add_axes(box)
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.grid(False)
    few_ticks(axes)
    return figure, axes, place


def few_ticks(axes) -> None:
    """As many ticks as their labels have room for, in axes of true proportion."""
    width, height = axes.get_position().size * size_of(axes.figure)
    along, up = np.ptp(axes.get_xlim()), np.ptp(axes.get_ylim())
    width, height = min(width, height * along / up), min(height, width * up / along)
    for axis, limits, room in ((axes.xaxis, axes.get_xlim(), width / 0.75), (axes.yaxis, axes.get_ylim(), height / 0.4)):
        axis.set_major_locator(MaxNLocator(nbins=int(np.clip(room, 1, 9)), steps=[1, 2, 2.5, 5, 10]))
        inside = [tick for tick in axis.get_majorticklocs() if limits[0] <= tick <= limits[1]]
        if room < 2.0:  # the locator has at least two
            axis.set_ticks(inside[len(inside) // 2 :][:1])
