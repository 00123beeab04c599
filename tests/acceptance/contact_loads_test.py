"""Contacts where the load is found: by a control, and along the arc length."""

import pathlib

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.results import Results
from tests.reference.verify import Verification
from tests.same_results import differences

CASES = pathlib.Path(__file__).resolve().parents[2] / "cases"
# A bar with an edge crack 1e-6 m open, which closes when it is pressed.
NOTCHED = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.024, 0.006] }]
[[set]]
name = "left"
where = "x < spacing"
[[set]]
name = "right"
where = "x > 0.024 - spacing"
[quadrature]
volume_correction = "linear"
[material]
youngs_modulus = 70e9
[[crack]]
from = [0.012, -1e-3]
to = [0.012, 3e-3]
[[contact]]
softness = 1e-4
distance = 0.9995e-3
[[support]]
set = "left"
displacement = [0, 0]
[[load]]
set = "right"
total_force = ["-20*load", 0]
[[probe]]
name = "right"
set = "right"
field = "displacement"
"""
CONTROL = """\
[[control]]
set = "right"
weights = [-1, 0]
"""
# A block whose foot moves against a cylinder that touches two of its points, or that a plane presses on.
HERTZ = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [-0.012, -0.010], max = [0.012, 0] }]
[[set]]
name = "foot"
where = "y < -0.010 + 2*spacing"
[[set]]
name = "top"
where = "y > -spacing && abs(x) < spacing"
[material]
youngs_modulus = 70e9
[[support]]
set = "foot"
displacement = [0, "1e-4*load"]
[[obstacle]]
name = "punch"
shape = "cylinder"
point = [0, PLACE]
radius = 0.080
softness = 1e-4
"""
TOUCHING = HERTZ.replace("PLACE", repr(float(numpy.sqrt(0.0805**2 - 0.5e-3**2) - 0.5e-3)))
APART = HERTZ.replace("PLACE", "0.08002")
PRESSED = TOUCHING.replace('"1e-4*load"', "0").split("[[obstacle]]")[0] + """\
[[obstacle]]
name = "punch"
shape = "plane"
set = "top"
point = [0, 0]
normal = [0, -1]
displacement = [0, "-4e-5*load"]
softness = 1e-4
"""
INDENTED = """\
[[control]]
set = "foot"
weights = [0, 1]
[[control]]
set = "top"
weights = [0, -1]
"""
SUNK = """\
[[control]]
set = "top"
weights = [0, -1]
"""
# Onto this plane the shipped arch snaps through: its middle meets it where the arch is unstable.
ARCH = (CASES / "buckling/arch.toml").read_text().replace('file = "arch.csv"', f'file = "{CASES / "buckling/arch.csv"}"')
GROUND = """\
[[obstacle]]
name = "ground"
shape = "plane"
point = [0, -0.04]
normal = [0, 1]
softness = 1e-3
"""


def steps(*values):
    return f"[loading]\ntable = {list(values)}\nsteps = 1\n"


def mode(name):
    return f'[solver]\nmode = "{name}"\n'


class LoadsThatAreFound(Folder):
    def assert_same_states(self, found, text, case_of_load, accuracy=1e-7):
        """Newton's method finds the same states at the loads of a folder."""
        rows, states = columns(found), Results(found).steps
        loads = rows["load_factor"][1:]
        self.assertGreater(len(loads), 2)
        again = self.run_case(text + steps(0, *loads), name="again")
        at_loads = columns(again)
        for state, other in zip(states[1:], Results(again).steps[1:], strict=True):
            size = abs(other.displacement).max()
            numpy.testing.assert_allclose(state.displacement, other.displacement, atol=accuracy * size)
        for name in case_of_load:
            numpy.testing.assert_allclose(rows[name][1:], at_loads[name][1:], rtol=10 * accuracy, atol=1e-9)

    def test_a_control_finds_the_load_of_a_closed_crack(self):
        text = NOTCHED + CONTROL + steps(0, 2e-7, 5e-7, 2e-6, 4e-6, 3e-7, -1e-6)
        folder = self.run_case(text)
        rows = columns(folder)
        numpy.testing.assert_allclose(-rows["right_x"], rows["control"], atol=1e-15)
        self.assertLessEqual(rows["newton_iterations"].max(), 7)
        stiffness = rows["load_factor"][1:] / rows["control"][1:]
        self.assertGreater(stiffness[3] / stiffness[0], 1.1)  # closed
        self.assertAlmostEqual(stiffness[-1] / stiffness[0], 1.0, delta=0.01)  # open again
        self.assert_same_states(folder, NOTCHED, ["stored_energy"])

    def test_a_control_finds_the_load_of_an_obstacle(self):
        for text, control in ((TOUCHING, INDENTED), (PRESSED, SUNK)):
            folder = self.run_case(text + control + steps(0, 5e-6, 2e-5, 4e-5, 1e-5), name="found" + control[20:23])
            rows = columns(folder)
            self.assertGreater(abs(rows["reaction_y:punch"]).max(), 100.0)
            self.assertLessEqual(rows["newton_iterations"].max(), 7)
            self.assert_same_states(folder, text, ["stored_energy", "reaction_y:punch"])

    def test_along_the_arc_through_the_closing_of_a_gap(self):
        folder = self.run_case(NOTCHED + mode("arc_length"), "loading.steps=10")
        rows = columns(folder)
        self.assertEqual(rows["load_factor"][-1], 1.0)
        self.assertFalse((rows["negative_pivots"] > 0).any())
        self.assert_same_states(folder, NOTCHED, ["stored_energy"])

    def test_along_the_arc_against_an_obstacle(self):
        for k, text in enumerate((TOUCHING, APART, PRESSED)):
            folder = self.run_case(text + mode("arc_length"), "loading.steps=5", name=f"arc{k}")
            rows = columns(folder)
            self.assertEqual(rows["load_factor"][-1], 1.0)
            self.assertGreater(abs(rows["reaction_y:punch"]).max(), 100.0)
            self.assert_same_states(folder, text, ["stored_energy", "reaction_y:punch"])

    def test_an_arch_that_snaps_onto_an_obstacle(self):
        free, stopped = (self.run_case(ARCH + ground, "arc_length.steps=40", name=f"arch{len(ground)}") for ground in ("", GROUND))
        verification = Verification(stopped, ARCH + GROUND)
        verification.run()
        self.assertEqual(verification.complaints, ["completed, but not at its end"])  # after its steps
        path, rows = columns(free), columns(stopped)
        touches = rows["reaction_y:ground"] > 0.0
        self.assertGreater(touches.sum(), 5)
        self.assertTrue(rows["negative_pivots"][~touches].any())
        self.assertFalse(rows["negative_pivots"][touches].any())
        # The load falls until the arch touches, and rises again while its middle stays.
        first = numpy.argmax(touches)
        self.assertLess(rows["load_factor"][first - 1], 0.46)
        self.assertTrue((numpy.diff(rows["load_factor"][first:]) > 0.0).all())
        self.assertLess(numpy.ptp(rows["middle_y"][first:]), 1e-4)
        # Before it touches it goes the way of the free arch.
        order = numpy.argsort(-path["middle_y"])
        along = numpy.interp(-rows["middle_y"][:first], -path["middle_y"][order], path["load_factor"][order])
        self.assertLess(abs(along - rows["load_factor"][:first]).max(), 0.01)

    def test_resumed(self):
        text = NOTCHED + mode("arc_length") + "[loading]\nsteps = 10\n"
        whole = self.run_case(text, name="whole")
        self.run_case(text, name="split", words=("--stop-after", 2), code=130)
        self.resume("split")
        self.assertEqual(differences(whole, self.folder / "split"), [])

    def test_refused(self):
        away = PRESSED.replace("point = [0, 0]", "point = [0, 1e-5]")
        self.assertIn("from the start", self.refusal(away + mode("arc_length")))
        self.assertIn("from the start", self.refusal(away + SUNK + steps(0, 1e-6)))
        for found in (mode("arc_length"), INDENTED + steps(0, 1e-6)):
            self.assertIn("friction", self.refusal(TOUCHING.replace("softness", "friction = 0.1\nsoftness") + found))
