"""Integrity T(s) of a bond and its moment M(s), the integral of r T(r) (docs/theory.md, Damage)."""

import numpy

# Composite Gauss-Legendre quadrature: 40 panels of 12 nodes take a sigmoid as steep as rate 50 over
# the range to 1e-15.
NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(12)
PANELS = 40
FRACTIONS = ((numpy.arange(PANELS)[:, None] + (NODES + 1) / 2) / PANELS).ravel()
SHARES = numpy.tile(WEIGHTS / 2 / PANELS, PANELS)


class Elastic:
    """No damage at any stretch."""

    onset = critical = numpy.inf

    def integrity(self, stretch):
        return numpy.ones_like(stretch)

    def moment(self, stretch):
        return stretch**2 / 2


class Law:
    """A law by its table in the case file."""

    def __init__(self, table):
        self.name, self.critical, self.rate = table["law"], float(table["critical"]), float(table["rate"])
        self.onset = self.critical if self.name == "critical_stretch" else float(table["onset"])

    def published(self, stretch):
        """Equation 12 of [ADAPT], between onset and critical stretch."""
        argument = self.rate * (self.onset + self.critical - 2 * stretch) / (self.onset - self.critical)
        return (1 - numpy.tanh(argument)) / 2

    def softening(self, stretch):
        if self.name == "tanh":
            return self.published(stretch)
        start, end = self.published(self.onset), self.published(self.critical)
        return (self.published(stretch) - end) / (start - end)

    def integrity(self, stretch):
        """1 up to the onset, 0 from the critical stretch on; of a complex number by its real part."""
        real = numpy.real(stretch)
        value = numpy.where(real >= self.critical, 0.0, 1.0).astype(numpy.asarray(stretch).dtype)
        between = (real > self.onset) & (real < self.critical)
        if between.any():
            value[between] = self.softening(stretch[between])
        return value

    def moment(self, stretch):
        real = numpy.real(stretch)
        low = numpy.where(real < self.onset, stretch, self.onset)
        top = numpy.where(real < self.critical, stretch, self.critical)
        value = low**2 / 2
        beyond = real > self.onset
        if self.onset < self.critical and beyond.any():
            span = top[beyond] - self.onset
            at = self.onset + span[:, None] * FRACTIONS
            value[beyond] += span * (at * self.softening(at) @ SHARES)
        return value
