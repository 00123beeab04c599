"""Elastic foundations: springs between points and a ground that may move."""

import h5py
import numpy

from tests.acceptance.constraints_test import BONDS, HOLE, Constrained, plate
from tests.acceptance.programme_test import Programmes
from tests.reference.verify import verify
from tests.same_results import differences

BLOCK = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.02, 0.01] }]
[[set]]
name = "all"
where = "1"
[[set]]
name = "right"
where = "x > 0.019"
[[set]]
name = "foot"
where = "y < 1e-3"
[[set]]
name = "inside"
where = "abs(y - 5e-3) < 1e-3"
[material]
youngs_modulus = 200e9
[solver]
relative_tolerance = 1e-12
"""
SPRINGS = '[[foundation]]\nname = "bed"\nset = "all"\nstiffness = [2e6, 5e5]\n'
FORCE = '[[load]]\nset = "all"\ntotal_force = ["30*load", "-20*load"]\n'

BAR = """\
dimension = 1
[lattice]
spacing = 1e-2
area = 1e-4
shape = [{ add = "box", min = [0], max = [0.5] }]
layer = [{ name = "left", side = "x-", thickness = 1 }, { name = "right", side = "x+", thickness = 1 }]
[material]
youngs_modulus = 200e9
[[support]]
set = "left"
displacement = [0]
[solver]
relative_tolerance = 1e-12
"""
PULLED_BY_SPRING = '[[foundation]]\nname = "machine"\nset = "right"\nstiffness = [{stiffness}]\ndisplacement = ["{ground}*load"]\n'
BRITTLE = '[material.damage]\nlaw = "critical_stretch"\ncritical = 0.01\nno_fail = ["left", "right"]\n'

BEAM = """\
dimension = 2
[lattice]
spacing = {spacing}
thickness = 1e-2
shape = [{{ add = "box", min = [-0.6, 0], max = [0.6, 0.02] }}]
[[set]]
name = "middle"
where = "abs(x) < spacing"
[quadrature]
surface_correction = "energy"
volume_correction = "linear"
[material]
youngs_modulus = 1e9
[[foundation]]
name = "soil"
side = "y-"
modulus = [1e5, 1e7]
[[load]]
set = "middle"
total_force = [0, "-1*load"]
"""


class Springs(Programmes):
    def fields(self, name="out"):
        with h5py.File(self.folder / name / "results.h5") as file:
            step = file["steps"][sorted(file["steps"])[-1]]
            return file["points/reference"][...], {key: step[key][...] for key in step if step[key].shape}

    def judge(self, name="out"):
        with h5py.File(self.folder / name / "results.h5") as file:
            text = file["case/as_resolved"][()].decode()
        complaints, _ = verify(self.folder / name, text, self.folder)
        self.assertEqual(complaints, [])

    def test_a_block_moves_by_force_over_stiffness(self):
        for solver in ("cholesky", "pcg", "gmres"):
            with self.subTest(solver):
                row = self.rows(BLOCK + SPRINGS + FORCE, f"solver.linear={solver}", name=solver)[-1]
                displacement = self.fields(solver)[1]["displacement"]
                numpy.testing.assert_allclose(displacement, numpy.tile([30 / 2e6, -20 / 5e5], (200, 1)), rtol=1e-9)
                self.assertAlmostEqual(row["reaction_x:bed"], -30, delta=1e-9)
                self.assertAlmostEqual(row["reaction_y:bed"], 20, delta=1e-9)
                energy = 0.5 * (30**2 / 2e6 + 20**2 / 5e5)
                self.assertAlmostEqual(row["stored_energy"] / energy, 1, delta=1e-9)
                self.judge(solver)

    def test_all_searches_find_the_same(self):
        """Half of the block's load acts on its right end, so that it is strained, too."""
        text = BLOCK + SPRINGS + FORCE.replace('"all"', '"right"')
        self.run_case(text)
        expected = self.fields()[1]["displacement"]
        for settings in (("solver.mode=relaxation", "solver.relative_tolerance=1e-10"), ("loading.steps=3",),
                         ("solver.mode=arc_length",), ("solver.linear=pcg", "solver.preconditioner=multigrid")):  # fmt: skip
            with self.subTest(settings):
                self.run_case(text, *settings, name=settings[0])
                found = self.fields(settings[0])[1]["displacement"]
                self.assertLess(numpy.abs(found - expected).max(), 1e-7 * numpy.abs(expected).max())
                self.judge(settings[0])

    def test_a_ground_that_moves_carries_a_body_along(self):
        moved = SPRINGS + 'displacement = ["1e-3*load", "2e-3*load"]\n'
        # On softer springs relaxation would wait for a mode a thousand times slower than the others.
        stiff = ("foundation[0].stiffness=[2e10, 5e9]", "solver.mode=relaxation")
        for name, settings in (("once", ()), ("relaxed", stiff), ("steps", ("loading.steps=4",))):
            with self.subTest(name):
                row = self.rows(BLOCK + moved, *settings, name=name)[-1]
                displacement = self.fields(name)[1]["displacement"]
                numpy.testing.assert_allclose(displacement, numpy.tile([1e-3, 2e-3], (200, 1)), rtol=1e-6)
                self.assertLess(abs(row["reaction_x:bed"]), 1e-5 * 2e6 * 1e-3)
                turned_over = 0.5 * (2e6 * 1e-3**2 + 5e5 * 2e-3**2)
                self.assertLess(abs(row["stored_energy"]), 1e-6 * turned_over)
                self.assertLess(abs(row["balance_error"]), 1e-6 * turned_over)

    def test_a_spring_and_a_bar_in_series(self):
        stretched = BAR + '[[support]]\nset = "right"\ndisplacement = ["1e-4*load"]\n'
        stiffness = self.rows(stretched, name="bar")[-1]["reaction_x:right"] / 1e-4
        soft = 0.25 * stiffness
        row = self.rows(BAR + PULLED_BY_SPRING.format(stiffness=soft, ground="5e-4"))[-1]
        self.assertAlmostEqual(row["reaction_x:machine"] / (1e-4 * stiffness), 1, delta=1e-9)
        self.assertAlmostEqual(row["reaction_x:left"], -row["reaction_x:machine"], delta=1e-9 * row["reaction_x:machine"])
        self.assertAlmostEqual(row["external_work"] / row["stored_energy"], 1, delta=1e-9)
        self.judge()

    def test_a_soft_machine_breaks_a_bar_with_the_energy_of_its_spring(self):
        """With a stiff machine the work is the energy of the bar; a soft machine adds its spring's energy."""
        stiffness = 4e7  # of the bar, approximately
        drained = {}
        for name, factor in (("stiff", 100), ("soft", 0.1)):
            text = BAR + BRITTLE + PULLED_BY_SPRING.format(stiffness=factor * stiffness, ground=0.02 * 0.5 * (1 + 1 / factor))
            rows = self.rows(text, "solver.mode=adaptive", "loading.steps=40", "solver.relative_tolerance=1e-8", name=name)
            self.judge(name)
            self.assertGreater(rows[-1]["broken_bonds"], 0)
            for row in rows:
                self.assertLess(abs(row["balance_error"]), 1e-6 * max(row["external_work"], 1e-9))
            self.assertAlmostEqual(rows[-1]["stored_energy"], 0, delta=1e-6 * rows[-1]["external_work"])
            drained[name] = rows[-1]["drained_energy"]
        self.assertGreater(drained["soft"], 5 * drained["stiff"])

    def test_a_beam_on_soil_sags_as_hetenyi_says(self):
        """w(x) = P l / (2 k b) exp(-l x) (cos l x + sin l x), l4 = k b / (4 E I), without shear and for an infinite
        beam (this one extends 4.7 / l to either side): up to the lattice's error in bending, which falls."""
        errors = []
        for spacing in (4e-3, 2e-3):
            self.run_case(BEAM.format(spacing=spacing))
            reference, fields = self.fields()
            bed, width, bending = 1e7, 1e-2, 1e9 * 1e-2 * 0.02**3 / 12
            slope = (bed * width / (4 * bending)) ** 0.25
            middle = numpy.abs(reference[:, 1] - 0.01) < spacing
            sag = -fields["displacement"][middle, 1]
            away = slope * numpy.abs(reference[middle, 0])
            expected = slope / (2 * bed * width) * numpy.exp(-away) * (numpy.cos(away) + numpy.sin(away))
            errors.append(numpy.abs(sag - expected).max() / expected.max())
        self.assertLess(errors[1], 0.05)
        self.assertLess(errors[1], errors[0])
        self.judge()

    def test_tangents_are_those_of_the_energy(self):
        moved = SPRINGS + 'displacement = ["1e-3*load*x", "2e-3*load"]\n'
        for text in (BLOCK + moved, BLOCK + moved + '[[rigid]]\nset = "right"\n', BEAM.format(spacing=4e-3)):
            told = self.command("check-tangent", text).json()
            self.assertLess(max(told["residual_error"], told["tangent_error"]), 1e-6, told)
            self.assertLess(max(told["asymmetry"], told["force_sum"], told["moment_sum"]), 1e-9, told)

    def test_a_rigid_set_on_springs(self):
        """A platen on springs below its ends rotates by M / (k a2 / 2)."""
        text = BLOCK + """\
[[set]]
name = "feet"
where = "y < 1e-3 && (x < 1e-3 || x > 0.019)"
[[set]]
name = "platen"
where = "y < 5e-3"
[[rigid]]
set = "platen"
[[foundation]]
name = "springs"
set = "feet"
stiffness = [1e6, 1e6]
[[load]]
set = "right"
total_force = [0, "-1*load"]
"""
        row = self.rows(text)[-1]
        span, arm = 0.019, 0.0095
        self.assertAlmostEqual(row["rotation_z:platen"] / (-arm / (1e6 * (span / 2) ** 2)), 1, delta=1e-3)
        self.assertAlmostEqual(row["reaction_y:springs"], 1, delta=1e-9)
        self.judge()

    def test_a_controlled_displacement_on_springs(self):
        text = BLOCK + SPRINGS + FORCE + '[[control]]\nset = "all"\nweights = [1, 0]\n[loading]\ntable = [0, 3e-5]\nsteps = 2\n'
        row = self.rows(text)[-1]
        self.assertAlmostEqual(row["load_factor"], 3e-5 * 2e6 / 30, delta=1e-9)
        self.judge()

    def test_what_was_interrupted_goes_on(self):
        text = BAR + BRITTLE + PULLED_BY_SPRING.format(stiffness=4e6, ground=0.11)
        settings = ("solver.mode=adaptive", "loading.steps=20")
        self.run_case(text, *settings, "loading.table=[0, 0.3, 1]", name="whole")
        self.run_case(text, *settings, "loading.table=[0, 0.3]", name="part")
        self.resume("part", "loading.table=[0, 0.3, 1]")
        self.assertEqual(differences(self.folder / "whole", self.folder / "part"), [])

    def test_what_came_off_stays_on_its_springs(self):
        """A body in two parts, each on springs: no part floats."""
        text = BAR + BRITTLE + PULLED_BY_SPRING.format(stiffness=4e6, ground=0.11)
        rows = self.rows(text, "solver.mode=adaptive", "loading.steps=40", "solver.fragments=stop")
        self.assertGreater(rows[-1]["broken_bonds"], 0)
        self.assertEqual(max(row["pin_force"] for row in rows), 0)

    def test_slips_are_told(self):
        for text, told in (
            ('name = "bed"\nset = "all"\nstiffness = [0, 0]\n', "has no effect"),
            ('name = "bed"\nset = "all"\nstiffness = [-1, 0]\n', "0 or positive"),
            ('name = "bed"\nset = "all"\nstiffness = [1, 0]\nmodulus = [1, 0]\n', "modulus"),
            ('name = "bed"\nset = "all"\n', "stiffness"),
            ('name = "bed"\nstiffness = [1, 1]\n', "set"),
            ('name = "bed"\nmodulus = [1, 1]\n', "side or a set"),
            ('name = "bed"\nset = "all"\nside = "y-"\nstiffness = [1, 1]\n', "for a modulus"),
            ('name = "bed"\nset = "inside"\nmodulus = [1, 1]\n', "boundary"),
            ('name = "bed"\nset = "nowhere"\nstiffness = [1, 1]\n', "nowhere"),
            ('name = "bed"\nset = "all"\nstiffness = [1, 1]\ndisplacement = ["free", 0]\n', "ground"),
            ('name = "bed"\nset = "all"\nstiffness = [1, 1]\ndisplacement = ["1/load", 0]\n', "finite"),
            ('name = "foot"\nset = "all"\nstiffness = [1, 1]\n[[support]]\nset = "foot"\ndisplacement = [0, 0]\n', "reaction"),
            ('name = "bed"\nset = "foot"\nstiffness = [1, 0]\n', "may move along y"),
        ):
            with self.subTest(text):
                self.assert_refused(self.command("check", BLOCK + FORCE + "[[foundation]]\n" + text), told)
        self.assert_refused(self.command("check", BLOCK + SPRINGS, "solver.tangent=matrix_free"), "[[foundation]]")


class HalvesOnSprings(Constrained):
    def test_half_a_plate_on_a_bed_is_the_whole(self):
        bed = '[[foundation]]\nname = "bed"\nside = "x+"\nmodulus = [3e12, 1e12]\n'
        both = bed + bed.replace("x+", "x-").replace('"bed"', '"other"')
        whole = self.rows(plate("", BONDS, hole=HOLE, more=both), name="whole")
        half = self.rows(plate("x", BONDS, hole=HOLE, more=bed), name="half")
        self.assert_part_of(self.fields("whole"), self.fields("half"))
        for column in ("reaction_x:bed", "reaction_y:bed"):
            self.assertAlmostEqual(half[-1][column], whole[-1][column], delta=1e-9 * abs(whole[-1]["reaction_y:top"]))
        self.assertAlmostEqual(2 * half[-1]["stored_energy"] / whole[-1]["stored_energy"], 1, delta=1e-11)

    def test_a_bed_towards_a_plane_is_refused(self):
        bed = '[[foundation]]\nname = "bed"\nside = "x-"\nmodulus = [3e12, 1e12]\n'
        self.assert_refused(self.command("check", plate("x", BONDS, more=bed)), "beyond a plane")
