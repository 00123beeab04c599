"""Reactions of the supports, as pictures show them: one component for each, positive, equal ones once."""

from dataclasses import dataclass

import numpy as np

SMALL = 1e-6  # share of the largest reaction below which a reaction counts as zero
ALIKE = 0.02  # largest relative difference of the reactions of two supports that are drawn as one
AXES = "xyz"


@dataclass
class Reaction:
    """A component of a support set's reaction, with the sign that makes its largest value positive."""

    name: str  # of the set
    axis: int
    sign: float  # sign that it was multiplied by
    values: np.ndarray  # at the accepted steps [N]
    others: list[str]  # labels of the supports that have the same or the opposite reaction
    is_constraint: bool = False  # a constraint's reaction is one force without direction

    @property
    def own_label(self) -> str:
        if self.is_constraint:
            return f"constraint “{self.name}”"
        return f"“{self.name}” in {'−' * (self.sign < 0)}{AXES[self.axis]}"

    @property
    def label(self) -> str:
        return ", ".join([self.own_label, *self.others])


def reactions(results) -> list[Reaction]:
    """The dominating component of every support set's reaction, without those that are zero.

    Supports with equal or opposite reactions are represented by the one that is moved.
    """
    found = []
    constraints = {str(entry.get("name")) for entry in results.tables("constraint")}
    for name in support_sets(results):
        components = [results.numbers(f"reaction_{axis}:{name}") for axis in AXES]
        known = {axis: values for axis, values in enumerate(components) if values is not None}
        if known:
            axis = max(known, key=lambda component: np.abs(known[component]).max())
            values = known[axis]
            sign = 1.0 if values[np.argmax(np.abs(values))] >= 0.0 else -1.0
            found.append(Reaction(name, axis, sign, sign * values, [], name in constraints))
    largest = max((curve.values.max() for curve in found), default=0.0)
    found = [curve for curve in found if curve.values.max() > SMALL * largest] or found[:1]
    driven = {name for name, _ in driven_components(results)}
    kept = []
    for curve in sorted(found, key=lambda curve: (curve.name not in driven, curve.sign < 0)):
        slack = ALIKE * curve.values.max()
        twin = next((own for own in kept if own.axis == curve.axis and own.is_constraint == curve.is_constraint
                     and np.abs(own.values - curve.values).max() <= slack), None)  # fmt: skip
        if twin is None:
            kept.append(curve)
        else:
            twin.others.append(f"“{curve.name}” {'the same' if twin.sign == curve.sign else 'opposite'}")
    return kept


def support_sets(results) -> list[str]:
    """Names of the sets whose reactions are in the history."""
    return [column.partition(":")[2] for column in results.history if column.startswith("reaction_x:")]


def has_reactions(results) -> bool:
    """Whether the history has accepted steps with reactions; a body at rest has none."""
    load = results.numbers("load_factor")
    return load is not None and len(load) > len(results.resting_steps) and bool(reactions(results))


def driven_components(results) -> list[tuple[str, int]]:
    """Sets and components whose displacement is prescribed and changes: those of the history, in older folders those of
    the case."""
    told = [(column[len("displacement_x:") :], axis) for column in results.history
            for axis, letter in enumerate(AXES) if column.startswith(f"displacement_{letter}:")
            and f"force_{letter}:{column[len('displacement_x:') :]}" not in results.history]  # fmt: skip
    moved = [(name, axis) for name, axis in told if np.any(results.numbers(f"displacement_{AXES[axis]}:{name}"))]
    return moved or varying(results, "support", "displacement")


def varying(results, table: str, *keys: str) -> list[tuple[str, int]]:
    """Sets and components for which a table of the case has an expression of the load."""
    found = []
    for entry in results.tables(table):
        for key in keys:
            components = entry.get(key)
            for axis, text in enumerate(components[:3] if isinstance(components, list) else []):
                if isinstance(text, str) and "load" in text:
                    found.append((str(entry.get("set", "")), axis))
    return found
