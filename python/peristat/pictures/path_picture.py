"""Picture of an equilibrium path whose loads were found: load factor and reaction over displacements."""

from dataclasses import dataclass

import numpy as np

from .curve_pictures import AXES, has_reactions, reactions
from .style import FORCES, GHOST, INK, LENGTHS, LINES, heading, load_axis, new_figure, number, unit_for


def has_found_loads(results) -> bool:
    """Whether a control or the arc length has found the loads."""
    pivots, load = results.numbers("negative_pivots"), results.numbers("load_factor")
    return load is not None and pivots is not None and len(load) > 0 and pivots.max() >= 0


def _probes(results):
    """Label and values of every probed displacement component, with the sign that makes it grow."""
    for probe in results.tables("probe"):
        if probe.get("field", "displacement") not in ("displacement", "opening"):
            continue
        name = str(probe.get("name"))
        for axis in AXES[: results.dimension]:
            values = results.numbers(name if results.dimension == 1 else f"{name}_{axis}")
            if values is None:
                continue
            falls = values[np.argmax(np.abs(values))] < 0.0
            yield f"probe {name} in {'−' * falls}{axis}", -values if falls else values


@dataclass
class Panel:
    """Displacements for the abscissa [m]."""

    over: str
    places: np.ndarray
    label: str
    values: np.ndarray


def _panels(results):
    """The load factor over the controlled or probed displacement; under a control also the largest reaction over it."""
    control = results.numbers("control")
    words, of_load = load_axis(results.numbers("load_factor"))
    load = results.numbers("load_factor") / of_load
    probes = sorted(_probes(results), key=lambda probe: -np.abs(probe[1]).max())
    panels = [Panel(label, values, words, load) for label, values in probes[:2]
              if np.abs(values).max() > 1e-6 * np.abs(probes[0][1]).max()]  # fmt: skip
    if control is None or not np.abs(control).max() > 0.0:
        return panels
    panels = [Panel("controlled displacement", control, words, load), *panels]
    curves = reactions(results) if has_reactions(results) else []
    if curves:
        largest = max(curves, key=lambda curve: curve.values.max())
        unit, size = unit_for(largest.values.max(), FORCES, 1.0)
        panels.insert(1, Panel("controlled displacement", control, f"reaction of {largest.label} [{unit}]",
                               largest.values / size))  # fmt: skip
    return panels[:2]


def draw_path(results):
    """The path over displacements; states that are unstable under fixed loads are open marks."""
    load, unstable = results.numbers("load_factor"), results.numbers("negative_pivots") > 0
    panels = _panels(results) or [Panel("", np.arange(1.0, len(load) + 1), "load factor", load)]
    figure = new_figure(16.0, 7.2)
    for place, panel in enumerate(panels):
        axes = figure.add_axes([0.075 + 0.49 * place, 0.145, 0.40 if len(panels) > 1 else 0.80, 0.69])
        unit, size = unit_for(np.abs(panel.places).max(), LENGTHS) if panel.over else ("", 1.0)
        x, y = panel.places / size, panel.values
        rest = [0.0] if panel.over else []
        axes.plot(np.concatenate([rest, x]), np.concatenate([rest, y]), color=LINES[0], linewidth=1.8, zorder=2)
        mark = {"linestyle": "none", "marker": "o", "markersize": np.clip(400 / len(x), 3.5, 7), "zorder": 3,
                "markeredgecolor": LINES[0], "markeredgewidth": 1.2}  # fmt: skip
        axes.plot(x[~unstable], y[~unstable], markerfacecolor=LINES[0], label="stable", **mark)
        if unstable.any():
            axes.plot(x[unstable], y[unstable], markerfacecolor="white", label="unstable under fixed loads", **mark)
        axes.set_xlabel(f"{panel.over} [{unit}]" if panel.over else "step")
        axes.set_ylabel(panel.label)
        axes.axhline(0.0, color=GHOST, linewidth=1.2, zorder=1)
        axes.axvline(0.0, color=GHOST, linewidth=1.2, zorder=1)
    figure.axes[0].legend(loc="best", fontsize=12, labelcolor=INK)
    steps = len(load)
    heading(figure, results, ["loads that were found", f"{number(steps)} accepted step{'s' * (steps != 1)}",
                              f"largest load factor {number(load.max())}"])  # fmt: skip
    return figure
