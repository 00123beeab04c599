"""The search for the least sum of squares, from one start or several."""

from dataclasses import dataclass

import numpy

from .problem import NoDerivative, Point, Problem, gradient_of

# The search has converged if a step changes the values by less than this, relative, ...
STEP = 3e-4
# ... or the sum of squares: a hundredth of what noise in 100 points changes it by.
COST = 1e-4


@dataclass(frozen=True)
class Found:
    """Where the search from one start has ended."""

    start: tuple[str, ...]
    place: numpy.ndarray
    point: Point
    gradients: int
    reason: str
    is_converged: bool


def search(problem: Problem, starts: list[numpy.ndarray], most: int) -> list[Found]:
    """Searches from each start with Gauss-Newton steps within a trust region (scipy.optimize.least_squares).

    Values that a case refuses, and runs that end too early, shorten the step.

    Returns:
        list[Found]: the best first; without starts that have no curve.
    """
    at_starts = problem.at(starts)
    found = []
    for number, (start, point) in enumerate(zip(starts, at_starts, strict=True), 1):
        why = next((ran.reason for ran in point.runs if ran.reason), "the run ends too early")
        if numpy.isfinite(point.values).all():
            try:
                found.append(_search(problem, start, number, most))
                continue
            except NoDerivative as error:
                why = str(error)
        problem.tell(f"start {number} is left out: {why}")
    return sorted(found, key=lambda each: each.point.sum_of_squares)


def _search(problem: Problem, start: numpy.ndarray, number: int, most: int) -> Found:
    from scipy.optimize import least_squares

    count = {"runs": 0, "gradients": 0}

    def values(place: numpy.ndarray) -> numpy.ndarray:
        count["runs"] += 1
        point = problem.at([place])[0]
        size = (point.sum_of_squares / problem.points) ** 0.5
        named = ", ".join(f"{each.key} = {text.strip(chr(34))}" for each, text in zip(problem.parameters, point.texts, strict=True))
        problem.tell(f"start {number}, {count['runs']}: {named}: residual {size:.3e}")
        return point.values

    def derivatives(place: numpy.ndarray) -> numpy.ndarray:
        count["gradients"] += 1
        return gradient_of(problem, place)[0]

    low = numpy.array([each.coordinate(each.low) for each in problem.parameters])
    high = numpy.array([each.coordinate(each.high) for each in problem.parameters])
    inside = numpy.clip(start, low + 1e-9, high - 1e-9)
    ended = least_squares(values, inside, derivatives, bounds=(low, high), xtol=STEP, ftol=COST, gtol=1e-12, max_nfev=most)
    point = problem.at([ended.x])[0]
    problem.tell(f"start {number} ended: {ended.message.rstrip('.')}")
    return Found(problem.texts(start), ended.x, point, count["gradients"], ended.message, ended.status > 0)
