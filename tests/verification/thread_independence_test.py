"""Cracks take the same path, bond by bond, with any number of threads; relaxation and explicit steps
give the same bits."""

import sys
import unittest

from tests.reference.program import ROOT, execute


class ThreadIndependence(unittest.TestCase):
    def told(self, *cases):
        command = [sys.executable, "-BEs", ROOT / "benchmarks/thread_independence.py", *cases]
        ended = execute(command, seconds=1500, limited=False)
        self.assertEqual(ended.code, 0, ended.said)
        return [[cell.strip() for cell in line.strip("|").split("|")] for line in ended.output.splitlines()[2:]]

    def test_square_breaks_sixteen_bonds_first(self):
        # The case of a relaxation without inertia, which cannot jump over a barrier.
        for row in self.told("plate_with_hole/square"):
            self.assertEqual(row[5].split(" at ")[0], "16")
            self.assertAlmostEqual(float(row[5].split(" at ")[1]), 0.5575, delta=0.003)

    def test_relaxation_and_explicit_steps_have_the_same_bits(self):
        # Bonds, bonds with a mirror plane and contact, states, convolutions.
        for row in self.told("--bits", "--threads", "1,2,3,5", "plate_with_hole/square", "contact/impact",
                             "contact/impactor:dynamics.end_time=2e-5", "lps/v_notch:dynamics.end_time=5e-6",
                             "fcbm/waves"):  # fmt: skip
            self.assertIn(row[1], {"1", "2", "3", "5"})

    def test_coarser_plates_break_the_same_bonds_on_any_number_of_threads(self):
        # The problems as shipped take minutes: benchmarks/thread_independence.py.
        for row in self.told("three_point_bending/notched:lattice.spacing=2.4e-3",
                             "four_holes/tension:lattice.spacing=2e-3"):  # fmt: skip
            self.assertGreater(int(row[6]), 20)


if __name__ == "__main__":
    unittest.main()
