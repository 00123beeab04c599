"""What the program says to wrong, extreme and long input, and to an interrupt."""

import json
import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[2]
PROGRAM = os.environ["PERISTAT_PROGRAM"]

# A plate of 40 x 12 points with a cut of 10 columns from its left edge.
PLATE = """\
title = "Plate"
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [0.04, 0.012]
[[lattice.layer]]
name = "bottom"
side = "y-"
[[lattice.layer]]
name = "top"
side = "y+"
[[set]]
name = "ligament"
where = "abs(y - 6e-3) < spacing"
[[crack]]
from = [-1e-3, 6e-3]
to = [0.0102, 6e-3]
[material]
youngs_modulus = 200e9
[material.damage]
law = "critical_stretch"
critical = 0.01
no_fail = ["bottom", "top"]
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = [0, "LIFT*load"]
[loading]
steps = 4
[[probe]]
name = "crack"
set = "ligament"
field = "crack_length"
"""
SPACING = 1e-3


class Messages(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat messages ")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def peristat(self, *arguments, **options):
        return subprocess.run([PROGRAM, *map(str, arguments)], cwd=self.folder, capture_output=True, text=True,
                              stdin=subprocess.DEVNULL, timeout=600, **options)  # fmt: skip

    def write(self, text, name="case.toml"):
        path = self.folder / name
        path.write_text(text.replace("LIFT", "1e-6"))
        return path

    def assert_refused(self, run, *words):
        self.assertEqual(run.returncode, 2, run.stdout + run.stderr)
        for word in words:
            self.assertIn(word, run.stderr)
        self.assertLess(len(run.stderr), 4000)

    def test_a_long_line_is_read_in_time_that_grows_with_it(self):
        corners = [(0.04 * k / 20000, 0.01) for k in range(20000)] + [(0.04, 0.0), (0.0, 0.0)]
        vertices = ", ".join(f"[{x:.9f}, {y}]" for x, y in corners)
        text = PLATE.replace('add = "box"\nmin = [0.0, 0.0]\nmax = [0.04, 0.012]', f'add = "polygon"\nvertices = [{vertices}]')
        start = time.monotonic()
        # unknown, so that nothing but reading is done
        self.assert_refused(self.peristat("check", self.write(text), "--set", "lattice.spacin=1"), "lattice.spacin")
        # Quadratic reading took 13 s for a fifth of the vertices.
        self.assertLess(time.monotonic() - start, 30.0)

    def test_a_first_shape_that_subtracts_is_wrong_input(self):
        run = self.peristat("run", self.write(PLATE.replace('add = "box"', 'subtract = "box"')))
        self.assert_refused(run, "lattice.shape[0]", "the first shape must be added")

    def test_a_load_without_a_value_at_the_start_is_told_with_its_place(self):
        text = PLATE + '[[load]]\nset = "ligament"\ntotal_force = ["1/load", 0]\n'
        place = f"case.toml:{text.count(chr(10))}:16: load[0].total_force[0] = "
        self.assert_refused(self.peristat("run", self.write(text)), place, "at load = 0 is inf")

    def test_long_values_are_quoted_shortly(self):
        long = "x" * 100_000
        for setting in (f"loading.steps={long}", f"{long}=1", f'title=["{long}"]', f"lattice.{long}=1"):
            self.assert_refused(self.peristat("check", self.write(PLATE), "--set", setting), "characters)")
        self.assert_refused(self.peristat("check", self.write(PLATE.replace('"box"', f'"{"y" * 700_000}"'))), "characters)")
        self.assert_refused(self.peristat("check", self.write(PLATE), "--threads", long), "characters)")

    def test_control_characters_end_no_message(self):
        run = self.peristat("check", self.write(PLATE.replace('law = "critical_stretch"', r'law = "a\u0000b\u001b"')))
        self.assert_refused(run, "allowed: ")
        self.assertNotIn("\0", run.stderr)
        self.assertNotIn("\x1b", run.stderr)

    def test_a_number_with_a_unit(self):
        for text in ("3.2 GPa", '"3.2 GPa"'):
            run = self.peristat("check", self.write(PLATE.replace("200e9", text)))
            self.assert_refused(run, "numbers carry no unit", "3.2e+09")
        run = self.peristat("check", self.write(PLATE), "--set", "lattice.spacing=1 mm")
        self.assert_refused(run, "numbers carry no unit", "write 0.001")

    def test_data_of_damage_need_a_law(self):
        """They used to be dropped without a word. Law none, said aloud, switches them off."""
        lawless = PLATE.replace('law = "critical_stretch", ', "").replace('law = "critical_stretch"\n', "")
        self.assertNotEqual(lawless, PLATE)
        self.assert_refused(self.peristat("check", self.write(lawless)), "material.damage", "needs a law beside it")
        for table in ("region", "interface"):
            case = PLATE + f'[[{table}]]\nmaterial = {{ youngs_modulus = 1e9, damage = {{ fracture_energy = 10 }} }}\n'
            run = self.peristat("check", self.write(case.replace("[[region]]", '[[region]]\nset = "top"')))
            self.assert_refused(run, f"{table}[0].material.damage", "needs a law beside it")
        run = self.peristat("check", self.write(lawless), "--set", 'material.damage.law="none"')
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertNotIn("fracture ", run.stdout)

    def test_an_option_that_is_a_key(self):
        run = self.peristat("run", self.write(PLATE), "--steps", "3")
        self.assert_refused(run, "unknown option --steps", "--set loading.steps=3")
        self.assert_refused(self.peristat("run", self.write(PLATE), "--thraeds", "1"), "did you mean --threads?")

    def test_help_of_run_has_the_launchers_option(self):
        run = self.peristat("run", "--help")
        self.assertEqual(run.returncode, 0)
        self.assertIn("--no-plots", run.stdout)

    def test_an_interrupt_is_told_once(self):
        text = PLATE.replace("LIFT", "1e-6").replace("steps = 4", "steps = 1000000")
        with subprocess.Popen([PROGRAM, "run", self.write(text)], cwd=self.folder, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE) as process:  # fmt: skip
            while not process.stdout.readline().startswith("step "):
                self.assertIsNone(process.poll())
            process.send_signal(signal.SIGINT)
            said = process.communicate(timeout=120)[1]
        self.assertEqual(process.returncode, 130)
        self.assertEqual(said.partition("\n")[0].count("interrupted"), 1, said)

    def test_calibrate_prints_numbers_or_refuses(self):
        told = refused = 0
        plane = ["--dimension", "2", "--horizon-ratio", "3.015"]
        space = ["--dimension", "3", "--horizon-ratio", "2.015"]
        materials = (["--youngs-modulus", "1e6", "--poisson-ratio", "0.2"], ["--lambda", "1e6", "--mu", "1e6"],
                     ["--c1", "1", "--c2", "1"])  # fmt: skip
        questions = []
        for lattice in (plane, space):
            for spacing in ("1e-300", "1e-60", "1e-12", "0.1", "1e20", "1e60", "1e300"):
                questions += [[*lattice, "--spacing", spacing, *material] for material in materials]
            fixed = [*lattice, "--spacing", "0.1"]
            for extreme in ("1e-308", "5e-324", "1e-150", "1e150", "1e308", "-1e308", "0"):
                for option, other in (("--youngs-modulus", ("--poisson-ratio", "0.3")), ("--lambda", ("--mu", "1")),
                                      ("--mu", ("--lambda", "1")), ("--c1", ("--c2", "1")), ("--c2", ("--c1", "1")),
                                      ("--poisson-ratio", ("--youngs-modulus", "1"))):  # fmt: skip
                    questions.append([*fixed, option, extreme, *other])
                questions.append([*fixed, "--c1", "1", "--c2", extreme, "--c3", extreme])
                questions.append([*plane, "--spacing", "0.1", "--thickness", extreme, *materials[0]])
        for question in questions:
            run = self.peristat("calibrate", *question)
            with self.subTest(" ".join(question)):
                self.assertIn(run.returncode, (0, 2), run.stderr)
                if run.returncode == 0:
                    told += 1
                    json.loads(run.stdout, parse_constant=self.fail)  # NaN and Infinity
                    self.assertNotIn("nan", run.stdout)
                    self.assertNotIn("inf", run.stdout)
                else:
                    refused += 1
                    self.assertEqual(run.stdout, "")
        self.assertGreater(told, 20)
        self.assertGreater(refused, 20)

    def test_the_length_of_a_crack_is_no_matter_of_display(self):
        """A cut of 10 columns, and what it is after the plate has torn: the same with either display."""
        for lift, expected in (("1e-7", 0.010), ("1e-3", 0.040)):
            lengths = []
            for counted in ("true", "false"):
                case = self.write(PLATE.replace("LIFT", lift))
                run = self.peristat("run", case, "--set", f"output.count_cracks={counted}", "--set", "solver.mode=adaptive",
                                    "--threads", "1", "--output", f"out_{lift}_{counted}", "--quiet")  # fmt: skip
                self.assertEqual(run.returncode, 0, run.stderr)
                summary = json.loads((self.folder / f"out_{lift}_{counted}" / "summary.json").read_text())
                lengths.append(summary["probes"]["crack"])
                self.assertEqual(summary["broken_bonds"] > 0, lift == "1e-3")
            self.assertEqual(*lengths)
            # A tip lies within a spacing of where the last column is separated.
            self.assertAlmostEqual(lengths[0], expected, delta=SPACING)


if __name__ == "__main__":
    unittest.main()
