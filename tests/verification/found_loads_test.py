"""Every accepted state under a control and along the arc length, checked by tests/reference."""

import unittest

from tests.reference.case import Case
from tests.reference.program import ROOT
from tests.reference.verify import Verification
from tests.shipped_runs import shipped_run


class FoundLoads(unittest.TestCase):
    def verified(self, name, steps):
        path = ROOT / "cases" / f"{name}.toml"
        run = shipped_run(name)
        self.assertEqual(run.code, 0, run.output + run.errors)
        verification = Verification(run.folder, Case(path.read_text(), path.parent))
        self.assertTrue(verification.histories_are_known)
        self.assertEqual(verification.run(), [])
        self.assertGreater(len(verification.results.steps), steps)
        return verification

    def test_column(self):
        self.verified("buckling/column", 10)

    def test_arch(self):
        self.verified("buckling/arch", 20)

    def test_mouth_opening(self):
        verification = self.verified("three_point_bending/mouth_opening", 30)
        self.assertGreater(verification.results.summary["broken_bonds"], 50)
        self.assertIn("control", verification.worst)


if __name__ == "__main__":
    unittest.main()
