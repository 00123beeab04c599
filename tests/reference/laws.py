"""Integrity T(s) of a bond and its moment M(s), the integral of r T(r) (docs/theory.md, Damage)."""

import numpy

# Composite Gauss-Legendre quadrature: 40 panels of 12 nodes take a sigmoid as steep as rate 50 over
# the range to 1e-15.
NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(12)
PANELS = 40
FRACTIONS = ((numpy.arange(PANELS)[:, None] + (NODES + 1) / 2) / PANELS).ravel()
SHARES = numpy.tile(WEIGHTS / 2 / PANELS, PANELS)


class Law:
    """Laws of bonds: numbers for all of them, or arrays with an entry for each."""

    def __init__(self, name, onset, critical, rate):
        self.name, self.onset, self.critical, self.rate = name, onset, critical, rate

    @classmethod
    def of_table(cls, table):
        """By its table in the case file."""
        name, critical = table["law"], float(table["critical"])
        return cls(name, critical if name == "critical_stretch" else float(table["onset"]), critical, float(table["rate"]))

    @classmethod
    def elastic(cls):
        """No damage at any stretch."""
        return cls("none", numpy.inf, numpy.inf, 3.0)

    def of(self, bonds):
        """Those of some of the bonds."""
        parts = (self.name, self.onset, self.critical, self.rate)
        return Law(*(part[bonds] if numpy.ndim(part) else part for part in parts))

    def spread(self, count):
        """An entry for each."""
        return Law(*(numpy.broadcast_to(part, count) for part in (self.name, self.onset, self.critical, self.rate)))

    def published(self, stretch):
        """Equation 12 of [ADAPT], between onset and critical stretch."""
        argument = self.rate * (self.onset + self.critical - 2 * stretch) / (self.onset - self.critical)
        return (1 - numpy.tanh(argument)) / 2

    def softening(self, stretch):
        start, end = self.published(self.onset), self.published(self.critical)
        rescaled = (self.published(stretch) - end) / (start - end)
        return numpy.where(self.name == numpy.array("tanh"), self.published(stretch), rescaled)

    def integrity(self, stretch):
        """1 up to the onset, 0 from the critical stretch on; of a complex number by its real part."""
        real = numpy.real(stretch)
        value = numpy.where(real >= self.critical, 0.0, 1.0).astype(numpy.asarray(stretch).dtype)
        between = (real > self.onset) & (real < self.critical)
        if between.any():
            value[between] = self.spread(real.shape).of(between).softening(stretch[between])
        return value

    def moment(self, stretch):
        real = numpy.real(stretch)
        low = numpy.where(real < self.onset, stretch, self.onset)
        top = numpy.where(real < self.critical, stretch, self.critical)
        value = low**2 / 2
        beyond = (real > self.onset) & (numpy.asarray(self.onset) < self.critical)
        if beyond.any():
            law = self.spread(real.shape).of(beyond)
            rows = Law(law.name[:, None], law.onset[:, None], law.critical[:, None], law.rate[:, None])
            span = top[beyond] - law.onset
            at = rows.onset + span[:, None] * FRACTIONS
            value[beyond] += span * (at * rows.softening(at) @ SHARES)
        return value
