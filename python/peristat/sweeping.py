"""One case with many values of its keys."""

import concurrent.futures
import html
import itertools
import json
import os
import pathlib
import subprocess
import sys
from collections.abc import Callable, Mapping, Sequence

import numpy

from .case import Case
from .errors import InputError, MachineError, input_error
from .results import Results


def sweep(
    case: Case,
    vary: Mapping[str, Sequence],
    *,
    output: str | os.PathLike | None = None,
    jobs: int = 1,
    together: bool = False,
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
        options: those of `Case.solve`; with jobs only threads and overwrite.

    Raises:
        InputError: an unknown key, or a case that can't be run. Not converging is a run's `status`.
    """
    rows = _rows(vary, together)
    folder = pathlib.Path(output if output is not None else f"results/{case.name}-sweep")
    cases = []
    for row in rows:
        changed = case.copy()
        for key, value in row.items():
            changed.set(key, value)
        name = ",".join(f"{key}={_word(value)}" for key, value in row.items()).replace("/", "_")
        changed.set("output.directory", str((folder / name).absolute()))
        changed._read()  # refuses what is wrong before the first run
        cases.append(changed)
    if jobs > 1:
        return Sweep(rows, _solve_side_by_side(cases, jobs, **options))
    return Sweep(rows, [each.solve(output=each.get("output.directory"), **options) for each in cases])


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
    if not vary or any(isinstance(values, str) or not len(values) for values in vary.values()):
        raise input_error("vary", repr(dict(vary))[:80], "must have a list of values for each key")
    lists = [list(values) for values in vary.values()]
    if together and len({len(values) for values in lists}) != 1:
        raise input_error("vary", "", "must have lists of one length, if taken together")
    combinations = zip(*lists) if together else itertools.product(*lists)
    return [dict(zip(vary, values)) for values in combinations]


def _word(value):
    return getattr(value, "__name__", None) or str(value)


def _solve_side_by_side(cases, jobs, threads=0, overwrite=False):
    for case in cases:
        functions, points = case._givens()
        if functions or points is not None:
            raise input_error(
                "jobs", str(jobs), "needs a case without functions or points of Python; use jobs=1"
            )
    threads = threads or max(1, len(os.sched_getaffinity(0)) // jobs)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        return list(pool.map(lambda case: _solve_aside(case, threads, overwrite), cases))


def _solve_aside(case, threads, overwrite):
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
    done = subprocess.run(
        [sys.executable, "-c", "from peristat.sweeping import _solve_told; _solve_told()"],
        input=told,
        capture_output=True,
        text=True,
        env={**os.environ, "PYTHONPATH": path},
    )
    if done.returncode == 2:
        raise InputError(done.stderr.strip())
    if done.returncode != 0:
        raise MachineError(f"a run of the sweep ended with {done.returncode}: {done.stderr.strip()[-500:]}")
    return Results(case.get("output.directory"))


def _solve_told():
    """The process of `_solve_aside`."""
    from ._package import load_core
    from .run import _no_line

    told = json.load(sys.stdin)
    core = load_core()
    try:
        case = core.Case(told["file"], told["text"], [tuple(each) for each in told["settings"]], {}, None)
        core.run(case, None, None, _no_line, told["threads"], "", told["overwrite"])
    except InputError as error:
        print(error, file=sys.stderr)
        sys.exit(2)
