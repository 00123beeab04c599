"""Pictures of a run's history: reactions against load and displacement, convergence of iterations."""

import numpy as np
from matplotlib import colormaps
from matplotlib.ticker import MaxNLocator

from style import FAINT, FORCES, GHOST, INK, LENGTHS, LINES, WARNING, heading, new_figure, number, unit_for

# Relative residuals below are round-off and show no order: in slender bodies the forces of single
# bonds are orders of magnitude larger than the residual's scale, and so is their round-off.
ROUND_OFF = 1e-11
MOST_STEPS = 8  # curves in the picture of convergence
MOST_VALUES_READ = 20_000_000  # of displacements, to find how far the supports moved
AXES = "xyz"
MARKERS = "osD^vP"
HAND_OVERS = (  # actions of decisions.csv, words, colour and dashes
    ("hand over to relaxation", "hand-over to relaxation", "#b58a1b", (0, (5, 2))),
    ("hand back to newton", "hand-back to Newton's method", "#7a5aa6", (0, (1, 2))),
)
HISTORY_COLUMNS = {
    "step", "load_factor", "mode", "newton_iterations", "relaxation_iterations", "stored_energy",
    "dissipated_energy", "drained_energy", "external_work", "balance_error", "broken_bonds",
    "max_damage", "max_stretch",
}  # fmt: skip


# ------------------------------------------------------------------------------ load and displacement


def draw_load_displacement(results):
    """Reactions of the support sets over the load factor, and over a displacement if one is known.

    Once there is damage, also how the steps were found, the peak, and the hand-overs between the solvers.
    """
    load = np.array(results.history["load_factor"])
    curves = reactions(results.history, len(load))
    unit, size = unit_for(max(np.abs(values).max() for _, _, values in curves), FORCES, 1.0)
    abscissa = find_abscissa(results, curves)

    foot = 0.65 if results.is_fractured else 0.0  # inches for the legend
    height = 7.2 + foot
    bottom, panel_height = (0.115 * 7.2 + foot) / height, 0.71 * 7.2 / height
    figure = new_figure(16.0, height)
    panels = [figure.add_axes([0.075, bottom, 0.40 if abscissa else 0.80, panel_height])]
    _draw_reactions(panels[0], curves, lambda name: load, size)
    panels[0].set_xlabel("load factor")
    panels[0].set_ylabel(f"reaction [{unit}]")
    if results.is_fractured:
        draw_fracture(panels[0], results, curves, load, size, "at load factor {}")
    if abscissa:
        label, places, shown, words = abscissa_of(abscissa, curves)
        panels.append(figure.add_axes([0.565, bottom, 0.40, panel_height]))
        _draw_reactions(panels[1], shown, lambda name: places, size, curves)
        panels[1].set_xlabel(label)
        panels[1].set_ylabel(f"reaction [{unit}]")
        if results.is_fractured:
            draw_fracture(panels[1], results, shown, places, size, words, curves)
        if abs(places.min()) > places.max():
            panels[1].invert_xaxis()  # the curve starts at the left
    for axes in panels:
        axes.axhline(0.0, color=GHOST, linewidth=1.2, zorder=1)
        axes.axvline(0.0, color=GHOST, linewidth=1.2, zorder=1)
        if not results.is_fractured:
            axes.legend(loc="best" if len(curves) > 1 else "upper left", fontsize=12)
    if results.is_fractured:
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="lower center", ncol=min(len(labels), 6), fontsize=12,
                      bbox_to_anchor=(0.52, 0.0), borderaxespad=0.5)  # fmt: skip
    steps = len(load)
    heading(figure, results, ["reactions of the supports", f"{number(steps)} accepted step{'s' * (steps != 1)}",
                              f"load factor up to {number(load.max())}"])  # fmt: skip
    return figure


def find_abscissa(results, curves):
    """The displacement to draw over, see `abscissa_of`; None if none is known."""
    return _probe(results) or _moved_support(results, curves)


def abscissa_of(abscissa, curves):
    """Of a displacement to draw over: label, values in its unit, the curves to draw, words for a value."""
    label, places, only, sign = abscissa
    shown = [(name, axis, sign * values) for name, axis, values in curves if only in (None, name)]
    length, size = unit_for(np.abs(places).max(), LENGTHS) if "[m]" in label else ("", 1.0)
    return label.replace("[m]", f"[{length}]"), places / size, shown, f"at {{}} {length}".rstrip()


def draw_fracture(axes, results, curves, places, size, words, all_curves=None):
    """Open marks of the steps found by relaxation, lines of the hand-overs, and the peak with its value.

    places  abscissa of the accepted steps
    words   what is said of the peak's place, "at {} mm"
    """
    names = [name for name, _, _ in all_curves or curves]
    mark = np.clip(400 / len(places), 3.5, 7)
    for line in axes.get_lines():
        line.set(markersize=mark, markeredgewidth=0.0)
    relaxed = np.array([mode == "relaxation" for mode in results.history.get("mode", [])], dtype=bool)
    if len(relaxed) == len(places) and relaxed.any():
        for name, _, values in curves:
            style = names.index(name)
            axes.plot(places[relaxed], values[relaxed] / size, linestyle="none",
                      marker=MARKERS[style % len(MARKERS)], markersize=mark, markerfacecolor="white",
                      markeredgecolor=LINES[style % len(LINES)], markeredgewidth=1.2, zorder=4)  # fmt: skip
        for colour, label in ((INK, "Newton's method"), ("white", "relaxation")):
            axes.plot([], [], linestyle="none", marker="o", markersize=7, markerfacecolor=colour,
                      markeredgecolor=INK, markeredgewidth=1.2, label=label)  # fmt: skip
    for action, label, colour, dashes in HAND_OVERS:
        for place, (step, load) in enumerate(hand_overs(results, action)):
            axes.axvline(on_the_way(results, places, step, load), color=colour, linewidth=1.0, linestyle=dashes,
                         zorder=1.5, label=label if place == 0 else None)  # fmt: skip
    _mark_peak(axes, curves, places, size, words)


def hand_overs(results, action: str) -> list[tuple[float, float]]:
    """Step and load factor of decisions for an action; without decisions, of changes of the mode."""
    table = results.decisions
    if table.get("action"):
        decided = zip(table.get("step", []), table.get("load_factor", []), table["action"])
        return sorted({(step, load) for step, load, taken in decided
                       if taken == action and isinstance(step, float) and isinstance(load, float)})  # fmt: skip
    new = "relaxation" if "relaxation" in action else "newton"
    rows = list(zip(*(results.history.get(name, []) for name in ("mode", "step", "load_factor"))))
    return [(step, load) for (before, _, _), (mode, step, load) in zip(rows, rows[1:]) if before != mode == new]


def on_the_way(results, places, step: float, load: float) -> float:
    """Abscissa of a load factor on the way to a step from the accepted one before it."""
    after = min(int(np.searchsorted(results.history["step"], step)), len(places) - 1)
    loads = np.concatenate([[0.0], results.history["load_factor"]])[after : after + 2]
    ends = np.concatenate([[0.0], places])[after : after + 2]
    share = (load - loads[0]) / (loads[1] - loads[0]) if loads[1] != loads[0] else 1.0
    return float(ends[0] + np.clip(share, 0.0, 1.0) * (ends[1] - ends[0]))


def _mark_peak(axes, curves, places, size, words) -> None:
    """A ring about the largest reaction, and its value and place above (or below) all curves."""
    largest = max(np.abs(values).max() for _, _, values in curves)
    alike = [values / size for _, _, values in curves if np.abs(values).max() > (1.0 - 1e-3) * largest]
    values = max(alike, key=max)  # of opposite reactions the one that points up
    peak = int(np.argmax(np.abs(values)))
    up = values[peak] >= 0.0
    axes.plot(places[peak], values[peak], "o", markersize=13, markerfacecolor="none", markeredgecolor=WARNING,
              markeredgewidth=1.8, zorder=5, label="peak")  # fmt: skip
    low, high = axes.get_ylim()
    axes.set_ylim((low, high + 0.09 * (high - low)) if up else (low - 0.09 * (high - low), high))
    left, right = axes.get_xlim()
    share = (places[peak] - left) / (right - left) if right > left else 0.5
    share = 1.0 - share if np.abs(places.min()) > places.max() and places.min() < 0.0 else share
    unit = axes.get_ylabel().split("[")[-1].rstrip("]")
    text = f"{number(abs(values[peak]))} {unit} {words.format(number(places[peak]))}"
    axes.annotate(text, (places[peak], values[peak]), xytext=(0, 13 if up else -13), textcoords="offset points",
                  ha="left" if share < 0.25 else "right" if share > 0.75 else "center",
                  va="bottom" if up else "top", fontsize=12, fontweight="bold", color=WARNING, zorder=6,
                  bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.5})  # fmt: skip


def has_reactions(results) -> bool:
    """Whether the history has accepted steps with reactions."""
    load = results.history.get("load_factor", [])
    return bool(load) and isinstance(load[0], float) and bool(reactions(results.history, len(load)))


def reactions(history, count):
    """Per support set: name, dominating component (0, 1, 2) and its values [N]."""
    sets = {}
    for column, values in history.items():
        if column.startswith("reaction_") and column[9:10] in AXES and column[10:11] == ":":
            if len(values) == count and all(isinstance(value, float) for value in values):
                sets.setdefault(column[11:], {})[AXES.index(column[9])] = np.nan_to_num(np.array(values))
    curves = []
    for name, components in sets.items():
        axis = max(components, key=lambda component: np.abs(components[component]).max())
        curves.append((name, axis, components[axis]))
    return curves


def _draw_reactions(axes, curves, abscissa, size, all_curves=None):
    """Lines with a marker per accepted step; every line starts at the unloaded state."""
    names = [name for name, _, _ in all_curves or curves]
    for name, axis, values in curves:
        style = names.index(name)
        x, y = abscissa(name), values / size
        if x[0] != 0.0:
            x, y = np.concatenate([[0.0], x]), np.concatenate([[0.0], y])
        axes.plot(x, y, color=LINES[style % len(LINES)], linewidth=1.8, marker=MARKERS[style % len(MARKERS)],
                  markersize=np.clip(260 / len(x), 2.5, 7), markeredgecolor="white", markeredgewidth=0.7,
                  label=f"{name}, {AXES[axis]} component", zorder=3)  # fmt: skip


def _probe(results):
    """Largest component of the case's first probe: label, values, no restriction of sets, sign."""
    columns = {
        name: np.array(values) for name, values in results.history.items()
        if name not in HISTORY_COLUMNS and not name.startswith("reaction_")
        and values and isinstance(values[0], float) and np.isfinite(values).all()
    }  # fmt: skip
    if not columns:
        return None
    fields = {probe.get("name"): probe.get("field", "displacement") for probe in results.case.get("probe", [])}

    def owner(column):
        """Name of the probe that a column (`tip`, `tip_x`, `x:tip`, `tip:x`) belongs to."""
        return max((name for name in fields if name and name in column), key=len, default=column)

    first = owner(next(iter(columns)))
    own = [column for column in columns if owner(column) == first]
    column = max(own, key=lambda name: np.abs(columns[name]).max())
    values = columns[column]
    if not np.abs(values).max() > 0.0:
        return None
    kind = fields.get(first, "")
    units = {"displacement": "[m]", "force": "[N]", "energy_density": "[J/m³]"}
    pretty = column.replace("_", " ").replace(":", " ")
    return f"probe {pretty}: mean {kind.replace('_', ' ')} {units.get(kind, '')}".rstrip(": "), values, None, 1.0


def _moved_support(results, curves):
    """Mean displacement of the support that moved most, in the direction of its reaction.

    Label, values at the accepted steps, the set's name, and the sign that makes the curve rise.
    """
    steps = [int(step) for step in results.history.get("step", [])]
    if not steps or set(steps) - set(results.step_numbers):
        return None  # fields of some steps were not written
    if len(steps) * results.reference.size > MOST_VALUES_READ:
        return None
    axes = {name: axis for name, axis, _ in curves if len(results.sets.get(name, ()))}
    means = {name: [] for name in axes}
    for number_of_step in steps:
        displacement = results.displacement(number_of_step)
        for name, axis in axes.items():
            means[name].append(displacement[results.sets[name], axis].mean())
    if not means:
        return None
    name = max(means, key=lambda key: abs(means[key][-1]))
    values = np.array(means[name])
    if not np.abs(values).max() > 0.0:
        return None
    sign = -1.0 if values[-1] < 0.0 else 1.0
    return f"displacement of set “{name}” in {AXES[axes[name]]} [m]", sign * values, name, sign


# ---------------------------------------------------------------------------------------- convergence


def has_iterations(results) -> bool:
    return any(len(residuals) > 1 for _, _, residuals in _searches(results))


def _searches(results):
    """The searches for equilibrium: step, whether it was accepted, relative residuals by iteration.

    A step that was cut appears several times; its last search is the one that counts.
    """
    table = results.iterations
    columns = [table.get(name, []) for name in ("step", "iteration", "relative_residual")]
    searches = []
    for step, iteration, residual in zip(*columns):
        if not all(isinstance(value, float) for value in (step, iteration, residual)):
            continue
        if not searches or searches[-1][0] != step or iteration <= searches[-1][1]:
            searches.append([int(step), iteration, []])
        searches[-1][1] = iteration
        searches[-1][2].append(residual if np.isfinite(residual) else np.nan)
    last = {step: number for number, (step, _, _) in enumerate(searches)}
    accepted = {int(step) for step in results.history.get("step", [])}
    return [(step, last[step] == number and step in accepted, np.array(residuals))
            for number, (step, _, residuals) in enumerate(searches)]  # fmt: skip


def observed_order(residuals: np.ndarray) -> float | None:
    """Order p of r_new ~ r_old^p, from the last three residuals above round-off; None if unclear.

    p = log(r_{k+1} / r_k) / log(r_k / r_{k-1}); the residuals must fall, and by at least half.
    """
    usable = residuals[: np.argmax(~(residuals > ROUND_OFF))] if not (residuals > ROUND_OFF).all() else residuals
    for end in range(len(usable), 2, -1):
        before, now, after = usable[end - 3 : end]
        if after < now < 0.5 * before:
            return float(np.log(after / now) / np.log(now / before))
    return None


def draw_convergence(results):
    """Relative residuals against iterations, and each against the one before, whose slope is the order."""
    searches = [search for search in _searches(results) if len(search[2]) > 1]
    accepted = [search for search in searches if search[1]]
    failed = [search for search in searches if not search[1]]
    chosen = accepted or failed
    if len(chosen) > MOST_STEPS:
        chosen = [chosen[i] for i in np.unique(np.linspace(0, len(chosen) - 1, MOST_STEPS).round().astype(int))]
    failed = [] if not accepted else failed[-2:]
    loads = dict(zip(map(int, results.history.get("step", [])), results.history.get("load_factor", [])))
    shades = colormaps["viridis"](np.linspace(0.05, 0.82, max(len(chosen), 2)))

    figure = new_figure(16.0, 7.4)
    left = figure.add_axes([0.07, 0.115, 0.50, 0.71])
    right = figure.add_axes([0.655, 0.115, 0.325, 0.71])
    for axes in (left, right):
        axes.set_yscale("log")
    right.set_xscale("log")

    positive = np.concatenate([residuals[residuals > 0.0] for _, _, residuals in chosen + failed] or [[1.0]])
    floor = 0.1 * min(positive.min(initial=1.0), 1e-15)
    orders = []
    for colour, (step, _, residuals) in zip(shades, chosen):
        order = observed_order(residuals[1:])  # iteration 0 is the jump of the load, not Newton's
        orders += [] if order is None else [order]
        where = f"load {number(loads[step])}" if step in loads else f"step {step}"
        text = "" if order is None else f",  p = {order:.2f}"
        _draw_search(left, right, residuals, floor, color=colour, label=where + text)
    for place, (step, _, residuals) in enumerate(failed):
        label = "search that failed" if place == 0 else None
        _draw_search(left, right, residuals, floor, color=WARNING, linestyle="--", label=label)
    zeros = [np.argmax(residuals == 0.0) for _, _, residuals in chosen if (residuals == 0.0).any()]
    if zeros:
        left.annotate("exactly zero", (min(zeros), floor), xytext=(-10, 0), textcoords="offset points",
                      fontsize=11, ha="right", va="center", color=FAINT)  # fmt: skip
    _draw_tolerance(left, results)
    _draw_slopes(right, chosen, floor)
    for axes in (left, right):
        low, high = axes.get_ylim()
        if low < ROUND_OFF:
            axes.axhspan(low, ROUND_OFF, color="#f3f4f6", zorder=0)
            axes.annotate("round-off", (1.0, ROUND_OFF), xycoords=("axes fraction", "data"), xytext=(-6, -6),
                          textcoords="offset points", ha="right", va="top", fontsize=11, color=FAINT)  # fmt: skip
            axes.set_ylim(low, high)

    left.set_xlabel("iteration")
    left.set_ylabel("relative residual")
    left.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=12))
    left.legend(loc="lower left", fontsize=11.5, title="p: observed order" if orders else None,
                title_fontsize=11.5, alignment="left")  # fmt: skip
    right.set_xlabel("relative residual of one iteration")
    right.set_ylabel("… of the next iteration")
    words = ["convergence of the search for equilibrium"]
    if orders:
        words.append(f"observed order {np.median(orders):.2f} (median)")
    if len(chosen) < len(accepted):
        words.append(f"{len(chosen)} of {number(len(accepted))} steps")
    heading(figure, results, words)
    return figure


def _draw_search(left, right, residuals, floor, **looks):
    """One search in both panels; a residual of exactly zero is an open mark at the floor."""
    shown = np.where(residuals == 0.0, floor, residuals)
    many = len(residuals) > 60
    marks = {} if many else {"marker": "o", "markersize": 6, "markeredgecolor": "white", "markeredgewidth": 0.7}
    left.plot(shown, linewidth=1.2 if many else 1.7, zorder=3, **marks, **looks)
    right.plot(shown[:-1], shown[1:], linewidth=1.2, zorder=3, **marks, **{**looks, "label": None})
    zeros = np.flatnonzero(residuals == 0.0)
    if len(zeros):
        left.plot(zeros, shown[zeros], "o", markersize=8, markerfacecolor="white",
                  markeredgecolor=looks["color"], zorder=4)  # fmt: skip


def _draw_tolerance(axes, results):
    tolerance = results.case.get("solver", {}).get("relative_tolerance")
    if isinstance(tolerance, float) and tolerance > 0.0:
        axes.axhline(tolerance, color=FAINT, linewidth=1.2, linestyle=(0, (2, 3)), zorder=2)
        # Below its line: "round-off" may stand right above.
        axes.annotate(f"tolerance {tolerance:.0e}", (1.0, tolerance), xycoords=("axes fraction", "data"),
                      xytext=(-4, -4), textcoords="offset points", ha="right", va="top",
                      fontsize=11, color=FAINT)  # fmt: skip


def _draw_slopes(axes, chosen, floor):
    """Guides of slope 1 (linear) and 2 (quadratic) through the start of the last search."""
    pairs = [(a, b) for _, _, residuals in chosen for a, b in zip(residuals, residuals[1:])
             if a > ROUND_OFF and b > 0.0]  # fmt: skip
    if not pairs:
        return
    start, reached = max(pairs)
    low, high = min(a for a, _ in pairs) / 3.0, start * 3.0
    bottom = max(min(b for _, b in pairs) / 30.0, 0.3 * floor)
    x = np.geomspace(low, high, 50)
    for slope, name in ((2.0, "slope 2: quadratic"), (1.0, "slope 1: linear")):
        y = reached * (x / start) ** slope
        seen = (y >= bottom) & (y <= 30 * max(b for _, b in pairs))
        axes.plot(x[seen], y[seen], color=FAINT, linewidth=1.2, linestyle="--" if slope > 1 else ":", zorder=2,
                  label=name)  # fmt: skip
    axes.legend(loc="upper left", fontsize=11.5)
    axes.set_xlim(low, high)
