"""Picture of the crack-tip quantities: J, energy release rates and stress intensity factors."""

import numpy as np

from .style import INK, LINES, heading, new_figure, number, scaled, unit_for

RELEASES, INTENSITIES = scaled("J/m²"), scaled("Pa√m")
RATES = (("J", "J", "o", "-"), ("G_displacement", "G by a cut, at fixed displacement", "v", "none"),
         ("G_load", "G by a cut, at fixed load", "^", "none"))  # fmt: skip
FACTORS = (("K1", "K_I", "o"), ("K2", "K_II", "s"), ("K3", "K_III", "D"))


def _column(results, name: str) -> np.ndarray:
    values = results.history.get(name, [])
    return np.array(values if values and all(isinstance(value, float) for value in values) else [], dtype=float)


def crack_tips(results) -> list[str]:
    """Names of the tips that have columns in the history."""
    names = [str(tip.get("name")) for tip in results.tables("crack_tip")]
    return [name for name in names if len(_column(results, f"{name}_J"))]


def draw_crack_tips(results):
    """J with its spread over the ring and G above, stress intensity factors below; over the load factor, or over the
    steps if the load factor turns back."""
    load = _column(results, "load_factor")
    grows = (np.diff(load) >= 0.0).all()
    place = load if grows else np.arange(1.0, len(load) + 1)
    names = crack_tips(results)
    rates = {(name, part): _column(results, f"{name}_{part}") for name in names for part, *_ in RATES}
    factors = {(name, part): _column(results, f"{name}_{part}") for name in names for part, *_ in FACTORS}
    has_factors = any(len(values) for values in factors.values())

    figure = new_figure(15.0, 9.0 if has_factors else 6.0)
    height = 0.36 if has_factors else 0.7
    above = figure.add_axes([0.08, 0.9 - height - 0.04, 0.62, height])
    _draw(above, place, rates, RATES, names, RELEASES, "energy release rate")
    spread = max(np.abs(_column(results, f"{name}_J_spread")).max() for name in names)
    last = above
    if has_factors:
        last = figure.add_axes([0.08, 0.08, 0.62, height])
        _draw(last, place, factors, tuple((part, words, mark, "-") for part, words, mark in FACTORS), names, INTENSITIES,
              "stress intensity factor")  # fmt: skip
    last.set_xlabel("load factor" if grows else "step")
    heading(figure, results, ["what loads the tips of cracks", f"J differs by at most {number(100 * spread, 2)} % within its ring"])
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
            axes.plot(place, values / size, marker=mark, markersize=6, linestyle=line, color=colour, markeredgecolor=INK,
                      markeredgewidth=0.5, label=f"{name}: {label}")  # fmt: skip
    axes.set_ylabel(f"{words} [{unit}]")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), fontsize=12)
