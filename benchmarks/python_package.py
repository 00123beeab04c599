"""What the Python package costs, as a table.

    PERISTAT_PROGRAM=build/release/peristat PYTHONPATH=python /usr/bin/python3 -B benchmarks/python_package.py

Memory of 1000 bodies made and dropped; time of a small run; time of a callback of each step; arrays of a million
points without a copy; histories of shipped cases from Python and from the program, byte by byte.
"""

import os
import pathlib
import resource
import subprocess
import tempfile
import time

import peristat as ps

ROOT = pathlib.Path(__file__).resolve().parents[1]
SHIPPED = ["buckling/column", "three_point_bending/toughness"]
MEMORY = "/dev/shm" if os.path.isdir("/dev/shm") else None  # files without a disk


def square(points):
    """An elastic square of points x points, pulled in one step."""
    case = ps.Case("square", dimension=2)
    case.lattice.update(spacing=1e-3, thickness=1e-3)
    case.lattice.add_shape(add="box", min=[0, 0], max=[points * 1e-3, points * 1e-3])
    case.add_set(name="left", where="x < 3e-3")
    case.add_set(name="right", where=f"x > {points - 3}e-3")
    case.material.youngs_modulus = 70e9
    case.add_support(set="left", displacement=["0", "0"])
    case.add_support(set="right", displacement=["1e-6*load", "free"])
    return case


def bar(steps):
    """A moving bar of 20 points with a row of the history per time step."""
    case = ps.Case("moving_bar", dimension=1)
    case.lattice.update(spacing=1e-3, area=1e-6)
    case.lattice.add_shape(add="box", min=[0], max=[20e-3])
    case.add_set(name="left", where="x < 3e-3")
    case.material.update(youngs_modulus=70e9, density=2500)
    case.add_support(set="left", displacement=["1e-6*t/1e-4"])
    time_step = 5e-8
    case.dynamics.update(time_step=time_step, end_time=steps * time_step, history_every=1)
    case.output.every = steps
    case.solver.mode = "dynamics"
    return case


def resident():
    """Memory of this process now [bytes]."""
    pages = int(pathlib.Path("/proc/self/statm").read_text().split()[1])
    return pages * resource.getpagesize()


def growth(count=1000, points=14):
    """Memory that is left after making and dropping bodies [bytes], and the time for one [s]."""
    case = square(points)
    for _ in range(100):  # what is kept once
        case.body().positions
    before, start = resident(), time.perf_counter()
    for _ in range(count):
        case.body().positions
    return resident() - before, (time.perf_counter() - start) / count


def seconds_of_run(folder, count=20):
    """Time of a run of 196 points with its results folder, the smallest of some [s]."""
    case, times = square(14), []
    for k in range(count):
        start = time.perf_counter()
        case.solve(output=folder / f"small-{k}", quiet=True)
        times.append(time.perf_counter() - start)
    return min(times)


def cost_of_callbacks(folder, steps=500, turns=30):
    """Time of a step without a callback, and what an empty one and one that reads a field add [s]."""
    body, called = bar(steps).body(), []
    callbacks = [None, lambda step: called.append(step.load), lambda step: step.displacement]
    times = [[], [], []]
    for turn in range(turns):  # in turn, so that a busy machine slows all alike
        for kind, on_step in enumerate(callbacks):
            start = time.perf_counter()
            body.solve(output=folder / f"steps-{turn}-{kind}", quiet=True, on_step=on_step, threads=1)
            times[kind].append(time.perf_counter() - start)
    assert len(called) >= turns * steps, len(called)
    plain, counted, copied = (min(each) / steps for each in times)
    return plain, counted - plain, copied - plain


def million(folder):
    """Times of making and solving a million points [s]; whether their arrays are views of one memory."""
    case = square(1000)
    case.solver.relative_tolerance = 1e-4
    case.output.every = 1
    start = time.perf_counter()
    body = case.body()
    made = time.perf_counter() - start
    first, second = body.positions, body.positions
    run = body.solve(output=folder / "million", quiet=True)
    solved = time.perf_counter() - start - made
    pairs = [(first, second), (run.displacement(), run.displacement())]
    same = all(one.ctypes.data == other.ctypes.data and not one.flags.owndata for one, other in pairs)
    return body.count, made, solved, same


def has_same_history(name, folder):
    """Whether a shipped case has the same history.csv from Python and from the program."""
    file, ways = ROOT / f"cases/{name}.toml", [folder / f"{name}-program", folder / f"{name}-python"]
    subprocess.run(
        [os.environ["PERISTAT_PROGRAM"], "run", file, "--output", ways[0], "--no-plots", "--quiet", "--threads", "1"],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    ps.load_case(file).solve(output=ways[1], quiet=True, threads=1)
    program, python = ((way / "history.csv").read_bytes() for way in ways)
    return program == python, program.count(b"\n") - 1


def cost_of_sampled_law(folder, turns=2):
    """Time of an iteration of relaxation of a softening square, with a sampled law over the built-in one."""
    case, onset, critical = square(30), 1e-4, 2e-2
    case.set("support[1].displacement[0]", "1e-4*load")
    case.set("solver.mode", "relaxation")
    case.set("relaxation.steps", 1)
    laws = [
        {"law": "linear", "onset": onset, "critical": critical},
        ps.sampled_law(lambda s: onset * (critical - s) / (critical - onset), onset, critical, samples=1000),
    ]
    times = [[], []]
    for turn in range(turns):
        for kind, law in enumerate(laws):
            case.material.damage = law
            body, start = case.body(), time.perf_counter()
            run = body.solve(output=folder / f"law-{turn}-{kind}", quiet=True, threads=1)
            iterations = run.history["relaxation_iterations"].sum()
            times[kind].append((time.perf_counter() - start) / iterations)
            assert run.field("damage").max() > 0.05, run.field("damage").mean()
    return min(times[1]) / min(times[0])


def row(what, value):
    print(f"| {what} | {value} |", flush=True)


def main():
    print("| measured | value |\n|---|---|")
    with tempfile.TemporaryDirectory(dir=MEMORY) as name:
        folder = pathlib.Path(name)
        bytes_left, each = growth()
        row("memory left by 1000 bodies of 196 points, made and dropped", f"{bytes_left / 1e6:.2f} MB")
        row("making one of them", f"{each * 1e3:.2f} ms")
        row("a run of it in one step, with its results folder", f"{seconds_of_run(folder) * 1e3:.0f} ms")
        plain, counted, copied = cost_of_callbacks(folder)
        row("a time step of 20 points with a row of the history", f"{plain * 1e6:.1f} µs")
        row("added by a callback that reads the load", f"{counted * 1e6:.1f} µs")
        row("added by a callback that copies the displacement", f"{copied * 1e6:.1f} µs")
        ratio = cost_of_sampled_law(folder)
        row("an iteration with a law of 1000 samples of a NumPy function, over the built-in law", f"{ratio:.2f}")
        for case in SHIPPED:
            same, rows = has_same_history(case, folder)
            row(f"history of {case}.toml from Python and the program, {rows} rows", "equal" if same else "DIFFERENT")
        count, made, solved, same = million(folder)
        row(f"making {count} points in 2D; a step of them", f"{made:.1f} s; {solved:.0f} s")
        row("their positions and displacements", "one memory, no copy" if same else "COPIED")


if __name__ == "__main__":
    main()
