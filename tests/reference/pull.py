"""Strength of a lattice under a homogeneous stress whose strain grows (docs/theory.md, Fracture data)."""

import itertools
import math

import numpy


class Pull:
    """Interactions whose energy per volume is stiffness / 2 times their relative change squared, times the product of
    the integrities of their sides. A bond is its own side."""

    def __init__(self, direction, stiffness):
        """stiffness: w r / (2 V) of every bond [m4]; c T s n n^T times this is its part of the stress."""
        self._set_directions(direction)
        self.kinds = [(self.dyad, numpy.arange(len(self.dyad))[:, None], stiffness)]

    @classmethod
    def of_bulk(cls, bulk):
        return cls(bulk.direction, bulk.weight * bulk.length / 2)

    @classmethod
    def of_cpd(cls, tear):
        """Interactions of all orders in a planar lattice; stiffness in Pa."""
        pull, sides, first = cls.__new__(cls), [], 0
        for places, _ in tear.kinds:
            pairs = itertools.combinations(range(places.shape[1]), 2)
            sides.append(numpy.stack([places[:, b] - places[:, a] for a, b in pairs], 1))
        arms = numpy.concatenate([of.reshape(-1, tear.dimension) for of in sides])
        pull._set_directions(arms / numpy.linalg.norm(arms, axis=1)[:, None])
        pull.kinds = []
        for (_, stiffness), of in zip(tear.kinds, sides, strict=True):
            number = first + numpy.arange(of.shape[0] * of.shape[1]).reshape(of.shape[:2])
            first += number.size
            area = numpy.tile((pull.entries[0] == pull.entries[1]).astype(float), (len(of), 1))
            pull.kinds.append((pull.dyad[number[:, 0]] if of.shape[1] == 1 else area, number, stiffness))
        return pull

    def _set_directions(self, direction):
        rows, columns = numpy.triu_indices(direction.shape[1])
        self.share = numpy.where(rows == columns, 1.0, math.sqrt(2))  # factor of the strain's entries in vector form
        self.entries = rows, columns
        self.dyad = direction[:, rows] * direction[:, columns] * self.share

    def secant(self, integrity):
        """Stress over strain at the given integrities of the sides."""
        return sum((measure.T * (stiffness * integrity[side].prod(axis=1))) @ measure for measure, side, stiffness in self.kinds)

    def _stress_and_tangent(self, strain, integrity, slope):
        stress, tangent = 0.0, self.secant(integrity)
        for measure, side, stiffness in self.kinds:
            of_sides, force = integrity[side], stiffness * (measure @ strain)
            stress = stress + measure.T @ (force * of_sides.prod(axis=1))
            for k in range(side.shape[1]):
                others = numpy.delete(of_sides, k, axis=1).prod(axis=1)
                tangent = tangent + (measure.T * (force * others * slope[side[:, k]])) @ self.dyad[side[:, k]]
        return stress, tangent

    def peak(self, law, form, finest=1e-9, coarsest=0.02):
        """Largest stress over c (for cpd: in Pa), in multiples of `form`."""
        form = form[self.entries] * self.share
        strain = numpy.linalg.solve(self.secant(numpy.ones(len(self.dyad))), form)
        stress = law.onset / (self.dyad @ strain).max() * (1 - 1e-9)
        start = (stress * (strain @ form), stress * strain, stress, numpy.zeros(len(self.dyad)))
        return self._march(law, form, start, coarsest, finest, numpy.inf)

    def _march(self, law, form, here, step, finest, end):
        """Steps the strain along the form from a state on, and again in finer steps about each maximum."""
        best, before = here[2], here
        while here[0] < end:
            there = self._settle(law, form, here[0] * (1 + step), here)
            if before[2] <= here[2] > there[2] and here[2] > 0.98 * best and step > finest:
                best = max(best, self._march(law, form, before, step / 8, finest, there[0]))
            best = max(best, there[2])
            if there[2] < 0.9 * best:
                break
            before, here = here, there
        return best

    def _settle(self, law, form, along, since):
        """The state with a given strain along the form."""
        _, strain, stress, history = since
        strain, scale = strain * along / since[0], numpy.trace(self.secant(numpy.ones(len(self.dyad))))
        for _ in range(30):
            stretch = self.dyad @ strain
            grows = stretch > history
            integrity = law.integrity(numpy.where(grows, stretch, history))
            slope = numpy.imag(law.integrity(stretch + 1e-30j)) / 1e-30
            borne, tangent = self._stress_and_tangent(strain, integrity, numpy.where(grows, slope, 0.0))
            matrix = numpy.block([[tangent / scale, -form[:, None]], [form[None], numpy.zeros((1, 1))]])
            change = numpy.linalg.lstsq(matrix, numpy.append((stress * form - borne) / scale, along - form @ strain), rcond=1e-13)[0]
            strain, stress = strain + change[:-1], stress + scale * change[-1]
            if abs(change[:-1]).max() < 1e-11 * abs(strain).max():
                if self._has_stiffened(along, stress, since):
                    break
                return along, strain, stress, numpy.maximum(history, self.dyad @ strain)
        return self._settle_by_secants(law, form, along, since)

    @staticmethod
    def _has_stiffened(along, stress, since):
        """Stress over strain, like the integrities, can only decrease. A state with a larger stress is no equilibrium,
        but an artefact of the pseudoinverse for a lattice that has lost its stiffness."""
        return stress * since[0] > since[2] * along * (1 + 1e-9)

    def _settle_by_secants(self, law, form, along, since):
        """Iterates with damage that grows in each iteration."""
        history = since[3]
        for _ in range(10000):
            strain, *_ = numpy.linalg.lstsq(self.secant(law.integrity(history)), form, rcond=1e-11)
            stress = along / (strain @ form)
            if self._has_stiffened(along, stress, since) or stress < 1e-3 * since[2]:
                return along, strain, 0.0, history
            strain = strain * stress
            grown = numpy.maximum(history, self.dyad @ strain)
            if (grown - history).max() < 1e-11 * law.onset:
                break
            history = grown
        return along, strain, stress, history


def uniaxial(direction):
    n = numpy.asarray(direction, float) / numpy.linalg.norm(direction)
    return numpy.outer(n, n)
