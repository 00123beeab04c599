"""The table of a sweep: a row per combination, from the results folders (docs/results.md)."""

import csv
import io
import json
import math
from pathlib import Path

from own_files import TABLE, write_own

FIGURES = [
    "steps", "newton_iterations", "relaxation_iterations", "factorisations", "broken_bonds", "max_damage",
    "max_displacement",
]  # fmt: skip
ENERGIES = {
    "energy_stored": "stored", "energy_dissipated": "dissipated", "energy_drained": "drained",
    "external_work": "external_work", "balance_error": "balance_error",
}  # fmt: skip
FIELD_UNITS = {
    "displacement": "m", "opening": "m", "crack_length": "m", "crack_begin": "m", "crack_end": "m", "crack_angle": "°",
    "force": "N", "energy_density": "J/m³",
    "first_piola_stress": "Pa", "stress": "Pa", "von_mises": "Pa", "principal_stress": "Pa",
}  # fmt: skip
COSTS = ["seconds_total", "peak_memory_bytes"]
DRIVEN = tuple(f"{kind}_{axis}:" for kind in ("displacement", "force") for axis in "xyz")  # columns of the history

def figures(folder: Path) -> dict:
    """The columns that come from a results folder; empty if its run has not ended."""
    try:
        summary = json.loads((folder / "summary.json").read_bytes())
    except (OSError, ValueError):
        return {}
    row = {name: summary.get(name, "") for name in FIGURES}
    if summary.get("steps") or summary.get("max_displacement"):  # the zeros of a body at rest are no results
        row |= {column: summary.get("energy", {}).get(name, "") for column, name in ENERGIES.items()}
        row |= {f"peak_reaction:{name}": peak for name, peak in _peak_reactions(folder).items()}
        for name, reaction in summary.get("reactions", {}).items():
            row[f"final_reaction:{name}"] = math.hypot(*reaction)
        for name, value in summary.get("probes", {}).items():
            row |= _probe_columns(name, value)
    row["seconds_total"] = summary.get("seconds", {}).get("total", "")
    row["peak_memory_bytes"] = summary.get("peak_memory_bytes", "")
    return row


def _probe_columns(name: str, value) -> dict:
    """A scalar probe is one column, a vector one per component. Displacements and loads of what is driven are none."""
    if name.startswith(DRIVEN):
        return {}
    if not isinstance(value, list):
        return {f"probe:{name}": value}
    return {f"probe:{name}_{axis}": component for axis, component in zip("xyz", value)}


def _peak_reactions(folder: Path) -> dict[str, float]:
    """Largest norm of each support set's reaction over all accepted steps [N]."""
    peaks: dict[str, float] = {}
    try:
        with open(folder / "history.csv", newline="", encoding="utf-8") as file:
            for row in csv.DictReader(file):
                for column in row:
                    kind, _, name = column.partition(":")
                    if kind == "reaction_x":
                        norm = math.hypot(*(float(row[f"reaction_{axis}:{name}"]) for axis in "xyz"))
                        peaks[name] = max(peaks.get(name, 0.0), norm)
    except OSError:
        pass
    return peaks


def quantities(rows: list[dict]) -> dict[str, list[float]]:
    """The refined quantities of rows by column: reactions, probes, energies, displacement.

    Components of a vector that are round-off relative to its others are left out, as are columns of zeros.
    """
    names = [name for name in rows[0] if name.partition(":")[0] in ("peak_reaction", "final_reaction", "probe")]
    names += ["energy_stored", "energy_dissipated", "max_displacement"]
    found = {}
    for name in names:
        values = [row.get(name, "") for row in rows]
        if all(isinstance(value, (int, float)) and math.isfinite(value) for value in values):
            found[name] = [float(value) for value in values]
    size = {name: max(map(abs, values)) for name, values in found.items()}
    vector = lambda name: name[:-2] if name[-2:] in ("_x", "_y", "_z") else name
    largest = {name: max(size[other] for other in found if vector(other) == vector(name)) for name in found}
    return {name: values for name, values in found.items() if size[name] > 1e-6 * largest[name]}


def write_table(path: Path, keys: list[str], rows: list[dict]) -> None:
    """Replaces the table by a complete new one in one rename.

    A set or probe that exists in some combinations only still gets a column.
    """
    fixed = [*keys, "status", "exit_code", *FIGURES, *ENERGIES]
    found = dict.fromkeys(column for row in rows for column in row)
    between = [column for column in found if column not in [*fixed, *COSTS]]
    order = ("peak_reaction", "final_reaction", "probe")
    between.sort(key=lambda column: order.index(column.partition(":")[0]))
    text = io.StringIO(newline="")
    table = csv.DictWriter(text, [*fixed, *between, *COSTS], restval="", lineterminator="\n")
    table.writeheader()
    table.writerows(rows)
    write_own(path, text.getvalue().encode("utf-8", "surrogateescape"), TABLE)
