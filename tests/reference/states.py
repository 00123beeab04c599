"""The state-based solid as an energy, linear and at finite strain, in NumPy: dilatations, energies, forces, the whole
matrix, and what bonds would release.

With xi = x_j - x_i, r = |xi|, eta = u_j - u_i, d the dimension, kappa = K(r) V_i V_j nu over all bonds, broken or
cut or not, M_i = sum kappa r^2; over the remaining bonds
    theta_i = (d / M_i) sum kappa xi.eta,
    Pi = sum_i V_i [(lambda - mu) theta_i^2 / 2 + d (d + 2) mu / (2 M_i) sum kappa (xi.eta)^2 / r^2].
At finite strain xi.eta is replaced by r e, e = |xi + eta| - r, and kappa by T kappa, T the integrity of a bond.
For small bodies only: the derivatives of all bonds are dense. No code is shared with the program.
"""

import numpy

from tests.reference.body import bonds_that_meet
from tests.reference.influence import influence
from tests.reference.lps import lame

CLOSED_BALL = 1 + 1e-8


class StateSolid:
    def __init__(self, places, volume, horizon, lame_lambda, mu, *, kernel="inverse", size=None, cracks=()):
        """places (n, d); size: edge of the cells, for the linear correction of their volumes [m]; None: whole cells;
        cracks: tables of a case file."""
        self.places, self.volume = numpy.asarray(places, float), numpy.asarray(volume, float)
        count, self.dimension = self.places.shape
        self.lame_lambda, self.mu = (numpy.broadcast_to(v, count) for v in (lame_lambda, mu))
        first, second = numpy.triu_indices(count, 1)
        length = numpy.linalg.norm(self.places[second] - self.places[first], axis=1)
        if size is None:
            share = (length <= horizon * CLOSED_BALL).astype(float)
        else:
            share = numpy.clip((horizon + size / 2 - length) / size, 0, 1)
            share[share < 1e-8] = 0
        share = share * influence(kernel, length / horizon)
        near = share > 0
        self.first, self.second, self.length = first[near], second[near], length[near]
        self.share = share[near] * self.volume[self.first] * self.volume[self.second]
        self.moment = sum(numpy.bincount(end, self.share * self.length**2, count) for end in (self.first, self.second))
        self.left = numpy.ones(len(self.first), bool)
        for crack in cracks:
            self.left &= ~bonds_that_meet(crack, self.places[self.first], self.places[self.second])
        self.number = {pair: k for k, pair in enumerate(zip(self.first.tolist(), self.second.tolist()))}

    def stretches(self, displacement):
        """Stretches in the deformed configuration."""
        now = self.places + displacement
        return numpy.linalg.norm(now[self.second] - now[self.first], axis=1) / self.length - 1

    def without(self, pairs):
        """A copy in which bonds (first, second), the lower number first, are broken."""
        copy = object.__new__(StateSolid)
        copy.__dict__.update(self.__dict__)
        copy.left = self.left.copy()
        copy.left[[self.number[pair] for pair in pairs]] = False
        return copy

    def rates(self):
        """d(xi.eta)/du of the remaining bonds (bonds, n, d), their shares, and the point of each bond."""
        first, second = self.first[self.left], self.second[self.left]
        vectors, every = self.places[second] - self.places[first], numpy.arange(len(first))
        rates = numpy.zeros((len(first), *self.places.shape))
        rates[every, first], rates[every, second] = -vectors, vectors
        ends = numpy.zeros((len(self.places), len(first)))
        ends[first, every] = ends[second, every] = 1
        return rates.reshape(len(first), -1), self.share[self.left], ends

    def matrix(self):
        d = self.dimension
        rates, share, ends = self.rates()
        dilatation = d / self.moment[:, None] * ((ends * share) @ rates)
        of_points = self.volume * (self.lame_lambda - self.mu)
        of_bonds = d * (d + 2) * (self.volume * self.mu / self.moment) @ ends * share / self.length[self.left] ** 2
        return dilatation.T @ (of_points[:, None] * dilatation) + rates.T @ (of_bonds[:, None] * rates)

    def energies(self, displacement):
        """Energy per point [J]."""
        d = self.dimension
        rates, share, ends = self.rates()
        along = rates @ displacement.ravel()
        theta = d / self.moment * (ends @ (share * along))
        squares = ends @ (share * (along / self.length[self.left]) ** 2)
        density = (self.lame_lambda - self.mu) * theta**2 / 2 + d * (d + 2) * self.mu / (2 * self.moment) * squares
        return self.volume * density

    def forces(self, displacement):
        """dPi/du (n, d)."""
        return (self.matrix() @ displacement.ravel()).reshape(self.places.shape)


class FiniteSolid(StateSolid):
    """At finite strain. Displacements may be complex: derivatives are found by complex steps."""

    integrity = 1.0  # of the bonds, or an array

    def strained(self, displacement):
        """Directions, stretches and weighted shares T kappa r of the bonds."""
        now = self.places + displacement
        vectors, reference = now[self.second] - now[self.first], self.places[self.second] - self.places[self.first]
        length = numpy.sqrt((vectors**2).sum(axis=1))  # no norm: that of complex numbers is real
        moved = vectors - reference
        stretch = (moved * (2 * reference + moved)).sum(axis=1) / (self.length * (length + self.length))
        return vectors / length[:, None], stretch, self.share * self.integrity * self.left * self.length

    def at_points(self, of_bonds):
        sums = numpy.zeros(len(self.places), complex)
        numpy.add.at(sums, self.first, of_bonds)
        numpy.add.at(sums, self.second, of_bonds)
        return sums

    @property
    def of_points(self):
        """V (lambda - mu) and q = V d (d + 2) mu / M."""
        d = self.dimension
        return self.volume * (self.lame_lambda - self.mu), self.volume * d * (d + 2) * self.mu / self.moment

    def energies(self, displacement):
        _, stretch, weight = self.strained(displacement)
        dilatational, q = self.of_points
        theta = self.dimension / self.moment * self.at_points(weight * self.length * stretch)
        energies = dilatational * theta**2 / 2 + q / 2 * self.at_points(weight * self.length * stretch**2)
        return energies if numpy.iscomplexobj(displacement) else energies.real

    def pulls(self, displacement):
        """Directions and forces of the bonds, and the pressures p of the points."""
        n, stretch, weight = self.strained(displacement)
        dilatational, q = self.of_points
        per_moment = self.dimension / self.moment
        p = dilatational * per_moment**2 * self.at_points(weight * self.length * stretch)
        first, second = self.first, self.second
        return n, weight * (p[first] + p[second] + (q[first] + q[second]) * stretch), p

    def forces(self, displacement):
        n, pull, _ = self.pulls(displacement)
        force = numpy.zeros(self.places.shape, complex)
        numpy.add.at(force, self.first, -pull[:, None] * n)
        numpy.add.at(force, self.second, pull[:, None] * n)
        return force if numpy.iscomplexobj(displacement) else force.real

    def matrix(self, displacement=None):
        """The derivative of the forces, column by column by complex steps of 1e-100."""
        at = numpy.zeros(self.places.shape) if displacement is None else displacement
        columns = []
        for k in range(at.size):
            moved = at.astype(complex)
            moved.ravel()[k] += 1e-100j
            columns.append(self.forces(moved).imag.ravel() / 1e-100)
        return numpy.stack(columns, axis=1)

    def equivalent_stretches(self, displacement, drops=1.0):
        """Equivalent stretches of bonds that would lose this integrity: 1 of brittle ones, 0 of those that soften."""
        _, stretch, _ = self.strained(displacement)
        p, (dilatational, q) = self.pulls(displacement)[2].real, self.of_points
        first, second = self.first, self.second
        stiffness = dilatational * (self.dimension / self.moment) ** 2
        lost = drops * self.share * self.length**2 * stretch * (stiffness[first] + stiffness[second])
        squared = stretch * (stretch + (2 * (p[first] + p[second]) - lost) / (q[first] + q[second]))
        return numpy.sqrt(numpy.maximum(numpy.where(stretch > 0, squared, 0), 0))

    def taken(self, work_of_law):
        """Energy that each bond takes in all: kappa r^2 (q_i + q_j) times the work of the law [J]."""
        q = self.of_points[1]
        return self.share * self.length**2 * (q[self.first] + q[self.second]) * work_of_law


class LinearRelease(FiniteSolid):
    """The linear solid with damage by release: xi.eta / r^2 in the place of e / r, forces along bonds at rest."""

    def strained(self, displacement):
        reference = self.places[self.second] - self.places[self.first]
        stretch = ((displacement[self.second] - displacement[self.first]) * reference).sum(axis=1) / self.length**2
        return reference / self.length[:, None], stretch, self.share * self.integrity * self.left * self.length


def solid_of(material, places, volume, horizon, **more):
    """lambda and mu from the table of a material."""
    is_stress = places.shape[1] == 2 and material.get("plane", "stress") == "stress"
    constants = lame(material["youngs_modulus"], material["poisson_ratio"], "stress" if is_stress else "strain")
    releases = material.get("drive") == "release"
    kind = FiniteSolid if material.get("model") == "state" else LinearRelease if releases else StateSolid
    return kind(places, volume, horizon, *constants, kernel=material.get("influence", "inverse"), **more)
