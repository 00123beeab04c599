"""Damage laws that fall only by drops, as mode `path` follows them (docs/theory.md, Saw-tooth)."""

import functools

import numpy

from tests.reference.laws import Law

# Strengths are where a band is met, whose minimum width is searched for: both programs know them to about 1e-10.
SAME_STRENGTH = 1e-8
JUST_ABOVE = 1 + 1e-9  # at the minimum band itself round-off decides whether the teeth suffice


class Teeth:
    """Secants of one law, stretches in units of the critical one."""

    def __init__(self, strengths, integrities, ends):
        self.strengths, self.integrities = numpy.array(strengths), numpy.array(integrities)
        self.ends = numpy.array(ends)  # stretches of the law between which each drop occurs


class Smooth:
    """A law with the critical stretch 1, from tables of T and of the integral of r T(r) between its ends."""

    CELLS = 4000

    def __init__(self, name, onset, rate, peak, hardening, curve):
        law = Law(name, onset, 1.0, rate, peak, hardening, curve=curve and tuple(map(numpy.array, curve)))
        places = numpy.linspace(onset, 1.0, self.CELLS + 1)
        self.onset, self.cell = onset, (1.0 - onset) / self.CELLS
        integrity = law.softening(places)
        slope = law.softening(places + 1e-30j).imag / 1e-30
        moment = numpy.concatenate([law.moment(part) for part in numpy.array_split(places, 50)])
        self.largest_force = max(onset, (integrity * places)[1:-1].max())
        self.tables = [table.tolist() for table in (integrity, slope, moment, places * integrity)]

    def between(self, values, slopes, stretch):
        """Cubic interpolation."""
        at = (stretch - self.onset) / self.cell
        k = min(max(int(at), 0), self.CELLS - 1)
        t = at - k
        return (values[k] * (1 + 2 * t) * (1 - t) ** 2 + values[k + 1] * t * t * (3 - 2 * t)
                + self.cell * t * (1 - t) * (slopes[k] * (1 - t) - slopes[k + 1] * t))  # fmt: skip

    def integrity(self, stretch):
        return 1.0 if stretch <= self.onset else 0.0 if stretch >= 1 else self.between(*self.tables[:2], stretch)

    def dissipated(self, stretch):
        return self.between(*self.tables[2:], stretch) - self.integrity(stretch) * stretch**2 / 2

    def strength(self, start, end):
        """Stretch at which a drop from one secant to the other dissipates as much as the law between them."""
        lost = self.integrity(start) - self.integrity(end)
        if not lost > 0:
            return start
        dissipated = max(self.dissipated(end) - self.dissipated(start), 0.0)
        return min(max((2 * dissipated / lost) ** 0.5, start), end)

    def above(self, start, end):
        """Excess force at the end of a secant over the law, relative to the law's largest force."""
        strength = self.strength(start, end)
        return (self.integrity(start) - self.integrity(strength)) * strength / self.largest_force

    def in_band(self, band, most):
        """Teeth, or None if there are more than the given number."""
        strengths, integrities, ends = [], [], [self.onset]
        while ends[-1] < 1.0:
            if len(strengths) == most:
                return None
            start, end = ends[-1], 1.0
            allowed = band * max(0.1, 1 - self.integrity(start))  # the first teeth are the finest
            if self.above(start, end) > allowed:
                end = last_of(start, 1.0, lambda at: self.above(start, at) <= allowed)[0]
            if not end > start * (1 + 1e-9):  # the law itself drops by more than the band
                end = min(1.0, start + 1e-3 * (1.0 - self.onset))
            strengths.append(self.strength(start, end))
            integrities.append(self.integrity(start))
            ends.append(end)
        strengths[-1] = min(strengths[-1], 1 - 1e-9)
        return Teeth(strengths, integrities, ends)


def last_of(low, high, holds):
    """Two close numbers between which a condition that holds at the low end stops holding."""
    for _ in range(50):
        middle = (low + high) / 2
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low, high


@functools.cache
def teeth_of(name, onset, rate, peak, hardening, curve, most):
    """Secants with the narrowest band that a number of teeth allows; stretches over the critical one."""
    if name == "critical_stretch":
        return Teeth([1.0], [1.0], [1.0])
    smooth = Smooth(name, onset, rate, peak, hardening, curve)
    wide = 1.0
    while smooth.in_band(wide, most) is None:
        wide *= 2
    narrowest = last_of(0.0, wide, lambda band: smooth.in_band(band, most) is None)[1]
    return smooth.in_band(narrowest * JUST_ABOVE, most)


class SawTooth:
    """Replaces a Law: the history of a bond is the strength of its current secant, or the critical stretch
    of a broken bond. Numbers are those of bonds."""

    def __init__(self, law, most):
        failing = law.critical < numpy.inf
        self.name, self.critical = law.name, law.critical
        columns = [law.onset, law.rate, law.peak, law.hardening]
        with numpy.errstate(invalid="ignore"):
            columns = [law.onset / law.critical, law.rate, numpy.where(failing, law.peak / law.critical, 0.0), law.hardening]
        kinds, self.kind = {}, numpy.zeros(len(law.name), int)
        for bond in numpy.flatnonzero(failing):
            curve = tuple(map(tuple, law.curve)) if law.name[bond] == "table" else None
            key = (str(law.name[bond]), *(float(f"{column[bond]:.10g}") for column in columns), curve)
            self.kind[bond] = kinds.setdefault(key, len(kinds))
        self.teeth = [teeth_of(*key, most) for key in kinds] or [Teeth([1.0], [1.0], [1.0])]
        self.strengths = padded([teeth.strengths for teeth in self.teeth], numpy.inf)
        self.integrities = padded([teeth.integrities for teeth in self.teeth], 0.0)
        self.onset = numpy.where(failing, self.strengths[self.kind, 0], 1.0) * self.critical

    def of(self, bonds):
        """The laws of some of the bonds."""
        part = SawTooth.__new__(SawTooth)
        part.__dict__.update(self.__dict__)
        part.name, part.critical, part.onset, part.kind = (of[bonds] for of in (self.name, self.critical, self.onset, self.kind))
        return part

    @property
    def is_toothed(self):
        """Whether any law softens smoothly."""
        return bool((self.name[self.critical < numpy.inf] != "critical_stretch").any())

    def tooth(self, stretch):
        """Number of the current secant of a bond with this history."""
        share = numpy.real(stretch) / self.critical
        return (self.strengths[self.kind] < (share * (1 - 1e-12))[:, None]).sum(axis=1)

    def told(self, bonds, history):
        """The exact history for a written one, and the difference."""
        law = self.of(bonds)
        candidates = numpy.column_stack([law.strengths[law.kind], numpy.ones(len(history))])
        off = numpy.abs((history / law.critical)[:, None] - candidates)
        off[:, :-1] = numpy.where(off[:, :-1] < numpy.inf, off[:, :-1], numpy.inf)
        # The last strength may be slightly below the critical stretch, which is exact.
        off[:, -1] = numpy.where(off[:, -1] < 1e-12, -1.0, numpy.inf)
        nearest = off.argmin(axis=1)
        rows = numpy.arange(len(history))
        return candidates[rows, nearest] * law.critical, numpy.maximum(off[rows, nearest], 0.0)

    def after(self, history):
        """The histories after a drop."""
        tooth = self.tooth(history) + 1
        columns = numpy.column_stack([self.strengths[self.kind], numpy.full(len(history), numpy.inf)])
        share = columns[numpy.arange(len(history)), numpy.minimum(tooth, columns.shape[1] - 1)]
        return numpy.where(share < numpy.inf, share, 1.0) * self.critical

    def integrity(self, history):
        columns = numpy.column_stack([self.integrities, numpy.zeros(len(self.integrities))])
        tooth = numpy.minimum(self.tooth(history), columns.shape[1] - 1)
        return numpy.where(numpy.real(history) >= self.critical, 0.0, columns[self.kind, tooth])

    def moment(self, stretch):
        """The integral of r T(r)."""
        critical = self.critical[:, None]
        ends = numpy.minimum(self.strengths[self.kind], 1.0) * critical
        reached = numpy.minimum(ends, numpy.real(stretch)[:, None])
        before = numpy.column_stack([numpy.zeros(len(reached)), reached[:, :-1]])
        return (self.integrities[self.kind] * (reached**2 - before**2)).sum(axis=1) / 2


def padded(rows, value):
    result = numpy.full((len(rows), max(map(len, rows))), value)
    for row, numbers in zip(result, rows):
        row[: len(numbers)] = numbers
    return result
