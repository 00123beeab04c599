"""Contact of points without a whole bond (docs/contact.md): E = sum (1 - T) k (a d)^2 b((d - r) / (a d)) over pairs."""

import numpy

from tests.reference.body import pairs_within
from tests.reference.face_contact import FaceContact


NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(60)


def law(x, bend):
    """b and b', by quadrature of b' = s / (1 - s): the closed forms of the program are not used."""
    value, first = numpy.zeros_like(x), numpy.zeros_like(x)

    def slope(depth):
        s = numpy.where(depth.real <= bend, depth**2 / (2 * bend), depth - bend / 2)
        return s / (1 - s)

    touches = x.real > 0
    depth = x[touches]
    first[touches] = slope(depth)
    in_onset = numpy.where(depth.real < bend, depth, bend)
    for begin, end in ((0 * depth, in_onset), (in_onset, depth)):
        at = begin[:, None] + (end - begin)[:, None] * (NODES + 1) / 2
        value[touches] += (end - begin) / 2 * (slope(at) * WEIGHTS).sum(axis=1)
    return value, first


class PairContact:
    def __init__(self, body):
        self.body, case = body, body.case
        size = (body.volume / body.cross_section) ** (1 / body.dimension)
        tables = body.materials.tables
        modulus = numpy.array([table["youngs_modulus"] for table in tables], float)
        self.modulus = modulus[body.materials.number]
        self.size, self.tables = size, case.get("contact")
        self.reach = max(table.get("distance", size.max()) for table in self.tables)
        has_faces = any(table.get("shape") == "faces" for table in self.tables)
        self.faces = FaceContact(self) if has_faces else None

    def sides(self, table):
        everywhere = numpy.ones(len(self.size), bool)
        one = self.body.sets[table["set"]] if "set" in table else everywhere
        return one, self.body.sets[table["with"]] if "with" in table else one

    def touching(self, u, integrity):
        """Pairs that press, with their energy and the force on the second point."""
        body, tables = self.body, self.tables
        place = body.reference + u
        i, j = pairs_within(place.real, self.reach).T
        number = [body.bond_number.get(code, -1) for code in body.codes(numpy.stack([i, j], 1)).tolist()]
        bond = numpy.array(number, int)
        share = numpy.where(bond < 0, 1.0, 1 - numpy.append(integrity, 0)[bond])
        arm = place[j] - place[i]
        distance = numpy.sqrt((arm**2).sum(axis=1))
        rest = body.reference[j] - body.reference[i]
        length = numpy.sqrt((rest**2).sum(axis=1))
        change = ((u[j] - u[i]) * (2 * rest + u[j] - u[i])).sum(axis=1)  # of the squared distance, without cancellation
        energy, force = numpy.zeros_like(distance), numpy.zeros_like(arm)
        for table in tables:
            one, other = self.sides(table)
            taken = (one[i] & other[j]) | (one[j] & other[i])
            mean = (self.size[i] + self.size[j]) / 2
            gap = numpy.minimum(length, table.get("distance", mean))
            section = {1: body.cross_section, 2: body.cross_section * mean, 3: mean**2}[body.dimension]
            harmonic = 2 / (1 / self.modulus[i] + 1 / self.modulus[j])
            stiffness = table.get("stiffness", 1.0) * harmonic * section / gap * share * taken
            if self.faces:
                stiffness = stiffness * self.faces.left_to_pairs(i, j, table, integrity)
            deepest = table.get("depth", 0.25) * gap
            value, first = law((gap**2 - length**2 - change) / (gap + distance) / deepest, table.get("softness", 1e-4) / table.get("depth", 0.25))
            energy = energy + stiffness * deepest**2 * value
            force = force + (stiffness * deepest * first / distance)[:, None] * arm
        presses = abs(energy) > 0
        return i[presses], j[presses], energy[presses], force[presses]

    def point_energies(self, u, integrity):
        i, j, energy, _ = self.touching(u, integrity)
        total = numpy.zeros(len(self.size), energy.dtype)
        for end in (i, j):
            numpy.add.at(total, end, energy / 2)
        for point, part, weights, energy, _ in self.on_faces(u, integrity):
            total[point] += energy / 2
            total[list(part)] += weights * energy / 2
        return total

    def on_faces(self, u, integrity):
        return self.faces.touching(u, integrity, law) if self.faces else []
