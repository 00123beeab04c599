"""The events of mode `path` in a body of states (model `state`), found by the NumPy reference: which bonds drop, what
they take and set free, and where the body settles. For small bodies, on supports alone."""

import types

import numpy

from tests.reference.events import AT_STRENGTH, TIE, Events
from tests.reference.laws import Law
from tests.reference.saw_tooth import SawTooth


class StateEvents:
    def __init__(self, solid, fails, held, table, *, teeth=10, tolerance=0.002):
        """solid: a FiniteSolid; fails: bonds that may; held: degrees of freedom that supports prescribe; table: the law."""
        self.solid, self.fails, self.held = solid, fails, held
        self.law = SawTooth(Law.of_table(table).spread(len(fails)), teeth)
        self.case = {"loading": {"event_tolerance": tolerance}}

    def told(self, bonds, history):
        """Histories as the reference knows them."""
        return self.law.told(bonds, history)[0]

    def next(self, history):
        return self.law.after(numpy.maximum(history, self.law.onset))

    def taken(self, history):
        """What the bonds have taken [J]."""
        work = self.law.moment(history) - self.law.integrity(history) * history**2 / 2
        return (self.solid.taken(1.0) * numpy.where(history > 0, work, 0.0)).sum()

    def with_damage(self, history):
        self.solid.integrity = self.law.integrity(history)
        return self.solid

    def utilisation(self, u, history):
        drops = self.law.integrity(history) - self.law.integrity(self.next(history))
        driving = self.with_damage(history).equivalent_stretches(u, drops)
        bears = self.fails & (history < self.law.critical)
        return driving / numpy.where(bears, numpy.maximum(history, self.law.onset), numpy.inf)

    def batch(self, utilisation):
        return Events.batch(types.SimpleNamespace(case=self.case), utilisation)

    def energy(self, u, history):
        return self.with_damage(history).energies(u).sum()

    def settle(self, u, history):
        """The equilibrium with the same supports, by iterations with the matrix of the first state, and the residual."""
        solid, free = self.with_damage(history), ~self.held.ravel()
        matrix = solid.matrix(u)[numpy.ix_(free, free)]
        matrix += 1e-11 * numpy.abs(numpy.diag(matrix)).max() * numpy.eye(len(matrix))
        inverse = numpy.linalg.inv(matrix)
        u, scale = u.copy(), numpy.abs(solid.forces(u)).max()
        for _ in range(100):
            force = solid.forces(u).ravel()[free]
            if numpy.abs(force).max() < 1e-11 * scale:
                break
            u.ravel()[free] -= inverse @ force
        return u, numpy.abs(force).max() / scale

    def event(self, u, history):
        """The bonds that drop, the histories after, and the energies that are drained and missing."""
        utilisation = self.utilisation(u, history)
        bonds, after = self.batch(utilisation), history.copy()
        after[bonds] = self.next(history)[bonds]
        lost = self.energy(u, history) - self.energy(u, after)
        short = self.taken(after) - self.taken(history) - lost
        settled, rest = self.settle(u, after)
        drained = self.energy(u, after) - self.energy(settled, after) + max(-short, 0.0)
        return {"bonds": bonds, "after": after, "drained": drained, "short": max(short, 0.0), "rest": rest, "settled": settled}
