"""The top of a run's page: how it ended, its size, and what the program warned of."""

from ..pictures.results_folder import ResultsFile
from ..pictures.units import LENGTHS, number, unit_for
from .markup import escaped, items, paragraph, table

ENDINGS = {
    "completed": "completed",
    "not_converged": "did not converge",
    "inconsistent": "stopped: a state violates a balance",
    "interrupted": "was interrupted",
    "failed": "failed: the machine failed the run",
    "running": "is still going",
}


def head(results, status: str) -> str:
    reason = str(results.summary.get("reason", ""))
    kind = "completed" if status == "completed" else "other"
    ending = f"The run {ENDINGS.get(status, status)}"
    facts = "".join(f"<li>{escaped(fact)}</li>" for fact in _facts(results))
    return (f'<h1>{escaped(results.title)}</h1>\n<p class="ending {kind}">{escaped(ending)}{escaped(": " + reason if reason else ".")}</p>\n'
            f'<ul class="facts">{facts}</ul>')  # fmt: skip


def _facts(results) -> list[str]:
    summary = results.summary
    steps = sum(step > 0 for step in results.history.get("step", []))
    steps = summary.get("steps") if results.is_of_motion else steps
    unit, size = unit_for(results.spacing, LENGTHS)
    known = [
        f"{results.dimension}D",
        f"{number(len(results.volume))} points",
        f"spacing {number(results.spacing / size)} {unit}",
    ]
    known += [f"{number(steps)} accepted step{'s' * (steps != 1)}"] if steps is not None else []
    for name in ("bonds", "triangles", "tetrahedra", "broken_bonds"):
        if isinstance(summary.get(name), (int, float)) and summary[name]:
            known.append(f"{name.replace('_', ' ')}: {number(summary[name])}")
    seconds = summary.get("seconds", {})
    if isinstance(seconds, dict) and isinstance(seconds.get("total"), (int, float)):
        known.append(f"{number(seconds['total'], 3)} s")
    return known


def preflight(results) -> str:
    """Facts and warnings of the preflight."""
    told = results.summary.get("warnings", [])
    told = [str(sentence) for sentence in told] if isinstance(told, list) else []
    none = "" if told or not results.summary else paragraph("The program gave no warning.")
    facts = [line.partition(": ")[::2] for line in _preflight_text(results).splitlines()]
    return items(told, "warnings") + none + (table(["", ""], facts) if facts else "")


def _preflight_text(results) -> str:
    """Facts as `check` prints them; older folders have none."""
    with ResultsFile(results.path) as file:
        return file.text("case/preflight") if "case/preflight" in file else ""
