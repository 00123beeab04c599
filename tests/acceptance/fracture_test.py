"""Fracture through the command line: cracks, the three modes, fragments and probes."""

import functools
import itertools
import json
import math
import pathlib
import tempfile
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.strip import LATTICE
from tests.reference.program import ROOT
from tests.reference.results import table

CASES = ROOT / "cases"
SQUARE = CASES / "plate_with_hole/square.toml"

# 20 x 10 points, half cut at x = 10 mm, and a layer of three columns at each end.
CRACK = """\
[[crack]]
from = [0.01, -1e-3]
to = [0.01, 0.0043]
"""
DAMAGE = """\
[material.damage]
law = "tanh"
onset = 0.015
critical = 0.020
"""
STRIP = LATTICE + f"""\
[[set]]
name = "all"
where = "x > -1"
{CRACK}[material]
micromodulus = 1e22
{DAMAGE}[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["5e-4*load", "0"]
[[probe]]
name = "pulled"
set = "right"
[[probe]]
name = "body"
set = "all"
[[probe]]
name = "gap"
set = "right"
other = "all"
field = "opening"
[solver]
mode = "adaptive"
[relaxation]
steps = 40
"""
SPACING, MICROMODULUS, REACH = 1e-3, 1e22, 3.015


def cut_by(segment, bond):
    """Whether two closed segments meet; exact for integers."""
    (p, q), (a, b) = segment, bond

    def side(o, m, n):
        area = (m[0] - o[0]) * (n[1] - o[1]) - (m[1] - o[1]) * (n[0] - o[0])
        return (area > 0) - (area < 0)

    def within(o, m, n):  # n, on the line o-m, lies between them
        return all(min(o[c], m[c]) <= n[c] <= max(o[c], m[c]) for c in (0, 1))

    turns = side(p, q, a), side(p, q, b), side(a, b, p), side(a, b, q)
    if turns[0] * turns[1] < 0 and turns[2] * turns[3] < 0:
        return True
    ends = (p, q, a), (p, q, b), (a, b, p), (a, b, q)
    return any(turn == 0 and within(*end) for turn, end in zip(turns, ends))


def bonds_of(places, reach):
    """Pairs of points (i < j) no farther apart than `reach`."""
    pairs = []
    for i in range(len(places) - 1):
        near = ((places[i + 1 :] - places[i]) ** 2).sum(axis=1) <= reach**2
        pairs += [(i, i + 1 + int(j)) for j in numpy.flatnonzero(near)]
    return pairs


def strip_places():
    """Points of the strip and its layers in whole tenths of a millimetre."""
    return numpy.array([(10 * i + 5, 10 * j + 5) for i in range(-3, 23) for j in range(10)])


class Run:
    """The ending of a run, and its files."""

    def __init__(self, ended, folder):
        self.code, self.said, self.folder = ended.code, ended.said, folder

    def table(self, name):
        return table(self.folder / f"{name}.csv")

    @functools.cached_property
    def history(self):
        """Without step 0: nothing acts at load 0."""
        return [row for row in self.table("history") if row["step"] > 0]

    @functools.cached_property
    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    def column(self, name):
        return numpy.array([row[name] for row in self.history])

    def last_iterations(self):
        """A column over the accepted steps."""
        last = {row["step"]: row for row in self.table("iterations")}
        return [last[row["step"]] for row in self.history]

    def points(self, name):
        with h5py.File(self.folder / "results.h5") as file:
            return file[f"points/{name}"][...]

    def field(self, name, step=-1):
        with h5py.File(self.folder / "results.h5") as file:
            return file[f"steps/{sorted(file['steps'])[step]}/{name}"][...]


# A crack driven between two arms, in equilibrium.
CANTILEVERS = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, -0.008], max = [0.03, 0.008] }]
[quadrature]
volume_correction = "linear"
[material]
youngs_modulus = 70e9
[material.damage]
law = "linear"
fracture_energy = 1000
no_fail = ["arms"]
[[crack]]
from = [-0.001, 0]
to = [0.01, 0]
[[set]]
name = "above"
where = "x < 2e-3 && y > 0.006"
[[set]]
name = "below"
where = "x < 2e-3 && y < -0.006"
[[set]]
name = "path"
where = "abs(y) < spacing"
[[set]]
name = "arms"
where = "abs(y) > 3e-3"
[[support]]
set = "above"
displacement = ["free", "1.64e-4*load"]
[[support]]
set = "below"
displacement = [0, "-1.64e-4*load"]
[[probe]]
name = "length"
set = "path"
field = "crack_length"
[[probe]]
name = "area"
set = "path"
field = "crack_area"
[[probe]]
name = "resistance"
set = "path"
field = "crack_resistance"
[loading]
steps = 16
[solver]
mode = "newton"
"""


class Fracture(Folder):
    @classmethod
    def setUpClass(cls):
        cls.folder = pathlib.Path(cls.enterClassContext(tempfile.TemporaryDirectory(prefix="peristat test ")))
        cls.runs = {}

    def setUp(self):
        """All tests share a folder with its runs."""

    def run_case(self, case, *changes, threads=2):
        """Runs a case once for all tests, with any ending."""
        key = (case, changes, threads)
        if key not in self.runs:
            out = super().run_case(case, *changes, name=f"out_{len(self.runs)}", threads=threads, code=(0, 2, 3))
            self.runs[key] = Run(self.ended, out)
        return self.runs[key]

    def completed(self, case, *changes, **options):
        run = self.run_case(case, *changes, **options)
        self.assertEqual(run.code, 0, run.said)
        self.assertEqual(run.summary["status"], "completed")
        self.assertEqual(run.history[-1]["load_factor"], 1.0)
        return run

    def changed(self, text, old, new):
        self.assertIn(old, text)
        return text.replace(old, new, 1)

    # ---- the square plate in the three modes ------------------------------------------------------

    RELAXATION = ("solver.mode=relaxation", "relaxation.steps=36")
    # 100 steps divide 10 000 iterations without a remainder
    MOVING = ("solver.mode=relaxation", "relaxation.load=moving", "relaxation.iterations=10000", "relaxation.steps=100")

    def square_runs(self):
        return {"adaptive": self.completed(SQUARE), "relaxation": self.completed(SQUARE, *self.RELAXATION),
                "moving": self.completed(SQUARE, *self.MOVING)}  # fmt: skip

    def assert_balanced(self, run, sets, axes, points):
        """Reactions sum up to minus the residual's sum, because bonds pull their ends equally: at most
        the residual's 2-norm times the root of the number of its components, and round-off."""
        for row, last in zip(run.history, run.last_iterations()):
            bound = math.sqrt(points) * float(last["residual"])
            for axis in axes:
                forces = [row[f"reaction_{axis}:{name}"] for name in sets]
                # the summed forces of the bonds are some 100 times the reaction
                round_off = 1e-12 * max(map(abs, run.column(f"reaction_y:{sets[0]}")))
                self.assertLessEqual(abs(sum(forces)), bound + round_off, row["step"])

    def test_square_plate_breaks_in_each_mode(self):
        for mode, run in self.square_runs().items():
            with self.subTest(mode):
                # [ADAPT] sec. 5.2 and its variants of mode and step: two cracks of 20 columns, each with
                # about 20 bonds for a horizon of three spacings
                self.assertGreaterEqual(run.summary["broken_bonds"], 700)
                self.assertLessEqual(run.summary["broken_bonds"], 880)
                self.assert_balanced(run, ("top", "bottom"), "xy", run.summary["points"])
                pull = run.column("reaction_y:top")
                self.assertGreater(pull.max(), 0.0)
                self.assertLess(abs(pull[-1]), 0.02 * pull.max())  # only single bonds are left

    def test_square_plate_has_the_same_reaction_before_damage(self):
        weak = ("support[0].displacement=['0','-1e-4*load']", "support[1].displacement=['0','1e-4*load']", "relaxation.steps=2")
        pulls = []
        for mode in ("newton", "adaptive", "relaxation"):
            run = self.completed(SQUARE, *weak, f"solver.mode={mode}")
            self.assertEqual(run.summary["energy"]["dissipated"], 0.0)
            pulls.append(run.history[-1]["reaction_y:top"])
        self.assertGreater(pulls[0], 0.0)
        # residuals are relaxed to 1e-10; single long waves of the plate respond 1e3 times more strongly
        for pull in pulls:
            self.assertLess(abs(pull / pulls[0] - 1.0), 1e-6)

    def test_moving_load_and_adaptive_mode_agree_on_the_strength(self):
        runs = self.square_runs()
        peaks = [runs[mode].column("reaction_y:top").max() for mode in ("adaptive", "moving")]
        # both sample the curve: the difference is due to the plate's inertia and load steps of 1/100 or less
        self.assertLess(abs(peaks[0] / peaks[1] - 1.0), 0.1)

    def test_cracks_of_the_square_plate_reach_the_free_edges(self):
        for mode, run in self.square_runs().items():
            with self.subTest(mode):
                places = run.points("reference")
                broken = {(int(row["first_point"]), int(row["second_point"])) for row in run.table("broken_bonds")}
                self.assertEqual(len(broken), run.summary["broken_bonds"])  # each is listed once
                bonds = bonds_of(places, REACH * SPACING)
                self.assertEqual(len(bonds), run.summary["bonds"])
                self.assertLessEqual(broken, set(bonds))
                touched = places[sorted(set(itertools.chain(*broken)))]
                for sign in (-1, 1):
                    self.assertGreater((sign * touched[:, 0]).max(), 0.024)  # the last column
                    for column in numpy.arange(5.5e-3, 25e-3, 1e-3):
                        self.assertLess(abs(sign * touched[:, 0] - column).min(), 1e-9)

    def test_ledger_of_the_square_plate(self):
        for mode, run in self.square_runs().items():
            with self.subTest(mode):
                work = run.column("external_work") + run.column("numerical_work")
                error = run.column("balance_error")
                stored, dissipated = run.column("stored_energy"), run.column("dissipated_energy")
                drained = run.column("drained_energy")
                # round-off of energies of order `work`
                self.assertLess(abs(work - stored - dissipated - drained - error).max(), 1e-12 * work.max())
                before = 0.0
                for row in run.history:
                    if row["mode"] == "relaxation":  # newton's is the error of the trapezoidal rule
                        self.assertLessEqual(abs(row["balance_error"] - before), 1e-8 * row["external_work"])
                    before = row["balance_error"]
                self.assertTrue((numpy.diff(dissipated) >= 0.0).all())
                self.assertTrue((numpy.diff(run.column("broken_bonds")) >= 0).all())
                # damping removes energy: with a moving load, drained energy includes that of oscillations
                if mode != "moving":
                    self.assertTrue((numpy.diff(drained, prepend=0.0) >= -1e-8 * work.max()).all())
                self.assertGreater(dissipated[-1], 0.0)
                damage = run.column("max_damage")
                self.assertTrue(((damage >= 0.0) & (damage <= 1.0)).all())
                for step in range(len(run.history)):
                    field = run.field("damage", step)
                    self.assertTrue(((field >= 0.0) & (field <= 1.0)).all())
                    self.assertAlmostEqual(field.max(), damage[step], delta=1e-14)

    def test_newton_mode_ends_with_a_name(self):
        # a coarser plate and few cuts: each failed step costs many factorisations
        run = self.run_case(SQUARE, "solver.mode=newton", "lattice.spacing=2e-3", "loading.smallest_step=0.01")
        self.assertIn(run.code, (0, 3), run.said)
        if run.code == 3:
            named = ("limit_point", "iteration_limit", "not_positive_definite", "singular_tangent", "no_descent", "line_search_failed")
            self.assertTrue(run.summary["reason"].startswith(named), run.summary["reason"])
        self.assertGreater(len(run.history), 0)
        for name in ("history.csv", "iterations.csv", "decisions.csv", "summary.json"):
            self.assertNotRegex((run.folder / name).read_text(), r"\b(nan|inf)\b")
        for row in run.history:
            self.assertTrue(all(math.isfinite(value) for key, value in row.items() if key != "mode"))
        if run.code == 3:
            dossier = (run.folder / "dossier.txt").read_text()
            for told in (run.summary["reason"].split()[0], "What to do", "Last accepted state: step", "pivots", "Worst points", "cut;"):
                self.assertIn(told, dossier)
            with h5py.File(run.folder / "results.h5") as file:
                residual = numpy.linalg.norm(file["dossier/residual"], axis=1)
            worst = int(dossier[dossier.index("reference position [m]"):].split("\n")[1].split()[0])
            self.assertEqual(worst, int(residual.argmax()))

    def test_crack_of_the_notched_plate_runs_to_the_load(self):
        run = self.completed(CASES / "three_point_bending/notched.toml")
        pull = abs(run.column("reaction_y:load"))
        self.assertTrue(0 < pull.argmax() < len(pull) - 1)  # the curve has its peak inside
        self.assertLess(pull[-1], 0.1 * pull.max())
        with h5py.File(run.folder / "results.h5") as file:
            reference = file["points/reference"][:]
        middle = numpy.array([reference[[int(row["first_point"]), int(row["second_point"])]].mean(axis=0)
                              for row in run.table("broken_bonds")])  # fmt: skip
        path = middle[abs(middle[:, 0]) < 10 * 1.2e-3]
        # from the notch's tip at 18 mm to within the horizon of the loaded edge at 60 mm, without gaps
        heights = numpy.concatenate([[18e-3], numpy.sort(path[:, 1]), [60e-3]])
        self.assertLess(numpy.diff(heights).max(), 3.015 * 1.2e-3 + 1e-12)

    def test_a_stand_in_carries_the_body_to_the_onset(self):
        # the four holes on a coarser lattice, with half their horizon until damage begins
        run = self.completed(CASES / "four_holes/tension.toml", "lattice.spacing=2e-3",
                             "lattice.horizon_ratio=4.015", "solver.elastic_horizon_ratio=2.015")  # fmt: skip
        handed = [row for row in run.table("decisions") if row["action"] == "hand over to relaxation"]
        self.assertIn("stand-in", handed[0]["reason"])
        self.assertNotIn("stand-in", "".join(row["reason"] for row in handed[1:]))
        modes = [row["mode"] for row in run.history]
        first = modes.index("relaxation")
        self.assertGreater(first, 0)
        self.assertEqual(run.history[first - 1]["broken_bonds"], 0)
        self.assertGreater(run.summary["broken_bonds"], 0)
        # The body's energy balance begins with its stored energy; relaxation's closes to round-off, and an
        # implicit step's error falls with the cube of its strain, 1e-2 at most.
        self.assertLess(abs(run.history[first]["balance_error"]), 1e-3 * run.history[first]["external_work"])

    # ---- equilibrium and decisions ----------------------------------------------------------------

    def test_accepted_steps_are_in_equilibrium(self):
        newton = self.run_case(SQUARE, "solver.mode=newton", "lattice.spacing=2e-3", "loading.smallest_step=0.01")
        for run in (self.completed(SQUARE), self.completed(SQUARE, *self.RELAXATION), newton, self.completed(STRIP)):
            self.assertGreater(len(run.history), 0)
            for row in run.last_iterations():
                self.assertLessEqual(float(row["relative_residual"]), 1e-10)  # the default tolerance

    def test_decisions_explain_the_modes(self):
        run = self.completed(SQUARE)
        switches = [row for row in run.table("decisions") if row["action"].startswith("hand ")]
        self.assertLessEqual({"hand over to relaxation", "hand back to newton"}, {row["action"] for row in switches})
        modes = {"hand over to relaxation": "relaxation", "hand back to newton": "newton"}
        for row in switches:
            self.assertIn("damaged", row["reason"])
        for row in run.history:
            past = [one["action"] for one in switches if int(one["step"]) <= row["step"]]
            self.assertEqual(row["mode"], modes[past[-1]] if past else "newton", row["step"])
        self.assertEqual({row["mode"] for row in run.history}, {"newton", "relaxation"})
        self.assertTrue(all(row["mode"] == "relaxation" for row in self.completed(SQUARE, *self.RELAXATION).history))

    # ---- cracks that are there from the start -----------------------------------------------------

    ELASTIC = ("solver.mode=newton", "material.damage.law=none")
    WEAK = "support[1].displacement=['1e-6*load','0']"

    def test_a_crack_cuts_the_bonds_that_it_meets(self):
        places = strip_places()
        bonds = bonds_of(places, 10 * REACH)
        self.assertEqual(self.completed(self.changed(STRIP, CRACK, ""), self.WEAK).summary["bonds"], len(bonds))
        counts = {}
        for segment in (((100, -10), (100, 43)), ((100, -10), (100, 45)), ((83, -10), (117, 52)), ((100, 38), (100, 42))):
            start, end = segment
            case = self.changed(STRIP, CRACK, f"[[crack]]\nfrom = [{start[0]}e-4, {start[1]}e-4]\nto = [{end[0]}e-4, {end[1]}e-4]\n")
            cut = [bond for bond in bonds if cut_by(segment, [places[end].tolist() for end in bond])]
            counts[segment] = len(cut)
            with self.subTest(segment):
                run = self.completed(case, self.WEAK)
                self.assertGreater(len(cut), 0)
                self.assertEqual(len(bonds) - run.summary["bonds"], len(cut))
        # the end lies on the bonds between the points left and right of it
        self.assertGreater(counts[(100, -10), (100, 45)], counts[(100, -10), (100, 43)])

    def test_cut_bonds_are_damage_on_request_only(self):
        run = self.completed(STRIP, self.WEAK)
        self.assertEqual(run.field("damage", 0).max(), 0.0)
        self.assertEqual(run.history[0]["max_damage"], 0.0)
        run = self.completed(STRIP, self.WEAK, "output.count_cracks=true")
        places = strip_places()
        # points in the order of the results; all volumes are equal
        number = {(round(1e4 * x), round(1e4 * y)): k for k, (x, y) in enumerate(run.points("reference"))}
        whole, cut = numpy.zeros(len(places)), numpy.zeros(len(places))
        for bond in bonds_of(places, 10 * REACH):
            ends = [tuple(places[end].tolist()) for end in bond]
            for end in ends:
                whole[number[end]] += 1
                cut[number[end]] += cut_by(((100, -10), (100, 43)), ends)
        self.assertGreater(cut.max(), 0)
        numpy.testing.assert_allclose(run.field("damage", 0), cut / whole, rtol=0.0, atol=1e-14)
        self.assertAlmostEqual(run.history[0]["max_damage"], (cut / whole).max(), delta=1e-14)
        self.assertEqual(run.summary["broken_bonds"], 0)

    def test_bad_input_is_refused_at_its_place(self):
        plane = "[[crack]]\nvertices = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n"
        bar = 'dimension = 1\n[lattice]\nspacing = 0.1\n[[lattice.shape]]\nadd = "box"\nmin = [0]\nmax = [1]\n[[lattice.layer]]\nname = "left"\nside = "x-"\n[material]\nyoungs_modulus = 1.0\n[[support]]\nset = "left"\ndisplacement = [0]\n'
        self.completed(bar)
        bad = {
            "crack in 1D": (bar + "[[crack]]\nfrom = [0]\nto = [1]\n", (), ["crack[0]"], "[[crack]]"),
            "vertices in 2D": (self.changed(STRIP, CRACK, plane), (), ["crack[0].vertices"], "vertices"),
            "law": (self.changed(STRIP, '"tanh"', '"tan"'), (), ["material.damage.law", "tanh"], 'law = "tan"'),
            "onset": (self.changed(STRIP, "onset = 0.015", "onset = 0.02"), (), ["material.damage.onset", "critical"], "onset"),
            "critical": (self.changed(STRIP, "critical = 0.020\n", ""), (), ["material.damage.critical", "missing"], "[material.damage]"),
            "no_fail": (self.changed(STRIP, "onset", 'no_fail = ["lefft"]\nonset'), (), ["material.damage.no_fail", "lefft"], "no_fail"),
            "other": (self.changed(STRIP, 'other = "all"\n', ""), (), ["probe[2].other"], 'name = "gap"'),
            "iterations": (self.changed(STRIP, "steps = 40", "iterations = 100"), (), ["relaxation.iterations", "moving"], "iterations"),
            "override": (STRIP, ("relaxation.iterations=100",), ["--set relaxation.iterations=100", "moving"], None),
        }  # fmt: skip
        for name, (text, settings, fragments, at) in bad.items():
            with self.subTest(name):
                run = self.run_case(text, *settings)
                self.assertEqual(run.code, 2, run.said)
                for fragment in fragments:
                    self.assertIn(fragment, run.said)
                if at:
                    line = next(k for k, one in enumerate(text.splitlines(), 1) if one.startswith(at))
                    # a missing key is reported at its table, whose header is right above
                    self.assertTrue(f".toml:{line}:" in run.said or f".toml:{line - 1}:" in run.said, run.said)
                self.assertFalse(run.folder.exists())

    # ---- no_fail, probes, threads -----------------------------------------------------------------

    def test_sets_that_never_fail(self):
        self.assertGreater(self.completed(STRIP).summary["broken_bonds"], 50)
        run = self.completed(STRIP, "material.damage.no_fail=['all']")
        self.assertEqual((run.summary["broken_bonds"], run.summary["energy"]["dissipated"]), (0, 0.0))
        self.assertEqual(run.table("broken_bonds"), [])
        elastic = self.completed(STRIP, *self.ELASTIC)
        # both in equilibrium to 1e-10
        self.assertAlmostEqual(run.history[-1]["reaction_x:right"] / elastic.history[-1]["reaction_x:right"], 1.0, delta=1e-8)
        part = self.changed(STRIP, 'where = "x > -1"', 'where = "y > 7e-3"')
        run = self.completed(part, "material.damage.no_fail=['all']")
        places, broken = run.points("reference"), run.table("broken_bonds")
        self.assertGreater(len(broken), 0)
        for row in broken:
            for end in ("first_point", "second_point"):
                self.assertLess(places[int(row[end])][1], 7e-3)

    def test_opening_is_a_difference_of_displacements(self):
        run = self.completed(STRIP)
        for row in run.history:
            for axis in "xy":
                # the same sums, printed with all digits
                self.assertAlmostEqual(row[f"gap_{axis}"], row[f"pulled_{axis}"] - row[f"body_{axis}"], delta=1e-18)
            self.assertAlmostEqual(row["pulled_x"], 5e-4 * row["load_factor"], delta=1e-15)

    def test_crack_length_of_the_square_plate(self):
        for sign, name in (("", "right"), ("-", "left")):
            probe = f'\n[[set]]\nname = "ligament"\nwhere = "{sign}x > 0 && abs(y) < 6e-3"\n[[probe]]\nname = "crack"\nset = "ligament"\nfield = "crack_length"\n'
            with self.subTest(name):
                run = self.completed(SQUARE.read_text() + probe)
                length = run.column("crack")
                self.assertEqual(length[0], 0.0)
                self.assertTrue((numpy.diff(length) >= 0.0).all())
                # from the hole's rim to the edge
                self.assertLessEqual(abs(length[-1] - 20e-3), 2 * SPACING)

    def test_resistance_sums_up_to_what_is_dissipated(self):
        """Dissipated energy over the newly cracked area; 0 if the crack does not grow, whatever is dissipated."""
        run = self.completed(CANTILEVERS)
        area, resistance, dissipated = (run.column(name) for name in ("area", "resistance", "dissipated_energy"))
        growth = numpy.diff(area, prepend=10e-6)  # without the pre-crack
        growth[abs(growth) < 1e-12] = 0.0
        grown = growth > 0
        self.assertGreater(grown.sum(), 5)
        self.assertGreater((~grown & (numpy.diff(dissipated, prepend=0.0) > 0)).sum(), 0)
        self.assertTrue(((resistance > 0) == grown).all())
        last = numpy.flatnonzero(grown)[-1]
        # sums of about ten rows, printed with all digits
        self.assertAlmostEqual((resistance * growth).sum() / dissipated[last], 1.0, delta=1e-12)
        # The material's fracture energy; a face more or less opens for the same softening ahead of it.
        self.assertAlmostEqual((resistance * growth).sum() / growth.sum() / 1000, 1.0, delta=0.15)

    def test_threads_do_not_change_the_states(self):
        one, two = (self.completed(STRIP, threads=threads) for threads in (1, 2))
        self.assertEqual((one.summary["threads"], two.summary["threads"]), (1, 2))
        self.assertGreater(one.summary["broken_bonds"], 50)
        # in a burst round-off decides which of two bonds breaks first, and adaptive damping amplifies it
        self.assertAlmostEqual(one.summary["broken_bonds"] / two.summary["broken_bonds"], 1.0, delta=0.1)
        compared = 0
        for first, second in zip(one.history, two.history):
            if float(first["broken_bonds"]) > 0 or float(second["broken_bonds"]) > 0:
                break
            self.assertAlmostEqual(float(first["load_factor"]), float(second["load_factor"]), delta=1e-12)
            work = float(first["external_work"])
            for key in ("stored_energy", "dissipated_energy"):
                # equilibria have residuals of 1e-10 of the forces
                self.assertAlmostEqual(float(first[key]), float(second[key]), delta=1e-8 * work, msg=key)
            compared += 1
        self.assertGreater(compared, 0)

    # ---- pieces -----------------------------------------------------------------------------------

    APART = "support[1].displacement=['4e-3*load','0']"

    def test_a_body_in_two_held_pieces_goes_on(self):
        for remedy in ("hold", "remove"):
            run = self.completed(STRIP, self.APART, f"solver.fragments={remedy}")
            pull = run.column("reaction_x:right")
            # the pieces are free of stress to the solver's tolerance, 1e-10 of the peak or less
            self.assertLess(abs(pull[-1]), 1e-6 * pull.max())
            self.assertGreater(run.summary["broken_bonds"], 0)

    def test_a_piece_that_a_support_still_moves_goes_with_it(self):
        for remedy in ("hold", "remove"):
            run = self.completed(STRIP, self.APART.replace("'0'", "'free'"), f"solver.fragments={remedy}")
            pull = run.column("reaction_x:right")
            self.assertLess(abs(pull[-1]), 1e-6 * pull.max())  # free of stress, as above
            self.assertLess(run.history[-1]["pin_force"], 1e-6 * pull.max())
            self.assertEqual(run.field("fragment").max(), 1)  # it may slide across

    # The supports move away by a spacing, faster than the body can follow: each of their bonds, of three
    # spacings or less, would be stretched by a fourth or more.
    TORN = (*(f"support[{k}].displacement=['{sign}1e-3*min(2*load,1)','0']" for k, sign in ((0, "-"), (1, ""))),
            "solver.mode=relaxation", "relaxation.ramp=100", "relaxation.steps=2", "relaxation.breaking=transient")  # fmt: skip

    def torn(self):
        damage = '[material.damage]\nlaw = "critical_stretch"\ncritical = 0.02\n'
        return self.changed(self.changed(STRIP, CRACK, ""), DAMAGE, damage)

    def test_a_body_torn_from_its_supports_is_a_piece(self):
        for remedy in ("hold", "remove"):
            with self.subTest(remedy):
                run = self.completed(self.torn(), *self.TORN, f"solver.fragments={remedy}")
                places = run.points("reference")
                inside = (places[:, 0] > 0) & (places[:, 0] < 0.02)
                broken = {(int(row["first_point"]), int(row["second_point"])) for row in run.table("broken_bonds")}
                torn = {(i, j) for i, j in bonds_of(places, REACH * SPACING) if inside[i] != inside[j]}
                self.assertTrue(torn and torn <= broken)  # and a few inside, near the corners
                self.assertEqual(run.summary["broken_bonds"], len(broken))
                # 1/2 c s_c^2 per bond, length and both volumes; sums of some 100 terms
                lengths = sum(numpy.linalg.norm(places[i] - places[j]) for i, j in broken)
                dissipated = 0.5 * MICROMODULUS * 0.02**2 * lengths * (SPACING**3) ** 2
                self.assertAlmostEqual(run.history[-1]["dissipated_energy"] / dissipated, 1.0, delta=1e-12)
                x = run.points("reference")[:, 0]
                for step in (0, 1):
                    fragment = run.field("fragment", step)
                    self.assertTrue((fragment == ((x > 0) & (x < 0.02))).all())
                # no stress is left: 1e-10 of the forces of the whole body over such a jump, about 5e4 N
                self.assertLess(abs(run.field("force")).max(), 1e-5)
                self.assertIn(f"{remedy} fragments", [row["action"] for row in run.table("decisions")])

    def test_a_run_may_end_with_the_first_piece(self):
        run = self.run_case(self.torn(), *self.TORN, "solver.fragments=stop")
        self.assertEqual(run.code, 3, run.said)
        self.assertTrue(run.summary["reason"].startswith("fragmented"), run.summary["reason"])
        self.assertIn("fragmented", run.said)
        self.assertEqual(len(run.history), 1)  # the step that tore it off is kept
        self.assertEqual(run.field("fragment").max(), 1)

    # ---- without damage ---------------------------------------------------------------------------

    def test_without_damage_the_modes_agree(self):
        newton = self.completed(STRIP, *self.ELASTIC)
        adaptive = self.completed(STRIP, *self.ELASTIC[1:])
        for ours, theirs in zip(newton.history, adaptive.history, strict=True):
            self.assertEqual(ours, theirs)
        numpy.testing.assert_array_equal(newton.field("displacement"), adaptive.field("displacement"))
        tight = "solver.relative_tolerance=1e-12"
        exact = self.completed(STRIP, *self.ELASTIC, tight).field("displacement")
        relaxed = self.completed(STRIP, self.ELASTIC[1], tight, "solver.mode=relaxation", "relaxation.steps=2").field("displacement")
        # the tangent of 20 x 10 points has a condition number of about 1e3
        self.assertLess(abs(relaxed - exact).max(), 1e-8 * abs(exact).max())


if __name__ == "__main__":
    unittest.main()
