"""Cases that invite a wrong answer: each ends with the right one, or says why it has none."""

import csv
import json
import math
import os
import pathlib
import statistics
import subprocess
import tempfile
import unittest

from tests.acceptance.strip import PULLED

PROGRAM = os.environ["PERISTAT_PROGRAM"]
CASES = pathlib.Path(__file__).resolve().parents[2] / "cases"
SQUARE = CASES / "plate_with_hole/square.toml"
BAR = CASES / "bar/tension.toml"
CANTILEVER = CASES / "cantilever/plate.toml"



# Two rows of points, pulled to a tenth of their strength.
ROW = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 1.5
thickness = 1e-3
shape = [{ add = "box", min = [0.0, 0.0], max = [0.01, 0.002] }]
layer = [{ name = "left", side = "x-" }, { name = "right", side = "x+" }]
[material]
youngs_modulus = 1e9
damage = { law = "critical_stretch", critical = 1e-2 }
[loading]
steps = 2
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["1e-5*load", 0]
"""
# Nothing is free; at the end the last bonds are stretched by a hundredth more than they bear.
ALL_PRESCRIBED = """\
[[set]]
name = "inside"
where = "x > 0 && x < 0.01"
[[support]]
set = "inside"
displacement = [0, 0]
"""


class Ended:
    def __init__(self, process, folder):
        self.code, self.said, self.folder = process.returncode, process.stdout + process.stderr, folder

    @property
    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    def table(self, name):
        with open(self.folder / f"{name}.csv", newline="") as file:
            return list(csv.DictReader(file))


class WrongAnswers(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat_wrong_")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
        self.runs = 0

    def write(self, text):
        case = self.folder / "case.toml"
        case.write_text(text)
        return case

    def run_case(self, case, *settings, threads=1, environment=(), seconds=600):
        self.runs += 1
        output = self.folder / f"results_{self.runs}"
        command = [PROGRAM, "run", str(case), "--output", str(output), "--threads", str(threads)]
        for setting in settings:
            command += ["--set", setting]
        process = subprocess.run(command, capture_output=True, text=True, timeout=seconds,
                                 env=dict(os.environ, **dict(environment)))  # fmt: skip
        return Ended(process, output)

    def completed(self, *arguments, **options):
        ended = self.run_case(*arguments, **options)
        self.assertEqual(ended.code, 0, ended.said)
        return ended

    def refused(self, *arguments, told):
        ended = self.run_case(*arguments)
        self.assertEqual(ended.code, 2, ended.said)
        self.assertIn(told, ended.said)
        self.assertFalse((ended.folder / "summary.json").exists())


class Damage(WrongAnswers):
    def test_a_jump_that_would_tear_every_bond_at_once_is_followed_step_by_step(self):
        # One step asks for 22 times the strength: the supports' jump alone breaks all bonds across
        # it, and the torn body has no residual. No energy may be dissipated that no work has done.
        for steps in (1, 2, 30):
            ended = self.run_case(SQUARE, "solver.mode=newton", f"loading.steps={steps}")
            self.assertIn(ended.code, (0, 3), ended.said)
            for row in ended.table("history"):
                work, taken_up = float(row["external_work"]), float(row["dissipated_energy"])
                self.assertLessEqual(taken_up, 1.05 * work)
            # The limit point is where damage control by 300 small steps finds it, 0.554 to 0.586.
            self.assertEqual(ended.code, 3, ended.said)
            reached = float(ended.table("history")[-1]["load_factor"])
            self.assertGreater(reached, 0.54)
            self.assertLess(reached, 0.60)

    def test_an_elastic_stand_in_without_damage_is_refused(self):
        self.refused(self.write(PULLED + '[solver]\nmode = "adaptive"\n'),
                     "solver.elastic_horizon_ratio=1.5", told="without damage")  # fmt: skip


    def test_points_that_are_loose_from_the_start_are_refused(self):
        # A row of points, each on two bonds along it: pins would bear the load across it.
        row = ROW.replace("max = [0.01, 0.002]", "max = [0.01, 0.001]")
        for mode in ("newton", "relaxation", "adaptive"):
            self.completed(self.write(ROW), f"solver.mode={mode}")
            self.refused(self.write(row), f"solver.mode={mode}", told="no bond resists their motion along y")

    def test_a_step_that_its_jump_completes_has_its_damage(self):
        # All points are prescribed: the jump alone is the step. Bonds that it breaks bear nothing.
        ended = self.completed(self.write(ROW.replace("1e-5*load", "2e-5*load") + ALL_PRESCRIBED), "solver.mode=newton")
        torn = [row for row in ended.table("history")[1:] if float(row["stored_energy"]) == 0.0]
        self.assertGreater(float(ended.table("history")[1]["reaction_x:right"]), 0.0)
        self.assertGreater(len(torn), 0)
        for row in torn:
            self.assertEqual(float(row["reaction_x:right"]), 0.0)


class Threads(WrongAnswers):
    def test_threads_that_the_system_does_not_grant_by_itself_all_run(self):
        reaction = self.completed(BAR).summary["reactions"]
        for name, value in [("OMP_DYNAMIC", "true"), ("OMP_MAX_ACTIVE_LEVELS", "0"),
                            ("OMP_NESTED", "true")]:  # fmt: skip
            ended = self.completed(BAR, threads=8, environment={name: value}.items())
            self.assertEqual(ended.summary["threads"], 8)
            for set_name, force in ended.summary["reactions"].items():
                for now, expected in zip(force, reaction[set_name]):
                    self.assertTrue(math.isclose(now, expected, rel_tol=1e-10, abs_tol=1e-9))


class Supports(WrongAnswers):
    SECOND = '[[support]]\nset = "right"\ndisplacement = ["{}", "free"]\n'

    def test_contradictions_away_from_the_ends_and_the_middle_are_found(self):
        text = PULLED.replace('"1e-5*load"', '"1e-3*load*(load-0.5)*(load-1)"')
        self.refused(self.write(text + self.SECOND.format("0")), told="contradict each other")

    def test_a_contradiction_that_shows_in_mid_run_fails_its_step(self):
        text = PULLED + self.SECOND.format("1e-5*load + (abs(load-0.42)<1e-9 ? 1e-6 : 0)")
        ended = self.run_case(self.write(text), "loading.steps=50", "loading.adaptive=false")
        self.assertEqual(ended.code, 3, ended.said)
        self.assertIn("contradict each other", ended.said)
        self.assertEqual(ended.summary["steps"], 20)

    def test_the_last_digits_of_two_expressions_are_no_contradiction(self):
        text = PULLED.replace('"1e-5*load"', '"1e-5*load*3"')
        self.completed(self.write(text + self.SECOND.format("3e-5*load")))

    def test_an_expression_without_a_value_in_mid_run_is_a_failed_step(self):
        text = PULLED.replace('"1e-5*load"', '"1e-5*load+0*ln(abs(load-0.3)>1e-6?1:-1)"')
        case = self.write(text)
        ended = self.run_case(case, "loading.steps=10", "loading.adaptive=false")
        self.assertEqual(ended.code, 3, ended.said)
        self.assertIn("case.toml:22:17", ended.said)
        self.assertIn("support[1].displacement[0]", ended.said)
        self.assertEqual(ended.summary["status"], "not_converged")
        self.assertEqual(ended.summary["steps"], 2)
        self.assertTrue((ended.folder / "dossier.txt").exists())
        # With steps that may be cut the run goes around the one place without a value.
        self.completed(case, "loading.steps=10")


class Magnitudes(WrongAnswers):
    def test_bodies_too_far_from_the_origin_are_refused(self):
        text = PULLED.replace("[0.0, 0.0]", "[1e12, 0.0]").replace("[0.02, 0.01]", "[1000000000000.02, 0.01]")
        self.refused(self.write(text), told="origin")
        points = self.folder / "points.txt"
        points.write_text("".join(f"{x} 0 1\n" for x in [0, 1, 2, 3, 1e300]))
        case = self.write('dimension = 2\n[points]\nfile = "points.txt"\nhorizon = 2\n[material]\n'
                          'youngs_modulus = 1\n[[set]]\nname = "a"\nwhere = "x < 9"\n[[support]]\n'
                          'set = "a"\ndisplacement = [0, 0]\n')  # fmt: skip
        ended = self.run_case(case)
        self.assertEqual(ended.code, 2, ended.said)

    def test_displacements_may_be_as_small_as_digits_go(self):
        expected = self.completed(self.write(PULLED)).summary["reactions"]["right"][0]
        small = PULLED.replace('"1e-5*load"', '"1e-90*load"')
        force = self.completed(self.write(small)).summary["reactions"]["right"][0]
        # Linear: at 1e-5 m the stretch is 5e-4, by which finite deformation changes the force.
        self.assertTrue(math.isclose(force / 1e-90, expected / 1e-5, rel_tol=2e-3))
        vanishing = PULLED.replace('"1e-5*load"', '"1e-170*load"')
        ended = self.run_case(self.write(vanishing))
        self.assertEqual(ended.code, 3, ended.said)
        self.assertEqual(ended.summary["status"], "inconsistent")
        self.assertEqual(ended.summary["steps"], 0)


class SlenderBodies(WrongAnswers):
    def test_cantilevers_converge_or_end_at_round_off(self):
        for slenderness in (60, 200):
            length = 0.025 * slenderness
            ended = self.completed(
                CANTILEVER, f"lattice.shape[0].max=[{length},0.025]",
                f"set[0].where='x > {length} - spacing'", 'load[0].body_force=["0","-1*load"]',
                threads=2)  # fmt: skip
            summary = ended.summary
            self.assertEqual(summary["steps"], 1)
            self.assertLessEqual(summary["newton_iterations"], 10)
            actions = {row["action"] for row in ended.table("decisions")}
            last = float(ended.table("iterations")[-1]["relative_residual"])
            if actions != {"accept at round-off"}:
                self.assertLessEqual(last, 1e-10)
            self.assertLessEqual(last, 1e-6)
            # The support carries the load: body force times volume.
            (load,) = [load for load in summary["reactions"].values()]
            self.assertGreater(load[1], 0.0)


class Tangents(WrongAnswers):
    def test_orders_are_only_told_where_linear_systems_were_exact_enough(self):
        inexact = self.completed(CASES / "cpd/square.toml", "lattice.spacing=0.1", "loading.steps=4",
                                 "solver.linear=pcg", "solver.preconditioner=block_jacobi")  # fmt: skip
        exact = self.completed(CASES / "cpd/square.toml", "lattice.spacing=0.1", "loading.steps=4",
                               "solver.linear_tolerance=1e-12", "solver.relative_tolerance=1e-12")  # fmt: skip
        orders = {}
        for name, ended in [("inexact", inexact), ("exact", exact)]:
            with open(ended.folder / "convergence.csv", newline="") as file:
                orders[name] = [float(cell) for cell in list(csv.reader(file))[-1][1:] if cell]
        self.assertTrue(orders["exact"])
        # Three residuals that begin at some per cent of the first are not quite quadratic yet; what a
        # linear solver leaves would be of order one and below.
        for order in orders["exact"] + orders["inexact"]:
            self.assertGreater(order, 1.5)
            self.assertLess(order, 2.4)
        self.assertAlmostEqual(statistics.median(orders["exact"]), 2.0, delta=0.15)


if __name__ == "__main__":
    unittest.main()
