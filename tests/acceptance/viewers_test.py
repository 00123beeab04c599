"""What viewers and tables show of a run: results.xdmf and results.vtkhdf as their formats say, read without ParaView, and
force against displacement of what is driven."""

import csv
import os
import xml.etree.ElementTree as ElementTree

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.acceptance.fracture_test import STRIP
from tests.acceptance.on_ranks import PLATE, Comparison, rows
from tests.acceptance.strip import PULLED

# Nodes of the kinds of cells: numbers in XDMF (None: it follows), and in VTK.
XDMF = {1: None, 2: None, 3: None, 4: 3, 5: 4, 6: 4, 7: 5, 8: 6, 9: 8}
TOPOLOGIES = {"Polyvertex": 1, "Polyline": 2, "Triangle": 3, "Quadrilateral": 4, "Tetrahedron": 4, "Hexahedron": 8}


def array_of(item, folder):
    """The values of a DataItem."""
    dimensions = [int(extent) for extent in item.get("Dimensions").split()]
    if item.get("Format") == "XML":
        return numpy.array([float(word) for word in item.text.split()]).reshape(dimensions)
    name, _, path = item.text.strip().partition(":")
    with h5py.File(folder / name) as file:
        values = file[path][...]
    assert list(values.shape) == dimensions, item.text
    return values


class Grid:
    """A grid of results.xdmf: points, cells as lists of points, and attributes by name."""

    def __init__(self, element, folder):
        self.points = array_of(element.find("Geometry/DataItem"), folder)
        topology = element.find("Topology")
        numbers = array_of(topology.find("DataItem"), folder).ravel()
        count = int(topology.get("NumberOfElements"))
        if topology.get("TopologyType") == "Mixed":
            self.cells, at = [], 0
            while at < len(numbers):
                nodes = XDMF[numbers[at]]
                if nodes is None:
                    at += 1
                    nodes = numbers[at]
                self.cells.append(numbers[at + 1 : at + 1 + nodes])
                at += 1 + nodes
        else:
            self.cells = numbers.reshape(count, TOPOLOGIES[topology.get("TopologyType")])
        assert len(self.cells) == count
        self.attributes, self.centres = {}, {}
        for attribute in element.findall("Attribute"):
            self.attributes[attribute.get("Name")] = array_of(attribute.find("DataItem"), folder)
            self.centres[attribute.get("Name")] = attribute.get("Center")


def xdmf_steps(folder):
    """Grids by name for each step."""
    steps = {}
    for collection in ElementTree.parse(folder / "results.xdmf").getroot().find("Domain/Grid").findall("Grid"):
        step = int(collection.find("Time").get("Value"))
        steps[step] = {grid.get("Name"): Grid(grid, folder) for grid in collection.findall("Grid")}
    return steps


class VtkHdf:
    """results.vtkhdf, read as VTKHDF 2.0 says."""

    def __init__(self, folder):
        with h5py.File(folder / "results.vtkhdf") as file:
            root = file["VTKHDF"]
            assert list(root.attrs["Version"]) == [2, 0] and root.attrs["Type"] == b"UnstructuredGrid"
            assert all(root[f"NumberOf{of}"].shape == (1,) for of in ("Points", "Cells", "ConnectivityIds"))
            self.points = root["Points"][...]
            corners, offsets = root["Connectivity"][...], root["Offsets"][...]
            assert (len(self.points), len(offsets) - 1, len(corners)) == tuple(
                root[f"NumberOf{of}"][0] for of in ("Points", "Cells", "ConnectivityIds"))
            self.cells = [corners[a:b] for a, b in zip(offsets, offsets[1:])]
            self.types = root["Types"][...]
            steps = root["Steps"]
            self.numbers = [int(value) for value in steps["Values"][...]]
            assert steps.attrs["NSteps"] == len(self.numbers)
            for name in ("PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"):
                assert not steps[name][...].any()
            assert (steps["NumberOfParts"][...] == 1).all()
            self.fields = {name: values[...] for name, values in root["CellData"].items()}
            self.offsets = {name: values[...] for name, values in steps["CellDataOffsets"].items()}
            assert self.fields.keys() == self.offsets.keys()

    def field(self, name, step):
        first = self.offsets[name][self.numbers.index(step)]
        return self.fields[name][first : first + len(self.cells)]

    def field_without_steps(self, name):
        """As a reader of VTKHDF 1.0 sees it."""
        return self.fields[name][: len(self.cells)]


def polygon_area(corners):
    x, y = corners[:, 0], corners[:, 1]
    return 0.5 * float(x @ numpy.roll(y, -1) - y @ numpy.roll(x, -1))


def hexahedron_volume(corners):
    """By the divergence theorem over the six faces, whose corners VTK numbers like this."""
    faces = (0, 4, 7, 3), (1, 2, 6, 5), (0, 1, 5, 4), (3, 7, 6, 2), (0, 3, 2, 1), (4, 5, 6, 7)
    total = 0.0
    for a, b, c, d in (corners[list(face)] for face in faces):
        total += numpy.dot(a, numpy.cross(b, c)) + numpy.dot(a, numpy.cross(c, d))
    return total / 6.0


class Viewers(Folder):
    def steps_of_h5(self, folder):
        with h5py.File(folder / "results.h5") as file:
            fields = {int(name): {key: values[...] for key, values in step.items() if isinstance(values, h5py.Dataset)}
                      for name, step in file["steps"].items()}  # fmt: skip
            return fields, file["points/volume"][...], file["points/reference"][...]

    def compare(self, folder):
        """Both files hold the fields of results.h5 in all steps; returns the grids of results.xdmf."""
        fields, volume, reference = self.steps_of_h5(folder)
        series, other = xdmf_steps(folder), VtkHdf(folder)
        self.assertEqual(list(series), list(fields))
        self.assertEqual(other.numbers, list(fields))
        self.assertGreater(len(fields), 0)
        for step, grids in series.items():
            body = grids["body"]
            numpy.testing.assert_array_equal(body.points, other.points)
            self.assertEqual([list(cell) for cell in body.cells], [list(cell) for cell in other.cells])
            numpy.testing.assert_array_equal(body.attributes["volume"], volume)
            for name in ("displacement", "damage", "force", "energy_density", "stretch", "fragment"):
                expected = fields[step][name]
                if expected.ndim == 2:
                    expected = numpy.pad(expected, [(0, 0), (0, 3 - expected.shape[1])])
                numpy.testing.assert_array_equal(body.attributes[name], expected, err_msg=f"{name} {step}")
                numpy.testing.assert_array_equal(other.field(name, step), expected, err_msg=f"{name} {step}")
                self.assertEqual(body.centres[name], "Cell")
        numpy.testing.assert_array_equal(other.field_without_steps("displacement"), other.field("displacement", max(fields)))
        self.assertGreater(abs(other.field_without_steps("displacement")).max(), 0.0)
        for point, cell in enumerate(body.cells):  # each has corners of its own, around its point
            centre = body.points[cell].mean(axis=0)[: reference.shape[1]]
            numpy.testing.assert_allclose(centre, reference[point], atol=0.3 * volume.max() ** (1 / reference.shape[1]))
        self.assertEqual(sorted(numpy.concatenate(body.cells)), list(range(len(body.points))))
        return series

    def test_cells_of_a_lattice_fill_the_body(self):
        for name, changes, area in (
            ("square", (), 22e-3 * 0.01),
            ("unequal", ("lattice.spacing=[1e-3, 0.5e-3]",), 22e-3 * 0.01),
            ("turned", ("lattice.angle=30",), None),
        ):
            with self.subTest(name):
                folder = self.run_case(PULLED, *changes, name=name, code=(0, 2))
                if self.ended.code == 2:
                    self.assertEqual(name, "turned", self.ended.said)  # layers stand on the lattice's axes
                    continue
                body = self.compare(folder)[1]["body"]
                areas = [polygon_area(body.points[cell]) for cell in body.cells]
                self.assertGreater(min(areas), 0.0)
                if area:
                    self.assertAlmostEqual(sum(areas) / self.area_of(folder, 1e-3), 1.0, delta=1e-12)

    def area_of(self, folder, thickness):
        with h5py.File(folder / "results.h5") as file:
            return file["points/volume"][...].sum() / thickness

    TURNED = """\
dimension = 2
[lattice]
spacing = 0.1
angle = 30
thickness = 0.5
shape = [{ add = "box", min = [0, 0], max = [2, 1] }]
[[set]]
name = "left"
where = "x < 0.3"
[material]
youngs_modulus = 1e9
[[support]]
set = "left"
displacement = [0, 0]
[[load]]
set = "right"
total_force = [10, 0]
[[set]]
name = "right"
where = "x > 1.7"
"""

    def test_cells_of_a_turned_lattice(self):
        body = self.compare(self.run_case(self.TURNED))[1]["body"]
        cell = body.points[body.cells[7]]
        self.assertAlmostEqual(polygon_area(cell), 0.01, delta=1e-14)
        edge = cell[1] - cell[0]
        self.assertAlmostEqual(numpy.degrees(numpy.arctan2(edge[1], edge[0])), 30.0, delta=1e-9)
        # Cells beside each other share corners, so that they fill the plane.
        corners = {tuple(numpy.round(corner / 1e-9).astype(int)) for corner in body.points}
        self.assertLess(len(corners), 1.35 * len(body.cells))

    def test_cells_of_blue_noise_and_of_cubes(self):
        noise = self.TURNED.replace("angle = 30", 'points = "blue_noise"\nseed = 3')
        folder = self.run_case(noise, name="noise", code=(0, 2))
        self.assertEqual(self.ended.code, 0, self.ended.said)
        body = self.compare(folder)[1]["body"]
        self.assertGreater(len({len(cell) for cell in body.cells}), 1)  # pentagons, hexagons, …
        _, volume, _ = self.steps_of_h5(folder)
        numpy.testing.assert_allclose([0.5 * polygon_area(body.points[cell]) for cell in body.cells], volume, rtol=1e-9)

        cubes = self.TURNED.replace("dimension = 2", "dimension = 3").replace("angle = 30\nthickness = 0.5\n", "")
        cubes = cubes.replace("[0, 0], max = [2, 1]", "[0, 0, 0], max = [2, 0.5, 0.4]").replace("0.1\n", "[0.1, 0.1, 0.2]\n")
        cubes = cubes.replace("[0, 0]", "[0, 0, 0]").replace("[10, 0]", "[10, 0, 0]")
        folder = self.run_case(cubes, name="cubes")
        body = self.compare(folder)[1]["body"]
        volumes = [hexahedron_volume(body.points[cell]) for cell in body.cells]
        numpy.testing.assert_allclose(volumes, 0.002, rtol=1e-12)

    def test_cells_of_a_bar_and_points_of_a_file(self):
        self.write("points.csv", "x,y,volume\n" + "".join(f"{x},{y},1\n" for x in range(6) for y in range(4)))
        cloud = """
dimension = 2
[points]
file = "points.csv"
thickness = 1.0
horizon = 2.1
""" + self.TURNED[self.TURNED.index("[[set]]") :].replace("< 0.3", "< 0.5").replace("> 1.7", "> 4.5")  # fmt: skip
        folder = self.run_case(cloud, name="cloud", code=(0, 2))
        self.assertEqual(self.ended.code, 0, self.ended.said)
        self.assertEqual({len(cell) for cell in self.compare(folder)[1]["body"].cells}, {1})

    def test_broken_bonds_are_lines(self):
        folder = self.run_case(STRIP, name="strip")
        series = self.compare(folder)
        bonds = rows(folder, "broken_bonds.csv")
        self.assertGreater(len(bonds), 20)
        with_lines = 0
        for step, grids in series.items():
            expected = [row for row in bonds if int(row["step"]) <= step]
            self.assertEqual("broken_bonds" in grids, bool(expected))
            if not expected:
                continue
            with_lines += 1
            lines = grids["broken_bonds"]
            numpy.testing.assert_array_equal(lines.cells, [[int(row[f"{end}_point"]) for end in ("first", "second")] for row in expected])
            numpy.testing.assert_array_equal(lines.attributes["step"], [int(row["step"]) for row in expected])
            fields, _, reference = self.steps_of_h5(folder)
            numpy.testing.assert_array_equal(lines.points[:, :2], reference)
            numpy.testing.assert_array_equal(lines.attributes["displacement"][:, :2], fields[step]["displacement"])
            self.assertEqual(lines.centres["displacement"], "Node")
        self.assertGreater(with_lines, 1)

    def test_lines_of_a_body_with_images_end_at_points(self):
        """Half of a strip that breaks in its middle: bonds across the plane have one end in the results."""
        left = '[[lattice.layer]]\nname = "left"\nside = "x-"\n'
        text = PULLED.replace(left, "").replace("[[support]]\nset = \"left\"\ndisplacement = [0, 0]\n", "")
        text = text.replace('["1e-5*load", "free"]', '["5e-4*load", 0]')
        text = text.replace("[[support]]", '[material.damage]\nlaw = "tanh"\nonset = 0.015\ncritical = 0.02\nno_fail = ["far"]\n[[support]]')
        text += '[[set]]\nname = "far"\nwhere = "x > 2.1e-3"\n[[symmetry]]\naxis = "x"\nat = 0.0\n'
        folder = self.run_case(text + '[solver]\nmode = "adaptive"\n[relaxation]\nsteps = 20\n', name="half")
        bonds = rows(folder, "broken_bonds.csv")
        within = [row for row in bonds if row["second_image"] == "0"]
        self.assertGreater(len(bonds), len(within))
        self.assertEqual(len(list(xdmf_steps(folder).values())[-1]["broken_bonds"].cells), len(within))
        self.assertGreater(len(within), 0)

    def test_a_resumed_run_shows_the_same(self):
        whole = self.run_case(STRIP, name="whole")
        cut = self.run_case(STRIP, name="cut", words=("--stop-after", 12), code=130)
        self.compare(cut)  # with parts
        self.resume("cut")
        for name in ("results.xdmf", "load_displacement.csv"):
            self.assertEqual((cut / name).read_bytes(), (whole / name).read_bytes())
        self.assertEqual(self.compare(cut).keys(), self.compare(whole).keys())
        lines = [list(xdmf_steps(folder).values())[-1]["broken_bonds"].cells for folder in (cut, whole)]
        numpy.testing.assert_array_equal(*lines)

    def test_files_open_beside_each_other_from_anywhere(self):
        folder = self.run_case(PULLED)
        moved = self.folder / "moved"
        os.rename(folder, moved)
        self.compare(moved)


class LoadDisplacement(Folder):
    def rows(self, folder, name="load_displacement.csv"):
        with open(folder / name, newline="") as file:
            return [{key: value if key == "mode" else float(value) for key, value in row.items()} for row in csv.DictReader(file)]

    def curve(self, *arguments, **options):
        """Columns of the curve, after a comparison with the history and the fields."""
        folder = self.run_case(*arguments, **options)
        curve, history = self.rows(folder), self.rows(folder, "history.csv")
        self.assertEqual([row["step"] for row in curve], [row["step"] for row in history])
        with h5py.File(folder / "results.h5") as file:
            names = list(file["points/set_ids"].attrs["sets"])
            for row, of_history in zip(curve, history):
                group = f"steps/{int(row['step']):06d}"
                for column in row:
                    kind, _, of = column.partition("_")
                    if kind == "displacement" and of[2:] in names and group in file:
                        members = file["points/set_ids"][:, names.index(of[2:])] == 1
                        mean = file[f"{group}/displacement"][...][members, "xyz".index(of[0])].mean()
                        self.assertAlmostEqual(row[column], mean, delta=1e-13 * max(abs(mean), 1e-30) + 1e-20)
                    if kind == "force":
                        source = of_history.get(f"force_{of}", of_history.get(f"reaction_{of}"))
                        self.assertEqual(row[column], source)
        return {column: [row[column] for row in curve] for column in curve[0]}

    def test_supports_that_move(self):
        curve = self.curve(PULLED, "loading.steps=2")
        self.assertEqual(list(curve), ["step", "load_factor", "displacement_x:right", "force_x:right"])
        numpy.testing.assert_allclose(curve["displacement_x:right"], [0, 0.5e-5, 1e-5], rtol=1e-13)
        # A bar of 200 GPa, 10 mm x 1 mm, of about 20 to 22 mm, whose ends are held across.
        stiffness = curve["force_x:right"][-1] / 1e-5
        self.assertTrue(200e9 * 1e-5 / 22e-3 * 0.8 < stiffness < 200e9 * 1e-5 / 20e-3 * 1.3, stiffness)

    def test_loads_sides_and_constraints(self):
        loaded = PULLED.replace('[[support]]\nset = "right"\ndisplacement = ["1e-5*load", "free"]\n', "")
        force = self.curve(loaded + '[[load]]\nset = "right"\ntotal_force = ["1e3*load", 0]\n')
        self.assertEqual(list(force)[2:], ["displacement_x:right", "force_x:right"])
        self.assertAlmostEqual(force["force_x:right"][-1], 1e3, delta=1e-9)
        pulled = self.curve(PULLED, name="pulled")
        stiffness = [curve["force_x:right"][-1] / curve["displacement_x:right"][-1] for curve in (force, pulled)]
        self.assertAlmostEqual(stiffness[0] / stiffness[1], 1.0, delta=0.1)

        plain = loaded.replace('[[lattice.layer]]\nname = "right"\nside = "x+"\n', "")
        traction = '[[load]]\nside = "x+"\ntraction = ["1e8*load", 0]\ndepth = "{}"\n'
        for depth in ("row", "horizon"):  # 1e8 Pa on 10 mm x 1 mm
            curve = self.curve(plain + traction.format(depth), name=depth)
            self.assertEqual(list(curve)[2:], ["displacement_x:x+", "force_x:x+"])
            self.assertAlmostEqual(curve["force_x:x+"][-1], 1e3, delta=1e-9)
            self.assertGreater(curve["displacement_x:x+"][-1], 0.0)

        # Several loads in one place are one force, in any order.
        pressure = '[[load]]\nside = "x+"\npressure = "1e6*load"\n'
        for number, both in enumerate((traction.format("row") + traction.format("horizon"), traction.format("horizon") + traction.format("row"))):
            for more in ("", pressure):
                curve = self.curve(plain + more + both, name=f"both_{number}{len(more)}")
                self.assertEqual(list(curve)[2:], ["displacement_x:x+", "force_x:x+"])
                self.assertAlmostEqual(curve["force_x:x+"][-1], 2e3, delta=1e-9)

        pressed = self.curve(plain + '[[load]]\nside = "x+"\npressure = "1e8*load"\n', name="pressed")
        self.assertEqual(list(pressed)[2:], ["displacement_x:x+"])
        self.assertLess(pressed["displacement_x:x+"][-1], 0.0)

        roller = loaded + '[[roller]]\nset = "right"\nnormal = [1, 0]\ndisplacement = "1e-5*load"\n'
        curve = self.curve(roller, name="roller")
        self.assertEqual(list(curve)[2:], ["displacement_x:right", "force_x:right"])
        self.assertAlmostEqual(curve["displacement_x:right"][-1], 1e-5, delta=1e-14)
        self.assertAlmostEqual(curve["force_x:right"][-1] / pulled["force_x:right"][-1], 1.0, delta=0.05)

    def test_a_control_has_its_own_column(self):
        text = PULLED.replace("1e-5*load", "load") + '[loading]\ntable = [0, 1e-5]\nsteps = 2\n[[control]]\nset = "middle"\nweights = [1, 0]\n'
        text += '[[set]]\nname = "middle"\nwhere = "x > 9e-3 && x < 11e-3"\n'
        curve = self.curve(text)
        self.assertEqual(list(curve)[2:], ["control", "displacement_x:right", "force_x:right"])
        self.assertAlmostEqual(curve["control"][-1], 1e-5, delta=1e-12)
        self.assertGreater(curve["displacement_x:right"][-1], 1.5e-5)

    def test_a_motion(self):
        text = PULLED.replace("1e-5*load", "1e-2*t").replace("[material]\n", "[material]\ndensity = 8000\n")
        curve = self.curve(text + '[solver]\nmode = "dynamics"\n[dynamics]\nend_time = 1e-5\n')
        numpy.testing.assert_allclose(curve["displacement_x:right"], 1e-2 * numpy.array(curve["load_factor"]), rtol=1e-12, atol=1e-20)
        self.assertGreater(max(curve["force_x:right"]), 0.0)

    def test_nothing_driven(self):
        still = PULLED.replace('"1e-5*load"', "0.0")
        self.assertEqual(list(self.curve(still + '[[eigenstrain]]\nset = "left"\nstrain = "1e-4*load"\n')), ["step", "load_factor"])


class OnRanksToo(Comparison):
    def test_cells_lines_and_curves(self):
        one = self.compare(PLATE, (2, 3))
        self.assertIsNotNone(one)
        names = [path.name for path in self.folder.iterdir() if (path / "results.h5").exists()]
        self.assertGreater(len(names), 1)
        series = [xdmf_steps(self.folder / name) for name in names]
        texts = {(self.folder / name / "results.xdmf").read_text() for name in names}
        self.assertEqual(len(texts), 1)
        for other in series[1:]:
            numpy.testing.assert_array_equal(other[1]["body"].points, series[0][1]["body"].points)
            numpy.testing.assert_array_equal(other[1]["body"].cells, series[0][1]["body"].cells)
        curves = [rows(self.folder / name, "load_displacement.csv") for name in names]
        self.assertIn("force_x:corner", curves[0][0])
        for curve in curves[1:]:
            for row, expected in zip(curve, curves[0]):
                for column, value in expected.items():
                    self.assertAlmostEqual(float(row[column]), float(value), delta=1e-7 * abs(float(value)) + 1e-12)
