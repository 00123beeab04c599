"""What cutting struts changes, `material.damage.struts = "keep"` beside "cut":

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 benchmarks/struts.py [tear] [arc] [kink]

tear: a plate with an edge crack (16 x 12 spacings) is torn in two by a pull and a shear: its last force over the largest,
and the dissipated energy over that of halves that move straight apart. arc: the field of a crack tip moves along an arc
of half a radian and 8 horizons, and the crack follows it: energy dissipated per area of the second half of the arc, over
the fracture energy. kink: directions of cracks under K_I and K_II, as `./peristat trust kink` finds them.
"""

import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path[:0] = [str(ROOT), str(ROOT / "cases/runner/trust"), str(ROOT / "cases/runner/sweep")]

import kinked_disk  # noqa: E402
from specimen import ANGLES, Lattice, rows  # noqa: E402
from strip import Strip  # noqa: E402
from surfing import dissipation  # noqa: E402
from tests.acceptance.struts_test import PULL, TORN, straight_tear, tail  # noqa: E402
from tests.acceptance.motions import columns  # noqa: E402
from tests.reference.program import peristat  # noqa: E402

REMEDIES = ("keep", "cut")
PULLS = ((3, 0), (3, 2), (1.5, 2), (3, 4), (2, -3))  # 1e-4 m
SLIDINGS = (0.577, 0.859)
POINTS = [*map(kinked_disk.Points, ANGLES), *(kinked_disk.Points(seed=seed) for seed in (1, 2))]


def run(folder: Path, name: str, text: str, remedy: str) -> Path:
    """The results of a case, which is kept in the folder above them."""
    case = folder / name.replace(" ", "_") / remedy / "case.toml"
    case.parent.mkdir(parents=True)
    case.write_text(text)
    words = ("--set", f'material.damage.struts="{remedy}"', "--quiet", "--no-plots", "--threads", 1)
    ended = peristat("run", case, "--output", case.parent / "out", *words, seconds=3600)
    if ended.code != 0:
        raise SystemExit(ended.said)
    return case.parent / "out"


def row(name: str, *values: float, digits: int = 3) -> None:
    print(f"| {name} | " + " | ".join(f"{value:.{digits}f}" for value in values) + " |", flush=True)


def tear(folder: Path) -> None:
    straight = columns(run(folder, "straight", straight_tear(), "keep"))["dissipated_energy"][-1]
    print("| pull, shear [1e-4 m] | last force over largest, keep | cut | dissipated over straight tear, keep | cut | of it stored in struts |")
    print("|---|---|---|---|---|---|")
    for pull in PULLS:
        text = TORN.replace(PULL, f'["{pull[0]}e-4*load", "{pull[1]}e-4*load"]')
        kept, cut = (columns(run(folder, f"tear {pull}", text, remedy)) for remedy in REMEDIES)
        energies = [found["dissipated_energy"][-1] / straight for found in (kept, cut)]
        row(f"{pull[0]:g}, {pull[1]:g}", tail(kept), tail(cut), *energies, cut["strut_energy"][-1] / straight)


def arc(folder: Path) -> None:
    print("| lattice | dissipated energy over area, keep | cut |\n|---|---|---|")
    for angle in (0.0, 45.0):
        text = Strip(turn=0.5).text(Lattice(angle=angle), 1e-3)
        row(f"{angle:.0f}°", *(dissipation(run(folder, f"arc {angle:.0f}", text, remedy)) for remedy in REMEDIES))


def kink(folder: Path) -> None:
    print("| K_II / K_I | points | direction, keep | cut | work, cut over keep |\n|---|---|---|---|---|")
    for sliding in SLIDINGS:
        for points in POINTS:
            loading = kinked_disk.Loading(sliding, 0.0)
            name, text = f"{sliding} {points.name}", kinked_disk.text(loading, points)
            found = [run(folder, name, text, remedy) for remedy in REMEDIES]
            directions = [kinked_disk.find(loading, points, out).direction for out in found]
            kept, cut = (rows(out)[-1]["external_work"] for out in found)
            print(f"| {sliding:g} | {points.name} | {directions[0]:.1f} | {directions[1]:.1f} | {cut / kept:.3f} |", flush=True)


def main() -> None:
    with tempfile.TemporaryDirectory() as folder:
        for measure in (tear, arc, kink):
            if measure.__name__ in (sys.argv[1:] or ("tear", "arc", "kink")):
                measure(Path(folder))


if __name__ == "__main__":
    main()
