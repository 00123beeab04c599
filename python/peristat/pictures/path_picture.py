"""Picture of an equilibrium path whose loads were found: the force over displacements, and which states are stable."""

from dataclasses import dataclass

import numpy as np

from .abscissa import Abscissa, abscissas
from .curve_page import curve_page, draw_zeros, settle
from .reactions import AXES, has_reactions, reactions
from .style import LINES, points
from .units import FORCES, load_axis, number, unit_for


def has_found_loads(results) -> bool:
    """Whether a control or the arc length has found the loads."""
    pivots, load = results.numbers("negative_pivots"), results.numbers("load_factor")
    return load is not None and pivots is not None and len(load) > 0 and pivots.max() >= 0


def _probes(results):
    """Probed displacement components, the largest first, with the sign that makes each grow."""
    found = []
    for probe in results.tables("probe"):
        if probe.get("field", "displacement") not in ("displacement", "opening"):
            continue
        name = str(probe.get("name"))
        for axis in AXES[: results.dimension]:
            values = results.numbers(name if results.dimension == 1 else f"{name}_{axis}")
            if values is None:
                continue
            falls = bool(values[np.argmax(np.abs(values))] < 0.0)
            found.append(Abscissa(f"probe {name} in {'−' * falls}{axis}", -values if falls else values))
    found.sort(key=lambda probe: -np.abs(probe.values).max())
    return [probe.readable() for probe in found if np.abs(probe.values).max() > 1e-6 * np.abs(found[0].values).max()]


@dataclass
class Panel:
    """A quantity over a displacement."""

    over: Abscissa
    label: str
    values: np.ndarray


def _panels(results) -> list[Panel]:
    """The largest reaction over what is controlled and driven. Without one: the load factor over probed displacements."""
    curves = reactions(results) if has_reactions(results) else []
    over = [one for one in abscissas(results, curves) if one.kind == "displacement"]
    load = results.numbers("load_factor")
    if curves and over:
        panels = []
        for one in over:
            curve = max(one.curves(curves), key=lambda curve: curve.values.max())
            unit, size = unit_for(curve.values.max(), FORCES, 1.0)
            panels.append(Panel(one, f"reaction of {curve.own_label} [{unit}]", curve.values / size))
        return panels
    words, of_load = load_axis(load)
    steps = Abscissa("step", np.arange(1.0, len(load) + 1), kind="step")
    return [Panel(one, words, load / of_load) for one in _probes(results) or over or [steps]]


def draw_path(results):
    """The path over displacements; states that are unstable under fixed loads are open marks."""
    load, unstable = results.numbers("load_factor"), results.numbers("negative_pivots") > 0
    shown = _panels(results)[:2]
    figure, panels = curve_page(len(shown))
    for axes, panel in zip(panels, shown):
        x, y = panel.over.values, panel.values
        rest = [0.0] if panel.over.kind != "step" else []
        axes.plot(np.concatenate([rest, x]), np.concatenate([rest, y]), color=LINES[0], zorder=2)
        mark = {"linestyle": "none", "marker": "o", "markersize": points(np.clip(400 / len(x), 3.5, 7)), "zorder": 3,
                "markeredgecolor": LINES[0], "markeredgewidth": points(1.2)}  # fmt: skip
        axes.plot(x[~unstable], y[~unstable], markerfacecolor=LINES[0], label="stable under fixed loads", **mark)
        if unstable.any():
            axes.plot(x[unstable], y[unstable], markerfacecolor="white", label="unstable under fixed loads", **mark)
        axes.set_xlabel(panel.over.label)
        axes.set_ylabel(panel.label.replace("$", r"\$") if "load factor" not in panel.label else panel.label)
        draw_zeros(axes)
    steps = sum(step > 0 for step in results.history["step"])
    words = ["loads that were found", f"{number(steps)} accepted step{'s' * (steps != 1)}"]
    if shown[0].label.startswith("load factor"):
        words.append(f"largest load factor {number(load.max())}")
    settle(figure, results, words, *panels[0].get_legend_handles_labels())
    return figure
