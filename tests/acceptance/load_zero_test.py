"""Step 0: the state at load 0 is solved for in every mode, and later steps are measured from it."""

import json
import unittest

import h5py

from tests.acceptance.programme_test import Programmes

HANGING = """\
dimension = 1
[lattice]
spacing = 1.0
horizon_ratio = 1.015
area = 1.0
[[lattice.shape]]
add = "box"
min = [0]
max = [4]
[[set]]
name = "top"
where = "x < 1"
[[set]]
name = "end"
where = "x > 3"
[material]
micromodulus = 1e9
density = 1000
[[support]]
set = "top"
displacement = [0]
[[load]]
gravity = ["WEIGHT"]
[solver]
mode = "MODE"
"""

CANTILEVER = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.02, 0.005]
[[lattice.layer]]
name = "wall"
side = "x-"
[[set]]
name = "tip"
where = "x > 0.019"
[material]
youngs_modulus = 1e9
density = 1000
[[support]]
set = "wall"
displacement = [0, 0]
[[load]]
set = "tip"
total_force = [0, "-0.5*load"]
[[load]]
gravity = [0, "WEIGHT"]
[[probe]]
name = "tip"
set = "tip"
"""

FREE = """\
dimension = 2
[lattice]
spacing = 1.0
thickness = 1.0
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [6, 4]
[[set]]
name = "corner"
where = "x < 1 && y < 1"
[[set]]
name = "beside"
where = "x > 5 && y < 1"
[material]
youngs_modulus = 1e6
thermal_expansion = 1e-3
[[support]]
set = "corner"
displacement = [0, 0]
[[support]]
set = "beside"
displacement = ["free", 0]
[temperature]
change = "20"
"""

TWO_BONDS = """\
dimension = 1
[lattice]
spacing = 1.0
horizon_ratio = 1.015
area = 1.0
[[lattice.shape]]
add = "box"
min = [0]
max = [4]
[[set]]
name = "left"
where = "x < 1"
[[set]]
name = "right"
where = "x > 3"
[[set]]
name = "weak"
where = "x > 1 && x < 3"
[material]
micromodulus = 1e6
[material.damage]
law = "critical_stretch"
critical = 1e-3
[[region]]
set = "weak"
[region.material]
micromodulus = 1e6
[region.material.damage]
law = "critical_stretch"
critical = 5e-4
[[support]]
set = "left"
displacement = [0]
[[load]]
set = "right"
total_force = ["FORCE"]
[solver]
mode = "path"
"""


class LoadZero(Programmes):
    first_step = 0

    def test_a_hanging_bar_takes_the_work_that_it_stores(self):
        """Each bond, of stiffness k, carries the weight W below it: E = sum of W^2 / 2k."""
        weight, stiffness = 1000 * 9.81, 1e9
        stored = sum((count * weight) ** 2 / (2 * stiffness) for count in (1, 2, 3))
        ramped = self.rows(HANGING.replace("WEIGHT", "9.81*load").replace("MODE", "newton"), name="ramped")[-1]
        self.assertAlmostEqual(ramped["stored_energy"], stored, delta=1e-9 * stored)
        for mode in ("newton", "adaptive", "relaxation", "arc_length"):
            for steps in (1, 10):
                with self.subTest(mode=mode, steps=steps):
                    text = HANGING.replace("WEIGHT", "9.81").replace("MODE", mode)
                    if mode == "arc_length":  # needs something that grows
                        text += '[[load]]\nset = "end"\ntotal_force = ["1000*load"]\n'
                    rows = self.rows(text, f"loading.steps={steps}", name=f"{mode}{steps}")
                    self.assertEqual([rows[0]["step"], rows[0]["load_factor"]], [0, 0])
                    for row in rows[:1] if mode == "arc_length" else rows:
                        self.assertAlmostEqual(row["external_work"] / stored, 1.0, delta=1e-9)
                        self.assertAlmostEqual(row["stored_energy"] / stored, 1.0, delta=1e-9)
                        self.assertLess(abs(row["balance_error"]), 1e-12 * stored)
                        self.assertAlmostEqual(row["reaction_x:top"] / (-4 * weight), 1.0, delta=1e-9)

    def test_a_free_body_that_grows_takes_no_work(self):
        row = self.rows(FREE)[0]
        self.assertEqual(row["step"], 0)
        self.assertLess(abs(row["external_work"]), 1e-6)  # 20 % of 1e6 Pa in 24 m3 would be 1e4 J
        self.assertLess(abs(row["stored_energy"]), 1e-6)

    def test_the_end_does_not_depend_on_how_the_weight_came(self):
        dead = self.rows(CANTILEVER.replace("WEIGHT", "-2e3"), "loading.steps=5", name="dead")
        ramped = self.rows(CANTILEVER.replace("WEIGHT", "-2e3*load2"), "loading.steps=20",
                               "loading.table=[0, 0, 1]", "loading.table2=[0, 1, 1]", name="ramped")  # fmt: skip
        at_zero = next(row for row in ramped if row["stage"] == 1)
        for column in ("stored_energy", "external_work", "tip_y", "reaction_y:wall"):
            bound = 1e-4 if column == "external_work" else 1e-8  # the trapezoidal rule of the ramp
            self.assertAlmostEqual(dead[0][column] / at_zero[column], 1.0, delta=bound)
            self.assertAlmostEqual(dead[-1][column] / ramped[-1][column], 1.0, delta=10 * bound)

    def test_arc_length_and_control_start_from_a_dead_weight(self):
        text = CANTILEVER.replace("WEIGHT", "-2e3")
        loaded = self.rows(text, "loading.steps=10", name="loaded")
        along = self.rows(text, "loading.steps=10", "solver.mode=arc_length", name="along")
        self.assertEqual(along[0]["step"], 0)
        for column in ("stored_energy", "tip_y"):
            self.assertAlmostEqual(along[0][column] / loaded[0][column], 1.0, delta=1e-8)
            self.assertAlmostEqual(along[-1][column] / loaded[-1][column], 1.0, delta=1e-8)
        moved = loaded[-1]["tip_y"] - loaded[0]["tip_y"]
        control = f'[[control]]\nset = "tip"\nweights = [0, 1]\n[loading]\nsteps = 10\ntable = [0, {moved!r}]\n'
        held = self.rows(text + control, name="held")
        self.assertEqual(held[0]["control"], 0.0)
        self.assertEqual(held[0]["load_factor"], 0.0)
        self.assertAlmostEqual(held[0]["tip_y"] / loaded[0]["tip_y"], 1.0, delta=1e-8)
        self.assertAlmostEqual(held[-1]["control"] / moved, 1.0, delta=1e-8)
        self.assertAlmostEqual(held[-1]["load_factor"], 1.0, delta=1e-6)
        self.assertAlmostEqual(held[-1]["stored_energy"] / loaded[-1]["stored_energy"], 1.0, delta=1e-6)
        self.assertAlmostEqual(held[-1]["external_work"] / held[-1]["stored_energy"], 1.0, delta=1e-3)

    def test_the_path_meets_the_first_strength_beyond_the_dead_load(self):
        rows = self.rows(TWO_BONDS.replace("FORCE", "100 + 1000*load"))
        first = next(row for row in rows if row["step"] == 1)
        self.assertAlmostEqual(first["load_factor"], 0.4, delta=1e-9)
        self.assertAlmostEqual(rows[0]["external_work"] / rows[0]["stored_energy"], 1.0, delta=1e-12)

    def test_arc_length_names_a_dead_load_beyond_strength(self):
        self.run_case(TWO_BONDS.replace("FORCE", "600 + 1000*load").replace('"path"', '"arc_length"'), code=3)
        reason = json.loads((self.folder / "out" / "summary.json").read_text())["reason"]
        self.assertIn("damage_begins on the way to load 0", reason)
        self.assertIn("arc_length", reason)

    def test_the_path_breaks_what_a_dead_load_breaks(self):
        """The weak bond carries 500 N, and dissipates k s^2 / 2."""
        rows = self.rows(TWO_BONDS.replace("FORCE", "600 + 1000*load"))
        self.assertEqual([rows[0]["step"], rows[0]["broken_bonds"]], [0, 1])
        self.assertAlmostEqual(rows[0]["dissipated_energy"], 0.5 * 1e6 * 5e-4**2, delta=1e-9)
        self.assertAlmostEqual(rows[0]["pin_force"], 600, delta=1e-6)  # nothing else holds the end

    def test_it_goes_on_from_step_zero(self):
        text = CANTILEVER.replace("WEIGHT", "-2e3")
        whole = self.rows(text, "loading.steps=3", name="whole")
        with h5py.File(self.folder / "whole" / "results.h5") as file:
            self.assertEqual(list(file["steps"]), ["000000", "000001", "000002", "000003"])
        self.assertEqual(len(whole), 4)
        self.run_case(text, "loading.steps=3", name="part", words=("--stop-after", 1), code=130)
        self.resume("part")
        self.assertEqual(self.history("part"), whole)

    def test_a_planned_unloading_is_no_failure(self):
        text = CANTILEVER.replace("WEIGHT", "0")
        rows = self.rows(text, "loading.steps=4", "loading.table=[0, 1, 0, 1]", "loading.stop_below=0.5")
        self.assertEqual([row["step"] for row in rows], list(range(13)))


if __name__ == "__main__":
    unittest.main()
