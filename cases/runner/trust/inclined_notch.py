"""Half a disk in three-point bending with a notch inclined by 30 degrees: the crack kinks and curves towards the load
[Ayatollahi et al. 2006]. The reference is the path of linear elastic fracture mechanics: in PMMA, whose process zone is
under a T-stress, too, the crack turned farther."""

import math
from pathlib import Path

import crack_path
from bending import rollers
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import Lattice, Measure, Specimen, lattice_of

RADIUS, THICKNESS = 0.05, 5e-3
SUPPORT, NOTCH, INCLINED = 0.43 * RADIUS, 0.3 * RADIUS, math.radians(30)
TIP = (NOTCH * math.sin(INCLINED), NOTCH * math.cos(INCLINED))
# The path with K_II = 0 in m, as `/usr/bin/python3 -BEs -m tests.reference.half_disk` prints it; the load is at (0, RADIUS).
PATH = [
    (7.50e-3, 12.99e-3), (7.15e-3, 13.93e-3), (6.66e-3, 14.80e-3), (6.23e-3, 15.70e-3), (5.81e-3, 16.61e-3), (5.42e-3, 17.53e-3),
    (5.06e-3, 18.46e-3), (4.73e-3, 19.41e-3), (4.42e-3, 20.36e-3), (4.14e-3, 21.32e-3), (3.88e-3, 22.28e-3), (3.64e-3, 23.25e-3),
    (3.41e-3, 24.23e-3), (3.21e-3, 25.21e-3), (3.02e-3, 26.19e-3), (2.85e-3, 27.17e-3), (2.69e-3, 28.16e-3), (2.53e-3, 29.15e-3),
    (2.39e-3, 30.14e-3), (2.26e-3, 31.13e-3), (2.14e-3, 32.12e-3), (2.03e-3, 33.12e-3), (1.92e-3, 34.11e-3), (1.82e-3, 35.11e-3),
]  # fmt: skip
# That of PMMA in m, digitised in github.com/floiseau/gcrack.
MEASURED = [
    (0.00727, 0.01314), (0.00625, 0.01492), (0.00459, 0.01735), (0.00344, 0.01939), (0.00191, 0.02245), (0.0014, 0.02436),
    (0.00102, 0.02615), (0.00077, 0.02793), (0.00051, 0.02985), (0.00038, 0.03176), (0.00026, 0.03342), (0.00013, 0.03508),
    (0.0, 0.03661), (-0.00013, 0.03827), (-0.00026, 0.0412), (-0.00026, 0.04349), (-0.00051, 0.04643), (-0.00038, 0.04885),
    (-0.00038, 0.05),
]  # fmt: skip
FOLLOWED = 0.03  # height up to which the paths are compared
OPENING = 4 * math.sqrt(FRACTURE_ENERGY * NOTCH / (math.pi * MODULUS))  # such a crack in a wide plate at failure


def text(lattice: Lattice, h: float) -> str:
    return setting(h, lattice, THICKNESS, ["contacts"]) + f"""
[[lattice.shape]]
add = "disk"
centre = [0.0, 0.0]
radius = {RADIUS}

[[lattice.shape]]
subtract = "box"
min = [{-RADIUS}, {-RADIUS}]
max = [{RADIUS}, {-1e-9 * RADIUS}]

[[crack]]
from = [{-0.1 * TIP[0]}, {-0.1 * TIP[1]}]
to = [{TIP[0]}, {TIP[1]}]

[[set]]
name = "contacts"
where = "y > {0.85 * RADIUS} || (y < {0.1 * RADIUS} && abs(x) > {0.3 * RADIUS})"

[[set]]
name = "mouth_right"
where = "x > {0.02 * RADIUS} && x < {0.02 * RADIUS + 1.5 * h} && y < {1.1 * h}"

[[set]]
name = "mouth_left"
where = "x < {-0.02 * RADIUS} && x > {-0.02 * RADIUS - 1.5 * h} && y < {1.1 * h}"

{rollers(SUPPORT, RADIUS)}[[control]]
set = "mouth_right"
weights = [1, 0]

[[control]]
set = "mouth_left"
weights = [-1, 0]

[loading]
table = [0, {OPENING:.6g}, {2 * OPENING:.6g}, {4 * OPENING:.6g}, {8 * OPENING:.6g}]
steps = 12
stop_below = 0.3
"""  # fmt: skip


def deviation(folder: Path) -> float:
    """1 + the largest distance of the crack's centre line from the path, in horizons."""
    lattice = lattice_of(folder)
    horizon = lattice["spacing"] * lattice["horizon_ratio"]
    middles = [place for place in crack_path.broken_middles(folder) if TIP[1] < place[1] < FOLLOWED]
    return 1 + max(crack_path.distance(place, PATH) for place in crack_path.line(middles, 1, 0.03 * RADIUS)) / horizon


SPECIMENS = [
    Specimen(
        name="inclined_notch",
        title="Half disk with an inclined notch",
        reference="path with K_II = 0",
        coarsest=RADIUS / 32,
        case=text,
        measures=(Measure("1 + distance of the paths in horizons", deviation, allowed=1.0, at=0.5),),
        spacings=(1.0, 0.7, 0.5),
    )
]
