"""Several runs side by side, for the pages of sweeps and suites: their curves, pictures and links."""

import base64
import io
import os
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

import numpy as np

from ..errors import InputError
from ..pictures.abscissa import find_abscissa
from ..pictures.figures import drawings
from ..pictures.reactions import has_reactions, reactions
from ..pictures.results_folder import ResultsFolder, read_results_folder
from ..pictures.units import FORCES, LENGTHS, unit_for
from .curves import curve, line
from .markup import Raw, escaped, paragraph
from .place import NAME

MOST_CURVES = 24  # in one picture
MOST_PICTURES = 24
DOTS_PER_INCH = 45
PICTURES = ("damage", "deformed")  # the first of them that a run has


@dataclass
class Run:
    """One of several runs, and what it has in common with the others."""

    label: str
    path: Path
    results: ResultsFolder


def read_runs(folders: dict[str, Path]) -> tuple[list[Run], list[str]]:
    """Runs by label, and sentences about those that can't be read."""
    runs, told = [], []
    for label, path in folders.items():
        try:
            runs.append(Run(label, path, read_results_folder(path)))
        except InputError as error:
            told.append(f"{label}: {error}")
    return runs, told


def comparison(name: str, title: str, runs: list[Run]) -> dict | None:
    """The largest reaction of each run over what it has in common with the others: the displacement, or the load."""
    drawn = [(run, max(reactions(run.results), key=lambda reaction: np.abs(reaction.values).max()))
             for run in runs[:MOST_CURVES] if has_reactions(run.results)]  # fmt: skip
    if not drawn:
        return None
    known = [find_abscissa(run.results, [reaction]) for run, reaction in drawn]
    unit, size = unit_for(max(np.abs(reaction.values).max() for _, reaction in drawn), FORCES, 1.0)
    label, by, places = "load factor", 1.0, [run.results.numbers("load_factor") for run, _ in drawn]
    if None not in known and len({abscissa.label for abscissa in known}) == 1:
        places = [abscissa.values for abscissa in known]
        length, by = unit_for(max(np.abs(values).max() for values in places), LENGTHS)
        label = f"{known[0].label} [{length}]"
    series = [line(run.label, values / by, reaction.values / size) for (run, reaction), values in zip(drawn, places)]
    if len(runs) > MOST_CURVES:
        title += f" (the first {MOST_CURVES} of {len(runs)} runs)"
    return curve(name, title, label, f"largest reaction [{unit}]", series)


def pictures(runs: list[Run]) -> str:
    """Small pictures of the last states."""
    shown = [
        f"<figure>{_picture(run)}<figcaption>{escaped(run.label)}</figcaption></figure>" for run in runs[:MOST_PICTURES]
    ]
    left = len(runs) - MOST_PICTURES
    told = paragraph(f"{left} more runs have no picture here.") if left > 0 else ""
    return f'<div class="pictures">{"".join(shown)}</div>{told}'


def _picture(run: Run) -> str:
    found = {drawing.name: drawing for drawing in drawings(run.results) if drawing.name in PICTURES}
    if not found:
        return '<p class="note">no fields</p>'
    file = io.BytesIO()
    found[next(name for name in PICTURES if name in found)].figure().savefig(file, format="png", dpi=DOTS_PER_INCH)
    return embedded(file.getvalue(), "image/png", f"Last state of {run.label}")


def embedded(content: bytes, kind: str, words: str) -> str:
    return f'<img class="thumbnail" alt="{escaped(words)}" src="data:{kind};base64,{base64.b64encode(content).decode()}">'


def link(path: Path, page_folder: Path, words: str) -> str:
    """Words that lead to the page of a run, if it has one."""
    if not (path / NAME).is_file():
        return Raw(escaped(words))
    return Raw(f'<a href="{escaped(quote(os.path.relpath(path / NAME, page_folder)))}">{escaped(words)}</a>')
