"""From strength to toughness: glass with edge cracks from half to 16 times the length at which Griffith's load is the

strength. The load of a short crack is that of the strength, the load of a long one Griffith's, and in between the
reference is El Haddad's interpolation, a crack longer by that length [El Haddad et al. 1979]. Both edges are cracked, so
that the plate does not bend. Along the lattice only one half up to a plane of symmetry is modelled."""

import math
from dataclasses import dataclass
from pathlib import Path

import lefm
from centre_crack import has_one_tip
from other_setting import of_material
from setting import setting, under_opening
from specimen import Lattice, Measure, Specimen, aside, peak, rows
from strength import FRACTURE_ENERGY, MODULUS, TENSILE

THICKNESS = 1e-3
TOUGHNESS = lefm.toughness(MODULUS, FRACTURE_ENERGY)
ZONE = MODULUS * FRACTURE_ENERGY / TENSILE**2  # characteristic length [m]
SHORTEST = lefm.edge_crack(TOUGHNESS, TENSILE)  # at which Griffith's load is the strength [m]


@dataclass(frozen=True)
class Plate:
    size: float  # crack length over SHORTEST
    share: float  # crack length over half of the width

    @property
    def crack(self) -> float:
        return self.size * SHORTEST

    @property
    def half(self) -> float:
        """Half of the width [m]."""
        return self.crack / self.share

    @property
    def strength(self) -> float:
        """Stress that the uncracked section bears [Pa]."""
        shape = lefm.double_edge_factor(self.share)
        return TOUGHNESS / (shape * math.sqrt(math.pi * (self.crack + (TOUGHNESS / (shape * TENSILE)) ** 2 / math.pi)))

    @property
    def coarsest(self) -> float:
        """A quarter of the crack or of the zone, or a little less: a third of half the width has whole spacings, and
        so has that half at three quarters and at half of this spacing, as a plane of symmetry needs."""
        return self.half / (3 * math.ceil(self.half / (3 * min(self.crack / 4, ZONE / 4))))

    def text(self, lattice: Lattice, h: float) -> str:
        y, half, height = aside(lattice, h), self.half, 2.4 * self.half
        right = 0.0 if has_one_tip(lattice) else half
        cracks = [(-2 * half, self.crack - half)] + ([] if has_one_tip(lattice) else [(half - self.crack, 2 * half)])
        cut = "".join(f"[[crack]]\nfrom = [{begin}, {y}]\nto = [{end}, {y}]\n\n" for begin, end in cracks)
        held = '[[symmetry]]\naxis = "x"\n' if has_one_tip(lattice) else (
            f'[[set]]\nname = "corner"\nwhere = "abs(x) < {1.1 * h} && y < {-0.5 * height + 1.5 * h}"\n\n'
            '[[support]]\nset = "corner"\ndisplacement = [0, "-load"]\n')  # fmt: skip
        opening = 6 * self.strength * self.crack / MODULUS + 0.6 * FRACTURE_ENERGY / TENSILE
        return of_material(setting(h, lattice, THICKNESS, ["ends"]), MODULUS, FRACTURE_ENERGY, TENSILE) + f"""
[[lattice.shape]]
add = "box"
min = [{-half}, {-0.5 * height}]
max = [{right}, {0.5 * height}]

{cut}[[set]]
name = "ends"
where = "abs(y) > {0.3 * height}"

[[set]]
name = "top"
where = "y > {0.5 * height - 1.5 * h}"

[[set]]
name = "bottom"
where = "y < {-0.5 * height + 1.5 * h}"

[[set]]
name = "above"
where = "x < {-half + 1.5 * h} && y > {y} && y < {y + 1.5 * h}"

[[set]]
name = "below"
where = "x < {-half + 1.5 * h} && y < {y} && y > {y - 1.5 * h}"

[[support]]
set = "top"
displacement = ["free", "load"]

[[support]]
set = "bottom"
displacement = ["free", "-load"]

{held}
""" + under_opening("above", "below", "[0, 1]", 2 * opening, follow_growth=False)  # fmt: skip

    def value(self, folder: Path) -> float:
        history = rows(folder)
        area = THICKNESS * self.half * (1 if "reaction_y:symmetry_x" in history[0] else 2)
        return peak([abs(row["reaction_y:top"]) for row in history]) / (area * self.strength)


def specimen(plate: Plate) -> Specimen:
    title = f"Edge crack, {plate.size:g} times the length of the transition"
    strength = Measure("stress at the peak", plate.value, allowed=0.1, at=0.5)
    name = f"edge_crack_{plate.size:g}".replace(".", "")
    return Specimen(name, title, "strength and Griffith", plate.coarsest, plate.text, (strength,), spacings=(1.0, 0.75, 0.5))


PLATES = [Plate(0.5, 1 / 10), Plate(2.0, 1 / 8), Plate(8.0, 1 / 4), Plate(16.0, 0.4)]
SPECIMENS = [specimen(plate) for plate in PLATES]
