"""Panels for the steps of a sequence on one page, with one colour bar."""

from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from .style import colour_bar, heading, new_figure, step_words

WIDTH = 14.6  # total of a row of panels [inch]
TITLE = 0.45  # height above a panel [inch]


def step_panels(results, steps, low, high, colours, words):
    """A figure and one axes per step; all axes show the same box in true proportion."""
    aspect = (high - low)[1] / (high - low)[0]
    columns = number_of_columns(len(steps), aspect)
    rows = -(-len(steps) // columns)
    panel_width = WIDTH / columns
    panel_height = max(min(panel_width * aspect, 7.5), 0.8)
    width, height = 16.0, 1.5 + rows * (panel_height + TITLE)
    figure, panels = new_figure(width, height), []
    for place, step in enumerate(steps):
        x = 0.3 + (place % columns) * panel_width
        y = height - 1.15 - (place // columns + 1) * (panel_height + TITLE)
        axes = figure.add_axes([x / width, y / height, 0.96 * panel_width / width, panel_height / height])
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.axis("off")
        axes.set_title(", ".join(step_words(step)), fontsize=13, loc="left")
        panels.append(axes)
    bar = [15.0 / width, 0.3 / height, 0.2 / width, (height - 1.9) / height]
    colour_bar(figure, bar, ScalarMappable(Normalize(0, 1), colours), "damage")
    heading(figure, results, ["damage as it grows", *words])
    return figure, panels


def number_of_columns(count: int, aspect: float) -> int:
    """Number of columns: as few as the height of a page allows, with at most a third of the last row empty."""
    fits = lambda columns: -(-count // columns) * (WIDTH / columns * aspect + TITLE) <= 11.0
    return next((columns for columns in range(1, count) if fits(columns) and -count % columns <= columns / 3), count)
