"""What curves are drawn over: the time, the opening under control, or the displacement of what is driven.

The load factor remains if no such quantity is known: it is a number of the case file without a meaning of its own, and
a reaction over the loads that it scales is a straight line.
"""

from dataclasses import dataclass, replace

import numpy as np

from .reactions import AXES, Reaction, driven_components, varying
from .units import LENGTHS, load_axis, number, time_unit, unit_for

MOST_VALUES_READ = 20_000_000  # limit on the displacement values read to find the motion of the supports


Found = tuple[str, np.ndarray, int | None]  # words for a displacement, values [m], axis (None: a sum of several)


@dataclass
class Abscissa:
    """A quantity for the abscissa, in its unit once it is `readable`."""

    label: str  # without unit until it is readable
    values: np.ndarray  # at the accepted steps [m, s or 1]
    of_set: str | None = None  # the support whose displacement it is: only that support's reaction is drawn over it
    unit: str = ""
    kind: str = "displacement"  # or "time", "load factor"

    def readable(self) -> "Abscissa":
        """The same in a unit that suits its values."""
        largest = float(np.abs(self.values).max(initial=0.0))
        if self.kind == "load factor":
            label, size = load_axis(self.values)
            return replace(self, label=label, values=self.values / size)
        unit, size = time_unit(largest) if self.kind == "time" else unit_for(largest, LENGTHS)
        return replace(self, label=f"{self.label} [{unit}]", values=self.values / size, unit=unit)

    def words(self, value: float) -> str:
        """A value as words: "at 0.25 mm"."""
        return f"at {'load factor ' * (self.kind == 'load factor')}{number(value)}{f' {self.unit}' if self.unit else ''}"

    def curves(self, curves: list[Reaction]) -> list[Reaction]:
        """The reactions to draw over it."""
        return [curve for curve in curves if self.of_set in (None, curve.name)] or curves

    @property
    def grows(self) -> bool:
        return bool((np.diff(self.values) >= 0.0).all() and self.values[0] >= 0.0)


def abscissas(results, curves: list[Reaction]) -> list[Abscissa]:
    """The quantities to draw the run's curves over, readable, the most telling first; at least one."""
    load = results.numbers("load_factor")
    found = []
    if (controlled := control(results)) is not None:
        found.append(controlled)
    if (displacement := find_abscissa(results, curves)) is not None:
        found.append(displacement)
    if results.is_of_motion:
        found.insert(0, Abscissa("time", load, kind="time"))
    return [one.readable() for one in found or [Abscissa("load factor", load, kind="load factor")]]


# ------------------------------------------------------------------------------------------ control


def control(results) -> Abscissa | None:
    """The displacement that a control increases while it finds the loads."""
    values = results.numbers("control")
    if values is None or not np.abs(values).max(initial=0.0) > 0.0:
        return None
    return Abscissa(control_words(results.tables("control")), values)


def control_words(tables: list[dict]) -> str:
    """What is controlled: the opening between two sets, or the displacement of one."""
    terms = []
    for table in tables:
        weights = table.get("weights")
        if not isinstance(weights, list):
            return "controlled displacement"
        terms += [(str(table.get("set", "")), axis, weight) for axis, weight in enumerate(weights[:3]) if weight]
    if any(weight not in (1, -1) for _, _, weight in terms):
        return "controlled displacement"
    if len(terms) == 1:
        name, axis, weight = terms[0]
        return f"controlled displacement of “{name}” in {'−' * (weight < 0)}{AXES[axis]}"
    if len(terms) == 2 and terms[0][1] == terms[1][1] and terms[0][2] == -terms[1][2]:
        (more, axis, _), (less, *_) = sorted(terms, key=lambda term: -term[2])
        return f"controlled opening, {AXES[axis]} of “{more}” less that of “{less}”"
    return "controlled displacement"


# ------------------------------------------------------------------------------- driven displacement


def find_abscissa(results, curves: list[Reaction]) -> Abscissa | None:
    """The displacement to draw over; None if none is known.

    It is the displacement of the driven support with the largest reaction, in its driven component: from the history,
    in older folders from a probe of it, else from the fields. If loads drive the body: the displacement of the loaded
    set in the component of the load, else any probe of a displacement. The case says which support is driven; without
    it, the support that moves most is used.
    """
    shown = {(curve.name, curve.axis) for curve in curves}
    driven = driven_components(results)
    for name, axis in sorted(driven, key=lambda entry: entry not in shown):
        found = (_between_grips(results, driven, name, axis) or _column_of(results, name, axis)
                 or _probe_of(results, name, axis) or _mean_of(results, name, axis))  # fmt: skip
        if found is not None:
            return _turned(found, name if name in {curve.name for curve in curves} else None)
    for name, axis in varying(results, "load", "body_force", "total_force"):
        found = _column_of(results, name, axis) or _probe_of(results, name, axis)
        if found is not None:
            return _turned(found, None)
    loaded = [_column_of(results, *column) for column in _loaded(results)]
    loaded = [entry for entry in loaded if entry is not None]
    if loaded:
        return _turned(max(loaded, key=lambda entry: np.abs(entry[1]).max()), None)
    moved = [] if driven else [_mean_of(results, curve.name, curve.axis) for curve in curves]
    known = [(found, curve.name) for found, curve in zip(moved, curves) if found is not None]
    if known:
        return _turned(*max(known, key=lambda entry: np.abs(entry[0][1]).max()))
    found = [_probe_of(results, probe.get("set"), axis)
             for probe in results.tables("probe") for axis in range(results.dimension)]  # fmt: skip
    found = [entry for entry in found if entry is not None]
    return _turned(max(found, key=lambda entry: np.abs(entry[1]).max()), None) if found else None


def _between_grips(results, driven, name: str, axis: int) -> Found | None:
    """How far a driven set and another one, which is driven the opposite way, part, in which direction."""
    own = _mean_of(results, name, axis)
    for other in (other for other, along in driven if along == axis and other != name) if own else ():
        against = _mean_of(results, other, axis)
        if against is None or own[1] @ against[1] >= 0.0:
            continue
        parted, (one, two) = own[1] - against[1], (name, other)
        if parted[np.argmax(np.abs(parted))] < 0.0:
            parted, (one, two) = -parted, (other, name)
        return f"displacement of “{one}” less that of “{two}”", parted, axis
    return None


def _turned(found: Found, of_set: str | None) -> Abscissa:
    """Values with the sign that makes them grow, so that the axis points to the right."""
    words, values, axis = found
    falls = bool(values[np.argmax(np.abs(values))] < 0.0)
    label = f"{words} in {'−' * falls}{AXES[axis]}" if axis is not None else "minus the " * falls + words
    return Abscissa(label, -values if falls else values, of_set)


def _probe_of(results, name, axis: int) -> Found | None:
    """A probe of the displacement of a set in a component in which it moves: its words, values and
    axis."""
    for probe in results.tables("probe"):
        is_mean = "set" in probe and probe.get("statistic", "mean") == "mean"
        if not is_mean or probe["set"] != name or probe.get("field", "displacement") != "displacement":
            continue
        own = str(probe.get("name"))
        values = results.numbers(own if results.dimension == 1 else f"{own}_{AXES[axis]}")
        if values is not None and np.abs(values).max() > 0.0:
            return f"probe {own}: mean displacement of “{name}”", values, axis
    return None


def _column_of(results, name: str, axis: int) -> Found | None:
    """The displacement of what is driven, from the history: its words, values and axis."""
    values = results.numbers(f"displacement_{AXES[axis]}:{name}")
    if values is None or not np.abs(values).max() > 0.0:
        return None
    if any(table.get("name") == name for table in results.tables("constraint")):
        return f"displacement of the constraint “{name}”", values, None
    return f"displacement of “{name}”", values, axis


def _loaded(results) -> list[tuple[str, int]]:
    """Names and components with a load, as the history has them."""
    return [(column[len("force_x:") :], axis) for column in results.history
            for axis, letter in enumerate(AXES) if column.startswith(f"force_{letter}:")]  # fmt: skip


def _mean_of(results, name: str, axis: int) -> Found | None:
    """Mean displacement of a set at the accepted steps, from the history, else from the fields if all steps have them:
    its words, values and axis."""
    if (known := _column_of(results, name, axis)) is not None:
        return known
    steps = [int(step) for step in results.history.get("step", [])]
    if not steps or set(steps) - set(results.step_numbers) - results.resting_steps or not len(results.sets.get(name, ())):
        return None  # the fields of some steps were not written
    if len(steps) * results.reference.size > MOST_VALUES_READ or axis >= results.dimension:
        return None
    members = results.sets[name]
    values = np.array([results.displacement(step)[members, axis].mean() for step in steps])
    return (f"displacement of “{name}”", values, axis) if np.abs(values).max() > 0.0 else None


