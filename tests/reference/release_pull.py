"""Strength of a lattice of cpd whose bonds fail by what they release, under a homogeneous stress whose strain grows
(docs/theory.md, Strength), in NumPy. No derivative is used: strain and damage are found in turns.

With W(eps, T) the energy per volume, bonds a_b T_b s_b^2 / 2 and triangles and tetrahedra a (product of the T of their
sides) (M : eps)^2 / 2, a bond has s_eq^2 = 2 dW/dT_b / a_b where s_b > 0.
"""

import itertools
import math

import numpy

from tests.reference.tear import directions


class ReleasePull:
    def __init__(self, tear):
        d = self.dimension = tear.dimension
        self.rows, self.columns = numpy.triu_indices(d)
        self.factor = numpy.where(self.rows == self.columns, 1.0, math.sqrt(2))
        bonds = tear.kinds[0][0][:, 1]
        spacing = numpy.linalg.norm(bonds, axis=1).min()
        numbers = {}

        def number(arm):
            cells = tuple(numpy.rint(arm / spacing).astype(int).tolist())
            return numbers.setdefault(max(cells, tuple(-c for c in cells)), len(numbers))

        of_bonds = [number(arm) for arm in bonds]
        self.stiffness = numpy.bincount(of_bonds, tear.kinds[0][1])
        arms = numpy.array(list(numbers), float)
        self.dyad = self.vectors(arms / numpy.linalg.norm(arms, axis=1)[:, None])
        self.kinds = []
        for places, stiffness in tear.kinds[1:]:
            pairs = list(itertools.combinations(range(places.shape[1]), 2))
            sides = numpy.array([[number(of[b] - of[a]) for a, b in pairs] for of in places])
            measure = numpy.tile((self.rows == self.columns).astype(float), (len(places), 1))
            if d == 3 and places.shape[1] == 3:
                normal = numpy.cross(places[:, 1] - places[:, 0], places[:, 2] - places[:, 0])
                measure -= self.vectors(normal / numpy.linalg.norm(normal, axis=1)[:, None])
            self.kinds.append((measure, sides, stiffness))

    def vectors(self, normals):
        return normals[:, self.rows] * normals[:, self.columns] * self.factor

    def stiffness_with(self, integrity):
        total = (self.dyad.T * (self.stiffness * integrity)) @ self.dyad
        for measure, sides, stiffness in self.kinds:
            total += (measure.T * (stiffness * integrity[sides].prod(axis=1))) @ measure
        return total

    def driving(self, strain, integrity):
        stretch = self.dyad @ strain
        released = self.stiffness * stretch**2
        for measure, sides, stiffness in self.kinds:
            energy = stiffness * (measure @ strain) ** 2
            for k in range(sides.shape[1]):
                others = numpy.delete(integrity[sides], k, axis=1).prod(axis=1)
                released += numpy.bincount(sides[:, k], energy * others, minlength=len(released))
        return numpy.sqrt(numpy.maximum(numpy.where(stretch > 0, released / self.stiffness, 0), 0))

    def strength(self, law, **more):
        """The mean of `peak` over directions."""
        return sum(weight * self.peak(law, normal, **more) for normal, weight in zip(*directions(self.dimension), strict=True))

    def peak(self, law, normal, step=1e-3):
        """Largest stress [Pa] under uniaxial tension along a direction.

        step: relative, of the strain along the direction."""
        n = numpy.asarray(normal, float) / numpy.linalg.norm(normal)
        form = self.vectors(n[None])[0]
        history, best = numpy.zeros(len(self.stiffness)), 0.0
        whole = numpy.ones_like(history)
        unit = numpy.linalg.solve(self.stiffness_with(whole), form)
        along = (unit @ form) * law.onset / self.driving(unit, whole).max() * (1 - 1e-9)
        while True:
            for _ in range(100000):
                integrity = law.integrity(history)
                strain = numpy.linalg.solve(self.stiffness_with(integrity), form)
                stress = along / (strain @ form)
                driving = self.driving(strain * stress, integrity)
                grown = numpy.maximum(history, numpy.where(driving > law.onset, driving, 0))
                done = abs(grown - history).max() < 1e-10 * law.onset
                history = grown
                if done or stress < 0.5 * best:
                    break
            best = max(best, stress)
            if stress < 0.9 * best:
                return best
            along *= 1 + step
