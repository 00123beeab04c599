"""Elasticity and fracture energy of blue noise, even and with a region four times as fine:

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 benchmarks/refined_points.py [--cost | --crack]

A square of 40 x 40 coarse spacings, or a cube of 20 x 20 x 20. *Energy* is that of a uniaxial stress, given to the rim by displacements, over the
exact one; *displacement* the largest error over the strain times half the width; *tear* the energy that halves of the
body dissipate as they move apart, over that of the fracture energy. Means over three seeds, ± standard deviation.
With --cost: seconds of even blue noise beside a lattice. With --crack: the field of a crack tip moves steadily through a
strip (surfing) from even points into a region twice as fine, and the crack follows. Over windows of the field's way, in
coarse horizons from the change of the spacing: *J* by a ring of even points about the whole way, *dissipated* the energy
that bonds dissipate and *released* what is no longer stored, both per area of the field's advance; all over G_c.
"""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / "cases/runner/trust"), str(ROOT / "cases/runner/sweep")]

from specimen import Lattice, rows  # noqa: E402
from strip import Strip  # noqa: E402

PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
E, FRACTURE_ENERGY, HALF, THICKNESS, STRAIN = 70e9, 10.0, 0.04, 1e-3, 1e-4
SEEDS = (1, 2, 3)


@dataclass(frozen=True)
class Body:
    """The square, or a cube of half its width, of one material."""

    name: str
    corrections: str
    model: str = ""
    poisson_ratio: float = 1 / 3
    dimension: int = 2

    @property
    def half(self) -> float:
        return HALF if self.dimension == 2 else HALF / 2

    @property
    def depth(self) -> float:
        return THICKNESS if self.dimension == 2 else 2 * self.half

    def region(self, growth: float) -> str:
        shape = "disk" if self.dimension == 2 else "sphere"
        finer = f'shape = "{shape}", centre = {[0] * self.dimension}, radius = {self.half / 4}, spacing = {1e-3 / (4 - self.dimension)}'
        return f"refine = [{{ {finer}, growth = {growth} }}]" if growth else ""

    def text(self, growth: float, seed: int) -> str:
        corner = [self.half] * self.dimension
        return f"""\
dimension = {self.dimension}
[lattice]
points = "blue_noise"
seed = {seed}
spacing = 2e-3
horizon_ratio = 3.015
{f"thickness = {THICKNESS}" if self.dimension == 2 else ""}
shape = [{{ add = "box", min = {[-edge for edge in corner]}, max = {corner} }}]
{self.region(growth)}
[quadrature]
{self.corrections}
[material]
youngs_modulus = {E}
{self.model}
"""

    def patch(self) -> str:
        across = [f"{-self.poisson_ratio * STRAIN}*load*{axis}" for axis in "yz"[: self.dimension - 1]]
        farthest = "max(abs(x), abs(y))" if self.dimension == 2 else "max(abs(x), max(abs(y), abs(z)))"
        return f"""\
[[set]]
name = "rim"
where = "{farthest} > {self.half} - 0.012"
[[support]]
set = "rim"
displacement = {[f"{STRAIN}*load*x", *across]}
"""

    def tear(self) -> str:
        return TEAR.format(up=["0", f"{10 * HALF}*load", "0"][: self.dimension], still=["0"] * self.dimension)


TEAR = """\
[material.damage]
law = "linear"
fracture_energy = 10
[[set]]
name = "above"
where = "y > 0"
[[set]]
name = "below"
where = "y < 0"
[[support]]
set = "above"
displacement = {up}
[[support]]
set = "below"
displacement = {still}
[solver]
mode = "relaxation"
[relaxation]
steps = 1
"""


def run(text: str, folder: Path) -> Path:
    case = folder / "case.toml"
    case.write_text(text)
    subprocess.run([PROGRAM, "run", case, "--output", folder / "out", "--overwrite", "--quiet", "--no-plots"], check=True)
    return folder / "out"


def energy(out: Path, name: str) -> float:
    return json.loads((out / "summary.json").read_text())["energy"][name]


def measured(body: Body, growth: float, seed: int, folder: Path) -> tuple[float, float, float, float]:
    """Points, energy, largest error of displacements, and tear."""
    out = run(body.text(growth, seed) + body.patch(), folder)
    with h5py.File(out / "results.h5") as file:
        places, moved = file["points/reference"][()], file["steps/000001/displacement"][()]
    exact = places * STRAIN * [1, *[-body.poisson_ratio] * (body.dimension - 1)]
    area = 2 * body.half * body.depth
    stored = energy(out, "stored") / (0.5 * E * STRAIN**2 * 2 * body.half * area)
    torn = energy(run(body.text(growth, seed) + body.tear(), folder), "dissipated") / (FRACTURE_ENERGY * area)
    return len(places), stored, abs(moved - exact).max() / (STRAIN * body.half), torn


def cost() -> None:
    """Four elastic steps of 200 x 200 points, in turns; the least of three."""
    corrected = 'volume_correction = "linear"\nsurface_correction = "energy"\n'
    body = Body("", corrected)
    noise = (body.text(0, 1) + body.patch() + "[loading]\nsteps = 4\n").replace("spacing = 2e-3", "spacing = 0.4e-3").replace("0.012", "0.0025")
    texts = {"lattice": noise.replace('points = "blue_noise"\nseed = 1\n', ""), "blue noise": noise}
    found: dict[str, list[dict[str, float]]] = {name: [] for name in texts}
    for _ in range(3):
        for name, text in texts.items():
            with tempfile.TemporaryDirectory() as folder:
                summary = json.loads((run(text, Path(folder)) / "summary.json").read_text())
            found[name].append(summary["seconds"] | {"bonds": summary["bonds"], "iterations": summary["linear_iterations"]})
    print("| points | bonds | linear iterations | linear solutions [s] | whole run [s] |\n|---|---|---|---|---|")
    for name, of in found.items():
        least = {key: min(one[key] for one in of) for key in of[0]}
        print(f"| {name} | {least['bonds']} | {least['iterations']} | {least['linear']:.2f} | {least['total']:.2f} |")


STRIP = Strip(half_height=12.0, half_length=17.0, way=12.0, inner=9.0, outer=10.5)
WINDOWS = {"even": (-4.0, -2.0), "change": (-2.0, 2.0), "fine": (2.0, 5.5), "whole": (-4.0, 5.5)}  # coarse horizons


def strip_text(seed: int, finer: bool) -> str:
    """The strip of blue noise; its finer part reaches as far as the field does, and 2.5 horizons to both sides."""
    spacing, ratio = 1e-3, 3.015
    unit = spacing * ratio
    region = f'shape = "box", min = [0.0, {-2.5 * unit}], max = [{6.5 * unit}, {2.5 * unit}], spacing = {spacing / 2}'
    points = f'points = "blue_noise"\nseed = {seed}\n' + (f"refine = [{{ {region} }}]\n" if finer else "")
    text = STRIP.text(Lattice(ratio=ratio), spacing).replace("angle = 0.0\n", points)
    return text.replace("steps = 40\n", "steps = 48\n")


def over_way(history: list[dict], window: tuple[float, float]) -> tuple[float, float, float]:
    """J, dissipated and released energy per area of the advance, over the fracture energy."""
    place = [STRIP.way * (row["load_factor"] - 0.5) for row in history]
    first, last = (min(range(len(place)), key=lambda k: abs(place[k] - end)) for end in window)
    area = (place[last] - place[first]) * 3.015e-3 * THICKNESS * FRACTURE_ENERGY
    gained = lambda name: history[last][name] - history[first][name]
    dissipated = gained("dissipated_energy")
    j = statistics.fmean(row["tip_J"] for row in history[first + 1 : last + 1]) / FRACTURE_ENERGY
    return j, dissipated / area, (dissipated + gained("drained_energy")) / area


def crack() -> None:
    print("| points | seed | window | J | dissipated | released |\n|---|---|---|---|---|---|")
    for seed in SEEDS:
        for finer in (True, False):
            with tempfile.TemporaryDirectory() as folder:
                history = rows(run(strip_text(seed, finer), Path(folder)))
            for name, window in WINDOWS.items():
                values = " | ".join(f"{value:.3f}" for value in over_way(history, window))
                print(f"| {'finer ahead' if finer else 'even'} | {seed} | {window[0]:g} to {window[1]:g} ({name}) | {values} |", flush=True)


def main() -> None:
    if sys.argv[1:] == ["--cost"]:
        return cost()
    if sys.argv[1:] == ["--crack"]:
        return crack()
    linear = 'volume_correction = "linear"\n'
    corrected = linear + 'surface_correction = "energy"\n'
    state = 'model = "state"\npoisson_ratio = 0.22\n'
    print("| model, corrections | growth of the spacing | points | energy | displacement | tear |\n|---|---|---|---|---|---|")
    for body, growths in (
        (Body("bond, none", ""), (0, 0.1)),
        (Body("bond, linear", linear), (0, 0.1)),
        (Body("bond, linear, energy", corrected), (0, 0.05, 0.1, 0.2, 0.4)),
        (Body("the same in 3D", corrected, poisson_ratio=0.25, dimension=3), (0, 0.2)),
        (Body("state, ν = 0.22, linear", linear, state, 0.22), (0,)),
    ):
        for growth in growths:
            with tempfile.TemporaryDirectory() as folder:
                found = [measured(body, growth, seed, Path(folder)) for seed in SEEDS]
            points, stored, off, torn = numpy.mean(found, axis=0)
            spread = statistics.stdev(one[3] for one in found)
            print(f"| {body.name} | {growth or 'even'} | {points:.0f} | {stored:.4f} | {off:.4f} | {torn:.3f} ± {spread:.3f} |", flush=True)


if __name__ == "__main__":
    sys.exit(main())
