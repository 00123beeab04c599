"""Checks the reference of the linear peridynamic solid (tests/reference/lps.py) against independent results: printed
weights, the printed scheme bond by bond, rigid motions, linear displacements, the derivative of its energy."""

import itertools
import math
import unittest

import numpy

from tests.reference import lps

# Printed for the uniform lattice: weight over h^2 by the position of the neighbour.
PRINTED = {
    3.0: {(1, 0): 1.9018542425, (1, 1): 1.4355103103, (2, 0): 0.9327693982, (2, 1): 0.9293206459,
          (2, 2): 0.8409601239, (3, 0): 0.6016710176},
    3.5: {(1, 0): 1.6631568915, (1, 1): 1.5074490738, (2, 0): 0.9196920912, (2, 1): 1.1422083780,
          (2, 2): 1.3131596297, (3, 0): 0.7110321114, (3, 1): 0.9264710961},
}  # fmt: skip
# Sums of some 40 terms, with weights whose moments err by 1e-14; solutions are worse by the condition, 1e3.
ROUND_OFF, OF_SOLUTIONS = 1e-13, 1e-12
GRADIENT = {
    2: numpy.array([[3.0, 2.0], [-1.0, 2.0]]),
    3: numpy.array([[3.0, 2.0, 0.5], [-1.0, 2.0, 1.5], [0.25, -2.0, 1.0]]),
}


def lattice_ball(dimension, ratio):
    places = numpy.array(list(itertools.product(range(-5, 6), repeat=dimension)), float)
    length = (places**2).sum(axis=1)
    return places[(length > 0) & (length <= ratio**2 * (1 + 1e-8))]


def block(dimension, count, ratio, free_sides=(), perturbation=0.0, **options):
    """A square or cube with `count` points per side about 0, spacing 1/count, collars except for tractions on the high
    sides of the free axes, which extend through the collars. Returns the solid and the fill values of its ghosts."""
    spacing, deep = 1 / count, 2 * math.ceil(ratio)
    line = (numpy.arange(-deep, count + deep) + 0.5) / count - 0.5
    places = numpy.stack(numpy.meshgrid(*[line] * dimension, indexing="ij"), -1).reshape(-1, dimension)
    body, carries = (abs(places) < 0.5).all(axis=1), (places[:, list(free_sides)] < 0.5).all(axis=1)
    places += numpy.random.default_rng(7).uniform(-perturbation, perturbation, places.shape) * spacing
    options = {"lame_lambda": 1.2, "mu": 0.8, "volume": spacing**dimension} | options
    return lps.Solid(places, ratio * spacing, body, collar=carries & ~body, **options)


def linear(solid, gradient=None):
    """Linear displacements, nan at ghosts; and the corresponding tractions."""
    gradient = GRADIENT[solid.dimension] if gradient is None else gradient
    displacement = solid.places @ gradient.T
    displacement[~solid.carries] = numpy.nan
    pressure = solid.lame_lambda[0] * numpy.trace(gradient)
    stress = pressure * numpy.eye(solid.dimension) + solid.mu[0] * (gradient + gradient.T)
    return displacement, solid.normals[solid.row[solid.points]] @ stress


def solve(solid, displacement, body_force=0.0, tractions=None):
    """Displacements of the body's points; those of the collar are given."""
    d, given = solid.dimension, numpy.where(solid.carries[:, None], displacement, 0)
    given[solid.points] = 0
    matrix, free = solid.matrix(), (d * solid.points[:, None] + numpy.arange(d)).ravel()
    forces = -solid.residual(given, body_force, tractions).ravel()
    return numpy.linalg.solve(matrix[:, free], forces).reshape(-1, d)


def random(solid, scale=1.0, seed=3):
    values = numpy.random.default_rng(seed).uniform(-scale, scale, solid.places.shape)
    values[~solid.carries] = numpy.nan
    return values


class Weights(unittest.TestCase):
    def test_moments_are_integrals(self):
        radius, weight = numpy.polynomial.legendre.leggauss(20)
        radius, weight = (radius + 1) / 2, weight / 2
        angle = numpy.arange(40) * 2 * math.pi / 40
        for power in lps.exponents(2, 5):  # the trapezoidal rule is exact for trigonometric polynomials
            around = (numpy.cos(angle) ** power[0] * numpy.sin(angle) ** power[1]).sum() * 2 * math.pi / 40
            expected = around * (weight * radius ** (power.sum() - 2)).sum()
            self.assertAlmostEqual(lps.moment(power), expected, delta=1e-14)
        for power in lps.exponents(3, 5):
            cosine, share = 2 * radius - 1, 2 * weight
            around = (numpy.cos(angle) ** power[0] * numpy.sin(angle) ** power[1]).sum() * 2 * math.pi / 40
            sphere = around * (share * (1 - cosine**2) ** ((power[0] + power[1]) / 2) * cosine ** power[2]).sum()
            expected = sphere * (weight * radius ** (power.sum() - 1)).sum()
            # Odd powers of the sine are no polynomials, but their integral over the circle is 0.
            self.assertAlmostEqual(lps.moment(power), expected, delta=1e-14)
        self.assertEqual((len(lps.exponents(2, 5)), len(lps.exponents(3, 5)), len(lps.exponents(2, 4))), (18, 55, 12))

    def test_printed_lattices(self):
        for ratio, expected in PRINTED.items():
            vectors = lattice_ball(2, ratio)
            weights, error = lps.quadrature_weights(vectors, ratio)
            self.assertLess(error, ROUND_OFF)
            for vector, weight in zip(vectors, weights):
                place = tuple(sorted(abs(vector).astype(int), reverse=True))
                self.assertAlmostEqual(weight, expected[place], delta=1e-10, msg=f"{ratio} {place}")
        self.assertAlmostEqual(weights.sum(), 41.007, delta=5e-4)

    def test_weights_are_exact_and_least(self):
        generator = numpy.random.default_rng(5)
        for dimension, ratio, count, rank in ((2, 2.5, 20, 18), (2, 3.5, 36, 18), (3, 3.0, 122, 55)):
            vectors = lattice_ball(dimension, ratio)
            self.assertEqual(len(vectors), count)
            for moved in (0, 0.2) if ratio >= 3 else (0,):
                places = vectors + generator.uniform(-moved, moved, vectors.shape)
                weights, error = lps.quadrature_weights(places, ratio + 0.4)
                self.assertLess(error, ROUND_OFF * 10)
                powers, scaled = lps.exponents(dimension, 5), places / (ratio + 0.4)
                matrix = numpy.prod(scaled[None] ** powers[:, None], -1) / numpy.linalg.norm(scaled, axis=1) ** 3
                self.assertEqual(numpy.linalg.matrix_rank(matrix), rank)
                # The least-norm solution is orthogonal to every change that keeps the moments.
                nothing = numpy.linalg.svd(matrix)[2][rank:]
                self.assertLess(abs(nothing @ weights).max(), ROUND_OFF * abs(weights).max())

    def test_small_space_lattice_is_solved_by_symmetry(self):
        weights, error = lps.quadrature_weights(lattice_ball(3, 2.5), 2.5)
        self.assertLess(error, ROUND_OFF)
        self.assertGreater(weights.min(), 0)

    def test_points_share_what_is_alike(self):
        vectors, generator = lattice_ball(2, 3.0), numpy.random.default_rng(2)
        moved = vectors + generator.uniform(-0.05, 0.05, vectors.shape)
        far = lattice_ball(2, 3.5) * 3 / 3.5
        every = [vectors[generator.permutation(len(vectors))], moved, vectors, far]
        starts = numpy.append(0, numpy.cumsum([len(v) for v in every])[:-1])
        weights, errors = lps.weights_of_points(numpy.concatenate(every), starts, 3.2)
        self.assertEqual(len(errors), 4)
        for own, found in zip(every, numpy.split(weights, starts[1:])):
            numpy.testing.assert_allclose(found, lps.quadrature_weights(own, 3.2)[0], rtol=1e-11)

    def test_too_few_neighbours_are_refused(self):
        places = numpy.array(list(itertools.product(range(3), repeat=2)), float)
        places[:, 0] += 0.1 * places[:, 1] ** 2
        with self.assertRaisesRegex(ValueError, "8 neighbours"):
            lps.Solid(places, 3.0, numpy.ones(9, bool), 1.0, 1.0)

    def test_neighbours_are_those_of_all_pairs(self):
        places = numpy.random.default_rng(1).uniform(0, 1, (700, 2))
        rows = numpy.arange(0, 700, 2)
        distance = numpy.linalg.norm(places[rows][:, None] - places[None], axis=-1)
        first, second = numpy.nonzero((distance <= 0.1) & (distance > 0))
        found = lps.neighbours(places, 0.1, rows)
        numpy.testing.assert_array_equal(found, numpy.stack([rows[first], second]))


class LinearDisplacements(unittest.TestCase):
    """Patches with collars, tractions on one side, and on two or three adjacent sides."""

    def compare(self, solid, gradient=None):
        gradient = GRADIENT[solid.dimension] if gradient is None else gradient
        displacement, tractions = linear(solid, gradient)
        scale = abs(solid.matrix()).max() * numpy.nanmax(abs(displacement))
        self.assertLess(abs(solid.residual(displacement, 0, tractions)).max(), ROUND_OFF * scale)
        self.assertLess(abs(solid.gradient(displacement) - gradient).max(), ROUND_OFF * 10)
        self.assertLess(abs(solid.dilatation(displacement) - numpy.trace(gradient)).max(), ROUND_OFF * 10)
        found = solve(solid, displacement, 0, tractions)
        self.assertLess(abs(found - displacement[solid.points]).max(), OF_SOLUTIONS)

    def test_full_form_is_exact(self):
        for sides, moved, ratio in itertools.product(((), (1,), (0, 1)), (0, 0.2), (3.5, 3.9)):
            with self.subTest(sides=sides, moved=moved, ratio=ratio):
                self.compare(block(2, 10, ratio, sides, moved))

    def test_space_is_exact_where_tangents_are_alike(self):
        """The ball is symmetric in both tangents (one face of a lattice), or the strain is (a swelling with rotation):
        the dilatation and the traction determine only the sum of the tangential strains."""
        self.compare(block(3, 3, 3.0))
        self.compare(block(3, 3, 3.2, perturbation=0.15))
        self.compare(block(3, 3, 3.0, (2,)))
        swelling = numpy.array([[1.5, 0.4, -0.2], [-0.4, 1.5, 0.7], [0.2, -0.7, 1.5]])
        for sides, moved in (((0, 1, 2), 0), ((0, 2), 0.15)):
            solid = block(3, 3, 3.2, sides, moved)
            self.compare(solid, swelling)
            displacement, tractions = linear(solid)
            error = abs(solve(solid, displacement, 0, tractions) - displacement[solid.points]).max()
            self.assertGreater(error, 1e-4)
            self.assertLess(error, 0.2)

    def test_printed_form_is_exact_on_symmetric_balls_alone(self):
        self.compare(block(2, 10, 3.5, (1,), form="paper"))
        self.compare(block(3, 3, 3.0, (1,), form="paper"))
        for sides, moved in (((1,), 0.2), ((0, 1), 0)):
            solid = block(2, 10, 3.5, sides, moved, form="paper")
            displacement, tractions = linear(solid)
            error = abs(solve(solid, displacement, 0, tractions) - displacement[solid.points]).max()
            self.assertGreater(error, 1e-3)
            self.assertLess(error, 0.5)

    def test_ghosts_matter_where_bonds_are_broken_alone(self):
        solid = block(2, 10, 3.5, (1,))
        near = solid.places[solid.points, 1] > 0.5 - 0.35
        numpy.testing.assert_array_equal(solid.has_surface, near)
        self.assertGreater(abs(solid.c_theta[near]).max(axis=1).min(), 0)
        self.assertEqual(abs(solid.c_theta[~near]).max(), 0)
        self.assertEqual(abs(solid.c_traction[~near]).max(), 0)
        normals = solid.normals[solid.row[solid.points]][near]
        self.assertLess(abs(normals - [0, 1]).max(), ROUND_OFF)

    def test_crack_is_a_surface(self):
        places = block(2, 12, 3.0).places
        bonds = lps.neighbours(places, 0.25, numpy.arange(len(places)))
        across = (places[bonds[0], 1] < 0) & (places[bonds[1], 1] > 0) & (abs(places[bonds[0], 0]) < 0.3)
        across &= abs(places[bonds[1], 0]) < 0.3
        solid = block(2, 12, 3.0, broken=numpy.stack(bonds, 1)[across])
        self.compare(solid)  # the tractions on the faces are those of the linear displacements
        self.assertGreater(solid.damage().max(), 0.2)
        numpy.testing.assert_array_equal(solid.has_surface, solid.damage() > 0)


class Printed(unittest.TestCase):
    """The printed scheme, bond by bond."""

    def scheme(self, solid, displacement, tractions):
        """(4.6) to (4.9) and (5.5), with lambda, mu of the point itself in the missing part of the ball."""
        weights = dict(zip(zip(solid.first, solid.second), zip(solid.weights, solid.intact)))
        kernel, theta, normal = 3 / (2 * math.pi * solid.horizon**3), {}, {}
        around = {i: [j for j in range(len(solid.places)) if (i, j) in weights] for i in solid.rows}
        x, u = solid.places, displacement
        for i in solid.rows:
            inverse, outward = numpy.zeros((2, 2)), numpy.zeros(2)
            for j in around[i]:
                weight, intact = weights[i, j]
                xi = x[j] - x[i]
                if intact:
                    inverse += 2 * kernel / math.hypot(*xi) * weight * numpy.outer(xi, xi)
                    outward -= weight * xi
            shape = numpy.linalg.inv(inverse)
            theta[i] = 0.0
            for j in around[i]:
                weight, intact = weights[i, j]
                if intact:
                    xi = x[j] - x[i]
                    theta[i] += 2 * kernel / math.hypot(*xi) * weight * xi @ shape @ (u[j] - u[i])
            normal[i] = outward / math.hypot(*outward) if math.hypot(*outward) > 1e-9 else numpy.zeros(2)
        residual = []
        for i, traction in zip(solid.points, tractions):
            n = normal[i]
            p, total, a, b = numpy.array([n[1], -n[0]]), numpy.zeros(2), solid.lame_lambda[i], solid.mu[i]
            for j in around[i]:
                weight, intact = weights[i, j]
                xi = x[j] - x[i]
                k, squared, of_n, of_p = kernel / math.hypot(*xi) * weight, xi @ xi, xi @ n, xi @ p
                if intact:
                    mean_a = 2 / (1 / a + 1 / solid.lame_lambda[j])
                    mean_b = 2 / (1 / b + 1 / solid.mu[j])
                    total -= k * 2 * (mean_a - mean_b) * xi * (theta[i] + theta[j])
                    total -= k * 16 * mean_b * xi * (xi @ (u[j] - u[i])) / squared
                else:
                    total += k * theta[i] * (-4 * (a - b) * xi - 8 * (a + 2 * b) * n * of_n * of_p**2 / squared
                                             + 8 * a * n * of_n**3 / squared)  # fmt: skip
                    total -= k * 16 * (traction @ p) * p * of_n / squared * of_p**2
                    total -= k * 8 * (traction @ n) * n * of_n / squared * (of_n**2 - of_p**2)
            residual.append(total)
        return numpy.array(residual)

    def test_forces_are_the_printed_ones(self):
        generator = numpy.random.default_rng(11)
        for moved in (0, 0.2):
            places = len(block(2, 5, 3.2).places)
            moduli = {"lame_lambda": generator.uniform(0.5, 2, places), "mu": generator.uniform(0.5, 2, places)}
            solid = block(2, 5, 3.2, (0, 1), moved, form="paper", **moduli)
            displacement, tractions = random(solid), generator.uniform(-1, 1, (len(solid.points), 2))
            expected = self.scheme(solid, displacement, tractions)
            found = solid.residual(displacement, 0, tractions)
            self.assertGreater(abs(solid.traction_terms(tractions)).max(), 1e-2)
            numpy.testing.assert_allclose(found, expected, rtol=0, atol=ROUND_OFF * abs(expected).max())

    def test_traction_terms_by_normal_and_tangent(self):
        solid = block(2, 5, 3.2, (0, 1), 0.2)
        tractions = random(solid)[solid.points]
        normal = solid.normals[solid.row[solid.points]]
        tangent = numpy.stack([-normal[:, 1], normal[:, 0]], 1)
        split = (tractions * normal).sum(1)[:, None] * solid.c_normal
        split += (tractions * tangent).sum(1)[:, None] * solid.c_tangent
        on = solid.has_surface
        scale = abs(split).max()
        numpy.testing.assert_allclose(solid.traction_terms(tractions)[on], split[on], rtol=0, atol=ROUND_OFF * scale)

    def test_forms_coincide_on_symmetric_balls(self):
        for dimension, count in ((2, 8), (3, 3)):
            full, paper = (block(dimension, count, 3.0, (1,), form=form) for form in ("full", "paper"))
            for a, b in ((full.c_theta, paper.c_theta), (full.c_traction, paper.c_traction)):
                self.assertGreater(abs(a).max(), 0)
                self.assertLess(abs(a - b).max(), ROUND_OFF * abs(a).max())
        with self.assertRaisesRegex(ValueError, "form is full or paper"):
            block(2, 4, 3.0, (1,), form="half")

    def test_form_in_space_is_that_of_a_plane_where_it_does_not_turn(self):
        """Bonds in a plane through the normal: with zero strain across it, both differ only by the shared strain."""
        vectors, normal = numpy.array([[0.3, 1.0], [-0.7, 0.5], [0.2, 0.4]]), numpy.array([0.6, 0.8])
        shares = numpy.array([0.2, -0.1, 0.4])
        raised = numpy.append(vectors, numpy.zeros((3, 1)), axis=1)
        for form in ("full", "paper"):
            flat = lps.missing_ball(vectors, shares, normal, 1.3, 0.7, form)[1]
            solid = lps.missing_ball(raised, shares, numpy.append(normal, 0), 1.3, 0.7, form)[1]
            tangent = numpy.array([-0.8, 0.6])  # shear has no such share; 16 and 30 are 2 d (d + 2)
            numpy.testing.assert_allclose(solid[:2, :2] @ tangent / 30, flat @ tangent / 16, rtol=1e-13)


class Invariance(unittest.TestCase):
    def test_rigid_motions_need_no_forces(self):
        generator = numpy.random.default_rng(4)
        for dimension, count, ratio in ((2, 8, 3.5), (3, 3, 3.2)):
            turn = generator.uniform(-1, 1, (dimension, dimension))
            for form in ("full", "paper"):
                places = (count + 4 * math.ceil(ratio)) ** dimension
                moduli = {"lame_lambda": generator.uniform(0.5, 2, places), "mu": generator.uniform(0.5, 2, places)}
                solid = block(dimension, count, ratio, (0, 1), 0.15, form=form, **moduli)
                motion = 3.0 + solid.places @ (turn - turn.T)
                motion[~solid.carries] = numpy.nan
                scale = abs(solid.matrix()).max() * numpy.nanmax(abs(motion))
                self.assertLess(abs(solid.forces(motion)).max(), 3e-15 * scale)
                self.assertLess(abs(solid.strain(motion)).max(), ROUND_OFF)
                self.assertLess(abs(solid.dilatation(motion)).max(), ROUND_OFF)
                self.assertLess(solid.energy(motion), ROUND_OFF**2)

    def test_points_with_few_bonds_see_what_these_span(self):
        solid = block(2, 7, 3.5)
        middle, h = solid.points[24], 1 / 7
        places = numpy.round((solid.places - solid.places[middle]) / h).astype(int)
        expected = GRADIENT[2]
        for kept, seen in (([(1, 0), (-2, 0)], expected @ numpy.diag([1, 0])), ([(2, 0), (3, 1)], expected)):
            away = [j for j in range(len(places)) if tuple(places[j]) not in kept and j != middle]
            few = block(2, 7, 3.5, broken=[(j, middle) for j in away])
            gradient = few.gradient(linear(few)[0])[few.row[middle]]
            self.assertLess(abs(gradient - seen).max(), OF_SOLUTIONS)

    def test_points_without_bonds_or_normals_are_at_rest(self):
        solid = block(2, 7, 3.0)
        middle = solid.points[24]
        every = numpy.arange(len(solid.places))
        alone = block(2, 7, 3.0, broken=[(middle, j) for j in every if j != middle])
        forces = alone.forces(random(alone))
        self.assertEqual(abs(forces[24]).max(), 0)
        self.assertGreater(abs(forces[23]).max(), 0)
        self.assertEqual(alone.damage()[24], 1)
        self.assertEqual(abs(alone.normals[alone.row[middle]]).max(), 0)
        h = 1 / 7
        beside = [j for j in every if abs(alone.places[j] - alone.places[middle]).sum() < 1.5 * h and j != middle]
        self.assertEqual(len(beside), 4)
        symmetric = block(2, 7, 3.0, broken=[(middle, j) for j in beside])
        self.assertEqual(abs(symmetric.normals[symmetric.row[middle]]).max(), 0)
        self.assertEqual(abs(symmetric.c_traction[24]).max(), 0)
        self.assertAlmostEqual(symmetric.damage()[24], 4 / 28)


class Energy(unittest.TestCase):
    def test_lattice_of_one_material_is_the_derivative_of_its_energy(self):
        for dimension, count, ratio in ((2, 8, 3.5), (3, 3, 3.0)):
            solid = block(dimension, count, ratio)
            d, free = dimension, (dimension * solid.points[:, None] + numpy.arange(dimension)).ravel()
            stiffness = solid.matrix()[:, free] / count**dimension
            self.assertLess(abs(stiffness - stiffness.T).max(), 1e-14 * abs(stiffness).max())
            self.assertGreater(numpy.linalg.eigvalsh(stiffness).min(), 0)
            # The energy is quadratic: differences are exact up to round-off.
            displacement, change = random(solid), random(solid, seed=9)
            change[numpy.setdiff1d(numpy.arange(len(change)), solid.points)] = 0
            difference = (solid.energy(displacement + change) - solid.energy(displacement - change)) / 2
            work = (solid.forces(displacement) * change[solid.points]).sum() / count**dimension
            self.assertAlmostEqual(difference / work, 1, delta=1e-12)
            self.assertEqual(solid.c_theta.shape, (len(solid.points), d))

    def test_without_that_it_is_not_symmetric(self):
        for options in ({"perturbation": 0.2}, {"free_sides": (1,)}):
            solid = block(2, 8, 3.5, **options)
            stiffness = solid.matrix()[:, (2 * solid.points[:, None] + numpy.arange(2)).ravel()]
            self.assertGreater(abs(stiffness - stiffness.T).max(), 1e-3 * abs(stiffness).max())

    def test_density_of_linear_displacements_is_that_of_the_continuum(self):
        for dimension, count in ((2, 6), (3, 3)):
            solid = block(dimension, count, 3.2, perturbation=0.1)
            gradient = GRADIENT[dimension]
            strain = (gradient + gradient.T) / 2
            expected = 1.2 / 2 * numpy.trace(strain) ** 2 + 0.8 * (strain**2).sum()
            found = solid.energy_density(linear(solid)[0])
            numpy.testing.assert_allclose(found, expected, rtol=1e-12)
            stress = 1.2 * numpy.trace(strain) * numpy.eye(dimension) + 1.6 * strain
            self.assertLess(abs(solid.stress(linear(solid)[0]) - stress).max(), 1e-11)


class Matrix(unittest.TestCase):
    def test_matrix_is_that_of_the_forces(self):
        for dimension, count, sides in ((2, 7, (0, 1)), (3, 3, (1,))):
            places = (count + 4 * 4) ** dimension
            moduli = numpy.random.default_rng(8).uniform(0.5, 2, (2, places))
            solid = block(dimension, count, 3.2, sides, 0.15, lame_lambda=moduli[0], mu=moduli[1])
            displacement = random(solid)
            found = solid.matrix() @ numpy.where(solid.carries[:, None], displacement, 1e6).ravel()
            expected = solid.forces(displacement).ravel()
            self.assertLess(abs(found - expected).max(), ROUND_OFF * abs(expected).max())


class Composites(unittest.TestCase):
    def test_means(self):
        self.assertEqual(lps.harmonic_mean(0.0, 0.0), 0)
        self.assertEqual(lps.harmonic_mean(0.0, 2.0), 0)
        self.assertAlmostEqual(lps.harmonic_mean(3.0, 6.0), 4, delta=1e-15)

    def test_layers_bear_the_series_modulus(self):
        """A step of lambda + 2 mu across layers: u is continuous and piecewise linear, up to O(h)."""
        errors = []
        for count in (8, 16):
            solid = block(2, count, 3.0)
            stiff = numpy.where(solid.places[:, 0] < 0, 4.0, 1.0)
            layered = block(2, count, 3.0, lame_lambda=1.2 * stiff, mu=0.8 * stiff)
            exact = numpy.zeros_like(layered.places)
            exact[:, 0] = layered.places[:, 0] / stiff
            errors.append(abs(solve(layered, exact) - exact[layered.points]).max())
        self.assertLess(errors[0], 0.05)
        self.assertLess(errors[1], 0.65 * errors[0])


class Constants(unittest.TestCase):
    def test_moduli(self):
        a, b = lps.lame(72.0, 0.23)
        self.assertAlmostEqual(b * (3 * a + 2 * b) / (a + b), 72, delta=1e-12)
        self.assertAlmostEqual(a / (2 * (a + b)), 0.23, delta=1e-15)
        # In plane stress, sigma_zz = 0 of the solid gives this lambda.
        self.assertAlmostEqual(lps.lame(72.0, 0.23, "stress")[0], 2 * a * b / (a + 2 * b), delta=1e-12)

    def test_critical_stretch(self):
        beta, a, b = 3 * 0.002 / (4 * math.pi), 30e9, 20e9
        printed = math.sqrt(3.8 / (4 * (a - b) * beta + 8 * b * beta))
        self.assertAlmostEqual(lps.critical_stretch(3.8, a, b, 0.002) / printed, 1, delta=1e-14)

    def test_stretches(self):
        solid = block(2, 6, 3.0, (1,))
        displacement = linear(solid, numpy.array([[0.01, 0.0], [0.0, 0.01]]))[0]
        stretches = solid.stretches(displacement)
        numpy.testing.assert_allclose(stretches[solid.intact], 0.01, rtol=1e-12)
        self.assertEqual(abs(stretches[~solid.intact]).max(), 0)
        self.assertGreater((~solid.intact).sum(), 0)
        self.assertEqual(solid.damage().max(), 0)


if __name__ == "__main__":
    unittest.main()
