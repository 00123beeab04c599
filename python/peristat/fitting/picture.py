"""The picture of a fit: for each specimen the measured and the fitted curve, and below them the residuals."""

import numpy

from ..pictures.style import FACTS, GHOST, LINES, WIDE, heading, new_figure, own_settings, room_above
from ..pictures.units import FORCES, LENGTHS, unit_for
from .curves import computed
from .outcome import Outcome

COLUMNS = 2
UNITS = {"m": LENGTHS, "N": FORCES}
PANEL, BELOW, GAP = 4.4, 1.7, 1.15  # heights [inch]


class _Heading:
    status = "completed"

    def __init__(self, title: str):
        self.title = title


@own_settings(WIDE)
def draw_fit(outcome: Outcome, title: str):
    specimens = outcome.problem.specimens
    columns = min(COLUMNS, len(specimens))
    lines = -(-len(specimens) // columns)
    words = [_told(each) for each in outcome.statistics.estimates]
    top = room_above(words, 16.0) + 0.15
    height = top + lines * (PANEL + BELOW + GAP + 0.2)
    figure = new_figure(16.0, height)
    for place in range(len(specimens)):
        left = 0.075 + (place % columns) * 0.93 / columns
        width = 0.93 / columns - 0.085
        bottom = height - top - (place // columns + 1) * (PANEL + BELOW + GAP + 0.2) + 0.75
        below = figure.add_axes([left, bottom / height, width, BELOW / height])
        above = figure.add_axes([left, (bottom + BELOW + 0.4) / height, width, PANEL / height], sharex=below)
        _draw(above, below, outcome, place)
    heading(figure, _Heading(title), words)
    return figure


def _told(each) -> str:
    name = each.parameter.key.rpartition(".")[2]
    if each.deviation is None:
        return f"{name} not determined"
    deviation = f"{each.deviation:.2g}" if not 100.0 <= each.deviation < 1e6 else f"{each.deviation:.0f}"
    return f"{name} {each.value:.4g} ± {deviation} {each.parameter.unit}".strip()


def _draw(above, below, outcome: Outcome, place: int) -> None:
    specimen, point = outcome.problem.specimens[place], outcome.best.point
    data, residual = specimen.measured.curve, point.residuals[place]
    run = computed(point.runs[place].folder, specimen.columns)
    x_unit, x_size = _unit(specimen.columns.x, data.x)
    y_unit, y_size = _unit(specimen.columns.y, data.y)
    marks = {"marker": "o", "linestyle": "none", "markersize": 4.5 if len(data.x) < 100 else 3.0}
    if specimen.measured.noise is not None:
        band = [(data.y + sign * specimen.measured.noise) / y_size for sign in (-1, 1)]
        above.fill_between(data.x / x_size, *band, color=GHOST, alpha=0.6, linewidth=0.0, label="standard deviation of the data")
    above.plot(data.x / x_size, data.y / y_size, color=FACTS, label="measured", zorder=3, **marks)
    above.plot(run.x / x_size, run.y / y_size, color=LINES[1], label="fitted", zorder=4, linewidth=2.2)
    end = data.x.max() / x_size
    above.set_xlim(min(0.0, 1.03 * data.x.min() / x_size), 1.03 * end)
    above.set_ylabel(f"{specimen.columns.y}{y_unit}".replace("$", r"\$"))
    above.legend(loc="best")
    above.set_title(specimen.name.rpartition("/")[2].replace("$", r"\$"), loc="left", fontsize="small", color=FACTS)
    above.tick_params(labelbottom=False)

    below.axhline(0.0, color=GHOST, linewidth=1.4, zorder=1)
    values = residual.values.reshape(-1, specimen.comparison.points)
    values = values[0] if len(values) == 1 else numpy.linalg.norm(values, axis=0)
    is_known = specimen.measured.noise is not None
    compared = numpy.isfinite(residual.fitted.y)
    below.plot(data.x[compared] / x_size, values[compared] * (1.0 if is_known else 100.0), color=LINES[1], zorder=3, **marks)
    below.set_xlabel(f"{specimen.columns.x}{x_unit}".replace("$", r"\$"))
    below.set_ylabel("residual [σ]" if is_known else "residual [%]")


def _unit(column: str, values: numpy.ndarray) -> tuple[str, float]:
    """Unit of a column by its name, as the label has it, and its size; none for a probe."""
    names = {"N": ("reaction_", "force_"), "m": ("displacement_", "control")}
    unit = next((unit for unit, starts in names.items() if any(start in column for start in starts)), None)
    if unit is None:
        return "", 1.0
    name, size = unit_for(float(numpy.abs(values).max()), UNITS[unit])
    return f" [{name}]", size
