"""What holds and drives a body, from the tables of its resolved case."""

import re
from dataclasses import dataclass, field

import numpy as np

AXES = "xyz"
TABLES = {  # of the case: words for its entries
    "support": "support", "rigid": "rigid set", "roller": "roller", "constraint": "constraint", "load": "load",
    "foundation": "foundation", "obstacle": "obstacle", "symmetry": "plane of symmetry", "period": "period", "eigenstrain": "eigenstrain",
    "initial": "initial state", "absorbing": "absorbing layer", "control": "control",
}  # fmt: skip
PLACES = ("set", "side", "name", "axis")  # keys that say where an entry acts
# By table: keys with a value per component.
VECTORS = {"support": ("displacement",), "load": ("body_force", "total_force", "gravity", "traction")}
LINEAR = re.compile(r"\s*([+-]?[0-9.]+(?:[eE][+-]?[0-9]+)?)?\s*(-)?\s*\*?\s*\b(?:load|t)\b\s*")


@dataclass
class Condition:
    """One entry: where it acts, what it holds, and where it drives the body.

    points     numbers of the points; none if it has no place
    held       axes along which it holds the points
    direction  in which it moves or loads them, or zeros
    """

    words: str
    points: np.ndarray
    held: list[int] = field(default_factory=list)
    direction: np.ndarray | None = None


def conditions(results) -> list[Condition]:
    found = []
    for table, words in TABLES.items():
        for entry in results.tables(table):
            found.append(_condition(results, table, words, entry))
    return found


def _condition(results, table: str, words: str, entry: dict) -> Condition:
    place = next((entry[key] for key in PLACES if entry.get(key)), "")
    values = [f"{key} = {_text(value)}" for key, value in entry.items() if key not in PLACES and value not in ("", [])]
    made = Condition(f"{words} {place}: {', '.join(values)}".replace(" :", ":"), _points(results, entry))
    vector = next((entry[key] for key in VECTORS.get(table, ()) if key in entry), None)
    if isinstance(vector, list):
        columns = ("displacement", "force") if table == "support" else ("force", "displacement")
        names = [[f"{column}_{axis}:{place}" for column in columns] for axis in AXES]
        signs = [_sign(results, value, own) for value, own in zip(vector, names)]
        made.direction = np.array([sign or 0.0 for sign in signs])
        made.held = [axis for axis, sign in enumerate(signs) if table == "support" and sign == 0.0]
    return made


def _text(value) -> str:
    if isinstance(value, list):
        return f"[{', '.join(map(_text, value))}]"
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {_text(own)}" for key, own in value.items()) + "}"
    return f"{value:g}" if isinstance(value, float) else str(value)


def _points(results, entry: dict) -> np.ndarray:
    if (name := str(entry.get("set", ""))) in results.sets:
        return results.sets[name]
    side = str(entry.get("side", ""))
    if len(side) == 2 and side[0] in AXES[: results.dimension] and side[1] in "+-":
        along = results.reference[:, AXES.index(side[0])] * (1.0 if side[1] == "+" else -1.0)
        return np.flatnonzero(along >= along.max() - 0.5 * results.spacing)
    return np.zeros(0, dtype=int)


def _sign(results, value, columns: list[str]) -> float | None:
    """Sign of a prescribed component as the load grows; None if it is free or not known."""
    try:
        return float(np.sign(float(value)))
    except (TypeError, ValueError):
        pass
    if not isinstance(value, str) or value.strip() == "free":
        return None
    if match := LINEAR.fullmatch(value):
        size = float(match[1]) if match[1] else 1.0
        return float(np.sign(-size if match[2] else size))
    for column in columns:
        known = results.numbers(column)
        if known is not None and np.any(known):
            return float(np.sign(known[np.abs(known).argmax()]))
    return None
