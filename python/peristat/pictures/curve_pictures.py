"""Picture of the reactions of a run over load factor and displacement."""

from dataclasses import dataclass

import numpy as np

from .style import FORCES, GHOST, INK, LENGTHS, LINES, WARNING, heading, load_words, new_figure, number, unit_for

SMALL = 1e-6  # share of the largest reaction below which a reaction counts as zero
ALIKE = 0.02  # largest relative difference of the reactions of two supports that are drawn as one
MOST_VALUES_READ = 20_000_000  # limit on the displacement values read to find the motion of the supports
AXES = "xyz"
MARKERS = "osD^vP"
HAND_OVERS = (  # actions of decisions.csv, label, colour and dashes
    ("hand over to relaxation", "hand-over to relaxation", "#b58a1b", (0, (5, 2))),
    ("hand back to newton", "hand-back to Newton's method", "#7a5aa6", (0, (1, 2))),
)


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
    def label(self) -> str:
        if self.is_constraint:
            return ", ".join([f"constraint {self.name}", *self.others])
        return ", ".join([f"{self.name} in {'−' * (self.sign < 0)}{AXES[self.axis]}", *self.others])


@dataclass
class Abscissa:
    """A displacement for the abscissa of the reactions."""

    label: str  # without unit
    values: np.ndarray  # at the accepted steps [m]
    of_set: str | None  # the support whose displacement it is: only that support's reaction is drawn over it


# ------------------------------------------------------------------------------ load and displacement


def draw_load_displacement(results):
    """Reactions of the support sets over the load factor, and over a displacement if one is known.

    Supports with equal or opposite reactions share one curve. Once there is damage, the picture also shows how the
    steps were found, the peak, and the switches between the solvers.
    """
    load = results.numbers("load_factor")
    curves = reactions(results)
    unit, size = unit_for(max(np.abs(curve.values).max() for curve in curves), FORCES, 1.0)
    abscissa = find_abscissa(results, curves)
    control = controlled(results)
    drive, drive_label, drive_words = _what_grows(results, load, control)

    foot = 0.75  # inches for the legend
    height = 7.2 + foot
    bottom, panel_height = (0.115 * 7.2 + foot) / height, 0.71 * 7.2 / height
    figure = new_figure(16.0, height)
    panels = [figure.add_axes([0.075, bottom, 0.40 if abscissa else 0.80, panel_height])]
    _draw_reactions(panels[0], curves, drive, size, curves)
    panels[0].set_xlabel(drive_label)
    if results.is_fractured:
        draw_fracture(panels[0], results, curves, drive, size, drive_words, curves)
    if abscissa:
        label, places, shown, words = abscissa_of(abscissa, curves)
        panels.append(figure.add_axes([0.565, bottom, 0.40, panel_height]))
        _draw_reactions(panels[1], shown, places, size, curves)
        panels[1].set_xlabel(label)
        if results.is_fractured:
            draw_fracture(panels[1], results, shown, places, size, words, curves)
    for axes in panels:
        axes.set_ylabel(f"reaction [{unit}]")
        axes.axhline(0.0, color=GHOST, linewidth=1.2, zorder=1)
        axes.axvline(0.0, color=GHOST, linewidth=1.2, zorder=1)
    handles, labels = panels[0].get_legend_handles_labels()
    figure.legend(handles, [label.replace("$", r"\$") for label in labels], loc="lower center",
                  ncol=min(len(labels), 4), fontsize=12, bbox_to_anchor=(0.52, 0.0), borderaxespad=0.5)  # fmt: skip
    steps = len(load) if results.is_of_motion else sum(step > 0 for step in results.history["step"])
    heading(figure, results, ["reactions of the supports", f"{number(steps)} accepted step{'s' * (steps != 1)}",
                              load_words(load.max(), results.is_of_motion, "up to ") if control is None
                              else f"under control up to {drive_words[3:].format(number(drive.max()))}"])  # fmt: skip
    return figure


def controlled(results) -> np.ndarray | None:
    """The displacement that a control increases while it finds the loads, at the accepted steps [m]."""
    values = results.numbers("control")
    return values if values is not None and np.abs(values).max(initial=0.0) > 0.0 else None


def _what_grows(results, load, control) -> tuple[np.ndarray, str, str]:
    """Values, label and words for the quantity that the run increases: load factor, time, or the controlled
    displacement.

    Where loads are found, a reaction over the load factor would be a straight line of the load over itself.
    """
    if control is not None:
        unit, size = unit_for(np.abs(control).max(), LENGTHS)
        return control / size, f"controlled displacement [{unit}]", f"at {{}} {unit}"
    if results.is_of_motion:
        return load, "time [s]", "at load factor {}"
    if _is_a_displacement(results, load):
        unit, size = unit_for(np.abs(load).max(), LENGTHS)
        return load / size, f"load factor, a displacement [{unit}]", f"at {{}} {unit}"
    return load, "load factor", "at load factor {}"


def _is_a_displacement(results, load) -> bool:
    """Whether a displacement is prescribed as the load factor itself: `displacement = "-load"`."""
    largest = np.abs(load).max(initial=0.0)
    columns = [results.numbers(name) for name in results.history
               if name.startswith(tuple(f"displacement_{axis}:" for axis in AXES))]  # fmt: skip
    return largest > 0.0 and any(values is not None and np.abs(np.abs(values) - np.abs(load)).max() <= 1e-12 * largest
                                 for values in columns)  # fmt: skip


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
    for curve in sorted(found, key=lambda curve: curve.name not in driven):
        slack = ALIKE * curve.values.max()
        twin = next((own for own in kept if own.axis == curve.axis and own.is_constraint == curve.is_constraint
                     and np.abs(own.values - curve.values).max() <= slack), None)  # fmt: skip
        if twin is None:
            kept.append(curve)
        else:
            twin.others.append(f"{curve.name} {'the same' if twin.sign == curve.sign else 'opposite'}")
    return kept


def support_sets(results) -> list[str]:
    """Names of the sets whose reactions are in the history."""
    return [column.partition(":")[2] for column in results.history if column.startswith("reaction_x:")]


def has_reactions(results) -> bool:
    """Whether the history has accepted steps with reactions; a body at rest has none."""
    load = results.numbers("load_factor")
    return load is not None and len(load) > len(results.resting_steps) and bool(reactions(results))


def driven_components(results) -> list[tuple[str, int]]:
    """Sets and components whose displacement the case prescribes and increases with the load."""
    return _varying(results, "support", "displacement")


def _varying(results, table: str, *keys: str) -> list[tuple[str, int]]:
    found = []
    for entry in results.tables(table):
        for key in keys:
            components = entry.get(key)
            for axis, text in enumerate(components[:3] if isinstance(components, list) else []):
                if isinstance(text, str) and "load" in text:
                    found.append((str(entry.get("set", "")), axis))
    return found


# ------------------------------------------------------------------------------- what to draw over


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
    for name, axis in _varying(results, "load", "body_force", "total_force"):
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


def _between_grips(results, driven, name: str, axis: int) -> tuple[str, np.ndarray] | None:
    """Displacement of a driven set relative to another set that is driven the opposite way: words and values."""
    own = _mean_of(results, name, axis)
    for other in (other for other, along in driven if along == axis and other != name) if own else ():
        against = _mean_of(results, other, axis)
        if against is not None and own[1] @ against[1] < 0.0:
            return f"displacement of “{name}” less that of “{other}” in {{}}{AXES[axis]}", own[1] - against[1]
    return None


def _turned(found: tuple[str, np.ndarray], of_set: str | None) -> Abscissa:
    """Values with the sign that makes them grow, so that the axis points to the right."""
    words, values = found
    falls = values[np.argmax(np.abs(values))] < 0.0
    return Abscissa(words.format("−" if falls else ""), -values if falls else values, of_set)


def _probe_of(results, name, axis: int) -> tuple[str, np.ndarray] | None:
    """A probe of the displacement of a set in a component in which it moves: words (with a place for its sign) and
    values."""
    for probe in results.tables("probe"):
        is_mean = "set" in probe and probe.get("statistic", "mean") == "mean"
        if not is_mean or probe["set"] != name or probe.get("field", "displacement") != "displacement":
            continue
        own = str(probe.get("name"))
        values = results.numbers(own if results.dimension == 1 else f"{own}_{AXES[axis]}")
        if values is not None and np.abs(values).max() > 0.0:
            return f"probe {own}: mean displacement of “{name}” in {{}}{AXES[axis]}", values
    return None


def _column_of(results, name: str, axis: int) -> tuple[str, np.ndarray] | None:
    """The displacement of what is driven, from the history: words (with a place for its sign) and values."""
    values = results.numbers(f"displacement_{AXES[axis]}:{name}")
    if values is None or not np.abs(values).max() > 0.0:
        return None
    return f"displacement of “{name}” in {{}}{AXES[axis]}", values


def _loaded(results) -> list[tuple[str, int]]:
    """Names and components with a load, as the history has them."""
    return [(column[len("force_x:") :], axis) for column in results.history
            for axis, letter in enumerate(AXES) if column.startswith(f"force_{letter}:")]  # fmt: skip


def _mean_of(results, name: str, axis: int) -> tuple[str, np.ndarray] | None:
    """Mean displacement of a set at the accepted steps, from the history, else from the fields if all steps have them:
    words (with a place for its sign) and values."""
    if (known := _column_of(results, name, axis)) is not None:
        return known
    steps = [int(step) for step in results.history.get("step", [])]
    if not steps or set(steps) - set(results.step_numbers) - results.resting_steps or not len(results.sets.get(name, ())):
        return None  # the fields of some steps were not written
    if len(steps) * results.reference.size > MOST_VALUES_READ or axis >= results.dimension:
        return None
    members = results.sets[name]
    values = np.array([results.displacement(step)[members, axis].mean() for step in steps])
    return (f"displacement of “{name}” in {{}}{AXES[axis]}", values) if np.abs(values).max() > 0.0 else None


def abscissa_of(abscissa: Abscissa, curves: list[Reaction]):
    """Label, values in a suitable unit, curves to draw and words for a value of a displacement to draw over."""
    shown = [curve for curve in curves if abscissa.of_set in (None, curve.name)] or curves
    length, size = unit_for(np.abs(abscissa.values).max(), LENGTHS)
    return f"{abscissa.label} [{length}]", abscissa.values / size, shown, f"at {{}} {length}"


# --------------------------------------------------------------------------------------- fracture


def draw_fracture(axes, results, curves, places, size, words, all_curves):
    """Marks the steps found by relaxation (open marks), the switches between solvers (lines), and the peak with its
    value.

    places  abscissa of the accepted steps
    words   text for the place of the peak, "at {} mm"
    """
    mark = np.clip(400 / len(places), 3.5, 7)
    for line in axes.get_lines():
        line.set(markersize=mark, markeredgewidth=0.0)
    relaxed = np.array([mode == "relaxation" for mode in results.history.get("mode", [])], dtype=bool)
    if len(relaxed) == len(places) and relaxed.any():
        for curve in curves:
            style = all_curves.index(curve)
            axes.plot(places[relaxed], curve.values[relaxed] / size, linestyle="none",
                      marker=MARKERS[style % len(MARKERS)], markersize=mark, markerfacecolor="white",
                      markeredgecolor=LINES[style % len(LINES)], markeredgewidth=1.2, zorder=4)  # fmt: skip
        for colour, label in ((INK, "Newton's method"), ("white", "relaxation")):
            axes.plot([], [], linestyle="none", marker="o", markersize=7, markerfacecolor=colour,
                      markeredgecolor=INK, markeredgewidth=1.2, label=label)  # fmt: skip
    for action, label, colour, dashes in HAND_OVERS:
        for place, (step, load) in enumerate(hand_overs(results, action)):
            axes.axvline(on_the_way(results, places, step, load), color=colour, linewidth=1.0, linestyle=dashes,
                         zorder=1.5, label=label if place == 0 else None)  # fmt: skip
    _mark_peak(axes, curves, places, size, words)


def hand_overs(results, action: str) -> list[tuple[float, float]]:
    """Step and load factor of the decisions for an action; if there are no decisions, of changes of the mode."""
    table = results.decisions
    if table.get("action"):
        decided = zip(table.get("step", []), table.get("load_factor", []), table["action"])
        return sorted({(step, load) for step, load, taken in decided
                       if taken == action and isinstance(step, float) and isinstance(load, float)})  # fmt: skip
    new = "relaxation" if "relaxation" in action else "newton"
    rows = list(zip(*(results.history.get(name, []) for name in ("mode", "step", "load_factor"))))
    return [(step, load) for (before, _, _), (mode, step, load) in zip(rows, rows[1:]) if before != mode == new]


def on_the_way(results, places, step: float, load: float) -> float:
    """Abscissa of a load factor between a step and the accepted step before it."""
    after = min(int(np.searchsorted(results.history["step"], step)), len(places) - 1)
    loads = np.concatenate([[0.0], results.history["load_factor"]])[after : after + 2]
    ends = np.concatenate([[0.0], places])[after : after + 2]
    share = (load - loads[0]) / (loads[1] - loads[0]) if loads[1] != loads[0] else 1.0
    return float(ends[0] + np.clip(share, 0.0, 1.0) * (ends[1] - ends[0]))


def _mark_peak(axes, curves, places, size, words) -> None:
    """A ring around the largest reaction, and its value and place above all curves."""
    values = max((curve.values for curve in curves), key=np.max) / size
    peak = int(np.argmax(values))
    axes.plot(places[peak], values[peak], "o", markersize=13, markerfacecolor="none", markeredgecolor=WARNING,
              markeredgewidth=1.8, zorder=5, label="peak")  # fmt: skip
    low, high = axes.get_ylim()
    axes.set_ylim(low, high + 0.09 * (high - low))
    left, right = axes.get_xlim()
    share = (places[peak] - left) / (right - left) if right > left else 0.5
    unit = unit_for(size, FORCES, 1.0)[0]
    text = f"{number(values[peak])} {unit} {words.format(number(places[peak]))}"
    axes.annotate(text, (places[peak], values[peak]), xytext=(0, 13), textcoords="offset points",
                  ha="left" if share < 0.25 else "right" if share > 0.75 else "center",
                  va="bottom", fontsize=12, fontweight="bold", color=WARNING, zorder=6,
                  bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85, "pad": 1.5})  # fmt: skip


def _draw_reactions(axes, curves, places, size, all_curves):
    """Lines with a marker per accepted step; every line starts at the unloaded state."""
    for curve in curves:
        style = all_curves.index(curve)
        x, y = places, curve.values / size
        if x[0] != 0.0:
            x, y = np.concatenate([[0.0], x]), np.concatenate([[0.0], y])
        axes.plot(x, y, color=LINES[style % len(LINES)], linewidth=1.8, marker=MARKERS[style % len(MARKERS)],
                  markersize=np.clip(260 / len(x), 2.5, 7), markeredgecolor="white", markeredgewidth=0.7,
                  label=curve.label, zorder=3)  # fmt: skip
