"""Mode path: from event to event. The reference of tests/reference solves every event independently."""

import json

import h5py
import numpy

from tests.acceptance.programme_test import Programmes
from tests.reference.events import Events
from tests.reference.results import table
from tests.reference.verify import Verification
from tests.same_results import differences

# 12 x 6 points between two held layers, notched from below.
STRIP = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [0.012, 0.006]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[[crack]]
from = [0.006, 0.0]
to = [0.006, 0.0015]
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 0.01
[[support]]
set = "left"
displacement = ["LEFT*load", 0]
[[support]]
set = "right"
displacement = ["2e-4*load", "free"]
[solver]
mode = "path"
"""
CRACK = '[[crack]]\nfrom = [0.006, 0.0]\nto = [0.006, 0.0015]\n'
BRITTLE = 'law = "critical_stretch"\ncritical = 0.01\n'
LINEAR = 'law = "linear"\nonset = 0.005\ncritical = 0.02\n'
OPENING = 'law = "cornelissen"\nonset = 0.004\ncritical = 0.08\n'
TANH = 'law = "tanh"\nonset = 0.008\ncritical = 0.012\n'


def strip(damage=BRITTLE, cracks=CRACK, left="0", more=""):
    return STRIP.replace(BRITTLE, damage).replace(CRACK, cracks).replace("LEFT", left) + more


def crack(*ends):
    return "".join(f"[[crack]]\nfrom = {list(a)}\nto = {list(b)}\n" for a, b in ends)


class Paths(Programmes):
    def broken(self, name="out"):
        """Ends of the bonds in breaking order, and the load factors."""
        rows = table(self.folder / name / "broken_bonds.csv")
        loads = numpy.array([row["load_factor"] for row in rows])
        return [(row["step"], row["first_point"], row["second_point"]) for row in rows], loads

    def decisions(self, action, name="out"):
        return [row["reason"] for row in table(self.folder / name / "decisions.csv") if row["action"] == action]

    def judged(self, text, *settings, name="out"):
        """Rows of a run that ends with 0 and passes the reference's checks."""
        rows = self.rows(text, *settings, name=name)
        judge = Verification(self.folder / name, text)
        self.assertEqual(judge.run(), [])
        events = judge.events
        self.assertIsInstance(events, Events)
        self.assertEqual(events.unknown, 0)
        self.assertTrue(events.is_whole)
        if events.is_plain:
            self.assertGreater(events.settled_here, 5)
        self.assertEqual(rows[-1]["stage"], round(rows[-1]["stage"]))
        return rows, events


class Judged(Paths):
    def test_brittle(self):
        rows, _ = self.judged(strip())
        self.assertGreater(sum(row["on_response"] == 0 for row in rows), 10)
        self.assertIn(-1, {row["stability"] for row in rows})
        self.assertGreater(rows[-1]["released_energy"], rows[-1]["drained_energy"])

    def test_linear_softening(self):
        self.judged(strip(LINEAR, more="[loading]\nteeth = 2\n"))

    def test_tanh_softening(self):
        self.judged(strip(TANH, more="[loading]\nteeth = 3\n"))

    def test_softening_by_the_opening(self):
        self.judged(strip(OPENING, more="[loading]\nteeth = 2\n"))

    def test_one_tooth(self):
        self.judged(strip(LINEAR, more="[loading]\nteeth = 1\n"))

    def test_no_batches_and_wide_ones(self):
        for tolerance in (0, 0.1):
            with self.subTest(tolerance):
                self.judged(strip(more=f"[loading]\nevent_tolerance = {tolerance}\n"), name=f"out{tolerance}")

    def test_cpd(self):
        material = 'model = "cpd"\nc1 = 1e22\nc2 = 2e31\n[material.damage]\n'
        text = strip().replace("youngs_modulus = 200e9\n[material.damage]\n", material)
        rows, _ = self.judged(text)
        self.assertGreater(rows[-1]["broken_bonds"], 10)

    def test_dead_load_beside_supports(self):
        self.judged(strip(more='[[load]]\nside = "y+"\ntraction = [0, "2e7*load"]\n'))

    def test_unloading_in_the_middle(self):
        rows, _ = self.judged(strip(more="[loading]\ntable = [0, 0.6, 0.2, 1]\n"))
        stages = [row["stage"] for row in rows]
        for stage in (1.0, 2.0, 3.0):
            self.assertIn(stage, stages)
        bonds = {row["stage"]: row["broken_bonds"] for row in rows}
        self.assertEqual(bonds[1.0], bonds[2.0])  # nothing breaks during unloading
        self.assertGreater(bonds[1.0], 0)

    def test_two_notches_that_compete(self):
        notches = crack(([0.004, 0.0], [0.004, 0.0016]), ([0.008, 0.0044], [0.008, 0.006]))
        self.judged(strip(cracks=notches))

    def test_three_pieces(self):
        """Equal ligaments break together, and leave a piece that is no longer held."""
        notches = crack(*(([x, low], [x, high]) for x in (0.005, 0.015) for low, high in ((0, 0.002), (0.004, 0.006))))
        text = strip(cracks=notches, left="-4e-4").replace("[0.012, 0.006]", "[0.020, 0.006]")
        text = text.replace('displacement = ["2e-4*load", "free"]', 'displacement = ["4e-4*load", "free"]')
        rows, _ = self.judged(text + "[loading]\nevent_tolerance = 0.01\n")  # ligaments tear together
        self.assertIn("2 floating pieces, 0 loose points", self.decisions("hold fragments"))
        self.assertLess(rows[-1]["stored_energy"], 1e-20 * rows[0]["stored_energy"])
        self.assertLess(abs(rows[-1]["reaction_x:right"]), 1e-10 * rows[0]["reaction_x:right"])
        with h5py.File(self.folder / "out/results.h5") as file:
            pieces = list(file["steps"].values())[-1]["fragment"][...]
        self.assertGreater(len(set(pieces)), 1)

    def test_avalanches_where_the_path_would_go_back_behind_an_entry(self):
        first = self.rows(strip(BRITTLE))[0]["load_factor"]
        rows, events = self.judged(strip(BRITTLE, more=f"[loading]\ntable = [0, {first - 1e-3}, 1]\n"), name="held")
        self.assertGreater(events.avalanches, 0)
        self.assertEqual(len([r for r in self.decisions("accept", "held") if "while the load is held" in r]), events.avalanches)


class Symmetric(Paths):
    def test_it_stays_symmetric(self):
        notches = crack(([0.006, 0.0], [0.006, 0.001]), ([0.006, 0.005], [0.006, 0.006]))
        text = strip(cracks=notches, left="-2e-4")
        text = text.replace('"-2e-4*load", 0]', '"-2e-4*load", "0"]').replace('"2e-4*load", "free"]', '"2e-4*load", "0"]')
        self.judged(text)
        with h5py.File(self.folder / "out/results.h5") as file:
            reference = file["points/reference"][...]
            mirrors = []
            for axis, middle in ((0, 0.012), (1, 0.006)):
                mirrored = reference.copy()
                mirrored[:, axis] = middle - mirrored[:, axis]
                away = numpy.abs(reference[None] - mirrored[:, None]).max(axis=2)
                self.assertLess(away.min(axis=1).max(), 1e-9)
                mirrors.append((axis, away.argmin(axis=1)))
            compared = 0
            for step in file["steps"].values():
                displacement, damage = step["displacement"][...], step["damage"][...]
                for axis, image in mirrors:
                    sign = numpy.where(numpy.arange(2) == axis, -1, 1)
                    off = numpy.abs(displacement - sign * displacement[image]).max()
                    self.assertLess(off, 1e-7 * numpy.abs(displacement).max())
                    self.assertEqual(numpy.abs(damage - damage[image]).max(), 0)
                    compared += damage.max() > 0
            self.assertGreater(compared, 20)


class OnePath(Paths):
    def same_path(self, text, variants):
        self.run_case(text)
        bonds, loads = self.broken()
        self.assertGreater(len(bonds), 20)
        for name, (threads, *changes) in variants.items():
            with self.subTest(name):
                folder = name.replace(".", "_")
                self.run_case(text, *changes, name=folder, threads=threads)
                others, other_loads = self.broken(folder)
                self.assertEqual([b[1:] for b in others], [b[1:] for b in bonds])
                self.assertLess(numpy.abs(other_loads - loads).max(), 1e-8)
                last, other = self.history()[-1], self.history(folder)[-1]
                for key in ("dissipated_energy", "drained_energy", "released_energy"):
                    self.assertLess(abs(last[key] - other[key]), 1e-7 * last["external_work"], key)

    TOGETHER = {
        "two threads": (2, "loading.steps=10", "solver.linear=cholesky"),
        "three threads": (3, "loading.steps=100", "solver.linear=pcg"),
    }

    def test_brittle(self):
        """Each change alone; they come together in the other tests."""
        changes = [change for _, *changes in self.TOGETHER.values() for change in changes]
        self.same_path(strip(), {"two threads": (2,), "three threads": (3,)} | {change: (1, change) for change in changes})

    def test_softening(self):
        self.same_path(strip(TANH, more="[loading]\nteeth = 3\n"), self.TOGETHER)

    def test_on_rollers(self):
        """Dependent degrees of freedom take part in the stiffness that dropped bonds remove from a tangent."""
        roller = '[[roller]]\nset = "right"\nnormal = [1, 0.2]\ndisplacement = "2e-4*load"\n'
        text = strip().replace('[[support]]\nset = "right"\ndisplacement = ["2e-4*load", "free"]\n', roller)
        self.same_path(text, {"pcg": (2, "solver.linear=pcg")})
        self.run_case(text.replace("2e-4*load", "2e-6*load").replace("critical = 0.01", "critical = 1e-4"))
        costs = json.loads((self.folder / "out/summary.json").read_text())
        self.assertLess(4 * costs["factorisations"], costs["steps"])

    def test_symmetric(self):
        """Also for tied bonds."""
        notches = crack(([0.006, 0.0], [0.006, 0.001]), ([0.006, 0.005], [0.006, 0.006]))
        self.same_path(strip(cracks=notches, left="-2e-4"), self.TOGETHER)

    def test_it_goes_on_from_any_step_as_if_nothing_had_been(self):
        text = strip()
        rows = self.rows(text)
        for stop in (1, len(rows) // 3, 2 * len(rows) // 3):
            with self.subTest(stop):
                folder = self.run_case(text, name=f"split{stop}", words=("--stop-after", stop), code=130)
                self.resume(folder)
                self.assertEqual(differences(self.folder / "out", folder), [])


class Preloaded(Paths):
    """Supports that have moved before the load begins."""

    def test_the_path_is_the_same(self):
        self.run_case(strip(), name="from rest")
        bonds, loads = self.broken("from rest")
        self.run_case(strip().replace("2e-4*load", "2e-4*(0.1+0.9*load)"), name="preloaded")
        others, other_loads = self.broken("preloaded")
        self.assertEqual([b[1:] for b in others], [b[1:] for b in bonds])
        self.assertLess(numpy.abs(0.1 + 0.9 * other_loads - loads).max(), 1e-8)

    def test_what_is_above_its_strength_at_once_is_an_avalanche(self):
        """All bonds of the strip used to break before any had reached its strength."""
        self.first_step = 0
        rows = self.rows(strip().replace("2e-4*load", "2e-4*(0.5+0.5*load)"))
        self.assertEqual(rows[0]["load_factor"], 0)
        self.assertGreater(rows[0]["broken_bonds"], 0)
        self.assertLess(rows[-1]["broken_bonds"], 150)
        self.assertLess(abs(rows[0]["balance_error"]), 1e-9 * rows[0]["external_work"])


class Fallen(Paths):
    """A run that ends when the force has fallen below a share of its peak."""

    def test_it_ends_and_goes_on(self):
        for mode in ("path", "relaxation", "adaptive"):
            with self.subTest(mode):
                more = "[loading]\nsteps = 40\n" + ("teeth = 2\n" if mode == "path" else "")
                text = strip(LINEAR, more=more).replace('mode = "path"', f'mode = "{mode}"')
                text = text.replace("2e-4*load", "4e-4*load")
                whole = self.rows(text, name=f"whole {mode}")
                name = f"fallen {mode}"
                rows = self.rows(text, "loading.stop_below=0.8", name=name)
                force = [numpy.hypot(row["reaction_x:right"], row["reaction_y:right"]) for row in rows]
                peaks = numpy.maximum.accumulate(force)
                self.assertLess(len(rows), len(whole))
                self.assertEqual(rows, whole[: len(rows)])
                self.assertGreaterEqual(min(numpy.array(force[:-1]) / peaks[:-1]), 0.8 - 1e-12)
                self.assertLess(force[-1] / peaks[-1], 0.8)
                self.assertIn("is below 0.8 of its peak", self.decisions("stop", name)[-1])
                self.resume(name, "loading.stop_below=0")
                self.assertEqual(self.history(name), whole)


class WrongInput(Paths):
    def test_it_is_refused(self):
        for setting, words in {
            'material.damage={law="none"}': "is for bodies with damage",
            "loading.event_tolerance=0.6": "must be a number from 0 to 0.5",
            "loading.event_tolerance=-1": "must be a number from 0 to 0.5",
            "loading.teeth=0": "must be a whole number from 1 to 1000",
            "loading.teeth=1001": "must be a whole number from 1 to 1000",
            "solver.elastic_horizon_ratio=4": "is for mode adaptive",
            "loading.stop_below=1.1": "must be a number from 0 to 1",
            "loading.largest_step=1": "has no effect in mode path",
            "loading.max_broken_bonds=3": "has no effect in mode path",
        }.items():
            with self.subTest(setting):
                said = self.refusal(strip(), setting)
                self.assertIn(words, said)
                self.assertIn("solver.mode" if "damage" in setting else setting.partition("=")[0], said)

    def test_its_keys_are_refused_in_other_modes(self):
        for setting in ("loading.teeth=3", "loading.event_tolerance=0.01"):
            self.assertIn('is for solver.mode = "path"', self.refusal(strip(), setting, "solver.mode=adaptive"))

    def test_a_control_is_refused(self):
        text = strip(more='[[control]]\nset = "right"\nweights = [1, 0]\n[loading]\ntable = [0, 1e-4]\n')
        text = text.replace('displacement = ["2e-4*load", "free"]', 'displacement = ["load", "free"]')
        self.assertIn("solver.mode", self.refusal(text))
