"""Terms other than bonds at rest on ranks: linear kinematics with failing points, state-based bodies with breaking
bonds, pressures and foundations of every model, at rest and in motion."""

import unittest

import h5py

from tests.acceptance.on_ranks import PLATE, SHEET, SOLVER, SQUARE, STATES, STORED, Comparison, rows
from tests.acceptance.ranks_bodies_test import CELL, SLOPED, TOP

LINEAR = PLATE.replace('model = "bond"', 'kinematics = "linear"')
# A notched strip without any symmetry, whose points fail in a row ahead of the notch.
STRIP = """
dimension = 2
[lattice]
spacing = 0.05
thickness = 0.01
shape = [{ add = "box", min = [0, 0], max = [1.2, 1] }, { subtract = "box", min = [-1, 0.5], max = [0.4, 0.6] }]
layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
[[set]]                    # what were torn through would bear round-off alone
name = "whole"
where = "x > 0.9"
[material]
kinematics = "linear"
youngs_modulus = 1e9
density = 1000
[material.damage]
law = "energy_density"
fracture_energy = 100
no_fail = ["bottom", "top", "whole"]
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
"""
PULLED = STRIP + 'displacement = ["1e-4*load", "1e-3*load"]\n[loading]\nsteps = 4\n'
IN_MOTION = STRIP + """displacement = ["0", "2*t"]
[[initial]]
velocity = ["0", "2*y + 0.2*x"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 1e-3
history_every = 4
[output]
every = 8
"""
NEWMARK = ('dynamics.scheme="newmark"', "dynamics.time_step=2e-5", 'solver.linear="pcg"',
           'solver.preconditioner="block_jacobi"', "solver.linear_tolerance=1e-12",
           "solver.relative_tolerance=1e-12")  # fmt: skip


class Terms(Comparison):
    def compare_settings(self, text, *of, ranks=(2,), solver=SOLVER):
        with self.subTest(settings=of):
            return self.compare(text, ranks, *of, solver=solver)

    def broken(self, output):
        return [(row["step"], row["first_point"], row["second_point"]) for row in rows(output, "broken_bonds.csv")]

    def failed(self, output):
        with h5py.File(output / "results.h5") as file:
            return [int((file[f"steps/{step}/damage"][()] == 1.0).sum()) for step in file["steps"]]

    def goes_on(self, text, *of, first=2, then=3, after=2):
        """A run that is stopped on some ranks is resumed on others."""
        options = of
        whole = self.run_on(1, text, *options).rename(self.folder / f"whole_{len(list(self.folder.iterdir()))}")
        output = self.run_on(first, text, *options, words=("--stop-after", after), code=130)
        self.resume_on(then, output)
        self.expect_same(whole, output)
        return output


class LinearKinematics(Terms):
    def test_a_plate_with_a_hole(self):
        self.compare_settings(LINEAR, "output.stress=true", ranks=(4,))
        self.compare_settings(LINEAR, 'quadrature.surface_correction="energy"', "crack=[{from=[0.7, 0.3], to=[1, 0.3]}]",
                              'solver.preconditioner="rigid_pieces"',
                              'region=[{set="corner", material={youngs_modulus=3e9}}]')  # fmt: skip

    def test_constraints(self):
        linear = SLOPED.replace('model = "bond"', 'kinematics = "linear"')
        self.compare_settings(linear, "solver.linear_tolerance=1e-12", solver=STORED)
        turned = LINEAR.replace(TOP, '[[rigid]]\nset = "top"\nrotation = ["0.02*load"]')
        self.compare_settings(turned, solver=STORED)
        self.compare_settings(CELL.replace('model = "bond"', 'kinematics = "linear"'), ranks=(2,), solver=STORED)
        whole = 'symmetry=[{axis="x", at=1.2}]'
        for text, options in ((PULLED, ["solver.relative_tolerance=1e-8"]), (IN_MOTION, [])):
            one = self.compare_settings(text, whole, *options, ranks=(3,), solver="" if text is IN_MOTION else STORED)
            self.assertGreater(self.failed(one)[-1], 10)

    def test_several_materials_that_fail(self):
        one = self.compare_settings(PULLED, 'set=[{name="right", where="x > 0.7"}, {name="whole", where="x > 0.9"}]',
                                    'region=[{set="right", material={youngs_modulus=2e9, damage={law="energy_density", fracture_energy=50}}}]',
                                    "solver.relative_tolerance=1e-8", "solver.linear_tolerance=1e-11", ranks=(2,))  # fmt: skip
        self.assertGreater(self.failed(one)[-1], 5)

    def test_ranks_without_a_point(self):
        bar = """
            dimension = 1
            [lattice]
            spacing = 0.1
            area = 2.0
            shape = [{ add = "box", min = [0], max = [0.5] }]
            [material]
            kinematics = "linear"
            youngs_modulus = 7.0
            density = 3.0
            [material.damage]
            law = "energy_density"
            fracture_energy = 4e-5
            [[initial]]
            velocity = ["0.12*x*x + 0.1"]
            [solver]
            mode = "dynamics"
            [dynamics]
            end_time = 0.45
            history_every = 1
        """
        one = self.compare(bar, (2, 7), solver="")
        self.assertGreater(self.failed(one)[-1], 0)

    def test_points_that_fail_at_rest(self):
        # What a second iteration would correct is round-off, which takes other numbers of products.
        one = self.compare_settings(PULLED, "solver.relative_tolerance=1e-8", ranks=(4,))
        count = self.failed(one)
        self.assertEqual(count[0], 0)
        self.assertGreater(count[-1], 10)
        self.assertGreater(len({step for step, _, _ in self.broken(one)}), 0)

    def test_points_that_fail_in_relaxation(self):
        one = self.compare_settings(PULLED, 'solver.mode="relaxation"')
        self.assertGreater(self.failed(one)[-1], 10)

    def test_points_that_fail_in_motion(self):
        one = self.compare_settings(IN_MOTION, ranks=(2,), solver="")
        self.assertGreater(self.failed(one)[-1], 10)
        one = self.compare_settings(IN_MOTION, *NEWMARK, solver="")
        self.assertGreater(self.failed(one)[-1], 10)

    def test_failures_that_go_on_with_another_number_of_ranks(self):
        for first, then in ((2, 3), (3, 1)):
            output = self.goes_on(PULLED + SOLVER, first=first, then=then, after=3)
            self.assertGreater(self.failed(output)[-1], 10)
        self.goes_on(IN_MOTION, "dynamics.history_every=1", after=9)


# Torn from a pre-crack and a hole; broken bonds change the dilatation of a point.
TORN = """
dimension = 2
[lattice]
spacing = 0.1
horizon_ratio = 2.515
thickness = 0.01
shape = [{ add = "box", min = [0, 0], max = [1.2, 1.6] }, { subtract = "disk", centre = [0.72, 0.83], radius = 0.2 }]
layer = [{ name = "bottom", side = "y-" }, { name = "top", side = "y+" }]
[[crack]]
from = [0, 0.9]
to = [0.22, 0.93]
[[set]]
name = "whole"
where = "x > 0.9"
[quadrature]
form = "energy"
[material]
model = "lps"
plane = "stress"
youngs_modulus = 1e9
poisson_ratio = 0.2
density = 1000
[material.damage]
law = "critical_stretch"
critical = 0.03
no_fail = ["bottom", "top", "whole"]
[[support]]
set = "bottom"
displacement = [0, 0]
[[support]]
set = "top"
"""
TORN_AT_REST = TORN + 'displacement = ["0.01*load", "0.06*load"]\n[loading]\nsteps = 4\n[relaxation]\nsteps = 8\n' + STORED
TORN_IN_MOTION = TORN + """displacement = ["0", "20*t"]
[[initial]]
velocity = ["0", "12*y + x"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 3e-3
history_every = 4
[output]
every = 8
"""


class States(Terms):
    """Bonds of state-based models break like other bonds, and the energy dissipated with each is counted once."""

    def compare_torn(self, text, *of, ranks=(2,)):
        options = of
        runs = self.ended_on_each((1, *ranks), text, *options, code=(0, 3))
        one_run, one = runs.pop(1)
        for count, (several, found) in runs.items():
            with self.subTest(ranks=count, settings=of):
                self.assertEqual(several.code, one_run.code, several.said)
                self.assertEqual(self.broken(one), self.broken(found))
                self.expect_same(one, found)
        self.assertGreater(len(self.broken(one)), 20)
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(file["history/dissipated_energy"][-1], 0.0)
        return one

    def test_a_plate_that_is_torn(self):
        self.compare_torn(TORN_AT_REST, 'solver.mode="adaptive"', ranks=(3,))
        self.compare_torn(TORN_AT_REST, 'solver.mode="relaxation"', ranks=(4,))

    def test_several_materials_that_are_torn(self):
        two = ('set=[{name="upper", where="y > 1"}, {name="whole", where="x > 0.9"}]',
               'region=[{set="upper", material={youngs_modulus=2e9, poisson_ratio=0.2, density=1000, damage={law="critical_stretch", critical=0.02}}}]')
        self.compare_torn(TORN_AT_REST, 'solver.mode="adaptive"', *two, ranks=(2,))

    def test_in_motion(self):
        self.compare_torn(TORN_IN_MOTION, ranks=(2,))
        self.compare_torn(TORN_IN_MOTION, *NEWMARK)

    def test_tears_that_go_on_with_another_number_of_ranks(self):
        for first, then in ((1, 2), (3, 1)):
            output = self.goes_on(TORN_AT_REST, 'solver.mode="relaxation"', first=first, then=then, after=4)
            self.assertGreater(len(self.broken(output)), 20)
        self.goes_on(TORN_IN_MOTION, "dynamics.history_every=1", after=20)


class Triangles(Terms):
    def test_several_materials_that_soften(self):
        two = ('set=[{name="right", where="x > 0.7"}]',
               'region=[{set="right", material={c1=2.0, c2=60.0, damage={law="tanh", onset=0.06, critical=0.09, rate=3}}}]')
        one = self.compare_settings(SHEET + 'displacement = ["0.038*load", 0]\n', *two, ranks=(2,), solver=STORED)
        with h5py.File(one / "results.h5") as file:
            self.assertGreater(file["history/dissipated_energy"][-1], 0.0)

    def test_softening_at_planes_and_periods(self):
        """Triangles also have sides between images, whose bonds soften like their originals."""
        pulled = 'displacement = ["0.038*load", 0]\n[loading]\nsteps = 4\n'
        half = SHEET.replace("max = [1.2, 1.1]", "max = [1.2, 0.6]").replace("centre = [0.72, 0.63]", "centre = [0.72, 0.6]")
        for text, beyond in ((half, 'symmetry=[{axis="y", at=0.6}]'), (SHEET, 'period=[{axis="y", from=0, to=1.1}]')):
            one = self.compare_settings(text + pulled, beyond, ranks=(3,), solver=STORED)
            with h5py.File(one / "results.h5") as file:
                self.assertGreater(file["history/dissipated_energy"][-1], 0.0)
            there_and_back = pulled.replace("steps = 4", "table = [0, 0.25, 0.5, 0.75, 1, 0.7, 0.3]")
            self.goes_on(text + there_and_back + STORED, beyond, after=4)
        # Round-off of detached parts decides when the body is found to be at rest.
        tearing = half + pulled.replace("0.038", "0.2") + STORED
        options = 'symmetry=[{axis="y", at=0.6}]', 'solver.mode="relaxation"'
        one, several = (self.broken(self.run_on(ranks, tearing, *options)) for ranks in (1, 3))
        self.assertEqual(one, several)
        self.assertGreater(len(one), 10)


# Pressures in a hole and on a side, springs to a moving ground; functions of the load at rest, of time in motion.
HOLE = 'set=[{name="hole", where="sqrt((x-0.5)^2 + (y-0.7)^2) < 0.28"}, {name="corner", where="x > 0.6 && y > 1"}]'
PRESSURES = 'load=[{set="hole", pressure="PRESSURE*RISE*(1+y)"}, {side="x+", pressure="PRESSURE*0.1"}]'
GROUND = ('foundation=[{name="soil", set="corner", stiffness=[MODULUS, MODULUS], displacement=["0.01*RISE", 0]}, '
          '{name="side", side="x+", modulus=[MODULUS, 0]}]')  # fmt: skip
MOVING = """
[solver]
mode = "dynamics"
[dynamics]
end_time = END
history_every = 3
[output]
every = 6
[[initial]]
velocity = ["0.1", "0.2*x"]
"""


def in_motion(plate):
    moved = plate.replace('"0.05*load"', '"1e-4*sin(2000*t)"').replace("1e6*load*y", "1e3*y")
    return moved.replace("[loading]\nsteps = 2\n", "").replace("[material]\n", "[material]\ndensity = 1000\n") + MOVING.replace("END", "1e-3")


def under(load, pressure, stiffness, with_pressures=True):
    found = (GROUND, PRESSURES) if with_pressures else (GROUND,)
    return [text.replace("RISE", load).replace("PRESSURE", pressure).replace("MODULUS", stiffness) for text in found]


class PressuresAndFoundations(Terms):
    def test_of_states_at_rest(self):
        one = self.compare_settings(STATES, HOLE, *under("load", "2e7", "1e7"), ranks=(2,), solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:soil"]), 0.0)

    def test_of_bonds_and_states_in_motion(self):
        for plate in (PLATE, STATES):
            moving = in_motion(plate)
            one = self.compare_settings(moving, HOLE, *under("(t/1e-3)", "2e5", "1e7"), ranks=(2,), solver="")
            self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:soil"]), 0.0)
            self.compare_settings(moving, HOLE, *under("(t/1e-3)", "2e5", "1e7"), *NEWMARK, solver="")

    def test_of_triangles(self):
        sides = ('foundation=[{name="side", side="y+", modulus=[1e-3, 1e-3], displacement=["0.01*TIME", 0]}]',
                 'load=[{side="y-", pressure="1e-3*TIME"}]')  # fmt: skip
        at_rest = [text.replace("TIME", "load") for text in sides]
        one = self.compare_settings(SQUARE, *at_rest, ranks=(2,), solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:side"]), 0.0)
        moving = [text.replace("TIME", "t") for text in sides]
        self.compare_settings(SHEET + 'displacement = ["0.02*t", 0]\n', *moving, 'solver.mode="dynamics"',
                              "dynamics={end_time=1, history_every=4}", solver="")  # fmt: skip

    def test_bonds_that_break_under_a_pressure(self):
        breaking = in_motion(PLATE), HOLE, *under("(t/1e-3)", "4e7", "1e7"), 'material.damage={law="critical_stretch", critical=0.02}'
        one = self.compare_settings(*breaking, solver="")
        self.assertGreater(len(self.broken(one)), 20)
        self.goes_on(*breaking, "dynamics.history_every=1", "output.every=7", after=5)


ROLLER = ('obstacle=[{name="roller", shape="cylinder", point=[1.3, 0.8], radius=0.3, displacement=["-0.03*RISE", 0]}, '
          '{name="wall", shape="plane", point=[1.0, 0.7], normal=[-1, 0], set="right"}]')  # fmt: skip
RIGHT = 'set=[{name="corner", where="x > 0.6 && y > 1"}, {name="right", where="x > 0.9 && y > 1.2"}]'


class Obstacles(Terms):
    def test_a_plate_between_obstacles_at_rest(self):
        one = self.compare_settings(PLATE, RIGHT, ROLLER.replace("RISE", "load"), ranks=(2, 3), solver=STORED)
        last = rows(one, "history.csv")[-1]
        self.assertNotEqual(float(last["reaction_x:roller"]), 0.0)
        self.assertNotEqual(float(last["moment_z:wall"]), 0.0)

    def test_a_plate_in_motion(self):
        moving = in_motion(PLATE), RIGHT, ROLLER.replace("RISE", "sin(1000*t)")
        one = self.compare_settings(*moving, solver="")
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:roller"]), 0.0)
        self.compare_settings(*moving, *NEWMARK, solver="")


GMRES = SOLVER.replace('"pcg"', '"gmres"').replace('tangent = "matrix_free"\n', "").replace("1e-9", "1e-12")
COLLOCATED = STATES.split("[quadrature]")[0].replace("radius = 0.2 }", 'radius = 0.2, name = "hole" }')
TRACTIONS = ('load=[{side="x+", traction=["2e6*load*y", "1e6"]}, {boundary="hole", stress=["1e6*load", "2e6", "1e6*x"]}, '
             '{set="corner", body_force=["1e6*load", "0"]}]')  # fmt: skip


class Collocation(Terms):
    """Forces without a potential, with quadrature weights of balls that extend over parts and surfaces."""

    def test_a_plate_under_tractions(self):
        one = self.compare_settings(COLLOCATED, TRACTIONS, "output.stress=true", ranks=(4,), solver=GMRES)
        self.assertGreater(float(rows(one, "history.csv")[-1]["stored_energy"]), 0.0)
        self.compare_settings(COLLOCATED, TRACTIONS.replace("stress", "pressure").replace('["1e6*load", "2e6", "1e6*x"]', '"1e6*load"'),
                              "lattice.perturbation=0.1", 'quadrature.normals="exact"', 'quadrature.traction_form="paper"',
                              "crack=[{from=[0.7, 0.3], to=[1, 0.3]}]",
                              'region=[{set="corner", material={youngs_modulus=2e9, poisson_ratio=0.3}}]', ranks=(2, 3), solver=GMRES)  # fmt: skip

    def test_in_motion(self):
        """By implicit steps, with breaking bonds."""
        steps = [word for word in NEWMARK if "solver.linear=" not in word] + ['solver.linear="bicgstab"']
        for perturbation, ranks in ((0.0, (2,)), (0.1, (4,))):
            self.compare_settings(in_motion(COLLOCATED), f"lattice.perturbation={perturbation}", *steps, ranks=ranks, solver="")
        torn = in_motion(COLLOCATED).replace('"1e-4*sin(2000*t)"', '"20*t"')
        one = self.compare_settings(torn, "dynamics.end_time=8e-4", 'material.damage={law="critical_stretch", critical=0.01, no_fail=["bottom", "top"]}', *steps,
                                    ranks=(3,), solver="")  # fmt: skip
        self.assertGreater(len(self.broken(one)), 5)


if __name__ == "__main__":
    unittest.main()
