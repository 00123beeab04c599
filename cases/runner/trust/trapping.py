"""Lattice trapping of a running crack: K- and K+, the least and the largest stress intensity at which it runs, over
K_Ic, by law, horizon ratio, angle and perturbation (surfing.py)."""

import csv
import io
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from own_files import PICTURE, picture, write_own
from run_all import Failed, Runs
from setting import FRACTURE_ENERGY, MODULUS
from specimen import ANGLES, RATIOS, Lattice, rows
from strip import Strip

HORIZON = 3.015e-3  # m
# The table [material.damage], and the mode without saw teeth.
LAWS = {
    "brittle": ('law = "critical_stretch"', "path"),
    "linear": ('law = "linear"', "newton"),
    "exponential": ('law = "exponential"', "newton"),
    "tanh": ('law = "tanh_continuous"', "newton"),
}
ONSET = 8.90504e6 / MODULUS  # default onset for linear bonds of that energy and horizon, as `check` prints it
PATHS = {
    "straight": Strip(),
    "arc": Strip(turn=math.radians(30), way=10.0),
    "3d": Strip(half_height=6.0, half_length=8.0, way=4.0, inner=2.5, outer=4.5, dimension=3),
    "like_3d": Strip(half_height=6.0, half_length=8.0, way=4.0, inner=2.5, outer=4.5),
}
COLUMNS = ["law", "strength", "path", "horizon_ratio", "angle", "perturbation", "least_K", "largest_K", "note"]
FILES = {"trapping.csv": ",".join(COLUMNS).encode(), "trapping.svg": PICTURE}  # and their signatures


@dataclass(frozen=True)
class Setting:
    law: str
    ratio: float = RATIOS[0]
    angle: float = 0.0
    perturbation: float = 0.0
    strength: float = 1.0  # over the default
    path: str = "straight"

    @property
    def name(self) -> str:
        name = f"{self.law}_m{self.ratio:g}_{self.angle:.0f}_p{self.perturbation:g}"
        name += "" if self.strength == 1.0 else f"_s{self.strength:g}"
        return name + ("" if self.path == "straight" else f"_{self.path}")


def settings(quick: bool) -> list[Setting]:
    if quick:
        return [Setting("linear")]
    ratios = [Setting("linear", ratio) for ratio in (2.015, 4.015, 6.015, 8.015)]
    brittle = [Setting("brittle", ratio) for ratio in (4.015, 6.015)]
    angles = [Setting(law, angle=angle) for law in ("brittle", "linear") for angle in ANGLES]
    few = [Setting("linear", ratio, angle) for ratio in (2.015, 2.515) for angle in ANGLES if (ratio, angle) != (2.015, 0.0)]
    others = [Setting(law) for law in ("exponential", "tanh")]
    stronger = [Setting("linear", strength=strength, angle=angle) for strength in (1.2, 1.4, 1.6) for angle in (0.0, 45.0)]
    perturbed = [Setting(law, perturbation=0.2) for law in ("brittle", "linear")]
    paths = [Setting(law, path=path) for law in ("linear", "brittle") for path in ("arc", "like_3d", "3d")]
    return [*angles, *ratios, *few, *others, *stronger, *perturbed, *paths, *brittle]


def text(of: Setting) -> str:
    law, mode = LAWS[of.law]
    if of.strength != 1.0:
        law += f"\nonset = {of.strength * ONSET:.9g}"
    case = PATHS[of.path].text(Lattice(ratio=of.ratio, angle=of.angle), HORIZON / of.ratio)
    case = case.replace('law = "linear"', law).replace('mode = "newton"', f'mode = "{mode}"')
    if of.perturbation:
        case = case.replace("[lattice]\n", f"[lattice]\nperturbation = {of.perturbation}\n", 1)
    return case.replace("steps = 40\n", "steps = 40\nevent_tolerance = 0.01\n") if mode == "path" else case


def resistance(of: Setting, folder: Path) -> tuple[float, float]:
    """K- and K+ over K_Ic: sqrt(G / G_c) over the second half of the way, when the crack runs steadily."""
    if of.path == "arc":
        return resistance_by_work(PATHS[of.path], folder)
    found = [row["tip_J"] for row in rows(folder) if row["broken_bonds"] > 0]
    steady = found[len(found) // 2 :]
    return math.sqrt(min(steady) / FRACTURE_ENERGY), math.sqrt(max(steady) / FRACTURE_ENERGY)


def resistance_by_work(strip: Strip, folder: Path) -> tuple[float, float]:
    """Energy per area that is no longer stored, in each of the last three quarters of the way: the ring of J does not
    apply to a crack that turns."""
    history = rows(folder)
    lost = []
    for quarter in (0.25, 0.5, 0.75, 1.0):
        row = min(history, key=lambda row: abs(row["load_factor"] - quarter))
        lost.append(row["dissipated_energy"] + row["drained_energy"])
    area = 0.25 * strip.crack_area(HORIZON)
    found = [math.sqrt((after - before) / area / FRACTURE_ENERGY) for before, after in zip(lost, lost[1:])]
    return min(found), max(found)


def measure(runs: Runs, directory: Path, quick: bool, tell: Callable[[str], None]) -> bool:
    """Writes trapping.csv, and trapping.svg if several angles were run. Returns True: nothing is judged."""
    by_name = {f"trapping/{setting.name}": setting for setting in settings(quick)}
    found = []
    for ran in runs.run({name: text(setting) for name, setting in by_name.items()}):
        setting, note = by_name[ran.name], ""
        try:
            least, largest = ran.value(lambda folder: resistance(setting, folder))
            tell(f"{ran.name}: K- {least:.3f}, K+ {largest:.3f} of K_Ic")
        except Failed as failure:
            least, largest, note = math.nan, math.nan, str(failure)
            tell(f"{ran.name}: {failure}")
        found.append([setting.law, setting.strength, setting.path, setting.ratio, setting.angle, setting.perturbation, least, largest, note])
    if runs.interrupted:
        return True
    found.sort(key=lambda row: row[:6])
    table = io.StringIO(newline="")
    csv.writer(table).writerows([COLUMNS, *found])
    write_own(directory / "trapping.csv", table.getvalue().encode(), FILES["trapping.csv"])
    if not quick:
        draw(found, directory / "trapping.svg")
    return True


def draw(found: list[list], path: Path) -> None:
    """K- to K+ over the angle of the lattice, with fourfold symmetry, in polar coordinates."""
    import matplotlib

    matplotlib.use("Agg")
    matplotlib.rcParams["svg.hashsalt"] = "peristat"  # the same picture in every run
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(subplot_kw={"projection": "polar"}, figsize=(6, 5))
    for law, colour in (("brittle", "tab:red"), ("linear", "tab:blue")):
        plain = [law, 1.0, "straight", RATIOS[0]]
        around = sorted((row[4], *row[6:8]) for row in found if row[:4] == plain and row[5] == 0.0)
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
    write_own(path, picture(figure, "svg", bbox_inches="tight"), PICTURE)
    pyplot.close(figure)
