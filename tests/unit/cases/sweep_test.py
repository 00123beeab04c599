"""Parts of a sweep: splitting and computing values, naming folders, curves from fields and their looks, and
extrapolation of refinements."""

import math
import sys
import tempfile
import threading
import time
import unittest
from pathlib import Path

import numpy as np

RUNNER = Path(__file__).resolve().parents[3] / "cases" / "runner"
sys.path[:0] = [str(RUNNER / "sweep"), str(RUNNER.parents[1] / "python"), str(Path(__file__).parent)]

import plot_test  # noqa: E402
from peristat.pictures import style  # noqa: E402
from computed import Keys, compute, split_computed  # noqa: E402
from jobs import FolderLock, Jobs, bounded, estimated_memory  # noqa: E402
from own_files import HEAD, PICTURE, ForeignFile, picture, remove_own, write_own  # noqa: E402
from refinement import observed_order, refine  # noqa: E402
from peristat.pictures.results_folder import ResultsFolder  # noqa: E402
from sweep_picture import DASHES, draw_sweep, labels, line_looks, midline  # noqa: E402
from variations import Axis, WrongInput, combinations, folder_name, split_values  # noqa: E402


def body(reference, layers=None) -> ResultsFolder:
    """A results folder of points with spacing 1 and nothing else; layers are point numbers by name."""
    layers = layers or {}
    case = {"lattice": {"layer": [{"name": name} for name in layers]}}
    return ResultsFolder(Path(), "", np.asarray(reference, dtype=float), np.ones(len(reference)), 1.0, layers,
                         [], {}, {}, {}, {}, {}, case)  # fmt: skip


def lattice(*counts: int) -> np.ndarray:
    return np.stack(np.meshgrid(*map(np.arange, counts), indexing="ij"), axis=-1).reshape(-1, len(counts)).astype(float)


class OwnFiles(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "table.md"

    def test_what_has_no_sign_is_not_replaced(self):
        self.path.write_bytes(b"mine")
        for act in (lambda: write_own(self.path, b"sign", b"sign"), lambda: remove_own(self.path, b"sign")):
            with self.assertRaises(ForeignFile):
                act()
        self.assertEqual(self.path.read_bytes(), b"mine")
        self.assertEqual([path.name for path in self.path.parent.iterdir()], ["table.md"])

    def test_own_files_and_empty_ones_are_replaced(self):
        self.path.touch()
        for content in (b"sign 1", b"sign 2"):
            write_own(self.path, content, b"sign")
            self.assertEqual(self.path.read_bytes(), content)
        remove_own(self.path, b"sign")
        self.assertFalse(self.path.exists())

    def test_links_are_not_followed(self):
        victim = self.path.with_name("victim")
        victim.write_bytes(b"sign of its own")
        self.path.symlink_to(victim)
        with self.assertRaises(ForeignFile):
            write_own(self.path, b"sign", b"sign")
        self.assertEqual(victim.read_bytes(), b"sign of its own")

    def test_pictures_carry_the_sign(self):
        figure = style.new_figure(1.0, 1.0)
        for ending in ("png", "svg"):
            self.assertIn(PICTURE, picture(figure, ending)[:HEAD])


class SideBySide(unittest.TestCase):
    def test_jobs_and_threads_take_no_more_than_the_processors(self):
        self.assertEqual(bounded(1, None, 8), (1, None))
        self.assertEqual(bounded(1, 16, 8), (1, 16))  # a single run may have what it is given
        self.assertEqual(bounded(4, None, 8), (4, 2))
        self.assertEqual(bounded(3, None, 8), (3, 2))
        self.assertEqual(bounded(20, None, 8), (8, 1))
        self.assertEqual(bounded(4, 4, 8), (2, 4))
        self.assertEqual(bounded(4, 16, 8), (1, 16))

    def test_memory_is_what_check_tells(self):
        told = "points      40\nmemory      about 62 MB of 24.90 GB available\ntime        below a second\n"
        self.assertEqual(estimated_memory(told), (62e6, 24.9e9))
        self.assertIsNone(estimated_memory("memory      enough\n"))

    def run_jobs(self, jobs, memory):
        """The largest number of tasks that ran at the same time, and the order of their ends."""
        running, most, lock = set(), [0], threading.Lock()

        def task(number):
            with lock:
                running.add(number)
                most[0] = max(most[0], len(running))
            time.sleep(0.05)
            with lock:
                running.remove(number)

        with tempfile.TemporaryDirectory() as folder:
            made = Jobs(jobs, memory, lambda number: FolderLock(Path(folder) / str(number)))
            ended = [number for number, _ in made.run(range(6), task, lambda: True, lambda number: None)]
        return most[0], ended

    def test_no_more_runs_begin_than_memory_allows(self):
        self.assertEqual(self.run_jobs(3, lambda number: (1.0, 10.0))[0], 3)
        self.assertEqual(self.run_jobs(3, lambda number: (4.0, 10.0))[0], 2)
        self.assertEqual(self.run_jobs(3, lambda number: (8.0, 10.0))[0], 1)
        self.assertEqual(self.run_jobs(3, lambda number: (80.0, 10.0))[0], 1)  # alone: the run itself refuses
        self.assertEqual(self.run_jobs(3, lambda number: None)[0], 1)  # unknown
        most, ended = self.run_jobs(1, None)
        self.assertEqual((most, ended), (1, list(range(6))))

    def test_what_another_sweep_runs_is_waited_for(self):
        with tempfile.TemporaryDirectory() as folder:
            held = FolderLock(Path(folder) / "0")
            self.assertFalse(FolderLock(Path(folder) / "0").is_held)
            threading.Timer(0.5, held.release).start()
            waited = []
            made = Jobs(1, None, lambda number: FolderLock(Path(folder) / str(number)))
            ended = [number for number, _ in made.run(range(2), lambda number: None, lambda: True, waited.append)]
        self.assertEqual((ended, waited), ([1, 0], [0]))


class Variations(unittest.TestCase):
    def test_commas_in_brackets_and_quotes_separate_nothing(self):
        for text, values in {
            "1": ["1"],
            "1, 2e-3 ,auto": ["1", "2e-3", "auto"],
            '["1e-5*load", "free"],[0, 0]': ['["1e-5*load", "free"]', "[0, 0]"],
            "'a,b',\"c,d\"": ["'a,b'", '"c,d"'],
            r'"a\",b",c': [r'"a\",b"', "c"],
            "{ a = [1, 2], b = 3 },4": ["{ a = [1, 2], b = 3 }", "4"],
            "max(x,y),x": ["max(x,y)", "x"],
            '"[",1': ['"["', "1"],
            "": [""],
            "1,": ["1", ""],
        }.items():
            self.assertEqual(split_values(text), values)
        for text in ("[1", "1]", "[1)", '"a', "'a\",b"):
            with self.assertRaises(WrongInput):
                split_values(text)

    def test_the_last_key_changes_fastest(self):
        self.assertEqual(combinations([Axis(["a"], [["1", "2"]]), Axis(["b"], [["x", "y"]])]),
                         [("1", "x"), ("1", "y"), ("2", "x"), ("2", "y")])  # fmt: skip

    def test_linked_keys_vary_together(self):
        self.assertEqual(combinations([Axis(["a", "c"], [["1", "2"], ["p", "q"]]), Axis(["b"], [["x", "y"]])]),
                         [("1", "p", "x"), ("1", "p", "y"), ("2", "q", "x"), ("2", "q", "y")])  # fmt: skip

    def test_folder_names_are_safe_and_different(self):
        self.assertEqual(folder_name(["loading.steps=10", "load[0].x=1e-3"]), "loading.steps=10,load[0].x=1e-3")
        odd = ["a=x/y", "a=x_y", "a=x y", "a='x,y'", "a=../x", "a=ä", "a=x\ny", "a=\udcff", f"a={'x' * 500}",
               f"a={'x' * 501}", "a=b=c"]  # fmt: skip
        names = [folder_name([setting]) for setting in odd]
        self.assertEqual(len(set(names)), len(names))
        for name in names:
            self.assertRegex(name, r"^a=[A-Za-z0-9._+\[\]-]+$")
            self.assertLess(len(name), 200)


class Computed(unittest.TestCase):
    CASE = b'dimension = 2\n[lattice]\nspacing = 1e-3\n[[lattice.shape]]\nmax = [0.02, 0.01]\n[material]\nmodel = "bond"'

    def value(self, expression, *settings):
        return compute(expression, Keys(self.CASE, list(settings)))

    def test_expressions_of_keys(self):
        for expression, value in {
            "0.02/lattice.spacing": repr(0.02 / 1e-3),
            "round(0.02/lattice.spacing)": "20",
            "2*lattice.shape[0].max[1]": "0.02",
            "max(1, floor(2.7), -3)": "2",
            "2^3": "8",
            "-dimension + 2*pi": repr(-2 + 2 * math.pi),
            "sqrt(material.e)": "2.0",
        }.items():
            self.assertEqual(self.value(expression, "material.e=4"), value)
        self.assertEqual(self.value("0.02/lattice.spacing", "lattice.spacing=5e-3"), "4.0")

    def test_what_is_set_counts_and_not_what_stands_in_the_file(self):
        self.assertEqual(self.value("lattice.spacing", "lattice={spacing=0.5}"), "0.5")
        self.assertEqual(self.value("lattice.shape[0].max[1]", "lattice.shape[0].max=[1, 7]"), "7")
        self.assertEqual(self.value("lattice.shape[0].max[1]", "lattice.shape[0].max[1]=8"), "8")
        self.assertEqual(self.value("a.b", "a.b=3"), "3")
        self.assertEqual(self.value("dimension", "lattice.shape[9].x=1", "dimension.of=2", "a[0].b=1"), "2")

    def test_what_is_computed_later_is_no_value_yet(self):
        keys = Keys(self.CASE, [], {"lattice.spacing"})
        with self.assertRaisesRegex(WrongInput, "computed later"):
            compute("2*lattice.spacing", keys)
        self.assertEqual(compute("dimension", keys), "2")

    def test_what_has_no_value_is_refused(self):
        for expression, why in {
            "0.02/lattice.spaceing": "is neither in the case file",
            "lattice.shape[1].max[0]": "is neither in the case file",
            "material.model": "not a number",
            "lattice": "not a number",
            "1/0": "no value",
            "(-1)^0.5": "no finite value",
            "9^9^9": "no value",
            "((9^900)^900)^900": "no value",
            "exp(1000)": "no value",
            "sqrt(-1)": "no value",
            "1" + "+1" * 5000: "no",
            "open('x')": "no function open",
            "__import__('os')": "no function",
            "'a'*3": "may only contain",
            "[1][0]": "may only contain",
            "1 +": "not an expression",
            "(" * 500: "not an expression",
            "": "not an expression",
            "max()": "no value",
        }.items():
            with self.assertRaisesRegex(WrongInput, why, msg=expression):
                self.value(expression)

    def test_a_computed_key_is_told_by_its_colon(self):
        self.assertEqual(split_computed("a.b := 2*c=d"), ("a.b", "2*c=d"))
        self.assertIsNone(split_computed("a=1:=2"))
        self.assertIsNone(split_computed("a"))


class Refinements(unittest.TestCase):
    def test_a_power_law_is_found_whatever_the_ratios(self):
        for order in (0.5, 1.0, 2.0, 3.3):
            for spacings in ([4.0, 2.0, 1.0], [3.0, 2.0, 1.7]):
                values = [5.0 - 0.3 * h**order for h in spacings]
                self.assertAlmostEqual(observed_order(spacings, values), order, delta=1e-9)
                found = refine("x", spacings, values)
                self.assertEqual(found.behaviour, "monotone")
                self.assertAlmostEqual(found.extrapolated, 5.0, delta=1e-9)
                self.assertAlmostEqual(found.uncertainty, 1.25 * 0.3 * spacings[-1] ** order, delta=1e-9)
                self.assertAlmostEqual(found.index, found.uncertainty / values[-1], delta=1e-12)

    def test_what_does_not_converge_is_told(self):
        spacings = [4.0, 2.0, 1.0]
        for values, behaviour in {
            (1.0, 2.0, 1.5): "oscillating",
            (1.0, 2.0, 3.0): "not converging",
            (1.0, 1.1, 1.3): "not converging",
            (2.0, 2.0, 2.0): "constant",
            (0.0, 0.0, 0.0): "constant",
            (1.0, 1.0, 2.0): "not converging",
            (1.0, 2.0, 2.0): "constant",
        }.items():
            found = refine("x", spacings, list(values))
            self.assertEqual((found.behaviour, found.order), (behaviour, None))
            self.assertTrue(found.told())
        self.assertAlmostEqual(refine("x", spacings, [1.0, 2.0, 1.5]).uncertainty, 1.5)
        self.assertEqual(refine("x", spacings, [1.0, 2.0, 2.0]).uncertainty, 1.0)
        self.assertEqual(refine("x", spacings, [2.0, 2.0, 2.0]).uncertainty, 0.0)

    def test_orders_that_disagree_call_for_caution(self):
        spacings = [8.0, 4.0, 2.0, 1.0]
        settled = refine("x", spacings, [1.0 + h**2 for h in spacings])
        self.assertAlmostEqual(settled.order_before, 2.0)
        self.assertAlmostEqual(settled.uncertainty, 1.25)
        unsettled = refine("x", spacings, [1.0, 1.0 + 4.0**2, 1.0 + 2.0**2, 1.0 + 1.0])
        self.assertAlmostEqual(unsettled.order, 2.0)
        self.assertAlmostEqual(unsettled.uncertainty, 3.0)


class Picture(unittest.TestCase):
    def test_a_middle_row_or_the_mean_of_two_is_the_midline(self):
        for rows, expected in ((5, 2.0), (4, 1.5)):
            points = lattice(6, rows)
            x, y = midline(body(points), 0, points[:, 1])
            np.testing.assert_allclose(x, np.arange(6))
            np.testing.assert_allclose(y, expected)

    def test_dimensions_one_and_three(self):
        points = lattice(5, 4, 2)
        x, y, z = midline(body(points), 0, points[:, 1], points[:, 2])
        np.testing.assert_allclose((x, y, z), (np.arange(5), [1.5] * 5, [0.5] * 5))
        (x,) = midline(body(lattice(5)), 0)
        np.testing.assert_allclose(x, np.arange(5))

    def test_along_another_axis(self):
        points = lattice(5, 4)
        y, x = midline(body(points), 1, points[:, 0])
        np.testing.assert_allclose((y, x), (np.arange(4), [2.0] * 4))

    def test_layers_are_no_part_of_the_body(self):
        points = lattice(6, 7)
        layers = {"left": np.flatnonzero(points[:, 0] < 1), "top": np.flatnonzero(points[:, 1] > 4)}
        x, y = midline(body(points, layers), 0, points[:, 1])
        np.testing.assert_allclose(x, np.arange(1, 6))
        np.testing.assert_allclose(y, 2.0)

    def test_a_hole_is_a_gap(self):
        points = lattice(11, 11)
        points = points[np.abs(points - 5).max(axis=1) > 2]
        x, y = midline(body(points), 0, points[:, 1])
        np.testing.assert_allclose(x, [0, 1, 2, np.nan, 8, 9, 10])
        np.testing.assert_allclose(y, [5, 5, 5, np.nan, 5, 5, 5])

    def test_colours_follow_numbers_and_dashes_the_rest(self):
        values = [(word, value) for word in ("never", "auto") for value in ("100", "5", "20")]
        looks = line_looks(values)
        shades = {value: look["color"][1] for (_, value), look in zip(values, looks)}  # green rises in viridis
        self.assertEqual(sorted(shades, key=shades.get), ["5", "20", "100"])
        self.assertEqual([look["linestyle"] for look in looks], [DASHES[0]] * 3 + [DASHES[1]] * 3)
        many = line_looks([(str(a), str(b)) for a in range(9) for b in range(9)])
        self.assertEqual(len({tuple(look["color"]) for look in many}), 81)

    def test_labels_are_short_where_they_are_clear(self):
        self.assertEqual(labels(["loading.steps", "title"], [("1", "x"), ("2", "x")]), ["steps = 1", "steps = 2"])
        self.assertEqual(labels(["a.x", "b.x"], [("1", "2")]), ["a.x = 1, b.x = 2"])
        two = [f"region[{k}].material.youngs_modulus" for k in (0, 1)]
        for label in labels(two, [("70e9", "140e9"), ("80e9", "210e9")]):
            one, other = label.split("\n")
            self.assertRegex(one, r"^region\[0\]….*modulus = [78]0e9$")
            self.assertRegex(other, r"^region\[1\]….*modulus = (140|210)e9$")
            self.assertLessEqual(max(len(one), len(other)), 30)
        (long,) = labels(["support[1].displacement"], [('["1e-5*load", "free"]',)])
        self.assertLessEqual(len(long), 30)

    def test_damage_is_drawn_where_there_is_any(self):
        for damaged, wanted in ((False, "displacement"), (True, "damage")):
            with tempfile.TemporaryDirectory() as name:
                folders = [Path(name) / "first", Path(name) / "second", Path(name) / "third"]
                plot_test.write_folder(folders[0], plot_test.lattice(20, 7))
                plot_test.write_folder(folders[1], plot_test.lattice(20, 8), damaged=damaged)
                statuses = ["completed", "not_converged", "out_of_memory"]
                figure = draw_sweep(["a"], [("1",), ("2",), ("3",)], folders, statuses)
                left, right, *outcomes = figure.axes
                self.assertIn(wanted, right.get_ylabel())
                self.assertTrue(outcomes)  # peak reaction and probes against the varied key
                self.assertEqual(len(left.lines), 2 + 1 + 1 + 1)  # curves, cross, zero, legend's cross
                first, second, _ = (line.get_ydata() for line in right.lines)
                self.assertEqual(len(first), 20)
                self.assertEqual(second.max(), 0.5 if damaged else second[-1])
                self.assertEqual(first.max() > 0.0, not damaged)

    def draw_outcomes(self, keys, values):
        """The panels of outcomes over the first key, for bodies with equal results."""
        with tempfile.TemporaryDirectory() as name:
            folders = [Path(name) / str(number) for number in range(len(values))]
            for folder in folders:
                plot_test.write_folder(folder, plot_test.lattice(8, 4))
            figure = draw_sweep(keys, values, folders, ["completed"] * len(values))
            figure.canvas.draw()
            return figure.axes[2:]

    def test_words_stand_below_outcomes_as_they_are_and_shortened(self):
        long = "a" * 60
        (panel,) = self.draw_outcomes(["solver.mode"], [("newton",), ("$x$",), (long,)])
        told = [label.get_text() for label in panel.get_xticklabels()]
        self.assertEqual(told, ["newton", r"\$x\$", "a" * 29 + "…"])

    def test_outcomes_over_numbers_of_several_sizes_have_a_logarithmic_axis(self):
        (panel,) = self.draw_outcomes(["a"], [("1",), ("10",), ("100",)])
        self.assertEqual(panel.get_xscale(), "log")
        (panel,) = self.draw_outcomes(["a"], [("1",), ("2",)])
        self.assertEqual(panel.get_xscale(), "linear")

    def test_a_key_of_one_value_has_no_outcomes_over_it(self):
        self.assertEqual(self.draw_outcomes(["a"], [("1",), ("1",)]), [])

    def test_many_combinations_share_a_legend(self):
        panels = self.draw_outcomes(["a", "b"], [(str(a), str(b)) for a in range(6) for b in "vwxyz"])
        self.assertEqual(len(panels), 1)

    def test_nothing_to_draw_is_no_picture(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertIsNone(draw_sweep(["a"], [("1",)], [Path(folder)], ["completed"]))


if __name__ == "__main__":
    unittest.main()
