"""Words for the state that a picture shows: how far the run is, broken bonds, pieces."""

import numpy as np

from .abscissa import control
from .reactions import AXES
from .units import LENGTHS, number, time_unit, unit_for


def progress(results, step: int, load: float) -> tuple[str, str, str]:
    """How far the run is at a step: name, value and unit of its time, of the cycles of its load, of the controlled
    displacement, or else of the load factor."""
    if results.is_of_motion:
        unit, size = time_unit(results.numbers("load_factor").max())
        return "time", number(load / size), unit
    if (cycles := results.in_history(step, "cycles")) is not None:  # of mode fatigue
        return "cycles", number(cycles), ""
    controlled = control(results)
    if controlled is not None and (value := results.in_history(step, "control")) is not None:
        unit, size = unit_for(np.abs(controlled.values).max(), LENGTHS)
        return f"controlled {'opening' if 'opening' in controlled.label else 'displacement'}", number(value / size), unit
    if _is_a_displacement(results):
        unit, size = unit_for(np.abs(results.numbers("load_factor")).max(), LENGTHS)
        return "prescribed displacement", number(load / size), unit
    return "load factor", number(load), ""


def _is_a_displacement(results) -> bool:
    """Whether a displacement is prescribed as the load factor itself: `displacement = "-load"`."""
    load = results.numbers("load_factor")
    largest = 0.0 if load is None else np.abs(load).max(initial=0.0)
    columns = [results.numbers(name) for name in results.history
               if name.startswith(tuple(f"displacement_{axis}:" for axis in AXES))]  # fmt: skip
    return largest > 0.0 and any(values is not None and np.abs(np.abs(values) - np.abs(load)).max() <= 1e-12 * largest
                                 for values in columns)  # fmt: skip


def step_words(results, step) -> list[str]:
    """Progress and number of a step as facts for a heading."""
    return [" ".join(progress(results, step.number, step.load_factor)).strip(), f"step {step.number}"]


def bond_words(results, step) -> list[str]:
    """Number of bonds broken up to a step as a fact for a heading; nothing if unknown."""
    broken = results.in_history(step.number, "broken_bonds")
    return [] if broken is None else [f"{number(broken)} broken bond{'s' * (broken != 1)}"]


def piece_words(step) -> str:
    """Number of detached pieces, and of their points."""
    pieces = len(np.unique(np.rint(step.fragment[step.floating])))
    count = int(step.floating.sum())
    return f"{number(pieces)} floating piece{'s' * (pieces != 1)}: {number(count)} point{'s' * (count != 1)}"
