"""How a computed curve is compared with a measured one."""

from dataclasses import dataclass

import numpy

from ..errors import InputError
from .curves import Curve, Measured

WAYS = ("auto", "x", "path")
LEAST_COVERAGE = 0.2  # share of the measured points that a run must reach
DENSE = 2000  # points of a computed curve along its way


@dataclass(frozen=True)
class Residual:
    """Differences of the points, computed less measured, in units of the noise or of the largest measured value."""

    values: numpy.ndarray  # one per point, or two with way "path"; NaN if the run does not reach enough points
    fitted: Curve  # of the computed curve, at each measured point; NaN beyond its end
    coverage: float  # share of the measured points that the run reaches


class Comparison:
    """Compares curves in one of two ways.

    x: y at the measured x. The computed curve is taken as a test under a growing x sees it: where x falls back, the
       curve jumps at this x. Measured x must grow or fall throughout.
    path: the distance of each measured point to the computed curve, in units of the largest values (or of the noise of
       y, which x then has in the same proportion). The points are matched in order: the places on the computed curve
       never go backwards, and of all such matches that with the least sum of squares is taken.

    Points beyond the end of the computed curve are not compared; the others count for them, so that a run gains nothing
    by ending early.
    """

    def __init__(self, measured: Measured, way: str = "auto"):
        self._measured = measured
        x, y = measured.curve.x, measured.curve.y
        falls = bool((numpy.diff(x) <= 0.0).all())
        is_monotone = falls or bool((numpy.diff(x) >= 0.0).all())
        if way == "x" and not is_monotone:
            raise InputError(f"{measured.name}: x does not grow throughout, so y can't be compared at x; use compare = path")
        self.way = way if way != "auto" else "x" if is_monotone else "path"
        self._direction = -1.0 if falls else 1.0
        self._size = numpy.abs(y).max() if measured.noise is None else measured.noise
        self._x_size = numpy.abs(x).max() * self._size / numpy.abs(y).max()

    @property
    def points(self) -> int:
        return len(self._measured.curve.x)

    def residual(self, found: Curve) -> Residual:
        if len(found.x) < 2:
            nothing = numpy.full(self.points, numpy.nan)
            return Residual(numpy.full(self.points * (1 + (self.way == "path")), numpy.nan), Curve(nothing, nothing), 0.0)
        return self._at_x(found) if self.way == "x" else self._along(found)

    def _at_x(self, found: Curve) -> Residual:
        curve = self._measured.curve
        x, y = under_growing_x(Curve(self._direction * found.x, found.y))
        at, slack = self._direction * curve.x, 1e-6 * numpy.ptp(curve.x)
        reached = (at >= x[0] - slack) & (at <= x[-1] + slack)
        fitted = numpy.where(reached, numpy.interp(at, x, y), numpy.nan)
        return self._residual((fitted - curve.y) / self._size, reached, Curve(curve.x, fitted))

    def _along(self, found: Curve) -> Residual:
        curve = self._measured.curve
        x_scale, y_scale = numpy.abs(curve.x).max(), numpy.abs(curve.y).max()
        way = numpy.concatenate([[0.0], numpy.cumsum(numpy.hypot(numpy.diff(found.x) / x_scale, numpy.diff(found.y) / y_scale))])
        place = numpy.linspace(0.0, way[-1], DENSE)
        x, y = numpy.interp(place, way, found.x), numpy.interp(place, way, found.y)
        differences = numpy.stack([(x - curve.x[:, None]) / x_scale, (y - curve.y[:, None]) / y_scale])
        matched = in_order((differences**2).sum(axis=0))
        shifts = _to_line(numpy.stack([x / x_scale, y / y_scale]), numpy.stack([curve.x / x_scale, curve.y / y_scale]), matched)
        fitted = Curve(curve.x + shifts[0] * x_scale, curve.y + shifts[1] * y_scale)
        # Points matched with the end lie beyond it, but for one of them.
        beyond = matched == DENSE - 1
        beyond[numpy.argmax(beyond)] = False
        reached = ~beyond
        values = numpy.stack([shifts[0] * x_scale / self._x_size, shifts[1] * y_scale / self._size])
        return self._residual(values, reached, Curve(*(numpy.where(reached, of, numpy.nan) for of in (fitted.x, fitted.y))))

    def _residual(self, values: numpy.ndarray, reached: numpy.ndarray, fitted: Curve) -> Residual:
        coverage = float(reached.mean())
        if coverage < LEAST_COVERAGE:
            return Residual(numpy.full(values.size, numpy.nan), fitted, coverage)
        return Residual((numpy.where(reached, values, 0.0) / coverage**0.5).ravel(), fitted, coverage)


def under_growing_x(found: Curve) -> tuple[numpy.ndarray, numpy.ndarray]:
    """The curve that a test under a growing x sees: it jumps where x falls back, to where x is exceeded again."""
    xs, ys = [found.x[0]], [found.y[0]]
    for k in range(1, len(found.x)):
        if found.x[k] <= xs[-1]:
            continue
        if found.x[k - 1] < xs[-1]:  # x comes back to the largest so far within this step
            share = (xs[-1] - found.x[k - 1]) / (found.x[k] - found.x[k - 1])
            ys.append(found.y[k - 1] + share * (found.y[k] - found.y[k - 1]))
            xs.append(numpy.nextafter(xs[-1], numpy.inf))
        xs.append(found.x[k])
        ys.append(found.y[k])
    return numpy.array(xs), numpy.array(ys)


def in_order(costs: numpy.ndarray) -> numpy.ndarray:
    """For each row a column, never to the left of the row's before, with the least sum of costs."""
    total = numpy.empty_like(costs)
    total[0] = costs[0]
    for k in range(1, len(costs)):
        total[k] = costs[k] + numpy.minimum.accumulate(total[k - 1])
    places = numpy.empty(len(costs), dtype=int)
    last = costs.shape[1]
    for k in reversed(range(len(costs))):
        places[k] = int(total[k, :last].argmin())
        last = places[k] + 1
    return places


def _to_line(line: numpy.ndarray, points: numpy.ndarray, nearest: numpy.ndarray) -> numpy.ndarray:
    """From each point to the pieces of the line beside its nearest vertex: the shorter way."""
    best = line[:, nearest] - points
    for step in (-1, 1):
        other = numpy.clip(nearest + step, 0, line.shape[1] - 1)
        begin, along = line[:, nearest], line[:, other] - line[:, nearest]
        length = (along**2).sum(axis=0)
        share = numpy.clip(((points - begin) * along).sum(axis=0) / numpy.where(length > 0.0, length, 1.0), 0.0, 1.0)
        way = begin + share * along - points
        best = numpy.where((way**2).sum(axis=0) < (best**2).sum(axis=0), way, best)
    return best
