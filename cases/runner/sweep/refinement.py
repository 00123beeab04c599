"""Convergence of a quantity under refinement of the lattice: its order, its extrapolated value, and the error
estimate on the finest lattice (Roache 1994, Celik et al. 2008)."""

import csv
import io
import math
from dataclasses import dataclass
from pathlib import Path

from own_files import write_own

SAFETY = 1.25  # Roache's safety factor for three lattices, and for more whose orders agree
CAUTION = 3.0  # his factor if the order is not confirmed
AGREEMENT = 0.25  # largest relative difference of two orders that agree
TOLERANCE = 1e-8  # changes below this share of the value are due to the solvers' tolerances
COLUMNS = ["quantity", "behaviour", "observed_order", "order_before", "extrapolated", "uncertainty",
           "grid_convergence_index"]  # fmt: skip
SIGN = ",".join(COLUMNS).encode()  # signature of the table


@dataclass
class Refinement:
    """Values of one quantity on lattices from the coarsest to the finest."""

    quantity: str
    spacings: list[float]
    values: list[float]
    behaviour: str  # "monotone", "oscillating", "not converging", "constant"
    order: float | None = None  # p of the three finest lattices
    order_before: float | None = None  # p of the three lattices before them
    extrapolated: float | None = None  # to spacing 0
    uncertainty: float | None = None  # absolute, of the value on the finest lattice

    @property
    def index(self) -> float | None:
        """Grid convergence index: the uncertainty as a share of the value on the finest lattice."""
        if self.uncertainty is None or self.values[-1] == 0.0:
            return None
        return abs(self.uncertainty / self.values[-1])

    def told(self) -> str:
        if self.behaviour == "monotone":
            return (f"order {self.order:.2f}, {self.extrapolated:.6g} at spacing 0; "
                    f"the finest is {self.values[-1]:.6g} ± {self.uncertainty:.2g}")  # fmt: skip
        return f"{self.behaviour}; the finest is {self.values[-1]:.6g}" + (
            f" ± {self.uncertainty:.2g}" if self.uncertainty else "")


def observed_order(spacings: list[float], values: list[float]) -> float | None:
    """p of f(h) = f0 + C h^p through three points from coarse to fine, whose changes have the same sign.

    With r = h1/h2, s = h2/h3: (f1 - f2)/(f2 - f3) = s^p (r^p - 1)/(s^p - 1), solved by bisection.
    """
    first, second = values[0] - values[1], values[1] - values[2]
    if first * second <= 0.0:
        return None
    r, s = spacings[0] / spacings[1], spacings[1] / spacings[2]
    excess = lambda p: s**p * math.expm1(p * math.log(r)) / math.expm1(p * math.log(s)) - first / second
    low, high = 1e-6, 20.0
    if excess(low) >= 0.0 or excess(high) <= 0.0:
        return None
    for _ in range(100):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if excess(middle) < 0.0 else (low, middle)
    return 0.5 * (low + high)


def refine(quantity: str, spacings: list[float], values: list[float]) -> Refinement:
    """Refinement from at least three lattices, from the coarsest to the finest."""
    found = Refinement(quantity, spacings, values, "not converging")
    last = values[-1]
    change, before = values[-2] - last, values[-3] - values[-2]
    if abs(change) <= TOLERANCE * abs(last):
        # No order can be determined. The last two may agree by chance, so the change before them counts.
        is_still = abs(before) <= TOLERANCE * abs(last)
        found.behaviour, found.extrapolated = "constant", last
        found.uncertainty = 0.0 if is_still else abs(before)
        return found
    if len(values) > 3:
        found.order_before = observed_order(spacings[-4:-1], values[-4:-1])
    if change * before < 0.0:
        # No order can be determined; the values oscillate within this range.
        found.behaviour = "oscillating"
        found.uncertainty = CAUTION * 0.5 * (max(values[-3:]) - min(values[-3:]))
        return found
    found.order = observed_order(spacings[-3:], values[-3:])
    if found.order is None:
        return found
    found.behaviour = "monotone"
    rest = change / math.expm1(found.order * math.log(spacings[-2] / spacings[-1]))
    found.extrapolated = last - rest
    found.uncertainty = (SAFETY if _is_settled(found) else CAUTION) * abs(rest)
    return found


def _is_settled(of: Refinement) -> bool:
    if len(of.values) == 3:
        return True
    return of.order_before is not None and abs(of.order_before - of.order) <= AGREEMENT * of.order


def write_refinements(path: Path, keys: list[str], rows: list[tuple[tuple[str, ...], Refinement]]) -> None:
    """Replaces the table by a complete new one in one rename."""
    levels = len(rows[0][1].spacings)
    names = [f"{kind}_{level}" for level in range(1, levels + 1) for kind in ("spacing", "value")]
    text = io.StringIO(newline="")
    table = csv.writer(text, lineterminator="\n")
    table.writerow([*keys, *COLUMNS, *names])
    for values, of in rows:
        numbers = [of.order, of.order_before, of.extrapolated, of.uncertainty, of.index]
        lattices = [number for pair in zip(of.spacings, of.values) for number in pair]
        table.writerow([*values, of.quantity, of.behaviour,
                        *("" if number is None else repr(number) for number in [*numbers, *lattices])])  # fmt: skip
    write_own(path, text.getvalue().encode("utf-8", "surrogateescape"), SIGN)
