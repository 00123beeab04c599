"""Colours for the step in which a bond broke."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize

from .style import colour_bar, number

MOST_TICKS = 8
STEP_COLOURS = LinearSegmentedColormap.from_list(  # dark enough at the end to be visible on the points
    "steps", ["#20104f", "#6a1b83", "#b5305f", "#e0602c", "#eda31b"]
)


def ranks_of_steps(steps: np.ndarray):
    """The distinct steps, the rank of each step, and a norm of ranks: one colour per step in which bonds broke, so that
    steps in between use up no colours."""
    distinct, rank = np.unique(steps, return_inverse=True)
    return distinct, rank, Normalize(-0.5, len(distinct) - 0.5)


def step_bar(figure, place, results, distinct: np.ndarray, norm: Normalize):
    """A colour bar of distinct steps that labels some of them with their load factors or times."""
    marked = np.unique(np.linspace(0, len(distinct) - 1, min(MOST_TICKS, len(distinct))).round().astype(int))
    what = "time [s]" if results.is_of_motion else "load factor"
    bar = colour_bar(figure, place, ScalarMappable(norm, STEP_COLOURS), f"step: {what} at which it broke", ticks=marked)
    bar.set_ticks(marked, labels=[_label(results, int(distinct[rank])) for rank in marked])
    return bar


def _label(results, step: int) -> str:
    load = results.in_history(step, "load_factor")
    return f"{step}" if load is None else f"{step}: {number(load, 3)}"
