"""What the data determine: standard deviations, confidence intervals, correlations, and what they leave open."""

from dataclasses import dataclass

import numpy

from .parameters import Parameter
from .problem import Problem, gradient_of
from .search import Found

CONFIDENCE = 0.95
SINGULAR = 1e-6  # smallest singular value of a determined direction, relative, of columns of length 1
SENSITIVE = 1e-6  # least change of a curve, relative to its largest value, that a change by a factor e makes
TOGETHER = 0.99  # correlation of parameters that are determined only together
SERIAL = 0.5  # correlation of neighbouring residuals that is worth a message
SCATTERED = 0.5  # scatter of a derivative, relative, beyond which it means little; pure scatter has 1


@dataclass(frozen=True)
class Estimate:
    """A parameter's value and what the data say about it, in the unit of the case."""

    parameter: Parameter
    value: float
    deviation: float | None  # standard deviation; None: not determined
    low: float | None  # of the confidence interval
    high: float | None
    scatter: float | None  # of the derivative, relative


@dataclass(frozen=True)
class Statistics:
    estimates: list[Estimate]
    correlation: numpy.ndarray  # NaN where a parameter is not determined
    residual: float  # standard deviation of the residuals, in units of the noise or of the largest value
    independent: float  # number of independent points
    messages: list[str]


def statistics(problem: Problem, found: Found) -> Statistics:
    """Linear estimates at the least sum of squares S of n points with p parameters.

    The covariance of the coordinates is s^2 (J^T J)^-1 n / n', where s^2 = S / (n - p), or 1 if the noise is known and
    larger, and n' = n (1 - a) / (1 + a) is the number of independent points if neighbouring residuals have the
    correlation a > 0: a model's own error is no noise. Confidence intervals are those of Student's t with n' - p degrees
    of freedom; for positive parameters they are symmetric in the logarithm.
    """
    from scipy.stats import t

    jacobian, scatter = gradient_of(problem, found.place)
    parameters, count = problem.parameters, problem.points
    free = max(count - len(parameters), 1)
    variance = found.point.sum_of_squares / free
    if all(each.measured.noise is not None for each in problem.specimens):
        variance = max(variance, 1.0)
    serial = _serial_correlation(problem, found)
    independent = max(count * (1.0 - serial) / (1.0 + serial), len(parameters) + 1.0)
    covariance, is_determined = _inverse(jacobian)
    covariance *= variance * count / independent
    is_determined &= ~(numpy.nan_to_num(scatter) > SCATTERED)
    deviation = numpy.where(is_determined, numpy.sqrt(numpy.diag(covariance)), numpy.inf)
    factor = t.ppf(0.5 + 0.5 * CONFIDENCE, max(independent - len(parameters), 1.0))
    estimates = [_estimate(each, q, own, factor * own, spread)
                 for each, q, own, spread in zip(parameters, found.place, deviation, scatter, strict=True)]  # fmt: skip
    with numpy.errstate(invalid="ignore"):
        correlation = covariance / numpy.sqrt(numpy.outer(numpy.diag(covariance), numpy.diag(covariance)))
    correlation[~is_determined] = correlation[:, ~is_determined] = numpy.nan
    messages = [*_undetermined(estimates, jacobian, scatter), *_at_bounds(estimates, found.place), *_together(parameters, correlation)]
    if serial > SERIAL and variance**0.5 > SENSITIVE:
        messages.append(f"neighbouring residuals have a correlation of {serial:.2f}: they are errors of the model or of the "
                        f"measurement rather than noise. The standard deviations count {independent:.0f} of {count} points as "
                        "independent, and do not contain the error of a model that can't follow the data")  # fmt: skip
    return Statistics(estimates, correlation, variance**0.5, independent, messages)


def _inverse(jacobian: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
    """(J^T J)^-1 on what J determines, and which parameters that are."""
    size = numpy.linalg.norm(jacobian, axis=0)
    is_felt = size > SENSITIVE * len(jacobian) ** 0.5
    scale = numpy.where(is_felt, size, 1.0)
    _, singular, rows = numpy.linalg.svd(numpy.where(is_felt, jacobian / scale, 0.0), full_matrices=False)
    is_good = singular > SINGULAR * singular[0]
    inverse = (rows[is_good].T / singular[is_good] ** 2) @ rows[is_good] / numpy.outer(scale, scale)
    open_share = (rows[~is_good] ** 2).sum(axis=0)
    return inverse, is_felt & (open_share < 1e-2)


def _estimate(each: Parameter, q: float, deviation: float, half: float, scatter: float) -> Estimate:
    value, spread = each.value(q), None if numpy.isnan(scatter) else float(scatter)
    if not numpy.isfinite(deviation):
        return Estimate(each, value, None, None, None, spread)
    slope = value if each.is_log else each.size
    with numpy.errstate(over="ignore"):
        ends = [each.value(min(q + sign * half, 700.0)) for sign in (-1, 1)]
    return Estimate(each, value, slope * deviation, ends[0], ends[1], spread)


def _undetermined(estimates: list[Estimate], jacobian: numpy.ndarray, scatter: numpy.ndarray) -> list[str]:
    told = []
    for k, each in enumerate(estimates):
        key = each.parameter.key
        if each.deviation is None and numpy.linalg.norm(jacobian[:, k]) <= SENSITIVE * len(jacobian) ** 0.5:
            told.append(f"{key} is not determined: the computed curve does not depend on it")
        elif each.deviation is None and scatter[k] > SCATTERED:
            told.append(f"{key} is not determined: the curve depends on it less than by the pieces it is made of")
        elif each.deviation is None:
            told.append(f"{key} is not determined by itself: others can make up for it")
        elif each.high - each.low > 2.0 * abs(each.value):  # type: ignore[operator]  # there with the deviation
            told.append(f"{key} is hardly determined: its confidence interval is wider than twice its value")
    return told


def _at_bounds(estimates: list[Estimate], place: numpy.ndarray) -> list[str]:
    told = []
    for each, q in zip(estimates, place, strict=True):
        own = each.parameter
        for bound in (own.low, own.high):
            if abs(q - own.coordinate(bound)) < 1e-3:
                told.append(f"{own.key} is at its bound {bound:g}: the data ask for values beyond it")
    return told


def _together(parameters: list[Parameter], correlation: numpy.ndarray) -> list[str]:
    pairs = zip(*numpy.triu_indices(len(parameters), 1), strict=True)
    return [f"{parameters[i].key} and {parameters[k].key} are determined only together: their correlation is {correlation[i, k]:.3f}"
            for i, k in pairs if abs(correlation[i, k]) > TOGETHER]  # fmt: skip


def _serial_correlation(problem: Problem, found: Found) -> float:
    """Correlation of neighbouring residuals, from 0 to below 1, over all specimens."""
    products, squares = 0.0, 0.0
    for specimen, residual in zip(problem.specimens, found.point.residuals, strict=True):
        for part in residual.values.reshape(-1, specimen.comparison.points):
            products += float(part[1:] @ part[:-1])
            squares += float(part @ part)
    return min(max(products / squares, 0.0), 0.999) if squares > 0.0 else 0.0
