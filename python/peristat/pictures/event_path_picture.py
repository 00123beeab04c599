"""Picture of a path from event to event (sequentially linear analysis): the snap-backs, and the response to the given
loads."""

import numpy as np

from .curve_pictures import abscissa_of, find_abscissa, reactions
from .style import ENERGIES, FORCES, GHOST, INK, LINES, WARNING, heading, new_figure, number, unit_for

PATH, RESPONSE = LINES[0], LINES[1]


def has_events(results) -> bool:
    """Whether the run went from event to event."""
    return "path" in results.history.get("mode", []) and results.numbers("on_response") is not None and bool(reactions(results))


def _with_rest(values: np.ndarray) -> np.ndarray:
    return np.concatenate([[0.0], values])


def draw_events(results):
    """Reaction over the displacement of the driven support, else over the load factor; beside it the energy released in
    avalanches.

    The response follows the path while the load grows and drops at constant load where the path snaps back.
    """
    load, curves = results.numbers("load_factor"), reactions(results)
    on_response = results.numbers("on_response") > 0.0
    released = results.numbers("released_energy")
    abscissa = find_abscissa(results, curves)
    label, places, shown = "load factor", load, curves
    if abscissa:
        label, places, shown, _ = abscissa_of(abscissa, curves)
    curve = max(shown, key=lambda one: np.abs(one.values).max())
    unit, size = unit_for(np.abs(curve.values).max(), FORCES, 1.0)
    x, y = _with_rest(places), _with_rest(curve.values / size)
    met = np.concatenate([[True], on_response])

    has_released = released is not None and released.max() > 0.0
    figure = new_figure(16.0, 7.2)
    axes = figure.add_axes([0.075, 0.125, 0.52 if has_released else 0.88, 0.71])
    axes.plot(x[met], y[met], color=RESPONSE, linewidth=3.6, alpha=0.75, solid_joinstyle="round", zorder=2,
              label="response under the given loads")  # fmt: skip
    axes.plot(x, y, color=PATH, linewidth=1.0, zorder=3, label="equilibrium path")
    peak = int(np.argmax(y))
    axes.plot(x[peak], y[peak], "o", markersize=12, markerfacecolor="none", markeredgecolor=WARNING, markeredgewidth=1.8,
              zorder=4, label=f"peak: {number(y[peak])} {unit}")  # fmt: skip
    axes.set_xlabel(label)
    axes.set_ylabel(f"reaction of {curve.label} [{unit}]".replace("$", r"\$"))
    axes.axhline(0.0, color=GHOST, linewidth=1.2, zorder=1)
    axes.axvline(0.0, color=GHOST, linewidth=1.2, zorder=1)
    axes.legend(loc="best", fontsize=12, labelcolor=INK)
    if has_released:
        _draw_released(figure.add_axes([0.68, 0.125, 0.29, 0.71]), label, x[met], _with_rest(released)[met])
    events = int(sum(isinstance(text, str) and "at their strength" in text for text in results.decisions.get("reason", [])))
    heading(figure, results, ["from event to event", f"{number(len(load))} accepted step{'s' * (len(load) != 1)}",
                              *([f"{number(events)} event{'s' * (events != 1)}"] if events else [])])  # fmt: skip
    return figure


def _draw_released(axes, label, places, released) -> None:
    """Energy released in avalanches so far, under the given loads."""
    unit, size = unit_for(released.max(), ENERGIES, 1.0)
    axes.plot(places, released / size, color=RESPONSE, linewidth=2.4, zorder=2)
    axes.set_xlabel(label)
    axes.set_ylabel(f"energy released by avalanches [{unit}]")
    axes.set_ylim(bottom=0.0)
