"""Loads that are found with the states: displacement control, and the arc length."""

import math
import unittest

import h5py
import numpy

from tests.acceptance.programme_test import Programmes
from tests.acceptance.strip import PULLED
from tests.reference.program import PLOT, ROOT
from tests.reference.results import table
from tests.same_results import differences
from tests.shipped_runs import shipped_run

CASES = ROOT / "cases"
# Relative error of displacements, for residuals of 1e-10.
CLOSE = 1e-8


def numbers(folder, *columns):
    """A column over all steps but 0."""
    rows = [row for row in table(folder / "history.csv") if row["step"] > 0]
    return [numpy.array([row[column] for row in rows]) for column in columns]


def critical_points(folder):
    return [(row["load_factor"], row["reason"]) for row in table(folder / "decisions.csv")
            if row["action"] == "locate critical point"]  # fmt: skip


class ShippedCase(Programmes):
    def shipped(self, case, *changes):
        ended = shipped_run(case, *changes)
        self.assertEqual(ended.code, 0, ended.errors)
        return ended.folder

    def straight_strip(self, rows, force):
        """End displacement and elongation of the middle half of a clamped strip, 240 points long, with the shipped
        cases' lattice."""
        height = rows * 0.005
        text = f"""\
dimension = 2
[lattice]
spacing = 0.01
thickness = 0.01
[[lattice.shape]]
add = "box"
min = [0.0, {-height}]
max = [2.4, {height}]
[[lattice.layer]]
name = "clamp"
side = "x-"
thickness = 3
[[set]]
name = "end"
where = "x > 2.39"
[[set]]
name = "near"
where = "abs(x - 0.605) < 1e-3"
[[set]]
name = "far"
where = "abs(x - 1.805) < 1e-3"
[material]
youngs_modulus = 200e9
[quadrature]
surface_correction = "energy"
[[support]]
set = "clamp"
displacement = [0, 0]
[[load]]
set = "end"
total_force = {force}
[[probe]]
name = "end"
set = "end"
[[probe]]
name = "middle"
set = "far"
field = "opening"
other = "near"
"""
        last = self.rows(text, name=f"strip_{rows}_{force[0]}")[-1]
        return last["end_y"], last["middle_x"]

    def stiffnesses(self, rows):
        """EA and EI of the points: from the strain of the middle, and from the deflection F L^3 / (3 EI)."""
        axial = 1e-3 / (self.straight_strip(rows, ["1e-3*load", "0"])[1] / 1.2)
        bending = 1e-3 * 2.395**3 / (3.0 * self.straight_strip(rows, ["0", "1e-3*load"])[0])
        return axial, bending


class Arch(ShippedCase):
    """y = h/2 (1 - cos kx) between clamps, loaded by q cos kx. With the remaining rise a,
    q = k^4/2 (EI (h - a) + EA/16 (h^2 - a^2) a), from the equilibrium EI (y - y0)'''' + P y'' = q cos kx
    under the thrust P = EA k^2/16 (h^2 - a^2) of a shallow arch."""

    LENGTH, ROWS, SPACING = 4.8, 6, 0.01
    RISE = 5 * ROWS * SPACING / math.sqrt(12)

    def load_factor(self, rise, axial, bending):
        wave = 2 * math.pi / self.LENGTH
        load = wave**4 / 2 * (bending * (self.RISE - rise) + axial / 16 * (self.RISE**2 - rise**2) * rise)
        return load / (1.5e7 * self.ROWS * self.SPACING * 0.01)

    def test_its_points_are_those_of_the_formula(self):
        points = numpy.genfromtxt(CASES / "buckling/arch.csv", delimiter=",", skip_header=1, usecols=(0, 1, 2))
        columns = round(self.LENGTH / self.SPACING) + 6
        self.assertEqual(len(points), columns * self.ROWS)
        x = (numpy.repeat(numpy.arange(columns), self.ROWS) - 2.5) * self.SPACING
        inside = (x > 0) & (x < self.LENGTH)
        middle = numpy.where(inside, self.RISE / 2 * (1 - numpy.cos(2 * math.pi * x / self.LENGTH)), 0.0)
        across = (numpy.tile(numpy.arange(self.ROWS), columns) - 2.5) * self.SPACING
        numpy.testing.assert_allclose(points, numpy.stack([x, middle + across, 0 * x + 1e-6], axis=1), atol=1e-9)

    def test_it_snaps_through_as_shallow_arch_theory_says(self):
        folder = self.shipped("buckling/arch")
        axial, bending = self.stiffnesses(self.ROWS)
        # docs/stability.md: "6 % stiffer in tension and 4 % softer in bending than its material"
        height, width, modulus = self.ROWS * self.SPACING, 0.01, 200e9
        self.assertAlmostEqual(axial / (modulus * width * height), 1.06, delta=0.005)
        self.assertAlmostEqual(bending / (modulus * width * height**3 / 12), 0.96, delta=0.005)
        highest = math.sqrt((self.RISE**2 - 16 * bending / axial) / 3)
        expected = [self.load_factor(rise, axial, bending) for rise in (highest, -highest)]
        found = critical_points(folder)
        self.assertEqual([reason.split(" between")[0] for _, reason in found], ["a limit point"] * 2)
        for (load_factor, _), theory in zip(found, expected):
            self.assertLess(abs(load_factor / theory - 1), 0.01)
        loads, sunk, pivots = numbers(folder, "load_factor", "middle_y", "negative_pivots")
        for load, down, negative in zip(loads, sunk, pivots):
            rise = self.RISE + down
            self.assertLess(abs(load - self.load_factor(rise, axial, bending)), 0.02)
            if abs(abs(rise) - highest) > 0.05 * self.RISE:
                self.assertEqual(negative, int(abs(rise) < highest), rise)
        self.assertEqual(loads[-1], 1.0)

    def test_it_goes_on_from_every_step_as_if_nothing_had_been(self):
        # Coarse, so that there are few steps: a located limit point among them.
        case = CASES / "buckling/arch.toml", "loading.steps=4", "arc_length.largest_step=0.5"
        steps = len(self.rows(*case, name="whole"))
        self.run_case(*case, name="split", words=("--stop-after", 1), code=130)
        for _ in range(steps + 2):
            if self.resume("split", words=("--stop-after", 1), code=(0, 130)).code == 0:
                break
        else:
            self.fail("it does not end")
        self.assertEqual(differences(self.folder / "whole", self.folder / "split"), [])


class Column(ShippedCase):
    LENGTH = 3.195  # to the centres of its last points

    def test_it_buckles_at_eulers_load_and_bends_as_the_elastica(self):
        folder = self.shipped("buckling/column")
        _, bending = self.stiffnesses(8)
        euler = math.pi**2 * bending / (4 * self.LENGTH**2) / 32e3
        (critical, reason), *others = critical_points(folder)
        self.assertTrue(reason.startswith("a bifurcation"), reason)
        self.assertEqual(others, [])
        self.assertLess(abs(critical / euler - 1), 0.01)
        loads, along, across, pivots = numbers(folder, "load_factor", "top_x", "top_y", "negative_pivots")
        self.assertFalse(pivots.any())  # straight before, bent beyond: stable
        self.assertEqual(loads[-1], 1.0)
        compared = 0
        for load, u, v in zip(loads, along, across):
            if load < 1.01 * critical:
                continue
            modulus = self.modulus_of(load / critical)
            first, second = self.elliptic_integrals(modulus)
            self.assertLess(abs(abs(v) / self.LENGTH - 2 * modulus / first), 0.01)
            self.assertLess(abs(1 + u / self.LENGTH - (2 * second / first - 1)), 0.01)
            compared += 1
        self.assertGreater(compared, 3)

    @staticmethod
    def elliptic_integrals(modulus):
        """K and E, by the arithmetic-geometric mean."""
        a, b, rest, factor = 1.0, math.sqrt(1 - modulus**2), 1 - modulus**2 / 2, 0.25
        while abs(a - b) > 1e-15:
            rest -= factor * (a - b) ** 2
            a, b, factor = (a + b) / 2, math.sqrt(a * b), 2 * factor
        return math.pi / (2 * a), rest * math.pi / (2 * a)

    def modulus_of(self, ratio):
        """Load over Euler's load on the elastica: (2 K / pi)^2."""
        low, high = 0.0, 1 - 1e-12
        for _ in range(60):
            middle = (low + high) / 2
            if (2 * self.elliptic_integrals(middle)[0] / math.pi) ** 2 < ratio:
                low = middle
            else:
                high = middle
        return low

    def test_it_can_be_followed_straight_on(self):
        folder = self.shipped("buckling/column", "arc_length.bifurcation=straight")
        loads, across, pivots = numbers(folder, "load_factor", "top_y", "negative_pivots")
        self.assertLess(abs(across).max(), 1e-6)
        critical = critical_points(folder)[0][0]
        for load, negative in zip(loads, pivots):
            self.assertEqual(negative > 0, load > critical)

    def test_one_step_or_a_hundred_find_the_same_load(self):
        reference = critical_points(self.shipped("buckling/column"))[0][0]
        for change in ("loading.steps=1", "loading.steps=100"):
            with self.subTest(change):
                found = critical_points(self.shipped("buckling/column", change))
                self.assertLess(abs(found[0][0] / reference - 1), 1e-3)

    def test_a_control_of_its_top_does_not_hide_that_it_buckles(self):
        text = (CASES / "buckling/column.toml").read_text()
        text = text[text.index("dimension"): text.index("[loading]")]
        top = '[[control]]\nset = "top"\nweights = [-1, 0]\n'
        critical = critical_points(self.shipped("buckling/column"))[0][0]
        for steps, tolerance in ((1, 1e-2), (1, 1e-4), (1, 1e-9), (20, 1e-9)):
            with self.subTest(steps=steps, tolerance=tolerance):
                rows = self.rows(f"{text}{top}[loading]\ntable = [0, 1e-3]\nsteps = {steps}\nsmallest_step = 1e-3\n",
                                     f"solver.relative_tolerance={tolerance}",
                                     name=f"in_{steps}_to_{tolerance}", code=3)  # fmt: skip
                self.assertTrue(all(row["negative_pivots"] == 0 for row in rows))
                self.assertLess(abs(rows[-1]["load_factor"] / critical - 1), max(0.02, 2 * tolerance))

    def test_load_control_tells_that_it_is_unstable(self):
        self.run_case(CASES / "buckling/column.toml", "solver.mode=newton", threads=2, code=3)
        self.assertIn("negative pivots", self.ended.said)


OPENED = PULLED.replace("1e-5*load", "1e-3*load") + """\
[[set]]
name = "middle"
where = "abs(x - 0.01) < 1e-3"
[[control]]
set = "middle"
weights = [2, -1]
[loading]
table = [0, 1e-5]
steps = 4
"""


SOFTENING = OPENED.replace("youngs_modulus = 200e9\n", """youngs_modulus = 200e9
[material.damage]
law = "tanh_continuous"
onset = 0.001
critical = 0.01
no_fail = ["left", "right"]
""").replace("[0, 1e-5]", "[0, 4e-5]")  # fmt: skip


class Control(Programmes):
    def test_its_states_are_those_of_the_loads_that_it_finds(self):
        rows = self.rows(OPENED, name="controlled")
        controlled = self.displacements("controlled")
        self.assertEqual(len(rows), 4)
        with h5py.File(self.folder / "controlled" / "results.h5") as file:
            reference = file["points/reference"][...]
        middle = abs(reference[:, 0] - 0.01) < 1e-3
        for k, (row, displacement) in enumerate(zip(rows, controlled), 1):
            self.assertAlmostEqual(row["control"], k * 2.5e-6, delta=1e-15)
            mean = displacement[middle].mean(axis=0)
            self.assertAlmostEqual(2 * mean[0] - mean[1], k * 2.5e-6, delta=1e-14)
            self.assertEqual(row["negative_pivots"], 0)
        for row, displacement in zip(rows, controlled):
            text = OPENED[: OPENED.index("[[control]]")].replace("1e-3*load", f"{row['load_factor']!r}*1e-3*load")
            self.run_case(text, name=f"loaded_{row['step']}")
            loaded = self.displacements(f"loaded_{row['step']}")[-1]
            self.assertLess(abs(loaded - displacement).max(), CLOSE * abs(displacement).max())

    def test_it_goes_up_and_down_and_beside_other_loads(self):
        text = OPENED.replace('"1e-3*load", "free"', '"1e-3*load", "1e-6*load2"')
        rows = self.rows(text, "loading.table=[0,1e-5,-1e-5,0]", "loading.table2=[0,1,1,0]")
        top, bottom, end = (row for row in rows if row["stage"] in (1, 2, 3))
        for row, control in ((top, 1e-5), (bottom, -1e-5)):
            self.assertAlmostEqual(row["control"], control, delta=1e-17)
        self.assertGreater(top["load_factor"], 0)
        self.assertLess(bottom["load_factor"], 0)
        self.assertAlmostEqual(end["load_factor"], 0, delta=1e-9)
        self.assertLess(abs(end["stored_energy"]), 1e-9 * top["stored_energy"])

    def test_a_damaged_strip_goes_back_to_nothing(self):
        rows = self.rows(SOFTENING, "loading.table=[0,4e-5,0]")
        self.assertEqual(rows[-1]["stage"], 2)
        self.assertGreater(rows[-1]["dissipated_energy"], 0)
        self.assertLess(abs(rows[-1]["load_factor"]), 1e-9 * max(row["load_factor"] for row in rows))

    def test_one_step_or_many_end_alike(self):
        one, many = (self.rows(OPENED, f"loading.steps={steps}", name=f"in_{steps}")[-1] for steps in (1, 30))
        self.assertLess(abs(one["load_factor"] / many["load_factor"] - 1), CLOSE)

    def test_it_goes_on_where_it_was_stopped(self):
        self.run_case(SOFTENING, name="whole")
        self.run_case(SOFTENING, name="split", words=("--stop-after", 2), code=130)
        self.resume("split")
        self.assertGreater(self.history("whole")[-1]["dissipated_energy"], 0)
        self.assertEqual(differences(self.folder / "whole", self.folder / "split"), [])


class SnapBack(Programmes):
    """A brittle plate, cut from one side, under control of its far corner: it snaps back with the first bonds."""

    TEXT = """\
dimension = 2
[lattice]
spacing = 0.001
thickness = 0.001
horizon_ratio = 2.015
shape = [{ add = "box", min = [0, 0], max = [0.007, 0.007] }]
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 1.3e-3
[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[[set]]
name = "bottom"
where = "y < 0.0011"
[[set]]
name = "top"
where = "y > 0.0059"
[[set]]
name = "corner"
where = "min(x, y) > 0.0059"
[[crack]]
from = [-0.001, 0.004]
to = [0.002, 0.004]
[[support]]
set = "bottom"
displacement = [0, 0]
[[load]]
set = "top"
total_force = ["140.0*load", "1400.0*load"]
[[control]]
set = "corner"
weights = [0, 1]
[loading]
table = [0, 2.8e-5]
[solver]
mode = "newton"
relative_tolerance = 1e-11
"""

    def test_it_has_a_name_and_a_way_out(self):
        for steps in (4, 8):
            rows = self.rows(self.TEXT, f"loading.steps={steps}", name=f"of_{steps}", code=3)
            told = (self.folder / f"of_{steps}/dossier.txt").read_text()
            self.assertIn("Stopped: no_answer", told)
            self.assertIn('solver.mode = "path"', told)
            self.assertIn("a snap-back", told)
            self.assertNotIn("error in the program", told)
            # Loads of failed searches are not reported as loads that the body carried.
            reached = {0.0} | {row["load_factor"] for row in rows}
            for row in table(self.folder / f"of_{steps}/decisions.csv"):
                if row["outcome"] != "converged":
                    self.assertIn(row["load_factor"], reached)


class Pictures(ShippedCase):
    def test_the_path_is_drawn_where_loads_were_found(self):
        self.run_case(OPENED, name="controlled")
        self.run_case(PULLED, name="loaded")
        for folder, has_path in ((self.folder / "controlled", True), (self.folder / "loaded", False)):
            self.assert_completed(self.execute([*PLOT, folder]))
            self.assertEqual((folder / "plots" / "path.png").exists(), has_path)


class BadInput(Programmes):
    def test_a_control_that_nothing_free_answers_to(self):
        held = self.refusal(OPENED, 'control[0].set="right"', "control[0].weights=[1,0]")
        self.assertIn("contains no free degree of freedom", held)
        self.assertIn("case.toml:", held)
        # No loaded point moves across: the strip is symmetric about its axis.
        still = OPENED.replace("abs(x - 0.01) < 1e-3", "abs(x - 0.01) < 1e-3 && abs(y - 5e-3) < 1e-3")
        self.assertIn("does not respond", self.refusal(still, "control[0].weights=[0,1]"))
        self.assertIn("nor a load depends on load", self.refusal(OPENED.replace("1e-3*load", "0")))
        for curved in ("load^2", "abs(load)"):  # zero slope at load 0, or the same change in both directions
            self.assertIn("must start in proportion to load", self.refusal(OPENED.replace("1e-3*load", f"1e-3*{curved}")))

    def test_what_does_not_go_with_a_control(self):
        self.assertIn("loading.table", self.refusal(OPENED.replace("table = [0, 1e-5]\n", "")))
        self.assertIn('must be "newton"', self.refusal(OPENED, "solver.mode=adaptive"))
        self.assertIn('must be "newton"', self.refusal(OPENED, "solver.mode=arc_length"))
        self.assertIn("solver.linear", self.refusal(OPENED, "solver.linear=pcg"))
        self.assertIn("solver.projection", self.refusal(OPENED, "solver.projection=always"))
        self.assertIn("not all zero", self.refusal(OPENED, "control[0].weights=[0,0]").replace("are all zero", "not all zero"))
        self.assertIn("must begin with 0", self.refusal(OPENED, "loading.table=[1e-6,1e-5]"))

    def test_what_does_not_go_with_the_arc_length(self):
        arc = PULLED + '[solver]\nmode = "arc_length"\n'
        self.assertIn("two entries", self.refusal(arc, "loading.table=[0,1,0]"))
        self.assertIn("depends on load", self.refusal(arc.replace("1e-5*load", "0")))
        self.assertIn("arc_length.largest_step", self.refusal(arc, "loading.largest_step=1.0"))
        self.assertIn("solver.preconditioner", self.refusal(arc, "solver.preconditioner=jacobi"))

    def test_a_load_that_ends_within_the_path(self):
        text = OPENED.replace("1e-3*load", "1e-3*sqrt(0.004 - load)*load")
        self.assertGreater(len(self.rows(text, code=3)), 1)
        self.assertIn("undefined_condition", self.ended.said)


if __name__ == "__main__":
    unittest.main()
