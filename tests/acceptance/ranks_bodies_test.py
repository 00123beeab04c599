"""Bodies of all kinds have the same results on several MPI ranks as on one."""

import shutil
import unittest

import h5py

from tests.acceptance.on_ranks import (
    CUBE,
    PIECES,
    PLATE,
    SOLVER,
    SQUARE,
    STATES,
    STORED,
    Comparison,
    linear_iterations,
    objects,
    rows,
)
from tests.acceptance.surfaces import binary, sphere
from tests.reference.graded import GradedRing, patch_test
from tests.reference.program import ROOT


# A periodic sheet with a hole, which is free to contract along y.
CELL = """
dimension = 2
[lattice]
spacing = 0.1
thickness = 0.01
volumes = "fractional"
shape = [{ add = "box", min = [-0.6, -0.8], max = [0.6, 0.8] }, { subtract = "disk", centre = [0.05, 0.1], radius = 0.25 }]
[quadrature]
surface_correction = "energy"
[material]
model = "bond"
youngs_modulus = 1e9
[[period]]
axis = "x"
from = -0.6
to = 0.6
gradient = ["1e-2*load", "2e-3*load"]
[[period]]
axis = "y"
from = -0.8
to = 0.8
gradient = [0, "free"]
[[set]]
name = "left"
where = "x < -0.4"
[[set]]
name = "right"
where = "x > 0.4"
[[load]]
set = "left"
total_force = ["2e4*load", 0]
[[load]]
set = "right"
total_force = ["-2e4*load", 0]
[loading]
steps = 2
"""


# Their sets extend over all ranks, overlap, and contain points of the support.
MEANS = """
[[set]]
name = "upper"
where = "y > 1.2 && y < 1.5"
[[set]]
name = "column"
where = "x < 0.2 && y < 1.1"
[[constraint]]
name = "pull"
displacement = "0.03*load"
[[constraint.term]]
set = "upper"
weights = [0.5, 1]
[[constraint]]
name = "tie"
[[constraint.term]]
set = "upper"
weights = [1, 0]
[[constraint.term]]
set = "column"
weights = [-0.4, 0.2]
"""
PULL = """
[[set]]
name = "pulled_too"
where = "RULE"
[[constraint]]
name = "pull"
displacement = "0.02*load"
[[constraint.term]]
set = "pulled_too"
weights = [0.2, 1]
"""
# The means of two sets move alike, and one of them does not rotate.
BETWEEN = """
[[set]]
name = "low"
where = "y > 0.3 && y < 0.5"
[[set]]
name = "high"
where = "y > 0.8 && y < 1"
[[set]]
name = "right"
where = "y > 0.8 && y < 1 && x > 0.8"
[[constraint]]
name = "along"
term = [{ set = "high", weights = [1, 0] }, { set = "low", weights = [-1, 0] }]
[[constraint]]
name = "across"
term = [{ set = "high", weights = [0, 1] }, { set = "low", weights = [0, -1] }]
[[constraint]]
name = "turn"
term = [{ set = "right", weights = [0, 1] }]
"""
# Held at its foot, 378 points.
CUBE_ON_ROLLERS = """
dimension = 3
[lattice]
spacing = 0.1
horizon_ratio = 2.015
shape = [{ add = "box", min = [0, 0, 0], max = [0.7, 0.6, 0.9] }]
layer = [{ name = "foot", side = "z-", thickness = 2 }]
[material]
model = "bond"
youngs_modulus = 1e6
[[support]]
set = "foot"
displacement = [0, 0, 0]
[loading]
steps = 1
"""


TOP = '[[support]]\nset = "top"\ndisplacement = [0, "0.05*load"]'
SLOPED = PLATE.replace(TOP, '[[roller]]\nset = "top"\nnormal = [1, 3]\ndisplacement = "0.05*load*(1+x)"')
FREE = SLOPED.replace('"0.05*load*(1+x)"', '"free"') + '[[load]]\nset = "top"\ntotal_force = [0, "2e5*load"]\n'


class Bodies(Comparison):
    """Shipped cases, coarser, and small bodies: their bodies are identical for any number of ranks."""

    def compare_shipped(self, case, *settings, ranks=(2,)):
        text = (ROOT / "cases" / f"{case}.toml").read_text()
        options = ('solver.linear="pcg"', 'solver.preconditioner="block_jacobi"', "solver.linear_tolerance=1e-9",
                   *settings)  # fmt: skip
        with self.subTest(case=case):
            return self.compare(text, ranks, *options, solver="")

    def compare_settings(self, text, *settings, ranks=(2,), solver=SOLVER):
        with self.subTest(settings=settings):
            return self.compare(text, ranks, *settings, solver=solver)

    def test_several_materials(self):
        self.compare_shipped("regions/bimaterial", "lattice.spacing=0.01", ranks=(2,))
        # A third solution would be of round-off, with as many iterations as that gives.
        self.compare_shipped("regions/composite", "lattice.spacing=1e-3", "solver.relative_tolerance=1e-7")

    def test_ellipses_and_shapes_from_files(self):
        shutil.copy(ROOT / "cases/regions/aggregates.png", self.folder)
        self.compare_shipped("regions/aggregates", "lattice.spacing=2e-3")
        self.write("outline.csv", "0.2 0.9\n0.3 0.9\n0.3 1.2\n0.2 1.2\n")
        self.compare_settings(PLATE.replace(
            '{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
            '{ subtract = "ellipse", centre = [0.5, 0.7], radii = [0.3, 0.1], angle = 40, cuts_bonds = true }, '
            '{ subtract = "polygon", file = "outline.csv" }'))  # fmt: skip
        (self.folder / "ball.stl").write_bytes(binary(sphere(0.2, 12)))
        self.compare_settings(CUBE_ON_ROLLERS.replace(
            '[material]', '[[set]]\nname = "core"\nshape = { stl = { file = "ball.stl", translate = [0.3, 0.3, 0.5] } }\n[material]')
            + '[[region]]\nset = "core"\nmaterial = { micromodulus = 1e6 }\n[[load]]\nset = "core"\nbody_force = [0, 0, "1e3*load"]\n')

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
        self.compare_settings(PLATE, "lattice.angle=20", 'quadrature.surface_correction="volume"', ranks=(2,))
        self.compare_settings(PLATE, "lattice.angle=20", 'lattice.volumes="fractional"',
                              'quadrature.volume_correction="linear"', ranks=(4,))  # fmt: skip
        self.compare_settings(PLATE, "lattice.cell_perturbation=0.2", 'quadrature.volume_correction="exact"')

    def test_meshes_are_refused(self):
        (self.folder / "plate.msh").write_text("")
        text = PLATE.split("[lattice]")[0] + '[points]\nfile = "plate.msh"\nhorizon = 0.16\n[material]' + \
            PLATE.split("[material]")[1]
        ended = self.peristat("run", self.case(text), "--ranks", "2", "--output", "out")
        self.assert_code(ended, 2)
        self.assertIn("peristat points", ended.errors)

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
        one = self.compare_settings(text, 'quadrature.volume_correction="linear"', ranks=(3,))
        with h5py.File(one / "results.h5") as file, h5py.File(self.folder / "on_3/results.h5") as several:
            row = file["points/source_row"][()]
            self.assertEqual(sorted(row), list(range(len(rows) - 1)))
            self.assertEqual(list(row), list(several["points/source_row"][()]))
            places = [[float(word) for word in rows[1 + k].split(",")[:2]] for k in row]
            self.assertEqual(places, several["points/reference"][()].tolist())
        scaled = self.compare_settings(text, 'points.length_unit="2 m"', "points.horizon=0.32", 'points.thickness="2 cm"', 'units.stress="kPa"',
                                       ranks=(2,))  # fmt: skip
        with h5py.File(scaled / "results.h5") as file:
            self.assertEqual([[2 * x for x in place] for place in places], file["points/reference"][()].tolist())

    def test_a_horizon_per_point(self):
        ring = GradedRing(16)
        ring.write(self.folder / "points.csv", ring.places[:, 1] < 3 * ring.sizes)
        tearing = '[material.damage]\nlaw = "linear"\nfracture_energy = 1.0'
        images = '[[symmetry]]\naxis = "x"\nat = 0'
        for surface, more in (("volume", tearing), ("energy", images)):
            quadrature = f'volume_correction = "linear"\nsurface_correction = "{surface}"'
            text = patch_test("points.csv", "{ ratio = 2.515 }", quadrature, more, "")
            one = self.compare_settings(text, 'support=[{set="held", displacement=["1e-5*load*x*y", "1e-5*load"]}]',
                                        'set=[{name="far", where="x < 1"}]', 'load=[{set="far", body_force=["600*load", "900*load"]}]',
                                        "loading.steps=2", ranks=(3,), solver=STORED)  # fmt: skip
            with h5py.File(one / "results.h5") as file, h5py.File(self.folder / "on_3/results.h5") as several:
                horizons = file["points/horizon"][()]
                self.assertGreater(horizons.max() / horizons.min(), 3.5)
                self.assertEqual(horizons.tolist(), several["points/horizon"][()].tolist())
                self.assertEqual(more == tearing, file["steps/000002/damage"][()].max() > 0.01)

    def test_loads(self):
        side = 'load=[{side="x+", traction=["1e5*load*y", "2e5"]}]'
        self.compare_settings(PLATE, side, ranks=(2,))
        self.compare_settings(PLATE, side.replace('"2e5"]', '"2e5"], depth="horizon"'))
        self.compare_settings(PLATE, 'set=[{name="corner", where="y > 1.45 && y < 1.5"}]', 'load=[{set="corner", traction=["1e5*load", "0"]}]')

    def test_pressures_and_foundations(self):
        self.compare(PLATE, (2,), 'set=[{name="hole", where="sqrt((x-0.5)^2 + (y-0.7)^2) < 0.28"}]',
                     'load=[{set="hole", pressure="4e7*load*(1+y)"}, {side="x+", pressure="1e6"}]', solver=STORED)  # fmt: skip
        ground = ('foundation=[{name="soil", set="corner", stiffness=[1e7, 2e7], displacement=["0.01*load", 0]}, '
                  '{name="side", side="x+", modulus=[1e8, 0]}]')  # fmt: skip
        one = self.compare(PLATE, (3,), ground, solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:soil"]), 0.0)
        self.compare(PLATE, (4,), 'load=[{set="corner", pressure="4e7*load"}]', ground, solver=PIECES)

    def test_planes_of_symmetry(self):
        half = ('symmetry=[{axis="x", at=1}]', "output.stress=true")
        self.compare(PLATE, (2,), *half, 'quadrature.surface_correction="energy"', solver=STORED)
        self.compare(SQUARE, (3,), 'symmetry=[{axis="y", at=0}]', "output.stress=true", solver=STORED)
        self.compare(CUBE, (2,), 'symmetry=[{axis="y", at=0}]', "loading.table=[0, 0.2]", solver=STORED)
        # Thinner than the horizon, between two planes, and a rank may own nothing.
        thin = PLATE.replace("max = [1, 1.5]", "max = [0.1, 0.5]").replace(', { subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }', "")
        thin = thin.replace("x > 0.6 && y > 1", "y > 0.3")
        one = self.compare(thin, (3,), 'symmetry=[{axis="x", at=0}, {axis="x", at=0.1}]', solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:symmetry_x-"]), 0.0)

    def test_pressures_beyond_planes_and_periods(self):
        pressure = 'load=[{set="hole", pressure="4e7*load*(1+y)"}, {side="y+", pressure="1e6*load"}]'
        hole = 'set=[{name="hole", where="sqrt((x-0.5)^2 + (y-0.7)^2) < 0.28"}, {name="corner", where="x > 0.6 && y > 1"}]'
        held = PLATE.replace(', { name = "top", side = "y+" }', "").replace('set = "top"', 'set = "corner"').replace('[[set]]\nname = "corner"\nwhere = "x > 0.6 && y > 1"\n', "")
        for beyond in ('symmetry=[{axis="x", at=0.5}]', 'period=[{axis="x", from=0, to=1, gradient=["1e-3*load", 0]}]'):
            shape = held.replace("min = [0, 0]", "min = [0.5, 0]") if "symmetry" in beyond else held
            self.compare(shape, (2,), pressure, hole, beyond, solver=STORED)

    def test_relaxation_of_what_follows(self):
        relaxed = 'solver.mode="relaxation"'
        self.compare(PLATE, (3,), relaxed, 'symmetry=[{axis="x", at=1}]', solver=STORED)
        self.compare(CELL, (2,), relaxed, solver=STORED)
        free = PLATE.replace("y > 1", "y > 1 && y < 1.4") + '[[rigid]]\nset = "corner"\nrotation = ["0.02*load"]\n'
        self.compare(free, (2,), relaxed, solver=STORED)

    def test_periods(self):
        one = self.compare(CELL, (2,), solver=STORED.replace('tangent = "stored"\n', ""))
        self.assertLess(float(rows(one, "history.csv")[-1]["gradient_y:period_y"]), 0.0)
        strip = CELL.replace("0.6", "0.1").replace("0.4", "0").replace('"fractional"', '"cells"')
        self.compare(strip.replace(', { subtract = "disk", centre = [0.05, 0.1], radius = 0.25 }', ""), (3,), solver=STORED)

    def test_a_cell_goes_on_with_another_number_of_ranks(self):
        text = CELL.replace("steps = 2", "steps = 3") + STORED
        one = self.run_on(1, text)
        output = self.run_on(2, text, words=("--stop-after", 1), code=130)
        shutil.copytree(output, self.folder / "stopped")
        self.resume_on(3, output)
        self.expect_same(one, output)
        # Its state has no images, which that of one rank has.
        self.resume_on(1, "stopped", code=2)

    def test_rigid_sets(self):
        turned = PLATE.replace('[[support]]\nset = "top"\n', '[[rigid]]\nset = "top"\nrotation = ["0.2*load"]\n')
        self.compare(turned, (2,), solver=STORED)
        free = PLATE.replace("y > 1", "y > 1 && y < 1.4") + '[[rigid]]\nset = "corner"\nrotation = ["0.02*load"]\n'
        one = self.compare(free, (3,), solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["moment_z:corner"]), 0.0)
        # Two pieces with no other connection.
        apart = PLATE.replace('{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
                              '{ subtract = "box", min = [-1, 0.5], max = [2, 0.8] }')  # fmt: skip
        apart = apart.replace('[[support]]\nset = "top"\ndisplacement = [0, "0.05*load"]\n',
                              '[[set]]\nname = "both"\nwhere = "y > 0.3 && y < 1"\n[[rigid]]\nset = "both"\nrotation = ["0.01*load"]\n')  # fmt: skip
        self.compare(apart, (4,), solver=STORED)
        for text, pulled in ((SQUARE, "pulled"), (STATES, "top")):
            turned = f'[[rigid]]\nset = "{pulled}"\nrotation = ["0.01*load"]'
            self.compare(text.replace(f'[[support]]\nset = "{pulled}"', turned), (2,), solver=STORED)

    def test_rollers(self):
        """Of all points of a set, on several ranks and not on all of them."""
        one = self.compare(SLOPED, (4,), solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_y:top"]), 0.0)
        one = self.compare(FREE, (2,), solver=STORED)
        self.assertLess(abs(float(rows(one, "history.csv")[-1]["reaction_y:top"])), 1.0)

    def test_relaxation_and_damage_under_rollers_and_linear_constraints(self):
        """Pseudo masses equal those of one rank."""
        means = PLATE.replace(TOP, MEANS)
        for text in (FREE, means):
            self.compare_settings(text, 'solver.mode="relaxation"', ranks=(2,), solver=STORED)
        breaking = 'material.damage={law="critical_stretch", critical=0.02, no_fail=["bottom", "top"]}'
        for mode in ("adaptive", "relaxation"):
            one = self.compare_settings(SLOPED, breaking, f'solver.mode="{mode}"', ranks=(2,), solver=STORED)
            self.assertGreater(len(rows(one, "broken_bonds.csv")), 10)
        options = (breaking, 'solver.mode="adaptive"', "lattice.spacing=0.1")
        one = self.compare(means, (2,), *options, solver=STORED)
        self.assertGreater(len(rows(one, "broken_bonds.csv")), 10)
        softening = breaking.replace('"critical_stretch", critical=0.02', '"tanh", onset=0.02, critical=0.4, rate=2')
        self.compare_settings(SLOPED, softening, 'solver.mode="newton"', solver=STORED)
        refused = self.refusal(SLOPED + STORED, breaking, 'solver.mode="relaxation"', 'relaxation.method="flow"', ranks=2)
        self.assertIn('take "dynamic"', " ".join(refused.split()))

    def test_rollers_that_touch(self):
        """Nothing else holds the beam: the points that a roller holds on average are on two ranks."""
        case = (ROOT / "cases/three_point_bending/rollers.toml").read_text()
        self.compare(case.replace("5e-4", "1.5e-3"), (2,), solver=STORED)
        line = CUBE_ON_ROLLERS + '[[roller]]\nname = "edge"\nat = [0.0, 0.4, 0.9]\nto = [0.7, 0.4, 0.9]\nnormal = [0, 0, 1]\ndisplacement = "-0.02*load"\n'
        one = self.compare(line, (3,), solver=STORED)
        self.assertLess(float(rows(one, "history.csv")[-1]["reaction_z:edge"]), 0.0)

    def test_linear_constraints(self):
        """Over points of all ranks, of supports and of other constraints."""
        means = PLATE.replace(TOP, MEANS)
        one = self.compare(means, (4,), "output.stress=true", "lattice.spacing=0.1", solver=STORED)
        self.assertNotEqual(float(rows(one, "history.csv")[-1]["reaction_x:pull"]), 0.0)
        case = (ROOT / "cases/thermal/bimetal.toml").read_text()
        case = case.replace("0.04", "0.02").replace("spacing = 1e-4", "spacing = 5e-4")
        self.compare(case + '[[load]]\nset = "tip"\ntotal_force = [0, "0.1*load"]\n', (2,), solver=STORED)

    def test_constraints_of_triangles_and_states(self):
        pulled = '[[support]]\nset = "pulled"\ndisplacement = ["0.4*load", "0.1*load"]'
        rollers = SQUARE.replace(pulled, '[[roller]]\nset = "pulled"\nnormal = [3, 1]\ndisplacement = "0.1*load"')
        self.compare(rollers + PULL.replace("RULE", "y > 0.7 && x < 1"), (2,), solver=STORED)
        turned = STATES.replace('[[support]]\nset = "top"\ndisplacement = [0, "0.05*load"]', '[[rigid]]\nset = "top"\nrotation = ["0.05*load"]')
        self.compare(turned + PULL.replace("RULE", "x > 0.5 && y < 1.3"), (3,), "lattice.spacing=0.1", solver=STORED)

    def test_pieces_that_constraints_hold_together(self):
        """The upper part has no bond to the lower one, and is on other ranks."""
        pieces = PLATE.replace("spacing = 0.05", "spacing = 0.1").replace('{ subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }',
                                                                          '{ subtract = "box", min = [-1, 0.5], max = [2, 0.8] }')  # fmt: skip
        pieces = pieces.replace('[[support]]\nset = "top"\ndisplacement = [0, "0.05*load"]', "")
        both = '[[set]]\nname = "both"\nwhere = "y > 0.3 && y < 1"\n[[rigid]]\nset = "both"\nrotation = ["0.02*load"]\n'
        self.compare(pieces + both, (3,), solver=STORED)
        self.compare(pieces + BETWEEN, (2,), solver=STORED)

    def test_constraints_go_on_with_another_number_of_ranks(self):
        text = SLOPED.replace("steps = 2", "steps = 3") + MEANS + STORED
        one = self.run_on(1, text)
        for first, then in ((1, 3), (3, 2)):
            with self.subTest(first=first, then=then):
                output = self.run_on(first, text, words=("--stop-after", 1), code=130)
                self.resume_on(then, output)
                self.expect_same(one, output)

    def test_rigid_pieces_with_constraints(self):
        """Pieces are those of the whole body. Jumps over periods and rigid sets, which all ranks share, have their own
        block."""
        turning = PLATE.replace("y > 1", "y > 1 && y < 1.4") + '[[rigid]]\nset = "corner"\nrotation = ["0.02*load"]\n'
        thin = PLATE.replace("max = [1, 1.5]", "max = [0.1, 0.5]").replace("x > 0.6 && y > 1", "y > 0.3")
        thin = thin.replace(', { subtract = "disk", centre = [0.5, 0.7], radius = 0.2 }', "")
        for text, ranks, planes, share in (  # share of the iterations of block Jacobi, which has few in a small body
            (PLATE, (3,), 'symmetry=[{axis="x", at=1}]', 0.5),
            (thin, (8,), 'symmetry=[{axis="x", at=0}, {axis="x", at=0.1}]', 1.5),
            (CELL, (4,), "title='cell'", 0.7),
            (turning, (2,), 'symmetry=[{axis="x", at=0}]', 0.5),
        ):
            with self.subTest(planes=planes):
                found = linear_iterations(self.compare(text, ranks, planes, solver=PIECES))
                self.assertLess(found, share * linear_iterations(self.run_on(1, text + STORED, planes)))

    def test_preconditioners_with_constraints(self):
        half = 'symmetry=[{axis="x", at=1}]'
        one = self.run_on(1, PLATE + STORED, half)
        for kind in ("surrogate", "multigrid"):
            with self.subTest(kind=kind):
                taken = f'solver.preconditioner="{kind}"'
                self.expect_same(one, self.run_on(3, PLATE + STORED, half, taken))
                refused = self.refusal(CELL + STORED, taken)
                self.assertIn('take "rigid_pieces", "block_jacobi" or "jacobi" with periods and rigid sets', refused.replace("\n", " "))
        self.run_on(2, CELL)
        self.assertIn("rigid pieces", self.ended.output)

    def test_temperatures(self):
        case = (ROOT / "cases/thermal/bimetal.toml").read_text()
        held = '[[support]]\nset = "steel"\ndisplacement = [0, "free"]\n[[support]]\nset = "middle"\ndisplacement = ["free", 0]\n[[support]]\nset = "tip"\ndisplacement = [0, "free"]\n'
        case = case.split("[[symmetry]]")[0] + held + "[[probe]]" + case.split("[[probe]]")[1]
        case = case.replace("0.04", "0.02").replace("spacing = 1e-4", "spacing = 5e-4")
        one = self.compare(case, (2,), "loading.table=[0, 1, 0.5]")
        self.assertGreater(float(rows(one, "history.csv")[1]["max_stretch"]), 1e-4)
        self.compare_settings(PLATE, 'eigenstrain=[{set="corner", strain="0.01*load*x"}]')


if __name__ == "__main__":
    unittest.main()
