"""One case with many values of its keys."""

import concurrent.futures
import contextlib
import html
import itertools
import json
import operator
import os
import pathlib
import signal
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence

import numpy

from ._numbers import truth
from ._package import thread_count
from .case import Case, _with_mode
from .errors import InputError, MachineError, input_error
from .results import Results


def sweep(
    case: Case,
    vary: Mapping[str, Sequence],
    *,
    output: str | os.PathLike | None = None,
    jobs: int = 1,
    together: bool = False,
    mode: str | None = None,
    **options,
) -> "Sweep":
    """Solves a case for every combination of values.

        sweep = ps.sweep(case, {"lattice.spacing": ["2 mm", "1 mm"], "loading.steps": [10, 20]})

    Args:
        vary: values by dotted key.
        output: folder of the runs' folders; the default is results/NAME-sweep.
        jobs: runs side by side, in processes with the processors divided among them; then the case
            can't have functions or points of Python.
        together: takes the first values of all keys, then the second ones, and so on.
        mode: as in `Case.solve`.
        options: those of `Case.solve`; with jobs only threads, overwrite and quiet, which it is anyway.

    Raises:
        InputError: an unknown key, or a case that can't be run; a note tells which. Not converging is a run's
            `status`.
    """
    rows = _rows(vary, together)
    jobs = _count_of(jobs)
    folder = pathlib.Path(output if output is not None else f"results/{case.name}-sweep").absolute()
    cases = []
    for row, name in zip(rows, _folder_names(rows)):
        changed = _with_mode(case.copy(), mode)
        for key, value in row.items():
            changed.set(key, value)
        changed.set("output.directory", str(folder / name))
        changed._read()  # refuses what is wrong before the first run
        cases.append(changed)
    if jobs > 1:
        return Sweep(rows, _solve_side_by_side(rows, cases, jobs, **options))
    runs = []
    for row, each in zip(rows, cases):
        with _told_by(row):
            runs.append(each.solve(output=each.get("output.directory"), **options))
    return Sweep(rows, runs)


class Sweep(Sequence):
    """Runs of a sweep, in the order of their values: `sweep[0].curve()`.

    Attributes:
        values: the varied keys and values of each run, a list of dicts.
    """

    def __init__(self, values: list[dict], runs: list[Results]):
        self.values, self._runs = values, runs

    def __getitem__(self, k):
        return self._runs[k]

    def __len__(self):
        return len(self._runs)

    def of(self, measure: Callable[[Results], float]) -> numpy.ndarray:
        """A number of each run: `sweep.of(lambda run: abs(run.history["reaction_x:right"]).max())`."""
        return numpy.array([measure(run) for run in self])

    def table(self, **measures: Callable[[Results], float]) -> list[dict]:
        """A dict for each run: its varied values, its status, and the measures by their names."""
        return [
            {**row, "status": run.status, **{name: of(run) for name, of in measures.items()}}
            for row, run in zip(self.values, self, strict=True)
        ]

    def __repr__(self):
        lines = [f"{', '.join(f'{k} = {v}' for k, v in row.items())}: {run.status}" for row, run in zip(self.values, self)]
        return "\n".join([f"<Sweep of {len(self)} runs>", *lines])

    def _repr_html_(self):
        rows = self.table()
        head = "".join(f"<th>{html.escape(name)}</th>" for name in rows[0])
        body = "".join(
            "<tr>" + "".join(f"<td>{html.escape(str(value))}</td>" for value in row.values()) + "</tr>"
            for row in rows
        )
        return f"<table><tr>{head}</tr>{body}</table>"


def _rows(vary, together):
    if not isinstance(vary, Mapping) or not vary:
        raise input_error("vary", repr(vary)[:80], "must have a list of values for each key")
    lists = [_values(key, values) for key, values in vary.items()]
    if together and len({len(values) for values in lists}) != 1:
        raise input_error("vary", "", "must have lists of one length, if taken together")
    combinations = zip(*lists) if together else itertools.product(*lists)
    return [dict(zip(vary, values)) for values in combinations]


def _values(key, values):
    if isinstance(values, (str, Mapping)) or not hasattr(values, "__iter__") or not (found := list(values)):
        raise input_error("vary", f"{key}: {values!r}"[:80], "must have a list of values for each key")
    return found


def _count_of(jobs):
    try:
        count = operator.index(jobs)
    except TypeError:
        count = 0
    if count < 1:
        raise input_error("jobs", repr(jobs)[:80], "must be a whole number from 1")
    return count


def _folder_names(rows):
    """A name for the folder of each run: the same for the same sweep, and no two alike."""
    names = []
    for row in rows:
        whole = ",".join(f"{key}={_word(value)}" for key, value in row.items()).replace("/", "_")
        first = whole.encode(errors="replace")[:200].decode(errors="ignore")
        all_names = itertools.chain([first], (f"{first}-{k}" for k in itertools.count(2)))
        names.append(next(name for name in all_names if name not in names))
    return names


def _word(value):
    return getattr(value, "__name__", None) or str(value)


@contextlib.contextmanager
def _told_by(row):
    try:
        yield
    except InputError as error:
        error.add_note("in the run with " + ", ".join(f"{key} = {_word(value)}" for key, value in row.items()))
        raise


def _solve_side_by_side(rows, cases, jobs, threads=0, overwrite=False, quiet=True, **others):
    if others:
        raise input_error("jobs", str(jobs), f"can't have {', '.join(others)}: runs in processes tell nothing; use jobs=1")
    for case in cases:
        functions, points = case._givens()
        if functions or points is not None:
            raise input_error(
                "jobs", str(jobs), "needs a case without functions or points of Python; use jobs=1"
            )
    threads = thread_count(threads) or max(1, len(os.sched_getaffinity(0)) // jobs)
    at_work = []
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        try:
            return list(pool.map(lambda *of: _solve_aside(*of, threads, truth("overwrite", overwrite), at_work), rows, cases))
        except KeyboardInterrupt:
            pool.shutdown(wait=False, cancel_futures=True)
            for process in at_work:
                process.send_signal(signal.SIGINT)
            raise


def _solve_aside(row, case, threads, overwrite, at_work):
    """Solves a case in a process of its own."""
    told = json.dumps(
        {
            "file": str(case._place()),
            "text": case.text(),
            "settings": case._settings if case._is_file() else [],
            "threads": threads,
            "overwrite": overwrite,
        }
    )
    package = str(pathlib.Path(__file__).resolve().parents[1])
    path = os.pathsep.join(filter(None, [package, os.environ.get("PYTHONPATH")]))
    process = subprocess.Popen(
        [sys.executable, "-c", "from peristat.sweeping import _solve_told; _solve_told()"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        encoding="utf-8",
        env={**os.environ, "PYTHONPATH": path, "PYTHONUTF8": "1"},
    )
    at_work.append(process)
    refused, errors = process.communicate(told)
    if process.returncode == 2 and refused:
        with _told_by(row), case._located_errors():
            raise input_error(*json.loads(refused))
    if process.returncode != 0:
        raise MachineError(f"a run of the sweep ended with {process.returncode}: {errors.strip()[-500:]}")
    return Results(case.get("output.directory"))


def _solve_told():
    """The process of `_solve_aside`, which tells on its output what it refuses."""
    from ._package import load_core
    from .run import _no_line

    told = json.load(sys.stdin)
    core = load_core()
    try:
        case = core.Case(told["file"], told["text"], [tuple(each) for each in told["settings"]], {}, None)
        core.run(case, None, None, _no_line, None, told["threads"], "", told["overwrite"])
    except InputError as error:
        json.dump([error.key, error.value, error.allowed, error.place], sys.stdout)
        sys.exit(2)
