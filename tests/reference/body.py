"""Points, their interactions and the weights of interactions (docs/theory.md)."""

import itertools
import math

import numpy

from tests.reference.beyond import Beyond
from tests.reference.case import NotUnderstood, read_neighbours, read_points
from tests.reference.influence import influence, relative_moment
from tests.reference.materials import Materials
from tests.reference.parts import lattice_shares
from tests.reference.sheets import resolve

HORIZON_TOLERANCE = 1e-8


def pairs_within(reference, radius, first_points=None):
    """All pairs i < j no farther apart than the radius; i is one of the first `count` points if a count is given."""
    count, pairs = len(reference) if first_points is None else first_points, []
    for first in range(0, count, 256):
        rows = reference[first : min(first + 256, count)]
        squared = sum((rows[:, None, c] - reference[None, :, c]) ** 2 for c in range(reference.shape[1]))
        i, j = numpy.nonzero(squared <= (radius * (1 + HORIZON_TOLERANCE)) ** 2)
        keep = i + first < j
        pairs.append(numpy.stack([i[keep] + first, j[keep]], axis=1))
    return numpy.concatenate(pairs)


def measure(arms):
    """Signed length, area or volume of interactions from their arms (a list of vectors)."""
    dimension = arms[0].shape[-1]
    if len(arms) == 1:
        return numpy.sqrt((arms[0] ** 2).sum(axis=-1))
    if len(arms) == 2 and dimension == 2:
        return arms[0][..., 0] * arms[1][..., 1] - arms[0][..., 1] * arms[1][..., 0]
    if len(arms) == 2:
        return numpy.sqrt((numpy.cross(*arms) ** 2).sum(axis=-1))
    return (arms[0] * numpy.cross(arms[1], arms[2])).sum(axis=-1)


def arms_of(tuples, places):
    """Vectors from the first point of every tuple to the others."""
    first, *others = (numpy.take(places, ends, axis=0) for ends in tuples.T)
    return [other - first for other in others]


def cliques(bonds, count, size, first_points=None):
    """All tuples of `size` mutually bonded points, ascending; see pairs_within."""
    linked = [set() for _ in range(count)]
    for i, j in bonds.tolist():
        linked[i].add(j)
    found = []
    for i in range(count if first_points is None else first_points):
        for others in itertools.combinations(sorted(linked[i]), size - 1):
            if all(b in linked[a] for a, b in itertools.combinations(others, 2)):
                found.append((i, *others))
    return numpy.array(found, int).reshape(-1, size)


def lattice_ball(dimension, ratio, edges=1.0):
    """Neighbours of a lattice's bulk point, in spacings; `edges` are those of cells that are not square."""
    edges = numpy.broadcast_to(edges, (dimension,))
    reaches = (ratio * (1 + HORIZON_TOLERANCE) / edges).astype(int)
    grid = numpy.array(list(itertools.product(*(range(-reach, reach + 1) for reach in reaches))), float) * edges
    distance = numpy.sqrt((grid**2).sum(axis=1))
    return grid[(distance > 0) & (distance <= ratio * (1 + HORIZON_TOLERANCE))]


def influence_of_sides(name, tuples, places):
    """Product of the influences of all pairs of a tuple's points; positions in horizons."""
    factor = numpy.ones(len(tuples))
    for a, b in itertools.combinations(range(tuples.shape[1]), 2):
        arm = places[tuples[:, a]] - places[tuples[:, b]]
        factor *= influence(name, numpy.sqrt((arm**2).sum(axis=1)))
    return factor


def ball_volume(dimension, horizon, cross_section):
    return {1: 2 * horizon, 2: math.pi * horizon**2, 3: 4 / 3 * math.pi * horizon**3}[dimension] * cross_section


def micromodulus_factor(dimension, material, horizon, cross_section):
    """c / E."""
    plane = material["plane"]
    return constant_factor(dimension, plane, horizon, cross_section) / relative_moment(material["influence"], dimension)


def constant_factor(dimension, plane, horizon, cross_section):
    """c / E for the influence function 1."""
    if dimension == 1:
        return 2 / (cross_section * horizon**2)
    if dimension == 2 and plane == "stress":
        return 9 / (math.pi * horizon**3 * cross_section)
    if dimension == 2:
        return 48 / (5 * math.pi * horizon**3 * cross_section)
    return 12 / (math.pi * horizon**4)


def shape_norm(shape, vectors):
    """Maximum norm or sum norm."""
    return abs(vectors).max(axis=1) if shape == "box" else abs(vectors).sum(axis=1)


def turned_back(vectors, angle):
    """Rotates vectors along the axes by an angle about z."""
    result = vectors.copy()
    if vectors.shape[1] > 1:
        x, y = vectors[:, 0], vectors[:, 1]
        result[:, 0], result[:, 1] = math.cos(angle) * x + math.sin(angle) * y, math.cos(angle) * y - math.sin(angle) * x
    return result


def mean_of_reach(shape, dimension, power):
    """Mean over all directions of norm^-power, by Gauss quadrature over the angles, between the norm's kinks."""
    if shape == "ball" or dimension == 1:
        return 1.0
    nodes, weights = numpy.polynomial.legendre.leggauss(40)

    def over(begin, end):
        return begin + (end - begin) * (nodes + 1) / 2, weights * (end - begin) / 2

    flat, of_flat = over(0.0, math.pi / 4)
    flat, of_flat = numpy.append(flat, math.pi / 2 - flat), numpy.append(of_flat, of_flat)
    around = numpy.stack([numpy.cos(flat), numpy.sin(flat)], 1)
    if dimension == 2:
        return (of_flat * shape_norm(shape, around) ** -power).sum() / (math.pi / 2)
    total = 0.0
    for (cosine, sine), weight in zip(around, of_flat):
        edge = math.atan2(1.0, max(cosine, sine))  # where the height equals the largest in-plane component
        for polar, of_polar in (over(0.0, edge), over(edge, math.pi / 2)):
            directions = numpy.stack([numpy.sin(polar) * cosine, numpy.sin(polar) * sine, numpy.cos(polar)], 1)
            total += weight * (of_polar * numpy.sin(polar) * shape_norm(shape, directions) ** -power).sum()
    return total / (math.pi / 2)


def confined_modulus_factor(dimension, plane):
    """c11 / E: stress over strain along an axis with the other strains held at zero."""
    if dimension == 1:
        return 1.0
    if dimension == 2 and plane == "stress":
        return 1 / (1 - (1 / 3) ** 2)
    return 0.75 / (1.25 * 0.5)  # Poisson's ratio 1/4


class Body:
    """All constant data: interactions as arrays of point numbers, with their weights.

    bonds, triangles, tetrahedra: (points, weight, reference measure), the measures with sign. Weights are relative
    to the constants of the first material.

    sets: flags of the points by name, for regions; factors: random factors of the points, by name. The arrays cover
    the `own` points, followed by those beyond planes of symmetry and periods. Interactions are those with at least
    one own point; `share` is the part of each that belongs to the body.
    """

    def __init__(self, case, reference, volume, horizon_ratio=None, sets=None, factors=None):
        self.case, self.dimension = case, case.dimension
        self.horizon = case.horizon(horizon_ratio, volume)
        self.spacing = case.spacing(volume)
        self.cross_section = case.cross_section
        self.is_cpd = case["material"]["model"] == "cpd"
        is_box = case["quadrature"].get("horizon_shape") == "box"
        self.farthest = self.horizon * (math.sqrt(self.dimension) if is_box else 1.0)
        volume = numpy.asarray(volume, float)
        largest = (volume.max() / self.cross_section) ** (1 / self.dimension)
        self.beyond = Beyond(case, numpy.asarray(reference, float), self.spacing, self.farthest + largest)
        self.reference, self.own, self.source = self.beyond.places, self.beyond.own, self.beyond.source
        self.volume = volume[self.source]
        self.sets = {name: flags[self.source] for name, flags in (sets or {}).items()}
        factors = {name: values[self.source] for name, values in (factors or {}).items()}
        resolve(case, self.spacing, horizon_ratio)
        self.materials = Materials(case, self.sets, len(self.volume), factors)
        self.tuples, self.weight = {}, {}
        self.flatness, self.factor_sums = {}, {}  # cpd: g of interactions, and their sums at points
        if self.is_cpd:
            self._make_cpd()
        else:
            self._make_bonds()
        self._cut()
        self.measure = {k: measure(arms_of(t, self.reference)) for k, t in self.tuples.items()}
        self.share = {k: (t < self.own).mean(axis=1) for k, t in self.tuples.items()}
        self._number_bonds()

    @property
    def bonds(self):
        return self.tuples[1]

    @property
    def lengths(self):
        return self.measure[1]

    # ---- bonds ------------------------------------------------------------------------------------

    def _make_bonds(self):
        material, quadrature = self.materials.tables[0], self.case["quadrature"]
        factor = micromodulus_factor(self.dimension, self.case["material"], self.horizon, self.cross_section)
        shape = quadrature.get("horizon_shape", "ball")
        factor /= mean_of_reach(shape, self.dimension, 1 + self.dimension)
        if "micromodulus" in material:
            self.constants = {1: float(material["micromodulus"])}
        else:
            self.constants = {1: material["youngs_modulus"] * factor}
        self.youngs_modulus = self.constants[1] / factor
        size = (self.volume / self.cross_section) ** (1 / self.dimension)
        own_ratio = self.case.ratio_to_sizes
        linear = quadrature["volume_correction"] == "linear"
        given = self._given_pairs()
        exact = quadrature["volume_correction"].startswith("exact")
        reach = numpy.sqrt((self.case.spacings**2).sum()) / 2 if exact else size.max() / 2 if linear else 0
        pairs = given[0] if given else pairs_within(self.reference, self.farthest + reach, self.own)
        i, j = pairs.T
        arm = self.reference[j] - self.reference[i]
        length = numpy.sqrt((arm**2).sum(axis=1))

        def share(of):
            if not linear:
                return numpy.ones(len(pairs))
            inside = numpy.clip((self.horizon + of / 2 - length) / of, 0, 1)
            return numpy.where(inside < HORIZON_TOLERANCE, 0, inside)  # round-off at the far end

        name, counted = self.case["material"]["influence"], length / self.horizon
        if shape != "ball":
            angle = math.radians(self.case["lattice"].get("angle", 0.0)) if self.case.is_lattice else 0.0
            counted = shape_norm(shape, turned_back(arm, angle)) / self.horizon
        if exact:
            if self.case["lattice"].get("points") == "blue_noise" or self.case["lattice"].get("cell_perturbation"):
                raise NotUnderstood("parts of cells that are polygons: results don't tell their corners")
            mean_share, of_centroids = lattice_shares(arm, self.case.spacings, self.case["lattice"].get("angle", 0.0), self.horizon)
            if quadrature["volume_correction"] == "exact_centroids":
                mean_share, counted = mean_share * of_centroids / counted, of_centroids
        else:
            mean_share = given[1] if given else (share(size[j]) + share(size[i])) / 2
        if shape != "ball":
            mean_share = mean_share * (counted <= 1 + HORIZON_TOLERANCE)
        mean_share = mean_share * influence(name, counted)
        if own_ratio:
            mean_share = self._directed_shares(i, j, length, size, own_ratio, linear)
        weight = self.volume[i] * self.volume[j] * mean_share
        keep = weight > 0
        pairs, arm, length, weight, mean_share = (a[keep] for a in (pairs, arm, length, weight, mean_share))
        surface = quadrature["surface_correction"]
        if surface == "volume":
            weight = weight * self._volume_correction(pairs, mean_share)
        elif surface == "energy":
            weight = weight * self._energy_correction(pairs, arm / length[:, None], length, weight)
        if not self.materials.are_one:
            own = self.materials.bond_constants(pairs, arm / length[:, None], factor)
            weight = weight * own / self.constants[1]
        self.tuples[1], self.weight[1] = pairs, weight

    def _directed_shares(self, i, j, length, size, ratio, linear):
        """Mean over the two directions of a pair, each within the horizon of its first point, in micromoduli of the
        largest horizon."""
        both = 0.0
        for of, other in ((i, j), (j, i)):
            horizon = ratio * size[of]
            if linear:
                inside = numpy.clip((horizon + size[other] / 2 - length) / size[other], 0, 1)
                inside = numpy.where(inside < HORIZON_TOLERANCE, 0, inside)
            else:
                inside = length <= horizon * (1 + HORIZON_TOLERANCE)
            omega = influence(self.case["material"]["influence"], length / horizon)
            both = both + numpy.where(inside > 0, inside * omega, 0) * (self.horizon / horizon) ** (self.dimension + 1)
        return both / 2

    def _given_pairs(self):
        """Neighbours from a file and the means of their shares, by the numbers of these points."""
        if self.case.is_lattice or "neighbours" not in self.case["points"]:
            return None
        places, _, _ = read_points(self.case)
        number = {tuple(place): k for k, place in enumerate(self.reference.tolist())}
        renumbered = numpy.array([number[tuple(place)] for place in places.tolist()])
        pairs, shares = read_neighbours(self.case)
        return numpy.sort(renumbered[pairs], axis=1), shares.mean(axis=1)

    def _volume_correction(self, pairs, share):
        i, j = pairs.T
        own = self._sum_over(i, share * self.volume[j]) + self._sum_over(j, share * self.volume[i])
        if self.case.ratio_to_sizes:  # that of a lattice of each point's size and horizon
            size = self.case.sizes(self.volume)
            own = own / (self.horizon / (self.case.ratio_to_sizes * size)) ** (self.dimension + 1) / size**self.dimension
            return 2 * self._bulk_volume(self.case.ratio_to_sizes) / self.spacing**self.dimension / (own[i] + own[j])
        return 2 * self._bulk_volume() / (own[i] + own[j])

    def _bulk_volume(self, ratio=None):
        """V_H of a point inside the lattice; for a cloud, of a lattice with its mean spacing."""
        correction, name = self.case["quadrature"]["volume_correction"], self.case["material"]["influence"]
        ratio = ratio or self.horizon / self.spacing
        edges = self.case.spacings / self.spacing if self.case.is_lattice else 1.0
        shape = self.case["quadrature"].get("horizon_shape", "ball")
        farthest = ratio * self.farthest / self.horizon
        ball = lattice_ball(self.dimension, farthest + (0.0 if correction == "none" else 1.0), edges)
        if shape != "ball":
            ball = ball[shape_norm(shape, ball) <= ratio * (1 + HORIZON_TOLERANCE)]
        distance = numpy.sqrt((ball**2).sum(axis=1)) if shape == "ball" else shape_norm(shape, ball)
        counted = distance / ratio
        if correction.startswith("exact"):
            shares, of_centroids = lattice_shares(ball * self.spacing, self.case.spacings, 0.0, self.horizon)
            if correction == "exact_centroids":
                shares, counted = shares * of_centroids / counted, of_centroids
        else:
            shares = numpy.clip(ratio + 0.5 - distance, 0, 1) if correction == "linear" else 1.0
        return (shares * influence(name, counted)).sum() * self.spacing**self.dimension * self.cross_section

    def _energy_correction(self, pairs, direction, length, weight):
        i, j = pairs.T
        classical = self.youngs_modulus * confined_modulus_factor(self.dimension, self.case["material"]["plane"]) / 2
        inverse_square = 0.0
        for axis in range(self.dimension):
            energy = weight * self.constants[1] / 2 * length * direction[:, axis] ** 4
            density = (self._sum_over(i, energy / 2) + self._sum_over(j, energy / 2)) / self.volume
            with numpy.errstate(divide="ignore"):
                factor = classical / density
            inverse_square = inverse_square + (direction[:, axis] * 2 / (factor[i] + factor[j])) ** 2
        return 1 / numpy.sqrt(inverse_square)

    def _sum_over(self, index, value):
        """Sums at every point. Points beyond have the sum of their source, because only own points have all of their
        neighbours."""
        return numpy.bincount(index, value, minlength=len(self.volume))[self.source]

    # ---- continuum-kinematics-inspired ----------------------------------------------------------

    def _make_cpd(self):
        tables = self.materials.tables
        assert all("c1" in table for table in tables), "the reference does not calibrate"
        # If the first material has none, the weights are relative to 1.
        self.constants = {n: float(tables[0].get(f"c{n}", 0.0)) for n in (1, 2, 3)}
        for n in (2, 3):
            if any(table.get(f"c{n}", 0.0) for table in tables):
                self.constants[n] = self.constants[n] or 1.0
        bulk_weights = self.case["quadrature"]["weights"] == "bulk"
        ball = lattice_ball(self.dimension, self.horizon / self.spacing) * self.spacing
        volume = ball_volume(self.dimension, self.horizon, self.cross_section)
        pairs = pairs_within(self.reference, self.horizon)
        neighbours = self._sum_over(pairs.ravel(), numpy.ones(pairs.size))
        own_volume = volume * neighbours / len(ball)
        effective = numpy.full(len(self.volume), volume / len(ball))
        bonds = pairs[pairs[:, 0] < self.own]
        self.tuples[1] = bonds
        self.weight[1] = (self.volume * effective)[bonds].mean(axis=1)
        if not self.materials.are_one:
            own = self.materials.constants(bonds, "c1") * self.materials.factor("stiffness", bonds)
            self.weight[1] = self.weight[1] * own / self.constants[1]
        for order, constant in ((2, 2), (3, 6)):
            if order > self.dimension or self.constants[order] == 0:
                continue
            tuples = cliques(pairs, len(self.volume), order + 1, self.own)
            factor = self._flatness(tuples, self.reference, self.volume / self.cross_section)
            tuples, factor = tuples[factor > 0], factor[factor > 0]
            if bulk_weights:
                count = self._bulk_count(ball, order)
                effective = numpy.full(len(self.volume), volume**order / count if count else 0.0)
            else:
                number = sum(self._sum_over(tuples[:, k], factor) for k in range(order + 1))
                self.factor_sums[order] = number
                # The last interaction of a point must not keep its full weight by normalisation.
                number = numpy.where((number > 0) & (number < 1), (1 + number**2) / 2, number)
                ordered = math.factorial(order) * number
                effective = numpy.divide(own_volume**order, ordered, out=numpy.zeros(len(ordered)), where=ordered > 0)
            self.tuples[order], self.flatness[order] = tuples, factor
            share = self.volume * effective * self.materials.factors.get("stiffness", 1.0)
            self.weight[order] = constant * factor * share[tuples].mean(axis=1)
            if not self.materials.are_one:
                own = self.materials.constants(tuples, f"c{order}")
                self.weight[order] = self.weight[order] * own / self.constants[order]
        for order, tuples in self.tuples.items():
            factor = influence_of_sides(self.case["material"]["influence"], tuples, self.reference / self.horizon)
            self.tuples[order], self.weight[order] = tuples[factor > 0], (self.weight[order] * factor)[factor > 0]

    def _flatness(self, tuples, places, cells):
        """g(|M| / M0): 0 for flat interactions, 1 from three quarters of a cell on."""
        order = tuples.shape[1] - 1
        cell = (cells ** (order / self.dimension))[tuples].mean(axis=1)
        share = numpy.clip(2 * numpy.abs(measure(arms_of(tuples, places))) / cell - 0.5, 0, 1)
        return share**2 * (3 - 2 * share)

    def _bulk_count(self, ball, order):
        """Ordered pairs or triplets of a bulk point's neighbours."""
        places = numpy.concatenate([numpy.zeros((1, self.dimension)), ball])
        tuples = cliques(pairs_within(places, self.horizon), len(places), order + 1)
        tuples = tuples[tuples[:, 0] == 0]
        cells = numpy.full(len(places), self.spacing**self.dimension)
        return math.factorial(order) * self._flatness(tuples, places, cells).sum()

    # ---- cracks that are there from the start ---------------------------------------------------

    def _cut(self):
        self.cut_weight = numpy.zeros(len(self.volume))
        self.cut_bonds = 0
        if not self.case.get("crack"):
            return
        cut = self._meets_crack(self.bonds)
        for end in (0, 1):
            self.cut_weight += self._sum_over(self.bonds[cut, end], self.weight[1][cut])
        self.cut_bonds = int(cut.sum())
        for order, tuples in self.tuples.items():
            keep = numpy.ones(len(tuples), bool)
            for a, b in itertools.combinations(range(order + 1), 2):
                keep &= ~self._meets_crack(tuples[:, [a, b]])
            self.tuples[order], self.weight[order] = tuples[keep], self.weight[order][keep]

    def _meets_crack(self, pairs):
        meets = numpy.zeros(len(pairs), bool)
        for crack in self.beyond.cracks():
            meets |= bonds_that_meet(crack, *(self.reference[pairs[:, end]] for end in (0, 1)))
        return meets

    # ---- bonds by their points -------------------------------------------------------------------

    def _number_bonds(self):
        """Numbers of bonds by their points. Bonds between two points beyond, which are sides of triangles and
        tetrahedra, have the number of the bond between own points of which they are copies."""
        self.bond_number = {code: k for k, code in enumerate(self.codes(self.bonds).tolist())}
        for tuples in self.tuples.values():
            for a, b in itertools.combinations(range(tuples.shape[1]), 2):
                outside = tuples[tuples[:, a] >= self.own][:, [a, b]]
                for first, second in numpy.unique(outside, axis=0).tolist():
                    number = self.twin(first, second)
                    assert number is not None, "what lies beyond has no bonds of its own"
                    self.bond_number[first * len(self.volume) + second] = number

    def codes(self, pairs):
        return pairs[..., 0] * len(self.volume) + pairs[..., 1]

    def twin(self, first, second):
        """Number of the same bond as seen from the second point's source; None: no bond."""
        first, second = self.beyond.twin(first, second)
        return None if second is None else self.bond_number.get(min(first, second) * len(self.volume) + max(first, second))


def bonds_that_meet(crack, start, end):
    """Which bonds a segment or the sides of an outline (2D) or a plane polygon (3D) cut or touch."""
    if "outline" in crack:
        corners = numpy.array(crack["outline"], float)
        return numpy.any([segments_meet(p, q, start, end) for p, q in zip(corners, numpy.roll(corners, -1, axis=0))], axis=0)
    if "from" in crack:
        return segments_meet(numpy.array(crack["from"], float), numpy.array(crack["to"], float), start, end)
    return segments_meet_polygon(numpy.array(crack["vertices"], float), start, end)


def turn(a, b, c):
    return (b[..., 0] - a[..., 0]) * (c[..., 1] - a[..., 1]) - (b[..., 1] - a[..., 1]) * (c[..., 0] - a[..., 0])


def segments_meet(p, q, start, end):
    crossing = (turn(p, q, start) * turn(p, q, end) < 0) & (turn(start, end, p) * turn(start, end, q) < 0)
    length = numpy.sqrt(((end - start) ** 2).sum(axis=1))
    near = numpy.zeros(len(start), bool)
    for point, a, b in ((start, p, q), (end, p, q), (p, start, end), (q, start, end)):
        along = numpy.clip(((point - a) * (b - a)).sum(axis=-1) / ((b - a) ** 2).sum(axis=-1), 0, 1)
        gap = point - (a + along[..., None] * (b - a))
        near |= numpy.sqrt((gap**2).sum(axis=-1)) <= 1e-9 * length
    return crossing | near


def segments_meet_polygon(vertices, start, end):
    """Whether bonds cross the inside of the polygon; bonds that only touch it do not count."""
    normal = numpy.zeros(3)
    for a, b in zip(vertices, numpy.roll(vertices, -1, axis=0)):
        normal += numpy.cross(a - vertices[0], b - vertices[0])
    normal /= numpy.linalg.norm(normal)
    below, above = (start - vertices[0]) @ normal, (end - vertices[0]) @ normal
    crosses = below * above < 0
    share = numpy.divide(below, below - above, out=numpy.zeros(len(start)), where=crosses)
    at = start + share[:, None] * (end - start)
    keep = [axis for axis in range(3) if axis != numpy.abs(normal).argmax()]
    x, y = at[:, keep].T
    inside = numpy.zeros(len(start), bool)
    for a, b in zip(vertices[:, keep], numpy.roll(vertices[:, keep], -1, axis=0)):
        if a[1] != b[1]:
            inside ^= ((a[1] > y) != (b[1] > y)) & (x < a[0] + (y - a[1]) * (b[0] - a[0]) / (b[1] - a[1]))
    return crosses & inside
