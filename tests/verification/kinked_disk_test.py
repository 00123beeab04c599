"""The disk of `trust kink` with a kink cut into it: the program's stress intensity factors beside those of
tests/reference/kinked_crack.py, in which the rim holds the crack."""

import csv
import math
import sys
import unittest

from tests.acceptance.folder import Folder
from tests.reference import kinked_crack
from tests.reference.program import ROOT

sys.path[:0] = [str(ROOT / "cases/runner/trust"), str(ROOT / "cases/runner/sweep")]

import kinked_disk  # noqa: E402

LENGTH, ANGLE = 4.0, -30.0  # of the kink, in horizons of the benchmark and degrees
LOADING, POINTS = kinked_disk.Loading(0.364, -0.2), kinked_disk.Points(45.0)


class KinkedDisk(Folder):
    def test_a_kink_has_the_factors_of_the_reference(self):
        """At half the horizon; the rest is its size beside the kink and the ring. In an infinite plate K_I is 1.00."""
        turn, y, h = math.radians(ANGLE), kinked_disk.tip_height(POINTS), kinked_disk.HORIZON
        end = f"[{LENGTH * h * math.cos(turn)!r}, {y + LENGTH * h * math.sin(turn)!r}]"
        ring = f"direction = [{math.cos(turn)!r}, {math.sin(turn)!r}]\ninner = {2.2 * h!r}\nouter = {3.8 * h!r}"
        text = kinked_disk.text(LOADING, POINTS)
        text = text[: text.index("[loading]")] + f"[[crack]]\nfrom = [0.0, {y!r}]\nto = {end}\n\n[loading]\ntable = [0, 0.05]\n"
        for old, new in ((f"spacing = {kinked_disk.SPACING:.17g}\n", f"spacing = {0.5 * kinked_disk.SPACING!r}\n"),
                         (f"at = [0.0, {y:.17g}]\ndirection = [1, 0]", f"at = {end}\n{ring}")):  # fmt: skip
            self.assertEqual(text.count(old), 1)
            text = text.replace(old, new)
        with open(self.run_case(text) / "history.csv", newline="") as table:
            row = list(csv.DictReader(table))[-1]
        opening = 1 / math.hypot(1, LOADING.sliding)
        factors = opening, LOADING.sliding * opening, LOADING.stress / math.sqrt(math.pi)
        ends = kinked_crack.straight(turn, LENGTH, 80)
        due = kinked_crack.Plate(*factors, kinked_disk.RADIUS - kinked_disk.RING).intensities(ends)
        for name, value in zip(("tip_K1", "tip_K2"), due):
            self.assertAlmostEqual(float(row[name]) / (0.05 * kinked_disk.TOUGHNESS), value, delta=0.015)


if __name__ == "__main__":
    unittest.main()
