"""Conjugate gradients with products in single and in double precision: iterations, seconds, accuracy.

  ./peristat build && /usr/bin/python3 -m benchmarks.precision [--threads N] [--repeat 2]

Runs go in turns; of the repetitions the least seconds count. The difference is that of the displacements, over the
largest one. A second table counts the iterations of one system to 1e-8, for the bodies of docs/linear-solvers.md.
"""

import argparse
import csv
import json
import pathlib
import subprocess
import tempfile

import h5py
import numpy

from tests.reference.program import PROGRAM, ROOT, settings
from tests.verification.printed_numbers_test import LinearSolvers

PCG = ["solver.linear='pcg'", "solver.tangent='matrix_free'"]
BLOCK = ["lattice.spacing=0.02", "lattice.shape[0].min=[0,-0.5,-0.5]", "lattice.shape[0].max=[1,0.5,0.5]",
         "load[0].body_force=['0', '-5e9*load', '0']"]  # fmt: skip
PLATE = ["lattice.spacing=2.5e-4", "loading.steps=1"]
CASES = {
    "block of 132 500 points, sines": ("cantilever/beam.toml", [*PCG, *BLOCK, "solver.preconditioner='sines'"]),
    "same, block Jacobi": ("cantilever/beam.toml", [*PCG, *BLOCK, "solver.preconditioner='block_jacobi'"]),
    "same, one iteration to 1e-12": (
        "cantilever/beam.toml",
        [*PCG, *BLOCK, "solver.preconditioner='sines'", "solver.linear_tolerance=1e-12", "solver.max_iterations=3"],
    ),
    "slender beam in 3D, rigid pieces": ("cantilever/beam.toml", [*PCG, "solver.preconditioner='rigid_pieces'"]),
    "plate with a hole, rigid pieces": ("plate_with_hole/elastic.toml",
                                        [*PCG, *PLATE, "solver.preconditioner='rigid_pieces'"]),
    "same, to 1e-13": (
        "plate_with_hole/elastic.toml",
        [*PCG, *PLATE, "solver.preconditioner='rigid_pieces'", "solver.relative_tolerance=1e-13"],
    ),
}  # fmt: skip


def run(case, changes, precision, threads, folder):
    """Numbers of a run, and its displacements."""
    command = [PROGRAM, "run", ROOT / "cases" / case, "--output", folder, "--overwrite", "--no-plots", "--quiet",
               "--threads", str(threads), *settings(*changes, f"solver.precision='{precision}'")]  # fmt: skip
    ended = subprocess.run(list(map(str, command)), capture_output=True, text=True)
    if ended.returncode not in (0, 3):
        raise SystemExit(ended.stderr)
    summary = json.loads((folder / "summary.json").read_text())
    with (folder / "iterations.csv").open() as file:
        last = list(csv.DictReader(file))[-1]
    with h5py.File(folder / "results.h5") as results:
        steps = results["steps"]
        displacement = numpy.array(steps[sorted(steps)[-1]]["displacement"])
    return {
        "newton": summary["newton_iterations"], "cg": summary["linear_iterations"],
        "residual": float(last["relative_residual"]), "linear": summary["seconds"]["linear"],
        "total": summary["seconds"]["total"],
    }, displacement  # fmt: skip


def iterations_of_one_system(body, preconditioner, precision, work):
    extent, more = LinearSolvers.BODIES[body]
    case = work / "system.toml"
    case.write_text(LinearSolvers.CASE.format(extent=extent, more=more))
    run(case, [f"solver.preconditioner='{preconditioner}'"], precision, 1, work / "out")
    with (work / "out/iterations.csv").open() as file:
        return list(csv.DictReader(file))[1]["linear_iterations"]


def print_iterations_of_one_system(work):
    preconditioners = ("jacobi", "block_jacobi", "rigid_pieces", "surrogate", "multigrid", "sines")
    print("\n| one system, double / single | " + " | ".join(preconditioners) + " |")
    print("|---" * (len(preconditioners) + 1) + "|")
    for body in LinearSolvers.BODIES:
        cells = [" / ".join(iterations_of_one_system(body, preconditioner, precision, work)
                            for precision in ("double", "single")) for preconditioner in preconditioners]  # fmt: skip
        print("| " + " | ".join([body, *cells]) + " |", flush=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--repeat", type=int, default=2)
    arguments = parser.parse_args()
    print("| case | Newton, double | single | CG, double | single | residual, double | single "
          "| linear s, double | single | total s, double | single | difference |")  # fmt: skip
    print("|---" * 12 + "|")
    with tempfile.TemporaryDirectory() as work:
        for name, (case, changes) in CASES.items():
            best, displacements = {}, {}
            for _ in range(arguments.repeat):
                for precision in ("double", "single"):
                    found, displacements[precision] = run(case, changes, precision, arguments.threads,
                                                          pathlib.Path(work) / "out")  # fmt: skip
                    before = best.get(precision, found)
                    best[precision] = {key: min(found[key], before[key]) for key in found}
            double, single = best["double"], best["single"]
            size = numpy.abs(displacements["double"]).max()
            difference = numpy.abs(displacements["single"] - displacements["double"]).max() / size
            cells = [name]
            for key, text in (("newton", "{}"), ("cg", "{}"), ("residual", "{:.1e}"), ("linear", "{:.2f}"),
                              ("total", "{:.2f}")):  # fmt: skip
                cells += [text.format(double[key]), text.format(single[key])]
            print("| " + " | ".join([*cells, f"{difference:.1e}"]) + " |", flush=True)
        print_iterations_of_one_system(pathlib.Path(work))


if __name__ == "__main__":
    main()
