"""Cases that invite a wrong answer: each ends with the right one, or reports why it has none."""

import math
import statistics
import unittest

from tests.acceptance.folder import Folder
from tests.acceptance.strip import PULLED
from tests.reference.program import ROOT

CASES = ROOT / "cases"
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
# Nothing is free; at the end the last bonds are stretched by a hundredth beyond their strength.
ALL_PRESCRIBED = """\
[[set]]
name = "inside"
where = "x > 0 && x < 0.01"
[[support]]
set = "inside"
displacement = [0, 0]
"""


class Damage(Folder):
    def test_a_relaxed_step_far_beyond_the_onset_of_damage_is_told(self):
        # Its strength is at 1e-4 m; steps are a fiftieth of the load.
        for load, is_far in (("5e-4", False), ("0.2", True)):
            decisions = self.results(ROW, f"support[1].displacement[0]={load}*load", "solver.mode=adaptive",
                                     "loading.stop_below=0.2").table("decisions")  # fmt: skip
            told = any("would be missed" in row["reason"] for row in decisions)
            self.assertEqual(told, is_far, decisions)

    def test_a_jump_that_would_tear_every_bond_at_once_is_followed_step_by_step(self):
        # One step asks for 22 times the strength: the supports' jump alone breaks all bonds across
        # it, and the torn body has no residual. No energy may be dissipated that no work has done.
        for steps in (1, 30):
            rows = self.results(SQUARE, "solver.mode=newton", f"loading.steps={steps}", "loading.smallest_step=2e-3",
                                code=3).table("history")  # fmt: skip
            for row in rows:
                self.assertLessEqual(row["dissipated_energy"], 1.05 * row["external_work"])
            # A control by damage in 300 small steps finds the limit point between 0.554 and 0.586.
            reached = rows[-1]["load_factor"]
            self.assertGreater(reached, 0.54)
            self.assertLess(reached, 0.60)

    def test_an_elastic_stand_in_without_damage_is_refused(self):
        said = self.refusal(PULLED + '[solver]\nmode = "adaptive"\n', "solver.elastic_horizon_ratio=1.5")
        self.assertIn("without damage", said)

    def test_points_that_are_loose_from_the_start_are_refused(self):
        # A row of points, each with two bonds along it: pins would carry the load across it.
        row = ROW.replace("max = [0.01, 0.002]", "max = [0.01, 0.001]")
        for mode in ("newton", "relaxation", "adaptive"):
            self.run_case(ROW, f"solver.mode={mode}")
            self.assertIn("no bond resists their motion along y", self.refusal(row, f"solver.mode={mode}"))

    def test_a_step_that_its_jump_completes_has_its_damage(self):
        # All points are prescribed: the jump alone is the step. Bonds that it breaks carry nothing.
        text = ROW.replace("1e-5*load", "2e-5*load") + ALL_PRESCRIBED
        rows = self.results(text, "solver.mode=newton").table("history")[1:]
        torn = [row for row in rows if row["stored_energy"] == 0.0]
        self.assertGreater(rows[0]["reaction_x:right"], 0.0)
        self.assertGreater(len(torn), 0)
        for row in torn:
            self.assertEqual(row["reaction_x:right"], 0.0)


class Threads(Folder):
    def test_threads_that_the_system_does_not_grant_by_itself_all_run(self):
        reaction = self.results(BAR).summary["reactions"]
        for name, value in [("OMP_DYNAMIC", "true"), ("OMP_MAX_ACTIVE_LEVELS", "0"),
                            ("OMP_NESTED", "true")]:  # fmt: skip
            summary = self.results(BAR, threads=8, environment={name: value}).summary
            self.assertEqual(summary["threads"], 8)
            for set_name, force in summary["reactions"].items():
                for now, expected in zip(force, reaction[set_name]):
                    self.assertTrue(math.isclose(now, expected, rel_tol=1e-10, abs_tol=1e-9))


class Supports(Folder):
    SECOND = '[[support]]\nset = "right"\ndisplacement = ["{}", "free"]\n'

    def test_contradictions_away_from_the_ends_and_the_middle_are_found(self):
        text = PULLED.replace('"1e-5*load"', '"1e-3*load*(load-0.5)*(load-1)"')
        self.assertIn("contradict each other", self.refusal(text + self.SECOND.format("0")))

    def test_a_contradiction_that_shows_in_mid_run_fails_its_step(self):
        text = PULLED + self.SECOND.format("1e-5*load + (abs(load-0.42)<1e-9 ? 1e-6 : 0)")
        results = self.results(text, "loading.steps=50", "loading.adaptive=false", code=3)
        self.assertIn("contradict each other", self.ended.said)
        self.assertEqual(results.summary["steps"], 20)

    def test_the_last_digits_of_two_expressions_are_no_contradiction(self):
        text = PULLED.replace('"1e-5*load"', '"1e-5*load*3"')
        self.run_case(text + self.SECOND.format("3e-5*load"))

    def test_an_expression_without_a_value_in_mid_run_is_a_failed_step(self):
        text = PULLED.replace('"1e-5*load"', '"1e-5*load+0*ln(abs(load-0.3)>1e-6?1:-1)"')
        results = self.results(text, "loading.steps=10", "loading.adaptive=false", code=3)
        self.assertIn("case.toml:22:17", self.ended.said)
        self.assertIn("support[1].displacement[0]", self.ended.said)
        self.assertEqual(results.summary["status"], "not_converged")
        self.assertEqual(results.summary["steps"], 2)
        self.assertTrue((results.folder / "dossier.txt").exists())
        # With steps that may be cut, the run avoids the single place without a value.
        self.run_case(text, "loading.steps=10")


class Magnitudes(Folder):
    def test_bodies_too_far_from_the_origin_are_refused(self):
        text = PULLED.replace("[0.0, 0.0]", "[1e12, 0.0]").replace("[0.02, 0.01]", "[1000000000000.02, 0.01]")
        self.assertIn("origin", self.refusal(text))
        self.write("points.txt", "".join(f"{x} 0 1\n" for x in [0, 1, 2, 3, 1e300]))
        self.run_case('dimension = 2\n[points]\nfile = "points.txt"\nhorizon = 2\n[material]\n'
                      'youngs_modulus = 1\n[[set]]\nname = "a"\nwhere = "x < 9"\n[[support]]\n'
                      'set = "a"\ndisplacement = [0, 0]\n', code=2)  # fmt: skip

    def test_displacements_may_be_as_small_as_digits_go(self):
        expected = self.results(PULLED).summary["reactions"]["right"][0]
        small = PULLED.replace('"1e-5*load"', '"1e-90*load"')
        force = self.results(small).summary["reactions"]["right"][0]
        # Linear: at 1e-5 m the stretch is 5e-4, at which finite deformation changes the force.
        self.assertTrue(math.isclose(force / 1e-90, expected / 1e-5, rel_tol=2e-3))
        vanishing = PULLED.replace('"1e-5*load"', '"1e-170*load"')
        summary = self.results(vanishing, code=3).summary
        self.assertEqual(summary["status"], "inconsistent")
        self.assertEqual(summary["steps"], 0)


class SlenderBodies(Folder):
    def test_cantilevers_converge_or_end_at_round_off(self):
        for slenderness in (60, 200):
            length = 0.025 * slenderness
            results = self.results(
                CANTILEVER, f"lattice.shape[0].max=[{length},0.025]",
                f"set[0].where='x > {length} - spacing'", 'load[0].body_force=["0","-1*load"]',
                threads=2)  # fmt: skip
            summary = results.summary
            self.assertEqual(summary["steps"], 1)
            self.assertLessEqual(summary["newton_iterations"], 10)
            actions = {row["action"] for row in results.table("decisions")}
            last = results.table("iterations")[-1]["relative_residual"]
            if actions != {"accept at round-off"}:
                self.assertLessEqual(last, 1e-10)
            self.assertLessEqual(last, 1e-6)
            # The support carries the load: body force times volume.
            (load,) = [load for load in summary["reactions"].values()]
            self.assertGreater(load[1], 0.0)


class Tangents(Folder):
    def test_orders_are_only_told_where_linear_systems_were_exact_enough(self):
        orders = {}
        for name, changes in (("inexact", ["solver.linear=pcg", "solver.preconditioner=block_jacobi"]),
                              ("exact", ["solver.linear_tolerance=1e-12", "solver.relative_tolerance=1e-12"])):  # fmt: skip
            results = self.results(CASES / "cpd/square.toml", "lattice.spacing=0.1", "loading.steps=4", *changes)
            orders[name] = [cell for cell in list(results.table("convergence")[-1].values())[1:] if cell != ""]
        self.assertTrue(orders["exact"])
        # Three residuals that begin at some per cent of the first are not quite quadratic yet; the error of a
        # linear solver would give an order of one or below.
        for order in orders["exact"] + orders["inexact"]:
            self.assertGreater(order, 1.5)
            self.assertLess(order, 2.4)
        self.assertAlmostEqual(statistics.median(orders["exact"]), 2.0, delta=0.15)


if __name__ == "__main__":
    unittest.main()
