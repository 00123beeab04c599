"""Ensembles of random fields through the command line: the chain of docs/sweep.md against its exact distribution."""

import csv
import math
import re
import shutil
import sys
import unittest

import matplotlib.image
import numpy

from tests.acceptance.folder import Folder
from tests.printed.fences import cases, lines
from tests.printed.page import numbers
from tests.reference.program import ROOT

SWEEP = ROOT / "cases" / "runner" / "sweep" / "sweep.py"  # reads PERISTAT_PROGRAM, as this test does
PAGE = ROOT / "docs" / "sweep.md"


def exact_mean(points, modulus):
    """Mean peak of the chain [N]: the integral of the probability that all bonds bear a load. A bond has the mean of its points'
    factors, and the next point depends on the one before alone; sums over equally probable factors."""
    probable = (-numpy.log1p(-(numpy.arange(1000) + 0.5) / 1000)) ** (1 / modulus) / math.gamma(1 + 1 / modulus)
    loads, chances = numpy.linspace(0.0, 100.0, 401), []
    for load in loads:
        first = numpy.searchsorted(probable, 2.0 * load / 70.0 - probable)  # the least factor that the next point needs
        alive = numpy.ones(len(probable))
        for _ in range(points + 1):  # with the two points of the layers
            alive = numpy.append(numpy.cumsum(alive[::-1])[::-1], 0.0)[first] / len(probable)
        chances.append(alive.mean())
    return numpy.trapz(chances, loads)


class Ensembles(Folder):
    def setUp(self):
        super().setUp()
        self.chain = cases(PAGE)["chain.toml"]
        self.write("chain.toml", self.chain)

    def sweep(self, *words, case="chain.toml"):
        return self.execute([sys.executable, "-BEs", SWEEP, case, *words, "--output", "out", "--threads", "1"])

    def rows(self):
        with open(self.folder / "out/ensemble.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_the_chain_of_the_page_has_its_exact_mean(self):
        words = next(words for words in lines(PAGE) if "chain.toml" in words)
        ended = self.sweep(*words[words.index("chain.toml") + 1 :])
        self.assert_completed(ended)
        rows = self.rows()
        for row, points in zip(rows, (10, 100), strict=True):
            self.assertEqual((row["runs"], row["failed"], row["quantity"]), ("30", "30", "peak_reaction:left [N]"))
            self.assertAlmostEqual(float(row["volume"]), points * 1e-9, delta=1e-15)
            mean, error = float(row["mean"]), float(row["standard_deviation"]) / 30**0.5
            self.assertLess(abs(mean - exact_mean(points, 8.0)), 3.5 * error)
            self.assertTrue(float(row["modulus_low"]) < float(row["weibull_modulus"]) < float(row["modulus_high"]))
        self.assertEqual(matplotlib.image.imread(self.folder / "out/ensemble.png").shape[1], 1600)
        exponent, error = map(float, re.search(r"to the power of (\S+) ± (\S+),", ended.output).groups())
        expected = math.log(float(rows[1]["mean"]) / float(rows[0]["mean"])) / math.log(10.0)
        self.assertAlmostEqual(exponent, expected, places=4)
        self.expect_the_printed_numbers(rows, exponent, error)

    def expect_the_printed_numbers(self, rows, exponent, error):
        phrase = ("The chains above have mean peaks of {} and {} N and moduli of {} and {}, and the mean goes with the volume to the "
                  "power of {} ± {}.")  # fmt: skip
        printed = numbers("docs/sweep.md", phrase)
        found = [*(float(row["mean"]) for row in rows), *(float(row["weibull_modulus"]) for row in rows), exponent, error]
        for number, value in zip(printed, found, strict=True):
            self.assertLessEqual(abs(number.value - value), 1.01 * number.rounding, number.text)

    def test_what_has_not_failed_has_no_modulus(self):
        ended = self.sweep("--seeds", "5", "--per", "2*lattice.area", "--set", 'support[1].displacement=["1e-6*load"]')
        self.assert_completed(ended)
        self.assertIn("5 runs end before the reaction has fallen: no Weibull modulus", ended.output)
        row = self.rows()[0]
        self.assertEqual((row["failed"], row["weibull_modulus"]), ("0", ""))
        self.assertAlmostEqual(float(row["mean"]) / (70e9 * 1e-6 / 11e-3 / 2.0), 1.0, places=2)

    def test_fields_go_on_sharing_their_seeds(self):
        """Two fields of one seed and one of another; without failing, the runs are short."""
        fields = '[{ of = "strength", weibull_modulus = 8, seed = 3 }, { of = "stiffness", weibull_modulus = 8, seed = 5 }]'
        text = self.chain.replace('[{ of = "strength", weibull_modulus = 8 }]', fields)
        self.write("two.toml", text)
        self.assert_completed(self.sweep("--seeds", "5", "--set", 'support[1].displacement=["1e-6*load"]', case="two.toml"))
        with open(self.folder / "out/sweep.csv", newline="") as file:
            seeds = [[row[f"material.scatter[{k}].seed"] for k in (0, 1)] for row in csv.DictReader(file)]
        self.assertEqual(seeds, [["3", "5"], ["6", "8"], ["9", "11"], ["12", "14"], ["15", "17"]])

    def test_wrong_input_is_refused(self):
        self.write("plain.toml", self.chain.replace("material.scatter", "#"))
        self.assert_refused(self.sweep("--seeds", "10", case="plain.toml"), "has no random field")
        for words, told in {
            ("--seeds", "3"): "must be a number of seeds from 5",
            ("--seeds", "5", "--vary", "material.scatter[0].seed=1,2"): "is varied twice",
            ("--seeds", "5", "--refine", "3"): "can't be given together",
            ("--seeds", "5", "--per", "lattice.areaa"): "--per lattice.areaa: lattice.areaa is neither",
            ("--seeds", "5", "--per", "-1"): "must be positive",
            ("--vary", "loading.steps=1", "--per", "2"): "give --seeds, too",
        }.items():
            with self.subTest(words):
                self.assert_refused(self.sweep(*words), told)
        self.assertFalse((self.folder / "out").exists())
        for name in ("ensemble.csv", "ensemble.png"):
            self.write(f"out/{name}", "mine")
            self.assert_refused(self.sweep("--seeds", "5"), name)
            shutil.rmtree(self.folder / "out")


if __name__ == "__main__":
    unittest.main()
