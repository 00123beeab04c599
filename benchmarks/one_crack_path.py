#!/usr/bin/env python3
"""One crack path: settings that mode path must not depend on, and settings that it depends on.

The square plate with a hole and the notched plate in three-point bending, brittle and with a
saw-tooth law, with one setting varied after the other: threads, steps of the load, event_tolerance, linear
solver, teeth. Prints one row per run: rows of the path, peak and load factor of the response under the given
loads, first snap, bonds broken, CPU seconds; and whether the ordered list of broken bonds is that of the
case's first run, with the largest difference of their load factors.

    /usr/bin/python3 -BEs benchmarks/one_crack_path.py [--cases square,...] [--vary threads,steps,...]

Seconds are CPU seconds of the whole run, which depend less on other load of the machine than wall time.
"""

import argparse
import csv
import os
import pathlib
import resource
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
BRITTLE = {"square": "0.0175", "notched": "0.02"}
CASES = {
    "square, brittle": ("plate_with_hole/square.toml", "top", BRITTLE["square"]),
    "notched, brittle": ("three_point_bending/notched.toml", "load", BRITTLE["notched"]),
    "square, tanh": ("plate_with_hole/square.toml", "top", None),
    "beam, linear": ("three_point_bending/rollers.toml", "load", None),
}
SOFTENING = """
[material.damage]
law = "linear"
fracture_energy = 50.0
no_fail = ["ends"]

[[set]]
name = "ends"
where = "(abs(x) > 0.035 && y < 0.005) || (abs(x) < 0.005 && y > 0.017)"

[loading]
stop_below = 0.7

[solver]
mode = "path"

[output]
every = 100000
"""
# Settings that must not change the path, and settings that may.
SAME = {
    "threads": [["--threads", "1"], ["--threads", "2"], ["--threads", "3"]],
    "steps": [["--set", f"loading.steps={n}"] for n in (1, 10, 1000)],
    "solver": [["--set", f"solver.linear={name}"] for name in ("cholesky", "pcg")],
}
OTHER = {
    "tolerance": [["--set", f"loading.event_tolerance={t}"] for t in (0, 0.002, 0.01, 0.02, 0.05)],
    "teeth": [["--set", f"loading.teeth={n}"] for n in (5, 10, 20, 40)],
    "smooth": [["--set", "solver.mode=newton", "--set", f"loading.steps={n}"] for n in (400, 1600)],
}


def case_text(file, critical):
    """The shipped case, in mode path; brittle bonds if they have a critical stretch."""
    if file.endswith("rollers.toml"):
        return (ROOT / "cases" / file).read_text().replace("-1e-6*load", "-3e-5*load") + SOFTENING
    lines, table = [], ""
    for line in (ROOT / "cases" / file).read_text().splitlines():
        if line.startswith("["):
            table = line.split("#")[0].strip()
        key = line.split("=")[0].strip()
        if table == "[relaxation]" or (table == "[solver]" and key == "mode"):
            continue
        if critical and table == "[material.damage]" and key in ("law", "onset", "critical", "rate"):
            continue
        lines.append(line)
        if table == "[solver]" and line.startswith("["):
            lines.append('mode = "path"')
        if critical and table == "[material.damage]" and line.startswith("["):
            lines += ['law = "critical_stretch"', f"critical = {critical}"]
    return "\n".join(lines) + "\n\n[output]\nevery = 100000\n"


def rows(file):
    with open(file, newline="") as table:
        return list(csv.DictReader(table))


def run(folder, text, options):
    case, out = folder / "case.toml", folder / "out"
    case.write_text(text)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ended = subprocess.run([PROGRAM, "run", case, "--output", out, "--overwrite", "--quiet", "--no-plots", *options])
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return ended.returncode, seconds, rows(out / "history.csv"), rows(out / "broken_bonds.csv")


def told(name, options, result, side, first):
    code, seconds, history, broken = result
    response = [row for row in history if row["on_response"] == "1"] or history
    force = lambda row: abs(float(row[f"reaction_y:{side}"]))
    peak = max(response, key=force)
    snapped = next((row for row in response if int(row["broken_bonds"]) > 0), response[-1])
    ends = [(row["first_point"], row["second_point"]) for row in broken]
    loads = [float(row["load_factor"]) for row in broken]
    known_ends, known_loads = first
    is_same = ends == known_ends
    apart = max((abs(a - b) for a, b in zip(loads, known_loads)), default=0.0)
    same = f"yes, {apart:.0e}" if is_same else "no"
    print(f"| {name} | {' '.join(options[1:])} | {len(history) - 1} | {force(peak):.9g} | {float(peak['load_factor']):.9g} "
          f"| {snapped['broken_bonds']} at {float(snapped['load_factor']):.6g} | {len(broken)} | {same} | {seconds:.0f} "
          f"| {code} |", flush=True)  # fmt: skip


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", default=",".join(CASES).replace(", ", " "))
    parser.add_argument("--vary", default=",".join([*SAME, *OTHER]), help="smooth is for the beam alone")
    asked = parser.parse_args()
    print("| case | setting | rows | peak [N] | at load | first snap | bonds | same bonds in the same order; loads | CPU s | exit |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, (file, side, critical) in CASES.items():
        if name.replace(", ", " ") not in asked.cases.split(","):
            continue
        first = None
        for what in asked.vary.split(","):
            if (what == "teeth" and critical) or (what == "smooth" and not file.endswith("rollers.toml")):
                continue
            for options in (SAME | OTHER)[what]:
                with tempfile.TemporaryDirectory(prefix="peristat_path_") as folder:
                    result = run(pathlib.Path(folder), case_text(file, critical), options)
                ends = [(row["first_point"], row["second_point"]) for row in result[3]]
                first = first or (ends, [float(row["load_factor"]) for row in result[3]])
                told(name, options, result, side, first)


if __name__ == "__main__":
    main()
