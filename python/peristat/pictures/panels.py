"""Panels for the steps of a sequence on one page, with one colour bar."""

from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from .state_words import step_words
from .style import colour_bar, heading, is_narrow, new_figure, page_height, page_width, points, room_above, text_width

TITLE = 0.4  # height above a panel [inch of the code]
LEAST_WIDTH = 2.2  # of a panel, so that its title fits
HIGHEST = 9.0  # a page of panels


def step_panels(results, steps, low, high, colours, words):
    """A figure and one axes per step; all axes show the same box in true proportion."""
    titles = [", ".join(step_words(results, step)) for step in steps]
    aspect = (high - low)[1] / (high - low)[0]
    width, below = page_width(), 0.95 if is_narrow() else 0.3
    room = width - (0.4 if is_narrow() else 1.3)
    words = ["damage as it grows", *words]
    above = room_above(words, width)
    columns = number_of_columns(len(steps), aspect, room)
    rows = -(-len(steps) // columns)
    across = room / columns
    most = (page_height() - above - below) / rows - TITLE
    panel_height = max(min(across * aspect, most), 0.5)
    height = above + rows * (panel_height + TITLE) + below
    figure, panels = new_figure(width, height), []
    for place, title in enumerate(titles):
        x = 0.2 + (place % columns) * across
        y = height - above - (place // columns + 1) * (panel_height + TITLE)
        axes = figure.add_axes([x / width, y / height, 0.96 * across / width, panel_height / height])
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.axis("off")
        if text_width(title, "small") > 0.96 * across:
            title = title.replace(", ", "\n", 1)
        axes.set_title(title, fontsize="small", loc="left", pad=points(3))
        panels.append(axes)
    bar = [(width - 0.95) / width, 0.3 / height, 0.2 / width, (height - above - 0.5) / height]
    if is_narrow():
        bar = [0.5 / width, 0.65 / height, (width - 1.0) / width, 0.16 / height]
    colour_bar(figure, bar, ScalarMappable(Normalize(0, 1), colours), "damage")
    heading(figure, results, words)
    return figure, panels


def number_of_columns(count: int, aspect: float, room: float) -> int:
    """Number of columns: as few as the height of a page allows, with at most a third of the last row empty."""
    fits = lambda columns: -(-count // columns) * (room / columns * aspect + TITLE) <= min(HIGHEST, page_height())
    most = max(int(room / LEAST_WIDTH), 1)
    full = [columns for columns in range(1, most + 1) if -count % columns <= columns / 3]
    return next((columns for columns in full if fits(columns)), full[-1])
