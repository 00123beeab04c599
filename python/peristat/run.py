"""Runs, and their results."""

import inspect
import os
import pathlib
import sys
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy

from . import toml_text
from ._numbers import truth
from ._package import load_core, thread_count
from .case import Case
from .errors import input_error
from .results import Results, open_results

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

    def __reduce__(self):
        """In another process, or copied, it is the results in its folder."""
        return open_results, (self.path,)


def run_case(case, body, *, output=None, on_step=None, threads=0, quiet=False, log=None, overwrite=False):
    """Runs a case; its body may have been made before. See `Body.solve`."""
    _require_callback(on_step)
    threads = thread_count(threads)
    core = load_core()
    placed = _with_output(case, output)
    read = placed._read()
    folder = os.path.abspath(read.directory)  # a callback may change the working folder
    with core.Unfinished(), placed._located_errors():
        end = core.run(
            read,
            body._core if body is not None else None,
            on_step,
            _no_line if quiet else _print_line,
            getattr(on_step, "is_left", None),
            threads,
            os.fspath(log or ""),
            truth("overwrite", overwrite),
        )
        # A thread that Python's end stops here would keep the lock of h5py, and Python would hang.
        return Run(folder, end, placed)


def resume(
    folder: str | os.PathLike[str],
    settings: dict[str, Any] | None = None,
    *,
    case: Case | None = None,
    on_step: Callable[["Step"], Any] | None = None,
    threads: int = 0,
    quiet: bool = False,
    log: str | os.PathLike[str] | None = None,
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
    _require_callback(on_step)
    threads = thread_count(threads)
    settings = {} if settings is None else settings
    if not isinstance(settings, Mapping) or not all(isinstance(key, str) for key in settings):
        raise input_error("settings", repr(settings)[:80], "must be a dict of values by dotted keys")
    texts = [(key, toml_text.value_text(value, key)) for key, value in settings.items()]
    functions, points = ({}, None) if case is None else case._givens()
    place = os.path.abspath(folder)
    core = load_core()
    with core.Unfinished():  # as above
        end = core.resume(
            os.fspath(folder),
            texts,
            functions,
            points,
            on_step,
            _no_line if quiet else _print_line,
            None,
            threads,
            os.fspath(log or ""),
        )
        return Run(place, end, case)


def _require_callback(on_step):
    returns_at_once = inspect.iscoroutinefunction(on_step) or inspect.isgeneratorfunction(on_step)
    if on_step is not None and (not callable(on_step) or returns_at_once):
        raise input_error("on_step", repr(on_step)[:80], "must be a function of a step, neither async nor a generator")


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
    _print(f"peristat: {line}" if is_problem else line, sys.stderr if is_problem else sys.stdout)


def _no_line(line, is_problem):
    if is_problem:
        _print_line(line, is_problem)


def _print(text, stream):
    try:
        print(text, file=stream)
    except UnicodeEncodeError:  # a title, on a stream of ASCII
        print(text.encode("ascii", "backslashreplace").decode(), file=stream)
