"""Picture of the convergence of the searches for equilibrium."""

import numpy as np
from matplotlib import colormaps
from matplotlib.ticker import LogLocator, MaxNLocator, NullFormatter

from .curve_page import curve_page, settle
from .style import FAINT, WARNING, points
from .units import number

# Relative residuals below this value are round-off and show no order of convergence. In slender bodies single
# bonds carry forces that are orders of magnitude larger than the residual's scale, and so is their round-off.
ROUND_OFF = 1e-11
MOST_STEPS = 8  # curves in the picture


def has_iterations(results) -> bool:
    return any(len(residuals) > 1 for _, _, residuals in _searches(results))


def _searches(results):
    """The equilibrium searches: step, whether it was accepted, relative residuals by iteration.

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


def draw_convergence(results):
    """Relative residuals over the iterations, and each over the previous one; the slope of the second curve is the
    order."""
    searches = [search for search in _searches(results) if len(search[2]) > 1]
    accepted = [search for search in searches if search[1]]
    failed = [search for search in searches if not search[1]]
    chosen = accepted or failed
    if len(chosen) > MOST_STEPS:
        chosen = [chosen[i] for i in np.unique(np.linspace(0, len(chosen) - 1, MOST_STEPS).round().astype(int))]
    failed = [] if not accepted else failed[-2:]
    shades = colormaps["viridis"](np.linspace(0.05, 0.82, max(len(chosen), 2)))

    figure, (left, right) = curve_page(2)
    for axes in (left, right):
        axes.set_yscale("log")
    right.set_xscale("log")

    positive = np.concatenate([residuals[residuals > 0.0] for _, _, residuals in chosen + failed] or [[1.0]])
    floor = 0.1 * min(positive.min(initial=1.0), 1e-15)
    for colour, (step, _, residuals) in zip(shades, chosen):
        order = results.orders.get(step)
        text = "" if order is None else f", order {order:.2f}"
        _draw_search(left, right, residuals, floor, color=colour, label=f"step {step}{text}")
    for place, (step, _, residuals) in enumerate(failed):
        label = "search that failed" if place == 0 else None
        _draw_search(left, right, residuals, floor, color=WARNING, linestyle="--", label=label)
    zeros = [np.argmax(residuals == 0.0) for _, _, residuals in chosen if (residuals == 0.0).any()]
    if zeros:
        left.annotate("exactly zero", (min(zeros), floor), xytext=(-points(10), 0), textcoords="offset points",
                      fontsize="small", ha="right", va="center", color=FAINT)  # fmt: skip
    _draw_tolerance(left, results)
    _draw_slopes(right, chosen, floor)
    for axes in (left, right):
        _log_axis(axes.yaxis, *axes.get_ylim())
        low, high = axes.get_ylim()
        if low < ROUND_OFF:
            axes.axhspan(low, ROUND_OFF, color="#f3f4f6", zorder=0)
            is_left = axes is left
            axes.annotate("round-off", (1.0 - is_left, ROUND_OFF), xycoords=("axes fraction", "data"),
                          xytext=(points(6 if is_left else -6), -points(4)), textcoords="offset points",
                          ha="left" if is_left else "right", va="top", fontsize="small", color=FAINT)  # fmt: skip
            axes.set_ylim(low, high)

    left.set_xlabel("iteration")
    left.set_ylabel("relative residual")
    left.xaxis.set_major_locator(MaxNLocator(integer=True, nbins="auto"))
    right.set_xlabel("relative residual of one iteration")
    right.set_ylabel("… of the next iteration")
    words = ["convergence of the search for equilibrium"]
    words += order_words(results.orders, len(accepted))
    if len(chosen) < len(accepted):
        words.append(f"{len(chosen)} of them drawn" if results.orders else f"{len(chosen)} of {number(len(accepted))} increments drawn")
    told = [axes.get_legend_handles_labels() for axes in (left, right)]
    settle(figure, results, words, *(sum(parts, []) for parts in zip(*told)))
    return figure


def order_words(orders: dict[int, float], increments: int) -> list[str]:
    """The range of the observed orders and the number of increments that show one; nothing if none does."""
    if not orders:
        return []
    least, most = (f"{order(orders.values()):.2f}" for order in (min, max))
    told = least if least == most else f"{least} to {most}"
    return [f"order {told} in {number(len(orders))} of {number(max(increments, len(orders)))} increments"]


def _log_axis(axis, low: float, high: float) -> None:
    """Decades as ticks, at least one of them on the axis."""
    axis.set_major_locator(LogLocator(numticks=8))
    axis.set_minor_formatter(NullFormatter())
    if np.floor(np.log10(high)) < np.ceil(np.log10(low)):
        low, high = 10.0 ** np.floor(np.log10(low)), 10.0 ** np.ceil(np.log10(high))
    (axis.axes.set_xlim if axis.axis_name == "x" else axis.axes.set_ylim)(low, high)


def _draw_search(left, right, residuals, floor, **looks):
    """Draws one search in both panels; a residual of exactly zero is an open mark at the floor."""
    shown = np.where(residuals == 0.0, floor, residuals)
    many = len(residuals) > 60
    marks = {} if many else {"marker": "o", "markersize": points(6), "markeredgecolor": "white", "markeredgewidth": points(0.7)}
    left.plot(shown, linewidth=points(1.2 if many else 1.7), zorder=3, **marks, **looks)
    right.plot(shown[:-1], shown[1:], linewidth=points(1.2), zorder=3, **marks, **{**looks, "label": None})
    zeros = np.flatnonzero(residuals == 0.0)
    if len(zeros):
        left.plot(zeros, shown[zeros], "o", markersize=points(8), markerfacecolor="white",
                  markeredgecolor=looks["color"], zorder=4)  # fmt: skip


def _draw_tolerance(axes, results):
    tolerance = results.case.get("solver", {}).get("relative_tolerance")
    if isinstance(tolerance, float) and tolerance > 0.0:
        axes.axhline(tolerance, color=FAINT, linewidth=points(1.2), linestyle=(0, (2, 3)), zorder=2)
        # The label is below its line, because "round-off" may be right above it.
        # It is at the left, where residuals are large.
        axes.annotate(f"tolerance {tolerance:.0e}", (0.0, tolerance), xycoords=("axes fraction", "data"),
                      xytext=(points(4), -points(4)), textcoords="offset points", ha="left", va="top",
                      fontsize="small", color=FAINT)  # fmt: skip


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
        axes.plot(x[seen], y[seen], color=FAINT, linewidth=points(1.2), linestyle="--" if slope > 1 else ":", zorder=2,
                  label=name)  # fmt: skip
    _log_axis(axes.xaxis, low, high)
