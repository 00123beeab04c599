"""Points of meshes: formats, groups, boundaries, loads on facets, and meshes that are broken."""

import csv
import itertools
import json
import subprocess
import unittest

import h5py
import numpy as np

from tests.acceptance.folder import Folder
from tests.reference.program import ROOT

CASE = """\
dimension = 2
[points]
file = "plate.msh"
horizon = 3.1
thickness = 0.5
[material]
youngs_modulus = 100e9
[[support]]
set = "left"
displacement = [0, 0]
[[load]]
set = "right"
traction = ["1e6*load", 0]
[solver]
linear = "cholesky"
"""
TRIANGLE, QUADRILATERAL, LINE, TETRAHEDRON = 2, 3, 1, 4  # Gmsh's numbers


def msh(nodes, elements, names=(), version="2.2"):
    """Text of a mesh: elements are (type, number of the group, nodes from 1), names (dimension, number, name)."""
    lines = ["$MeshFormat", f"{version} 0 8", "$EndMeshFormat"]
    lines += ["$PhysicalNames", str(len(names)), *(f'{d} {k} "{name}"' for d, k, name in names), "$EndPhysicalNames"]
    lines += ["$Nodes", str(len(nodes))]
    lines += [f"{k + 1} " + " ".join(str(x) for x in (*node, 0, 0)[:3]) for k, node in enumerate(nodes)]
    lines += ["$EndNodes", "$Elements", str(len(elements))]
    lines += [f"{k + 1} {kind} 2 {group} {group} " + " ".join(map(str, of)) for k, (kind, group, of) in enumerate(elements)]
    return "\n".join([*lines, "$EndElements", ""])


def squares(nx, ny, left_out=()):
    """Nodes, elements and names of a plate of unit squares; some are left out by (column, row)."""
    nodes = [(i, j) for j in range(ny + 1) for i in range(nx + 1)]
    at = {node: k + 1 for k, node in enumerate(nodes)}
    elements = [(LINE, 1, (at[0, j], at[0, j + 1])) for j in range(ny)]
    elements += [(LINE, 2, (at[nx, j], at[nx, j + 1])) for j in range(ny)]
    elements += [
        (QUADRILATERAL, 3, (at[i, j], at[i + 1, j], at[i + 1, j + 1], at[i, j + 1]))
        for j in range(ny)
        for i in range(nx)
        if (i, j) not in left_out
    ]
    return nodes, elements, [(1, 1, "left"), (1, 2, "right"), (2, 3, "plate")]


def changed(values, number, value):
    return [*values[:number], value, *values[number + 1 :]]


class Meshes(Folder):
    def mesh(self, *of, name="plate.msh"):
        return self.write(name, msh(*of))

    def points(self, *words, code=0):
        ended = self.peristat("points", *words)
        self.assert_code(ended, code)
        return ended

    def checked(self, text=CASE, *changes):
        ended = self.command("check", text, *changes)
        self.assert_code(ended, 0)
        return ended.output

    def run_of_mesh(self, text=CASE, *changes, **options):
        """The results of a run, open."""
        return self.enterContext(h5py.File(self.run_case(text, *changes, **options) / "results.h5"))

    # ---- points ----

    def test_points_stand_at_centroids_and_know_their_element(self):
        self.mesh(*squares(12, 4))
        of = self.run_of_mesh()["points"]
        row, places = of["source_row"][...], of["reference"][...]
        self.assertEqual(sorted(row), list(range(8, 56)))  # behind 8 lines
        for place, k in zip(places, row, strict=True):
            np.testing.assert_allclose(place, [(k - 8) % 12 + 0.5, (k - 8) // 12 + 0.5], atol=1e-14)
        np.testing.assert_allclose(of["volume"][...], 0.5, rtol=1e-14)
        np.testing.assert_array_equal(of["cells/types"][...], 9)  # VTK's quadrilaterals
        corners = of["cells/corners"][:, :2].reshape(-1, 4, 2)
        np.testing.assert_allclose(corners.mean(axis=1), places, atol=1e-14)

    def test_points_stand_at_nodes_with_their_share(self):
        self.mesh(*squares(12, 4))
        of = self.run_of_mesh(CASE, 'points.at="nodes"')["points"]
        at = of["reference"][...]
        share = np.where(np.isin(at[:, 0], (0, 12)), 0.5, 1) * np.where(np.isin(at[:, 1], (0, 4)), 0.5, 1)
        np.testing.assert_allclose(of["volume"][...], 0.5 * share, rtol=1e-14)
        np.testing.assert_array_equal(of["source_row"][...], at[:, 0] + 13 * at[:, 1])

    def test_shipped_formats_give_the_same_points(self):
        tables = []
        for end in ("msh", "inp", "vtu"):
            output = self.folder / f"points_of_{end}.csv"
            self.points(ROOT / f"cases/mesh/elliptical_hole.{end}", "--output", output)
            lines = output.read_text().splitlines()[2:]
            tables.append([line.split(", ")[:3] for line in lines])
        self.assertGreater(len(tables[0]), 1000)
        self.assertEqual(tables[0], tables[1])
        self.assertEqual(tables[0], tables[2])

    def test_the_text_of_points_gives_the_same_run(self):
        self.mesh(*squares(12, 4))
        self.points("plate.msh", "--thickness", "0.5", "--output", "points.csv")
        text = CASE.replace("plate.msh", "points.csv").replace("traction", "total_force")
        text = text.replace("1e6*load", "2e6*load")
        of_text = self.run_of_mesh(text, name="text")["steps/000001/displacement"][...]
        of_mesh = self.run_of_mesh()["steps/000001/displacement"][...]
        self.assertGreater(np.abs(of_mesh).max(), 0.0)
        np.testing.assert_allclose(of_text, of_mesh, rtol=1e-9, atol=1e-9 * np.abs(of_mesh).max())

    def test_points_leaves_files_of_others_alone(self):
        self.mesh(*squares(3, 3))
        self.write("mine.csv", "important\n")
        ended = self.points("plate.msh", "--output", "mine.csv", code=2)
        self.assertIn("mine.csv", ended.errors)
        self.assertEqual((self.folder / "mine.csv").read_text(), "important\n")
        self.points("plate.msh", "--output", "plate.msh", code=2)
        self.points("plate.msh", "--output", "own.csv")
        self.points("plate.msh", "--at", "nodes", "--output", "own.csv")
        self.assertEqual(len((self.folder / "own.csv").read_text().splitlines()), 18)

    def test_points_prints_what_the_mesh_has(self):
        self.mesh(*squares(12, 4))
        said = self.points("plate.msh", "--thickness", "0.25").output
        for words in ("48 quadrilaterals", "48 in 2D", "12 m3", "32 sides", "left: 4 points; 4 of", "plate: 48 points",
                      "1 to 1 m", "horizon     3.015 m is 3.015 mean"):  # fmt: skip
            self.assertIn(words, said)
        self.assertNotIn("warning", said)

    def test_coordinates_in_millimetres(self):
        nodes, elements, names = squares(12, 4)
        self.mesh(nodes, elements, names)
        said = self.points("plate.msh", "--length-unit", "mm").output
        self.assertIn("horizon     0.003015 m is 3.015 mean", said)
        for unit in ("kg", "furlong"):
            self.assertIn("must be a unit of length", self.points("plate.msh", "--length-unit", unit, code=2).errors)
        scaled = CASE.replace("horizon = 3.1", "horizon = 3.1e-3")
        in_mm = self.fields(self.run_case(scaled, 'points.length_unit="1 mm"', name="mm"))
        self.mesh([(x / 1000, y / 1000) for x, y in nodes], elements, names)
        in_m = self.fields(self.run_case(scaled, name="m"))
        for one, other in zip(in_mm, in_m):
            self.assertEqual(one.tolist(), other.tolist())

    def fields(self, out):
        with h5py.File(out / "results.h5") as file:
            return [file["points/reference"][:], file["points/volume"][:], file["steps/000001/displacement"][:]]

    def test_a_graded_mesh_is_warned(self):
        nodes, elements, names = squares(40, 8)
        nodes = [(1.08**i, j) for i, j in nodes]
        self.mesh(nodes, elements, names)
        self.assertIn("warning: the mesh is graded", self.points("plate.msh").output)
        self.assertIn("warning: the mesh is graded", self.checked())

    def test_other_formats_and_their_groups(self):
        write = (
            "import meshio, sys, numpy as np\n"
            "x = np.array([[i, j, k] for k in range(3) for j in range(3) for i in range(3)], dtype=float)\n"
            "n = lambda i, j, k: i + 3 * j + 9 * k\n"
            "h = [[n(i + a, j + b, k + c) for a, b, c in [(0,0,0),(1,0,0),(1,1,0),(0,1,0),(0,0,1),(1,0,1),(1,1,1),(0,1,1)]]\n"
            "     for k in range(2) for j in range(2) for i in range(2)]\n"
            "tags = [np.array([1] * 4 + [2] * 4)]\n"
            "m = meshio.Mesh(x, [('hexahedron', np.array(h))], cell_data={'layer': tags})\n"
            "m.write('cube.vtu'); m.write('cube.vtk')\n"
            "meshio.Mesh(x, [('hexahedron', np.array(h))], point_sets={'base': np.arange(9)}).write('cube.e')\n"
            "f = meshio.Mesh(x, [('hexahedron', np.array(h))], cell_data={'cell_tags': [-tags[0]]})\n"
            "f.cell_tags = {-1: ['lower', 'all'], -2: ['upper', 'all']}; f.point_tags = {}\n"
            "f.write('cube.med')\n"
        )
        subprocess.run(["/usr/bin/python3", "-BEs", "-c", write], cwd=self.folder, check=True, capture_output=True)
        for name in ("cube.vtu", "cube.vtk"):
            self.assertIn("set         layer_2: 4 points", self.points(name).output)
        self.assertIn("set         lower: 4 points", self.points("cube.med").output)
        self.assertIn("set         all: 8 points", self.points("cube.med").output)
        said = self.points("cube.e").output
        self.assertIn("set         block_0: 8 points", said)
        self.assertIn("set         base: 4 points", said)
        self.assertIn("volume      8 m3", said)

    def test_sets_of_abaqus(self):
        self.write("plate.inp", "*HEADING\n*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n4, 0, 1\n5, 2, 0\n"
                                "*ELEMENT, TYPE=CPE4, ELSET=PLATE\n7, 1, 2, 3, 4\n"
                                "*ELEMENT, TYPE=CPE3, ELSET=PLATE\n9, 2, 5, 3\n"
                                "*ELSET, ELSET=RIGHT\n9\n*NSET, NSET=BASE\n1, 2\n*NSET, NSET=TIP\n5\n")  # fmt: skip
        said = self.points("plate.inp").output
        for words in ("1 triangle, 1 quadrilateral", "PLATE: 2 points", "RIGHT: 1 points", "BASE: 2 points",
                      "TIP: 1 points", "volume      1.5 m3"):  # fmt: skip
            self.assertIn(words, said)

    def test_elements_of_second_order_are_read_by_their_corners(self):
        nodes = [(0, 0), (2, 0), (0, 2), (1, 0), (1, 1), (0, 1)]
        self.mesh(nodes, [(9, 3, (1, 2, 3, 4, 5, 6))], [(2, 3, "plate")])
        said = self.points("plate.msh").output
        self.assertIn("1 element of second order", said)
        self.assertIn("volume      2 m3", said)
        self.assertIn("3 in 2D", self.points("plate.msh", "--at", "nodes").output)

    # ---- boundary ----

    def test_bonds_that_leave_the_body_are_cut(self):
        hole = {(i, 3) for i in range(4, 9)}
        self.mesh(*squares(12, 7, hole))
        centres = np.array([(i + 0.5, j + 0.5) for j in range(7) for i in range(12) if (i, j) not in hole])
        one, other = np.triu_indices(len(centres), 1)
        near = np.linalg.norm(centres[one] - centres[other], axis=1) <= 3.1
        along = np.linspace(0, 1, 401)[:, None, None]
        way = centres[one][near] + along * (centres[other] - centres[one])[near]
        inside = (way > [4.001, 3.001]).all(axis=2) & (way < [8.999, 3.999]).all(axis=2)
        cut = int(inside.any(axis=0).sum())
        self.assertGreater(cut, 30)
        self.assertIn(f"its boundary cuts {cut} bonds", self.checked())
        self.assertEqual(len(self.run_of_mesh(name="cut")["points/volume"]), len(centres))
        self.assertEqual(self.bonds(), near.sum() - cut)
        self.assertEqual(self.bonds("points.cut_bonds=false"), near.sum())

    def bonds(self, *changes):
        folder = self.run_case(CASE, *changes)
        return json.loads((folder / "summary.json").read_text())["bonds"]

    def test_cracks_cut_meshes_like_other_points(self):
        self.mesh(*squares(12, 7))
        said = self.checked(CASE + "[[crack]]\nfrom = [-1, 3.5001]\nto = [4.3, 3.5001]\n")
        self.assertRegex(said, r"crack\[0\] cuts \d\d+ bonds")
        self.assertIn("its boundary cuts 0 bonds", said)

    def test_the_tangent_of_a_mesh_with_a_hole_is_the_derivative(self):
        self.mesh(*squares(8, 7, {(4, 3), (5, 3)}))
        told = self.command("check-tangent", CASE).json()
        self.assertLess(told["tangent_error"], 1e-6)
        self.assertLess(told["asymmetry"], 1e-12)

    def test_a_run_is_resumed_with_its_mesh_alone(self):
        nodes, elements, names = squares(12, 4, {(5, 2)})
        self.mesh(nodes, elements, names)
        whole = self.run_case(CASE, "loading.table=[0,1,2]", name="whole")
        part = self.run_case(CASE, "loading.table=[0,1]", name="part")
        self.mesh(changed(nodes, 20, (nodes[20][0] + 0.1, nodes[20][1])), elements, names)
        ended = self.peristat("resume", part, "--set", "loading.table=[0,1,2]")
        self.assert_code(ended, 2)
        self.mesh(nodes, elements, names)
        self.assert_code(self.peristat("resume", part, "--set", "loading.table=[0,1,2]"), 0)
        with h5py.File(whole / "results.h5") as one, h5py.File(part / "results.h5") as other:
            last = max(one["steps"])
            self.assertEqual(last, max(other["steps"]))
            at_end, resumed = (file[f"steps/{last}/displacement"][...] for file in (one, other))
            np.testing.assert_allclose(resumed, at_end, rtol=1e-9, atol=1e-9 * np.abs(at_end).max())

    # ---- loads on facets ----

    def test_a_traction_acts_on_the_area_of_the_facets(self):
        nodes, elements, names = squares(12, 4)
        self.mesh([(x, 1.5 * y) for x, y in nodes], elements, names)
        for at in ("elements", "nodes"):
            folder = self.run_case(CASE, f'points.at="{at}"')
            reaction = json.loads((folder / "summary.json").read_text())["reactions"]["left"]
            self.assertAlmostEqual(reaction[0], -1e6 * 6.0 * 0.5, delta=1e-3)
        with_side = CASE.replace('set = "right"', 'side = "x+"')
        reaction = json.loads((self.run_case(with_side) / "summary.json").read_text())["reactions"]["left"]
        self.assertAlmostEqual(reaction[0], -1e6 * 6.0 * 0.5, delta=1e-3)

    def test_histories_have_the_displacement_of_a_side(self):
        """That of the points behind its facets: the mean over the elements, or nodes, at the right side."""
        nodes, elements, names = squares(12, 4)
        self.mesh(nodes, elements, names)
        traction, pressure = 'traction = ["1e6*load", 0]', 'pressure = "-1e6*load"'
        for at, load in itertools.product(("elements", "nodes"), (traction, pressure)):
            text = CASE.replace('set = "right"', 'side = "x+"').replace(traction, load)
            folder = self.run_case(text, f'points.at="{at}"')
            with open(folder / "load_displacement.csv", newline="") as table:
                last = list(csv.DictReader(table))[-1]
            with h5py.File(folder / "results.h5") as file:
                x = file["points/reference"][:, 0]
                displacement = file["steps"][max(file["steps"])]["displacement"][:, 0]
            expected = displacement[x > x.max() - 1e-6].mean()
            self.assertGreater(expected, 0.0)
            self.assertAlmostEqual(float(last["displacement_x:x+"]) / expected, 1.0, places=12)
            self.assertEqual("force_x:x+" in last, load == traction)
            if load == traction:
                self.assertAlmostEqual(float(last["force_x:x+"]), 1e6 * 4 * 0.5, delta=1e-3)

    def test_a_pressure_acts_on_a_slanted_facet(self):
        """A side of length l with normal n takes -p l t n: here the right one, slanted by one unit."""
        nodes, elements, names = squares(12, 4)
        self.mesh([(x + 0.25 * y * x / 12, y) for x, y in nodes], elements, names)
        text = CASE.replace('traction = ["1e6*load", 0]', 'pressure = "1e3*load"')
        for at in ("elements", "nodes"):
            folder = self.run_case(text, f'points.at="{at}"')
            reaction = json.loads((folder / "summary.json").read_text())["reactions"]["left"]
            np.testing.assert_allclose(reaction[:2], [1e3 * 4 * 0.5, -1e3 * 1 * 0.5], rtol=1e-5)

    def test_loads_on_facets_of_tetrahedra(self):
        nodes = [(i, j, k) for k in range(4) for j in range(4) for i in range(4)]
        number = {node: k + 1 for k, node in enumerate(nodes)}
        elements = []
        for i, j, k in itertools.product(range(3), repeat=3):  # six from corner to corner of each cube
            for order in itertools.permutations(range(3)):
                way = [(i, j, k)]
                for axis in order:
                    way.append(tuple(x + (c == axis) for c, x in enumerate(way[-1])))
                elements.append((TETRAHEDRON, 1, [number[node] for node in way]))
        self.mesh(nodes, elements, [(3, 1, "cube")])
        text = CASE.replace("dimension = 2", "dimension = 3").replace("thickness = 0.5\n", "").replace("horizon = 3.1", "horizon = 1.5")
        text = text.replace("[0, 0]", "[0, 0, 0]").replace('set = "right"', 'side = "x+"')
        text += '[[set]]\nname = "left"\nwhere = "x < 1"\n'
        for load in ('[1e3, 0, 0]', None):
            changed_load = text.replace('["1e6*load", 0]', load) if load else text.replace('traction = ["1e6*load", 0]', "pressure = 1e3")
            for at in ("elements", "nodes"):
                folder = self.run_case(changed_load, f'points.at="{at}"')
                reaction = json.loads((folder / "summary.json").read_text())["reactions"]["left"]
                expected = [-9e3 if load else 9e3, 0, 0]
                np.testing.assert_allclose(reaction, expected, rtol=1e-5, atol=1e-2)
        self.assertIn("18 faces, 9 m2", self.checked(text.replace('traction = ["1e6*load", 0]', "pressure = 1e3")))

    def test_loads_without_facets_are_refused(self):
        self.mesh(*squares(12, 4))
        for change, words in (("set = \"right\"\ntraction", "no facet"), ("side = \"z+\"\ntraction", "side")):
            middle = '[[set]]\nname = "right2"\nwhere = "abs(x - 6) < 2 and abs(y - 2) < 1"\n'
            text = CASE.replace('set = "right"\ntraction', change.replace('"right"', '"right2"')) + middle
            ended = self.command("check", text.replace(" and ", " && "))
            self.assert_code(ended, 2)
            self.assertIn(words, ended.errors)

    def test_keys_of_meshes_are_for_meshes(self):
        self.write("points.csv", "x, y, volume\n0, 0, 1\n1, 0, 1\n")
        for change in ('points.at="nodes"', "points.cut_bonds=false"):
            ended = self.command("check", CASE.replace("plate.msh", "points.csv"), change)
            self.assert_code(ended, 2)
            self.assertIn("is for a mesh", ended.errors)
        self.mesh(*squares(3, 3))
        ended = self.command("check", CASE, f'points.neighbours="{self.folder}/points.csv"')
        self.assert_code(ended, 2)
        self.assertIn("points.neighbours", ended.errors)

    # ---- pictures ----

    def test_triangles_are_drawn_as_they_are(self):
        nodes, elements, names = squares(6, 4)
        halves = [(TRIANGLE, 3, of[k : k + 3] if k == 0 else (of[0], of[2], of[3]))
                  for kind, _, of in elements if kind == QUADRILATERAL for k in (0, 1)]  # fmt: skip
        self.mesh(nodes, [element for element in elements if element[0] == LINE] + halves, names)
        out = self.run_case(CASE)
        code = (
            "import sys; sys.path.insert(0, sys.argv[1])\n"
            "from peristat.pictures.results_folder import read_results_folder\nfrom peristat.pictures.mesh_cells import element_cells\nfrom pathlib import Path\n"
            "of = read_results_folder(Path(sys.argv[2])); cells = element_cells(of.elements)\n"
            "inner = (cells.beyond >= 0) & cells.is_side\nprint(len(of.volume), inner.sum(), (cells.beyond < 0).sum(), of.missing)\n"
        )
        told = subprocess.run(["/usr/bin/python3", "-BEs", "-c", code, ROOT / "python", out],
                              check=True, capture_output=True, text=True).stdout  # fmt: skip
        # 48 triangles: 144 sides, 20 of them at the rim.
        self.assertEqual(told.split(), ["48", "124", "20", "[]"])


class BrokenMeshes(Folder):
    """Each ends with exit code 2 and words that say what is wrong."""

    def refuses(self, name, text, *words, dimension=2):
        path = self.folder / name
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        case = CASE.replace("plate.msh", name).replace("dimension = 2", f"dimension = {dimension}")
        if dimension == 3:
            case = case.replace("thickness = 0.5\n", "").replace("[0, 0]", "[0, 0, 0]").replace('load", 0]', 'load", 0, 0]')
        ended = self.command("check", case)
        with self.subTest(name=name, words=words):
            self.assert_code(ended, 2)
            self.assertIn("points.file", ended.errors)
            for word in words:
                self.assertIn(word, ended.errors)
            self.assertNotIn("Traceback", ended.said)

    def test_files_that_are_no_meshes(self):
        whole = msh(*squares(4, 4))
        self.refuses("empty.msh", "", "empty")
        self.refuses("cut.msh", whole[: len(whole) // 2], "meshio")
        self.refuses("end.msh", whole.replace("$EndElements", ""), "ends early")
        self.refuses("garbage.msh", bytes(range(256)) * 40, "meshio")
        self.refuses("garbage.vtu", bytes(range(256)) * 40, "meshio")
        self.refuses("garbage.vtk", bytes(range(256)) * 40, "meshio")
        self.refuses("garbage.med", bytes(range(256)) * 40, "meshio")
        self.refuses("garbage.e", bytes(range(256)) * 40, "meshio")
        self.refuses("garbage.inp", bytes(range(256)) * 40)
        self.refuses("type.inp", "*NODE\n1,0,0\n2,1,0\n3,1,1\n*ELEMENT,TYPE=XYZ3\n1,1,2,3\n", "XYZ3")

    def test_meshes_without_elements_of_the_dimension(self):
        nodes, elements, names = squares(4, 4)
        lines = [element for element in elements if element[0] == LINE]
        self.refuses("lines.msh", msh(nodes, lines, names[:2]), "no elements of dimension 2", "8 lines")
        self.refuses("plane.msh", msh(*squares(4, 4)), "no elements of dimension 3", "16 faces", dimension=3)
        solid = [(TETRAHEDRON, 3, (1, 2, 3, 4))]
        self.refuses("solid.msh", msh([(0, 0), (1, 0), (0, 1), (0, 0, 1)], solid, [(3, 3, "body")]), "1 solid element")
        self.refuses("none.msh", msh(nodes, [], []), "element")
        self.refuses("point.msh", msh(nodes, [(15, 1, (1,))], [(0, 1, "corner")]), "1 vertices")

    def test_elements_that_are_wrong(self):
        nodes, elements, names = squares(4, 4)
        first = len(elements) - 16
        twisted = changed(elements, first, (QUADRILATERAL, 3, (2, 1, 7, 6)))
        self.refuses("twisted.msh", msh(nodes, twisted, names), f"element {first + 1} ", "twisted")
        self.refuses("dent.msh", msh(changed(nodes, 6, (0.4, 0.4)), elements, names), "not convex")
        self.refuses("inverted.msh", msh(changed(nodes, 6, (2.5, 2.5)), elements, names), "element")
        folded = [(TRIANGLE, 3, (1, 2, 3)), (TRIANGLE, 3, (2, 1, 4))]
        self.refuses("folded.msh", msh([(0, 0), (1, 0), (0.5, 1), (0.5, 0.5)], folded, names[2:]), "overlap")
        self.refuses("twice.msh", msh(nodes, [*elements, elements[-1]], names), "an element twice")
        flat = [(TRIANGLE, 3, (1, 2, 3)), (TRIANGLE, 3, (1, 2, 4))]
        self.refuses("flat.msh", msh([(0, 0), (1, 0), (0.5, 1), (2, 0)], flat, names[2:]), "no area")
        same = changed(elements, first, (QUADRILATERAL, 3, (1, 2, 2, 6)))
        self.refuses("same.msh", msh(nodes, same, names), "at two corners")
        self.refuses("unknown.msh", msh(nodes, changed(elements, first, (QUADRILATERAL, 3, (1, 2, 99, 6))), names))
        self.refuses("type.msh", msh(nodes, changed(elements, first, (99, 3, (1, 2, 7, 6))), names), "meshio")

    def test_nodes_that_are_wrong(self):
        nodes, elements, names = squares(4, 4)
        self.refuses("far.msh", msh(changed(nodes, 6, (1e300, 1)), elements, names), "node 7 ", "1e+300")
        self.refuses("nan.msh", msh(changed(nodes, 6, ("nan", 1)), elements, names), "node 7 ", "nan")
        self.refuses("bent.msh", msh(changed(nodes, 6, (1, 1, 0.3)), elements, names), "z from 0 to 0.3")
        parted = [(0, 0), (1, 0), (1, 1), (0, 1), (1, 0), (2, 0), (2, 1), (1, 1)]
        both = [(QUADRILATERAL, 3, of) for of in ((1, 2, 3, 4), (5, 6, 7, 8))]
        self.refuses("doubled.msh", msh(parted, both, names[2:]), "position of node")
        hanging = [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1), (1, 0.5), (2, 0.5)]
        halves = [(QUADRILATERAL, 3, of) for of in ((1, 2, 3, 4), (2, 5, 8, 7), (7, 8, 6, 3))]
        self.refuses("hanging.msh", msh(hanging, halves, names[2:]), "without being one of its corners")
        crossing = [(0, 0), (1, 0), (0, 1), (0.3, 0.3), (1.3, 0.3), (0.3, 1.3)]
        self.refuses("crossing.msh", msh(crossing, [(TRIANGLE, 3, (1, 2, 3)), (TRIANGLE, 3, (4, 5, 6))], names[2:]), "cross")

    def test_groups_that_are_wrong(self):
        nodes, elements, names = squares(4, 4)
        self.refuses("unnamed.msh", msh(nodes, elements, names[1:]), "physical group 1", "no name")
        self.refuses("alike.msh", msh(nodes, elements, [(1, 1, "a"), (1, 2, "a"), (2, 3, "plate")]), 'called "a"')
        self.refuses("comma.msh", msh(nodes, elements, [(1, 1, "a,b"), *names[1:]]), '"a,b"')
        head = "*NODE\n1,0,0\n2,1,0\n3,1,1\n"
        element = "*ELEMENT,TYPE=CPS3\n1,1,2,3\n"
        self.refuses("nodes.inp", head + "*NODE\n4,0,1\n" + element, "two *NODE tables")
        self.refuses("sets.inp", head + element + "*ELSET,ELSET=A\n1\n*ELSET,ELSET=A\n1\n", "two *ELSET tables")
        self.refuses("include.inp", head + element + "*INCLUDE, INPUT=other.inp\n", "*INCLUDE")


if __name__ == "__main__":
    unittest.main()
