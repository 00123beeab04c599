"""Fits of curves with known answers: closed forms in the place of runs."""

import pathlib
import sys
import tempfile
import unittest

import numpy
import scipy.stats

ROOT = pathlib.Path(__file__).resolve().parents[3]
sys.path.insert(0, str(ROOT / "python"))

from peristat.errors import InputError  # noqa: E402
from peristat.fitting.comparison import Comparison, in_order, under_growing_x  # noqa: E402
from peristat.fitting.curves import Columns, Curve, computed, measured, read_measured  # noqa: E402
from peristat.fitting.outcome import NoCurve, document, fit_problem, table  # noqa: E402
from peristat.fitting.parameters import parameter  # noqa: E402
from peristat.fitting.problem import REFUSED, Problem, Ran, Specimen  # noqa: E402

X = numpy.linspace(0.0, 1.0, 201)


def line(a, b):
    return X, a * X + b


class Fitted(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory()))
        self.count = 0

    def problem(self, model, data, parameters, way="auto", names=1, difference=0.02):
        """`model` gives x and y of the values, None if it refuses them; with several specimens also of the number."""

        def run(asked):
            found = []
            for number, texts in asked:
                values = [float(text) for text in texts]
                curve = model(*values) if names == 1 else model(number, *values)
                folder = self.folder / str(self.count)
                self.count += 1
                if curve is None:
                    found.append(Ran(folder, REFUSED, "refused"))
                    continue
                folder.mkdir()
                numpy.savetxt(folder / "history.csv", numpy.column_stack(curve), delimiter=",", header="x,y", comments="", fmt="%.17g")
                found.append(Ran(folder, "completed"))
            return found

        tables = [data] if names == 1 else data
        specimens = []
        for k, each in enumerate(tables):
            curve = measured(numpy.column_stack(each), f"data {k}")
            specimens.append(Specimen(curve.name, curve, Comparison(curve, way), Columns("x", "y")))
        return Problem(specimens, parameters, run, difference, lambda text: None)

    def fit(self, *arguments, starts=1, seed=1, steps=50, **options):
        return fit_problem(self.problem(*arguments, **options), starts, seed, steps)

    def values(self, outcome):
        return [each.value for each in outcome.statistics.estimates]

    def assert_told(self, outcome, *fragments):
        for fragment in fragments:
            self.assertTrue(any(fragment in message for message in outcome.messages), outcome.messages)

    # ---- values and their errors ----

    def test_a_straight_line_has_the_covariance_of_linear_regression(self):
        noise = numpy.random.default_rng(1).normal(0.0, 0.02, len(X))
        y = 2.0 * X + 0.5 + noise
        outcome = self.fit(line, (X, y), [parameter("a", 1.0), parameter("b", 1.0)])
        design = numpy.column_stack([X, numpy.ones_like(X)])
        values, squares, _, _ = numpy.linalg.lstsq(design, y, rcond=None)
        covariance = numpy.linalg.inv(design.T @ design) * squares[0] / (len(X) - 2)
        told = outcome.statistics
        # Searches end at a relative step of 3e-4.
        numpy.testing.assert_allclose(self.values(outcome), values, rtol=1e-3)
        larger = (len(X) / told.independent) ** 0.5
        self.assertTrue(1.0 <= larger < 1.3)
        deviations = [each.deviation / larger for each in told.estimates]
        numpy.testing.assert_allclose(deviations, numpy.sqrt(numpy.diag(covariance)), rtol=5e-3)
        expected = covariance[0, 1] / numpy.sqrt(covariance[0, 0] * covariance[1, 1])
        self.assertAlmostEqual(told.correlation[0, 1], expected, places=2)
        self.assertEqual(outcome.messages, [])
        self.assertTrue(outcome.is_converged)
        self.assertIn("95 % confidence", table(outcome))

    def test_intervals_contain_the_truth_as_often_as_they_say(self):
        generator, hits = numpy.random.default_rng(2), 0
        x = X[::10]
        for _ in range(80):
            data = (x, 2.0 * x + generator.normal(0.0, 0.1, len(x)))
            each = self.fit(lambda a: line(a, 0.0), data, [parameter("a", 1.0)]).statistics.estimates[0]
            hits += each.low <= 2.0 <= each.high
        self.assertGreater(scipy.stats.binom.cdf(hits, 80, 0.95), 1e-3, hits)

    def test_known_noise_weighs_the_points(self):
        sigma = numpy.where(X < 0.5, 1e-3, 10.0)
        y = numpy.where(X < 0.5, 2.0, 5.0) * X
        outcome = self.fit(lambda a: line(a, 0.0), (X, y, sigma), [parameter("a", 1.0)])
        self.assertAlmostEqual(self.values(outcome)[0], 2.0, places=3)

    def test_residuals_of_a_wrong_model_are_no_noise(self):
        outcome = self.fit(lambda a: line(a, 0.0), (X, X**2), [parameter("a", 1.0)])
        self.assert_told(outcome, "neighbouring residuals have a correlation of 0.9")
        self.assertLess(outcome.statistics.independent, 10)

    def test_negative_values_and_zero_are_searched_linearly(self):
        outcome = self.fit(lambda a, b: line(a, b), (X, -2.0 * X + 0.5), [parameter("a", -1.0), parameter("b", 0.0, None, (-1, 1))])
        numpy.testing.assert_allclose(self.values(outcome), [-2.0, 0.5], rtol=1e-6)

    def test_specimens_share_the_values(self):
        model = lambda number, a, b: (X, a * X if number == 0 else a * X + b * X**2)
        data = [(X, 2.0 * X), (X, 2.0 * X + 3.0 * X**2)]
        outcome = self.fit(model, data, [parameter("a", 1.0), parameter("b", 1.0)], names=2)
        numpy.testing.assert_allclose(self.values(outcome), [2.0, 3.0], rtol=1e-4)

    # ---- what the data leave open ----

    def test_a_value_without_effect_is_not_determined(self):
        outcome = self.fit(lambda a, b: line(a, 0.0), (X, 2.0 * X), [parameter("a", 1.0), parameter("b", 3.0)])
        self.assert_told(outcome, "b is not determined: the computed curve does not depend on it")
        self.assertFalse(outcome.is_converged)
        self.assertEqual(self.values(outcome)[1], 3.0)
        self.assertIsNone(document(outcome)["parameters"][1]["standard_deviation"])
        self.assertIn("not determined", table(outcome))

    def test_values_that_act_as_a_product_are_not_determined_alone(self):
        outcome = self.fit(lambda a, b: line(a * b, 0.0), (X, 2.0 * X), [parameter("a", 1.0), parameter("b", 1.0)])
        self.assert_told(outcome, "a is not determined by itself", "b is not determined by itself")
        self.assertAlmostEqual(numpy.prod(self.values(outcome)), 2.0, places=3)

    def test_values_with_nearly_the_same_effect_are_told(self):
        noise = numpy.random.default_rng(3).normal(0.0, 1e-3, len(X))
        model = lambda a, b: (X, a * X + b * numpy.sin(0.2 * X))
        outcome = self.fit(model, (X, model(1.0, 1.0)[1] + noise), [parameter("a", 1.1), parameter("b", 1.1)])
        self.assert_told(outcome, "determined only together", "hardly determined")

    def test_a_value_at_its_bound_is_told(self):
        outcome = self.fit(lambda a: line(a, 0.0), (X, 2.0 * X), [parameter("a", 1.0, None, (0.5, 1.5))])
        self.assertAlmostEqual(self.values(outcome)[0], 1.5, places=2)
        self.assert_told(outcome, "a is at its bound 1.5")

    def test_a_derivative_within_the_pieces_of_a_curve_determines_nothing(self):
        def model(a, b):
            pieces = numpy.random.default_rng(int(round(b * 1e6)) % 2**31).normal(0.0, 1e-3, len(X))
            return X, a * X + pieces

        outcome = self.fit(model, (X, 2.0 * X), [parameter("a", 1.9), parameter("b", 3.0)])
        self.assert_told(outcome, "b is not determined: the curve depends on it less than by the pieces")

    # ---- runs that fail ----

    def test_refused_values_shorten_the_step(self):
        refusing = lambda a: None if a > 2.2 else (X, a**3 * X)
        outcome = self.fit(refusing, (X, 8.0 * X), [parameter("a", 0.8)])
        self.assertAlmostEqual(self.values(outcome)[0], 2.0, places=3)

    def test_a_start_that_is_refused_is_the_users_mistake(self):
        with self.assertRaisesRegex(InputError, "refused"):
            self.fit(lambda a: None, (X, X), [parameter("a", 1.0)])

    def test_a_run_gains_nothing_by_ending_early(self):
        """Larger values end earlier, before the part that they can't follow."""

        def model(a):
            keep = X <= max(1.2 - 0.2 * a, 0.3)
            return X[keep], a * X[keep]

        outcome = self.fit(model, (X, 2.0 * X), [parameter("a", 1.2)])
        self.assertAlmostEqual(self.values(outcome)[0], 2.0, places=3)
        self.assert_told(outcome, "41 of 201 points are not compared")

    def test_runs_without_a_curve_are_no_answer(self):
        with self.assertRaises(NoCurve):
            self.fit(lambda a: (X[:20], a * X[:20] + 0.1), (X, X), [parameter("a", 1.0)])

    # ---- several starts ----

    def test_other_starts_find_the_lower_minimum(self):
        model = lambda a: (X, numpy.sin(3.0 * a * X))
        one = self.fit(model, (X, numpy.sin(9.0 * X)), [parameter("a", 1.0, None, (0.3, 6.0))])
        many = self.fit(model, (X, numpy.sin(9.0 * X)), [parameter("a", 1.0, None, (0.3, 6.0))], starts=8)
        self.assertGreater(abs(self.values(one)[0] - 3.0), 0.5)
        self.assertAlmostEqual(self.values(many)[0], 3.0, places=3)
        self.assert_told(many, "starts have ended at larger sums of squares")

    def test_starts_are_the_same_for_a_seed(self):
        model, data = lambda a: line(a, 0.0), (X, 2.0 * X)
        starts = [
            [each.start for each in self.fit(model, data, [parameter("a", 1.0)], starts=3, seed=seed).found] for seed in (1, 1, 2)
        ]
        self.assertEqual(starts[0], starts[1])
        self.assertNotEqual(starts[0], starts[2])

    # ---- comparisons ----

    def test_a_snap_back_is_compared_along_its_way(self):
        turn = numpy.linspace(0.0, 1.5 * numpy.pi, 300)
        model = lambda r, s: (r * numpy.sin(turn / 1.5), s * numpy.sin(turn))
        noise = numpy.random.default_rng(4).normal(0.0, 0.01, (2, 300))
        x, y = model(2.0, 3.0)
        problem = self.problem(model, (x + 2.0 * noise[0], y + 3.0 * noise[1]), [parameter("r", 3.0), parameter("s", 2.0)])
        self.assertEqual(problem.specimens[0].comparison.way, "path")
        outcome = fit_problem(problem, 1, 1, 50)
        numpy.testing.assert_allclose(self.values(outcome), [2.0, 3.0], rtol=5e-3)

    def test_a_test_under_growing_x_jumps_where_x_falls_back(self):
        x, y = under_growing_x(Curve(numpy.array([0.0, 1.0, 0.5, 1.5]), numpy.array([0.0, 10.0, 4.0, 2.0])))
        numpy.testing.assert_allclose(x, [0.0, 1.0, 1.0, 1.5])
        numpy.testing.assert_allclose(y, [0.0, 10.0, 3.0, 2.0])

    def test_falling_x_is_compared_like_growing_x(self):
        curve = measured(numpy.column_stack([-X, 2.0 * X]), "data")
        comparison = Comparison(curve)
        self.assertEqual(comparison.way, "x")
        self.assertLess(abs(comparison.residual(Curve(-X, 2.0 * X)).values).max(), 1e-12)
        self.assertAlmostEqual(abs(comparison.residual(Curve(-X, 4.0 * X)).values).max(), 1.0)

    def test_matches_never_go_backwards(self):
        costs = numpy.array([[3.0, 1.0, 2.0], [0.0, 5.0, 4.0], [2.0, 3.0, 1.0]])
        self.assertEqual(list(in_order(costs)), [0, 0, 2])  # the sum 4; the smallest of each row, 1, 0, 2, would go backwards

    # ---- tables and columns ----

    def table(self, text):
        path = self.folder / "data.csv"
        path.write_text(text)
        return path

    def test_tables_have_commas_semicolons_or_blanks(self):
        for text in ("x,y\n0,0\n1,2\n2,4\n", "0;0\n1;2\n2;4\n", "# remark\n0 0\n1\t2\n2  4\n"):
            curve = read_measured(self.table(text), units=("mm", "kN")).curve
            numpy.testing.assert_allclose([curve.x, curve.y], [[0.0, 1e-3, 2e-3], [0.0, 2e3, 4e3]])

    def test_columns_are_named(self):
        path = self.table("t,x,y,s\n0,0,1,9\n1,1,2,9\n2,2,3,9\n")
        found = read_measured(path, ["x", "y", "s"])
        self.assertEqual([list(found.curve.y), list(found.noise)], [[1.0, 2.0, 3.0], [9.0, 9.0, 9.0]])
        with self.assertRaisesRegex(InputError, "no column 'z'"):
            read_measured(path, ["x", "z"])

    def test_wrong_tables_are_refused(self):
        for text, words in {
            "": "no rows",
            "x,y\n0,0\n1,a\n2,3\n": r"data.csv:3: 'a' is not a number",
            "0,0\n1\n2,3\n": "data.csv:2: has 1 columns",
            "0,0\n1,1\n": "at least 3 rows",
            "0,0\n1,0\n2,0\n": "y is zero everywhere",
            "1,0\n1,1\n1,2\n": "all x are equal",
            "0,0\n1,nan\n2,3\n": "not finite",
        }.items():
            with self.subTest(text=text), self.assertRaisesRegex(InputError, words):
                read_measured(self.table(text))
        with self.assertRaisesRegex(InputError, "unit furlong: must be one of"):
            read_measured(self.table("0,0\n1,1\n2,3\n"), units=("furlong", "N"))

    def test_columns_of_a_run_may_be_sums(self):
        (self.folder / "history.csv").write_text("a,reaction_y:top\n1,10\n2,30\n")
        curve = computed(self.folder, Columns("reaction_y:top - a", "-2*a"))
        self.assertEqual([list(curve.x), list(curve.y)], [[9.0, 28.0], [-2.0, -4.0]])
        with self.assertRaisesRegex(InputError, "Did you mean 'reaction_y:top'"):
            computed(self.folder, Columns("a", "reaction_y:topp"))

    def test_wrong_parameters_are_refused(self):
        for arguments, words in {
            ("k", None): "no value in the case",
            ("k", "10 mm", "1 m"): "must be in mm",
            ("k", 1.0, "2 m"): "must be a plain number",
            ("k", True): "must be a number",
            ("k", "wide"): "must be a number",
            ("k", 1.0, None, (2.0, 3.0)): "must be from 2 to 3, the bounds",
            ("k", 1.0, None, (3.0, 2.0)): "must ascend",
        }.items():
            with self.subTest(arguments), self.assertRaisesRegex(InputError, words):
                parameter(*arguments)
        self.assertEqual(parameter("k", "10 mm").text(2.5), '"2.5 mm"')
        self.assertEqual(parameter("k", 10).text(3.0), "3.0")


if __name__ == "__main__":
    unittest.main()
