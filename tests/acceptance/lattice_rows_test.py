"""The note of check about cracks along rows of a lattice."""

import re
import unittest

from tests.acceptance.folder import Folder

BODY = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
angle = {angle}
[[lattice.shape]]
add = "box"
min = [-0.02, -0.02]
max = [0.02, 0.02]
[[crack]]
from = [-0.03, {low}]
to = [0, {end}]
[[set]]
name = "left"
where = "x < -0.017"
[[set]]
name = "right"
where = "x > 0.017"
[material]
youngs_modulus = 70e9
[material.damage]
law = "critical_stretch"
critical = 0.01
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["1e-6*load", 0]
"""
SOLID = """\
dimension = 3
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
[[lattice.shape]]
add = "box"
min = [-8e-3, -8e-3, -4e-3]
max = [8e-3, 8e-3, 4e-3]
[[crack]]
vertices = [[-0.01, {low}, -0.01], [0, 3.2e-3, -0.01], [0, 3.2e-3, 0.01], [-0.01, {low}, 0.01]]
[material]
youngs_modulus = 70e9
[material.damage]
law = "critical_stretch"
critical = 0.01
"""
HELD = """\
[[set]]
name = "left"
where = "x < -4e-3"
[[support]]
set = "left"
displacement = [0, 0, 0]
[[set]]
name = "right"
where = "x > 4e-3"
[[support]]
set = "right"
displacement = ["1e-6*load", 0, 0]
"""


def body(angle=0, low=0, end=0.0052):
    """A crack that falls by `low` over 0.03 m."""
    return BODY.format(angle=angle, low=end + low, end=end)


class LatticeRows(Folder):
    def note(self, text, *changes):
        """The line of check about rows, or nothing."""
        output = self.assert_completed(self.command("check", text, *changes)).output
        self.assertIn("bonds", output)
        lines = [line for line in output.splitlines() if re.search(r"\brows?\b.*blue_noise", line)]
        self.assertLessEqual(len(lines), 1)
        return lines[0] if lines else ""

    def test_a_crack_along_an_axis_or_a_diagonal_is_noted(self):
        # The slope of the crack is -low/0.03.
        for angle, low, is_noted in ((0, 0, True), (0, -0.0052, True), (0, -0.0054, False), (0, -0.03, True), (22.5, 0, False),
                                     (45, 0, True), (36, 0, True), (34, 0, False), (-11, 0, False), (80.5, 0, True)):  # fmt: skip
            with self.subTest(angle=angle, low=low):
                note = self.note(body(angle, low))
                self.assertEqual("crack[0]" in note, is_noted, note)

    def test_rows_are_those_of_unequal_spacings(self):
        wide = 'lattice.spacing=[2e-3, 1e-3]'
        for low, is_noted in ((-0.015, True), (-0.03, False)):  # the diagonal rises by a half
            self.assertEqual(bool(self.note(body(low=low), wide)), is_noted)

    def test_without_rows_damage_or_doubt_there_is_no_note(self):
        text = body(end=0)
        for change in ('lattice.points="blue_noise"', "lattice.perturbation=0.1", 'material.damage={law="none"}'):
            with self.subTest(change):
                self.assertEqual(self.note(text, change), "")
        # Half of the body: in its plane of symmetry the crack can't turn.
        half = text.replace("min = [-0.02, -0.02]", "min = [-0.02, 0]")
        self.assertEqual(self.note(half + '[[symmetry]]\naxis = "y"\n'), "")
        self.assertNotEqual(self.note(half.replace("0]\nto = [0, 0]", "2.2e-3]\nto = [0, 2.2e-3]") + '[[symmetry]]\naxis = "y"\n'), "")

    def test_cracks_are_listed_in_one_line(self):
        second = "[[crack]]\nfrom = [0.03, 0.0122]\nto = [5e-3, 0.0122]\n[[crack]]\nfrom = [0.03, 0]\nto = [5e-3, -0.0125]\n"
        note = self.note(body() + second)
        self.assertIn("crack[0], crack[1]: ", note)
        self.assertNotIn("crack[2]", note)

    def test_planes_of_a_solid_are_noted(self):
        for low, is_noted in ((0, True), (-0.005, False), (-0.01, True)):
            text = SOLID.format(low=3.2e-3 + low) + HELD
            self.assertEqual(bool(self.note(text)), is_noted, low)

    def test_a_run_does_not_repeat_it(self):
        self.run_case(body())
        self.assertNotIn("blue_noise", self.ended.output + self.ended.errors)


if __name__ == "__main__":
    unittest.main()
