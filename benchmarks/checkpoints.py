"""Cost of checkpoints: ./peristat build && /usr/bin/python3 benchmarks/checkpoints.py [CASE [key=value]...]

Runs each case and prints the share of its wall time spent on checkpoints, and their bytes.
"""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py

ROOT = Path(__file__).resolve().parents[1]
CASES = [
    ["bar/tension"], ["cantilever/beam"], ["plate_with_hole/elastic"], ["plate_with_hole/elastic", "lattice.spacing=2.5e-4"],
    ["cpd/square_hole"], ["plate_with_hole/square"], ["plate_with_hole/rectangle"], ["three_point_bending/notched"],
    ["plate_with_hole/square", 'solver.mode="relaxation"', "relaxation.steps=200"],
]  # fmt: skip


def measure(case: str, settings: list[str]) -> str:
    program = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder) / "out"
        words = [word for setting in settings for word in ("--set", setting)]
        subprocess.run([program, "run", ROOT / "cases" / f"{case}.toml", "--output", out, "--quiet", *words], check=True)
        summary = json.loads((out / "summary.json").read_text())
        with h5py.File(out / "results.h5") as file:
            size = file["checkpoint"].size
    seconds = summary["seconds"]
    return (f"| `{' '.join([case, *settings])}` | {summary['points']} | {summary['steps']} | {seconds['total']:.2f} s | "
            f"{1e3 * seconds['checkpoints'] / summary['steps']:.2f} ms | {100 * seconds['checkpoints'] / seconds['total']:.2f} % | "
            f"{size / 1e3:.0f} kB |")  # fmt: skip


def main(words: list[str]) -> None:
    print("| case | points | steps | run | a checkpoint | share | bytes of one |\n|---|---|---|---|---|---|---|")
    for case, *settings in [words] if words else CASES:
        print(measure(case, settings), flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
