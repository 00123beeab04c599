"""The body beyond planes of symmetry and periodic sides (docs/case-file.md), as explicit points.

The body is continued as far as its own points see. A copy X' = M X + t of a point X moves with u' = M u + n . jump:
M is the mirror, t the shift by whole multiples of the repeat length, n the number of periods between them per axis,
and jump the displacement's increase over a period.
"""

import itertools
import math

import numpy

from tests.reference.case import evaluate

WITHOUT_PLACE = numpy.zeros((1, 3))
SAME_PLACE = 1e-7  # of the spacing


class Along:
    """A map of one axis: x' = mirror x + shift, `periods` periods away. The shift is by_planes times the positions of
    the planes."""

    def __init__(self, mirror=1, shift=0.0, periods=0, by_planes=(0, 0)):
        self.mirror, self.shift, self.periods, self.by_planes = mirror, shift, periods, by_planes


def planes_across(axis, case):
    """Where planes of symmetry cross an axis, ascending."""
    return sorted(float(table.get("at", 0.0)) for table in case.get("symmetry") if table["axis"] == axis)


def maps_along(axis, case, reach):
    """All maps of an axis whose copies a body between its planes or sides may see; the first is the identity."""
    planes = planes_across(axis, case)
    period = next((table for table in case.get("period") if table["axis"] == axis), None)
    if len(planes) == 1:
        return [Along(), Along(-1, 2 * planes[0], by_planes=(2, 0))]
    if period:
        length = float(period["to"]) - float(period["from"])
        most = math.ceil(reach / length) + 1
        return [Along(), *(Along(1, k * length, k) for k in range(-most, most + 1) if k)]
    if planes:  # reflections in two planes repeat after twice their distance
        length = 2 * (planes[1] - planes[0])
        most = math.ceil(reach / length) + 1
        shifted = [Along(1, k * length, by_planes=(-2 * k, 2 * k)) for k in range(-most, most + 1) if k]
        mirrored = [Along(-1, 2 * planes[0] + k * length, by_planes=(2 - 2 * k, 2 * k)) for k in range(-most, most + 1)]
        return [Along(), *shifted, *mirrored]
    return [Along()]


class Beyond:
    """Own points, followed by the copies that an own point may see.

    places, source (own point of each), mirror, shift and periods (count x dimension).
    """

    def __init__(self, case, reference, spacing, reach):
        self.case, self.own, self.spacing = case, len(reference), spacing
        self.in_expressions = case.spacing_in_expressions if case.has_one_spacing else spacing
        self.axes = "xyz"[: reference.shape[1]]
        each = [maps_along(axis, case, reach) for axis in self.axes]
        self.maps = list(itertools.product(*each))
        places, source, of = [reference], [numpy.arange(self.own)], [numpy.zeros(self.own, int)]
        for number, along in enumerate(self.maps[1:], start=1):
            copies = reference * [a.mirror for a in along] + [a.shift for a in along]
            seen = self.are_seen(copies, reference, reach * (1 + 1e-6))
            places.append(copies[seen])
            source.append(numpy.flatnonzero(seen))
            of.append(numpy.full(seen.sum(), number))
        self.places, self.source, self.map = numpy.concatenate(places), numpy.concatenate(source), numpy.concatenate(of)
        self.mirror, self.shift, self.periods, self.by_planes = (
            numpy.array([[getattr(a, name) for a in along] for along in self.maps])[self.map]
            for name in ("mirror", "shift", "periods", "by_planes"))  # fmt: skip
        self.at = {self.key(place): k for k, place in enumerate(self.places)}

    @staticmethod
    def are_seen(copies, reference, reach):
        """The copies within `reach` of an own point."""
        low, high = reference.min(axis=0) - reach, reference.max(axis=0) + reach
        seen = ((copies >= low) & (copies <= high)).all(axis=1)
        for k in numpy.flatnonzero(seen):
            seen[k] = (((reference - copies[k]) ** 2).sum(axis=1) <= reach**2).any()
        return seen

    def key(self, place):
        """Integer key of a position. Positions that differ by round-off may have neighbouring keys: see number."""
        return tuple(numpy.rint(place / (SAME_PLACE * self.spacing)).astype(numpy.int64).tolist())

    def number(self, place):
        """Number of the point at a position; None: there is none."""
        here = numpy.array(self.key(place))
        for off in itertools.product((0, -1, 1), repeat=len(here)):
            found = self.at.get(tuple((here + off).tolist()))
            if found is not None:
                return found
        return None

    def spread(self, displacement, jump):
        """Displacements of all points from those of own points, with the jumps over the periods (axes x components)."""
        return displacement[self.source] * self.mirror + self.periods @ jump

    def twin(self, first, second):
        """The same pair of points as the second one's source sees it: numbers of the other two points."""
        back = self.mirror[second] * (self.places[first] - self.shift[second])  # mirrors are their own inverses
        return self.source[second], self.number(back)

    # ---- planes of symmetry ----------------------------------------------------------------------

    def mirrored_axes(self):
        return [axis for axis, letter in enumerate(self.axes) if planes_across(letter, self.case)]

    def planes(self):
        """Name of each plane, its axis, and how much more the points beyond it move with it than the plane itself."""
        found = []
        for axis, letter in enumerate(self.axes):
            count = len(planes_across(letter, self.case))
            for k in range(count):
                name = f"symmetry_{letter}" + ("" if count == 1 else "-+"[k])
                found.append((name, axis, self.by_planes[:, axis, k]))
        return found

    # ---- cracks ----------------------------------------------------------------------------------

    def cracks(self):
        """All cracks of the case and their copies."""
        found = []
        for crack, along in itertools.product(self.case.get("crack"), self.maps):
            mirror, shift = [a.mirror for a in along], [a.shift for a in along]
            moved = {key: numpy.asarray(crack[key], float) * mirror + shift for key in ("from", "to", "vertices", "outline") if key in crack}
            found.append(moved)
        return found

    # ---- periods ---------------------------------------------------------------------------------

    def lengths(self):
        """Name of each period's axis, and its length [m]."""
        return {table["axis"]: float(table["to"]) - float(table["from"]) for table in self.case.get("period")}

    def given_jump(self, load):
        """Jumps over the periods (axes x components) [m] as the case gives them, and which of them are free."""
        jump, free = numpy.zeros((len(self.axes),) * 2), numpy.zeros((len(self.axes),) * 2, bool)
        for table in self.case.get("period"):
            axis = self.axes.index(table["axis"])
            for c, gradient in enumerate(table.get("gradient", [0] * len(self.axes))):
                free[axis, c] = gradient == "free"
                if not free[axis, c]:
                    jump[axis, c] = evaluate(gradient, WITHOUT_PLACE, load, self.in_expressions)[0] * self.lengths()[table["axis"]]
        return jump, free

    def told_jump(self, row):
        """Jumps over the periods from a row of the history."""
        jump = numpy.zeros((len(self.axes),) * 2)
        for axis, length in self.lengths().items():
            for c, component in enumerate(self.axes):
                jump[self.axes.index(axis), c] = row[f"gradient_{component}:period_{axis}"] * length
        return jump
