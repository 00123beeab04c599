"""Fits through the command line and in Python: values, errors, what is run again, and every refusal."""

import csv
import json
import shutil
import sys
import unittest

import matplotlib.image
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.strip import LATTICE, PULLED
from tests.reference.program import ROOT, settings

FIT = ROOT / "cases" / "runner" / "fit" / "fit.py"  # reads PERISTAT_PROGRAM, as this test does
sys.path.insert(0, str(ROOT / "python"))
import peristat as ps  # noqa: E402

STRIP = 'title = "Strip"\n' + PULLED
MODULUS, ENERGY, STRENGTH = "material.youngs_modulus", "material.damage.fracture_energy", "material.damage.strength"
BEAM = """\
title = "Beam"
dimension = 2
lattice.spacing = "6.25 mm"
lattice.thickness = "50 mm"
lattice.shape = [{ add = "box", min = ["-75 mm", "0 mm"], max = ["75 mm", "50 mm"] }]
quadrature = { volume_correction = "linear", surface_correction = "energy" }
crack = [{ from = ["0 mm", "-10 mm"], to = ["0 mm", "25 mm"] }]
material.plane = "stress"
material.youngs_modulus = "37 GPa"
material.damage = { law = "linear", fracture_energy = "100 J/m2", strength = "3 MPa", no_fail = ["ends"] }
set = [{ name = "ends", where = "(abs(x) > 50 mm && y < 12.5 mm) || (abs(x) < 12.5 mm && y > 42.5 mm)" },
       { name = "mouth_right", where = "x > 0 && x < 7 mm && y < 7 mm" },
       { name = "mouth_left", where = "x < 0 && x > -7 mm && y < 7 mm" }]
roller = [{ name = "left", at = ["-62.5 mm", "0 mm"], normal = [0, 1] },
          { name = "right", at = ["62.5 mm", "0 mm"], normal = [0, 1] },
          { name = "load", at = ["0 mm", "50 mm"], normal = [0, 1], displacement = "-load*(1 m)" },
          { name = "middle", at = ["0 mm", "50 mm"], normal = [1, 0] }]
control = [{ set = "mouth_right", weights = [1, 0] }, { set = "mouth_left", weights = [-1, 0] }]
loading = { table = [0, 1e-4], steps = 20 }
solver.mode = "newton"
"""


def read(folder, column):
    with open(folder / "load_displacement.csv", newline="") as file:
        return [float(row[column]) for row in csv.DictReader(file)]


class Fits(Folder):
    def setUp(self):
        super().setUp()
        self.write("strip.toml", STRIP)
        self.out = self.folder / "out"

    def fit(self, *words, case="strip.toml", data="data.csv", output="out"):
        given = ([case] if case else []) + (["--data", data] if case and data else [])
        return self.execute([sys.executable, "-BEs", FIT, *given, *words, "--output", output, "--threads", "1"])

    def document(self):
        return json.loads((self.out / "fit.json").read_text())

    def value(self, key):
        return next(each for each in self.document()["parameters"] if each["key"] == key)

    def summaries(self):
        return sorted((path, path.stat().st_mtime_ns) for path in self.out.rglob("summary.json"))

    def measure(self, case, x, y, *changes, name="data.csv", points=101, noise=0.0, size=(1.0, 1.0), seed=1):
        """A table of two columns of a run, with noise as a share of the largest y."""
        run = numpy.abs([read(self.run_case(case, *changes, name="truth"), column) for column in (x, y)])
        places = numpy.linspace(0.0, run[0][-1], points)
        values = numpy.interp(places, *run)
        values = values + noise * values.max() * numpy.random.default_rng(seed).normal(size=points)
        numpy.savetxt(self.folder / name, numpy.column_stack([places * size[0], values * size[1]]), delimiter=",", fmt="%.9g")

    def measure_strip(self, *changes, case="strip.toml", **options):
        self.measure(self.folder / case, "displacement_x:right", "force_x:right", *changes, **options)

    def measure_beam(self, *changes, **options):
        self.measure(self.write("beam.toml", BEAM), "control", "force_y:load", *changes, **options)

    # ---- a modulus ----

    def test_a_modulus_is_found_from_a_linear_bar(self):
        """Also in other units, and from a start three times off; the second call runs nothing."""
        self.measure_strip(size=(1e3, 1e-3), points=11)
        words = ("--over", MODULUS, "--start", f"{MODULUS}=70e9", "--units", "mm,kN")
        ended = self.fit(*words)
        self.assert_completed(ended)
        self.assertIn("compares force_x:right at the measured values of displacement_x:right", ended.output)
        self.assertAlmostEqual(self.value(MODULUS)["value"] / 200e9, 1.0, places=5)
        self.assertEqual(self.document()["specimens"][0]["coverage"], 1.0)
        self.assertEqual((self.out / "curves.csv").read_text().count("\n"), 12)
        self.assertEqual(matplotlib.image.imread(self.out / "fit.png").shape[1], 1600)
        self.assertIn("<svg", (self.out / "fit.svg").read_text())
        setting = ended.output.partition("settings: --set '")[2].partition("'")[0]
        self.assert_completed(self.command("check", self.folder / "strip.toml", setting))
        self.expect_that_finished_runs_are_used_again(words)
        self.expect_that_another_case_is_not_replaced(words)

    def expect_that_finished_runs_are_used_again(self, words):
        before, numbers = self.summaries(), self.document()
        self.assert_completed(self.fit(*words))
        self.assertEqual((self.summaries(), self.document()), (before, numbers))
        removed = before[0][0].parent
        shutil.rmtree(removed)
        self.assert_completed(self.fit(*words))
        self.assertEqual([path for path, time in self.summaries() if (path, time) not in before], [removed / "summary.json"])
        self.assertEqual(self.document(), numbers)

    def expect_that_another_case_is_not_replaced(self, words):
        self.write("other.toml", STRIP.replace("Strip", "Other"))
        before = self.summaries()
        self.assert_refused(self.fit(*words, case="other.toml"), "another case")
        self.assertEqual(self.summaries(), before)
        self.assert_completed(self.fit(*words, "--overwrite", case="other.toml"))

    def test_python_finds_what_the_command_line_finds(self):
        self.measure_strip(points=11)
        self.assert_completed(self.fit("--over", MODULUS, "--start", f"{MODULUS}=70e9"))
        case, data = ps.load_case(self.folder / "strip.toml"), self.folder / "data.csv"
        options = {"start": {MODULUS: 70e9}, "threads": 1, "quiet": True, "output": self.folder / "python"}
        found = ps.fit(case, data, [MODULUS], **options)
        self.assertEqual(found.values[MODULUS], self.value(MODULUS)["value"])
        self.assertTrue(found.is_converged)
        self.assertTrue(found.run().converged)
        self.assertEqual(len(found.plot().axes), 2)
        self.assertIn(MODULUS, repr(found))
        before = sorted((path, path.stat().st_mtime_ns) for path in (self.folder / "python").rglob("summary.json"))
        array = numpy.loadtxt(data, delimiter=",")
        again = ps.fit([(case, array), (case, array)], over=[MODULUS], jobs=2, **options)
        self.assertEqual(again.settings, found.settings)
        after = sorted((path, path.stat().st_mtime_ns) for path in (self.folder / "python/specimen_1").rglob("summary.json"))
        self.assertEqual(after, before)
        fitted = case.copy()
        fitted.set(MODULUS, found.settings[MODULUS])
        self.assertIn("youngs_modulus", fitted.resolved())
        for wrong, words in (({"over": MODULUS}, "list of different keys"), ({"over": ["material.moduls"]}, "moduls"),
                             ({"over": [MODULUS], "start": {"x": 1}}, "must be one of the fitted keys"),
                             ({"over": [MODULUS], "starts": 0}, "starts = 0")):  # fmt: skip
            with self.assertRaisesRegex(ps.InputError, words):
                ps.fit(case, data, **wrong)

    def test_specimens_share_one_value(self):
        self.measure_strip(points=11, name="short.csv")
        self.write("wide.toml", STRIP.replace("0.02, 0.01", "0.02, 0.02"))
        self.measure_strip(case="wide.toml", points=11, name="wide.csv")
        words = ("--specimen", "strip.toml=short.csv", "--specimen", "wide.toml=wide.csv")
        self.assert_completed(self.fit(*words, "--over", MODULUS, "--start", f"{MODULUS}=150e9", "--jobs", "2", case=None))
        self.assertAlmostEqual(self.value(MODULUS)["value"] / 200e9, 1.0, places=5)
        self.assertEqual(len(self.document()["specimens"]), 2)
        self.write("wide.toml", 'units = { force = "kN" }\n' + STRIP)
        self.assert_refused(self.fit(*words, "--over", MODULUS, case=None), "have different [units]")

    def test_keys_may_be_computed_from_fitted_ones(self):
        self.measure_strip("material.youngs_modulus=100e9", points=11)
        thickness = "lattice.thickness:=1e-3*material.youngs_modulus/200e9"  # the force goes with the square of the modulus
        self.assert_completed(self.fit("--over", MODULUS, "--set", thickness))
        self.assertAlmostEqual(self.value(MODULUS)["value"] / 2**0.5 / 100e9, 1.0, places=4)

    # ---- fracture ----

    def test_fracture_energy_and_strength_are_recovered_from_a_noisy_curve(self):
        """A twin experiment: 1 % noise, starts three times off, and errors of at most 0.5 %."""
        self.measure_beam(size=(1e3, 1.0), points=400, noise=0.01)
        ended = self.fit("--over", f"{ENERGY},{STRENGTH}", "--start", f"{ENERGY}=300 J/m2", "--start", f"{STRENGTH}=9 MPa",
                         "--units", "mm,N", "--x", "control", "--y", "-1*reaction_y:load", "--jobs", "2", case="beam.toml")  # fmt: skip
        self.assert_completed(ended)
        for key, truth in ((ENERGY, 100.0), (STRENGTH, 3.0)):
            found = self.value(key)
            self.assertLess(abs(found["value"] / truth - 1.0), 5e-3)
            self.assertLess(abs(found["value"] - truth), 4.0 * found["standard_deviation"])
            self.assertLess(found["standard_deviation"], 3e-3 * truth)
        self.assertAlmostEqual(self.document()["residual"], 0.01, delta=2e-3)
        self.assertEqual(self.document()["messages"], [])

    def test_elastic_data_do_not_determine_a_fracture_energy(self):
        elastic = ("loading.table=[0,4e-6]", "loading.steps=2")
        self.measure_beam(*elastic, points=30)
        ended = self.fit("--over", f"{MODULUS},{ENERGY}", *settings(*elastic), case="beam.toml")
        self.assert_code(ended, 3)
        self.assertIn(f"note: {ENERGY} is not determined: the computed curve does not depend on it", ended.output)
        self.assertIn("not determined", ended.output)
        self.assertIsNone(self.value(ENERGY)["standard_deviation"])
        self.assertIsNotNone(self.value(MODULUS)["standard_deviation"])

    def test_the_good_part_of_a_run_that_fails_counts(self):
        """Newton's method with three iterations a step ends where bonds break."""
        torn = LATTICE + """\
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 1e-3
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["4e-5*load", "free"]
[loading]
steps = 20
smallest_step = 0.02
"""
        self.write("torn.toml", torn)
        self.write("data.csv", "".join(f"{k * 1e-6},{k * 100.0}\n" for k in range(41)))
        ended = self.fit("--over", MODULUS, case="torn.toml")
        self.assert_code(ended, 3)
        self.assertIn("did not converge", ended.output)
        self.assertIn("points are not compared: they lie beyond the end of the run", ended.output)
        self.assertLess(self.document()["specimens"][0]["coverage"], 1.0)
        self.assertLess(self.document()["residual"], 1e-2)

    # ---- refusals ----

    def test_wrong_input_is_refused(self):
        self.measure_strip(points=11)
        self.write("words.csv", "x,y\n0,0\n1,one\n2,2\n")
        over = ("--over", MODULUS)
        for words, told in {
            ("--over", "material.moduls"): "no value in the case",
            (*over, "--data", "words.csv"): "words.csv:3: 'one' is not a number",
            (*over, "--units", "mm,kN"): "give the units of the data",
            (*over, "--start", "a=1"): "a is not fitted",
            (*over, "--start", f"{MODULUS}=-1e9"): "must be",
            (*over, "--bounds", f"{MODULUS}=1"): "needs the form KEY=LOW:HIGH",
            (*over, "--x", "displacement_x:rihgt"): "Did you mean 'displacement_x:right'",
            (*over, "--y", "reaction_x:left"): "write -reaction_x:left",
            (*over, "--difference", "0"): "must be from 0.0001",
            (*over, "--set", f"{MODULUS}=1e9"): "the key is fitted",
            (*over, "--set", "loading.stepps=3"): "stepps",
            (*over, "--specimen", "strip.toml"): "needs the form CASE=FILE",
        }.items():
            with self.subTest(words=words):
                self.assert_refused(self.fit(*words), told)
        self.assertFalse((self.out / "fit.json").exists())
        self.write("broken.toml", "title = \n")
        self.assert_refused(self.fit(*over, case="broken.toml"), "broken.toml")
        self.assert_refused(self.fit(*over, case="strip.toml", data=None), "belong together")

    def test_files_of_others_are_not_replaced(self):
        self.measure_strip(points=11)
        for name in ("fit.json", "curves.csv", "fit.png", "fit.svg"):
            shutil.rmtree(self.out, ignore_errors=True)
            self.out.mkdir()
            (self.out / name).write_text("mine")
            self.assert_refused(self.fit("--over", MODULUS), name)
            self.assertEqual([path.name for path in self.out.iterdir()], [name])


if __name__ == "__main__":
    unittest.main()
