"""Coulomb friction of obstacles, from the command line."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.program import ROOT
from tests.same_results import differences

INCLINE = (ROOT / "cases/contact/incline.toml").read_text()
WEIGHT = 1000 * 0.020 * 0.010 * 1e-3 * 9.81  # N across the slope
SPRING = 1e-3  # N/m
# A block under its weight, which is put on slowly; then a force along the floor grows.
PUSHED = INCLINE.split("[[foundation]]")[0] + """\
[[load]]
gravity = ["9.81*max(0, 10*(t - 0.03))", "-9.81*min(1, 40*t)"]
[[probe]]
name = "block"
set = "block"
field = "velocity"
[solver]
mode = "dynamics"
[dynamics]
end_time = 0.0625
[output]
every = 500
"""


class FrictionTest(Folder):
    def moved(self, *changes):
        """Displacement of the block by load factor, and all columns."""
        rows = columns(self.run_case(INCLINE, *changes))
        return dict(zip(rows["load_factor"].round(9), rows["block_x"])), rows

    def test_sticks_below_and_slides_above_the_angle_of_friction(self):
        for friction in (0.3, 0.1):
            below, above = round(friction - 1e-3, 9), round(friction + 1e-3, 9)
            moved, rows = self.moved(f"obstacle[0].friction={friction}", f"loading.table=[0, {below}, {above}]")
            self.assertLess(moved[below], 1e-7)
            stuck = rows["load_factor"] <= below
            # The spring bears next to nothing of what is below the limit of friction.
            self.assertLess(abs(rows["reaction_x:spring"][stuck]).max(), 1e-6 * WEIGHT)
            along, across = -rows["reaction_x:slope"], rows["reaction_y:slope"]
            numpy.testing.assert_allclose(along[stuck], rows["load_factor"][stuck] * WEIGHT, rtol=1e-5, atol=1e-12)
            numpy.testing.assert_allclose(along[-1], friction * across[-1], rtol=1e-5)
            numpy.testing.assert_allclose(moved[above], (above * WEIGHT - friction * across[-1]) / SPRING, rtol=1e-5)

    def test_what_slides_is_dissipated(self):
        moved, rows = self.moved()
        force = -rows["reaction_x:slope"][-1]
        # It slides at a force that does not change; the edges have slid a little before.
        numpy.testing.assert_allclose(rows["dissipated_energy"][-1], force * moved[0.301], rtol=1e-3)
        self.assertLess(abs(rows["balance_error"][-1]), 1e-4 * rows["dissipated_energy"][-1])

    def test_does_not_creep(self):
        """However many steps it waits in, it stays where it stuck, as far as the normal forces are found: 1e-6."""
        stay = "loading.table=[0, 0.299, 0.299, 0.299]"
        _, rows = self.moved(stay, "loading.steps=25")
        arrived = rows["block_x"][26 if rows["step"][0] == 0 else 25]
        numpy.testing.assert_allclose(rows["block_x"][-1], arrived, rtol=1e-7)
        once = self.moved("loading.table=[0, 0.299]", "loading.steps=2")[0][0.299]
        numpy.testing.assert_allclose(arrived, once, rtol=1e-2)  # edges slide by steps

    def test_unloading_leaves_a_slip(self):
        rows = columns(self.run_case(INCLINE, "loading.table=[0, 0.301, 0, -0.29]"))
        at = {round(load, 9): moved for load, moved in zip(rows["load_factor"], rows["block_x"])}
        self.assertGreater(at[0.301], 1e-3)
        self.assertGreater(rows["block_x"][-1], 0.999 * at[0.301])

    def test_resumed_runs_and_threads(self):
        table = "loading.table=[0, 0.299, 0.301, 0.1]"
        whole = self.run_case(INCLINE, table)
        self.run_case(INCLINE, "loading.table=[0, 0.299, 0.301]", name="part")
        self.resume("part", table)
        self.assertEqual(differences(whole, self.folder / "part"), [])
        one, two = (columns(self.run_case(INCLINE, table, name="other", threads=count)) for count in (1, 2))
        numpy.testing.assert_allclose(one["block_x"], two["block_x"], rtol=1e-6, atol=1e-15)

    def test_explicit_steps(self):
        """It sticks until the force along the floor is mu times that on it, at 0.06 s, and then accelerates."""
        rows = columns(self.run_case(PUSHED))
        stuck = (rows["time"] > 0.03) & (rows["time"] < 0.0595)
        self.assertGreater(stuck.sum(), 3)
        force = 10 * (rows["time"] - 0.03) * WEIGHT
        numpy.testing.assert_allclose(-rows["reaction_x:slope"][stuck], force[stuck], atol=0.03 * WEIGHT)
        self.assertLess(abs(rows["block_x"][stuck]).max(), 2e-4)
        # v = 98.1 (t - 0.06)^2 / 2 [m/s]; vibrations of the block lower friction a little.
        expected = 0.5 * 98.1 * (rows["time"][-1] - 0.06) ** 2
        self.assertGreater(rows["block_x"][-1], 0.9 * expected)
        self.assertLess(rows["block_x"][-1], 1.6 * expected)
        self.assertLess(abs(rows["balance_error"][-1]), 0.02 * rows["external_work"][-1])

    def test_implicit_steps_that_damp_vibrations(self):
        """Newmark's steps without vibrations: the rigid block, v = 98.1 (t - 0.06)^2 / 2 [m/s]."""
        damped = PUSHED.replace("end_time = 0.0625", 'end_time = 0.08\nscheme = "newmark"\ntime_step = 2e-4\nspectral_radius = 0.0')
        rows = columns(self.run_case(damped.replace("every = 500", "every = 50")))
        numpy.testing.assert_allclose(rows["block_x"][-1], 0.5 * 98.1 * 0.02**2, rtol=2e-3)
        numpy.testing.assert_allclose(-rows["reaction_x:slope"][-1], 0.3 * rows["reaction_y:slope"][-1], rtol=1e-5)
        stuck = (rows["time"] > 0.03) & (rows["time"] < 0.0595)
        self.assertLess(abs(rows["block_x"][stuck]).max(), 1e-5)

    def test_refused(self):
        self.assertIn("friction", self.refusal(INCLINE, "obstacle[0].friction=-0.1"))
        self.assertIn("needs friction", self.refusal(INCLINE, "obstacle[0].friction=0", "obstacle[0].tangential_stiffness=2"))
