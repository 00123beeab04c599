"""Runs, and their results."""

import os
import pathlib
import sys
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy

from . import toml_text
from ._package import load_core, thread_count
from .case import Case
from .errors import input_error
from .results import Results

if TYPE_CHECKING:
    from ._core import Step

_folders = set()  # that runs of this process have written


class Run(Results):
    """The results of a run of this process.

    The last state is in memory; anything else is read from the results folder when it is asked for.
    """

    def __init__(self, folder, end, case=None):
        super().__init__(folder)
        self._end = end
        self._case = case

    @property
    def converged(self) -> bool:
        """True if the run reached the end of its load."""
        return self.status == "completed"

    @property
    def reason(self) -> str:
        """Why the run ended before its load did, a sentence; empty if it did not."""
        return ": ".join(part for part in (super().reason, self._end.reason) if part)

    def displacement(self, step: int = -1) -> numpy.ndarray:
        """Displacement of the points at a step [m], points x dimension.

        The last one is a view of the run's memory, without a copy, which can't be written.
        """
        if step == -1 and self._end.displacement is not None:
            return self._end.displacement
        return super().displacement(step)

    def resume(self, settings: dict[str, Any] | None = None, **options: Any) -> "Run":
        """Goes on from the last accepted step, see `peristat.resume`."""
        return resume(self.path, settings, case=self._case, **options)


def run_case(case, body, *, output=None, on_step=None, threads=0, quiet=False, log="", overwrite=False):
    """Runs a case; its body may have been made before. See `Body.solve`."""
    if on_step is not None and not callable(on_step):
        raise input_error("on_step", repr(on_step)[:80], "must be a function of a step")
    threads = thread_count(threads)
    core = load_core()
    placed = _with_output(case, output)
    read = placed._read()
    folder = pathlib.Path(read.directory)
    with placed._located_errors():
        end = core.run(
            read,
            body._core if body is not None else None,
            on_step,
            _no_line if quiet else _print_line,
            threads,
            os.fspath(log),
            overwrite,
        )
    return Run(folder, end, placed)


def resume(
    folder: str | os.PathLike[str],
    settings: dict[str, Any] | None = None,
    *,
    case: Case | None = None,
    on_step: Callable[["Step"], Any] | None = None,
    threads: int = 0,
    quiet: bool = False,
    log: str | os.PathLike[str] = "",
) -> Run:
    """Goes on with an interrupted or failed run from its last accepted step.

    Args:
        folder: results folder of the run.
        settings: keys that extend the run: {"loading.largest_step": 0.01}.
        case: gives its functions and points, if the run used any.

    Returns:
        Run: the results, with those of before.

    Raises:
        InputError: there is nothing to resume, or a setting would make it another case.
    """
    threads = thread_count(threads)
    texts = [(key, toml_text.value_text(value, key)) for key, value in (settings or {}).items()]
    functions, points = ({}, None) if case is None else case._givens()
    end = load_core().resume(
        os.fspath(folder), texts, functions, points, on_step, _no_line if quiet else _print_line, threads, os.fspath(log)
    )
    return Run(folder, end, case)


def _with_output(case, output):
    """The case with its results folder: no run replaces another one's of this process unasked."""
    placed = case.copy()
    if output is not None:
        placed.set("output.directory", os.fspath(output))
        return placed
    if case.get("output.directory") is None and not case._is_file():
        placed.set("output.directory", f"results/{case.name}")
    folder = pathlib.Path(placed._read().directory)
    free, count = folder, 1
    while free.resolve() in _folders:
        count += 1
        free = folder.with_name(f"{folder.name}-{count}")
    _folders.add(free.resolve())
    if count > 1:
        placed.set("output.directory", str(free))
    return placed


def _print_line(line, is_problem):
    print(f"peristat: {line}" if is_problem else line, file=sys.stderr if is_problem else sys.stdout)


def _no_line(line, is_problem):
    if is_problem:
        print(f"peristat: {line}", file=sys.stderr)
