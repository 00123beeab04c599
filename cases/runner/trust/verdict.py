"""The result of an entry's runs for one quantity: pass, or red with the reason."""

from dataclasses import dataclass

from refinement import Refinement, refine
from specimen import Lattice, Measure, Specimen

CALIBRATION = "senb_05"  # the specimen that the setting and the crack extension below come from


@dataclass
class Verdict:
    specimen: Specimen
    measure: Measure
    values: dict[Lattice, float]  # over the reference
    failures: dict[Lattice, str]
    seconds: float
    extension: dict[Lattice, float]  # kappa, see `extension_of`; empty: unknown

    @property
    def straight(self) -> list[Lattice]:
        """Straight lattices from the coarsest to the finest."""
        return sorted((lattice for lattice in self.values if lattice.is_straight), key=lambda lattice: -lattice.refinement)

    @property
    def judged_at(self) -> Lattice | None:
        """The lattice at which the quantity is judged; if it was not run, the finest one that was run and is no
        finer."""
        return next((lattice for lattice in reversed(self.straight) if lattice.refinement >= self.measure.at), None)

    @property
    def raw(self) -> float | None:
        return None if self.judged_at is None else self.values[self.judged_at]

    def corrected_on(self, lattice: Lattice) -> float:
        """The value over the reference for a crack that is longer by kappa horizons."""
        value = self.values[lattice]
        if lattice not in self.extension or self.measure.of_longer_crack is None:
            return value
        by = self.extension[lattice] * self.specimen.spacing(lattice) * lattice.ratio
        return value / self.measure.of_longer_crack(by)

    @property
    def corrected(self) -> float | None:
        return None if self.judged_at is None else self.corrected_on(self.judged_at)

    @property
    def refinement(self) -> Refinement | None:
        """Convergence of the values with the spacing. A peak is replaced by its inverse square, which a process zone of
        fixed length makes linear in the spacing [Bažant and Planas 1998]."""
        if len(self.straight) < 3:
            return None
        values = [self.values[lattice] for lattice in self.straight]
        if self.measure.of_longer_crack is not None:
            values = [value**-2 for value in values]
        return refine(self.measure.quantity, [self.specimen.spacing(lattice) for lattice in self.straight], values)

    @property
    def extrapolated(self) -> tuple[float | None, float | None]:
        """The value at spacing 0, and the uncertainty of the finest value: its grid convergence index times the
        value."""
        found = self.refinement
        if found is None:
            return None, None
        finest = self.values[self.straight[-1]]
        is_inverse_square = self.measure.of_longer_crack is not None
        share = None if found.index is None else found.index * (0.5 if is_inverse_square else 1.0)
        limit = found.extrapolated
        if limit is not None and is_inverse_square:
            limit = limit**-0.5 if limit > 0 else None
        return limit, None if share is None else share * finest

    @property
    def spread(self) -> float:
        """Half the range of the corrected values over angles and horizons at the middle spacing."""
        found = [self.corrected_on(lattice) for lattice in self.values if lattice.refinement == self.specimen.middle]
        return 0.5 * (max(found) - min(found)) if found else 0.0

    @property
    def judged(self) -> dict[Lattice, float]:
        if self.judged_at is None:
            return {}
        asked = [self.judged_at]
        if self.measure.on_every_lattice:
            asked += [lattice for lattice in self.values if not lattice.is_straight]
        return {lattice: self.corrected_on(lattice) for lattice in asked}

    @property
    def worst(self) -> Lattice | None:
        return max(self.judged, key=lambda lattice: abs(self.judged[lattice] - 1), default=None)

    @property
    def passes(self) -> bool:
        return not self.failures and self.worst is not None and abs(self.judged[self.worst] - 1) <= self.measure.allowed

    @property
    def reason(self) -> str:
        if self.failures:
            lattice, why = next(iter(self.failures.items()))
            return f"{lattice.name}: {why[:100]}"
        if self.passes:
            return ""
        where = "" if self.worst == self.judged_at else f" on {self.worst.name}"
        off = f"{100 * (self.judged[self.worst] - 1):+.1f} %{where} where {100 * self.measure.allowed:.0f} % are allowed"
        needs_more = not self.extension and self.measure.of_longer_crack is not None
        return off + f", not corrected: run it with surfing and {CALIBRATION}" * needs_more


def extension_of(beam: Verdict, lattice: Lattice, resistance: float) -> float:
    """kappa of value = R P_LEFM(a + kappa horizon) / P_LEFM(a), by bisection."""
    horizon = beam.specimen.spacing(lattice) * lattice.ratio
    low, high = -1.0, 3.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if resistance * beam.measure.of_longer_crack(middle * horizon) > beam.values[lattice]:
            low = middle
        else:
            high = middle
    return low


HEADING = ["| entry | reference | quantity | peristat over reference, from the coarsest to the finest spacing | at spacing 0 "
           "| corrected | over lattices | allowed | |",
           "|---|---|---|---|---|---|---|---|---|"]  # fmt: skip


def row(of: Verdict) -> str:
    raw = ", ".join(f"{of.values[lattice]:.3f}" for lattice in of.straight)
    limit, uncertainty = of.extrapolated
    raw += "" if uncertainty is None else f" ± {uncertainty:.3f}"
    corrected = "" if of.corrected is None or of.measure.of_longer_crack is None else f"{of.corrected:.3f}"
    sets_kappa = of.specimen.name == CALIBRATION and of.extension and of.measure.of_longer_crack is not None
    word = (f"sets κ = {of.extension[of.judged_at]:.2f}" if sets_kappa
            else "pass" if of.passes else f"**red**: {of.reason}")  # fmt: skip
    return (f"| {of.specimen.title} (`{of.specimen.name}`) | {of.specimen.reference} | {of.measure.quantity} | {raw} "
            f"| {'' if limit is None else f'{limit:.3f}'} | {corrected} | ±{of.spread:.3f} | {of.measure.allowed:g} | {word} |")  # fmt: skip
