"""The pictures of a results folder: which are drawn, their content, and the handling of bad folders.

Run with /usr/bin/python3 tests/unit/cases/plot_test.py; it builds its own folders.
"""

import csv
import io
import json
import multiprocessing
import os
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

PYTHON = Path(__file__).resolve().parents[3] / "python"
sys.path.insert(0, str(PYTHON))

from peristat._folder_command import guarded  # noqa: E402
from peristat.pictures import command  # noqa: E402
from peristat.pictures.abscissa import abscissas, control_words, find_abscissa  # noqa: E402
from peristat.pictures.camera import Camera  # noqa: E402
from peristat.pictures.cells import Cells, merged  # noqa: E402
from peristat.pictures.convergence_picture import order_words  # noqa: E402
from peristat.pictures.crack_surface import crack_surface  # noqa: E402
from peristat.pictures.crack_surface_pictures import draw_crack_surface, draw_crack_surface_sequence  # noqa: E402
from peristat.pictures.energy_picture import draw_energies  # noqa: E402
from peristat.pictures.event_path_picture import draw_events  # noqa: E402
from peristat.pictures.figures import chosen_frames  # noqa: E402
from peristat.pictures.fracture_marks import hand_overs, on_the_way  # noqa: E402
from peristat.pictures.load_displacement_picture import draw_load_displacement  # noqa: E402
from peristat.pictures.named_values import named_values  # noqa: E402
from peristat.pictures.panels import number_of_columns  # noqa: E402
from peristat.pictures.path_picture import draw_path  # noqa: E402
from peristat.pictures.plane import deformed_plate  # noqa: E402
from peristat.pictures.ranges import beyond  # noqa: E402
from peristat.pictures.reactions import reactions  # noqa: E402
from peristat.pictures.resistance_picture import draw_resistances, resistances  # noqa: E402
from peristat.pictures.results_folder import read_results_folder  # noqa: E402
from peristat.pictures.separations import crosses, separate  # noqa: E402
from peristat.pictures.solid_pictures import draw_cut_solid  # noqa: E402
from peristat.pictures.state_words import step_words  # noqa: E402
from peristat.pictures.tip_picture import tip_speeds  # noqa: E402
from peristat.pictures.units import load_axis, round_factor  # noqa: E402
from peristat.pictures.voronoi import voronoi_cells  # noqa: E402

SPACING = 1e-3
HISTORY = (
    "step,load_factor,mode,newton_iterations,relaxation_iterations,stored_energy,dissipated_energy,"
    "drained_energy,external_work,balance_error,broken_bonds,max_damage,max_stretch"
).split(",")
ITERATIONS = "step,iteration,residual,relative_residual,energy,step_length,linear_iterations,changed_bonds".split(",")

BROKEN_BONDS = ["step", "load_factor", "first_point", "second_point", "second_image"]
PICTURES = {"deformed", "lateral", "middle_plane", "cut", "fields", "damage", "broken_bonds", "crack_surface", "sequence",
            "load_displacement", "energies", "convergence", "resistance"}  # fmt: skip
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
    """Changes the rows (dictionaries) of a CSV file by a function."""
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
    """A plate pulled in x: from half of the load on, a crack runs up its middle and tears it in two.

    The steps of the crack are found by relaxation. A small piece beside the crack comes off near the end. Bonds
    reach over three points, stiffness falls with the crack's length, dissipated energy grows with it.
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
                broken += [] if step is None else [(step, step / steps, point, end, 0)]
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

    def plot(self, expected_code: int = 0, *options: str) -> str:
        """Draws the folder's pictures, with warnings as errors; returns the output."""
        said = io.StringIO()
        with warnings.catch_warnings(), redirect_stdout(said), redirect_stderr(said):
            warnings.simplefilter("error")
            code = command.main([str(self.folder), *options])
        self.assertEqual(code, expected_code, said.getvalue())
        return said.getvalue()

    def assert_pictures(self, *names: str) -> None:
        """Exactly these pictures exist, with a reasonable size and more than a few colours."""
        drawn = sorted(path.stem for path in (self.folder / "plots").glob("*.png"))
        self.assertLessEqual(set(drawn), PICTURES)
        listed = (self.folder / "plots" / ".pictures").read_text().split()
        self.assertEqual(sorted(name for name in listed if name.endswith(".png")), [f"{name}.png" for name in drawn])
        self.assertEqual(drawn, sorted(names))
        for name in names:
            image = matplotlib.image.imread(self.folder / "plots" / f"{name}.png")
            height, width = image.shape[:2]
            self.assertTrue(900 <= width <= 2000 and 300 <= height <= 2200, f"{name}: {width} x {height}")
            colours = np.unique((image[::3, ::3, :3] * 255).astype(np.uint8).reshape(-1, 3), axis=0)
            self.assertGreater(len(colours), 30, name)

    def test_program_ends_with_the_code(self):
        program = [sys.executable, str(PYTHON / "peristat/pictures/__main__.py")]
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

    def test_a_plate_in_motion(self):
        write_folder(self.folder, lattice(30, 10))
        with h5py.File(self.folder / "results.h5", "a") as file:
            for group in file["steps"].values():
                group["velocity"] = np.full((300, 2), [3.0, 4.0])
        table = (self.folder / "history.csv").read_text().splitlines()
        table = [table[0] + ",kinetic_energy,time_step", *(row + ",1,1" for row in table[1:])]
        (self.folder / "history.csv").write_text("\n".join(table) + "\n")
        self.plot()
        for name in ("speed", "energy_decades"):
            with Image.open(self.folder / "plots" / f"{name}.png") as picture:
                self.assertGreater(len(set(picture.convert("RGB").getdata())), 100, name)
        write_folder(self.folder.with_name("still"), lattice(30, 10))
        command.draw(self.folder.with_name("still"), "png")
        self.assertFalse((self.folder.with_name("still") / "plots" / "speed.png").exists())

    def test_animation_of_many_points_and_steps_is_small(self):
        write_cracked_folder(self.folder, (160, 50), steps=100)
        self.plot()
        animation = self.folder / "plots" / "crack.gif"
        self.assertLess(animation.stat().st_size, 1_000_000)
        with Image.open(animation) as image:
            self.assertTrue(30 <= image.n_frames <= 60, image.n_frames)

    def test_animation_that_would_be_too_large_loses_frames(self):
        write_cracked_folder(self.folder, (40, 30))
        with mock.patch("peristat.pictures.crack_animation.MOST_BYTES", 60_000):
            self.plot()
        animation = self.folder / "plots" / "crack.gif"
        with Image.open(animation) as image:
            self.assertTrue(2 <= image.n_frames < 12)

    def test_animation_without_its_library_is_named(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        with mock.patch.dict(sys.modules, {"PIL": None}):
            sys.modules.pop("peristat.pictures.crack_animation", None)
            self.assertIn("python3-pil", self.plot())
        self.assert_pictures(*CRACKED)
        self.assertFalse((self.folder / "plots" / "crack.gif").exists())

    def test_cracked_plate_of_an_older_folder(self):
        """Without fragments, stretches, broken bonds, decisions; only the history has damage."""
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
        broken = results.broken_bonds()
        self.assertGreater(len(broken.steps), 100)
        self.assertTrue((np.diff(broken.steps) >= 0).all())
        x = results.reference[broken.points, 0]
        self.assertTrue(((x[:, 0] < 0.01) & (x[:, 1] > 0.01)).all())  # across the middle
        with h5py.File(self.folder / "results.h5", "a") as file:
            del file["broken_bonds"]
        for one, other in zip(broken, read_results_folder(self.folder).broken_bonds()):
            np.testing.assert_array_equal(one, other)

    def test_broken_bonds_that_cannot_be_are_reported(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["broken_bonds/second_point"][:3] = 400  # one more than the last
        self.assertIn("do not exist", self.plot())
        with h5py.File(self.folder / "results.h5", "a") as file:
            del file["broken_bonds/second_point"]
            file["broken_bonds/second_point"] = np.zeros(2, dtype=int)  # fewer than the others
        self.assertIn("broken bonds can't be read", self.plot())

    def write_cell(self, crack=""):
        """A plate of 8 x 6 points, half of a body about y = 0, and a cell that repeats along x."""
        write_folder(self.folder, lattice(8, 6), steps=1)
        with h5py.File(self.folder / "results.h5", "a") as file:
            kinds = [(mirror, period) for mirror in (1, -1) for period in (0, 1, -1) if (mirror, period) != (1, 0)]
            file["points/images/mirror"] = np.array([[1.0, mirror] for mirror, _ in kinds])
            file["points/images/shift"] = np.array([[8 * SPACING * period, 0.0] for _, period in kinds])
            del file["case/as_resolved"]
            file["case/as_resolved"] = (f"[lattice]\nspacing = {SPACING}\nhorizon_ratio = 3.015\n{crack}\n"
                                        '[[symmetry]]\naxis = "y"\nat = 0.0\n'
                                        f'[[period]]\naxis = "x"\nfrom = 0.0\nto = {8 * SPACING}\n')  # fmt: skip
            file["steps/000001/damage"][:3] = 0.3
        return {kind: number for number, kind in enumerate(kinds, 1)} | {(1, 0): 0}

    def break_bonds(self, rows):
        with h5py.File(self.folder / "results.h5", "a") as file:
            names = ("step", "load_factor", "first_point", "second_point", "second_image")
            for name, column in zip(names, np.array([(1, 1, *row) for row in rows]).T):
                file[f"broken_bonds/{name}"] = column

    def test_bonds_across_planes_and_periods_end_at_images(self):
        kind = self.write_cell()
        self.break_bonds([(0, 6, kind[-1, 0]), (1, 0, kind[-1, 0]), (42, 0, kind[1, 1]), (0, 42, kind[1, -1]), (0, 42, kind[-1, -1])])
        results = read_results_folder(self.folder)
        ends = results.broken_bonds().ends(results.reference, results.image_kinds) / SPACING
        np.testing.assert_allclose(ends, [[[0.5, 0.5], [1.5, -0.5]], [[0.5, 1.5], [0.5, -0.5]], [[7.5, 0.5], [8.5, 0.5]],
                                          [[0.5, 0.5], [-0.5, 0.5]], [[0.5, 0.5], [-0.5, -0.5]]])  # fmt: skip
        self.assertEqual(results.sides, [(1, 0.0), (0, 0.0), (0, 8 * SPACING)])
        self.assertIn("broken_bonds.png", self.plot())

    def test_bonds_to_images_part_the_rim_and_no_neighbours(self):
        kind = self.write_cell()
        across = [(6 * i, 6 * i, kind[-1, 0]) for i in range(3)]  # one cell to its own image
        behind = [(6 * i + a, 6 * i + b, kind[-1, 0]) for i in range(2) for a, b in ((0, 1), (1, 0))]
        self.break_bonds(across + behind)
        results = read_results_folder(self.folder)
        step = results.step(1)
        cells = deformed_plate(results, step, 1.0, step.damage).cells
        self.assertEqual(np.flatnonzero(cells.parted(1, -1)).tolist(), [0, 6])  # the third has other bonds left
        self.assertEqual(sum(cells.parted(axis, sign).sum() for axis in (0, 1) for sign in (-1, 1)), 2)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["broken_bonds/second_image"][...] = 0  # within the body: points with themselves, neighbours
        results = read_results_folder(self.folder)
        cells = deformed_plate(results, step, 1.0, step.damage).cells
        self.assertEqual(cells.parted(1, -1).sum(), 0)

    def test_a_bond_over_the_rim_holds_cells_together(self):
        for holds in (True, False):
            with self.subTest(holds=holds):
                self.folder = self.folder.with_name(f"rim_{holds}")
                kind = self.write_cell()
                # The cells next to both ends of a row from those behind them: in the row, and over the period.
                rows = [(0, 6, 0), (0, 12, 0), (36, 42, 0), (30, 42, 0)]
                self.break_bonds(rows if holds else [*rows, (6, 42, kind[1, -1]), (36, 0, kind[1, 1])])
                results = read_results_folder(self.folder)
                step = results.step(1)
                cells = deformed_plate(results, step, 1.0, step.damage).cells
                self.assertEqual(np.flatnonzero(cells.parted(0, 1)).tolist(), [] if holds else [0, 36])

    def test_a_crack_that_leaves_a_cell_comes_in_again(self):
        self.write_cell(f"[[crack]]\nfrom = [{-2 * SPACING}, {2 * SPACING}]\nto = [{3 * SPACING}, {2 * SPACING}]")
        results = read_results_folder(self.folder)
        np.testing.assert_allclose([crack[:, 0] / SPACING for crack in results.cracks if crack[0, 1] > 0], [[-2, 3], [6, 11]])
        step = results.step(1)
        cells = deformed_plate(results, step, 1.0, step.damage).cells
        x, y = results.reference.T / SPACING
        np.testing.assert_array_equal(cells.parted(1, 1), (y == 1.5) & ((x < 3) | (x > 6)))

    def test_a_pre_crack_on_a_side_parts_the_rim(self):
        self.write_cell(f"[[crack]]\nfrom = [0.0, {-SPACING}]\nto = [0.0, {2 * SPACING}]")
        (self.folder / "broken_bonds.csv").write_text(",".join(BROKEN_BONDS) + "\n")
        results = read_results_folder(self.folder)
        step = results.step(1)
        cells = deformed_plate(results, step, 1.0, step.damage).cells
        self.assertEqual(np.flatnonzero(cells.parted(0, -1)).tolist(), [0, 1])
        self.assertEqual(np.flatnonzero(cells.parted(0, 1)).tolist(), [42, 43])  # the same crack, a period on

    def test_images_that_make_no_sense_are_reported(self):
        kind = self.write_cell()
        self.break_bonds([(0, 6, kind[-1, 0]), (0, 6, len(kind))])
        self.assertIn("broken bonds of points or images that do not exist", self.plot())
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["points/images/shift"][0] = np.inf
        self.assertIn("the images of points can't be read", self.plot())

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

    def with_resistance(self, place):
        """A cracked plate with probes of the resistance, and one more field."""
        write_cracked_folder(self.folder, (20, 20), steps=12)
        probes = "".join(f'[[probe]]\nname = "{name}"\nset = "left"\nfield = "{field}"\n'
                         for name, field in (("taken", "crack_resistance"), ("far", place)))  # fmt: skip
        with h5py.File(self.folder / "results.h5", "a") as file:
            del file["case/as_resolved"]
            file["case/as_resolved"] = (f"[lattice]\nspacing = {SPACING}\n[material.damage]\nfracture_energy = 30\n" + probes)

        path = self.folder / "history.csv"
        with open(path, newline="") as file:
            rows = list(csv.reader(file))
        for k, row in enumerate(rows):
            row += ["taken", "far"] if k == 0 else [30.0 * (k % 2) * (k > 3), 1e-3 * k]
        with open(path, "w", newline="") as file:
            csv.writer(file).writerows(rows)

    def test_resistance_is_drawn_over_the_length_of_its_crack(self):
        self.with_resistance("crack_length")
        self.plot()
        self.assert_pictures(*sorted({*CRACKED, "resistance"}))
        results = read_results_folder(self.folder)
        [(probe, place)] = resistances(results)
        self.assertEqual((probe["name"], place["name"]), ("taken", "far"))
        axes = draw_resistances(results, [(probe, place)]).axes[0]
        curve, asked = axes.get_lines()
        np.testing.assert_allclose(curve.get_xdata(), [5, 7, 9, 11], rtol=1e-12)  # mm
        np.testing.assert_allclose(curve.get_ydata(), 30.0, rtol=1e-12)
        np.testing.assert_allclose(asked.get_ydata(), 30.0, rtol=1e-12)

    def test_speeds_of_tips_are_slopes(self):
        times = np.linspace(0.0, 1e-5, 41)
        at, speeds = tip_speeds(times, 0.05 + 1e-3 * np.floor(2000.0 * times / 1e-3 + 1e-9), 4e-3)
        np.testing.assert_allclose(speeds, 2000.0, rtol=0.05)  # though the tip advances a spacing at a time
        self.assertTrue(0.0 < at.min() and at.max() < 1e-5)
        self.assertEqual(len(tip_speeds(times, np.full(41, 0.05), 4e-3)[0]), 0)  # it never moves

    def test_resistance_without_a_length_is_named(self):
        self.with_resistance("damage")
        self.assertIn("no resistance of taken", self.plot())
        self.assert_pictures(*CRACKED)

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
        self.assertAlmostEqual(on_the_way(results, places, 7, 7 / 6), 9.0, delta=1e-12)  # never accepted

    def write_events(self, **columns):
        """A run of mode path whose six steps snap back at the third and return to its load with the fifth."""
        write_folder(self.folder, lattice(20, 10), steps=6)
        rows = {"mode": ["path"] * 6, "load_factor": [0.2, 0.4, 0.3, 0.35, 0.4, 1.0],
                "reaction_x:right": [2e3, 4e3, 2.5e3, 2.8e3, 3e3, 5e3], "on_response": [1, 1, 0, 0, 1, 1],
                "released_energy": [0, 0, 0, 0, 0.3, 0.3], **columns}  # fmt: skip
        with open(self.folder / "history.csv", newline="") as file:
            history = list(csv.DictReader(file))
        history = [row | {name: values[k] for name, values in rows.items()} for k, row in enumerate(history)]
        with open(self.folder / "history.csv", "w", newline="") as file:
            table = csv.DictWriter(file, list(history[0]))
            table.writeheader()
            table.writerows(history)

    def test_a_path_from_event_to_event_is_drawn_beside_its_response(self):
        self.write_events()
        self.plot()
        self.assertIn("path.png", os.listdir(self.folder / "plots"))
        path, released = draw_events(read_results_folder(self.folder)).axes
        drawn = {line.get_label(): line.get_xydata().tolist() for line in path.lines}
        # Over the displacement of the support that moves most, which grows from step to step here.
        self.assertEqual([y for _, y in drawn["equilibrium path"]], [0, 2, 4, 2.5, 2.8, 3, 5])
        self.assertEqual([y for _, y in drawn["response under the given loads"]], [0, 2, 4, 3, 5])
        self.assertEqual([y for _, y in drawn["peak: 5 kN"]], [5])
        self.assertEqual(released.lines[0].get_ydata().tolist(), [0, 0, 0, 300, 300])
        self.assertIn("[mJ]", released.get_ylabel())

    def test_a_path_that_releases_nothing_is_drawn_alone(self):
        self.write_events(released_energy=[0] * 6)
        self.assertEqual(len(draw_events(read_results_folder(self.folder)).axes), 1)

    def results_with(self, columns, as_resolved="", change=lambda file: None):
        """A plate whose history has further columns, and whose case has further tables."""
        write_folder(self.folder, lattice(6, 6))
        with open(self.folder / "history.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        with open(self.folder / "history.csv", "w", newline="") as file:
            table = csv.DictWriter(file, dict.fromkeys([*rows[0], *columns]))
            table.writeheader()
            table.writerows(row | {name: values[place] for name, values in columns.items()} for place, row in enumerate(rows))
        with h5py.File(self.folder / "results.h5", "r+") as file:
            text = file["case/as_resolved"][()].decode() + as_resolved
            del file["case/as_resolved"]
            file["case/as_resolved"] = text
            change(file)
        return read_results_folder(self.folder)

    def test_under_control_reactions_are_drawn_over_what_is_controlled(self):
        results = self.results_with({"control": [1e-6, 2e-6, 3e-6], "negative_pivots": [0, 0, 1], "reaction_x:right": [1, 2, 9e4]})
        over = draw_load_displacement(results).axes[0]
        self.assertEqual(over.get_xlabel(), "controlled displacement [µm]")
        np.testing.assert_allclose(over.lines[0].get_xdata(), [0, 1, 2, 3])
        _, reaction = draw_path(results).axes
        self.assertIn("reaction of “right”", reaction.get_ylabel())  # the largest, not the first

    def test_small_load_factors_have_a_power_of_ten(self):
        self.assertEqual(load_axis(np.array([1.0, -2.0])), ("load factor", 1.0))
        label, size = load_axis(np.array([1.7e-5, 0.0]))
        self.assertEqual((label, round(np.log10(size))), ("load factor [$10^{-6}$]", -6))

    def test_a_constraint_has_a_force_and_no_direction(self):
        tie = {f"reaction_{axis}:tie": [value] * 3 for axis, value in zip("xyz", (-5e3, 0, 0))}
        results = self.results_with(tie, '[[constraint]]\nname = "tie"\n')
        self.assertIn("constraint “tie”", [curve.label for curve in reactions(results)])

    def test_grips_that_part_are_drawn_over_their_distance(self):
        pulled = "".join(f'[[support]]\nset = "{name}"\ndisplacement = ["{sign}1e-5*load", "free"]\n'
                         for name, sign in (("left", "-"), ("right", "")))  # fmt: skip

        def part(file):
            for step in file["steps"].values():
                moved = step["displacement"][()]
                moved[:, 0] -= moved[:, 0].mean()
                step["displacement"][...] = moved

        results = self.results_with({}, pulled, part)
        found = find_abscissa(results, reactions(results))
        mean = lambda name: results.displacement(3)[results.sets[name], 0].mean()
        self.assertIn("less that of", found.label)
        self.assertAlmostEqual(found.values[-1], mean("right") - mean("left"))

    def test_panels_of_a_sequence_leave_no_half_of_it_empty(self):
        for count in range(2, 7):
            for aspect in (0.1, 0.25, 0.5, 1.0, 3.0):
                columns = number_of_columns(count, aspect, 11.0)
                self.assertLessEqual(-count % columns, columns / 3, (count, aspect))
        self.assertEqual(number_of_columns(4, 0.25, 11.0), 2)  # a beam
        self.assertEqual(number_of_columns(6, 1.0, 11.0), 3)  # a square
        self.assertEqual(number_of_columns(6, 1.0, 5.0), 2)  # in a column of a paper

    # ---- files that are written and removed --------------------------------------------------------

    def test_pictures_drawn_before_go_and_others_stay(self):
        write_folder(self.folder, lattice(10, 10))
        plots = self.folder / "plots"
        plots.mkdir()
        outside = self.folder.parent / "outside.png"
        outside.write_text("mine")
        (plots / "linked.png").symlink_to(outside)
        for name in ("damage.png", "crack.gif", "mine.png", "old.pdf"):
            (plots / name).write_text("old")
        names = ["damage.png", "crack.gif", "linked.png", "old.pdf", "../history.csv", "../outside.png", "/etc/x.png"]
        (plots / ".pictures").write_text("\n".join(names))
        self.plot()
        for name, stays in (("damage.png", False), ("crack.gif", False), ("mine.png", True), ("old.pdf", True),
                            ("linked.png", True), ("../history.csv", True)):  # fmt: skip
            self.assertEqual((plots / name).exists(), stays, name)
        self.assertEqual(outside.read_text(), "mine")

    def test_a_picture_of_somebody_else_is_not_replaced(self):
        write_folder(self.folder, lattice(10, 10))
        (self.folder / "plots").mkdir()
        mine = self.folder / "plots" / "deformed.png"
        mine.write_text("mine")
        self.assertIn("was not drawn by this command", self.plot(expected_code=2))
        self.assertEqual(mine.read_text(), "mine")

    def test_a_fault_of_the_program_is_not_told_as_a_damaged_folder(self):
        write_folder(self.folder, lattice(10, 10))
        with mock.patch("peristat.pictures.command.drawings", side_effect=NameError("name '_cut' is not defined")):
            with redirect_stderr(io.StringIO()):
                self.assertEqual(command.main([str(self.folder)]), 1)

    def test_a_picture_replaces_a_link_and_not_what_it_leads_to(self):
        write_folder(self.folder, lattice(10, 10))
        (self.folder / "plots").mkdir()
        victim = self.folder.parent / "victim"
        victim.write_text("mine")
        (self.folder / "plots" / "deformed.png").symlink_to(victim)
        self.plot()
        self.assertEqual(victim.read_text(), "mine")
        self.assertFalse((self.folder / "plots" / "deformed.png").is_symlink())

    def test_plots_or_its_list_that_are_links_are_refused(self):
        write_folder(self.folder, lattice(10, 10))
        elsewhere = self.folder.parent / "elsewhere"
        elsewhere.mkdir()
        (self.folder / "plots").symlink_to(elsewhere)
        self.assertIn("is a link", self.plot(expected_code=2))
        self.assertEqual(list(elsewhere.iterdir()), [])
        (self.folder / "plots").unlink()
        (self.folder / "plots").mkdir()
        (elsewhere / "list").write_text("deformed.png")
        (self.folder / "plots" / ".pictures").symlink_to(elsewhere / "list")
        self.assertIn("is a link", self.plot(expected_code=2))
        self.assertEqual((elsewhere / "list").read_text(), "deformed.png")

    def test_vector_formats(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        self.plot()
        for ending, beginning in (("pdf", b"%PDF"), ("svg", b"<?xml")):
            self.plot(0, "--format", ending)
            for name in CRACKED:
                content = (self.folder / "plots" / f"{name}.{ending}").read_bytes()
                self.assertTrue(content.startswith(beginning), name)
            self.assertTrue((self.folder / "plots" / "deformed.png").exists())  # from the same run, and still valid
        self.plot(2, "--format", "jpg")

    def test_the_script_for_paraview(self):
        write_folder(self.folder, lattice(10, 10))
        script = self.folder / "plots" / "show_in_paraview.py"
        self.assertIn("no results.xdmf", self.plot(2, "--paraview"))
        self.assertFalse(script.exists())
        (self.folder / "results.xdmf").write_text("<Xdmf/>")
        for _ in range(2):  # it may be written again
            self.assertIn(f"paraview --script={script}", self.plot(0, "--paraview"))
        self.assertEqual([path.name for path in script.parent.iterdir() if path.suffix != ""], [script.name])
        text = script.read_text()
        compile(text, script.name, "exec")
        self.assertIn(f"FOLDER = {str(self.folder.resolve())!r}  #", text)
        script.unlink()
        (self.folder / "plots" / ".pictures").unlink()
        script.write_text("somebody's own")
        self.assertIn("was not drawn by this command", self.plot(2, "--paraview"))
        self.assertEqual(script.read_text(), "somebody's own")

    # ---- cracks -----------------------------------------------------------------------------------

    def test_a_pre_crack_opens_without_damage(self):
        """Points left and right of a cut move apart: no square is stretched across it, for any damage."""
        write_folder(self.folder, lattice(10, 6), steps=1)
        with h5py.File(self.folder / "results.h5", "a") as file:
            x, y = file["points/reference"][...].T / SPACING
            file["steps/000001/displacement"][...] = 0.0
            opening = np.where(y < 3.0, 0.5 * SPACING, 0.0)
            file["steps/000001/displacement"][:, 0] = np.where(x > 5.0, opening, 0.0)
            del file["case/as_resolved"]
            file["case/as_resolved"] = (
                f"[lattice]\nspacing = {SPACING}\nhorizon_ratio = 3.015\n"
                f"[[crack]]\nfrom = [{5 * SPACING}, -1.0]\nto = [{5 * SPACING}, {3 * SPACING}]\n"
            )
        results = read_results_folder(self.folder)
        step = results.step(1)
        plate = deformed_plate(results, step, 1.0, step.damage)
        cut = plate.cells.parted(0, 1)
        self.assertEqual(cut.sum(), 3)
        np.testing.assert_allclose(results.reference[cut, 0], 4.5 * SPACING)
        at_cut = (y < 1.0) & ((np.abs(x - 4.5) < 0.1) | (np.abs(x - 5.5) < 0.1))
        widths = np.ptp(plate.moved[at_cut][:, :, 0], axis=1)
        np.testing.assert_allclose(widths, SPACING, rtol=1e-12)  # they have moved rigidly

    def test_broken_bonds_part_cells_and_single_ones_do_not(self):
        reference = lattice(8, 4)
        number = {tuple(place): point for point, place in enumerate(np.rint(reference / SPACING - 0.5).astype(int))}
        across = [(number[i, j], number[k, j]) for j in range(4) for i in (2, 3) for k in (4, 5) if k - i < 3]
        for broken, parted in ((across, 4), ([pair for pair in across if pair[1] - pair[0] < 5], 0)):
            cells = Cells(reference, SPACING)
            separate(cells, reference, [], np.array(broken), reach=3)
            self.assertEqual(cells.parted(0, 1).sum(), parted)
            self.assertEqual(cells.parted(1, 1).sum(), 0)

    def test_lines_that_meet_a_crack(self):
        segment = np.array([[0.0, 0.0], [2.0, 0.0]])
        lines = np.array([
            [[1, -1], [1, 1]], [[2, -1], [2, 1]], [[2.001, -1], [2.001, 1]], [[1, 0], [1, 1]], [[1, 0.1], [1, 1]],
            [[-1, 0], [0, 0]], [[-2, 0], [-1, 0]], [[0, 0.5], [1, 0.5]],
        ], dtype=float)  # fmt: skip
        expected = [True, True, False, True, False, True, False, False]
        self.assertEqual(crosses(lines[:, 0], lines[:, 1], segment).tolist(), expected)
        polygon = np.array([[0, 0, 1], [2, 0, 1], [2, 2, 1], [1, 0.5, 1], [0, 2, 1]], dtype=float)  # not convex
        starts = np.array([[0.3, 0.5, 0], [1.0, 1.5, 0], [1.0, 0.2, 0], [0.3, 0.5, 1.2], [3, 0.5, 0]])
        ends = starts + [0.0, 0.0, 1.5]
        self.assertEqual(crosses(starts, ends, polygon).tolist(), [True, False, True, False, False])

    def test_frames_are_spent_on_damage(self):
        write_cracked_folder(self.folder, (30, 20), steps=40)
        results = read_results_folder(self.folder)
        frames = chosen_frames(results)
        self.assertTrue(3 <= len(frames) <= 6)
        self.assertEqual(frames[-1], 40)
        for frame in frames:
            self.assertGreater(results.in_history(frame, "broken_bonds"), 0)
        grown = [results.in_history(frame, "broken_bonds") for frame in frames]
        # Six frames of a crack that runs evenly: it grows by at most a third between two of them.
        self.assertLess(max(np.diff(grown)), grown[-1] / 3)

    # ---- curves -----------------------------------------------------------------------------------

    def test_opposite_reactions_are_drawn_once_and_zero_ones_not(self):
        write_folder(self.folder, lattice(10, 10))
        results = read_results_folder(self.folder)
        count = len(results.history["step"])
        results.history |= {f"reaction_{axis}:roller": [1e-9] * count for axis in "xyz"}
        curves = reactions(results)
        self.assertEqual([curve.name for curve in curves], ["right"])  # whose reaction is positive
        self.assertEqual(curves[0].others, ["“left” opposite"])
        self.assertGreater(curves[0].values[-1], 0.0)
        results.case["support"] = [{"set": "left", "displacement": ["-1e-5*load", "free"]}]
        self.assertEqual([curve.name for curve in reactions(results)], ["left"])  # the driven one

    def test_the_displacement_is_that_of_the_driven_support(self):
        write_folder(self.folder, lattice(10, 10))
        results = read_results_folder(self.folder)
        results.case |= {
            "support": [{"set": "left", "displacement": [0, 0]},
                        {"set": "right", "displacement": ["1e-5*load", "free"]}],
            "probe": [{"name": "waist", "set": "middle"}, {"name": "temperature", "set": "right", "field": "damage"}],
        }  # fmt: skip
        steps = len(results.history["step"])
        results.history |= {"waist_x": [7.0] * steps, "waist_y": [8.0] * steps, "temperature": [9.0] * steps}
        found = find_abscissa(results, reactions(results))
        self.assertIn("“right” in x", found.label)
        self.assertEqual(found.of_set, "right")
        np.testing.assert_allclose(found.values[-1], 0.01 * 9.5 * SPACING, rtol=1e-12)
        results.case["probe"].append({"name": "end", "set": "right"})
        results.history |= {"end_x": [-1.0, -2.0, -3.0], "end_y": [50.0] * steps}
        found = find_abscissa(results, reactions(results))
        self.assertEqual(found.label, "probe end: mean displacement of “right” in −x")
        self.assertEqual(found.values.tolist(), [1.0, 2.0, 3.0])
        results.history |= {"displacement_x:right": [0.1, 0.2, 0.3]}
        found = find_abscissa(results, reactions(results))
        self.assertEqual((found.label, found.values.tolist()), ("displacement of “right” in x", [0.1, 0.2, 0.3]))

    def test_what_is_loaded_needs_no_probe(self):
        write_folder(self.folder, lattice(10, 10))
        results = read_results_folder(self.folder)
        results.case |= {"load": [{"side": "y+", "traction": ["0", "-1e8*load"]}]}
        results.history |= {"displacement_y:y+": [-0.1, -0.2, -0.3], "force_y:y+": [-1.0, -2.0, -3.0]}
        found = find_abscissa(results, reactions(results))
        self.assertEqual((found.label, found.values.tolist()), ("displacement of “y+” in −y", [0.1, 0.2, 0.3]))

    def test_a_load_factor_that_is_a_displacement_has_a_unit(self):
        write_folder(self.folder, lattice(10, 10))
        results = read_results_folder(self.folder)
        self.assertEqual(step_words(results, results.step(3)), ["load factor 1", "step 3"])
        results.history |= {"displacement_y:right": list(-results.numbers("load_factor"))}
        self.assertEqual(step_words(results, results.step(3)), ["prescribed displacement 1 m", "step 3"])
        results.history["control"] = [1e-6, 2e-6, 3e-6]
        self.assertEqual(step_words(results, results.step(2)), ["controlled displacement 2 µm", "step 2"])

    def test_dead_loads_are_drawn_over_the_loaded_set(self):
        write_folder(self.folder, lattice(10, 10))
        results = read_results_folder(self.folder)
        steps = len(results.history["step"])
        results.case |= {
            "load": [{"set": "tip", "body_force": ["0", "-1e8*load"]}],
            "probe": [{"name": "other", "set": "left"}, {"name": "tip", "set": "tip"}],
        }
        results.history |= {f"{name}_{axis}": [value] * steps for name, value in (("other", 9.0), ("tip", -1.0))
                            for axis in "xy"}  # fmt: skip
        self.assertIn("“tip” in −y", find_abscissa(results, reactions(results)).label)

    def test_orders_are_those_of_the_table(self):
        write_folder(self.folder, lattice(10, 10))
        self.assertEqual(read_results_folder(self.folder).orders, {})
        table = self.folder / "convergence.csv"
        table.write_text("iteration,step_1,step_2,step_3\n0,1,1,1\n1,0.1,0.1,\nobserved_order,1.95,,1.97\n")
        orders = read_results_folder(self.folder).orders
        self.assertEqual(orders, {1: 1.95, 3: 1.97})
        self.assertEqual(order_words(orders, 3), ["order 1.95 to 1.97 in 2 of 3 increments"])
        self.assertEqual(order_words({}, 3), [])
        table.write_text("iteration,step_1\n0,1\nobserved_order,\n")
        self.assertEqual(read_results_folder(self.folder).orders, {})
        self.plot()

    def test_columns_that_are_new_change_nothing(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        path = self.folder / "history.csv"
        rows = list(csv.reader(path.read_text().splitlines()))
        for row, cells in zip(rows, [["numerical_work", "settled", "words"]] + [["0.5", "1", "a word"]] * 6):
            row[5:5] = cells
        with open(path, "w", newline="") as file:
            csv.writer(file).writerows(rows)
        self.plot()
        self.assert_pictures(*CRACKED)

    def test_pieces_do_not_set_the_scale(self):
        write_cracked_folder(self.folder, (20, 20), steps=6)
        results = read_results_folder(self.folder)
        step = results.step(6)
        held = np.linalg.norm(step.displacement[~step.floating], axis=1).max()
        with h5py.File(self.folder / "results.h5", "a") as file:
            moved = file["steps/000006/displacement"][...]
            moved[step.floating] += 1.0
            file["steps/000006/displacement"][...] = moved
        colours = named_values(results, 6, "displacement").shades(step)
        size = {"[µm]": 1e-6, "[mm]": 1e-3}[colours.label.split()[-1]]
        self.assertAlmostEqual(colours.high * size, held, delta=1e-12 * held)
        self.assertEqual(beyond(colours.values, colours.low, colours.high), "max")  # the colour bar shows that there is more

    def test_solid(self):
        write_folder(self.folder, lattice(20, 5, 5))
        self.plot()
        self.assert_pictures("deformed", "cut", "load_displacement", "convergence")

    def test_solid_that_deforms_visibly(self):
        for planes in (4, 5):  # a plane in the middle, or two beside it
            with self.subTest(planes=planes):
                folder, self.folder = self.folder, self.folder.with_name(f"planes{planes}")
                write_folder(self.folder, lattice(12, 6, planes), strain=1.0)
                self.plot()
                self.assert_pictures("deformed", "cut", "lateral", "middle_plane", "load_displacement", "convergence")
                self.folder = folder

    def test_damaged_solid(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        self.plot()
        self.assert_pictures("deformed", "cut", "damage", "crack_surface", "sequence", "load_displacement", "convergence")

    def test_damaged_solid_with_a_floating_piece(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000003/fragment"] = (file["points/reference"][:, 0] > 0.008).astype(float)
        self.plot()
        self.assert_pictures("deformed", "cut", "damage", "crack_surface", "sequence", "load_displacement", "convergence")

    def write_torn_solid(self, crack=""):
        """A block of 8 x 4 x 3 cells, torn in its middle from below in three steps; the first step has no damage."""
        reference = lattice(8, 4, 3)
        write_folder(self.folder, reference, steps=4, damaged=True)
        place = np.rint(reference / SPACING - 0.5).astype(int)
        number = {tuple(index): point for point, index in enumerate(place)}
        with h5py.File(self.folder / "results.h5", "a") as file:
            rows = [(min(j + 2, 4), number[3, j, k], number[4, j, k]) for j in range(4) for k in range(3)]
            for name, column in zip(("step", "first_point", "second_point"), np.array(rows).T):
                file[f"broken_bonds/{name}"] = column
            text = file["case/as_resolved"][()].decode()
            del file["case/as_resolved"]
            file["case/as_resolved"] = text.replace("[solver]", "horizon_ratio = 1.5\n" + crack + "[solver]")
        return read_results_folder(self.folder)

    def drawn_colours(self, axes) -> np.ndarray:
        """Colours of the crack faces, which are drawn after those of the body."""
        return axes.collections[1].get_facecolor()

    def test_a_crack_surface_is_coloured_by_its_steps(self):
        results = self.write_torn_solid()
        surface = crack_surface(results, results.step(4))
        figure = draw_crack_surface(results, results.step(4), surface)
        self.assertEqual(len(np.unique(surface.steps)), 3)
        self.assertEqual([label.get_text().split(":")[0] for label in figure.axes[-2].get_yticklabels()], ["2", "3", "4"])
        self.assertEqual(len(self.drawn_colours(figure.axes[0])), 12)
        self.assertEqual(len(np.unique(self.drawn_colours(figure.axes[0]).round(6), axis=0)), 3)
        self.assertFalse(any("pre-crack" in text.get_text() for text in figure.texts))
        results.history = {}
        figure = draw_crack_surface(results, results.step(4), surface)
        self.assertEqual([label.get_text() for label in figure.axes[-2].get_yticklabels()], ["2", "3", "4"])
        one = surface._replace(steps=np.full(12, 2))  # a colour bar would show nothing
        self.assertEqual(len(draw_crack_surface(results, results.step(4), one).axes), len(figure.axes) - 1)
        self.plot()
        self.assert_pictures("deformed", "cut", "damage", "crack_surface", "sequence", "load_displacement", "convergence")

    def test_faces_of_a_pre_crack_are_blue_in_both_pictures(self):
        vertices = [[2 * SPACING, y, z] for y, z in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        results = self.write_torn_solid(f"[[crack]]\nvertices = {vertices}\n")
        steps = [results.step(number) for number in (1, 4)]
        is_blue = lambda colours: (colours[:, 2] > 1.5 * colours[:, 0]) & (colours[:, 1] > 2 * colours[:, 0])
        alone = draw_crack_surface(results, steps[1], crack_surface(results, steps[1]))
        sequence = draw_crack_surface_sequence(results, steps)
        for figure, panel, blue, all_of_them in ((alone, 0, 12, 24), (sequence, 0, 12, 12), (sequence, 1, 12, 24)):
            colours = self.drawn_colours(figure.axes[panel])
            self.assertEqual((is_blue(colours).sum(), len(colours)), (blue, all_of_them))
            self.assertTrue(any("blue: pre-crack" in text.get_text() for text in figure.texts))

    def test_faces_of_cracks_are_lit_from_both_sides(self):
        results = self.write_torn_solid()
        step = results.step(4)
        surface = crack_surface(results, step)
        turned = surface._replace(faces=surface.faces[:, ::-1])
        seen = [self.drawn_colours(draw_crack_surface(results, step, one).axes[0]) for one in (surface, turned)]
        np.testing.assert_allclose(*seen, rtol=1e-12)

    def test_a_solid_whose_bonds_are_not_known_shows_its_damaged_cells(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        results = read_results_folder(self.folder)
        surface = crack_surface(results, results.step(3))
        figure = draw_crack_surface(results, results.step(3), surface)
        self.assertIn("damage", [axes.get_ylabel() for axes in figure.axes])
        self.assertEqual(len(surface.faces), 2 * (6 * 6 + 2 * 6 + 2 * 6))

    def test_a_solid_with_little_damage_has_no_crack_surface(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000003/damage"][...] *= 0.2
        self.plot()
        self.assert_pictures("deformed", "cut", "damage", "load_displacement", "convergence")

    def test_a_crack_in_a_single_step_is_no_sequence(self):
        write_folder(self.folder, lattice(12, 6, 6), steps=1)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["steps/000001/damage"][:36] = 0.5
        self.plot()
        self.assert_pictures("deformed", "cut", "damage", "crack_surface", "load_displacement", "convergence")

    def test_a_cut_is_pale_where_there_is_little_energy(self):
        write_folder(self.folder, lattice(20, 6, 6) - [0.0, 3.0 * SPACING * (1 + 1e-13), 3.0 * SPACING * (1 + 1e-13)])
        with h5py.File(self.folder / "results.h5", "a") as file:
            x = file["points/reference"][:, 0] / SPACING
            file["steps/000003/energy_density"][...] = np.where(x < 4, 1e6, np.where(x < 8, 1e5, 0.0))
        figure = draw_cut_solid(*self.last(read_results_folder(self.folder)))
        [faces] = figure.axes[0].collections
        colours = np.unique(faces.get_facecolor()[:, :3].round(2), axis=0)
        self.assertGreater(np.median(faces.get_facecolor()[:, :3].min(axis=1)), 0.5)
        bar = figure.axes[-1]
        self.assertGreater(len(colours), 4)  # of three values, on differently shaded faces
        ticks = bar.get_yticks()
        self.assertEqual(bar.get_yscale(), "function")  # the square root
        self.assertTrue((np.diff(ticks) > 0).all())
        self.assertTrue(any("cut at y = 0 m" in text.get_text() for text in figure.texts), [t.get_text() for t in figure.texts])

    def last(self, results):
        return results, results.step(results.step_numbers[-1])

    def test_a_camera_may_look_from_farther_round(self):
        block = lattice(8, 4, 4)
        own, given = Camera(block, 0 * block), Camera(block, 0 * block, 70.0)
        self.assertGreater(abs(given.towards[0]), abs(own.towards[0]))
        faces = np.random.default_rng(1).uniform(size=(9, 1, 3)) + np.zeros((1, 4, 1))
        self.assertTrue((np.diff(own.depth(faces[own.far_to_near(faces)][:, 0])) > 0).all())

    def shaped(self, shapes, points, layer=""):
        """Results of a body with shapes in its case [spacings]."""
        write_folder(self.folder, points * SPACING, steps=1)
        with h5py.File(self.folder / "results.h5", "a") as file:
            text = file["case/as_resolved"][()].decode()
            del file["case/as_resolved"]
            file["case/as_resolved"] = text.replace("[solver]", shapes + layer + "[solver]")
        return read_results_folder(self.folder)

    PLATE = (f"[[lattice.shape]]\nadd = 'box'\nmin = [0.0, 0.0]\nmax = [{20 * SPACING}, {12 * SPACING}]\n"
             f"[[lattice.shape]]\nsubtract = 'disk'\ncentre = [{10 * SPACING}, {6 * SPACING}]\nradius = {3.3 * SPACING}\n")

    def test_a_round_hole_is_drawn_round(self):
        points = lattice(20, 12) / SPACING
        points = points[np.linalg.norm(points - [10, 6], axis=1) > 3.3]
        results = self.shaped(self.PLATE, points)
        plate = deformed_plate(*self.last(results), 0.0, np.zeros(len(points)), SPACING)
        self.assertFalse(plate.cells.is_image)  # and not drawn as an image
        near = np.linalg.norm(plate.still.reshape(-1, 2) - [10, 6], axis=1)
        np.testing.assert_allclose(near[near < 3.4], 3.3, rtol=0, atol=0.02)
        self.assertGreater((near < 3.4).sum(), 40)
        np.testing.assert_allclose(plate.moved, plate.still, rtol=0, atol=1e-12)
        self.plot()
        self.assert_pictures("deformed", "fields", "load_displacement", "convergence")
        fewer = deformed_plate(*self.last(results), 0.0, np.zeros(len(points)), SPACING, limit=80)
        self.assertLess(len(fewer.still), 81)  # cells that stand for several points have outlines of their own
        self.assertEqual(len(results.drawn), 2)

    def test_cells_of_layers_stay_squares(self):
        layer = "[[lattice.layer]]\nname = 'left'\nside = 'x-'\nthickness = 1\n"
        points = np.concatenate([[[-0.5, 3.5]], lattice(20, 12) / SPACING])
        points = points[np.linalg.norm(points - [10, 6], axis=1) > 3.3]
        results = self.shaped(self.PLATE, points, layer)  # the set is the points at less than two spacings
        np.testing.assert_array_equal(results.in_layers, points[:, 0] < 2.0)
        plate = deformed_plate(*self.last(results), 0.0, np.zeros(len(points)), SPACING)
        np.testing.assert_allclose(np.ptp(plate.still[0], axis=0), [1, 1], rtol=0, atol=1e-9)

    def test_a_cloud_is_drawn_without_gaps(self):
        points = lattice(20, 12) / SPACING
        points = points + np.random.default_rng(3).choice([-0.15, 0.0, 0.15], points.shape)
        points = np.concatenate([points, [[9.9, 6.1]]])  # a second point in a cell of the lattice
        points = points[np.linalg.norm(points - [10, 6], axis=1) > 3.3]
        points = np.concatenate([points, [[19.8, 11.9]]])
        results = self.shaped(self.PLATE, points)
        self.assertFalse(Cells(points, 1.0).is_lattice)
        for factor in (0.0, 5.0):
            plate = deformed_plate(*self.last(results), factor, np.zeros(len(points)), SPACING)
            x, y = plate.moved[:, :, 0], plate.moved[:, :, 1]
            area = 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum()
            whole = (240 - np.pi * 3.3**2) * (1 + 0.01 * factor) * (1 - 0.003 * factor)
            self.assertAlmostEqual(area / whole, 1.0, delta=0.005)
        self.plot()
        self.assert_pictures("deformed", "fields", "load_displacement", "convergence")

    def test_a_cloud_is_parted_by_its_cracks_bonds_and_pieces(self):
        points = lattice(10, 6) / SPACING + np.random.default_rng(3).uniform(-0.15, 0.15, (60, 2))
        points = np.concatenate([points, [[5.0, 5.95]]])
        crack = f"[[crack]]\nfrom = [{2 * SPACING}, {-SPACING}]\nto = [{2 * SPACING}, {9 * SPACING}]\n"
        results = self.shaped(crack, points)
        with h5py.File(self.folder / "results.h5", "a") as file:
            right = points[:, 0] > 5.0
            rows = [(1, one, other) for one in np.flatnonzero(~right) for other in np.flatnonzero(right)]
            for name, column in zip(("step", "first_point", "second_point"), np.array(rows).T):
                file[f"broken_bonds/{name}"] = column
            file["steps/000001/fragment"] = np.where(points[:, 0] > 8.0, 1, 0)
        results = read_results_folder(self.folder)
        for size in (1.0, SPACING):
            with mock.patch("peristat.pictures.separations.voronoi_cells", wraps=voronoi_cells) as found:
                plates = [deformed_plate(*self.last(results), 0.0, np.zeros(61), size) for _ in range(2)]
            self.assertEqual(found.call_count, 1 if size == 1.0 else 0)  # once for all pictures
            part = sum(points[:, 0] > place for place in (2.0, 5.0, 8.0))  # between the cuts
            for _, other, parted in plates[1].cells.sides():
                np.testing.assert_array_equal(parted, (other >= 0) & (part != part[other]))
            self.assertGreater(sum(parted.sum() for *_, parted in plates[1].cells.sides()), 30)

    def test_a_cloud_of_clusters_far_apart_may_be_merged(self):
        cluster = np.random.default_rng(3).uniform(0.0, 6.0, (60, 2))
        points = np.concatenate([cluster, cluster + 30_000.0])
        results = self.shaped(self.PLATE, points)
        plate = deformed_plate(*self.last(results), 0.0, np.zeros(120), SPACING, limit=50)
        self.assertFalse(plate.cells.is_lattice)
        sides = np.ptp(plate.still, axis=1)
        np.testing.assert_allclose(sides, np.full_like(sides, sides[0, 0]), rtol=1e-6)

    def test_a_solid_and_a_bar_have_no_outline(self):
        for dimension in (1, 3):
            self.folder = self.folder.with_name(f"body_{dimension}")
            box = f"[[lattice.shape]]\nadd = 'box'\nmin = {[0.0] * dimension}\nmax = {[4 * SPACING] * dimension}\n"
            self.assertIsNone(self.shaped(box, lattice(*[4] * dimension) / SPACING).outline)

    def test_volumes_that_make_no_sense_leave_a_cloud_its_cells(self):
        points = np.random.default_rng(5).uniform(0.0, 0.02, (300, 2))
        write_folder(self.folder, points)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file["points/volume"][:4] = [0.0, -1.0, np.nan, np.inf]
        results = read_results_folder(self.folder)
        self.assertTrue(np.isfinite(deformed_plate(*self.last(results), 1.0, np.zeros(300)).moved).all())

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

    def begin_at_rest(self):
        """A row of zeros for step 0, whose fields are not written: nothing moves there."""
        path = self.folder / "history.csv"
        names, *rows = path.read_text().splitlines()
        rest = ["newton" if name == "mode" else "0" for name in names.split(",")]
        path.write_text("\n".join([names, ",".join(rest), *rows]) + "\n")
        return read_results_folder(self.folder)

    def test_a_row_at_rest_takes_no_displacement_away(self):
        write_folder(self.folder, lattice(20, 10))
        results = self.begin_at_rest()
        found = find_abscissa(results, reactions(results))
        self.assertIn("“right”", found.label)
        expected = [0.0] + [results.displacement(step)[results.sets["right"], 0].mean() for step in (1, 2, 3)]
        np.testing.assert_allclose(found.values, expected, rtol=1e-15)
        figure = draw_load_displacement(results)
        self.assertEqual(len(figure.axes), 1)
        self.assertTrue(any("3 accepted steps" in text.get_text() for text in figure.texts))

    def test_a_body_that_stayed_at_rest_has_no_curve(self):
        write_folder(self.folder, lattice(20, 10), steps=0)
        self.begin_at_rest()
        self.assertIn("no load_displacement", self.plot())
        self.assertFalse((self.folder / "plots/load_displacement.png").exists())

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
        self.assertIn("not a folder", self.plot(expected_code=2))


def link_in_a_circle(file):
    del file["points"]
    file["points"] = h5py.SoftLink("/points")


def link_to_itself_outside(file):
    del file["steps"]
    file["steps"] = h5py.ExternalLink("results.h5", "/steps")


def huge(path, dtype="f8"):
    def change(file):
        del file[path]
        file.create_dataset(path, shape=(1_000_000_000,), dtype=dtype, chunks=(1024,))  # a few bytes on disk

    return change


def replaced(path, value):
    def change(file):
        del file[path]
        file[path] = value

    return change


def values_elsewhere(file):
    del file["points/volume"]
    file.create_dataset("points/volume", (10,), "f8", external=[("pipe", 0, 80)])


def values_of_another_dataset(file):
    layout = h5py.VirtualLayout((100,), "f8")
    layout[:] = h5py.VirtualSource("results.h5", "points/volume", (100,), "f8")  # itself
    del file["points/volume"]
    file.create_virtual_dataset("points/volume", layout)


LAST = "steps/000003"
# Damage to results.h5, and the name that the message must contain.
DAMAGE = {
    "points that are linked to themselves": (link_in_a_circle, "/points is a link"),
    "steps that are linked to themselves": (link_to_itself_outside, None),
    "a billion points": (huge("points/volume"), "/points/volume claims"),
    "a billion displacements": (huge(f"{LAST}/displacement"), f"/{LAST}/displacement claims"),
    "a billion broken bonds": (lambda file: [huge_new(file, f"broken_bonds/{name}") for name in BROKEN_BONDS],
                               "/broken_bonds/step claims"),
    "values in a pipe": (values_elsewhere, "in other files"),
    "values of nothing": (values_of_another_dataset, "in other files"),
    "volumes that are words": (replaced("points/volume", "words"), "/points/volume holds no numbers"),
    "points without volumes": (lambda file: file.__delitem__("points/volume"), "/points/volume is missing"),
    "no points at all": (lambda file: file.__delitem__("points"), "/points is missing"),
    "volumes that are a group": (lambda file: (file.__delitem__("points/volume"), file.create_group("points/volume")),
                                 "/points/volume is no dataset"),
    "positions that are not finite": (replaced("points/reference", np.full((100, 2), np.nan)), "not finite"),
    "fewer positions": (replaced("points/reference", np.zeros((7, 2))), "/points has (7, 2)"),
    "four dimensions": (replaced("points/reference", np.zeros((100, 4))), "/points has (100, 4)"),
    "displacements of other points": (replaced(f"{LAST}/displacement", np.zeros((7, 2))), "has the shape (7, 2)"),
    "damage that is words": (replaced(f"{LAST}/damage", "words"), f"/{LAST}/damage holds no numbers"),
    "an empty damage": (replaced(f"{LAST}/damage", h5py.Empty("f8")), f"/{LAST}/damage is empty"),
}  # fmt: skip


def huge_new(file, path):
    file.create_dataset(path, shape=(1_000_000_000,), dtype="i8", chunks=(1024,))


def drawn(folder: Path, told: int) -> None:
    """The command, with a different import of matplotlib."""
    os.dup2(told, 1)
    os.dup2(told, 2)
    os._exit(guarded("plot", command.main, [str(folder)]))


class DamagedFolders(unittest.TestCase):
    """Each folder is drawn in a process of its own: it ends by itself, with code 2 and a message, or draws."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="peristat_plot_test_")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name) / "results"

    def plot(self, expected_code: int | None = 2) -> str:
        with tempfile.TemporaryFile("w+", encoding="utf-8") as told:
            process = multiprocessing.get_context("fork").Process(target=drawn, args=(self.folder, told.fileno()))
            process.start()
            process.join(300)  # takes two seconds; the limit catches a hang
            if process.is_alive():
                process.kill()
                self.fail("plot did not end")
            told.seek(0)
            return self.judged(process.exitcode, told.read(), expected_code)

    def plot_by_command(self) -> str:
        command = [sys.executable, "-BEs", str(PYTHON / "peristat/pictures/__main__.py"), str(self.folder)]
        done = subprocess.run(command, capture_output=True, text=True, timeout=300)
        return self.judged(done.returncode, done.stdout + done.stderr, 2)

    def judged(self, code: int | None, said: str, expected_code: int | None) -> str:
        self.assertNotIn("Traceback", said)
        if expected_code is None:
            self.assertIn(code, (0, 2), said)
        else:
            self.assertEqual(code, expected_code, said)
        return said

    def write(self):
        write_folder(self.folder, lattice(10, 10))

    def test_results_that_cannot_be(self):
        for name, (change, words) in DAMAGE.items():
            with self.subTest(name):
                self.folder = self.folder.with_name(name.replace(" ", "_"))
                self.write()
                with h5py.File(self.folder / "results.h5", "a") as file:
                    change(file)
                said = self.plot(None if words is None else 2)
                self.assertIn(words or "plot: ", said)

    def test_results_that_are_no_file(self):
        self.write()
        results = self.folder / "results.h5"
        results.unlink()
        for make in (lambda: os.mkfifo(results), results.mkdir, lambda: results.symlink_to("/dev/zero"),
                     lambda: results.symlink_to("results.h5")):  # fmt: skip
            make()
            self.plot_by_command()
            results.rmdir() if results.is_dir() else results.unlink()

    def test_tables_that_are_no_files(self):
        for name in ("history.csv", "iterations.csv", "decisions.csv", "convergence.csv", "summary.json"):
            with self.subTest(name):
                self.folder = self.folder.with_name(name)
                self.write()
                (self.folder / name).unlink(missing_ok=True)
                os.mkfifo(self.folder / name)
                self.plot(0)

    def test_truncated_and_overwritten_files(self):
        self.write()
        whole = (self.folder / "results.h5").read_bytes()
        generator = np.random.default_rng(2)
        for size in (0, 10, 100, 2000, len(whole) // 2, len(whole) - 100):
            (self.folder / "results.h5").write_bytes(whole[:size])
            self.plot()
        for _ in range(12):
            damaged = np.frombuffer(whole, dtype=np.uint8).copy()
            damaged[generator.integers(0, len(whole), 40)] = generator.integers(0, 256, 40)
            (self.folder / "results.h5").write_bytes(damaged.tobytes())
            self.plot(None)

    def test_tables_with_other_columns(self):
        for content in ("", "a,b\n1,2\n", "step,load_factor\nx,y\n", "step,load_factor\nnan,inf\n", "\0\0,\n\0",
                        "step,load_factor,reaction_x:left\n1,1,oops\n", '"' + "x" * 200_000 + '"\n1\n',
                        "step,load_factor,mode,broken_bonds,max_damage\n1,1,relaxation,x,1\n"):  # fmt: skip
            with self.subTest(content[:40]):
                self.folder = self.folder.with_name(f"table{abs(hash(content))}")
                self.write()
                for name in ("history.csv", "iterations.csv", "decisions.csv", "convergence.csv", "broken_bonds.csv"):
                    (self.folder / name).write_text(content)
                self.plot(0)

    def test_summaries_and_cases_that_cannot_be(self):
        for summary, case in (("[" * 100_000, "a = " + "[" * 100_000), ('{"status": [1]}', "lattice = 3\nprobe = 1"),
                              ("[1, 2]", "support = [1]\ncrack = [{from = 1}]\nload = {}")):  # fmt: skip
            with self.subTest(case[:20]):
                self.folder = self.folder.with_name(f"case{len(case)}")
                self.write()
                (self.folder / "summary.json").write_text(summary)
                with h5py.File(self.folder / "results.h5", "a") as file:
                    replaced("case/as_resolved", case)(file)
                self.plot(0)


class Parts(unittest.TestCase):
    def test_round_factor_is_the_largest_round_number_below(self):
        wanted = [0.3, 1.0, 1.9, 2.0, 4.9, 7.0, 10.0, 99.0, 2345.0, np.inf]
        self.assertEqual([round_factor(value) for value in wanted], [1, 1, 1, 2, 2, 5, 10, 50, 2000, 1])

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
        whole = places[:, 0] < 0.039  # blocks of three columns; the last block has one
        np.testing.assert_allclose(values[whole], places[whole, 0], rtol=0, atol=1e-15)


if __name__ == "__main__":
    unittest.main()
