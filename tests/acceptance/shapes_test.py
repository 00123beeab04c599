"""Ellipses, and shapes from files: outlines, images and closed surfaces."""

import itertools
import json
import math
import re
import struct
import unittest
import zlib

import h5py
import numpy
from PIL import Image

from tests.acceptance.folder import Folder
from tests.acceptance.surfaces import ascii_text, binary, sphere, volume_of
from tests.reference.results import table

PLATE = """\
dimension = 2
[lattice]
spacing = 0.1
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [3, 2]
SHAPE
[material]
youngs_modulus = 1e9
[[set]]
name = "left"
where = "x < 0.2"
[[support]]
set = "left"
displacement = [0, 0]
"""
BODY = """\
dimension = 3
[lattice]
spacing = 0.1
[[lattice.shape]]
add = "stl"
file = "FILE"
[material]
youngs_modulus = 1e9
[[set]]
name = "held"
where = "z < 0"
[[support]]
set = "held"
displacement = [0, 0, 0]
"""
ELLIPSE = """\
[[lattice.shape]]
subtract = "ellipse"
centre = [1.5, 1]
radii = [0.75, 0.3]
angle = 30
"""
SQUARE = "0.5 0.5\n1.5 0.5\n1.5 1.5\n0.5 1.5\n"
OUTLINE = '[[lattice.shape]]\nsubtract = "polygon"\nfile = "outline.csv"\n'
PHASE = '[[set]]\nname = "NAME"\nshape = { image = { file = "FILE", min = [0, 0], max = [3, 2], grey = GREY } }\n'


class Shapes(Folder):
    def points(self, text, *settings, name="out"):
        folder = self.run_case(text, *settings, name=name, words=("--no-plots",))
        with h5py.File(folder / "results.h5") as file:
            self.resolved = file["case/as_resolved"][()].decode()
            self.sets = {key: int(value[:].sum()) for key, value in file["points/sets"].items()}
            return file["points/reference"][:], file["points/volume"][:]

    def count(self, text, *settings):
        ended = self.command("check", text, *settings)
        self.assertEqual(ended.code, 0, ended.errors)
        return int(re.search(r"^points +(\d+) in", ended.output, re.MULTILINE)[1])

    def refused(self, text, *words, command="check", settings=(), code=2):
        ended = self.command(command, text, *settings)
        self.assertEqual(ended.code, code, ended.errors)
        for word in words:
            self.assertIn(word, ended.errors)

    def picture(self, name, pixels, **options):
        Image.fromarray(numpy.asarray(pixels)).save(self.folder / name, **options)


class Ellipses(Shapes):
    def test_it_is_taken_away(self):
        text = PLATE.replace("SHAPE", ELLIPSE)
        at, volume = self.points(text)
        c, s = math.cos(math.pi / 6), math.sin(math.pi / 6)
        x, y = c * (at[:, 0] - 1.5) + s * (at[:, 1] - 1), c * (at[:, 1] - 1) - s * (at[:, 0] - 1.5)
        self.assertGreater(numpy.min((x / 0.75) ** 2 + (y / 0.3) ** 2), 1)
        self.assertIn("radii = [0.75, 0.3]\nangle = 30.0", self.resolved)
        missing = 6 - self.points(text, 'lattice.volumes="fractional"', name="cut")[1].sum()
        self.assertAlmostEqual(missing, math.pi * 0.75 * 0.3, delta=1e-5)
        self.assertAlmostEqual(6 - volume.sum(), math.pi * 0.75 * 0.3, delta=0.05)

    def test_it_cuts_bonds(self):
        slit = PLATE.replace("SHAPE", ELLIPSE.replace("[0.75, 0.3]", "[0.75, 0.12]").replace("30", "90") + "KEY\n")
        cut = self.command("check", slit.replace("KEY", "cuts_bonds = true"))
        self.assertEqual(cut.code, 0, cut.errors)
        bridged = self.command("check", slit.replace("KEY", ""))
        self.assertIn("bridge", bridged.output)
        self.assertNotIn("bridge", cut.output)
        self.assertIn("opening     lattice.shape[1], 0.24 m", bridged.output)

    def test_a_pressure_on_its_name_acts_on_its_length(self):
        text = PLATE.replace("SHAPE", ELLIPSE + 'name = "hole"\n').replace(
            "[material]", '[material]\nmodel = "lps"\npoisson_ratio = 0.3')
        text += '[[load]]\nboundary = "hole"\npressure = "1e3*load"\n[[probe]]\nname="all"\nset="left"\nfield="displacement"\n'
        self.run_case(text, "lattice.horizon_ratio=3.5", "lattice.spacing=0.05", "solver.linear='lu'", words=("--no-plots",))
        row = table(self.folder / "out/history.csv")[-1]
        # A closed boundary has no resultant.
        self.assertLess(abs(float(row["reaction_x:left"])), 20)

    def test_what_is_none_is_refused(self):
        for change, words in {
            "[0.75, 0.3]": (),
            "[0.75, 0]": ("radii", "must be positive"),
            "[0.75, -1]": ("radii", "must be positive"),
            "[0.75]": ("radii",),
            "0.75": ("radii",),
            "[0.75, 1e-9]": ("radii", "a millionth of the other"),
        }.items():
            text = PLATE.replace("SHAPE", ELLIPSE.replace("[0.75, 0.3]", change))
            self.refused(text, *words, code=2 if words else 0)
        self.refused(PLATE.replace("SHAPE", ELLIPSE.replace("angle", "axis")), "axis", "is not a key of the shape ellipse")
        self.refused(PLATE.replace("SHAPE", ELLIPSE.replace("1.5, 1]", "9, 1]")), "has no effect")
        self.refused(BODY.replace('"stl"\nfile = "FILE"', '"ellipse"\ncentre=[0,0,0]\nradii=[1,1,1]'),
                     "there is no ellipse in dimension 3")  # fmt: skip


class Outlines(Shapes):
    def test_a_file_is_the_same_as_its_corners(self):
        self.write("outline.csv", "# a square\nx, y\n" + SQUARE.replace(" ", ", ") + "0.5, 0.5\n")
        at, volume = self.points(PLATE.replace("SHAPE", OUTLINE))
        self.assertIn(f'file = "{self.folder}/outline.csv"', self.resolved)
        typed = OUTLINE.replace('file = "outline.csv"', "vertices = [[0.5, 0.5], [1.5, 0.5], [1.5, 1.5], [0.5, 1.5]]")
        other, _ = self.points(PLATE.replace("SHAPE", typed), name="typed")
        numpy.testing.assert_array_equal(at, other)
        self.assertLess(len(at), 520)

    def test_what_is_none_is_refused(self):
        text = PLATE.replace("SHAPE", OUTLINE)
        self.refused(text, "file", "no such file")
        for content, words in {
            "0 0\n1 0\n": ("outline.csv", "at least three corners"),
            "": ("at least three corners",),
            "0 0\n1 0\n2 0\n": ("enclose an area",),
            "0 0\n1 zero\n1 1\n": ("outline.csv:2", "y = 'zero' is not a number"),
            "0 0\n1 0 0\n1 1\n": ("outline.csv:2", "two numbers"),
            "0 0\n1 0\n1 1\n0 0\n2 2\n": ("outline.csv:5", "one polygon"),
        }.items():
            self.write("outline.csv", content)
            self.refused(text, *words)
        self.write("outline.csv", SQUARE)
        self.refused(text.replace("file =", "vertices = [[0,0],[1,0],[0,1]]\nfile ="), "vertices", "file")
        self.refused(text.replace('file = "outline.csv"', ""), "vertices", "file")

    def test_a_changed_file_is_noticed(self):
        self.write("outline.csv", SQUARE)
        text = PLATE.replace("SHAPE", OUTLINE) + '[[load]]\nset = "left"\nbody_force = [0, "load"]\n[loading]\nsteps = 3\n'
        self.run_case(text, words=("--no-plots", "--stop-after", "1"), code=(0, 130))
        # The same points: only bonds that pass the corners would be others.
        self.write("outline.csv", SQUARE.replace("1.5", "1.501"))
        ended = self.peristat("resume", self.folder / "out")
        self.assertEqual(ended.code, 2, ended.errors)
        self.assertIn("outline.csv: has changed since the run began", ended.errors)
        self.write("outline.csv", SQUARE)
        self.assertEqual(self.peristat("resume", self.folder / "out").code, 0)


class Images(Shapes):
    #  3 x 2 pixels of 1 m; the first row is on top.
    GREY = numpy.array([[0, 100, 255], [100, 255, 100]], numpy.uint8)

    def phases(self, file, *greys):
        text = PLATE.replace("SHAPE", "") + "".join(
            PHASE.replace("NAME", f"phase{k}").replace("FILE", file).replace("GREY", str(grey))
            for k, grey in enumerate(greys))  # fmt: skip
        at, _ = self.points(text)
        return at, [self.sets[f"phase{k}"] for k in range(len(greys))]

    def test_phases_of_all_kinds_of_files(self):
        grey = self.GREY
        self.picture("grey.png", grey)
        self.picture("grey.tif", grey)
        self.picture("packed.tif", grey, compression="tiff_lzw")
        colour = numpy.stack([grey] * 3, axis=-1)
        self.picture("colour.png", colour)
        self.picture("colour.tif", colour)
        self.picture("opaque.png", numpy.concatenate([colour, numpy.full((2, 3, 1), 255, numpy.uint8)], axis=-1))
        Image.fromarray(grey).convert("P").save(self.folder / "palette.png")
        for file in ("grey.png", "grey.tif", "packed.tif", "colour.png", "colour.tif", "opaque.png", "palette.png"):
            with self.subTest(file):
                _, counts = self.phases(file, [0, 50], [51, 200], [201, 255])
                self.assertEqual(counts, [100, 300, 200])
        self.picture("deep.png", 257 * grey.astype(numpy.uint16))
        self.picture("deep.tif", 257 * grey.astype(numpy.uint16))
        self.picture("real.tif", grey.astype(numpy.float32) / 255)
        self.assertEqual(self.phases("deep.png", [0, 5000], [25700, 25700], [65535, 65535])[1], [100, 300, 200])
        self.assertEqual(self.phases("deep.tif", [0, 5000], [25700, 25700], [65535, 65535])[1], [100, 300, 200])
        self.assertEqual(self.phases("real.tif", [0, 0.1], [0.2, 0.5], [1, 1])[1], [100, 300, 200])
        Image.fromarray(grey > 50).save(self.folder / "two.png")
        self.assertEqual(self.phases("two.png", [0, 0], [255, 255])[1], [100, 500])
        self.picture("luminance.png", numpy.array([[[255, 0, 0], [0, 255, 0], [0, 0, 255]]] * 2, numpy.uint8))
        self.assertEqual(self.phases("luminance.png", [76, 76], [150, 150], [29, 29])[1], [200, 200, 200])

    def test_row_0_is_on_top(self):
        self.picture("grey.png", self.GREY)
        text = PLATE.replace("SHAPE", '[[lattice.shape]]\nsubtract = "image"\nfile = "grey.png"\nmin = [0, 0]\nmax = [3, 2]\ngrey = [0, 50]')
        text = text.replace("x < 0.2", "x > 2.8")
        at, _ = self.points(text)
        self.assertEqual(len(at), 500)
        self.assertFalse(((at[:, 0] < 1) & (at[:, 1] > 1)).any())
        self.assertEqual(self.points(text, 'lattice.volumes="fractional"', "lattice.spacing=0.13", name="cut")[1].sum().round(9), 5)

    def test_finer_and_coarser_pixels(self):
        fine = numpy.kron(self.GREY, numpy.ones((70, 70), numpy.uint8))
        self.picture("fine.png", fine)
        self.assertEqual(self.phases("fine.png", [0, 50], [51, 200], [201, 255])[1], [100, 300, 200])

    def test_what_is_none_is_refused(self):
        text = PLATE.replace("SHAPE", "") + PHASE.replace("NAME", "phase").replace("FILE", "it.png")
        wanted = text.replace("GREY", "[0, 50]")
        self.refused(wanted, "file", "no such file")
        self.write("it.png", "no image at all\n" * 100)
        self.refused(wanted, "file", "neither PNG nor TIFF")
        self.write("it.png", "")
        self.refused(wanted, "file", "neither PNG nor TIFF")
        self.picture("it.png", numpy.kron(self.GREY, numpy.random.default_rng(1).integers(0, 2, (90, 90), numpy.uint8)))
        content = (self.folder / "it.png").read_bytes()
        (self.folder / "it.png").write_bytes(content[: len(content) // 2])
        self.refused(wanted, "file", "can't be read: Truncated")
        self.picture("it.jpg", self.GREY)
        self.refused(wanted.replace("it.png", "it.jpg"), "neither PNG nor TIFF")
        clear = numpy.stack([self.GREY] * 4, axis=-1)
        self.picture("it.png", clear)
        self.refused(wanted, "transparent")
        pages = [Image.fromarray(self.GREY)] * 2
        pages[0].save(self.folder / "it.tif", save_all=True, append_images=pages[1:])
        self.refused(wanted.replace("it.png", "it.tif"), "2 pictures")
        self.picture("it.png", self.GREY)
        self.refused(text.replace("GREY", "[10, 20]"), "grey", "from 0 to 255")
        self.refused(text.replace("GREY", "[20, 10]"), "grey", "below the first")
        self.refused(text.replace("GREY", "[20]"), "grey")
        self.refused(wanted.replace("max = [3, 2], grey", "max = [3, 0], grey"), "max", "larger than min")
        cut = PLATE.replace("SHAPE", '[[lattice.shape]]\nsubtract = "image"\nfile = "it.png"\nmin = [0, 0]\nmax = [3, 2]\ngrey = [0, 50]')
        self.refused(cut, "angle must be 0", settings=('lattice.volumes="fractional"', "lattice.angle=10"))
        self.refused(cut, "blue noise", settings=('lattice.points="blue_noise"',))
        self.refused(cut, "faces", settings=('material.model="lps"', "material.poisson_ratio=0.3", "lattice.horizon_ratio=3.5"))

    def test_16_bits_per_colour_are_refused(self):
        # Pillow reads such files, with 8 of the bits.
        def chunk(kind, data):
                return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        row = b"\0" + struct.pack(">9H", *range(0, 9000, 1000))
        png = (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", 3, 2, 16, 2, 0, 0, 0))
               + chunk(b"IDAT", zlib.compress(row * 2)) + chunk(b"IEND", b""))  # fmt: skip
        (self.folder / "it.png").write_bytes(png)
        text = PLATE.replace("SHAPE", "") + PHASE.replace("NAME", "phase").replace("FILE", "it.png").replace("GREY", "[0, 50]")
        self.refused(text, "16 bits per colour")


class Surfaces(Shapes):
    def test_a_sphere_has_its_volume_in_both_formats(self):
        triangles = list(sphere())
        exact = volume_of(triangles)
        (self.folder / "it.stl").write_bytes(binary(triangles))
        fine = "lattice.spacing=0.025", "lattice.horizon_ratio=1.5"
        count = self.count(BODY.replace("FILE", "it.stl"), *fine)
        self.assertLess(abs(count * 0.025**3 / exact - 1), 5e-3)  # stairs
        self.write("it.stl", ascii_text(triangles))
        self.assertEqual(self.count(BODY.replace("FILE", "it.stl"), *fine), count)
        at, _ = self.points(BODY.replace("FILE", "it.stl"))
        self.assertLessEqual(numpy.linalg.norm(at, axis=1).max(), 0.5)
        self.assertIn(f'file = "{self.folder}/it.stl"', self.resolved)

    def test_scale_and_translate(self):
        self.write("it.stl", ascii_text(sphere(500.0, 20)))
        text = BODY.replace('"FILE"', '"it.stl"\nscale = 1e-3\ntranslate = [1, 2, 0]')
        at, volume = self.points(text)
        numpy.testing.assert_allclose(at.mean(axis=0), [1, 2, 0], atol=0.02)
        self.assertLess(numpy.ptp(at, axis=0).max(), 1)

    def test_it_may_be_taken_away_and_cut_bonds(self):
        self.write("it.stl", ascii_text(sphere(0.3, 20)))
        text = BODY.replace('add = "stl"\nfile = "FILE"', 'add = "box"\nmin = [-0.5, -0.5, -0.5]\nmax = [0.5, 0.5, 0.5]\n'
                            '[[lattice.shape]]\nsubtract = "stl"\nfile = "it.stl"\ncuts_bonds = true')  # fmt: skip
        at, volume = self.points(text)
        self.assertGreater(numpy.linalg.norm(at, axis=1).min(), 0.29)
        self.assertLess(len(at), 1000)
        # The same by a sphere, but for bonds that pass between a facet and the sphere.
        ball = text.replace('"stl"\nfile = "it.stl"', '"sphere"\ncentre = [0, 0, 0]\nradius = 0.3')
        bonds = [json.loads((self.run_case(case, name=name, words=("--no-plots",)) / "summary.json").read_text())["bonds"]
                 for case, name in ((text, "a"), (ball, "b"))]  # fmt: skip
        self.assertLess(abs(bonds[0] / bonds[1] - 1), 2e-3)
        uncut = json.loads((self.run_case(text.replace("true", "false"), name="c", words=("--no-plots",)) / "summary.json").read_text())["bonds"]
        self.assertGreater(uncut, bonds[0] + 10)

    def test_a_set(self):
        self.write("it.stl", ascii_text(sphere(0.3, 20)))
        text = BODY.replace('add = "stl"\nfile = "FILE"', 'add = "box"\nmin = [-0.5, -0.5, -0.5]\nmax = [0.5, 0.5, 0.5]')
        self.points(text + '[[set]]\nname = "core"\nshape = { stl = { file = "it.stl" } }\n')
        at = numpy.arange(-0.45, 0.5, 0.1)
        inside = sum(x * x + y * y + z * z < 0.297**2 for x, y, z in itertools.product(at, at, at))
        self.assertEqual(self.sets["core"], inside)

    def test_what_is_none_is_refused(self):
        text = BODY.replace("FILE", "it.stl")
        triangles = list(sphere(0.5, 8))
        self.refused(text, "file", "no such file")
        for content, words in {
            ascii_text(triangles[3:]).encode(): ("not closed", "edges do not belong to two triangles"),
            binary(triangles[:-1]): ("not closed", "3 edges", "belongs to 1"),
            ascii_text(triangles).encode()[:-3000]: ("no complete STL file",),
            binary(triangles)[:-30]: ("no complete STL file",),
            b"": ("no triangles",),
            b"solid nothing\nendsolid nothing\n": ("no triangles",),
            b"garbage " * 200: ("no complete STL file",),
            binary([]): ("no triangles",),
            ascii_text(triangles + [[v + 0.3 for v in triangle] for triangle in triangles]).encode(): ("crosses or touches itself",),
            ascii_text((0 * a, 0 * b, 0 * c) for a, b, c in triangles).encode(): ("no triangles",),
            ascii_text(triangles).replace("vertex 0", "vertex nan", 1).encode(): ("no complete STL file",),
        }.items():  # fmt: skip
            (self.folder / "it.stl").write_bytes(content)
            with self.subTest(words):
                self.refused(text, "file", *words)
        (self.folder / "it.stl").write_bytes(binary(triangles))
        self.refused(text, "not measured", settings=('lattice.volumes="fractional"',))
        self.refused(text, "blue noise", settings=('lattice.points="blue_noise"',))
        self.refused(text, "faces", settings=('material.model="lps"', "material.poisson_ratio=0.3", "lattice.horizon_ratio=2.5"))
        self.refused(text.replace('"it.stl"', '"it.stl"\nscale = 0'), "scale")
        self.refused(text.replace("dimension = 3", "dimension = 2"), "there is no stl in dimension 2")

    def test_results_do_not_replace_it(self):
        self.folder.joinpath("out").mkdir()
        (self.folder / "out/summary.json").write_bytes(binary(list(sphere(0.5, 8))))
        self.refused(BODY.replace("FILE", "out/summary.json"), "summary.json", command="run", settings=('output.directory="out"',))


if __name__ == "__main__":
    unittest.main()
