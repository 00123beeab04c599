"""Picture of columns of the history over another one."""

from dataclasses import dataclass

import numpy as np

from .curve_page import curve_page, settle
from .style import LINES, Style, SCREEN, own_settings, points
from .units import unit_for, units_of


@dataclass(frozen=True)
class Column:
    """A column of the history, with its unit as results.h5 spells it."""

    name: str
    values: np.ndarray
    unit: str


def draw_columns(results, x: Column, columns: list[Column], style: Style = SCREEN):
    """Columns of one unit over the column x, with a mark at each row if they are few."""
    with own_settings(style):
        figure, [axes] = curve_page()
        of_x, x_size = _unit([x])
        of_y, y_size = _unit(columns)
        for place, column in enumerate(columns):
            axes.plot(x.values / x_size, column.values / y_size, color=LINES[place % len(LINES)],
                      linestyle="-" if place < len(LINES) else "--", label=column.name,
                      marker="o" if len(x.values) <= 60 else None, markersize=points(4))  # fmt: skip
        axes.set_xlabel(_label(x.name, of_x))
        axes.set_ylabel(_label(columns[0].name if len(columns) == 1 else "", of_y))
        words = [f"{', '.join(column.name for column in columns[:3])}{' …' * (len(columns) > 3)} over {x.name}"]
        settle(figure, results, words, *(axes.get_legend_handles_labels() if len(columns) > 1 else ((), ())))
        return figure


def _unit(columns: list[Column]) -> tuple[str, float]:
    return unit_for(max(np.abs(column.values).max(initial=0.0) for column in columns), units_of(columns[0].unit))


def _label(name: str, unit: str) -> str:
    return (name + f" [{unit}]" * bool(unit)).strip().replace("$", r"\$")
