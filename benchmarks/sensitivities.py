"""Processor time of runs with derivatives, over that of the runs without:

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 benchmarks/sensitivities.py

A cracked strip that softens, in 2D and 3D, in eight steps of Newton's method with Cholesky factors, one thread. The
numbers are three data of the material, then the moduli of four regions.
"""

import json
import os
import re
import resource
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
REGIONS = {"a": "x < 0.2", "b": "x > 0.2 && x < 0.4", "c": "x > 0.6", "d": "x > 0.4 && x < 0.6 && y > 0.4"}
KEYS = ["material.youngs_modulus", "material.damage.fracture_energy", "material.damage.strength"]
KEYS += [f"region[{k}].material.youngs_modulus" for k in range(len(REGIONS))]


def case(dimension: int, spacing: float, keys: list[str]) -> str:
    low, high = [0, 0, 0], [1, 0.5, 0.25]
    crack = "from = [0.5, -0.1]\nto = [0.5, 0.15]"
    if dimension == 3:
        crack = "vertices = [[0.5, -0.1, -0.1], [0.5, 0.15, -0.1], [0.5, 0.15, 0.4], [0.5, -0.1, 0.4]]"
    zeros = [0] * dimension
    sets = "".join(f'[[set]]\nname = "{name}"\nwhere = "{where}"\n' for name, where in REGIONS.items())
    regions = "".join(
        f'[[region]]\nset = "{name}"\n[region.material]\nyoungs_modulus = {2e9 + 1e8 * k}\n'
        for k, name in enumerate(REGIONS)
    )
    return f"""\
dimension = {dimension}
[lattice]
spacing = {spacing}
shape = [{{ add = "box", min = {low[:dimension]}, max = {high[:dimension]} }}]
[[lattice.layer]]
name = "held"
side = "x-"
thickness = 3
[[lattice.layer]]
name = "pulled"
side = "x+"
thickness = 3
{sets}
[[crack]]
{crack}
[material]
youngs_modulus = 2e9
[material.damage]
law = "linear"
fracture_energy = 2e4
strength = {20e6 if dimension == 2 else 8e6}
no_fail = ["held", "pulled"]
{regions}
[[support]]
set = "held"
displacement = {zeros}
[[support]]
set = "pulled"
displacement = ["{12e-3 if dimension == 2 else 6e-3}*load", {", ".join(map(str, zeros[1:]))}]
[loading]
table = [0, 0.2]
steps = 8
[solver]
linear = "cholesky"
[output]
every = 100
{f"[sensitivity]{chr(10)}over = {json.dumps(keys)}" if keys else ""}
"""


def seconds(text: str, folder: Path) -> tuple[float, int]:
    """Processor seconds of a run, and its points."""
    (folder / "case.toml").write_text(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    words = ["--output", folder / "out", "--overwrite", "--no-plots", "--threads", "1"]
    ended = subprocess.run([PROGRAM, "run", folder / "case.toml", *words], check=True, capture_output=True, text=True)
    if "sensitivities end" in ended.stdout:
        raise SystemExit(ended.stdout)
    return resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - before, int(re.search(r"(\d+) points", ended.stdout)[1])


def main() -> None:
    print("| body | points | alone, s | 1 number | 3 numbers | 7 numbers |\n|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as name:
        for dimension, spacing in ((2, 1 / 160), (3, 1 / 32)):
            alone, points = seconds(case(dimension, spacing, []), Path(name))
            ratios = [seconds(case(dimension, spacing, KEYS[:count]), Path(name))[0] / alone for count in (1, 3, 7)]
            print(f"| {dimension}D | {points} | {alone:.1f} | " + " | ".join(f"{ratio:.2f}" for ratio in ratios) + " |", flush=True)


if __name__ == "__main__":
    main()
