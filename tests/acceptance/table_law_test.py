"""The law of damage `table`: the force of a bond is a given curve."""

import re
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.strip import LATTICE
from tests.reference.torn_strip import ANGLES, TornStrip

LINEAR = 'law = "linear"\nonset = 1e-3\ncritical = 4e-3\n'
# The same curve; two of the pairs lie on its straight parts.
TABLE = 'law = "table"\nstretches = [5e-4, 1e-3, 2e-3, 4e-3]\nforces = [5e-4, 1e-3, 6.666666666666666e-4, 0]\n'
CURVE = {"law": "table", "stretches": [1e-4, 3e-4, 5e-4, 9e-4], "forces": [1e-4, 1.4e-4, 0.5e-4, 0.2e-4]}
MODELS = {"bond": "youngs_modulus = 200e9\n", "cpd": 'model = "cpd"\nyoungs_modulus = 200e9\npoisson_ratio = 0.35\n'}


def torn(damage, model="bond"):
    """A strip with a notch that is torn apart and released in between."""
    return (
        LATTICE
        + '[[crack]]\nfrom = [0.0098, -1]\nto = [0.0098, 0.004]\n[[support]]\nset = "left"\ndisplacement = [0, 0]\n'
        + '[[support]]\nset = "right"\ndisplacement = ["1e-4*load", 0]\n[loading]\ntable = [0, 0.6, 0.2, 1]\nsteps = 8\n'
        + f"[material]\n{MODELS[model]}[material.damage]\n{damage}"
    )


class TableLaw(Folder):
    threads = 2

    def same_histories(self, *changes, model="bond", delta=1e-10):
        one = self.results(torn(LINEAR, model), *changes, name="linear", code=(0, 3))
        other = self.results(torn(TABLE, model), *changes, name="table", code=(0, 3))
        rows, others = one.table("history"), other.table("history")
        self.assertEqual(len(rows), len(others))
        self.assertGreater(len(rows), 8)
        names = ("reaction_x:right", "stored_energy", "dissipated_energy", "broken_bonds")
        for name in names:
            values = numpy.array([float(row[name]) for row in rows])
            self.assertGreater(abs(values).max(), 0.0, name)
            worst = abs(values - [float(row[name]) for row in others]).max()
            self.assertLessEqual(worst, delta * abs(values).max(), name)

    def test_of_a_linear_curve_has_the_history_of_the_linear_law(self):
        self.same_histories('solver.mode="relaxation"')
        self.same_histories("solver.mode=adaptive", "relaxation.steps=8")

    def test_with_cpd_too(self):
        self.same_histories('solver.mode="relaxation"', model="cpd")

    def test_follows_the_path_by_saw_teeth(self):
        of = '[[crack]]\nfrom = [0.0098, -1]\nto = [0.0098, 0.004]\n[[support]]\nset = "left"\ndisplacement = [0, 0]\n' \
             '[[support]]\nset = "right"\ndisplacement = ["1e-4*load", 0]\n'  # fmt: skip
        peaks = []
        for law in (LINEAR, TABLE):
            text = LATTICE + of + "[material]\n" + MODELS["bond"] + "[material.damage]\n" + law
            results = self.results(text, "solver.mode=path", 'loading.table=[0, 1]', code=(0, 3))
            peaks.append(max(abs(float(row["reaction_x:right"])) for row in results.table("history")))
            self.assertGreater(float(results.table("history")[-1]["broken_bonds"]), 0)
        self.assertAlmostEqual(peaks[1] / peaks[0], 1.0, delta=1e-6)

    def test_check_and_calibrate_print_the_numbers_of_the_curve(self):
        for model in MODELS:
            for command in ("check", "calibrate"):
                with self.subTest(model=model, command=command):
                    told = [self.assert_completed(self.command(command, torn(law, model))).output for law in (LINEAR, TABLE)]
                    number = lambda text: [f"{float(n):.9g}" for n in re.findall(r"-?\d[\d.]*(?:e[-+]?\d+)?", text)]
                    fracture = [[number(line) for line in text.splitlines() if re.search("fracture|strength|onset", line)]
                                for text in told]  # fmt: skip
                    self.assertGreater(len(fracture[0]), 1 if command == "check" else 0)
                    self.assertEqual(*fracture)

    def test_a_tear_takes_what_calibrate_prints(self):
        material = {"youngs_modulus": 70e9, "damage": CURVE}
        for (angle, period), key in zip(ANGLES[::2], ("axes", "diagonals"), strict=True):
            strip = TornStrip(material, 3.015, angle, period, 2, {"volume_correction": "linear"})
            flat = TornStrip(material, 3.015, 0.0, 1.0, 2, {"volume_correction": "linear"}).tables(0.03, 0.0)
            told = self.assert_completed(self.command("calibrate", flat)).json()["damage"]["fracture_energy"]
            took = strip.energy(self.folder)
            for value in told[key]:
                self.assertAlmostEqual(value / took, 1.0, delta=1e-10)

    def test_has_an_exact_tangent(self):
        for model in MODELS:
            ended = self.assert_completed(self.command("check-tangent", torn(TABLE, model)))
            self.assertIn("tangent", ended.output)

    def test_is_the_same_in_the_resolved_text(self):
        with h5py.File(self.run_case(torn(TABLE), 'solver.mode="relaxation"') / "results.h5") as file:
            resolved = file["case/as_resolved"][()].decode()
        self.assertIn("stretches = [5e-04, 0.001, 0.002, 0.004]", resolved)
        one = self.results(torn(TABLE), 'solver.mode="relaxation"', name="typed").table("history")
        self.assertEqual(str(one), str(self.results(resolved, name="resolved").table("history")))

    def test_is_refused_where_it_is_no_law(self):
        for damage, fragments in (
            (TABLE.replace("6.666666666666666e-4", "2.1e-3"), ("forces[2]", "may be at most 0.002")),
            (TABLE.replace("forces", "force"), ("force", "forces")),
            ('law = "table"\n', ("stretches",)),
            (TABLE + "fracture_energy = 10\n", ("fracture_energy", "follows from stretches and forces")),
            (TABLE.replace("[5e-4, 1e-3, 2e-3, 4e-3]", "[5e-4, 1e-3, 4e-3, 2e-3]"), ("stretches[3]", "larger")),
            (TABLE.replace("1e-3, 6.6", "1.1e-3, 6.6"), ("forces[1]",)),
        ):
            with self.subTest(damage):
                self.assert_refused(self.command("check", torn(damage)), *fragments)
        solid = LATTICE + '[material]\nmodel = "lps"\nyoungs_modulus = 1e9\npoisson_ratio = 0.2\n[material.damage]\n' + TABLE
        self.assert_refused(self.command("check", solid), "material.damage.law")


if __name__ == "__main__":
    unittest.main()
