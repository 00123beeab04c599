"""Contact of points, from the command line: beside an independent reference, closed forms, and what is refused."""

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.motions import columns
from tests.reference import stress
from tests.reference.results import Results
from tests.reference.verify import Verification
from tests.same_results import differences

HEAD = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.024, 0.006] }]
[[set]]
name = "left"
where = "x < 0.012"
[[set]]
name = "right"
where = "x > 0.012"
[[set]]
name = "left_end"
where = "x < spacing"
[[set]]
name = "right_end"
where = "x > 0.024 - spacing"
[quadrature]
volume_correction = "linear"
[material]
model = "bond"
youngs_modulus = 70e9
density = 2700
"""
CUT = """\
[[crack]]
from = [0.012, -1e-3]
to = [0.012, 7e-3]
[[contact]]
softness = 1e-5
"""
PRESSED = """\
[[support]]
set = "left_end"
displacement = [0, 0]
[[support]]
set = "right_end"
displacement = ["1e-5*load", "2e-6*load"]
[loading]
table = [0, -1, 0.5, -3, -2]
"""
BRITTLE = CUT + '[material.damage]\nlaw = "critical_stretch"\ncritical = 2e-4\nno_fail = ["left_end", "right_end"]\n'
FLYING = """\
[[initial]]
set = "left"
velocity = [10, 0]
[[initial]]
set = "right"
velocity = [-10, 0]
[solver]
mode = "dynamics"
[dynamics]
end_time = 1.4e-5
"""
IN_SPACE = """\
dimension = 3
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
shape = [{ add = "box", min = [0, 0, 0], max = [0.012, 0.005, 0.005] }]
[[set]]
name = "left_end"
where = "x < 2*spacing"
[[set]]
name = "right_end"
where = "x > 0.012 - 2*spacing"
[material]
model = "bond"
youngs_modulus = 70e9
[[crack]]
vertices = [[0.006, -1e-3, -1e-3], [0.006, 6e-3, -1e-3], [0.006, 6e-3, 6e-3], [0.006, -1e-3, 6e-3]]
[[contact]]
softness = 1e-5
[[support]]
set = "left_end"
displacement = [0, 0, 0]
[[support]]
set = "right_end"
displacement = ["1e-5*load", "2e-6*load", 0]
[loading]
table = [0, -1, 0.5, -3]
"""
# A block hits a layer two points thick at 0.6 of the wave speed.
LAYER = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.010, 0.012] }, { add = "box", min = [0.011, 0], max = [0.013, 0.012] }]
[[set]]
name = "block"
where = "x < 0.0105"
[[crack]]
from = [0.0105, -1e-3]
to = [0.0105, 13e-3]
[material]
youngs_modulus = 70e9
density = 2700
[[contact]]
[[initial]]
set = "block"
velocity = [3055, 0]
[solver]
mode = "dynamics"
[dynamics]
end_time = 2e-6
[output]
every = 1
"""
CUTS = "".join(
    f"[[crack]]\nfrom = {begin}\nto = {end}\n"
    for begin, end in [([x, -1e-3], [x, 26e-3]) for x in (0.006, 0.012, 0.018)]
    + [([-1e-3, y], [25e-3, y]) for y in (0.005, 0.010, 0.015, 0.020)]
)
FRAGMENTS = f"""\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
shape = [{{ add = "box", min = [0, 0], max = [0.024, 0.025] }}]
{CUTS}[material]
youngs_modulus = 70e9
density = 2700
[[contact]]
[[initial]]
velocity = ["200*sin(900*y) - 2e4*(x - 0.012)", "200*sin(1100*x + 1) - 2e4*(y - 0.0125)"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 6e-5
[output]
every = 20
"""


class ContactTest(Folder):
    def assert_verified(self, text, folder):
        verification = Verification(folder, text)
        verification.run()
        self.assertEqual(verification.complaints, [])

    def test_every_state_is_an_equilibrium_of_the_reference(self):
        for law in (CUT, CUT + "stiffness = 3.0\ndepth = 0.2\ndistance = 0.999e-3\n"):
            text = HEAD + law + PRESSED
            folder = self.run_case(text)
            self.assert_verified(text, folder)
            rows = columns(folder)
            self.assertLess(rows["reaction_x:right_end"][1], -1.0)  # pressed
            self.assertLess(abs(rows["reaction_x:right_end"][2]), 1e-6)  # apart
            self.assertLessEqual(rows["newton_iterations"].max(), 6)

    def test_beside_a_rigid_set(self):
        platen = '[[rigid]]\nset = "right_end"\ncentre = [0.0235, 0.003]\ndisplacement = ["1e-5*load", "2e-6*load"]\n'
        head, tail = PRESSED.split('[[support]]\nset = "right_end"')
        text = HEAD + CUT + head + platen + 'rotation = ["1e-3*load"]\n[loading]' + tail.split("[loading]")[1]
        self.assert_verified(text, self.run_case(text))
        self.assert_code(self.command("check-tangent", text), 0)

    def test_a_closed_cut_is_nearly_as_stiff_as_the_whole_bar(self):
        steps = '[loading]\nsteps = 1\n'
        pressed = PRESSED.split("[loading]")[0].replace("1e-5*load", "-1e-5*load").replace('"2e-6*load"', "0") + steps
        force = [columns(self.run_case(HEAD + cut + pressed))["reaction_x:right_end"][1] for cut in (CUT, "")]
        # The faces of the cut add 2.65 spacings of bar (volumes "linear", three spacings): 24 / (24 - 2 + 2.65) and
        # less, as the supports hold a row at each end.
        self.assertGreater(force[0] / force[1], 0.88)
        self.assertLess(force[0] / force[1], 0.93)

    def test_broken_bonds_close_again(self):
        text = HEAD + BRITTLE.replace(CUT, "") + "[[contact]]\nsoftness = 1e-5\n" + PRESSED.replace(
            "[0, -1, 0.5, -3, -2]", "[0, 2, -1]") + '[solver]\nmode = "adaptive"\n'
        text = text.replace("[loading]\n", "[loading]\nsteps = 20\n")
        folder = self.run_case(text)
        self.assert_verified(text, folder)
        rows = columns(folder)
        self.assertGreater(rows["broken_bonds"][-1], 50)
        self.assertLess(rows["reaction_x:right_end"][-1], -5.0)
        without = self.run_case(text.replace("[[contact]]\nsoftness = 1e-5\n", ""), name="without")
        self.assertGreater(columns(without)["reaction_x:right_end"][-1], -1.0)

    def test_bonds_that_close(self):
        text = HEAD + BRITTLE.replace(CUT, "") + 'compression = "kept"\n' + PRESSED.replace(
            "[0, -1, 0.5, -3, -2]", "[0, 2, -1]") + '[solver]\nmode = "adaptive"\n'
        text = text.replace("[loading]\n", "[loading]\nsteps = 20\n").replace('"2e-6*load"', "0")
        folder = self.run_case(text)
        self.assert_verified(text, folder)
        rows = columns(folder)
        torn = text.replace('compression = "kept"\n', "")
        self.assertGreater(rows["broken_bonds"][-1], 50)
        whole = torn.replace("critical = 2e-4", "critical = 2.0").replace('mode = "adaptive"', 'mode = "newton"')
        force = [columns(self.run_case(of, name="other"))["reaction_x:right_end"][-1] for of in (whole, torn)]
        # Closed, the bar is nearly the whole one; Poisson's effect stretches a few bonds across it.
        self.assertGreater(rows["reaction_x:right_end"][-1] / force[0], 0.95)
        self.assertLess(rows["reaction_x:right_end"][-1] / force[0], 1.0 + 1e-9)
        self.assertLess(force[1] / force[0], 0.2)
        for change, words in {"solver.mode=path": "mode path", "material.model=state": "compression"}.items():
            self.assertIn(words, self.refusal(text, change, *(["material.poisson_ratio=0.3"] if "state" in change else [])))
        self.assertIn("one of the two", self.refusal(text + "[[contact]]\nstiffness = 1.0\n"))

    def test_resumed_runs_and_threads(self):
        text = HEAD + CUT + PRESSED
        whole = self.run_case(text)
        self.run_case(text, "loading.table=[0, -1, 0.5]", name="part")
        self.resume("part", "loading.table=[0, -1, 0.5, -3, -2]")
        self.assertEqual(differences(whole, self.folder / "part"), [])
        two = columns(self.run_case(text, name="two", threads=2))
        one = columns(whole)
        numpy.testing.assert_allclose(two["stored_energy"], one["stored_energy"], rtol=1e-9, atol=1e-20)

    def test_a_bar_in_space_and_its_stress(self):
        text = IN_SPACE + "[output]\nstress = true\n"
        folder = self.run_case(text)
        self.assert_verified(text, folder)
        verification = Verification(folder, text)
        mechanics, last = verification.mechanics, verification.results.steps[-1]
        with h5py.File(folder / "results.h5") as file:
            written = list(file["steps"].values())[-1]["first_piola_stress"][...]
        for has_contact in (True, False):
            if not has_contact:
                mechanics.contact = None
            right = stress.fields(mechanics, last.displacement, mechanics.no_history())["first_piola_stress"]
            error = abs(written - right.reshape(written.shape)).max() / abs(written).max()
            self.assertEqual(error < 1e-11, has_contact, error)

    def test_models(self):
        for model in ("state", "cpd"):
            changes = f"material.model={model}", "material.poisson_ratio=0.3", "lattice.horizon_ratio=2.015"
            rows = columns(self.run_case(IN_SPACE, *changes, name=model))
            self.assertLess(rows["reaction_x:right_end"][-1], -1.0)
            self.assertLess(abs(rows["reaction_x:right_end"][2]), 1e-6)
            self.assertLessEqual(rows["newton_iterations"].max(), 6)
            ended = self.command("check-tangent", IN_SPACE, *changes)
            self.assert_code(ended, 0)

    def test_a_thin_layer_is_not_passed(self):
        results = Results(self.run_case(LAYER))
        block = results.reference[:, 0] < 0.0105
        nearest = min(
            numpy.linalg.norm(place[block][:, None] - place[~block], axis=2).min()
            for place in (results.reference + step.displacement for step in results.steps)
        )
        self.assertGreater(nearest, 0.75e-3)
        self.assertLess(nearest, 0.85e-3)
        rows = columns(results.folder)
        numpy.testing.assert_allclose(rows["kinetic_energy"] + rows["stored_energy"], rows["kinetic_energy"][0], rtol=1e-2)

    def test_fragments_that_are_pushed_together_and_apart(self):
        results = Results(self.run_case(FRAGMENTS))
        piece = results.reference[:, 0] // 0.006 * 10 + results.reference[:, 1] // 0.005
        others = piece[:, None] != piece
        nearest = min(
            numpy.linalg.norm(place[:, None] - place, axis=2)[others].min()
            for place in (results.reference + step.displacement for step in results.steps)
        )
        self.assertGreater(nearest, 0.75e-3)
        self.assertLess(nearest, 0.95e-3)
        rows = columns(results.folder)
        numpy.testing.assert_allclose(rows["momentum_x"], rows["momentum_x"][0], rtol=1e-12)
        numpy.testing.assert_allclose(rows["kinetic_energy"] + rows["stored_energy"], rows["kinetic_energy"][0], rtol=1e-2)

    def test_bars_that_collide_part_again(self):
        for scheme, energy in (("verlet", 1e-2), ("newmark", 1e-2)):
            step = "time_step = 5e-8\n" if scheme == "newmark" else ""
            text = HEAD + CUT.replace("softness = 1e-5", 'set = "left"\nwith = "right"') + FLYING
            text += f'scheme = "{scheme}"\n{step}'
            rows = columns(self.run_case(text, name=scheme))
            mass = 2700 * 0.024 * 0.006 * 1e-3
            self.assertLess(abs(rows["momentum_x"]).max(), 1e-12 * mass * 10)
            numpy.testing.assert_allclose(rows["modified_energy"], 0.5 * mass * 100, rtol=energy)
            # After 2 l / c = 4.7e-6 s and the passage of the faces the halves fly apart with nearly all of the speed.
            self.assertGreater(rows["kinetic_energy"][-1], 0.9 * 0.5 * mass * 100)

    def test_nothing_passes_through_in_one_long_step(self):
        text = HEAD + CUT + PRESSED.replace("1e-5*load", "2e-2*load").replace("[0, -1, 0.5, -3, -2]", "[0, -1]")
        self.run_case(text, code=3)
        self.assertIn("degenerate", self.ended.output + self.ended.errors)

    def test_refused(self):
        text = HEAD + CUT + PRESSED
        for change, words in {
            "contact[0].depth=0.9": "depth",
            "contact[0].stiffness=0": "stiffness",
            "contact[0].softness=0.2": "softness",
            "contact[0].distance=1": "distance",
            "contact[0].with=left": "needs the other set",
            "contact[0].set=nowhere": "nowhere",
            "material.kinematics=linear": "contact",
            "solver.tangent=matrix_free": "[[contact]]",
        }.items():
            self.assertIn(words, self.refusal(text, change))
        overlapping = text.replace("[[contact]]", '[[contact]]\nset = "left"\n[[contact]]')
        self.assertIn("in common with another contact", self.refusal(overlapping))
        shared = text.replace("[[contact]]", '[[contact]]\nset = "left"\nwith = "left_end"')
        self.assertIn("shares points", self.refusal(shared))

    def test_tangent(self):
        ended = self.command("check-tangent", HEAD + CUT + PRESSED)
        self.assert_code(ended, 0)
