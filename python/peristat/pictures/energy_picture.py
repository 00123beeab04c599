"""Picture of the energy balance: where the external work went."""

import numpy as np
from matplotlib.ticker import MaxNLocator

from .style import ENERGIES, INK, heading, load_axis, new_figure, number, time_unit, unit_for

PARTS = (  # columns of the history, labels and colours, from below
    ("stored_energy", "stored", "#8fb8d4"),
    ("dissipated_energy", "dissipated by damage", "#d98a68"),
    ("drained_energy", "drained by relaxation, or released", "#c9b26a"),
)
MOST_BARS = 40  # more steps are drawn as areas, because their states lie close together
KINETIC = ("kinetic_energy", "kinetic", "#a9c58f")  # of a motion


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


def _marks(count: int, edge: str = INK) -> dict:
    """Style of the marks at the accepted steps, the only states whose energies are known."""
    return {"marker": "o", "markersize": float(np.clip(260 / count, 2.0, 6.0)), "markerfacecolor": INK,
            "markeredgecolor": edge, "markeredgewidth": 0.5}  # fmt: skip


def draw_energies(results):
    """Stored, kinetic, dissipated and drained energy stacked, and the external work that they add up to.

    The abscissa is the load factor if it only grows, the time for a motion, else the step.
    """
    load, work = _column(results, "load_factor"), _column(results, "external_work")
    parts = [_column(results, name) for name, _, _ in _parts(results)]
    grows = (np.diff(load) >= 0.0).all() and load[0] >= 0.0
    label, of_load = ("", 1.0) if results.is_of_motion else load_axis(load)
    place = load / of_load if grows else _column(results, "step")
    unit, size = unit_for(max(np.abs(work).max(), sum(parts).max()), ENERGIES, 1.0)
    start = [0.0] if place[0] > 0.0 else []
    place, work = np.concatenate([start, place]), np.concatenate([start, work]) / size
    parts = [np.concatenate([start, values]) / size for values in parts]

    figure = new_figure(15.0, 7.2)
    axes = figure.add_axes([0.07, 0.115, 0.67, 0.71])
    time, second = time_unit(load.max()) if results.is_of_motion else ("", 1.0)
    place = place / second
    shown = [(values, *looks) for values, (_, *looks) in zip(parts, _parts(results)) if values.any()]
    below = np.zeros_like(work)
    # Few steps get one bar each: lines between them would show values that are not known.
    fill, line = ({"step": "mid"}, {"drawstyle": "steps-mid"}) if len(place) <= MOST_BARS else ({}, {})
    for values, words, colour in shown:
        axes.fill_between(place, below, below + values, color=colour, linewidth=0.0, label=words, zorder=2, **fill)
        below = below + values
        axes.plot(place, below, color="white", linewidth=1.0, zorder=3, **line, **_marks(len(place), "white"))
    axes.plot(place, work, color=INK, linewidth=1.4, zorder=4, label="external work",
              linestyle="none" if fill else "-", **_marks(len(place)))  # fmt: skip
    numerical = _column(results, "numerical_work")
    if len(numerical) == len(load) and np.abs(numerical).max() > 1e-3 * np.abs(work).max() * size:
        both = work + np.concatenate([start, numerical]) / size
        axes.plot(place, both, color=INK, linewidth=1.2, linestyle=(0, (4, 2)), zorder=4,
                  label="with the numerical work of relaxation")  # fmt: skip
        below = np.maximum(below, both)
    axes.set_xlabel(f"time [{time}]" if results.is_of_motion else label if grows else "step")
    if not grows:
        axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_ylabel(f"energy [{unit}]")
    axes.set_xlim(place.min(), place.max() if place.max() > place.min() else place.min() + 1.0)
    axes.set_ylim(min(0.0, work.min()), 1.06 * max(work.max(), below.max()))
    handles, labels = axes.get_legend_handles_labels()
    # The legend lists the parts in their stacking order, beside the axes.
    axes.legend(handles[::-1], labels[::-1], loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=12)
    words = ["where the external work went", "known at the marked steps"]
    error = _column(results, "balance_error")
    if len(error) and np.abs(work).max() > 0.0:
        share = np.abs(error).max() / (np.abs(work).max() * size)
        words.append(f"balance error at most {number(100.0 * share, 2)} % of the largest external work")
    heading(figure, results, words)
    return figure
