"""Runs the benchmark program on one and on all threads and prints the table of RESULTS.md.

The table lists every figure with the DGEMM and STREAM triad of the same run. Targets are for one thread of a
machine with 55 GF/s and 35 GB/s and are scaled by the measured rates: targets of passes over bonds by
the slower of the two ratios. Targets of the factorisation are shares of DGEMM already, and those of relaxation
are matrix-free products of the same bonds in the same state.

    benchmarks/run.py [OPTION of Google Benchmark]...
"""

import json
import os
import pathlib
import subprocess
import sys

REFERENCE_DGEMM, REFERENCE_TRIAD = 55e9, 35e9

# name: (counter, unit of the printed figure, its text, target on one thread)
ROWS = {
    "neighbour_search": ("bond", 1e6, "M directed bonds/s", 50e6),
    "energy": ("bond", 1e6, "M bonds/s", None),
    "gradient": ("bond", 1e6, "M bonds/s", None),
    "tangent": ("bond", 1e6, "M bonds/s", 80e6),
    "matrix_free_product": ("bond", 1e6, "M bonds/s", 300e6),
    "single_product": ("bond", 1e6, "M bonds/s", None),
    "listed_energy": ("bond", 1e6, "M bonds/s", None),
    "listed_gradient": ("bond", 1e6, "M bonds/s", None),
    "listed_product": ("bond", 1e6, "M bonds/s", None),
    "state_gradient": ("bond", 1e6, "M bonds/s", None),
    "state_product": ("bond", 1e6, "M bonds/s", None),
    "stored_product": ("bond", 1e6, "M bonds/s", None),
    "tetrahedra_tangent": ("interaction", 1e6, "M tetrahedra/s", 30e6),
    "tetrahedra_gradient": ("interaction", 1e6, "M tetrahedra/s", None),
    "tetrahedra_product": ("interaction", 1e6, "M tetrahedra/s", None),
    "triangles_tangent": ("interaction", 1e6, "M triangles/s", None),
    "triangles_gradient": ("interaction", 1e6, "M triangles/s", None),
    "optimised_weights": ("point", 1e3, "k points/s", None),
    "factorisation": ("flop", 1e9, "GF/s", None),
}
FACTORISATION_SHARE = {"100": 0.45, "300": 0.65}
WEIGHTS_TARGET = {"2": 1 / 15e-6, "3": 1 / 300e-6}  # points/s
PRODUCTS_PER_ITERATION = 1.7  # of relaxation
MOST_OF_STATES = 2.2  # times a bond's
LAWS = ["elastic", "tanh", "tanh with 2 % of the bonds broken"]


def measure(program, threads, options):
    """Best rate of each benchmark over the repetitions, by its name."""
    environment = dict(os.environ, OMP_NUM_THREADS=str(threads), OMP_THREAD_LIMIT=str(threads),
                       GOMP_SPINCOUNT="1000")
    command = [program, "--benchmark_format=json", "--benchmark_repetitions=7",
               "--benchmark_enable_random_interleaving=true", "--benchmark_min_time=0.15", *options]
    output = subprocess.run(command, env=environment, check=True, stdout=subprocess.PIPE,
                            stderr=subprocess.DEVNULL, text=True).stdout
    best = {}
    for run in json.loads(output)["benchmarks"]:
        if run["run_type"] != "iteration":
            continue
        name = run["run_name"].replace("/real_time", "").replace("dimension:", "").replace("width:", "")
        rate = next(run[key] for key in ("bond", "interaction", "point", "flop", "byte") if key in run)
        best[name] = max(best.get(name, 0.0), rate)
    return best


def print_relaxation(name, one, many):
    """A table row of relaxation's iterations, counted in products."""
    kind, _, case = name.partition("/")
    dimension, law, transient = (part.split(":")[-1] for part in case.split("/"))
    product = f"{kind}_product/{case}"
    breaking = ", breaking in every iteration" if transient == "1" else ""
    print(f"| {kind.replace('_', ' ')} iteration, {dimension}D, {LAWS[int(law)]}{breaking} | products "
          f"| {one[product] / one[name]:.2f} | {many[product] / many[name]:.2f} "
          f"| {many[name] / one[name]:.2f} | at most {PRODUCTS_PER_ITERATION} |")


def print_states(name, bonds, one, many):
    """A table row of a pass over states, counted in passes over the same bonds of the bond model."""
    kind, _, dimension = name.partition("/")
    ratio = [rates[f"{bonds}/{dimension}"] / rates[name] for rates in (one, many)]
    print(f"| {kind.replace('_', ' ')}, {dimension}D | {bonds.replace('_', ' ')} of bonds | {ratio[0]:.2f} | {ratio[1]:.2f} "
          f"| {many[name] / one[name]:.2f} | at most {MOST_OF_STATES} |")


def print_table(threads, one, many):
    dgemm, triad = one["dgemm"], one["stream_triad"]
    scale = min(dgemm / REFERENCE_DGEMM, triad / REFERENCE_TRIAD, 1.0)
    print(f"| measured | unit | 1 thread | {threads} threads | ratio | target, 1 thread, this machine |")
    print("|---|---|---|---|---|---|")
    print(f"| DGEMM | GF/s | {dgemm / 1e9:.1f} | {many['dgemm'] / 1e9:.1f} "
          f"| {many['dgemm'] / dgemm:.2f} | |")
    print(f"| STREAM triad | GB/s | {triad / 1e9:.1f} | {many['stream_triad'] / 1e9:.1f} "
          f"| {many['stream_triad'] / triad:.2f} | |")
    for name, rate in one.items():
        kind, _, case = name.partition("/")
        if kind not in ROWS:
            continue
        _, unit, unit_text, target = ROWS[kind]
        if kind == "factorisation":
            share = FACTORISATION_SHARE[case]
            told = f"{case}² points | {unit_text} ({rate / dgemm:.0%} of DGEMM)"
            goal = f"{share * dgemm / unit:.1f} ({share:.0%} of DGEMM)"
        elif kind == "optimised_weights":
            dimension, horizon, percent = (part.split(":")[-1] for part in case.split("/"))
            told = f"{dimension}D, horizon {horizon}, perturbed by {percent} % | {unit_text}"
            goal = f"{scale * WEIGHTS_TARGET[dimension] / unit:.0f}" if percent != "0" else ""
        elif kind.startswith("t") and "/" in case:
            horizon, stored = (part.split(":")[1] for part in case.split("/"))
            how = "stored" if stored == "1" else "found anew"
            told = f"horizon {int(horizon) / 1000:g}, {how} | {unit_text}"
            goal = f"{scale * target / unit:.0f}" if target and horizon != "2015" else ""
        else:
            told = f"{case}D | {unit_text}"
            goal = f"{scale * target / unit:.0f}" if target else ""
        print(f"| {kind.replace('_', ' ')}, {told} | {rate / unit:.1f} | {many[name] / unit:.1f} "
              f"| {many[name] / rate:.2f} | {goal} |")
    for name in sorted(one):
        if name.startswith(("state_gradient/", "state_product/")):
            print_states(name, "listed_gradient" if "gradient" in name else "listed_product", one, many)
        if name.startswith(("relaxation/", "listed_relaxation/")):
            print_relaxation(name, one, many)


def main():
    program = pathlib.Path(__file__).resolve().parent.parent / "build/release/peristat_bench"
    threads = len(os.sched_getaffinity(0))
    one = measure(program, 1, sys.argv[1:])
    print_table(threads, one, measure(program, threads, sys.argv[1:]))


if __name__ == "__main__":
    main()
