"""Parts of the benchmark of kinked cracks: fields, directions, tables, and the paths of fracture mechanics beside closed
forms."""

import csv
import io
import math
import sys
import tomllib
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
sys.path[:0] = [str(ROOT / "cases/runner/trust"), str(ROOT / "cases/runner/sweep"), str(ROOT)]

import kink  # noqa: E402
import kink_table  # noqa: E402
import kinked_disk  # noqa: E402
import lefm  # noqa: E402
from kinked_disk import Found, Loading, Points  # noqa: E402
from tests.reference import kinked_crack  # noqa: E402

MODULUS, RATIO = 70e9, 1 / 3


class Fields(unittest.TestCase):
    """Displacements as texts, their stresses by finite differences."""

    def displacement(self, texts, x, y):
        names = {name: getattr(math, name) for name in ("sqrt", "atan2", "cos", "sin")} | {"x": x, "y": y, "load": 1.0}
        return [eval(text.replace("^", "**"), names) for text in texts]

    def stress(self, texts, x, y, step=1e-6):
        """s_xx, s_yy, s_xy in plane stress."""
        right, left = self.displacement(texts, x + step, y), self.displacement(texts, x - step, y)
        above, below = self.displacement(texts, x, y + step), self.displacement(texts, x, y - step)
        xx, yx = ((p - q) / (2 * step) for p, q in zip(right, left))
        xy, yy = ((p - q) / (2 * step) for p, q in zip(above, below))
        stiffness = MODULUS / (1 - RATIO**2)
        return stiffness * (xx + RATIO * yy), stiffness * (yy + RATIO * xx), MODULUS / (2 * (1 + RATIO)) * (xy + yx)

    def all_fields(self):
        along = lambda of: of(2e6, MODULUS, RATIO, "x", "y")
        mixed = kinked_disk.displacement(Loading(0.577, -0.2), "y")
        return along(lefm.williams_opening), along(lefm.williams_sliding), mixed

    def test_fields_are_in_equilibrium(self):
        step = 1e-4
        for texts in self.all_fields():
            for angle in (-2.9, -1.0, 0.3, 2.0):
                x, y = 0.02 * math.cos(angle), 0.02 * math.sin(angle)
                right, left = self.stress(texts, x + step, y), self.stress(texts, x - step, y)
                above, below = self.stress(texts, x, y + step), self.stress(texts, x, y - step)
                size = max(map(abs, right)) / 0.02  # of one derivative
                self.assertLess(abs(right[0] - left[0] + above[2] - below[2]) / (2 * step) / size, 1e-3)
                self.assertLess(abs(right[2] - left[2] + above[1] - below[1]) / (2 * step) / size, 1e-3)

    def test_faces_are_free_of_tractions(self):
        for texts in self.all_fields():
            ahead = max(map(abs, self.stress(texts, 0.02, 0.0)))
            for y in (2e-6, -2e-6):
                _, across, shear = self.stress(texts, -0.02, y)
                self.assertLess(max(abs(across), abs(shear)) / ahead, 1e-3)

    def test_stresses_ahead_are_those_of_the_factors(self):
        """K / sqrt(2 pi r) ahead of the tip, and T on the faces: the mean of both, as the term of K_II has opposite signs
        there."""
        loading = Loading(0.577, -0.2)
        opening, sliding, stress = loading.factors
        self.assertAlmostEqual(math.hypot(opening, sliding) / lefm.toughness(MODULUS, 10.0), 1, delta=1e-12)
        self.assertAlmostEqual(stress * math.sqrt(math.pi * kinked_disk.HORIZON) / math.hypot(opening, sliding), -0.2, delta=1e-12)
        texts = kinked_disk.displacement(loading, "y")
        root = math.sqrt(2 * math.pi * 0.02)
        _, across, shear = self.stress(texts, 0.02, 0.0)
        self.assertAlmostEqual(across * root / opening, 1, delta=1e-5)
        self.assertAlmostEqual(shear * root / sliding, 1, delta=1e-5)
        faces = [self.stress(texts, -0.02, y)[0] for y in (2e-6, -2e-6)]
        self.assertAlmostEqual(sum(faces) / 2 / stress, 1, delta=2e-3)
        self.assertAlmostEqual((faces[1] - faces[0]) / 2 * root / (2 * sliding), 1, delta=1e-3)

    def test_the_hoop_stress_is_largest_in_its_direction(self):
        """-70.5 degrees in pure sliding, and the maximum of K_I cos^3 t/2 - 3 K_II sin t/2 cos^2 t/2."""
        self.assertAlmostEqual(math.degrees(lefm.hoop_direction(0.0, 1.0)), -70.5288, delta=1e-4)
        self.assertEqual(lefm.hoop_direction(1.0, 0.0), 0.0)
        for sliding in (0.176, 0.577, 3.0, -0.364):
            hoop = lambda t: math.cos(t / 2) ** 2 * (math.cos(t / 2) - 3 * sliding * math.sin(t / 2))
            found = lefm.hoop_direction(1.0, sliding)
            self.assertLess(max(hoop(found - 0.01), hoop(found + 0.01)), hoop(found))
            self.assertAlmostEqual(found, -lefm.hoop_direction(1.0, -sliding), delta=1e-12)


class Cases(unittest.TestCase):
    def test_every_setting_has_a_case_of_its_own(self):
        settings = kink.settings(quick=False)
        texts = {kinked_disk.text(*setting) for setting in settings}
        self.assertEqual(len(texts), len(settings))
        self.assertLess(len(kink.settings(quick=True)), 5)
        self.assertLessEqual(set(kink.settings(quick=True)), set(settings))
        for text in texts:
            lattice = tomllib.loads(text)["lattice"]
            self.assertNotEqual("seed" in lattice, "angle" in lattice)
            self.assertLessEqual("refine" in lattice, "seed" in lattice)

    def test_the_rim_moves_as_the_field_of_a_tip_off_the_axis(self):
        points = Points(45.0)
        case = tomllib.loads(kinked_disk.text(Loading(0.577, 0.2), points))
        y = kinked_disk.tip_height(points)
        self.assertGreater(y, 0)
        self.assertEqual(case["crack"][0]["to"], [0.0, y])
        texts, plain = case["support"][0]["displacement"], kinked_disk.displacement(Loading(0.577, 0.2), "y")
        at = Fields().displacement
        for found, asked in zip(at(texts, 0.03, 0.01 + y), at(plain, 0.03, 0.01)):
            self.assertAlmostEqual(found / asked, 1, delta=1e-12)


class Directions(unittest.TestCase):
    def test_only_bonds_of_the_chord_count(self):
        on = lambda r, angle: (r * math.cos(math.radians(angle)), r * math.sin(math.radians(angle)))
        middles = [on(0.5, 80), on(2.0, -30), on(4.0, -30), on(5.0, -30), on(5.1, 10)]
        self.assertAlmostEqual(kinked_disk.direction(middles, 1.0), -30, delta=1e-12)

    def test_short_cracks_have_none(self):
        for middles in ([], [(4.9, 0.0)]):
            with self.assertRaisesRegex(ValueError, "has grown"):
                kinked_disk.direction(middles, 1.0)


class Tables(unittest.TestCase):
    loading = Loading(0.577, 0.0)

    def found(self, *offs, note=""):
        due = kink_table.REFERENCE[self.loading]
        points = [Points(0.0), Points(seed=1), Points(seed=2)]
        return {(self.loading, at): Found(due + off, 1.0, 1.0, 0.0, note) for at, off in zip(points, offs)}

    def test_a_row_passes_if_lattices_and_the_mean_of_blue_noise_do(self):
        found = self.found(3.0, -8.0, 8.0)
        self.assertEqual(kink_table.faults(found, self.loading), [])
        self.assertIn("| pass |", kink_table.table(found))
        self.assertIn("± 11.3 |", kink_table.table(found))

    def test_finer_points_have_a_column_of_their_own_and_a_t_stress_a_wider_range(self):
        self.loading = Loading(0.577, -0.2)
        due = kink_table.REFERENCE[self.loading]
        points = (Points(seed=1), Points(seed=1, finer=2))
        found = {(self.loading, at): Found(due + off, 1.0, 1.0, 0.0) for at, off in zip(points, (9.0, 7.0))}
        self.assertEqual(kink_table.faults(found, self.loading), ["blue noise by +9.0°"])
        self.assertIn(f"| {due + 7:.1f} | **red**", kink_table.table(found))

    def test_what_is_off_is_red_and_says_by_how_much(self):
        self.assertIn("| **red**: 0° by +23.0° |", kink_table.table(self.found(23.0, 0.0, 0.0)))
        self.assertIn("| **red**: blue noise by -8.0° |", kink_table.table(self.found(0.0, -8.0, -8.0)))
        self.assertIn("**red**: 0°: no memory", kink_table.table(self.found(math.nan, note="no memory")))

    def test_values_name_every_run(self):
        found = list(csv.DictReader(io.StringIO(kink_table.values(self.found(1.0, 2.0, 3.0)))))
        self.assertEqual([row["points"] for row in found], ["0", "noise1", "noise2"])
        self.assertAlmostEqual(float(found[0]["direction"]) - float(found[0]["reference"]), 1, delta=1e-9)


class Reference(unittest.TestCase):
    """Cracks of fracture mechanics, which the benchmark is compared with."""

    def test_a_straight_crack_keeps_its_factors(self):
        """Also in a disk, for a crack that is short beside it."""
        ends = kinked_crack.straight(0.0, 1.0, 80)
        for radius in (math.inf, 300.0):
            plate = kinked_crack.Plate(1.0, 0.5, 0.3, radius)
            for value, due in zip(plate.intensities(ends), (1.0, 0.5)):
                self.assertAlmostEqual(value / due, 1, delta=0.01)

    def test_a_kink_has_the_factors_of_its_angle(self):
        """Series in m = angle / pi [Amestoy and Leblond 1992]; 80 elements, and terms from m^5 on, make 0.5 %."""
        pi = math.pi
        for degrees in (15, 30, 45):
            m = degrees / 180
            first = (1 - 3 * pi**2 / 8 * m**2 + (pi**2 - 5 * pi**4 / 128) * m**4, pi / 2 * m - (4 * pi / 3 + pi**3 / 48) * m**3)
            second = (-3 * pi / 2 * m + (10 * pi / 3 + pi**3 / 16) * m**3,
                      1 - (4 + 3 * pi**2 / 8) * m**2 + (8 / 3 + 29 * pi**2 / 18 - 5 * pi**4 / 128) * m**4)  # fmt: skip
            ends = kinked_crack.straight(math.radians(degrees), 1.0, 80)
            for factors, series in (((1, 0), first), ((0, 1), second)):
                for value, due in zip(kinked_crack.Plate(*factors, 0.0).intensities(ends), series):
                    self.assertAlmostEqual(value, due, delta=0.012)

    def test_a_slightly_turned_crack_bends_with_the_t_stress(self):
        """Slope -2 K_II / K_I exp(b^2 x) erfc(-b sqrt(x)), b = 2 sqrt(2) T / K_I [Cotterell and Rice 1980]. An increment has
        the slope of its beginning, so that a path of increments lags by 1 or 2 %."""
        for stress in (-0.1, 0.0, 0.1):
            b, x = 2 * math.sqrt(2) * stress, 1.0  # where the last increment begins
            ends = kinked_crack.path(kinked_crack.Plate(1.0, 0.02, stress), 1.1)
            self.assertAlmostEqual(abs(ends[-1 - kinked_crack.ELEMENTS]), x, delta=0.01)
            last = ends[-1] - ends[-2]
            self.assertAlmostEqual(last.imag / last.real / (-0.04 * math.exp(b * b * x) * math.erfc(-b * math.sqrt(x))), 1, delta=0.03)

    def test_the_table_is_that_of_the_paths(self):
        """One loading with T-stress, by coarser increments; the others are printed by the same command."""
        self.assertEqual([(of.sliding, of.stress) for of in kink_table.REFERENCE], kinked_crack.LOADINGS)
        self.assertEqual(kinked_crack.RADIUS, kinked_disk.RADIUS - kinked_disk.RING)
        self.assertEqual((kinked_crack.NEAR, kinked_crack.FAR), (kinked_disk.NEAR, kinked_disk.FAR))
        found = kinked_crack.reference(0.364, -0.2, increment=0.5)
        self.assertAlmostEqual(found, kink_table.REFERENCE[Loading(0.364, -0.2)], delta=0.5)


if __name__ == "__main__":
    unittest.main()
