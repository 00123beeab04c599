"""The curves of a run, each in units with prefixes."""

import numpy as np

from ..pictures.abscissa import find_abscissa
from ..pictures.reactions import has_reactions, reactions
from ..pictures.units import ENERGIES, FORCES, time_unit, unit_for

ENERGY_COLUMNS = (
    ("stored_energy", "stored"),
    ("kinetic_energy", "kinetic"),
    ("dissipated_energy", "dissipated by damage"),
    ("drained_energy", "drained by relaxation, or released"),
    ("external_work", "external work"),  # on top, dashed: where all of it is stored, one line would hide the other
)
MOST_VALUES = 2000  # of a curve; of a longer one every n-th, and its extremes
LEAST_RESIDUAL = 1e-18


def curve(name: str, title: str, x: str, y: str, series: list[dict], **further) -> dict:
    return {"id": name, "title": title, "x": x, "y": y, "series": series} | further


def line(label: str, x, y, **further) -> dict:
    """A curve of finite numbers; others are gaps."""
    pairs = zip(np.asarray(x, float).tolist(), np.asarray(y, float).tolist())
    known = [(a, b if np.isfinite(b) else None) for a, b in pairs if np.isfinite(a)]
    return {"label": label, "x": [a for a, _ in known], "y": [b for _, b in known]} | further


def curves_of_run(results) -> list[dict]:
    """Load-displacement, energies and convergence, as far as the folder has them."""
    kept = _kept_rows(results)
    found = []
    if has_reactions(results):
        found += _load_displacement(results, kept)
    if (energies := _energies(results, kept)) is not None:
        found.append(energies)
    return found


def _kept_rows(results) -> np.ndarray:
    """Rows of the history that are drawn: all, or every n-th."""
    count = len(results.history.get("step", []))
    return np.unique(np.linspace(0, count - 1, min(count, MOST_VALUES)).astype(int)) if count else np.zeros(0, dtype=int)


def _steps(results, kept) -> list[int]:
    return [int(results.history["step"][row]) for row in kept]


def _over(results) -> tuple[str, np.ndarray]:
    """Label and values of the abscissa where no displacement is known."""
    load = results.numbers("load_factor")
    if not results.is_of_motion:
        return "load factor", load
    unit, size = time_unit(np.abs(load).max(initial=0.0))
    return f"time [{unit}]", load / size


def _load_displacement(results, kept) -> list[dict]:
    drawn = reactions(results)
    unit, size = unit_for(max(np.abs(reaction.values).max() for reaction in drawn), FORCES, 1.0)
    label, over = _over(results)
    shown = [line(reaction.label, over[kept], reaction.values[kept] / size) for reaction in drawn]
    title, reaction_label, steps = f"Reactions over {label.partition(' [')[0]}", f"reaction [{unit}]", _steps(results, kept)
    found = [curve("load-curve", title, label, reaction_label, shown, steps=steps)]
    if abscissa := find_abscissa(results, drawn):
        over = abscissa.readable()
        shown = [line(reaction.label, over.values[kept], reaction.values[kept] / size) for reaction in over.curves(drawn)]
        found.insert(0, curve("displacement-curve", "Load and displacement", over.label, reaction_label, shown, steps=steps))
    return found


def _energies(results, kept) -> dict | None:
    if results.numbers("load_factor") is None:
        return None
    label, over = _over(results)
    columns = [(words, results.numbers(name)) for name, words in ENERGY_COLUMNS]
    known = [(words, values) for words, values in columns if values is not None and np.any(values)]
    if not known:
        return None
    unit, size = unit_for(max(np.abs(values).max() for _, values in known), ENERGIES, 1.0)
    if not results.is_of_motion and not (np.diff(over) >= 0.0).all():
        label, over = "step", results.numbers("step")
    dashed = ENERGY_COLUMNS[-1][1]
    shown = [line(words, over[kept], values[kept] / size, dashed=words == dashed) for words, values in known]
    return curve("energy-curve", "Energies", label, f"energy [{unit}]", shown, steps=_steps(results, kept))


def convergence(results) -> dict | None:
    """Relative residuals of all searches, one after another; each begins a new line."""
    columns = [results.iterations.get(name, []) for name in ("step", "iteration", "relative_residual")]
    rows = [row for row in zip(*columns) if all(isinstance(value, float) for value in row)]
    x, y, before = [], [], None
    for number, (step, iteration, residual) in enumerate(rows):
        if before is not None and (step != before[0] or iteration <= before[1]):
            x.append(number - 0.5)
            y.append(np.nan)
        x.append(float(number))
        y.append(residual if residual > LEAST_RESIDUAL else np.nan)
        before = step, iteration
    if len(rows) < 2 or not np.isfinite(y).any():
        return None
    every = -(-len(x) // (2 * MOST_VALUES))
    title = "Residuals of the searches" + (f", every {every}th" if every > 1 else "")
    shown = [line("relative residual", x[::every], y[::every])]
    return curve("convergence-curve", title, "rows of iterations.csv", "relative residual", shown, log=True)
