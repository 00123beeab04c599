"""A horizon per point: patch tests of graded meshes, and what a person is told."""

import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference.graded import GradedRing, errors, patch_test

OWN = "{ ratio = 4.015 }"
LINEAR = 'volume_correction = "linear"'


class HorizonsOfPoints(Folder):
    def ring(self, along=32, ratio=4.015):
        ring = GradedRing(along)
        ring.write(self.folder / "points.csv", ring.depth() < (ratio + 1) * ring.sizes)
        return ring

    def patch(self, ring, horizon, quadrature, inside):
        output = self.run_case(patch_test("points.csv", horizon, quadrature))
        with h5py.File(output / "results.h5") as file:
            return errors(file, ring, inside)

    def test_a_patch_test_of_sizes_of_4_to_1_is_within_3_per_cent(self):
        ring = self.ring()
        self.assertGreater(ring.sizes.max() / ring.sizes.min(), 4)
        inside = ring.depth() > 2 * 4.015 * ring.sizes
        self.assertGreater(inside.sum(), 50)
        corrected = self.patch(ring, OWN, LINEAR, inside)
        self.assertLess(max(corrected[:3]), 0.03)
        # As many neighbours in the mean, but the large elements have hardly any.
        one = self.patch(ring, 4.015 * ring.areas.mean() ** 0.5, LINEAR, inside)
        self.assertGreater(one[0], 2 * corrected[0])

    def test_results_have_the_horizons(self):
        ring = self.ring(16)
        output = self.run_case(patch_test("points.csv", OWN))
        with h5py.File(output / "results.h5") as file:
            found, row = file["points/horizon"][()], file["points/source_row"][()]
            self.assertEqual(file["points/horizon"].attrs["unit"], "m")
        self.assertLess(abs(found / (4.015 * ring.sizes[row]) - 1).max(), 1e-14)
        self.assertIn("horizon = { ratio = 4.015 }", (output / "case.resolved.toml").read_text()
                      if (output / "case.resolved.toml").exists() else self.resolved(output))  # fmt: skip

    def resolved(self, output):
        with h5py.File(output / "results.h5") as file:
            return file["case/as_resolved"].asstr()[()]


if __name__ == "__main__":
    unittest.main()
