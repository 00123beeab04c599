"""Strength of a state-based solid whose bonds fail by what they release, under a homogeneous stress whose strain grows
(docs/theory.md, Strength of states), in NumPy. No derivative is used: strain and damage are found in turns.

With beta = kappa r^2 / M of a bond of a point deep inside, n its direction, s = n.eps n and T its integrity,
    theta = d sum beta T s,  W = (lambda - mu) theta^2 / 2 + d (d + 2) mu / 2 sum beta T s^2,
    s_eq^2 = max(s (s + zeta theta - drop zeta d beta s / 2), 0) where s > 0,  zeta = 2 (lambda - mu) / ((d + 2) mu).
"""

import itertools
import math

import numpy

from tests.reference.influence import influence
from tests.reference.lps import lame
from tests.reference.tear import directions


class StatePull:
    def __init__(self, dimension, ratio, youngs_modulus, poisson_ratio, *, plane="stress", linear_volumes=False, kernel="inverse"):
        """ratio: horizon over the spacing of a square or cubic lattice."""
        reach = range(-math.ceil(ratio) - 1, math.ceil(ratio) + 2)
        arms = numpy.array([arm for arm in itertools.product(reach, repeat=dimension) if arm > (0,) * dimension], float)
        length = numpy.linalg.norm(arms, axis=1)
        share = numpy.clip(ratio + 0.5 - length, 0, 1) if linear_volumes else (length <= ratio * (1 + 1e-8)).astype(float)
        beta = share * influence(kernel, length / ratio) * length**2
        near = beta > 0
        arms, length, beta = arms[near], length[near], beta[near]
        self.dimension, self.beta = dimension, beta / (2 * beta.sum())  # of one of two opposite bonds
        self.rows, self.columns = numpy.triu_indices(dimension)
        self.factor = numpy.where(self.rows == self.columns, 1.0, math.sqrt(2))
        n = arms / length[:, None]
        self.dyad = n[:, self.rows] * n[:, self.columns] * self.factor
        self.dilatational, self.mu = lame(youngs_modulus, poisson_ratio, "stress" if dimension == 2 and plane == "stress" else "strain")
        self.dilatational -= self.mu
        self.zeta = 2 * self.dilatational / ((dimension + 2) * self.mu)

    def rate(self, integrity):
        """dtheta/dstrain"""
        return 2 * self.dimension * (self.beta * integrity) @ self.dyad

    def stiffness(self, integrity):
        d, rate = self.dimension, self.rate(integrity)
        bonds = 2 * d * (d + 2) * self.mu * (self.dyad.T * (self.beta * integrity)) @ self.dyad
        return self.dilatational * numpy.outer(rate, rate) + bonds

    def driving(self, strain, integrity, drop):
        s, theta = self.dyad @ strain, self.rate(integrity) @ strain
        squared = s * (s + self.zeta * theta - drop * self.zeta * self.dimension * self.beta * s / 2)
        return numpy.sqrt(numpy.maximum(numpy.where(s > 0, squared, 0), 0))

    def strength(self, law, **more):
        """The mean of `peak` over directions."""
        return sum(weight * self.peak(law, normal, **more) for normal, weight in zip(*directions(self.dimension), strict=True))

    def peak(self, law, normal, step=1e-3):
        """Largest stress [Pa] under uniaxial tension along a direction.

        step: relative, of the strain along the direction."""
        drop = 1.0 if law.onset == law.critical else 0.0
        n = numpy.asarray(normal, float) / numpy.linalg.norm(normal)
        form = n[self.rows] * n[self.columns] * self.factor
        history, best = numpy.zeros(len(self.beta)), 0.0
        unit = numpy.linalg.solve(self.stiffness(numpy.ones_like(history)), form)
        along = (unit @ form) * law.onset / self.driving(unit, numpy.ones_like(history), drop).max() * (1 - 1e-9)
        while True:
            for _ in range(100000):
                integrity = law.integrity(history)
                strain = numpy.linalg.solve(self.stiffness(integrity), form)
                stress = along / (strain @ form)
                driving = self.driving(strain * stress, integrity, drop)
                grown = numpy.maximum(history, numpy.where(driving > law.onset, driving, 0))
                done = abs(grown - history).max() < 1e-10 * law.onset
                history = grown
                if done or stress < 0.5 * best:
                    break
            best = max(best, stress)
            if stress < 0.9 * best:
                return best
            along *= 1 + step
