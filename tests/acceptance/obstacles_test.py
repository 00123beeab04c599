"""Rigid obstacles that press on a body."""

import json
import sys

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference.program import ROOT
from tests.reference.results import Results, table
from tests.reference.verify import verify
from tests.same_results import differences

sys.path.insert(0, str(ROOT / "python"))
from peristat.pictures.figures import drawings  # noqa: E402
from peristat.pictures.results_folder import read_results_folder  # noqa: E402

BLOCK = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.016, 8e-3] }]
layer = [{ name = "foot", side = "y-", thickness = 1 }]
[material]
youngs_modulus = 200e9
density = 8000
[[support]]
set = "foot"
displacement = [0, 0]
"""
TOP = 'name = "top"\nshape = "plane"\npoint = [8e-3, 8e-3]\nnormal = [0, -1]\ndisplacement = [0, "-4e-5*load"]\n'
PLANE = "[[obstacle]]\n" + TOP
ROLLER = """\
[[obstacle]]
name = "roller"
shape = "cylinder"
point = [7.3e-3, 12e-3]
radius = 4e-3
displacement = ["1e-5*load", "-8e-5*load"]
"""
BEND = """\
[[obstacle]]
name = "die"
shape = "cylinder"
point = [8e-3, -20e-3]
radius = 30e-3
inside = true
displacement = [0, "-1.1e-3*load"]
"""
CUBE = """\
dimension = 3
[lattice]
spacing = 1e-3
shape = [{ add = "box", min = [0, 0, 0], max = [6e-3, 6e-3, 4e-3] }]
layer = [{ name = "foot", side = "z-", thickness = 1 }]
[material]
youngs_modulus = 200e9
[[support]]
set = "foot"
displacement = [0, 0, 0]
[[obstacle]]
name = "ball"
shape = "sphere"
point = [2.8e-3, 3.1e-3, 7e-3]
radius = 3e-3
displacement = [0, "1e-5*load", "-8e-5*load"]
"""
BAR = """\
dimension = 1
[lattice]
spacing = 1e-2
area = 1e-4
shape = [{ add = "box", min = [0], max = [0.5] }]
layer = [{ name = "left", side = "x-", thickness = 1 }]
[material]
youngs_modulus = 200e9
[[support]]
set = "left"
displacement = [0]
[[obstacle]]
name = "wall"
shape = "plane"
point = [0.5]
normal = [-1]
displacement = ["-1e-3*load"]
"""
SOLVER = '[solver]\nlinear = "cholesky"\nrelative_tolerance = 1e-12\n'


def read_drawings(folder):
    """Names of the pictures that a results folder allows."""
    return [drawing.name for drawing in drawings(read_results_folder(folder))]


class Pressed(Folder):
    def rows(self, case, *changes, name="out", **options):
        """The history of a run, without step 0."""
        self.run_case(case, *changes, name=name, **options)
        return table(self.folder / name / "history.csv")[1:]

    def fields(self, name="out"):
        with h5py.File(self.folder / name / "results.h5") as file:
            step = file["steps"][sorted(file["steps"])[-1]]
            return file["points/reference"][...], {key: step[key][...] for key in step if step[key].shape}

    def judge(self, name="out"):
        with h5py.File(self.folder / name / "results.h5") as file:
            text = file["case/as_resolved"][()].decode()
        complaints, _ = verify(self.folder / name, text, self.folder)
        self.assertEqual(complaints, [])


class Obstacles(Pressed):
    def forces(self, case, *changes, name="out", of="top", axis="y"):
        return [row[f"reaction_{axis}:{of}"] for row in self.rows(case, *changes, name=name)]

    def test_the_reference_agrees(self):
        cases = {"plane": BLOCK + PLANE, "roller": BLOCK + ROLLER, "die": BLOCK + BEND, "ball": CUBE, "bar": BAR,
                 "on a set": BLOCK + PLANE + 'set = "half"\n[[set]]\nname = "half"\nwhere = "x < 7e-3"\n',
                 "two": BLOCK + PLANE.replace("-4e-5", "-1e-5") + ROLLER,
                 "stiff": BLOCK + ROLLER + "stiffness = 3\ndepth = 0.4\nsoftness = 1e-3\n"}  # fmt: skip
        for name, case in cases.items():
            with self.subTest(name):
                rows = self.rows(case + SOLVER + "[loading]\nsteps = 3\n", name=name)
                self.assertGreater(rows[-1]["stored_energy"], 0)
                for row in rows:
                    self.assertLessEqual(row["newton_iterations"], 8)
                self.judge(name)

    def test_searches_and_steps_find_the_same(self):
        for name, case, of in (("plane", BLOCK + PLANE, "top"), ("roller", BLOCK + ROLLER, "roller")):
            expected = self.forces(case + SOLVER, name=name, of=of)[-1]
            self.assertLess(expected, 0)
            u = self.fields(name)[1]["displacement"]
            for changes in (("loading.steps=30",), ("solver.mode=adaptive", "loading.steps=4"),
                            ("solver.mode=relaxation", "solver.relative_tolerance=1e-11"),
                            ("solver.linear=pcg", "solver.preconditioner=block_jacobi")):  # fmt: skip
                with self.subTest(case=name, changes=changes):
                    found = self.forces(case + SOLVER, *changes, name="again", of=of)[-1]
                    self.assertAlmostEqual(found / expected, 1, delta=1e-6)
                    error = numpy.abs(self.fields("again")[1]["displacement"] - u).max()
                    self.assertLess(error, 1e-7 * numpy.abs(u).max())
                    self.judge("again")

    def test_the_force_is_that_of_the_depth(self):
        """Beyond its bend, k a d s / (1 - s) with s = x - x0 / 2."""
        force = -self.forces(BAR + SOLVER, of="wall", axis="x")[-1]
        gap = (0.5 - 1e-3) - (0.495 + self.fields()[1]["displacement"][-1, 0])
        stiffness, scale = 200e9 * 1e-4 / 5e-3, 0.25 * 5e-3
        s = (5e-3 - gap) / scale - 2e-4
        self.assertAlmostEqual(force / (stiffness * scale * s / (1 - s)), 1, delta=1e-9)

    def test_pressures_add_up_to_the_force(self):
        spacing, thickness = 1e-3, 1e-3
        for case, of, axis, face in ((BLOCK + PLANE, "top", "y", spacing * thickness), (BAR, "wall", "x", 1e-4)):
            with self.subTest(of):
                force = self.forces(case + SOLVER, of=of, axis=axis, name=of)[-1]
                pressure = self.fields(of)[1]["contact_pressure"]
                self.assertAlmostEqual(pressure.sum() * face / abs(force), 1, delta=1e-9)
                self.assertEqual((pressure > 0).sum(), 16 if of == "top" else 1)
        self.assertIn("contact_pressure", read_drawings(self.folder / "top"))
        self.run_case(BLOCK + SOLVER, name="none")
        self.assertNotIn("contact_pressure", self.fields("none")[1])
        self.assertNotIn("contact_pressure", read_drawings(self.folder / "none"))

    def test_an_obstacle_that_withdraws_lets_go(self):
        case = BLOCK + PLANE + SOLVER + "[loading]\ntable = [0, 1, 0.5, 0, -1, 1]\n"
        forces = self.forces(case)
        self.judge()
        self.assertLess(forces[0], forces[1])
        self.assertEqual(forces[3], 0)
        self.assertAlmostEqual(forces[4] / forces[0], 1, delta=1e-9)
        there = self.forces(BLOCK + PLANE + SOLVER, "loading.steps=1", name="once")
        self.assertAlmostEqual(forces[0] / there[-1], 1, delta=1e-9)
        # Back at its place: nothing but what the bend of the law leaves.
        self.assertLess(abs(forces[2]), 1e-6 * abs(forces[0]))

    def test_an_obstacle_that_jumps_finds_the_same_state(self):
        case = BLOCK + PLANE.replace("-4e-5*load", "-4e-5*(load > 0.4)") + SOLVER + "[loading]\nsteps = 5\n"
        forces = self.forces(case)
        self.assertEqual(forces[:2], [0, 0])
        expected = self.forces(BLOCK + PLANE + SOLVER, name="once")[-1]
        for force in forces[2:]:
            self.assertAlmostEqual(force / expected, 1, delta=1e-9)

    def test_half_a_body_behind_a_plane_of_symmetry_is_half_of_it(self):
        middle = ROLLER.replace("7.3e-3", "8e-3").replace('"1e-5*load"', "0")
        whole = self.forces(BLOCK + middle + SOLVER, of="roller")[-1]
        half = (BLOCK + middle + SOLVER).replace("min = [0, 0]", "min = [8e-3, 0]") + '[[symmetry]]\naxis = "x"\nat = 8e-3\n'
        self.assertAlmostEqual(self.forces(half, of="roller")[-1] / whole, 0.5, delta=1e-9)

    def test_units_change_nothing(self):
        expected = self.forces(BLOCK + ROLLER + SOLVER, of="roller")[-1]
        told = (ROLLER.replace("[7.3e-3, 12e-3]", '["7.3 mm", "0.012 m"]').replace("4e-3", '"4 mm"')
                .replace("1e-5*load", "10 um * load").replace("-8e-5*load", "-0.08 mm * load"))  # fmt: skip
        self.assertAlmostEqual(self.forces(BLOCK + told + SOLVER, of="roller", name="told")[-1] / expected, 1, delta=1e-12)

    def test_threads_change_round_off_alone(self):
        one = self.forces(BLOCK + ROLLER + SOLVER, of="roller")[-1]
        self.threads = 2
        two = self.forces(BLOCK + ROLLER + SOLVER, of="roller", name="two")[-1]
        self.assertAlmostEqual(one / two, 1, delta=1e-11)

    def test_a_displacement_at_load_0_is_a_preload(self):
        case = BLOCK + PLANE.replace("-4e-5*load", "-4e-5") + SOLVER
        self.run_case(case)
        forces = [row["reaction_y:top"] for row in Results(self.folder / "out").table("history")]
        expected = self.forces(BLOCK + PLANE + SOLVER, name="once")[-1]
        for force in forces:
            self.assertAlmostEqual(force / expected, 1, delta=1e-9)

    def test_a_resumed_run_is_the_same_to_the_last_bit(self):
        case = BLOCK + ROLLER + SOLVER + "[loading]\nsteps = 6\n"
        self.run_case(case, name="whole")
        self.run_case(case, name="parts", words=("--stop-after", "3"), code=130)
        self.resume("parts")
        self.assertEqual(differences(self.folder / "whole", self.folder / "parts"), [])

    def test_an_obstacle_that_touches_nothing_is_reported(self):
        for changes, count in ((('obstacle[0].displacement=[0, "1e-3*load"]',), 1), ((), 0)):
            self.run_case(BLOCK + PLANE + SOLVER, *changes)
            warnings = json.loads((self.folder / "out/summary.json").read_text())["warnings"]
            self.assertEqual(sum("top has touched nothing" in warning for warning in warnings), count)

    def test_a_roller_that_jumps_through_the_body_is_noticed(self):
        case = BLOCK + ROLLER.replace("-8e-5*load", "-40e-3*load") + SOLVER
        self.run_case(case, "loading.adaptive=false", code=3)
        self.assertIn("degenerate", self.ended.said)

    def test_tangents_of_pressed_points(self):
        for name, case in (("roller", BLOCK + ROLLER), ("plane", BLOCK + PLANE), ("ball", CUBE), ("die", BLOCK + BEND), ("bar", BAR)):
            with self.subTest(name):
                axes = "xyz"[: int(case.split("dimension = ")[1][0])]
                deformation = "; ".join(f"{a} + 1e-4*({' + '.join(f'{k + 1 + j}*{b}' for j, b in enumerate(axes))})"
                                        for k, a in enumerate(axes))  # fmt: skip
                found = self.peristat("check-tangent", self.write("case.toml", case + SOLVER), "--deformation", deformation)
                self.assert_completed(found)
                told = json.loads(found.output)
                self.assertGreater(told["energy"], 0)
                self.assertLess(told["residual_error"], 1e-8)
                self.assertLess(told["tangent_error"], 1e-8)
                self.assertLess(told["force_sum"], 1e-12)
                self.assertLess(told["moment_sum"], 1e-12)

    def test_bad_input_is_refused(self):
        block = BLOCK + PLANE + SOLVER
        roller = BLOCK + ROLLER + SOLVER
        for case, change, message in (
            (block, "obstacle[0].normal=[0, 0]", "must be a vector that is not zero"),
            (block, 'obstacle[0].shape="cube"', "cylinder"),
            (block, 'obstacle[0].shape="sphere"', "normal"),
            (block, "obstacle[0].radius=1", "is for shapes"),
            (block, "obstacle[0].depth=1", "depth"),
            (block, "obstacle[0].stiffness=0", "positive"),
            (block, "obstacle[0].softness=0", "softness"),
            (block, "obstacle[0].softness=0.3", "below depth"),
            (block, "obstacle[0].point=[8e-3, 7.99e-3]", "begins inside the body"),
            (block, 'obstacle[0].name="foot"', "already a support"),
            (block, 'obstacle[0].displacement=["free", 0]', "needs a force"),
            (block, 'obstacle[0].displacement=[0, "1e-3*y"]', "y"),
            (block, 'obstacle[0].set="none"', "none"),
            (BLOCK + PLANE, "solver={tangent=\"matrix_free\", linear=\"pcg\"}", "needs the stored tangent"),
            (block, 'material.kinematics="linear"', 'is for models "bond" with kinematics "finite"'),
            (roller, "obstacle[0].radius=1.9e-3", "at least two spacings"),
            (roller, "obstacle[0].axis=[0, 0, 1]", "in 3D"),
            (BAR + SOLVER, 'obstacle[0]={name="wall", shape="cylinder", point=[0.5], radius=0.1}', "must be \"plane\" in 1D"),
            (BLOCK.split("[[support]]")[0] + PLANE + SOLVER, "loading.steps=1", "Obstacles only push"),
        ):  # fmt: skip
            with self.subTest(change):
                self.assertIn(message, self.refusal(case, change).replace("\n", " "))


class InMotion(Pressed):
    """A bar that hits a wall: it leaves with its velocity, after the time in which a wave passes it twice."""

    def text(self):
        bar = BAR.split("[[support]]")[0].replace('layer = [{ name = "left", side = "x-", thickness = 1 }]', "")
        bar = bar.replace("youngs_modulus = 200e9", "youngs_modulus = 200e9\ndensity = 8000")
        wall = '[[obstacle]]\nname = "wall"\nshape = "plane"\npoint = [0.5001]\nnormal = [-1]\n'
        wall += '[quadrature]\nvolume_correction = "linear"\n'  # without it the modulus is a quarter too large
        return bar + wall + '[[initial]]\nvelocity = ["5"]\n[solver]\nmode = "dynamics"\n[dynamics]\nend_time = 4e-4\nhistory_every = 1\n'

    def test_a_bar_bounces_off_a_wall(self):
        schemes = {"verlet": (), "fine": ("dynamics.step_share=0.2",),
                   "newmark": ('dynamics.scheme="newmark"', "dynamics.time_step=5e-7", "solver.linear=cholesky")}  # fmt: skip
        for name, changes in schemes.items():
            with self.subTest(name):
                rows = self.rows(self.text(), *changes, name=name)
                mass, speed = 8000 * 1e-4 * 0.5, 5.0
                self.assertAlmostEqual(rows[0]["momentum_x"] / (mass * speed), 1, delta=1e-12)
                # Some of the motion is left as vibrations.
                self.assertAlmostEqual(rows[-1]["momentum_x"] / (mass * speed), -1, delta=0.06)
                self.assertEqual(rows[-1]["reaction_x:wall"], 0)
                energy = 0.5 * mass * speed**2
                told = [row["kinetic_energy"] + row["stored_energy"] for row in rows]
                self.assertLess(numpy.abs(numpy.array(told) / energy - 1).max(), 0.03)
                touched = [row["time"] for row in rows if row["reaction_x:wall"] != 0]
                wave = (200e9 / 8000) ** 0.5
                self.assertAlmostEqual((touched[-1] - touched[0]) / (2 * 0.5 / wave), 1, delta=0.12)
