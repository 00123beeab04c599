"""Contact and obstacles in mode path: contacts close, press and open between one breaking bond and the next."""

import json

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.acceptance.path_test import strip
from tests.reference.results import table
from tests.reference.verify import Verification
from tests.same_results import differences

# A notched beam of 25 x 7 points on two single points, loaded at the middle of its upper side.
BEAM = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [-0.0125, 0], max = [0.0125, 0.007] }]
[[set]]
name = "left"
where = "y < spacing && abs(x + 0.010) < 0.5*spacing"
[[set]]
name = "right"
where = "y < spacing && abs(x - 0.010) < 0.5*spacing"
[[set]]
name = "middle"
where = "y > 0.006 && abs(x) < 0.5*spacing"
[[set]]
name = "tough"
where = "(y < 3*spacing && abs(x) > 0.007) || (y > 0.004 && abs(x) < 0.003)"
[[crack]]
from = [5e-4, -1e-3]
to = [5e-4, 2e-3]
[quadrature]
volume_correction = "linear"
[material]
youngs_modulus = 70e9
[material.damage]
law = "critical_stretch"
critical = 2e-3
no_fail = ["tough"]
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["free", 0]
[solver]
mode = "path"
"""
POINT = """\
[[support]]
set = "middle"
displacement = ["free", "-2e-4*load"]
"""
ROLLER = """\
[[obstacle]]
name = "middle"
shape = "cylinder"
point = [0, PLACE]
radius = 8e-3
displacement = [0, "-2e-4*load"]
softness = 1e-4
"""
TOUCHING = ROLLER.replace("PLACE", "0.015")
APART = ROLLER.replace("PLACE", "0.01502")
# Bending closes this cut.
CUT = """\
[[crack]]
from = [-0.0055, 0.003]
to = [-0.0055, 0.008]
[[contact]]
softness = 1e-4
"""


class ContactOnPaths(Folder):
    def broken(self, name="out"):
        return [(row["first_point"], row["second_point"]) for row in table(self.folder / name / "broken_bonds.csv")]

    def judged(self, text, *changes, name="out"):
        """Columns of a run whose every state is an equilibrium of the reference, and whose ledger is closed."""
        folder = self.run_case(text, *changes, name=name)
        verification = Verification(folder, text)
        verification.run()
        self.assertEqual(verification.complaints, [])
        rows = columns(folder)
        self.assertLess(abs(rows["balance_error"]).max(), 1e-9 * rows["external_work"].max())
        self.assertLess(abs(numpy.diff(rows["numerical_work"])).max(), 0.01 * rows["external_work"].max())
        return rows
