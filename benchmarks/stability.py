"""Critical loads compared with theory, and the cost of finding loads: ./peristat build && /usr/bin/python3
benchmarks/stability.py

Runs the cases of cases/buckling and cases/three_point_bending/mouth_opening.toml as shipped.
"""

import csv
import json
import math
import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.acceptance.stability_test import Arch, Column  # noqa: E402

CASES = ["buckling/arch", "buckling/column", "three_point_bending/mouth_opening"]


class Runs:
    """Results of the shipped cases."""

    def __init__(self, folder: Path):
        self.folder = folder

    def run(self, case: str) -> dict:
        out = self.folder / case.replace("/", "_")
        program = os.environ["PERISTAT_PROGRAM"]
        subprocess.run([program, "run", ROOT / "cases" / f"{case}.toml", "--output", out, "--quiet"], check=True)
        return json.loads((out / "summary.json").read_text())

    def rows(self, case: str, table: str) -> list[dict]:
        with open(self.folder / case.replace("/", "_") / f"{table}.csv", newline="") as file:
            return list(csv.DictReader(file))

    def critical(self, case: str) -> list[float]:
        return [float(row["load_factor"]) for row in self.rows(case, "decisions")
                if row["action"] == "locate critical point"]  # fmt: skip


def compare(runs: Runs) -> None:
    arch, column = Arch(), Column()
    for test in (arch, column):
        test.folder = runs.folder
    axial, bending = arch.stiffnesses(Arch.ROWS)
    highest = math.sqrt((Arch.RISE**2 - 16 * bending / axial) / 3)
    print("| critical load | found | theory | difference |\n|---|---|---|---|")
    for name, rise, found in zip(("arch, snaps", "arch, snaps back"), (highest, -highest), runs.critical("buckling/arch")):
        theory = arch.load_factor(rise, axial, bending)
        print(f"| {name} | {found:.5f} | {theory:.5f} | {100 * (found / theory - 1):.2f} % |")
    _, bending = column.stiffnesses(8)
    euler = math.pi**2 * bending / (4 * Column.LENGTH**2) / 32e3
    (found,) = runs.critical("buckling/column")
    print(f"| column, Euler | {found:.5f} | {euler:.5f} | {100 * (found / euler - 1):.2f} % |")
    last = runs.rows("buckling/column", "history")[-1]
    modulus = column.modulus_of(float(last["load_factor"]) / found)
    first, second = column.elliptic_integrals(modulus)
    for name, value, theory in (("aside", abs(float(last["top_y"])), 2 * modulus / first),
                                ("left of its height", 1 * Column.LENGTH + float(last["top_x"]), 2 * second / first - 1)):  # fmt: skip
        share = value / Column.LENGTH
        print(f"| column at load 1, {name} / length | {share:.4f} | {theory:.4f} | {100 * (share - theory):.2f} % of the length |")


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        runs = Runs(Path(folder))
        print("| case | points | steps | Newton iterations | factorisations | run |\n|---|---|---|---|---|---|")
        for case in CASES:
            told = runs.run(case)
            print(f"| `{case}` | {told['points']} | {told['steps']} | {told['newton_iterations']} | "
                  f"{told['factorisations']} | {told['seconds']['total']:.1f} s |", flush=True)  # fmt: skip
        compare(runs)


if __name__ == "__main__":
    main()
