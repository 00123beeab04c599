"""Linear solvers through the command line: their choice, their results, their refusals."""

import pathlib
import re
import shutil
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import PROGRAM, ROOT, settings
from tests.reference.results import table

CASES = ROOT / "cases"
BEAM = CASES / "cantilever" / "beam.toml"
PLATE = CASES / "plate_with_hole" / "elastic.toml"
# A shorter and coarser beam: 20 x 5 x 5 points and the clamp.
SMALL = ["lattice.spacing=0.02", "lattice.shape[0].max=[0.4, 0.05, 0.05]", "set[0].where='x > 0.4 - spacing'"]


class LinearSolvers(Folder):
    threads = 2

    def solved(self, case, *changes):
        """The output of a run, and its summary."""
        summary = self.results(case, *changes).summary
        return self.ended.output, summary

    def iterations(self):
        return table(self.folder / "out/iterations.csv")

    def test_every_solver_and_preconditioner_gives_the_same_tip(self):
        _, direct = self.solved(BEAM, *SMALL, "solver.linear=cholesky")
        tip = direct["probes"]["tip"]
        counted = {}
        for linear in ("pcg", "minres", "gmres"):
            for preconditioner in ("auto", "jacobi", "block_jacobi", "rigid_pieces", "surrogate", "sines", "riluk",
                                   "chebyshev", "multigrid"):  # fmt: skip
                with self.subTest(linear=linear, preconditioner=preconditioner):
                    told, summary = self.solved(BEAM, *SMALL, f"solver.linear={linear}",
                                                f"solver.preconditioner={preconditioner}")  # fmt: skip
                    for found, expected in zip(summary["probes"]["tip"], tip):
                        self.assertAlmostEqual(found, expected, delta=1e-9 * max(map(abs, tip)))
                    self.assertGreater(summary["linear_iterations"], 0)
                    of_steps = sum(row["linear_iterations"] for row in self.iterations())
                    self.assertEqual(of_steps, summary["linear_iterations"])
                    self.assertIn("(as the case asks)", told)
                    counted[linear, preconditioner] = summary["linear_iterations"]
        for better in ("rigid_pieces", "surrogate", "multigrid"):
            self.assertLess(counted["pcg", better], 0.5 * counted["pcg", "jacobi"])

    def with_launcher(self, script):
        """A run that iterates, by a program without modules beside it and a substitute for the launcher."""
        launcher = self.write("a house/launcher", "#!/bin/sh\n" + script)
        launcher.chmod(0o755)
        program = shutil.copy(PROGRAM, launcher.with_name("peristat"))
        command = [program, "run", BEAM, "--output", "out", *settings(*SMALL, "solver.linear=pcg")]
        return self.execute(command, environment={"PERISTAT_LAUNCHER": str(launcher)})

    def test_a_module_is_built_by_the_launcher_at_its_first_use(self):
        built = self.with_launcher(f'echo "built: $*"; ln -s "{pathlib.Path(PROGRAM).parent}/$2.so" "$(dirname "$0")"')
        self.assert_completed(built)
        self.assertIn("built: build peristat_trilinos\n", built.errors)

    def test_a_module_that_is_not_built_ends_the_run(self):
        ended = self.with_launcher("echo no compiler >&2; exit 1")
        self.assert_code(ended, 5)
        self.assertRegex(ended.errors, "no compiler\n(.*\n)*.*Trilinos could not be built: see above")

    def test_stored_and_matrix_free_tangents_give_the_same(self):
        stored, first = self.solved(BEAM, *SMALL, "solver.linear=pcg", "solver.tangent=stored")
        free, second = self.solved(BEAM, *SMALL, "solver.linear=pcg", "solver.tangent=matrix_free")
        self.assertNotIn("matrix-free", stored)
        self.assertIn("tangent matrix-free", free)
        for one, other in zip(first["probes"]["tip"], second["probes"]["tip"]):
            self.assertAlmostEqual(one, other, delta=1e-9 * abs(first["probes"]["tip"][1]))

    def test_products_in_single_precision_give_the_same_solution(self):
        beam = (BEAM, *SMALL, "solver.linear=pcg", "solver.tangent=matrix_free")
        plate = (PLATE, "lattice.spacing=5e-4", "loading.steps=1", "solver.linear=pcg", "solver.tangent=matrix_free")
        # The residual of Newton's last iteration; then a system solved to many digits at once.
        for case in (beam, plate, (*beam, "solver.linear_tolerance=1e-11")):
            with self.subTest(case=case):
                found = {}
                for precision in ("double", "single"):
                    results = self.results(*case, f"solver.precision={precision}")
                    rows = self.iterations()
                    found[precision] = (results.summary, float(rows[-1]["relative_residual"]), rows[1]["residual"])
                (double, exact, one), (single, rough, other) = found["double"], found["single"]
                self.assertLess(max(exact, rough), 1e-10)
                self.assertNotEqual(one, other)  # the key has an effect
                self.assertLessEqual(single["newton_iterations"], double["newton_iterations"] + 1)
                self.assertLessEqual(single["linear_iterations"], 1.3 * double["linear_iterations"])
                self.assertAlmostEqual(single["max_displacement"] / double["max_displacement"], 1.0, delta=1e-9)

    def test_auto_says_what_it_chooses_and_why(self):
        told = self.command("check", BEAM).output
        self.assertRegex(told, r"solver +conjugate gradients preconditioned by rigid pieces \(auto: a factorisation "
                               r"is estimated at .* s, iterations at .* s a step\)")  # fmt: skip
        told = self.command("check", PLATE, "lattice.spacing=2.5e-4").output
        self.assertRegex(told, r"solver +conjugate gradients preconditioned by sines on 606 x 200 places \(auto: a "
                               r"factorisation is estimated at .* s, iterations at .* s a step\)")  # fmt: skip
        told = self.command("check", CASES / "bar/tension.toml").output
        self.assertRegex(told, r"solver +CHOLMOD .* \(auto: .*\)")
        told = self.command("check", CASES / "plate_with_hole/square.toml", "solver.mode=newton").output
        self.assertRegex(told, r"solver +CHOLMOD .* \(auto: its pivots show whether the softening body is stable\)")

    def test_a_preconditioner_that_is_named_is_used(self):
        told, _ = self.solved(BEAM, *SMALL, "solver.preconditioner=surrogate")
        self.assertIn("preconditioned by surrogate", told)
        self.assertIn("(as the case asks)", told)

    def test_runs_with_mumps_repeat_to_the_last_bit(self):
        """Scotch orders its matrix: on several cores differently in each run. One run in two would differ."""
        histories = set()
        for _ in range(6):
            output = self.run_case(CASES / "three_point_bending/toughness.toml", words=("--stop-after", 1), code=130)
            histories.add((output / "history.csv").read_text())
        self.assertIn("MUMPS", self.ended.output)
        self.assertEqual(len(histories), 1)

    def test_newton_stays_quadratic_with_iterations(self):
        self.run_case(BEAM, *SMALL)
        residuals = [row["relative_residual"] for row in self.iterations()]
        self.assertLess(residuals[-1], 1e-10)
        self.assertLessEqual(len(residuals), 6)

    def test_what_does_not_go_together_is_refused(self):
        for settings, fragment in (
            (("solver.tangent=matrix_free", "solver.linear=cholesky"), "solver.tangent"),
            (("solver.tangent=matrix_free", "solver.preconditioner=multigrid"), "solver.tangent"),
            (("solver.preconditioner=ilu",), "rigid_pieces"),
            (("solver.linear=cholesky", "solver.preconditioner=surrogate"), "solver.preconditioner"),
            (("solver.linear=cg",), "did you mean pcg"),
            (("solver.linear=lu",), "solver.linear = lu: is for models whose tangent is not symmetric"),
            (("solver.linear=bicgstab",), "solver.linear = bicgstab: is for models whose tangent is not"),
            (("solver.preconditioner=local_operator",),
             "solver.preconditioner = local_operator: is for models whose tangent is not"),
        ):
            with self.subTest(settings=settings):
                self.assert_refused(self.command("check", BEAM, *settings), fragment)
        run = self.command("check", CASES / "cpd/square.toml", "solver.tangent=matrix_free")
        self.assert_refused(run, "solver.tangent = matrix_free: is for bonds and states alone")

    def test_sines_say_what_they_are_not_for(self):
        text = PLATE.read_text()
        left = text.index('[[support]]\nset = "left"')
        rigid = '[[rigid]]\nset = "left"\n\n'
        pinned = self.write("pinned.toml", text[:left] + rigid + text[text.index('[[support]]\nset = "right"'):])
        for case, settings, fragment in (
            (PLATE, ("lattice.angle=30",), "is for lattices along the axes"),
            (pinned, (), "is for bodies without rigid sets"),
            (CASES / "buckling" / "arch.toml", ("solver.mode='newton'",), "the points do not lie on a lattice"),
        ):
            for command in ("check", "run"):
                with self.subTest(case=case.name, command=command):
                    run = self.command(command, case, "solver.preconditioner=sines", *settings)
                    self.assert_refused(run, fragment, "solver.preconditioner = sines", "rigid_pieces")

    def test_auto_keeps_rigid_pieces_where_sines_are_no_good(self):
        fine = "lattice.spacing=2.5e-4"
        for settings in (("lattice.angle=90",), ("crack=[{from=[-0.01, 0.01], to=[0.01, 0.01]}]",)):
            with self.subTest(settings=settings):
                told = self.assert_completed(self.command("check", PLATE, fine, *settings))
                self.assertIn("preconditioned by rigid pieces", told.output)

    def beam_of(self, half_width):
        return [f"lattice.shape[0].min=[0, -{half_width}, -{half_width}]",
                f"lattice.shape[0].max=[1, {half_width}, {half_width}]"]  # fmt: skip

    def test_check_estimates_the_memory_within_15_percent(self):
        plate = CASES / "plate_with_hole" / "elastic.toml"
        wide = self.beam_of(0.1)
        for case, settings in [(BEAM, []), (BEAM, ["solver.tangent=stored"]), (BEAM, ["solver.linear=cholesky"]),
                               (BEAM, wide), (BEAM, wide + ["solver.tangent=stored", "solver.linear=pcg"]),
                               (BEAM, wide + ["solver.preconditioner=jacobi"]),
                               (BEAM, wide + ["solver.linear=gmres"]),
                               (plate, []), (plate, ["solver.linear=cholesky"]),
                               (plate, ["solver.preconditioner=multigrid"])]:  # fmt: skip
            with self.subTest(case=case.name, settings=settings):
                check = self.command("check", case, *settings)
                told = re.search(r"^memory +about ([0-9.]+) (MB|GB)", check.output, re.MULTILINE)
                estimate = float(told[1]) * {"MB": 1e6, "GB": 1e9}[told[2]]
                _, summary = self.solved(case, *settings)
                self.assertLess(abs(estimate / summary["peak_memory_bytes"] - 1.0), 0.15)

    def test_memory_per_point_in_3d(self):
        for tangent, most in [("matrix_free", 1200), ("stored", 5000)]:
            with self.subTest(tangent=tangent):
                used = []
                for half_width in (0.12, 0.24):  # so large that the libraries' own memory is a small part
                    _, summary = self.solved(BEAM, *self.beam_of(half_width), "solver.linear=pcg",
                                             f"solver.tangent={tangent}")  # fmt: skip
                    used.append((summary["points"], summary["peak_memory_bytes"]))
                (few, less), (many, more) = used
                self.assertGreater(many, 3 * few)
                self.assertLess((more - less) / (many - few), most)


if __name__ == "__main__":
    unittest.main()
