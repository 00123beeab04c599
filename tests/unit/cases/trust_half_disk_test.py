"""The path of fracture mechanics in the half disk of the suite: the method beside closed forms, and the entry's path."""

import math
import sys
import unittest
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "cases/runner/trust"), str(ROOT / "cases/runner/sweep"), str(ROOT)]

import crack_path  # noqa: E402
import inclined_notch  # noqa: E402
import lefm  # noqa: E402
from tests.reference import half_disk, kinked_crack  # noqa: E402
from tests.reference.outlined_crack import Body  # noqa: E402


def strip(width, height, sides, stress, kappa=2.0):
    """A strip from x = 0 to its width under a normal stress at its ends, a function of x; the first corner is the middle
    of its left side."""
    tall = 0.5 * height
    down, across, up = (numpy.arange(round(sides * length)) / sides for length in (tall, width, height))
    corners = numpy.concatenate([-1j * down, across - 1j * tall, width + 1j * (up - tall), width - across + 1j * tall, 1j * (tall - down)])
    middles = 0.5 * (corners + numpy.roll(corners, -1))
    return Body(corners, numpy.where(abs(abs(middles.imag) - tall) < 1e-9, stress(middles.real), 0.0), kappa)


class OutlinedCrack(unittest.TestCase):
    def test_an_edge_crack_under_tension_has_its_factors(self):
        """1.1215 for a short crack; 1.660 at a third of the width [Tada, Paris and Irwin 2000]."""
        for share, sides, due in ((0.05, 80, 1.136), (0.3, 80, 1.660)):
            opening, sliding = strip(1.0, 3.0, sides, numpy.ones_like).intensities(numpy.linspace(0, share, 41) + 0j)
            self.assertAlmostEqual(opening / math.sqrt(math.pi * share) / due, 1, delta=0.025)
            self.assertAlmostEqual(sliding, 0, delta=1e-9)

    def test_an_edge_crack_under_bending_has_its_factors(self):
        """F = 1.122 - 1.40 a + 7.33 a^2 - 13.08 a^3 + 14.0 a^4 of a strip in pure bending [Tada, Paris and Irwin 2000]."""
        share = 0.4
        due = 1.122 - 1.4 * share + 7.33 * share**2 - 13.08 * share**3 + 14.0 * share**4
        opening, _ = strip(1.0, 3.0, 60, lambda x: 1 - 2 * x).intensities(numpy.linspace(0, share, 41) + 0j)
        self.assertAlmostEqual(opening / math.sqrt(math.pi * share) / due, 1, delta=0.025)

    def test_an_inclined_edge_crack_has_both_factors(self):
        """0.705 and 0.364 of sigma sqrt(pi a) for an edge crack at 45 degrees in a half-plane [Murakami 1987]."""
        crack = 0.05
        ends = kinked_crack.straight(math.pi / 4, crack, 40)
        opening, sliding = strip(1.0, 2.0, 120, numpy.ones_like).intensities(ends)
        for factor, due in ((opening, 0.705), (abs(sliding), 0.364)):
            self.assertAlmostEqual(factor / math.sqrt(math.pi * crack) / due, 1, delta=0.03)

    def test_factors_do_not_depend_on_elastic_constants(self):
        ends = kinked_crack.straight(math.pi / 6, 0.3, 20)
        one, other = (strip(1.0, 2.0, 40, numpy.ones_like, kappa).intensities(ends) for kappa in (1.2, 2.8))
        for factor, again in zip(one, other):
            self.assertAlmostEqual(factor / again, 1, delta=0.01)


class HalfDisk(unittest.TestCase):
    def test_an_upright_notch_has_the_factor_of_the_standard(self):
        """K = Y P sqrt(pi a) / (2 R B), Y = -1.297 + 9.516 s - (0.47 + 16.457 s) b + (1.071 + 34.401 s) b^2 with half the span
        and the crack over R [Kuruppu et al. 2014]."""
        for span, crack in ((0.5, 0.4), (0.6, 0.5)):
            due = -1.297 + 9.516 * span - (0.47 + 16.457 * span) * crack + (1.071 + 34.401 * span) * crack**2
            opening, sliding = half_disk.half_disk(span).intensities(half_disk.notch(0.0, crack))
            self.assertAlmostEqual(2 * opening / math.sqrt(math.pi * crack) / due, 1, delta=0.03)
            self.assertAlmostEqual(sliding / opening, 0, delta=1e-3)

    def test_the_geometry_is_that_of_the_entry(self):
        self.assertEqual(half_disk.RADIUS * 1e-3, inclined_notch.RADIUS)
        self.assertAlmostEqual(half_disk.SUPPORT * inclined_notch.RADIUS, inclined_notch.SUPPORT, delta=1e-12)
        self.assertAlmostEqual(half_disk.NOTCH * inclined_notch.RADIUS, inclined_notch.NOTCH, delta=1e-12)
        tip = half_disk.notch()[-1] * inclined_notch.RADIUS
        self.assertAlmostEqual(abs(tip - complex(*inclined_notch.TIP)), 0, delta=1e-12)

    def test_the_entry_has_the_path_and_coarser_increments_agree(self):
        """Twice as long ones, of 2 mm, keep the kink's first direction longer, which moves the path by up to 0.25 mm."""
        found = half_disk.RADIUS * half_disk.path(2 * half_disk.INCREMENT, 2 * half_disk.SIDE)
        for place in found[found.imag < 35]:
            away = crack_path.distance((place.real * 1e-3, place.imag * 1e-3), inclined_notch.PATH)
            self.assertLess(away, 0.25e-3)
        fine = half_disk.RADIUS * half_disk.path()
        self.assertEqual([(f"{x:.2f}", f"{y:.2f}") for x, y in zip(fine.real, fine.imag)],
                         [(f"{1e3 * x:.2f}", f"{1e3 * y:.2f}") for x, y in inclined_notch.PATH])  # fmt: skip

    def test_the_crack_of_pmma_turned_farther(self):
        """By half a horizon of the finest lattice, which is 2.4 mm."""
        away = [crack_path.distance(place, inclined_notch.PATH) for place in inclined_notch.MEASURED if place[1] < inclined_notch.FOLLOWED]
        self.assertAlmostEqual(max(away), 2.0e-3, delta=0.3e-3)

    def test_the_first_kink_is_that_of_the_largest_hoop_stress(self):
        opening, sliding = half_disk.half_disk().intensities(half_disk.notch())
        self.assertAlmostEqual(sliding / opening, -0.845, delta=0.005)
        self.assertAlmostEqual(kinked_crack.hoop(opening, sliding), lefm.hoop_direction(opening, sliding), delta=1e-3)


if __name__ == "__main__":
    unittest.main()
