"""Runs on several ranks: what they give is what one rank gives, and what they can't do they refuse."""

import csv
import json
import os
import re
import resource
import shutil
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
# Triangles, in large steps; the hole is narrower than two horizons.
SQUARE = """
dimension = 2
[lattice]
spacing = 0.1
horizon_ratio = 2.415
shape = [{ add = "box", min = [0, 0], max = [1.2, 1] }, { subtract = "box", min = [0.5, 0.4], max = [0.8, 0.6] }]
layer = [{ name = "held", side = "x-", thickness = 2 }, { name = "pulled", side = "x+", thickness = 2 }]
[material]
model = "cpd"
c1 = 1.0
c2 = 30.0
[[support]]
set = "held"
displacement = [0, 0]
[[support]]
set = "pulled"
displacement = ["0.4*load", "0.1*load"]
[loading]
steps = 2
"""
CUBE = """
dimension = 3
[lattice]
spacing = 0.1
horizon_ratio = 1.815
perturbation = 0.05
shape = [{ add = "box", min = [0, 0, 0], max = [0.6, 0.4, 0.5] }]
layer = [{ name = "held", side = "x-" }, { name = "pulled", side = "x+" }]
[material]
model = "cpd"
c1 = 1.0
c2 = 100.0
c3 = 1e6
[[support]]
set = "held"
displacement = [0, 0, 0]
[[support]]
set = "pulled"
displacement = ["0.2*load", 0, "0.05*load"]
[loading]
steps = 1
"""
# A dilatation per point, which neighbours of ghosts tell.
STATES = PLATE.replace('model = "bond"', 'model = "lps"\nplane = "strain"\npoisson_ratio = 0.4') + """
[quadrature]
form = "energy"
volume_correction = "linear"
"""
STORED = SOLVER.replace("matrix_free", "stored")
# Thin and long, with a notch, under a load at its end.
BEAM = """
dimension = 3
[lattice]
spacing = 0.1
shape = [{ add = "box", min = [0, 0, 0], max = [0.2, 0.3, 4] }, { subtract = "box", min = [-1, 0.1, 1.9], max = [1, 1, 2.1] }]
layer = [{ name = "held", side = "z-" }, { name = "end", side = "z+", thickness = 1 }]
[material]
model = "bond"
youngs_modulus = 1e6
[[support]]
set = "held"
displacement = [0, 0, 0]
[[load]]
set = "end"
total_force = ["1e-3*load", "1e-3*load", "load"]
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


def nine_digits(text):
    return re.sub(r"\d+\.\d+(e[-+]?\d+)?", lambda number: f"{float(number[0]):.9g}", text)


class Comparison(OnRanks):
    def expect_same(self, one, several):
        with h5py.File(one / "results.h5") as expected, h5py.File(several / "results.h5") as found:
            names = objects(expected)
            self.assertEqual(names, objects(found))
            for name in names:
                if name == "checkpoint":
                    continue  # of seconds, too
                if not isinstance(expected[name], h5py.Dataset) or name.startswith("iterations/"):
                    continue
                if name == "case/as_resolved" or name.startswith("case/settings"):
                    continue  # the folder
                self.expect_same_data(name, expected[name], found[name])

    def expect_same_data(self, name, expected, found):
        self.assertEqual((expected.shape, expected.dtype), (found.shape, found.dtype), name)
        self.assertEqual(dict(expected.attrs.items()).keys(), dict(found.attrs.items()).keys(), name)
        if name == "decisions/reason":  # numbers in them have all their digits
            self.assertEqual(*([nine_digits(text) for text in data.asstr()[()]] for data in (expected, found)))
            return
        if expected.dtype.kind != "f":
            self.assertTrue(numpy.array_equal(expected[()], found[()]), name)
            return
        if name.endswith(("balance_error", "/reason", "pin_force")):
            return  # differences of large numbers
        scale = numpy.abs(expected[()]).max(initial=0)
        if name.startswith("history/") and name[-2:] in ("_x", "_y", "_z"):  # of a vector
            scale = max(numpy.abs(expected.parent[key][()]).max() for key in expected.parent if key[:-2] == name[8:-2])
        if name.startswith(("history/reaction", "history/momentum")):
            kind = name.split("_")[0].split("/")[1]
            scale = max(numpy.abs(file[()]).max() for key, file in expected.parent.items() if kind in key)
        difference = numpy.abs(expected[()] - found[()]).max(initial=0)
        self.assertLessEqual(difference, 1e-9 * scale, name)

    def expect_same_iterations(self, one, several):
        expected, found = rows(one, "iterations.csv"), rows(several, "iterations.csv")
        self.assertEqual(len(expected), len(found))
        for before, after in zip(expected, found):
            for key in ("step", "iteration", "rejected_trials", "step_length"):
                self.assertEqual(before[key], after[key])
            self.assertAlmostEqual(int(before["linear_iterations"]), int(after["linear_iterations"]), delta=1)

    def compare(self, text, ranks=(2, 3), *options, solver=SOLVER):
        one = self.results(1, text + solver, *options)
        for count in ranks:
            several = self.results(count, text + solver, *options)
            with self.subTest(ranks=count):
                self.expect_same(one, several)
                self.expect_same_iterations(one, several)
        return one


class SameResults(Comparison):
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
            (PLATE, ('solver.tangent="stored"',)),
            (PLATE, ("loading.largest_step=0.5", "loading.smallest_step=1e-3", "loading.table=[0, 0.5]",
                     "loading.table2=[0, 1]", 'load[0].body_force=["1e6*load2", "0"]')),
            (PLATE, ('load=[{set="corner", total_force=["1e4*load", "2e3"]}]', 'quadrature.surface_correction="energy"')),
            (PLATE, ('lattice.layer[1].where="x < 0.5"', 'lattice.shape[1].name="hole"', "dimension=2")),
        ):  # fmt: skip
            with self.subTest(settings=settings):
                self.compare(text, (3,), *(word for setting in settings for word in ("--set", setting)))

    def test_triangles(self):
        one = self.compare(SQUARE, (2, 3, 4), solver=STORED)
        self.expect_same_counts(one, 4)
        thin = ("--set", "lattice.shape=[{add=\"box\", min=[0, 0], max=[0.4, 0.2]}]")
        self.compare(SQUARE, (3,), *thin, "--set", 'quadrature.weights="bulk"', solver=STORED)
        moduli = ("--set", "material={model=\"cpd\", youngs_modulus=2e9, poisson_ratio=0.25, influence=\"gaussian\"}")
        self.compare(SQUARE, (2,), *moduli, solver=STORED)  # its c2 is negative

    def test_tetrahedra(self):
        one = self.compare(CUBE, (2, 3), solver=STORED)
        self.expect_same_counts(one, 3)

    def test_states(self):
        self.compare(STATES, (2, 3, 4), solver=STORED)
        block = BLOCK.replace('model = "bond"', 'model = "lps"\npoisson_ratio = 0.3').replace(
            'surface_correction = "volume"', 'form = "energy"')
        self.compare(block, (3,), "--set", 'material.influence="gaussian"', solver=STORED)

    def expect_same_counts(self, one, ranks):
        expected, found = (json.loads((folder / "summary.json").read_text()) for folder in (one, self.folder / f"on_{ranks}"))
        self.assertGreater(expected["triangles"], 0)
        for kind in ("bonds", "triangles", "tetrahedra"):
            self.assertEqual(expected.get(kind), found.get(kind), kind)

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

    def test_probes_at_places_and_along_lines_and_of_stress(self):
        probes = """
            [[probe]]
            name = "place"
            at = [0.77, 0.3]
            [[probe]]
            name = "pulled"
            at = [0.02, 1.4]
            field = "stress"
            [[probe]]
            name = "row"
            from = [0.1, 1.2]
            to = [0.9, 1.0]
            field = "strain"
            component = "yy"
            [[probe]]
            name = "upright"
            from = [0.5, 1.0]
            to = [0.5, 1.4]
            [[probe]]
            name = "hardest"
            set = "corner"
            field = "von_mises"
            statistic = "max"
            [[probe]]
            name = "ratio"
            set = "corner"
            field = "poisson_ratio"
            axis = "y"
            [[probe]]
            name = "divergence"
            set = "top"
            field = "divergence"
            [[probe]]
            name = "crack"
            set = "corner"
            field = "crack_length"
            axis = "x"
            [[output]]
        """
        text = PLATE + probes.replace("[[output]]", "[output]\nstress = true")
        one = self.compare(text, (2, 3, 4))
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(numpy.abs(file["steps/000002/cauchy_stress"]).max(), 1e6)
            self.assertEqual(len(file["lines/row/point"]), 2 * len(set(file["lines/row/point"])))
            self.assertGreater(len(file["lines/row/point"]), 20)
        last = rows(one, "history.csv")[-1]
        for name in ("place_y", "pulled_yy", "hardest", "ratio", "divergence"):
            self.assertNotEqual(float(last[name]), 0.0, name)

    def test_stress_in_three_dimensions_and_of_a_bar_shorter_than_the_horizon(self):
        stress = "[output]\nstress = true\n"
        probe = '[[probe]]\nname = "ratio"\nset = "foot"\nfield = "poisson_ratio"\naxis = "z"\n'
        self.compare(BLOCK + stress + probe, (3,))
        self.compare(SHORT_BAR + stress, (8,))

    def test_steps_that_are_cut(self):
        few = ("--set", "solver.max_iterations=3", "--set", "loading.steps=1")
        one = self.compare(PLATE.replace("0.05*load", "0.3*load"), (2, 3), *few)
        self.assertIn("cut", [row["action"] for row in rows(one, "decisions.csv")])

    def test_fields_of_some_steps_only(self):
        text = PLATE.replace("steps = 2", "steps = 3") + "[output]\nevery = 2\n"
        one = self.compare(text, (3,))
        with h5py.File(one / "results.h5") as file:
            self.assertEqual(list(file["steps"]), ["000002", "000003"])

    def test_operators(self):
        for operator in ("auto", "bonds"):
            self.compare(PLATE, (2,), "--set", f'solver.operator="{operator}"')

    def test_automatic_choices(self):
        one = self.results(1, PLATE)
        run, several = self.start(2, PLATE, "--set", "solver.relative_tolerance=1e-12")
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("rigid pieces", run.stdout)
        self.assertIn("factorisations and sines are for one rank", run.stdout.replace("\n    ", " "))
        self.expect_same_displacements(one, several)

    def test_rigid_pieces(self):
        """Of a body whose pieces stand on several ranks, and of one that is thinner than the horizon."""
        for text in (BLOCK, BEAM):
            self.compare(text, (2, 3, 4), "--set", 'solver.preconditioner="rigid_pieces"')

    def test_other_linear_solvers(self):
        one = self.results(1, PLATE + SOLVER)
        for solver, preconditioner in (
            ("pcg", "surrogate"), ("pcg", "multigrid"), ("pcg", "riluk"), ("pcg", "chebyshev"),
            ("minres", "rigid_pieces"), ("gmres", "surrogate"),
        ):  # fmt: skip
            with self.subTest(solver=solver, preconditioner=preconditioner):
                settings = f'solver.linear="{solver}"', f'solver.preconditioner="{preconditioner}"', 'solver.tangent="auto"'
                several = self.results(3, PLATE + SOLVER, *(word for text in settings for word in ("--set", text)))
                self.expect_same(one, several)

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


class Motions(Comparison):
    """Explicit steps: waves, supports and loads that move, layers that absorb."""

    MOVING = (
        PLATE.replace('"0.05*load"', '"1e-3*sin(2000*t)"')
        .replace('["1e6*load*y", 0]', '["1e6*t*2000*y", "1e5*exp(-t*5000)"]')
        .replace("youngs_modulus", "density = 1000\nyoungs_modulus")
        .replace("[loading]\nsteps = 2\n", "")
    )
    STEPS = """
        [solver]
        mode = "dynamics"
        [dynamics]
        end_time = 1e-3
        history_every = 2
        [[initial]]
        set = "corner"
        velocity = ["0.1", "0.2*x"]
        displacement = ["1e-4*exp(-(y - 1.2)^2*50)", "0"]
        [[absorbing]]
        rate = "x < 0.3 ? 3000*(0.3 - x) : 0"
        [output]
        every = 6
        [[probe]]
        name = "swing"
        set = "corner"
        field = "velocity"
        component = "y"
    """

    def move(self, text, ranks=(2, 3), *options):
        return self.compare(text, ranks, *options, solver="")

    def test_a_plate_whose_supports_and_loads_move(self):
        one = self.move(self.MOVING + self.STEPS, (2, 3, 4))
        last = rows(one, "history.csv")[-1]
        for name in ("kinetic_energy", "external_work", "drained_energy", "momentum_x", "swing"):
            self.assertNotEqual(float(last[next(key for key in last if key.startswith(name))]), 0.0, name)

    def test_given_steps_and_a_row_each(self):
        self.move(self.MOVING + self.STEPS, (3,), "--set", "dynamics.time_step=5e-6", "--set", "dynamics.history_every=1",
                  "--set", "dynamics.end_time=1e-4", "--set", "output.every=7")  # fmt: skip

    def test_a_free_body_and_ranks_without_a_point(self):
        bar = """
            dimension = 1
            [lattice]
            spacing = 0.1
            area = 2.0
            shape = [{ add = "box", min = [0], max = [0.5] }]
            [material]
            model = "bond"
            micromodulus = 7.0
            density = 3.0
            [solver]
            mode = "dynamics"
            [dynamics]
            end_time = 3.0
            [[initial]]
            velocity = ["0.01*x + 0.1"]
        """
        self.move(bar, (2, 7))

    def test_two_pieces(self):
        apart = self.MOVING.replace('{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
                                    '{ subtract = "box", min = [-1, 0.5], max = [2, 0.8] }')  # fmt: skip
        self.move(apart + self.STEPS, (3,))

    def test_a_block_under_its_weight(self):
        block = BLOCK.replace("load*", "").replace("[loading]\ntable = [0, 1, 0.5]", "")
        self.move(block + """
            [solver]
            mode = "dynamics"
            [dynamics]
            end_time = 0.05
            step_share = 0.5
            history_every = 5
        """, (2, 3))  # fmt: skip

    def test_a_wave(self):
        wave = (ROOT / "cases/bond_models/wave_propagation.toml").read_text()
        wave = wave.replace("[[initial]]", '[[initial]]\nvelocity = ["0.1", "0.05*x"]')  # a momentum
        self.move(wave, (2, 3), "--set", "lattice.spacing=0.1", "--set", "dynamics.end_time=0.6")

    def test_steps_that_are_refused(self):
        for ranks in (1, 2):
            said = self.refusal(self.MOVING + self.STEPS, "--set", "dynamics.time_step=1e-3", ranks=ranks)
            self.assertIn("longer than the stable step", said)
            said = self.refusal(self.MOVING + self.STEPS.replace("0.2*x", "x > 0.96 ? 1/0 : 0"), ranks=ranks)
            self.assertIn("it must be finite", said)

    def ends_of(self, text, *options):
        found = []
        for ranks in (1, 2, 3):
            run, output = self.start(ranks, text, *options)
            decision = rows(output, "decisions.csv")[-1]
            found.append((run.returncode, decision["outcome"], decision["reason"], decision["stage"]))
        self.assertEqual(found[0], found[1])
        self.assertEqual(found[0], found[2])
        return found[0]

    def test_a_load_without_a_value_on_one_rank(self):
        missing = self.MOVING.replace('"1e5*exp(-t*5000)"', '"x > 0.96 && t > 4e-4 && t < 4.5e-4 ? 1/0 : 0"')
        code, outcome, reason, _ = self.ends_of(missing + self.STEPS)
        self.assertEqual((code, outcome), (3, "undefined_condition"))
        self.assertIn("finite", reason)

    def test_a_support_without_a_value_on_one_rank(self):
        missing = self.MOVING.replace('"1e-3*sin(2000*t)"', '"x > 0.96 && t > 4e-4 && t < 4.5e-4 ? 1/0 : 0"')
        self.assertEqual(self.ends_of(missing + self.STEPS)[1], "undefined_condition")

    def test_a_run_that_is_stopped_and_goes_on(self):
        whole = self.results(1, self.MOVING + self.STEPS).rename(self.folder / "whole")
        run, output = self.start(2, self.MOVING + self.STEPS, "--stop-after", "3")
        self.assertEqual(run.returncode, 130, run.stderr)
        self.assertEqual(len(rows(output, "history.csv")), 3)
        again = resume(3, output)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.expect_same(whole, output)


def resume(ranks, output, *options):
    words = [PROGRAM, "resume", str(output), *(("--ranks", str(ranks)) if ranks > 1 else ()), "--threads", "1", *options]
    return subprocess.run(words, env=ENVIRONMENT, capture_output=True, text=True, timeout=100)


def entries_of_checkpoint(file):
    """Names and sizes of what it holds, as they stand at its begin."""
    head, rest = file["checkpoint"][()].tobytes().split(b"\n", 1)
    return head, rest[24 : 24 + int.from_bytes(rest[:8], "little")].decode()


class GoesOn(Comparison):
    """On another number of ranks than before."""

    TEXT = PLATE.replace("steps = 2", "steps = 4") + SOLVER

    def stopped(self, ranks, text, *options):
        run, output = self.start(ranks, text, "--stop-after", "2", *options)
        self.assertEqual(run.returncode, 130, run.stderr)
        self.assertEqual(len(rows(output, "history.csv")), 2)
        self.assertIn("peristat resume", run.stderr)
        return output

    def goes_on(self, ranks, output, whole, *options):
        folder = self.folder / f"{output.name}_resumed_on_{ranks}"
        shutil.copytree(output, folder)
        run = resume(ranks, folder, *options)
        self.assertEqual(run.returncode, 0, run.stderr)
        self.assertIn("going on after step 2", run.stdout)
        self.expect_same(whole, folder)
        self.expect_same_iterations(whole, folder)
        with h5py.File(whole / "results.h5") as expected, h5py.File(folder / "results.h5") as found:
            self.assertEqual(entries_of_checkpoint(expected), entries_of_checkpoint(found))
        self.assertFalse((folder / "parts").exists())

    def whole(self, text):
        output = self.results(1, text)
        return output.rename(self.folder / "whole")

    def test_on_more_and_on_fewer_ranks(self):
        whole = self.whole(self.TEXT)
        of_two = self.stopped(2, self.TEXT)
        for ranks in (3, 1, 2):
            with self.subTest(from_2_to=ranks):
                self.goes_on(ranks, of_two, whole)
        of_one = self.stopped(1, self.TEXT)
        for ranks in (2, 4):
            with self.subTest(from_1_to=ranks):
                self.goes_on(ranks, of_one, whole)

    def test_with_fields_that_are_not_written_yet(self):
        text = self.TEXT + "[output]\nevery = 3\nstress = true\n[[probe]]\nname = 'p'\nat = [0.5, 1.2]\n"
        text += "[[probe]]\nname = 'row'\nfrom = [0.1, 1.2]\nto = [0.9, 1.2]\nfield = 'stress'\n"
        self.goes_on(3, self.stopped(2, text), self.whole(text))

    def test_on_ranks_without_a_point(self):
        text = SHORT_BAR + SOLVER + "[loading]\nsteps = 3\n[output]\nevery = 3\n"
        whole = self.whole(text)
        self.goes_on(1, self.stopped(8, text), whole)
        self.goes_on(8, self.stopped(1, text), whole)

    def test_in_three_dimensions(self):
        block = BLOCK.replace("table = [0, 1, 0.5]", "steps = 4") + SOLVER
        self.goes_on(3, self.stopped(2, block), self.whole(block))

    def test_with_the_same_bits_on_as_many_ranks(self):
        whole = self.results(2, self.TEXT).rename(self.folder / "whole")
        output = self.stopped(2, self.TEXT)
        self.assertEqual(resume(2, output).returncode, 0)
        with h5py.File(whole / "results.h5") as expected, h5py.File(output / "results.h5") as found:
            for name in ("steps/000004/displacement", "history/external_work", "history/reaction_y:top"):
                self.assertTrue(numpy.array_equal(expected[name], found[name]), name)

    def test_further_than_before(self):
        output = self.results(2, self.TEXT)
        again = resume(3, output)
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("has come to its end", again.stdout)
        self.assertEqual(again.stdout.count("has come to its end"), 1)
        further = resume(3, output, "--set", "loading.table=[0, 1, 0.5]")
        self.assertEqual(further.returncode, 0, further.stderr)
        self.assertEqual(float(rows(output, "history.csv")[-1]["load_factor"]), 0.5)

    def test_of_another_body(self):
        output = self.stopped(2, self.TEXT)
        results = output / "results.h5"
        with h5py.File(results, "r+") as file:
            file["points/reference"][7, 1] += 1e-12
        said = resume(3, output)
        self.assertEqual(said.returncode, 2, said.stderr)
        self.assertIn("its points are not those", said.stderr)
        self.assertEqual(said.stderr.count("peristat:"), 1)

    def test_from_a_damaged_checkpoint(self):
        output = self.stopped(2, self.TEXT)
        with h5py.File(output / "results.h5", "r+") as file:
            file["checkpoint"][700] ^= 1
        said = resume(2, output)
        self.assertEqual(said.returncode, 2, said.stderr)
        self.assertIn("its checksum is wrong", said.stderr)

class Bodies(Comparison):
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
        codes, statuses, dossiers, residuals = [], [], [], []
        for ranks in (1, 3):
            run, output = self.start(ranks, PLATE + SOLVER, *options)
            codes.append(run.returncode)
            self.assertIn('"not_converged"', (output / "summary.json").read_text())
            dossiers.append((output / "dossier.txt").read_text())
            self.assertFalse((output / "parts").exists())
            with h5py.File(output / "results.h5") as file:
                residuals.append(file["dossier/residual"][()])
                self.assertEqual(file["dossier/displacement"].shape, residuals[-1].shape)
            statuses.append([row["outcome"] for row in rows(output, "decisions.csv")])
        self.assertEqual(codes, [3, 3])
        self.assertEqual(statuses[0], statuses[1])
        self.assertLess(numpy.abs(residuals[0] - residuals[1]).max(), 1e-9 * numpy.abs(residuals[0]).max())
        worst = [re.findall(r"^  (\d+)  ", text, re.MULTILINE) for text in dossiers]
        self.assertEqual(worst[0], worst[1])
        self.assertEqual(len(worst[0]), 10)

    def test_places_off_the_body(self):
        for probe, what in (("at=[5, 5]", "within two spacings"), ("from=[5, 0], to=[5, 1]", "within half a spacing")):
            said = [self.refusal(PLATE, "--set", f'probe=[{{name="p", {probe}}}]', ranks=ranks) for ranks in (1, 2)]
            for text in said:
                self.assertIn(what, text)

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
        file = self.case(PLATE.replace("spacing = 0.05", "spacing = 0.025").replace("steps = 2", "steps = 5000") + SOLVER)
        words = [PROGRAM, "run", "--ranks", "2", str(file), "--threads", "1", "--output", str(self.folder / "out")]
        run = subprocess.Popen(words, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        try:
            ranks = self.wait_for_ranks(run.pid, steps=2)
            os.kill(ranks[-1], signal.SIGKILL)
            self.assertNotEqual(run.wait(timeout=20), 0)
            for rank in ranks:
                self.assertFalse(Path(f"/proc/{rank}/exe").exists())
        finally:
            run.kill()
            run.wait()
        self.assertFalse((self.folder / "out/summary.json").exists())
        self.expect_going_on(self.folder / "out", 1, 3)

    def expect_going_on(self, output, *numbers_of_ranks):
        """What a run has left is readable, and is gone on from."""
        with h5py.File(output / "results.h5") as file:
            steps = file["history/step"][()]
            self.assertGreaterEqual(len(steps), 1)
            self.assertEqual(list(file["steps"]), [f"{step:06}" for step in steps])
        for ranks in numbers_of_ranks:
            run = resume(ranks, output, "--stop-after", "2")
            self.assertEqual(run.returncode, 130, run.stderr)
            self.assertIn("going on after step", run.stdout)
        with h5py.File(output / "results.h5") as file:
            self.assertGreaterEqual(len(file["history/step"]), len(steps) + 2 * len(numbers_of_ranks) - 1)

    def test_files_that_can_not_grow_end_all(self):
        """Like a full disk, which faults_test.py has for one rank."""
        file = self.case(PLATE.replace("spacing = 0.05", "spacing = 0.025").replace("steps = 2", "steps = 5000") + SOLVER)
        words = [PROGRAM, "run", "--ranks", "2", str(file), "--threads", "1", "--output", str(self.folder / "out")]
        run = subprocess.Popen(words, env=ENVIRONMENT, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        try:
            for rank in self.wait_for_ranks(run.pid, steps=2):
                resource.prlimit(rank, resource.RLIMIT_FSIZE, (1 << 14, 1 << 14))
            said = run.communicate(timeout=60)[1]
        finally:
            run.kill()
            run.wait()
        self.assertEqual(run.returncode, 5, said)
        self.assertRegex(said, "accepted steps? (is|are) in")
        summary = json.loads((self.folder / "out/summary.json").read_text())
        self.assertEqual(summary["status"], "failed", said)
        self.assertGreater(summary["steps"], 1)
        self.expect_going_on(self.folder / "out", 3)

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

    def wait_for_ranks(self, launcher, steps=0):
        """Process numbers, once results are there, or so many accepted steps."""
        end = time.monotonic() + 60
        while time.monotonic() < end:
            time.sleep(0.05)
            history = self.folder / "out/history.csv"
            if not (self.folder / "out/results.h5").exists() or history.read_text().count("\n") <= steps:
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
            'solver.linear="cholesky"',
            'solver.linear="lu"',
            'solver.preconditioner="sines"',
            'solver.preconditioner="local_operator"',
            'solver.fragments="stop"',
            'material.kinematics="linear"',
            'material.damage={law="critical_stretch", critical=0.1}',
            'lattice.points="blue_noise"',
            'rigid=[{set="corner"}]',
            'symmetry=[{axis="x", at=0}]',
            'foundation=[{name="f", set="corner", stiffness=[1, 1]}]',
            'load=[{side="x+", pressure="1"}]',
            'roller=[{set="corner", normal=[1, 0]}]',
            'control=[{set="corner", weights=[1, 0]}]',
            "relaxation.steps=2",
        ):
            with self.subTest(key=key):
                said = self.refusal(PLATE, "--set", key)
                self.assertIn(key.split("=")[0].split(".")[0], said)
                self.assertEqual(said.count("peristat:"), 1)

    def test_convolutions(self):
        """Bonds stand in for them where the material has some."""
        said = self.refusal(PLATE, "--set", 'solver.operator="fft"')
        self.assertIn("solver.operator", said)
        self.assertIn('take "bonds" or "auto"', said)
        for operator in ("fft", "auto"):
            said = self.refusal(PLATE, "--set", f'solver.operator="{operator}"', "--set", 'material.model="green_bond"')
            self.assertIn("models that have bonds", said)

    def test_what_one_rank_refuses_too(self):
        for ranks in (1, 2):
            for text, what in (
                (PLATE.replace('set = "top"', 'set = "no"'), "no set"),
                (PLATE.replace('where = "x > 0.6', 'where = "x > 6'), "selects no point"),
                (PLATE.replace("displacement = [0, 0]", 'displacement = [0, "free"]')
                 .replace('[0, "0.05*load"]', '[0, "free"]'), "move along y"),
                (BAR + '[[support]]\nset = "left"\ndisplacement = [1]\n', "contradict"),
                (SQUARE.replace("c1 = 1.0\nc2 = 30.0", "youngs_modulus = 1e6\npoisson_ratio = -0.6"), "unstable before"),
                (SQUARE.replace("max = [1.2, 1]", "max = [1.2, 0.1]"), "no triangles"),
            ):  # fmt: skip
                with self.subTest(ranks=ranks, what=what):
                    self.assertIn(what, self.refusal(text, ranks=ranks))

    def test_forces_without_a_potential(self):
        said = self.refusal(STATES.split("[quadrature]")[0])
        self.assertIn("quadrature.form", said)
        self.assertIn('take "energy"', said)

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
        self.assertIn("no command but run and resume", run.stderr)


if __name__ == "__main__":
    unittest.main()
