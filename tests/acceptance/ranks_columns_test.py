"""Columns of points, given factors, tables of files and loads over time on several MPI ranks."""

import unittest

import h5py
import numpy

from tests.acceptance.columns_test import AMPLITUDE, CLOUD, MOVING, NAMED, PLACES, STILL, TYPED
from tests.acceptance.on_ranks import PLATE, STORED, Comparison, on


class ColumnsOnRanks(Comparison):
    def write_points(self):
        lines = ["copy_of_x, x, y, product, volume, is_right"]
        for x, y in PLACES.tolist():
            lines.append(", ".join(map(repr, (x, x, y, x * y, 1.0, float(x > 6.5)))))
        self.write("points.csv", "\n".join(lines) + "\n")

    def test_columns(self):
        self.write_points()
        self.compare((CLOUD + STILL).format(**NAMED), (2,), solver=STORED)
        folders = [self.run_case((CLOUD + STILL).format(**names) + STORED, name=name, words=on(2))
                   for name, names in (("typed", TYPED), ("named", NAMED))]  # fmt: skip
        displacements = []
        for folder in folders:
            with h5py.File(folder / "results.h5") as file:
                displacements.append(file[f"steps/{sorted(file['steps'])[-1]}/displacement"][...])
        numpy.testing.assert_array_equal(*displacements)

    def test_motions(self):
        self.write_points()
        self.compare((CLOUD + MOVING).format(**NAMED), (2,), solver="")

    def test_tables(self):
        self.write("amplitude.csv", AMPLITUDE)
        text = PLATE.replace('"0.05*load"', "'0.05*table(\"amplitude.csv\", \"u\", load)'")
        self.assertNotEqual(text, PLATE)
        self.compare(text, (2,))

    def test_loads_over_time(self):
        self.write_points()
        text = (CLOUD + MOVING).format(**NAMED).replace("sin(t)", "load") + "[loading]\ntable = [[0, 0], [0.2, 3], [1, 1]]\n"
        self.compare(text, (2,), solver="")


if __name__ == "__main__":
    unittest.main()
