"""Picture of the energy balance: where the external work went."""

import numpy as np
from matplotlib.collections import LineCollection
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator

from .abscissa import Abscissa, abscissas
from .curve_page import PANEL, curve_page, settle
from .reactions import has_reactions, reactions
from .style import INK, page_width, points
from .units import ENERGIES, number, unit_for

PARTS = (  # columns of the history, labels and colours, from below
    ("stored_energy", "stored", "#8fb8d4"),
    ("dissipated_energy", "dissipated by damage", "#d98a68"),
    ("drained_energy", "drained by relaxation, or released", "#c9b26a"),
)
KINETIC = ("kinetic_energy", "kinetic", "#a9c58f")  # of a motion
MOST_STEMS = 250  # more states lie so close together that the stems are an area


def _column(results, name: str) -> np.ndarray:
    values = results.history.get(name, [])
    return np.nan_to_num(np.array(values if all(isinstance(value, float) for value in values) else [], dtype=float))


def _parts(results) -> tuple:
    return (PARTS[0], KINETIC, *PARTS[1:]) if results.is_of_motion else PARTS


def has_lost_energy(results) -> bool:
    """Whether the history has energies, and some energy was dissipated, drained or became kinetic."""
    columns = [_column(results, name) for name in ("load_factor", "external_work", *(name for name, _, _ in _parts(results)))]
    lengths = {len(column) for column in columns}
    return len(lengths) == 1 and lengths != {0} and any(column.any() for column in columns[3:])


def _abscissa(results) -> Abscissa:
    """What the run is drawn over if it only grows, else the step."""
    found = abscissas(results, reactions(results) if has_reactions(results) else [])
    steps = Abscissa("step", _column(results, "step"), kind="step")
    return next((one for one in found if one.grows), steps)


def draw_energies(results):
    """Stored, kinetic, dissipated and drained energy on top of each other, and the external work that they add up to.

    Energies are known at the accepted steps only. Each has a stem; nothing is drawn in between.
    """
    work, over = _column(results, "external_work"), _abscissa(results)
    parts = [(_column(results, name), words, colour) for name, words, colour in _parts(results)]
    parts = [part for part in parts if part[0].any()]
    unit, size = unit_for(max(np.abs(work).max(), sum(values for values, *_ in parts).max()), ENERGIES, 1.0)
    figure, [axes] = curve_page(heights=PANEL)
    work, below = work / size, np.zeros_like(work)
    width = np.clip(0.7 * 72.0 * page_width() / len(work), 1.5, 5.0)
    handles = []
    for values, words, colour in parts:
        above = below + values / size
        _draw_stems(axes, over.values, below, above, colour, points(width))
        handles.append(Patch(color=colour, label=words))
        below = above
    mark = {"linestyle": "none", "marker": "o", "markersize": points(np.clip(260 / len(work), 2.0, 6.0)), "zorder": 4}
    axes.plot(over.values, work, color=INK, label="external work", **mark)
    numerical = _column(results, "numerical_work")
    if len(numerical) == len(work) and np.abs(numerical).max() > 1e-3 * np.abs(work).max() * size:
        below = np.maximum(below, work + numerical / size)
        axes.plot(over.values, work + numerical / size, markerfacecolor="white", markeredgecolor=INK,
                  label="with the numerical work of relaxation", **(mark | {"zorder": 3.5}))  # fmt: skip
    axes.set_xlabel(over.label)
    axes.set_ylabel(f"energy [{unit}]")
    axes.margins(x=0.02)
    if over.kind == "step":
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_ylim(min(0.0, work.min()), 1.06 * max(work.max(), below.max()) or 1.0)
    words = ["where the external work went", "a stem per accepted step" if len(work) <= MOST_STEMS else "at accepted steps"]
    error = _column(results, "balance_error")
    if len(error) and np.abs(work).max() > 0.0:
        share = np.abs(error).max() / (np.abs(work).max() * size)
        words.append(f"balance error at most {number(100.0 * share, 2)} % of the largest external work")
    handles += axes.get_legend_handles_labels()[0]
    settle(figure, results, words, handles, [handle.get_label() for handle in handles])
    return figure


def _draw_stems(axes, places, below, above, colour, width) -> None:
    """A piece of the stem of every state."""
    ends = np.stack([np.stack([places, below], axis=1), np.stack([places, above], axis=1)], axis=1)
    axes.add_collection(LineCollection(ends, colors=colour, linewidths=width, capstyle="butt", zorder=2,
                                       antialiaseds=len(places) <= MOST_STEMS))  # fmt: skip
    axes.update_datalim(ends.reshape(-1, 2))
