"""G at which a crack of model `state` runs steadily through a clamped strip, over the fracture energy of its data sheet:

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 benchmarks/steady_cracks.py [--steps N] [--strip KEY=VALUE] [--curve] [--work DIR] [NAME...]

A strip whose long edges are clamped, with a crack along half its middle. The mean opening of the crack's line is
controlled, and the load is found: far from both ends of the strip G is the energy per length of the strip that is not
cracked yet, which goes with the square of the load, whatever the horizon, the height and the clamps are. That energy
is the difference of two elastic strips of different lengths. G is the mean over the growth by three spacings, once the
process zone has developed; damage commits at the end of each step of the control, and what it sets free beyond the
law is drained, so that G tends to `tear` with finer steps: G = tear (1 + drained / dissipated). A straight tear of the same strip, whose halves move apart as rigid bodies, takes
`tear`, which differs from the fracture energy by the direction of the lattice and, in 3D, by the free faces.
Names: stress_NU, strain_NU, space_NU, planes_NU (in 3D between two planes of symmetry), bond (plane stress), bond_cut (with struts cut), bond_space; strength_NU and surface_NU in plane
stress with a strength, without and with a strength surface. --strip gives the strip another size, --curve prints G by the growth of the crack
too: G that still changes is no steady crack's. A strip that softens without a crack at the loads found is refused. Finished runs in DIR are not repeated.
"""

import argparse
import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, fields, replace
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
MODULUS, FRACTURE_ENERGY, SPACING, THICKNESS = 70e9, 10.0, 1e-3, 1e-3  # Pa, J/m2, m, m
STRENGTH, COMPRESSIVE = 10264785.785, 170e6  # of strength_NU and surface_NU [Pa]
NAMES = ("stress_0", "stress_0.22", "stress_0.3333", "stress_0.45", "strain_0.25", "strain_0.35", "strain_0.4", "bond")
# Mean opening over that of a severed strip: up to which few steps do, and by which it then grows.
ELASTIC_PART, GROWING_PART = 0.27, 0.23
COUNTED = 3  # growth over which G is averaged [spacings]


@dataclass(frozen=True)
class Strip:
    name: str
    steps: int  # of the control while the crack grows
    length: int = 40  # spacings
    crack: int = 12
    height: int = 24  # lower strips soften ahead of the crack
    width: int = 4  # in 3D
    growing: float = GROWING_PART
    grown: float = 3.5  # growth from which on G is averaged [spacings]
    ratio: float = 3.015

    @property
    def kind(self) -> str:
        return self.name.partition("_")[0]

    @property
    def poisson_ratio(self) -> float:
        return (1 / 4 if self.dimension == 3 else 1 / 3) if self.kind == "bond" else float(self.name.partition("_")[2])

    @property
    def dimension(self) -> int:
        return 3 if "space" in self.name or self.kind == "planes" else 2

    @property
    def depth(self) -> float:
        return self.width * SPACING if self.dimension == 3 else THICKNESS

    @property
    def displacement(self) -> float:
        """Of the clamps at load 1, at which G of a strip in the continuum is about the fracture energy [m]."""
        nu = self.poisson_ratio
        is_thick = self.kind == "strain" or self.dimension == 3
        clamped = MODULUS * (1 - nu) / ((1 + nu) * (1 - 2 * nu)) if is_thick else MODULUS / (1 - nu**2)
        return math.sqrt(FRACTURE_ENERGY * self.height * SPACING / clamped / 2)

    def material(self) -> str:
        model = "bond" if self.kind == "bond" else "state"
        plane = "" if self.dimension == 3 or self.kind == "bond" else f'plane = "{"strain" if self.kind == "strain" else "stress"}"\n'
        ratio = f"poisson_ratio = {self.poisson_ratio}\n" if model == "state" else ""
        return f'[material]\nmodel = "{model}"\n{plane}youngs_modulus = {MODULUS}\n{ratio}'

    def body(self, length: int) -> str:
        half, far = self.height * SPACING / 2, length * SPACING
        low, high = ([0, -half, 0], [far, half, self.depth])
        space = self.dimension == 3
        return f"""\
dimension = {self.dimension}
[lattice]
spacing = {SPACING}
horizon_ratio = {self.ratio}
{"" if space else f"thickness = {THICKNESS}"}
shape = [{{ add = "box", min = {low[: self.dimension]}, max = {high[: self.dimension]} }}]
[quadrature]
volume_correction = "linear"
[[lattice.layer]]
name = "low"
side = "y-"
thickness = 3
[[lattice.layer]]
name = "high"
side = "y+"
thickness = 3
{self.planes()}"""

    def planes(self) -> str:
        """Planes of symmetry in the place of free faces."""
        sides = (0, self.depth) if self.kind == "planes" else ()
        return "".join(f'[[symmetry]]\naxis = "z"\nat = {side}\n' for side in sides)

    def clamps(self) -> str:
        also = ", 0" if self.dimension == 3 else ""
        return "".join(
            f'[[support]]\nset = "{name}"\ndisplacement = [0, "{sign}{self.displacement}*load"{also}]\n'
            for name, sign in (("low", "-"), ("high", ""))
        )

    def elastic(self, length: int) -> str:
        return self.body(length) + self.material() + self.clamps()

    def damage(self) -> str:
        more = f"strength = {STRENGTH}\n" if self.kind in ("strength", "surface") else ""
        more += 'struts = "cut"\n' if self.name.endswith("_cut") else ""
        more += f'strength_surface = "drucker_prager"\ncompressive_strength = {COMPRESSIVE}\n' if self.kind == "surface" else ""
        return f'[material.damage]\nlaw = "linear"\nfracture_energy = {FRACTURE_ENERGY}\n{more}no_fail = ["low", "high"]\n'

    def intact(self, load: float) -> str:
        """A strip without a crack, up to this load."""
        return self.elastic(self.crack) + self.damage() + f"[loading]\ntable = [0, {load}]\nadaptive = false\n"

    def torn(self, length: int) -> str:
        """Halves that move apart until no bond joins them; nothing is searched for."""
        also = ", 0" if self.dimension == 3 else ""
        sets = "".join(
            f'[[set]]\nname = "{name}"\nwhere = "y {sign} 0"\n[[support]]\nset = "{name}"\ndisplacement = [0, {value}{also}]\n'
            for name, sign, value in (("below", "<", "0"), ("above", ">", f'"{20 * SPACING}*load"'))
        )
        return self.body(length) + self.material() + self.damage().split("no_fail")[0] + sets + '[solver]\nmode = "relaxation"\n[relaxation]\nsteps = 1\n'

    def text(self) -> str:
        end, h = self.crack * SPACING, SPACING
        crack = f"from = [{-h}, 0]\nto = [{end}, 0]"
        if self.dimension == 3:
            corners = [[-h, 0, -h], [end, 0, -h], [end, 0, self.depth + h], [-h, 0, self.depth + h]]
            crack = f"vertices = {corners}"
        opened = 2 * self.displacement
        table = [0, 0.15, 0.2, 0.24] + [ELASTIC_PART + self.growing * k / self.steps for k in range(self.steps + 1)]
        weights = lambda sign: [0, sign, 0][: self.dimension]
        along = f"x < {(self.length - 6) * h}"
        return (
            self.body(self.length)
            + self.material()
            + self.damage()
            + self.clamps()
            + f"""\
[[crack]]
{crack}
[[set]]
name = "above"
where = "y > 0 && y < {h} && {along}"
[[set]]
name = "below"
where = "y < 0 && y > {-h} && {along}"
[[control]]
set = "above"
weights = {weights(1)}
[[control]]
set = "below"
weights = {weights(-1)}
[loading]
table = {[round(share * opened, 12) for share in table]}
adaptive = false
[output]
every = 100000
"""
        )


def run(text: str, folder: Path) -> Path:
    """The results folder of a case; a finished run of the same text is not repeated."""
    case, out = folder / "case.toml", folder / "out"
    if not ((out / "summary.json").exists() and case.exists() and case.read_text() == text):
        folder.mkdir(parents=True, exist_ok=True)
        case.write_text(text)
        subprocess.run([PROGRAM, "run", case, "--output", out, "--overwrite", "--quiet", "--no-plots", "--threads", "1"], check=True)
    return out


def energy(out: Path, name: str) -> float:
    return json.loads((out / "summary.json").read_text())["energy"][name]


def per_area(strip: Strip, text, name: str, folder: Path) -> float:
    """Difference of an energy between two lengths, over the area of the crack that fits in between [J/m2]."""
    lengths = (strip.length, strip.length + 10)
    short, long = (energy(run(text(length), folder / f"{text.__name__}_{length}"), name) for length in lengths)
    return (long - short) / ((lengths[1] - lengths[0]) * SPACING * strip.depth)


@dataclass(frozen=True)
class Measured:
    """Energies per area over the fracture energy, and the drained share of what is dissipated."""

    tear: float
    release: float  # G
    drained: float


@dataclass(frozen=True)
class Step:
    """Growth of the crack [spacings], the part of it in this step, and G over the fracture energy; drained in the same unit as the growth."""

    growth: float
    part: float
    drained: float
    release: float


def steps_of(strip: Strip, folder: Path) -> list[Step]:
    ahead = per_area(strip, strip.elastic, "stored", folder / strip.name) / FRACTURE_ENERGY  # at load 1
    with open(run(strip.text(), folder / f"{strip.name}/steps_{strip.steps}") / "history.csv", newline="") as table:
        rows = [[float(row[key]) for key in ("load_factor", "dissipated_energy", "drained_energy")] for row in csv.DictReader(table)]
    if energy(run(strip.intact(max(load for load, *_ in rows)), folder / strip.name / "intact"), "dissipated") > 0:
        raise SystemExit(f"{strip.name}: the strip softens ahead of the crack, so its energy per length is no G; take a higher one")
    one = SPACING * strip.depth * FRACTURE_ENERGY
    return [Step(new[1] / one, (new[1] - old[1]) / one, (new[2] - old[2]) / one, new[0] ** 2 * ahead) for old, new in zip(rows, rows[1:])]


def measured(strip: Strip, steps: list[Step], folder: Path) -> Measured:
    tear = per_area(strip, strip.torn, "dissipated", folder / strip.name) / FRACTURE_ENERGY
    counted = [step for step in steps if strip.grown < step.growth < strip.grown + COUNTED]
    growth = sum(step.part for step in counted)
    if growth == 0:
        raise SystemExit(f"{strip.name}: the crack did not grow by {strip.grown} spacings")
    return Measured(tear, sum(step.release * step.part for step in counted) / growth, sum(step.drained for step in counted) / growth)


def curve(steps: list[Step]) -> Iterator[str]:
    """G by the growth of the crack, in parts of about a spacing."""
    for number in range(int(steps[-1].growth) + 1):
        inside = [step for step in steps if number <= step.growth < number + 1]
        growth = sum(step.part for step in inside)
        if growth > 0:
            yield f"{sum(step.release * step.part for step in inside) / growth:.3f} from {number}"


def standard(name: str, steps: int) -> Strip:
    """The strip that the tables tell."""
    plain = Strip(name, steps)
    return replace(plain, ratio=2.015, width=1 if plain.kind == "planes" else plain.width) if plain.dimension == 3 else plain


def sized(strip: Strip, sizes: list[str]) -> Strip:
    """The strip with values KEY=VALUE in the place of its own."""
    types = {field.name: float if field.type in (float, "float") else int for field in fields(Strip) if field.name not in ("name", "steps")}
    try:
        given = {key: types[key](value) for key, _, value in (size.partition("=") for size in sizes)}
    except (KeyError, ValueError):
        raise SystemExit(f"--strip: KEY=VALUE with a number, and a key of {', '.join(types)}") from None
    return replace(strip, **given)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", metavar="NAME", nargs="*", default=NAMES)
    parser.add_argument("--steps", type=int, default=23, help="of the control while the crack grows (default: 23)")
    parser.add_argument("--work", type=Path, help="folder of the runs, which are kept")
    parser.add_argument("--strip", metavar="KEY=VALUE", action="append", default=[],
                        help="another length, crack, height, width (3D) [spacings], horizon ratio, share of the opening growing, or growth grown from which on G counts")  # fmt: skip
    parser.add_argument("--curve", action="store_true", help="print G by the growth of the crack, too")
    asked = parser.parse_args()
    print("| strip, Poisson's ratio | steps | tear / G_c | G / G_c | drained / dissipated | tear (1 + drained / dissipated) / G_c |\n|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as name:
        for strip in asked.names:
            one = sized(standard(strip, asked.steps), asked.strip)
            steps = steps_of(one, asked.work or Path(name))
            if asked.curve:
                print("G / G_c by growth [spacings]:", ", ".join(curve(steps)))
            found = measured(one, steps, asked.work or Path(name))
            print(f"| {strip.replace('_', ', ')} | {asked.steps} | {found.tear:.3f} | {found.release:.3f} | {found.drained:.3f} "
                  f"| {found.tear * (1 + found.drained):.3f} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    sys.exit(main())
