"""Springs of elastic foundations (docs/theory.md, Constraints): k (u - g)2 / 2 per component."""

import numpy

from tests.reference.case import evaluate


class Foundations:
    """`stiffness` of each foundation at each point, points x dimension [N/m]."""

    def __init__(self, case, conditions):
        self.conditions, self.tables = conditions, case.get("foundation")
        self.stiffness = {}
        for table in self.tables:
            members = conditions.sets[table["set"]] if "set" in table else numpy.ones(len(conditions.volume), bool)
            if "modulus" in table:
                share = conditions.traction_areas(table, members)
            else:
                volume = numpy.where(members, conditions.volume, 0)
                share = volume / volume.sum()
            self.stiffness[table["name"]] = numpy.outer(share, table.get("modulus", table.get("stiffness")))

    def ground(self, table, load):
        place = self.conditions.reference
        components = table.get("displacement", [0] * place.shape[1])
        return numpy.stack([evaluate(c, place, load, self.conditions.spacing) * numpy.ones(len(place)) for c in components], 1)

    def forces(self, displacement, load):
        """Force on each point, by name [N]."""
        return {table["name"]: self.stiffness[table["name"]] * (self.ground(table, load) - displacement) for table in self.tables}

    def force(self, displacement, load):
        return sum(self.forces(displacement, load).values(), numpy.zeros(displacement.shape))

    def energy(self, displacement, load):
        """Energy per point [J]."""
        return sum((0.5 * self.stiffness[table["name"]] * (self.ground(table, load) - displacement) ** 2
                    for table in self.tables), numpy.zeros(displacement.shape)).sum(axis=1)  # fmt: skip

    def work(self, old, new):
        """Work of the ground's motion from one step to another: half of the energy that it adds in both states [J]."""
        return sum((self.energy(u, new.loads) - self.energy(u, old.loads)).sum() / 2 for u in (old.displacement, new.displacement))
