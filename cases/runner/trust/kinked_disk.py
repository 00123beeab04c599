"""A disk whose rim moves as the field of K_I, K_II and a T-stress around a crack that ends in its middle, and the
direction in which that crack grows."""

import math
from dataclasses import dataclass
from pathlib import Path

import crack_path
import lefm
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import RATIOS, Lattice, aside, rows

SPACING, RATIO, THICKNESS = 1e-3, RATIOS[0], 1e-3  # m
HORIZON = RATIO * SPACING
POISSON_RATIO = 1 / 3  # of bonds in plane stress
RADIUS, RING = 12.0, 1.5  # of the disk, and width of the ring that moves, in horizons
NEAR, FAR = 2.0, 5.0  # the chord is that of bonds between these distances from the tip, in horizons
# sqrt(K_I^2 + K_II^2) / K_Ic. At K_II / K_I = 0.577 steps half as large break the same bonds, at 27 degrees and on blue
# noise of seed 1; on a larger disk steps of 0.05 turned a crack by 4.5 degrees more than these of 0.033.
LOADS = [0.0, 0.4, 0.7, *(0.1 * k for k in range(8, 18))]
STEPS = 3  # from each load to the next
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)


@dataclass(frozen=True)
class Loading:
    """The field's proportions."""

    sliding: float  # K_II / K_I
    stress: float  # T sqrt(pi horizon) / sqrt(K_I^2 + K_II^2)

    @property
    def name(self) -> str:
        return f"{self.sliding:g}_{self.stress:+g}"

    @property
    def factors(self) -> tuple[float, float, float]:
        """K_I, K_II [Pa sqrt(m)] and T [Pa] at load 1."""
        opening = TOUGHNESS / math.hypot(1.0, self.sliding)
        return opening, self.sliding * opening, self.stress * TOUGHNESS / math.sqrt(math.pi * HORIZON)


@dataclass(frozen=True)
class Points:
    """A lattice at an angle [degrees], or blue noise of a seed, finer along the crack's way."""

    angle: float = 0.0
    seed: int = 0
    finer: int = 1

    @property
    def name(self) -> str:
        return f"noise{self.seed}" + (f"_{self.finer}" if self.finer > 1 else "") if self.seed else f"{self.angle:.0f}"


def text(loading: Loading, points: Points) -> str:
    y = tip_height(points)
    u, v = displacement(loading, f"(y-({y:.17g}))")
    case = setting(SPACING, Lattice(ratio=RATIO, angle=points.angle), THICKNESS, ["rim"]) + f"""
[[lattice.shape]]
add = "disk"
centre = [0.0, 0.0]
radius = {RADIUS * HORIZON:.17g}

[[crack]]
from = [{-2 * RADIUS * HORIZON:.17g}, {y:.17g}]
to = [0.0, {y:.17g}]

[[set]]
name = "rim"
where = "x^2 + y^2 > {((RADIUS - RING) * HORIZON) ** 2:.17g}"

[[support]]
set = "rim"
displacement = ["{u}", "{v}"]

[[crack_tip]]
name = "tip"
at = [0.0, {y:.17g}]
direction = [1, 0]

[loading]
table = [{", ".join(f"{load:g}" for load in LOADS)}]
steps = {STEPS}
"""  # fmt: skip
    return case.replace("angle = 0.0\n", noise(points)) if points.seed else case


def noise(points: Points) -> str:
    """Lines of blue noise; the region of finer points contains the crack until it has grown by FAR."""
    low, high = -1.5 * HORIZON, (FAR + 0.5) * HORIZON
    region = f'shape = "box", min = [{low:.6g}, {-high:.6g}], max = [{high:.6g}, {-low:.6g}], spacing = {SPACING / points.finer:g}'
    return f'points = "blue_noise"\nseed = {points.seed}\n' + (f"refine = [{{ {region} }}]\n" if points.finer > 1 else "")


def tip_height(points: Points) -> float:
    return 0.0 if points.seed else aside(Lattice(angle=points.angle), SPACING)


def displacement(loading: Loading, y: str) -> tuple[str, str]:
    """Displacements of the field as expressions in x, y and load; T stretches x by T / E and y by -nu T / E."""
    opening, sliding, stress = loading.factors
    first = lefm.williams_opening(opening, MODULUS, POISSON_RATIO, "x", y)
    second = lefm.williams_sliding(sliding, MODULUS, POISSON_RATIO, "x", y)
    along = stress / MODULUS
    return (f"load*({first[0]}+{second[0]}+({along:.17g})*x)",
            f"load*({first[1]}+{second[1]}+({-POISSON_RATIO * along:.17g})*{y})")  # fmt: skip


def direction(middles: list[crack_path.Place], horizon: float) -> float:
    """Angle [degrees] of the chord from the tip, at the origin, to the mean of the midpoints from NEAR to FAR.

    @raise ValueError if the crack does not reach FAR
    """
    reach = max((math.hypot(*middle) for middle in middles), default=0.0) / horizon
    if reach < FAR:
        raise ValueError(f"the crack has grown {reach:.1f} horizons of {FAR:g}")
    between = [middle for middle in middles if NEAR <= math.hypot(*middle) / horizon <= FAR]
    x, y = (sum(middle[axis] for middle in between) for axis in (0, 1))
    return math.degrees(math.atan2(y, x))


@dataclass(frozen=True)
class Found:
    """Direction [degrees], and what the elastic body's ring integrals make of the field: K_I and K_II over the given
    ones, and T sqrt(pi horizon) / sqrt(K_I^2 + K_II^2)."""

    direction: float = math.nan
    opening: float = math.nan
    sliding: float = math.nan
    stress: float = math.nan
    note: str = ""


def find(loading: Loading, points: Points, folder: Path) -> Found:
    y = tip_height(points)
    middles = [(a, b - y) for a, b in crack_path.broken_middles(folder)]
    first = rows(folder)[0]  # before anything is damaged
    opening, sliding, _ = (first["load_factor"] * factor for factor in loading.factors)
    stress = first["tip_T"] * math.sqrt(math.pi * HORIZON) / math.hypot(opening, sliding)
    return Found(direction(middles, HORIZON), first["tip_K1"] / opening, first["tip_K2"] / sliding, stress)
