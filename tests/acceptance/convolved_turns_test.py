"""Materials for convolutions only, at large strains or rotations."""

import math
import unittest

import h5py
import numpy

from tests.acceptance.linear_kinematics_test import CommandLine

PLATE = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 2e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.1, 0.1] }]
[[set]]
name = "all"
where = "x > -1"
[[support]]
set = "all"
displacement = ["(1+1e-4)*x*cos(load*pi/2)-x - y*sin(load*pi/2)", "(1+1e-4)*x*sin(load*pi/2) + y*(cos(load*pi/2)-1)"]
[loading]
steps = 2
[solver]
operator = "fft"
[output]
stress = true
[material]
model = "green_bond"
youngs_modulus = 70e9
damage = { law = "energy_density", fracture_energy = 3.8 }
"""


class LargeTurns(CommandLine):
    def test_a_brittle_plate_that_turns_by_90_degrees(self):
        """Two thirds of the strength everywhere: sums that keep the rotation lose all of its digits."""
        turned = self.results(PLATE)
        straight = self.results(PLATE, 'support=[{set="all", displacement=["1e-4*x*load", "0"]}]')
        self.assertEqual(turned.damage.max(), 0.0)
        self.assertGreater(straight.energy_density.max(), 0.6 * 3.8 / (2 * 3.015e-3))
        numpy.testing.assert_allclose(turned.energy_density, straight.energy_density, rtol=1e-8)


class LargeStrains(CommandLine):
    def test_stress_across_plane_strain(self):
        material = 'material={model="correspondence", youngs_modulus=70e9, poisson_ratio=0.3, plane="strain"}'
        run = self.results(PLATE, material, 'lattice.shape=[{add="box", min=[0, 0], max=[0.02, 0.012]}]',
                           'support=[{set="all", displacement=["0.1*x*load", "0"]}]')  # fmt: skip
        with h5py.File(self.folder / "out/results.h5") as file:
            found = file["steps"][sorted(file["steps"])[-1]]["von_mises"][:]
        mu, Lambda = 70e9 / 2.6, 70e9 * 0.3 / 1.3 / 0.4
        green = (1.1**2 - 1) / 2
        x, y = 1.1 * (Lambda + 2 * mu) * green, Lambda * green / 1.1  # and z as y
        middle = numpy.linalg.norm(run.reference[:, :2] - [0.01, 0.006], axis=1).argmin()
        self.assertAlmostEqual(found[middle] / math.fabs(x - y), 1.0, delta=1e-9)


if __name__ == "__main__":
    unittest.main()
