"""Contact of points across planes of symmetry and periods: parts of bodies beside whole ones."""

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference.results import Results

# A bar that is cut in its middle, pulled and pressed.
BAR = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = MIN, max = MAX }]
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
density = 2700
[[contact]]
softness = 1e-4
"""
CUT = """\
[[crack]]
from = [0.012, -1e-3]
to = [0.012, 7e-3]
"""
LEFT = """\
[[support]]
set = "left"
displacement = ["-2e-6*load", 0]
"""
RIGHT = LEFT.replace("left", "right").replace("-2e-6", "2e-6")
TABLE = "[loading]\ntable = [0, -1, 0.5, -3, -2]\nsteps = 1\n"
BRITTLE = """\
[material.damage]
law = "critical_stretch"
critical = 2e-4
no_fail = ["left", "right"]
"""
ACROSS_X = '[[symmetry]]\naxis = "x"\nat = 0.012\n'
ACROSS_Y = '[[symmetry]]\naxis = "y"\nat = 0.003\n'
WHOLE = BAR.replace("MIN", "[0, 0]").replace("MAX", "[0.024, 0.006]")
# The two halves of a bar, which fly towards each other.
FLYING = """\
[[initial]]
velocity = ["-2e3*(x - 0.012)", "300*sin(500*(y - 0.003))"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 4e-6
"""
# Two layers of a period; the upper one slides.
LAYERS = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 2.015
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [LENGTH, 0.006] }]
[[set]]
name = "foot"
where = "y < spacing"
[[set]]
name = "top"
where = "y > 0.006 - spacing"
[material]
youngs_modulus = 70e9
[[crack]]
from = [-1, 0.003]
to = [1, 0.003]
[[contact]]
softness = 1e-3
REACH
[[period]]
axis = "x"
from = 0
to = LENGTH
gradient = [0, 0]
[[support]]
set = "foot"
displacement = [0, 0]
[[support]]
set = "top"
displacement = ["4.2e-3*load", "-0.01e-3*min(20*load, 1)"]
[loading]
steps = 42
"""
# A bar of a period, cut once in each.
ROW = """\
dimension = DIMENSION
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
SECTION
shape = [{ add = "box", min = LOW, max = HIGH }]
[[set]]
name = "middle"
where = "abs(x - 0.006) < spacing"
[material]
youngs_modulus = 70e9
[[contact]]
softness = 1e-4
"""


class ContactOfImages(Folder):
    def assert_part_of(self, part, whole, accuracy=1e-9):
        """The part's points move as those of the whole body at their places."""
        some, all_of_them = Results(part), Results(whole)
        places = {tuple(numpy.round(place, 9)): k for k, place in enumerate(all_of_them.reference)}
        numbers = [places[tuple(numpy.round(place, 9))] for place in some.reference]
        self.assertEqual(len(some.steps), len(all_of_them.steps))
        for state, other in zip(some.steps[1:], all_of_them.steps[1:]):
            size = abs(other.displacement).max()
            numpy.testing.assert_allclose(state.displacement, other.displacement[numbers], atol=accuracy * size)

    def halves(self, changes):
        upper = BAR.replace("MIN", "[0, 0.003]").replace("MAX", "[0.024, 0.006]") + ACROSS_Y
        left = BAR.replace("MIN", "[0, 0]").replace("MAX", "[0.012, 0.006]") + ACROSS_X
        both = BAR.replace("MIN", "[0, 0.003]").replace("MAX", "[0.012, 0.006]") + ACROSS_X + ACROSS_Y
        left, both = (text.replace('[[set]]\nname = "right"\nwhere = "x > 0.024 - spacing"\n', "") for text in (left, both))
        without_right = changes.replace(RIGHT, "").replace(', "right"]', "]")
        return [(upper + changes, 0.5), (left + without_right, 0.5), (both + without_right, 0.25)]

    def test_a_cut_bar_by_its_halves_and_quarter(self):
        for law in (CUT, CUT + BRITTLE):
            changes = law + LEFT + RIGHT + TABLE
            whole = self.run_case(WHOLE + changes, name="whole")
            rows = columns(whole)
            self.assertLess(rows["reaction_x:right"][1], -1.0)
            self.assertLess(abs(rows["reaction_x:right"][2]), 1e-6)  # apart
            for k, (text, share) in enumerate(self.halves(changes)):
                part = self.run_case(text, name=f"part{k}")
                self.assert_part_of(part, whole)
                mine = columns(part)
                numpy.testing.assert_allclose(mine["stored_energy"], share * rows["stored_energy"], rtol=1e-9, atol=1e-18)
                pressed = "--deformation", "0.012 + 0.97*(x - 0.012) + 0.1*(x - 0.012)*(y - 0.003)^2; 0.003 + 1.01*(y - 0.003)"
                self.assert_code(self.command("check-tangent", text, words=pressed), 0)

    def test_halves_that_fly_together(self):
        for scheme in ("verlet", "newmark"):
            changes = CUT + FLYING + f'scheme = "{scheme}"\n' + ("time_step = 5e-8\n" if scheme == "newmark" else "")
            whole = self.run_case(WHOLE + changes, name="whole")
            if scheme == "newmark":
                for k, (text, share) in enumerate(self.halves(changes)):
                    part = self.run_case(text, name=f"part{k}")
                    self.assert_part_of(part, whole, 1e-7)
                continue
            rows = columns(whole)
            for k, (text, share) in enumerate(self.halves(changes)):
                mine = columns(self.run_case(text, name=f"part{k}"))
                numpy.testing.assert_allclose(mine["kinetic_energy"][-1], share * rows["kinetic_energy"][-1], rtol=1e-3)

    def test_relaxation(self):
        changes = CUT + LEFT + RIGHT + "[loading]\ntable = [0, -1]\nsteps = 2\n"
        whole = self.run_case(WHOLE + changes, name="whole")
        for k, (text, _) in enumerate(self.halves(changes)):
            part = self.run_case(text, "solver.mode=relaxation", name=f"part{k}")
            self.assert_part_of(part, whole, 1e-3)

    def test_layers_that_slide_over_periods(self):
        once, twice = (LAYERS.replace("LENGTH", length) for length in ("0.008", "0.016"))
        self.run_case(once.replace("REACH", ""), name="short", code=3)
        self.assertIn("reach of a contact", self.ended.output + self.ended.errors)
        one = self.run_case(once.replace("REACH", "reach = 6e-3"), name="one")
        two = self.run_case(twice.replace("REACH", "reach = 6e-3"), name="two")
        self.assert_part_of(one, two, 1e-7)
        rows, of_two = columns(one), columns(two)
        self.assertGreater(abs(rows["reaction_x:top"]).max(), 1.0)
        numpy.testing.assert_allclose(2.0 * rows["reaction_x:top"], of_two["reaction_x:top"], rtol=1e-6, atol=1e-6)

    def test_a_row_that_is_pressed_over_its_period(self):
        for d, section, low, high in ((2, "thickness = 1e-3", [0, 0], [0.012, 0.004]),
                                      (3, "", [0, 0, 0], [0.012, 0.004, 0.004])):  # fmt: skip
            cracks = {2: lambda x: f"[[crack]]\nfrom = [{x}, -1]\nto = [{x}, 1]\n",
                      3: lambda x: f"[[crack]]\nvertices = [[{x}, -1, -1], [{x}, 1, -1], [{x}, 1, 1], [{x}, -1, 1]]\n"}  # fmt: skip
            zeros = ", 0" * (d - 1)
            rows = []
            for length, cuts in ((0.012, (0.0,)), (0.024, (0.0, 0.012))):
                high[0] = length
                text = ROW.replace("DIMENSION", str(d)).replace("SECTION", section).replace("LOW", str(low)).replace("HIGH", str(high))
                text += "".join(cracks[d](x) for x in cuts)
                text += f'[[period]]\naxis = "x"\nfrom = 0\nto = {length}\ngradient = ["1e-4*load"{zeros}]\n'
                text += f'[[support]]\nset = "middle"\ndisplacement = [0{zeros}]\n'
                text += "[loading]\ntable = [0, -1, 0.5, -2]\nsteps = 1\n"
                if len(cuts) == 2:  # its second half hangs on contact
                    text += f'[[set]]\nname = "second"\nwhere = "abs(x - 0.018) < spacing"\n'
                    text += f'[[support]]\nset = "second"\ndisplacement = ["1e-4*0.012*load"{zeros}]\n'
                folder = self.run_case(text, name=f"of{d}_{len(cuts)}")
                rows.append((columns(folder), folder))
            for load in (-1.0, 0.5, -2.0):
                one, two = (of["stored_energy"][of["load_factor"] == load] for of, _ in rows)
                numpy.testing.assert_allclose(2.0 * one, two, rtol=1e-9, atol=1e-18)
                self.assertEqual(one[0] > 1e-12, load < 0.0)  # apart, then pressed
