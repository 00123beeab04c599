"""A crack of model `state` in a clamped strip runs at the fracture energy of its data sheet, whatever Poisson's ratio is."""

import unittest

from benchmarks.steady_cracks import Strip, measured
from tests.acceptance.folder import Folder


class SteadyCracks(Folder):
    def test_g_is_that_of_the_data_sheet(self):
        """Within 4 %: a tear along the rows takes 2.2 % less than the mean over directions, and the steps of the control
        drain some per cent. Both are known, and explain G within 2 %."""
        for name in ("stress_0", "stress_0.45", "strain_0.25"):
            with self.subTest(name):
                found = measured(Strip(name, 23), self.folder)
                self.assertAlmostEqual(found.release, 1, delta=0.04)
                self.assertAlmostEqual(found.release / (found.tear * (1 + found.drained)), 1, delta=0.02)
                self.assertGreater(found.drained, 0)


if __name__ == "__main__":
    unittest.main()
