"""Energy of a plane tear in a lattice of cpd: its halves move apart, and every interaction across
the plane does the work of its force (docs/theory.md, Damage)."""

import itertools
import math

import numpy

from tests.reference.laws import Law


def directions(dimension):
    """Normals and their weights in the mean."""
    if dimension == 2:
        nodes, weights = numpy.polynomial.legendre.leggauss(12)
        angle = (nodes + 1) * math.pi / 8
        return numpy.stack([numpy.cos(angle), numpy.sin(angle)], -1), weights / 2
    nodes, weights = numpy.polynomial.legendre.leggauss(4)
    share, weight = (nodes + 1) / 2, weights / 2
    y, ratio = (a.ravel() for a in numpy.meshgrid(share, share, indexing="ij"))
    normal = numpy.stack([numpy.ones_like(y), y, ratio * y], -1)
    length = numpy.linalg.norm(normal, axis=1)
    weight = numpy.outer(weight, weight).ravel() * y / length**3
    return normal / length[:, None], weight / weight.sum()


class Tear:
    def __init__(self, dimension, ratio, spacing, cross_section, constants, influence="constant"):
        """constants: C1, C2, C3 by their order."""
        from tests.reference.body import ball_volume, cliques, influence_of_sides, lattice_ball, measure, pairs_within

        self.dimension, self.measure = dimension, measure
        ball = lattice_ball(dimension, ratio) * spacing
        places = numpy.concatenate([numpy.zeros((1, dimension)), ball])
        pairs = pairs_within(places, ratio * spacing)
        volume = ball_volume(dimension, ratio * spacing, cross_section)
        self.kinds = []  # positions of the points, energy per volume for half a squared relative change
        for order, constant in constants.items():
            if not constant:
                continue
            tuples = cliques(pairs, len(places), order + 1)
            tuples = tuples[tuples[:, 0] == 0]
            found, factor = places[tuples], influence_of_sides(influence, tuples, places / (ratio * spacing))
            size = abs(measure([found[:, k] - found[:, 0] for k in range(1, order + 1)]))
            full = size > spacing**order / 2
            found, size, factor = found[full], size[full], factor[full]
            # Every interaction is one of each of its points.
            effective = volume**order / (math.factorial(order) * len(found))
            self.kinds.append((found, math.factorial(order) * effective * factor * size * constant / (order + 1)))

    def energy(self, damage, normal):
        """Energy per area of a plane with this normal."""
        law = Law.of_table(damage)
        return sum(self._of_kind(law, *kind, numpy.asarray(normal)) for kind in self.kinds)

    def of_bonds(self, damage, normal):
        """The part of the bonds only."""
        return self._of_kind(Law.of_table(damage), *self.kinds[0], numpy.asarray(normal))

    def mean(self, damage):
        law = Law.of_table(damage)
        bonds = self.kinds[0]
        arms = numpy.linalg.norm(bonds[0][:, 1], axis=1)
        total = {2: 2 / math.pi, 3: 1 / 2}[self.dimension] * (bonds[1] * arms).sum()
        total *= float(law.moment(numpy.array([law.critical]))[0])
        for normal, weight in zip(*directions(self.dimension), strict=True):
            total += weight * sum(self._of_kind(law, *kind, normal) for kind in self.kinds[1:])
        return total

    def _of_kind(self, law, places, energy, normal):
        height = places @ normal
        level = numpy.sort(height, axis=1)
        total = 0.0
        for k in range(level.shape[1] - 1):
            width = level[:, k + 1] - level[:, k]
            there = width > 1e-9 * abs(level).max()
            above = height[there] > level[there, k, None] + width[there, None] / 2
            total += (energy[there] * width[there] * self._work(law, places[there], above, normal)).sum()
        return total

    def _work(self, law, places, above, normal):
        """The integral of T d(e^2/2) while the points above move along the normal."""
        bonds = [places[:, b] - places[:, a] for a, b in itertools.combinations(range(places.shape[1]), 2)]
        across = [above[:, a] != above[:, b] for a, b in itertools.combinations(range(places.shape[1]), 2)]
        length = numpy.stack([numpy.linalg.norm(arm, axis=1) for arm in bonds], -1)
        rise = numpy.stack([abs(arm @ normal) for arm in bonds], -1)
        across = numpy.stack(across, -1)
        opening = lambda s: numpy.where(across, numpy.sqrt(rise**2 + (s * s + 2 * s) * length**2) - rise, numpy.inf)
        end = opening(law.critical).min(axis=1)
        marks = [law.onset, law.critical] + ([law.peak] if law.name == "blended" else [])
        # The integrand is smooth between kinks.
        stops = numpy.concatenate([numpy.zeros((len(end), 1)), *map(opening, marks)], axis=1)
        stops = numpy.sort(numpy.minimum(stops, end[:, None]), axis=1)
        panels = 2 + math.ceil(law.rate)
        nodes, weights = numpy.polynomial.legendre.leggauss(10)
        at = (numpy.arange(panels)[:, None] + (nodes + 1) / 2).ravel() / panels
        share = numpy.tile(weights, panels) / 2 / panels
        total = numpy.zeros(len(end))
        for k in range(stops.shape[1] - 1):
            span = stops[:, k + 1] - stops[:, k]
            some = span > 0
            u = stops[some, k, None] + span[some, None] * at
            integrity = numpy.ones_like(u)
            for b in range(length.shape[1]):
                r, l = rise[some, b, None], length[some, b, None]
                stretch = numpy.sqrt(1 + (2 * r * u + u * u) / l**2) - 1
                integrity *= numpy.where(across[some, b, None], law.integrity(stretch), 1.0)
            step = 1e-30j
            change = self._change(places[some], above[some], normal, u + step)
            total[some] += span[some] * (integrity * change.real * change.imag / step.imag @ share)
        return total

    def _change(self, places, above, normal, u):
        moved = places[:, None] + u[:, :, None, None] * (above[:, None, :, None] * normal)
        arms = [moved[..., k, :] - moved[..., 0, :] for k in range(1, places.shape[1])]
        whole = [places[:, None, k] - places[:, None, 0] for k in range(1, places.shape[1])]
        return self.measure(arms) / self.measure(whole) - 1
