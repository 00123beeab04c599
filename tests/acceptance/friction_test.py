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
    def test_sticks_below_and_slides_above_the_angle_of_friction(self):
        for friction in (0.3, 0.1):
            below, above = friction - 1e-3, friction + 1e-3
            rows = columns(self.run_case(INCLINE, f"obstacle[0].friction={friction}", f"loading.table=[0, {below}, {above}]"))
            sticks, slides = rows["block_x"][1:]
            self.assertLess(sticks, 1e-7)
            spring = rows["reaction_x:spring"][1:]
            self.assertLess(abs(spring[0]), 1e-6 * WEIGHT)
            along, across = -rows["reaction_x:slope"], rows["reaction_y:slope"]
            numpy.testing.assert_allclose(along[1:], [below * WEIGHT, friction * across[2]], rtol=1e-5)
            numpy.testing.assert_allclose(slides, (above * WEIGHT - friction * across[2]) / SPRING, rtol=1e-5)
            numpy.testing.assert_allclose(rows["moment_z:slope"][1:], -across[1:] * 0.0, atol=across[1] * 0.02)

    def test_what_slides_is_dissipated(self):
        rows = columns(self.run_case(INCLINE, "loading.steps=20"))
        slid, force = rows["block_x"][-1], -rows["reaction_x:slope"][-1]
        # It slides in the last tenth of the way, at a force that hardly changes.
        numpy.testing.assert_allclose(rows["dissipated_energy"][-1], force * slid, rtol=2e-2)
        self.assertLess(abs(rows["balance_error"][-1]), 0.02 * rows["dissipated_energy"][-1])

    def test_does_not_creep(self):
        """However many steps it waits in, it stays where it stuck."""
        once = columns(self.run_case(INCLINE, "loading.table=[0, 0.299]"))["block_x"][-1]
        often = columns(self.run_case(INCLINE, "loading.table=[0, 0.299]", "loading.steps=50"))["block_x"][-1]
        waited = columns(self.run_case(INCLINE, "loading.table=[0, 0.299, 0.299]", "loading.steps=20"))["block_x"][-1]
        numpy.testing.assert_allclose([often, waited], once, rtol=1e-8)

    def test_unloading_leaves_a_slip(self):
        rows = columns(self.run_case(INCLINE, "loading.table=[0, 0.301, 0, -0.29]"))
        self.assertGreater(rows["block_x"][1], 1e-3)
        self.assertGreater(rows["block_x"][2], 0.999 * rows["block_x"][1])
        self.assertGreater(rows["block_x"][3], 0.99 * rows["block_x"][1])

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

    def test_refused(self):
        self.assertIn("friction", self.refusal(INCLINE, "obstacle[0].friction=-0.1"))
        self.assertIn("needs friction", self.refusal(INCLINE, "obstacle[0].friction=0", "obstacle[0].tangential_stiffness=2"))
