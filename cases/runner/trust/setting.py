"""The one setting: found on the notched beam with a/W = 0.5, and the same for every specimen."""

MODULUS, POISSON_RATIO, FRACTURE_ENERGY = 70e9, 1 / 3, 10.0  # glass: Pa, bonds in plane stress, J/m2


def setting(spacing: float, lattice, thickness: float, no_fail: list[str]) -> str:
    names = ", ".join(f'"{name}"' for name in no_fail)
    return f"""\
dimension = 2

[lattice]
spacing = {spacing:.17g}
horizon_ratio = {lattice.ratio}
angle = {lattice.angle}
thickness = {thickness}

[quadrature]
volume_correction = "linear"
surface_correction = "energy"

[material]
model = "bond"
plane = "stress"
youngs_modulus = {MODULUS}

[material.damage]
law = "linear"
fracture_energy = {FRACTURE_ENERGY}
no_fail = [{names}]

[solver]
mode = "newton"

[output]
every = 1000000
"""
