"""Seconds of an explicit time step per directed bond: crack_branching as shipped.

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -BEs benchmarks/time_steps.py [--threads 1 2] [--runs 5]

Prints for each number of threads the least time in the passes over the bonds over steps and directed bonds, and the
least time of the whole run, both as wall time and as CPU time, which depends less on other load of the machine. The
time of the steps includes passes outside the steps (fields, the stable step).
"""

import argparse
import json
import os
import pathlib
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))


def summary(folder, threads):
    case = ROOT / "cases/bond_models/crack_branching.toml"
    subprocess.run([PROGRAM, "run", case, "--output", folder, "--threads", str(threads), "--quiet", "--overwrite", "--no-plots"],
                   check=True)  # fmt: skip
    spent = resource.getrusage(resource.RUSAGE_CHILDREN)
    steps = int((folder / "history.csv").read_text().splitlines()[-1].split(",")[0])
    return json.loads((folder / "summary.json").read_text()) | {"time_steps": steps, "processor": spent.ru_utime + spent.ru_stime}


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", type=int, nargs="+", default=[1, 2])
    parser.add_argument("--runs", type=int, default=5)
    options = parser.parse_args()
    print("threads  ns per directed bond and step  whole run [s]  of the processor [s]")
    with tempfile.TemporaryDirectory() as folder:
        for threads in options.threads:
            runs, processor, before = [], [], resource.getrusage(resource.RUSAGE_CHILDREN)
            before = before.ru_utime + before.ru_stime
            for _ in range(options.runs):
                runs.append(summary(pathlib.Path(folder) / "out", threads))
                processor.append(runs[-1]["processor"] - before)
                before = runs[-1]["processor"]
            directed = 2 * runs[0]["bonds"] * runs[0]["time_steps"]
            least = min(run["seconds"]["assembly"] for run in runs)
            print(f"{threads:7}  {1e9 * least / directed:29.2f}  {min(run['seconds']['total'] for run in runs):13.2f}  {min(processor):20.2f}")


if __name__ == "__main__":
    main()
