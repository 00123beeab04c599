"""Contact of points on several ranks: results of one rank, resumed runs, and what is refused."""

import h5py
import numpy

from tests.acceptance.contact_images_test import ACROSS_Y, BAR, LAYERS, LEFT, RIGHT, TABLE
from tests.acceptance.contact_images_test import CUT as CUT_OF_HALVES
from tests.acceptance.contact_test import BRITTLE, CUT, FLYING, FRAGMENTS, HEAD, IN_SPACE, PRESSED
from tests.acceptance.motions import columns
from tests.acceptance.on_ranks import Comparison, on
from tests.same_results import differences

# Two blocks a centimetre apart, which parts of the body do not see of one another.
APART = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.010, 0.008] }, { add = "box", min = [0.020, 0], max = [0.030, 0.008] }]
[[set]]
name = "left"
where = "x < 0.015"
[[set]]
name = "right"
where = "x > 0.015"
[material]
model = "bond"
youngs_modulus = 70e9
density = 2700
[[contact]]
softness = 1e-5
"""
COLLIDES = """\
[[initial]]
set = "right"
velocity = [-400, 30]
[solver]
mode = "dynamics"
[dynamics]
end_time = 4e-5
[output]
every = 50
"""
DRIVEN = """\
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["-WAY*load", 0]
[loading]
steps = STEPS
"""
HELD = """\
[[set]]
name = "wall"
where = "x < spacing"
[[support]]
set = "wall"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["-0.01001*load", 0]
[loading]
steps = 4
"""
OPENS = PRESSED.replace("[0, -1, 0.5, -3, -2]", "[0, 2, -1]").replace("[loading]", "[loading]\nsteps = 20")
MODES = {
    "newton": HEAD + CUT + PRESSED,
    "in space": IN_SPACE,
    "adaptive": HEAD + BRITTLE.replace(CUT, "") + "[[contact]]\nsoftness = 1e-5\n" + OPENS + '[solver]\nmode = "adaptive"\n',
    "relaxation": HEAD + CUT + PRESSED + '[solver]\nmode = "relaxation"\n',
    "explicit": HEAD + CUT + FLYING,
    "explicit, torn": HEAD + BRITTLE + FLYING,
    "implicit": HEAD + CUT + FLYING + 'scheme = "newmark"\ntime_step = 5e-8\n',
}


class RanksContactTest(Comparison):
    def assert_alike(self, one, several, accuracy):
        expected, found = columns(one), columns(several)
        for name in ("broken_bonds", "load_factor", "time"):
            if name in expected:
                numpy.testing.assert_allclose(found[name], expected[name], rtol=0 if name == "broken_bonds" else 1e-9, err_msg=name)
        names = [name for name in expected if name.startswith(("reaction", "stored_energy", "kinetic_energy"))]
        self.assertGreater(len(names), 0)
        for name in names:
            kind = name.split("_")[0]
            size = max(abs(expected[other]).max() for other in names if other.startswith(kind))
            numpy.testing.assert_allclose(found[name], expected[name], rtol=0, atol=accuracy * size, err_msg=name)
        with h5py.File(one / "results.h5") as file, h5py.File(several / "results.h5") as other:
            for field in ("displacement", "contact_pressure"):
                largest = max(abs(step[field][...]).max() for step in file["steps"].values())
                self.assertTrue(largest > 0 or field == "contact_pressure")  # parts that fly may not touch in any written step
                for step in file["steps"]:
                    values, too = (of["steps"][step][field][...] for of in (file, other))
                    numpy.testing.assert_allclose(too, values, rtol=0, atol=accuracy * largest, err_msg=field)
            broken, too = (
                sorted(zip(*(of["broken_bonds"][name][...].tolist() for name in ("step", "first_point", "second_point"))))
                for of in (file, other)
            )
            self.assertEqual(too, broken)

    def expect_alike(self, text, *changes, ranks=(2, 3), accuracy=1e-8):
        one, *others = self.run_on_each((1, *ranks), text, *changes)
        for other in others:
            self.assert_alike(one, other, accuracy)
        return columns(one)

    def test_modes(self):
        for mode, text in MODES.items():
            with self.subTest(mode):
                self.expect_alike(text, ranks=(2, 4) if mode == "newton" else (3,))

    def test_models_that_lose_bonds(self):
        """Some losses are decided on one rank and told to others, whose contacts take them over."""
        text = IN_SPACE.replace("6e-3, -1e-3]", "3e-3, -1e-3]").replace("6e-3, 6e-3]", "3e-3, 6e-3]")
        text = text.replace("[0, -1, 0.5, -3]", "[0, 1, -1]") + '[material.damage]\nlaw = "tanh"\nonset = 4e-4\ncritical = 2e-2\nrate = 3\n'
        for model in ("state", "cpd"):
            rows = self.expect_alike(text, f"material.model={model}", "material.poisson_ratio=0.3",
                                     "lattice.horizon_ratio=2.015", ranks=(3,))  # fmt: skip
            self.assertGreater(abs(rows["dissipated_energy"]).max(), 0)

    def test_ranks_without_points(self):
        text = HEAD.replace("[0.024, 0.006]", "[0.004, 0.002]").replace("0.024", "0.004").replace("0.012", "0.002")
        rows = self.expect_alike(text + CUT.replace("0.012", "0.002") + PRESSED, ranks=(10,))
        self.assertLess(rows["reaction_x:right_end"][-1], -1.0)

    def test_fragments_that_are_pushed_together_and_apart(self):
        # Round-off grows with every collision.
        rows = self.expect_alike(FRAGMENTS, "dynamics.end_time=3e-5", accuracy=1e-6)
        self.assertGreater(abs(rows["stored_energy"]).max(), 1e-3 * rows["kinetic_energy"][0])

    def test_images(self):
        bar = BAR.replace("MIN", "[0, 0.003]").replace("MAX", "[0.024, 0.006]") + ACROSS_Y
        self.expect_alike(bar + CUT_OF_HALVES + LEFT + RIGHT + TABLE)
        self.expect_alike(LAYERS.replace("LENGTH", "0.008").replace("REACH", "reach = 6e-3"), "loading.steps=21",
                          ranks=(2,), accuracy=1e-6)  # fmt: skip
        ended, _ = self.ended_on(2, LAYERS.replace("LENGTH", "0.008").replace("REACH", ""))
        self.assert_code(ended, 3)
        self.assertIn("reach of a contact", ended.output + ended.errors)

    def test_parts_that_were_far_from_each_other(self):
        text = APART + COLLIDES
        ended, folder = self.ended_on(2, text)
        self.assert_code(ended, 3)
        self.assertIn("points of other ranks", ended.output + ended.errors)
        self.assertGreater(columns(folder)["time"][-1], 1.5e-5)  # until they meet
        rows = self.expect_alike(text, "contact[0].reach=0.02", accuracy=1e-7)
        self.assertGreater(rows["stored_energy"].max(), 1e-2 * rows["kinetic_energy"][0])

    def test_nothing_passes_through_in_one_long_step(self):
        for way, steps in ((0.05, 1), (0.012, 2)):
            text = APART + DRIVEN.replace("WAY", str(way)).replace("STEPS", str(steps))
            for changes in ((), ("contact[0].reach=0.06",)):
                ended, _ = self.ended_on(2, text, *changes)
                self.assert_code(ended, 3)
                self.assertIn("degenerate", ended.output + ended.errors)

    def test_blocks_that_meet(self):
        rows = self.expect_alike(APART + HELD, "contact[0].reach=0.015")
        self.assertLess(rows["reaction_x:right"][-1], -1.0)
        self.assertEqual(self.ended_on(2, APART + HELD)[0].code, 3)

    def test_resumed_runs(self):
        flies = FLYING + "[output]\nevery = 20\n"
        for text, steps in ((HEAD + CUT + PRESSED, 2), (HEAD + BRITTLE + flies, 2), (MODES["adaptive"], 12)):
            self.run_case(text, name="whole", words=on(2))
            self.run_case(text, name="part", words=(*on(2), "--stop-after", steps), code=130)
            self.resume_on(2, "part")
            different = set(differences(self.folder / "whole", self.folder / "part"))
            self.assertEqual(different - {"summary.json steps"}, set())  # of a motion, those of this process
        self.run_case(HEAD + CUT + PRESSED, name="others", words=(*on(3), "--stop-after", 2), code=130)
        self.resume_on(2, "others")
        self.assert_alike(self.run_case(HEAD + CUT + PRESSED, name="one"), self.folder / "others", 1e-8)

    def test_refused(self):
        text = HEAD + CUT + PRESSED
        faces, rubs = self.refusals((2, text, "contact[0].shape=faces"), (2, text, "contact[0].friction=0.3"))
        self.assertIn("contact[0].shape", faces)
        self.assertIn("contact[0].friction", rubs)
        for refusal in (faces, rubs):
            self.assertIn("more than one rank", refusal)
