"""Sweeps through the command line: the table, the picture, skipped runs, and every ending."""

import contextlib
import csv
import json
import math
import os
import shutil
import signal
import sys
import time
import tomllib
import unittest

import h5py
import matplotlib.image

from tests.acceptance.folder import Folder
from tests.acceptance.refine_test import PATCH
from tests.acceptance.strip import PULLED
from tests.reference.program import ROOT, limited_by_shell, settings

SWEEP = ROOT / "cases" / "runner" / "sweep" / "sweep.py"  # reads PERISTAT_PROGRAM, as this test does

STRIP = 'title = "Strip"\n' + PULLED + """\
[[probe]]
name = "end"
set = "right"
[[probe]]
name = "energy"
set = "left"
field = "energy_density"
"""
COLUMNS = [
    "status", "exit_code", "steps", "newton_iterations", "relaxation_iterations", "factorisations",
    "broken_bonds", "max_damage", "max_displacement", "energy_stored", "energy_dissipated",
    "energy_drained", "external_work", "balance_error", "peak_reaction:left", "peak_reaction:right",
    "final_reaction:left", "final_reaction:right", "probe:end_x", "probe:end_y", "probe:energy",
    "seconds_total", "peak_memory_bytes",
]  # fmt: skip
STIFFNESS_AND_STEPS = ["--vary", "material.youngs_modulus=100e9,200e9", "--vary", "loading.steps=1,3"]
FIRST_FAILS = ["--vary", "solver.max_iterations=1,20", "--set", "loading.smallest_step=0.1"]


class Sweep(Folder):
    def setUp(self):
        super().setUp()
        self.write("strip.toml", STRIP)
        self.out = self.folder / "out"

    def words(self, *arguments):
        return [sys.executable, "-BEs", SWEEP, *arguments]

    def sweep(self, *arguments, case="strip.toml", output=("--output", "out")):
        return self.execute(self.words(case, *arguments, *output))

    def assert_ends(self, run, code, *lines):
        """The exit code, and the ends of the lines on the combinations."""
        self.assert_code(run, code)
        told = [line for line in run.output.splitlines() if line[0].isdigit()]
        self.assertEqual(len(told), len(lines), run.output)
        for line, fragment in zip(told, lines):
            self.assertIn(f": {fragment}", line)

    def rows(self):
        with open(self.out / "sweep.csv", newline="") as table:
            return list(csv.DictReader(table))

    def summaries(self):
        return sorted((path, path.stat().st_mtime_ns) for path in self.out.glob("*/summary.json"))

    # ---- files of others ----

    def test_files_of_others_are_not_replaced(self):
        for name in ["sweep.csv", "sweep.png", "refinement.csv", "refinement.png"]:
            shutil.rmtree(self.out, ignore_errors=True)
            self.out.mkdir()
            (self.out / name).write_text("a,b\n1,2\n")
            run = self.sweep("--vary", "loading.steps=1")
            self.assert_ends(run, 2)
            self.assertIn(name, run.errors)
            self.assertEqual([path.name for path in self.out.iterdir()], [name])
            self.assertEqual((self.out / name).read_text(), "a,b\n1,2\n")

    def test_files_of_others_beside_our_table_are_not_replaced(self):
        self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, "done")
        (self.out / "sweep.png").write_text("mine")
        run = self.sweep("--vary", "loading.steps=1,2")
        self.assert_ends(run, 2)
        self.assertEqual((self.out / "sweep.png").read_text(), "mine")

    def test_the_table_of_a_benchmark_replaces_no_file_of_others(self):
        self.write("table.md", "mine")
        run = self.execute([sys.executable, "-BEs", ROOT / "benchmarks/table1.py", "--output", "table.md"])
        self.assert_refused(run)
        self.assertEqual((self.folder / "table.md").read_text(), "mine")

    def test_words_are_varied_and_drawn(self):
        self.assert_ends(self.sweep("--vary", "solver.mode=newton,adaptive"), 0, "done", "done")
        self.assertTrue((self.out / "sweep.png").exists())

    def test_results_of_another_case_are_replaced_on_demand_only(self):
        self.write("other.toml", STRIP.replace("200e9", "100e9"))
        self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, "done")
        before = self.summaries()
        refused = self.sweep("--vary", "loading.steps=1", case="other.toml")
        self.assert_ends(refused, 2, "exit code 2: refused")
        self.assertIn("another case", refused.errors)
        self.assertEqual(self.summaries(), before)
        self.assert_ends(self.sweep("--vary", "loading.steps=1", "--overwrite", case="other.toml"), 0, "done")

    def test_a_fault_of_the_machine_ends_the_sweep(self):
        command = self.words("strip.toml", "--vary", "loading.steps=1,2", "--output", "out")
        run = self.execute(limited_by_shell("ulimit -f 8", command))
        self.assert_ends(run, 5, "exit code 5: the machine failed")
        self.assertEqual([row["exit_code"] for row in self.rows()], ["5"])

    def test_who_stops_reading_does_not_stop_the_sweep(self):
        script = '"$@" | head -1; exit "${PIPESTATUS[0]}"'
        command = self.words("strip.toml", "--vary", "loading.steps=1,2,3", "--output", "out")
        run = self.execute(["bash", "-c", script, "bash", *command])
        self.assertEqual((run.code, run.errors.count("without output")), (0, 1), run.errors)
        self.assertEqual([row["status"] for row in self.rows()], ["completed"] * 3)

    # ---- table and picture ------------------------------------------------------------------------

    def test_every_combination_is_a_row_and_is_skipped_once_it_is_done(self):
        self.assert_ends(self.sweep(*STIFFNESS_AND_STEPS), 0, "done", "done", "done", "done")
        self.expect_a_row_each()
        self.expect_the_picture()
        rows = self.rows()
        self.expect_that_what_is_done_is_skipped()
        shutil.rmtree(self.out)
        self.expect_side_by_side(rows)

    def expect_a_row_each(self):
        keys = ["material.youngs_modulus", "loading.steps"]
        rows = self.rows()
        self.assertEqual(list(rows[0]), keys + COLUMNS)
        told = [[row[key] for key in keys] for row in rows]
        self.assertEqual(told, [["100e9", "1"], ["100e9", "3"], ["200e9", "1"], ["200e9", "3"]])
        for row in rows:
            folder = self.out / ",".join(f"{key}={row[key]}" for key in keys)
            summary = json.loads((folder / "summary.json").read_text())
            self.assertEqual((row["status"], row["exit_code"], row["steps"]), ("completed", "0", row["loading.steps"]))
            for column, value in {
                "newton_iterations": summary["newton_iterations"],
                "energy_stored": summary["energy"]["stored"],
                "external_work": summary["energy"]["external_work"],
                "final_reaction:right": math.hypot(*summary["reactions"]["right"]),
                "peak_reaction:right": math.hypot(*summary["reactions"]["right"]),  # it only grows
                "probe:end_x": summary["probes"]["end"][0],
                "probe:energy": summary["probes"]["energy"],
                "seconds_total": summary["seconds"]["total"],
                "peak_memory_bytes": summary["peak_memory_bytes"],
            }.items():
                self.assertEqual(float(row[column]), value, column)
        soft, stiff = float(rows[0]["final_reaction:right"]), float(rows[2]["final_reaction:right"])
        self.assertGreater(soft, 0.0)
        self.assertAlmostEqual(stiff / soft, 2.0, delta=1e-9)

    def expect_the_picture(self):
        picture = matplotlib.image.imread(self.out / "sweep.png")
        self.assertEqual(picture.shape[1], 1600)  # the height follows from the number of outcomes
        self.assertGreater(picture[100:, :, :3].std(), 0.05)
        self.assertEqual(sorted(path.name for path in self.out.glob("sweep.*")), ["sweep.csv", "sweep.png"])

    def test_peak_and_final_reaction_differ_where_the_load_goes_back(self):
        displacement = 'support[1].displacement=["4e-5*load*(1 - 0.5*load)", "free"]'
        self.sweep("--vary", displacement.replace("1 - 0.5", "1 - 0.75") + ',["1e-5*load", "free"]',
                   "--set", "loading.steps=6")  # fmt: skip
        back, forth = self.rows()
        self.assertEqual(back["support[1].displacement"], '["4e-5*load*(1 - 0.75*load)", "free"]')
        # largest at load 2/3: 4e-5 * 2/3 * 1/2, and 1e-5 at the end
        ratio = float(back["peak_reaction:left"]) / float(back["final_reaction:left"])
        self.assertAlmostEqual(ratio, 4.0 / 3.0, delta=1e-3)
        self.assertEqual(forth["peak_reaction:left"], forth["final_reaction:left"])

    def test_the_folder_is_named_after_the_case(self):
        run = self.sweep("--vary", "loading.steps=1", "--threads", "1", output=())
        self.assert_ends(run, 0, "done")
        self.out = self.folder / "results" / f"{self.folder.name}_strip_sweep"
        self.assertEqual(len(self.rows()), 1)
        summary = json.loads((self.out / "loading.steps=1" / "summary.json").read_text())
        self.assertEqual(summary["threads"], 1)

    def test_what_launched_it_does_not_count_as_memory(self):
        self.sweep("--vary", "loading.steps=1,2,3")
        peaks = [float(row["peak_memory_bytes"]) for row in self.rows()]
        self.assertLess(max(peaks) / min(peaks), 1.3)

    # ---- skipping ---------------------------------------------------------------------------------

    def expect_that_what_is_done_is_skipped(self):
        table, before = (self.out / "sweep.csv").read_text(), self.summaries()
        self.assertEqual(len(before), 4)
        self.assert_ends(self.sweep(*STIFFNESS_AND_STEPS), 0, *["skipped"] * 4)
        self.assertEqual(self.summaries(), before)
        self.assertEqual((self.out / "sweep.csv").read_text(), table)
        self.assertTrue((self.out / "sweep.png").exists())
        more = self.sweep("--vary", "material.youngs_modulus=200e9,300e9", *STIFFNESS_AND_STEPS[2:])
        self.assert_ends(more, 0, "skipped", "skipped", "done", "done")

    def test_changed_settings_run_again(self):
        vary = ["--vary", "loading.steps=1,2"]
        self.sweep(*vary)
        changed = [*vary, "--set", "material.youngs_modulus=100e9"]
        self.assert_ends(self.sweep(*changed), 0, "done", "done")
        self.assert_ends(self.sweep(*changed), 0, "skipped", "skipped")
        self.assert_ends(self.sweep(*vary), 0, "done", "done")

    def test_a_changed_case_runs_again(self):
        self.sweep("--vary", "loading.steps=1,2")
        self.write("strip.toml", STRIP.replace("200e9", "210e9"))
        self.assert_ends(self.sweep("--vary", "loading.steps=1,2"), 0, "done", "done")

    def test_results_of_another_run_do_not_count_as_done(self):
        self.sweep("--vary", "loading.steps=1,2")
        run = self.peristat("run", "strip.toml", "--set", "loading.steps=5", "--output", "out/loading.steps=2")
        self.assert_completed(run)
        (self.out / "loading.steps=1" / "results.h5").unlink()
        self.assert_ends(self.sweep("--vary", "loading.steps=1,2"), 0, "done", "done")

    def test_a_changed_points_file_runs_again(self):
        rows = [f"{x}e-3, {y}e-3, 1e-9, {'left' if x < 3 else 'right' if x > 8 else ''}"
                for x in range(12) for y in range(4)]  # fmt: skip
        begin, end = STRIP.index("[lattice]"), STRIP.index("[material]")
        points = '[points]\nfile = "points.csv"\nhorizon = 3.015e-3\nthickness = 1e-3\n'
        self.write("strip.toml", STRIP[:begin] + points + STRIP[end:])
        self.write("points.csv", "x, y, volume, set\n" + "\n".join(rows) + "\n")
        self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, "done")
        self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, "skipped")
        self.write("points.csv", "x, y, volume, set\n" + "\n".join(rows[:-1]) + "\n")
        self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, "done")

    def test_a_changed_outline_runs_again(self):
        hole = '[[lattice.shape]]\nsubtract = "polygon"\nfile = "outline.csv"\n[material]'
        self.write("strip.toml", STRIP.replace("[material]", hole, 1))
        for width, ends in (("6.4e-3", "done"), ("6.4e-3", "skipped"), ("6.3e-3", "done")):
            self.write("outline.csv", f"4e-3 1e-3\n{width} 1e-3\n{width} 3e-3\n4e-3 3e-3\n")
            self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, ends)

    # ---- keys that vary together, and refinement --------------------------------------------------

    def test_linked_and_computed_keys(self):
        run = self.sweep("--vary", "lattice.spacing=1e-3,2e-3", "--with", "material.youngs_modulus=100e9,200e9",
                         "--with", "loading.steps:=round(4e-3/lattice.spacing)",
                         "--set", "lattice.horizon_ratio:=1 + 4*1e-3/lattice.spacing")  # fmt: skip
        self.assert_ends(run, 0, "done", "done")
        for row, values in zip(self.rows(), (("1e-3", "100e9", "4"), ("2e-3", "200e9", "2"))):
            self.assertEqual((row["lattice.spacing"], row["material.youngs_modulus"], row["loading.steps"]), values)
            self.assertEqual(row["steps"], values[2])
        with h5py.File(self.out / "lattice.spacing=2e-3,material.youngs_modulus=200e9/results.h5") as file:
            case = tomllib.loads(file["case/as_resolved"][()].decode())
        self.assertEqual(case["lattice"]["horizon_ratio"], 3.0)

    def test_materials_of_regions_vary(self):
        run = self.sweep("--vary", "region[0].material.youngs_modulus=70e9,140e9",
                         "--with", "region[1].material.youngs_modulus:=3*region[0].material.youngs_modulus",
                         "--vary", "interface[0].rule=harmonic,weaker", "--vary", "region[1].material.damage.critical=0.1,0.2",
                         "--set", "region[1].material.damage.law=critical_stretch", case=ROOT / "cases/regions/bimaterial.toml")  # fmt: skip
        self.assert_ends(run, 0, *8 * ["done"])
        rows = self.rows()
        soft, stiff = (next(row for row in rows if row["region[0].material.youngs_modulus"] == value) for value in ("70e9", "140e9"))
        # F/A (0.5/E1 + 0.497/E2) of the joined bars, without the interface's horizon of 6 mm.
        closed = 100.0 / 1e-4 * (0.5 / 70e9 + 0.497 / 210e9)
        self.assertAlmostEqual(float(soft["probe:end"]) / closed, 1, delta=1e-3)
        self.assertAlmostEqual(float(stiff["probe:end"]) / float(soft["probe:end"]), 0.5, delta=1e-9)
        self.assertEqual(len({row["probe:end"] for row in rows if row["region[0].material.youngs_modulus"] == "70e9"}), 2)
        (folder,) = self.out.glob("*youngs_modulus=140e9*weaker*critical=0.2*")
        with h5py.File(folder / "results.h5") as file:
            regions = tomllib.loads(file["case/as_resolved"][()].decode())["region"]
        self.assertEqual([region["material"]["youngs_modulus"] for region in regions], [140e9, 420e9])
        self.assertEqual(regions[1]["material"]["damage"]["critical"], 0.2)
        for key, told in (("region[0].material.youngsmodulus=1e9", "did you mean youngs_modulus"),
                          ("region[3].material.youngs_modulus=1e9", "region has 2 elements"),
                          ("region[0].youngs_modulus=1e9", "region[0].youngs_modulus")):  # fmt: skip
            refused = self.sweep("--vary", key, case=ROOT / "cases/regions/bimaterial.toml", output=("--output", "refused"))
            self.assert_refused(refused, told)

    def test_a_refinement_is_extrapolated(self):
        # A bar whose surface effect falls with the spacing: converges to F L / (E A) with first order, by theory.
        case = ROOT / "cases/bar/tension.toml"
        run = self.sweep("--set", "lattice.spacing=4e-3", "--refine", "4", case=case)
        self.assert_ends(run, 0, *4 * ["done"])
        self.assertIn("probe:tip: order 1.0", run.output)
        with open(self.out / "refinement.csv", newline="") as table:
            rows = {row["quantity"]: row for row in csv.DictReader(table)}
        tip = rows["probe:tip"]
        self.assertEqual(tip["behaviour"], "monotone")
        self.assertAlmostEqual(float(tip["observed_order"]), 1.0, delta=0.01)
        self.assertAlmostEqual(float(tip["extrapolated"]) / 1e-3, 1.0, delta=1e-5)
        self.assertEqual([float(tip[f"spacing_{k}"]) for k in (1, 2, 3, 4)], [4e-3, 2e-3, 1e-3, 5e-4])
        self.assertEqual([row["probe:tip"] for row in self.rows()], [tip[f"value_{k}"] for k in (1, 2, 3, 4)])
        error = abs(float(tip["value_4"]) - 1e-3)
        self.assertLess(error, float(tip["uncertainty"]))
        self.assertLess(float(tip["uncertainty"]), 1.3 * error)
        self.assertEqual(rows["peak_reaction:left"]["behaviour"], "constant")
        self.assertGreater(matplotlib.image.imread(self.out / "refinement.png").std(), 0.01)
        # Files made from a table are removed with it.
        self.assert_ends(self.sweep("--vary", "loading.steps=1", case=case), 0, "done")
        self.assertFalse((self.out / "refinement.csv").exists())

    def test_a_refinement_refines_the_regions_of_finer_points_too(self):
        self.write("refined.toml", PATCH)
        coarse = ("--set", "lattice.spacing=8e-3", "--set", "lattice.refine[0].spacing=4e-3")
        self.assert_ends(self.sweep(*coarse, "--refine", "3", case="refined.toml"), 0, *3 * ["done"])
        spacings = [[float(row[key]) for key in ("lattice.spacing", "lattice.refine[0].spacing")] for row in self.rows()]
        self.assertEqual(spacings, [[8e-3, 4e-3], [4e-3, 2e-3], [2e-3, 1e-3]])
        with open(self.out / "refinement.csv", newline="") as table:
            stored = next(row for row in csv.DictReader(table) if row["quantity"] == "energy_stored")
        self.assertEqual([float(stored[f"spacing_{k}"]) for k in (1, 2, 3)], [8e-3, 4e-3, 2e-3])

    def test_spacings_of_a_refinement_are_in_m_whatever_the_units(self):
        run = self.sweep("--set", "lattice.spacing=4e-3", "--set", "units.length=mm", "--refine", "3", case=ROOT / "cases/bar/tension.toml")
        self.assert_ends(run, 0, *3 * ["done"])
        with open(self.out / "refinement.csv", newline="") as table:
            tip = next(row for row in csv.DictReader(table) if row["quantity"] == "probe:tip")
        for k, spacing in enumerate((4e-6, 2e-6, 1e-6), 1):
            self.assertAlmostEqual(float(tip[f"spacing_{k}"]) / spacing, 1.0, delta=1e-14)
        self.assertAlmostEqual(float(tip["extrapolated"]) / 1e-6, 1.0, delta=1e-3)
        refused = self.sweep("--set", 'lattice.spacing="4 mm"', "--refine", "3", case=ROOT / "cases/bar/tension.toml", output=("--output", "refused"))
        self.assert_refused(refused, "lattice.spacing is not a number", "unit")

    def test_a_refinement_in_which_a_run_fails_extrapolates_nothing(self):
        run = self.sweep("--refine", "3", "--vary", "solver.max_iterations=1,20", "--set", "loading.smallest_step=0.5")
        self.assert_code(run, 3)
        self.assertIn("nothing is extrapolated of 1: a lattice has no completed run", run.output)
        with open(self.out / "refinement.csv", newline="") as table:
            self.assertEqual({row["solver.max_iterations"] for row in csv.DictReader(table)}, {"20"})

    # ---- other endings ----------------------------------------------------------------------------

    def test_wrong_arguments_are_refused(self):
        for arguments, fragment in {
            (): "nothing is varied",
            ("--vary", "loading.steps"): "key=value1,value2",
            ("--vary", "=1,2"): "key=value1,value2",
            ("--vary", "loading.steps="): "a value is empty",
            ("--vary", "loading.steps=1,,2"): "a value is empty",
            ("--vary", "loading.steps=1,2,1"): "is given twice",
            ("--vary", "load[0].body_force=[0, 1"): "] is missing",
            ("--with", "loading.steps=1"): "needs a --vary before it",
            ("--vary", "loading.steps=1,2", "--with", "solver.max_iterations=1"): "has 1 values and loading.steps has 2",
            ("--vary", "loading.steps=1", "--with", "loading.steps=2"): "varied twice",
            ("--vary", "loading.steps=1", "--with", "solver.max_iterations:=1/0"): "no value",
            ("--vary", "loading.steps=1", "--with", "loading.smallest_step:=lattice.spaceing"): "is neither in the case file",
            ("--vary", "loading.steps:=1"): "computed by --with loading.steps:=EXPRESSION",
            ("--vary", "loading.steps=1", "--with", "lattice.horizon_ratio:=lattice.spacing*3e3", "--with",
             "lattice.spacing:=1e-3"): "computed later",
            ("--refine", "2"): "from 3 to 20",
            ("--refine", "many"): "from 3 to 20",
            ("--refine", "3", "--refine", "3"): "given twice",
            ("--refine", "3", "--ratio", "1"): "from 1.05 to 10",
            ("--refine", "3", "--vary", "lattice.spacing=1e-3"): "varied twice",
            ("--vary", "loading.steps=1", "--vary", "loading.steps=2"): "varied twice",
            ("--vary", "loading.steps=1", "--set", "loading.steps=2"): "both varied and set",
            ("--vary", "output.directory=a,b"): "output.directory",
            ("--vary", "loading.steps=1", "--threads", "many"): "--threads",
            ("--vary", "loading.steps=1", "--threads", "0"): "--threads",
            ("--vary", "loading.steps=1", "--wary"): "--wary",
            ("--vary", "loading.stepps=1,2"): "did you mean steps",
        }.items():
            with self.subTest(arguments=arguments):
                run = self.sweep(*arguments)
                self.assert_refused(run, fragment)
                self.assertNotIn("Traceback", run.errors)
                self.assertFalse(self.out.exists())
        self.assert_refused(self.sweep("--vary", "loading.steps=1", case="missing.toml"), "missing.toml")

    def test_wrong_input_stops_at_once(self):
        run = self.sweep("--vary", "loading.steps=1,0,2")
        self.assert_ends(run, 2, "done", "exit code 2")
        self.assertIn("loading.steps=0", run.errors)
        self.assertEqual(len(self.rows()), 1)

    def test_the_others_go_on_when_one_does_not_converge(self):
        self.assert_ends(self.sweep(*FIRST_FAILS), 3, "exit code 3: did not converge (iteration_limit", "done")
        failed, completed = self.rows()
        self.assertEqual((failed["status"], failed["exit_code"], failed["steps"]), ("not_converged", "3", "0"))
        for column in ("peak_reaction:left", "final_reaction:left", "energy_stored"):  # zeros would be no result
            self.assertEqual(failed[column], "")
        with h5py.File(self.out / "solver.max_iterations=1" / "results.h5") as file:
            self.assertEqual(list(file["steps"]), [])  # no fields are written for a body at rest
        self.assertEqual((completed["status"], completed["steps"]), ("completed", "1"))
        self.assertTrue((self.out / "sweep.png").exists())
        self.assert_ends(self.sweep(*FIRST_FAILS), 3, "exit code 3", "skipped")

    def test_figures_of_a_preload_are_told_though_the_load_fails(self):
        preloaded = ["support[1].displacement=['1e-5 + 9e-3*load', 0]", "solver.max_iterations=2", "loading.smallest_step=0.5"]
        run = self.sweep("--vary", "loading.steps=1", *settings(*preloaded))
        self.assert_ends(run, 3, "exit code 3: did not converge")
        row = self.rows()[0]
        self.assertEqual(row["steps"], "0")
        self.assertGreater(float(row["final_reaction:left"]), 0.0)
        with h5py.File(next(self.out.glob("*/results.h5"))) as file:
            self.assertEqual(list(file["steps"]), ["000000"])

    def test_what_does_not_fit_is_told_and_earlier_results_are_not_taken_for_it(self):
        self.sweep("--vary", "loading.steps=1")
        run = self.sweep("--vary", "loading.steps=1", "--set", "lattice.spacing=1e-8")
        self.assert_ends(run, 4, "exit code 4: out of memory (the case")
        (row,) = self.rows()
        self.assertEqual((row["status"], row["exit_code"], row["steps"]), ("out_of_memory", "4", ""))
        self.assertFalse((self.out / "sweep.png").exists())  # the earlier one is gone
        self.assert_ends(self.sweep("--vary", "loading.steps=1"), 0, "skipped")

    def interrupted(self, interrupt):
        """Ending and output of a sweep whose second combination, a long one, is interrupted."""
        process = self.start(self.words("strip.toml", "--vary", "loading.steps=1,100000,2", "--output", "out"),
                             start_new_session=True)  # fmt: skip
        second = self.out / "loading.steps=100000" / "history.csv"
        end = time.monotonic() + 60
        while not (second.exists() and second.read_text().count("\n") > 2):
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.02)
        interrupt(process)
        output = process.communicate(timeout=60)[0]
        return process.returncode, output

    def test_an_interrupt_ends_the_run_and_leaves_the_table(self):
        for interrupt in (lambda process: process.send_signal(signal.SIGINT),
                          lambda process: os.killpg(process.pid, signal.SIGINT)):  # fmt: skip
            if self.out.exists():
                shutil.rmtree(self.out)
            code, output = self.interrupted(interrupt)
            self.assertEqual(code, 130, output)
            self.assertNotIn("3/3", output)
            self.assertEqual([row["status"] for row in self.rows()], ["completed", "interrupted"])
            summary = json.loads((self.out / "loading.steps=100000" / "summary.json").read_text())
            self.assertEqual(summary["status"], "interrupted")  # it was interrupted once, and saved

    def test_what_was_interrupted_or_killed_is_gone_on_with(self):
        steps = "--vary", "loading.steps=150"
        folder = self.out / "loading.steps=150"
        self.assert_ends(self.sweep(*steps, output=("--output", "whole")), 0, "done")
        for interrupt in (lambda process: process.send_signal(signal.SIGINT), lambda process: process.kill()):
            shutil.rmtree(self.out, ignore_errors=True)
            process = self.start(self.words("strip.toml", *steps, "--output", "out"))
            while not ((folder / "history.csv").exists() and (folder / "history.csv").read_text().count("\n") > 3):
                self.assertIsNone(process.poll())
                time.sleep(0.02)
            interrupt(process)
            process.wait(timeout=60)
            time.sleep(0.3)  # until the kernel has ended a run whose sweep was killed
            first = next(path for path in (folder / "parts/000001.h5", folder / "results.h5") if path.exists())
            with h5py.File(first, "r+") as file:  # a run from the start would overwrite this
                fields = file["step"] if "step" in file else file["steps/000001"]
                fields["damage"][0] = 0.5
            self.assert_ends(self.sweep(*steps), 0, "done")
            with h5py.File(folder / "results.h5") as file, h5py.File(self.folder / "whole" / folder.name / "results.h5") as whole:
                self.assertEqual(file["steps/000001/damage"][0], 0.5)
                last = file["steps/000150/displacement"][...]
                self.assertLess(abs(last - whole["steps/000150/displacement"][...]).max(), 1e-12 * abs(last).max())
            self.assert_ends(self.sweep(*steps), 0, "skipped (done before)")

    def test_what_was_interrupted_with_other_settings_is_run_anew(self):
        words = "--vary", "loading.steps=20"
        self.peristat("run", "strip.toml", "--set", "loading.steps=20", "--set", "material.youngs_modulus=1e9",
                      "--stop-after", "3", "--output", "out/loading.steps=20")  # fmt: skip
        self.assert_ends(self.sweep(*words), 0, "done")
        with h5py.File(self.out / "loading.steps=20" / "results.h5") as file:
            self.assertIn("youngs_modulus = 2e+11", file["case/as_resolved"][()].decode())
            self.assertEqual(len(file["history/step"]), 21)  # step 0 and those of the load

    # ---- parallel jobs ------------------------------------------------------------------------------

    def expect_side_by_side(self, one_by_one):
        """They fill the same table."""
        run = self.sweep(*STIFFNESS_AND_STEPS, "--jobs", "2", "--threads", "1")
        self.assert_ends(run, 0, "done", "done", "done", "done")
        side_by_side = self.rows()
        for row in one_by_one + side_by_side:
            del row["seconds_total"], row["peak_memory_bytes"]
            for column, value in row.items():  # threads differ
                with contextlib.suppress(ValueError):
                    row[column] = float(f"{float(value):.6g}") if abs(float(value)) > 1e-9 else 0.0
        self.assertEqual(side_by_side, one_by_one)

    def test_two_sweeps_share_a_folder(self):
        words = "--vary", "loading.steps=30,31,32,33"
        both = [self.start(self.words("strip.toml", *words, "--output", "out", "--jobs", "2")) for _ in range(2)]
        told = [process.communicate(timeout=300) for process in both]
        self.assertEqual([process.returncode for process in both], [0, 0], told)
        output = "".join(output for output, _ in told)
        self.assertEqual(output.count(": done"), 4, output)
        self.assertEqual(output.count("skipped (done "), 4, output)
        self.assertEqual([row["steps"] for row in self.rows()], ["30", "31", "32", "33"])
        self.assertEqual([path.name for path in self.out.iterdir() if path.name.endswith(".tmp")], [])

    def test_more_jobs_than_processors_are_not_begun(self):
        run = self.sweep("--vary", "loading.steps=1,2", "--jobs", "1000")
        self.assert_ends(run, 0, "done", "done")
        self.assertIn(f"{len(os.sched_getaffinity(0))} at a time, not 1000", run.output)
        self.assert_ends(self.sweep("--vary", "loading.steps=1", "--jobs", "0"), 2)

    def test_a_killed_sweep_leaves_no_run_behind(self):
        code, _ = self.interrupted(lambda process: process.kill())
        self.assertEqual(code, -signal.SIGKILL)
        time.sleep(0.2)
        history = self.out / "loading.steps=100000" / "history.csv"
        size = history.stat().st_size
        time.sleep(0.5)
        self.assertEqual(history.stat().st_size, size)

    def test_help_tells_the_options(self):
        run = self.assert_completed(self.execute(self.words("--help")))
        for word in ("usage: peristat sweep", "--vary", "--set", "--output", "--threads", "--jobs"):
            self.assertIn(word, run.output)


if __name__ == "__main__":
    unittest.main()
