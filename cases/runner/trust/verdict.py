"""What the runs of an entry say: pass, or red with its reason."""

from dataclasses import dataclass

from specimen import MIDDLE, SPACINGS, Lattice, Specimen

CALIBRATION = "senb_05"  # the specimen that the setting, and the extension of cracks below, are from


@dataclass
class Verdict:
    specimen: Specimen
    values: dict[Lattice, float]  # over the reference
    failures: dict[Lattice, str]
    seconds: float
    extension: float | None = None  # kappa, see `extension_of`

    @property
    def finest(self) -> Lattice | None:
        straight = [lattice for lattice in self.values if (lattice.angle, lattice.ratio) == (0.0, Lattice().ratio)]
        return min(straight, key=lambda lattice: lattice.refinement, default=None)

    @property
    def raw(self) -> float | None:
        return None if self.finest is None else self.values[self.finest]

    @property
    def corrected(self) -> float | None:
        """The finest lattice's value over the reference of a crack that is longer by kappa horizons."""
        if self.raw is None or self.extension is None or self.specimen.of_longer_crack is None:
            return self.raw
        by = self.extension * self.specimen.spacing(self.finest) * self.finest.ratio
        return self.raw / self.specimen.of_longer_crack(by)

    @property
    def spread(self) -> float:
        """Half the range over angles and horizons at the middle spacing."""
        found = [value for lattice, value in self.values.items() if lattice.refinement == SPACINGS[MIDDLE]]
        return 0.5 * (max(found) - min(found)) if found else 0.0

    @property
    def passes(self) -> bool:
        return not self.failures and self.corrected is not None and abs(self.corrected - 1) <= self.specimen.allowed

    @property
    def reason(self) -> str:
        if self.failures:
            lattice, why = next(iter(self.failures.items()))
            return f"{lattice.name}: {why.partition(': ')[0]}"
        if self.passes:
            return ""
        off = f"{100 * (self.corrected - 1):+.1f} % where {100 * self.specimen.allowed:.0f} % are allowed"
        needs_more = self.extension is None and self.specimen.of_longer_crack is not None
        return off + f", not corrected: run it with surfing and {CALIBRATION}" * needs_more


def extension_of(specimen: Specimen, value: float, lattice: Lattice, resistance: float) -> float:
    """kappa of value = R P_LEFM(a + kappa horizon) / P_LEFM(a), by bisection."""
    horizon = specimen.spacing(lattice) * lattice.ratio
    low, high = -1.0, 3.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        if resistance * specimen.of_longer_crack(middle * horizon) > value:
            low = middle
        else:
            high = middle
    return low


HEADING = ["| entry | reference | quantity | ours over it, from the coarsest to the finest spacing | corrected | spread | allowed | |",
           "|---|---|---|---|---|---|---|---|"]  # fmt: skip


def row(of: Verdict) -> str:
    straight = sorted((lattice for lattice in of.values if (lattice.angle, lattice.ratio) == (0.0, Lattice().ratio)),
                      key=lambda lattice: -lattice.refinement)  # fmt: skip
    raw = ", ".join(f"{of.values[lattice]:.3f}" for lattice in straight)
    corrected = "" if of.corrected is None else f"{of.corrected:.3f}"
    sets_kappa = of.specimen.name == CALIBRATION and of.extension is not None
    word = f"sets κ = {of.extension:.2f}" if sets_kappa else "pass" if of.passes else f"**red**: {of.reason}"
    return (f"| {of.specimen.title} (`{of.specimen.name}`) | {of.specimen.reference} | {of.specimen.quantity} | {raw} "
            f"| {corrected} | ±{of.spread:.3f} | {of.specimen.allowed:g} | {word} |")  # fmt: skip
