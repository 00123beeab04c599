"""Notched beams of concrete in three-point bending, whose loads were measured: one with its notch in the middle

[Grégoire et al. 2013], and one with a notch aside, whose crack starts under mixed mode and runs towards the load
[García-Álvarez et al. 2012]. Dimensions, constants and measured bands as in github.com/mark-hobbs/pypd. Both are small
beside the length E G / f_t^2 of a third of a metre, so that the strength decides more than the toughness.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from bending import mouth_sets, rollers
from other_setting import of_material
from setting import setting, under_opening
from specimen import Lattice, Measure, Specimen, aside, peak, rows

THICKNESS, SPAN = 0.05, 2.5  # m, depths
LARGEST = 0.06e-3  # m, opening of the notch; some 0.02 mm at the peak


@dataclass(frozen=True)
class Beam:
    name: str
    title: str
    reference: str
    depth: float  # m
    notch: float  # depth of the notch, in depths of the beam
    eccentricity: float  # of the notch, in depths
    constants: tuple[float, float, float]  # E [Pa], fracture energy [J/m2], tensile strength [Pa]
    band: tuple[float, float]  # peaks of the lower and the upper limit of the measured loads [N]

    def text(self, lattice: Lattice, h: float) -> str:
        d, x = self.depth, aside(lattice, h) - self.eccentricity * self.depth
        half = h * math.ceil(0.625 * SPAN * d / h)  # notches in the middle and aside lie between columns of points
        ends = f"(abs(x) > {1.05 * d} && y < {0.25 * d}) || (abs(x) < {0.25 * d} && y > {0.85 * d})"
        return of_material(setting(h, lattice, THICKNESS, ["ends"]), *self.constants) + f"""
[[lattice.shape]]
add = "box"
min = [{-half}, 0.0]
max = [{half}, {d}]

[[crack]]
from = [{x}, {-d}]
to = [{x}, {self.notch * d}]

[[set]]
name = "ends"
where = "{ends}"

{mouth_sets(x, h)}{rollers(0.5 * SPAN * d, d)}""" + under_opening("mouth_right", "mouth_left", "[1, 0]", LARGEST, follow_growth=False)  # fmt: skip

    def load(self, folder: Path) -> float:
        """Peak over the middle of the measured band."""
        return peak([abs(row["reaction_y:load"]) for row in rows(folder)]) / (0.5 * sum(self.band))


BEAMS = [
    Beam("concrete_beam", "Half-notched beam of concrete, 50 mm deep", "Grégoire et al.", 0.05, 0.5, 0.0,
         (37e9, 143.2, 3.9e6), (933.0, 1114.0)),
    Beam("eccentric_notch", "Beam of concrete with an eccentric notch", "García-Álvarez et al.", 0.08, 0.25, 0.625,
         (33.8e9, 125.2, 3.5e6), (4894.0, 5405.0)),
]  # fmt: skip
SPECIMENS = [
    Specimen(beam.name, beam.title, beam.reference, beam.depth / 24, beam.text, (Measure("peak load", beam.load, allowed=0.1),))
    for beam in BEAMS
]
