"""Twin experiments of fits (docs/fit.md): a curve with 1 % noise is made from known values, and fitted from starts that are
three times off; then derivatives by differences of other sizes. Prints two tables for benchmarks/RESULTS.md.

PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -BE benchmarks/fit_twin.py
"""

import argparse
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[1]
sys.path[:0] = [str(ROOT / folder) for folder in ("cases/runner/fit", "cases/runner/sweep", "python", ".")]

import fit  # noqa: E402
from peristat.fitting.outcome import fit_problem  # noqa: E402
from peristat.fitting.problem import gradient_of  # noqa: E402
from program import Program  # noqa: E402

from tests.acceptance.fit_test import BEAM, ENERGY, STRENGTH  # noqa: E402

TRUTH = (100.0, 3.0)  # J/m2, MPa
NOISE, POINTS = 0.01, 400
DIFFERENCES = (0.02, 0.001, 0.003, 0.01, 0.05, 0.1)


def measure(folder: Path, seed: int) -> None:
    with open(folder / "truth/load_displacement.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    opening, force = (numpy.array([abs(float(row[name])) for row in rows]) for name in ("control", "force_y:load"))
    places = numpy.linspace(0.0, opening[-1], POINTS)
    noise = NOISE * force.max() * numpy.random.default_rng(seed).normal(size=POINTS)
    values = numpy.interp(places, opening, force) + noise
    numpy.savetxt(folder / f"data_{seed}.csv", numpy.column_stack([places, values]), delimiter=",", fmt="%.9g")


def problem(folder: Path, seed: int, *words: str):
    given = [str(folder / "beam.toml"), "--data", str(folder / f"data_{seed}.csv"), "--over", f"{ENERGY},{STRENGTH}", "--output",
             str(folder / "fit"), "--threads", "1", "--jobs", "2", *words]  # fmt: skip
    return fit.read(fit._parser().parse_args(given), Program(os.environ["PERISTAT_PROGRAM"]))[0]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=3)
    seeds = range(1, 1 + parser.parse_args().seeds)
    fit.say = lambda text: None
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "beam.toml").write_text(BEAM)
        command = [os.environ["PERISTAT_PROGRAM"], "run", folder / "beam.toml", "--output", folder / "truth", "--quiet", "--threads", "1"]
        subprocess.run(command, check=True)
        print("| noise of seed | start | runs | fracture energy [J/m²] | strength [MPa] |\n|---|---|---|---|---|")
        for seed in seeds:
            measure(folder, seed)
            for factor in (3.0, 1.0 / 3.0):
                start = [f"{key}={factor * value:.6g} {unit}" for key, value, unit in zip((ENERGY, STRENGTH), TRUTH, ("J/m2", "MPa"))]
                before = len(list((folder / "fit/runs").glob("*")))
                found = fit_problem(problem(folder, seed, "--start", start[0], "--start", start[1]), 1, 1, 30)
                runs = len(list((folder / "fit/runs").glob("*"))) - before
                told = " | ".join(f"{each.value:.4g} ± {each.deviation:.1g}" for each in found.statistics.estimates)
                print(f"| {seed} | {factor:.2g} times the truth | {runs} | {told} |", flush=True)
        print("\n| difference | change of the derivatives [%] | their scatter [%] |\n|---|---|---|")
        reference = None
        for difference in DIFFERENCES:
            of = problem(folder, 1, "--difference", str(difference))
            of.begin(numpy.ones(2))
            derivatives, scatter = gradient_of(of, numpy.ones(2))
            reference = derivatives if reference is None else reference
            change = numpy.linalg.norm(derivatives - reference, axis=0) / numpy.linalg.norm(reference, axis=0)
            percent = [", ".join(f"{100.0 * value:.1f}" for value in row) for row in (change, scatter)]
            print(f"| {difference:g} | {percent[0]} | {percent[1]} |", flush=True)


if __name__ == "__main__":
    main()
