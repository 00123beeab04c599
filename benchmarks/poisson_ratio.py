"""Poisson's ratio against C2/C1 in 2D and C3/C1 in 3D, as in Figs 8 and 9 of [CPD].

Runs cases/cpd/poisson_2d.toml and poisson_3d.toml once per ratio and compares the measured probe with the
bulk sums of the lattice and with the continuum (`peristat calibrate`).

    /usr/bin/python3 benchmarks/poisson_ratio.py PICTURE.png
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

import matplotlib

matplotlib.use("Agg")
from matplotlib import pyplot  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parent.parent
PROGRAM = ROOT / "build/release/peristat"
sys.path.insert(0, str(ROOT / "cases/runner/sweep"))

from own_files import PICTURE, picture, require_own, write_own  # noqa: E402

# name, constant that varies, its values, limit of nu for infinite stiffness
CASES = [
    ("poisson_2d", "c2", [-500, -300, -150, 0, 150, 400, 800, 1500, 3000, 6000, 12000, 30000], 1.0),
    ("poisson_3d", "c3", [-8e3, -5e3, -2.5e3, 0, 5e3, 1e4, 2e4, 4e4, 8e4, 1.6e5, 4e5, 1e6], 0.5),
]


def measured(case, key, value, folder):
    subprocess.run(
        [PROGRAM, "run", ROOT / f"cases/cpd/{case}.toml", "--quiet", "--output", folder / case,
         "--set", f"material.{key}={value}"], check=True)  # fmt: skip
    with open(folder / case / "history.csv", newline="") as table:
        return float(list(csv.DictReader(table))[-1]["poisson_ratio"])


def calibrated(case, key, value):
    told = subprocess.run(
        [PROGRAM, "calibrate", ROOT / f"cases/cpd/{case}.toml", "--set", f"material.{key}={value}"],
        check=True, capture_output=True, text=True).stdout  # fmt: skip
    return json.loads(told)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    figure, panels = pyplot.subplots(1, 2, figsize=(15, 6))
    with tempfile.TemporaryDirectory() as name:
        for axes, (case, key, values, limit) in zip(panels, CASES):
            settings = {"c3": 0.0} if key == "c2" else {"c2": 0.0}
            print(f"{case}: {key}, measured, lattice along an axis, lattice isotropic part, continuum ({settings})")
            rows = []
            for value in values:
                told = calibrated(case, key, value)
                rows.append((value, measured(case, key, value, pathlib.Path(name)),
                             told["lattice"]["axis_poisson_ratio"], told["lattice"]["poisson_ratio"],
                             told["continuum"]["poisson_ratio"]))  # fmt: skip
                print("  " + "  ".join(f"{entry:.4g}" for entry in rows[-1]), flush=True)
            ratio, probe, axis, isotropic, continuum = zip(*rows)
            axes.plot(ratio, axis, color="#1f6f9f", label="lattice's bulk sums, pull along an axis")
            axes.plot(ratio, isotropic, "--", color="#1f6f9f", label="lattice's bulk sums, isotropic part")
            axes.plot(ratio, continuum, ":", color="#8a949e", label="continuum")
            axes.plot(ratio, probe, "o", color="#d1603d", label=f"{case}.toml, probe poisson_ratio")
            axes.axhline(limit, color="#c3cad1", linewidth=1)
            axes.set_xscale("symlog", linthresh=max(values) / 100)
            axes.set_xlabel(f"C{key[1]}/C1 [1/m{'⁴' if key == 'c2' else '⁸'}]")
            axes.set_ylabel("Poisson's ratio")
            axes.set_title(f"{case[-2:].upper()}: incompressible limit {limit:g}")
            axes.grid(True, color="#e6e9ec")
            axes.legend(frameon=False)
    figure.tight_layout()
    write_own(pathlib.Path(sys.argv[1]), picture(figure, "png", dpi=100), PICTURE)


if __name__ == "__main__":
    main()
