"""Small bodies, runs of them on ranks, and the comparison of their results."""

import csv
import json
import re
from pathlib import Path

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference.program import Begun

# Root may run them, as in a container; waiting ranks yield the core to other tests.
ENVIRONMENT = {
    "OMPI_MCA_mpi_yield_when_idle": "1",
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
# Triangles that break with their bonds.
SHEET = """
dimension = 2
[lattice]
spacing = 0.1
horizon_ratio = 2.415
shape = [{ add = "box", min = [0, 0], max = [1.2, 1.1] }, { subtract = "disk", centre = [0.72, 0.63], radius = 0.15 }]
layer = [{ name = "held", side = "x-", thickness = 2 }, { name = "pulled", side = "x+", thickness = 2 }]
[[crack]]
from = [0.52, 0]
to = [0.55, 0.22]
[material]
model = "cpd"
c1 = 1.0
c2 = 30.0
density = 0.002
[material.damage]
law = "tanh"
onset = 0.05
critical = 0.08
rate = 3
no_fail = ["held", "pulled"]
[[support]]
set = "held"
displacement = [0, 0]
[[support]]
set = "pulled"
"""
# A dilatation per point, which needs the neighbours of ghosts.
STATES = PLATE.replace('model = "bond"', 'model = "lps"\nplane = "strain"\npoisson_ratio = 0.4') + """
[quadrature]
form = "energy"
volume_correction = "linear"
"""
STORED = SOLVER.replace("matrix_free", "stored")
PIECES = STORED.replace("block_jacobi", "rigid_pieces")
# Thin and long, with a notch, loaded at its end.
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
# Some parts are thinner than the horizon.
SHORT_BAR = BAR.replace("max = [4]", "max = [0.3]").replace(', thickness = 2', ", thickness = 1")


def on(ranks):
    return ("--ranks", ranks) if ranks > 1 else ()


class OnRanks(Folder):
    LIMITS = {"environment": ENVIRONMENT, "seconds": 100}

    def execute(self, command, **options):
        return super().execute(command, **self.LIMITS | options)

    def run_on(self, ranks, text, *changes, words=(), **options):
        return self.run_case(text, *changes, name=f"on_{ranks}", words=(*on(ranks), *words), **options)

    def ended_on(self, ranks, text, *changes, **options):
        """How a run ended, well or not, and its folder."""
        output = self.run_on(ranks, text, *changes, code=(0, 3), **options)
        return self.ended, output

    def ended_on_each(self, counts, text, *changes, words=(), code=0):
        """How runs on several numbers of ranks ended, and their folders."""
        case = self.case(text)
        names = [f"on_{count}" for count in counts]
        runs = self.side_by_side([self.words_of_run(case, *changes, name=name, words=(*on(count), *words))
                                  for count, name in zip(counts, names)])  # fmt: skip
        for run in runs:
            self.assert_code(run, code)
        return {count: (run, self.folder / name) for count, name, run in zip(counts, names, runs)}

    def side_by_side(self, commands):
        """How they ended. Two run at a time: a start on ranks leaves half of two cores idle."""
        begun, ended = [], []
        for command in commands:
            if len(begun) - len(ended) == 2:
                ended.append(begun[len(ended)].end())
            begun.append(Begun(command, folder=self.folder, **self.LIMITS))
            self.addCleanup(begun[-1].kill)
        return ended + [run.end() for run in begun[len(ended) :]]

    def run_on_each(self, counts, text, *changes, **options):
        """Folders of runs on several numbers of ranks."""
        return [folder for _, folder in self.ended_on_each(counts, text, *changes, **options).values()]

    def resume_on(self, ranks, folder, *changes, words=(), **options):
        return self.resume(folder, *changes, words=(*on(ranks), *words), **options)

    def refusal(self, text, *changes, ranks=2):
        return super().refusal(text, *changes, words=on(ranks))

    def refusals(self, *refused):
        """What runs say that are refused, each of a number of ranks, a case and its changes; they leave nothing."""
        commands, folders = [], []
        for k, (ranks, text, *changes) in enumerate(refused):
            folders.append(self.folder / f"refused_{k}")
            case = self.write(f"case_{k}.toml", text)
            commands.append(self.words_of_run(case, *changes, name=folders[-1].name, words=on(ranks)))
        runs = self.side_by_side(commands)
        for run, folder in zip(runs, folders):
            self.assert_code(run, 2)
            self.assertFalse(folder.exists())
        return [run.errors for run in runs]


def children_of(process):
    return [int(child) for child in Path(f"/proc/{process}/task/{process}/children").read_text().split()]


def objects(file):
    names = []
    file.visit(names.append)
    return sorted(names)


def rows(output, table):
    with open(output / table, newline="") as file:
        return list(csv.DictReader(file))


def linear_iterations(output):
    return json.loads((output / "summary.json").read_text())["linear_iterations"]


def nine_digits(text):
    return re.sub(r"\d+\.\d+(e[-+]?\d+)?", lambda number: f"{float(number[0]):.9g}", text)


class Comparison(OnRanks):
    def expect_same(self, one, several):
        with h5py.File(one / "results.h5") as expected, h5py.File(several / "results.h5") as found:
            names = objects(expected)
            self.assertEqual(names, objects(found))
            for name in names:
                if name == "checkpoint":
                    continue  # times are ignored, too
                if not isinstance(expected[name], h5py.Dataset) or name.startswith("iterations/"):
                    continue
                if name == "case/as_resolved" or name.startswith("case/settings"):
                    continue  # so is the folder
                if name.endswith("_iterations"):
                    continue  # see expect_like_costs
                self.expect_same_data(name, expected[name], found[name])

    def expect_same_data(self, name, expected, found):
        self.assertEqual((expected.shape, expected.dtype), (found.shape, found.dtype), name)
        self.assertEqual(dict(expected.attrs.items()).keys(), dict(found.attrs.items()).keys(), name)
        if name == "decisions/reason":  # numbers in them have all their digits
            self.assertEqual(*([nine_digits(text) for text in data.asstr()[()]] for data in (expected, found)))
            return
        if name == "case/preflight":  # resultants that vanish are round-off
            self.assertEqual(*(re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?", "#", data.asstr()[()]) for data in (expected, found)))
            return
        if expected.dtype.kind != "f":
            self.assertTrue(numpy.array_equal(expected[()], found[()]), name)
            return
        if name.endswith(("balance_error", "/reason", "pin_force")):
            return  # differences of large numbers
        scale = numpy.abs(expected[()]).max(initial=0)
        if name.startswith("history/") and name[-2:] in ("_x", "_y", "_z"):  # components of a vector
            scale = max(numpy.abs(expected.parent[key][()]).max() for key in expected.parent if key[:-2] == name[8:-2])
        if name.startswith(("history/reaction", "history/momentum")):
            kind = name.split("_")[0].split("/")[1]
            scale = max(numpy.abs(file[()]).max() for key, file in expected.parent.items() if kind in key)
        if name.startswith("history/displacement_") and ":" in name:  # a mean, which may cancel
            scale = max(numpy.abs(step["displacement"][()]).max() for step in expected.file["steps"].values())
        if name.startswith("history/force_") and ":" in name:
            scale = max(numpy.abs(file[()]).max() for key, file in expected.parent.items() if key.startswith(("reaction", "force")))
        difference = numpy.abs(expected[()] - found[()]).max(initial=0)
        self.assertLessEqual(difference, 1e-9 * scale, name)

    def expect_like_costs(self, one, several):
        """Partitions cost no convergence. The number of iterations is not a result: round-off, which
        differs between builds, changes it by a few."""
        count = lambda folder: sum(int(row["linear_iterations"]) for row in rows(folder, "iterations.csv"))
        self.assertLessEqual(count(several), 1.1 * count(one) + 10)

    def compare(self, text, ranks=(3,), *changes, solver=SOLVER):
        one, *others = self.run_on_each((1, *ranks), text + solver, *changes)
        for count, several in zip(ranks, others):
            with self.subTest(ranks=count):
                self.expect_same(one, several)
                self.expect_like_costs(one, several)
        return one


def entries_of_checkpoint(file):
    """Names and sizes of the files, at the moment of the call."""
    head, rest = file["checkpoint"][()].tobytes().split(b"\n", 1)
    return head, rest[24 : 24 + int.from_bytes(rest[:8], "little")].decode()
