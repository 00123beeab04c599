"""The tables of a run: decisions, ledger of energies, timings, observed orders."""

import numpy as np

from ..pictures.units import ENERGIES, number, unit_for
from .markup import Raw, paragraph, table

LEDGER = (  # keys of summary.json, words, sign in the balance
    ("external_work", "work of supports and loads", "+"),
    ("numerical_work", "numerical work of relaxation", "+"),
    ("stored", "stored", "−"),
    ("dissipated", "dissipated by damage", "−"),
    ("drained", "drained by relaxation, or released", "−"),
    ("kinetic", "kinetic", "−"),
    ("balance_error", "what is left over: the balance error", "="),
)
TIMES = (("assembly", "assembly"), ("linear", "linear systems"), ("relaxation", "relaxation"),
         ("neighbourhood", "neighbours"), ("output", "output"), ("checkpoints", "of that, checkpoints"))  # fmt: skip
DECISIONS = (("step", "step"), ("load_factor", "load factor"), ("increment", "increment"), ("outcome", "outcome"),
             ("action", "action"), ("reason", "reason"))  # fmt: skip


def _shown(value) -> str:
    return number(value, 6) if isinstance(value, (int, float)) and np.isfinite(value) else str(value)


def decisions(results) -> str:
    columns = [(name, words) for name, words in DECISIONS if results.decisions.get(name)]
    if not columns:
        return ""
    rows = [[_shown(value) for value in row] for row in zip(*(results.decisions[name] for name, _ in columns))]
    return table([words for _, words in columns], rows, range(min(3, len(columns))))


def ledger(results) -> str:
    """Energies at the last step: what was put in and where it went."""
    energy = dict(results.summary.get("energy", {})) if isinstance(results.summary.get("energy"), dict) else {}
    if results.is_of_motion and (kinetic := results.numbers("kinetic_energy")) is not None:
        energy["kinetic"] = float(kinetic[-1])
    known = [(words, sign, energy[name]) for name, words, sign in LEDGER if isinstance(energy.get(name), (int, float))]
    if not known or not results.history:
        return ""
    unit, size = unit_for(max(abs(value) for _, _, value in known), ENERGIES, 1.0)
    rows = [[sign, words, number(value / size, 5)] for words, sign, value in known]
    return table(["", "at the last step", unit], rows, [2]) + paragraph(_largest_error(results))


def _largest_error(results) -> str:
    error, work = results.numbers("balance_error"), results.numbers("external_work")
    if error is None or work is None or not np.abs(work).max(initial=0.0) > 0.0:
        return ""
    share = 100.0 * np.abs(error).max() / np.abs(work).max()
    return f"In no step is the balance error larger than {number(share, 2)} % of the largest external work."


def timings(results) -> str:
    seconds = results.summary.get("seconds", {})
    total = seconds.get("total") if isinstance(seconds, dict) else None
    if not isinstance(total, (int, float)) or not total > 0.0:
        return ""
    rows = []
    for name, words in (("total", "total"), *TIMES):
        if isinstance(value := seconds.get(name), (int, float)):
            width = 100.0 * min(max(value / total, 0.0), 1.0)
            rows.append([words, number(value, 3), Raw(f'<span class="share" style="width:{width:.1f}px"></span>')])
    summary = results.summary
    words = [f"{what}: {_shown(summary[name])}" for name, what in (
        ("newton_iterations", "iterations of Newton's method"), ("relaxation_iterations", "of relaxation"),
        ("factorisations", "factorisations"), ("linear_iterations", "linear iterations"), ("threads", "threads"),
        ("ranks", "ranks"),
    ) if isinstance(summary.get(name), (int, float))]  # fmt: skip
    memory = summary.get("peak_memory_bytes")
    words += [f"largest memory: {number(memory / 2**20, 3)} MiB"] if isinstance(memory, (int, float)) else []
    remark = (
        "Some of the parts overlap: linear systems of relaxed steps count in both." if seconds.get("relaxation") else ""
    )
    return table(["", "s", ""], rows, [1]) + paragraph(" · ".join(words)) + paragraph(remark)


def orders(results) -> str:
    """Observed orders of Newton's method by step."""
    if not results.orders:
        return ""
    rows = [[step, f"{order:.2f}"] for step, order in sorted(results.orders.items())]
    return paragraph("Observed orders of convergence (2 is quadratic):") + table(["step", "order"], rows, [0, 1])
