"""Surfing boundary condition: the field of a crack tip moves steadily through a strip, and the crack follows it
[Hossain, Hsueh, Bourdin and Bhattacharya 2014]."""

import math
from dataclasses import dataclass

import lefm
from setting import FRACTURE_ENERGY, MODULUS, setting
from specimen import Lattice, aside

THICKNESS = 1e-3  # in 2D
LAYERS = 3  # in 3D, number of layers between two planes of symmetry


@dataclass(frozen=True)
class Strip:
    """Lengths in horizons."""

    half_height: float = 10.0
    half_length: float = 13.0
    way: float = 8.0  # travel of the field
    inner: float = 6.5  # radii of the ring of J around the middle
    outer: float = 8.5
    dimension: int = 2
    given_ratio: float | None = None  # Poisson's ratio of models that take any
    turn: float = 0.0  # angle by which the field turns on its way [rad]; the crack's path is then an arc

    @property
    def poisson_ratio(self) -> float:
        """Poisson's ratio: unless one is given, that of bond-based models in plane stress and in 3D."""
        if self.given_ratio is not None:
            return self.given_ratio
        return 1 / 3 if self.dimension == 2 else 1 / 4

    @property
    def modulus(self) -> float:
        """E that governs the opening of a crack: plane stress, or plane strain [Pa]."""
        return MODULUS if self.dimension == 2 else MODULUS / (1 - self.poisson_ratio**2)

    @property
    def toughness(self) -> float:
        return lefm.toughness(self.modulus, FRACTURE_ENERGY)

    def crack_area(self, unit: float) -> float:
        """Area that the field passes [m2]; `unit` is the horizon."""
        return self.way * unit * THICKNESS

    def text(self, lattice: Lattice, h: float) -> str:
        y, unit = aside(lattice, h), h * lattice.ratio
        height, length = self._whole(self.half_height, lattice, h), self._whole(self.half_length, lattice, h)
        start = -0.5 * self.way * unit
        u, v = self._field(unit, y)
        # If the field turns, the crack behind it does not lie on the field's axis: that edge is free.
        behind = "abs(x)" if self.turn == 0.0 else "x"
        thick = LAYERS * h
        corner, other, still, along = ("", "", "", "") if self.dimension == 2 else (", 0.0", f", {thick:.17g}", ", 0", ", 0")
        planes = "" if self.dimension == 2 else f'\n[[symmetry]]\naxis = "z"\n\n[[symmetry]]\naxis = "z"\nat = {thick:.17g}\n'
        ring = "" if self.turn else f"""
[[crack_tip]]
name = "tip"
at = [0.0, {y}{corner}]
direction = [1, 0{along}]
inner = {self.inner * unit}
outer = {self.outer * unit}
"""
        return setting(h, lattice, THICKNESS, ["rim"], self.dimension) + f"""
[[lattice.shape]]
add = "box"
min = [{-length}, {-height}{corner}]
max = [{length}, {height}{other}]

[[crack]]
{self._crack(-2 * length, start, y, thick)}

[[set]]
name = "rim"
where = "{behind} > {length - 1.05 * unit} || abs(y) > {height - 1.05 * unit}"

[[support]]
set = "rim"
displacement = ["{u}", "{v}"{still}]
{planes}{ring}
[loading]
steps = 40
"""  # fmt: skip

    def _whole(self, horizons: float, lattice: Lattice, h: float) -> float:
        """The given number of horizons; in 3D rounded up to whole spacings, because planes of symmetry need an aligned
        lattice."""
        return horizons * (h * lattice.ratio) if self.dimension == 2 else math.ceil(horizons * lattice.ratio) * h

    def _crack(self, begin: float, end: float, y: float, thick: float) -> str:
        if self.dimension == 2:
            slope = math.tan(-0.5 * self.turn)  # along the field at the start
            at = self._tip(0.0, end)[1] + y if self.turn else y
            return f"from = [{begin}, {at + slope * (begin - end)}]\nto = [{end}, {at}]"
        corners = [(begin, -thick), (end, -thick), (end, 2 * thick), (begin, 2 * thick)]
        return "vertices = [" + ", ".join(f"[{x}, {y}, {z}]" for x, z in corners) + "]"

    def _tip(self, load: float, start: float) -> tuple[float, float]:
        """Position on the arc at a load factor; the arc is horizontal in its middle."""
        radius = -2 * start / self.turn
        angle = (load - 0.5) * self.turn
        return radius * math.sin(angle), radius * (1 - math.cos(angle))

    def _field(self, unit: float, y: float) -> tuple[str, str]:
        way = self.way * unit
        if self.turn == 0.0:
            x, across = f"x-({-0.5 * way:.17g}+{way:.17g}*load)", f"y-({y:.17g})"
            return lefm.williams_opening(self.toughness, MODULUS, self.poisson_ratio, x, across, self.dimension == 3)
        angle, radius = f"({self.turn:.17g}*(load-0.5))", way / self.turn
        x, across = f"(x-{radius:.17g}*sin{angle})", f"(y-({y:.17g})-{radius:.17g}*(1-cos{angle}))"
        ahead, aside_ = f"{x}*cos{angle}+{across}*sin{angle}", f"{across}*cos{angle}-{x}*sin{angle}"
        u, v = lefm.williams_opening(self.toughness, MODULUS, self.poisson_ratio, ahead, aside_)
        return f"({u})*cos{angle}-({v})*sin{angle}", f"({u})*sin{angle}+({v})*cos{angle}"
