"""Picture of the crack-tip quantities: J, energy release rates and stress intensity factors."""

import numpy as np

from .abscissa import Abscissa, abscissas
from .curve_page import curve_page, settle
from .reactions import has_reactions, reactions
from .style import INK, LINES, points
from .units import number, scaled, unit_for

RELEASES, INTENSITIES = scaled("J/m²"), scaled("Pa√m")
RATES = (("J", "J", "o", "-"), ("G_displacement", "G by a cut, at fixed displacement", "v", "none"),
         ("G_load", "G by a cut, at fixed load", "^", "none"))  # fmt: skip
FACTORS = (("K1", "K₁", "o"), ("K2", "K₂", "s"), ("K3", "K₃", "D"))


def _column(results, name: str) -> np.ndarray:
    values = results.history.get(name, [])
    return np.array(values if values and all(isinstance(value, float) for value in values) else [], dtype=float)


def crack_tips(results) -> list[str]:
    """Names of the tips that have columns in the history."""
    names = [str(tip.get("name")) for tip in results.tables("crack_tip")]
    return [name for name in names if len(_column(results, f"{name}_J"))]


def draw_crack_tips(results):
    """J with its spread over the ring and G above, stress intensity factors below; over what drives the run, or over the
    steps if that turns back."""
    over = next((one for one in abscissas(results, reactions(results) if has_reactions(results) else []) if one.grows),
                Abscissa("step", _column(results, "step"), kind="step"))  # fmt: skip
    names = crack_tips(results)
    rates = {(name, part): _column(results, f"{name}_{part}") for name in names for part, *_ in RATES}
    factors = {(name, part): _column(results, f"{name}_{part}") for name in names for part, *_ in FACTORS}
    has_factors = any(len(values) for values in factors.values())
    figure, panels = curve_page(1 + has_factors, sharex=True)
    _draw(panels[0], over.values, rates, RATES, names, RELEASES, "energy release rate")
    spread = max(np.abs(_column(results, f"{name}_J_spread")).max() for name in names)
    if has_factors:
        _draw(panels[1], over.values, factors, tuple((part, words, mark, "-") for part, words, mark in FACTORS), names,
              INTENSITIES, "stress intensity factor")  # fmt: skip
    for axes in panels:
        axes.set_xlabel(over.label)
    told = [axes.get_legend_handles_labels() for axes in panels]
    words = ["what loads the tips of cracks", f"J differs by at most {number(100 * spread, 2)} % within its ring"]
    settle(figure, results, words, *(sum(parts, []) for parts in zip(*told)))
    return figure


def _draw(axes, place, columns, parts, names, units, words):
    present = {key: values for key, values in columns.items() if len(values) == len(place)}
    unit, size = unit_for(max((np.abs(values).max() for values in present.values()), default=0.0), units, 1.0)
    for number_of_tip, name in enumerate(names):
        for part, label, mark, line in parts:
            values = present.get((name, part))
            if values is None:
                continue
            colour = LINES[(number_of_tip * len(parts) + [p for p, *_ in parts].index(part)) % len(LINES)]
            axes.plot(place, values / size, marker=mark, markersize=points(6), linestyle=line, color=colour, markeredgecolor=INK,
                      markeredgewidth=points(0.5), label=f"{name}: {label}")  # fmt: skip
    axes.set_ylabel(f"{words} [{unit}]")
