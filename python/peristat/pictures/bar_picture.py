"""Picture of a bar: a value over x, and the bar before and after the deformation."""

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize

from .curve_page import curve_page, settle
from .ranges import Shades, exaggeration_words
from .separations import cells_of
from .state_words import step_words
from .style import GHOST, LINES, points
from .units import LENGTHS, number, unit_for


def draw_bar(results, step, factor: float, shades: Shades, window=None):
    """Values over x above, and the bar in both configurations below, coloured by their magnitude.

    window  ends of what is shown [m]
    """
    order = np.argsort(results.reference[:, 0])
    x, u, values = results.reference[order, 0], step.displacement[order, 0], shades.values[order]
    cells, *_, loose = cells_of(results, step, len(x), 1.0)
    unit, size = unit_for(np.ptp(x if window is None else window), LENGTHS)
    half = 0.5 * results.spacing
    figure, (curve, bars) = curve_page(2, 2.4, is_stacked=True, sharex=True, gridspec_kw={"height_ratios": [1.6, 1.0]})
    curve.axhline(0.0, color=GHOST, linewidth=points(1.4), zorder=1)
    curve.plot(x / size, values, color=LINES[0], linewidth=points(1.6), zorder=2)
    if len(x) <= 400:
        curve.plot(x / size, values, "o", color=LINES[0], markersize=points(np.clip(500 / len(x), 3, 7)),
                   markeredgecolor="white", markeredgewidth=points(0.6), zorder=3)  # fmt: skip
    curve.set_ylabel(shades.label)

    free = [(cells.parted(0, sign) | loose)[order] for sign in (-1, 1)]
    left, right = _edges(x, u, factor, half, *free)
    magnitude = np.abs(values)
    norm = Normalize(0.0, magnitude.max() or 1.0)
    _draw_pieces(bars, x - half, x + half, 1.0, size, facecolors="#e9ecef", edgecolors="#c3cad1")
    _draw_pieces(bars, left, right, 0.0, size, array=magnitude, cmap=shades.colours if shades.low >= 0.0 else "viridis",
                 norm=norm, edgecolors="white")  # fmt: skip
    bars.set_ylim(-0.5, 1.5)
    bars.set_yticks([1.0, 0.0], ["reference", "deformed"])
    bars.grid(False)
    bars.spines["left"].set_visible(False)
    bars.tick_params(axis="y", length=0)
    bars.set_xlabel(f"x [{unit}]")
    if window is None:
        lowest, highest = min(left.min(), x[0] - half), max(right.max(), x[-1] + half)
        margin = 0.015 * (highest - lowest)
        window = lowest - margin, highest + margin
    bars.set_xlim(window[0] / size, window[1] / size)
    settle(figure, results, [exaggeration_words(factor), *step_words(results, step), *shades.words,
                             f"{number(len(x))} points"])  # fmt: skip
    return figure


def _edges(x, u, factor, half, free_left, free_right):
    """Ends of every point's piece of the deformed bar; pieces meet unless they have been parted."""
    places = x + factor * u
    middle = 0.5 * (places[1:] + places[:-1])
    left = np.concatenate([places[:1] - half, middle])
    right = np.concatenate([middle, places[-1:] + half])
    return np.where(free_left, places - half, left), np.where(free_right, places + half, right)


def _draw_pieces(axes, left, right, height, size, **looks):
    y = np.full_like(left, height)
    corners = [(left, y - 0.32), (right, y - 0.32), (right, y + 0.32), (left, y + 0.32)]
    pieces = np.stack([np.stack([a / size, b], axis=1) for a, b in corners], axis=1)
    axes.add_collection(PolyCollection(pieces, linewidths=points(0.5) if len(left) < 400 else 0.0, **looks), autolim=False)
