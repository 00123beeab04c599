"""The picture of a refinement: quantities over the spacing, and their extrapolation to zero spacing."""

import tomllib
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from peristat.pictures.style import GHOST, LINES, WARNING, WIDE, heading, new_figure, own_settings
from peristat.pictures.units import ENERGIES, FORCES, LENGTHS, STRESSES, number, unit_for
from refinement import Refinement
from table import FIELD_UNITS

MOST_PANELS = 6
COLUMNS = 3
UNITS = {"m": LENGTHS, "N": FORCES, "J": ENERGIES, "Pa": STRESSES}  # units with prefixes


@own_settings(WIDE)
def draw_refinements(case: Path, rows: list[tuple[tuple[str, ...], Refinement]]):
    """One panel per quantity, with a line for each combination of the other keys; probes come first."""
    text = tomllib.loads(case.read_text("utf-8"))
    units = {probe["name"]: FIELD_UNITS.get(probe.get("field", "displacement"), "") for probe in text.get("probe", [])}
    names = list(dict.fromkeys(of.quantity for _, of in rows))
    shown = _most_telling(rows, names)
    lines = -(-len(shown) // COLUMNS)
    height = 1.1 + 4.3 * lines
    figure = new_figure(16.0, height)
    for place, name in enumerate(shown):
        left = 0.085 + (place % COLUMNS) * 0.325
        bottom = (0.75 + (lines - 1 - place // COLUMNS) * 4.3) / height
        axes = figure.add_axes([left, bottom, 0.225, 3.0 / height])
        own = [(values, of) for values, of in rows if of.quantity == name]
        _draw_quantity(axes, name, _unit(name, units), own)
    words = [f"{len(rows[0][1].spacings)} lattices"]
    if len(shown) < len(names):
        words.append(f"{number(len(shown))} of {number(len(names))} quantities (all are in refinement.csv)")
    heading(figure, _Heading(text.get("title") or case.stem), words)
    return figure


def _most_telling(rows: list[tuple[tuple[str, ...], Refinement]], names: list[str]) -> list[str]:
    """Probes and reactions first; constant quantities and duplicates of shown ones are left out."""
    order = {"probe": 0, "peak_reaction": 1, "final_reaction": 2}
    shown, seen = [], []
    for name in sorted(names, key=lambda name: order.get(name.partition(":")[0], 3)):
        own = [of for _, of in rows if of.quantity == name]
        values = np.concatenate([of.values for of in own])
        is_constant = all(of.behaviour == "constant" for of in own)
        if not is_constant and not any(np.allclose(values, other, rtol=1e-7, atol=0.0) for other in seen):
            shown.append(name)
            seen.append(values)
    return (shown or names)[:MOST_PANELS]


@dataclass
class _Heading:
    title: str
    status: str = "completed"


def _unit(name: str, of_probes: dict[str, str]) -> str:
    kind, _, own = name.partition(":")
    if kind == "probe":
        return next((unit for probe, unit in of_probes.items() if own == probe or own[:-2] == probe), "")
    return {"max_displacement": "m"}.get(kind, "J" if "energy" in kind else "N")


def _draw_quantity(axes, name: str, unit: str, rows: list[tuple[tuple[str, ...], Refinement]]) -> None:
    told = []
    largest = max(abs(value) for _, of in rows for value in of.values)
    unit, size = unit_for(largest, UNITS[unit]) if unit in UNITS else (unit, 1.0)
    length, metres = unit_for(max(rows[0][1].spacings), LENGTHS)
    for color, (values, of) in zip(LINES * len(rows), rows):
        spacings, results = np.array(of.spacings) / metres, np.array(of.values) / size
        axes.plot(spacings, results, "o", color=color, markersize=7, zorder=3)
        label = ", ".join(values)
        if of.behaviour == "monotone":
            curve = np.linspace(0.0, spacings[0], 100)
            limit = of.extrapolated / size
            slope = (results[-1] - limit) / spacings[-1] ** of.order
            axes.plot(curve, limit + slope * curve**of.order, color=color, linewidth=1.4, zorder=2)
            axes.errorbar([0.0], [limit], [of.uncertainty / size], color=color, marker="D", markersize=6,
                          capsize=4, clip_on=False, zorder=4)  # fmt: skip
            index = "" if of.index is None else f", GCI {100.0 * of.index:.2g} %"
            told.append((color, f"{label}{': ' if label else ''}order {of.order:.2f}{index}"))
        else:
            axes.plot(spacings, results, color=GHOST, linewidth=1.2, zorder=1)
            told.append((WARNING, f"{label}{': ' if label else ''}{of.behaviour}"))
    axes.set_xlim(0.0, None)
    axes.margins(y=0.15)
    axes.ticklabel_format(axis="y", useOffset=False)
    axes.set_xlabel(f"spacing [{length}]")
    axes.set_ylabel(f"{name}{f' [{unit}]' if unit else ''}".replace("$", r"\$"))
    for line, (color, text) in enumerate(told[:4]):
        axes.text(0.03, 1.13 - 0.06 * line if len(told) > 1 else 1.03, text.replace("$", r"\$"), color=color,
                  transform=axes.transAxes, fontsize=10.5)  # fmt: skip
