"""Sums along the rows of a lattice, where a case demands them."""

import unittest

import numpy

from tests.acceptance.folder import Folder

PLATE = """\
dimension = 2
[lattice]
spacing = 0.05
horizon_ratio = 2.015
thickness = 0.1
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [1.5, 1]
[[lattice.shape]]
subtract = "disk"
centre = [0.75, 0.5]
radius = 0.15
[material]
youngs_modulus = 1e9
[material.damage]
law = "critical_stretch"
critical = 0.01
[[set]]
name = "left"
where = "x < 0.1"
[[set]]
name = "right"
where = "x > 1.4"
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["0.012*load", 0]
[loading]
steps = 3
[solver]
mode = "relaxation"
operator = "stencil"
"""


class Stencil(Folder):
    def test_rows_through_fracture(self):
        self.assert_as_one_by_one()

    def test_rows_of_states_through_fracture(self):
        self.assert_as_one_by_one('material.model="state"', "material.poisson_ratio=0.2")

    def test_rows_of_linear_bonds(self):
        self.assert_as_one_by_one('material={kinematics="linear", youngs_modulus=1e9}', "solver.mode=newton", breaks=False)

    def assert_as_one_by_one(self, *changes, breaks=True):
        """Bonds of points moved by a billionth of the spacing all differ: they go by number of kind, or one by one."""
        rows = self.results(PLATE, *changes, name="rows").steps[-1]
        single = self.results(PLATE, *changes, 'solver.operator="bonds"', "lattice.perturbation=1e-9", name="single").steps[-1]
        if breaks:
            self.assertGreater(rows.damage.max(), 0)
            numpy.testing.assert_allclose(rows.damage, single.damage, atol=1e-12)
        # Residuals of relaxation, 1e-6 of the forces, and the moved points differ.
        numpy.testing.assert_allclose(rows.displacement, single.displacement, atol=1e-6 * abs(rows.displacement).max())

    def test_bodies_without_rows_are_refused(self):
        for changes, words in (
            (['lattice.points="blue_noise"'], ["of this body's bonds only"]),
            (["lattice.shape=[{add=\"box\", min=[0, 0], max=[1.5, 0.15]}]"], ["rows of lattice points"]),
        ):
            with self.subTest(changes):
                self.assert_refused(self.command("check", PLATE, *changes), "solver.operator", '"stencil"', 'take "bonds"', *words)


if __name__ == "__main__":
    unittest.main()
