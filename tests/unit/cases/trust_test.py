"""Pieces of the suite of known answers: closed forms beside numbers of handbooks, peaks, verdicts."""

import math
import sys
import unittest
from pathlib import Path

RUNNER = Path(__file__).resolve().parents[3] / "cases" / "runner"
sys.path[:0] = [str(RUNNER / "trust"), str(RUNNER / "sweep")]

import lefm  # noqa: E402
from specimen import Lattice, Specimen, lattices, peak  # noqa: E402
from verdict import Verdict, extension_of, row  # noqa: E402


def bar(factor=1.0) -> Specimen:
    """Its load falls with the crack as 1 / (1 + 10 by)."""
    return Specimen("bar", "Bar", "theory", "load", 1.0, lambda lattice, h: "", lambda folder: factor,
                    of_longer_crack=lambda by: 1 / (1 + 10 * by))  # fmt: skip


class ClosedForms(unittest.TestCase):
    def test_factors_of_the_standard(self):
        """ASTM E399 tabulates f(a/W): 2.66 for beams and 9.66 for compact tension at 0.5."""
        self.assertAlmostEqual(lefm.bend_factor(0.5), 2.66, delta=0.005)
        self.assertAlmostEqual(lefm.bend_factor(0.45), 2.29, delta=0.005)
        self.assertAlmostEqual(lefm.tension_factor(0.5), 9.66, delta=0.005)
        self.assertAlmostEqual(lefm.tension_factor(0.45), 8.34, delta=0.005)

    def test_williams_opening_is_that_of_irwin(self):
        """Behind the tip the faces are 8 K / E sqrt(r / 2 pi) apart, and on its line ahead nothing opens."""
        names = {name: getattr(math, name) for name in ("sqrt", "atan2", "cos", "sin")}
        at = lambda x, y: [eval(text.replace("^", "**"), names | {"x": x, "y": y})
                           for text in lefm.williams_opening(2.0, 70e9, 1 / 3, "x", "y")]  # fmt: skip
        gap = at(-0.01, 1e-15)[1] - at(-0.01, -1e-15)[1]
        self.assertAlmostEqual(gap / (8 * 2.0 / 70e9 * math.sqrt(0.01 / (2 * math.pi))), 1, delta=1e-9)
        self.assertEqual(at(0.01, 0.0)[1], 0)

    def test_a_cantilever_opens_until_its_energy_is_that_of_the_crack(self):
        """G = (P a')^2 12 / (E B^2 h^3) with a' = a + 0.64 h."""
        modulus, energy, arm, thickness, opening = 70e9, 10.0, 0.01, 0.001, 1e-4
        crack = lefm.cantilever_crack(modulus, energy, arm, opening)
        load = lefm.cantilever_load(modulus, arm, thickness, crack, opening)
        self.assertAlmostEqual((load * (crack + 0.64 * arm)) ** 2 * 12 / (modulus * thickness**2 * arm**3), energy, delta=1e-9)


class Verdicts(unittest.TestCase):
    def test_a_peak_between_rows(self):
        self.assertAlmostEqual(peak([5 - (x - 2.3) ** 2 for x in range(5)]), 5, delta=1e-12)
        self.assertEqual(peak([1.0, 2.0, 3.0]), 3)

    def test_every_entry_has_three_spacings_two_horizons_and_four_angles(self):
        found = lattices(quick=False)
        self.assertEqual(len({lattice.refinement for lattice in found}), 3)
        self.assertEqual(len({lattice.ratio for lattice in found}), 2)
        self.assertEqual(len({lattice.angle for lattice in found}), 4)
        self.assertEqual(len(lattices(quick=True)), 1)

    def test_a_finite_horizon_is_taken_off(self):
        kappa, resistance = 0.4, 0.99
        value = resistance / (1 + 10 * kappa * 0.25 * 3.015)
        lattice = Lattice(0.25)
        self.assertAlmostEqual(extension_of(bar(), value, lattice, resistance), kappa, delta=1e-12)
        verdict = Verdict(bar(), {Lattice(): 0.5, lattice: value}, {}, 0.0, kappa)
        self.assertAlmostEqual(verdict.corrected, resistance, delta=1e-12)
        self.assertTrue(verdict.passes)
        self.assertIn("| pass |", row(verdict))

    def test_what_is_off_is_red_and_says_by_how_much(self):
        verdict = Verdict(bar(), {Lattice(): 0.9}, {}, 0.0)
        self.assertFalse(verdict.passes)
        self.assertIn("**red**: -10.0 % where 2 % are allowed", row(verdict))
        failed = Verdict(bar(), {Lattice(): 1.0}, {Lattice(0.5): "no memory"}, 0.0)
        self.assertFalse(failed.passes)
        self.assertIn("h0.5_m3.015_0: no memory", row(failed))
