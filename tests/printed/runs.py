"""Runs whose results are compared with printed numbers; each command runs once per process."""

import functools
import json

import h5py

from tests.reference.program import ROOT, peristat, settings
from tests.reference.results import table
from tests.shipped_runs import shipped_run


class Run:
    """Results folder of a run."""

    def __init__(self, folder, output):
        self.folder = folder
        self.output = output
        self.summary = json.loads((folder / "summary.json").read_text())
        self.history = [row for row in table(folder / "history.csv") if row["step"] > 0 or "time" in row]
        self.iterations = table(folder / "iterations.csv")
        self.decisions = table(folder / "decisions.csv")
        self.convergence = table(folder / "convergence.csv")

    def reaction(self, support, axis="x"):
        """Reaction at the last step [N]."""
        return self.summary["reactions"][support]["xyz".index(axis)]

    def reactions(self, support, axis):
        """Reactions at all steps [N]."""
        return [row[f"reaction_{axis}:{support}"] for row in self.history]

    def peak(self, support, axis):
        return max(abs(reaction) for reaction in self.reactions(support, axis))

    def step(self, number):
        return self.history[number - 1]

    def step_of_peak(self, support, axis):
        return max(self.history, key=lambda row: abs(row[f"reaction_{axis}:{support}"]))

    def first(self, column):
        """The first step with a positive value in the column."""
        return next(row for row in self.history if row[column] > 0)

    def field(self, name):
        """A field of the points at the last step."""
        with h5py.File(self.folder / "results.h5") as file:
            return list(file["steps"].values())[-1][name][...]

    def points(self, name):
        """A dataset of the points in the results."""
        with h5py.File(self.folder / "results.h5") as file:
            return file["points"][name][...]

    def accepted_residuals(self):
        """Final relative residual of each accepted step."""
        last = {row["step"]: row["relative_residual"] for row in self.iterations}
        return [last[row["step"]] for row in self.history]


@functools.cache
def run(case, *changes, code=0, threads=1):
    """Runs cases/CASE.toml with overrides `key=value` and expects an exit code."""
    ended = shipped_run(case, *changes, threads=threads)
    assert ended.code == code, f"{case} {changes}: exit code {ended.code}\n{ended.output}{ended.errors}"
    return Run(ended.folder, ended.output)


@functools.cache
def check(case, *changes):
    """What `check` prints."""
    ended = peristat("check", ROOT / "cases" / f"{case}.toml", *settings(*changes))
    assert ended.code == 0, ended.said
    return ended.output


@functools.cache
def calibrate(*options):
    ended = peristat("calibrate", *options)
    assert ended.code == 0, ended.said
    return ended.json()
