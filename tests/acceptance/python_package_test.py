"""The package `peristat`: cases, bodies, runs, steps, callbacks, functions, points, sweeps, and what is refused."""

import contextlib
import gc
import io
import math
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = pathlib.Path(os.environ.get("PERISTAT_PROGRAM", ROOT / "build/release/peristat"))
os.environ.setdefault("PERISTAT_BUILD", str(PROGRAM.parent))
sys.path.insert(0, str(ROOT / "python"))

import peristat as ps  # noqa: E402

SHIPPED = ["cantilever/beam", "plate_with_hole/elastic", "thermal/bimetal", "cpd/poisson_2d"]


def strip(name="strip", spacing="2 mm"):
    """A strip of 40 x 10 mm that is pulled by 0.02 mm in four steps."""
    case = ps.Case(name, dimension=2)
    case.lattice = {"spacing": spacing, "thickness": "1 mm"}
    case.lattice.add_shape(add="box", min=["0 mm", "0 mm"], max=["40 mm", "10 mm"])
    case.lattice.add_layer(name="left", side="x-")
    case.lattice.add_layer(name="right", side="x+")
    case.material.youngs_modulus = "200 GPa"
    case.add_support(set="left", displacement=["0", "0"])
    case.add_support(set="right", displacement=["0.02 mm*load", "0"])
    case.loading.steps = 4
    return case


class InFolder(unittest.TestCase):
    """Each test works in a folder of its own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(folder.name)

    def assertRefuses(self, act, *words, error=ps.InputError):
        with self.assertRaises(error) as caught:
            act()
        for word in words:
            self.assertIn(word, str(caught.exception))
        return caught.exception


class TestSameAsCommandLine(InFolder):
    def test_histories_of_shipped_cases_are_those_of_the_command_line_to_the_last_bit(self):
        for name in SHIPPED:
            with self.subTest(case=name):
                file = ROOT / f"cases/{name}.toml"
                stem = name.replace("/", "_")
                command = [PROGRAM, "run", file, "--output", f"program_{stem}", "--quiet"]
                subprocess.run(command, check=True)
                run = ps.load_case(file).solve(output=f"python_{stem}", quiet=True)
                self.assertEqual(run.status, "completed")
                histories = [
                    (pathlib.Path(f"{which}_{stem}") / "history.csv").read_text()
                    for which in ("program", "python")
                ]
                self.assertEqual(*histories)

    def test_text_of_a_changed_case_says_what_the_file_says(self):
        case = ps.load_case(ROOT / "cases/plate_with_hole/elastic.toml")
        before = case.resolved()
        case.loading.steps = case.get("loading.steps", 1) + 1  # no longer the file's text
        case.loading.steps -= 1
        changed = case.copy()
        changed.title = "another title"
        self.assertIn("another title", changed.text())
        expected = [line for line in before.splitlines() if not line.startswith("title")]
        found = [line for line in changed.resolved().splitlines() if not line.startswith("title")]
        self.assertEqual([line for line in found if "directory" not in line],
                         [line for line in expected if "directory" not in line])  # fmt: skip

    def test_a_changed_file_goes_on_from_python(self):
        case = strip()
        case.save("strip.toml")
        loaded = ps.load_case("strip.toml")
        loaded.support[1].displacement[0] = "0.01 mm*load"  # in place
        run = loaded.solve(quiet=True, on_step=lambda step: step.number == 2 and step.stop())
        self.assertEqual(run.resume(quiet=True).history["step"][-1], 4)
        self.assertAlmostEqual(run.reload().field("displacement").max(), 1e-5)

    def test_settings_of_a_loaded_case_are_those_of_the_command_line(self):
        case = ps.load_case(ROOT / "cases/cantilever/beam.toml")
        case.set("loading.steps", 3)
        run = case.solve(output="set", quiet=True)
        self.assertEqual(run.settings["loading.steps"], "3")
        self.assertEqual(run.history["step"][-1], 3)


class TestArrays(InFolder):
    def test_displacement_of_a_run_is_a_view_that_cannot_be_written(self):
        run = strip().solve(quiet=True)
        first, second = run.displacement(), run.displacement()
        address = lambda array: array.__array_interface__["data"][0]  # noqa: E731
        self.assertEqual(address(first), address(second))
        self.assertFalse(first.flags.owndata)
        with self.assertRaises(ValueError):
            first[0] = 1.0
        np.testing.assert_array_equal(first, run.displacement(run.steps[-1]))

    def test_a_view_keeps_its_body_alive(self):
        body = strip().body()
        expected = body.positions.copy()
        positions = body.positions
        del body
        gc.collect()
        np.testing.assert_array_equal(positions, expected)

    def test_sets_are_numbers_of_points(self):
        body = strip().body()
        x = body.positions[:, 0]
        self.assertTrue((x[body.sets["right"]] > 0.04).all())
        self.assertAlmostEqual(body.volumes.sum() / body.count, 4e-9, delta=1e-20)


class TestCase(InFolder):
    def test_a_misspelt_key_is_refused_at_once(self):
        self.assertRefuses(lambda: strip().set("material.youngs_moduls", 1), "youngs_modulus")
        with self.assertRaises(AttributeError) as caught:
            strip().material.youngs_moduls  # noqa: B018
        self.assertIn("youngs_modulus", str(caught.exception))

    def test_wrong_values_are_refused_by_their_keys(self):
        wrong = {
            "material.youngs_modulus": ("200 GPx", "no unit"),
            "lattice.spacing": ("1 kg", "must be a length"),
            "support[1].set": ("rigt", "did you mean right"),
            "support[1].displacement": (["0"], "array of 2"),
            "loading.steps": (2.5, "whole number"),
            "dimension": (4, "1 to 3"),
        }
        for key, (value, words) in wrong.items():
            with self.subTest(key=key):
                case = strip()
                case.set(key, value)
                error = self.assertRefuses(case.body, key.partition("[")[0], words)
                self.assertEqual(error.key, key)
                self.assertNotIn("Python", str(error))  # lines of a text that nobody has written

    def test_values_that_no_case_file_has_are_refused(self):
        for value in (object(), float("nan"), [1j], {"a": None}):
            with self.subTest(value=value):
                case = strip()
                case.support[1].displacement = [value, "0"]
                self.assertRefuses(case.body, "support[1].displacement[0]")

    def test_tables_and_lists_are_asked_for(self):
        self.assertRefuses(lambda: strip().set("material", 3), "must be a table")
        self.assertRefuses(lambda: strip().set("support", {"set": "left"}), "list of tables")
        self.assertRefuses(lambda: strip().set("support[7].set", "left"), "[7]")

    def test_a_file_is_refused_with_its_line(self):
        pathlib.Path("bad.toml").write_text("dimension = 2\n[lattic]\nspacing = 1\n")
        self.assertRefuses(lambda: ps.load_case("bad.toml"), "bad.toml:2", "lattice")
        pathlib.Path("worse.toml").write_text("dimension = 2\n[lattice\n")
        self.assertRefuses(lambda: ps.load_case("worse.toml"), "worse.toml:2")
        self.assertRefuses(lambda: ps.load_case("none.toml"), "none.toml")

    def test_a_saved_case_is_the_same_and_is_not_overwritten(self):
        case = strip()
        case.title = 'a "quoted"\nline'
        case.save("strip.toml")
        saved, given = (text.splitlines() for text in (ps.load_case("strip.toml").resolved(), case.resolved()))
        self.assertEqual([line for line in saved if not line.startswith("directory")],
                         [line for line in given if not line.startswith("directory")])  # fmt: skip
        self.assertRefuses(lambda: case.save("strip.toml"), "exists")

    def test_a_copy_is_of_its_own(self):
        case = strip()
        other = case.copy()
        other.support[1].displacement[0] = "1 mm*load"
        self.assertEqual(case.support[1].displacement[0], "0.02 mm*load")

    def test_check_tangent_and_calibrate_are_dicts(self):
        self.assertLess(strip().check_tangent()["tangent_error"], 1e-6)
        self.assertGreater(strip().calibrate()["micromodulus"], 0.0)

    def test_check_tells_warnings(self):
        self.assertEqual(strip().check().warnings, [])
        self.assertIn("points", strip().check())


class TestFunctions(InFolder):
    def test_a_function_gives_what_its_expression_gives(self):
        case = strip()
        given = case.copy()
        given.support[1].displacement = [lambda load: 2e-5 * load, lambda x: 0.0 * x]
        np.testing.assert_array_equal(
            case.solve(quiet=True).displacement(), given.solve(quiet=True).displacement()
        )

    def test_a_function_is_called_once_for_all_points_of_a_set(self):
        shapes = []

        def bend(x, load):
            shapes.append((np.shape(x), type(load)))
            return 1e-6 * load * x / 0.04

        case = strip()
        case.support[1].displacement = ["0", bend]
        body = case.body()
        self.assertEqual({shape for shape, _ in shapes}, {(len(body.sets["right"]),)})
        self.assertEqual({kind for _, kind in shapes}, {float})

    def test_units_of_the_case_are_those_of_the_function(self):
        case = strip()
        metres = case.copy()
        metres.support[1].displacement = [lambda x, load: 2e-5 * load + 0 * x, "0"]
        millimetres = case.copy()
        millimetres.units = {"length": "mm"}

        def pull(x, load):
            self.assertGreater(np.min(x), 1.0)  # mm
            return 0.02 * load + 0 * x

        millimetres.support[1].displacement = [pull, "0"]
        expected = metres.solve(quiet=True).displacement()
        np.testing.assert_allclose(millimetres.solve(quiet=True).displacement(), expected, rtol=1e-12, atol=1e-20)

    def test_what_a_function_raises_or_returns_wrongly(self):
        wrong = [
            (lambda load: 1 / 0, ZeroDivisionError, "division"),
            (lambda load: "much", TypeError, "in place of numbers"),
            (lambda x: np.zeros(3), ValueError, "shape (3,)"),
            (lambda load: float("nan"), ps.InputError, "finite"),
            (lambda q: q, ps.InputError, "unknown variable q"),
            (lambda *all: 0, ps.InputError, "parameters by name"),
        ]
        for function, error, words in wrong:
            with self.subTest(words=words):
                case = strip()
                case.support[1].displacement = [function, "0"]
                self.assertRefuses(case.body, words, error=error)

    def test_a_run_with_functions_goes_on_with_them_alone(self):
        case = strip()
        case.support[1].displacement = [lambda load: 2e-5 * load, "0"]
        run = case.solve(quiet=True, on_step=lambda step: step.number == 2 and step.stop("enough"))
        self.assertRefuses(lambda: ps.resume(run.path, quiet=True), "python_lambda")
        self.assertEqual(run.resume(quiet=True).history["step"][-1], 4)

    def test_a_run_does_not_go_on_with_another_function(self):
        case = strip()
        case.support[1].displacement = [lambda load: 2e-5 * load, "0"]
        run = case.solve(quiet=True, on_step=lambda step: step.number == 2 and step.stop())
        other = strip()
        other.support[1].displacement = [lambda load: 3e-5 * load, "0"]
        self.assertRefuses(lambda: ps.resume(run.path, case=other, quiet=True), "functions", "5e-06 m")

    def test_functions_of_time_move_a_body_as_their_expressions_do(self):
        case = ps.Case("bar", dimension=1)
        case.lattice = {"spacing": 0.01, "area": 1e-4}
        case.lattice.add_shape(add="box", min=[0.0], max=[1.0])
        case.lattice.add_layer(name="left", side="x-")
        case.lattice.add_layer(name="right", side="x+")
        case.material = {"youngs_modulus": 2e11, "density": 8000.0}
        case.add_support(set="left", displacement=["1e-4*sin(2e4*t)"])
        case.add_load(set="right", body_force=["1e8*t/1e-4"])
        case.solver.mode = "dynamics"
        case.dynamics = {"end_time": 2e-4}
        given = case.copy()
        given.support[0].displacement = [lambda t: 1e-4 * math.sin(2e4 * t)]
        given.load[0].body_force = [lambda t: 1e8 * t / 1e-4]
        # The sine of muParser and that of Python may differ in their last bit.
        np.testing.assert_allclose(
            given.solve(quiet=True).displacement(), case.solve(quiet=True).displacement(), rtol=1e-12
        )

    def test_an_exception_in_a_function_of_a_later_step_reaches_the_caller(self):
        case = strip()
        calls = []

        def pull(load):
            calls.append(load)
            if len(calls) > 60:
                raise KeyError("mine")
            return 1e-5 * load

        case.loading.steps = 200
        case.support[1].displacement = [pull, "0"]
        self.assertRefuses(lambda: case.solve(quiet=True), "mine", error=KeyError)


class TestPoints(InFolder):
    def cloud(self, **points):
        x, y = np.meshgrid(np.arange(0.5, 20), np.arange(0.5, 6))
        positions = 1e-3 * np.column_stack([x.ravel(), y.ravel()])
        order = np.random.default_rng(1).permutation(len(positions))
        positions = positions[order]
        given = {"volumes": 1e-9, "sets": {"left": positions[:, 0] < 3e-3, "right": positions[:, 0] > 17e-3}}
        case = ps.Case("cloud", given_points=ps.Points(positions, **{**given, **points}), dimension=2)
        case.points = {"horizon": "3.015 mm", "thickness": "1 mm"}
        case.material.youngs_modulus = "200 GPa"
        case.add_support(set="left", displacement=["0", "0"])
        case.add_support(set="right", displacement=["1e-5*load", "0"])
        return case, positions

    def test_points_have_their_given_numbers(self):
        case, positions = self.cloud()
        body = case.body()
        np.testing.assert_array_equal(positions[body.given_numbers], body.positions)
        self.assertEqual(body.solve(quiet=True).status, "completed")

    def test_columns_stand_in_expressions_and_functions(self):
        case, positions = self.cloud(columns={"pull": np.arange(120.0)})
        case.support[1].displacement = ["1e-8*pull*load", lambda pull, load: 1e-8 * pull * load]
        body = case.body()
        moved = body.solve(quiet=True).displacement()[body.sets["right"]]
        expected = 1e-8 * body.given_numbers[body.sets["right"]]
        np.testing.assert_allclose(moved, np.column_stack([expected, expected]), rtol=1e-14)

    def test_wrong_arrays_are_refused(self):
        self.assertRefuses(lambda: ps.Points([[1, 2], [3]], 1), "must be numbers")
        self.assertRefuses(lambda: ps.Points([1, 2, 3], 1), "points x dimension")
        self.assertRefuses(lambda: ps.Points([[1, 2], [3, 4]], [1, 2, 3]), "volumes")
        self.assertRefuses(lambda: ps.Points([[1, 2], [3, 4]], 1, sets={"a": [5]}), "sets['a']")
        self.assertRefuses(lambda: self.cloud(volumes=-1e-9)[0].body(), "positive")
        self.assertRefuses(lambda: ps.Case("list", given_points=[[0.0, 0.0]]), "given_points")
        case, _ = self.cloud()
        case.lattice.spacing = 1e-3
        self.assertRefuses(case.body, "")


class TestRuns(InFolder):
    def test_runs_of_a_process_have_folders_of_their_own(self):
        case = strip()
        first = case.solve(quiet=True)
        case.set("support[1].displacement[0]", "0.04 mm*load")
        second = case.solve(quiet=True)
        self.assertNotEqual(first.path, second.path)
        self.assertAlmostEqual(second.field("displacement").max() / first.field("displacement").max(), 2.0)

    def test_a_replaced_folder_is_not_read_as_the_old_run(self):
        first = strip().solve(quiet=True, output="same")
        changed = strip()
        changed.set("support[1].displacement[0]", "0.04 mm*load")
        changed.solve(quiet=True, output="same")
        self.assertRefuses(lambda: first.field("damage"), "another run")

    def test_results_of_others_are_left_alone(self):
        strip("one").solve(quiet=True, output="taken")
        self.assertRefuses(lambda: strip("two").solve(quiet=True, output="taken"), "taken")
        pathlib.Path("mine").mkdir()
        (pathlib.Path("mine") / "history.csv").write_text("mine")
        self.assertRefuses(lambda: strip().solve(quiet=True, output="mine"), "mine")
        self.assertEqual((pathlib.Path("mine") / "history.csv").read_text(), "mine")

    def test_not_converging_is_a_value(self):
        case = strip()
        case.set("solver.max_iterations", 1)
        case.set("support[1].displacement[0]", "9 mm*load")
        case.set("loading.adaptive", False)
        run = case.solve(quiet=True)
        self.assertFalse(run.converged)
        self.assertEqual(run.status, "not_converged")
        self.assertTrue(run.reason)

    def test_a_body_is_solved_twice_alike(self):
        body = strip().body()
        np.testing.assert_array_equal(
            body.solve(quiet=True).displacement(), body.solve(quiet=True).displacement()
        )

    def test_a_body_does_not_change_with_its_case(self):
        case = strip()
        body = case.body()
        case.set("support[1].displacement[0]", "0.04 mm*load")
        self.assertAlmostEqual(body.solve(quiet=True).displacement().max(), 2e-5)

    def test_another_mode_makes_the_body_anew(self):
        self.assertEqual(strip().body().solve("relaxation", quiet=True).history["mode"][-1], "relaxation")

    def test_unknown_options_modes_and_numbers_of_threads(self):
        self.assertRefuses(lambda: strip().solve("newtn"), "did you mean newton")
        self.assertRefuses(lambda: strip().solve(steps=3), "steps", error=TypeError)
        for threads in (-1, 10**6, "2", 1.5):
            with self.subTest(threads=threads):
                self.assertRefuses(lambda: strip().solve(threads=threads), "threads")
        self.assertRefuses(lambda: strip().solve(on_step=3), "on_step")

    def test_an_interrupt_closes_the_results(self):
        script = textwrap.dedent(
            """
            import os, signal, sys
            sys.path[:0] = sys.argv[1:3]
            import peristat as ps
            from python_package_test import strip
            def interrupt(step):
                if step.number == 2:
                    os.kill(os.getpid(), signal.SIGINT)
            case = strip()
            case.loading.steps = 100000
            try:
                case.solve(quiet=True, output="interrupted", on_step=interrupt)
            except KeyboardInterrupt:
                print(ps.open_results("interrupted").status)
            """
        )
        done = subprocess.run(
            [sys.executable, "-c", script, ROOT / "python", ROOT / "tests/acceptance"],
            capture_output=True, text=True, timeout=100,
        )  # fmt: skip
        self.assertIn("interrupted", done.stdout, done.stderr)

    def test_another_thread_is_refused_and_the_first_goes_on(self):
        ended, begun = [], threading.Event()
        big = strip("big", "0.25 mm")
        solve = lambda: ended.append(big.solve(quiet=True, on_step=lambda _: begun.set()).status)  # noqa: E731
        thread = threading.Thread(target=solve)
        thread.start()
        begun.wait()
        body, refused = strip(), None
        while thread.is_alive() and not refused:
            try:
                body.body()
            except RuntimeError as error:
                refused = str(error)
            time.sleep(0.001)
        thread.join()
        self.assertIn("another thread", refused or "")
        self.assertEqual(ended, ["completed"])


class TestSteps(InFolder):
    def test_a_callback_sees_the_steps(self):
        seen = []
        case = strip()
        case.add_probe(name="end", set="right", field="displacement")
        run = case.solve(quiet=True, on_step=lambda step: seen.append(
            (step.number, step.load, step.probes["end"][0], step.reactions["right"][0], step.field("displacement").max())))  # fmt: skip
        self.assertEqual([row[0] for row in seen], list(run.history["step"]))
        np.testing.assert_array_equal([row[2] for row in seen], run.history["end_x"])
        np.testing.assert_array_equal([row[3] for row in seen], run.history["reaction_x:right"])
        np.testing.assert_array_equal(seen[-1][4], run.displacement().max())

    def test_an_exception_of_a_callback_ends_the_run_after_the_step(self):
        def fail(step):
            if step.number == 2:
                raise KeyError("mine")

        self.assertRefuses(lambda: strip().solve(quiet=True, output="failed", on_step=fail), "mine", error=KeyError)
        self.assertEqual(ps.open_results("failed").history["step"][-1], 2)

    def test_a_callback_stops_the_run_and_it_goes_on(self):
        run = strip().solve(quiet=True, on_step=lambda step: step.number == 2 and step.stop("enough"))
        self.assertEqual(run.status, "interrupted")
        self.assertIn("enough", run.reason)
        again = run.resume(quiet=True)
        whole = strip().solve(quiet=True)
        np.testing.assert_array_equal(again.displacement(), whole.displacement())

    def test_a_step_that_is_over_has_its_record_alone(self):
        kept = []
        strip().solve(quiet=True, on_step=kept.append)
        self.assertEqual(kept[1].load, 0.25)
        self.assertRefuses(lambda: kept[1].field("damage"), "is over", error=RuntimeError)
        self.assertRefuses(lambda: kept[1].displacement, "is over", error=RuntimeError)

    def test_an_unknown_field_of_a_step_is_refused(self):
        for step in strip().steps(quiet=True):
            self.assertRefuses(lambda: step.field("damge"), "damage")

    def test_a_loop_sees_each_step_and_what_it_leaves_is_closed(self):
        steps = strip().steps(quiet=True, output="left")
        for step in steps:
            if step.number == 2:
                break
        self.assertEqual(steps.run.status, "interrupted")
        self.assertEqual(ps.open_results("left").history["step"][-1], 2)
        self.assertEqual([step.number for step in strip().steps(quiet=True)], [0, 1, 2, 3, 4])

    def test_a_loop_raises_what_its_body_and_its_run_raise(self):
        with self.assertRaises(ZeroDivisionError):
            for _ in strip().steps(quiet=True):
                1 / 0  # noqa: B018
        self.assertRefuses(lambda: list(strip().steps("newtn")), "newton")
        self.assertEqual(strip().solve(quiet=True).status, "completed")  # nothing is left at work

    def test_a_dial_is_followed(self):
        pull = ps.Dial(0.0)
        case = strip()
        case.loading.steps = 10
        case.support[1].displacement = [pull, "0"]
        self.assertEqual(case.check().warnings, [])  # that nothing moves is not known before the run
        wanted = [1e-6 * k**2 for k in range(1, 12)]
        reached = []
        for step in case.steps(quiet=True):
            reached.append(step.displacement[:, 0].max())
            pull.turn_to(wanted[step.number], step, within=0.1)
        np.testing.assert_allclose(reached, [0.0, *wanted[:10]], rtol=1e-12)

    def test_wrong_settings_of_a_dial_are_refused(self):
        self.assertRefuses(lambda: ps.Dial().turn_to(1.0, within=0.0), "within")
        self.assertRefuses(lambda: ps.Dial().turn_to(float("nan"), within=0.1), "finite")

    def test_a_loop_that_stays_open_ends_with_python(self):
        script = """
import sys
sys.path[:0] = sys.argv[1:3]
from python_package_test import strip
steps = strip().steps(quiet=True, output="open")
next(steps)
"""
        done = subprocess.run([sys.executable, "-c", script, ROOT / "python", ROOT / "tests/acceptance"],
                              capture_output=True, text=True, timeout=100)  # fmt: skip
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(ps.open_results("open").status, "interrupted")

    def test_bodies_may_be_made_in_a_loop(self):
        for _ in strip().steps(quiet=True):
            self.assertGreater(strip().body().count, 0)


class TestSweep(InFolder):
    def test_processes_and_the_loop_give_the_same(self):
        vary = {"lattice.spacing": ["2 mm", "1 mm"], "loading.steps": [1, 2]}
        in_loop = ps.sweep(strip(), vary, quiet=True, output="loop", threads=1)
        aside = ps.sweep(strip(), vary, jobs=2, output="aside", threads=1)
        self.assertEqual(len(aside), 4)
        for one, other in zip(in_loop, aside, strict=True):
            np.testing.assert_array_equal(one.field("force"), other.field("force"))
        self.assertEqual(aside.table()[1]["loading.steps"], 2)

    def test_values_may_go_together(self):
        swept = ps.sweep(strip(), {"lattice.spacing": ["2 mm", "1 mm"], "loading.steps": [1, 2]},
                         together=True, quiet=True)  # fmt: skip
        self.assertEqual([run.history["step"][-1] for run in swept], [1, 2])

    def test_wrong_sweeps_are_refused_before_the_first_run(self):
        self.assertRefuses(lambda: ps.sweep(strip(), {"loading.stps": [1]}), "steps")
        self.assertRefuses(lambda: ps.sweep(strip(), {"loading.steps": [1, 0]}), "steps")
        self.assertRefuses(lambda: ps.sweep(strip(), {"loading.steps": "12"}), "list")
        self.assertRefuses(lambda: ps.sweep(strip(), {}), "vary")
        case = strip()
        case.support[1].displacement = [lambda load: 1e-5 * load, "0"]
        self.assertRefuses(lambda: ps.sweep(case, {"loading.steps": [1]}, jobs=2), "functions")
        self.assertFalse(pathlib.Path("results").exists())


class TestLaw(InFolder):
    def test_a_sampled_law_is_that_of_the_program(self):
        case = strip()
        case.set("support[1].displacement[0]", "0.2 mm*load")
        case.set("solver.mode", "relaxation")
        case.set("relaxation.steps", 3)
        case.material.damage = {"law": "linear", "onset": 1e-3, "critical": 6e-3}
        given = case.copy()
        given.material.damage = ps.sampled_law(
            lambda s: 1e-3 * (6e-3 - s) / (6e-3 - 1e-3), elastic_until=1e-3, breaks_at=6e-3
        )
        built_in, sampled = case.solve(quiet=True), given.solve(quiet=True)
        self.assertGreater(built_in.field("damage").max(), 0.1)
        np.testing.assert_allclose(sampled.field("damage"), built_in.field("damage"), atol=1e-9)

    def test_what_is_no_law_is_refused(self):
        self.assertRefuses(lambda: ps.sampled_law(lambda s: 2 * s, 1e-3, 2e-3), "elastic part")
        self.assertRefuses(lambda: ps.sampled_law(lambda s: s[:2], 1e-3, 2e-3), "shape")
        self.assertRefuses(lambda: ps.sampled_law(lambda s: s, 1e-3, float("inf")), "breaks_at")
        case = strip()
        case.material.damage = ps.sampled_law(lambda s: s + (s - 1e-3) ** 2, 1e-3, 2e-3)
        self.assertRefuses(case.body, "material.damage")


class TestPages(InFolder):
    def blocks(self, text):
        return re.findall(r"^```python\n(.*?)^```", text, re.MULTILINE | re.DOTALL)

    def test_the_blocks_of_the_page_run(self):
        text = (ROOT / "docs/python.md").read_text("utf-8").partition("\n## Results\n")[0]
        pathlib.Path("cases").symlink_to(ROOT / "cases")
        said = io.StringIO()
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            exec(compile("\n".join(self.blocks(text)), "docs/python.md", "exec"), {})
        self.assertIn("fracture_energ", said.getvalue())  # of the last block but one

    def run_script(self, page):
        (script,) = self.blocks((ROOT / page).read_text("utf-8"))
        self.assertLessEqual(len(script.splitlines()), 25)
        return subprocess.run([sys.executable, "-c", script], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": str(ROOT / "python"), "MPLBACKEND": "Agg"})  # fmt: skip

    def test_the_script_of_the_readme_varies_the_hole(self):
        text = (ROOT / "README.md").read_text("utf-8")
        (case,) = re.findall(r"^```toml\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
        pathlib.Path("plate.toml").write_text(case)
        done = self.run_script("README.md")
        peaks = re.findall(r"^radius \d mm: (\S+) kN", done.stdout, re.MULTILINE)
        self.assertEqual(len(peaks), 3, done.stderr)
        self.assertIn(f"prints peaks of {peaks[0]}, {peaks[1]} and {peaks[2]} kN", text)
        self.assertIn(f"The plate bears {peaks[1]} kN", text)
        self.assertIn(f"The plate bears {peaks[1]} kN", (ROOT / "docs/start/own-plate.md").read_text("utf-8"))
        for picture in ("damage.png", "curve.png"):
            self.assertGreater(pathlib.Path(picture).stat().st_size, 10_000)

    def test_the_script_of_the_start_tears_a_plate(self):
        done = self.run_script("docs/start/own-plate.md")
        self.assertIn("peak 2.41 kN, status completed", done.stdout, done.stderr)
        self.assertIn("the plate bears 2.41 kN", (ROOT / "docs/start/own-plate.md").read_text("utf-8"))
        for picture in ("torn_plate.png", "curve.png"):
            self.assertGreater(pathlib.Path(picture).stat().st_size, 10_000)

    def test_the_script_for_users_of_peridynamics_jl_runs(self):
        pathlib.Path("cases").symlink_to(ROOT / "cases")
        done = self.run_script("docs/how-to/from-peridynamics-jl.md")
        self.assertGreater(float(done.stdout.splitlines()[-1]), 0, done.stderr)


class TestMemory(InFolder):
    def test_bodies_made_and_dropped_leave_nothing(self):
        def resident():
            return int(pathlib.Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        case = strip(spacing="1 mm")
        for _ in range(20):
            case.body()
        before = resident()
        for _ in range(300):
            case.body()
        # A body has 0.5 MB: 300 that stay would take 150.
        self.assertLess(resident() - before, 4e6)


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.default_int_handler)
    unittest.main()
