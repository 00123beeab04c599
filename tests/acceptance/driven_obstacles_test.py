"""Obstacles that a force drives."""

import json
import re

import numpy

from tests.acceptance.obstacles_test import BAR, BEND, BLOCK, CUBE, PLANE, ROLLER, SOLVER, Pressed
from tests.reference.results import table
from tests.same_results import differences

PIN = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [24e-3, 16e-3] }, { subtract = "disk", centre = [8e-3, 8e-3], radius = 4.5e-3 }]
layer = [{ name = "foot", side = "x+", thickness = 1 }]
[material]
youngs_modulus = 200e9
[[support]]
set = "foot"
displacement = [0, 0]
[[obstacle]]
name = "pin"
shape = "cylinder"
point = [8e-3, 8e-3]
radius = 4e-3
displacement = ["-0.2e-3*load", 0]
"""
# Rollers stand between two points of the row that they touch: they have 0.168 mm to the surface of the body.
BEAM = """\
dimension = 2
[lattice]
spacing = 4e-3
thickness = 10e-3
shape = [{ add = "box", min = [-100e-3, 0], max = [100e-3, 24e-3] }]
[[set]]
name = "middle"
where = "abs(x) < 4e-3 && abs(y - 12e-3) < 4e-3"
[quadrature]
volume_correction = "linear"
[material]
youngs_modulus = 30e9
[[foundation]]
name = "light_spring"
set = "middle"
stiffness = [1e6, 100]
[[obstacle]]
name = "left_support"
shape = "cylinder"
point = [-80e-3, -9.83216e-3]
radius = 10e-3
[[obstacle]]
name = "right_support"
shape = "cylinder"
point = [80e-3, -9.83216e-3]
radius = 10e-3
[[obstacle]]
name = "left"
shape = "cylinder"
point = [-40e-3, 33.83216e-3]
radius = 10e-3
displacement = [0, "-0.2e-3*load"]
[[obstacle]]
name = "right"
shape = "cylinder"
point = [40e-3, 33.83216e-3]
radius = 10e-3
displacement = [0, "-0.2e-3*load"]
"""
# Round-off of places is up to 1e-11 of the forces.
ROUGH = SOLVER.replace("1e-12", "1e-10")
SHAPES = {"plane": (BLOCK + PLANE, "top", "y"), "roller": (BLOCK + ROLLER, "roller", "y"), "die": (BLOCK + BEND, "die", "y"),
          "ball": (CUBE, "ball", "z"), "bar": (BAR, "wall", "x"), "pin": (PIN, "pin", "x")}  # fmt: skip


def driven(case, name, axis, force):
    """The case in which a force in N at the end of the load drives an obstacle, instead of its displacement."""
    head, tail = case.split(f'name = "{name}"', 1)

    def freed(found):
        components = [part.strip() for part in found[1].split(",")]
        components["xyz".index(axis)] = '"free"'
        return f'displacement = [{", ".join(components)}]\nforce = "{force!r}*load"'

    return head + f'name = "{name}"' + re.sub(r"displacement = \[(.*)\]", freed, tail, count=1)


def moved(case, name, axis, way):
    """The case in which an obstacle moves by a way in m."""
    return re.sub(r'force = ".*"\n', "", driven(case, name, axis, 0.0)).replace('"free"', f'"{way!r}*load"')


class DrivenObstacles(Pressed):
    def displacement(self, name="out"):
        return self.fields(name)[1]["displacement"]

    def assert_same_state(self, expected, name="out", share=1e-8):
        error = numpy.abs(self.displacement(name) - expected).max()
        self.assertLess(error, share * numpy.abs(expected).max())

    def test_a_force_and_its_displacement_lead_to_the_same_state(self):
        for shape, (case, of, axis) in SHAPES.items():
            with self.subTest(shape):
                last = self.rows(case + SOLVER, name="moved")[-1]
                force, way = last[f"reaction_{axis}:{of}"], last.get(f"displacement_{axis}:{of}")
                expected = self.displacement("moved")
                rows = self.rows(driven(case, of, axis, force) + SOLVER + "[loading]\nsteps = 3\n")
                self.assertLess(max(row["newton_iterations"] for row in rows), 7)
                self.assertAlmostEqual(rows[-1][f"displacement_{axis}:{of}"] / way, 1, delta=1e-8)
                for row in rows:
                    self.assertAlmostEqual(row[f"reaction_{axis}:{of}"] / (force * row["load_factor"]), 1, delta=1e-10)
                self.assert_same_state(expected)
                self.judge()
                # Back: where the first of three forces has led.
                way = rows[0][f"displacement_{axis}:{of}"]
                back = self.rows(moved(case, of, axis, 3 * way) + SOLVER + "[loading]\nsteps = 3\n", name="back")[0]
                lateral = shape in ("roller", "ball")  # a third of these is another displacement across
                self.assertAlmostEqual(back[f"reaction_{axis}:{of}"] / (force / 3), 1, delta=1e-2 if lateral else 1e-7)

    def test_searches_and_steps_find_the_same(self):
        for shape, force in (("plane", -3e4), ("roller", -1e4)):
            case, of, axis = SHAPES[shape]
            case = driven(case, of, axis, force) + ROUGH
            way = self.rows(case)[-1][f"displacement_{axis}:{of}"]
            expected = self.displacement()
            for changes in (("loading.steps=30",), ("solver.mode=adaptive", "loading.steps=4"),
                            ("solver.mode=relaxation", "solver.relative_tolerance=1e-11"),
                            ("solver.linear=pcg", "solver.preconditioner=block_jacobi")):  # fmt: skip
                with self.subTest(shape, changes=changes):
                    row = self.rows(case, *changes, name="again")[-1]
                    self.assertAlmostEqual(row[f"displacement_{axis}:{of}"] / way, 1, delta=1e-6)
                    self.assert_same_state(expected, "again", 1e-7)
                    if changes == ("loading.steps=30",):
                        self.assertLess(abs(row["balance_error"]), 2e-3 * row["external_work"])
                    self.judge("again")

    def test_a_body_turned_upside_down_feels_the_opposite_force(self):
        down = driven(*SHAPES["plane"], -3e4) + SOLVER
        up = (down.replace('side = "y-"', 'side = "y+"').replace("point = [8e-3, 8e-3]", "point = [8e-3, 0]")
              .replace("normal = [0, -1]", "normal = [0, 1]").replace("-30000.0", "30000.0"))  # fmt: skip
        one, other = (self.rows(case)[-1]["displacement_y:top"] for case in (down, up))
        self.assertAlmostEqual(one / -other, 1, delta=1e-10)

    def test_a_force_that_is_there_from_the_start(self):
        case = driven(*SHAPES["roller"], -1e4) + SOLVER
        last = self.rows(case.replace('"1e-5*load"', '"0"'))[-1]
        for name, text in (("constant", '"-1e4"'), ("number", "-1e4"), ("early", '"-1e4 + 0*load"')):
            with self.subTest(name):
                constant = case.replace('"-10000.0*load"', text).replace('"1e-5*load"', '"0"')
                self.run_case(constant, "loading.steps=2", name="early")
                for row in table(self.folder / "early/history.csv"):
                    self.assertAlmostEqual(row["displacement_y:roller"] / last["displacement_y:roller"], 1, delta=1e-8)
                    self.assertAlmostEqual(row["reaction_y:roller"] / -1e4, 1, delta=1e-10)
                self.judge("early")

    def test_a_gap_is_crossed_at_once(self):
        near = driven(*SHAPES["plane"], -3e4) + ROUGH
        far = near.replace("point = [8e-3, 8e-3]", "point = [8e-3, 3e-2]")
        expected = self.rows(near, "loading.steps=4", name="near")
        for one, other in zip(expected, self.rows(far, "loading.steps=4", name="far")):
            self.assertAlmostEqual((other["displacement_y:top"] + 22e-3) / one["displacement_y:top"], 1, delta=1e-8)
            self.assertAlmostEqual(other["external_work"] / one["external_work"], 1, delta=1e-6)
        self.judge("far")

    def test_a_force_that_ends_and_comes_back(self):
        case = driven(*SHAPES["plane"], -3e4) + SOLVER + "[loading]\ntable = [0, 1, 0.5, 0, 0, 1]\n"
        rows = self.rows(case)
        self.judge()
        self.assertAlmostEqual(rows[4]["displacement_y:top"] / rows[0]["displacement_y:top"], 1, delta=1e-8)
        for row in rows[2:4]:
            self.assertEqual(row["reaction_y:top"], 0)
            self.assertLess(abs(row["displacement_y:top"]), 1e-9)
        for row in rows:
            self.assertLess(abs(row["balance_error"]), 5e-3 * rows[0]["stored_energy"])

    def test_the_work_of_a_constant_force(self):
        """A block that grows lifts a platen."""
        case = driven(*SHAPES["plane"], -3e4).replace('"-30000.0*load"', "-3e4") + SOLVER
        case += '[[eigenstrain]]\nstrain = "1e-3*load"\n[loading]\nsteps = 4\n'
        self.run_case(case)
        rows = table(self.folder / "out/history.csv")
        self.judge()
        self.assertGreater(rows[-1]["displacement_y:top"] - rows[0]["displacement_y:top"], 7e-6)
        for row in rows:
            self.assertLess(abs(row["balance_error"]), 1e-4 * rows[-1]["stored_energy"])

    def test_two_forces_bend_a_beam(self):
        last = self.rows(BEAM + ROUGH, name="moved")[-1]
        force = last["reaction_y:left"]
        self.assertAlmostEqual(force / last["reaction_y:right"], 1, delta=1e-6)
        expected = self.displacement("moved")
        case = driven(driven(BEAM, "left", "y", force), "right", "y", force) + ROUGH
        rows = self.rows(case, "loading.steps=3")
        self.assertLess(max(row["newton_iterations"] for row in rows), 7)
        for name in ("left", "right"):
            self.assertAlmostEqual(rows[-1][f"displacement_y:{name}"] / -0.2e-3, 1, delta=1e-5)
        self.assert_same_state(expected, share=1e-5)
        self.judge()

    def test_two_equal_forces_move_by_different_ways(self):
        """The right one is nearer to its support."""
        beam = BEAM.replace("point = [40e-3, 33.83216e-3]", "point = [60e-3, 33.83216e-3]")
        case = driven(driven(beam, "left", "y", -500.0), "right", "y", -500.0) + ROUGH
        rows = self.rows(case, "loading.steps=3")
        last = rows[-1]
        left, right = (last[f"displacement_y:{name}"] for name in ("left", "right"))
        self.assertLess(left, 1.2 * right)
        self.assertAlmostEqual(last["reaction_y:left"], -500, delta=1e-6)
        self.assertAlmostEqual(last["reaction_y:right"], -500, delta=1e-6)
        # Lever rule: moments about the left support, whose span is 160 mm.
        self.assertAlmostEqual(last["reaction_y:right_support"] / (500 * (40 + 140) / 160), 1, delta=2e-2)
        self.judge()
        expected = self.displacement()
        back = moved(moved(beam, "left", "y", left), "right", "y", right) + ROUGH
        given = self.rows(back, "loading.steps=3", name="back")
        self.assertAlmostEqual(given[-1]["reaction_y:left"] / -500, 1, delta=1e-6)
        # Points are coarse for these rollers: given displacements need as many iterations.
        self.assertLessEqual(*(max(row["newton_iterations"] for row in of) for of in (rows, given)))
        self.assert_same_state(expected, "back", 1e-7)

    def test_half_a_body_behind_a_plane_of_symmetry_bears_half_of_it(self):
        middle = ROLLER.replace("7.3e-3", "8e-3").replace('"1e-5*load"', "0")
        whole = self.rows(driven(BLOCK + middle, "roller", "y", -1e4) + SOLVER)[-1]
        half = (driven(BLOCK + middle, "roller", "y", -5e3) + SOLVER).replace("min = [0, 0]", "min = [8e-3, 0]")
        half = self.rows(half + '[[symmetry]]\naxis = "x"\nat = 8e-3\n', name="half")[-1]
        self.assertAlmostEqual(half["displacement_y:roller"] / whole["displacement_y:roller"], 1, delta=1e-9)

    def test_units_and_threads_change_nothing(self):
        case = driven(*SHAPES["roller"], -1e4) + SOLVER
        expected = self.rows(case)[-1]["displacement_y:roller"]
        told = case.replace('"-10000.0*load"', '"-10 kN * load"').replace("[7.3e-3, 12e-3]", '["7.3 mm", "12 mm"]')
        self.assertAlmostEqual(self.rows(told, name="told")[-1]["displacement_y:roller"] / expected, 1, delta=1e-12)
        self.threads = 2
        self.assertAlmostEqual(self.rows(case, name="two")[-1]["displacement_y:roller"] / expected, 1, delta=1e-9)

    def test_a_resumed_run_is_the_same_to_the_last_bit(self):
        case = driven(*SHAPES["roller"], -1e4) + SOLVER + "[loading]\nsteps = 6\n"
        self.run_case(case, name="whole")
        self.run_case(case, name="parts", words=("--stop-after", "3"), code=130)
        self.resume("parts")
        self.assertEqual(differences(self.folder / "whole", self.folder / "parts"), [])

    def test_tangents(self):
        for shape, (case, of, axis) in SHAPES.items():
            with self.subTest(shape):
                case = driven(case, of, axis, self.rows(case + SOLVER)[-1][f"reaction_{axis}:{of}"]) + SOLVER
                axes = "xyz"[: int(case.split("dimension = ")[1][0])]
                deformation = "; ".join(f"{a} + 1e-4*({' + '.join(f'{k + 1 + j}*{b}' for j, b in enumerate(axes))})"
                                        for k, a in enumerate(axes))  # fmt: skip
                found = self.peristat("check-tangent", self.write("case.toml", case), "--deformation", deformation)
                self.assert_completed(found)
                told = json.loads(found.output)
                self.assertLess(told["residual_error"], 1e-8)
                self.assertLess(told["tangent_error"], 1e-8)

    def test_bad_input_is_refused(self):
        moved, case = BLOCK + PLANE + SOLVER, driven(*SHAPES["plane"], -3e4) + SOLVER
        for given, change, message in (
            (moved, "obstacle[0].force=-1", 'needs a component of displacement that is "free"'),
            (moved, 'obstacle[0].displacement=[0, "free"]', "needs a force that drives the obstacle"),
            (case, 'obstacle[0].displacement=["free", "free"]', "is for one component"),
            (case, 'obstacle[0].displacement=["free", 0]', "acts along the plane"),
            (case, "obstacle[0].force=3e4", "drives the obstacle away from the body"),
            (case, "obstacle[0].friction=0.2", "friction"),
            (case, 'obstacle[0].force="-1e3*y"', "y"),
            (case, 'obstacle[0].force="-1e3*/load"', "force"),
            (case, 'obstacle[0].force="-1/0"', "force"),
            (case, 'obstacle[0].force="-1e4/(load - 1)"', "force"),
            (case, 'obstacle[0].force="free"', "force"),
            (case, "obstacle[0].force=[0, -1]", "force"),
            (case, 'obstacle[0].force="-1 mm"', "force"),
            (case, "obstacle[0].force=nan", "force"),
            (case, "obstacle[0].forces=-1", "forces"),
            (case, "solver={mode=\"arc_length\"}", "arc_length"),
        ):  # fmt: skip
            with self.subTest(change):
                self.assertIn(message, self.refusal(given, change).replace("\n", " "))

    def test_a_force_that_nothing_bears_any_more_ends_the_run(self):
        """A roller that is pushed while it moves off the body."""
        case = driven(*SHAPES["roller"], -1e4).replace('"1e-5*load"', '"40e-3*(load > 0.6)*load"') + SOLVER
        self.run_case(case, "loading.steps=5", "loading.adaptive=false", code=(2, 3))
        self.assertRegex(self.ended.said.replace("\n", " "), "no place of an obstacle bears its force|no point is in its way")


class DrivenInMotion(Pressed):
    """A force that acts from the start on the end of a bar: behind the wave that it sends the end moves at F / (A rho c)."""

    def test_the_end_of_a_bar_moves_as_a_wave_tells(self):
        force, area, density, modulus = 2e3, 1e-4, 8000.0, 200e9
        bar = driven(BAR, "wall", "x", -force).replace(f'"{-force!r}*load"', repr(-force))
        bar = bar.replace("youngs_modulus = 200e9", "youngs_modulus = 200e9\ndensity = 8000")
        bar = bar.replace("spacing = 1e-2", "spacing = 2.5e-3")
        case = bar + '[quadrature]\nvolume_correction = "linear"\n[solver]\nmode = "dynamics"\n'
        case += "[dynamics]\nend_time = 8e-5\nhistory_every = 1\n"
        wave = (modulus / density) ** 0.5
        speed = force / (area * density * wave)
        case += '[[initial]]\nvelocity = ["0"]\n'
        for name, changes in {"verlet": (), "newmark": ('dynamics.scheme="newmark"', "dynamics.time_step=2e-7",
                                                        "solver.linear=cholesky")}.items():  # fmt: skip
            with self.subTest(name):
                self.run_case(case, *changes, name=name)
                rows = table(self.folder / name / "history.csv")
                self.assertTrue(all(abs(row["reaction_x:wall"] / -force - 1) < 1e-9 for row in rows))
                times = numpy.array([row["time"] for row in rows])
                ways = numpy.array([row["displacement_x:wall"] for row in rows])
                late = times > 2e-5
                slope = numpy.polyfit(times[late], ways[late], 1)[0]
                self.assertAlmostEqual(slope / -speed, 1, delta=0.03)
                done = [row["kinetic_energy"] + row["stored_energy"] for row in rows]
                work = [row["external_work"] for row in rows]
                self.assertLess(numpy.abs(numpy.array(done) - work).max(), 0.02 * work[-1])
