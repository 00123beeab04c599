"""Numbers of the pages with which a user begins, compared with runs of their cases."""

import unittest

from tests.acceptance.folder import Folder
from tests.printed.comparison import PrintedTest
from tests.printed.fences import cases
from tests.printed.runs import run
from tests.reference.program import ROOT
from tests.reference.results import table

# Round-off decides which of two equal bonds breaks first, as in tests/slow/printed_cases_test.py.
COUNTS, PEAK = 0.05, 0.01


class FirstCrack(PrintedTest):
    def setUp(self):
        self.crack = run("start/crack", threads=2)
        self.peak = self.crack.step_of_peak("upper", "y")
        self.torn = next(row for row in self.crack.history if row["reaction_y:upper"] < 0.5 * self.peak["reaction_y:upper"]
                         and row["step"] > self.peak["step"])  # fmt: skip

    def test_header(self):
        self.page = "cases/start/crack.toml"
        self.prints("rises to {} N at load factor {}.", self.peak["reaction_y:upper"], self.peak["load_factor"], within=PEAK)
        self.prints("reaches it at load factor {}:", self.torn["load_factor"])
        before = self.crack.step(int(self.torn["step"]) - 1)
        share = self.torn["reaction_y:upper"] / before["reaction_y:upper"]
        self.assertLess(abs(share - 1 / 3), 0.05)  # "the force drops to a third"
        self.prints("{} broken bonds in", self.crack.summary["broken_bonds"], within=COUNTS)
        self.prints("broken bonds in {} steps", self.crack.summary["steps"])
        self.assertEqual(sum(row["mode"] == "newton" for row in self.crack.history), 1)  # "the elastic step"

    def test_the_crack_ends_at_the_hole(self):
        places = self.crack.points("reference")[self.crack.field("damage") > 0.3]
        x, y = places[:, 0].max(), places[:, 1].max()
        self.assertLess(x, 0.038 + 1e-3)  # not behind the middle of the hole
        self.assertLess(abs(((places[:, 0] - 0.038) ** 2 + (places[:, 1] - 0.007) ** 2) ** 0.5 - 5e-3).min(), 1.5e-3)
        self.assertGreater(y, 2e-3)  # it has turned

    def test_page(self):
        self.page = "docs/start/first-crack.md"
        self.prints("`{} bonds would be damaged … hand over", self.damaged())
        self.prints("`step {} … {} bonds broken`", self.torn["step"], self.torn["broken_bonds"], within=COUNTS)
        self.prints("the force rises to {} N at an opening of {} mm", self.peak["reaction_y:upper"],
                    1e3 * (self.peak["displacement_y:upper"] - self.peak["displacement_y:lower"]), within=PEAK)  # fmt: skip
        self.prints("at the end {} J are dissipated", self.crack.history[-1]["dissipated_energy"], within=COUNTS)
        self.assertLess(max(self.crack.accepted_residuals()), 1e-10)

    def damaged(self):
        (line,) = (line for line in self.crack.output.splitlines() if "hand over to relaxation" in line)
        return float(line.partition(": ")[2].split()[0])


class OwnPlates(PrintedTest, Folder):
    def test_check_of_the_plate(self):
        self.page = "docs/start/own-plate.md"
        told = self.assert_completed(self.command("check", cases(ROOT / self.page)["plate.toml"])).output
        self.assertNotIn("warning", told)
        self.prints("the body: {} points, a ligament of {} spacings", float(told.partition("points ")[2].split()[0]),
                    float(told.partition("ligament ")[2].partition(" spacings")[0].split()[-1]))  # fmt: skip

    def test_beam_of_concrete(self):
        self.page = "docs/start/data-sheets.md"
        beam = self.run_case(cases(ROOT / self.page)["concrete.toml"])
        peak = max(-row["reaction_y:load"] for row in table(beam / "history.csv"))
        self.prints("The beam bears {} kN", 1e-3 * peak, within=PEAK)

    def test_copied_numbers(self):
        self.page = "docs/start/data-sheets.md"
        beam = run("three_point_bending/toughness")
        self.prints("The peak is {} N where", beam.peak("load", "y"), within=PEAK)
        quarter = run("plate_with_hole/quarter")
        self.prints("half of its reaction, {} N", quarter.reaction("right"), page="docs/how-to/symmetric-bodies.md")
        self.prints("The quarter has {} points", quarter.summary["points"], page="docs/how-to/symmetric-bodies.md")


if __name__ == "__main__":
    unittest.main()
