"""The state at load 0 in every mode: ./peristat build && /usr/bin/python3 benchmarks/load_zero.py"""

import os
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
os.environ.setdefault("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
sys.path.insert(0, str(ROOT))

from tests.acceptance.load_zero_test import CANTILEVER, HANGING, TWO_BONDS  # noqa: E402
from tests.reference.program import peristat  # noqa: E402
from tests.reference.results import Results  # noqa: E402


def rows(text, *settings):
    """The history of a case."""
    with tempfile.TemporaryDirectory() as folder:
        case, output = Path(folder, "case.toml"), Path(folder, "out")
        case.write_text(text)
        words = [word for setting in settings for word in ("--set", setting)]
        ended = peristat("run", case, "--output", output, "--threads", 1, "--quiet", *words)
        assert ended.code == 0, ended.said
        return Results(output).table("history")


def main():
    print("| hanging bar: mode | steps | work in step 0 [J] | work / stored - 1 | at the end |\n|---|---|---|---|---|")
    for mode in ("newton", "adaptive", "relaxation"):
        for steps in (1, 10):
            bar = rows(HANGING.replace("WEIGHT", "9.81").replace("MODE", mode), f"loading.steps={steps}")
            off = [row["external_work"] / row["stored_energy"] - 1 for row in (bar[0], bar[-1])]
            print(f"| {mode} | {steps} | {bar[0]['external_work']:.6f} | {off[0]:.0e} | {off[1]:.0e} |")
    path = rows(TWO_BONDS.replace("FORCE", "100 + 1000*load"))
    print(f"\npath: the first bond breaks at load {path[1]['load_factor']:.12g}")
    dead = rows(CANTILEVER.replace("WEIGHT", "-2e3"), "loading.steps=10", 'solver.mode="arc_length"')
    ramped = rows(CANTILEVER.replace("WEIGHT", "-2e3*load2"), "loading.steps=20", "loading.table=[0, 0, 1]",
                  "loading.table2=[0, 1, 1]")  # fmt: skip
    off = abs(dead[-1]["tip_y"] / ramped[-1]["tip_y"] - 1)
    print(f"arc length beside a ramped weight: the tip differs by {off:.0e} of its displacement")


if __name__ == "__main__":
    main()
