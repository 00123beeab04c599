"""Conjugate gradients for model state beside bonds: ./peristat build && /usr/bin/python3 benchmarks/state_solver.py

A cube of N^3 points held at one side under a body force, one load step, products without a stored tangent. For each
Poisson's ratio the table gives the mean number of iterations of a linear solve to 1e-8, the bond model's on the same
points, and the limit: 1.5 times the latter times the root of (2 mu + 3 lambda) / (5 mu), by which the tangent may
exceed that of the bonds. `--largest` runs the 100^3 points of nu = 0.3 alone and prints its seconds and memory.
"""

import argparse
import json
import os
import resource
import subprocess
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
RATIOS = (0.2, 0.3, 0.45, 0.49)


def case(side: int, poisson_ratio: float | None, preconditioner: str) -> str:
    model = '"bond"' if poisson_ratio is None else f'"state"\npoisson_ratio = {poisson_ratio}'
    return f"""\
dimension = 3
[lattice]
spacing = 0.01
horizon_ratio = 3.015
shape = [{{ add = "box", min = [0, 0, 0], max = [{side / 100}, {side / 100}, {side / 100}] }}]
layer = [{{ name = "clamped", side = "x-", thickness = 3 }}]
[material]
model = {model}
youngs_modulus = 200e9
[[support]]
set = "clamped"
displacement = [0, 0, 0]
[[set]]
name = "loaded"
where = "x > 0"
[[load]]
set = "loaded"
body_force = ["0", "-1e6*load", "0"]
[loading]
steps = 1
[solver]
linear = "pcg"
preconditioner = "{preconditioner}"
linear_tolerance = 1e-8
"""


def solve(side: int, poisson_ratio: float | None, preconditioner: str = "rigid_pieces"):
    """Returns the summary of the run and its seconds."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "case.toml")
        path.write_text(case(side, poisson_ratio, preconditioner))
        start = time.monotonic()
        subprocess.run([PROGRAM, "run", path, "--quiet", "--no-plots", "--output", Path(folder, "out")], check=True)
        seconds = time.monotonic() - start
        return json.loads(Path(folder, "out", "summary.json").read_text()), seconds


def iterations(summary) -> float:
    return summary["linear_iterations"] / summary["newton_iterations"]


def print_table(sides, preconditioner):
    print("| points | bonds | " + " | ".join(f"nu = {ratio}" for ratio in RATIOS) + " |")
    print("|---|---|" + "---|" * len(RATIOS))
    for side in sides:
        of_bonds = iterations(solve(side, None, preconditioner)[0])
        cells = []
        for ratio in RATIOS:
            lame = 2 * ratio / (1 - 2 * ratio)  # lambda / mu
            limit = 1.5 * of_bonds * max(1.0, (2 + 3 * lame) / 5) ** 0.5
            cells.append(f"{iterations(solve(side, ratio, preconditioner)[0]):.1f} of {limit:.1f}")
        print(f"| {side}^3 | {of_bonds:.1f} | " + " | ".join(cells) + " |", flush=True)


def print_largest(side):
    summary, seconds = solve(side, 0.3)
    peak = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
    points = (side + 3) * side * side
    print(f"{points} points: {seconds:.1f} s, {peak / 1e9:.2f} GB, {peak / points:.0f} bytes a point")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sides", type=int, nargs="+", default=[10, 22, 46])
    parser.add_argument("--preconditioner", default="rigid_pieces")
    parser.add_argument("--largest", type=int, nargs="?", const=100)
    arguments = parser.parse_args()
    if arguments.largest:
        print_largest(arguments.largest)
    else:
        print_table(arguments.sides, arguments.preconditioner)


main()
