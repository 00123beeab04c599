"""Strain and stress at points: fields, probes, lines, and their balance."""

import json

import h5py
import numpy

from tests.acceptance.constraints_test import BONDS, BRITTLE, CELL, CPD_2D, CPD_3D, HOLE, Constrained, lattice_stress, plate
from tests.reference import stress
from tests.reference.body import Body
from tests.reference.case import Case
from tests.reference.mechanics import Mechanics
from tests.reference.results import table
from tests.reference.verify import verify

# Sums of some hundred terms of stretches that have lost no digits.
EXACT = 1e-12
FIELDS = {"deformation_gradient", "green_lagrange_strain", "first_piola_stress", "cauchy_stress", "strain", "stress",
          "von_mises", "principal_stress", "principal_direction", "missing_neighbourhood"}  # fmt: skip
OUTPUT = "[output]\nstress = true\n"

FRAMED = """\
dimension = {dimension}
[lattice]
spacing = 1e-3
horizon_ratio = {ratio}
{section}
[[lattice.shape]]
add = "box"
min = {low}
max = {high}
[[set]]
name = "frame"
where = "{outside}"
[material]
{material}
[[support]]
set = "frame"
displacement = {displacement}
[solver]
relative_tolerance = 1e-13
"""


def framed(gradient, material, ratio=3.015, half=10, more=""):
    """A body whose boundary, thicker than the horizon, moves homogeneously, and so does the whole body."""
    d = len(gradient)
    free = half - 2 * int(ratio) - 2  # the neighbours of free points do not see the surface either
    outside = " || ".join(f"(abs({axis}) > {free * 1e-3})" for axis in "xyz"[:d])
    rows = ["load*(" + " + ".join(f"({value!r})*{axis}" for value, axis in zip(row, "xyz")) + ")" for row in gradient]
    section = {1: "area = 2e-6", 2: "thickness = 3e-3", 3: ""}[d]
    return FRAMED.format(dimension=d, ratio=ratio, section=section, low=[-half * 1e-3] * d, high=[half * 1e-3] * d, outside=outside,
                         material=material, displacement=json.dumps(rows)) + more + OUTPUT  # fmt: skip


class Stressed(Constrained):
    def fields_of(self, name="out", step=-1):
        with h5py.File(self.folder / name / "results.h5") as file:
            group = file["steps"][sorted(file["steps"])[step]]
            found = {key: group[key][...] for key in group if isinstance(group[key], h5py.Dataset)}
            found["reference"], found["volume"] = file["points/reference"][...], file["points/volume"][...]
        return found


class Homogeneous(Stressed):
    """Inside, stress is the derivative of the lattice's energy density."""

    def check(self, gradient, material, **more):
        text = framed(gradient, material, **more)
        self.run_case(text)
        found = self.fields_of()
        case = Case(text.replace(OUTPUT, ""), self.folder)
        gradient = numpy.array(gradient)
        d = len(gradient)
        bulk = (numpy.abs(found["reference"]) < 1e-3).all(axis=1)
        self.assertEqual(bulk.sum(), 2**d)
        body = Mechanics(Body(case, found["reference"], found["volume"], sets={}))
        virial = stress.virials(body, found["reference"] @ gradient.T)[bulk] / found["volume"][bulk, None, None]
        F = numpy.eye(d) + gradient
        sigma = virial[0] @ F.T / numpy.linalg.det(F)
        strain = (gradient + gradient.T + gradient.T @ gradient) / 2
        size = numpy.abs(virial).max()
        self.assertGreater(size, 0)
        self.assertLess(numpy.abs(found["first_piola_stress"][bulk] - virial).max() / size, EXACT)
        self.assertLess(numpy.abs(found["cauchy_stress"][bulk] - sigma).max() / numpy.abs(sigma).max(), EXACT)
        self.assertLess(numpy.abs(sigma - sigma.T).max() / numpy.abs(sigma).max(), EXACT)
        self.assertLess(numpy.abs(found["deformation_gradient"] - F).max(), EXACT)
        self.assertLess(numpy.abs(found["green_lagrange_strain"] - strain).max() / numpy.abs(strain).max(), EXACT)
        self.assertLess(numpy.abs(found["missing_neighbourhood"][bulk]).max(), EXACT)
        self.assertGreater(found["missing_neighbourhood"].max(), 0.4)
        return found, bulk

    def test_bonds(self):
        elastic = 'model = "bond"\nyoungs_modulus = 200e9\n'
        self.check([[0.02]], elastic)
        for plane in ("stress", "strain"):
            self.check([[0.03, 0.02], [-0.01, -0.04]], elastic + f'plane = "{plane}"\n', more='[quadrature]\nvolume_correction = "linear"\n')
        self.check([[0.03, 0.02, 0.01], [-0.01, -0.04, 0.0], [0.02, -0.03, 0.01]], elastic, ratio=2.015, half=8)

    def test_cpd(self):
        self.check([[0.03, 0.02], [-0.01, -0.04]], 'model = "cpd"\nc1 = 4e24\nc2 = 9e30\n', ratio=2.015, half=8)
        self.check([[0.03, 0.02, 0.01], [-0.01, -0.04, 0.0], [0.02, -0.03, 0.01]],
                   'model = "cpd"\nc1 = 4e24\nc2 = 9e34\nc3 = 5e47\n', ratio=1.5, half=6)  # fmt: skip

    def test_small_strains_keep_their_digits(self):
        self.check([[3e-9, 2e-9], [-1e-9, -4e-9]], BONDS)

    def test_von_mises_and_principal_values_of_a_pull(self):
        for plane, across in (("stress", 0.0), ("strain", 0.25)):
            found, bulk = self.check([[1e-7, 0], [0, 3e-8]], BONDS.replace("stress", plane))
            x, y = found["principal_stress"][bulk][0]
            z = across * (x + y)
            self.assertGreater(x, y)
            expected = numpy.sqrt(((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2)
            self.assertLess(numpy.abs(found["von_mises"][bulk] / expected - 1).max(), EXACT)
            self.assertLess(numpy.abs(found["principal_direction"][bulk] - numpy.eye(2)).max(), 1e-6)
            # The lattice's Young's modulus equals the case's up to its anisotropy; Hooke's law in the plane or across
            # it.
            nu, E = (1 / 3, 200e9) if plane == "stress" else (1 / 4, 200e9)
            factor = E / (1 - nu**2) if plane == "stress" else E * (1 - nu) / (1 + nu) / (1 - 2 * nu)
            ratio = nu if plane == "stress" else nu / (1 - nu)
            self.assertAlmostEqual(x / (factor * (1e-7 + ratio * 3e-8)), 1, delta=0.06)


class Turned(Stressed):
    def test_a_rigid_rotation_strains_nothing_and_turns_stress(self):
        angle = 0.7
        turn = numpy.array([[numpy.cos(angle), -numpy.sin(angle)], [numpy.sin(angle), numpy.cos(angle)]])
        rotated = (turn - numpy.eye(2)).tolist()
        self.run_case(framed(rotated, BONDS), name="rigid")
        rigid = self.fields_of("rigid")
        self.assertLess(numpy.abs(rigid["strain"]).max(), 1e-14)
        self.assertLess(numpy.abs(rigid["cauchy_stress"]).max(), 1e-13 * 200e9)
        stretch = numpy.array([[1.02, 0.01], [0.01, 0.97]])
        self.run_case(framed((stretch - numpy.eye(2)).tolist(), BONDS), name="straight")
        self.run_case(framed((turn @ stretch - numpy.eye(2)).tolist(), BONDS), name="turned")
        straight, turned = self.fields_of("straight"), self.fields_of("turned")
        size = numpy.abs(straight["cauchy_stress"]).max()
        self.assertLess(numpy.abs(turned["strain"] - straight["strain"]).max(), 1e-13)
        expected = turn @ straight["cauchy_stress"] @ turn.T
        self.assertLess(numpy.abs(turned["cauchy_stress"] - expected).max() / size, EXACT)
        self.assertLess(numpy.abs(turned["first_piola_stress"] - turn @ straight["first_piola_stress"]).max() / size, EXACT)
        self.assertLess(numpy.abs(turned["von_mises"] - straight["von_mises"]).max() / size, EXACT)


class Balance(Stressed):
    def test_virials_of_a_body_are_those_of_what_acts_on_it(self):
        """In any equilibrium the sum of V P equals that of force (x) position over all forces on the body."""
        body_force = '[[load]]\nset = "top"\nbody_force = ["1e8*load", "2e9*load*(1 + 100*x)"]\n'
        cases = {"bonds": plate("", hole=HOLE), "corrected": plate("", hole=HOLE, correction="energy"),
                 "cpd": plate("", material=CPD_2D, hole=HOLE), "solid": plate("", material=CPD_3D, dimension=3, pull="3e-5"),
                 "torn": plate("", material=BRITTLE, pull="2e-4", more="[[crack]]\nfrom = [-0.004, 0.0]\nto = [0.004, 0.0]\n[loading]\nsteps = 4\n")}  # fmt: skip
        self.assertIn('displacement = ["0", "1e-5*load"]', cases["bonds"])
        cases["loaded"] = cases["bonds"].replace('displacement = ["0", "1e-5*load"]', 'displacement = ["0", "free"]') + body_force
        for name, text in cases.items():
            with self.subTest(name):
                settings = ("solver.mode='adaptive'", "relaxation.steps=20") if name == "torn" else ()
                rows = self.rows(text + OUTPUT, *settings, name=name)
                found = self.fields_of(name)
                virial = numpy.einsum("n,nij->ij", found["volume"], found["first_piola_stress"])
                acting = -numpy.einsum("ni,nj->ij", found["force"], found["reference"])
                self.assertLess(numpy.abs(virial - acting).max() / numpy.abs(acting).max(), EXACT)
                if name == "torn":
                    self.assertGreater(rows[-1]["broken_bonds"], 0)

    def test_a_slab_as_wide_as_the_horizon_bears_the_reaction(self):
        """Faces of the slab are where the state hardly changes along the bar; the rest is the change over a horizon."""
        text = plate("", pull="1e-5").replace("-0.012, -0.012", "-0.006, -0.03").replace("0.012, 0.012", "0.006, 0.03")
        self.assertIn("-0.03", text)
        row = self.rows(text + OUTPUT)[-1]
        found = self.fields_of()
        y = found["reference"][:, 1]
        for middle in (-0.008, 0.0, 0.006):
            slab = numpy.abs(y - middle) < 2e-3  # four rows: the horizon is three
            width = 4e-3
            area_stress = (found["volume"][slab] * found["first_piola_stress"][slab, 1, 1]).sum() / width
            self.assertAlmostEqual(area_stress / row["reaction_y:top"], 1, delta=2e-5)

    def test_a_periodic_cell_has_the_stress_of_its_reactions(self):
        for gradient in ([[1e-4, 0], [0, 0]], [[0.02, 0.01], [-0.03, 0.05]]):
            text = CELL.format(material=BONDS, x=[gradient[0][0], gradient[1][0]], y=[gradient[0][1], gradient[1][1]])
            for hole in ("", "[[lattice.shape]]\nsubtract = \"disk\"\ncentre = [0.003, 0.003]\nradius = 1.2e-3\n"):
                row = self.rows(text.replace("[material]", hole + "[material]") + OUTPUT, name="cell")[-1]
                found = self.fields_of("cell")
                mean = numpy.einsum("n,nij->ij", found["volume"], found["first_piola_stress"]) / (0.008 * 0.006 * 1e-3)
                told = numpy.array([[row["reaction_x:period_x"] / 0.006, row["reaction_x:period_y"] / 0.008],
                                    [row["reaction_y:period_x"] / 0.006, row["reaction_y:period_y"] / 0.008]]) / 1e-3  # fmt: skip
                self.assertLess(numpy.abs(mean - told).max() / numpy.abs(told).max(), EXACT)
                if not hole:
                    self.assertLess(numpy.abs(found["first_piola_stress"] - lattice_stress(gradient)).max() / numpy.abs(told).max(), EXACT)
                    self.assertLess(numpy.abs(found["missing_neighbourhood"]).max(), EXACT)

    def test_parts_by_symmetry_are_the_whole(self):
        for material, dimension, parts in ((BONDS, 2, ("x", "y", "xy")), (CPD_2D, 2, ("xy",)), (CPD_3D, 3, ("xyz",))):
            body = dict(material=material, dimension=dimension, hole=HOLE if dimension == 2 else "")
            self.run_case(plate("", **body) + OUTPUT, name="whole")
            whole = self.fields_of("whole")
            of_place = {tuple(numpy.rint(place * 2e3).astype(int)): i for i, place in enumerate(whole["reference"])}
            for part in parts:
                self.run_case(plate(part, **body) + OUTPUT, name=f"part_{part}")
                found = self.fields_of(f"part_{part}")
                twins = [of_place[tuple(numpy.rint(place * 2e3).astype(int))] for place in found["reference"]]
                for name in FIELDS - {"principal_direction"}:
                    size = numpy.abs(whole[name]).max()
                    self.assertLess(numpy.abs(found[name] - whole[name][twins]).max() / size, EXACT, f"{part} {name}")


class Histories(Stressed):
    def test_damage_lowers_stress(self):
        soft = 'model = "bond"\nyoungs_modulus = 200e9\n[material.damage]\nlaw = "tanh_continuous"\nonset = 0.002\ncritical = 0.015\n'
        strain = [[0.01, 0.0], [0.0, 0.0]]
        self.run_case(framed(strain, soft), name="soft")
        self.run_case(framed(strain, BONDS), name="whole")
        bulk = (numpy.abs(self.fields_of("soft")["reference"]) < 1e-3).all(axis=1)
        soft, whole = (self.fields_of(name)["stress"][bulk, 0].mean() for name in ("soft", "whole"))
        self.assertGreater(self.fields_of("soft")["damage"].max(), 0.05)
        self.assertLess(soft, 0.95 * whole)
        self.assertGreater(soft, 0)

    def test_free_growth_has_no_stress(self):
        text = plate("xy", hole=HOLE).split("[[support]]")[0].replace("[material]\n", "[material]\nthermal_expansion = 1e-5\n")
        text += "".join(f'[[symmetry]]\naxis = "{axis}"\n' for axis in "xy") + '[temperature]\nchange = "200*load"\n'
        self.run_case(text + OUTPUT)
        found = self.fields_of()
        self.assertLess(numpy.abs(found["deformation_gradient"] - 1.002 * numpy.eye(2)).max(), EXACT)
        self.assertLess(numpy.abs(found["first_piola_stress"]).max(), 1e-9 * 0.002 * 200e9)

    def test_what_is_torn_apart_stays_finite(self):
        text = plate("", material=BRITTLE, pull="1e-3", more="[[crack]]\nfrom = [-0.004, 0.0]\nto = [0.004, 0.0]\n")
        self.run_case(text + OUTPUT + "[loading]\nsteps = 4\n", "solver.mode='adaptive'", "relaxation.steps=20")
        found = self.fields_of()
        self.assertGreater(found["damage"].max(), 0.3)
        for name in FIELDS:
            self.assertTrue(numpy.isfinite(found[name]).all(), name)


class Judged(Stressed):
    def test_the_reference_finds_the_same(self):
        cases = {"plate": plate("", hole=HOLE), "energy": plate("", hole=HOLE, correction="energy"),
                 "cpd": plate("", material='model = "cpd"\nc1 = 4e24\nc2 = 9e30\n', hole=HOLE).replace("3.015", "2.015"),
                 "torn": plate("", material=BRITTLE, pull="2e-4", more="[[crack]]\nfrom = [-0.004, 0.0]\nto = [0.004, 0.0]\n")}  # fmt: skip
        for name, text in cases.items():
            with self.subTest(name):
                settings = ("solver.mode='adaptive'", "relaxation.steps=10", "loading.steps=2") if name == "torn" else ()
                self.run_case(text + OUTPUT, *settings, name=name)
                resolved = self.fields_text(name)
                complaints, worst = verify(self.folder / name, resolved, self.folder)
                self.assertEqual(complaints, [])
                self.assertIn("first_piola_stress", worst)

    def test_a_body_at_rest_bears_nothing(self):
        """Not even compared with a reference whose complex steps leave 1e-51 Pa."""
        for pull in ("0", "1e-60"):
            with self.subTest(pull):
                name = f"by_{pull}"
                self.run_case(plate("", pull=pull) + OUTPUT, name=name)
                complaints, worst = verify(self.folder / name, self.fields_text(name), self.folder)
                self.assertEqual(complaints, [])
                self.assertIn("first_piola_stress", worst)

    def fields_text(self, name):
        with h5py.File(self.folder / name / "results.h5") as file:
            return file["case/as_resolved"][()].decode()

    def test_a_wrong_stress_is_noticed(self):
        self.run_case(plate("", hole=HOLE) + OUTPUT)
        with h5py.File(self.folder / "out" / "results.h5", "r+") as file:
            file["steps/000001/von_mises"][17] *= 1.001
        complaints, _ = verify(self.folder / "out", self.fields_text("out"), self.folder)
        self.assertTrue(any("von_mises" in complaint for complaint in complaints))


PROBES = """\
[[set]]
name = "middle"
where = "abs(y) < 2e-3"
[[probe]]
name = "pull"
set = "middle"
field = "stress"
component = "yy"
[[probe]]
name = "most"
set = "middle"
field = "von_mises"
statistic = "max"
[[probe]]
name = "least"
set = "middle"
field = "principal_stress"
component = "2"
statistic = "min"
[[probe]]
name = "shear"
at = [3.1e-3, 6.2e-3]
field = "strain"
component = "xy"
[[probe]]
name = "where"
at = [3.1e-3, 6.2e-3]
[[probe]]
name = "section"
from = [0.0, 0.0]
to = [0.012, 0.0]
field = "stress"
[[probe]]
name = "gap"
from = [0.0, 0.0]
to = [0.0, 0.012]
field = "first_piola_stress"
component = "yx"
"""


class Probes(Stressed):
    def test_probes_are_what_the_fields_hold(self):
        text = plate("", hole=HOLE) + PROBES
        rows = self.rows(text + OUTPUT, "loading.steps=2")
        found = self.fields_of()
        middle = numpy.abs(found["reference"][:, 1]) < 2e-3
        nearest = numpy.linalg.norm(found["reference"] - [3.1e-3, 6.2e-3], axis=1).argmin()
        row = rows[-1]
        self.assertAlmostEqual(row["pull"] / found["stress"][middle, 1].mean(), 1, delta=1e-13)
        self.assertEqual(row["most"], found["von_mises"][middle].max())
        self.assertEqual(row["least"], found["principal_stress"][middle, 1].min())
        self.assertEqual(row["shear"], found["strain"][nearest, 2])
        self.assertEqual([row["where_x"], row["where_y"]], found["displacement"][nearest].tolist())
        self.assertNotIn("section", row)
        line = table(self.folder / "out/line_section.csv")
        self.assertEqual(list(line[0]), ["step", "load_factor", "point", "distance", "x", "y", "stress_xx", "stress_yy", "stress_xy"])
        last = [one for one in line if one["step"] == 2]
        self.assertEqual(len(last), 2 * 8)  # two rows half a spacing away, without the hole
        self.assertEqual(len(line), 2 * len(last))
        self.assertEqual([one["distance"] for one in last], sorted(one["distance"] for one in last))
        for one in last:
            point = int(one["point"])
            self.assertEqual([one["x"], one["y"]], found["reference"][point].tolist())
            self.assertEqual([one["stress_xx"], one["stress_yy"], one["stress_xy"]], found["stress"][point].tolist())
        gap = table(self.folder / "out/line_gap.csv")
        self.assertEqual(gap[-1]["first_piola_stress_yx"], found["first_piola_stress"][int(gap[-1]["point"]), 1, 0])
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual(summary["probes"]["most"], row["most"])

    def test_probes_ask_for_stress_without_fields_of_it(self):
        with_fields = self.rows(plate("", hole=HOLE) + PROBES + OUTPUT, name="with")
        without = self.rows(plate("", hole=HOLE) + PROBES, name="without")
        self.assertEqual(with_fields, without)
        self.assertEqual((self.folder / "with/line_gap.csv").read_bytes(), (self.folder / "without/line_gap.csv").read_bytes())
        self.assertFalse(FIELDS & set(self.fields_of("without")))

    def test_goes_on_to_the_last_bit(self):
        text = plate("", material=BRITTLE, pull="2e-4", more="[[crack]]\nfrom = [-0.004, 0.0]\nto = [0.004, 0.0]\n") + PROBES
        text += OUTPUT + "every = 3\n"
        settings = ("solver.mode='adaptive'", "relaxation.steps=10", "loading.steps=5")
        whole = self.rows(text, *settings, name="whole")
        self.assertGreater(len(whole), 4)
        for stop in (2, 4):
            self.run_case(text, *settings, name="halted", words=("--stop-after", stop), code=130)
            self.resume("halted")
            for name in ("history", "line_section", "line_gap"):
                self.assertEqual((self.folder / "halted" / f"{name}.csv").read_bytes(), (self.folder / "whole" / f"{name}.csv").read_bytes())
            for name, field in self.fields_of("whole").items():
                self.assertTrue((field == self.fields_of("halted")[name]).all(), name)
            with h5py.File(self.folder / "halted/results.h5") as halted, h5py.File(self.folder / "whole/results.h5") as other:
                self.assertEqual(list(halted["steps"]), list(other["steps"]))
                self.assertTrue((halted["lines/gap/point"][...] == other["lines/gap/point"][...]).all())

    def test_wrong_probes_are_refused(self):
        for wrong, told in (('set = "top"\nfield = "stress"\n', "needs a component"),
                            ('set = "top"\nfield = "stress"\ncomponent = "zz"\n', "xx, yy, xy"),
                            ('set = "top"\nfield = "von_mises"\ncomponent = "xx"\n', "no components"),
                            ('field = "von_mises"\n', "exactly one of"),
                            ('set = "top"\nat = [0.0, 0.0]\n', "exactly one of"),
                            ('from = [0.0, 0.0]\nfield = "damage"\n', "to"),
                            ('from = [0.0, 0.0]\nto = [0.0, 0.0]\nfield = "damage"\n', "same place"),
                            ('set = "top"\nto = [0.0, 0.0]\n', "needs the key from"),
                            ('at = [0.0, 0.0]\nfield = "crack_length"\n', "every point"),
                            ('at = [0.0, 0.0]\nstatistic = "max"\n', "over a set"),
                            ('at = [0.0, 0.1]\n', "within two spacings"),
                            ('from = [1.0, 0.0]\nto = [2.0, 0.0]\nfield = "damage"\n', "no point lies")):  # fmt: skip
            with self.subTest(wrong):
                self.assert_refused(self.command("check", plate("") + '[[probe]]\nname = "p"\n' + wrong), told)


class Written(Stressed):
    def test_nothing_is_written_unless_asked_for(self):
        self.run_case(plate("", hole=HOLE))
        self.assertFalse(FIELDS & set(self.fields_of()))

    def test_shapes_units_and_views(self):
        for dimension, material in ((2, BONDS), (3, BONDS)):
            text = plate("", material=material, dimension=dimension)
            self.run_case(text + OUTPUT, name=f"in_{dimension}")
            with h5py.File(self.folder / f"in_{dimension}" / "results.h5") as file:
                step, views = file["steps/000001"], file["xdmf/000001"]
                count, d = step["displacement"].shape
                for name in ("deformation_gradient", "green_lagrange_strain", "first_piola_stress", "cauchy_stress", "principal_direction"):
                    self.assertEqual(step[name].shape, (count, d, d))
                    padded = numpy.zeros((count, 3, 3))
                    padded[:, :d, :d] = step[name][...]
                    self.assertTrue((views[name][...] == padded.reshape(count, 9)).all(), name)
                    self.assertGreater(numpy.abs(padded).max(), 0)
                self.assertEqual(step["stress"].shape, (count, d * (d + 1) // 2))
                self.assertEqual(step["von_mises"].attrs["unit"], "Pa")
            series = (self.folder / f"in_{dimension}" / "results.xdmf").read_text()
            self.assertIn('Name="cauchy_stress" AttributeType="Tensor"', series)
            self.assertIn('Name="von_mises" AttributeType="Scalar"', series)
            self.assertIn(f'Dimensions="{count} 9">results.h5:/xdmf/000001/cauchy_stress', series)


if __name__ == "__main__":
    import unittest

    unittest.main()
