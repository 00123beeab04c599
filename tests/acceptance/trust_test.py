"""The suite of known answers, on the coarsest lattice of some of its entries."""

import csv
import re
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import PROGRAM, ROOT

BIAXIAL = 27e6  # Pa, of the glass in cases/runner/trust/strength.py


class Trust(Folder):
    def words(self, *arguments, output="."):
        script = ROOT / "cases/runner/trust/trust.py"
        return ["/usr/bin/python3", "-BEs", script, *arguments, "--output", self.folder / output]

    def trust(self, *arguments, **options):
        return self.execute(self.words(*arguments, **options), environment={"PERISTAT_PROGRAM": PROGRAM})

    def test_a_steady_crack_resists_with_what_it_was_given(self):
        """A law whose force falls linearly: within 2 % of G_c; and nothing is run twice. The dissipated energy is 2.3 %
        off along the lattice, where 1 % is allowed: red, also in the exit code."""
        ended = self.trust("surfing", "--quick", "--threads", 1)
        self.assert_code(ended, 3)
        value = float(re.search(r"surfing/h1_m3.015_0, sqrt\(J / G_c\): ([0-9.]+) of the reference", ended.output)[1])
        self.assertAlmostEqual(value, 1, delta=0.02)
        steady, dissipated = [line for line in (self.folder / "table.md").read_text().splitlines() if "(`surfing`)" in line]
        self.assertIn("| pass |", steady)
        self.assertIn("| **red**: -2.3 % where 1 % are allowed |", dissipated)
        again = self.trust("surfing", "--quick", "--threads", 1)
        self.assertNotRegex(again.output, r"h1_m3.015_0: \d+ s")

    def test_the_quick_subset(self):
        """Entries whose coarsest lattice takes seconds: a cantilever whose energy over area is G_c, strengths that no
        horizon can match together, and a beam whose toughness by compliance is closer than its peak."""
        ended = self.trust("double_cantilever", "strength_biaxial", "strength_shear", "senb_03", "--quick")
        self.assert_code(ended, 3)
        value = lambda name, quantity: float(re.search(rf"{name}/h1_m3.015_0, {quantity}: ([0-9.]+)", ended.output)[1])
        self.assertAlmostEqual(value("double_cantilever", "dissipated energy over area"), 1, delta=0.01)
        self.assertAlmostEqual(value("double_cantilever", "load while the crack grows"), 1, delta=0.025)
        self.assertAlmostEqual(value("senb_03", "toughness by compliance"), 1, delta=0.04)
        # All bonds soften at once: the run reaches the lattice's predicted strength, up to a strain step, here a 27th
        # of it.
        case = self.folder / "strength_biaxial/h1_m3.015_0/case.toml"
        foretold = self.peristat("calibrate", "--strengths", case).json()
        biaxial = foretold["damage"]["strengths"]["biaxial"]["peak"]["mean"] / BIAXIAL
        self.assertLess(value("strength_biaxial", "strength"), biaxial * (1 + 1e-4))
        self.assertGreater(value("strength_biaxial", "strength"), biaxial * (1 - 1 / 27))
        self.assertLess(value("strength_shear", "strength"), 0.8)

    def test_two_suites_in_one_folder_share_the_work(self):
        names = ["strength_uniaxial", "strength_biaxial", "strength_shear"]
        started = [self.start(self.words(*names, "--jobs", 1), {"PERISTAT_PROGRAM": PROGRAM}) for _ in range(2)]
        said = [process.communicate(timeout=300)[0] for process in started]
        self.assertEqual([process.returncode for process in started], [3, 3], said)
        for name in names:
            runs = [text for text in said if re.search(rf"{name}/h0.25_m3.015_0: \d+ s", text)]
            self.assertEqual(len(runs), 1, said)

    def test_a_coarse_beam_is_red(self):
        """20 spacings are too few for a peak within 2 %: the table says so, with exit code 3."""
        ended = self.trust("senb_05", "--quick", "--threads", 1)
        self.assert_code(ended, 3)
        self.assertIn("**red**", (self.folder / "table.md").read_text())

    def test_another_model_runs_or_is_refused_in_the_program_s_words(self):
        """Entries whose keys the model does not take are red; the table names what was set."""
        ended = self.trust("senb_05", "double_cantilever", "strength_shear", "--quick", "--jobs", 1,
                           "--set", "material.model=state", "--set", "loading.steps=2", "--set", "loading.adaptive=false",
                           "--set", "loading.table=[0, 1e-6]")  # fmt: skip
        self.assert_code(ended, 3)
        table = (self.folder / "table.md").read_text()
        line = {entry: next(line for line in table.splitlines() if f"(`{entry}`)" in line)
                for entry in ("double_cantilever", "strength_shear")}  # fmt: skip
        self.assertIn("**red**: h1_m3.015_0: ", line["double_cantilever"])
        self.assertIn("interface: is for models", line["double_cantilever"])
        self.assertNotIn("h1_m3.015_0: ", line["strength_shear"])  # it has run
        self.assertIn("With material.model = state.\n\nWith loading.steps = 2.", table)
        self.assertIn("With material.poisson_ratio = 0.22.", table)
        again = self.trust("senb_05", "--quick", "--set", "loading.steps=2", "--set", "loading.table=[0, 1e-6]")
        self.assertRegex(again.output, r"senb_05/h1_m3.015_0: \d+ s")  # other settings are other runs

    def test_strength_and_toughness_meet_and_a_sheared_plate_bears_what_was_measured(self):
        """An edge crack of twice the length of the transition: Griffith's load is 1.22 of the reference, the strength
        1.73."""
        ended = self.trust("edge_crack_2", "double_edge_notch", "--quick", "--jobs", 1)
        self.assert_code(ended, 0)
        value = lambda name, quantity: float(re.search(rf"{name}/h1_m3.015_0, {quantity}: ([0-9.]+)", ended.output)[1])
        self.assertAlmostEqual(value("edge_crack_2", "stress at the peak"), 1, delta=0.06)
        self.assertAlmostEqual(value("double_edge_notch", "largest shear force"), 1, delta=0.1)

    def test_a_crack_kinks_without_t_stress_and_keeps_to_its_row_with_it(self):
        """On a lattice along the crack: without T it turns as in fracture mechanics, within 5 degrees; with negative T a
        row holds it, 24 degrees off, and the table says so, with exit code 3. Nothing is run twice."""
        ended = self.trust("kink", "--quick", "--jobs", 1)
        self.assert_code(ended, 3)
        free, held = (self.folder / "kink.md").read_text().splitlines()[2:4]
        self.assertRegex(free, r"^\| 0.577 \| 0 \|.*\| pass \|$")
        self.assertRegex(held, r"^\| 0.364 \| -0.2 \|.*\| \*\*red\*\*: 0° by \+2\d\.\d° \|$")
        # The elastic body bears the factors that its rim is given.
        with open(self.folder / "kink.csv", newline="") as table:
            for row, stress in zip(csv.DictReader(table), (0.0, -0.2), strict=True):
                self.assertAlmostEqual(float(row["K1_over_given"]), 1, delta=0.02)
                self.assertAlmostEqual(float(row["K2_over_given"]), 1, delta=0.07)
                self.assertAlmostEqual(float(row["elastic_T_star"]), stress, delta=0.02)
        again = self.trust("kink", "--quick", "--jobs", 1)
        self.assertNotRegex(again.output, r"kink/\S+: \d+ s")

    def test_bad_input(self):
        self.assert_refused(self.trust("surfing", "--threads", 0), "argument --threads")
        self.assert_refused(self.trust("surfing", "--set", "material.model"), "must be KEY=VALUE")
        for study in ("trapping", "kink"):
            self.assert_refused(self.trust(study, "--set", "material.model=state"), f"{study} takes no --set")
        ended = self.trust("surfing", "--quick", output=self.write("a file", ""))
        self.assert_code(ended, 5)
        self.assertIn("a file", ended.errors)
        self.assertNotIn("Traceback", ended.errors)

    def test_files_of_others_are_not_replaced(self):
        for name in ("table.md", "entries.svg", "trapping.csv", "trapping.svg", "kink.md", "kink.csv", "kink.svg",
                     "phase_fields.md", "strength_shear/h1_m3.015_0/case.toml"):  # fmt: skip
            mine = self.write(name, "mine")
            self.assert_refused(self.trust("strength_shear", "--quick", "--jobs", 1), name)
            self.assertEqual([path for path in self.folder.rglob("*") if path.is_file()], [mine])
            self.assertEqual(mine.read_text(), "mine")
            mine.unlink()

    def test_no_such_entry(self):
        self.assert_refused(self.trust("nonsense"), "no entry nonsense; there are surfing")


if __name__ == "__main__":
    unittest.main()
