"""Seconds of the adaptive mode and of dynamic relaxation alone, as in Table 1 of [ADAPT].

    ./peristat bench --table1 [--problems 1,2] [--threads N] [--output FILE.md]

Each of the four problems is run three times, one run after the other:

    adaptive     the case as shipped: Newton's method, and relaxation where bonds are damaged
    published    relaxation alone as published: the load moves a little in every iteration, so that no
                 state need be in equilibrium (problem 1: load at once, until ||du||/||u|| < 1e-9)
    equilibrium  relaxation alone in the case's steps, each of them relaxed to equilibrium

The table is printed and written to FILE.md (results/table1.md). Ratios are of CPU seconds, which depend
little on other programs on the machine; [ADAPT] used one core. Exits with 1 if a run failed, with 2 if
FILE.md is not an earlier table.
"""

import argparse
import csv
import dataclasses
import json
import math
import pathlib
import resource
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "cases/runner/sweep"))

from own_files import ForeignFile, require_own, write_own  # noqa: E402

PROGRAM = ROOT / "build/release/peristat"
TOLD_STATES = 100  # recorded states of the published mode; divides every number of iterations
SIGN = b"Seconds (of CPU)"  # signature of the file with the table
MODES = ("adaptive", "published", "equilibrium")


@dataclasses.dataclass
class Problem:
    title: str
    case: str
    reaction: str  # set whose reaction along y is reported
    iterations: int | None  # of the published mode; None: until displacements no longer change
    published: tuple[float, float]  # seconds of relaxation and of the adaptive method


PROBLEMS = {
    1: Problem("beam, 3D", "cantilever/beam", "clamped", None, (4109, 29)),
    2: Problem("square with hole", "plate_with_hole/square", "top", 1000, (160, 15)),
    3: Problem("three-point bending", "three_point_bending/notched", "load", 40_000, (275, 43)),
    4: Problem("four holes", "four_holes/tension", "top", 80_000, (2368, 51)),
}


def settings_of(mode, problem):
    if mode == "adaptive":
        return ["solver.mode=adaptive"]
    relaxed = ["solver.mode=relaxation"]
    if mode == "equilibrium":
        return relaxed
    if problem.iterations is None:
        return [*relaxed, "loading.steps=1", "relaxation.load=fixed", "relaxation.ramp=1",
                "relaxation.damping=adaptive",
                "relaxation.displacement_tolerance=1e-9", "solver.relative_tolerance=1e-14"]  # fmt: skip
    return [*relaxed, "relaxation.load=moving", f"relaxation.iterations={problem.iterations}",
            f"relaxation.steps={TOLD_STATES}"]  # fmt: skip


@dataclasses.dataclass
class Measured:
    code: int
    message: str  # text of the error stream
    cpu_seconds: float
    summary: dict | None
    peak: float  # largest reaction along y of the recorded states [N]
    residual: float  # relative, of the last state


def measure(problem, mode, threads):
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name) / "results"
        command = [PROGRAM, "run", ROOT / f"cases/{problem.case}.toml", "--quiet", "--output", folder]
        for setting in settings_of(mode, problem):
            command += ["--set", setting]
        if threads:
            command += ["--threads", str(threads)]
        before = cpu_seconds()
        done = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        seconds = cpu_seconds() - before
        summary, peak, residual = None, math.nan, math.nan
        if (folder / "summary.json").exists():
            summary = json.loads((folder / "summary.json").read_text())
            peak = max(map(abs, column(folder / "history.csv", f"reaction_y:{problem.reaction}")), default=math.nan)
            residual = next(reversed(column(folder / "iterations.csv", "relative_residual")), math.nan)
        return Measured(done.returncode, done.stderr.strip(), seconds, summary, peak, residual)


def cpu_seconds():
    """CPU seconds of all runs that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def column(file, name):
    with open(file, newline="") as table:
        return [float(row[name]) for row in csv.DictReader(table)]


def cells(run):
    """The cells of one run."""
    if not run.summary:
        return f"**failed** (exit code {run.code})"
    summary = run.summary
    text = (f"{summary['seconds']['total']:.1f} s ({run.cpu_seconds:.1f} s), "
            f"{summary['relaxation_iterations']} / {summary['newton_iterations']}, "
            f"{summary['broken_bonds']}, {run.peak:.4g} N, {run.residual:.0e}")  # fmt: skip
    return text if run.code == 0 else f"{text}; **{summary['status']}** (exit code {run.code})"


def ratio(run, to):
    return f"{run.cpu_seconds / to.cpu_seconds:.1f}" if run.code == 0 and to.code == 0 else "–"


def row_of(number, problem, runs):
    relaxed, adaptive = problem.published
    (a, b, c), told = (runs[mode] for mode in MODES), f"{relaxed} s, {adaptive} s, {relaxed / adaptive:.1f}"
    ran = " | ".join(map(cells, (a, b, c)))
    return f"| {number}, {problem.title} | {ran} | {ratio(b, a)} | {ratio(c, a)} | {told} |"


def options():
    parser = argparse.ArgumentParser(prog="./peristat bench --table1", description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    parser.add_argument("--problems", default="1,2,3,4", help="numbers, with commas between them (all)")
    parser.add_argument("--threads", type=int, help="of the program (its default)")
    parser.add_argument("--output", type=pathlib.Path, default="results/table1.md", metavar="FILE.md")
    given = parser.parse_args()
    try:
        given.problems = [int(number) for number in given.problems.split(",")]
    except ValueError:
        parser.error("--problems: numbers with commas between them, such as 1,2")
    if unknown := sorted(set(given.problems) - set(PROBLEMS)):
        parser.error(f"--problems: there is no problem {unknown[0]}; there are 1 to 4")
    return given


def main():
    given = options()
    try:
        require_own(given.output, SIGN)
    except ForeignFile as error:
        print(f"bench: {error}", file=sys.stderr)
        sys.exit(2)
    lines, all_went_well, threads = [], True, set()
    for number in given.problems:
        problem, runs = PROBLEMS[number], {}
        for mode in MODES:
            print(f"problem {number}, {mode} ...", end=" ", file=sys.stderr, flush=True)
            runs[mode] = run = measure(problem, mode, given.threads)
            print(cells(run), file=sys.stderr)
            if run.code != 0:
                print(f"exit code {run.code}: {run.message}", file=sys.stderr)
                all_went_well = False
            if run.summary:
                threads.add(run.summary["threads"])
        lines.append(row_of(number, problem, runs))
    head = [
        f"{SIGN.decode()}, iterations of relaxation / of Newton's method, broken bonds, peak reaction, relative "
        f"residual of the last state; threads: {', '.join(map(str, sorted(threads)))}.",
        "",
        "| problem | (a) adaptive | (b) relaxation as published | (c) relaxation to equilibrium | (b)/(a) | (c)/(a) "
        "| [ADAPT]: relaxation, adaptive, ratio |",
        "|---|---|---|---|---|---|---|",
    ]  # fmt: skip
    table = "\n".join([*head, *lines]) + "\n"
    print(table, end="")
    given.output.parent.mkdir(parents=True, exist_ok=True)
    write_own(given.output, table.encode(), SIGN)
    sys.exit(0 if all_went_well else 1)


if __name__ == "__main__":
    main()
