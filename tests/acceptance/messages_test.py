"""Messages for wrong, extreme and long input, and for an interrupt."""

import json
import signal
import time
import unittest

import h5py

from tests.acceptance.folder import Folder
from tests.reference.program import PROGRAM

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


class Messages(Folder):
    def case(self, text):
        return super().case(text.replace("LIFT", "1e-6"))

    def assert_refused(self, run, *words):
        super().assert_refused(run, *words)
        self.assertLess(len(run.errors), 4000)

    def test_a_long_line_is_read_in_time_that_grows_with_it(self):
        corners = [(0.04 * k / 20000, 0.01) for k in range(20000)] + [(0.04, 0.0), (0.0, 0.0)]
        vertices = ", ".join(f"[{x:.9f}, {y}]" for x, y in corners)
        text = PLATE.replace('add = "box"\nmin = [0.0, 0.0]\nmax = [0.04, 0.012]', f'add = "polygon"\nvertices = [{vertices}]')
        start = time.monotonic()
        # an unknown key, so that the case is only read
        self.assert_refused(self.command("check", text, "lattice.spacin=1"), "lattice.spacin")
        # Reading in quadratic time took 13 s for a fifth of the vertices.
        self.assertLess(time.monotonic() - start, 30.0)

    def test_a_first_shape_that_subtracts_is_wrong_input(self):
        run = self.command("run", PLATE.replace('add = "box"', 'subtract = "box"'))
        self.assert_refused(run, "lattice.shape[0]", "the first shape must be added")

    def test_a_load_without_a_value_at_the_start_is_told_with_its_place(self):
        text = PLATE + '[[load]]\nset = "ligament"\ntotal_force = ["1/load", 0]\n'
        place = f"case.toml:{text.count(chr(10))}:16: load[0].total_force[0] = "
        self.assert_refused(self.command("run", text), place, "at load = 0 is inf")

    def test_long_values_are_quoted_shortly(self):
        long = "x" * 100_000
        for setting in (f"loading.steps={long}", f"{long}=1", f'title=["{long}"]', f"lattice.{long}=1"):
            self.assert_refused(self.command("check", PLATE, setting), "characters)")
        self.assert_refused(self.command("check", PLATE.replace('"box"', f'"{"y" * 700_000}"')), "characters)")
        self.assert_refused(self.command("check", PLATE, words=("--threads", long)), "characters)")

    def test_control_characters_end_no_message(self):
        run = self.command("check", PLATE.replace('law = "critical_stretch"', r'law = "a\u0000b\u001b"'))
        self.assert_refused(run, "allowed: ")
        self.assertNotIn("\0", run.errors)
        self.assertNotIn("\x1b", run.errors)

    def warnings(self, run):
        return [line.removeprefix("warning: ") for line in run.output.splitlines() if line.startswith("warning: ")]

    def test_check_tells_what_a_case_makes_of_the_body(self):
        run = self.assert_completed(self.command("check", PLATE))
        for line in ("body        0.04 x 0.012 m, thickness 0.001 m; 40 x 12 spacings", "ligament    ligament beside crack[0], 0.0298 m",
                     "crack       crack[0] cuts ", "applied     support[1].displacement[1] (top): 0 m at load 0, 1e-06 m at the end",
                     "steps in which damage grows take many times as long"):  # fmt: skip
            self.assertIn(line, run.output)
        self.assertEqual(self.warnings(run), [])

    def test_warnings_stand_at_the_head_of_a_run_and_in_its_summary(self):
        case = PLATE.replace('"LIFT*load"', "1e-6").replace("thickness = 1e-3\n", "")
        told = self.warnings(self.command("check", case))
        self.assertEqual(len(told), 2, told)
        self.assertIn("lattice.thickness is not given, so it is 1 m", told[0])
        self.assertIn("support[1].displacement[1] = 1e-06 does not depend on load: it is applied in full at load 0", told[1])
        self.assertEqual(self.results(case).summary["warnings"], told)
        self.assertEqual(self.warnings(self.ended), told)
        self.assertLess(self.ended.output.index("warning: "), self.ended.output.index("step "))
        self.assertEqual(self.results(PLATE, words=("--quiet",)).summary["warnings"], [])
        self.assertEqual(self.ended.output, "")

    def test_what_does_nothing_is_refused(self):
        outside = PLATE.replace("from = [-1e-3, 6e-3]", "from = [1.0, 6e-3]").replace("to = [0.0102, 6e-3]", "to = [2.0, 6e-3]")
        for command in ("check", "run"):
            self.assert_refused(self.command(command, outside), "crack[0]", "cuts no bond")
        hole = '[[lattice.shape]]\nsubtract = "disk"\ncentre = [4.0, 4.0]\nradius = 1.0\n'
        text = PLATE.replace("[[lattice.layer]]", hole + "[[lattice.layer]]", 1)
        self.assert_refused(self.command("check", text), "lattice.shape[1].subtract", "has no effect")
        run = self.command("check", PLATE, "loading.table2=[0, 1]")
        self.assert_refused(run, "loading.table2", "load2, but no displacement and no load uses it")

    def test_a_modulus_in_gigapascals(self):
        text = PLATE.replace("200e9", "30").replace("critical = 0.01", "fracture_energy = 100\nstrength = 3e6").replace("critical_stretch", "linear")
        self.assert_refused(self.command("check", text), "strength", "youngs_modulus is 30 Pa (30 GPa is 30e9)")

    def test_names_that_results_can_not_have(self):
        name = "n" * 300
        for text in (PLATE.replace('name = "crack"', f'name = "{name}"'), PLATE.replace("ligament", name)):
            self.assert_refused(self.command("check", text), "300 characters; at most 100")
        self.write("points.csv", "x,y,volume,set\n0,0,1e-9,.\n1e-3,0,1e-9,\n")
        text = 'dimension = 2\n[points]\nfile = "points.csv"\nhorizon = 3e-3\nthickness = 1e-3\n[material]\nyoungs_modulus = 1e9\n'
        self.assert_refused(self.command("check", text), "points.csv:2", "can't be called '.'")

    def test_more_ranks_than_the_machine_bears(self):
        self.assert_refused(self.command("run", PLATE, words=("--ranks", "100000")), "--ranks", "at most")

    def test_results_tell_which_point_of_the_file_each_is(self):
        places = [(0.001 * (7 * k % 20), 0.001 * (k % 2)) for k in range(40)]
        places = sorted(set(places), key=lambda place: (place[1], -place[0]))
        rows = [f"{x},{y},1e-9,{'held' if x < 0.0025 else 'pulled' if x > 0.0165 else ''}" for x, y in places]
        self.write("points.csv", "\n".join(["# remark", "x,y,volume,set", *rows]))
        out = self.run_case('dimension = 2\n[points]\nfile = "points.csv"\nhorizon = 3.1e-3\nthickness = 1e-3\n'
                            '[material]\nyoungs_modulus = 1e9\n[[support]]\nset = "held"\ndisplacement = [0, 0]\n'
                            '[[support]]\nset = "pulled"\ndisplacement = ["1e-6*load", 0]\n')  # fmt: skip
        with h5py.File(out / "results.h5") as file:
            row = file["points/source_row"][...]
            self.assertEqual(sorted(row), list(range(len(places))))
            for place, k in zip(file["points/reference"][...], row, strict=True):
                self.assertEqual(tuple(place), places[k])

    def test_a_number_with_a_unit(self):
        run = self.command("check", PLATE.replace("200e9", "3.2 GPa"))
        self.assert_refused(run, 'write a number with a unit in quotes: "3.2 GPa"')
        run = self.command("check", PLATE.replace("200e9", '"3.2 mm"'))
        self.assert_refused(run, "must be a stress, e.g. 210 GPa")
        self.assert_completed(self.command("check", PLATE.replace("200e9", '"3.2 GPa"')))
        self.assert_completed(self.command("check", PLATE, "lattice.spacing=1 mm"))

    def test_data_of_damage_need_a_law(self):
        """They used to be ignored silently. An explicit law "none" switches them off."""
        lawless = PLATE.replace('law = "critical_stretch", ', "").replace('law = "critical_stretch"\n', "")
        self.assertNotEqual(lawless, PLATE)
        self.assert_refused(self.command("check", lawless), "material.damage", "needs a law in the same table")
        for table in ("region", "interface"):
            case = PLATE + f'[[{table}]]\nmaterial = {{ youngs_modulus = 1e9, damage = {{ fracture_energy = 10 }} }}\n'
            run = self.command("check", case.replace("[[region]]", '[[region]]\nset = "top"'))
            self.assert_refused(run, f"{table}[0].material.damage", "needs a law in the same table")
        run = self.assert_completed(self.command("check", lawless, 'material.damage.law="none"'))
        self.assertNotIn("fracture ", run.output)

    def test_a_layer_of_points_in_space(self):
        """No horizon gives bonds a direction out of the plane in which all points lie."""
        layer = 'dimension = 3\n[lattice]\nspacing = 1e-3\nshape = [{ add = "box", min = [0, 0, 0], max = [0.02, 0.01, 0.001] }]\n'
        layer += '[material]\nyoungs_modulus = 200e9\n[[set]]\nname = "left"\nwhere = "x < 0.003"\n'
        layer += '[[support]]\nset = "left"\ndisplacement = [0, 0, 0]\n[[load]]\nset = "left"\nbody_force = ["load", 0, 0]\n'
        run = self.command("check", layer)
        self.assert_refused(run, "all points have the same z", "two layers", "2 dimensions")
        self.assertNotIn("horizon", run.errors)

    def test_an_option_that_is_a_key(self):
        run = self.command("run", PLATE, words=("--steps", "3"))
        self.assert_refused(run, "unknown option --steps", "--set loading.steps=3")
        self.assert_refused(self.command("run", PLATE, words=("--thraeds", "1")), "did you mean --threads?")

    def test_help_of_run_has_the_launchers_option(self):
        run = self.assert_completed(self.peristat("run", "--help"))
        self.assertIn("--no-plots", run.output)

    def test_an_interrupt_is_told_once(self):
        process = self.start([PROGRAM, "run", self.case(PLATE.replace("steps = 4", "steps = 1000000"))])
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
                self.assertIn(run.code, (0, 2), run.errors)
                if run.code == 0:
                    told += 1
                    json.loads(run.output, parse_constant=self.fail)  # NaN and Infinity
                    self.assertNotIn("nan", run.output)
                    self.assertNotIn("inf", run.output)
                else:
                    refused += 1
                    self.assertEqual(run.output, "")
        self.assertGreater(told, 20)
        self.assertGreater(refused, 20)

    def test_the_length_of_a_crack_is_no_matter_of_display(self):
        """A cut of 10 columns, and its display after the plate has torn: the same with either setting."""
        for lift, expected in (("1e-7", 0.010), ("1e-3", 0.040)):
            lengths = []
            for counted in ("true", "false"):
                text = PLATE.replace("LIFT", lift)
                summary = self.results(text, f"output.count_cracks={counted}", "solver.mode=adaptive").summary
                lengths.append(summary["probes"]["crack"])
                self.assertEqual(summary["broken_bonds"] > 0, lift == "1e-3")
            self.assertEqual(*lengths)
            # A tip is within a spacing of the last separated column.
            self.assertAlmostEqual(lengths[0], expected, delta=SPACING)


if __name__ == "__main__":
    unittest.main()
