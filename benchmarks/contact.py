"""Contact of points beside closed forms, in the shipped cases:

    PERISTAT_PROGRAM=build/release/peristat /usr/bin/python3 -B benchmarks/contact.py

The stiffness of a bar with a closed cut over that of the whole bar, by spacing and by stiffness of the contact; energy
and speed of two halves that collide, by the share of the stable step; and the slip of a closed inclined crack over that
of an infinite plate, by spacing and friction.
"""

import os
import pathlib
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.acceptance.motions import columns  # noqa: E402
from tests.reference.program import peristat, settings  # noqa: E402

CUT = ROOT / "cases/contact/closed_crack.toml"
INCLINED = ROOT / "cases/contact/inclined_crack.toml"
IMPACT = ROOT / "cases/contact/impact.toml"
ENERGY = 0.5 * 2700 * 0.080 * 0.004 * 1e-3 * 10.0**2  # J


def run(folder, case, *changes):
    ended = peristat("run", case, "--output", folder / "out", "--overwrite", "--no-plots", "--quiet", *settings(*changes))
    if ended.code != 0:
        raise SystemExit(ended.said)
    return columns(folder / "out")


def cut_bar(folder):
    text = CUT.read_text()
    whole = folder / "whole.toml"
    whole.write_text(text[: text.index("[[crack]]")] + text[text.index("[[support]]") :])
    print("| spacings along the bar | " + " | ".join(f"alpha = {alpha:g}" for alpha in (0.5, 1, 2, 100)) + " |\n|---|---|---|---|---|")
    for spacing in (1e-3, 5e-4, 2.5e-4):
        changes = f"lattice.spacing={spacing}"
        force = run(folder, whole, changes)["reaction_x:right"][-1]
        ratios = [run(folder, CUT, changes, f"contact[0].stiffness={alpha}")["reaction_x:right"][-1] / force for alpha in (0.5, 1, 2, 100)]
        print(f"| {0.060 / spacing:.0f} | " + " | ".join(f"{ratio:.3f}" for ratio in ratios) + " |", flush=True)


def impact(folder):
    print("\n| share of the stable step | steps | modified energy over the first | mean speed over the first |\n|---|---|---|---|")
    for share in (0.95, 0.9, 0.5, 0.25):
        rows = run(folder, IMPACT, f"dynamics.step_share={share}")
        print(f"| {share} | {rows['step'][-1]:.0f} | {rows['modified_energy'][-1] / ENERGY:.4f} | {-rows['left_x'][-1] / 10:.3f} |", flush=True)


def inclined(folder):
    """The plate is eight times as wide as the crack, 20 mm, is long, and elastic."""
    width, half = 0.160, 0.010
    print("\n| spacings along the crack | open, under tension | mu = 0 | 0.3 | 0.6 |\n|---|---|---|---|---|")
    for spacing in (1e-3, 5e-4, 2.5e-4):
        at = [width / 2 + sign * half / 2**0.5 for sign in (-1, 1)]
        changes = [
            f"lattice.spacing={spacing}",
            f"lattice.shape[0].max=[{width}, {width}]",
            f'set[1].where="y > {width} - spacing"',
            f'set[2].where="y < spacing && abs(x - {width / 2}) < spacing"',
            f'set[3].where="abs(y - x - spacing) < 0.1*spacing && abs(x + y - {width} - 0.5*spacing) < 1.2*spacing"',
            f'set[4].where="abs(y - x) < 0.1*spacing && abs(x + y - {width} - 0.5*spacing) < 1.2*spacing"',
            f"crack[0].from=[{at[0]}, {at[0] + spacing / 2}]",
            f"crack[0].to=[{at[1]}, {at[1] + spacing / 2}]",
            "material.damage.law=none",
            "loading.steps=1",
            "solver.mode=newton",
        ]
        ratios = []
        for load, friction in ((-0.1, 0.0), (0.1, 0.0), (0.1, 0.3), (0.1, 0.6)):
            rows = run(folder, INCLINED, *changes, f"loading.table=[0, {load}]", f"contact[0].friction={friction}")
            slip = sum(rows[f"above_{c}"][-1] - rows[f"below_{c}"][-1] for c in "xy") / 2**0.5
            stress = rows["reaction_y:top"][-1] / width / 1e-3
            ratios.append(slip / (4 * 0.5 * (1 - friction) * stress * half / 3e9))
        print(f"| {2 * half / spacing:.0f} | " + " | ".join(f"{ratio:.3f}" for ratio in ratios) + " |", flush=True)


with tempfile.TemporaryDirectory() as name:
    cut_bar(pathlib.Path(name))
    impact(pathlib.Path(name))
    inclined(pathlib.Path(name))
