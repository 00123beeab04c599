"""Strengths of a body without a crack: a periodic cell is strained until its stress has passed a peak. The data for
soda-lime glass are second-hand, from the nine circles of elastic brittle fracture [Nine circles 2026]."""

import math
from pathlib import Path

from other_setting import of_material
from setting import setting
from specimen import Lattice, Measure, Specimen, lattice_of, rows

MODULUS, FRACTURE_ENERGY, TENSILE, BIAXIAL, SHEAR, COMPRESSIVE = 70e9, 10.0, 40e6, 27e6, 44.4e6, 1000e6
POISSON_RATIO = 1 / 3  # of bond-based models in plane stress
CELLS, COARSEST, THICKNESS = 12, 5e-5, 1e-3  # cells per side of the periodic cell


def turned(first: float, second: float, angle: float) -> tuple[float, float, float]:
    """Components xx, yy, xy of a tensor whose principal directions are turned by an angle."""
    mean, half = 0.5 * (first + second), 0.5 * (first - second)
    return mean + half * math.cos(2 * angle), mean - half * math.cos(2 * angle), half * math.sin(2 * angle)


def case(second: float, most: float):
    """Case text for strains in the ratio 1 : second. They grow to `most` times the strain at the tensile strength,
    which is beyond the peak, but to at most six tenths of the critical stretch. A periodic cell cannot be turned, so
    the strains are turned against the lattice."""

    def text(lattice: Lattice, h: float) -> str:
        critical = 4 * math.pi * FRACTURE_ENERGY * MODULUS / (9 * TENSILE**2 * h * lattice.ratio)
        largest = min(most, 0.6 * critical)
        xx, yy, xy = (f'"{largest * TENSILE / MODULUS * part:.9g}*load"' for part in turned(1.0, second, -math.radians(lattice.angle)))
        period = lambda axis, column: f'[[period]]\naxis = "{axis}"\nfrom = 0.0\nto = {CELLS * h}\ngradient = [{", ".join(column)}]\n\n'
        straight = Lattice(lattice.refinement, lattice.ratio)
        return of_material(setting(h, straight, THICKNESS, []), MODULUS, FRACTURE_ENERGY, TENSILE) + f"""
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [{CELLS * h}, {CELLS * h}]

{period("x", (xx, xy))}{period("y", (xy, yy))}[loading]
steps = {math.ceil(30 * largest)}
"""  # fmt: skip

    return text


def on_surface(second: float, most: float):
    """The same with a strength surface."""
    plain = case(second, most)

    def text(lattice: Lattice, h: float) -> str:
        surface = f'strength = {TENSILE}\nstrength_surface = "drucker_prager"\ncompressive_strength = {COMPRESSIVE}'
        return plain(lattice, h).replace(f"strength = {TENSILE}", surface)

    return text


def largest_stress(folder: Path) -> float:
    """Peak of the largest principal stress [Pa]."""
    return max(largest for largest, _ in _principal_stresses(folder))


def utilisation(folder: Path) -> float:
    """Largest utilisation of Drucker and Prager's surface on the way: the ratio of the stresses changes once bonds
    soften."""
    share = TENSILE / COMPRESSIVE

    def rho(one: float, two: float) -> float:
        deviator = math.sqrt((one**2 - one * two + two**2) / 3)
        return (math.sqrt(3) * (1 + share) * deviator + (1 - share) * (one + two)) / (2 * TENSILE)

    return max(rho(one, two) for one, two in _principal_stresses(folder))


def _principal_stresses(folder: Path) -> list[tuple[float, float]]:
    """The larger and the smaller one of each step [Pa]."""
    area = lattice_of(folder)["shape"][0]["max"][0] * THICKNESS
    found = []
    for row in rows(folder):
        xx, xy, yx, yy = (row[f"reaction_{of}"] / area for of in ("x:period_x", "y:period_x", "x:period_y", "y:period_y"))
        mean, half = 0.5 * (xx + yy), math.hypot(0.5 * (xx - yy), 0.5 * (xy + yx))
        found.append((mean + half, mean - half))
    return found


def specimen(name: str, title: str, second: float, largest: float, known: float) -> Specimen:
    strength = Measure("strength", lambda folder: largest_stress(folder) / known, allowed=0.05)
    return Specimen(name, title, "glass, second-hand", COARSEST, case(second, largest), (strength,))


def specimen_on_surface(name: str, title: str, second: float, largest: float) -> Specimen:
    reached = Measure("utilisation of the surface", utilisation, allowed=0.05)
    return Specimen(name, title, "Drucker and Prager, glass", COARSEST, on_surface(second, largest), (reached,))


# Uniaxial: the lateral strain is the elastic one, so the lateral stress is not quite zero when bonds soften.
SPECIMENS = [
    specimen("strength_uniaxial", "Glass under tension", -POISSON_RATIO, 4.0, TENSILE),
    specimen("strength_biaxial", "Glass under equal biaxial tension", 1.0, 1.5, BIAXIAL),
    specimen("strength_shear", "Glass in pure shear", -1.0, 2.5, SHEAR),
    specimen_on_surface("surface_uniaxial", "Strength surface under tension", -POISSON_RATIO, 4.0),
    specimen_on_surface("surface_biaxial", "Strength surface under equal biaxial tension", 1.0, 1.5),
    specimen_on_surface("surface_shear", "Strength surface in pure shear", -1.0, 2.5),
]
