"""The one setting, calibrated on the notched beam with a/W = 0.5 and used for every specimen."""

from specimen import Lattice

MODULUS, FRACTURE_ENERGY = 70e9, 10.0  # glass: Pa, J/m2


def setting(spacing: float, lattice: Lattice, thickness: float, no_fail: list[str], dimension: int = 2) -> str:
    names = ", ".join(f'"{name}"' for name in no_fail)
    planar, plane = (f"thickness = {thickness}\n", 'plane = "stress"\n') if dimension == 2 else ("", "")
    return f"""\
dimension = {dimension}

[lattice]
spacing = {spacing:.17g}
horizon_ratio = {lattice.ratio}
angle = {lattice.angle}
{planar}
[quadrature]
volume_correction = "linear"
surface_correction = "energy"

[material]
model = "bond"
{plane}youngs_modulus = {MODULUS}

[material.damage]
law = "linear"
fracture_energy = {FRACTURE_ENERGY}
no_fail = [{names}]

[solver]
mode = "newton"

[output]
every = 1000000
"""


def under_opening(first: str, second: str, weights: str, largest: float, follow_growth: bool) -> str:
    """Control of the opening between two sets [m], until the force has passed its peak or, if growth is followed, until
    the crack has grown."""
    below = 0.45 if follow_growth else 0.97
    return f"""\
[[control]]
set = "{first}"
weights = {weights}

[[control]]
set = "{second}"
weights = {weights.replace("1", "-1")}

[loading]
table = [0, {largest:.6g}]
steps = 40
stop_below = {below}
"""
