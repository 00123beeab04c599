"""The Python package reads results folders: what it returns is what the files hold, and its pictures are the program's."""

import io
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest

import h5py
import matplotlib
import matplotlib.image
import numpy as np

from tests.acceptance.folder import Folder
from tests.acceptance.motions import SQUARE
from tests.acceptance.resume_test import TORN
from tests.acceptance.strip import PULLED
from tests.reference.program import PLOT, ROOT
from tests.reference.results import table

sys.path.insert(0, str(ROOT / "python"))

import peristat as ps  # noqa: E402

LINE = """
[[probe]]
name = "along"
field = "displacement"
from = [0, 5e-3]
to = [0.02, 5e-3]
[[probe]]
name = "moved"
set = "right"
[output]
stress = true
every = 2
"""
CUBE = """\
dimension = 3
[lattice]
spacing = 1e-3
shape = [{ add = "box", min = [0, 0, 0], max = [8e-3, 4e-3, 4e-3] }]
layer = [{ name = "left", side = "x-" }, { name = "right", side = "x+" }]
[material]
youngs_modulus = 200e9
[[support]]
set = "left"
displacement = [0, 0, 0]
[[support]]
set = "right"
displacement = ["1e-5*load", "free", "free"]
[loading]
steps = 2
"""


def pixels(content):
    return matplotlib.image.imread(io.BytesIO(content), format="png")


class ResultsFolders(Folder):
    def opened(self, *arguments, **options):
        return ps.open_results(self.run_case(*arguments, **options))

    def judge(self, results):
        """Everything equals the files as other readers see them."""
        folder = results.path
        with h5py.File(folder / "results.h5") as file:
            np.testing.assert_array_equal(results.positions, file["points/reference"])
            np.testing.assert_array_equal(results.points["volume"], file["points/volume"])
            self.assertEqual(results.steps, [int(name) for name in sorted(file["steps"])])
            self.assertTrue(results.steps)
            for number in results.steps:
                group = file[f"steps/{number:06d}"]
                fields = [name for name, item in group.items() if isinstance(item, h5py.Dataset)]
                self.assertEqual(sorted(results.fields(number)), sorted(fields))
                self.assertEqual(results.load_factor(number), group.attrs["load_factor"])
                for name in fields:
                    np.testing.assert_array_equal(results.field(name, number), group[name])
            np.testing.assert_array_equal(results.displacement(), file[f"steps/{results.steps[-1]:06d}/displacement"])
            for name, column in results.history.items():
                self.assertEqual(results.history.units[name], file["history"][name].attrs["unit"])
            sets = list(file["points/set_ids"].attrs.get("sets", []))
            self.assertEqual(list(results.point_sets), sets)
            for place, name in enumerate(sets):
                np.testing.assert_array_equal(results.point_sets[name], np.flatnonzero(file["points/set_ids"][:, place]))
        for name in ("history", "iterations", "decisions", "broken_bonds"):
            rows, read = table(folder / f"{name}.csv"), getattr(results, name)
            for column in rows[0] if rows else ():
                self.assertEqual(read[column].tolist(), [row[column] for row in rows], f"{name}, {column}")
        self.assertEqual(results.dimension, results.positions.shape[1])
        self.assertIn("<table>", results._repr_html_())

    def assert_pictures_are_the_programs(self, results):
        """Each picture that the command saves, but the animation, is that of `plot` to the last pixel."""
        self.assert_completed(self.execute([*PLOT, results.path]))
        saved = sorted((results.path / "plots").glob("*.png"))
        self.assertGreater(len(saved), 1)
        for path in saved:
            figure = results.plot(path.stem)
            image = pixels(figure._repr_png_())
            np.testing.assert_array_equal(image, matplotlib.image.imread(path), path.name)
            self.assertGreater(len(np.unique(image.reshape(-1, image.shape[-1]), axis=0)), 30, path.name)
        self.assertIn((results.path / "plots/.pictures").read_text().split()[0], ("deformed.png", "load_displacement.png"))
        return [path.stem for path in saved]

    def test_a_plate_that_is_pulled(self):
        results = self.opened(PULLED, "loading.steps=4")
        self.judge(results)
        self.assertEqual((results.status, results.reason, results.dimension), ("completed", "", 2))
        self.assertEqual(results.settings["loading.steps"], "4")
        self.assertEqual(results.case["loading"]["steps"], 4)
        self.assertIn('add = "box"', results.case_text)
        self.assertEqual(len(results.broken_bonds["step"]), 0)
        self.assertEqual(results.summary["points"], len(results.positions))
        self.assertAlmostEqual(results.displacement()[results.point_sets["right"], 0].mean(), 1e-5)
        drawn = self.assert_pictures_are_the_programs(results)
        self.assertLessEqual({"deformed", "fields", "load_displacement"}, set(drawn))

    def test_a_plate_that_is_torn(self):
        results = self.opened(TORN + LINE)
        self.judge(results)
        self.assertGreater(len(results.broken_bonds["step"]), 10)
        self.assertEqual(results.history["mode"].dtype.kind, "U")
        self.assertIn("relaxation", results.history["mode"])
        self.assertTrue(all(number % 2 == 0 for number in results.steps[:-1]))  # output.every
        np.testing.assert_array_equal(results.probes["crack"], results.history["crack"])
        moved = results.probes["moved"]
        self.assertEqual(moved.shape, (len(results.history["step"]), 2))
        np.testing.assert_array_equal(moved[:, 1], results.history["moved_y"])
        self.assertNotIn("along", results.probes)
        (line,) = results.lines.values()
        rows = table(results.path / "line_along.csv")
        np.testing.assert_array_equal(line["displacement_x"], [row["displacement_x"] for row in rows])
        self.assertEqual(line.units["distance"], "m")
        drawn = self.assert_pictures_are_the_programs(results)
        self.assertLessEqual({"damage", "broken_bonds", "von_mises"}, set(drawn))

    def test_a_bar(self):
        results = self.opened(ROOT / "cases/bar/tension.toml")
        self.judge(results)
        self.assertEqual(results.displacement().shape, (len(results.positions), 1))
        self.assert_pictures_are_the_programs(results)
        with self.assertRaisesRegex(ps.InputError, "'strech'.*Did you mean 'stretch'.*There are deformed, load_displacement"):
            results.plot("strech")
        self.assertEqual([axes.get_xlabel() for axes in results.plot("stretch", zoom=(0.0, 0.01)).axes][-1], "x [mm]")

    def test_a_solid(self):
        results = self.opened(CUBE)
        self.judge(results)
        self.assertLessEqual({"deformed", "cut"}, set(self.assert_pictures_are_the_programs(results)))
        self.assertGreater(len(np.unique(pixels(results.plot("stretch")._repr_png_()))), 30)

    def test_a_motion(self):
        results = self.opened(SQUARE)
        self.judge(results)
        self.assertEqual(results.field("velocity").shape, results.positions.shape)
        self.assertIn("kinetic_energy", results.history)
        drawn = self.assert_pictures_are_the_programs(results)
        self.assertIn("speed", drawn)
        self.assertGreater(results.load_factor(), results.load_factor(results.steps[0]))

    # ---- pictures ----

    def test_pictures_of_other_steps_and_of_fields(self):
        results = self.opened(TORN)
        first, last = (pixels(results.plot("deformed", step)._repr_png_()) for step in (results.steps[0], -1))
        self.assertFalse(first.shape == last.shape and (first == last).all())
        np.testing.assert_array_equal(pixels(results.plot()._repr_png_()), last)
        began = int(results.broken_bonds["step"][0])
        broken = pixels(results.plot("broken_bonds", began)._repr_png_())
        self.assertFalse(np.array_equal(broken, pixels(results.plot("broken_bonds")._repr_png_())))
        for name in ("stretch", "force"):
            self.assertGreater(len(np.unique(pixels(results.plot(name)._repr_png_()))), 30, name)
        with self.assertRaisesRegex(ps.InputError, "'energies' shows the whole run"):
            results.plot("energies", results.steps[0])
        np.testing.assert_array_equal(pixels(results.plot("deformed", "last")._repr_png_()), last)
        with self.assertRaisesRegex(ps.InputError, "'damge'.*Did you mean 'damage'.*deformed.*energies.*stretch"):
            results.plot("damge")

    def test_curves(self):
        results = self.opened(TORN)
        own = results.curve()._repr_png_()
        np.testing.assert_array_equal(pixels(own), pixels(results.plot("load_displacement")._repr_png_()))
        figure = results.curve(x="displacement_x:right", y=["reaction_x:left", "reaction_x:right"])
        (axes,) = figure.axes
        self.assertEqual(axes.get_ylabel(), "[kN]")
        for line, name in zip(axes.lines, ("reaction_x:left", "reaction_x:right")):
            np.testing.assert_allclose(line.get_ydata(), 1e-3 * results.history[name])
        factor = {"displacement_x:right [µm]": 1e6, "displacement_x:right [mm]": 1e3}[axes.get_xlabel()]
        np.testing.assert_allclose(axes.lines[0].get_xdata(), factor * results.history["displacement_x:right"])
        self.assertEqual(results.curve(y="stored_energy").axes[0].get_xlabel(), "load_factor")
        for words, message in (({"x": "step"}, "Give y"), ({"y": ["step", "stored_energy"]}, "one unit, not step .1., stored_energy .J."),
                               ({"y": []}, "one unit, not none"), ({"y": "mode"}, "holds text"),
                               ({"y": "stored"}, "'stored'.*Did you mean 'stored_energy'.*max_damage")):  # fmt: skip
            with self.subTest(words), self.assertRaisesRegex(ps.InputError, message):
                results.curve(**words)

    def test_the_callers_settings_neither_change_a_picture_nor_are_changed(self):
        results = self.opened(PULLED)
        expected = results.plot()._repr_png_()
        with matplotlib.rc_context({"font.size": 30, "axes.facecolor": "black", "savefig.dpi": 20, "xtick.labelcolor": "red"}):
            before = dict(matplotlib.rcParams)
            figure = results.plot()
            file = io.BytesIO()
            figure.savefig(file, format="png")
            self.assertEqual(dict(matplotlib.rcParams), before)
        np.testing.assert_array_equal(pixels(file.getvalue()), pixels(expected))

    def test_the_backend_stays_and_nothing_is_loaded_that_is_not_used(self):
        folder = self.run_case(PULLED)
        code = (
            "import sys; sys.path.insert(0, sys.argv[1])\n"
            "import peristat as ps; print('h5py' in sys.modules)\n"
            "results = ps.open_results(sys.argv[2]); results.field('damage'); print('matplotlib' in sys.modules)\n"
            "import matplotlib; matplotlib.use('svg'); results.plot(); results.curve()\n"
            "print(matplotlib.get_backend(), 'matplotlib.pyplot' in sys.modules)\n"
        )
        done = self.execute(["/usr/bin/python3", "-BEs", "-c", code, ROOT / "python", folder])
        self.assertEqual(self.assert_completed(done).output.split(), ["False", "False", "svg", "False"])

    # ---- folders that are not finished ----

    def test_a_run_that_was_killed_and_goes_on(self):
        process = self.start(self.words_of_run(PULLED, "loading.steps=2000"))
        end = time.monotonic() + 60
        while not list(self.folder.glob("out/parts/000003.h5")) and time.monotonic() < end:
            time.sleep(0.01)
        results = ps.open_results(self.folder / "out")
        self.assertEqual(results.status, "running")
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
        self.assertEqual(results.status, "interrupted")
        known = list(results.steps)
        results.reload()
        self.assertGreaterEqual(len(results.steps), len(known))
        self.assertTrue((results.path / "parts").is_dir())
        self.assertEqual(results.summary, {})
        self.assertEqual(results.history["step"].tolist(), [0, *results.steps])
        self.assertIn("interrupted", repr(results))
        results.displacement(known[0])
        self.assertGreater(len(np.unique(pixels(results.plot()._repr_png_()))), 30)
        self.resume("out", words=("--stop-after", "3"), code=130)
        with self.assertRaisesRegex(ps.InputError, "reload"):
            results.displacement()
        count = len(results.steps)
        results.reload()
        self.assertEqual((results.status, len(results.steps)), ("interrupted", count + 3))
        self.judge(results)

    def test_a_folder_that_another_run_has_replaced_is_not_mixed_with_it(self):
        results = self.opened(PULLED)
        results.plot()  # what pictures need of the first run is kept
        self.run_case(PULLED.replace("0.02, 0.01", "0.03, 0.01"))
        for read in (results.displacement, lambda: results.history["step"], results.plot, results.curve):
            with self.assertRaisesRegex(ps.InputError, "reload"):
                read()
        self.judge(results.reload())

    def test_a_run_that_did_not_converge(self):
        results = self.opened(PULLED, "solver.max_iterations=1", "loading.smallest_step=0.5", code=3)
        self.assertEqual(results.status, "not_converged")
        self.assertTrue(results.reason)
        self.assertEqual(results.steps, [])
        with self.assertRaisesRegex(ps.InputError, "no step has fields"):
            results.field("damage")
        with self.assertRaisesRegex(ps.InputError, "no picture None|no picture 'deformed'"):
            results.plot("deformed")
        self.assertIn("not_converged", results._repr_html_())

    # ---- refusals ----

    def test_names_that_are_not_there(self):
        results = self.opened(PULLED, "loading.steps=3")
        refused = (
            (lambda: results.field("damag"), "'damag'.*Did you mean 'damage'.*displacement"),
            (lambda: results.field("damage", 7), "step 7 has no fields. There are 1 to 3"),
            (lambda: results.field("damage", -4), "step -4 "),
            (lambda: results.field("damage", 1.0), "whole number, not 1.0"),
            (lambda: results.field("../damage"), "no field '../damage'"),
            (lambda: results.history["reaction_x:up"], "'reaction_x:up'.*Did you mean 'reaction_x:left'"),
            (lambda: results.points["volum"], "Did you mean 'volume'"),
            (lambda: ps.open_results(self.folder / "nowhere"), "nowhere: no such folder; the results in .* are out"),
            (lambda: ps.open_results(self.folder), "no results.h5.*the results in .* are out"),
            (lambda: ps.open_results(self.folder / "case.toml"), "no such folder"),
        )
        for read, message in refused:
            with self.subTest(message), self.assertRaisesRegex(ps.InputError, message):
                read()
        self.assertIsNone(results.history.get("nothing"))
        self.assertNotIn("nothing", results.history)
        with self.assertRaises(ValueError):  # what is kept can't be changed by accident
            results.positions[0] = 1.0
        np.testing.assert_array_equal(results.field("damage", -1), results.field("damage", 3))
        np.testing.assert_array_equal(results.displacement(-3), results.displacement(1))

    def test_damaged_files(self):
        results = self.opened(PULLED)
        copy = self.folder / "copy"
        shutil.copytree(results.path, copy)
        with h5py.File(copy / "results.h5", "a") as file:
            del file["points/reference"]
        with self.assertRaisesRegex(ps.InputError, "points/reference is missing"):
            ps.open_results(copy)
        (copy / "results.h5").write_bytes(b"no HDF5")
        with self.assertRaisesRegex(ps.InputError, "can't be read"):
            ps.open_results(copy)
        (results.path / "summary.json").write_text("{")
        with self.assertRaisesRegex(ps.InputError, "summary.json: can't be read"):
            results.status  # noqa: B018


class Page(Folder):
    def test_the_blocks_of_the_page_run(self):
        """Those of the section "Results", one after another, beside the results of a torn strip."""
        text = (ROOT / "docs/python.md").read_text("utf-8").partition("\n## Results\n")[2].partition("\n## ")[0]
        blocks = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
        self.assertGreater(len(blocks), 3)
        self.run_case(TORN, name="results/strip")
        code = f"import sys; sys.path.insert(0, {str(ROOT / 'python')!r})\n" + "\n".join(blocks)
        done = subprocess.run(["/usr/bin/python3", "-BEs", "-c", code], cwd=self.folder, capture_output=True, text=True)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertTrue((self.folder / "damage.png").is_file())


if __name__ == "__main__":
    unittest.main()
