"""Marks of fracture on curves of reactions: the peak, steps found by relaxation, switches between the solvers."""

import numpy as np

from .style import INK, WARNING, points
from .units import number

HAND_OVERS = (  # actions of decisions.csv, label, colour and dashes
    ("hand over to relaxation", "hand-over to relaxation", "#b58a1b", (0, (5, 2))),
    ("hand back to newton", "hand-back to Newton's method", "#7a5aa6", (0, (1, 2))),
)


def draw_fracture(axes, results, abscissa, curves, unit: str, size: float, everything) -> None:
    """Marks the steps found by relaxation (open marks), the switches between solvers (lines), and the peak with its
    value."""
    from .load_displacement_picture import style_of

    places = abscissa.values
    mark = points(np.clip(400 / len(places), 3.5, 7))
    for line in axes.get_lines():
        line.set(markersize=mark, markeredgewidth=0.0)
    relaxed = np.array([mode == "relaxation" for mode in results.history.get("mode", [])], dtype=bool)
    if len(relaxed) == len(places) and relaxed.any():
        for curve in curves:
            colour, kind = style_of(curve, everything)
            axes.plot(places[relaxed], curve.values[relaxed] / size, linestyle="none", marker=kind, markersize=mark,
                      markerfacecolor="white", markeredgecolor=colour, markeredgewidth=points(1.2), zorder=4)  # fmt: skip
        for colour, label in ((INK, "Newton's method"), ("white", "relaxation")):
            axes.plot([], [], linestyle="none", marker="o", markersize=points(7), markerfacecolor=colour,
                      markeredgecolor=INK, markeredgewidth=points(1.2), label=label)  # fmt: skip
    for action, label, colour, dashes in HAND_OVERS:
        for place, (step, load) in enumerate(hand_overs(results, action)):
            axes.axvline(on_the_way(results, places, step, load), color=colour, linewidth=points(1.0), linestyle=dashes,
                         zorder=1.5, label=label if place == 0 else None)  # fmt: skip
    _mark_peak(axes, abscissa, curves, unit, size)


def hand_overs(results, action: str) -> list[tuple[float, float]]:
    """Step and load factor of the decisions for an action; if there are no decisions, of changes of the mode."""
    table = results.decisions
    if table.get("action"):
        decided = zip(table.get("step", []), table.get("load_factor", []), table["action"])
        return sorted({(step, load) for step, load, taken in decided
                       if taken == action and isinstance(step, float) and isinstance(load, float)})  # fmt: skip
    new = "relaxation" if "relaxation" in action else "newton"
    rows = list(zip(*(results.history.get(name, []) for name in ("mode", "step", "load_factor"))))
    return [(step, load) for (before, _, _), (mode, step, load) in zip(rows, rows[1:]) if before != mode == new]


def on_the_way(results, places, step: float, load: float) -> float:
    """Abscissa of a load factor between a step and the accepted step before it."""
    after = min(int(np.searchsorted(results.history["step"], step)), len(places) - 1)
    loads = np.concatenate([[0.0], results.history["load_factor"]])[after : after + 2]
    ends = np.concatenate([[0.0], places])[after : after + 2]
    share = (load - loads[0]) / (loads[1] - loads[0]) if loads[1] != loads[0] else 1.0
    return float(ends[0] + np.clip(share, 0.0, 1.0) * (ends[1] - ends[0]))


def _mark_peak(axes, abscissa, curves, unit: str, size: float) -> None:
    """A ring around the largest reaction, and its value and place above all curves."""
    places, values = abscissa.values, max((curve.values for curve in curves), key=np.max) / size
    peak = int(np.argmax(values))
    axes.plot(places[peak], values[peak], "o", markersize=points(13), markerfacecolor="none", markeredgecolor=WARNING,
              markeredgewidth=points(1.8), zorder=5, label="peak")  # fmt: skip
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.12 * (high - low))
    left, right = axes.get_xlim()
    share = (places[peak] - left) / (right - left) if right > left else 0.5
    text = f"{number(values[peak])} {unit} {abscissa.words(places[peak])}"
    axes.annotate(text, (places[peak], values[peak]), xytext=(0, points(11)), textcoords="offset points",
                  ha="left" if share < 0.3 else "right" if share > 0.7 else "center",
                  va="bottom", fontsize="small", fontweight="bold", color=WARNING, zorder=6,
                  bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": points(1.5)})  # fmt: skip
