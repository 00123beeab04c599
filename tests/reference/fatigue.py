"""Fatigue of a lattice of equal bonds between given displacements, by dense matrices of NumPy.

Bonds of any points within a horizon have the energy L s^2 / 2 (the constant and the weights, equal for all, do not
matter), s = l / L - 1. A bond loses A (|s| (1 - R) - limit)^m of its life in a cycle. The bond whose life ends first
breaks, with all that tie with it; the equilibrium is found by Newton's method. Near a crack, where a point has lost the
given share of its bonds, the other law holds, with a new life.
"""

import itertools

import numpy

TIE = 1e-6


class Lattice:
    def __init__(self, points, horizon, is_cut=lambda a, b: False):
        self.points = numpy.array(points, dtype=float)
        count, self.dimension = self.points.shape
        pairs = [(i, j) for i, j in itertools.combinations(range(count), 2)
                 if numpy.linalg.norm(self.points[j] - self.points[i]) <= horizon]  # fmt: skip
        self.cut = [pair for pair in pairs if is_cut(*self.points[list(pair)])]
        self.bonds = numpy.array([pair for pair in pairs if pair not in self.cut])
        self.arms = self.points[self.bonds[:, 1]] - self.points[self.bonds[:, 0]]
        self.lengths = numpy.linalg.norm(self.arms, axis=1)

    def deformed(self, displacement):
        arms = self.arms + displacement[self.bonds[:, 1]] - displacement[self.bonds[:, 0]]
        lengths = numpy.linalg.norm(arms, axis=1)
        return arms / lengths[:, None], lengths, lengths / self.lengths - 1.0

    def equilibrium(self, displacement, fixed, intact):
        """From displacements that have the given values; fixed: a mask of degrees of freedom."""
        free = numpy.flatnonzero(~fixed.ravel())
        d = self.dimension
        for _ in range(50):
            direction, lengths, stretch = self.deformed(displacement)
            force = numpy.zeros_like(displacement)
            stiffness = numpy.zeros((displacement.size,) * 2)
            for b in numpy.flatnonzero(intact):
                i, j = self.bonds[b]
                n, s = direction[b], stretch[b]
                force[i] += s * n
                force[j] -= s * n
                block = numpy.outer(n, n) / self.lengths[b] + s / lengths[b] * (numpy.eye(d) - numpy.outer(n, n))
                for p, q, sign in ((i, i, 1), (j, j, 1), (i, j, -1), (j, i, -1)):
                    stiffness[p * d : p * d + d, q * d : q * d + d] += sign * block
            step = numpy.linalg.solve(stiffness[numpy.ix_(free, free)], force.ravel()[free])
            displacement = displacement.copy()
            displacement.ravel()[free] += step
            if numpy.abs(step).max() < 1e-13 * numpy.abs(displacement).max():  # of a step that squares the error
                return displacement
        raise RuntimeError("no equilibrium")


def rate(law, reach):
    if law is None:
        return numpy.zeros_like(reach)
    coefficient, exponent, limit = law
    return numpy.where(reach > limit, coefficient * numpy.maximum(reach - limit, 0.0) ** exponent, 0.0)


def near_crack(lattice, intact, crack_damage):
    """True for bonds of which an end is a neighbour of a point with that damage, or is such a point."""
    count = len(lattice.points)
    whole, lost = numpy.zeros(count), numpy.zeros(count)
    for (i, j), is_whole in itertools.chain(zip(lattice.bonds, intact), ((pair, False) for pair in lattice.cut)):
        for point in (i, j):
            whole[point] += 1
            lost[point] += not is_whole
    cracked = lost / numpy.maximum(whole, 1) >= crack_damage
    near = cracked.copy()
    for i, j in itertools.chain(lattice.bonds, lattice.cut):
        near[i] |= cracked[j]
        near[j] |= cracked[i]
    return near[lattice.bonds].any(axis=1)


def events(lattice, displacement, fixed, blocks, ratio=0.0, nucleation=None, growth=None, crack_damage=0.3):
    """Cycles and broken bonds of each block, as pairs of points."""
    intact = numpy.ones(len(lattice.bonds), dtype=bool)
    life, grows = numpy.ones(len(intact)), numpy.zeros(len(intact), dtype=bool)
    cycles, found = 0.0, []
    for _ in range(blocks):
        displacement = lattice.equilibrium(displacement, fixed, intact)
        if growth:
            new = near_crack(lattice, intact, crack_damage) & ~grows & intact
            grows |= new
            life[new] = 1.0
        reach = (1.0 - ratio) * numpy.abs(lattice.deformed(displacement)[2])
        rates = numpy.where(grows, rate(growth, reach), rate(nucleation, reach)) * intact * (reach > 1e-12)
        if not rates.any():
            break
        length = (life[rates > 0] / rates[rates > 0]).min()
        life -= rates * length
        cycles += length
        worn = (rates > 0) & (life <= TIE)
        intact &= ~worn
        found.append((cycles, lattice.bonds[worn]))
    return found
