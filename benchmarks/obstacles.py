"""Rigid obstacles against closed forms, at several spacings.

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -B benchmarks/obstacles.py [hertz] [disk] [beam]

Hertz: the half width b from the mean square of the places of the forces, b^2 = 4 <x^2>, and the largest pressure, over
b = sqrt(4 F R / (pi h E)) and 2 F / (pi h b), F the force of the run. Disk: the stresses at the centre over those of
uniform pressure on the flats, (2P / pi D h) (sin 2a / a - 1) and -(2P / pi D h) (sin 2a / a + 1), and of a rigid punch on
each of these. Beam: the curvature between the inner rollers over M / EI, M = P (L - l) / 4.
"""

import csv
import json
import math
import os
import pathlib
import subprocess
import sys
import tempfile

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))


def run(case, *changes):
    """Probes, reactions and line of forces of the last step of a shipped case with some keys changed."""
    with tempfile.TemporaryDirectory() as folder:
        words = [word for change in changes for word in ("--set", change)]
        subprocess.run([PROGRAM, "run", ROOT / f"cases/contact/{case}.toml", "--output", folder, "--overwrite", "--quiet",
                        "--no-plots", *words], check=True)  # fmt: skip
        summary = json.loads((pathlib.Path(folder) / "summary.json").read_text())
        line = pathlib.Path(folder) / "line_pressed.csv"
        rows = list(csv.DictReader(line.open())) if line.exists() else []
        last = [{key: float(value) for key, value in row.items()} for row in rows if row["step"] == rows[-1]["step"]]
        return summary, last


def hertz():
    print("| spacing [mm] | F [kN] | b [Δ] | measured b − b [Δ] | p0 [MPa] | largest pressure / p0 |\n|---|---|---|---|---|---|")
    radius, thickness, modulus = 0.2, 0.01, 70e9
    for spacing in (1.0, 0.5, 0.25):
        summary, line = run("hertz", f'lattice.spacing="{spacing} mm"')
        force = -summary["reactions"]["cylinder"][1]
        b = math.sqrt(4 * force * radius / (math.pi * thickness * modulus))
        p0 = 2 * force / (math.pi * thickness * b)
        x, f = (numpy.array([row[key] for row in line]) for key in ("x", "contact_force_y"))
        assert abs(f.sum() / -force - 1) < 1e-9, "the line misses some forces"
        size = spacing * 1e-3
        width = math.sqrt(4 * (f * x**2).sum() / f.sum())
        largest = -f.min() / (size * thickness)
        print(f"| {spacing} | {force / 1e3:.2f} | {b / size:.2f} | {(width - b) / size:+.2f} | {p0 / 1e6:.1f} | {largest / p0:.3f} |")


def disk():
    print("| spacing [mm] | across / uniform | along / uniform | across / punch | along / punch |\n|---|---|---|---|---|")
    radius, thickness, height = 0.032, 0.01, 0.031
    angle = math.acos(height / radius)
    s = math.sin(angle) * numpy.sin(math.pi * ((numpy.arange(1000) + 0.5) / 1000 - 0.5))  # of equal forces of a punch
    c = numpy.sqrt(1 - s**2)
    for spacing in (1.0, 0.5, 0.25):
        summary, _ = run("brazilian_disk", f'lattice.spacing="{spacing} mm"', f'set[0].where="x < {spacing} mm && y < {spacing} mm"')
        unit = 2 * 2 * -summary["reactions"]["platen"][1] / (math.pi * 2 * radius * thickness)
        across, along = (summary["probes"][name] / unit for name in ("across", "along"))
        uniform = math.sin(2 * angle) / angle
        print(f"| {spacing} | {across / (uniform - 1):.3f} | {-along / (uniform + 1):.3f} | "
              f"{across / (c * (1 - 4 * s**2)).mean():.3f} | {along / (c * (1 - 4 * c**2)).mean():.3f} |")  # fmt: skip


def beam():
    print("| spacing [mm] | rows | P [N] | curvature / (M / EI), correction \"energy\" | \"none\" |\n|---|---|---|---|---|")
    thickness, depth, modulus = 0.01, 0.024, 30e9
    for spacing in (2.0, 1.0, 0.5):
        ratios = []
        for correction in ("energy", "none"):
            summary, _ = run("four_point_bending", f'lattice.spacing="{spacing} mm"', f'quadrature.surface_correction="{correction}"',
                             f'set[0].where="x < {spacing} mm && abs(y - 12 mm) < {spacing} mm"',
                             f'set[1].where="abs(x - 20 mm - {spacing / 2} mm) < {spacing / 2} mm && abs(y - 12 mm) < {spacing} mm"')  # fmt: skip
            load = 2 * summary["reactions"]["support"][1]
            moment = load * 0.08 / 4
            near, far = spacing * 0.5e-3, 0.02 + spacing * 0.5e-3
            bow = summary["probes"]["beside"] - summary["probes"]["middle"]
            curvature = 2 * bow / (far**2 - near**2)
            ratios.append(curvature / (moment / (modulus * thickness * depth**3 / 12)))
            if correction == "energy":
                told = load
        print(f"| {spacing} | {depth / spacing * 1e3:.0f} | {told:.0f} | {ratios[0]:.3f} | {ratios[1]:.3f} |")


if __name__ == "__main__":
    tables = {"hertz": hertz, "disk": disk, "beam": beam}
    for name in sys.argv[1:] or tables:
        tables[name]()
