"""The linear peridynamic solid as an energy, in NumPy: dilatations, energies, forces and the whole matrix.

With xi = x_j - x_i, r = |xi|, eta = u_j - u_i, d the dimension, kappa = K(r) V_i V_j nu over all bonds, broken or
cut or not, M_i = sum kappa r^2; over the remaining bonds
    theta_i = (d / M_i) sum kappa xi.eta,
    Pi = sum_i V_i [(lambda - mu) theta_i^2 / 2 + d (d + 2) mu / (2 M_i) sum kappa (xi.eta)^2 / r^2].
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


def solid_of(material, places, volume, horizon, **more):
    """lambda and mu from the table of a material."""
    is_stress = places.shape[1] == 2 and material.get("plane", "stress") == "stress"
    constants = lame(material["youngs_modulus"], material["poisson_ratio"], "stress" if is_stress else "strain")
    return StateSolid(places, volume, horizon, *constants, kernel=material.get("influence", "inverse"), **more)
