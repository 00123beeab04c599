"""Runs on several ranks: what they give is what one rank gives, and what they can't do they refuse."""

import csv
import os
import re
import signal
import subprocess
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy

ROOT = Path(__file__).parents[2]
PROGRAM = os.environ["PERISTAT_PROGRAM"]
# Root may run them, as in a container.
ENVIRONMENT = os.environ | {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMP_WAIT_POLICY": "passive",
}
SOLVER = """
[solver]
linear = "pcg"
preconditioner = "block_jacobi"
tangent = "matrix_free"
linear_tolerance = 1e-9
"""
PLATE = """
title = "plate with a hole"
dimension = 2
[lattice]
spacing = 0.05
thickness = 0.01
shape = [{ add = "box", min = [0, 0], max = [1, 1.5] }, { subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }]
layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
[[set]]
name = "corner"
where = "x > 0.6 && y > 1"
[material]
model = "bond"
youngs_modulus = 1e9
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
displacement = [0, "0.05*load"]
[[load]]
set = "corner"
body_force = ["1e6*load*y", 0]
[loading]
steps = 2
"""
BAR = """
dimension = 1
[lattice]
spacing = 0.1
area = 2.0
shape = [{ add = "box", min = [0], max = [4] }]
layer = [{ name = "left", side = "x-" }, { name = "right", side = "x+", thickness = 2 }]
[material]
model = "bond"
micromodulus = 7.0
[[support]]
set = "left"
displacement = [0]
[[support]]
set = "right"
displacement = ["0.3*load"]
"""
BLOCK = """
dimension = 3
[lattice]
spacing = 0.1
horizon_ratio = 2.015
perturbation = 0.1
seed = 7
shape = [{ add = "box", min = [0, 0, 0], max = [0.7, 0.6, 0.9] }, { subtract = "sphere", centre = [0.1, 0.1, 0.5], radius = 0.2 }]
layer = [{ name = "foot", side = "z-", thickness = 2 }]
[quadrature]
volume_correction = "linear"
surface_correction = "volume"
[material]
model = "bond"
youngs_modulus = 1e6
density = 2000
[[support]]
set = "foot"
displacement = [0, 0, 0]
[[load]]
gravity = ["0", "load*30", "-load*9.81"]
[loading]
table = [0, 1, 0.5]
"""
# Parts of it are thinner than the horizon.
SHORT_BAR = BAR.replace("max = [4]", "max = [0.3]").replace(', thickness = 2', ", thickness = 1")


class OnRanks(unittest.TestCase):
    def setUp(self):
        self.folder = Path(self.enterContext(tempfile.TemporaryDirectory()))

    def case(self, text):
        file = self.folder / "case.toml"
        file.write_text(text)
        return file

    def start(self, ranks, text, *options, threads=1):
        file = self.case(text)
        output = self.folder / f"on_{ranks}"
        words = [PROGRAM, "run", *(("--ranks", str(ranks)) if ranks > 1 else ()), str(file)]
        words += ["--threads", str(threads), "--output", str(output), "--overwrite", *options]
        run = subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True, timeout=100)
        return run, output

    def results(self, ranks, text, *options, **threads):
        run, output = self.start(ranks, text, *options, **threads)
        self.assertEqual(run.returncode, 0, run.stderr)
        return output

    def refusal(self, text, *options, ranks=2):
        run, output = self.start(ranks, text, *options)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertFalse(output.exists())
        return run.stderr


def children_of(process):
    return [int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def objects(file):
    names = []
    file.visit(names.append)
    return sorted(names)


def rows(output, table):
    with open(output / table, newline="") as file:
        return list(csv.DictReader(file))


class Comparing(OnRanks):
    def expect_same(self, one, several):
        with h5py.File(one / "results.h5") as expected, h5py.File(several / "results.h5") as found:
            names = [name for name in objects(expected) if name != "checkpoint"]
            self.assertEqual(names, objects(found))
            for name in names:
                if not isinstance(expected[name], h5py.Dataset) or name.startswith("iterations/"):
                    continue
                if name == "case/as_resolved" or name.startswith("case/settings"):
                    continue  # the folder
                self.expect_same_data(name, expected[name], found[name])

    def expect_same_data(self, name, expected, found):
        self.assertEqual((expected.shape, expected.dtype), (found.shape, found.dtype), name)
        self.assertEqual(dict(expected.attrs.items()).keys(), dict(found.attrs.items()).keys(), name)
        if expected.dtype.kind != "f":
            self.assertTrue(numpy.array_equal(expected[()], found[()]), name)
            return
        if name.endswith(("balance_error", "/reason", "pin_force")):
            return  # differences of large numbers
        scale = numpy.abs(expected[()]).max(initial=0)
        if name.startswith("history/") and name[-2:] in ("_x", "_y", "_z"):  # of a vector
            scale = max(numpy.abs(expected.parent[key][()]).max() for key in expected.parent if key[:-2] == name[8:-2])
        if name.startswith("history/reaction"):
            scale = max(numpy.abs(file[()]).max() for key, file in expected.parent.items() if "reaction" in key)
        difference = numpy.abs(expected[()] - found[()]).max(initial=0)
        self.assertLessEqual(difference, 1e-9 * scale, name)

    def expect_same_iterations(self, one, several):
        expected, found = rows(one, "iterations.csv"), rows(several, "iterations.csv")
        self.assertEqual(len(expected), len(found))
        for before, after in zip(expected, found):
            for key in ("step", "iteration", "rejected_trials", "step_length"):
                self.assertEqual(before[key], after[key])
            self.assertAlmostEqual(int(before["linear_iterations"]), int(after["linear_iterations"]), delta=1)

    def compare(self, text, ranks=(2, 3), *options):
        one = self.results(1, text + SOLVER, *options)
        for count in ranks:
            several = self.results(count, text + SOLVER, *options)
            with self.subTest(ranks=count):
                self.expect_same(one, several)
                self.expect_same_iterations(one, several)
        return one


class SameResults(Comparing):
    def test_a_bar(self):
        self.compare(BAR)

    def test_a_plate_with_a_hole(self):
        one = self.compare(PLATE, (2, 3, 4))
        self.assertEqual(len(rows(one, "history.csv")), 2)

    def test_a_perturbed_block_with_corrections_under_its_weight(self):
        self.compare(BLOCK)

    def test_pre_cracks(self):
        in_plane = PLATE + '[[crack]]\nfrom = [0, 1.02]\nto = [0.33, 1.05]\n[[crack]]\nfrom = [0.7, 0.3]\nto = [1, 0.3]\n'
        one = self.compare(in_plane, (2, 3, 4), "--set", "output.count_cracks=true")
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(file["steps/000002/damage"][()].max(), 0.2)
        in_space = BLOCK + "[[crack]]\nvertices = [[0, 0, 0.5], [0.4, 0, 0.5], [0.4, 0.6, 0.52], [0, 0.6, 0.52]]\n"
        one = self.compare(in_space, (3,))
        with h5py.File(one / "results.h5") as file:
            self.assertEqual(file["steps/000002/damage"][()].max(), 0.0)

    def test_a_body_thinner_than_the_horizon_and_ranks_without_a_point(self):
        self.compare(SHORT_BAR, (2, 3, 8))

    def test_keys_of_the_list(self):
        """Each on a body of its own, with other values than those of the other tests."""
        for text, settings in (
            (PLATE, ('lattice.origin="nodes"', "lattice.spacing=[0.05, 0.06]", 'material.plane="strain"')),
            (PLATE, ('solver.predictor="none"', "loading.adaptive=false", 'solver.preconditioner="jacobi"')),
            (PLATE, ("loading.largest_step=0.5", "loading.smallest_step=1e-3", "loading.table=[0, 0.5]",
                     "loading.table2=[0, 1]", 'load[0].body_force=["1e6*load2", "0"]')),
            (PLATE, ('load=[{set="corner", total_force=["1e4*load", "2e3"]}]', 'quadrature.surface_correction="energy"')),
            (PLATE, ('lattice.layer[1].where="x < 0.5"', 'lattice.shape[1].name="hole"', "dimension=2")),
        ):  # fmt: skip
            with self.subTest(settings=settings):
                self.compare(text, (3,), *(word for setting in settings for word in ("--set", setting)))

    def test_probes_of_sets(self):
        probes = """
            [[probe]]
            name = "moved"
            set = "corner"
            [[probe]]
            name = "pulled"
            set = "top"
            field = "force"
            component = "y"
            [[probe]]
            name = "least"
            set = "corner"
            field = "stretch"
            statistic = "min"
            [[probe]]
            name = "most"
            set = "corner"
            field = "energy_density"
            statistic = "max"
            [[probe]]
            name = "opened"
            set = "top"
            field = "opening"
            other = "corner"
            [[probe]]
            name = "off"
            set = "corner"
            statistic = "rms_error"
            expected = ["1e-3*load", "0.03*load*y"]
            [[probe]]
            name = "farthest"
            set = "corner"
            statistic = "max_error"
            expected = ["1e-3*load", "0.03*load*y"]
        """
        one = self.compare(PLATE + probes, (2, 4))
        last = rows(one, "history.csv")[-1]
        names = [name for name in last if "moved" in name or "opened" in name]
        self.assertEqual(len(names), 4)
        for name in (*names, "pulled", "least", "most", "off", "farthest"):
            found = [key for key in last if key.startswith(name) or key.endswith(":" + name)]
            self.assertTrue(found, (name, list(last)))
            self.assertNotEqual(float(last[found[0]]), 0.0)

    def test_steps_that_are_cut(self):
        few = ("--set", "solver.max_iterations=3", "--set", "loading.steps=1")
        one = self.compare(PLATE.replace("0.05*load", "0.3*load"), (2, 3), *few)
        self.assertIn("cut", [row["action"] for row in rows(one, "decisions.csv")])

    def test_fields_of_some_steps_only(self):
        text = PLATE.replace("steps = 2", "steps = 3") + "[output]\nevery = 2\n"
        one = self.compare(text, (3,))
        with h5py.File(one / "results.h5") as file:
            self.assertEqual(list(file["steps"]), ["000002", "000003"])

    def test_automatic_choices(self):
        one = self.results(1, PLATE)
        several = self.results(2, PLATE, "--set", "solver.relative_tolerance=1e-12")
        self.expect_same_displacements(one, several)

    def expect_same_displacements(self, one, several):
        with h5py.File(one / "results.h5") as expected, h5py.File(several / "results.h5") as found:
            u = expected["steps/000002/displacement"][()]
            difference = numpy.abs(u - found["steps/000002/displacement"][()]).max()
            self.assertLess(difference, 1e-9 * numpy.abs(u).max())

    def test_threads_of_ranks(self):
        one = self.results(1, PLATE + SOLVER)
        self.expect_same(one, self.results(2, PLATE + SOLVER, threads=2))

    def test_ranks_of_mpirun(self):
        one = self.results(1, PLATE + SOLVER)
        output = self.folder / "of_mpirun"
        words = ["mpirun", "--oversubscribe", "-np", "3", PROGRAM, "run", str(self.folder / "case.toml")]
        run = subprocess.run([*words, "--output", str(output)], env=ENVIRONMENT, capture_output=True, text=True, timeout=100)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.expect_same(one, output)
        self.assertEqual(run.stdout.count("completed in"), 1)


class Bodies(Comparing):
    """Shipped cases, coarser, and small bodies: what they are made of is the same on all ranks."""

    def compare_shipped(self, case, *settings, ranks=(2, 3)):
        text = (ROOT / "cases" / f"{case}.toml").read_text()
        words = ('solver.linear="pcg"', 'solver.preconditioner="block_jacobi"', "solver.linear_tolerance=1e-9", *settings)
        options = [word for setting in words for word in ("--set", setting)]
        one = self.results(1, text, *options)
        for count in ranks:
            several = self.results(count, text, *options)
            with self.subTest(case=case, ranks=count):
                self.expect_same(one, several)
                self.expect_same_iterations(one, several)
        return one

    def compare_settings(self, text, *settings, ranks=(3,)):
        with self.subTest(settings=settings):
            return self.compare(text, ranks, *(word for setting in settings for word in ("--set", setting)))

    def test_several_materials(self):
        self.compare_shipped("regions/bimaterial", "lattice.spacing=0.01")
        # A third solution would be of round-off, with as many iterations as that gives.
        self.compare_shipped("regions/composite", "lattice.spacing=1e-3", "solver.relative_tolerance=1e-7")

    def test_interfaces_and_random_fields(self):
        two = ('region=[{set="corner", material={youngs_modulus=1e8, scatter=[{of="stiffness", distribution="weibull", '
               'weibull_modulus=5, correlation_length=0.2, seed=3}]}}]',)  # fmt: skip
        one = self.compare_settings(PLATE, *two, 'interface=[{between=["corner", "material"], rule="arithmetic"}]')
        with h5py.File(one / "results.h5") as file:
            self.assertIn("stiffness_factor", "".join(objects(file)))
        self.compare_settings(PLATE, *two, 'interface=[{between=["corner", "material"], material={youngs_modulus=5e8}}]')

    def test_influences_shares_and_shapes(self):
        self.compare_settings(PLATE, 'material.influence="gaussian"', 'material.calibration="lattice"',
                              'quadrature.volume_correction="exact"', 'quadrature.surface_correction="energy"')  # fmt: skip
        self.compare_settings(PLATE, 'quadrature.horizon_shape="box"', 'quadrature.surface_correction="energy"')
        self.compare_settings(PLATE, 'material.potential="harmonic"', 'quadrature.volume_correction="exact_centroids"')

    def test_lattices(self):
        self.compare_settings(PLATE, "lattice.angle=20", 'quadrature.surface_correction="volume"', ranks=(2, 3))
        self.compare_settings(PLATE, "lattice.angle=20", 'lattice.volumes="fractional"',
                              'quadrature.volume_correction="linear"', ranks=(2, 4))  # fmt: skip
        self.compare_settings(PLATE, "lattice.cell_perturbation=0.2", 'quadrature.volume_correction="exact"')

    def test_points_from_a_file(self):
        rows = ["x, y, volume, set"]
        for k in range(20):
            for j in range(9):
                name = "bottom" if k < 3 else "top" if k > 16 else ""
                rows.append(f"{0.05*j + 0.01*((7*k + 3*j) % 5)}, {0.05*k + 0.004*((5*k + j) % 7)}, {2.5e-5*(1 + 0.1*(k % 3))}, {name}")
        rows[1:] = rows[:0:-1]
        (self.folder / "points.csv").write_text("\n".join(rows))
        text = PLATE.split("[lattice]")[0] + '[points]\nfile = "points.csv"\nthickness = 0.01\nhorizon = 0.16\n' + \
            "[[set]]\nname = \"corner\"\nwhere = \"x > 0.2 && y > 0.5\"\n[material]" + PLATE.split("[material]")[1]
        self.compare_settings(text, 'quadrature.volume_correction="linear"', ranks=(2, 3))

    def test_loads(self):
        side = 'load=[{side="x+", traction=["1e5*load*y", "2e5"]}]'
        self.compare_settings(PLATE, side, ranks=(2, 3))
        self.compare_settings(PLATE, side.replace('"2e5"]', '"2e5"], depth="horizon"'))
        self.compare_settings(PLATE, 'set=[{name="corner", where="y > 1.45 && y < 1.5"}]', 'load=[{set="corner", traction=["1e5*load", "0"]}]')

    def test_temperatures(self):
        case = (ROOT / "cases/thermal/bimetal.toml").read_text()
        held = '[[support]]\nset = "steel"\ndisplacement = [0, "free"]\n[[support]]\nset = "middle"\ndisplacement = ["free", 0]\n[[support]]\nset = "tip"\ndisplacement = [0, "free"]\n'
        case = case.split("[[symmetry]]")[0] + held + "[[probe]]" + case.split("[[probe]]")[1]
        case = case.replace("0.04", "0.02").replace("spacing = 1e-4", "spacing = 5e-4")
        one = self.compare(case, (2, 3), "--set", "loading.table=[0, 1, 0.5]")
        self.assertGreater(float(rows(one, "history.csv")[0]["max_stretch"]), 1e-4)
        self.compare_settings(PLATE, 'eigenstrain=[{set="corner", strain="0.01*load*x"}]')


class Ends(OnRanks):
    def test_a_search_that_does_not_converge(self):
        options = ("--set", "solver.max_iterations=1", "--set", "loading.adaptive=false")
        codes, statuses = [], []
        for ranks in (1, 3):
            run, output = self.start(ranks, PLATE + SOLVER, *options)
            codes.append(run.returncode)
            self.assertIn('"not_converged"', (output / "summary.json").read_text())
            statuses.append([row["outcome"] for row in rows(output, "decisions.csv")])
        self.assertEqual(codes, [3, 3])
        self.assertEqual(statuses[0], statuses[1])

    def test_a_run_that_is_stopped(self):
        run, output = self.start(2, PLATE + SOLVER, "--stop-after", "1")
        self.assertEqual(run.returncode, 130, run.stderr)
        self.assertEqual(len(rows(output, "history.csv")), 1)
        again = subprocess.run([PROGRAM, "resume", str(output)], capture_output=True, text=True, timeout=60)
        self.assertEqual(again.returncode, 2, again.stderr)

    def test_what_one_rank_alone_meets_ends_all(self):
        broken = PLATE.replace('"0.05*load"', '"0.05*load*(x > 0.96 ? 1/(1-load) : 1)"')
        said = self.refusal(broken)
        self.assertIn("it must be finite", said)
        self.assertEqual(said.count("peristat:"), 1)

    def test_a_value_that_one_rank_alone_misses_on_the_way(self):
        missing = PLATE.replace('"0.05*load"', '"0.05*load*(x > 0.96 ? (load-0.25)/(load-0.25) : 1)"')
        outcomes = []
        for ranks in (1, 2):
            output = self.results(ranks, missing.replace("steps = 2", "steps = 4") + SOLVER)
            outcomes.append([(row["outcome"], row["reason"]) for row in rows(output, "decisions.csv")])
        self.assertEqual(outcomes[0][0], outcomes[1][0])
        self.assertIn("undefined_condition", outcomes[0][0])

    def test_a_folder_that_can_not_be_written(self):
        (self.folder / "on_2").write_text("in the way")
        run, _ = self.start(2, PLATE)
        self.assertEqual(run.returncode, 2, run.stderr)
        self.assertIn("is a file", run.stderr)

    def test_a_rank_that_is_killed_ends_all(self):
        file = self.case(PLATE.replace("spacing = 0.05", "spacing = 0.004").replace("steps = 2", "steps = 50") + SOLVER)
        words = [PROGRAM, "run", "--ranks", "2", str(file), "--threads", "1", "--output", str(self.folder / "out")]
        run = subprocess.Popen(words, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            ranks = self.wait_for_ranks(run.pid)
            os.kill(ranks[-1], signal.SIGKILL)
            self.assertNotEqual(run.wait(timeout=20), 0)
            for rank in ranks:
                self.assertFalse(Path(f"/proc/{rank}/exe").exists())
        finally:
            run.kill()
            run.wait()

    def test_an_interruption_ends_a_run_in_order(self):
        file = self.case(PLATE.replace("spacing = 0.05", "spacing = 0.01").replace("steps = 2", "steps = 500") + SOLVER)
        words = [PROGRAM, "run", "--ranks", "2", str(file), "--threads", "1", "--output", str(self.folder / "out")]
        run = subprocess.Popen(words, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        try:
            self.wait_for_ranks(run.pid)
            run.send_signal(signal.SIGINT)
            said = run.communicate(timeout=60)[1]
            self.assertEqual(run.returncode, 130, said)
            self.assertIn("interrupted", said)
            self.assertIn('"interrupted"', (self.folder / "out/summary.json").read_text())
        finally:
            run.kill()
            run.wait()

    def wait_for_ranks(self, launcher):
        """Process numbers, once results are there."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            time.sleep(0.05)
            if not (self.folder / "out/results.h5").exists():
                continue
            mpirun = children_of(launcher)
            ranks = children_of(mpirun[0]) if mpirun else []
            if len(ranks) == 2:
                return ranks
        self.fail("no ranks")


class Page(OnRanks):
    """docs/cluster.md"""

    def test_counts_of_messages(self):
        lines = (ROOT / "docs/cluster.md").read_text().splitlines()
        first = next(k for k, line in enumerate(lines) if "cases/plate_with_hole/elastic.toml --ranks N` |" in line)
        table = [[cell.strip() for cell in lines[k].strip("|").split("|")] for k in range(first, first + 6)]
        case = (ROOT / "cases/plate_with_hole/elastic.toml").read_text()
        for column, ranks in enumerate(table[0][1:], 1):
            run, _ = self.start(int(ranks), case, "--set", "loading.steps=1")
            points, ghosts, messages, size = (row[column] for row in table[2:])
            self.assertIn(f"at most {points} points on a rank, {ghosts} ghosts", run.stdout)
            self.assertIn(f"{messages} messages, {size} bytes each", run.stdout.replace("\n    ", " "))

    def test_the_list_of_keys_is_that_of_the_program(self):
        page = (ROOT / "docs/cluster.md").read_text().split("## What runs")[1].split("\nThe list is")[0]
        source = (ROOT / "cases/runner/build/part_body.cpp").read_text()
        listed = source.split("keys_of_ranks{")[1].split("};")[0]
        keys = re.findall(r'"([^"]+)"', listed)
        self.assertGreater(len(keys), 30)
        for key in keys:
            with self.subTest(key=key):
                table, _, name = key.rpartition(".")
                shown = [f"`{name}"] if name else [f"[[{table}]]", f"`[{table}]`", f"`{table.rpartition('.')[2]}`"]
                self.assertTrue(any(text in page for text in shown))


class Refusals(OnRanks):
    def test_keys_that_are_not_on_the_list(self):
        for key in (
            'solver.mode="adaptive"',
            'solver.mode="arc_length"',
            'solver.mode="path"',
            'solver.mode="dynamics"',
            'solver.linear="cholesky"',
            'solver.preconditioner="rigid_pieces"',
            'solver.tangent="stored"',
            'solver.operator="fft"',
            'solver.fragments="stop"',
            "output.stress=true",
            'material.model="cpd"',
            'material.kinematics="linear"',
            'material.damage={law="critical_stretch", critical=0.1}',
            'lattice.points="blue_noise"',
            'rigid=[{set="corner"}]',
            'symmetry=[{axis="x", at=0}]',
            'foundation=[{name="f", set="corner", stiffness=[1, 1]}]',
            'load=[{side="x+", pressure="1"}]',
            'roller=[{set="corner", normal=[1, 0]}]',
            'control=[{set="corner", weights=[1, 0]}]',
            'probe=[{name="p", at=[0.5, 1]}]',
            'probe=[{name="p", from=[0.5, 1], to=[0.5, 1.4]}]',
            'probe=[{name="p", set="corner", field="crack_length"}]',
            'probe=[{name="p", set="corner", field="damage"}]',
            "relaxation.steps=2",
        ):
            with self.subTest(key=key):
                said = self.refusal(PLATE, "--set", key)
                self.assertIn(key.split("=")[0].split(".")[0], said)
                self.assertEqual(said.count("peristat:"), 1)

    def test_what_one_rank_refuses_too(self):
        for ranks in (1, 2):
            for text, what in (
                (PLATE.replace('set = "top"', 'set = "no"'), "no set"),
                (PLATE.replace('where = "x > 0.6', 'where = "x > 6'), "selects no point"),
                (PLATE.replace("displacement = [0, 0]", 'displacement = [0, "free"]')
                 .replace('[0, "0.05*load"]', '[0, "free"]'), "move along y"),
                (BAR + '[[support]]\nset = "left"\ndisplacement = [1]\n', "contradict"),
            ):  # fmt: skip
                with self.subTest(ranks=ranks, what=what):
                    self.assertIn(what, self.refusal(text, ranks=ranks))

    def test_bodies_of_two_pieces(self):
        apart = PLATE.replace('{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
                              '{ subtract = "box", min = [-1, 0.5], max = [2, 0.8] }')  # fmt: skip
        self.assertIn("2 of this one", self.refusal(apart))

    def test_points_on_too_few_bonds(self):
        chain = PLATE.replace("shape = [{", 'shape = [{ add = "box", min = [1, 1], max = [1.2, 1.04] }, {')
        said = [self.refusal(chain, ranks=ranks) for ranks in (1, 2)]
        for text in said:
            self.assertIn("too few bonds", text)

    def test_another_number_of_ranks_than_was_started(self):
        words = ["mpirun", "--oversubscribe", "-np", "2", PROGRAM, "run", "--ranks", "3", str(self.case(PLATE))]
        run = subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True, timeout=60)
        self.assertEqual(run.returncode, 2)
        self.assertIn("does not agree with the 2", run.stderr)

    def test_other_commands(self):
        file = self.case(PLATE)
        words = ["mpirun", "--oversubscribe", "-np", "2", PROGRAM, "check", str(file)]
        run = subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True, timeout=60)
        self.assertEqual(run.returncode, 2)
        self.assertIn("no command but run", run.stderr)


if __name__ == "__main__":
    unittest.main()
