"""The comparison of measured passes with stored ones: benchmarks/roofline.py."""

import sys
import tempfile
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "benchmarks"))
import roofline

RATES = {"dgemm": 50e9, "stream_triad": 30e9} | {f"{name}/{d}": 100e6 for name in roofline.PASSES for d in (2, 3)}


def lost(rates, before):
    points = list(roofline.points_of(rates))
    return [name for name, _ in roofline.losses(roofline.ratios(rates, points), before)]


class Roofline(unittest.TestCase):
    def setUp(self):
        self.before = roofline.ratios(RATES, list(roofline.points_of(RATES)))

    def test_a_pass_that_has_become_slower_is_told(self):
        self.assertEqual(lost(RATES | {"gradient/3": 88e6}, self.before), ["gradient, 3D"])
        self.assertEqual(lost(RATES | {"gradient/3": 92e6}, self.before), [])

    def test_a_slower_machine_is_no_loss(self):
        self.assertEqual(lost({name: rate / 2 for name, rate in RATES.items()}, self.before), [])
        # Passes follow either what computes or what moves.
        self.assertEqual(lost(RATES | {"dgemm": 100e9}, self.before), [])

    def test_a_pass_that_is_no_more_measured_is_told(self):
        self.assertEqual(lost(RATES, self.before | {"old, 2D": [1.0, 1.0]}), ["old, 2D"])

    def test_files_that_hold_no_ratios_are_refused(self):
        with tempfile.TemporaryDirectory() as folder:
            for text in (None, "{", "[]", '{"a": 1}', '{"a": [1, 0]}', '{"a": ["x", "y"]}'):
                file = Path(folder) / "stored.json"
                if text is not None:
                    file.write_text(text)
                with self.subTest(text), self.assertRaisesRegex(ValueError, "stored.json"):
                    roofline.stored_ratios(file)

    def test_flops_are_those_of_the_points(self):
        point = next(point for point in roofline.points_of(RATES) if str(point) == "stored product, 3D")
        self.assertEqual((point.flops, point.bytes), (36, 52 + 8 * 3 * 4 / 61))


if __name__ == "__main__":
    unittest.main()
