"""Gravity, tractions, eigenstrains and pressures, compared with sums, closed forms and tests/reference."""

import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference import ring
from tests.reference.body import constant_factor, lattice_ball
from tests.reference.case import Case
from tests.reference.verify import Verification

PLATE = """
dimension = 2
[lattice]
spacing = 1e-3
thickness = 2e-3
shape = [{ add = "box", min = [0, 0], max = [0.02, 0.01] }]
layer = [{ name = "left", side = "x-" }]
[[set]]
name = "corner"
where = "x > 0 && x < 1e-3 && y < 1e-3"
[[set]]
name = "foot"
where = "x > 0.019 && y < 1e-3"
[[set]]
name = "right"
where = "x > 0.019"
[material]
youngs_modulus = 1e9
density = 2000.0
thermal_expansion = 1e-3
[[support]]
set = "left"
displacement = [0, 0]
"""
# Two corner points hold a plate without layers, so that it can expand.
FREE = (
    PLATE.replace('layer = [{ name = "left", side = "x-" }]\n', "")
    .replace('set = "left"\ndisplacement = [0, 0]', 'set = "corner"\ndisplacement = [0, 0]')
    + '[[support]]\nset = "foot"\ndisplacement = ["free", 0]\n'
)
HEATED = FREE + '[temperature]\nchange = "200*load"\n'


class Loads(Folder):
    threads = 2

    def judged(self, text, *changes):
        """Results of a run, checked by tests/reference."""
        output = self.run_case(text, *changes)
        verification = Verification(output, Case(self.resolved(output), self.folder))
        self.assertEqual(verification.run(), [])
        return verification.results

    @staticmethod
    def resolved(output):
        with h5py.File(output / "results.h5") as file:
            text = file["case/as_resolved"][()]
        return text.decode() if isinstance(text, bytes) else str(text)


class DeadLoads(Loads):
    def test_the_reactions_bear_the_weight(self):
        results = self.judged(PLATE + '[[load]]\ngravity = ["3*load", "-9.81*load"]\n')
        weight = 2000 * 0.02 * 0.01 * 2e-3
        reaction = results.summary["reactions"]["left"]
        # Newton's last step converges quadratically, so only the round-off of sums over 3000 bonds remains.
        self.assertAlmostEqual(reaction[0] / (-3 * weight), 1, delta=1e-10)
        self.assertAlmostEqual(reaction[1] / (9.81 * weight), 1, delta=1e-10)
        self.refusal(PLATE + "[[load]]\ngravity = [0, 1]\n", "material={youngs_modulus=1e9}")

    def test_a_traction_adds_up_to_stress_times_area(self):
        for place in ('side = "x+"', 'set = "right"'):
            for depth in ("row", "horizon"):
                with self.subTest(place=place, depth=depth):
                    load = f'[[load]]\n{place}\ndepth = "{depth}"\ntraction = ["1e6*load", "2e5*load"]\n'
                    reaction = self.judged(PLATE + load).summary["reactions"]["left"]
                    self.assertAlmostEqual(reaction[0] / (-1e6 * 0.01 * 2e-3), 1, delta=1e-9)
                    self.assertAlmostEqual(reaction[1] / (-2e5 * 0.01 * 2e-3), 1, delta=1e-9)

    def test_places_that_bear_no_traction_are_refused(self):
        for load, told in (
            ('traction = [0, 1]', "needs a side or a set"),
            ('set = "left"\ntraction = [0, 1]', "the outermost one on"),
            ('set = "foot"\ntraction = [0, 1]', "more than one side"),
            ('side = "z+"\ntraction = [0, 1]', "allowed: x-, x+, y-, y+"),
            ('side = "x+"\nbody_force = [0, 1]\nset = "foot"', "is for a traction"),
            ('side = "x+"\npressure = 1\ndepth = "row"', "is for a traction"),
            ("body_force = [0, 1]", "missing"),
        ):
            with self.subTest(load=load):
                self.assert_refused(self.command("check", PLATE + "[[load]]\n" + load + "\n"), told)


class Heated(Loads):
    def assert_grown(self, results, by):
        """No stress and a uniform growth of all lengths, to the digits of displacements."""
        step = results.steps[-1]
        start = results.reference[results.sets["corner"]][0]
        growth = by * (results.reference - start)
        self.assertLess(numpy.abs(step.displacement - growth).max(), 1e-9 * numpy.abs(growth).max())
        held = step.stretch.max()
        self.assertLess(abs(held), 1e-8 * by)

    def test_a_free_plate_grows_without_stress_however_it_is_solved(self):
        one = 'loading.steps=1'
        for settings in ((one,), ('loading.steps=7',), (one, 'solver.linear=pcg', 'solver.tangent=matrix_free'),
                         ('solver.mode=arc_length', 'loading.steps=3'),
                         ('loading.table=[0, 1, 1]', 'loading.steps=2'),
                         ('control=[{set="right", weights=[1, 0]}]', 'loading.table=[0, 3.7e-3]'),
                         (one, 'eigenstrain=[{strain="0.2*load"}]', 'temperature.change=0'),
                         ('loading.table=[0, 0, 1]', 'loading.table2=[0, 1, 1]',
                          'temperature.change="100*load+100*load2"')):  # fmt: skip
            with self.subTest(settings=settings):
                # A stress-free state has no forces that could scale the last digits of stretches and work.
                results = self.results(HEATED, *settings)
                x = results.reference[:, 0]
                by = 3.7e-3 / (x.max() - x.min()) if "control" in settings[0] else 0.2
                self.assert_grown(results, by)

    def test_relaxation_finds_it_too_and_its_energies_add_up(self):
        results = self.results(HEATED, "solver.mode=relaxation", "loading.steps=2")
        step, row = results.steps[-1], results.table("history")[-1]
        growth = 0.2 * (results.reference - results.reference[results.sets["corner"]][0])
        self.assertLess(numpy.abs(step.displacement - growth).max(), 1e-5 * numpy.abs(growth).max())
        self.assertLess(abs(row["balance_error"]), 1e-6 * row["drained_energy"])

    def test_a_plate_that_is_held_all_round_bears_what_it_cannot_grow(self):
        """s = -alpha dT in every bond: energy and mean stress of the strain -alpha dT, and no displacement."""
        held = HEATED.replace('set = "corner"', 'set = "all"').replace(
            "[material]", '[[set]]\nname = "all"\nwhere = "x < 1e-3 || x > 0.019 || y < 1e-3 || y > 0.009"\n[material]'
        ).replace('[[support]]\nset = "foot"\ndisplacement = ["free", 0]\n', "")  # fmt: skip
        held += '[quadrature]\nsurface_correction = "energy"\n'
        results = self.judged(held, "temperature.change=\"2*load\"", "loading.steps=2")
        inside = numpy.abs(results.reference - [0.01, 0.005]).max(axis=1) < 1e-3
        # 2 * 1/2 E e2 / (1 - nu) = 3/2 E e2. The energy correction calibrates W for one strain at a time, which leaves
        # an error of 2 % for two strains at once in the bulk of this lattice.
        density = results.steps[-1].energy_density[inside].mean()
        self.assertAlmostEqual(density / (1.5 * 1e9 * 2e-3**2), 1, delta=0.03)
        row = results.table("history")[-1]
        # Points near the edges move; the trapezoidal rule errs by a small part of the strain.
        self.assertAlmostEqual(row["external_work"], row["stored_energy"], delta=2e-5 * row["stored_energy"])

    def test_a_clamped_bar_bears_the_bonds_across_a_section(self):
        """Every point of a bar between two layers has the same number of neighbours on both sides, so none moves, and
        every bond has the stretch -alpha dT: k bonds of the reach k cross a section. With half of the outermost
        neighbours' volume that sum is E alpha dT, without a volume correction (m + 1)/m of it."""
        bar = """
dimension = 1
[lattice]
spacing = 1e-3
horizon_ratio = {reach}
area = 1e-6
shape = [{{ add = "box", min = [0], max = [0.1] }}]
layer = [{{ name = "left", side = "x-", thickness = {reach} }}, {{ name = "right", side = "x+", thickness = {reach} }}]
[quadrature]
volume_correction = "{correction}"
[material]
youngs_modulus = 2e11
thermal_expansion = 1e-5
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = [0]
[temperature]
change = "100*load"
"""
        for reach in (1, 2, 3, 5):
            for correction, of_outermost in (("linear", 0.5), ("none", 1.0)):
                with self.subTest(reach=reach, correction=correction):
                    results = self.judged(bar.format(reach=reach, correction=correction))
                    share = numpy.ones(reach)
                    share[-1] = of_outermost
                    factor = constant_factor(1, None, reach * 1e-3, 1e-6)
                    force = (numpy.arange(1, reach + 1) * share).sum() * factor * 2e11 * 1e-3 * 1e-9**2
                    self.assertAlmostEqual(force / (2e11 * 1e-5 * 100 * 1e-6 * (1 if correction == "linear" else (reach + 1) / reach)), 1, delta=1e-14)
                    for side, sign in (("left", 1), ("right", -1)):
                        # Distances of points have the round-off of positions, 1e-14 of a spacing at the far end.
                        self.assertAlmostEqual(sign * results.summary["reactions"][side][0] / force, 1, delta=1e-12)
                    self.assertLess(numpy.abs(results.steps[-1].displacement).max(), 1e-12 * 0.1)

    def test_a_heated_cell_has_the_stress_of_its_lattice(self):
        """Held in shape: every bond has the stretch -s, and the stress is the lattice's sum. Free: it grows by s."""
        growth = 0.02
        for dimension, ratio in ((2, 3.015), (3, 2.1)):
            for is_free in (False, True):
                with self.subTest(dimension=dimension, is_free=is_free):
                    shape = [8e-3, 6e-3, 5e-3][:dimension]
                    text = f"dimension = {dimension}\n[lattice]\nspacing = 1e-3\nhorizon_ratio = {ratio}\n"
                    text += "thickness = 2e-3\n" * (dimension == 2)
                    text += f'shape = [{{ add = "box", min = {[0.0] * dimension}, max = {shape} }}]\n'
                    text += "[material]\nyoungs_modulus = 1e9\nthermal_expansion = 2e-4\n[temperature]\nchange = \"100*load\"\n"
                    for axis in range(dimension):
                        # Free to grow, but not to shear, which would let it rotate.
                        gradient = [("free" if k == axis and is_free else 0) for k in range(dimension)]
                        text += f'[[period]]\naxis = "{"xyz"[axis]}"\nfrom = 0\nto = {shape[axis]}\ngradient = {gradient}\n'
                    results = self.results(text)
                    bonds = lattice_ball(dimension, ratio) * 1e-3
                    lengths = numpy.linalg.norm(bonds, axis=1)
                    thickness, volume = (2e-3, 2e-9) if dimension == 2 else (1.0, 1e-9)
                    modulus = constant_factor(dimension, "stress", ratio * 1e-3, thickness) * 1e9
                    expected = -0.5 * modulus * growth * volume * (bonds[:, 0] ** 2 / lengths).sum()
                    for axis in range(dimension):
                        area = volume / 1e-3**dimension * numpy.prod(numpy.delete(shape, axis))
                        reaction = numpy.array(results.summary["reactions"][f"period_{'xyz'[axis]}"]) / area
                        told = numpy.where(numpy.arange(3) == axis, 0.0 if is_free else expected, 0.0)
                        self.assertLess(numpy.abs(reaction - told).max(), 1e-10 * abs(expected))
                    moved = results.steps[-1].displacement
                    centre = results.reference[numpy.linalg.norm(moved, axis=1).argmin()]
                    grown = growth * is_free * (results.reference - centre)
                    self.assertLess(numpy.abs(moved - grown).max(), 1e-11 * growth * shape[0])

    def test_a_linear_temperature_bends_with_little_stress(self):
        """The remaining stretches are of second order in the growth: a tenth of it leaves a hundredth of them."""
        left = []
        for change in (2.0, 0.2):
            results = self.results(HEATED, f'temperature.change="{change}*load*y/0.01"', "loading.steps=1")
            left.append(numpy.abs(results.steps[-1].stretch).max() / (1e-3 * change))
        self.assertLess(left[0], 0.01)
        self.assertAlmostEqual(left[1] / left[0], 0.1, delta=0.02)

    def test_bonds_break_by_the_stretch_that_is_left(self):
        held = HEATED.replace("[temperature]", '[material.damage]\nlaw = "critical_stretch"\ncritical = 0.01\n[temperature]')
        free = self.results(held, "loading.steps=2")
        self.assertEqual(free.summary["broken_bonds"], 0)  # at a growth of 20 critical stretches
        ends = held.replace('set = "corner"\ndisplacement = [0, 0]', 'set = "right"\ndisplacement = [0, 0]')
        ends = ends.replace('set = "foot"\ndisplacement = ["free", 0]', 'set = "start"\ndisplacement = [0, 0]')
        ends = ends.replace("[material]", '[[set]]\nname = "start"\nwhere = "x < 1e-3"\n[material]')
        cold = self.judged(ends, 'temperature.change="-30*load"', "solver.mode=adaptive", "loading.steps=2",
                           "relaxation.steps=10")  # fmt: skip
        self.assertGreater(cold.summary["broken_bonds"], 0)  # cooled by three critical stretches between its ends
        row = cold.table("history")[-1]
        self.assertLess(abs(row["balance_error"]), 0.05 * row["external_work"])

    def test_cpd_grows_in_two_and_three_dimensions(self):
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                third = ", 0.004" if dimension == 3 else ""
                zeros = ", 0" * (dimension - 1)
                text = f"""
dimension = {dimension}
[lattice]
spacing = 1e-3
horizon_ratio = 2.05
shape = [{{ add = "box", min = [0, 0{', 0' * (dimension - 2)}], max = [0.005, 0.004{third}] }}]
[[set]]
name = "corner"
where = "x < 1e-3"
[material]
model = "cpd"
c1 = 1e15
c2 = 2e20
{"c3 = 1e26" if dimension == 3 else ""}
[[support]]
set = "corner"
displacement = [{", ".join(f'"0.2*load*({c} - 0.0005)"' for c in "xyz"[:dimension])}]
[[eigenstrain]]
strain = "0.2*load"
"""
                results = self.results(text)
                growth = 0.2 * (results.reference - 0.0005)
                error = numpy.abs(results.steps[-1].displacement - growth).max()
                self.assertLess(error, 1e-9 * numpy.abs(growth).max(), zeros)
                told = self.command("check-tangent", text).json()
                self.assertLess(max(told["residual_error"], told["tangent_error"]), 1e-6)
                self.assertLess(max(told["force_sum"], told["moment_sum"]), 1e-12)

    def test_what_is_interrupted_goes_on_under_the_same_temperature(self):
        text = HEATED.replace('set = "corner"\ndisplacement = [0, 0]', 'set = "right"\ndisplacement = [0, 0]')
        changes = "loading.steps=4", 'temperature.change="20*load*x/0.02"'
        whole = self.judged(text, *changes)
        self.run_case(text, *changes, name="part", words=("--stop-after", 2), code=130)
        self.resume("part")
        self.assertEqual((self.folder / "part/history.csv").read_text(), (self.folder / "out/history.csv").read_text())
        self.assertEqual(len(whole.steps), 4)

    def test_slips_are_told(self):
        for text, settings, told in (
            (HEATED.replace("thermal_expansion = 1e-3\n", ""), (), "material.thermal_expansion"),
            (HEATED, ('temperature.change="-1000*load"',), "must be above -1"),
            (HEATED.replace('change = "200*load"', ""), (), "temperature.change"),
            (HEATED, ('temperature.change="200*lod"',), "temperature.change"),
            (HEATED, ("solver.fragments=remove",), "can't grow or shrink"),
        ):
            with self.subTest(told=told):
                self.assert_refused(self.command("check", text, *settings), told)


RING = """
dimension = 2
[lattice]
spacing = {spacing}
thickness = 0.1
origin = "nodes"
shape = [{{ add = "disk", centre = [0, 0], radius = 1.0 }}, {{ subtract = "disk", centre = [0, 0], radius = 0.5 }}]
[[set]]
name = "on_x"
where = "abs(y) < spacing/4"
[[set]]
name = "on_y"
where = "abs(x) < spacing/4"
[[set]]
name = "rim"
where = "sqrt(x^2 + y^2) < 0.5 + 1.5*spacing"
[quadrature]
surface_correction = "energy"
volume_correction = "linear"
[material]
youngs_modulus = 1e9
[[support]]
set = "on_x"
displacement = ["free", 0]
[[support]]
set = "on_y"
displacement = [0, "free"]
[[load]]
set = "rim"
pressure = "{pressure}*load"
"""


class Pressed(Loads):
    def growth(self, results):
        """Mean radial displacement at radii within a spacing of 3/4."""
        step, radius = results.steps[-1], numpy.sqrt((results.reference**2).sum(axis=1))
        middle = numpy.abs(radius - 0.75) < 0.05
        along = (step.displacement * results.reference).sum(axis=1) / radius
        return along[middle].mean(), radius[middle]

    def test_a_ring_grows_as_lame_says(self):
        errors = []
        for spacing in (0.1, 0.05, 0.025):
            run = self.judged if spacing > 0.04 else self.results
            results = run(RING.format(spacing=spacing, pressure=1e4))
            found, radius = self.growth(results)
            errors.append(found / ring.lame(radius, 0.5, 1, 1e4, 1e9).mean() - 1)
        self.assertLess(abs(errors[-1]), 0.05)
        self.assertLess(abs(errors[-1]), abs(errors[0]))

    def test_the_continuum_at_large_strain_is_that_of_finite_elements(self):
        radii, exact = ring.solve(0.5, 1.0, 0.1e9, 1e9)
        errors = []
        for elements in (25, 50, 100):
            nodes, found = ring.finite_elements(0.5, 1.0, 0.1e9, 1e9, elements)
            errors.append(numpy.abs(found - numpy.interp(nodes, radii, exact)).max() / exact.max())
        self.assertLess(errors[-1], 1e-4)
        for coarse, fine in zip(errors, errors[1:]):  # linear elements: second order
            self.assertAlmostEqual(numpy.log2(coarse / fine), 2, delta=0.1)

    def test_a_ring_at_large_strain(self):
        results = self.judged(RING.format(spacing=0.05, pressure=0.1e9), "loading.steps=4")
        found, radius = self.growth(results)
        radii, displacement = ring.solve(0.5, 1.0, 0.1e9, 1e9)
        expected = numpy.interp(radius, radii, displacement).mean()
        linear = ring.lame(radius, 0.5, 1, 0.1e9, 1e9).mean()
        small, radius = self.growth(self.judged(RING.format(spacing=0.05, pressure=1e4)))
        of_lattice = small / ring.lame(radius, 0.5, 1, 1e4, 1e9).mean()
        # The lattice's relative error at small strain also applies at large strain, to a tenth of the effect of the
        # strain.
        self.assertGreater(expected / linear, 1.15)
        self.assertAlmostEqual(found / expected / of_lattice, 1, delta=0.03)
        iterations = results.table("history")
        self.assertLess(max(row["newton_iterations"] for row in iterations), 7)

    def test_pressure_on_a_closed_boundary_has_no_resultant(self):
        text = RING.format(spacing=0.1, pressure=5e8)
        told = self.command("check-tangent", text).json()
        self.assertLess(max(told["force_sum"], told["moment_sum"]), 1e-12)
        self.assertLess(max(told["residual_error"], told["tangent_error"]), 1e-6)
        self.assertIn("closed or held", self.command("check", text).said)

    def test_in_space_too(self):
        text = """
dimension = 3
[lattice]
spacing = 0.1
horizon_ratio = 2.1
shape = [{ add = "box", min = [0, 0, 0], max = [0.5, 0.4, 0.4] }]
[[set]]
name = "all"
where = "1"
[[set]]
name = "corner"
where = "x < 0.1 && y < 0.2 && z < 0.2"
[material]
youngs_modulus = 1e6
[[support]]
set = "corner"
displacement = [0, 0, 0]
[[load]]
set = "all"
pressure = "5e4*load"
"""
        told = self.command("check-tangent", text).json()
        self.assertLess(max(told["force_sum"], told["moment_sum"]), 1e-12)
        self.assertLess(max(told["residual_error"], told["tangent_error"]), 1e-6)
        results = self.judged(text)
        self.assertLess(results.steps[-1].stretch.min(), -0.01)

    def test_an_open_boundary_is_told_and_forces_are_exact(self):
        load = '[[load]]\nside = "y+"\npressure = "2e7*load"\n'
        ended = self.assert_completed(self.command("check", PLATE + load))
        self.assertIn("open or uneven", ended.said)
        for settings in ((), ("loading.steps=3",), ("solver.mode=relaxation",)):
            with self.subTest(settings=settings):
                results = self.judged(PLATE + load, *settings)
                self.assertGreater(numpy.abs(results.steps[-1].displacement).max(), 1e-3)  # it has rotated
        row = results.table("history")[-1]
        self.assertLess(abs(row["balance_error"]), 1e-6 * row["external_work"])

    def test_what_cannot_be_is_refused(self):
        text = PLATE + '[[load]]\nside = "y+"\npressure = 1\n'
        self.assert_refused(self.command("check", text, "solver.tangent=matrix_free"), "pressure")
        inside = '[[set]]\nname = "inside"\nwhere = "abs(x-0.01) < 2e-3 && abs(y-0.005) < 2e-3"\n'
        load = '[[load]]\nset = "inside"\npressure = 1\n'
        self.assert_refused(self.command("check", PLATE + inside + load), "no point on the boundary")


if __name__ == "__main__":
    unittest.main()
