"""Contact and obstacles in mode path: contacts close, press and open between one breaking bond and the next."""

import json

import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.contact_test import BRITTLE, CUT as CUT_BAR, HEAD, PRESSED
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
displacement = ["free", "-6e-5*load"]
"""
ROLLER = """\
[[obstacle]]
name = "middle"
shape = "cylinder"
point = [0, PLACE]
radius = 8e-3
displacement = [0, "-6e-5*load"]
softness = 1e-4
"""
TOUCHING = ROLLER.replace("PLACE", "0.015")
APART = ROLLER.replace("PLACE", "0.01502")
PUNCH = """\
[[obstacle]]
name = "middle"
shape = "plane"
set = "middle"
point = [0, 0.007]
normal = [0, -1]
displacement = [0, "-6e-5*load"]
softness = 1e-4
"""
# A dead load on the beam, and a ground below it.
DEAD = """\
[[load]]
set = "middle"
total_force = [0, "-300*load"]
"""
GROUND = """\
[[set]]
name = "low"
where = "y < spacing && abs(x) < 0.003"
[[obstacle]]
name = "ground"
shape = "plane"
set = "low"
point = [0, -4e-5]
normal = [0, 1]
softness = 1e-4
"""
# Bending closes this cut.
CUT = """\
[[crack]]
from = [-0.0055, 0.003]
to = [-0.0055, 0.008]
[[contact]]
softness = 1e-4
"""
# A bar that is torn, pressed, pulled and pressed again.
TORN = HEAD + BRITTLE.replace(CUT_BAR, "[[contact]]\nsoftness = 1e-5\n")
TORN += PRESSED.replace("[0, -1, 0.5, -3, -2]", "[0, 2, -1, 2.5, -1]")
TORN += '[solver]\nmode = "path"\n'
# A bar in space with an edge crack, pulled, pressed and pulled again.
IN_SPACE = """\
dimension = 3
[lattice]
spacing = 1e-3
horizon_ratio = 2.015
shape = [{ add = "box", min = [0, 0, 0], max = [0.010, 0.005, 0.003] }]
[[set]]
name = "left_end"
where = "x < 2*spacing"
[[set]]
name = "right_end"
where = "x > 0.010 - 2*spacing"
[[crack]]
vertices = [[0.005, -1e-3, -1e-3], [0.005, 2.2e-3, -1e-3], [0.005, 2.2e-3, 4e-3], [0.005, -1e-3, 4e-3]]
[material]
youngs_modulus = 70e9
[material.damage]
law = "critical_stretch"
critical = 2e-3
no_fail = ["left_end", "right_end"]
[[contact]]
softness = 1e-4
[[support]]
set = "left_end"
displacement = [0, 0, 0]
[[support]]
set = "right_end"
displacement = ["2e-5*load", "2e-6*load", 0]
[loading]
table = [0, 1, -1, 0.5]
[solver]
mode = "path"
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
        return rows

    def test_an_obstacle_loads_a_beam_like_a_point(self):
        """It touches one point, and stands for it and the half cell in front of it. So the path is the same, at other
        displacements of the obstacle; a roller pushes to the side, too, where the beam tilts."""
        point = self.judged(BEAM + POINT, name="point")
        for name, text, accuracy in (("punch", PUNCH, 1e-6), ("touching", TOUCHING, 1e-2), ("apart", APART, 1e-2)):
            with self.subTest(name):
                rows = self.judged(BEAM + text, name=name)
                self.assertGreater((numpy.diff(rows["load_factor"]) < 0).sum(), 5)  # snaps back
                count = int(min(of["broken_bonds"][-1] for of in (rows, point)))
                self.assertGreater(count, 15)
                for number in range(count):
                    forces = [
                        of["reaction_y:middle"][numpy.flatnonzero(of["broken_bonds"] == number)[-1]] for of in (rows, point)
                    ]
                    self.assertAlmostEqual(forces[0] / forces[1], 1.0, delta=accuracy)
                self.assertEqual(self.broken(name)[:count], self.broken("point")[:count])
                self.assertLess(abs(numpy.diff(rows["numerical_work"])).max(), 1e-3 * rows["external_work"].max())
        self.assertEqual(len(self.corners("apart")), 1)

    def corners(self, name="out"):
        return [row for row in table(self.folder / name / "decisions.csv") if "closes or opens" in row["reason"]]

    def test_a_cut_that_stays_pressed_while_bonds_break(self):
        text = BEAM + CUT + TOUCHING
        rows = self.judged(text)
        whole = self.judged(BEAM + TOUCHING, name="whole")
        open_cut = self.run_case(text.split("[[contact]]")[0] + TOUCHING, name="open")
        first = [of["reaction_y:middle"][1] / of["load_factor"][1] for of in (rows, whole, columns(open_cut))]
        # Closed, the cut costs hardly any stiffness; open, it is a notch.
        self.assertGreater(first[0] / first[1], 0.93)
        self.assertLess(first[2] / first[1], 0.85)
        self.assertGreater(rows["broken_bonds"][-1], 10)
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertLess(summary["factorisations"], 12 * summary["steps"])

    def test_it_goes_on_from_any_step_as_if_nothing_had_been(self):
        for k, text in enumerate((BEAM + CUT + TOUCHING, TORN)):
            whole = self.run_case(text, name=f"whole{k}")
            last = json.loads((whole / "summary.json").read_text())["steps"]
            for stop in (2, last // 2, last - 2):
                with self.subTest(case=k, stop=stop):
                    name = f"split{k} {stop}"
                    self.run_case(text, name=name, words=("--stop-after", stop), code=130)
                    self.resume(name)
                    self.assertEqual(differences(whole, self.folder / name), [])

    def test_a_bar_that_is_torn_and_pressed(self):
        rows = self.judged(TORN)
        self.assertGreaterEqual(len(self.corners()), 2)
        ends = {stage: numpy.argmax(rows["stage"] == stage) for stage in (1.0, 2.0, 3.0, 4.0)}
        force = rows["reaction_x:right_end"]
        self.assertLess(force[ends[2.0]], -100.0)
        self.assertLess(abs(force[ends[3.0]]), 0.02 * abs(force[ends[2.0]]))
        # Nothing has broken since, so the state is the same.
        self.assertEqual(rows["broken_bonds"][ends[2.0]], rows["broken_bonds"][ends[4.0]])
        self.assertAlmostEqual(force[ends[4.0]] / force[ends[2.0]], 1.0, delta=1e-8)
        self.assertAlmostEqual(rows["stored_energy"][ends[4.0]] / rows["stored_energy"][ends[2.0]], 1.0, delta=1e-8)
        # In between, the work of pressing and of letting go is that of an elastic body.
        error = abs(numpy.diff(rows["numerical_work"]))[ends[1.0] :].max()
        self.assertLess(error, 1e-3 * rows["stored_energy"].max())

    def test_the_ground_stops_an_avalanche(self):
        """The load is held where the first bond breaks, as the path would have to go back behind an entry of the table."""
        free = columns(self.run_case(BEAM + DEAD, name="free"))
        first = free["load_factor"][1]
        held = f"[loading]\ntable = [0, {first - 1e-3}, 1]\n"
        rows = self.judged(BEAM + DEAD + GROUND + held)
        self.assertEqual(rows["load_factor"][2], rows["load_factor"][3])
        self.assertGreater(rows["broken_bonds"][3], 10)
        self.assertEqual(rows["broken_bonds"][2], 0)
        self.assertEqual(rows["reaction_y:ground"][2], 0.0)
        self.assertGreater(rows["reaction_y:ground"][3], 10.0)
        self.assertGreater(rows["drained_energy"][3], 1e-4)
        self.assertEqual(rows["stage"][-1], 2.0)

    def test_in_space(self):
        rows = self.judged(IN_SPACE)
        end = numpy.argmax(rows["stage"] == 2.0)
        self.assertGreater(rows["broken_bonds"][end], 10)
        self.assertLess(rows["reaction_x:right_end"][end], -100.0)
        self.assertGreaterEqual(len(self.corners()), 1)

    def test_threads_and_steps_change_nothing(self):
        whole = columns(self.run_case(IN_SPACE))
        for name, threads, *changes in (("two", 2), ("steps", 1, "loading.steps=10")):
            rows = columns(self.run_case(IN_SPACE, *changes, name=name, threads=threads))
            self.assertEqual(self.broken(name), self.broken())
            for key in ("dissipated_energy", "drained_energy", "stored_energy", "reaction_x:right_end"):
                self.assertAlmostEqual(rows[key][-1] / whole[key][-1], 1.0, delta=1e-6)

    def test_nothing_changes_while_nothing_touches(self):
        without = columns(self.run_case(strip(), name="without"))
        rows = columns(self.run_case(strip() + '[[contact]]\nset = "left"\nwith = "right"\n', name="with"))
        self.assertEqual(self.broken("with"), self.broken("without"))
        for name in ("load_factor", "stored_energy", "dissipated_energy", "drained_energy", "external_work", "reaction_x:right"):
            numpy.testing.assert_allclose(rows[name], without[name], rtol=1e-8, atol=1e-9 * abs(without[name]).max())
        costs = [json.loads((self.folder / name / "summary.json").read_text())["factorisations"] for name in ("with", "without")]
        self.assertEqual(*costs)

    def test_faces(self):
        text = BEAM + CUT.replace("[[contact]]", '[[contact]]\nshape = "faces"') + TOUCHING
        rows = self.judged(text)
        self.assertGreater(rows["broken_bonds"][-1], 10)

    def test_a_roller_that_would_pass_through_is_noticed(self):
        text = BEAM + APART.replace("0.01502", "0.040")
        self.run_case(text, 'obstacle[0].displacement=[0, "-0.2*load"]', "loading.adaptive=false", code=3)
        self.assertIn("degenerate", self.ended.said)

    def test_refused(self):
        for text, change, words in (
            (BEAM + TOUCHING, "obstacle[0].friction=0.1", "friction"),
            (BEAM + CUT + TOUCHING, "contact[0].friction=0.1", "friction"),
            (BEAM + TOUCHING, 'obstacle[0]={name="middle", shape="plane", point=[0, 0.007], normal=[0, -1], '
                              'displacement=[0, "free"], force="-1*load"}', "force"),
            (BEAM + POINT, 'material.damage.compression="kept"', "mode path"),
        ):  # fmt: skip
            with self.subTest(change):
                self.assertIn(words, self.refusal(text, change))
