"""Peaks, cracks and costs of four specimens beside phase fields, on two lattices: one table. Nothing is judged here; the
entries of the suite are (phase_field.py, l_panel.py), and runs are shared with them."""

import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import l_panel
import phase_field
from crack_path import broken_middles
from own_files import write_own
from run_all import Failed, Ran, Runs
from specimen import Lattice, Specimen, peak, rows

HEADING = ["| entry | spacing [mm] | points | peak [kN] | phase field [kN] | ratio | displacement at the peak [µm] "
           "| phase field [µm] | crack reaches [mm] | direction [°] | Newton iterations | relaxation iterations | seconds |",
           "|---|---|---|---|---|---|---|---|---|---|---|---|---|"]  # fmt: skip
FILES = {"phase_fields.md": HEADING[0].encode()}  # and its signature
MM = phase_field.MM


@dataclass(frozen=True)
class Known:
    """What the phase field has, and where the crack starts."""

    force: str  # column of the history
    load: float  # kN; of plates 1 mm thick
    unit: float  # kN of this load per unit of the column
    displacement: float | None  # at the peak [m]
    tip: tuple[float, float]  # m


PLATE = 1e-6  # the column is the load in N of a plate 1 m thick
HALF = 0.5 * phase_field.SIDE
KNOWN = {
    "square_tension": Known("reaction_y:head", 0.6915, PLATE, 5.58e-6, (HALF, HALF)),
    "square_shear": Known("reaction_x:head", 0.495, PLATE, 8.7e-6, (HALF, HALF)),
    "bending_phase_field": Known("reaction_y:load", 0.0352, PLATE, 38.6e-6, (0.0, phase_field.NOTCH)),
    "l_panel_strength": Known("reaction_y:load", 8.12, 1e-3, None, (0.25, 0.25)),
}
SPECIMENS = {of.name: of for of in (*phase_field.SPECIMENS, *l_panel.SPECIMENS) if of.name in KNOWN}


def crack(folder: Path, tip: tuple[float, float]) -> tuple[str, str]:
    """Where the crack ends [mm], the mean middle of the broken bonds in the last fifth of its reach, and the direction
    from its start to there [degrees]. Single bonds lie up to a horizon aside."""
    middles = [at[:2] for at in broken_middles(folder)]
    reach = max((math.dist(at, tip) for at in middles), default=0.0)
    last = [at for at in middles if math.dist(at, tip) >= 0.8 * reach]
    if not last:
        return "", ""
    x, y = (sum(values) / len(last) for values in zip(*last))
    return f"({round(x / MM, 3):g}, {round(y / MM, 3):g})", f"{math.degrees(math.atan2(y - tip[1], x - tip[0])):.0f}"


def cells(specimen: Specimen, lattice: Lattice, folder: Path) -> list[str]:
    known, history = KNOWN[specimen.name], rows(folder)
    loads = [abs(row[known.force]) * known.unit for row in history]
    highest = peak(loads)
    moved = history[max(range(len(loads)), key=loads.__getitem__)]["load_factor"]
    summary = json.loads((folder / "summary.json").read_text())
    due = "" if known.displacement is None else f"{1e6 * known.displacement:.3g}"
    return [f"{specimen.title} (`{specimen.name}`)", f"{specimen.spacing(lattice) / MM:.3g}", f"{summary['points']}", f"{highest:.4g}",
            f"{known.load:.4g}", f"{highest / known.load:.3f}", f"{1e6 * moved:.3g}", due, *crack(folder, known.tip),
            f"{summary['newton_iterations']}", f"{summary['relaxation_iterations']}", f"{summary['seconds']['total']:.0f}"]  # fmt: skip


def line(ran: Ran, specimen: Specimen, lattice: Lattice) -> str:
    found: list[list[str]] = []
    try:
        ran.value(lambda folder: found.append(cells(specimen, lattice, folder)) or 0.0)
    except Failed as failure:
        empty = [""] * (HEADING[1].count("---") - 3)
        found = [[f"{specimen.title} (`{specimen.name}`)", f"{specimen.spacing(lattice) / MM:.3g}", str(failure)[:100], *empty]]
    return "| " + " | ".join(found[0]) + " |"


def measure(runs: Runs, directory: Path, quick: bool, tell: Callable[[str], None]) -> bool:
    """Writes phase_fields.md. Returns True: nothing is judged."""
    places = {f"{name}/{lattice.name}": (specimen, lattice) for name, specimen in SPECIMENS.items()
              for lattice in map(Lattice, specimen.spacings[: 1 if quick else 2])}  # fmt: skip
    found = {}
    for ran in runs.run({name: specimen.text(lattice) for name, (specimen, lattice) in places.items()}):
        found[ran.name] = line(ran, *places[ran.name])
    if runs.interrupted:
        return True
    table = "\n".join([*HEADING, *(found[name] for name in places)]) + "\n"
    write_own(directory / "phase_fields.md", table.encode(), FILES["phase_fields.md"])
    tell("\n" + table)
    return True
