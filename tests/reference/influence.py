"""Influence functions of bonds (docs/theory.md), in powers of the distance over the horizon."""

import numpy

POWERS = {
    "constant": {0: 1},
    "piecewise_constant": {0: 1},
    "linear": {0: 1, 1: -1},
    "cubic": {0: 1, 2: -3, 3: 2},
    "quintic": {0: 1, 3: -10, 4: 15, 5: -6},
    "septic": {0: 1, 4: -35, 5: 84, 6: -70, 7: 20},
    "inverse": {-1: 1},
}
EVERYWHERE = ("constant", "gaussian", "inverse")  # functions that do not vanish beyond the horizon
ROUND_OFF = 1e-8


def influence(name, ratio):
    """omega at distances over the horizon."""
    ratio = numpy.where(abs(ratio - 1) <= ROUND_OFF, 1.0, ratio)
    if name == "gaussian":
        return numpy.exp(-(ratio**2))
    value = sum(factor * ratio**power for power, factor in POWERS[name].items())
    inside = ratio <= 1 if name not in EVERYWHERE else True
    return numpy.where(inside & (value >= ROUND_OFF), value, 0.0)


def relative_moment(name, power):
    """int omega x^power dx over int x^power dx from 0 to 1."""
    if name == "gaussian":
        x, weights = numpy.polynomial.legendre.leggauss(40)
        return (power + 1) * (numpy.exp(-(((x + 1) / 2) ** 2)) * ((x + 1) / 2) ** power * weights).sum() / 2
    return (power + 1) * sum(factor / (power + own + 1) for own, factor in POWERS[name].items())
