"""Picture of a path from event to event (sequentially linear analysis): the snap-backs, and the response to the given
loads."""

import numpy as np

from .abscissa import abscissas
from .curve_page import curve_page, draw_zeros, settle
from .reactions import reactions
from .style import LINES, WARNING, points
from .units import ENERGIES, FORCES, number, unit_for

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
    everything = reactions(results)
    over = abscissas(results, everything)[0]
    released = results.numbers("released_energy")
    curve = max(over.curves(everything), key=lambda one: np.abs(one.values).max())
    unit, size = unit_for(np.abs(curve.values).max(), FORCES, 1.0)
    x, y = _with_rest(over.values), _with_rest(curve.values / size)
    met = np.concatenate([[True], results.numbers("on_response") > 0.0])

    has_released = released is not None and bool(released.max() > 0.0)
    options = {} if not has_released else {"gridspec_kw": {"width_ratios": [1.8, 1.0]}}
    figure, panels = curve_page(1 + has_released, wide=options)
    axes = panels[0]
    axes.plot(x[met], y[met], color=RESPONSE, linewidth=points(3.6), alpha=0.75, solid_joinstyle="round", zorder=2,
              label="response under the given loads")  # fmt: skip
    axes.plot(x, y, color=PATH, linewidth=points(1.0), zorder=3, label="equilibrium path")
    peak = int(np.argmax(y))
    axes.plot(x[peak], y[peak], "o", markersize=points(12), markerfacecolor="none", markeredgecolor=WARNING,
              markeredgewidth=points(1.8), zorder=4, label=f"peak: {number(y[peak])} {unit}")  # fmt: skip
    axes.set_xlabel(over.label)
    axes.set_ylabel(f"reaction of {curve.own_label} [{unit}]".replace("$", r"\$"))
    draw_zeros(axes)
    if has_released:
        _draw_released(panels[1], over.label, x[met], _with_rest(released)[met])
    steps = sum(step > 0 for step in results.history["step"])
    events = int(sum(isinstance(text, str) and "at their strength" in text for text in results.decisions.get("reason", [])))
    words = ["from event to event", f"{number(steps)} accepted step{'s' * (steps != 1)}",
             *([f"{number(events)} event{'s' * (events != 1)}"] if events else [])]  # fmt: skip
    settle(figure, results, words, *axes.get_legend_handles_labels())
    return figure


def _draw_released(axes, label, places, released) -> None:
    """Energy released in avalanches so far, under the given loads; it jumps at each."""
    unit, size = unit_for(released.max(), ENERGIES, 1.0)
    axes.plot(places, released / size, color=RESPONSE, drawstyle="steps-post", zorder=2)
    axes.set_xlabel(label)
    axes.set_ylabel(f"released energy [{unit}]")
    axes.set_ylim(bottom=0.0)
