"""What the headers of the long cases print, compared with one run of each."""

import unittest

from tests.printed.comparison import PrintedTest
from tests.printed.page import numbers
from tests.printed.runs import run

# Round-off decides which of two like bonds breaks first, so that elsewhere counts differ "by some per
# cent" and peaks by "less than one": so the headers and the tutorial.
COUNTS, PEAK = 0.05, 0.01


class Fracture(PrintedTest):
    def test_rectangle(self):
        self.page = "cases/plate_with_hole/rectangle.toml"
        plate = run("plate_with_hole/rectangle")
        self.prints("damage begins near load factor {};", plate.first("max_damage")["load_factor"])
        self.prints("the first {} bonds break at {} and", plate.first("broken_bonds")["broken_bonds"],
                    plate.first("broken_bonds")["load_factor"], within=PEAK)  # fmt: skip
        torn = next(row for row in plate.history if row["broken_bonds"] > 100)
        self.prints("and the plate at {}, in two cracks", torn["load_factor"], within=PEAK)
        peak = plate.step_of_peak("right", "x")
        self.prints("Peak reaction {} N at {};", peak["reaction_x:right"], peak["load_factor"], within=PEAK)
        self.prints("{} broken bonds in", plate.summary["broken_bonds"], within=COUNTS)
        self.prints("broken bonds in {} steps", plate.summary["steps"])

    def test_stretch_where_the_paper_splits_the_displacement(self):
        elastic = "solver.mode=newton", "loading.steps=1", 'material.damage={law="none"}'
        rectangle = run("plate_with_hole/rectangle", *elastic, 'support[0].displacement=["-0.8e-3*load","0"]',
                        'support[1].displacement=["0.8e-3*load","0"]')  # fmt: skip
        square = run("plate_with_hole/square", *elastic, 'support[0].displacement=["0","-1.375e-4*load"]',
                     'support[1].displacement=["0","1.375e-4*load"]')  # fmt: skip
        self.prints("the most stretched bond would end at {} (3.3) and {} (5.2) of the onset",
                    rectangle.history[-1]["max_stretch"] / 0.033, square.history[-1]["max_stretch"] / 0.015,
                    page="docs/theory.md")  # fmt: skip

    def test_four_holes(self):
        self.page = "cases/four_holes/tension.toml"
        plate = run("four_holes/tension")
        peak = plate.step_of_peak("top", "y")
        self.prints("(peak reaction {} N at {})", peak["reaction_y:top"], peak["load_factor"], within=PEAK)
        breaks = [after["load_factor"] for before, after in zip(plate.history, plate.history[1:])
                  if after["broken_bonds"] > before["broken_bonds"] + 3000]  # fmt: skip
        self.prints("to load factor {} (peak", breaks[0])
        self.prints("in that to {};", breaks[1])
        self.prints("{} broken bonds in", plate.summary["broken_bonds"], within=COUNTS)
        self.prints("broken bonds in {} steps", plate.summary["steps"])


class Cpd(PrintedTest):
    def test_cube_in_one_increment(self):
        self.page = "cases/cpd/cube.toml"
        kinds = ("material.c3=0",), ("material.c2=2000", "material.c3=0"), ()
        cubes = [run("cpd/cube", "loading.steps=1", *kind) for kind in kinds]
        self.prints('reaction on "pulled" [N] {} {} {}', *(cube.reaction("pulled") for cube in cubes))
        self.assertEqual(cubes[2].summary["newton_iterations"], 6)  # "takes six iterations,
        self.assertEqual(sum(row["projection"] > 0 for row in cubes[2].iterations), 1)  # one of them projected"

    def test_cube_in_25_increments(self):
        cube = run("cpd/cube")
        *_, last = numbers("cases/cpd/cube.toml", 'reaction on "pulled" [N] {} {} {}')
        self.assertAlmostEqual(cube.reaction("pulled"), last.value, delta=last.rounding)
        counts = {row["newton_iterations"] for row in cube.history}
        self.assertLessEqual(counts, {3, 4})  # "three to four iterations in an increment"

    def test_table_3(self):
        self.page = "cases/cpd/table3.toml"
        residuals = [row["step_1"] for row in run("cpd/table3").convergence[:5]]
        self.prints("residuals of increment 1 over that after the jump: {}, {}, {}, {},", *residuals[:4])
        self.assertLess(residuals[4], 1e-13)  # round-off, which differs between machines


if __name__ == "__main__":
    unittest.main()
