"""Contact of points with faces (docs/contact.md): for each point k (a d)^2 sum_F c_F b((d - r_F) / (a d)) over the parts F
of the surface, each coefficient one less those of the parts that it belongs to. The surface is found with scipy."""

import itertools

import numpy
from scipy.spatial import Delaunay

RADIUS = 1.25


def circumscribed(corners):
    """Radius of the circle or sphere through the corners of a simplex; 0 if it is flat."""
    sides = corners[1:] - corners[0]
    if abs(numpy.linalg.det(sides)) < 1e-5 * abs(sides).max() ** len(sides):
        return 0.0
    return numpy.linalg.norm(numpy.linalg.solve(2 * sides, (sides**2).sum(axis=1)))


def nearest_weights(arms):
    """Weights of the place of a closed part that is nearest to the origin: the best of all its open parts."""
    best, found = numpy.inf, None
    for size in range(1, len(arms) + 1):
        for taken in itertools.combinations(range(len(arms)), size):
            sides = arms[list(taken[1:])] - arms[taken[0]]
            inner = numpy.linalg.solve(sides @ sides.T, -sides @ arms[taken[0]]) if size > 1 else numpy.zeros(0)
            weights = numpy.zeros(len(arms))
            weights[list(taken)] = numpy.append(1 - inner.sum(), inner)
            squared = ((weights @ arms) ** 2).sum()
            if (weights >= 0).all() and squared < best * (1 - 1e-14):
                best, found = squared, weights
    return found


class FaceContact:
    def __init__(self, pairs):
        """pairs: a PairContact."""
        self.pairs, self.body = pairs, pairs.body
        size, self.dimension = pairs.size, self.body.dimension
        self.facets = self.surface()
        self.surface_points = sorted({corner for facet in self.facets for corner in facet})
        self.at_corner = {point: [] for point in self.surface_points}
        for number, facet in enumerate(self.facets):
            for corner in facet:
                self.at_corner[corner].append(number)
        self.sides = {id(table): [side.tolist() for side in pairs.sides(table)] for table in pairs.tables}
        self.facing = []  # point, table, d, k, its facets
        for table in pairs.tables:
            if table.get("shape") != "faces":
                continue
            one, other = pairs.sides(table)
            for point in self.surface_points:
                if not one[point] and not other[point]:
                    continue
                distance = table.get("distance", size[point])
                facets = [f for f, facet in enumerate(self.facets) if self.touches(point, facet, table)]
                rest = numpy.zeros_like(self.body.reference)
                near = [self.distance(point, self.facets[f], rest)[0] for f in self.within(point, facets, rest, distance)]
                opposite = other if one[point] else one
                modulus = pairs.modulus[point]
                if "with" in table:
                    across = pairs.modulus[[k for k in self.surface_points if opposite[k]]].mean()
                    modulus = 2 / (1 / modulus + 1 / across)
                section = {2: self.body.cross_section * size[point], 3: size[point] ** 2}[self.dimension]
                gap = min([distance, *near])
                self.facing.append((point, table, gap, table.get("stiffness", 1.0) * modulus * section / gap / 2, facets))

    def within(self, point, facets, u, distance):
        """Those of the facets that may be within a distance of a point."""
        if not facets:
            return []
        place = (self.body.reference + u).real
        corners = place[numpy.array(self.facets)[facets]]
        outside = numpy.maximum(corners.min(axis=1) - place[point], place[point] - corners.max(axis=1))
        return numpy.array(facets)[(outside <= distance * (1 + 1e-9)).all(axis=1)].tolist()

    def bonded(self, i, j):
        return min(i, j) * len(self.pairs.size) + max(i, j) in self.body.bond_number

    def surface(self):
        """Of simplices without an unbonded side; before, points move apart across these, so that cells of a lattice are
        cut along the crack."""
        reference, size = self.body.reference, self.pairs.size
        place = reference.copy()
        sides = {side for simplex in Delaunay(reference).simplices for side in itertools.combinations(sorted(simplex.tolist()), 2)}
        for i, j in sides:
            arm, least = reference[j] - reference[i], min(size[i], size[j])
            if numpy.linalg.norm(arm) <= 1.5 * least and not self.bonded(i, j):
                place[j] += 0.05 * least * arm / numpy.linalg.norm(arm)
                place[i] -= 0.05 * least * arm / numpy.linalg.norm(arm)
        times = {}
        for simplex in Delaunay(place).simplices:
            limit = RADIUS * size[simplex].max()
            if all(self.bonded(i, j) for i, j in itertools.combinations(simplex.tolist(), 2)):
                if circumscribed(place[simplex]) <= limit:
                    for facet in itertools.combinations(sorted(simplex.tolist()), self.dimension):
                        times[facet] = times.get(facet, 0) + 1
        return sorted(facet for facet, count in times.items() if count == 1)

    def touches(self, point, facet, table):
        one, other = self.sides[id(table)]
        across = all((one[point] and other[k]) or (other[point] and one[k]) for k in facet)
        return across and point not in facet and not any(self.bonded(point, k) for k in facet)

    def whole(self, integrity):
        number = self.body.bond_number
        sides = [[number[i * len(self.pairs.size) + j] for i, j in itertools.combinations(facet, 2)] for facet in self.facets]
        return [bool((integrity[side] >= 0.5).all()) for side in sides]

    def left_to_pairs(self, i, j, table, integrity):
        """Share of the contact of each pair of points without a bond that is not that of faces."""
        share, whole = numpy.ones(len(i)), self.whole(integrity)
        if table.get("shape") != "faces":
            return share
        for k, ends in enumerate(zip(i.tolist(), j.tolist())):
            if self.bonded(*ends):
                continue
            taken = [
                point in self.at_corner and any(whole[f] and self.touches(point, self.facets[f], table) for f in self.at_corner.get(corner, []))
                for point, corner in (ends, ends[::-1])
            ]
            share[k] = 1 - sum(taken) / 2
        return share

    def distance(self, point, part, u):
        """Distance from a closed part, its weights, and the arm from the nearest place; weights are held."""
        place = self.body.reference + u
        arms = place[list(part)] - place[point]
        weights = nearest_weights(arms.real)
        arm = -weights @ arms
        return numpy.sqrt((arm**2).sum()), weights, arm

    def touching(self, u, integrity, law):
        """Parts that press: point, corners, weights, energy, force on the point."""
        found, whole = [], self.whole(integrity)
        for point, table, gap, stiffness, facets in self.facing:
            near = [f for f in self.within(point, facets, u, gap) if whole[f]]
            coefficients = {}
            for size in range(self.dimension, 0, -1):
                parts = {part for f in near for part in itertools.combinations(self.facets[f], size)}
                for part in parts:
                    larger = [c for other, c in coefficients.items() if len(other) > size and set(part) < set(other)]
                    coefficients[part] = 1 - sum(larger)
            for part, coefficient in coefficients.items():
                distance, weights, arm = self.distance(point, part, u)
                deepest = table.get("depth", 0.25) * gap
                bend = table.get("softness", 1e-4) / table.get("depth", 0.25)
                rest = -weights @ (self.body.reference[list(part)] - self.body.reference[point])
                change = ((arm - rest) * (arm + rest)).sum()
                overlap = (gap**2 - (rest**2).sum() - change) / (gap + distance)
                if coefficient == 0 or not overlap.real > 0:
                    continue
                value, first = law(numpy.atleast_1d(overlap / deepest), bend)
                energy = coefficient * stiffness * deepest**2 * value[0]
                force = coefficient * stiffness * deepest * first[0] / distance * arm
                found.append((point, part, weights, energy, force))
        return found
