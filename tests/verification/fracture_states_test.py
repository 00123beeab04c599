"""Every accepted state of the published fracture problems, checked by tests/reference.

Each problem runs twice: with damage only in accepted states, so that the states determine the histories of
the bonds, and as shipped, where transient breaking makes histories that are read from the results.
"""

import unittest

from tests.reference.case import Case
from tests.reference.program import ROOT
from tests.reference.verify import Verification
from tests.shipped_runs import shipped_run

# Minimum number of broken bonds: a run that breaks nothing would prove nothing.
CASES = {
    "plate_with_hole/square": 500,
    "plate_with_hole/rectangle": 500,
    "three_point_bending/notched": 400,
    "four_holes/tension": 8000,
}


class FractureStates(unittest.TestCase):
    def verified(self, name, **relaxation):
        path = ROOT / "cases" / f"{name}.toml"
        case = Case(path.read_text(), path.parent)
        case["relaxation"].update(relaxation)
        run = shipped_run(name, *(f"relaxation.{key}={value}" for key, value in relaxation.items()))
        self.assertEqual(run.code, 0, run.output + run.errors)
        verification = Verification(run.folder, case)
        self.assertTrue(verification.histories_are_known, "the results tell no histories of the bonds")
        self.assertEqual(verification.run(), [])
        self.assertGreater(len(verification.results.steps), 9)
        self.assertGreater(verification.results.summary["broken_bonds"], CASES[name])


def add_tests(name):
    title = name.replace("/", "_")

    def at_equilibrium(self):
        self.verified(name, breaking="at_equilibrium")

    def as_shipped(self):
        self.verified(name)

    setattr(FractureStates, f"test_{title}_with_damage_in_accepted_states", at_equilibrium)
    setattr(FractureStates, f"test_{title}_as_shipped", as_shipped)


for case_name in CASES:
    add_tests(case_name)

if __name__ == "__main__":
    unittest.main()
