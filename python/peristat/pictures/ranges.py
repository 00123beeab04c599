"""Values of points as colours: their range, the colours, the label of the colour bar; and the factor of displacements."""

from dataclasses import dataclass, field

import numpy as np
from matplotlib.colors import LinearSegmentedColormap, Normalize, PowerNorm

from .units import number, round_factor, unit_for

CLIPPED_SHARE = 99.5  # percentile at which a range may end
DAMAGE_COLOURS = LinearSegmentedColormap.from_list(  # lightness decreases monotonically
    "damage", ["#d9dfe5", "#f0b36a", "#d8562f", "#8c1c2b", "#2b0a18"]
)
SIGNED = "RdBu_r"  # of values of both signs


@dataclass
class Shades:
    """Values per point, and the colours that show them."""

    values: np.ndarray  # count, in the unit of the label
    label: str
    low: float  # the range of the colours
    high: float
    colours: object = "viridis"
    words: list[str] = field(default_factory=list)  # for the heading
    power: float = 1.0  # colours follow this power of the values

    @property
    def norm(self) -> Normalize:
        return Normalize(self.low, self.high) if self.power == 1.0 else PowerNorm(self.power, self.low, self.high)


def held_values(values: np.ndarray, floating: np.ndarray) -> np.ndarray:
    """Values of the held body alone, which set the scale; all values if the whole body floats."""
    return values if floating.all() else values[~floating]


def span(values: np.ndarray) -> tuple[float, float, float, float]:
    """The range of values without the few that stand out, and the whole range."""
    low, high = float(values.min()), float(values.max())
    end, begin = np.percentile(values, [CLIPPED_SHARE, 100.0 - CLIPPED_SHARE]).tolist()
    return begin if 0.7 * low < begin < 0.0 else low, end if 0.0 < end < 0.7 * high else high, low, high


def wider(one: tuple, other: tuple | None) -> tuple:
    """A span that contains two others."""
    return one if other is None else tuple(pick(pair) for pick, pair in zip((min, max, min, max), zip(one, other)))


def shades(values: np.ndarray, whole: tuple, meaning: str, units, colours=None, power: float = 1.0) -> Shades:
    """Values in one of the units, with the span that they are drawn in.

    If both signs matter the range is symmetric about zero. Colours that are given begin at zero. If the range leaves
    out a few values that stand out, the words give the largest.
    """
    begin, end, low, high = whole
    unit, size = unit_for(max(abs(begin), abs(end)), units)
    words = [f"up to {number(high / size)} {unit}".strip()] if end < high else []
    words += [f"down to {number(low / size)} {unit}".strip()] if begin > low else []
    if colours is None:
        largest = max(abs(begin), abs(end))
        is_signed = begin < -0.02 * largest and end > 0.02 * largest
        begin, end, colours = (-largest, largest, SIGNED) if is_signed else (begin, end, "viridis")
    else:
        begin = min(begin, 0.0)
    if end - begin <= 1e-12 * max(abs(begin), abs(end)):  # a constant field
        begin, end = min(begin, 0.0), max(end, 0.0)
    if end <= begin:
        end = begin + size
    return Shades(values / size, f"{meaning} [{unit}]" if unit else meaning, begin / size, end / size, colours, words, power)


def beyond(values: np.ndarray, low: float, high: float) -> str:
    """The ends of a colour bar at which values lie outside its range, apart from round-off."""
    slack = 1e-9 * (high - low)
    ends = (bool(values.min() < low - slack), bool(values.max() > high + slack))
    return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[ends]


# ---------------------------------------------------------------------------------- displacements


def exaggeration(reference: np.ndarray, step, share: float = 0.125) -> float:
    """Round factor that limits the largest displacement of the held body to a share of its size."""
    held = step.displacement if step.floating.all() else step.displacement[~step.floating]
    size = np.linalg.norm(np.ptp(reference, axis=0))
    largest = np.linalg.norm(held, axis=1).max()
    return round_factor(size * share / largest) if largest > 1e-14 * size else 1.0


def exaggeration_words(factor: float) -> str:
    if factor == 0.0:
        return "reference configuration"
    return "deformation to scale" if factor == 1.0 else f"deformation × {number(factor)}"
