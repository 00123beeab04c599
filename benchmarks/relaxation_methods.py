#!/usr/bin/env python3
"""Relaxation with kinetic damping and the flow without inertia: uniqueness and speed.

The four problems of fracture, both ways of breaking bonds, on one, two and three threads; kinetic
damping with three ramps, the flow with three tolerances. Prints a row per run, then a line per case,
method and way of breaking: whether all its runs took one path up to the first snap, and in total.

    /usr/bin/python3 -BEs benchmarks/relaxation_methods.py [--first-snap] [--coarse] [--limit SECONDS]
        [--threads 1,2,3] [--cases square,rectangle] [--methods kinetic,flow] [--breaking transient]

--first-snap ends a run as soon as bonds have broken; --coarse doubles the spacing; a run that takes
longer than --limit is ended and listed as not finished. Seconds are CPU seconds of the whole run, which
depend less on other load of the machine than wall time; compare only runs made at the same time.
"""

import argparse
import csv
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
CASES = {
    "square": ("plate_with_hole/square", "2e-3"),
    "rectangle": ("plate_with_hole/rectangle", "2e-3"),
    "notched": ("three_point_bending/notched", "2.4e-3"),
    "four_holes": ("four_holes/tension", "2e-3"),
}
# Settings that a method's path must not depend on.
METHODS = {
    "kinetic": [[f"relaxation.ramp={ramp}"] for ramp in (50, 100, 200)],
    "flow": [["relaxation.method=flow", f"relaxation.flow_tolerance={t}"] for t in (0.05, 0.1, 0.2)],
}


def rows(file):
    try:
        with open(file, newline="") as table:
            return list(csv.DictReader(table))
    except FileNotFoundError:
        return []


def snaps(history):
    """(bonds broken so far, load factor) of the steps in which bonds broke"""
    found, before = [], 0
    for row in history:
        # The last row of a file that is being written may be incomplete.
        if not row.get("broken_bonds") or None in row.values():
            continue
        count = int(row["broken_bonds"])
        if count > before:
            found.append((count, round(float(row["load_factor"]), 6)))
        before = count
    return found


def run(command, folder, limit, first_snap):
    """@return CPU seconds, and whether the run reached its goal"""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    started = time.monotonic()
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    stopped = has_snapped = False
    while process.poll() is None:
        time.sleep(0.2)
        has_snapped = first_snap and snaps(rows(f"{folder}/history.csv"))
        if has_snapped or time.monotonic() - started > limit:
            stopped = True
            process.send_signal(signal.SIGINT)
            process.wait()
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    if process.returncode in (1, 2):
        sys.exit(" ".join(command) + " is refused")
    return seconds, bool(has_snapped) if stopped else process.returncode == 0


def measure(name, settings, threads, asked):
    case, coarse = CASES[name]
    with tempfile.TemporaryDirectory(prefix="peristat_relaxation_") as place:
        folder = f"{place}/results"
        command = [PROGRAM, "run", str(ROOT / "cases" / f"{case}.toml"), "--quiet", "--no-plots",
                   "--threads", str(threads), "--output", folder]  # fmt: skip
        for setting in settings + ([f"lattice.spacing={coarse}"] if asked.coarse else []):
            command += ["--set", setting]
        seconds, finished = run(command, folder, asked.limit, asked.first_snap)
        history = rows(f"{folder}/history.csv")
        bonds = [(row["step"], row["first_point"], row["second_point"])
                 for row in rows(f"{folder}/broken_bonds.csv")]  # fmt: skip
    found = snaps(history)
    if asked.first_snap and found:
        found, step = found[:1], min(int(bond[0]) for bond in bonds)
        history = [row for row in history if int(row["step"]) <= step]
        bonds = [bond for bond in bonds if int(bond[0]) <= step]
    iterations = sum(int(row["relaxation_iterations"]) for row in history)
    return found, bonds, iterations, seconds, finished


def told(snap):
    return f"{snap[0]} at {snap[1]:.4f}" if snap else "none"


def compare(name, method, breaking, asked):
    first, whole, all_seconds, missing = set(), set(), [], 0
    for settings in METHODS[method]:
        for threads in (int(count) for count in asked.threads.split(",")):
            found, bonds, iterations, seconds, finished = measure(
                name, settings + [f"relaxation.breaking={breaking}"], threads, asked)  # fmt: skip
            value = settings[-1].split("=")[1]
            last = told(found[-1]) if found else "none"
            print(f"| {name} | {breaking} | {method} {value} | {threads} "
                  f"| {told(found[0] if found else None)} | {last} | {iterations} | {seconds:.1f} "
                  f"| {'' if finished else 'not finished'} |", flush=True)  # fmt: skip
            if not finished:
                missing += 1
                continue
            step = min((int(bond[0]) for bond in bonds), default=0)
            first.add((tuple(found[:1]), frozenset(b[1:] for b in bonds if int(b[0]) == step)))
            whole.add(frozenset(bonds))
            all_seconds.append(seconds)
    sentence = f"{name}, {breaking}, {method}: {len(first)} first snap(s)"
    if not asked.first_snap:
        sentence += f", {len(whole)} set(s) of broken bonds"
    if all_seconds:
        sentence += f", {sum(all_seconds) / len(all_seconds):.1f} CPU seconds a run"
    return sentence + (f", {missing} not finished" if missing else "")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--first-snap", action="store_true")
    parser.add_argument("--coarse", action="store_true")
    parser.add_argument("--limit", type=float, default=600.0)
    parser.add_argument("--threads", default="1,2,3")
    parser.add_argument("--cases", default=",".join(CASES))
    parser.add_argument("--methods", default=",".join(METHODS))
    parser.add_argument("--breaking", default="transient,at_equilibrium")
    asked = parser.parse_args()
    print("| case | breaking | method | threads | first broken bonds | all broken bonds "
          "| relaxation iterations | CPU s | |\n|---|---|---|---|---|---|---|---|---|")  # fmt: skip
    sentences = [compare(name, method, breaking, asked) for name in asked.cases.split(",")
                 for breaking in asked.breaking.split(",") for method in asked.methods.split(",")]  # fmt: skip
    print("\n" + "\n".join(sentences))
    return 0


if __name__ == "__main__":
    sys.exit(main())
