"""Reads a results folder (docs/results.md) for the pictures.

A run that was killed, did not converge or is still going leaves an incomplete folder; this module returns what is
there and lists what is missing. Damaged files are named (NotAResultsFolder).
"""

import csv
import json
import tomllib
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

import numpy as np

from ..errors import InputError
from .hdf5_reader import Damaged, Hdf5Reader, as_text, require_plain_file
from .images import BrokenBonds, ImageKinds, on_the_body
from .mesh_cells import QUADRILATERAL, TRIANGLE, Elements, are_sound
from .outline import Outline, read_outline

MOST_TABLE = 1 << 30  # limit on the bytes of a CSV file
MOST_SUMMARY = 64 << 20  # limit on the bytes of summary.json
LONGEST_TITLE = 200  # characters
MOST_SPACINGS = 1e7  # largest size of a body
MOST_IMAGE_KINDS = 1_000_000


class NotAResultsFolder(InputError):
    """The folder does not exist, or holds no readable results."""


@dataclass
class Step:
    """Fields of one accepted step; arrays are count x dimension or count."""

    number: int
    load_factor: float
    mode: str
    displacement: np.ndarray  # [m]
    damage: np.ndarray  # 0 intact to 1
    energy_density: np.ndarray  # [J/m3]
    fragment: np.ndarray  # 0 in the held body, else the number of a floating piece

    @property
    def floating(self) -> np.ndarray:
        """Whether each point belongs to a detached piece."""
        return self.fragment > 0.5


@dataclass
class ResultsFolder:
    """A results folder; the fields of steps are read on request."""

    path: Path
    title: str
    reference: np.ndarray  # count x dimension [m]
    volume: np.ndarray  # count [m3]
    spacing: float  # [m]
    sets: dict[str, np.ndarray]  # point numbers by name
    step_numbers: list[int]  # steps with readable fields, ascending
    history: dict[str, list]  # columns of history.csv
    iterations: dict[str, list]  # columns of iterations.csv
    decisions: dict[str, list]  # columns of decisions.csv, empty if there is none
    orders: dict[int, float]  # observed orders of convergence by step, from convergence.csv
    summary: dict
    case: dict  # the resolved case
    missing: list[str] = field(default_factory=list)  # sentences for the user
    drawn: dict = field(default_factory=dict)  # cache shared by pictures of several steps
    image_kinds: ImageKinds | None = None  # for a body with planes of symmetry or periods
    _bonds: BrokenBonds | None = None  # broken bonds, once they have been read
    elements: Elements | None = None  # of a plane mesh, one per point
    lattice_edges: np.ndarray | None = None  # for a lattice that is turned or not square, one row per axis [m]

    @property
    def dimension(self) -> int:
        return self.reference.shape[1]

    @property
    def edges(self) -> np.ndarray:
        """Edges of a cell, one row per lattice axis [m]."""
        return self.spacing * np.eye(self.dimension) if self.lattice_edges is None else self.lattice_edges

    @property
    def status(self) -> str:
        return as_text(self.summary.get("status", "interrupted"))[:20]

    def tables(self, name: str) -> list[dict]:
        """The tables of an array of tables of the case ("support"); none if it has no such array."""
        found = self.case.get(name, [])
        return [table for table in found if isinstance(table, dict)] if isinstance(found, list) else []

    @property
    def reach(self) -> int:
        """Reach of the horizon in whole spacings; 1 if unknown."""
        lattice, points = (self.case.get(name) for name in ("lattice", "points"))
        ratio = _finite(lattice.get("horizon_ratio")) if isinstance(lattice, dict) else None
        horizon = points.get("horizon") if isinstance(points, dict) else None
        if isinstance(horizon, dict):  # per point, a ratio to its size
            ratio, horizon = _finite(horizon.get("ratio")), None
        horizon = _finite(horizon)
        return int(max(ratio or (horizon or 0.0) / self.spacing, 1.0))

    @property
    def listed_reach(self) -> int:
        """Reach of the broken bonds that are listed; with convolutions only those to next neighbours are."""
        solver = self.case.get("solver")
        return 1 if isinstance(solver, dict) and solver.get("operator") == "fft" else self.reach

    @cached_property
    def outline(self) -> Outline | None:
        """Outline of a plane body whose case has shapes; None in other dimensions, which have other shapes."""
        lattice = self.case.get("lattice")
        tables = lattice.get("shape") if isinstance(lattice, dict) else None
        return read_outline(tables, self.spacing, self.reference) if isinstance(tables, list) else None

    @cached_property
    def in_layers(self) -> np.ndarray:
        """Whether each point is in a layer outside the body."""
        lattice, inside = self.case.get("lattice"), np.zeros(len(self.volume), dtype=bool)
        layers = lattice.get("layer") if isinstance(lattice, dict) else None
        for layer in layers if isinstance(layers, list) else []:
            name = as_text(layer.get("name", "")) if isinstance(layer, dict) else ""
            inside[self.sets.get(name, [])] = True
        return inside

    @property
    def cracks(self) -> list[np.ndarray]:
        """Pre-cracks: the two ends of a segment, or the vertices of a polygon [m]. These are the cracks of the case and
        those of their images that reach the body."""
        cracks = []
        for table in self.tables("crack"):
            places = table.get("vertices") or [table.get("from"), table.get("to")]
            try:
                crack = np.array(places, dtype=float)
            except (TypeError, ValueError):
                continue
            if crack.ndim == 2 and crack.shape[1] == self.dimension and len(crack) > 1 and np.isfinite(crack).all():
                cracks.append(crack)
        if self.image_kinds is None:
            return cracks
        edge = self.reach * self.spacing
        return on_the_body(cracks, self.image_kinds, self.reference.min(axis=0) - edge, self.reference.max(axis=0) + edge)

    @property
    def sides(self) -> list[tuple[int, float]]:
        """Axis and position of planes of symmetry and of the sides of periods [m]."""
        places = [(table.get("axis"), _finite(table.get(key)))
                  for name, keys in (("symmetry", ["at"]), ("period", ["from", "to"]))
                  for table in self.tables(name) for key in keys]  # fmt: skip
        axes = list("xyz"[: self.dimension])
        return [(axes.index(axis), at) for axis, at in places if axis in axes and at is not None]

    def step(self, number: int) -> Step:
        """Fields of a step; values that are not finite are replaced by zero and reported."""
        with ResultsFile(self.path) as file:
            group = f"steps/{number:06d}"
            count = len(self.volume)

            def values(name, shape, expected=True):
                try:
                    array = file.numbers(f"{group}/{name}", shape)
                except KeyError:
                    if expected:
                        self._report(f"step {number} has no {name}")
                    return np.zeros(shape)
                if not np.isfinite(array).all():
                    self._report(f"{name} of step {number} has values that are not finite (drawn as 0)")
                    array = np.where(np.isfinite(array), array, 0.0)
                return array

            return Step(
                number,
                _finite(file.attribute(group, "load_factor")) or 0.0,
                as_text(file.attribute(group, "mode", "")),
                values("displacement", self.reference.shape),
                values("damage", (count,)),
                values("energy_density", (count,)),
                values("fragment", (count,), expected=False),
            )

    def field(self, number: int, name: str, *width: int) -> np.ndarray | None:
        """An optional field of a step, count x width; None if it is missing or not finite."""
        with ResultsFile(self.path) as file:
            path = f"steps/{number:06d}/{name}"
            if path not in file:
                return None
            array = file.numbers(path, (len(self.volume), *width))
        if np.isfinite(array).all():
            return array
        self._report(f"{name} of step {number} has values that are not finite (not drawn)")
        return None

    @property
    def resting_steps(self) -> set[int]:
        """Includes step 0 if nothing moves there: it has a row of the history and no fields."""
        return {0} & {int(step) for step in self.history.get("step", [])} - set(self.step_numbers)

    def displacement(self, number: int) -> np.ndarray:
        """Displacement of a step alone, count x dimension [m]."""
        if number in self.resting_steps:
            return np.zeros_like(self.reference)
        with ResultsFile(self.path) as file:
            array = file.numbers(f"steps/{number:06d}/displacement", self.reference.shape)
        return np.nan_to_num(array, posinf=0.0, neginf=0.0)

    def has_damage(self, number: int) -> bool:
        if (self.in_history(number, "max_damage") or 0.0) > 0.0:
            return True
        with ResultsFile(self.path) as file:
            name = f"steps/{number:06d}/damage"
            return name in file and bool(np.nanmax(file.numbers(name), initial=0.0) > 0.0)

    @property
    def is_fractured(self) -> bool:
        """Whether the history reports damage."""
        return any(isinstance(value, float) and value > 0.0
                   for column in ("max_damage", "broken_bonds") for value in self.history.get(column, []))  # fmt: skip

    def numbers(self, column: str) -> np.ndarray | None:
        """A column of the history if all of its entries are finite numbers."""
        values = self.history.get(column, [])
        if not values or not all(isinstance(value, float) for value in values):
            return None
        array = np.array(values)
        return array if np.isfinite(array).all() else None

    @property
    def is_of_motion(self) -> bool:
        """Whether the load factor is the time [s]."""
        return "kinetic_energy" in self.history and "time_step" in self.history

    def in_history(self, step: int, column: str) -> float | None:
        """A number from an accepted step's row of the history."""
        rows = zip(self.history.get("step", []), self.history.get(column, []))
        return next((value for own, value in rows if own == step and isinstance(value, float)), None)

    def broken_bonds(self) -> BrokenBonds:
        if self._bonds is None:
            self._bonds = self._read_broken_bonds()
        return self._bonds

    @property
    def tells_broken_bonds(self) -> bool:
        """Whether the folder has a list of broken bonds, even an empty one; older folders have none."""
        if (self.path / "broken_bonds.csv").is_file():
            return True
        with ResultsFile(self.path) as file:
            return "broken_bonds/first_point" in file

    def _read_broken_bonds(self) -> BrokenBonds:
        names = ("step", "first_point", "second_point", "second_image")
        table = {}
        with ResultsFile(self.path) as file:
            if all(f"broken_bonds/{name}" in file for name in names[:3]):
                there = [name for name in names if f"broken_bonds/{name}" in file]
                table = {name: file.numbers(f"broken_bonds/{name}", kind=np.int64) for name in there}
        if not table and (self.path / "broken_bonds.csv").is_file():
            table = _table(self.path / "broken_bonds.csv", self.missing)
        table.setdefault("second_image", [0] * len(table.get("step", [])))  # older folders lack this column
        try:
            step, first, second, image = (np.asarray(table.get(name, []), dtype=np.int64).ravel() for name in names)
            ends = np.stack([first, second], axis=1)
            kinds = len(self.image_kinds.mirror) if self.image_kinds else 0
            known = ((ends >= 0) & (ends < len(self.volume))).all(axis=1) & (image >= 0) & (image <= kinds)
            found = BrokenBonds(ends[known], image[known], step[: len(known)][known])
        except (ValueError, IndexError, OverflowError) as error:
            self._report(f"the broken bonds can't be read ({error})")
            return BrokenBonds(np.zeros((0, 2), dtype=np.int64), *np.zeros((2, 0), dtype=np.int64))
        if not known.all():
            self._report("broken bonds of points or images that do not exist are left out")
        order = np.argsort(found.steps, kind="stable")
        return BrokenBonds(*(values[order] for values in found))

    def _report(self, sentence: str) -> None:
        if sentence not in self.missing:
            self.missing.append(sentence)


class ResultsFile(Hdf5Reader):
    """An open results file whose damage is reported as damage of the folder."""

    def __init__(self, path: Path):
        try:
            super().__init__(path)
        except Damaged as error:
            raise NotAResultsFolder(str(error)) from error
        self._path = path

    def __exit__(self, kind, error, trace):
        super().__exit__(kind, error, trace)
        if isinstance(error, (Damaged, OSError, KeyError, ValueError, TypeError, RuntimeError)):
            what = f"{error.args[0]} is missing" if isinstance(error, KeyError) and error.args else error
            raise NotAResultsFolder(f"{self._path}/results.h5: {what}") from error


def read_results_folder(path: Path) -> ResultsFolder:
    """Opens a results folder.

    Raises NotAResultsFolder if there is nothing to draw from, or if it is damaged.
    """
    if not path.is_dir():
        raise NotAResultsFolder(f"{path}: no such folder")
    if not (path / "results.h5").exists():
        raise NotAResultsFolder(f"{path}: no results folder (it has no results.h5)")
    missing: list[str] = []
    with ResultsFile(path) as file:
        volume = file.numbers("points/volume")
        reference = file.numbers("points/reference")
        if not (volume.ndim == 1 and reference.ndim == 2 and len(volume) == len(reference) > 0
                and reference.shape[1] in (1, 2, 3)):  # fmt: skip
            raise Damaged(f"/points has {reference.shape} coordinates and {volume.shape} volumes")
        size = np.ptp(reference, axis=0).max()
        if not (np.isfinite(reference).all() and np.isfinite(size)):
            raise Damaged("/points/reference has values that are not finite")
        sets = _sets(file, len(volume), missing)
        case = _case(file, missing)
        title = as_text(file.attribute("", "title", ""))
        spacing = _finite(file.attribute("points", "spacing"))
        along = [_finite(file.attribute("points", f"spacing_{axis}")) for axis in "xyz"[: reference.shape[1]]]
        angle = _finite(file.attribute("points", "angle"))
        step_numbers = _readable_steps(file, missing)
        image_kinds = _image_kinds(file, reference.shape[1], missing)
        elements = None if "lattice" in case else _elements(file, reference, missing)
    title = title or as_text(case.get("title", "")) or path.resolve().name
    title = "".join(c if c.isprintable() else " " for c in title)[:LONGEST_TITLE]
    lattice = case.get("lattice", {})
    for told in (spacing, _finite(lattice.get("spacing") if isinstance(lattice, dict) else None)):
        if told and told > 0.0 and size / told < MOST_SPACINGS:
            spacing = told
            break
    else:
        spacing = _mean_spacing(reference)
    found = ResultsFolder(
        path, title, reference, volume, spacing, sets, step_numbers,
        _history(path / "history.csv", missing), _table(path / "iterations.csv", missing),
        _table(path / "decisions.csv", []), _orders(path / "convergence.csv"), _summary(path, missing), case, missing,
    )  # fmt: skip
    found.lattice_edges = _edges(spacing, along, angle)
    found.image_kinds = image_kinds
    found.elements = elements
    return found


def _edges(spacing: float, along: list, angle: float | None) -> np.ndarray | None:
    """Edges of cells that are turned or not square; None for others, and for invalid values."""
    lengths = [length if length and length > 0.0 else spacing for length in along]
    if max(lengths) > MOST_SPACINGS * min(lengths) or (lengths == [spacing] * len(lengths) and not angle):
        return None
    turn = np.eye(len(lengths))
    if angle and len(lengths) > 1:
        cosine, sine = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        turn[:2, :2] = [[cosine, sine], [-sine, cosine]]
    return np.array(lengths)[:, None] * turn


def _image_kinds(file, dimension: int, missing) -> ImageKinds | None:
    """Image kinds; None for a body without images, and for invalid kinds."""
    if "points/images" not in file:
        return None
    try:
        kinds = ImageKinds(*(file.numbers(f"points/images/{name}") for name in ("mirror", "shift")))
        if kinds.mirror.shape != kinds.shift.shape or kinds.shift.shape[1:] != (dimension,):
            raise Damaged(f"they have {kinds.mirror.shape} mirrors and {kinds.shift.shape} shifts")
        if len(kinds.shift) > MOST_IMAGE_KINDS or not np.isfinite(np.concatenate(kinds)).all():
            raise Damaged("they are too many or not finite")
    except (Damaged, KeyError) as error:
        missing.append(f"the images of points can't be read ({error})")
        return None
    return kinds


def _elements(file, reference: np.ndarray, missing) -> Elements | None:
    """Elements of a plane mesh; None for other bodies, and for elements that are no cells of the points."""
    if reference.shape[1] != 2 or "points/cells" not in file:
        return None
    try:
        if not np.isin(file.numbers("points/cells/types"), (TRIANGLE, QUADRILATERAL)).all():
            return None
        offset = file.numbers("points/cells/offsets", kind=np.int64)
        elements = Elements(file.numbers("points/cells/corners")[:, :2], offset)
        if are_sound(elements, len(reference)):
            return elements
        raise Damaged("they are no cells of the points")
    except (Damaged, KeyError) as error:
        missing.append(f"the elements can't be read ({error})")
        return None


def _finite(value) -> float | None:
    """A finite number, or None."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        return None
    return number if np.isfinite(number) else None


def _summary(path: Path, missing) -> dict:
    try:
        if require_plain_file(path / "summary.json") > MOST_SUMMARY:
            raise ValueError("too large")
        return dict(json.loads((path / "summary.json").read_text()))
    except (Damaged, OSError, ValueError, TypeError, RecursionError):
        missing.append("there is no readable summary.json: the run was interrupted or is still going")
        return {}


def point_sets(file, count: int) -> dict[str, np.ndarray]:
    """Point numbers by set name, from the membership matrix (count x sets)."""
    names = [as_text(name) for name in np.atleast_1d(file.attribute("points/set_ids", "sets", []))]
    if not names:
        return {}
    matrix = file.numbers("points/set_ids", (count, len(names)), kind=np.uint8)
    return {name: np.flatnonzero(matrix[:, column]) for column, name in enumerate(names)}


def _sets(file, count: int, missing) -> dict[str, np.ndarray]:
    try:
        return point_sets(file, count)
    except (Damaged, KeyError) as error:
        missing.append(f"the sets can't be read ({error})")
        return {}


def _case(file, missing) -> dict:
    """The resolved case, or an empty one if it can't be read."""
    try:
        return tomllib.loads(file.text("case/as_resolved"))
    except (Damaged, KeyError, OSError, ValueError, TypeError, RecursionError):
        missing.append("the resolved case can't be read from results.h5")
        return {}


def _readable_steps(file, missing) -> list[int]:
    """Steps whose displacement can be opened (each may be a link to a file that is gone)."""
    readable = []
    for name in file.names("steps"):
        try:
            if f"steps/{name}/displacement" not in file or not (name.isdecimal() and len(name) >= 6):
                raise Damaged("no displacement")
            readable.append(int(name))
        except (Damaged, OSError, ValueError):
            missing.append(f"the fields of step {name} can't be read")
    if not readable:
        missing.append("there are no fields: no step was accepted")
    return readable


def _mean_spacing(reference: np.ndarray) -> float:
    """Spacing as the median distance to the nearest neighbour, from a sample of the points [m]."""
    generator = np.random.default_rng(1)
    sample = generator.choice(len(reference), min(60, len(reference)), replace=False)
    nearest = []
    for point in sample:
        squared = ((reference - reference[point]) ** 2).sum(axis=1)
        squared[point] = np.inf
        nearest.append(squared.min())
    spacing = float(np.sqrt(np.median(nearest)))
    return spacing if 0.0 < spacing < np.inf else 1.0


def _history(path: Path, missing) -> dict[str, list]:
    """The history; empty, with a message, if its steps or load factors can't be read."""
    table = _table(path, missing)
    for column in ("step", "load_factor"):
        values = table.get(column, [])
        if table and not (all(isinstance(value, float) for value in values) and np.isfinite(values).all()):
            missing.append(f"{path.name} has no column {column} with finite numbers")
            return {}
        if table and column not in table:
            missing.append(f"{path.name} has no column {column}")
            return {}
    return table


def _orders(path: Path) -> dict[int, float]:
    """Observed orders by step: the last row of convergence.csv, without its empty cells."""
    rows = _rows(path, [])
    if not rows or rows[-1][0] != "observed_order":
        return {}
    orders = {}
    for name, cell in zip(rows[0][1:], rows[-1][1:]):
        order = _finite(cell)
        if order is not None and name.startswith("step_") and name[5:].isdecimal():
            orders[int(name[5:])] = order
    return orders


def _rows(path: Path, missing) -> list[list[str]]:
    """Rows of a CSV file that are not empty; none, with a message, if it can't be read."""
    try:
        if require_plain_file(path) > MOST_TABLE:
            raise ValueError("it is larger than a gigabyte")
        with open(path, newline="", encoding="utf-8", errors="replace") as file:
            return [row for row in csv.reader(file) if row]
    except (Damaged, OSError):
        missing.append(f"there is no {path.name}" if not path.exists() else f"{path.name} can't be read")
    except (csv.Error, ValueError) as error:
        missing.append(f"{path.name} can't be read ({error})")
    return []


def _table(path: Path, missing) -> dict[str, list]:
    """Columns of a CSV file, as numbers if every entry is one. Half-written rows are left out."""
    rows = _rows(path, missing)
    if not rows:
        return {}
    names, rows = rows[0], [row for row in rows[1:] if len(row) == len(rows[0])]
    return {name: _column([row[i] for row in rows]) for i, name in enumerate(names)}


def _column(entries: list[str]) -> list:
    try:
        return [float(entry) for entry in entries]
    except ValueError:
        return entries
