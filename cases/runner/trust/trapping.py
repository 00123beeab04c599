"""What a lattice holds a running crack up with: K- and K+, the least and the largest stress intensity at which it
goes on, over K_Ic, by law, horizon ratio, angle and perturbation (surfing.py)."""

import csv
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import surfing
from run_all import Failed, Runs
from setting import FRACTURE_ENERGY
from specimen import ANGLES, Lattice, rows

# Of the table [material.damage], and the mode that follows the law without teeth.
LAWS = {
    "brittle": ('law = "critical_stretch"', "path"),
    "linear": ('law = "linear"', "newton"),
    "exponential": ('law = "exponential"', "newton"),
    "tanh": ('law = "tanh_continuous"', "newton"),
}
COLUMNS = ["law", "horizon_ratio", "angle", "perturbation", "least_K", "largest_K", "note"]


@dataclass(frozen=True)
class Setting:
    law: str
    ratio: float = 3.015
    angle: float = 0.0
    perturbation: float = 0.0

    @property
    def name(self) -> str:
        return f"{self.law}_m{self.ratio:g}_{self.angle:.0f}_p{self.perturbation:g}"


def settings(quick: bool) -> list[Setting]:
    if quick:
        return [Setting("linear")]
    ratios = [Setting(law, ratio) for law, most in (("brittle", 6), ("linear", 6)) for ratio in (3.015, 4.015, 6.015) if ratio < most + 1]
    angles = [Setting(law, angle=angle) for law in ("brittle", "linear") for angle in ANGLES[1:]]
    others = [Setting(law) for law in ("exponential", "tanh")]
    perturbed = [Setting(law, perturbation=0.2) for law in ("brittle", "linear")]
    return [*ratios, *angles, *others, *perturbed]


def text(of: Setting) -> str:
    law, mode = LAWS[of.law]
    case = surfing.text(Lattice(ratio=of.ratio, angle=of.angle), surfing.HORIZON / of.ratio)
    case = case.replace('law = "linear"', law).replace('mode = "newton"', f'mode = "{mode}"')
    if of.perturbation:
        case = case.replace("[lattice]\n", f"[lattice]\nperturbation = {of.perturbation}\n", 1)
    return case.replace("steps = 40\n", "steps = 40\nevent_tolerance = 0.01\n") if mode == "path" else case


def resistance(folder: Path) -> tuple[float, float]:
    """K- and K+ over K_Ic: sqrt(J / G_c) over the second half of the way, when the crack runs steadily."""
    found = [row["tip_J"] for row in rows(folder) if row["broken_bonds"] > 0]
    steady = found[len(found) // 2 :]
    return math.sqrt(min(steady) / FRACTURE_ENERGY), math.sqrt(max(steady) / FRACTURE_ENERGY)


def measure(runs: Runs, directory: Path, quick: bool, tell: Callable[[str], None]) -> None:
    """Writes trapping.csv, and trapping.svg where there are angles."""
    by_name = {f"trapping/{setting.name}": setting for setting in settings(quick)}
    found = []
    for ran in runs.run({name: text(setting) for name, setting in by_name.items()}):
        setting, note = by_name[ran.name], ""
        try:
            least, largest = ran.value(resistance)
            tell(f"{ran.name}: K- {least:.3f}, K+ {largest:.3f} of K_Ic")
        except Failed as failure:
            least, largest, note = math.nan, math.nan, str(failure)
            tell(f"{ran.name}: {failure}")
        found.append([setting.law, setting.ratio, setting.angle, setting.perturbation, least, largest, note])
    if runs.interrupted:
        return
    found.sort(key=lambda row: row[:4])
    with open(directory / "trapping.csv", "w", newline="") as table:
        csv.writer(table).writerows([COLUMNS, *found])
    if not quick:
        draw(found, directory / "trapping.svg")


def draw(found: list[list], path: Path) -> None:
    """K- to K+ over the angle of the lattice, a fourfold one, in polar coordinates."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "peristat"  # the same picture in every run
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(subplot_kw={"projection": "polar"}, figsize=(6, 5))
    for law, colour in (("brittle", "tab:red"), ("linear", "tab:blue")):
        of_law = sorted(row[2:6] for row in found if row[0] == law and row[1] == Setting("").ratio and row[3] == 0.0)
        around = [(angle, least, largest) for angle, _, least, largest in of_law]
        around += [(90 - angle, least, largest) for angle, least, largest in reversed(around[:-1])]
        angles = [math.radians(angle) for angle, _, _ in around]
        axes.fill_between(angles, [row[1] for row in around], [row[2] for row in around], color=colour, alpha=0.3)
        axes.plot(angles, [row[2] for row in around], "o-", color=colour, label=law)
    axes.plot([math.radians(angle) for angle in range(91)], [1.0] * 91, "k--", linewidth=1, label="$K_{Ic}$")
    axes.set_thetamin(0)
    axes.set_thetamax(90)
    axes.set_rlim(0, 1.35)
    axes.set_xlabel("$K_-$ to $K_+$ over $K_{Ic}$", labelpad=14)
    axes.legend(loc="upper right", bbox_to_anchor=(1.15, 1.05))
    axes.set_title("Angle between crack and lattice")
    figure.savefig(path, bbox_inches="tight", metadata={"Date": None})
    pyplot.close(figure)
