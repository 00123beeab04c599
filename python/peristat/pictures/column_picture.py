"""Picture of columns of the history over another one."""

from dataclasses import dataclass

import numpy as np

from .style import LINES, heading, new_figure, own_settings, unit_for, units_of


@dataclass(frozen=True)
class Column:
    """A column of the history, with its unit as results.h5 spells it."""

    name: str
    values: np.ndarray
    unit: str


@own_settings()
def draw_columns(results, x: Column, columns: list[Column]):
    """Columns of one unit over the column x, with a mark at each row if they are few."""
    figure = new_figure(12.0, 7.2)
    axes = figure.add_axes([0.105, 0.115, 0.855, 0.71])
    of_x, x_size = _unit([x])
    of_y, y_size = _unit(columns)
    for place, column in enumerate(columns):
        axes.plot(x.values / x_size, column.values / y_size, color=LINES[place % len(LINES)], linewidth=1.8,
                  linestyle="-" if place < len(LINES) else "--", label=column.name.replace("$", r"\$"),
                  marker="o" if len(x.values) <= 60 else None, markersize=4)  # fmt: skip
    axes.set_xlabel(_label(x.name, of_x))
    axes.set_ylabel(_label(columns[0].name if len(columns) == 1 else "", of_y))
    if len(columns) > 1:
        axes.legend(fontsize=12)
    heading(figure, results, [f"{', '.join(column.name for column in columns[:3])}{' …' * (len(columns) > 3)} over {x.name}"
                              .replace("$", r"\$")])  # fmt: skip
    return figure


def _unit(columns: list[Column]) -> tuple[str, float]:
    return unit_for(max(np.abs(column.values).max(initial=0.0) for column in columns), units_of(columns[0].unit))


def _label(name: str, unit: str) -> str:
    return (name + f" [{unit}]" * bool(unit)).strip().replace("$", r"\$")
