"""Sizes of pages and seconds to make them: ./peristat build && /usr/bin/python3 benchmarks/report.py

Runs a plate that tears, a solid that tears, a solid of another model and a plate whose run fails, makes the page of
each by ./peristat report, and prints a table in markdown. The first page builds the program of the pages; that time is
printed by itself. --results DIR keeps the results there and uses those that it finds.
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "python"))
from peristat.results import open_results  # noqa: E402

PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
CASES = {  # name: file and settings
    "plate_with_hole/square": ("cases/plate_with_hole/square.toml", []),
    "the same, failed": ("cases/plate_with_hole/square.toml", ["solver.mode=newton", "loading.adaptive=false", "loading.steps=2"]),
    "notched block in 3D": ("benchmarks/report_block.toml", []),
    "cpd/cube_hole, coarse": ("cases/cpd/cube_hole.toml", ["lattice.spacing=0.1", "material.c3=4e4"]),
}
DONE, NOT_CONVERGED = 0, 3


def run(folder: Path, case: str, settings: list[str]) -> None:
    words = [word for setting in settings for word in ("--set", setting)]
    ended = subprocess.run([PROGRAM, "run", ROOT / case, "--output", folder, "--quiet", "--no-plots", *words])
    if ended.returncode not in (DONE, NOT_CONVERGED):
        sys.exit(f"{case}: exit code {ended.returncode}")


def report(folder: Path) -> float:
    """Makes the page; returns the seconds that it took."""
    began = time.perf_counter()
    subprocess.run([ROOT / "peristat", "report", folder], check=True, stdout=subprocess.DEVNULL)
    return time.perf_counter() - began


def row(name: str, folder: Path) -> str:
    seconds = report(folder)
    results = open_results(folder)
    size, source = ((folder / file).stat().st_size for file in ("report.html", "results.h5"))
    return (f"| {name} | {results.status} | {results.dimension} | {len(results.positions)} | {len(results.steps)} "
            f"| {source / 1e6:.1f} | {size} | {seconds:.1f} |")  # fmt: skip


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=Path, help="folder that keeps the results")
    kept = parser.parse_args().results
    with tempfile.TemporaryDirectory() as temporary:
        folder = kept or Path(temporary)
        for name, (case, settings) in CASES.items():
            if not (folder / name.replace("/", "_") / "results.h5").exists():
                run(folder / name.replace("/", "_"), case, settings)
        first = report(folder / next(iter(CASES)).replace("/", "_"))
        print(f"first page, with the program of the pages if it was not built: {first:.1f} s\n")
        print("| run | status | dimension | points | steps with fields | results.h5 [MB] | page [bytes] | seconds |")
        print("|---|---|---|---|---|---|---|---|")
        for name in CASES:
            print(row(name, folder / name.replace("/", "_")), flush=True)


if __name__ == "__main__":
    main()
