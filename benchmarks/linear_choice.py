#!/usr/bin/env python3
"""Quality of the choice of solver.linear = "auto": ten problems with each solver.

    benchmarks/linear_choice.py [--repeat N] [PROBLEM]...

Prints the CPU seconds of whole runs, the best of N, taken in turns.
"""

import argparse
import os
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/peristat"
BLOCK = ["lattice.shape[0].min=[0,-0.07,-0.07]", "lattice.shape[0].max=[1,0.07,0.07]"]

PROBLEMS = {
    "bar/tension": ("bar/tension", []),
    "cantilever/plate": ("cantilever/plate", []),
    "cantilever/beam": ("cantilever/beam", []),
    "cantilever/beam, 20 000 points": ("cantilever/beam", BLOCK),
    "plate_with_hole/elastic": ("plate_with_hole/elastic", []),
    "plate_with_hole/elastic, 120 000 points": ("plate_with_hole/elastic",
                                                ["lattice.spacing=2.5e-4", "loading.steps=1"]),
    "cpd/square": ("cpd/square", []),
    "cpd/cube, 5 steps": ("cpd/cube", ["loading.steps=5"]),
    "cpd/poisson_3d": ("cpd/poisson_3d", []),
    "plate_with_hole/square": ("plate_with_hole/square", []),
}  # fmt: skip
CHOICES = {
    "auto": [],
    "cholesky": ["solver.linear=cholesky"],
    "rigid_pieces": ["solver.linear=pcg", "solver.preconditioner=rigid_pieces"],
    "surrogate": ["solver.linear=pcg", "solver.preconditioner=surrogate"],
    "multigrid": ["solver.linear=pcg", "solver.preconditioner=multigrid"],
}


def run(case, settings, folder):
    """CPU seconds of a run, or infinity if it fails."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words = [word for setting in settings for word in ("--set", setting)]
    ended = subprocess.run([PROGRAM, "run", ROOT / f"cases/{case}.toml", "--output", folder, "--quiet", *words],
                           env=dict(os.environ, OMP_WAIT_POLICY="passive"), capture_output=True)  # fmt: skip
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if ended.returncode != 0:
        return float("inf")
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("problems", nargs="*", choices=[[], *PROBLEMS], metavar="PROBLEM")
    parser.add_argument("--repeat", type=int, default=3)
    options = parser.parse_args()
    print(f"| problem | {' | '.join(CHOICES)} | auto / best |\n|---|{'---|' * len(CHOICES)}---|")
    worst = 0.0
    for name in options.problems or PROBLEMS:
        case, settings = PROBLEMS[name]
        best = dict.fromkeys(CHOICES, float("inf"))
        with tempfile.TemporaryDirectory() as folder:
            for _ in range(options.repeat):
                for choice, chosen in CHOICES.items():
                    best[choice] = min(best[choice], run(case, settings + chosen, folder))
        ratio = best["auto"] / min(best.values())
        worst = max(worst, ratio)
        print(f"| {name} | {' | '.join(f'{seconds:.2f}' for seconds in best.values())} | {ratio:.2f} |")
        sys.stdout.flush()
    print(f"\nworst: {worst:.2f}")


if __name__ == "__main__":
    main()
