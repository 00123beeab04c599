"""Picture of the reactions of a run over the displacement, opening or time of what drives it."""

import numpy as np

from .abscissa import Abscissa, abscissas
from .curve_page import curve_page, draw_zeros, settle
from .fracture_marks import draw_fracture
from .reactions import Reaction, reactions
from .style import LINES, points
from .units import FORCES, number, unit_for

MARKERS = "osD^vP"


def draw_load_displacement(results):
    """Reactions of the support sets over what drives the run.

    Under a control and in a motion a second panel shows them over the displacement of what is driven. Supports with
    equal or opposite reactions share one curve. Once there is damage, the picture also shows how the steps were found,
    the peak, and the switches between the solvers.
    """
    load, everything = results.numbers("load_factor"), reactions(results)
    shown = abscissas(results, everything)[:2]
    unit, size = unit_for(max(np.abs(curve.values).max() for curve in everything), FORCES, 1.0)
    figure, panels = curve_page(len(shown))
    for axes, abscissa in zip(panels, shown):
        curves = abscissa.curves(everything)
        draw_reactions(axes, abscissa, curves, size, everything)
        if results.is_fractured:
            draw_fracture(axes, results, abscissa, curves, unit, size, everything)
        axes.set_xlabel(abscissa.label)
        axes.set_ylabel(f"reaction [{unit}]")
        draw_zeros(axes)
    steps = len(load) if results.is_of_motion else sum(step > 0 for step in results.history["step"])
    words = ["reactions of the supports", f"{number(steps)} accepted step{'s' * (steps != 1)}"]
    settle(figure, results, [*words, *part_words(results)], *panels[0].get_legend_handles_labels())
    return figure


def part_words(results) -> list[str]:
    """That a body with planes of symmetry has the forces and openings of a part."""
    planes = [str(table.get("axis")) for table in results.tables("symmetry")]
    share = {1: "half", 2: "quarter", 3: "eighth"}.get(len(planes))
    return [f"of one {share} of the body (symmetry in {', '.join(planes)})"] if share else []


def style_of(curve: Reaction, everything: list[Reaction]) -> tuple[str, str]:
    """Colour and mark of a reaction, the same in all panels."""
    place = everything.index(curve)
    return LINES[place % len(LINES)], MARKERS[place % len(MARKERS)]


def draw_reactions(axes, abscissa: Abscissa, curves: list[Reaction], size: float, everything: list[Reaction]) -> None:
    """Lines with a mark per accepted step; every line starts at the unloaded state."""
    for curve in curves:
        colour, mark = style_of(curve, everything)
        x, y = abscissa.values, curve.values / size
        if x[0] != 0.0:
            x, y = np.concatenate([[0.0], x]), np.concatenate([[0.0], y])
        axes.plot(x, y, color=colour, marker=mark, markersize=points(np.clip(260 / len(x), 2.5, 7)),
                  markeredgecolor="white", markeredgewidth=points(0.7), label=curve.label, zorder=3)  # fmt: skip
