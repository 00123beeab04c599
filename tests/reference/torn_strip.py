"""Straight tears through the command line: two halves of a body are pulled apart until no bond joins them."""

import itertools
import json
import math
from dataclasses import dataclass, field

from tests.reference.clouds import toml
from tests.reference.program import peristat

# Directions in which the lattice repeats, with the period in spacings.
ANGLES = ((0.0, 1.0), (math.degrees(math.atan(0.5)), math.sqrt(5.0)), (45.0, math.sqrt(2.0)))
SPACING, THICKNESS = 1e-3, 0.5


@dataclass
class TornStrip:
    """A strip of a lattice that is turned by an angle about z, torn along the plane y = 0, between its points."""

    material: dict
    ratio: float
    angle: float
    period: float  # of the lattice along x [spacings]
    dimension: int = 2
    quadrature: dict = field(default_factory=dict)
    steps: int = 1
    opening: float = 0.0  # [m]; 0: wide enough to break every bond at once

    def tables(self, length, width):
        """A strip of that length along x and, in space, width along z [m]."""
        # Surfaces affect a bond across the plane only through a correction.
        half = (2 * self.ratio + 3 if "surface_correction" in self.quadrature else self.ratio + 1) * SPACING
        low, high = [0, -half, 0], [length, half, width]
        opening = self.opening or 20 * self.ratio * SPACING
        lattice = {"spacing": SPACING, "horizon_ratio": self.ratio, "angle": self.angle}
        if self.dimension == 2:
            lattice["thickness"] = THICKNESS
        box = {"add": "box", "min": low[: self.dimension], "max": high[: self.dimension]}
        return {
            "dimension": self.dimension, "lattice": lattice | {"shape": [box]},
            "set": [{"name": "low", "where": "y < 1.23e-5"}, {"name": "high", "where": "y >= 1.23e-5"}],
            "quadrature": self.quadrature, "material": self.material,
            "support": [{"set": "low", "displacement": [0] * self.dimension},
                        {"set": "high", "displacement": [0, f"{opening}*load", 0][: self.dimension]}],
            "loading": {"steps": self.steps}, "solver": {"mode": "relaxation"}, "output": {"every": self.steps},
        }  # fmt: skip

    def energy(self, folder):
        """Dissipated energy over area [J/m2] in the middle of the strip: the increase for a longer (and wider)
        strip."""
        more = 2
        least = 4 * self.ratio + 3 if "surface_correction" in self.quadrature else self.ratio + 1
        lengths, widths = self._two(least, self.period, more), self._two(least, 1.0, more)
        if self.dimension == 2:
            short, long = (self.dissipated(self.tables(length, 0.0), folder) for length in lengths)
            return (long - short) / (more * self.period * SPACING * THICKNESS)
        of = [self.dissipated(self.tables(*size), folder) for size in itertools.product(lengths, widths)]
        return (of[3] - of[2] - of[1] + of[0]) / (more**2 * self.period * SPACING**2)

    @staticmethod
    def _two(least, period, more):
        """A length of at least the given one, and one that is longer by some periods; slightly more, so that no point
        is on the end."""
        periods = math.ceil(least / period)
        return [n * period * SPACING * (1 + 1e-12) for n in (periods, periods + more)]

    @staticmethod
    def dissipated(tables, folder):
        case = folder / "case.toml"
        case.write_text(toml(tables))
        run = peristat("run", case, "--quiet", "--overwrite", "--output", folder / "out")
        if run.code != 0:
            raise RuntimeError(run.said)
        return json.loads((folder / "out/summary.json").read_text())["energy"]["dissipated"]
