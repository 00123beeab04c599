"""The outcome of a fit: its numbers, as a table, as JSON and as curves."""

import csv
import io
import math
from dataclasses import dataclass

import numpy

from ..errors import InputError
from .comparison import Residual
from .parameters import scattered
from .problem import Problem, Specimen
from .search import Found, search
from .statistics import CONFIDENCE, Statistics, statistics

SIGN = '"format": "peristat fit"'  # of fit.json
CURVES = "specimen,x,y,fitted_x,fitted_y"  # first line of the table of curves
SAME = 1.01  # of sums of squares of starts that have ended at one place


class NoCurve(Exception):
    """No start has a curve that can be compared."""


@dataclass(frozen=True)
class Outcome:
    problem: Problem
    found: list[Found]  # from each start, the best first
    statistics: Statistics
    messages: list[str]

    @property
    def best(self) -> Found:
        return self.found[0]

    @property
    def is_converged(self) -> bool:
        """Whether the search has ended at a minimum, with runs that have converged, and every value is determined."""
        return (
            self.best.is_converged
            and all(ran.status == "completed" for ran in self.best.point.runs)
            and all(each.deviation is not None for each in self.statistics.estimates)
        )


def fit_problem(problem: Problem, starts: int, seed: int, most: int) -> Outcome:
    """Searches from the starting values, and from others that are spread around them.

    Raises:
        InputError: the case is refused with the starting values, or data and columns do not belong together.
        NoCurve: no start has a curve.
    """
    places = scattered(problem.parameters, starts, seed)
    problem.begin(places[0])
    for specimen in problem.specimens:
        data = specimen.measured
        of = f" of {data.columns}" if data.columns else ""
        problem.tell(f"{data.name}: {specimen.comparison.points} points{of}; {_told_way(specimen)}")
    if problem.points <= len(problem.parameters):
        raise InputError(f"{len(problem.parameters)} parameters need more than {problem.points} measured points")
    found = search(problem, places, most)
    if not found:
        raise NoCurve("no start has a run that reaches a fifth of the measured points")
    told = statistics(problem, found[0])
    return Outcome(problem, found, told, [*told.messages, *_messages(problem, found, starts)])


def _told_way(specimen: Specimen) -> str:
    columns = specimen.columns
    if specimen.comparison.way == "x":
        return f"compares {columns.y} at the measured values of {columns.x}"
    return f"compares distances to the curve of {columns.y} over {columns.x}, matched in order along it"


def _messages(problem: Problem, found: list[Found], starts: int) -> list[str]:
    best, told = found[0], []
    if not best.is_converged:
        told.append(f"the search has not converged: {best.reason.rstrip('.')}")
    for specimen, ran, residual in zip(problem.specimens, best.point.runs, best.point.residuals, strict=True):
        if ran.status != "completed":
            told.append(f"{specimen.name}: the run with the fitted values did not complete ({ran.reason or ran.status})")
        if residual.coverage < 1.0:
            left = round((1.0 - residual.coverage) * specimen.comparison.points)
            told.append(f"{specimen.name}: {left} of {specimen.comparison.points} points are not compared: they lie beyond the end "
                        "of the run")  # fmt: skip
    apart = sum(each.point.sum_of_squares > SAME * best.point.sum_of_squares for each in found)
    if apart:
        told.append(f"{apart} of {len(found)} starts have ended at larger sums of squares: there are other minima")
    if len(found) < starts:
        told.append(f"{starts - len(found)} of {starts} starts have no run that can be compared")
    return told


# ----------------------------------------------------------------------------------------- numbers


def document(outcome: Outcome) -> dict:
    """The content of fit.json."""
    problem, told, best = outcome.problem, outcome.statistics, outcome.best
    return {
        "format": "peristat fit",
        "is_converged": outcome.is_converged,
        "reason": best.reason,
        "confidence": CONFIDENCE,
        "parameters": [
            {
                "key": each.parameter.key,
                "unit": each.parameter.unit,
                "value": each.value,
                "setting": f"{each.parameter.key}={text}",
                "standard_deviation": each.deviation,
                "low": each.low,
                "high": _finite(each.high),
                "start": each.parameter.start,
                "bounds": [_finite(each.parameter.low), _finite(each.parameter.high)],
                "scatter_of_derivative": each.scatter,
            }
            for each, text in zip(told.estimates, best.point.texts, strict=True)
        ],
        "correlation": [[_finite(value) for value in row] for row in told.correlation.tolist()],
        "residual": told.residual,
        "independent_points": told.independent,
        "difference": problem.difference,
        "specimens": [
            {
                "data": specimen.name,
                "points": specimen.comparison.points,
                "x": specimen.columns.x,
                "y": specimen.columns.y,
                "compared": specimen.comparison.way,
                "coverage": residual.coverage,
                "root_mean_square": _root_mean_square(specimen, residual),
                "run": str(ran.folder),
                "status": ran.status,
            }
            for specimen, ran, residual in zip(problem.specimens, best.point.runs, best.point.residuals, strict=True)
        ],
        "starts": [
            {"start": list(each.start), "end": list(each.point.texts), "sum_of_squares": each.point.sum_of_squares,
             "gradients": each.gradients, "is_converged": each.is_converged}
            for each in outcome.found
        ],
        "messages": outcome.messages,
    }  # fmt: skip


def _finite(value: float | None) -> float | None:
    return value if value is not None and math.isfinite(value) else None


def _root_mean_square(specimen: Specimen, residual: Residual) -> float:
    return float(numpy.linalg.norm(residual.values) / specimen.comparison.points**0.5)


def table(outcome: Outcome) -> str:
    """Values, standard deviations, confidence intervals and correlations as lines of text."""
    told = outcome.statistics
    rows = [["key", "value", "standard deviation", "95 % confidence", "unit"]]
    for each in told.estimates:
        if each.deviation is None:
            rows.append([each.parameter.key, f"{each.value:.5g}", "not determined", "", each.parameter.unit])
            continue
        share = f" ({100.0 * each.deviation / abs(each.value):.2g} %)" if each.value else ""
        rows.append([each.parameter.key, f"{each.value:.5g}", f"{each.deviation:.2g}{share}",
                     f"{each.low:.5g} to {each.high:.5g}", each.parameter.unit])  # fmt: skip
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    lines = ["  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip() for row in rows]
    if len(told.estimates) > 1:
        lines += ["", "correlation"]
        for each, row in zip(told.estimates, told.correlation, strict=True):
            numbers = "  ".join("     -" if math.isnan(value) else f"{value:+.3f}" for value in row)
            lines.append(f"{each.parameter.key.ljust(widths[0])}  {numbers}")
    return "\n".join(lines)


def curves_table(outcome: Outcome) -> str:
    """Measured and fitted points, in SI units; a point that is not compared has no fitted one."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    text.write(CURVES + "\n")
    for specimen, residual in zip(outcome.problem.specimens, outcome.best.point.residuals, strict=True):
        data, fitted = specimen.measured.curve, residual.fitted
        for numbers in zip(data.x.tolist(), data.y.tolist(), fitted.x.tolist(), fitted.y.tolist(), strict=True):
            has_fitted = math.isfinite(numbers[3])
            writer.writerow([specimen.name, *numbers[:2], *(numbers[2:] if has_fitted else ("", ""))])
    return text.getvalue()
