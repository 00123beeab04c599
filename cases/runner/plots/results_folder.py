"""Reads a results folder (docs/results.md) for the pictures.

A run that was killed, did not converge or is still going leaves an incomplete folder; everything here
gives what is there and says what is missing.
"""

import csv
import json
import os
import tomllib
from dataclasses import dataclass, field
from pathlib import Path

# A results file on a read-only or shared file system, or of a run still going, can be read unlocked.
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")

import h5py
import numpy as np


class NotAResultsFolder(Exception):
    """The folder does not exist, or holds no results.h5 that can be read."""


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
        """Whether each point belongs to a piece that has come off."""
        return self.fragment > 0.5


@dataclass
class ResultsFolder:
    """A results folder; the fields of steps are read when they are asked for."""

    path: Path
    title: str
    reference: np.ndarray  # count x dimension [m]
    volume: np.ndarray  # count [m3]
    spacing: float  # [m]
    sets: dict[str, np.ndarray]  # point numbers by name
    step_numbers: list[int]  # with readable fields, ascending
    history: dict[str, list]  # columns of history.csv
    iterations: dict[str, list]  # columns of iterations.csv
    decisions: dict[str, list]  # columns of decisions.csv, empty if there is none
    summary: dict
    case: dict  # the resolved case
    missing: list[str] = field(default_factory=list)  # sentences for a person

    @property
    def dimension(self) -> int:
        return self.reference.shape[1]

    @property
    def status(self) -> str:
        return self.summary.get("status", "interrupted")

    def step(self, number: int) -> Step:
        """Fields of a step; values that are not finite are replaced by zero and reported."""
        with h5py.File(self.path / "results.h5", "r") as file:
            group = file[f"steps/{number:06d}"]
            count = len(self.volume)

            def values(name, shape, expected=True):
                if name not in group:
                    if expected:
                        self._report(f"step {number} has no {name}")
                    return np.zeros(shape)
                array = np.asarray(group[name][...], dtype=float).reshape(shape)
                if not np.isfinite(array).all():
                    self._report(f"{name} of step {number} has values that are not finite (drawn as 0)")
                    array = np.where(np.isfinite(array), array, 0.0)
                return array

            return Step(
                number,
                float(group.attrs.get("load_factor", 0.0)),
                _text(group.attrs.get("mode", "")),
                values("displacement", self.reference.shape),
                values("damage", count),
                values("energy_density", count),
                values("fragment", count, expected=False),
            )

    def displacement(self, number: int) -> np.ndarray:
        """Displacement of a step alone, count x dimension [m]."""
        with h5py.File(self.path / "results.h5", "r") as file:
            array = np.asarray(file[f"steps/{number:06d}/displacement"][...], dtype=float)
        return np.nan_to_num(array.reshape(self.reference.shape), posinf=0.0, neginf=0.0)

    def has_damage(self, number: int) -> bool:
        with h5py.File(self.path / "results.h5", "r") as file:
            name = f"steps/{number:06d}/damage"
            return name in file and bool(np.nanmax(file[name][...], initial=0.0) > 0.0)

    @property
    def is_fractured(self) -> bool:
        """Whether the history knows of damage."""
        return any(isinstance(value, float) and value > 0.0
                   for column in ("max_damage", "broken_bonds") for value in self.history.get(column, []))  # fmt: skip

    def in_history(self, step: int, column: str) -> float | None:
        """A number of an accepted step's row in the history."""
        rows = zip(self.history.get("step", []), self.history.get(column, []))
        return next((value for own, value in rows if own == step and isinstance(value, float)), None)

    def broken_bonds(self) -> tuple[np.ndarray, np.ndarray]:
        """Bonds that broke, in the order of breaking: their two points (count x 2) and the step (count)."""
        names = ("step", "first_point", "second_point")
        table = {}
        with h5py.File(self.path / "results.h5", "r") as file:
            group = file.get("broken_bonds", {})
            if all(name in group for name in names):
                table = {name: group[name][...] for name in names}
        if not table and (self.path / "broken_bonds.csv").is_file():
            table = _table(self.path / "broken_bonds.csv", self.missing)
        try:
            step, first, second = (np.asarray(table.get(name, []), dtype=np.int64) for name in names)
            ends = np.stack([first, second], axis=1)
        except ValueError as error:
            self._report(f"the broken bonds can't be read ({error})")
            return np.zeros((0, 2), dtype=np.int64), np.zeros(0, dtype=np.int64)
        known = ((ends >= 0) & (ends < len(self.volume))).all(axis=1)
        if not known.all():
            self._report("broken bonds of points that do not exist are left out")
        order = np.argsort(step[known], kind="stable")
        return ends[known][order], step[known][order]

    def _report(self, sentence: str) -> None:
        if sentence not in self.missing:
            self.missing.append(sentence)


def read_results_folder(path: Path) -> ResultsFolder:
    """Opens a results folder.

    Raises NotAResultsFolder if there is nothing to draw from.
    """
    if not path.is_dir():
        raise NotAResultsFolder(f"{path}: no such folder")
    if not (path / "results.h5").is_file():
        raise NotAResultsFolder(f"{path}: no results folder (it has no results.h5)")
    missing = []
    try:
        with h5py.File(path / "results.h5", "r") as file:
            reference = np.asarray(file["points/reference"][...], dtype=float)
            volume = np.asarray(file["points/volume"][...], dtype=float)
            reference = reference.reshape(len(volume), -1)
            if not (len(volume) and reference.shape[1] in (1, 2, 3) and np.isfinite(reference).all()):
                raise NotAResultsFolder(f"{path}/results.h5: its points can't be read")
            sets = _sets(file)
            case = _case(file, missing)
            title = _text(file.attrs.get("title", "")) or case.get("title", "") or path.resolve().name
            spacing = float(file["points"].attrs.get("spacing", 0.0))
            step_numbers = _readable_steps(file, missing)
    except (OSError, KeyError, ValueError) as error:
        raise NotAResultsFolder(f"{path}/results.h5: can't be read ({error})") from error

    spacing = spacing or _number(case.get("lattice", {}).get("spacing")) or _mean_spacing(reference)
    summary = {}
    try:
        summary = dict(json.loads((path / "summary.json").read_text()))
    except (OSError, ValueError, TypeError):
        missing.append("there is no readable summary.json: the run was interrupted or is still going")
    return ResultsFolder(
        path, title, reference, volume, spacing, sets, step_numbers,
        _table(path / "history.csv", missing), _table(path / "iterations.csv", missing),
        _table(path / "decisions.csv", []), summary, case, missing,
    )  # fmt: skip


def _text(value) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)


def _number(value) -> float:
    return float(value) if isinstance(value, (int, float)) and value > 0 else 0.0


def _sets(file) -> dict[str, np.ndarray]:
    """Point numbers by set name, from the membership matrix (count x sets)."""
    if "points/set_ids" not in file:
        return {}
    membership = file["points/set_ids"]
    names = membership.attrs.get("sets", [])
    names = [_text(name) for name in np.atleast_1d(names)]
    if not names or not membership.size:
        return {}
    matrix = np.asarray(membership[...]).reshape(-1, len(names))
    return {name: np.flatnonzero(matrix[:, column]) for column, name in enumerate(names)}


def _case(file, missing) -> dict:
    """The resolved case, or an empty one if it can't be read."""
    try:
        text = file["case/as_resolved"]
        return tomllib.loads(_text(np.asarray(text[()]).item()))
    except (KeyError, ValueError, tomllib.TOMLDecodeError):
        missing.append("the resolved case can't be read from results.h5")
        return {}


def _readable_steps(file, missing) -> list[int]:
    """Steps whose displacement can be opened (each may be a link to a file that is gone)."""
    readable = []
    for name in sorted(file["steps"]) if "steps" in file else []:
        try:
            file[f"steps/{name}/displacement"].shape
            readable.append(int(name))
        except (KeyError, OSError, ValueError):
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


def _table(path: Path, missing) -> dict[str, list]:
    """Columns of a CSV file; numbers where every entry is one. Half-written rows are left out."""
    try:
        with open(path, newline="") as file:
            rows = [row for row in csv.reader(file) if row]
    except OSError:
        missing.append(f"there is no {path.name}")
        return {}
    if not rows:
        return {}
    names, rows = rows[0], [row for row in rows[1:] if len(row) == len(rows[0])]
    return {name: _column([row[i] for row in rows]) for i, name in enumerate(names)}


def _column(entries: list[str]) -> list:
    try:
        return [float(entry) for entry in entries]
    except ValueError:
        return entries
