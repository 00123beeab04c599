#!/usr/bin/env python3
"""Fracture on one, two and three threads: the same bonds break in the same steps, after the same
numbers of relaxation iterations.

The Newton iterations that finish relaxed steps are printed but not compared: their linear systems are
solved iteratively, and if the residual comes close to the tolerance, round-off decides on one more
iteration.

    /usr/bin/python3 benchmarks/thread_independence.py [--threads 1,2,3] [--bits] [CASE[:key=value...]...]

Prints a row per case and number of threads; exits with 1 if they differ. Without cases, the four
problems of fracture are run as shipped. With --bits every row of the history and every field is
compared, to the last bit: for relaxation and explicit steps.
"""

import argparse
import csv
import json
import os
import pathlib
import subprocess
import sys
import tempfile

import h5py

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
CASES = ["plate_with_hole/square", "plate_with_hole/rectangle", "three_point_bending/notched",
         "four_holes/tension"]  # fmt: skip
COUNTS = ["step", "mode", "relaxation_iterations", "broken_bonds"]


def rows(file):
    with open(file, newline="") as table:
        return list(csv.DictReader(table))


def run(case, settings, threads, folder):
    """@return counts of each step, the bonds that break in each, and the text to print"""
    command = [PROGRAM, "run", str(ROOT / "cases" / f"{case}.toml"), "--quiet", "--output", folder]
    for setting in settings:
        command += ["--set", setting]
    subprocess.run(command + ["--threads", str(threads)], check=True)
    history = rows(f"{folder}/history.csv")
    counts = [[row[name] for name in COUNTS] for row in history]
    bonds = [(row["step"], row["first_point"], row["second_point"])
             for row in rows(f"{folder}/broken_bonds.csv")]  # fmt: skip
    summary = json.loads(pathlib.Path(f"{folder}/summary.json").read_text())
    broken = [row for row in history if int(row["broken_bonds"]) > 0]
    first = f"{broken[0]['broken_bonds']} at {float(broken[0]['load_factor']):.4f}" if broken else "none"
    told = (f"| {case} | {threads} | {summary['steps']} | {summary['newton_iterations']} "
            f"| {summary['relaxation_iterations']} | {first} | {summary['broken_bonds']} |")  # fmt: skip
    return counts, bonds, told


def bits(folder):
    """The history, and the bytes of all numbers of the results by their names."""
    found = {"history.csv": pathlib.Path(f"{folder}/history.csv").read_bytes()}

    def take(name, item):
        is_number = isinstance(item, h5py.Dataset) and item.dtype.kind in "fiu"
        if is_number and name != "checkpoint":  # which holds times
            found[name] = item[()].tobytes()

    with h5py.File(f"{folder}/results.h5") as file:
        file.visititems(take)
    return found


def compare(case, settings, threads, to_the_bit):
    """@return whether the runs on all numbers of threads agree"""
    found = []
    for count in threads:
        with tempfile.TemporaryDirectory(prefix="peristat_threads_") as folder:
            *result, told = run(case, settings, count, f"{folder}/results")
            if to_the_bit:
                result.append(bits(f"{folder}/results"))
        print(told, flush=True)
        found.append(result)
    return all(result == found[0] for result in found)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--threads", default="1,2,3")
    parser.add_argument("--bits", action="store_true")
    parser.add_argument("cases", nargs="*", default=CASES, metavar="CASE[:key=value...]")
    asked = parser.parse_args()
    threads = [int(count) for count in asked.threads.split(",")]
    print("| case | threads | steps | Newton iterations | relaxation iterations | first broken bonds "
          "| broken bonds |\n|---|---|---|---|---|---|---|")  # fmt: skip
    same = True
    for entry in asked.cases:
        case, *settings = entry.split(":")
        if not compare(case, settings, threads, asked.bits):
            print(f"{case}: the runs differ", file=sys.stderr)
            same = False
    return 0 if same else 1


if __name__ == "__main__":
    sys.exit(main())
