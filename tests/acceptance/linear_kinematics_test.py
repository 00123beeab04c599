"""Linear kinematics, by bonds and by convolutions, and points that fail by their energy density."""

import math
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference.program import ROOT
from tests.reference.results import Results, table

CASES = ROOT / "cases"
STRIP = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 2e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.02, 0.012] },
         { subtract = "disk", centre = [0.01, 0.0], radius = 2.7e-3 }]
[[lattice.layer]]
name = "left"
side = "x-"
thickness = 3
[[lattice.layer]]
name = "right"
side = "x+"
thickness = 3
[quadrature]
surface_correction = "none"
[material]
kinematics = "linear"
youngs_modulus = 70e9
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["2e-6*load", 0]
[solver]
relative_tolerance = 1e-12
linear_tolerance = 1e-6
"""
WAVES = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 2e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.08, 0.06] }]
[material]
kinematics = "linear"
youngs_modulus = 72e9
density = 2440
[[initial]]
velocity = ["0.01*sin(300*x)", "0"]
[solver]
mode = "dynamics"
operator = "fft"
[dynamics]
end_time = 2e-4
step_share = 0.99
history_every = 100
[output]
every = 10000
"""
CRACKS = "crack=[{from=[0.0062, 0.008], to=[0.0062, 0.02]}, {from=[0.0149, 0.001], to=[0.0173, 0.0052]}]"
FAILING = 'material.damage={law="energy_density", fracture_energy=2.0, no_fail=["left", "right"]}'
GLASS = ["lattice.spacing=4e-4", "lattice.horizon_ratio=3.1"]  # for branching_2d


class Run(Results):
    """With the last step's fields as attributes."""

    def __init__(self, folder):
        super().__init__(folder)
        names = ("displacement", "damage", "force", "energy_density")
        self.fields = {name: self.steps[-1].fields[name] for name in names}
        self.loads = [row["load_factor"] for row in self.table("history")]

    def __getattr__(self, name):
        return self.fields[name]


class CommandLine(Folder):
    def results(self, *arguments, **options):
        return Run(self.run_case(*arguments, **options))

    def same(self, one, other, share=1e-11):
        # A severed part keeps the round-off of its previous forces.
        work = one.summary["energy"]["external_work"]
        least = {"force": work / abs(one.displacement).max(), "energy_density": work / one.volume.sum()}
        for name, field in one.fields.items():
            scale = max(abs(field).max(), least.get(name, 0.0))
            self.assertLess(abs(field - other.fields[name]).max(), share * scale if name != "damage" else 1e-11, name)
        for key in ("dissipated", "stored", "external_work"):
            largest = max(abs(one.summary["energy"][key]), one.summary["energy"]["external_work"])
            self.assertAlmostEqual(one.summary["energy"][key] / largest, other.summary["energy"][key] / largest, delta=1e-10)

    def both(self, case, *settings, share=1e-11):
        bonds = self.results(case, 'solver.operator="bonds"', *settings)
        fft = self.results(case, 'solver.operator="fft"', *settings)
        self.same(bonds, fft, share)
        self.assertEqual(bonds.summary["broken_bonds"], fft.summary["broken_bonds"])
        return fft


class Solved:
    """Bonds and stiffness, recomputed densely."""

    def __init__(self, run, ratio=3.015, spacing=1e-3, thickness=2e-3, modulus=70e9):
        places = run.reference[:, :2]
        self.horizon = ratio * spacing
        i, j = numpy.triu_indices(len(places), 1)
        arm = places[j] - places[i]
        length = numpy.hypot(*arm.T)
        near = length <= self.horizon * (1 + 1e-8)
        self.i, self.j, length = i[near], j[near], length[near]
        self.length = length
        self.n = arm[near] / length[:, None]
        c = 9 * modulus / (math.pi * thickness * self.horizon**3)
        self.k = c * run.volume[self.i] * run.volume[self.j] / length
        self.volume = run.volume

    def along(self, u):
        return ((u[self.j] - u[self.i]) * self.n).sum(1)

    def energy_density(self, u, q):
        w = 0.25 * q[self.i] * q[self.j] * self.k * self.along(u) ** 2
        return (numpy.bincount(self.i, w, len(q)) + numpy.bincount(self.j, w, len(q))) / self.volume

    def forces(self, u, q):
        pull = (q[self.i] * q[self.j] * self.k * self.along(u))[:, None] * self.n
        return numpy.stack([numpy.bincount(self.i, pull[:, c], len(q)) - numpy.bincount(self.j, pull[:, c], len(q)) for c in (0, 1)], 1)

    def solve(self, u, q, held):
        stiffness = numpy.zeros((2 * len(q), 2 * len(q)))
        blocks = (q[self.i] * q[self.j] * self.k)[:, None, None] * self.n[:, :, None] * self.n[:, None, :]
        for a in (0, 1):
            for b in (0, 1):
                for row, column, sign in ((self.i, self.i, 1), (self.j, self.j, 1), (self.i, self.j, -1), (self.j, self.i, -1)):
                    numpy.add.at(stiffness, (2 * row + a, 2 * column + b), sign * blocks[:, a, b])
        held = numpy.repeat(held, 2) | (numpy.abs(stiffness).sum(1) == 0.0)
        u = u.copy().ravel()
        u[~held] = numpy.linalg.solve(stiffness[numpy.ix_(~held, ~held)], -stiffness[numpy.ix_(~held, held)] @ u[held])
        return u.reshape(-1, 2)


class Statics(CommandLine):
    def test_both_operators_solve_the_same(self):
        for settings in ([], [CRACKS], ['lattice.spacing=[1e-3, 0.8e-3]'], ["lattice.angle=30", "quadrature.volume_correction=linear"],
                         ["lattice.horizon_ratio=2.015", "solver.preconditioner=block_jacobi"],
                         [CRACKS, "lattice.horizon_ratio=5.1", "solver.mode=relaxation"]):  # fmt: skip
            with self.subTest(settings=settings):
                # Relaxation ends at its own tolerance, along paths that differ by round-off.
                self.both(STRIP, *settings, share=1e-7 if "solver.mode=relaxation" in settings else 1e-9)

    def test_cracks_beyond_the_ball_of_a_turned_box(self):
        # The corner of a box, along x here, is farther away than the horizon.
        crack = "crack=[{from=[0.0102, 0.0051], to=[0.0102, 0.02]}]"
        self.both(STRIP, crack, "lattice.angle=45", 'quadrature.horizon_shape="box"', share=1e-9)

    def test_what_rollers_and_rigid_sets_carry_is_no_points(self):
        # Displacements of 1e-9 spacings: the additional terms of finite kinematics are of that relative size.
        on_left = STRIP[: STRIP.index('[[support]]\nset = "right"')] + STRIP[STRIP.index("[solver]") :]
        for held in ('[[roller]]\nset = "right"\nnormal = [1, 0.3]\ndisplacement = "1e-12*load"\n',
                     '[[rigid]]\nset = "right"\ndisplacement = ["1e-12*load", "free"]\n'):  # fmt: skip
            with self.subTest(held):
                linear = self.results(on_left + "[loading]\nsteps = 3\n" + held)
                finite = self.results(on_left + "[loading]\nsteps = 3\n" + held, "material.kinematics=finite")
                self.same(linear, finite, share=1e-6)
                energy = linear.summary["energy"]
                self.assertAlmostEqual(energy["stored"], energy["external_work"], delta=1e-9 * energy["stored"])

    def test_it_is_the_direct_solution(self):
        run = self.results(STRIP, "solver.operator=fft")
        solved = Solved(run)
        x = run.reference[:, 0]
        held = (x < 0) | (x > 0.02)
        u = numpy.where((x > 0.02)[:, None], [2e-6, 0.0], [0.0, 0.0])
        one = numpy.ones(len(x))
        expected = solved.solve(u, one, held)
        numpy.testing.assert_allclose(run.displacement[:, :2], expected, atol=1e-10 * 2e-6)
        numpy.testing.assert_allclose(run.energy_density, solved.energy_density(expected, one), rtol=1e-8, atol=1e-3)

    def test_solids_as_an_energy_are_the_same_without_damage(self):
        lps = ["material.model=lps", "material.poisson_ratio=0.2", "quadrature.form=energy"]
        for settings in ([], [CRACKS]):
            bonds, fft = (self.results(STRIP, *lps, *settings, f"solver.operator={name}") for name in ("bonds", "fft"))
            self.same(bonds, fft, 1e-9)

    def test_solids_with_lame_constants_alike_are_bonds(self):
        # No dilatation remains: bonds have the weights 1/M + 1/M' ([FCBM] 5.6), M of the existing neighbours.
        run = self.results(STRIP, "material.model=lps", "material.poisson_ratio=0.33333333333333333", "quadrature.form=energy", "solver.operator=fft")
        solved = Solved(run)
        length = solved.length
        moment = numpy.bincount(numpy.r_[solved.i, solved.j], numpy.r_[length, length])
        shear = 70e9 / 2 / (1 + 1 / 3)
        solved.k = 8 * shear * run.volume[0] / length * (1 / moment[solved.i] + 1 / moment[solved.j])
        x = run.reference[:, 0]
        held = (x < 0) | (x > 0.02)
        one = numpy.ones(len(x))
        expected = solved.solve(numpy.where((x > 0.02)[:, None], [2e-6, 0.0], [0.0, 0.0]), one, held)
        numpy.testing.assert_allclose(run.displacement[:, :2], expected, atol=1e-10 * 2e-6)
        work = (solved.k * solved.along(expected) ** 2).sum() / 2
        self.assertAlmostEqual(run.summary["energy"]["stored"] / work, 1.0, delta=1e-10)

    def test_cubes(self):
        cube = """\
dimension = 3
lattice = {spacing = 0.1, shape = [{add = "box", min = [0, 0, 0], max = [0.6, 0.5, 0.7]}]}
material = {youngs_modulus = 1e9, kinematics = "linear"}
set = [{name = "low", where = "z < 0.1"}, {name = "high", where = "z > 0.6"}]
support = [{set = "low", displacement = [0, 0, 0]}, {set = "high", displacement = [0, "1e-3*load", "2e-3*load"]}]
solver = {relative_tolerance = 1e-12, linear_tolerance = 1e-6}
"""
        for ratio in (2.015, 3.015, 9.0):  # the last one includes the whole body
            self.both(cube, f"lattice.horizon_ratio={ratio}", share=1e-9)

    def test_strains_of_solids(self):
        lps = ["material.model=lps", "material.poisson_ratio=0.2", "quadrature.form=energy", "output.stress=true"]
        for name in ("bonds", "fft"):
            self.results(STRIP, *lps, f"solver.operator={name}")
            (self.folder / "out").rename(self.folder / name)
        with h5py.File(self.folder / "bonds/results.h5") as bonds, h5py.File(self.folder / "fft/results.h5") as fft:
            last = sorted(bonds["steps"])[-1]
            for field in ("strain", "stress"):
                one, other = (file["steps"][last][field][:] for file in (bonds, fft))
                numpy.testing.assert_allclose(one, other, atol=1e-9 * abs(one).max())

    def test_check_judges_no_quadrature_of_short_bonds(self):
        for operator, count in (("bonds", 1), ("fft", 0)):
            said = self.assert_completed(self.command("check", STRIP, f"solver.operator={operator}")).said
            self.assertEqual(said.count("energy of a confined strain"), count)

    def test_check_estimates_the_memory(self):
        cube = """\
dimension = 3
lattice = {spacing = 0.0125, horizon_ratio = 3.015, shape = [{add = "box", min = [0, 0, 0], max = [0.6, 0.5, 0.7]}]}
material = {youngs_modulus = 1e9, density = 1e3, kinematics = "linear"}
set = [{name = "low", where = "z < 0.1"}, {name = "high", where = "z > 0.6"}]
support = [{set = "low", displacement = [0, 0, 0]}, {set = "high", displacement = [0, "1e-3*load", "2e-3*load"]}]
solver = {operator = "fft"}
"""
        solid = cube.replace('kinematics = "linear"', 'model = "lps", poisson_ratio = 0.3') + 'quadrature = {form = "energy"}\n'
        moving = cube.replace("*load", "*t*1e3").replace('operator', 'mode = "dynamics", operator')
        moving += 'dynamics = {end_time = 1e-4}\n'
        failing = 'material.damage={law="energy_density", fracture_energy=2e3}'
        for case, settings in ((cube, []), (solid, []), (moving, []), (moving, [failing])):
            with self.subTest(case=case, settings=settings):
                ended = self.assert_completed(self.command("check", case, *settings))
                number, unit = ended.said.split("memory      about ")[1].split()[:2]
                peak = self.results(case, *settings).summary["peak_memory_bytes"]
                self.assertGreater(float(number) * {"MB": 1e6, "GB": 1e9}[unit], peak)
                self.assertLess(float(number) * {"MB": 1e6, "GB": 1e9}[unit], 1.3 * peak)

    def test_stress_and_neighbourhoods_are_those_of_all_bonds(self):
        fields = {}
        for name in ("bonds", "fft"):
            self.results(STRIP, f"solver.operator={name}", "output.stress=true")
            with h5py.File(self.folder / "out/results.h5") as file:
                step = file["steps"][sorted(file["steps"])[-1]]
                fields[name] = {key: step[key][:] for key in ("strain", "first_piola_stress", "missing_neighbourhood")}
        for key, field in fields["bonds"].items():
            numpy.testing.assert_allclose(fields["fft"][key], field, atol=1e-7 * abs(field).max())


class FailingPoints(CommandLine):
    def test_they_are_those_of_the_direct_sums(self):
        """Solves, fails all points beyond the threshold, and repeats until nothing more fails."""
        for steps in (1, 4):
            run = self.both(STRIP, FAILING, f"loading.steps={steps}", share=1e-8)
            solved = Solved(run)
            x = run.reference[:, 0]
            held, q, spared = (x < 0) | (x > 0.02), numpy.ones(len(x)), (x < 0) | (x > 0.02)
            for load in run.loads:
                u = run.displacement[:, :2] * 0.0
                u[x > 0.02, 0] = 2e-6 * load
                while True:
                    u = solved.solve(u, q, held)
                    fails = (solved.energy_density(u, q) > 2.0 / (2 * solved.horizon)) & ~spared & (q > 0)
                    if not fails.any():
                        break
                    q[fails] = 0.0
            self.assertGreater((q == 0).sum(), 3)
            numpy.testing.assert_array_equal(run.damage == 1.0, q == 0.0)

    def test_work_is_stored_dissipated_or_drained(self):
        energy = self.results(STRIP, FAILING, "solver.operator=fft", "loading.steps=4").summary["energy"]
        self.assertGreater(energy["dissipated"], 0.0)
        self.assertAlmostEqual((energy["stored"] + energy["dissipated"] + energy["drained"]) / energy["external_work"], 1, delta=1e-8)


class Motions(CommandLine):
    CASE = CASES / "fcbm/branching_2d.toml"

    def test_both_operators_break_the_same(self):
        loads = ["load[0].traction=[0, 4e6]", "load[1].traction=[0, -4e6]", "dynamics.end_time=2e-5"]
        run = self.both(self.CASE, *GLASS, *loads, share=1e-10)
        self.assertGreater((run.damage == 1.0).sum(), 100)
        again = self.results(self.CASE, *GLASS, *loads, threads=2)
        numpy.testing.assert_allclose(again.damage, run.damage, atol=1e-12)

    def test_a_straight_crack_takes_the_fracture_energy(self):
        run = self.results(self.CASE, "dynamics.end_time=3.1e-5", threads=2)
        x, y = (run.reference[:, :2] / 2e-4).round().astype(int).T
        at = dict(zip(zip(x, y), run.damage))
        for (x, y), damage in at.items():
            self.assertAlmostEqual(at[x, -y], damage, delta=1e-12)
        tips = [row for row in table(self.folder / "out/history.csv") if row["tip"] > 0.056]
        grown = tips[-1]["tip"] - tips[0]["tip"]
        self.assertGreater(grown, 0.01)
        self.assertAlmostEqual((tips[-1]["dissipated_energy"] - tips[0]["dissipated_energy"]) / grown / 3.8, 1, delta=0.05)

    def test_steps_are_stable_up_to_the_stable_one(self):
        # 2 / omega_max of plane waves in the bulk, from the lattice's sums: no mask has a shorter step.
        bulk = 1e-3 * math.sqrt(2440 / 72e9) * self.bulk_step()
        ended = self.assert_completed(self.command("check", WAVES))
        stable = float(ended.said.split("stable time step ")[1].split()[0])
        self.assertLess(stable, bulk * (1 + 1e-5))
        self.assertGreater(stable, 0.98 * bulk)
        modified = [row["modified_energy"] for row in self.results(WAVES).table("history")]
        self.assertGreater(len(modified), 5)
        self.assertLess(max(modified) / min(modified) - 1, 1e-12)
        longer = WAVES.replace("step_share = 0.99", f"time_step = {1.02 * bulk}")
        self.assert_refused(self.command("check", longer), "longer than the stable step")

    @staticmethod
    def bulk_step(ratio=3.015):
        """For E = 1, rho = 1, spacing = 1, in plane stress."""
        steps = numpy.array([(x, y) for x in range(-3, 4) for y in range(-3, 4) if 0 < math.hypot(x, y) <= ratio])
        c = 9 / (math.pi * ratio**3) / numpy.hypot(*steps.T)
        n = steps / numpy.hypot(*steps.T)[:, None]
        waves = numpy.stack(numpy.meshgrid(*[numpy.linspace(0, math.pi, 101)] * 2), -1).reshape(-1, 2)
        blocks = numpy.einsum("ks,si,sj->kij", c * (1 - numpy.cos(waves @ steps.T)), n, n)
        return 2 / math.sqrt(numpy.linalg.eigvalsh(blocks).max())

    def test_implicit_steps(self):
        newmark = ["dynamics.scheme=newmark", "dynamics.end_time=2e-6", "dynamics.time_step=1e-7"]
        self.both(self.CASE, *GLASS, *newmark, share=1e-6)


    def test_coarse_steps_end_as_fine_ones(self):
        """All overloaded points fail together, so steps must end where the first points are overloaded."""
        fine = self.results(STRIP, FAILING, "loading.steps=64")
        for steps in (1, 3):
            coarse = self.results(STRIP, FAILING, f"loading.steps={steps}")
            numpy.testing.assert_array_equal(coarse.damage == 1.0, fine.damage == 1.0)
            self.assertAlmostEqual(coarse.summary["energy"]["dissipated"] / fine.summary["energy"]["dissipated"], 1.0, delta=0.02)


class Torn(CommandLine):
    def test_a_ground_that_pulls_has_worked_before_points_fail(self):
        pulled = STRIP[: STRIP.index('[[support]]\nset = "right"')] + STRIP[STRIP.index("[solver]") :]
        pulled += '[loading]\nsteps = 3\n[[foundation]]\nname = "machine"\nset = "right"\nstiffness = [1e9, 1e9]\n'
        energy = self.results(pulled + 'displacement = ["2e-6*load", 0]\n', FAILING).summary["energy"]
        self.assertGreater(energy["drained"], 0.0)
        self.assertLess(abs(energy["balance_error"]), 1e-12 * energy["external_work"])
        self.assertIn("hold fragments", [row["action"] for row in table(self.folder / "out/decisions.csv")])

    def test_a_dead_load_that_nobody_bears(self):
        loaded = STRIP[: STRIP.index('[[support]]\nset = "right"')] + STRIP[STRIP.index("[solver]") :]
        loaded += '[loading]\nsteps = 30\n[[load]]\nside = "x+"\ntraction = ["4e7*load", 0]\n'
        self.run_case(loaded, FAILING, threads=2, code=3)
        self.assertIn("the body does not carry them", (self.folder / "out/decisions.csv").read_text())

    def test_what_is_torn_through_is_left_with_round_off(self):
        run = self.results(STRIP, FAILING, "solver.operator=fft", "loading={steps=10, adaptive=false}",
                           "solver.relative_tolerance=1e-10",
                           'support=[{set="left", displacement=[0, 0]}, {set="right", displacement=["5e-5*load", 0]}]')  # fmt: skip
        self.assertGreater(run.summary["energy"]["dissipated"], 1e-4)

    def test_torn_motions(self):
        moving = STRIP.replace("*load", "*t/1e-6") + "[dynamics]\nend_time = 2e-5\ntime_step = 2e-7\n"
        self.results(moving, FAILING, "solver.operator=fft", "solver.mode=dynamics", "dynamics.scheme=newmark", "material.density=2440.0")


class CutsAhead(CommandLine):
    def test_of_bodies_whose_points_may_fail(self):
        plate = STRIP.replace("[0.02, 0.012]", "[0.04, 0.03]").replace("[0.01, 0.0], radius = 2.7e-3", "[0.035, 0.0], radius = 1.6e-3")
        crack = "crack=[{from=[0.0202, 0.0152], to=[0.0202, 0.05]}]"
        tip = 'crack_tip=[{name="tip", at=[0.0202, 0.0152], direction=[0, -1], cut=3.1e-3}]'
        law = 'material.damage={law="energy_density", fracture_energy=1e6}'
        last = []
        for laws in ([], [law]):
            self.results(plate, crack, tip, *laws)
            last.append((self.folder / "out/history.csv").read_text().splitlines()[-1])
        self.assertEqual(*last)


class Refusals(CommandLine):
    def test_bodies_held_across_a_gap(self):
        """Bonds to next neighbours do not reach across a missing row; longer bonds do."""
        halves = '[{ add = "box", min = [0.0, 0.0], max = [0.009, 0.012] }, { add = "box", min = [0.010, 0.0], max = [0.02, 0.012] }]'
        self.both(STRIP, f"lattice.shape={halves}")
        loaded = STRIP[: STRIP.index('[[support]]\nset = "right"')] + STRIP[STRIP.index("[solver]") :]
        self.both(loaded + '[[load]]\nside = "x+"\ntraction = ["1e6*load", 0]\n', f"lattice.shape={halves}")

    def test_what_is_no_convolution(self):
        fft = "solver.operator=fft"
        for settings, words in (
            ([fft, "material.kinematics=finite"], ("solver.operator", "linear")),
            ([fft, "lattice.perturbation=0.1"], ("solver.operator", "sites of the lattice")),
            ([fft, "quadrature.surface_correction=volume"], ("solver.operator", "surface_correction")),
            ([fft, "lattice.volumes=fractional"], ("solver.operator", "equal volume")),
            ([fft, "solver.linear=cholesky"], ("solver.linear", "pcg")),
            ([fft, "solver.preconditioner=rigid_pieces"], ("solver.preconditioner", "sines")),
            ([fft, "solver.tangent=stored"], ("solver.tangent", "products")),
            ([fft, "solver.mode=arc_length"], ("solver.operator", "bonds")),
            ([fft, 'load=[{side="y+", pressure=1e6}]'], ("load[0].pressure", "traction")),
            ([FAILING, "loading.max_broken_bonds=10"], ("max_broken_bonds", "a point that fails")),
            (['material.damage={law="critical_stretch", critical=0.01}'], ("material.damage.law", "energy_density")),
            (['material.damage={law="energy_density"}'], ("fracture_energy", "missing")),
            (["material.kinematics=finite", 'material.damage={law="energy_density", fracture_energy=1.0}'], ("damage.law", "linear")),
            ([FAILING, 'material.scatter=[{of="strength", weibull_modulus=8}]'], ("material.scatter[0].of", "stretches")),
            ([FAILING, "solver.mode=adaptive"], ("solver.mode", "dynamics")),
            ([FAILING, "solver.mode=relaxation", "relaxation.method=flow"], ("relaxation.method", "dynamic")),
            (["material.model=lps", "material.poisson_ratio=0.3", "material.kinematics=finite"], ("material.kinematics", "linear")),
            ([FAILING, 'set=[{name="all", where="x > 0"}]', 'probe=[{name="area", field="crack_area", set="all"}]'], ("probe[0].field", "band")),
        ):  # fmt: skip
            with self.subTest(settings=settings):
                self.assert_refused(self.command("check", STRIP, *settings), *words)


class SoonerOperator(CommandLine):
    def test_auto_takes_convolutions_where_they_are_sooner(self):
        finer = ["lattice.spacing=1e-3", "lattice.horizon_ratio=5.1"]
        for case, settings, convolved in (
            (WAVES, [], True),
            (WAVES, ["lattice.horizon_ratio=2.1"], False),
            (WAVES, ["lattice.perturbation=0.1"], False),
            (WAVES, ["quadrature.surface_correction=volume"], False),
            (STRIP, finer, False),
            (STRIP, ["material.model=green_bond", "material.kinematics=finite"], True),
        ):
            with self.subTest(settings=settings):
                ended = self.assert_completed(self.command("check", case, "solver.operator=auto", *settings))
                self.assertEqual("summed by convolutions" in ended.said, convolved)

    def test_both_move_alike(self):
        steps = "dynamics={end_time=2e-5, time_step=1e-7}"  # the stable step is known to few digits only
        auto = self.results(WAVES, steps, "solver.operator=auto")
        self.same(self.results(WAVES, steps, "solver.operator=bonds"), auto, share=1e-9)


class Calibration(CommandLine):
    def test_of_points_that_fail(self):
        told = self.assert_completed(self.command("calibrate", STRIP, FAILING)).json()["damage"]
        self.assertEqual(told["fracture_energy"], 2.0)
        self.assertAlmostEqual(told["energy_density"], 2.0 / (2 * 3.015e-3), delta=1e-9)


if __name__ == "__main__":
    unittest.main()
