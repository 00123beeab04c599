#!/usr/bin/env -S /usr/bin/python3 -BEs
"""Torture: random but valid cases, every accepted step of which the reference has to confirm.

    /usr/bin/python3 -B tests/torture/torture.py                    all 300 cases, some 20 minutes on one core
    /usr/bin/python3 -B tests/torture/torture.py --only 17          one of them again
    /usr/bin/python3 -B tests/torture/torture.py --seed 2 --cases 50

A case must end with 0 (done), 3 (did not converge), 4 (memory), or 2 if its body is unstable at rest
or not held, within a minute of processor time. Cases that fail are kept below --keep.
"""

import argparse
import collections
import pathlib
import re
import shutil
import sys
import tempfile
import time

import numpy

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))

from tests.reference.clouds import random_places, toml, write_points  # noqa: E402
from tests.reference.program import peristat  # noqa: E402
from tests.reference.results import not_finite  # noqa: E402
from tests.reference.verify import Verification  # noqa: E402

CPU_SECONDS = 60
# A body that can't be calculated, by its own choice of constants, points or supports.
REFUSALS = ("unstable at rest", "move freely", "held", "negative", "Poisson", "selects no")
PRECONDITIONERS = ("auto", "jacobi", "block_jacobi", "rigid_pieces", "surrogate", "riluk", "chebyshev", "multigrid")


class Generator:
    """Makes the case of one seed and number, the same one every time."""

    def __init__(self, seed, number):
        self.random = numpy.random.default_rng([seed, number])

    def choice(self, *options, weights=None):
        return options[self.random.choice(len(options), p=weights)]

    def chance(self, probability):
        return self.random.random() < probability

    def between(self, low, high):
        return float(self.random.uniform(low, high))

    def power(self, low, high):
        """Between 10^low and 10^high, every decade as likely."""
        return float(10 ** self.random.uniform(low, high))

    def make(self, folder):
        self.dimension = int(self.choice(1, 2, 3, weights=(0.15, 0.5, 0.35)))
        self.model = "cpd" if self.dimension > 1 and self.chance(0.3) else "bond"
        self.spacing = self.power(-4, 1)
        case = {"dimension": self.dimension}
        from_file = self.chance(0.2)
        case.update(self.cloud(folder) if from_file else self.lattice())
        if not from_file and self.dimension > 1 and self.chance(0.25):
            case["crack"] = [self.crack()]
        case["material"] = self.material(from_file)
        case["quadrature"] = self.quadrature()
        self.supports_and_loads(case, from_file)
        case.update(self.solution())
        path = folder / "case.toml"
        path.write_text(toml(case))
        return path

    # ---- bodies ----------------------------------------------------------------------------------

    def counts(self):
        if self.model == "cpd":
            ranges = {2: ((5, 12), (4, 8)), 3: ((4, 6), (3, 5), (3, 4))}[self.dimension]
        else:
            ranges = {1: ((6, 60),), 2: ((6, 24), (4, 12)), 3: ((4, 9), (3, 6), (3, 5))}[self.dimension]
        return [int(self.random.integers(low, high)) for low, high in ranges]

    def horizon_ratio(self):
        if self.model == "cpd" and self.dimension == 3:
            return self.choice(1.5, 1.75, 2.015)
        return self.choice(1.5, 2.015, 3.015, 3.0, self.between(1.45, 3.3))

    def lattice(self):
        self.size = [n * self.spacing for n in self.counts()]
        shapes = [{"add": "box", "min": [0.0] * self.dimension, "max": self.size}]
        if self.dimension > 1 and self.chance(0.35):
            centre = [self.between(0.3, 0.7) * side for side in self.size]
            radius = self.between(0.1, 0.3) * min(self.size)
            kind = self.choice("disk") if self.dimension == 2 else self.choice("sphere", "cylinder")
            shapes.append({"subtract": kind, "centre": centre, "radius": radius})
        thickness = int(self.random.integers(1, 4))
        layers = [{"name": name, "side": side, "thickness": thickness} for name, side in (("left", "x-"), ("right", "x+"))]
        lattice = {"spacing": self.spacing, "horizon_ratio": self.horizon_ratio(), "shape": shapes, "layer": layers}
        if self.dimension < 3:
            self.cross_section = self.power(-1, 1) * self.spacing
            lattice[{1: "area", 2: "thickness"}[self.dimension]] = self.cross_section
        if self.chance(0.4):
            lattice["perturbation"] = self.between(0, 0.3)
            lattice["seed"] = int(self.random.integers(1, 1000))
        return {"lattice": lattice}

    def cloud(self, folder):
        count = {1: 30, 2: 90, 3: 100}[self.dimension] if self.model == "bond" else {2: 50, 3: 40}[self.dimension]
        reference = random_places(self.random, count, self.dimension) * self.spacing
        self.size = list(reference.max(axis=0) - reference.min(axis=0))
        self.cross_section = self.spacing if self.dimension < 3 else 1.0
        volume = self.random.uniform(0.8, 1.25, count) * self.spacing**self.dimension * self.cross_section
        x = reference[:, 0] / self.spacing
        sets = {"left": x < x.min() + 1.2, "right": x > x.max() - 1.2}
        write_points(folder / "points.csv", reference, volume, sets)
        points = {"file": "points.csv", "horizon": self.horizon_ratio() * self.spacing * 1.1}
        if self.dimension < 3:
            points[{1: "area", 2: "thickness"}[self.dimension]] = self.cross_section
        return {"points": points}

    def crack(self):
        """Across the body, between two planes of points."""
        x = round(self.between(0.3, 0.7) * self.size[0] / self.spacing) * self.spacing + 0.013 * self.spacing
        depth = self.between(0.1, 0.6) * self.size[1] + 0.007 * self.spacing
        low = -0.53 * self.spacing
        if self.dimension == 2:
            return {"from": [x, low], "to": [x, depth]}
        high = self.size[2] + 0.53 * self.spacing
        return {"vertices": [[x, low, low], [x, depth, low], [x, depth, high], [x, low, high]]}

    def material(self, from_file):
        self.modulus = self.power(0, 11)
        material = {"model": self.model}
        if self.model == "bond":
            material["youngs_modulus"] = self.modulus
            if self.dimension == 2:
                material["plane"] = self.choice("stress", "strain")
        else:
            # Constants of the same order of stiffness: bonds, triangles and tetrahedra of a horizon
            # of two spacings each bear a part.
            horizon = 2 * self.spacing
            unit = self.cross_section * horizon**3 if self.dimension == 2 else horizon**4
            plane = horizon**6 * self.cross_section**2 if self.dimension == 2 else horizon**8
            material["c1"] = 8 * self.modulus / unit
            material["c2"] = self.choice(0.0, 0.3, 3.0) * self.modulus / plane
            if self.dimension == 3:
                material["c3"] = self.choice(0.0, 0.5, 5.0) * self.modulus / horizon**12
        law = self.choice("none", "critical_stretch", "tanh", "tanh_continuous", "linear", "exponential", "blended",
                          weights=(0.2, 0.2, 0.15, 0.2, 0.1, 0.1, 0.05))  # fmt: skip
        self.critical = self.power(-4, -1)
        if law != "none":
            damage = {"law": law, "critical": self.critical}
            if law != "critical_stretch":
                damage["onset"] = self.critical * self.between(0.2, 0.95)
            if law in ("tanh", "tanh_continuous", "exponential"):
                damage["rate"] = self.power(-0.5, 1)
            if law == "blended":
                damage["peak"] = damage["onset"] + self.between(0.1, 0.9) * (self.critical - damage["onset"])
                damage["hardening"] = self.between(0.1, 0.9)
            if self.chance(0.6):
                damage["no_fail"] = ["left", "right"]
            material["damage"] = damage
        return material

    def quadrature(self):
        if self.model == "cpd":
            return {"weights": self.choice("mean", "bulk")}
        return {"volume_correction": self.choice("none", "linear"),
                "surface_correction": self.choice("none", "volume", "energy")}  # fmt: skip

    # ---- conditions and solution -----------------------------------------------------------------

    def supports_and_loads(self, case, from_file):
        strain = self.critical * self.power(-0.7, 2)
        reach = min(strain, 3.0) * self.size[0]
        still = [0] * self.dimension
        case["support"] = [{"set": "left", "displacement": still}]
        kind = self.choice("pull", "shear", "wave", "force", "confined", weights=(0.4, 0.1, 0.2, 0.2, 0.1))
        if kind == "force":
            side = numpy.prod(self.size[1:]) if self.dimension > 1 else 1.0
            area = side * (self.cross_section if self.dimension < 3 else 1.0)
            force = self.modulus * area * strain
            direction = int(self.random.integers(self.dimension)) if self.chance(0.3) else 0
            components = [f"{force if axis == direction else 0:.6e}*load" for axis in range(self.dimension)]
            case["load"] = [{"set": "right", "total_force": components}]
            return
        along = f"{reach:.6e}*load"
        if kind == "wave":
            along = f"{reach:.6e}*sin({self.between(2, 12):.4f}*load)"
        axis = 1 if kind == "shear" and self.dimension > 1 else 0
        other = "free" if kind in ("pull", "wave") and self.chance(0.5) else 0
        displacement = [along if k == axis else other for k in range(self.dimension)]
        case["support"].append({"set": "right", "displacement": displacement})

    def solution(self):
        solver = {"mode": self.choice("newton", "relaxation", "adaptive", weights=(0.35, 0.25, 0.4)),
                  "relative_tolerance": self.power(-10, -5), "fragments": self.choice("hold", "remove", "stop"),
                  "linear": self.choice("auto", "cholesky", "pcg")}  # fmt: skip
        if solver["linear"] == "pcg":
            solver["preconditioner"] = self.choice(*PRECONDITIONERS)
        steps = int(self.random.integers(1, 31))
        relaxation = {"steps": int(self.random.integers(1, 31)), "max_iterations": 4000,
                      "ramp": int(self.power(0.5, 2.3)), "breaking": self.choice("at_equilibrium", "transient"),
                      "damping": self.choice("adaptive", "kinetic"), "mass_factor": self.choice(1.0, 2.0, 5.0)}  # fmt: skip
        loading = {"steps": steps, "smallest_step": 0.02, "adaptive": self.chance(0.8)}
        return {"solver": solver, "relaxation": relaxation, "loading": loading}


def judge(path, folder):
    """Runs a case; returns the exit code, whether the reference has judged it, and complaints."""
    run = peristat("run", path, "--quiet", "--threads", 1, "--output", folder / "out", "--set", "output.stress=true", folder=folder,
                   seconds=10 * CPU_SECONDS, cpu_seconds=CPU_SECONDS)  # fmt: skip
    (folder / "said.txt").write_text(run.said)
    if run.code is None:
        return run.code, False, ["out of time"]
    if run.code == 2 and any(word in run.said for word in REFUSALS):
        return run.code, False, []
    if run.code not in (0, 3, 4):
        return run.code, False, [f"exit code {run.code}: {run.said.strip()[-500:]}"]
    if run.code == 4 or not (folder / "out/results.h5").exists():
        return run.code, False, []
    complaints = [f"not finite: {place}" for place in not_finite(folder / "out")]
    verification = Verification(folder / "out", path.read_text(), folder)
    if verification.histories_are_known:
        return run.code, True, complaints + verification.run()
    return run.code, False, complaints


def torture(seed, numbers, keep, tell=print):
    """Runs cases; returns counts by outcome and the numbers of those that failed with complaints."""
    counts, failures = collections.Counter(), {}
    for number in numbers:
        with tempfile.TemporaryDirectory(prefix="peristat_torture_") as temporary:
            folder, since = pathlib.Path(temporary), time.monotonic()
            path = Generator(seed, number).make(folder)
            try:
                code, judged, complaints = judge(path, folder)
            except Exception as error:  # noqa: BLE001  what the reference can't read is a finding, too
                code, judged, complaints = -1, False, [f"the reference fails: {error!r}"]
            counts[f"exit {code}"] += 1
            counts["judged"] += judged
            if complaints:
                failures[number] = complaints
                if keep:
                    kept = pathlib.Path(keep) / f"seed_{seed}_case_{number}"
                    shutil.rmtree(kept, ignore_errors=True)
                    shutil.copytree(folder, kept)
                    (kept / "complaints.txt").write_text("\n".join(complaints) + "\n")
            text = f"case {number}: exit {code}, {'judged' if judged else 'not judged'}, {time.monotonic() - since:.1f} s"
            tell(text + "".join(f"\n    {line}" for line in complaints[:3]))
    return counts, failures


def main():
    parser = argparse.ArgumentParser(description=re.split(r"\n\n", __doc__)[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cases", type=int, default=300)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--only", type=int, help="a single case by its number")
    parser.add_argument("--keep", default="results/torture", help="folder for the cases that fail")
    options = parser.parse_args()
    numbers = [options.only] if options.only is not None else range(options.first, options.first + options.cases)
    counts, failures = torture(options.seed, numbers, options.keep, lambda text: print(text, flush=True))
    print(", ".join(f"{name}: {count}" for name, count in sorted(counts.items())))
    print(f"{len(failures)} failed" + (f": {', '.join(map(str, failures))}" if failures else ""))
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
