"""The picture of a sweep: load curves of all combinations, a field along the midline of the body, and outcomes
(peak reaction, probes) over the varied values."""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.ticker import MaxNLocator
from peristat.pictures.results_folder import NotAResultsFolder, ResultsFolder, read_results_folder
from peristat.pictures.style import GHOST, LINES, WARNING, WIDE, heading, new_figure, own_settings
from peristat.pictures.units import ENERGY_DENSITIES, FORCES, LENGTHS, STRESSES, number, unit_for
from table import FIELD_UNITS

DASHES = ["-", (0, (5, 2)), (0, (1.2, 1.5)), (0, (7, 2, 1.5, 2))]
MOST_LABELS = 24  # entries of the legend
LONGEST_LABEL = 30  # characters
MOST_QUANTITIES = 4  # panels of outcomes
UNITS = {"m": LENGTHS, "N": FORCES, "J/m³": ENERGY_DENSITIES, "Pa": STRESSES}  # units with prefixes


@dataclass
class Curves:
    """The data drawn for one combination."""

    title: str
    label: str
    looks: dict  # colour and line style
    completed: bool
    load: np.ndarray  # load factors of the accepted steps
    reactions: dict[str, np.ndarray]  # norm by support set [N]
    midlines: list["Midline"]  # along each axis
    largest_damage: float  # of all points
    values: tuple[str, ...] = ()  # of the varied keys
    outcomes: dict[str, tuple[float, str]] = field(default_factory=dict)  # number and unit by name


@dataclass
class Midline:
    place: np.ndarray  # along an axis [m], NaN in gaps
    damage: np.ndarray
    displacement: np.ndarray  # magnitude [m]


@dataclass
class _Heading:
    title: str
    status: str = "completed"


@own_settings(WIDE)
def draw_sweep(keys: list[str], values: list[tuple[str, ...]], folders: list[Path], statuses: list[str]):
    """Figure of all combinations that have an accepted step; None if there is none."""
    shown = []
    for own, looks, label, folder, status in zip(values, line_looks(values), labels(keys, values), folders, statuses):
        if status in ("completed", "not_converged"):
            try:
                results = read_results_folder(folder)
            except NotAResultsFolder:
                continue
            if results.step_numbers and results.history.get("load_factor"):
                shown.append(_curves(results, label, looks, status == "completed"))
                shown[-1].values = own
    if not shown:
        return None

    names = _quantities(shown)
    key = main_key(values)
    below = 4.9 if names and len(set(combination[key] for combination in values)) > 1 else 0.0  # inches
    height = 7.2 + below
    bottom, panel_height = (0.83 + below) / height, 5.1 / height
    figure = new_figure(16.0, height)
    left = figure.add_axes([0.065, bottom, 0.325, panel_height])
    right = figure.add_axes([0.46, bottom, 0.325, panel_height])
    _draw_reactions(left, shown)
    _draw_midlines(right, shown)
    _draw_legend(figure, left, shown)
    for place, name in enumerate(names if below else []):
        width = 0.92 / len(names)
        axes = figure.add_axes([0.065 + place * width, 0.8 / height, min(width - 0.065, 0.5), 3.4 / height])
        _draw_outcome(axes, shown, keys, key, name)
    count = len(statuses)
    known = len({name for curves in shown for name in curves.outcomes})
    told = " and ".join(keys)
    words = [f"sweep of {told if len(told) <= 80 else f'{len(keys)} keys'}",
             f"{number(count)} combination{'s' * (count != 1)}"]  # fmt: skip
    for status, remark in (("not_converged", "did not converge"), ("out_of_memory", "out of memory"),
                           ("failed", "failed")):  # fmt: skip
        if status in statuses:
            words.append(f"{statuses.count(status)} {remark}")
    if below and known > len(names):
        words.append(f"{len(names)} of {known} quantities (all are in sweep.csv)")
    heading(figure, _Heading(shown[0].title), words)
    return figure


# ----------------------------------------------------------------------------------------- reading


def _curves(results: ResultsFolder, label: str, looks: dict, completed: bool) -> Curves:
    step = results.step(results.step_numbers[-1])
    magnitude = np.linalg.norm(step.displacement, axis=1)
    midlines = [Midline(*midline(results, axis, step.damage, magnitude)) for axis in range(results.dimension)]
    return Curves(results.title, label, looks, completed, np.array(results.history["load_factor"]),
                  _reactions(results.history), midlines, step.damage.max(), outcomes=_outcomes(results))  # fmt: skip


def _outcomes(results: ResultsFolder) -> dict[str, tuple[float, str]]:
    """Scalar outcomes of a run, with units: its largest reaction, and its probes at the last step."""
    peaks = [values.max() for values in _reactions(results.history).values()]
    outcomes = {"peak reaction": (float(max(peaks)), "N")} if peaks else {}
    fields = {probe.get("name"): probe.get("field", "displacement") for probe in results.tables("probe")}
    told = results.summary.get("probes", {})
    for name, value in told.items() if isinstance(told, dict) else ():
        unit = FIELD_UNITS.get(fields.get(name), "")
        components = {name: value} if not isinstance(value, list) else {
            f"{name} {axis}" if len(value) > 1 else name: component for axis, component in zip("xyz", value)}  # fmt: skip
        for component, number_told in components.items():
            if isinstance(number_told, (int, float)) and np.isfinite(number_told):
                outcomes[component] = (float(number_told), unit)
    return outcomes


def _reactions(history: dict[str, list]) -> dict[str, np.ndarray]:
    """Norm of the reaction at the accepted steps by support set [N]."""
    names = [column.partition(":")[2] for column in history if column.startswith("reaction_x:")]
    return {name: np.linalg.norm([history[f"reaction_{axis}:{name}"] for axis in "xyz"], axis=0) for name in names}


def midline(results: ResultsFolder, axis: int, *fields: np.ndarray) -> list[np.ndarray]:
    """Positions and fields of the points nearest to the line along an axis through the middle of the body.

    Points of layers are not part of the body. Points that are equally near (the two rows beside the line) are
    averaged. NaN marks gaps where the body has no point near the line, as in a hole.
    """
    spacing = results.spacing
    body = np.ones(len(results.volume), dtype=bool)
    for layer in results.case.get("lattice", {}).get("layer", []):
        body[results.sets.get(layer.get("name"), [])] = False
    points = np.flatnonzero(body)
    reference = results.reference[points]
    middle = 0.5 * (reference.min(axis=0) + reference.max(axis=0))
    distance = np.linalg.norm(np.delete(reference - middle, axis, axis=1), axis=1)
    cell = np.rint((reference[:, axis] - reference[:, axis].min()) / spacing).astype(int)

    least = np.full(cell.max() + 1, np.inf)
    np.minimum.at(least, cell, distance)
    near = (distance <= least[cell] + 0.1 * spacing) & (distance <= spacing * max(results.dimension - 1, 1) ** 0.5)
    count = np.bincount(cell[near], minlength=len(least))
    columns = [np.bincount(cell[near], values[points][near], len(least))[count > 0] / count[count > 0]
               for values in (results.reference[:, axis], *fields)]  # fmt: skip
    gaps = np.flatnonzero(np.diff(columns[0]) > 2.2 * spacing) + 1
    return [np.insert(column, gaps, np.nan) for column in columns]


# ------------------------------------------------------------------------------------------- looks


def labels(keys: list[str], values: list[tuple[str, ...]]) -> list[str]:
    """Legend texts of the varied values: short names of the keys that have several values."""
    short = [key.rpartition(".")[2] for key in keys]
    names = [name if short.count(name) == 1 else key for name, key in zip(short, keys)]
    several = [len(set(column)) > 1 for column in zip(*values)]
    if not any(several):
        several = [True] * len(keys)
    told = []
    for combination in values:
        parts = [_entry(name, value) for name, value, shown in zip(names, combination, several) if shown]
        line = ", ".join(parts)
        told.append((line if len(line) <= LONGEST_LABEL else "\n".join(parts)).replace("$", r"\$"))
    return told


def _entry(name: str, value: str) -> str:
    """Shortens a long label: first the middle of the key, which says least, then the end of the value."""
    table, _, rest = name.partition(".")
    room = LONGEST_LABEL - len(f"{table}… = {value}")
    if 3 <= room < len(rest):
        name = f"{table}…{rest[-room:]}"
    return _shortened(f"{name} = {value}")


def _shortened(text: str, most: int = LONGEST_LABEL) -> str:
    return text if len(text) <= most else text[: most - 1] + "…"


def line_looks(values: list[tuple[str, ...]]) -> list[dict]:
    """Colour by one key, dashes by the others if they have few values; else colour by combination.

    The colour key is numeric if possible, and has the most values.
    """
    columns = [list(dict.fromkeys(column)) for column in zip(*values)]
    key = main_key(values)
    others = [combination[:key] + combination[key + 1 :] for combination in values]
    rest = list(dict.fromkeys(others))
    if len(rest) > len(DASHES):
        return [{"color": shade, "linestyle": "-"} for shade in _shades(len(values))]
    colours = _colours(columns[key])
    return [{"color": colours[combination[key]], "linestyle": DASHES[rest.index(other)]}
            for combination, other in zip(values, others)]  # fmt: skip


def main_key(values: list[tuple[str, ...]]) -> int:
    """Index of the key for colours and for the abscissa of outcomes: numeric if possible, with the most values."""
    columns = [list(dict.fromkeys(column)) for column in zip(*values)]
    return max(range(len(columns)), key=lambda place: (len(columns[place]) > 1, _is_numeric(columns[place]),
                                                       len(columns[place])))  # fmt: skip


def _is_numeric(texts: list[str]) -> bool:
    try:
        return all(np.isfinite(float(text)) for text in texts)
    except ValueError:
        return False


def _colours(texts: list[str]) -> dict:
    """Numbers get the shades of an ordered map by rank, a few words get distinct colours."""
    if _is_numeric(texts):
        return dict(zip(sorted(texts, key=float), _shades(len(texts))))
    return dict(zip(texts, LINES if len(texts) <= len(LINES) else _shades(len(texts))))


def _shades(count: int):
    return colormaps["viridis"](np.linspace(0.05, 0.85, max(count, 2)))


# ----------------------------------------------------------------------------------------- drawing


def _draw_reactions(axes, shown: list[Curves]) -> None:
    """Norm of the reaction of the most loaded support set over the load factor, from the unloaded state."""
    peaks: dict[str, float] = {}
    for curves in shown:
        for name, values in curves.reactions.items():
            peaks[name] = max(peaks.get(name, 0.0), values.max())
    if not peaks:
        axes.text(0.5, 0.5, "no support has a reaction", transform=axes.transAxes, ha="center")
        return
    largest = max(peaks.values())
    common = next(name for name, peak in peaks.items() if peak >= (1 - 1e-6) * largest)
    unit, size = unit_for(largest, FORCES, 1.0)
    for curves, width in zip(shown, _widths(len(shown))):
        values = curves.reactions.get(common)
        if values is None:
            values = max(curves.reactions.values(), key=np.max, default=np.zeros(len(curves.load)))
        x, y = np.concatenate([[0.0], curves.load]), np.concatenate([[0.0], values / size])
        marks = {"marker": "o", "markersize": 2.5 * width} if len(x) <= 60 else {}
        axes.plot(x, y, linewidth=width, zorder=3, label=curves.label, **marks, **curves.looks)
        if not curves.completed:
            axes.plot(x[-1], y[-1], "x", color=WARNING, markersize=11, markeredgewidth=2.4, zorder=4)
    _draw_axis(axes)
    axes.set_xlabel("load factor")
    axes.set_ylabel(f"reaction of “{common}” [{unit}]".replace("$", r"\$"))


def _draw_midlines(axes, shown: list[Curves]) -> None:
    """Damage, if there is any, or displacement at the last step, along the midline with the largest value."""
    damaged = max(curves.largest_damage for curves in shown) > 0.0

    def largest(axis: int) -> float:
        return max(np.nanmax(_field(curves.midlines[axis], damaged)) for curves in shown)

    axis = max(range(min(len(curves.midlines) for curves in shown)), key=largest)  # the first of equals
    length, length_size = unit_for(max(np.nanmax(np.abs(curves.midlines[axis].place)) for curves in shown), LENGTHS)
    unit, size = ("", 1.0) if damaged else unit_for(largest(axis), LENGTHS)
    for curves, width in zip(shown, _widths(len(shown))):
        line = curves.midlines[axis]
        axes.plot(line.place / length_size, _field(line, damaged) / size, linewidth=width, zorder=3, **curves.looks)
    _draw_axis(axes)
    axes.set_xlabel(f"{'xyz'[axis]} along the midline [{length}]")
    axes.set_ylabel("damage at the last step" if damaged else f"displacement at the last step [{unit}]")


def _quantities(shown: list[Curves]) -> list[str]:
    """Names of the outcomes to draw: those that are not zero, the largest component of a vector first."""
    names = dict.fromkeys(name for curves in shown for name in curves.outcomes)
    size = {name: max(abs(curves.outcomes[name][0]) for curves in shown if name in curves.outcomes) for name in names}
    vectors = {name.rpartition(" ")[0] for name in names if name[-2:] in (" x", " y", " z")}
    for vector in vectors:
        own = [name for name in names if name.rpartition(" ")[0] == vector]
        largest = max(size[name] for name in own)
        for name in own:
            if size[name] <= 1e-6 * largest:  # round-off
                del names[name]
    return [name for name in names if size[name] > 0.0][:MOST_QUANTITIES]


def _draw_outcome(axes, shown: list[Curves], keys: list[str], key: int, name: str) -> None:
    """An outcome over the values of a key; a line joins the combinations that differ in that key alone."""
    told = [curves for curves in shown if name in curves.outcomes]
    unit = told[0].outcomes[name][1]
    largest = max(abs(curves.outcomes[name][0]) for curves in told)
    unit, size = unit_for(largest, UNITS[unit]) if unit in UNITS else (unit, 1.0)
    texts = list(dict.fromkeys(curves.values[key] for curves in told))
    numeric = _is_numeric(texts)
    place = {text: float(text) if numeric else float(rank) for rank, text in enumerate(texts)}
    lines: dict[tuple, list[Curves]] = {}
    for curves in told:
        lines.setdefault(curves.values[:key] + curves.values[key + 1 :], []).append(curves)
    for dashes, own in zip(DASHES * len(lines), lines.values()):
        own.sort(key=lambda curves: place[curves.values[key]])
        axes.plot([place[curves.values[key]] for curves in own], [curves.outcomes[name][0] / size for curves in own],
                  color=GHOST, linestyle=dashes, linewidth=1.4, zorder=2)  # fmt: skip
    for curves in told:
        mark = {"marker": "o", "markersize": 8} if curves.completed else {"marker": "x", "markersize": 9}
        axes.plot(place[curves.values[key]], curves.outcomes[name][0] / size, color=curves.looks["color"],
                  linestyle="none", zorder=3, markeredgewidth=0.0 if curves.completed else 2.2, **mark)  # fmt: skip
    if not numeric:
        axes.set_xticks(list(place.values()), [_shortened(text).replace("$", r"\$") for text in place])
    elif min(place.values()) > 0.0 and max(place.values()) >= 20.0 * min(place.values()):
        axes.set_xscale("log")
    axes.set_xlabel(keys[key].replace("$", r"\$"))
    axes.set_ylabel(f"{name}{f' [{unit}]' if unit else ''}".replace("$", r"\$"))
    if numeric and axes.get_xscale() == "linear":
        axes.xaxis.set_major_locator(MaxNLocator(5))


def _field(line: Midline, damaged: bool) -> np.ndarray:
    return line.damage if damaged else line.displacement


def _widths(count: int):
    """Line widths: later lines are thinner, so that earlier ones stay visible where lines coincide."""
    return np.linspace(3.2 if count > 1 else 1.8, 1.4 if count > 1 else 1.8, count)


def _draw_axis(axes) -> None:
    axes.axhline(0.0, color=GHOST, linewidth=1.2, zorder=1)


def _draw_legend(figure, axes, shown: list[Curves]) -> None:
    """The legend beside the panels; of many combinations, evenly chosen ones are named."""
    handles, texts = axes.get_legend_handles_labels()
    chosen = np.unique(np.linspace(0, len(handles) - 1, min(MOST_LABELS, len(handles))).round().astype(int))
    handles, texts = [handles[place] for place in chosen], [texts[place] for place in chosen]
    if not all(curves.completed for curves in shown):
        cross = axes.plot([], [], "x", color=WARNING, markersize=9, markeredgewidth=2.2)
        handles, texts = [*handles, *cross], [*texts, "did not converge"]
    lines = sum(text.count("\n") + 1 for text in texts)
    size = np.clip(11.0 * 24 / max(lines, 1), 6.5, 11.0)
    title = f"{len(chosen)} of {len(shown)} combinations" if len(chosen) < len(shown) else None
    figure.legend(handles, texts, loc="upper left", bbox_to_anchor=(0.795, axes.get_position().y1 + 0.01), fontsize=size, title=title,
                  title_fontsize=size, alignment="left", handlelength=2.4)  # fmt: skip
