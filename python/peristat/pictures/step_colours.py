"""Colours for the step in which a bond broke."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import LinearSegmentedColormap, Normalize

from .state_words import progress
from .style import colour_bar

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
    """A colour bar of distinct steps that labels some of them with how far the run was."""
    upright = place[3] * figure.get_size_inches()[1] > place[2] * figure.get_size_inches()[0]
    marked = np.unique(np.linspace(0, len(distinct) - 1, min(MOST_TICKS if upright else 2, len(distinct))).round().astype(int))
    known = [(int(step), results.in_history(int(step), "load_factor")) for step in distinct[marked]]
    told = [None if load is None else progress(results, step, load) for step, load in known]
    what = f"step: {told[0][0]}{f' [{told[0][2]}]' if told[0][2] else ''} at which it broke" if told[0] else "step"
    bar = colour_bar(figure, place, ScalarMappable(norm, STEP_COLOURS), what, ticks=marked)
    bar.set_ticks(marked, labels=[f"{step}: {words[1]}" if words else f"{step}" for (step, _), words in zip(known, told)])
    return bar
