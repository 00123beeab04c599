"""Numbers in the headers of cases whose shapes are ellipses and images."""

import tempfile

import numpy
from PIL import Image

from tests.printed.comparison import PrintedTest
from tests.printed.runs import run
from tests.reference.program import ROOT
from tests.reference.results import table

A, B = 8e-3, 4e-3  # radii of the hole across the load and along it [m]


def inglis(x):
    """Stress along the load on the ligament over that far away: Muskhelishvili's potentials of the map
    z = R (zeta + m / zeta), whose derivatives are differences."""
    size, m, turn = (A + B) / 2, (A - B) / (A + B), -1.0  # turn: exp(2i 90 degrees)
    z, h = numpy.asarray(x, complex), 1e-4 * A
    zeta = lambda z: z / (2 * size) + numpy.sqrt((z / (2 * size)) ** 2 - m)
    phi = lambda z: size / 4 * (zeta(z) + (2 * turn - m) / zeta(z))
    psi = lambda z: -size / 2 * (turn * zeta(z) + turn / (m * zeta(z))
                                 - (1 + m * m) * (turn - m) / m * zeta(z) / (zeta(z) ** 2 - m))  # fmt: skip
    first = lambda f: (f(z + h) - f(z - h)) / (2 * h)
    second = lambda f: (f(z + h) - 2 * f(z) + f(z - h)) / h**2
    return (2 * first(phi) + numpy.conj(z) * second(phi) + first(psi)).real


class Shapes(PrintedTest):
    def test_the_reference_is_that_of_an_ellipse(self):
        self.assertAlmostEqual(inglis(A + 1e-6), 1 + 2 * A / B, delta=0.01)
        self.assertAlmostEqual(inglis(100 * A), 1, delta=2e-4)

    def test_ellipse(self):
        self.page = "cases/plate_with_hole/ellipse.toml"
        points, factors = [], []
        for spacing in (1e-3, 5e-4, 2.5e-4):
            plate = run("plate_with_hole/ellipse", f"lattice.spacing={spacing}",
                        f"probe[0].from=[{A}, {spacing / 2}]", f"probe[0].to=[0.08, {spacing / 2}]")  # fmt: skip
            rows = [row for row in table(plate.folder / "line_ligament.csv") if abs(row["y"] - spacing / 2) < 0.1 * spacing]
            x, stress = (numpy.array([row[name] for row in rows]) for name in ("x", "stress_yy"))
            start = A + 3.015 * spacing
            near = (x > start) & (x < start + A / 2)
            points.append(plate.summary["points"])
            factors.append(numpy.mean(stress[near] / 1e6 / inglis(x[near])))
        self.prints("points {} {} {}", *points)
        self.prints("factor {} {} {}", *factors)
        self.prints("stress concentration {} {} {}", *(5 * factor for factor in factors))
        self.prints("the stress is {} MPa", stress[len(stress) // 2] / 1e6)

    def test_aggregates(self):
        self.page = "cases/regions/aggregates.toml"
        plate, finer = run("regions/aggregates"), run("regions/aggregates", "lattice.spacing=2.5e-4")
        aggregates = int(plate.points("sets/aggregates").sum())
        layers = int(plate.points("sets/bottom").sum() + plate.points("sets/top").sum())
        removed = 100**2 - (plate.summary["points"] - layers)
        self.prints("{} points with the layers: {} of aggregates, {} %", plate.summary["points"], aggregates, aggregates / 100)
        self.prints("and {} less by pores, {} %", removed, removed / 100)
        forces = [one.reaction("top", "y") for one in (plate, finer)]
        self.prints('reaction on "top" {} N, with lattice.spacing=2.5e-4 {} N', *forces)
        modulus = [1e-9 * force / 5e-5 * length / 5e-6 for force, length in zip(forces, (0.0505, 0.05025))]
        self.prints("a modulus of {} GPa ({} GPa)", *modulus)
        self.prints("is {} GPa.", 0.6 * aggregates / 100 + 0.25 * (100 - (aggregates + removed) / 100))

    def test_the_image_is_that_of_its_script(self):
        script = ROOT / "cases/regions/aggregates.py"
        shipped = numpy.asarray(Image.open(script.with_suffix(".png")))
        copy = self.enterContext(tempfile.TemporaryDirectory()) + "/aggregates.py"
        exec(compile(script.read_text(), copy, "exec"), {"__file__": copy})
        numpy.testing.assert_array_equal(numpy.asarray(Image.open(copy.replace(".py", ".png"))), shipped)
        pixels = [numpy.mean(shipped > 200), numpy.mean(shipped < 50)]
        self.page = "cases/regions/aggregates.toml"
        self.assertAlmostEqual(pixels[0], 0.582, delta=5e-4)  # "58.2 % of the square and of the pixels"
        self.prints("% ({} % of the pixels)", 100 * pixels[1])
