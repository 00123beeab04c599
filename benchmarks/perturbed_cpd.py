"""Reaction of perturbed lattices over that of the regular one, in continuum-kinematics-inspired peridynamics.

Pulls the square and the cube of cases/cpd by 1e-3 of their length, with every point of the body shifted at
random by up to the perturbation (in spacings), and prints Markdown tables: a row per perturbation, a column
per Poisson's ratio. The first has the cases' horizons, which are just beyond a shell of neighbours, and the second
horizons in the middle between two shells. A column starts with the reaction of the regular lattice [N]; "unstable"
marks a body that is refused because it is unstable at rest.

    /usr/bin/python3 -BEs benchmarks/perturbed_cpd.py [PROGRAM]
"""

import json
import pathlib
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PERTURBATIONS = [0.0, 1e-9, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 3e-3, 1e-2, 0.02, 0.03, 0.05, 0.07, 0.1, 0.13, 0.16, 0.2]
# case, settings, Poisson's ratios
CASES = [
    ("square", ["lattice.spacing=0.05", 'support[1].displacement=["1e-3*load","0"]'],
     [0.1, 0.2, 0.3, 1.0 / 3.0, 0.4, 0.45]),
    ("square", ["lattice.spacing=0.05", 'support[1].displacement=["1e-3*load","0"]', "lattice.horizon_ratio=3.08"],
     [0.1, 1.0 / 3.0, 0.45]),
    ("cube", ["lattice.spacing=0.125", 'support[1].displacement=["1e-3*load","0","0"]'],
     [0.1, 0.2, 0.25, 0.3, 0.4, 0.45]),
    ("cube", ["lattice.spacing=0.125", 'support[1].displacement=["1e-3*load","0","0"]', "lattice.horizon_ratio=2.118"],
     [0.1, 0.25, 0.45]),
]  # fmt: skip


def reaction(program, case, settings, poisson_ratio, perturbation, folder):
    material = f'material={{model="cpd",youngs_modulus=1.0,poisson_ratio={poisson_ratio!r}}}'
    words = [*settings, material, f"lattice.perturbation={perturbation!r}", "loading.steps=1"]
    run = subprocess.run(
        [program, "run", ROOT / f"cases/cpd/{case}.toml", "--quiet", "--output", folder,
         *(word for setting in words for word in ("--set", setting))],
        capture_output=True, text=True)  # fmt: skip
    if run.returncode == 2 and "unstable" in run.stderr:
        return None
    if run.returncode != 0:
        return f"exit {run.returncode}"
    return json.loads((folder / "summary.json").read_text())["reactions"]["pulled"][0]


def main():
    if len(sys.argv) > 2:
        sys.exit(__doc__)
    program = pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) == 2 else ROOT / "build/release/peristat"
    with tempfile.TemporaryDirectory() as name:
        for case, settings, ratios in CASES:
            horizon = settings[2] if len(settings) > 2 else "the case's horizon"
            print(f"\n| {case}, {horizon}: perturbation | " + " | ".join(f"ν = {ratio:.4g}" for ratio in ratios) + " |")
            print("|---" * (len(ratios) + 1) + "|")
            regular = {}
            for perturbation in PERTURBATIONS:
                cells = []
                for ratio in ratios:
                    force = reaction(program, case, settings, ratio, perturbation, pathlib.Path(name) / "out")
                    regular.setdefault(ratio, force)
                    if not isinstance(force, float) or not isinstance(regular[ratio], float):
                        cells.append("unstable" if force is None else str(force))
                    else:
                        cells.append(f"{force:.4g} N" if perturbation == 0.0 else f"{force / regular[ratio]:.5f}")
                print(f"| {perturbation:g} | " + " | ".join(cells) + " |", flush=True)


if __name__ == "__main__":
    main()
