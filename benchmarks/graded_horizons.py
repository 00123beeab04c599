"""Patch tests of a mesh with 4 : 1 graded elements: a horizon per point beside one horizon for all.

A quarter of a ring has quadrilaterals whose sizes grow fourfold from its inner to its outer edge, with regular
corners or with corners shifted at random by a fifth of a size. Its points, one per quadrilateral, are held over
two horizons below the edges at the displacements of a uniform strain. The table has the largest errors of energy
density, stress and displacement at the points that are free, and deeper than two of the largest horizons.

The last lines have the fracture energy of a crack along a jump of sizes, by integrals over the points' horizons.

    /usr/bin/python3 benchmarks/graded_horizons.py
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import h5py
import numpy

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/peristat"
sys.path.insert(0, str(ROOT))

from tests.reference.graded import GradedRing, errors, patch_test  # noqa: E402

CORRECTIONS = {"none": "", "linear": 'volume_correction = "linear"',
               "linear, energy": 'volume_correction = "linear"\nsurface_correction = "energy"'}  # fmt: skip


def measure(ring, horizon, quadrature, held, inside, folder):
    """Errors and number of bonds."""
    ring.write(folder / "points.csv", held)
    (folder / "case.toml").write_text(patch_test("points.csv", horizon, quadrature))
    subprocess.run([PROGRAM, "run", folder / "case.toml", "--quiet", "--output", folder / "out", "--overwrite"],
                   check=True, stdout=subprocess.DEVNULL)  # fmt: skip
    with h5py.File(folder / "out/results.h5") as file:
        found = errors(file, ring, inside)
    return found, json.loads((folder / "out/summary.json").read_text())["bonds"]


def beside_a_jump(sizes):
    """Least and largest energy over G of a crack along a jump of sizes, over all distances; in 2D.

    A point at a distance z from a crack holds in its bonds across it the integral over r from z to the horizon of
    r^2 2 arccos(z/r)."""
    place = numpy.linspace(-1, 1, 2001)
    radius = [numpy.linspace(abs(z), 1, 1001) for z in place]
    density = numpy.array([numpy.trapz(r**2 * numpy.arccos(numpy.minimum(abs(z) / numpy.maximum(r, 1e-300), 1)), r)
                           for z, r in zip(place, radius)])  # fmt: skip
    up_to = numpy.concatenate([[0], numpy.cumsum((density[1:] + density[:-1]) / 2)])
    share = lambda z: numpy.interp(z, place, up_to / up_to[-1])
    distance = numpy.linspace(-sizes, sizes, 4001)  # in horizons of the fine side
    taken = share(distance) + 1 - share(distance / sizes)
    return taken.min(), taken.max()


def main():
    if len(sys.argv) != 1:
        sys.exit(__doc__)
    print("| corners | elements along the arc | ratio | horizon | corrections | bonds | energy density | mean | stress | displacement |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for shift, along, ratio in ((0.0, 48, 3.015), (0.0, 48, 4.015), (0.0, 72, 4.015), (0.2, 48, 4.015)):
            ring = GradedRing(along, shift=shift)
            sizes, largest, mean = ring.sizes, ring.sizes.max(), ring.areas.mean() ** 0.5
            inside = ring.depth() >= 2 * ratio * largest + sizes
            horizons = {"per point": (f"{{ ratio = {ratio} }}", ratio * sizes),
                        "of the mean size": (ratio * mean, ratio * mean + 0 * sizes),
                        "of the largest size": (ratio * largest, ratio * largest + 0 * sizes)}  # fmt: skip
            for words, (horizon, of_points) in horizons.items():
                held = ring.depth() < 2 * of_points + sizes
                for correction, quadrature in CORRECTIONS.items():
                    found, bonds = measure(ring, horizon, quadrature, held, inside, pathlib.Path(name))
                    energy, stress, displacement, middle = (f"{100 * value:.2f} %" for value in found)
                    print(f"| {'shifted' if shift else 'regular'} | {along} | {ratio} | {words} | {correction} | {bonds} | "
                          f"{energy} | {middle} | {stress} | {displacement} |", flush=True)  # fmt: skip
    print("\n| jump of sizes | least energy over G | largest |\n|---|---|---|")
    for sizes in (1.1, 1.5, 2.0, 4.0):
        print("| {} : 1 | {:.3f} | {:.3f} |".format(sizes, *beside_a_jump(sizes)))


if __name__ == "__main__":
    main()
