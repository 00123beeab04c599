"""Planes of symmetry, periodic cells, rigid sets, rollers and linear constraints."""

import itertools
import math

import h5py
import numpy

from benchmarks import specimens
from tests.acceptance.programme_test import Programmes
from tests.reference.body import ball_volume, constant_factor, lattice_ball
from tests.reference.program import ROOT
from tests.reference.verify import verify

CASES = ROOT / "cases"
# Two numberings of one system agree to the round-off of its solution: the condition number of these small
# bodies, 1e3, times that of a double.
SAME_BODY = 1e-12

PLATE = """\
dimension = {dimension}
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
{thickness}
[[lattice.shape]]
add = "box"
min = {low}
max = {high}
{hole}
[[lattice.layer]]
name = "top"
side = "y+"
thickness = 2
{layers}
[material]
{material}
[quadrature]
surface_correction = "{correction}"
[[support]]
set = "top"
displacement = ["0", "{pull}*load"{third}]
{supports}
{planes}
[solver]
relative_tolerance = 1e-12
"""
BONDS = 'model = "bond"\nplane = "stress"\nyoungs_modulus = 200e9\n'
BRITTLE = BONDS + '[material.damage]\nlaw = "critical_stretch"\ncritical = 0.01\nno_fail = ["top"]\n'
STATE = 'model = "state"\nplane = "stress"\nyoungs_modulus = 200e9\npoisson_ratio = {}\n'
CPD_2D = 'model = "cpd"\nyoungs_modulus = 200e9\npoisson_ratio = 0.4\n'
CPD_3D = 'model = "cpd"\nyoungs_modulus = 200e9\npoisson_ratio = 0.3\n'


def plane(axis):
    return f'[[symmetry]]\naxis = "{axis}"\n'


def plate(part, material=BONDS, correction="none", pull="1e-5", hole="", dimension=2, more=""):
    """A body of 24 x 24 (x 4) points about the origin, or the part of it with positive x, y, z."""
    low = [0.0 if axis in part else -0.012 for axis in "xy"] + [0.0 if "z" in part else -0.002]
    high = [0.012, 0.012, 0.002]
    is_whole = "y" not in part
    bottom = '[[lattice.layer]]\nname = "bottom"\nside = "y-"\nthickness = 2\n' if is_whole else ""
    held = f'[[support]]\nset = "bottom"\ndisplacement = ["0", "-{pull}*load"{", 0" * (dimension == 3)}]\n' if is_whole else ""
    if "no_fail" in material and is_whole:
        material = material.replace('["top"]', '["top", "bottom"]')
    return PLATE.format(dimension=dimension, thickness="thickness = 1e-3" if dimension == 2 else "", low=low[:dimension],
                        high=high[:dimension], hole=hole, layers=bottom, material=material.replace('plane = "stress"\n', "" if dimension == 3 else 'plane = "stress"\n'),
                        correction=correction, pull=pull, third=", 0" if dimension == 3 else "", supports=held,
                        planes="".join(plane(axis) for axis in part)) + more  # fmt: skip


HOLE = '[[lattice.shape]]\nsubtract = "disk"\ncentre = [0.0, 0.0]\nradius = 4e-3\n'


class Constrained(Programmes):
    def fields(self, name):
        with h5py.File(self.folder / name / "results.h5") as file:
            step = file["steps"][sorted(file["steps"])[-1]]
            return file["points/reference"][...], {key: step[key][...] for key in ("displacement", "force", "energy_density", "damage")}

    def bonds(self, name, rows):
        """Positions of both ends, in half spacings, of the bonds in rows (first, second, image)."""
        with h5py.File(self.folder / name / "results.h5") as file:
            places = file["points/reference"][...]
            kinds = [file[f"points/images/{part}"][...] for part in ("mirror", "shift")] if "images" in file["points"] else [[], []]
        found = []
        for first, second, image in rows:
            end = places[second] if image == 0 else kinds[0][image - 1] * places[second] + kinds[1][image - 1]
            found.append(tuple(sorted(tuple(numpy.rint(place * 2e3).astype(int).tolist()) for place in (places[first], end))))
        return found

    def broken(self, name):
        rows = (self.folder / name / "broken_bonds.csv").read_text().splitlines()[1:]
        return self.bonds(name, [map(int, row.split(",")[2:5]) for row in rows])

    def damaged(self, name):
        """Largest stretch of every bond with a written one."""
        stretches = {}
        with h5py.File(self.folder / name / "results.h5") as file:
            for step in file["steps"].values():
                told = step["history"]
                images = told["second_image"] if "second_image" in told else numpy.zeros(len(told["first_point"]), int)
                bonds = self.bonds(name, zip(told["first_point"], told["second_point"], images))
                stretches |= dict(zip(bonds, told["largest_stretch"][...].tolist()))
        return stretches

    def assert_part_of(self, whole, part, same=SAME_BODY):
        of_place = {tuple(numpy.rint(place * 2e3).astype(int)): i for i, place in enumerate(whole[0])}
        twins = [of_place[tuple(numpy.rint(place * 2e3).astype(int))] for place in part[0]]
        for name, field in part[1].items():
            size = max(numpy.abs(whole[1][name]).max(), 1e-300)
            self.assertLess(numpy.abs(field - whole[1][name][twins]).max() / size, same, name)


class Symmetry(Constrained):
    def compare(self, parts, steps=1, settings=(), same=SAME_BODY, **body):
        whole = self.rows(plate("", **body), f"loading.steps={steps}", *settings, name="whole")
        for part in parts:
            with self.subTest(part, **{key: value for key, value in body.items() if key != "material"}):
                history = self.rows(plate(part, **body), f"loading.steps={steps}", *settings, name=f"part_{part}")
                self.assert_part_of(self.fields("whole"), self.fields(f"part_{part}"), same)
                share = 0.5 ** len(part)
                for energy in ("stored_energy", "external_work", "dissipated_energy"):
                    self.assertAlmostEqual(history[-1][energy] / share, whole[-1][energy], delta=1e-11 * whole[-1]["external_work"])
                # The force from beyond the plane balances the supports.
                if "y" in part:
                    self.assertAlmostEqual(history[-1]["reaction_y:symmetry_y"] / history[-1]["reaction_y:top"], -1, delta=1e-9)

    def test_parts_are_the_whole_plate(self):
        for correction in ("none", "volume", "energy"):
            self.compare(("x", "y", "xy"), correction=correction, hole=HOLE)
        # Bonds that reach half a cell beyond the horizon have images, too.
        for volume in ("linear", "exact", "exact_centroids"):
            self.compare(("x", "xy"), correction="energy", hole=HOLE, settings=(f"quadrature.volume_correction='{volume}'",))
        # The corners of boxes also have images.
        self.compare(("x", "xy"), correction="volume", hole=HOLE, settings=("quadrature.horizon_shape='box'",))

    def test_parts_of_cpd_bodies_are_the_whole(self):
        self.compare(("x", "xy"), material=CPD_2D, hole=HOLE)
        self.compare(("xy", "xyz"), material=CPD_3D, dimension=3)

    def test_parts_of_state_based_solids_are_the_whole(self):
        for ratio in (0.1, 0.45):
            # Tangents of states are solved by iterations, to the tolerance of the residual.
            same = dict(material=STATE.format(ratio), same=10 * SAME_BODY)
            self.compare(("x", "y", "xy"), hole=HOLE, **same)
            self.compare(("x", "xy"), correction="energy", hole=HOLE, settings=("quadrature.volume_correction='linear'",), **same)
            self.compare(("xy", "xyz"), dimension=3, **same)
        # Also at large strains, with the stored tangent.
        self.compare(("xy",), material=STATE.format(0.45), pull="1e-3", hole=HOLE, settings=("solver.linear='cholesky'",))

    def test_a_crack_runs_as_in_the_whole_plate(self):
        self.compare_cracks(BRITTLE, "2e-4", 50)

    def test_a_crack_of_states_runs_as_in_the_whole_plate(self):
        damage = '[material.damage]\nlaw = "{}"\ncritical = 0.01\nno_fail = ["top"]\n'
        # At larger pulls a crack of bonds that soften runs through, where round-off breaks the whole plate's symmetries.
        for ratio, pull in ((0.1, "3.9e-5"), (0.45, "3.3e-5")):
            self.compare_cracks(STATE.format(ratio) + damage.format("critical_stretch"), "2e-4", 50)
            self.compare_cracks(STATE.format(ratio) + damage.format("linear") + "onset = 0.005\n", pull, 8)

    def test_a_crack_of_cpd_by_release_runs_as_in_the_whole_plate(self):
        damage = '[material.damage]\ndrive = "release"\nlaw = "{}"\ncritical = 0.01\nno_fail = ["top"]\n'
        for ratio in (0.1, 0.45):
            material = f'model = "cpd"\nyoungs_modulus = 200e9\npoisson_ratio = {ratio}\n'
            self.compare_cracks(material + damage.format("critical_stretch"), "2e-4", 50)
            if ratio == 0.1:
                self.compare_cracks(material + damage.format("linear") + "onset = 0.005\n", "4e-5", 8)

    def test_a_path_of_cpd_through_the_plane_is_that_of_the_whole_plate(self):
        """From notches at both sides, so that triangles with sides between images fail; also by stretch."""
        damage = '[material.damage]\ndrive = "{}"\nlaw = "critical_stretch"\ncritical = 0.01\nno_fail = ["top"]\n'
        for drive, ratio in (("release", 0.1), ("release", 0.45), ("stretch", 0.4)):
            material = f'model = "cpd"\nyoungs_modulus = 200e9\npoisson_ratio = {ratio}\n' + damage.format(drive)
            self.compare_cracks(material, "1e-4", 20, mode="path", notches=((-0.013, -0.004), (0.004, 0.013)))

    def compare_cracks(self, material, pull, least, mode="adaptive", notches=((-0.004, 0.004),)):
        crack = "[[crack]]\nfrom = [{}, 0.0]\nto = [{}, 0.0]\n"
        text = dict(material=material, pull=pull)
        settings = ("loading.steps=4", f"solver.mode='{mode}'", "solver.relative_tolerance=1e-10")
        notch = "".join(crack.format(*ends) for ends in notches)
        whole = self.rows(plate("", **text, more=notch), *settings, name="whole")
        part = self.rows(plate("x", **text, more=notch), *settings, name="part")
        self.assertGreater(whole[-1]["broken_bonds"], least)
        part_bonds = self.broken("part")
        self.assertEqual(len(part_bonds), part[-1]["broken_bonds"])
        self.assertEqual(len(set(part_bonds)), len(part_bonds))
        twins = [tuple(sorted((-x, y) for x, y in ends)) for ends in part_bonds]
        self.assertEqual(sorted(self.broken("whole")), sorted({*part_bonds, *twins}))
        whole_stretch = self.damaged("whole")
        for bond, stretch in self.damaged("part").items():
            self.assertAlmostEqual(stretch, whole_stretch[bond], delta=1e-9)
        self.assertAlmostEqual(part[-1]["reaction_y:top"], 0.5 * whole[-1]["reaction_y:top"], delta=1e-6 * max(abs(row["reaction_y:top"]) for row in whole))

    def test_two_planes_across_one_axis_are_half_a_period(self):
        """A strip between two planes, also one thinner than the horizon, compared with the cell that both repeat."""
        for material, width in itertools.product((BONDS, CPD_2D), (0.006, 0.002)):
            with self.subTest(material=material, width=width):
                strip = plate("x", material=material).replace("max = [0.012", f"max = [{width}")
                strip = self.rows(strip + f'[[symmetry]]\naxis = "x"\nat = {width}\n', name="strip")[-1]
                cell = plate("", material=material).replace("min = [-0.012", f"min = [{-width}").replace("max = [0.012", f"max = [{width}")
                cell += f'[[period]]\naxis = "x"\nfrom = {-width}\nto = {width}\n'
                cell = self.rows(cell, name="cell")[-1]
                force = cell["reaction_x:period_x"]
                self.assertGreater(force, 0.1 * cell["reaction_y:top"] * 0.02 / width)
                self.assertAlmostEqual(strip["reaction_x:symmetry_x+"] / force, 1, delta=1e-9)
                self.assertAlmostEqual(strip["reaction_x:symmetry_x-"] / force, -1, delta=1e-9)
                self.assertAlmostEqual(2 * strip["stored_energy"] / cell["stored_energy"], 1, delta=1e-11)

    def test_what_a_part_is_not_is_refused(self):
        inner = '[[set]]\nname = "inner"\nwhere = "x < 1e-3 && abs(y) < 0.0119"\n[[load]]\nset = "inner"\ntraction = ["1e6*load", 0]\n'
        deep = '[[load]]\nside = "x+"\ntraction = ["1e6*load", 0]\ndepth = "horizon"\n'
        for text, code in ((plate("x") + deep, 0), (plate("x").replace("max = [0.012", "max = [0.003") + deep, 2)):
            self.assert_code(self.command("check", text), code)
        side = '[[load]]\nside = "x-"\ntraction = ["1e6*load", 0]\n'
        pin = '[[set]]\nname = "pin"\nwhere = "x^2 + y^2 < 0.003^2"\n[[rigid]]\nset = "pin"\n'
        for more, words in ((inner, "the outermost one on"), (side, "continues beyond"), (pin, "along x must be 0"),
                            (pin + 'displacement = [0, "free"]\n', "rotation")):  # fmt: skip
            with self.subTest(more):
                self.assert_refused(self.command("check", plate("x") + more), words)

    def test_a_rigid_set_that_a_plane_cuts_is_that_of_the_whole(self):
        pin = '[[set]]\nname = "pin"\nwhere = "x^2 + y^2 < 0.003^2"\n[[rigid]]\nset = "pin"\ndisplacement = [0, "free"]\nrotation = [0]\n'
        self.run_case(plate("", more=pin), name="whole")
        self.run_case(plate("x", more=pin), name="part")
        self.assert_part_of(self.fields("whole"), self.fields("part"))

    def test_planes_that_are_none_are_refused(self):
        for text, words in ((plate("x") + plane("x"), "already"),
                            (plate("x").replace('axis = "x"', 'axis = "x"\nat = 5e-4'), "passes through points"),
                            (plate("x").replace('axis = "x"', 'axis = "x"\nat = 3e-3'), "both sides"),
                            (plate("x").replace('axis = "x"', 'axis = "z"'), "axis")):  # fmt: skip
            self.assert_refused(self.command("check", text), words)

    def test_what_a_plane_leaves_free_is_refused(self):
        text = plate("x").replace('displacement = ["0", "1e-5*load"]', 'displacement = ["0", "free"]')
        text = text.replace('displacement = ["0", "-1e-5*load"]', 'displacement = ["0", "free"]')
        self.assert_refused(self.command("check", text), "move along y")


CELL = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [0.008, 0.006]
[material]
{material}
[[period]]
axis = "x"
from = 0.0
to = 0.008
gradient = {x}
[[period]]
axis = "y"
from = 0.0
to = 0.006
gradient = {y}
[solver]
relative_tolerance = 1e-13
"""


def lattice_stress(gradient, youngs_modulus=200e9, spacing=1e-3, ratio=3.015):
    """First Piola-Kirchhoff stress of the bonds of a lattice at a displacement gradient."""
    bonds = lattice_ball(2, ratio) * spacing
    lengths = numpy.linalg.norm(bonds, axis=1)
    moved = bonds @ (numpy.eye(2) + numpy.array(gradient)).T
    now = numpy.linalg.norm(moved, axis=1)
    modulus = constant_factor(2, "stress", ratio * spacing, spacing) * youngs_modulus
    forces = (modulus * (now / lengths - 1) * spacing**3 / now)[:, None] * moved
    return 0.5 * forces.T @ bonds


class Periodic(Constrained):
    def torn(self, crack, material, strain):
        """A cell of 24 x 12 points, longer than 20, in which a crack begins to run."""
        softening = 'law = "tanh_continuous"\nonset = 0.003\ncritical = 0.008\n'
        softening += 'drive = "release"\n' if "cpd" in material else ""
        text = CELL.format(material=material + "[material.damage]\n" + softening, x=[0, 0], y=[0, f"{strain}*load"])
        text = text.replace("0.008, 0.006]", "0.024, 0.012]").replace("to = 0.008", "to = 0.024").replace("to = 0.006", "to = 0.012")
        text += f"[[crack]]\nfrom = [-0.004, {crack}]\nto = [0.004, {crack}]\n"
        text += '[[set]]\nname = "all"\nwhere = "1"\n[[probe]]\nname = "crack"\nset = "all"\nfield = "crack_length"\n'
        return self.rows(text, "loading.steps=6", name=f"y{crack}")

    def test_a_crack_on_the_side_of_a_cell_is_that_within_it(self):
        """The choice of the cell within the same lattice changes nothing, to the round-off of softening bonds."""
        for material, strain in ((BONDS, 3e-3), (STATE.format(0.1), 3.4e-3), (STATE.format(0.45), 2.7e-3), (CPD_2D, 2.9e-3)):
            with self.subTest(material):
                self.compare_cells(material, strain)

    def compare_cells(self, material, strain):
        within, on_side = self.torn(0.003, material, strain), self.torn(0.0, material, strain)
        self.assertGreater(within[-1]["broken_bonds"], 5)
        for column in ("stored_energy", "dissipated_energy", "reaction_y:period_y", "max_damage"):
            self.assertAlmostEqual(within[-1][column] / on_side[-1][column], 1, delta=1e-8)
        self.assertEqual([round(row["crack"], 12) for row in within], [round(row["crack"], 12) for row in on_side])
        self.assertAlmostEqual(within[0]["crack"], 8e-3, delta=1e-12)
        self.assertGreater(within[-1]["crack"], 9e-3)

        def of_crack(name, crack):
            """Bonds by their midpoints over a whole period, and their directions; in half spacings."""
            found = []
            for (x, y), (other_x, other_y) in self.broken(name):
                lies = max((other_x - x, other_y - y), (x - other_x, y - other_y))
                found.append(((x + other_x) % 96, (y + other_y - round(4000 * crack)) % 48, *lies))
            return found

        inside, on_side = of_crack("y0.003", 0.003), of_crack("y0.0", 0.0)
        self.assertEqual(sorted(inside), sorted(set(on_side)))
        # Bonds across the side appear at both of its ends.
        across = sum(min(y, 48 - y) < abs(high) for _, y, _, high in inside)
        self.assertEqual(len(on_side), len(inside) + across)

    def test_a_cell_has_the_stress_of_its_lattice(self):
        for gradient in ([[1e-4, 0], [0, 0]], [[0.02, 0.01], [-0.03, 0.05]]):
            text = CELL.format(material=BONDS, x=[gradient[0][0], gradient[1][0]], y=[gradient[0][1], gradient[1][1]])
            for thickness in (0.006, 0.002):  # also thinner than the horizon
                row = self.rows(text.replace("0.006", str(thickness)), name=f"{gradient[0][0]}_{thickness}")[-1]
                stress = lattice_stress(gradient)
                found = numpy.array([[row["reaction_x:period_x"] / (thickness * 1e-3), row["reaction_x:period_y"] / (0.008 * 1e-3)],
                                     [row["reaction_y:period_x"] / (thickness * 1e-3), row["reaction_y:period_y"] / (0.008 * 1e-3)]])  # fmt: skip
                self.assertLess(numpy.abs(found / stress.max() - stress / stress.max()).max(), 1e-12)

    def test_a_thin_cell_of_states_is_a_thick_one(self):
        """Where a cell is thinner than the horizon, points have bonds with their own images."""
        found = []
        for thickness in (0.006, 0.002):
            text = CELL.format(material=STATE.format(0.45), x=[0.02, -0.03], y=[0.01, "free"])
            row = self.rows(text.replace("0.006", str(thickness)), name=f"{thickness}")[-1]
            found.append([row["reaction_x:period_x"] / thickness, row["reaction_y:period_x"] / thickness, row["stored_energy"] / thickness, row["gradient_y:period_y"]])
        numpy.testing.assert_allclose(*found, rtol=1e-11)

    def test_a_free_side_has_no_stress(self):
        strain = 1e-3
        row = self.rows(CELL.format(material=BONDS, x=[strain, 0], y=[0, "free"]))[-1]
        self.assertLess(abs(row["reaction_y:period_y"]), 1e-11 * row["reaction_x:period_x"])
        self.assertAlmostEqual(row["gradient_x:period_x"] / strain, 1, delta=1e-14)
        low, high = -strain, 0.0
        for _ in range(60):  # the contraction at which the lattice has no transverse stress
            middle = 0.5 * (low + high)
            low, high = (middle, high) if lattice_stress([[strain, 0], [0, middle]])[1, 1] < 0 else (low, middle)
        stress = lattice_stress([[strain, 0], [0, high]])[0, 0]
        self.assertAlmostEqual(row["reaction_x:period_x"] / (0.006 * 1e-3) / stress, 1, delta=1e-11)
        self.assertAlmostEqual(row["gradient_y:period_y"] / high, 1, delta=1e-9)

    def test_a_cell_of_cpd_has_the_energy_of_its_lattice(self):
        gradient = numpy.array([[0.02, 0.01], [-0.03, 0.05]])
        text = CELL.format(material='model = "cpd"\nc1 = 1e20\nc2 = 3e30\n', x=[*gradient[:, 0]], y=[*gradient[:, 1]])
        stored = self.rows(text)[-1]["stored_energy"]
        ball = lattice_ball(2, 3.015) * 1e-3
        lengths = numpy.linalg.norm(ball, axis=1)
        now = ball @ (numpy.eye(2) + gradient).T
        volume, around = 1e-9, ball_volume(2, 3.015e-3, 1e-3)
        bonds = 0.5 * (volume * around / len(ball) * 0.5e20 * lengths * (numpy.linalg.norm(now, axis=1) / lengths - 1) ** 2).sum()
        first, second = numpy.triu_indices(len(ball), 1)
        near = numpy.linalg.norm(ball[first] - ball[second], axis=1) <= 3.015e-3 * (1 + 1e-8)
        area = numpy.cross(ball[first], ball[second])
        keep = near & (numpy.abs(area) > 1e-9)  # in m2; collinear points span nothing
        area, first, second = area[keep], first[keep], second[keep]
        ratio = numpy.cross(now[first], now[second]) / area
        pair = around**2 / (2 * len(area))
        triangles = (2 * volume * pair * 0.5 * 3e30 * numpy.abs(area) * (ratio - 1) ** 2).sum() / 3
        self.assertAlmostEqual(stored / (48 * (bonds + triangles)), 1, delta=1e-12)

    def test_what_a_cell_is_not_is_refused(self):
        heavy = BONDS + "density = 1000.0\n"
        gravity = '[[load]]\ngravity = ["0", "-9.81*load"]\n'
        sheared = CELL[: CELL.index('[[period]]\naxis = "y"')] + '[[symmetry]]\naxis = "y"\n'
        for text, words in ((CELL.format(material=heavy, x=[0, 0], y=[0, 0]) + gravity, "along y"),
                            (sheared.format(material=BONDS, x=["0", "1e-3*load"]), "allows no jump"),
                            (sheared.format(material=BONDS, x=["0", "free"]), "allows no jump")):  # fmt: skip
            with self.subTest(text):
                self.assert_refused(self.command("check", text), words)

    def test_a_cell_that_is_held_along_one_axis_floats_along_the_other(self):
        free = CELL.format(material=BONDS, x=[1e-3, 0], y=[0, 0])
        held = '[[set]]\nname = "middle"\nwhere = "abs(y - 0.003) < 6e-4 && abs(x - 0.004) < 6e-4"\n[[support]]\nset = "middle"\ndisplacement = ["free", 0]\n'
        expected, row = self.rows(free, name="free")[-1], self.rows(free + held)[-1]
        for force in ("reaction_x:period_x", "reaction_y:period_y"):
            self.assertAlmostEqual(row[force] / expected["reaction_x:period_x"], expected[force] / expected["reaction_x:period_x"], delta=1e-11)

    def test_loads_that_get_out_of_balance_end_the_run(self):
        sets = '[[set]]\nname = "low"\nwhere = "y < 0.003"\n[[set]]\nname = "high"\nwhere = "y > 0.003"\n'
        loads = '[[load]]\nset = "low"\ntotal_force = [0, "-load"]\n[[load]]\nset = "high"\ntotal_force = [0, "{}"]\n'
        text = CELL.format(material=BONDS, x=[0, 0], y=[0, 0]) + sets
        balanced = self.rows(text + loads.format("load"), "loading.steps=4", name="balanced")
        self.assertGreater(balanced[-1]["stored_energy"], 0)
        kink = "load + 16*load*(load - 0.5)*(load - 1)*(load > 0.2 ? 0 : 1)"  # 0 at the ends and in the middle
        self.run_case(text + loads.format(kink), "loading.steps=10", name="kinked", code=3)
        self.assertIn("add up to", (self.folder / "kinked/decisions.csv").read_text())

    def test_cells_may_have_many_points(self):
        """A gap of one spacing between a cell and the next is a small relative error for a large cell."""
        text = CELL.format(material=BONDS, x=["1e-3*load", "0"], y=["0", "0"]).replace("0.008", "0.06")
        row = self.rows(text)[-1]
        stress = lattice_stress([[1e-3, 0], [0, 0]])
        self.assertAlmostEqual(row["reaction_x:period_x"] / (0.006 * 1e-3) / stress[0, 0], 1, delta=1e-12)

    def test_points_at_both_sides_are_refused(self):
        text = CELL.format(material=BONDS, x=[0, 0], y=[0, 0]).replace("to = 0.008", "to = 0.0075")
        self.assert_refused(self.command("check", text), "does not continue")

    def test_a_cell_that_may_turn_is_refused(self):
        text = CELL.format(material=BONDS, x=["1e-3*load", "free"], y=["free", 0])
        self.assert_refused(self.command("check", text), "rotate")


BODY = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [-0.015, -0.01]
max = [0.015, 0.01]
[[set]]
name = "pin"
where = "(x+0.005)^2+y^2 < 0.003^2"
[[set]]
name = "right"
where = "x > 0.014"
[[set]]
name = "left"
where = "x < -0.014"
[material]
model = "bond"
plane = "stress"
youngs_modulus = 200e9
[solver]
relative_tolerance = 1e-11
"""
PIN = '[[rigid]]\nset = "pin"\ncentre = [-5e-3, 0.0]\ndisplacement = ["0", "0"]\n'
LIFTED = '[[support]]\nset = "right"\ndisplacement = ["free", "1e-3*load"]\n'
ROLLER = '[[roller]]\nname = "foot"\nat = [1e-3, -0.01]\nnormal = [0, 1]\n'


class Rigid(Constrained):
    def balance(self, row, *holders):
        for axis in "xy":
            forces = [row[f"reaction_{axis}:{holder}"] for holder in holders]
            self.assertLess(abs(sum(forces)), 1e-8 * max(abs(row["reaction_y:right"]), 1))

    def test_a_pin_turns_and_carries_no_moment(self):
        row = self.rows(BODY + PIN + LIFTED + ROLLER)[-1]
        self.assertGreater(abs(row["rotation_z:pin"]), 0.02)
        self.assertLess(abs(row["moment_z:pin"]), 1e-9 * abs(row["reaction_y:pin"]) * 3e-3)
        self.balance(row, "pin", "right", "foot")
        moments = -5e-3 * row["reaction_y:pin"]  # of the roller and the layer as well, about the origin
        self.assertTrue(math.isfinite(moments))

    def test_a_clamped_set_is_a_support(self):
        """A rigid set without rotation is equivalent to a layer with prescribed displacements."""
        rigid = self.rows(BODY + PIN.replace('"pin"', '"left"').replace('["0", "0"]', '[0, "1e-5*load"]\nrotation = [0]') + LIFTED, name="rigid")[-1]
        held = self.rows(BODY + '[[support]]\nset = "left"\ndisplacement = ["0", "1e-5*load"]\n' + LIFTED, name="held")[-1]
        for column in ("reaction_x:left", "reaction_y:left", "stored_energy", "external_work"):
            self.assertAlmostEqual(rigid[column], held[column], delta=1e-9 * abs(held["reaction_y:left"]))

    def test_check_tells_what_is_prescribed_and_what_follows(self):
        def line(text):
            ended = self.assert_completed(self.command("check", text))
            return next(line for line in ended.output.splitlines() if line.startswith("supports"))

        # 600 points: the pin has 32 and each end a column of 20; images have no degrees of freedom of their own.
        pin, ends = 2 * 32, 2 * 20
        self.assertEqual(line(BODY + '[[support]]\nset = "left"\ndisplacement = [0, 0]\n'),
                         f"supports    {ends} prescribed and {1200 - ends} free degrees of freedom")  # fmt: skip
        self.assertEqual(line(BODY + PIN + LIFTED + ROLLER),
                         f"supports    {ends // 2} prescribed, {pin + 1} that follow constraints, and "
                         f"{1200 - ends // 2 - pin - 1} free degrees of freedom; free ones added by constraints: 1")  # fmt: skip
        self.assertEqual(line(CELL.format(material=BONDS, x=["1e-3*load", 0], y=[0, "free"])),
                         "supports    2 prescribed and 94 free degrees of freedom; free ones added by constraints: 1")  # fmt: skip
        self.assertEqual(line(plate("xy")), "supports    48 prescribed and 288 free degrees of freedom")

    def test_a_rotation_is_a_rigid_motion(self):
        """Two rigid sets that rotate by the same finite angle about one centre rotate the body with them."""
        turned = "".join(f'[[rigid]]\nset = "{name}"\ncentre = [0.0, 0.0]\ndisplacement = [0, 0]\nrotation = ["2.5*load"]\n'
                         for name in ("left", "right"))  # fmt: skip
        rows = self.rows(BODY + turned, "loading.steps=25", "solver.relative_tolerance=1e-10")
        stiffness = 200e9 * 1e-3  # for a strain of one
        self.assertLess(abs(rows[-1]["stored_energy"]), 1e-12 * stiffness * 0.02**2)
        place, fields = self.fields("out")
        turn = numpy.array([[math.cos(2.5), -math.sin(2.5)], [math.sin(2.5), math.cos(2.5)]])
        self.assertLess(numpy.abs(place + fields["displacement"] - place @ turn.T).max(), 1e-12)

    def test_newton_is_quadratic(self):
        self.run_case(BODY + PIN + LIFTED + ROLLER, "solver.linear_tolerance=1e-12")
        rows = [line.split(",") for line in (self.folder / "out/iterations.csv").read_text().splitlines()[1:]]
        residuals = [float(row[3]) for row in rows if float(row[3]) > 1e-11]
        self.assertLess(residuals[-1], 30 * residuals[-2] ** 2)

    def test_all_linear_solvers_find_the_same(self):
        expected = self.rows(BODY + PIN + LIFTED + ROLLER, name="direct")[-1]
        for solver in ("pcg/rigid_pieces", "pcg/jacobi", "pcg/block_jacobi", "pcg/surrogate", "pcg/riluk", "pcg/chebyshev", "pcg/multigrid"):
            with self.subTest(solver):
                method, preconditioner = solver.split("/")
                row = self.rows(BODY + PIN + LIFTED + ROLLER, f"solver.linear='{method}'", f"solver.preconditioner='{preconditioner}'", name=preconditioner)[-1]
                self.assertAlmostEqual(row["reaction_y:pin"] / expected["reaction_y:pin"], 1, delta=1e-8)

    def test_the_surrogate_bears_linear_constraints(self):
        """Dependent degrees of freedom have no rows, so the springs of their neighbours alone do not hold them."""
        text = """\
dimension = 2
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
shape = [{ add = "box", min = [0, 0], max = [12e-3, 7e-3] }]
layer = [{ name = "left", side = "x-" }, { name = "right", side = "x+" }]
[material]
youngs_modulus = 1e9
[[support]]
set = "left"
displacement = [0, 0]
[[constraint]]
name = "tie"
displacement = "1e-5*load"
[[constraint.term]]
set = "right"
weights = [1, 0]
"""
        expected = self.rows(text, name="direct")[-1]
        row = self.rows(text, "solver.linear='pcg'", "solver.preconditioner='surrogate'")[-1]
        self.assertEqual(len(self.history()), 1)
        self.assertAlmostEqual(row["stored_energy"] / expected["stored_energy"], 1, delta=1e-8)

    def test_relaxation_finds_the_same(self):
        gentle = LIFTED.replace("1e-3", "1e-5")
        expected = self.rows(BODY + PIN + gentle + ROLLER, name="newton")[-1]
        row = self.rows(BODY + PIN + gentle + ROLLER, "solver.mode='relaxation'", "solver.relative_tolerance=1e-8", "relaxation.max_iterations=100000", name="relaxed")[-1]
        for column in ("reaction_y:pin", "reaction_y:foot", "stored_energy", "external_work"):
            self.assertAlmostEqual(row[column] / expected[column], 1, delta=1e-5, msg=column)

    def test_tangents_are_those_of_the_energy(self):
        periods = CELL.format(material=BONDS, x=["1e-3*load", 0], y=[0, "free"])
        slope = '[[roller]]\nset = "left"\nnormal = [1, 2]\n'
        shared = '[[roller]]\nset = "right"\nnormal = [2, -1]\ndisplacement = "free"\n'
        tied = ('[[constraint]]\nname = "tie"\ndisplacement = "1e-4*load"\n[[constraint.term]]\nset = "left"\nweights = [1, 0.5]\n'
                '[[constraint.term]]\nset = "right"\nweights = [-1, 2]\n')  # fmt: skip
        bodies = {"pin": BODY + PIN + LIFTED + ROLLER, "slope": BODY + PIN + slope, "shared": BODY + PIN + shared, "tied": BODY + PIN + tied,
                  "part": plate("xy"), "cpd": plate("xy", material=CPD_2D), "solid": plate("xyz", material=CPD_3D, dimension=3), "cell": periods}  # fmt: skip
        for name, text in bodies.items():
            with self.subTest(name):
                found = self.assert_completed(self.command("check-tangent", text)).json()
                self.assertLess(found["tangent_error"], 1e-8)
                self.assertLess(found["residual_error"], 1e-7)
                self.assertLess(found["asymmetry"], 1e-8)

    def test_an_inclined_roller_carries_no_force_along_its_slope(self):
        """The whole case rotated by an angle: a constraint along an axis then acts along the slope."""
        held = BODY + '[[support]]\nset = "left"\ndisplacement = ["0", "0"]\n' + '[[roller]]\nset = "right"\nnormal = [{}, {}]\ndisplacement = "1e-5*load"\n'
        row = self.rows(held.format(1, 0), name="along")[-1]
        support = self.rows(BODY + '[[support]]\nset = "left"\ndisplacement = ["0", "0"]\n[[support]]\nset = "right"\ndisplacement = ["1e-5*load", "free"]\n', name="support")[-1]
        self.assertAlmostEqual(row["reaction_x:right"] / support["reaction_x:right"], 1, delta=1e-10)
        inclined = self.rows(held.format(3, 4), name="inclined")[-1]
        force = numpy.array([inclined["reaction_x:right"], inclined["reaction_y:right"]])
        self.assertLess(abs(force @ [-4, 3]), 1e-12 * numpy.abs(force).max())

    def test_contradictions_are_named(self):
        support = '[[support]]\nset = "pin"\ndisplacement = [0, 0]\n'
        one = BODY.replace("(x+0.005)^2+y^2 < 0.003^2", "(x+0.0045)^2+(y-0.0005)^2 < 1e-8") + PIN + LIFTED
        tie = '[[constraint]]\nname = "tie"\n[[constraint.term]]\nset = "right"\nweights = [{}]\n'
        for text, words in ((BODY + PIN + support, "contradict each other"),
                            (BODY + PIN + PIN + LIFTED, "contradict each other"),
                            (BODY + PIN + LIFTED + '[[roller]]\nset = "right"\nnormal = [0, 1]\n', "contradict each other"),
                            (BODY + PIN + LIFTED + '[[roller]]\nset = "left"\nnormal = [0, 0]\n', "direction"),
                            (one, "at least two"),
                            (BODY + PIN + LIFTED + tie.format("0, 1"), "contains no free displacement"),
                            (BODY + PIN + tie.format("1, 0") + tie.format("2, 0").replace('"tie"', '"again"'), "repeat or contradict"),
                            (BODY + PIN + tie.format("1, 0") + tie.format("0, 1"), "of this name"),
                            (BODY + PIN + LIFTED + ROLLER.replace("-0.01", "-0.03"), "no points"),
                            (BODY + PIN, "rotate about z")):  # fmt: skip
            with self.subTest(words):
                self.assert_refused(self.command("check", text), words)


BAR = """\
dimension = 3
[lattice]
spacing = 1e-3
horizon_ratio = 2.5
[[lattice.shape]]
add = "box"
min = [0.0, 0.0, 0.0]
max = [0.014, 0.004, 0.004]
[[set]]
name = "left"
where = "x < 0.002"
[[set]]
name = "right"
where = "x > 0.012"
[material]
youngs_modulus = 2e11
"""
TWISTED = ('[[rigid]]\nset = "left"\ndisplacement = [0, 0, 0]\nrotation = [0, 0, 0]\n'
           '[[rigid]]\nset = "right"\ndisplacement = ["free", 0, 0]\nrotation = ["1.5*load", 0, "free"]\n[loading]\nsteps = 2\n')  # fmt: skip


def line(name, x, z, more=""):
    return f'[[roller]]\nname = "{name}"\nat = [{x}, 0.0, {z}]\nto = [{x}, 0.004, {z}]\nnormal = [0, 0, 1]\n{more}'


LINES = (line("a", 0.0025, 0.0) + line("b", 0.0115, 0.0) + line("c", 0.007, 0.004, 'displacement = "-1e-5*load"\n')
         + '[[roller]]\nname = "x"\nat = [0.007, 0.002, 0.004]\nnormal = [1, 0, 0]\n'
         + "".join(f'[[roller]]\nname = "{name}"\nat = [{x}, 0.002, 0.0]\nnormal = [0, 1, 0]\n' for name, x in (("y", 0.0025), ("yy", 0.0115))))  # fmt: skip


RING = """\
dimension = 2
[lattice]
spacing = 0.05
thickness = 0.1
shape = [
  {{ add = "disk", centre = [0, 0], radius = 1.0 }},
  {{ subtract = "disk", centre = [0, 0], radius = 0.5 }},
  {cut}
]
[[set]]
name = "all"
where = "1"
[[set]]
name = "rim"
where = "sqrt(x^2 + y^2) < 0.56"
[[set]]
name = "right"
where = "x > 0.8"
[material]
youngs_modulus = 1e9
[quadrature]
surface_correction = "energy"
volume_correction = "linear"
[[load]]
set = "rim"
pressure = "{pressure}*load"
[solver]
relative_tolerance = 1e-12
{held}
"""
LEFT = '{ subtract = "box", min = [-1.1, -1.1], max = [0, 1.1] },'
BELOW = '{ subtract = "box", min = [-1.1, -1.1], max = [1.1, 0] },'


def mean_is_zero(name, *terms):
    tables = "".join(f'[[constraint.term]]\nset = "{set}"\nweights = {weights}\n' for set, weights in terms)
    return f'[[constraint]]\nname = "{name}"\n' + tables


HELD_X, HELD_Y = (mean_is_zero(f"held_{axis}", ("all", weights)) for axis, weights in (("x", [1, 0]), ("y", [0, 1])))
HELD_ROUND = mean_is_zero("held_round", ("right", [0, 1]), ("all", [0, -1]))


class Pressed(Constrained):
    """Follower pressures on dependent degrees of freedom."""

    def assert_part_of(self, whole, part):
        of_place = {tuple(numpy.rint(place * 40).astype(int)): i for i, place in enumerate(whole[0])}
        twins = [of_place[tuple(numpy.rint(place * 40).astype(int))] for place in part[0]]
        for name, field in part[1].items():
            size = max(numpy.abs(whole[1][name]).max(), 1e-300)
            self.assertLess(numpy.abs(field - whole[1][name][twins]).max() / size, 1e-11, name)

    def test_parts_of_a_ring_are_the_whole(self):
        for pressure, steps in ((1e5, 1), (0.1e9, 4)):
            bodies = {"whole": RING.format(cut="", held=HELD_X + HELD_Y + HELD_ROUND, pressure=pressure),
                      "half": RING.format(cut=LEFT, held=plane("x") + HELD_Y, pressure=pressure),
                      "quarter": RING.format(cut=LEFT + BELOW, held=plane("x") + plane("y"), pressure=pressure)}  # fmt: skip
            rows = {name: self.rows(text, f"loading.steps={steps}", name=name)[-1] for name, text in bodies.items()}
            for name, share in (("half", 0.5), ("quarter", 0.25)):
                with self.subTest(name, pressure=pressure):
                    self.assert_part_of(self.fields("whole"), self.fields(name))
                    for energy in ("stored_energy", "external_work"):
                        self.assertAlmostEqual(rows[name][energy] / share / rows["whole"][energy], 1, delta=1e-10)
            # The pressure on the projection of the bore, which has widened, pulls half of the ring off.
            _, fields = self.fields("quarter")
            self.assertGreater(-rows["quarter"]["reaction_x:symmetry_x"], 0.5 * 0.1 * pressure)
            self.assertLess(-rows["quarter"]["reaction_x:symmetry_x"], (0.5 + numpy.abs(fields["displacement"]).max() + 0.05) * 0.1 * pressure)

    def test_what_check_tells_of_a_part_is_that_of_the_whole(self):
        """A closed bore: the stiffness is complete."""
        for cut, held in (("", HELD_X + HELD_Y + HELD_ROUND), (LEFT + BELOW, plane("x") + plane("y"))):
            ended = self.assert_completed(self.command("check", RING.format(cut=cut, held=held, pressure=1e5)))
            self.assertIn("closed or held", ended.said)

    def test_relaxation_finds_the_same(self):
        text = RING.format(cut=LEFT + BELOW, held=plane("x") + plane("y"), pressure=1e7)
        newton = self.rows(text, name="newton")[-1]
        relaxed = self.rows(text, "solver.mode=relaxation", "solver.relative_tolerance=1e-10", name="relaxed")[-1]
        for energy in ("stored_energy", "external_work"):
            self.assertAlmostEqual(relaxed[energy] / newton[energy], 1, delta=1e-4)

    def test_tangents_are_those_of_the_energy(self):
        for cut, held in ((LEFT + BELOW, plane("x") + plane("y")), (LEFT, plane("x") + HELD_Y)):
            told = self.command("check-tangent", RING.format(cut=cut, held=held, pressure=1e8)).json()
            self.assertLess(max(told["residual_error"], told["tangent_error"], told["asymmetry"]), 1e-6, told)

    def test_a_rigid_body_hands_on_the_pressure_as_it_turns(self):
        """A rigid block under pressure on one side: p A along the normal, which rotates with the block."""
        force = 1e10 * 0.01 * 1e-3
        with_it, without = (self.rows(BLOCK_UNDER_PRESSURE.replace("1e10*load", pressure), name=pressure[:4])[-1]
                            for pressure in ("1e10*load", "0*load"))  # fmt: skip
        added = {column: with_it[column] - without[column] for column in with_it if column.endswith(":block")}
        self.assertAlmostEqual(added["reaction_x:block"] / (force * math.cos(0.5)), 1, delta=1e-8)
        self.assertAlmostEqual(added["reaction_y:block"] / (force * math.sin(0.5)), 1, delta=1e-8)
        self.assertAlmostEqual(added["moment_z:block"] / (force * 0.01), 0, delta=1e-8)

    def test_a_strip_is_pressed_as_a_long_plate(self):
        """One period of a plate that rests on its lower side."""
        text = STRIP_UNDER_PRESSURE
        row = self.rows(text)[-1]
        self.assertAlmostEqual(row["reaction_y:bottom"] / (1e6 * 0.01 * 1e-3), 1, delta=1e-9)
        reference, fields = self.fields("out")
        rows = {round(y, 6): fields["displacement"][numpy.abs(reference[:, 1] - y) < 1e-6] for y in reference[:, 1]}
        for displacement in rows.values():  # nothing changes along the plate
            self.assertLess(numpy.ptp(displacement, axis=0).max(), 1e-12 * numpy.abs(fields["displacement"]).max())

    def test_a_cell_that_nothing_holds_needs_balanced_pressures(self):
        floating = STRIP_UNDER_PRESSURE.replace('[[support]]\nset = "bottom"\ndisplacement = [0, 0]\n', "")
        self.assert_refused(self.command("check", floating), "no equilibrium")
        self.run_case(floating + '[[load]]\nside = "y-"\npressure = "1e6*load"\n')

    def test_on_a_side_where_the_body_goes_on_it_is_refused(self):
        for side, told in (("x-", "beyond a plane"), ("x+", "")):
            text = plate("x", more=f'[[load]]\nside = "{side}"\npressure = "1e6*load"\n')
            ended = self.command("check", text)
            self.assert_code(ended, 2 if told else 0)
            self.assertIn(told, ended.said)



BLOCK_UNDER_PRESSURE = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.02, 0.01] }]
[[set]]
name = "block"
where = "x > 0.01"
[[set]]
name = "left"
where = "x < 2e-3"
[material]
youngs_modulus = 200e9
[[support]]
set = "left"
displacement = [0, 0]
[[rigid]]
set = "block"
displacement = ["-1e-3*load", "2e-3*load"]
rotation = ["0.5*load"]
[[load]]
side = "x+"
pressure = "1e10*load"
[loading]
steps = 4
"""
STRIP_UNDER_PRESSURE = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
shape = [{ add = "box", min = [0, 0], max = [0.01, 0.012] }]
[[set]]
name = "bottom"
where = "y < 2e-3"
[material]
youngs_modulus = 200e9
[[support]]
set = "bottom"
displacement = [0, 0]
[[period]]
axis = "x"
from = 0
to = 0.01
[[load]]
side = "y+"
pressure = "1e6*load"
[solver]
relative_tolerance = 1e-12
"""


class Judged(Constrained):
    """Checked by the reference, which uses no generalised degrees of freedom (tests/reference/ties.py)."""

    def test_runs_are_what_the_reference_says(self):
        heavy = '[[load]]\nset = "{}"\nbody_force = ["{}*load", "1e9*load"]\n'
        slope = '[[roller]]\nset = "left"\nnormal = [1, 2]\n' + heavy.format("right", 0)
        shared = '[[roller]]\nset = "right"\nnormal = [2, -1]\ndisplacement = "free"\n' + heavy.format("pin", 0) + heavy.format("right", "1e9")
        tied = ('[[constraint]]\nname = "tie"\ndisplacement = "1e-4*load"\n[[constraint.term]]\nset = "left"\nweights = [1, 0.5]\n'
                '[[constraint.term]]\nset = "right"\nweights = [-1, 2]\n' + heavy.format("left", "-1e9"))  # fmt: skip
        bodies = {"pin": BODY + PIN + LIFTED + ROLLER + "[loading]\nsteps = 3\n", "slope": BODY + PIN + slope, "shared": BODY + PIN + shared,
                  "tied": BODY + PIN + tied, "loaded pin": BODY + PIN + LIFTED + ROLLER + heavy.format("pin", "2e8"),
                  "twisted": BAR + TWISTED, "lines": BAR + LINES}  # fmt: skip
        for name, text in bodies.items():
            with self.subTest(name):
                self.run_case(text, name=name)
                complaints, worst = verify(self.folder / name, text)
                self.assertEqual(complaints, [])
                self.assertIn("ties", worst)


class Specimens(Constrained):
    """The shipped cases compared with ASTM E399, with the compliances of benchmarks/specimens.py."""

    def test_a_beam_on_rollers(self):
        row = self.rows(CASES / "three_point_bending/rollers.toml")[-1]
        self.assertAlmostEqual(row["mouth_x"] / -row["reaction_y:load"] / specimens.bend_compliance(), 1, delta=0.05)
        self.assertAlmostEqual(row["reaction_y:left"] / -row["reaction_y:load"], 0.5, delta=1e-6)

    def test_compact_tension_on_pins_is_that_of_its_half(self):
        text = (CASES / "compact_tension/pins.toml").read_text()
        whole = self.rows(text, name="whole")[-1]
        self.assertAlmostEqual(whole["mouth_y"] / whole["reaction_y:upper"] / specimens.tension_compliance(), 1, delta=0.08)
        self.assertLess(abs(whole["moment_z:upper"]), 1e-9 * whole["reaction_y:upper"] * 5e-3)
        self.assertAlmostEqual(whole["rotation_z:upper"], -whole["rotation_z:lower"], delta=1e-9)
        half = text.replace("min = [-0.010, -0.024]", "min = [-0.010, 0.0]")
        for table, name in (("[[set]]", "lower"), ("[[set]]", "mouth_below"), ("[[rigid]]", "lower")):
            start = half.index(f'{table}\n{"name" if table == "[[set]]" else "set"} = "{name}"')
            half = half[:start] + half[half.index("\n\n", start) + 2 :]
        half = half[: half.index("[[probe]]")] + '[[probe]]\nname = "mouth"\nset = "mouth_above"\n[[symmetry]]\naxis = "y"\n'
        part = self.rows(half, name="half")[-1]
        # Both are solved to a residual of 1e-10 of the pin's force, in systems of different size.
        self.assertAlmostEqual(part["reaction_y:upper"] / whole["reaction_y:upper"], 1, delta=1e-8)
        self.assertAlmostEqual(part["rotation_z:upper"] / whole["rotation_z:upper"], 1, delta=1e-8)
        self.assertAlmostEqual(2 * part["mouth_y"] / whole["mouth_y"], 1, delta=1e-8)
