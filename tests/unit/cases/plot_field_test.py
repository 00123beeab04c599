"""One field of one step by `plot --field`: which steps, components and parts, names of files, refusals.

Run with /usr/bin/python3 tests/unit/cases/plot_field_test.py; it builds its own folders.
"""

import io
import os
import sys
import tempfile
import unittest
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import h5py
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
from plot_test import SPACING, lattice, write_cracked_folder, write_folder  # noqa: E402

from peristat.errors import InputError  # noqa: E402
from peristat.pictures import command  # noqa: E402
from peristat.pictures.field_picture import View, in_common  # noqa: E402
from peristat.pictures.named_values import components, named_values  # noqa: E402
from peristat.pictures.results_folder import read_results_folder  # noqa: E402
from peristat.pictures.steps_by_name import steps_named  # noqa: E402


class Fields(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="peristat_plot_field_")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name) / "results"

    def plot(self, expected_code: int, *options: str) -> str:
        said = io.StringIO()
        with redirect_stdout(said), redirect_stderr(said):
            code = command.main([str(self.folder), *options])
        self.assertEqual(code, expected_code, said.getvalue())
        return said.getvalue()

    def names(self) -> list[str]:
        return sorted(name for name in os.listdir(self.folder / "plots") if not name.startswith("."))

    def test_names_of_files_tell_what_they_show(self):
        write_folder(self.folder, lattice(10, 8))
        self.assertIn("step 3", self.plot(0, "--field", "displacement"))
        self.plot(0, "--field", "displacement", "--component", "y", "--step", "first", "--deform", "none", "--style", "paper")
        self.plot(0, "--field", "damage", "--step", "2", "--zoom", "-1mm,5mm,1e-3,0.5cm", "--deform", "2.5", "--style", "paper",
                  "--column", "double", "--format", "pdf")  # fmt: skip
        drawn = ["damage_step_000002_zoom_times_2_5_paper_double.pdf", "displacement_step_000003.png",
                 "displacement_y_step_000001_undeformed_paper.png"]  # fmt: skip
        self.assertEqual(self.names(), drawn)
        self.assertEqual(sorted((self.folder / "plots/.pictures").read_text().split()), drawn)

    def test_other_pictures_stay_and_pictures_of_fields_too(self):
        write_folder(self.folder, lattice(10, 8))
        self.plot(0)
        before = self.names()
        self.plot(0, "--field", "damage")
        self.plot(0)
        self.assertEqual(self.names(), sorted([*before, "damage_step_000003.png"]))

    def test_a_file_of_somebody_else_is_not_replaced(self):
        write_folder(self.folder, lattice(10, 8))
        (self.folder / "plots").mkdir()
        mine = self.folder / "plots/damage_step_000003.png"
        mine.write_text("mine")
        self.assertIn("was not drawn by this command", self.plot(2, "--field", "damage"))
        self.assertEqual(mine.read_text(), "mine")

    def test_refusals_name_what_there_is(self):
        write_folder(self.folder, lattice(10, 8))
        for options, words in (
            (["--field", "damge"], "Did you mean 'damage'? There are damage, displacement, energy_density, force"),
            (["--field", "damage", "--step", "7"], "step 7 has no fields. There are 1 to 3."),
            (["--field", "damage", "--step", "lst"], "neither a number nor one of last, first, peak, all"),
            (["--field", "damage", "--component", "x"], "leave out the component"),
            (["--field", "displacement", "--component", "z"], "There are magnitude, x, y."),
            (["--field", "damage", "--zoom", "0,1"], "needs 4 numbers, xmin,xmax,ymin,ymax"),
            (["--field", "damage", "--zoom", "1,0,0,1"], "must be below"),
            (["--field", "damage", "--zoom", "5,6,5,6"], "no point of step 3 is there"),
            (["--field", "damage", "--zoom", "0,1,0,1in"], "is no length"),
            (["--field", "damage", "--deform", "-1"], "a factor from 0 on"),
            (["--step", "3"], "--step needs --field"),
            (["--column", "double"], "--column needs --style paper"),
            (["--style", "papr"], "invalid choice: 'papr'"),
            (["--paraview", "--field", "damage"], "leave out the other options"),
        ):
            with self.subTest(options=options):
                self.assertIn(words, self.plot(2, *options))
        self.assertFalse((self.folder / "plots").exists())

    def test_the_peak_is_the_step_of_the_largest_reaction(self):
        write_cracked_folder(self.folder, (20, 20), steps=12)
        results = read_results_folder(self.folder)
        largest = int(np.argmax(results.numbers("reaction_x:right"))) + 1
        self.assertTrue(1 < largest < 12)
        self.assertEqual(steps_named(results, "peak"), [largest])
        self.assertEqual(steps_named(results, "all"), list(range(1, 13)))
        results.step_numbers.remove(largest)
        with self.assertRaisesRegex(InputError, f"the peak is at step {largest}, which has no fields"):
            steps_named(results, "peak")
        results.history.clear()
        with self.assertRaisesRegex(InputError, "there is no peak"):
            steps_named(results, "peak")

    def test_all_steps_share_colours_and_factor(self):
        write_folder(self.folder, lattice(10, 8))
        results = read_results_folder(self.folder)
        view, whole = in_common(results, [1, 2, 3], "displacement", View("x"))
        values = named_values(results, 3, "displacement", "x").values
        np.testing.assert_allclose(whole[2:], [values.min() / 3.0, values.max()], rtol=1e-12)
        alone = [in_common(results, [step], "displacement", View("x"))[0].deform for step in (1, 2, 3)]
        self.assertEqual(view.deform, min(alone))
        self.assertLess(view.deform, max(alone))
        self.plot(0, "--field", "energy_density", "--step", "all")
        self.assertEqual(self.names(), [f"energy_density_step_{step:06d}.png" for step in (1, 2, 3)])

    def test_colours_are_those_of_the_part_that_is_shown(self):
        write_folder(self.folder, lattice(10, 8))
        results = read_results_folder(self.folder)
        values, step = named_values(results, 3, "displacement", "x"), results.step(3)
        shown = results.reference[:, 0] < 4.0 * SPACING
        colours = values.shades(step, None, shown)
        unit = {"µm": 1e-6, "mm": 1e-3}[colours.label.split("[")[1].strip("]")]
        self.assertAlmostEqual(colours.high * unit, values.values[shown].max(), delta=1e-12)

    def test_components_of_vectors_and_tensors(self):
        self.assertEqual(components("displacement", (2,), 2), ["magnitude", "x", "y"])
        self.assertEqual(components("stress", (3,), 2), ["xx", "yy", "xy"])
        self.assertEqual(components("strain", (6,), 3), ["xx", "yy", "zz", "xy", "yz", "xz"])
        self.assertEqual(components("cauchy_stress", (2, 2), 2), ["xx", "xy", "yx", "yy"])
        self.assertEqual(components("principal_stress", (3,), 3), ["1", "2", "3"])
        self.assertEqual(components("force", (3,), 3), ["magnitude", "x", "y", "z"])  # not the stress of a plate
        self.assertEqual(components("odd", (7,), 3), [])

    def test_values_are_those_of_the_component(self):
        write_folder(self.folder, lattice(6, 5))
        tensor = np.arange(30 * 4, dtype=float).reshape(30, 2, 2)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000003/cauchy_stress"], file["steps/000003/stress"] = tensor, tensor.reshape(30, 4)[:, :3]
            file["steps/000003/cauchy_stress"].attrs["unit"] = "Pa"
        results = read_results_folder(self.folder)
        np.testing.assert_array_equal(named_values(results, 3, "cauchy_stress", "yx").values, tensor[:, 1, 0])
        np.testing.assert_array_equal(named_values(results, 3, "stress", "xy").values, tensor[:, 1, 0])
        moved = results.step(3).displacement
        np.testing.assert_array_equal(named_values(results, 3, "displacement", "y").values, moved[:, 1])
        np.testing.assert_array_equal(named_values(results, 3, "displacement").values, np.linalg.norm(moved, axis=1))
        with self.assertRaisesRegex(InputError, "is a tensor: choose a component. There are xx, xy, yx, yy."):
            named_values(results, 3, "cauchy_stress")
        self.assertIn("cauchy_stress_xy_step_000003.png", self.plot(0, "--field", "cauchy_stress", "--component", "xy"))

    def test_values_that_are_not_finite_are_refused(self):
        write_folder(self.folder, lattice(6, 5))
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000003/damage"][4] = np.nan
        self.assertIn("not finite", self.plot(2, "--field", "damage"))

    def test_a_part_of_a_solid_and_of_a_bar(self):
        for counts, zoom in (((8, 4, 4), "0,3mm,0,1,0,1"), ((12,), "2mm,6mm")):
            self.folder = self.folder.with_name(f"body_{len(counts)}")
            write_folder(self.folder, lattice(*counts))
            self.plot(0, "--field", "energy_density", "--zoom", zoom, "--style", "talk", "--format", "svg")
            self.assertEqual(self.names(), ["energy_density_step_000003_zoom_talk.svg"])


if __name__ == "__main__":
    unittest.main()
