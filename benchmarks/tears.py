"""Energy of straight tears compared with the material's fracture energy and with predictions by direction.

  ./peristat build && /usr/bin/python3 -m benchmarks.tears [bonds] [cpd]

Two halves of a strip are pulled apart along a plane through the lattice at 0, 26.6 and 45 degrees. Predictions come
from sums of the reference (tests/reference) and, along an axis, from `calibrate`.
"""

import json
import math
import pathlib
import sys
import tempfile

import numpy

from tests.reference.body import lattice_ball
from tests.reference.case import Case
from tests.reference.clouds import toml
from tests.reference.program import peristat
from tests.reference.sheets import Bulk
from tests.reference.tear import Tear
from tests.reference.torn_strip import ANGLES, SPACING, THICKNESS, TornStrip

G = 10.0  # J/m2
LAWS = {"brittle": {"law": "critical_stretch"}, "linear": {"law": "linear"}, "exponential": {"law": "exponential"},
        "tanh": {"law": "tanh"}, "blended": {"law": "blended"}}  # fmt: skip
HEAD = "| ratio | laws | 0° | 26.6° | 45° | mean | spread | laws differ by | foretold within |\n|---|---|---|---|---|---|---|---|---|"


def told(strip, folder):
    """Prediction of `calibrate` for the damage law."""
    case = folder / "asked.toml"
    width = (strip.ratio + 2) * SPACING
    case.write_text(toml(TornStrip(strip.material, strip.ratio, 0.0, 1.0, strip.dimension, strip.quadrature).tables(width, width)))
    run = peristat("calibrate", case)
    if run.code != 0:
        raise RuntimeError(run.said)
    return json.loads(run.output)["damage"]


def bonds(dimension, ratio, folder):
    """A row: all damage laws of bonds."""
    took, errors = {}, []
    for law, damage in LAWS.items():
        material = {"youngs_modulus": 70e9, "damage": damage | {"fracture_energy": G}}
        for angle, period in ANGLES:
            strip = TornStrip(material, ratio, angle, period, dimension, {"volume_correction": "linear"})
            took[law, angle] = strip.energy(folder)
            bulk = Bulk(Case(strip.tables(1, 1)))
            foretold = G * bulk.crossing_of([0, 1, 0][:dimension]) / bulk.crossing
            errors.append(abs(took[law, angle] / foretold - 1))
            if angle == 0.0:
                errors.append(abs(took[law, angle] / told(strip, folder)["fracture_energy"]["axes"][0] - 1))
    tell(f"{ratio:g} ({dimension}D)", "bonds, all", took, errors)


def cpd(ratio, law, steps, folder):
    """A row: a damage law of cpd, torn in small steps."""
    constants = {"c1": 5e19, "c2": 3e27 * (2.015 / ratio) ** 4}
    material = {"model": "cpd", **constants, "damage": LAWS[law] | {"fracture_energy": G, "drive": "stretch"}}
    tear = Tear(2, ratio, SPACING, THICKNESS, {1: constants["c1"], 2: constants["c2"]})
    took, errors = {}, []
    for angle, period in ANGLES:
        strip = TornStrip(material, ratio, angle, period, 2, {"weights": "bulk"}, steps)
        answer = told(strip, folder)
        normal = numpy.array([math.sin(math.radians(angle)), math.cos(math.radians(angle))])
        strip.opening = 1.02 * last_opening(ratio, normal, answer["critical"])
        took[law, angle] = strip.energy(folder)
        found = LAWS[law] | {key: answer[key] for key in ("onset", "peak", "critical", "hardening", "rate") if key in answer}
        errors.append(abs(took[law, angle] / tear.energy(found, normal) - 1))
    tell(f"{ratio:g} (2D)", f"CPD, {law}, {steps} steps", took, errors)


def last_opening(ratio, normal, critical):
    """Opening at which the last bond across a tear breaks [m]."""
    arm = lattice_ball(2, ratio)
    rise, length = abs(arm @ normal), numpy.hypot(*arm.T)
    across = rise > 1e-9
    opening = numpy.sqrt(rise**2 + (critical**2 + 2 * critical) * length**2) - rise
    return opening[across].max() * SPACING


def tell(ratio, laws, took, errors):
    by_angle = {angle: [took[key] / G for key in took if key[1] == angle] for angle, _ in ANGLES}
    differ = f"{max(max(values) - min(values) for values in by_angle.values()):.0e}" if len(took) > len(ANGLES) else ""
    first, between, last = (sum(values) / len(values) for values in by_angle.values())
    mean = (first + 2 * between + last) / 4  # the middle value belongs to both halves of the range
    spread = max(first, between, last) - min(first, between, last)
    print(f"| {ratio} | {laws} | {first:.4f} | {between:.4f} | {last:.4f} | {mean:.4f} | {spread:.4f} | {differ} | {max(errors):.0e} |",
          flush=True)  # fmt: skip


def main():
    chosen = sys.argv[1:] or ["bonds", "cpd"]
    print(HEAD)
    with tempfile.TemporaryDirectory(prefix="peristat_tears_") as place:
        folder = pathlib.Path(place)
        if "bonds" in chosen:
            for dimension, ratio in ((2, 3.015), (2, 4.0), (2, 6.0), (2, 8.0), (3, 3.0)):
                bonds(dimension, ratio, folder)
        if "cpd" in chosen:
            for law in LAWS:
                cpd(3.015, law, 400, folder)
            cpd(3.015, "exponential", 1600, folder)


if __name__ == "__main__":
    main()
