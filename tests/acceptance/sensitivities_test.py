"""Derivatives of the history (table [sensitivity]), compared with differences of whole runs."""

import collections
import unittest

from tests.acceptance.folder import Folder
from tests.reference.results import table

STRIP = """
dimension = 2
[lattice]
spacing = 0.05
shape = [{ add = "box", min = [0, 0], max = [1, 0.5] }]
[[lattice.layer]]
name = "held"
side = "x-"
thickness = 3
[[lattice.layer]]
name = "pulled"
side = "x+"
thickness = 3
[[set]]
name = "left_lip"
where = "x > 0.4 && x < 0.5 && y < spacing"
[[set]]
name = "right_lip"
where = "x > 0.5 && x < 0.6 && y < spacing"
[[crack]]
from = [0.5, -0.1]
to = [0.5, 0.15]
[material]
youngs_modulus = 2e9
[material.damage]
law = "linear"
fracture_energy = 5000.0
strength = 4e6
no_fail = ["held", "pulled"]
[[support]]
set = "held"
displacement = [0, 0]
[[support]]
set = "pulled"
displacement = ["6e-3*load", 0]
[loading]
adaptive = false
[solver]
relative_tolerance = 1e-12
[[probe]]
name = "lip"
field = "displacement"
set = "right_lip"
"""
MATERIAL = ("material.youngs_modulus", "material.damage.fracture_energy", "material.damage.strength")
CONTROL = """
[[control]]
set = "right_lip"
weights = [1, 0]
[[control]]
set = "left_lip"
weights = [-1, 0]
"""
BEAM = """
dimension = {dimension}
[lattice]
spacing = 0.1
shape = [{{ add = "box", min = {low}, max = {high} }}]
[[lattice.layer]]
name = "held"
side = "x-"
thickness = 3
[[lattice.layer]]
name = "end"
side = "x+"
thickness = 1
[material]
youngs_modulus = 2e9
{material}
[[support]]
set = "held"
displacement = {zero}
[[load]]
set = "end"
total_force = {force}
[solver]
relative_tolerance = 1e-12
[[probe]]
name = "end"
field = "displacement"
set = "end"
"""


def over(*keys):
    return "sensitivity.over=[" + ", ".join(f'"{key}"' for key in keys) + "]"


def kind(column):
    """What all components of a column's quantity share: "d_reaction" of "d_reaction_x:held"."""
    return column.partition(":")[0].removesuffix("_x").removesuffix("_y").removesuffix("_z")


class Sensitivities(Folder):
    def derivatives(self, case, keys, *changes):
        """Rows of sensitivities.csv by parameter."""
        self.run_case(case, *changes, over(*keys))
        rows = table(self.folder / "out/sensitivities.csv")
        return {key: [row for row in rows if row["parameter"] == key] for key in keys}

    def assert_differences(self, case, keys, *changes, step=1e-5, tolerance=1e-6):
        """Derivatives are differences of runs, to this share of the largest one of their kind."""
        found = self.derivatives(case, keys, *changes)
        counts = []
        for key, rows in found.items():
            value = rows[0]["value"]
            runs = []
            for sign in (-1, 1):
                self.run_case(case, *changes, f"{key}={value * (1 + sign * step)!r}", name=f"side{sign}")
                runs.append(table(self.folder / f"side{sign}/history.csv"))
            counts.append(len(rows))
            columns = [name for name in rows[0] if name.startswith("d_") and name != "d_control"]
            wanted, round_off = {}, collections.defaultdict(float)
            for column in columns:
                less, more = ([row[column[2:]] for row in run] for run in runs)
                round_off[kind(column)] = max(round_off[kind(column)], 1e-9 * max(map(abs, more)) / abs(value))
                wanted[column] = [(b - a) / (2 * step * value) for a, b in zip(less, more)][: len(rows)]
            for column in columns:
                largest = max(abs(entry) for name in columns if kind(name) == kind(column) for entry in wanted[name])
                with self.subTest(key=key, column=column):
                    for row, entry in zip(rows, wanted[column]):
                        error = abs(row[column] - entry)
                        self.assertLessEqual(error, tolerance * largest + round_off[kind(column)])
        return counts

    def test_softening(self):
        counts = self.assert_differences(STRIP, MATERIAL, "loading.table=[0, 0.3]", "loading.steps=12")
        self.assertEqual(counts, [13, 13, 13])
        rows = table(self.folder / "out/history.csv")
        self.assertGreater(rows[-1]["dissipated_energy"], 100.0)

    def test_softening_under_a_control(self):
        case = STRIP + CONTROL
        counts = self.assert_differences(case, MATERIAL, "loading.table=[0, 1.2e-3]", "loading.steps=8")
        self.assertEqual(counts, [9, 9, 9])
        self.assertNotEqual(table(self.folder / "out/sensitivities.csv")[-1]["d_load_factor"], 0.0)

    def test_softening_by_release(self):
        for model, ratio in (("state", 0.2), ("cpd", 0.4)):
            with self.subTest(model):
                case = STRIP.replace("strength = 4e6", "")
                changes = (f"material.model={model}", f"material.poisson_ratio={ratio}", "loading.table=[0, 0.25]",
                           "loading.steps=5")  # fmt: skip
                keys = (MATERIAL[0], "material.poisson_ratio", MATERIAL[1])
                # Commits end within a tolerance, which differences of runs show.
                counts = self.assert_differences(case, keys, *changes, tolerance=1e-4)
                self.assertEqual(counts, [6, 6, 6])
                self.assertGreater(table(self.folder / "out/history.csv")[-1]["dissipated_energy"], 0.0)

    def test_models_and_loads(self):
        flat = dict(dimension=2, low=[0, 0], high=[1.5, 0.4], zero=[0, 0], force=[0, -2e4])
        solid = dict(dimension=3, low=[0, 0, 0], high=[1.2, 0.3, 0.3], zero=[0, 0, 0], force=[0, -2e3, 0])
        E, NU, FORCE = "material.youngs_modulus", "material.poisson_ratio", "load[0].total_force[1]"
        for name, keys, body, material, changes in (
            ("bonds in space by conjugate gradients", (E, FORCE), solid, "", ["solver.linear=pcg"]),
            ("a state-based solid", (E, NU, FORCE), flat, 'model = "state"\npoisson_ratio = 0.2', []),
            ("continuum-kinematics-inspired", (E, NU), flat, 'model = "cpd"\npoisson_ratio = 0.4', []),
            ("a sum of loads", ("load[0].total_force[0]", "material.thermal_expansion"), flat, "thermal_expansion = 1e-5",
             ["load[0].total_force=[3e4, -2e4]", 'temperature.change="100 * load * y"']),
        ):  # fmt: skip
            with self.subTest(name):
                self.assert_differences(BEAM.format(material=material, **body), keys, *changes)

    def test_threads_do_not_matter(self):
        found = []
        for threads in (1, 3):
            self.run_case(STRIP, "loading.table=[0, 0.2]", "loading.steps=4", over(*MATERIAL), threads=threads)
            found.append(table(self.folder / "out/sensitivities.csv"))
        for one, other in zip(*found):
            for name in (name for name in one if name.startswith("d_reaction_x") or name == "d_stored_energy"):
                self.assertAlmostEqual(one[name], other[name], delta=1e-7 * abs(one[name]) + 1e-9)

    def test_end_where_damage_and_equilibrium_take_turns(self):
        self.run_case(STRIP + CONTROL, "loading.table=[0, 3e-3]", "loading.steps=20", over(*MATERIAL))
        self.assertIn("warning: sensitivities end before step 10: material.youngs_modulus: other bonds", self.ended.output)
        steps = [int(row["step"]) for row in table(self.folder / "out/sensitivities.csv")]
        self.assertEqual(max(steps), 9)
        self.assertEqual(len(steps), 30)

    def test_refusals(self):
        for keys, words in (
            (["material.damage.onset_of_nothing"], "is no number of this case"),
            (["support[1].displacement[0]"], "is no number of this case"),
            (["material.damage.strength", "material.damage.strength"], "is there twice"),
            (["lattice.spacing"], "moves points or changes which of them have bonds"),
            (["lattice.angle"], "is 0 in this case"),
        ):
            with self.subTest(keys=keys):
                self.assertIn(words, self.refusal(STRIP, over(*keys)))
        self.assertIn('needs solver.mode = "newton"', self.refusal(STRIP, over(MATERIAL[0]), "solver.mode=adaptive"))
        by_stretch = ("material.model=cpd", "material.poisson_ratio=0.4", "material.damage.drive=stretch")
        strip = STRIP.replace("strength = 4e6", "")
        self.assertIn("not by stretch", self.refusal(strip, over(MATERIAL[0]), *by_stretch))
        self.assertIn("is not for contact", self.refusal(STRIP + '[[contact]]\nset = "pulled"\n', over(MATERIAL[0])))

    def test_the_table_belongs_to_the_run(self):
        few = ("loading.table=[0, 0.1]", "loading.steps=2")
        self.run_case(STRIP, *few, over(MATERIAL[0]))
        self.assertTrue((self.folder / "out/sensitivities.csv").exists())
        self.run_case(STRIP, *few)
        self.assertFalse((self.folder / "out/sensitivities.csv").exists())

    def test_resuming_is_refused(self):
        self.run_case(STRIP, "loading.steps=4", "loading.table=[0, 0.1]", over(MATERIAL[0]), words=["--stop-after", "2"],
                      code=130)  # fmt: skip
        self.assert_refused(self.resume("out", code=2), "can't be resumed")


if __name__ == "__main__":
    unittest.main()
