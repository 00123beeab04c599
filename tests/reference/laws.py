"""Integrity T(s) of a bond and its moment M(s), the integral of r T(r) (docs/theory.md, Damage)."""

import itertools

import numpy

# Composite Gauss-Legendre quadrature: 40 panels of 12 nodes integrate a sigmoid as steep as rate 50 over
# the range to 1e-15.
NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(12)
PANELS = 40
FRACTIONS = ((numpy.arange(PANELS)[:, None] + (NODES + 1) / 2) / PANELS).ravel()
SHARES = numpy.tile(WEIGHTS / 2 / PANELS, PANELS)


def petersson(x):
    """Stress over strength, and its slope, at a share of the opening at which no stress is left."""
    is_steep = numpy.real(x) <= 2 / 9
    return numpy.where(is_steep, 1 - 3 * x, 3 / 7 * (1 - x)), numpy.where(is_steep, -3.0, -3 / 7)


def cornelissen(x):
    fall, end = numpy.exp(-6.93 * x), 28 * numpy.exp(-6.93)
    return (1 + (3 * x) ** 3) * fall - x * end, (81 * x**2 - 6.93 * (1 + (3 * x) ** 3)) * fall - end


CURVES = {"bilinear": petersson, "cornelissen": cornelissen}


def ends_of(table):
    """Onset and critical stretch of the law table: the last pair of the elastic part, and the last pair."""
    pairs = list(zip(table["stretches"], table["forces"], strict=True))
    elastic = list(itertools.takewhile(lambda pair: abs(pair[1] - pair[0]) <= 1e-6 * pair[0], pairs))
    return {"onset": elastic[-1][0], "critical": pairs[-1][0]}


def curve_of(table):
    """Stretches and forces of the law table from the origin on, over its last stretch; None for another law."""
    if table["law"] != "table":
        return None
    return tuple(numpy.array([0.0, *table[key]]) / table["stretches"][-1] for key in ("stretches", "forces"))


class Law:
    """Laws of bonds: numbers for all bonds, or arrays with an entry for each. All laws named table have one curve."""

    PARTS = ("name", "onset", "critical", "rate", "peak", "hardening")

    def __init__(self, name, onset, critical, rate, peak=0.0, hardening=0.0, *, curve=None):
        self.name, self.onset, self.critical, self.rate = name, onset, critical, rate
        self.peak, self.hardening, self.curve = peak, hardening, curve

    @classmethod
    def of_table(cls, table):
        """Law from its table in the case file."""
        if table["law"] == "table":
            table = table | ends_of(table)
        name, critical = table["law"], float(table["critical"])
        return cls(name, critical if name == "critical_stretch" else float(table["onset"]), critical,
                   float(table.get("rate", 3.0)), float(table.get("peak", 0.0)), float(table.get("hardening", 0.5)),
                   curve=curve_of(table))  # fmt: skip

    @classmethod
    def elastic(cls):
        """No damage at any stretch."""
        return cls("none", numpy.inf, numpy.inf, 3.0)

    @property
    def parts(self):
        return [getattr(self, part) for part in self.PARTS]

    def of(self, bonds):
        """The laws of some of the bonds."""
        return Law(*(part[bonds] if numpy.ndim(part) else part for part in self.parts), curve=self.curve)

    def spread(self, count):
        """Expands numbers to an entry per bond."""
        return Law(*(numpy.broadcast_to(part, count) for part in self.parts), curve=self.curve)

    def columns(self):
        """The laws shaped for several stretches per bond."""
        return Law(*(part[:, None] for part in self.parts), curve=self.curve)

    def published(self, stretch):
        """Equation 12 of [ADAPT], between onset and critical stretch."""
        argument = self.rate * (self.onset + self.critical - 2 * stretch) / (self.onset - self.critical)
        return (1 - numpy.tanh(argument)) / 2

    def tanh(self, stretch):
        start, end, published = self.published(self.onset), self.published(self.critical), self.published(stretch)
        return numpy.where(self.name == numpy.array("tanh"), published, (published - end) / (start - end))

    def enveloped(self, stretch):
        """Integrity of the laws that are given by their force: force over stretch."""
        is_blended = self.name == numpy.array("blended")
        peak = numpy.where(is_blended, self.peak, self.onset)
        highest = self.onset + numpy.where(is_blended, self.hardening, 0.0) * (peak - self.onset)
        fallen = (stretch - peak) / (self.critical - peak)
        end = numpy.exp(-self.rate)
        exponential = (numpy.exp(-self.rate * fallen) - end) / (1 - end)
        left = numpy.where(self.name == numpy.array("exponential"), exponential, 1 - fallen)
        for name in ("bilinear", "cornelissen"):
            if numpy.any(self.name == numpy.array(name)):
                left = numpy.where(self.name == numpy.array(name), self.opened(name, stretch), left)
        rising = self.onset + self.hardening * (stretch - self.onset)
        force = numpy.where(numpy.real(stretch) < peak, rising, highest * left)
        if self.curve is not None:
            force = numpy.where(self.name == numpy.array("table"), self.on_curve(stretch)[0], force)
        return force / stretch

    def opened(self, name, stretch):
        """Force over the largest one of a law of the opening w = s - f: f/s_m = g(w/s_c)."""
        return CURVES[name](self.share(name, stretch))[0]

    def share(self, name, stretch):
        """The opening over the critical stretch."""
        x, ratio = stretch / self.critical, self.onset / self.critical
        # Newton's method, also for complex numbers; it descends from the right on a convex curve.
        with numpy.errstate(all="ignore"):  # it means nothing for bonds of other laws
            for _ in range(100):
                force, slope = CURVES[name](x)
                step = (ratio * force + x - stretch / self.critical) / (ratio * slope + 1)
                x = x - step
                if not (numpy.abs(step) > 1e-15).any():
                    break
        return x

    def work_of_opening(self, name, stretch):
        """Integral of f ds = f (dw + df) from 0, over the opening: as a function of s it may be steep."""
        onset, critical = (numpy.broadcast_to(part, stretch.shape)[:, None] for part in (self.onset, self.critical))
        x = self.share(name, stretch)
        kink = numpy.where(numpy.real(x) < 2 / 9, x, 2 / 9)
        work = self.onset**2 / 2
        for start, end in ((0 * x, kink), (kink, x)):
            force, slope = CURVES[name](start[:, None] + (end - start)[:, None] * FRACTIONS)
            work = work + (end - start) * ((onset * force * (onset * slope + critical)) @ SHARES)
        return work

    def on_curve(self, stretch):
        """Force of the law table, and its integral from 0."""
        stretches, forces = self.curve
        at = stretch / self.critical
        k = numpy.clip(numpy.searchsorted(stretches, numpy.real(at), side="right"), 1, len(stretches) - 1)
        beyond = at - stretches[k - 1]
        force = forces[k - 1] + (forces[k] - forces[k - 1]) / (stretches[k] - stretches[k - 1]) * beyond
        pieces = numpy.diff(stretches) * (forces[1:] + forces[:-1]) / 2
        work = numpy.concatenate([[0.0], numpy.cumsum(pieces)])[k - 1] + (forces[k - 1] + force) / 2 * beyond
        return self.critical * force, self.critical**2 * work

    def softening(self, stretch):
        is_tanh = numpy.char.startswith(numpy.array(self.name, "U20"), "tanh")
        if is_tanh.all():
            return self.tanh(stretch)
        if not is_tanh.any():
            return self.enveloped(stretch)
        with numpy.errstate(all="ignore"):  # each of the two is meaningless for the other's laws
            return numpy.where(is_tanh, self.tanh(stretch), self.enveloped(stretch))

    def integrity(self, stretch):
        """1 up to the onset, 0 from the critical stretch on; for complex numbers, by the real part."""
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
            end = top[beyond]
            # In two pieces: the force of the blended law has a kink at its peak.
            kink = numpy.where(law.name == "blended", numpy.where(numpy.real(end) < law.peak, end, law.peak), law.onset)
            value[beyond] += law.between(law.onset, kink) + law.between(kink, end)
            if self.curve is not None:
                value[beyond] = numpy.where(law.name == "table", law.on_curve(end)[1], value[beyond])
            for name in CURVES:
                if (law.name == name).any():
                    with numpy.errstate(all="ignore"):
                        value[beyond] = numpy.where(law.name == name, law.work_of_opening(name, end), value[beyond])
        return value

    def between(self, start, end):
        """The integral of r T(r) over a range in which T is smooth."""
        span = end - start
        at = start[:, None] + span[:, None] * FRACTIONS
        return span * (at * self.columns().softening(at) @ SHARES)
