"""The cohesive crack that the size effect of the suite is compared with: its method beside closed forms."""

import math
import sys
import unittest
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "cases/runner/trust"), str(ROOT / "cases/runner/sweep"), str(ROOT)]

import lefm  # noqa: E402
import size_effect  # noqa: E402
from tests.reference import cohesive_beam  # noqa: E402


class CohesiveBeam(unittest.TestCase):
    def test_a_stress_free_notch_opens_as_in_handbooks(self):
        """E B V / P of ASTM E399 for a notch of 0.3 D without forces on its faces. Four-node elements smear the singularity
        over one of them."""
        rows = 60
        c, b = cohesive_beam.compliance(rows)
        tip = round(cohesive_beam.NOTCH * rows)
        forces = numpy.linalg.solve(c[tip:, tip:], b[tip:])
        opened = 2 * (b[0] - c[0, tip:] @ forces)
        self.assertAlmostEqual(cohesive_beam.E * opened / lefm.bend_opening(cohesive_beam.NOTCH), 1, delta=0.02)

    def test_a_small_beam_bears_the_strength_on_its_whole_ligament(self):
        """P S / 4 = f_t b^2 / 2 with S = 4 D: the force across is a spike at the top. The two topmost nodes stay
        closed, so that the height of two elements may be missing."""
        rows, ligament = 60, 1 - cohesive_beam.NOTCH
        bound = lambda height: 0.5 * cohesive_beam.TENSILE * height**2
        found = cohesive_beam.peak(1e-4, rows)
        self.assertLess(found, bound(ligament))
        self.assertGreater(found, bound(ligament - 2 / rows))

    def test_a_large_beam_bears_the_load_of_fracture_mechanics(self):
        """The zone of a beam of 3 m has a few elements; its peak lies between the asymptote, which lengthens the notch by
        0.44 E G / f_t^2, and the sharp notch."""
        depth = 3.0
        sharp = lefm.bend_load(size_effect.TOUGHNESS, depth, size_effect.NOTCH * depth, 1.0) / depth
        found = cohesive_beam.peak(depth)
        self.assertLess(found, sharp)
        self.assertAlmostEqual(found / size_effect.law(depth), 1, delta=0.03)

    def test_softening_curves_have_their_area(self):
        x = numpy.linspace(0, 1, 100001)
        for curve, due in ((cohesive_beam.linear, 0.5), (cohesive_beam.bilinear, 5 / 18), (cohesive_beam.cornelissen, 0.1947)):
            value, slope = curve(x)
            self.assertAlmostEqual(value[0], 1, delta=1e-12)
            self.assertAlmostEqual(float(numpy.mean(0.5 * (value[1:] + value[:-1]))), due, delta=5e-5)
            inner = numpy.array([0.05, 0.15, 0.4, 0.8])
            differences = (curve(inner + 1e-6)[0] - curve(inner - 1e-6)[0]) / 2e-6
            numpy.testing.assert_allclose(curve(inner)[1], differences, atol=1e-7)

    def test_the_entry_has_the_strengths_of_the_cohesive_crack(self):
        """By a third of the rows, which changes the deep beams by up to a per cent."""
        constants = (size_effect.MODULUS, size_effect.FRACTURE_ENERGY, size_effect.TENSILE, size_effect.DEPTHS, size_effect.NOTCH)
        self.assertEqual(constants, (cohesive_beam.E, cohesive_beam.FRACTURE_ENERGY, cohesive_beam.TENSILE, cohesive_beam.DEPTHS, cohesive_beam.NOTCH))
        for name, strengths in size_effect.COHESIVE.items():
            for depth, strength in zip(size_effect.DEPTHS, strengths):
                found = cohesive_beam.peak(depth, 20, getattr(cohesive_beam, name))
                self.assertAlmostEqual(1e-6 * found / strength, 1, delta=0.02, msg=f"{name} {depth}")


if __name__ == "__main__":
    unittest.main()
