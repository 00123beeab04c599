"""Numbers on fracture in the tutorial, the theory and the headers of its cases, compared with runs."""

import re
import unittest

from tests.printed.comparison import PrintedTest
from tests.printed.page import numbers
from tests.printed.runs import run
from tests.reference.program import ROOT

SQUARE, NOTCHED = "plate_with_hole/square", "three_point_bending/notched"
TUTORIAL = "docs/tutorial-fracture.md"
# "Elsewhere round-off differs: counts of broken bonds may differ by some per cent, peaks by less than
# one" (tutorial).
COUNTS, PEAK = 0.05, 0.01


class Square(PrintedTest):
    page = TUTORIAL

    def test_transcript(self):
        text = (ROOT / self.page).read_text()
        told = [line for line in text.split("```")[3].splitlines() if line.strip(" …")]
        self.assertGreater(len(told), 10)
        said = run(SQUARE).output.splitlines()
        for line in told:
            # round-off decides residuals, and a few iterations
            pattern = re.escape(line.rstrip())
            pattern = re.sub(r"\d+\\ iterations", r"\\d+\\ iterations", pattern)
            pattern = re.sub(r"after\\ \d+\\ of", r"after\\ \\d+\\ of", pattern)
            pattern = re.sub(r"residual\\ [^ ]+?\\ ", r"residual\\ \\S+\\ ", pattern)
            self.assertTrue(any(re.fullmatch(pattern, other.rstrip()) for other in said), f"not told: {line}")

    def test_first_section(self):
        square = run(SQUARE)
        self.prints("in step {} the first {} bonds snap", square.first("broken_bonds")["step"],
                    square.first("broken_bonds")["broken_bonds"])  # fmt: skip
        torn = next(row for row in square.history if row["broken_bonds"] > 100)
        self.prints("In step {} two cracks run", torn["step"])
        self.prints("All {} states are equilibria", square.summary["steps"])
        self.assertLess(max(square.accepted_residuals()), 1e-10)
        self.assertEqual({row["settled"] for row in square.history}, {0.0})
        self.prints("the reaction rises to {} kN", square.peak("top", "y") / 1e3, within=PEAK)
        before = square.step(int(torn["step"]) - 1)
        self.prints("at the drop {} J are stored. {} J of them go into broken bonds", before["stored_energy"],
                    torn["dissipated_energy"], within=COUNTS)  # fmt: skip

    def test_header(self):
        self.page = f"cases/{SQUARE}.toml"
        square = run(SQUARE)
        torn = next(row for row in square.history if row["broken_bonds"] > 100)
        snap = square.first("broken_bonds")
        self.prints("near load factor {};", square.first("max_damage")["load_factor"])
        self.prints("{} bonds snap at {} and the plate holds", snap["broken_bonds"], snap["load_factor"])
        self.prints("at {} two cracks run through", torn["load_factor"], within=PEAK)
        self.prints("Peak reaction {} N ([ADAPT]", square.peak("top", "y"), within=PEAK)
        self.prints("{} broken bonds in", square.summary["broken_bonds"], within=COUNTS)
        self.prints("broken bonds in {} steps", square.summary["steps"])
        self.assertLess(abs(square.reaction("top", "y")), 1e-6 * square.peak("top", "y"))  # "afterwards the reaction is zero"

    def test_bonds_do_not_depend_on_threads(self):
        one, two = run(SQUARE), run(SQUARE, threads=2)
        self.assertEqual(one.summary["broken_bonds"], two.summary["broken_bonds"])
        self.assertEqual(one.first("broken_bonds")["broken_bonds"], two.first("broken_bonds")["broken_bonds"])

    def test_laws(self):
        runs = {"`tanh`, 0.015 to 0.020": run(SQUARE),
                "`tanh_continuous`, 0.015 to 0.020": run(SQUARE, "material.damage.law=tanh_continuous"),
                "`critical_stretch`, 0.020": run(SQUARE, 'material.damage={law="critical_stretch", critical=0.020}'),
                }  # fmt: skip
        for name, square in runs.items():
            peak, load, count = numbers(TUTORIAL, f"| {name} | {{}} kN | {{}} | {{}} |")
            self.prints(f"| {name} | {{}} kN | {{}} | {count.text} |", square.peak("top", "y") / 1e3,
                        square.step_of_peak("top", "y")["load_factor"], within=PEAK)  # fmt: skip
            self.prints(f"| {name} | {peak.text} kN | {load.text} | {{}} |", square.summary["broken_bonds"],
                        within=COUNTS)  # fmt: skip

    def test_crack(self):
        cracked = run(SQUARE, "crack[0].from=[-0.012, 0.0]", "crack[0].to=[-0.003, 0.0]", "output.count_cracks=true")
        torn = next(row for row in cracked.history if row["broken_bonds"] > 100)
        self.prints("The peak falls to {} kN.", cracked.peak("top", "y") / 1e3, within=PEAK)
        self.prints("at load {}, and runs in several bursts before it goes through at {}.",
                    cracked.first("broken_bonds")["load_factor"], torn["load_factor"], within=PEAK)  # fmt: skip
        # damage beside a straight crack: "about 0.4", the share of bonds that cross it
        self.prints("A clean crack has about {} beside it", cracked.step(1)["max_damage"])

    def mode(self, words, result):
        reached, peak, count = numbers(TUTORIAL, f"| {words} | {{}}{self.outcome(result)} | {{}} kN | {{}} |")
        for number, value, share in ((reached, result.history[-1]["load_factor"], 1e-3),
                                     (peak, result.peak("top", "y") / 1e3, PEAK),
                                     (count, result.summary["broken_bonds"], COUNTS)):  # fmt: skip
            self.assertAlmostEqual(number.value, value, delta=max(number.rounding, share * number.value), msg=words)

    @staticmethod
    def outcome(result):
        return "" if result.summary["status"] == "completed" else ", `limit_point`"

    def test_modes(self):
        adaptive, relaxed = run(SQUARE), run(SQUARE, "solver.mode=relaxation")
        newton = run(SQUARE, "solver.mode=newton", code=3)
        self.mode(f"`adaptive` | {adaptive.summary['steps']}", adaptive)
        self.mode(f"`relaxation` | {relaxed.summary['steps']}", relaxed)
        (steps,) = numbers(TUTORIAL, "| `newton` | {} |")  # most of them are cuts: a few more or less
        self.assertAlmostEqual(newton.summary["steps"], steps.value, delta=3)
        self.mode(f"`newton` | {steps.text}", newton)
        self.prints("limit point near {} with a dossier", newton.history[-1]["load_factor"],
                    page=f"cases/{SQUARE}.toml")  # fmt: skip
        self.prints("limit_point after load factor {}: a limit point", newton.history[-1]["load_factor"], within=1e-4)
        gentle = run(SQUARE, "relaxation.breaking=at_equilibrium")
        self.prints("gives {} broken bonds and the same peak", gentle.summary["broken_bonds"], within=COUNTS)
        self.assertAlmostEqual(gentle.peak("top", "y") / adaptive.peak("top", "y"), 1.0, delta=PEAK)
        self.prints("loses {} and {} bonds in the two manners, {} in mode `relaxation`",
                    *(result.summary["broken_bonds"] for result in (adaptive, gentle, relaxed)),
                    within=COUNTS, page="docs/theory.md")  # fmt: skip

    def test_moving_load(self):
        moving = run(SQUARE, "solver.mode=relaxation", "relaxation.load=moving", "relaxation.steps=100")
        self.assertIn("`--set relaxation.load=moving --set relaxation.steps=100`", (ROOT / TUTORIAL).read_text())
        self.prints("its peak is {} kN, and more than", moving.peak("top", "y") / 1e3, within=PEAK)
        (least,) = numbers(TUTORIAL, "and more than {} N remain where the plate is in two")
        self.assertGreater(max(abs(force) for force in moving.reactions("top", "y")[-20:]), least.value)
        (least,) = numbers("docs/theory.md", "still carry more than {} N where")
        self.assertGreater(max(abs(force) for force in moving.reactions("top", "y")[-20:]), least.value)
        self.assertEqual({row["settled"] for row in moving.history}, {1.0})

    def test_steps(self):
        runs = [run(SQUARE, *changes) for changes in (("relaxation.steps=45",), ("relaxation.steps=90",), (),
                                                      ("relaxation.steps=360",))]  # fmt: skip
        self.prints("Here the peaks are {}, {}, {} and {} kN", *(result.peak("top", "y") / 1e3 for result in runs),
                    within=PEAK)  # fmt: skip
        self.prints("and {}, {}, {} and {} bonds break", *(result.summary["broken_bonds"] for result in runs),
                    within=COUNTS)  # fmt: skip


class Notched(PrintedTest):
    page = TUTORIAL

    def test_header(self):
        self.page = f"cases/{NOTCHED}.toml"
        beam = run(NOTCHED)
        peak = beam.step_of_peak("load", "y")
        self.prints("(peak reaction {} N at {},", -peak["reaction_y:load"], peak["load_factor"], within=PEAK)
        self.prints("{} broken bonds in", beam.summary["broken_bonds"], within=COUNTS)
        self.prints("broken bonds in {} steps", beam.summary["steps"])
        self.prints("{} % of the peak at the end", 100 * beam.reaction("load", "y") / peak["reaction_y:load"],
                    within=0.2)  # of a small rest  # fmt: skip

    def test_fourth_section(self):
        beam = run(NOTCHED)
        self.prints("The load peaks at {} kN", beam.peak("load", "y") / 1e3, within=PEAK)
        energy = beam.summary["energy"]
        self.prints("At the end {} J are dissipated, and {} J are drained", energy["dissipated"], energy["drained"],
                    within=COUNTS)  # fmt: skip
        self.prints("of which {} J are numerical work", energy["numerical_work"], within=COUNTS)

    def test_steps(self):
        for steps in (20, 40):
            beam = run(NOTCHED, f"relaxation.steps={steps}") if steps != 20 else run(NOTCHED)
            energy = beam.summary["energy"]
            self.prints(f"| {steps} | {{}} kN | {{}} | {{}} J | {{}} J | {{}} J |", beam.peak("load", "y") / 1e3,
                        beam.summary["broken_bonds"], energy["dissipated"], energy["drained"],
                        energy["numerical_work"], within=COUNTS)  # fmt: skip


if __name__ == "__main__":
    unittest.main()
