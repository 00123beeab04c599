#!/usr/bin/env python3
"""Memory: the estimate of `check` and the measured peak of the run, and bytes per point in 3D.

    benchmarks/memory.py [--large]

--large adds a million points in 3D (20 s, and 4.2 GB with the stored tangent).
"""

import argparse
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/peristat"
BEAM, PLATE = "cantilever/beam", "plate_with_hole/elastic"


def wide(half_width):
    return [f"lattice.shape[0].min=[0,-{half_width},-{half_width}]",
            f"lattice.shape[0].max=[1,{half_width},{half_width}]"]


def cube(points_per_side):
    return [f"lattice.spacing={1 / points_per_side}", *wide(0.5)]


def named(preconditioner):
    return ["solver.linear=pcg", f"solver.preconditioner={preconditioner}"]


STORED = ["solver.linear=pcg", "solver.tangent=stored"]
FINE = ["lattice.spacing=2.5e-4", "loading.steps=1"]
RUNS = [
    ("bar/tension", []),
    ("cantilever/plate", []),
    (PLATE, []),
    (PLATE, ["solver.linear=cholesky"]),
    (PLATE, FINE),
    (PLATE, FINE + ["solver.linear=cholesky"]),
    (BEAM, []),
    (BEAM, ["solver.linear=cholesky"]),
    (BEAM, wide(0.1)),
    (BEAM, wide(0.1) + STORED),
    (BEAM, wide(0.2)),
    (BEAM, wide(0.2) + ['quadrature.surface_correction="energy"']),
    (BEAM, cube(50)),
    (BEAM, cube(50) + STORED),
    (PLATE, ["solver.mode=arc_length"]),
    (PLATE, FINE + ["solver.mode=arc_length"]),
    (BEAM, ["solver.mode=arc_length"]),
    ("buckling/column", []),
    ("cpd/square", []),
    ("cpd/cube", ["loading.steps=2"]),
    ("plate_with_hole/square", []),
    ("four_holes/tension", []),
    *[(BEAM, wide(0.1) + named(kind))
      for kind in ("jacobi", "surrogate", "multigrid", "riluk", "chebyshev")],
    *[(PLATE, ["lattice.spacing=5e-4", "loading.steps=1"] + named(kind))
      for kind in ("jacobi", "surrogate", "multigrid", "riluk", "chebyshev")],
]
LARGE = [(BEAM, cube(100)), (BEAM, cube(100) + STORED)]


def program(command, problem, settings, *options):
    words = [word for setting in settings for word in ("--set", setting)]
    return subprocess.run([PROGRAM, command, ROOT / f"cases/{problem}.toml", *options, *words], text=True,
                          check=True, capture_output=True,
                          env=dict(os.environ, OMP_WAIT_POLICY="passive")).stdout


def estimate_and_summary(problem, settings):
    told = re.search(r"^memory +about ([0-9.]+) (MB|GB)", program("check", problem, settings), re.MULTILINE)
    estimate = float(told[1]) * {"MB": 1e6, "GB": 1e9}[told[2]]
    with tempfile.TemporaryDirectory() as folder:
        program("run", problem, settings, "--quiet", "--output", folder)
        return estimate, json.loads((pathlib.Path(folder) / "summary.json").read_text())


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--large", action="store_true", help="a million points in 3D, too")
    runs = RUNS + (LARGE if parser.parse_args().large else [])
    print("| case | settings | points | peak, MB | estimate / peak |\n|---|---|---|---|---|")
    for problem, settings in runs:
        estimate, summary = estimate_and_summary(problem, settings)
        peak = summary["peak_memory_bytes"]
        told = f"`{' '.join(settings)}`" if settings else ""
        print(f"| {problem} | {told} | {summary['points']} | {peak / 1e6:.0f} | {estimate / peak:.2f} |",
              flush=True)


if __name__ == "__main__":
    sys.exit(main())
