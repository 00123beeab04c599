"""Materials for convolutions only: Green bonds, correspondence, and the linear solid as printed."""

import math
import unittest

import h5py
import numpy

from tests.acceptance.linear_kinematics_test import STRIP, CommandLine, Run
from tests.reference.results import table

GREEN = ['material={model="green_bond", youngs_modulus=70e9}', "solver.operator=fft"]
CORRESPONDENCE = ['material={model="correspondence", youngs_modulus=70e9, poisson_ratio=0.2}', "solver.operator=fft"]
MODELS = {"green_bond": GREEN, "correspondence": CORRESPONDENCE}
STRETCHED = ['support[1].displacement=["1e-3*load", "2e-4*load"]', "loading.steps=2"]  # by 5 %
FAILING = 'material.damage={law="energy_density", fracture_energy=8e4, no_fail=["left", "right"]}'
CUBE = """\
dimension = 3
lattice = {spacing = 0.1, shape = [{add = "box", min = [0, 0, 0], max = [0.9, 0.4, 0.5]}]}
material = {model = "correspondence", youngs_modulus = 1e9, poisson_ratio = 0.3}
set = [{name = "low", where = "x < 0.2"}, {name = "high", where = "x > 0.7"}]
support = [{set = "low", displacement = [0, 0, 0]}, {set = "high", displacement = ["0.04*load", "0.02*load", 0]}]
solver = {relative_tolerance = 1e-11, linear_tolerance = 1e-6, operator = "fft"}
"""
TURNED = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 2e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.02, 0.012] },
         { subtract = "disk", centre = [0.01, 0.0], radius = 2.7e-3 }]
[[set]]
name = "held"
where = "abs(x - 0.01) > 7e-3"
[[support]]
set = "held"
displacement = ["x*(cos(load*pi/6)-1) - y*sin(load*pi/6)", "x*sin(load*pi/6) + y*(cos(load*pi/6)-1)"]
[loading]
steps = 6
[solver]
operator = "fft"
relative_tolerance = 1e-10
[material]
"""
MOVING = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 2e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.014, 0.010] }]
[[set]]
name = "pulled"
where = "x > 12e-3"
[[load]]
set = "pulled"
body_force = [3e10, 1e10]
[solver]
mode = "dynamics"
operator = "fft"
[dynamics]
end_time = 2e-6
time_step = 1e-7
history_every = 1
[output]
every = 1
[quadrature]
form = "printed"
[material]
model = "lps"
youngs_modulus = 72e9
poisson_ratio = 0.22
density = 2440
"""


class Pairs:
    """Both directions of each pair of neighbours, dense; unit integrity by default."""

    def __init__(self, run, horizon, dimension):
        self.d, self.x, self.V, self.horizon = dimension, run.reference[:, :dimension], run.volume[0], horizon
        arm = self.x[None] - self.x[:, None]
        length = numpy.linalg.norm(arm, axis=2)
        self.i, self.j = numpy.nonzero((length <= horizon * (1 + 1e-8)) & (length > 0))
        self.xi, self.r = arm[self.i, self.j], length[self.i, self.j]
        self.q = numpy.ones(len(self.x))

    def weight(self):
        return self.q[self.i] * self.q[self.j]

    def sums(self, of_pairs):
        result = numpy.zeros((len(self.x), *of_pairs.shape[1:]))
        numpy.add.at(result, self.i, of_pairs)
        return result

    def eta(self, u):
        return u[self.j] - u[self.i]

    def solve(self, u, held, tolerance=1e-12):
        """Newton's method, with central differences of forces that are at most cubic; few steps."""
        free = numpy.flatnonzero(~numpy.repeat(held, self.d))
        scale = abs(self.forces(u)).max()
        step = 1e-6 * self.horizon
        for _ in range(12):
            residual = self.forces(u).ravel()[free]
            if abs(residual).max() < tolerance * scale:
                return u
            jacobian = numpy.empty((len(free), len(free)))
            for column, dof in enumerate(free):
                there, back = u.copy().ravel(), u.copy().ravel()
                there[dof] += step
                back[dof] -= step
                jacobian[:, column] = (self.forces(there.reshape(u.shape)) - self.forces(back.reshape(u.shape))).ravel()[free] / (2 * step)
            move = numpy.zeros(u.size)
            move[free] = -numpy.linalg.solve(jacobian, residual)
            u = u + move.reshape(u.shape)
        raise AssertionError("the reference did not converge")


class GreenPairs(Pairs):
    def __init__(self, run, ratio=3.015, spacing=1e-3, thickness=2e-3, modulus=70e9):
        super().__init__(run, ratio * spacing, 2)
        self.c = 9 * modulus / (math.pi * thickness * self.horizon**3)

    def forces(self, u):
        y = self.xi + self.eta(u)
        green = ((y**2).sum(1) - self.r**2) / 2
        return self.sums((self.weight() * self.c * self.V**2 / self.r**3 * green)[:, None] * y)

    def energy(self, u):
        y = self.xi + self.eta(u)
        strain = ((y**2).sum(1) / self.r**2 - 1) / 2
        return (self.weight() * self.c * self.V**2 * self.r * strain**2).sum() / 4


class CorrespondencePairs(Pairs):
    def __init__(self, run, horizon, dimension, modulus, ratio, thickness=1.0, stabilisation=0.5):
        super().__init__(run, horizon, dimension)
        self.mu = modulus / 2 / (1 + ratio)
        self.Lambda = modulus * ratio / (1 - ratio**2) if dimension == 2 else modulus * ratio / (1 + ratio) / (1 - 2 * ratio)
        if dimension == 2:
            C = 12 * (self.Lambda + self.mu) / (math.pi * thickness * horizon**4)
        else:
            C = 18 * (self.Lambda + 2 * self.mu / 3) / (math.pi * horizon**5)
        self.beta = stabilisation * C
        self.shape = numpy.linalg.inv(self.sums(self.xi[:, :, None] * self.xi[:, None, :]))

    def states(self, u):
        y = self.xi + self.eta(u)
        F = self.sums(y[:, :, None] * self.xi[:, None, :]) @ self.shape
        strain = (F.transpose(0, 2, 1) @ F - numpy.eye(self.d)) / 2
        S = self.Lambda * numpy.trace(strain, axis1=1, axis2=2)[:, None, None] * numpy.eye(self.d) + 2 * self.mu * strain
        z = y - numpy.einsum("pij,pj->pi", F[self.i], self.xi)
        return F, strain, S, y, z

    def forces(self, u):
        F, _, S, y, z = self.states(u)
        R = F @ S @ self.shape * self.V**-1  # shape does not include V
        here = numpy.einsum("pij,pj->pi", R[self.i] + R[self.j], self.xi) * self.V
        there = y - numpy.einsum("pij,pj->pi", F[self.j], self.xi)  # minus z of the other
        return self.sums(here * self.V + self.V**2 * self.beta * (z + there)) * 1.0

    def energy(self, u):
        _, strain, S, _, z = self.states(u)
        return (self.V * (S * strain).sum((1, 2)) / 2).sum() + self.V**2 * self.beta / 2 * (z**2).sum()


class PrintedPairs(Pairs):
    """[FCBM] (A-8), with the kernel 1/r and the point's own 1/m at both ends."""

    def __init__(self, run, ratio, spacing, modulus, poisson):
        super().__init__(run, ratio * spacing, 2)
        self.mu = modulus / 2 / (1 + poisson)
        self.Lambda = modulus * poisson / (1 - poisson**2)

    def states(self, u):
        weight = self.q[self.j] / self.r * self.V
        m = self.sums(weight * self.r**2)
        m[(m == 0) | (self.q == 0)] = numpy.inf
        along = (self.xi * self.eta(u)).sum(1)
        return weight, m, along, 2 / m * self.sums(weight * along)

    def forces(self, u):
        d = 2
        weight, m, along, theta = self.states(u)
        pull = d * (self.Lambda - self.mu) * (theta[self.i] + theta[self.j]) / m[self.i]
        pull = pull + 2 * d * (d + 2) * self.mu / m[self.i] * along / self.r**2
        return (self.V * self.q)[:, None] * self.sums((weight * pull)[:, None] * self.xi) * 1.0

    def energy_density(self, u):
        weight, m, along, theta = self.states(u)
        return self.q * ((self.Lambda - self.mu) * theta**2 / 2 + 4 * self.mu / m * self.sums(weight * (along / self.r) ** 2))


def held_of(run):
    x = run.reference[:, 0]
    return (x < 0) | (x > 0.02)


def pulled(run, u):
    return numpy.where((run.reference[:, 0] > 0.02)[:, None], u, [0.0] * len(u))


class Statics(CommandLine):
    def check(self, run, pairs, u, held):
        found = run.displacement[:, : pairs.d]
        start = found * (1 + 1e-3 * numpy.sin(numpy.arange(found.size)).reshape(found.shape) * ~held[:, None])
        expected = pairs.solve(start, held)
        numpy.testing.assert_allclose(found[held], u[held], atol=1e-14 * abs(u).max())
        numpy.testing.assert_allclose(found, expected, atol=1e-8 * abs(u).max())
        self.assertAlmostEqual(run.summary["energy"]["stored"] / pairs.energy(expected), 1.0, delta=1e-8)

    def test_green_bonds_are_the_direct_solution(self):
        run = self.results(STRIP, *GREEN, *STRETCHED)
        self.check(run, GreenPairs(run), pulled(run, [1e-3, 2e-4]), held_of(run))

    def test_a_correspondence_material_is_the_direct_solution(self):
        run = self.results(STRIP, *CORRESPONDENCE, *STRETCHED)
        pairs = CorrespondencePairs(run, 3.015e-3, 2, 70e9, 0.2, 2e-3)
        self.check(run, pairs, pulled(run, [1e-3, 2e-4]), held_of(run))

    def test_a_bar_in_3d(self):
        run = self.results(CUBE, "lattice.horizon_ratio=2.015")
        pairs = CorrespondencePairs(run, 0.2015, 3, 1e9, 0.3)
        x = run.reference[:, 0]
        self.check(run, pairs, numpy.where((x > 0.7)[:, None], [0.04, 0.02, 0.0], 0.0), (x < 0.2) | (x > 0.7))

    def test_small_strains_are_linear_kinematics(self):
        linear = self.results(STRIP, "solver.operator=fft")
        green = self.results(STRIP, *GREEN)
        # Relative to 1e-4 of strain.
        numpy.testing.assert_allclose(green.displacement, linear.displacement, atol=2e-4 * 2e-6)
        self.assertGreater(abs(green.displacement - linear.displacement).max(), 1e-7 * 2e-6)
        self.assertAlmostEqual(green.summary["energy"]["stored"] / linear.summary["energy"]["stored"], 1.0, delta=1e-3)

    def test_turns_take_no_energy(self):
        for name, model in (("green_bond", GREEN), ("correspondence", CORRESPONDENCE)):
            run = self.results(TURNED, *model)
            x = run.reference[:, :2]
            c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
            expected = x @ numpy.array([[c, s], [-s, c]]) - x
            numpy.testing.assert_allclose(run.displacement[:, :2], expected, atol=1e-9 * abs(expected).max(), err_msg=name)
            # Round-off of energies proportional to squared displacements, which are some horizons here; 0.1 without the
            # rotation.
            self.assertLess(abs(run.summary["energy"]["stored"]), 1e-14 * 70e9 * run.volume.sum())

    def test_the_modulus_of_a_correspondence_material(self):
        # A plate with displacements on all of its boundary from St. Venant-Kirchhoff elasticity.
        long, nu, E = 1.02, 0.2, 70e9
        green = (long**2 - 1) / 2
        across = math.sqrt(1 - 2 * nu * green)
        # Forces reach two horizons: the held rim is so wide that no free point sees the surface.
        case = TURNED[: TURNED.index("shape")] + 'shape = [{ add = "box", min = [0, 0], max = [0.02, 0.02] }]\n' + TURNED[TURNED.index("[[set]]") :]
        run = self.results(case, *CORRESPONDENCE, 'set=[{name="held", where="max(abs(x-0.01), abs(y-0.01)) > 3.7e-3"}]',
                           f'support=[{{set="held", displacement=["{long - 1}*x*load", "{across - 1}*y*load"]}}]')  # fmt: skip
        expected = run.reference[:, :2] * [long - 1, across - 1]
        numpy.testing.assert_allclose(run.displacement[:, :2], expected, atol=1e-9 * abs(expected).max())
        self.assertAlmostEqual(run.summary["energy"]["stored"] / (E * green**2 / 2 * run.volume.sum()), 1.0, delta=1e-9)

    def test_relaxation_ends_where_newton_does(self):
        for name, model in MODELS.items():
            newton = self.results(STRIP, *model, *STRETCHED)
            relaxed = self.results(STRIP, *model, *STRETCHED, "solver.mode=relaxation", "solver.relative_tolerance=1e-9")
            numpy.testing.assert_allclose(relaxed.displacement, newton.displacement, atol=1e-7 * 1e-3, err_msg=name)

    def test_the_tangent_is_the_derivative(self):
        for name, model in MODELS.items():
            self.assert_completed(self.command("check-tangent", STRIP, *model))

    def test_struts_buckle(self):
        """Beyond the limit the tangent is indefinite, and the straight strut is no minimum."""
        case = TURNED[: TURNED.index("[[support]]")].replace("max = [0.02, 0.012] },", "max = [0.06, 0.004] }]").replace(
            '         { subtract = "disk", centre = [0.01, 0.0], radius = 2.7e-3 }]\n', "").replace(
            "abs(x - 0.01) > 7e-3", "abs(x - 0.03) > 0.027")  # fmt: skip
        for name, model in MODELS.items():
            run = self.results(case + '''
[[set]]
name = "middle"
where = "abs(x - 0.03) < 2e-3"
[[support]]
set = "held"
displacement = ["-0.1*x*load", 0]
[[load]]
set = "middle"
body_force = [0, 1e7]
[loading]
steps = 10
''', *model)  # fmt: skip
            self.assertGreater(run.displacement[:, 1].max(), 5e-3, name)
            self.assertTrue(any(row["projection"] > 0 for row in table(self.folder / "out/iterations.csv")), name)

    def test_threads_change_no_bit(self):
        for name, model in MODELS.items():
            one, two = (self.results(STRIP, *model, FAILING, *STRETCHED, "loading.steps=4", threads=threads) for threads in (1, 2))
            self.assertGreater((one.damage == 1.0).sum(), 0, name)
            for field, values in one.fields.items():
                numpy.testing.assert_array_equal(values, two.fields[field], f"{name} {field}")

    def test_stress_is_that_of_a_homogeneous_strain(self):
        for name, model in MODELS.items():
            case = TURNED.replace(TURNED[TURNED.index(",\n") : TURNED.index("]\n[[set]]")], "")
            run = self.results(case, *model, "output.stress=true", 'set=[{name="held", where="x > -1"}]',
                               'support=[{set="held", displacement=["0.02*x*load", "0"]}]')  # fmt: skip
            with h5py.File(self.folder / "out/results.h5") as file:
                step = file["steps"][sorted(file["steps"])[-1]]
                stress = step["first_piola_stress"][:].reshape(len(run.volume), -1)
            green = (1.02**2 - 1) / 2
            middle = numpy.linalg.norm(run.reference[:, :2] - [0.01, 0.006], axis=1).argmin()
            if name == "correspondence":
                plane = 70e9 / (1 - 0.2**2)
                self.assertAlmostEqual(stress[middle, 0] / (1.02 * plane * green), 1.0, delta=1e-9)
            else:  # bonds: 1.02 sum s (xi_x^2)^2 green, the lattice's own modulus
                pairs = GreenPairs(run)
                own = pairs.i == middle
                virial = (pairs.c * pairs.V / pairs.r**3 * pairs.xi[:, 0] ** 4)[own].sum() * green * 1.02 / 2
                self.assertAlmostEqual(stress[middle, 0] / virial, 1.0, delta=1e-9)


class Motions(CommandLine):
    def fields(self, name):
        with h5py.File(self.folder / "out/results.h5") as file:
            return [file["steps"][step][name][:] for step in sorted(file["steps"])]

    def printed(self, *given):
        run = self.results(MOVING, *given)
        pairs = PrintedPairs(run, 3.015, 1e-3, 72e9, 0.22)
        x = run.reference[:, :2]
        load = numpy.where((x[:, 0] > 12e-3)[:, None], [3e10, 1e10], 0.0) * pairs.V
        return run, pairs, load, 2440 * pairs.V

    def test_the_printed_solid_is_the_direct_sums(self):
        """20 Verlet steps; the notch makes neighbourhoods that differ."""
        notch = 'lattice.shape=[{add="box", min=[0, 0], max=[0.014, 0.010]}, {subtract="box", min=[0.006, 0.004], max=[0.007, 0.011]}]'
        failing = 'material.damage={law="energy_density", fracture_energy=60}'
        run, pairs, load, mass = self.printed(notch, failing)
        energy = run.summary["energy"]  # the imbalance of work and energy is reported
        self.assertGreater(abs(energy["balance_error"]), 1e-3 * energy["external_work"])
        u = v = numpy.zeros_like(load)
        force = pairs.forces(u) + load
        for _ in range(20):
            v = v + 0.5e-7 * force / mass
            u = u + 1e-7 * v
            while (fails := pairs.energy_density(u) > 60 / 2 / pairs.horizon).any():
                pairs.q[fails] = 0.0
            force = pairs.forces(u) + load
            v = v + 0.5e-7 * force / mass
        self.assertGreater((pairs.q == 0).sum(), 3)
        numpy.testing.assert_array_equal(run.damage == 1.0, pairs.q == 0.0)
        found = self.fields("displacement")[-1][:, :2]
        numpy.testing.assert_allclose(found, u, atol=1e-11 * abs(u).max())
        # They differ from those of the energy by more than round-off.
        self.results(MOVING, notch, failing, "quadrature.form=energy")
        self.assertGreater(abs(self.fields("displacement")[-1][:, :2] - u).max(), 1e-6 * abs(u).max())

    def test_explicit_and_implicit_steps(self):
        for name, model in MODELS.items():
            dense = model[0].replace("}", ", density=2440}")
            moving = MOVING[: MOVING.index("[quadrature]")] + "[material]\n"
            given = [dense, "load[0].body_force=[3e11, 1e11]", "dynamics.end_time=4e-6", "dynamics.time_step=2e-8"]
            explicit = self.results(moving, *given)
            self.assertGreater(abs(explicit.displacement).max(), 1e-5, name)  # 1 % of strain
            energy = explicit.summary["energy"]
            self.assertLess(abs(energy["balance_error"]), 1e-3 * energy["external_work"], name)
            implicit = self.results(moving, *given, "dynamics.scheme=newmark")
            numpy.testing.assert_allclose(implicit.displacement, explicit.displacement, atol=2e-2 * abs(explicit.displacement).max())

    def test_the_stable_step_is_that_of_linear_bonds_at_rest(self):
        said = {}
        for name, material in (("bond", 'material={kinematics="linear", youngs_modulus=70e9, density=2440}'),
                               ("green_bond", GREEN[0].replace("}", ", density=2440}"))):  # fmt: skip
            moving = MOVING[: MOVING.index("[quadrature]")] + "[material]\n"
            ended = self.assert_completed(self.command("check", moving, material, "dynamics.time_step=1e-9"))
            said[name] = float(ended.said.split("stable time step ")[1].split()[0])
        self.assertAlmostEqual(said["green_bond"] / said["bond"], 1.0, delta=0.02)

    def test_a_run_that_goes_on_is_the_whole_one(self):
        for name, model in MODELS.items():
            given = [*model, FAILING, *STRETCHED, "loading.steps=4"]
            whole = self.results(STRIP, *given)
            (self.folder / "out").rename(self.folder / name)
            self.run_case(STRIP, *given, words=("--stop-after", 2), code=130)
            self.resume("out")
            again = Run(self.folder / "out")
            for field, values in whole.fields.items():
                numpy.testing.assert_array_equal(values, again.fields[field], f"{name} {field}")
            (self.folder / "out").rename(self.folder / f"again_{name}")


class Refusals(CommandLine):
    def test_nothing_to_calibrate(self):
        self.assert_refused(self.command("calibrate", STRIP, *CORRESPONDENCE), "as they are given")

    def test_what_nothing_sums(self):
        green, correspondence = GREEN, CORRESPONDENCE
        printed = ["material.model=lps", "material.poisson_ratio=0.2", "quadrature.form=printed"]
        for given, words in (
            (green[:1], ("solver.operator", "needs convolutions", "fft")),
            (correspondence[:1], ("solver.operator", "needs convolutions", "fft")),
            ([*green, "lattice.perturbation=0.1"], ("solver.operator", "sites of the lattice", "no other operator")),
            ([*green, "solver.linear=cholesky"], ("solver.linear", "pcg")),
            ([*green, "solver.mode=arc_length"], ("pivots",)),
            ([*green, "quadrature.surface_correction=volume"], ("surface_correction", "bond")),
            ([*green, "material.kinematics=linear"], ("material.kinematics", "bond")),
            ([*green, "material.poisson_ratio=0.2"], ("poisson_ratio", "cpd")),
            ([*green, "material.stabilisation=0.4"], ("stabilisation", "correspondence")),
            ([*green, 'material.damage={law="critical_stretch", critical=0.01}'], ("damage.law", "energy_density")),
            ([*correspondence, "material.stabilisation=0"], ("stabilisation", "positive")),
            ([*correspondence, "material.poisson_ratio=0.5"], ("poisson_ratio", "below 0.5")),
            ([*correspondence, "lattice.shape=[{add=\"box\", min=[0, 0], max=[0.02, 0.001]}]"], ("line", "another model")),
            (printed, ("solver.operator", "fft")),
            ([*printed, "solver.operator=fft"], ("solver.mode", "verlet", "energy")),
        ):  # fmt: skip
            with self.subTest(given=given):
                self.assert_refused(self.command("check", STRIP, *given), *words)

    def test_printed_forces_in_implicit_steps(self):
        ended = self.command("check", MOVING, "dynamics.scheme=newmark")
        self.assert_refused(ended, "dynamics.scheme", "verlet", "energy")


if __name__ == "__main__":
    unittest.main()
