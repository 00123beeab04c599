"""Points, their interactions and the weights of these (docs/theory.md)."""

import itertools
import math

import numpy

HORIZON_TOLERANCE = 1e-8


def pairs_within(reference, radius):
    """All pairs i < j no further apart than the radius."""
    count, pairs = len(reference), []
    for first in range(0, count, 256):
        rows = reference[first : first + 256]
        squared = sum((rows[:, None, c] - reference[None, :, c]) ** 2 for c in range(reference.shape[1]))
        i, j = numpy.nonzero(squared <= (radius * (1 + HORIZON_TOLERANCE)) ** 2)
        keep = i + first < j
        pairs.append(numpy.stack([i[keep] + first, j[keep]], axis=1))
    return numpy.concatenate(pairs)


def measure(arms):
    """Length, area or volume of interactions from their arms (a list of vectors), with sign."""
    dimension = arms[0].shape[-1]
    if len(arms) == 1:
        return numpy.sqrt((arms[0] ** 2).sum(axis=-1))
    if len(arms) == 2 and dimension == 2:
        return arms[0][..., 0] * arms[1][..., 1] - arms[0][..., 1] * arms[1][..., 0]
    if len(arms) == 2:
        return numpy.sqrt((numpy.cross(*arms) ** 2).sum(axis=-1))
    return (arms[0] * numpy.cross(arms[1], arms[2])).sum(axis=-1)


def arms_of(tuples, places):
    """Vectors from the first point of every tuple to the others."""
    return [places[tuples[:, k]] - places[tuples[:, 0]] for k in range(1, tuples.shape[1])]


def cliques(bonds, count, size):
    """All tuples of `size` points that are bonded with one another, ascending."""
    linked = [set() for _ in range(count)]
    for i, j in bonds.tolist():
        linked[i].add(j)
    found = []
    for i in range(count):
        for others in itertools.combinations(sorted(linked[i]), size - 1):
            if all(b in linked[a] for a, b in itertools.combinations(others, 2)):
                found.append((i, *others))
    return numpy.array(found, int).reshape(-1, size)


def lattice_ball(dimension, ratio):
    """Neighbours of a lattice's bulk point, in spacings."""
    reach = int(ratio * (1 + HORIZON_TOLERANCE))
    grid = numpy.array(list(itertools.product(range(-reach, reach + 1), repeat=dimension)), float)
    distance = numpy.sqrt((grid**2).sum(axis=1))
    return grid[(distance > 0) & (distance <= ratio * (1 + HORIZON_TOLERANCE))]


def ball_volume(dimension, horizon, cross_section):
    return {1: 2 * horizon, 2: math.pi * horizon**2, 3: 4 / 3 * math.pi * horizon**3}[dimension] * cross_section


def micromodulus_factor(dimension, plane, horizon, cross_section):
    """c / E."""
    if dimension == 1:
        return 2 / (cross_section * horizon**2)
    if dimension == 2 and plane == "stress":
        return 9 / (math.pi * horizon**3 * cross_section)
    if dimension == 2:
        return 48 / (5 * math.pi * horizon**3 * cross_section)
    return 12 / (math.pi * horizon**4)


def confined_modulus_factor(dimension, plane):
    """c11 / E: stress over strain along an axis with the other strains held at zero."""
    if dimension == 1:
        return 1.0
    if dimension == 2 and plane == "stress":
        return 1 / (1 - (1 / 3) ** 2)
    return 0.75 / (1.25 * 0.5)  # Poisson's ratio 1/4


class Body:
    """Everything that is constant: interactions as arrays of point numbers, with their weights.

    bonds, triangles, tetrahedra: (points, weight, reference measure), the measures with sign.
    """

    def __init__(self, case, reference, volume, horizon_ratio=None):
        self.case, self.dimension = case, case.dimension
        self.reference, self.volume = numpy.asarray(reference, float), numpy.asarray(volume, float)
        self.horizon = case.horizon(horizon_ratio)
        self.spacing = case.spacing(volume)
        self.cross_section = case.cross_section
        self.is_cpd = case["material"]["model"] == "cpd"
        self.tuples, self.weight = {}, {}
        self.flatness, self.factor_sums = {}, {}  # cpd: g of interactions, and their sums at points
        if self.is_cpd:
            self._make_cpd()
        else:
            self._make_bonds()
        self._cut()
        self.measure = {k: measure(arms_of(t, self.reference)) for k, t in self.tuples.items()}

    @property
    def bonds(self):
        return self.tuples[1]

    @property
    def lengths(self):
        return self.measure[1]

    # ---- bonds alone -----------------------------------------------------------------------------

    def _make_bonds(self):
        material, quadrature = self.case["material"], self.case["quadrature"]
        factor = micromodulus_factor(self.dimension, material["plane"], self.horizon, self.cross_section)
        if "micromodulus" in material:
            self.constants = {1: float(material["micromodulus"])}
        else:
            self.constants = {1: material["youngs_modulus"] * factor}
        self.youngs_modulus = self.constants[1] / factor
        size = (self.volume / self.cross_section) ** (1 / self.dimension)
        linear = quadrature["volume_correction"] == "linear"
        pairs = pairs_within(self.reference, self.horizon + (size.max() / 2 if linear else 0))
        i, j = pairs.T
        arm = self.reference[j] - self.reference[i]
        length = numpy.sqrt((arm**2).sum(axis=1))

        def share(of):
            return numpy.clip((self.horizon + of / 2 - length) / of, 0, 1) if linear else numpy.ones(len(pairs))

        mean_share = (share(size[j]) + share(size[i])) / 2
        weight = self.volume[i] * self.volume[j] * mean_share
        keep = weight > 0
        pairs, arm, length, weight, mean_share = (a[keep] for a in (pairs, arm, length, weight, mean_share))
        surface = quadrature["surface_correction"]
        if surface == "volume":
            weight = weight * self._volume_correction(pairs, mean_share)
        elif surface == "energy":
            weight = weight * self._energy_correction(pairs, arm / length[:, None], length, weight)
        self.tuples[1], self.weight[1] = pairs, weight

    def _volume_correction(self, pairs, share):
        i, j = pairs.T
        own = self._sum_over(i, share * self.volume[j]) + self._sum_over(j, share * self.volume[i])
        return 2 * self._bulk_volume() / (own[i] + own[j])

    def _bulk_volume(self):
        """V_H of a point inside the lattice; for a cloud a lattice of its mean spacing."""
        linear = self.case["quadrature"]["volume_correction"] == "linear"
        ratio = self.horizon / self.spacing
        distance = numpy.sqrt((lattice_ball(self.dimension, ratio + (0.5 if linear else 0)) ** 2).sum(axis=1))
        shares = numpy.clip(ratio + 0.5 - distance, 0, 1) if linear else numpy.ones(len(distance))
        return shares.sum() * self.spacing**self.dimension * self.cross_section

    def _energy_correction(self, pairs, direction, length, weight):
        i, j = pairs.T
        classical = self.youngs_modulus * confined_modulus_factor(self.dimension, self.case["material"]["plane"]) / 2
        inverse_square = 0.0
        for axis in range(self.dimension):
            energy = weight * self.constants[1] / 2 * length * direction[:, axis] ** 4
            density = (self._sum_over(i, energy / 2) + self._sum_over(j, energy / 2)) / self.volume
            crosses = below * above < 0
    share = numpy.divide(below, below - above, out=numpy.zeros(len(start)), where=crosses)
    at = start + share[:, None] * (end - start)
    keep = [axis for axis in range(3) if axis != numpy.abs(normal).argmax()]
    x, y = at[:, keep].T
    inside = numpy.zeros(len(start), bool)
    for a, b in zip(vertices[:, keep], numpy.roll(vertices[:, keep], -1, axis=0)):
        if a[1] != b[1]:
            inside ^= ((a[1] > y) != (b[1] > y)) & (x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
    return crosses & inside
