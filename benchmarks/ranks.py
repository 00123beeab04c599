#!/usr/bin/env python3
"""Bodies on MPI ranks: seconds, memory, messages and bytes compared with the model of docs/cluster.md.

    benchmarks/ranks.py [--side N] [--rounds N] [--preconditioner NAME] [--most N] [--program FILE]

A cube of N x N x N points (50) with layers of three that are held and moved, one static step. Each
round takes all numbers of ranks, up to --most (8), in turn; seconds are the minimum over the rounds (3).
"""

import argparse
import itertools
import json
import os
import pathlib
import re
import subprocess
import tempfile
import time

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/peristat"
HORIZON_RATIO, LAYER = 3.015, 3
CASE = """
dimension = 3
[lattice]
spacing = {spacing}
horizon_ratio = {ratio}
shape = [{{ add = "box", min = [0, 0, 0], max = [1, 1, 1] }}]
layer = [{{ name = "held", side = "x-", thickness = {layer} }},
         {{ name = "moved", side = "x+", thickness = {layer} }}]
[material]
youngs_modulus = 70e9
[[support]]
set = "held"
displacement = [0, 0, 0]
[[support]]
set = "moved"
displacement = ["1e-3*load", 0, 0]
[loading]
steps = 1
[solver]
linear = "pcg"
preconditioner = "{preconditioner}"
tangent = "matrix_free"
"""
# (ranks, threads of each); the first gives the model's constants.
RUNS = [(1, 1), (1, 2), (2, 1), (3, 1), (4, 1), (8, 1)]


def proportional_bytes(program):
    """Memory of all processes of a program; shared pages, as of libraries, count once."""
    held = 0
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(process / "exe") == str(program):
                rollup = (process / "smaps_rollup").read_text()
                held += 1024 * int(re.search(r"^Pss: +(\d+) kB", rollup, re.MULTILINE)[1])
        except (OSError, TypeError):  # it has ended
            pass
    return held


def command_of(wanted, side, ranks, threads, folder):
    case = folder / "cube.toml"
    case.write_text(CASE.format(spacing=1 / side, ratio=HORIZON_RATIO, layer=LAYER,
                                preconditioner=wanted.preconditioner))
    command = [wanted.program, "run", case, "--threads", str(threads), "--no-plots", "--overwrite",
               "--output", folder / "results"]
    if ranks > 1:
        command += ["--ranks", str(ranks)]
    return [str(word) for word in command]


ENVIRONMENT = os.environ | {"OMP_WAIT_POLICY": "passive"}


def most_memory(wanted, side, ranks, threads, folder):
    """Peak of the total memory of a run's processes, sampled ten times a second [bytes]."""
    program = wanted.program.resolve()
    most = 0
    with subprocess.Popen(command_of(wanted, side, ranks, threads, folder), env=ENVIRONMENT,
                          stdout=subprocess.DEVNULL) as running:
        while running.poll() is None:
            most = max(most, proportional_bytes(program))
            time.sleep(0.1)
    if running.returncode != 0:
        raise SystemExit(f"the run on {ranks} ranks ended with exit code {running.returncode}")
    return most


def run(wanted, side, ranks, threads, folder):
    """The figures that a run prints; all of its output if it fails."""
    done = subprocess.run(command_of(wanted, side, ranks, threads, folder), capture_output=True,
                          text=True, check=False, env=ENVIRONMENT)
    if done.returncode != 0:
        raise SystemExit(done.stdout + done.stderr)
    told = json.loads((folder / "results/summary.json").read_text())
    own = re.search(r"at most (\d+) points on a rank, (\d+) ghosts", done.stdout)
    sent = re.search(r"ghosts exchanged (\d+) times: (\d+) messages, (\d+) bytes", done.stdout)
    if ranks > 1:
        told["own"], told["ghosts"] = (int(count) for count in own.groups())
        told["exchanges"], told["messages"], told["bytes"] = (int(n) for n in sent.groups())
    return told


def least(runs):
    """One of the runs, with the least time over all runs for each part."""
    for part in runs[0]["seconds"]:
        runs[0]["seconds"][part] = min(one["seconds"][part] for one in runs)
    return runs[0]


def bisected(low, high, parts):
    """The boxes from halving a box across its longest side recursively."""
    if parts == 1:
        return [(low, high)]
    axis = int(np.argmax(np.subtract(high, low)))
    first = parts // 2
    cut = low[axis] + round((high[axis] - low[axis]) * first / parts)
    end, start = list(high), list(low)
    end[axis] = start[axis] = cut
    return bisected(low, tuple(end), first) + bisected(tuple(start), high, parts - first)


def within_horizon(box, other):
    """Number of points of the other box within the horizon of this box's points."""
    squares = []
    for (low, high), (first, end) in zip(zip(*box), zip(*other)):
        at = np.arange(first, end)
        squares.append(np.maximum(np.maximum(low - at, at - high + 1), 0.0) ** 2)
    x, y, z = squares
    distance = x[:, None, None] + y[None, :, None] + z[None, None, :]
    return int(np.count_nonzero(distance <= HORIZON_RATIO**2))


def predicted(side, ranks):
    """Largest numbers over the ranks: own points, ghosts, and messages of an exchange."""
    boxes = bisected((0, 0, 0), (side + 2 * LAYER, side, side), ranks)
    seen = [within_horizon(one, other) for one, other in itertools.permutations(boxes, 2)]
    own = max(int(np.prod(np.subtract(high, low))) for low, high in boxes)
    return own, sum(seen), sum(count > 0 for count in seen)


def row(name, values):
    print("|", name, "|", " | ".join(values), "|")


def table_of_runs(told, memory_of_all):
    row("", [f"{ranks} rank{'s' * (ranks > 1)} of {threads} thread{'s' * (threads > 1)}"
             for ranks, threads in told])
    print("|---" * (len(told) + 1) + "|")
    for part in ("total", "neighbourhood", "assembly", "linear", "output"):
        row(f"seconds, {part}", [f"{one['seconds'][part]:.2f}" for one in told.values()])
    row("MB of the largest rank", [f"{one['peak_memory_bytes'] / 1e6:.0f}" for one in told.values()])
    row("MB of all ranks, what they share once",
        [f"{memory_of_all[to] / 1e6:.0f}" for to in told])
    row("iterations", [str(one["linear_iterations"]) for one in told.values()])


def table_of_counts(told, side, memory):
    on_several = {ranks: one for (ranks, _), one in told.items() if ranks > 1}
    print()
    row("counts of runs (and of the model)", [f"{ranks} ranks" for ranks in on_several])
    print("|---" * (len(on_several) + 1) + "|")
    models = {ranks: predicted(side, ranks) for ranks in on_several}
    for place, name in enumerate(("own", "ghosts", "messages")):
        row(name, [f"{one[name]} ({models[ranks][place]})" for ranks, one in on_several.items()])
    row("bytes", [f"{one['bytes']} ({24 * models[ranks][1]})" for ranks, one in on_several.items()])
    row("exchanges", [str(one["exchanges"]) for one in on_several.values()])
    row("MB of the largest rank", [f"{one['peak_memory_bytes'] / 1e6:.0f} "
                         f"({memory(models[ranks][0] + models[ranks][1] / ranks) / 1e6:.0f})"
                         for ranks, one in on_several.items()])


def forecast(points, ranks, side, iterations, growth, seconds_per_bond, memory):
    """Estimate for an interior rank of a cube that is partitioned into cubes."""
    across = points ** (1 / 3)
    own = round(across / ranks ** (1 / 3))
    reach = int(HORIZON_RATIO)
    around = within_horizon(((reach,) * 3, (reach + own,) * 3), ((0,) * 3, (own + 2 * reach,) * 3))
    ghosts = around - own**3
    bonds = 61 * own**3 + 0.5 * 61 * (ghosts / 2)
    products = iterations * (across / side) ** growth
    print(f"{points:.0e} points on {ranks} ranks: {own**3} own points of a rank, {ghosts} ghosts, "
          f"26 messages of {24 * ghosts / 1e6:.2f} MB in all, "
          f"{memory(own**3 + ghosts) / 1e6:.0f} MB; {products:.0f} products of "
          f"{bonds * seconds_per_bond * 1e3:.0f} ms, {products * bonds * seconds_per_bond:.0f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--side", type=int, default=50, metavar="N")
    parser.add_argument("--rounds", type=int, default=3, metavar="N")
    parser.add_argument("--preconditioner", default="block_jacobi", metavar="NAME")
    parser.add_argument("--most", type=int, default=8, metavar="N")
    parser.add_argument("--program", type=pathlib.Path, default=PROGRAM, metavar="FILE")
    wanted = parser.parse_args()
    side = wanted.side
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        half = run(wanted, side // 2, 1, 1, folder)
        half_on_two = run(wanted, side // 2, 2, 1, folder)
        runs = [to for to in RUNS if to[0] <= wanted.most]
        memory_of_all = {to: most_memory(wanted, side, *to, folder) for to in runs}
        rounds = [{to: run(wanted, side, *to, folder) for to in runs} for _ in range(wanted.rounds)]
    told = {to: least([one[to] for one in rounds]) for to in runs}
    one = told[runs[0]]
    per_point = (one["peak_memory_bytes"] - half["peak_memory_bytes"]) / (one["points"]
                                                                         - half["points"])
    program = half_on_two["peak_memory_bytes"] - per_point * (half_on_two["own"]
                                                              + half_on_two["ghosts"] / 2)
    per_bond = one["seconds"]["linear"] / (one["linear_iterations"] * one["bonds"])
    growth = np.log(one["linear_iterations"] / half["linear_iterations"]) / np.log(side
                                                                                   / (side // 2))

    def memory(points):
        return program + per_point * points

    table_of_runs(told, memory_of_all)
    table_of_counts(told, side, memory)
    print(f"\n{per_bond * 1e9:.2f} ns a bond and product; {program / 1e6:.0f} MB of a rank + "
          f"{per_point:.0f} B a point; iterations {half['linear_iterations']} at {side // 2}, "
          f"{one['linear_iterations']} at {side}: exponent {growth:.2f}")
    for points, ranks in ((1e8, 1000), (1e9, 10000)):
        forecast(points, ranks, side, one["linear_iterations"], growth, per_bond, memory)


if __name__ == "__main__":
    main()
