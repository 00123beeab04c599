"""The pictures of a results folder: which exist, that they show something, and how bad folders end.

Run with /usr/bin/python3 tests/unit/cases/plot_test.py; it builds its own folders.
"""

import csv
import io
import json
import subprocess
import sys
import tempfile
import unittest
import warnings
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path
from unittest import mock

import h5py
import matplotlib.image
import numpy as np
from PIL import Image

PLOTS = Path(__file__).resolve().parents[3] / "cases" / "runner" / "plots"
sys.path.insert(0, str(PLOTS))

import plot  # noqa: E402
from cells import Cells, merged  # noqa: E402
from curve_pictures import hand_overs, observed_order, on_the_way  # noqa: E402
from field_pictures import deformed_plate  # noqa: E402
from results_folder import read_results_folder  # noqa: E402
from style import round_factor  # noqa: E402

SPACING = 1e-3
HISTORY = (
    "step,load_factor,mode,newton_iterations,relaxation_iterations,stored_energy,dissipated_energy,"
    "drained_energy,external_work,balance_error,broken_bonds,max_damage,max_stretch"
).split(",")
ITERATIONS = "step,iteration,residual,relative_residual,energy,step_length,linear_iterations,changed_bonds".split(",")

BROKEN_BONDS = ["step", "load_factor", "first_point", "second_point"]
CRACKED = ("deformed", "fields", "damage", "broken_bonds", "sequence", "load_displacement", "energies", "convergence")


def lattice(*counts: int) -> np.ndarray:
    """Cell centres of a box, count x dimension [m]."""
    grid = np.meshgrid(*[np.arange(count) for count in counts], indexing="ij")
    return (np.stack(grid, axis=-1).reshape(-1, len(counts)) + 0.5) * SPACING


def write_folder(folder: Path, reference: np.ndarray, steps: int = 3, damaged: bool = False,
                 strain: float = 0.01) -> None:  # fmt: skip
    """A results folder of a body stretched by 1 % in x, torn in the middle if damaged."""
    folder.mkdir()
    count, dimension = reference.shape
    x = reference[:, 0]
    middle = x.mean()
    with h5py.File(folder / "results.h5", "w") as file:
        file.attrs["title"] = "Synthetic body"
        file["points/reference"] = reference
        file["points/volume"] = np.full(count, SPACING**dimension)
        file["points/set_ids"] = np.stack([x < 2 * SPACING, x > x.max() - SPACING], axis=1).astype(np.uint8)
        file["points/set_ids"].attrs["sets"] = ["left", "right"]
        file["case/as_resolved"] = f"[lattice]\nspacing = {SPACING}\n[solver]\nrelative_tolerance = 1e-10\n"
        for step in range(1, steps + 1):
            displacement = np.zeros_like(reference)
            displacement[:, 0] = strain * x * step / steps
            for axis in range(1, dimension):  # contracts about its middle
                across = reference[:, axis] - reference[:, axis].mean()
                displacement[:, axis] = -0.3 * strain * across * step / steps
            group = file.create_group(f"steps/{step:06d}")
            group.attrs["load_factor"] = step / steps
            group.attrs["mode"] = "newton"
            group["displacement"] = displacement
            group["damage"] = np.where(damaged & (np.abs(x - middle) < SPACING) & (step > 1), 0.5, 0.0)
            group["force"] = np.zeros_like(reference)
            group["energy_density"] = 1e4 * (1.0 + reference[:, -1] / SPACING)
    with open(folder / "history.csv", "w", newline="") as file:
        table = csv.writer(file)
        sets = [f"reaction_{axis}:{name}" for name in ("left", "right") for axis in "xyz"]
        table.writerow(HISTORY + sets)
        for step in range(1, steps + 1):
            force = 1e3 * step / steps
            table.writerow([step, step / steps, "newton", 4] + [0] * 9 + [-force, 0, 0, force, 0, 0])
    with open(folder / "iterations.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow(ITERATIONS)
        for step in range(1, steps + 1):
            for iteration, residual in enumerate((1.0, 1e-2, 1e-5, 1e-11, 0.0)):
                table.writerow([step, iteration, residual, residual, 0, 1, 0, 0])
    (folder / "summary.json").write_text(json.dumps({"status": "completed"}))


def rewrite(path: Path, change) -> None:
    """Lets a function change the rows (dictionaries) of a CSV file."""
    with open(path, newline="") as file:
        table = csv.DictReader(file)
        names, rows = table.fieldnames, list(table)
    for row in rows:
        change(row)
    with open(path, "w", newline="") as file:
        table = csv.DictWriter(file, names)
        table.writeheader()
        table.writerows(rows)


def write_cracked_folder(folder: Path, counts: tuple[int, int], steps: int = 12) -> None:
    """A plate pulled in x: from half of the load on a crack runs up its middle and tears it in two.

    The steps of the crack are found by relaxation. A crumb beside the crack comes off near the end. Bonds reach
    over three points, stiffness falls with the crack's length, dissipated energy grows with it.
    """
    reference = lattice(*counts)
    write_folder(folder, reference, steps)
    x, y = (reference - [reference[:, 0].mean(), 0.0]).T / SPACING
    tip = [counts[1] * np.clip((step / steps - 0.5) / 0.35, 0.0, 1.0) for step in range(1, steps + 1)]
    number = {tuple(place): point for point, place in enumerate(np.rint(reference / SPACING - 0.5).astype(int))}
    broken = []
    for (i, j), point in number.items():
        for across, up in ((a, b) for a in range(1, 4) for b in range(-3, 4) if a * a + b * b < 9.1):
            end = number.get((i + across, j + up))
            if end is not None and x[point] < 0.0 <= x[end]:
                height = y[point] + (y[end] - y[point]) * x[point] / (x[point] - x[end])
                step = next((k + 1 for k in range(steps) if tip[k] > height), None)
                broken += [] if step is None else [(step, step / steps, point, end)]
    broken.sort()
    crumb = (x > 0.0) & (x < 6.0) & (abs(y - 0.4 * counts[1]) < 4.0)

    with h5py.File(folder / "results.h5", "a") as file:
        for step in range(1, steps + 1):
            group, load = file[f"steps/{step:06d}"], step / steps
            group.attrs["mode"] = "relaxation" if 0.0 < tip[step - 1] < counts[1] else "newton"
            opening = np.clip((tip[step - 1] - y) / 8.0, 0.0, 1.0) * load
            group["displacement"][:, 0] = 1e-3 * SPACING * counts[0] * (
                0.3 * x / counts[0] * load * (1 - opening) + np.sign(x) * (0.5 * opening - 0.1 * crumb * opening))
            group["damage"][...] = np.where(y < tip[step - 1], np.clip(0.5 - 0.16 * (abs(x) - 0.5), 0.0, 1.0), 0.0)
            group["fragment"] = np.where(crumb & (load > 0.8), 1, 0)
            group["stretch"] = 0.01 * opening
            if load > 0.8:
                group["damage"][...] = np.maximum(group["damage"][...], np.where(crumb, 0.3, 0.0))
        for column, values in zip(BROKEN_BONDS, zip(*broken)):
            file[f"broken_bonds/{column}"] = np.array(values)
    with open(folder / "broken_bonds.csv", "w", newline="") as file:
        csv.writer(file).writerows([BROKEN_BONDS, *broken])

    def fracture(row):
        step, load = int(row["step"]), float(row["load_factor"])
        share = tip[step - 1] / counts[1]
        force, stored = 5e4 * load * (1 - share) ** 0.7, 2.5 * load**2 * (1 - share)
        dissipated, drained = 0.5 * share, 0.7 * share**2
        row.update({
            "mode": "relaxation" if 0.0 < share < 1.0 else "newton", "max_damage": 0.6 * (share > 0.0),
            "broken_bonds": sum(bond[0] <= step for bond in broken), "stored_energy": stored,
            "dissipated_energy": dissipated, "drained_energy": drained, "balance_error": 1e-4 * load,
            "external_work": stored + dissipated + drained + 1e-4 * load,
            "reaction_x:left": -force, "reaction_x:right": force,
        })  # fmt: skip

    rewrite(folder / "history.csv", fracture)
    first, last = (next(step for step in range(steps) if tip[step] > height) for height in (0.0, counts[1] - 1e-9))
    with open(folder / "decisions.csv", "w", newline="") as file:
        table = csv.writer(file)
        table.writerow("step,load_factor,increment,outcome,action,next_increment,reason".split(","))
        for step in range(steps):
            for place, outcome, action in ((first, "unstable", "hand over to relaxation"),
                                           (last, "converged", "hand back to newton")):  # fmt: skip
                if step == place:
                    table.writerow([step + 1, (step + 1) / steps, 1 / steps, outcome, action, 1 / steps, "a test"])
            table.writerow([step + 1, (step + 1) / steps, 1 / steps, "converged", "accept", 1 / steps, ""])


class Pictures(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="peristat_plot_test_")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name) / "results"

    def plot(self, expected_code: int = 0) -> str:
        """Draws the folder's pictures, where a warning is an error too; gives what is said."""
        said = io.StringIO()
        with warnings.catch_warnings(), redirect_stdout(said), redirect_stderr(said):
            warnings.simplefilter("error")
            code = plot.main([str(self.folder)])
        self.assertEqual(code, expected_code, said.getvalue())
        return said.getvalue()

    def assert_pictures(self, *names: str) -> None:
        """Exactly these pictures exist, of a size to look at and with more than a few colours."""
        drawn = sorted(path.stem for path in (self.folder / "plots").glob("*.png"))
        self.assertTrue({f"{name}.png" for name in drawn} <= set(plot.PICTURES))
        self.assertEqual(drawn, sorted(names))
        for name in names:
            image = matplotlib.image.imread(self.folder / "plots" / f"{name}.png")
            height, width = image.shape[:2]
            self.assertTrue(900 <= width <= 2000 and 300 <= height <= 2200, f"{name}: {width} x {height}")
            colours = np.unique((image[::3, ::3, :3] * 255).astype(np.uint8).reshape(-1, 3), axis=0)
            self.assertGreater(len(colours), 30, name)

    def test_program_ends_with_the_code(self):
        program = [sys.executable, str(PLOTS / "plot.py")]
        write_folder(self.folder, lattice(6))
        for arguments, code in (([str(self.folder)], 0), ([str(self.folder / "none")], 2), ([], 2)):
            done = subprocess.run(program + arguments, capture_output=True, text=True)
            self.assertEqual(done.returncode, code, done.stderr)
            self.assertNotIn("Traceback", done.stderr)

    def test_bar(self):
        write_folder(self.folder, lattice(40))
        self.plot()
        self.assert_pictures("deformed", "load_displacement", "convergence")

    def test_plate(self):
        write_folder(self.folder, lattice(30, 10))
        self.plot()
        self.assert_pictures("deformed", "fields", "load_displacement", "convergence")

    def test_damaged_plate(self):
        write_folder(self.folder, lattice(30, 30), damaged=True)
        self.plot()
        self.assert_pictures("deformed", "fields", "damage", "sequence", "load_displacement", "convergence")

    def test_cracked_plate(self):
        write_cracked_folder(self.folder, (40, 30))
        self.assertIn("crack.gif", self.plot())
        self.assert_pictures(*CRACKED)
        with Image.open(self.folder / "plots" / "crack.gif") as animation:
            self.assertEqual(animation.n_frames, 12)
            self.assertTrue(700 <= animation.width <= 1200 and 300 <= animation.height <= 800)
            self.assertEqual(animation.convert("RGB").getpixel((2, 2)), (255, 255, 255))

    def test_elastic_plate_has_no_pictures_of_fracture(self):
        write_folder(self.folder, lattice(30, 10))
        self.plot()
        for name in ("damage.png", "broken_bonds.png", "sequence.png", "energies.png", "crack.gif"):
            self.assertFalse((self.folder / "plots" / name).exists(), name)

    def test_animation_of_many_points_and_steps_is_small(self):
        write_cracked_folder(self.folder, (160, 50), steps=100)
        self.plot()
        animation = self.folder / "plots" / "crack.gif"
        self.assertLess(animation.stat().st_size, 1_000_000)
        with Image.open(animation) as image:
            self.assertTrue(30 <= image.n_frames <= 60, image.n_frames)

    def test_animation_that_would_be_too_large_loses_frames(self):
        write_cracked_folder(self.folder, (40, 30))
        with mock.patch("crack_animation.MOST_BYTES", 60_000):
            self.plot()
        animation = self.folder / "plots" / "crack.gif"
        with Image.open(animation) as image:
            self.assertTrue(2 <= image.n_frames < 12)

    def test_animation_without_its_library_is_named(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        with mock.patch.dict(sys.modules, {"PIL": None}):
            sys.modules.pop("crack_animation", None)
            self.assertIn("python3-pil", self.plot())
        self.assert_pictures(*CRACKED)
        self.assertFalse((self.folder / "plots" / "crack.gif").exists())

    def test_cracked_plate_of_an_older_folder(self):
        """Without fragments, stretches, broken bonds, decisions, and with damage alone in the history."""
        write_cracked_folder(self.folder, (20, 20), steps=6)
        with h5py.File(self.folder / "results.h5", "a") as file:
            del file["broken_bonds"]
            for step in file["steps"].values():
                del step["fragment"], step["stretch"], step.attrs["mode"]
        for name in ("broken_bonds.csv", "decisions.csv"):
            (self.folder / name).unlink()
        unknown = ("broken_bonds", "dissipated_energy", "drained_energy", "external_work", "balance_error", "mode")
        rewrite(self.folder / "history.csv", lambda row: row.update(dict.fromkeys(unknown, "")))
        self.plot()
        self.assert_pictures(*sorted(set(CRACKED) - {"broken_bonds", "energies"}))

    def test_broken_bonds_are_read_from_either_file(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        results = read_results_folder(self.folder)
        ends, steps = results.broken_bonds()
        self.assertGreater(len(steps), 100)
        self.assertTrue((np.diff(steps) >= 0).all())
        x = results.reference[ends, 0]
        self.assertTrue(((x[:, 0] < 0.01) & (x[:, 1] > 0.01)).all())  # across the middle
        with h5py.File(self.folder / "results.h5", "a") as file:
            del file["broken_bonds"]
        for one, other in zip((ends, steps), results.broken_bonds()):
            np.testing.assert_array_equal(one, other)

    def test_broken_bonds_that_cannot_be_are_reported(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["broken_bonds/second_point"][:3] = 400  # one more than the last
        self.assertIn("do not exist", self.plot())
        with h5py.File(self.folder / "results.h5", "a") as file:
            del file["broken_bonds/second_point"]
            file["broken_bonds/second_point"] = np.zeros(2, dtype=int)  # not as many as the others
        self.assertIn("broken bonds can't be read", self.plot())

    def test_plate_all_of_which_floats_far_away(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000006/fragment"][:200] = 1
            file["steps/000006/fragment"][200:] = 2
            file["steps/000006/displacement"][:200, 0] -= 1.0
        self.plot()
        self.assert_pictures(*CRACKED)

    def test_crumb_that_flew_far_does_not_shrink_the_plate(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        results = read_results_folder(self.folder)
        step = results.step(6)
        before = deformed_plate(results, step, 1.0, step.damage).frame()
        step.displacement[step.floating] += 1.0
        low, high = deformed_plate(results, step, 1.0, step.damage).frame()
        self.assertGreater(step.floating.sum(), 10)
        for one, other in zip(before, (low, high)):
            np.testing.assert_allclose(one, other, rtol=0, atol=0.5 * SPACING)

    def test_cracked_plate_under_compression(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)

        def push(row):
            for name in ("left", "right"):
                row[f"reaction_x:{name}"] = -float(row[f"reaction_x:{name}"])

        rewrite(self.folder / "history.csv", push)
        self.plot()
        self.assert_pictures(*CRACKED)

    def test_cloud_with_pieces(self):
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                self.folder = self.folder.with_name(f"pieces_{dimension}")
                write_folder(self.folder, np.random.default_rng(5).uniform(0.0, 0.02, (300, dimension)), damaged=True)
                with h5py.File(self.folder / "results.h5", "a") as file:
                    file["steps/000003/fragment"] = np.arange(300) % 3
                self.plot()
                self.assertTrue((self.folder / "plots" / "damage.png").is_file())

    def test_energies_of_a_load_that_turns_are_drawn_over_steps(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)

        def turn(row):
            row["load_factor"] = 3.0 - abs(3.0 - float(row["step"]))

        rewrite(self.folder / "history.csv", turn)
        self.plot()
        self.assert_pictures(*CRACKED)

    def test_hand_overs_stand_between_the_steps_that_they_are_of(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        results = read_results_folder(self.folder)
        places = np.array([1.0, 2.0, 3.0, 5.0, 8.0, 9.0])  # m, of the six steps
        for action, step, place in (("hand over to relaxation", 4, 5.0), ("hand back to newton", 6, 9.0)):
            results.decisions = {}
            self.assertEqual(hand_overs(results, action), [(step, step / 6)])  # from the modes
            results.decisions = read_results_folder(self.folder).decisions
            self.assertEqual(hand_overs(results, action), [(step, step / 6)])
            self.assertAlmostEqual(on_the_way(results, places, step, step / 6), place, delta=1e-12)
        self.assertAlmostEqual(on_the_way(results, places, 5, 4.5 / 6), 6.5, delta=1e-12)
        self.assertAlmostEqual(on_the_way(results, places, 7, 7 / 6), 9.0, delta=1e-12)  # was never accepted

    def test_pictures_of_an_earlier_run_do_not_stay(self):
        write_folder(self.folder, lattice(10, 10))
        (self.folder / "plots").mkdir()
        for name in ("damage.png", "energies.png", "crack.gif"):
            (self.folder / "plots" / name).write_text("old")
        self.plot()
        self.assertFalse((self.folder / "plots" / "crack.gif").exists())
        self.assert_pictures("deformed", "fields", "load_displacement", "convergence")

    def test_solid(self):
        write_folder(self.folder, lattice(20, 5, 5))
        self.plot()
        self.assert_pictures("deformed", "load_displacement", "convergence")

    def test_solid_that_deforms_visibly(self):
        for planes in (4, 5):  # a plane in the middle, or two beside it
            with self.subTest(planes=planes):
                folder, self.folder = self.folder, self.folder.with_name(f"planes{planes}")
                write_folder(self.folder, lattice(12, 6, planes), strain=1.0)
                self.plot()
                self.assert_pictures("deformed", "lateral", "middle_plane", "load_displacement", "convergence")
                self.folder = folder

    def test_damaged_solid(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        self.plot()
        self.assert_pictures("deformed", "damage", "load_displacement", "convergence")

    def test_damaged_solid_with_a_floating_piece(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000003/fragment"] = (file["points/reference"][:, 0] > 0.008).astype(float)
        self.plot()
        self.assert_pictures("deformed", "damage", "load_displacement", "convergence")

    def test_points_that_are_no_lattice(self):
        for dimension in (2, 3):
            with self.subTest(dimension=dimension):
                self.folder = self.folder.with_name(f"cloud_{dimension}")
                cloud = np.random.default_rng(5).uniform(0.0, 0.02, (300, dimension))
                write_folder(self.folder, cloud)
                self.plot()
                self.assertTrue((self.folder / "plots" / "deformed.png").is_file())

    def test_a_single_point_that_does_not_move(self):
        for dimension in (1, 2, 3):
            with self.subTest(dimension=dimension):
                self.folder = self.folder.with_name(f"single_{dimension}")
                write_folder(self.folder, np.zeros((1, dimension)), steps=1)
                self.plot()
                self.assertTrue((self.folder / "plots" / "deformed.png").is_file())

    def test_many_points_are_averaged(self):
        write_folder(self.folder, lattice(320, 250), steps=1)
        self.plot()
        self.assert_pictures("deformed", "fields", "load_displacement", "convergence")

    def test_killed_run_draws_what_is_there(self):
        write_folder(self.folder, lattice(20, 10))
        (self.folder / "summary.json").unlink()
        history = self.folder / "history.csv"
        history.write_text(history.read_text()[:-20])  # the last row half written
        self.assertIn("summary.json", self.plot())
        self.assert_pictures("deformed", "fields", "load_displacement", "convergence")

    def test_run_without_an_accepted_step(self):
        write_folder(self.folder, lattice(20, 10), steps=0)
        self.assertIn("no step was accepted", self.plot())
        self.assert_pictures()

    def test_steps_without_their_part_are_passed_over(self):
        write_folder(self.folder, lattice(20, 10))
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000004"] = h5py.ExternalLink("parts/000004.h5", "/")
        self.assertIn("000004", self.plot())
        self.assertTrue((self.folder / "plots" / "deformed.png").is_file())

    def test_tables_that_are_gone_are_named(self):
        write_folder(self.folder, lattice(20, 10))
        (self.folder / "history.csv").unlink()
        (self.folder / "iterations.csv").unlink()
        said = self.plot()
        self.assertIn("history.csv", said)
        self.assertIn("iterations.csv", said)
        self.assert_pictures("deformed", "fields")

    def test_values_that_are_not_finite_are_reported(self):
        write_folder(self.folder, lattice(20, 10))
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000003/displacement"][0, 0] = np.nan
            file["steps/000003/energy_density"][0] = np.inf
        self.assertIn("not finite", self.plot())
        self.assertTrue((self.folder / "plots" / "deformed.png").is_file())

    def test_folder_that_does_not_exist_ends_with_code_2(self):
        self.assertIn("no such folder", self.plot(expected_code=2))

    def test_folder_without_results_ends_with_code_2(self):
        self.folder.mkdir()
        self.assertIn("results.h5", self.plot(expected_code=2))

    def test_file_that_is_no_hdf5_ends_with_code_2(self):
        self.folder.mkdir()
        (self.folder / "results.h5").write_text("no HDF5")
        self.assertIn("can't be read", self.plot(expected_code=2))

    def test_plots_folder_that_cannot_be_made_ends_with_code_2(self):
        write_folder(self.folder, lattice(5))
        (self.folder / "plots").write_text("a file")
        self.plot(expected_code=2)


class Parts(unittest.TestCase):
    def test_round_factor_is_the_largest_round_number_below(self):
        wanted = [0.3, 1.0, 1.9, 2.0, 4.9, 7.0, 10.0, 99.0, 2345.0, np.inf]
        self.assertEqual([round_factor(value) for value in wanted], [1, 1, 1, 2, 2, 5, 10, 50, 2000, 1])

    def test_observed_order_is_that_of_the_sequence(self):
        for order in (1.0, 1.5, 2.0):
            residuals = [0.1]
            while residuals[-1] > 1e-12 and len(residuals) < 30:
                residuals.append(0.3 * residuals[-1] ** order)
            self.assertAlmostEqual(observed_order(np.array(residuals)), order, places=6)

    def test_observed_order_ignores_round_off_and_zero(self):
        self.assertAlmostEqual(observed_order(np.array([1e-1, 1e-2, 1e-4, 1e-8, 3e-12, 0.0])), 2.0, places=12)
        self.assertIsNone(observed_order(np.array([1.0, 1e-12, 1e-13])))
        self.assertIsNone(observed_order(np.array([1.0, 1.0, 1.0])))

    def test_corners_follow_an_affine_deformation_exactly(self):
        generator = np.random.default_rng(3)
        for counts in ((4,), (4, 5), (3, 4, 5)):
            reference = lattice(*counts)
            gradient = generator.uniform(-0.5, 0.5, (len(counts), len(counts)))
            cells = Cells(reference, SPACING)
            self.assertTrue(cells.is_lattice)
            nobody = np.zeros(len(reference), dtype=bool)
            still = cells.corners(reference, np.zeros_like(reference), nobody)
            moved = cells.corners(reference, reference @ gradient, nobody)
            expected = still + still @ gradient
            # 1e-14 m is 1e-11 of a spacing: round-off of coordinates of a few spacings.
            np.testing.assert_allclose(moved, expected, rtol=0, atol=1e-14)

    def test_neighbouring_cells_share_corners_and_loose_cells_do_not(self):
        reference = lattice(2, 1)
        displacement = np.array([[0.0, 0.0], [0.3e-3, 0.0]])
        for loose, gap in ((False, 0.0), (True, 0.3e-3)):
            corners = Cells(reference, SPACING).corners(reference, displacement, np.full(2, loose))
            self.assertAlmostEqual(corners[1, 0, 0] - corners[0, 2, 0], gap, delta=1e-15)

    def test_perturbed_lattice_is_recognised(self):
        generator = np.random.default_rng(7)
        reference = lattice(12, 9) + generator.uniform(-0.3, 0.3, (108, 2)) * SPACING
        cells = Cells(reference, SPACING)
        self.assertTrue(cells.is_lattice)
        self.assertEqual(list(cells.index.max(axis=0)), [11, 8])

    def test_merged_points_keep_means_and_stay_few(self):
        reference = lattice(40, 20)
        spacing, places, values = merged(reference, SPACING, 100, reference[:, 0])
        self.assertTrue(0 < len(places) <= 100)
        self.assertAlmostEqual(spacing, 3 * SPACING)  # ceil(sqrt(800 / 100))
        whole = places[:, 0] < 0.039  # blocks of three columns; the last has one
        np.testing.assert_allclose(values[whole], places[whole, 0], rtol=0, atol=1e-15)


if __name__ == "__main__":
    unittest.main()
