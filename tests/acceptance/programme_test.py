"""Loads that increase and decrease, rest, and have several parameters."""

import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.resume_test import TORN
from tests.acceptance.strip import PULLED
from tests.reference.results import table
from tests.same_results import differences

BAR = """\
dimension = 1
[lattice]
spacing = 1e-2
area = 1e-4
[[lattice.shape]]
add = "box"
min = [0.0]
max = [0.5]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[material]
youngs_modulus = 200e9
[material.damage]
law = "tanh_continuous"
onset = 0.004
critical = 0.02
no_fail = ["left", "right"]
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = ["4e-3*load"]
[[probe]]
name = "end"
set = "right"
"""
ROUND_OFF = 1e-12


class Programmes(Folder):
    first_step = 1  # of the `history`; step 0 has a test of its own

    def rows(self, case, *changes, name="out", **options):
        """The history of a run."""
        self.run_case(case, *changes, name=name, **options)
        return self.history(name)

    def history(self, name="out"):
        return [row for row in table(self.folder / name / "history.csv") if row["step"] >= self.first_step]

    def displacements(self, name="out"):
        with h5py.File(self.folder / name / "results.h5") as file:
            return [step["displacement"][...] for step in file["steps"].values()]


class Cycles(Programmes):
    def is_elastic_since(self, rows, first, force):
        """From row `first` on all rows follow one secant: work is stored and returned, nothing is dissipated."""
        at_first = rows[first]
        stiffness = at_first[force] / at_first["load_factor"]
        for row in rows[first:]:
            self.assertEqual(row["broken_bonds"], at_first["broken_bonds"])
            dissipated_since = row["dissipated_energy"] - at_first["dissipated_energy"]
            self.assertLess(abs(dissipated_since), ROUND_OFF * at_first["dissipated_energy"])
            self.assertLess(abs(row[force] - stiffness * row["load_factor"]), 1e-9 * abs(at_first[force]))

    def test_a_damaged_bar_unloads_and_loads_along_its_secant(self):
        rows = self.rows(BAR, "loading.table=[0,1,0,-0.5,0.8,1]", "loading.steps=5", 'solver.mode="newton"')
        self.assertEqual([row["load_factor"] for row in rows[4::5]], [1, 0, -0.5, 0.8, 1])
        self.assertGreater(rows[4]["dissipated_energy"], 0.01 * rows[4]["stored_energy"])
        # It is softer in tension than before, and unchanged in compression.
        self.is_elastic_since(rows[:10] + rows[20:], 4, "reaction_x:right")
        unloaded = rows[9]
        self.assertLess(abs(unloaded["reaction_x:right"]), 1e-8 * rows[4]["reaction_x:right"])
        self.assertLess(unloaded["stored_energy"], ROUND_OFF * rows[4]["stored_energy"])
        self.assertLess(abs(rows[-1]["stored_energy"] / rows[4]["stored_energy"] - 1), 1e-9)
        # External work is a sum by the trapezoidal rule, exact along a straight line.
        for row in rows[5:]:
            self.assertLess(abs(row["balance_error"] - rows[4]["balance_error"]), 1e-9 * rows[4]["stored_energy"])

    def test_a_torn_plate_does_so_in_every_mode(self):
        for mode in ("adaptive", "relaxation"):
            with self.subTest(mode):
                self.run_case(TORN, "loading.table=[0,1,0,1]", "loading.steps=5", "relaxation.steps=20",
                              f'solver.mode="{mode}"')  # fmt: skip
                rows = self.history()
                top = next(k for k, row in enumerate(rows) if row["stage"] == 1)
                self.assertGreater(rows[top]["broken_bonds"], 50)
                self.assertEqual(rows[-1]["stage"], 3)
                last = rows[-1]
                self.assertEqual(last["broken_bonds"], rows[top]["broken_bonds"])
                for key, within in {"dissipated_energy": ROUND_OFF, "stored_energy": 1e-6, "reaction_x:right": 1e-6}.items():
                    self.assertLess(abs(last[key] / rows[top][key] - 1), within, key)
                bottom = next(row for row in rows if row["stage"] == 2)
                self.assertLess(bottom["stored_energy"], 1e-8 * rows[top]["stored_energy"])

    def test_a_rest_changes_nothing(self):
        for text, mode in ((BAR, "newton"), (TORN, "adaptive"), (TORN, "relaxation")):
            with self.subTest(mode):
                self.run_case(text, "loading.table=[0,1,1]", "loading.steps=5", "relaxation.steps=10",
                              f'solver.mode="{mode}"')  # fmt: skip
                rows, displacements = self.history(), self.displacements()
                top = next(k for k, row in enumerate(rows) if row["stage"] == 1)
                size = abs(displacements[top]).max()
                self.assertGreater(len(rows), top + 1)
                for row, displacement in list(zip(rows, displacements))[top + 1 :]:
                    self.assertLess(abs(displacement - displacements[top]).max(), 1e-9 * size)
                    self.assertEqual(row["broken_bonds"], rows[top]["broken_bonds"])
                    self.assertEqual(row["dissipated_energy"], rows[top]["dissipated_energy"])
                    self.assertLess(abs(row["external_work"] - rows[top]["external_work"]), 1e-9 * rows[top]["external_work"])

    def test_the_way_up_is_the_same_whatever_follows(self):
        self.run_case(TORN, name="up")
        self.run_case(TORN, "loading.table=[0,1,0.5]", name="cycle")
        up, cycle = self.displacements("up"), self.displacements("cycle")
        for one, other in zip(up, cycle):
            numpy.testing.assert_array_equal(one, other)


class Parameters(Programmes):
    def test_one_after_the_other(self):
        pulled_and_sheared = PULLED.replace('["1e-5*load", "free"]', '["1e-5*load", "2e-5*load2"]')
        rows = self.rows(pulled_and_sheared, "loading.table=[0,1,1,0]", "loading.table2=[0,0,1,1]", "loading.steps=2")
        pulled, both, sheared = rows[1], rows[3], rows[5]
        self.assertLess(abs(pulled["reaction_y:right"]), 1e-9 * pulled["reaction_x:right"])
        # Small displacements: forces add up, except for the effect of rotations.
        self.assertLess(abs(both["reaction_x:right"] / pulled["reaction_x:right"] - 1), 0.05)
        self.assertLess(abs(sheared["reaction_y:right"] / both["reaction_y:right"] - 1), 0.05)
        self.assertEqual([row["stage"] for row in rows], [0.5, 1, 1.5, 2, 2.5, 3])

    def test_an_expression_of_the_step_is_its_table(self):
        self.run_case(PULLED, 'loading.table="sin(step/6*pi)"', "loading.steps=6", name="expression")
        entries = [float(numpy.sin(step / 6 * numpy.pi)) for step in range(7)]
        self.run_case(PULLED, f"loading.table={entries}", "loading.steps=1", name="table")
        for one, other in zip(self.history("expression"), self.history("table"), strict=True):
            self.assertAlmostEqual(one["load_factor"], other["load_factor"], delta=1e-15)
            self.assertAlmostEqual(one["stored_energy"], other["stored_energy"], delta=1e-12)

    def test_a_table_that_says_what_is_the_default_changes_nothing(self):
        self.run_case(TORN, name="default")
        self.run_case(TORN, "loading.table=[0,1]", name="table")
        self.assertEqual(differences(self.folder / "default", self.folder / "table"), [])

    def test_tables_that_are_wrong(self):
        for setting, words in {
            "loading.table=[1,2]": "loading.table = [1,2]: must begin with 0",
            "loading.table=[0]": "needs at least two entries",
            'loading.table="step + 1"': "must begin with 0",
            'loading.table="x"': "unknown variable x; allowed are step, pi",
            'loading.table="1/step"': "the value at step = 0 is inf; it must be finite",
            "loading.table2=[0,1,2]": "loading.table2 = [0,1,2]: has 3 entries, but the first table has 2",
            "loading.table3=[0,1]": "loading.table2: is missing, but a table with a higher number is given",
            'support[1].displacement=["1e-5*load2","free"]': "unknown variable load2; allowed are x, y, load, pi",
        }.items():
            with self.subTest(setting):
                self.assert_refused(self.command("check", PULLED, setting), words)


class GoingOn(Programmes):
    def test_a_cycle_that_is_split(self):
        words = "loading.table=[0,1,0.2,1.1]", "loading.steps=3"
        self.run_case(TORN, *words, name="whole")
        self.run_case(TORN, *words, name="split", words=("--stop-after", 20), code=130)
        while self.resume("split", words=("--stop-after", 9), code=(0, 130)).code == 130:
            pass
        self.assertEqual(differences(self.folder / "whole", self.folder / "split"), [])

    def test_more_load_after_the_end(self):
        self.run_case(TORN, "loading.table=[0,1,0.2,1.1]", name="whole")
        self.run_case(TORN, name="split")
        for table in ("[0,1,0.2]", "[0,1,0.2,1.1]"):
            self.resume("split", f"loading.table={table}")
        self.assertEqual(differences(self.folder / "whole", self.folder / "split"), [])

    def test_another_way_to_where_the_run_is(self):
        self.run_case(TORN, "loading.table=[0,1,0.2]", name="split", words=("--stop-after", 20), code=130)
        for table, words in {"[0,1.1,0.2]": "entry 1 has changed",
                             "[0]": "needs at least two entries"}.items():  # fmt: skip
            self.assertIn(words, self.resume("split", f"loading.table={table}", code=2).errors)


if __name__ == "__main__":
    unittest.main()
