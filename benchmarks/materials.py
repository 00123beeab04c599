"""Several materials compared with closed forms, and a crack in front of a tougher region:
./peristat build && /usr/bin/python3 benchmarks/materials.py"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.acceptance.regions_test import CRACKED, INCLUSION, SAME_LAW  # noqa: E402
from tests.reference.results import Results  # noqa: E402

RULES = ("harmonic", "arithmetic", "weaker")
BAR = ROOT / "cases/regions/bimaterial.toml"
BAR_END = 100.0 / 1e-4 * (0.5 / 70e9 + 0.497 / 210e9)  # m, of the joined bars; see the case's header
INCLUSION_STRAIN = 1e-3 * 3 / 7  # regions_test.py has the derivation


def run(folder: Path, case: Path, *settings: str) -> Results:
    words = [word for setting in settings for word in ("--set", setting)]
    command = [os.environ["PERISTAT_PROGRAM"], "run", case, "--output", folder / "out", "--quiet", "--no-plots",
               "--overwrite", "--threads", "1"]  # fmt: skip
    subprocess.run([*command, *words], check=True)
    return Results(folder / "out")


def inclusion_strain(results: Results) -> float:
    """Mean strain of the points inside three quarters of the inclusion's radius."""
    inside = (results.reference**2).sum(axis=1) < 9e-3**2
    x, u = results.reference[inside], results.steps[-1].displacement[inside]
    return (u * x).sum() / (x * x).sum()


def main() -> None:
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "inclusion.toml").write_text(INCLUSION)
        (folder / "cracked.toml").write_text(CRACKED)
        print("| rule | end of the bar over that of the joined bars | strain in the inclusion over the closed form |")
        print("|---|---|---|")
        for rule in RULES:
            chosen = f"interface[0].rule={rule}"
            end = run(folder, BAR, chosen).summary["probes"]["end"] / BAR_END
            strain = inclusion_strain(run(folder, folder / "inclusion.toml", chosen)) / INCLUSION_STRAIN
            print(f"| `{rule}` | {end:.4f} | {strain:.3f} |")
        for words, settings in (("thrice the critical stretch", ()), ("the same", SAME_LAW)):
            summary = run(folder, folder / "cracked.toml", *settings).summary
            print(f"crack before a region of {words}: {summary['broken_bonds']} broken bonds")


if __name__ == "__main__":
    main()
