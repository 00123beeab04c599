"""Rough use of the package `peristat`: forks, ends of Python, interrupts, and what is neither number nor name."""

import copy
import functools
import io
import multiprocessing
import os
import pathlib
import pickle
import shutil
import subprocess
import sys
import textwrap
import unittest
from unittest import mock

import numpy as np

from tests.acceptance.python_package_test import ROOT, InFolder, ps, strip


def gone(load):
    """A function of the load, by a name that no expression can use."""
    return 1e-5 * load


def script(text, *arguments, **options):
    """Runs a script in a process of its own, in this folder."""
    head = "import sys\nsys.path[:0] = sys.argv[1:3]\nimport peristat as ps\nfrom tests.acceptance.python_package_test import strip\n"
    return subprocess.run([sys.executable, "-c", head + textwrap.dedent(text), ROOT / "python", ROOT, *arguments],
                          capture_output=True, text=True, timeout=300, **options)  # fmt: skip


class TestProcesses(InFolder):
    def test_a_forked_process_solves_after_its_parent_has(self):
        def work(told):
            told.put(strip("child").solve(quiet=True, output="child").status)

        big = strip("big", "0.5 mm")  # has threads of OpenMP, which no fork takes along
        self.assertEqual(big.solve(quiet=True).status, "completed")
        context = multiprocessing.get_context("fork")

        def fork(step):
            if step.number == 2:
                told = context.SimpleQueue()
                child = context.Process(target=work, args=(told,))
                child.start()
                child.join(100)
                child.kill()
                statuses.append("hangs" if told.empty() else told.get())

        statuses = []
        self.assertEqual(big.solve(quiet=True, on_step=fork).status, "completed")
        self.assertEqual(statuses, ["completed"])

    def test_a_run_goes_to_another_process_as_its_results(self):
        run = strip().solve(quiet=True)
        for other in (pickle.loads(pickle.dumps(run)), copy.deepcopy(run)):
            self.assertTrue(other.converged)
            np.testing.assert_array_equal(other.displacement(), run.displacement())

    def test_python_ends_in_order_while_another_thread_works(self):
        works = {
            "a run": "lambda: case.solve(quiet=True, output='left', on_step=lambda step: begun.set())",
            "bodies": "lambda: [(case.body(), begun.set()) for _ in range(1000)]",
            "a loop": "lambda: [begun.set() for _ in case.steps(quiet=True, output='left')]",
        }
        for name, work in works.items():
            with self.subTest(name):
                done = script(f"""
                    import tempfile, threading
                    begun, kept = threading.Event(), tempfile.TemporaryDirectory()
                    case = strip(spacing="0.5 mm")
                    case.loading.steps = 5000
                    threading.Thread(target={work}, daemon=True).start()
                    begun.wait()
                    """)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertNotIn("terminate", done.stderr)
        self.assertEqual(ps.open_results("left").status, "interrupted")

    def test_python_ends_after_a_thread_has_read_its_results(self):
        """A thread that Python's end stopped while it read a file would keep the lock of h5py."""
        done = script("""
            import tempfile, threading, time
            from h5py._objects import phil
            from peristat.run import Run
            begun, kept, begin = threading.Event(), tempfile.TemporaryDirectory(), Run.__init__
            def begin_slowly(self, *given):
                with phil:
                    time.sleep(1.0)
                begin(self, *given)
                print("read", flush=True)
            Run.__init__ = begin_slowly
            case = strip(spacing="0.5 mm")
            case.loading.steps = 5000
            work = lambda: case.solve(quiet=True, output=f"{kept.name}/out", on_step=lambda step: begun.set())
            threading.Thread(target=work, daemon=True).start()
            begun.wait()
            """)
        self.assertEqual((done.returncode, done.stdout.strip()), (0, "read"), done.stderr)

    def test_an_interrupt_ends_a_loop_in_the_midst_of_a_step(self):
        done = script("""
            import os, signal, threading, time
            case = strip(spacing="0.1 mm")  # a step takes minutes
            case.solver.mode = "relaxation"
            case.relaxation.steps = 1
            def interrupt():
                time.sleep(1.0)
                os.kill(os.getpid(), signal.SIGINT)
            try:
                for step in case.steps(quiet=True, output="left"):
                    threading.Thread(target=interrupt).start()
            except KeyboardInterrupt:
                print(step.number, ps.open_results("left").status, ps.open_results("left").steps)
            """)
        self.assertEqual(done.stdout.strip(), "0 interrupted []", done.stderr)

    def test_a_title_that_the_terminal_has_no_letters_for_ends_no_run(self):
        with mock.patch("sys.stdout", io.TextIOWrapper(io.BytesIO(), encoding="ascii")):
            status = strip("träger").solve().status
        self.assertEqual(status, "completed")


class TestFolders(InFolder):
    def test_results_stay_where_they_are_when_the_working_folder_changes(self):
        os.mkdir("other")
        run = strip().solve(quiet=True, on_step=lambda step: step.number == 2 and os.chdir("other"))
        self.assertEqual(run.status, "completed")
        self.assertEqual(run.history["step"][-1], 4)
        self.assertEqual(pathlib.Path("..", "results", "strip").resolve(), run.path.resolve())

    def test_a_path_with_dots_is_that_of_the_program(self):
        self.assertEqual(strip().solve(quiet=True, output="new/../kept").history["step"][-1], 4)

    def test_words_do_not_overwrite(self):
        strip().solve(quiet=True, output="kept")
        for act in (strip("other").solve, lambda **given: ps.sweep(strip("other"), {"loading.steps": [1]}, jobs=2, **given)):
            self.assertRefuses(lambda: act(quiet=True, output="kept", overwrite="no"), "overwrite", "True or False")
        self.assertEqual(ps.open_results("kept").title, "strip")

    def test_a_removed_folder_has_no_status(self):
        run = strip().solve(quiet=True)
        shutil.rmtree(run.path)
        self.assertRefuses(lambda: run.status, "no such folder")
        self.assertRefuses(run.reload, "no such folder")

    def test_text_that_no_file_can_hold_is_refused(self):
        for text, word in (("a\0b", "zero character"), ("\udcff", "Unicode")):
            self.assertRefuses(lambda: strip().solve(output=text, quiet=True), "output.directory", word)
        self.assertEqual(os.listdir(), [])

    def test_names_that_results_do_not_have(self):
        case = strip()
        case.add_probe(name="middle", from_=[0.0, 5e-3], to=[0.04, 5e-3], field="stress")
        run = case.solve(quiet=True)
        self.assertRefuses(lambda: run.lines["midle"], "Did you mean 'middle'")
        self.assertRefuses(lambda: run.point_sets["rigt"], "Did you mean 'right'")
        self.assertRefuses(lambda: run.probes["end"], "There are none")
        self.assertIsNone(run.lines.get("midle"))
        self.assertRefuses(lambda: run.field("stress"), "output.stress = true")
        case.output.stress = True
        self.assertEqual(case.solve(quiet=True).field("stress").shape[1], 3)


class TestCase(InFolder):
    def test_copies_are_of_their_own(self):
        dial = ps.Dial(0.0)
        for copied in (copy.copy, copy.deepcopy, ps.Case.copy):
            with self.subTest(copied.__name__):
                case = strip()
                case.support[1].displacement = [dial, "0"]
                other = copied(case)
                other.title, other.loading.steps = "other", 7
                other.support[0].displacement[0] = "free"
                self.assertEqual((case.title, case.loading.steps, case.support[0].displacement[0]), ("strip", 4, "0"))
                self.assertIs(other.support[1].displacement[0], dial)
        table = copy.copy(case.loading)
        table.steps = 9
        self.assertEqual(case.loading.steps, 4)

    def test_a_case_does_not_share_what_it_is_given(self):
        pull, one, other = ["1e-5*load", "0"], strip(), strip()
        one.support[1].displacement = other.support[1].displacement = pull
        one.support[1].displacement[0] = pull[1] = "9e-5*load"
        self.assertEqual(other.support[1].displacement, ["1e-5*load", "0"])

    def test_elements_of_values_are_got(self):
        case = strip()
        self.assertEqual(case.get("support[1].displacement[0]"), "0.02 mm*load")
        self.assertEqual(case.get("lattice.shape[0].max[1]"), "10 mm")
        self.assertRefuses(lambda: case.get("support[1].displacement[7]"), "no such element")
        self.assertRefuses(lambda: case.set("support[0]", {"set": "left"}), "name a key in it")
        self.assertRefuses(lambda: case.set("support[²].set", "left"), "[²]")
        self.assertRefuses(lambda: case.set(5, "left"), "must be text")


class TestFunctions(InFolder):
    def test_parameters_with_a_value_keep_it(self):
        def pull(load, *, scale=1e-5):
            return scale * load

        gone.__name__ = "größe"
        for function in (pull, functools.partial(lambda load, scale: scale * load, scale=1e-5), gone):
            case = strip()
            case.support[1].displacement = [function, "0"]
            self.assertAlmostEqual(case.solve(quiet=True).displacement().max(), 1e-5)

    def test_masked_values_are_refused(self):
        case = strip()
        case.support[1].displacement = [lambda x: np.ma.masked_greater(1e-6 * x, 0.0), "0"]
        self.assertRefuses(case.body, "masked", error=ValueError)

    def test_a_callback_that_would_return_at_once_is_refused(self):
        async def later(step):
            step.stop()

        def generator(step):
            yield step.stop()

        for callback in (later, generator, "stop"):
            self.assertRefuses(lambda: strip().solve(quiet=True, on_step=callback), "on_step")
            self.assertRefuses(lambda: ps.resume("results/strip", on_step=callback), "on_step")

    def test_a_law_has_numbers_and_a_range(self):
        law = lambda s: 1e-3 * (6e-3 - s) / 5e-3  # noqa: E731
        self.assertRefuses(lambda: ps.sampled_law(lambda s: law(s) + 1e-4j, 1e-3, 6e-3), "complex")
        self.assertRefuses(lambda: ps.sampled_law(lambda s: np.ma.masked_less(law(s), 5e-4), 1e-3, 6e-3), "masked")
        self.assertRefuses(lambda: ps.sampled_law(law, 6e-3, 1e-3), "breaks_at", "larger")
        self.assertRefuses(lambda: ps.sampled_law(law, None, 1e-3), "elastic_until")
        for samples in (0, 2.7, 10**9):
            self.assertRefuses(lambda: ps.sampled_law(law, 1e-3, 6e-3, samples=samples), "samples")


class TestPoints(InFolder):
    def cloud(self, positions, **given):
        case = ps.Case("cloud", given_points=ps.Points(positions, 1e-9, **given), dimension=2)
        case.points = {"horizon": "3.015 mm", "thickness": "1 mm"}
        case.material.youngs_modulus = "200 GPa"
        return case

    def test_what_is_no_real_number_is_refused(self):
        positions = np.stack(np.meshgrid(np.arange(10), np.arange(5)), axis=-1).reshape(-1, 2) * 1e-3
        wrong = {"complex": positions + 1j, "masked": np.ma.masked_greater(positions, 5e-3), "<U": positions.astype(str),
                 "object": [[None, 0.0]], "datetime": positions.astype("M8[s]")}  # fmt: skip
        for word, array in wrong.items():
            self.assertRefuses(lambda: ps.Points(array, 1e-9), "positions", word)
        self.assertRefuses(lambda: ps.Points(positions, 1e-9, sets=[1]), "sets", "dict")
        self.assertRefuses(lambda: ps.Points(positions, 1e-9, columns={5: positions[:, 0]}), "columns", "dict")

    def test_names_of_columns_are_those_of_expressions(self):
        positions = np.stack(np.meshgrid(np.arange(10), np.arange(5)), axis=-1).reshape(-1, 2) * 1e-3
        for name, word in (("pi", "meaning"), ("load", "meaning"), ("a b", "letters"), ("", "letters")):
            self.assertRefuses(self.cloud(positions, columns={name: positions[:, 0]}).body, name, word)


class TestDials(InFolder):
    def test_a_load_factor_that_decreases_is_refused(self):
        pull, case = ps.Dial(0.0), strip()
        case.support[1].displacement = [pull, "0"]
        case.loading.table = [0, 1, 0]

        def loop():
            for step in case.steps(quiet=True):
                pull.turn_to(1e-6 * step.number, step, within=0.25)

        self.assertRefuses(loop, "smaller load factor")
        case.loading.table = [0, 1]
        loop()  # the next run begins anew
        self.assertEqual(pull(1.0), 3e-6)

    def test_a_dial_has_finite_numbers(self):
        for value in ("1e-5", None, float("nan"), 1j, [1.0, 2.0]):
            self.assertRefuses(lambda: ps.Dial(value), "value")
            self.assertRefuses(lambda: ps.Dial().turn_to(value, within=0.1), "value")
        for within in (float("inf"), "0.1", None):
            self.assertRefuses(lambda: ps.Dial().turn_to(1.0, within=within), "within")
        self.assertRefuses(lambda: ps.Dial().turn_to(1.0, 0.5, within=0.1), "must be a step")

    def test_a_loop_that_has_not_begun_has_no_run(self):
        self.assertRefuses(lambda: strip().steps().run, "no step has been asked for", error=RuntimeError)


class TestSweeps(InFolder):
    def test_runs_of_like_names_have_folders_of_their_own(self):
        pulls = [lambda load: 1e-5 * load, lambda load: 2e-5 * load, lambda load: 3e-5 * load]
        swept = ps.sweep(strip(), {"support[1].displacement[0]": pulls}, quiet=True)
        np.testing.assert_allclose(swept.of(lambda run: run.field("displacement").max()), [1e-5, 2e-5, 3e-5])
        self.assertEqual(len(ps.sweep(strip(), {"loading.steps": [2, 2]}, jobs=2, quiet=True).table()), 2)
        ps.sweep(strip(), {"title": ["x" * 300]}, quiet=True)

    def test_a_refused_run_is_told_alike_by_processes_and_the_loop(self):
        errors = [
            self.assertRefuses(lambda: ps.sweep(strip(), {"support[1].set": ["right", "left"]}, jobs=jobs, output=str(jobs)),
                               "contradict")  # fmt: skip
            for jobs in (1, 2)
        ]
        self.assertEqual(str(errors[0]), str(errors[1]))
        self.assertEqual(errors[0].__notes__, ["in the run with support[1].set = left"])
        self.assertEqual(errors[1].__notes__, errors[0].__notes__)

    def test_options_of_processes(self):
        swept = ps.sweep(strip(), {"loading.steps": [1, 2]}, mode="relaxation", jobs=2)
        self.assertEqual({mode for run in swept for mode in run.history["mode"][1:]}, {"relaxation"})
        self.assertRefuses(lambda: ps.sweep(strip(), {"loading.steps": [1]}, jobs=2, on_step=print), "on_step")
        for jobs in (0, -1, "2", 1.5):
            self.assertRefuses(lambda: ps.sweep(strip(), {"loading.steps": [1]}, jobs=jobs), "jobs")
        for vary in (None, [], {"loading.steps": 3}, {"loading.steps": []}):
            self.assertRefuses(lambda: ps.sweep(strip(), vary), "vary")

    def test_an_interrupt_of_the_sweep_alone_ends_its_processes(self):
        done = script("""
            import os, signal, threading, time
            case = strip(spacing="0.5 mm")
            def interrupt():
                while sum(os.path.exists(f"sweep/loading.steps={k}") for k in (9001, 9002)) < 2:
                    time.sleep(0.1)
                os.kill(os.getpid(), signal.SIGINT)
            threading.Thread(target=interrupt).start()
            try:
                ps.sweep(case, {"loading.steps": [9001, 9002, 9003]}, jobs=2, output="sweep")
            except KeyboardInterrupt:
                print([ps.open_results(f"sweep/loading.steps={k}").status for k in (9001, 9002)])
            """)
        self.assertEqual(done.stdout.strip(), "['interrupted', 'interrupted']", done.stderr)
        self.assertEqual(len(os.listdir("sweep")), 2)


if __name__ == "__main__":
    unittest.main()
