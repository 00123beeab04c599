"""Errors of tractions near a boundary, and of pressures in a ring: ./peristat build && /usr/bin/python3 benchmarks/loads.py"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.reference import ring  # noqa: E402
from tests.reference.results import Results  # noqa: E402
from tests.verification.loads_test import RING  # noqa: E402

STRIP = """
dimension = 2
[lattice]
spacing = {spacing}
shape = [{{ add = "box", min = [0, 0], max = [0.16, 0.08] }}]
[[set]]
name = "left"
where = "x < spacing"
[[set]]
name = "foot"
where = "x < spacing && y < spacing"
[quadrature]
volume_correction = "linear"
surface_correction = "{correction}"
[material]
youngs_modulus = 1e9
[[support]]
set = "foot"
displacement = [0, 0]
[[support]]
set = "left"
displacement = [0, "free"]
[[load]]
side = "x+"
depth = "{depth}"
traction = ["1e3*load", 0]
"""


def run(folder: Path, text: str, *settings: str) -> Results:
    case, out = folder / "case.toml", folder / "out"
    case.write_text(text)
    words = [word for setting in settings for word in ("--set", setting)]
    command = [os.environ["PERISTAT_PROGRAM"], "run", case, "--output", out, "--quiet", "--no-plots", "--overwrite"]
    subprocess.run([*command, *words], check=True)
    return Results(out)


def strains(results: Results, spacing: float) -> tuple[list[float], float]:
    """Strain between neighbouring rows on the middle line, from the loaded end inwards, and the elongation of all
    but the held row, both over those of the stress E e."""
    x, y = results.reference.T
    moved = results.steps[-1].displacement[:, 0]
    middle = numpy.abs(y - 0.04) < spacing
    columns = numpy.unique(numpy.rint(x / spacing - 0.5)).astype(int)
    mean = numpy.array([moved[middle & (numpy.rint(x / spacing - 0.5) == k)].mean() for k in columns])
    local = numpy.diff(mean)[::-1] / spacing / 1e-6
    return local[:6].tolist(), mean[-1] / ((columns[-1] - columns[0]) * spacing * 1e-6)


def tractions(folder: Path) -> None:
    print("| depth | correction | spacing | strain between rows 1 and 2 from the end, 2 and 3, … over σ/E | elongation |")
    print("|---|---|---|---|---|")
    for depth in ("row", "horizon"):
        for correction in ("none", "energy"):
            for spacing in (4e-3, 2e-3):
                results = run(folder, STRIP.format(spacing=spacing, correction=correction, depth=depth))
                local, elongation = strains(results, spacing)
                row = ", ".join(f"{value:.3f}" for value in local)
                print(f"| `{depth}` | {correction} | 0.16/{0.16 / spacing:.0f} m | {row} | {elongation:.4f} |")


def growth(results: Results, exact) -> float:
    """Mean radial displacement at the points of the inner half over the exact one."""
    radius = numpy.sqrt((results.reference**2).sum(axis=1))
    middle = numpy.abs(radius - 0.75) < 0.05
    along = (results.steps[-1].displacement * results.reference).sum(axis=1) / radius
    return along[middle].mean() / exact(radius[middle]).mean()


def rings(folder: Path) -> None:
    print("\n| pressure / E | spacing | displacement at 3/4 of the outer radius over theory | Newton iterations |")
    print("|---|---|---|---|")
    for pressure, spacings in ((1e4, (0.1, 0.05, 0.025, 0.0125)), (0.1e9, (0.1, 0.05, 0.025))):
        small = pressure < 1e5
        radii, moved = (None, None) if small else ring.solve(0.5, 1.0, pressure, 1e9)

        def exact(radius, small=small, radii=radii, moved=moved, pressure=pressure):
            return ring.lame(radius, 0.5, 1, pressure, 1e9) if small else numpy.interp(radius, radii, moved)

        for spacing in spacings:
            settings = () if small else ("loading.steps=4",)
            results = run(folder, RING.format(spacing=spacing, pressure=pressure), *settings)
            iterations = [int(row["newton_iterations"]) for row in results.table("history") if row["step"] > 0]
            theory = "Lamé" if small else "large strain"
            print(f"| {pressure / 1e9:g} | {spacing} m | {growth(results, exact):.4f} ({theory}) | {iterations} |")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        tractions(Path(folder))
        rings(Path(folder))
