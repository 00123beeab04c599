"""The fit in Python: `peristat.fit`."""

import concurrent.futures
import html
import importlib.util
import os
import pathlib
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy

from .._package import thread_count
from ..case import Case
from ..errors import InputError, input_error
from ..results import Results, open_results
from ..sweeping import _count_of, _solve_aside
from .comparison import WAYS, Comparison
from .curves import Columns, Measured, measured, read_measured, require_one_system
from .outcome import NoCurve, Outcome, document, fit_problem, table
from .parameters import Parameter, parameter
from .problem import REFUSED, Problem, Ran, Specimen
from .record import is_finished, record_finished, status_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DIFFERENCE = 0.02  # relative, of derivatives
STEPS = 30


class Fit:
    """The outcome of a fit.

    Attributes:
        values: the fitted value of each key, as a number in the unit of the case.
        messages: what the data do not determine, and other doubts. Read them.
        is_converged: whether the search has ended at a minimum, its runs have converged, and every value is determined.
        document: all numbers, as in fit.json (docs/fit.md).
    """

    def __init__(self, outcome: Outcome, title: str):
        self._outcome, self._title = outcome, title
        self.document: dict[str, Any] = document(outcome)
        self.messages: list[str] = list(outcome.messages)
        self.is_converged: bool = outcome.is_converged

    @property
    def values(self) -> dict[str, float]:
        return {each["key"]: each["value"] for each in self.document["parameters"]}

    @property
    def settings(self) -> dict[str, Any]:
        """Values by key for `Case.set`: a text where the value has a unit."""
        found = {}
        for each, text in zip(self.document["parameters"], self._outcome.best.point.texts, strict=True):
            found[each["key"]] = text.strip('"') if each["unit"] else float(text)
        return found

    @property
    def standard_deviations(self) -> dict[str, float | None]:
        """None for a value that the data do not determine."""
        return {each["key"]: each["standard_deviation"] for each in self.document["parameters"]}

    @property
    def intervals(self) -> dict[str, tuple[float | None, float | None]]:
        """The 95 % confidence interval of each value."""
        return {each["key"]: (each["low"], each["high"]) for each in self.document["parameters"]}

    @property
    def correlation(self) -> numpy.ndarray:
        """Correlation of the values, NaN where one is not determined."""
        return self._outcome.statistics.correlation

    def run(self, specimen: int = 0) -> Results:
        """The run of a specimen with the fitted values."""
        return open_results(self._outcome.best.point.runs[specimen].folder)

    def plot(self) -> "Figure":
        """Measured and fitted curves, and residuals."""
        from .picture import draw_fit

        return draw_fit(self._outcome, self._title)

    def __repr__(self):
        return "\n".join(["<Fit>", table(self._outcome), *self.messages])

    def _repr_html_(self):
        return f"<pre>{html.escape(repr(self)[6:])}</pre>"


def fit(
    case: Case | Sequence[tuple[Case, Any]],
    data: Any = None,
    over: Sequence[str] = (),
    *,
    start: Mapping[str, Any] | None = None,
    bounds: Mapping[str, tuple[Any, Any]] | None = None,
    x: str | None = None,
    y: str | None = None,
    columns: Sequence[str] | None = None,
    units: tuple[str, str] = ("", ""),
    compare: str = "auto",
    starts: int = 1,
    seed: int = 1,
    difference: float = DIFFERENCE,
    steps: int = STEPS,
    output: str | os.PathLike | None = None,
    jobs: int = 1,
    threads: int = 0,
    overwrite: bool = False,
    quiet: bool = False,
) -> Fit:
    """Fits values of keys to measured curves by least squares, see docs/fit.md.

        fit = ps.fit(case, "curve.csv", ["material.damage.fracture_energy", "material.damage.strength"])
        print(fit.values, fit.messages)

    Args:
        case: of the specimen; or pairs of a case and its data, for several specimens with the same values.
        data: path of a table, or an array with two columns, x and y, and perhaps a third, the standard deviation of y.
        over: the keys. Starting values are those of the (first) case.
        start: other starting values, by key; in the unit of the case.
        bounds: (low, high) by key; None leaves a side open.
        x, y: columns of the history to compare, such as "-reaction_y:load" or "probe_right - probe_left"; the default is
            force over displacement of what the case drives.
        columns: names of the columns of the table.
        units: of x and y in the data; the default are SI units.
        compare: "x", "path" or "auto".
        starts: number of starts; the others are spread around the first one, the same for one `seed`.
        difference: relative, of the central differences that give derivatives.
        steps: most steps of each search.
        output: folder of the runs; default: results/NAME-fit. Finished runs in it are used again.
        jobs: runs side by side, in processes.
        threads, overwrite: as in `Case.solve`.

    Raises:
        InputError: data, keys or columns are wrong, or the case is refused with the starting values.
    """
    if importlib.util.find_spec("scipy") is None:
        raise ImportError("peristat.fit needs SciPy (python3-scipy)")
    pairs = [(case, data)] if isinstance(case, Case) else list(case)
    if not pairs or not all(isinstance(pair, tuple) and len(pair) == 2 and isinstance(pair[0], Case) for pair in pairs):
        raise input_error("case", repr(case)[:80], "must be a case, or pairs of a case and its data")
    if isinstance(over, str) or not over or len(set(over)) != len(over):
        raise input_error("over", repr(over)[:80], "must be a list of different keys")
    require_one_system([of.plain().get("units") for of, _ in pairs])
    require_options(compare, starts, difference, steps)
    curves = [_measured(k, given, columns, units) for k, (_, given) in enumerate(pairs)]
    parameters = _parameters(pairs[0][0], over, start or {}, bounds or {})
    folder = pathlib.Path(output if output is not None else f"results/{pairs[0][0].name}-fit").absolute()
    runs = _Runs([of for of, _ in pairs], parameters, folder, _count_of(jobs), thread_count(threads), overwrite)
    specimens = [Specimen(curve.name, curve, Comparison(curve, compare), Columns(x or "", y or "")) for curve in curves]
    tell = (lambda text: None) if quiet else (lambda text: print(text, flush=True))
    problem = Problem(specimens, parameters, runs, difference, tell)
    try:
        return Fit(fit_problem(problem, starts, seed, steps), f"Fit of {pairs[0][0].get('title') or pairs[0][0].name}")
    except NoCurve as error:
        raise InputError(str(error)) from None


def require_options(compare: str, starts: int, difference: float, steps: int) -> None:
    """Refuses wrong options of a fit."""
    if compare not in WAYS:
        raise input_error("compare", compare, f"must be one of {', '.join(WAYS)}")
    if not 1 <= starts <= 1000:
        raise input_error("starts", str(starts), "must be from 1 to 1000")
    if not 1e-4 <= difference <= 0.3:
        raise input_error("difference", str(difference), "must be from 0.0001 to 0.3")
    if not 1 <= steps <= 1000:
        raise input_error("steps", str(steps), "must be from 1 to 1000")


def _measured(number: int, given: Any, columns: Sequence[str] | None, units: tuple[str, str]) -> Measured:
    if isinstance(given, (str, os.PathLike)):
        return read_measured(pathlib.Path(given), list(columns) if columns is not None else None, units)
    try:
        return measured(numpy.array(given, dtype=float), f"data {number + 1}", units)
    except (TypeError, ValueError):
        raise input_error("data", repr(given)[:80], "must be a path, or rows of numbers") from None


def _parameters(case: Case, over: Sequence[str], start: Mapping, bounds: Mapping) -> list[Parameter]:
    for name, given in (("start", start), ("bounds", bounds)):
        for key in given:
            if key not in over:
                raise input_error(name, key, f"must be one of the fitted keys, {', '.join(over)}")
    return [parameter(key, case.get(key), start.get(key), bounds.get(key)) for key in over]


class _Runs:
    """Runs cases with given values, each in a folder of its own; finished ones are used again."""

    def __init__(self, cases: list[Case], parameters: list[Parameter], folder: pathlib.Path, jobs: int, threads: int, overwrite: bool):
        self._cases, self._parameters, self._folder = cases, parameters, folder
        self._jobs, self._overwrite = jobs, overwrite
        self._threads = threads or (max(1, len(os.sched_getaffinity(0)) // jobs) if jobs > 1 else 0)
        if jobs > 1 and any(points is not None or functions for functions, points in (each._givens() for each in cases)):
            raise input_error("jobs", str(jobs), "needs cases without functions or points of Python; use jobs=1")

    def __call__(self, asked: Sequence[tuple[int, tuple[str, ...]]]) -> list[Ran]:
        with concurrent.futures.ThreadPoolExecutor(self._jobs) as pool:
            if self._jobs > 1:
                return list(pool.map(lambda each: self._run(*each), asked))
        return [self._run(*each) for each in asked]

    def _run(self, number: int, texts: tuple[str, ...]) -> Ran:
        values = [text.strip('"') if text[0] == '"' else float(text) for text in texts]
        row = {each.key: value for each, value in zip(self._parameters, values, strict=True)}
        folder = self._folder / f"specimen_{number + 1}" / run_name(self._parameters, texts)
        case = self._cases[number].copy()
        for key, value in row.items():
            case.set(key, value)
        text, settings = case.text().encode(), [f"{key}={value}" for key, value in case._settings if case._is_file()]
        functions, points = case._givens()
        has_givens = points is not None or bool(functions)
        if not has_givens and is_finished(folder, text, settings):
            return Ran(folder, *status_of(folder))
        case.set("output.directory", str(folder))
        try:
            if self._jobs > 1:
                _solve_aside(row, case, self._threads, self._overwrite, [])
            else:
                case.solve(output=folder, threads=self._threads, overwrite=self._overwrite, quiet=True)
        except InputError as error:
            if error.key == "output.directory" or "another case" in str(error):
                raise
            return Ran(folder, REFUSED, str(error))
        if not has_givens:
            record_finished(folder, text, settings)
        return Ran(folder, *status_of(folder))


def run_name(parameters: Sequence[Parameter], texts: Sequence[str]) -> str:
    """Name of a run's folder: the last part of each key with its value."""
    parts = [f"{each.key.rpartition('.')[2]}={text.strip(chr(34)).replace(' ', '')}" for each, text in zip(parameters, texts, strict=True)]
    return "".join(c if c.isalnum() or c in "=,.+-_[]" else "_" for c in ",".join(parts))
