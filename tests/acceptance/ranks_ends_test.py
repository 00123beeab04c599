"""Endings of runs on several MPI ranks, and refused cases."""

import json
import os
import re
import resource
import signal
import subprocess
import time
import unittest
from pathlib import Path

import h5py
import numpy

from tests.acceptance.on_ranks import (
    BAR,
    ENVIRONMENT,
    PLATE,
    SOLVER,
    SQUARE,
    STATES,
    OnRanks,
    children_of,
    rows,
)
from tests.reference.program import PROGRAM, limited_by_shell, settings


def fine(spacing, steps):
    return PLATE.replace("spacing = 0.05", f"spacing = {spacing}").replace("steps = 2", f"steps = {steps}") + SOLVER


class Ends(OnRanks):
    def test_a_search_that_does_not_converge(self):
        options = ("solver.max_iterations=1", "loading.adaptive=false")
        codes, statuses, dossiers, residuals = [], [], [], []
        for ranks in (1, 3):
            run, output = self.ended_on(ranks, PLATE + SOLVER, *options)
            codes.append(run.code)
            self.assertIn('"not_converged"', (output / "summary.json").read_text())
            dossiers.append((output / "dossier.txt").read_text())
            self.assertFalse((output / "parts").exists())
            with h5py.File(output / "results.h5") as file:
                residuals.append(file["dossier/residual"][()])
                self.assertEqual(file["dossier/displacement"].shape, residuals[-1].shape)
            statuses.append([row["outcome"] for row in rows(output, "decisions.csv")])
        self.assertEqual(codes, [3, 3])
        self.assertEqual(statuses[0], statuses[1])
        self.assertLess(numpy.abs(residuals[0] - residuals[1]).max(), 1e-9 * numpy.abs(residuals[0]).max())
        worst = [re.findall(r"^  (\d+)  ", text, re.MULTILINE) for text in dossiers]
        self.assertEqual(worst[0], worst[1])
        self.assertEqual(len(worst[0]), 10)

    def test_places_off_the_body(self):
        for probe, what in (("at=[5, 5]", "within two spacings"), ("from=[5, 0], to=[5, 1]", "within half a spacing")):
            for text in self.refusals(*((ranks, PLATE, f'probe=[{{name="p", {probe}}}]') for ranks in (1, 2))):
                self.assertIn(what, text)

    def test_what_one_rank_alone_meets_ends_all(self):
        broken = PLATE.replace('"0.05*load"', '"0.05*load*(x > 0.96 ? 1/(1-load) : 1)"')
        said = self.refusal(broken)
        self.assertIn("it must be finite", said)
        self.assertEqual(said.count("peristat:"), 1)

    def test_a_value_that_one_rank_alone_misses_on_the_way(self):
        missing = PLATE.replace('"0.05*load"', '"0.05*load*(x > 0.96 ? (load-0.25)/(load-0.25) : 1)"')
        outcomes = []
        for ranks in (1, 2):
            output = self.run_on(ranks, missing.replace("steps = 2", "steps = 4") + SOLVER)
            outcomes.append([(row["outcome"], row["reason"]) for row in rows(output, "decisions.csv")])
        self.assertEqual(outcomes[0][0], outcomes[1][0])
        self.assertIn("undefined_condition", outcomes[0][0])

    def test_a_folder_that_can_not_be_written(self):
        self.write("on_2", "in the way")
        self.run_on(2, PLATE, code=2)
        self.assertIn("is a file", self.ended.errors)

    def start_on_two(self, text, **options):
        words = [PROGRAM, "run", "--ranks", 2, self.case(text), "--threads", 1, "--output", "out"]
        return self.start(words, ENVIRONMENT, stdout=subprocess.DEVNULL, **options)

    def test_a_rank_that_is_killed_ends_all(self):
        run = self.start_on_two(fine(0.025, 5000), stderr=subprocess.DEVNULL)
        ranks = self.wait_for_ranks(run.pid, rows=3)
        os.kill(ranks[-1], signal.SIGKILL)
        self.assertNotEqual(run.wait(timeout=20), 0)
        for rank in ranks:
            self.assertFalse(Path(f"/proc/{rank}/exe").exists())
        self.assertFalse((self.folder / "out/summary.json").exists())
        self.expect_going_on(self.folder / "out", 1, 3)

    def expect_going_on(self, output, *numbers_of_ranks):
        """The files of a run are readable, and the run can be resumed."""
        with h5py.File(output / "results.h5") as file:
            steps = file["history/step"][()]
            self.assertGreaterEqual(len(steps), 2)
            self.assertEqual(list(file["steps"]), [f"{step:06}" for step in steps if step > 0])  # nothing moves at load 0
        for ranks in numbers_of_ranks:
            run = self.resume_on(ranks, output, words=("--stop-after", 2), code=130)
            self.assertIn("continuing after step", run.output)
        with h5py.File(output / "results.h5") as file:
            self.assertGreaterEqual(len(file["history/step"]), len(steps) + 2 * len(numbers_of_ranks) - 1)

    def test_files_that_can_not_grow_end_all(self):
        """Like a full disk, which faults_test.py tests for one rank."""
        run = self.start_on_two(fine(0.025, 5000))
        for rank in self.wait_for_ranks(run.pid, rows=3):
            resource.prlimit(rank, resource.RLIMIT_FSIZE, (1 << 14, 1 << 14))
        said = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 5, said)
        self.assertRegex(said, "accepted steps? (is|are) in")
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual(summary["status"], "failed", said)
        self.assertGreater(summary["steps"], 1)
        self.expect_going_on(self.folder / "out", 3)

    def test_a_rank_that_gets_no_more_memory_ends_all(self):
        """During construction of the parts, and during the search."""
        words = [PROGRAM, "run", self.case(fine(0.006, 1)), "--threads", 1, "--output", "out", "--overwrite",
                 *settings("solver.max_iterations=1", "loading.adaptive=false")]  # fmt: skip
        codes = []
        for kilobytes in range(740000, 1500000, 60000):
            limited = limited_by_shell(f"ulimit -v {kilobytes}", words)
            both = ["-np", 1, *words, ":", "-np", 1, *limited]
            run = self.execute(["mpirun", "--oversubscribe", "--bind-to", "none", *both])
            codes.append(run.code)
            if run.code == 4:
                self.assertRegex(run.errors, "peristat: (out of memory|.* are available)")
            else:
                self.assert_code(run, 3)
                break
        self.assertIn(4, codes)
        self.assertEqual(codes[-1], 3)

    def test_an_interruption_ends_a_run_in_order(self):
        run = self.start_on_two(fine(0.01, 500))
        self.wait_for_ranks(run.pid)
        run.send_signal(signal.SIGINT)
        said = run.communicate(timeout=60)[1]
        self.assertEqual(run.returncode, 130, said)
        self.assertIn("interrupted", said)
        self.assertIn('"interrupted"', (self.folder / "out/summary.json").read_text())

    def wait_for_ranks(self, launcher, rows=0):
        """Process numbers, once the history has the given number of rows (the first is step 0)."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            time.sleep(0.05)
            history = self.folder / "out/history.csv"
            if not (self.folder / "out/results.h5").exists() or history.read_text().count("\n") <= rows:
                continue
            mpirun = children_of(launcher)
            ranks = children_of(mpirun[0]) if mpirun else []
            if len(ranks) == 2:
                return ranks
        self.fail("no ranks")


class Refusals(OnRanks):
    def test_keys_that_are_not_on_the_list(self):
        keys = (
            'solver.mode="arc_length"',
            'solver.mode="path"',
            'solver.linear="cholesky"',
            'solver.linear="lu"',
            'solver.preconditioner="sines"',
            'solver.preconditioner="local_operator"',
            'lattice.points="blue_noise"',
            'control=[{set="corner", weights=[1, 0]}]',
        )
        for key, said in zip(keys, self.refusals(*((2, PLATE, key) for key in keys))):
            with self.subTest(key=key):
                self.assertIn(key.split("=")[0].split(".")[0], said)
                self.assertEqual(said.count("peristat:"), 1)

    def test_convolutions(self):
        """Bonds replace them if the material has some."""
        said = self.refusal(PLATE, 'solver.operator="fft"')
        self.assertIn("solver.operator", said)
        self.assertIn('take "bonds" or "auto"', said)
        self.assertIn('"bonds" sums along rows', self.refusal(PLATE, 'solver.operator="stencil"'))
        for operator in ("fft", "auto"):
            said = self.refusal(PLATE, f'solver.operator="{operator}"', 'material.model="green_bond"')
            self.assertIn("models with bonds", said)

    def test_what_one_rank_refuses_too(self):
        cases = (
            (PLATE.replace('set = "top"', 'set = "no"'), "no set"),
            (PLATE.replace('where = "x > 0.6', 'where = "x > 6'), "selects no point"),
            (PLATE.replace("displacement = [0, 0]", 'displacement = [0, "free"]')
             .replace('[0, "0.05*load"]', '[0, "free"]'), "move along y"),
            (BAR + '[[support]]\nset = "left"\ndisplacement = [1]\n', "contradict"),
            (SQUARE.replace("c1 = 1.0\nc2 = 30.0", "youngs_modulus = 1e6\npoisson_ratio = -0.6"), "unstable before"),
            (SQUARE.replace("max = [1.2, 1]", "max = [1.2, 0.1]").replace("min = [0.5, 0.4]", "min = [0.5, 0]"), "no triangles"),
        )  # fmt: skip
        tried = [(ranks, text, what) for ranks in (1, 2) for text, what in cases]
        for (ranks, _, what), said in zip(tried, self.refusals(*((ranks, text) for ranks, text, _ in tried))):
            with self.subTest(ranks=ranks, what=what):
                self.assertIn(what, said)

    def test_what_all_ranks_meet_is_told_once(self):
        """Each of them has points of both supports."""
        twice = '[[set]]\nname = "all"\nwhere = "y > -1"\n' + 2 * '[[support]]\nset = "all"\ndisplacement = [VALUE, 0]\n'
        said = self.refusal(PLATE.split("[[support]]")[0] + twice.replace("VALUE", "0", 1).replace("VALUE", "1"), ranks=4)
        self.assertEqual(said.count("contradict"), 1, said)

    def test_the_printed_form(self):
        """Only convolutions support it."""
        said = self.refusal(STATES, 'quadrature.form="printed"', 'quadrature.volume_correction="none"')
        self.assertIn("models with bonds", said)

    def test_pieces_that_nothing_holds(self):
        apart = PLATE.replace('{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
                              '{ subtract = "box", min = [-1, 0.5], max = [2, 0.8] }')  # fmt: skip
        apart += ('[[crack]]\nfrom = [0.5, 0.2]\nto = [0.5, 0.3]\n[[crack]]\nfrom = [-1, 1]\nto = [2, 1]\n'
                  '[[crack]]\nfrom = [-1, 1.3]\nto = [2, 1.3]\n')  # fmt: skip
        self.expect_the_same_refusal(apart, "a part of")

    def test_points_on_too_few_bonds(self):
        chain = PLATE.replace("shape = [{", 'shape = [{ add = "box", min = [1, 1], max = [1.2, 1.04] }, {')
        self.expect_the_same_refusal(chain, "too few bonds")

    def expect_the_same_refusal(self, text, words):
        one, several = (said.replace("case_1", "case_0") for said in self.refusals((1, text), (3, text)))
        self.assertIn(words, one)
        self.assertEqual(one, several)

    def test_another_number_of_ranks_than_was_started(self):
        run = self.execute(["mpirun", "--oversubscribe", "-np", 2, PROGRAM, "run", "--ranks", 3, self.case(PLATE)])
        self.assert_refused(run, "does not match the number of ranks started, 2")

    def test_other_commands(self):
        run = self.execute(["mpirun", "--oversubscribe", "-np", 2, PROGRAM, "check", self.case(PLATE)])
        self.assert_refused(run, "only the commands run and resume")


if __name__ == "__main__":
    unittest.main()
