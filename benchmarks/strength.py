"""What a bar of concrete bears beside `strength`: ./peristat build && /usr/bin/python3 benchmarks/strength.py"""

import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.reference.program import peristat  # noqa: E402
from tests.reference.results import Results  # noqa: E402

BAR = """
title = "Bar of concrete, uniform tension"
dimension = 2
[lattice]
spacing = 5e-3
thickness = 0.05
angle = ANGLE
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.2, 0.1]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[material]
youngs_modulus = 30e9
[material.damage]
law = "linear"
fracture_energy = ENERGY
strength = 3e6
no_fail = ["left", "right"]
[[set]]
name = "mid"
where = "abs(x - 0.1) < spacing && abs(y - 0.05) < spacing"
[[support]]
set = "left"
displacement = [0, "free"]
[[support]]
set = "right"
displacement = ["1.2e-4*load", "free"]
[[support]]
set = "mid"
displacement = ["free", 0]
[loading]
steps = 30
stop_below = 0.8
[solver]
mode = "adaptive"
[relaxation]
steps = 60
"""
THICKNESS, SPACING, LENGTH = 0.05, 5e-3, 0.2 + 2 * 3 * 5e-3  # with the layers


def peak(angle, energy):
    """The largest reaction [N] and the points of the body."""
    with tempfile.TemporaryDirectory() as folder:
        case, output = Path(folder, "case.toml"), Path(folder, "out")
        case.write_text(BAR.replace("ANGLE", str(angle)).replace("ENERGY", str(energy)))
        ended = peristat("run", case, "--output", output, "--threads", 1, "--quiet")
        assert ended.code == 0, ended.said
        results = Results(output)
        return max(row["reaction_x:right"] for row in results.table("history")), results.steps[0].damage.size


def main():
    print("| angle [°] | fracture_energy [J/m2] | over 5e-3 m2 [MPa] | over the area by volume [MPa] |\n|---|---|---|---|")
    for angle in (0, 18, 45):
        for energy in (30, 110, 440):
            force, points = peak(angle, energy)
            area = points * SPACING**2 * THICKNESS / LENGTH
            print(f"| {angle} | {energy} | {force / 5e-3 / 1e6:.3f} | {force / area / 1e6:.3f} |", flush=True)


if __name__ == "__main__":
    main()
