"""The page of a sweep: its table, the curves and pictures of its runs, and the refinement."""

import csv
import json
from collections import Counter
from pathlib import Path

from ..errors import InputError
from ..pictures.hdf5_reader import require_plain_file
from .comparison import comparison, embedded, link, pictures, read_runs
from .markup import escaped, items, paragraph, section, table
from .page import Page

TABLE, RECORD = "sweep.csv", "sweep.json"
MOST_TABLE = 64 << 20
MOST_PICTURE = 500_000
FIRST = "status"  # the column after the varied keys


def sweep_page(directory: Path, page_folder: Path) -> Page:
    """Raises InputError if the table is none of a sweep."""
    names, rows = _table(directory / TABLE)
    if FIRST not in names:
        raise InputError(f"{directory / TABLE}: is no table of a sweep (it has no column {FIRST})")
    keys = names[: names.index(FIRST)]
    folders = _folders(directory)
    places = [_place(folders, keys, row) for row in rows]
    labels = [", ".join(f"{key}={row[key]}" for key in keys) for row in rows]
    runs, told = read_runs({label: place for label, place in zip(labels, places) if place is not None})
    together = comparison("reaction-curve", "Reactions of all runs", runs)
    counts = Counter(row[FIRST] for row in rows)
    ended = ", ".join(f"{count} {word.replace('_', ' ')}" for word, count in counts.items())
    title = f"Sweep: {runs[0].results.title}" if runs else f"Sweep {directory.resolve().name}"
    kind = "completed" if set(counts) <= {"completed"} else "other"
    head = f'<h1>{escaped(title)}</h1><p class="ending {kind}">{len(rows)} combinations: {escaped(ended)}.</p>'
    parts = [
        section("table", "Table", _rows(names, rows, places, page_folder) + items(told, "warnings")
                + paragraph("A combination leads to the page of its run, once ./peristat report has made it.")),
        section("curves", "Curves", '<div class="curve" id="reaction-curve"></div>' if together else ""),
        section("refinement", "Refinement", _refinement(directory)),
        section("pictures", "Last states", pictures(runs) if runs else ""),
    ]  # fmt: skip
    return Page(title, head, parts, [together] if together else [])


def _table(path: Path) -> tuple[list[str], list[dict]]:
    if require_plain_file(path) > MOST_TABLE:
        raise InputError(f"{path}: is larger than {MOST_TABLE} bytes")
    with open(path, newline="", encoding="utf-8", errors="replace") as file:
        reader = csv.DictReader(file, restval="")
        rows = [{name: row[name] or "" for name in reader.fieldnames or []} for row in reader]
        return list(reader.fieldnames or []), rows


def _folders(directory: Path) -> list[tuple[Path, set[str]]]:
    """The folders of combinations, with their settings."""
    found = []
    for record in sorted(directory.glob(f"*/{RECORD}")):
        try:
            settings = json.loads(record.read_text("utf-8"))["settings"]
            found.append((record.parent, set(map(str, settings))))
        except (OSError, ValueError, KeyError, TypeError):
            continue
    return found


def _place(folders, keys: list[str], row: dict) -> Path | None:
    """The results folder of a row, if there is one."""
    wanted = {f"{key}={row[key]}" for key in keys}
    return next((folder for folder, settings in folders if wanted <= settings and (folder / "results.h5").exists()), None)


def _rows(names: list[str], rows: list[dict], places: list[Path | None], page_folder: Path) -> str:
    shown = []
    for row, place in zip(rows, places):
        cells = [_short(row[name]) for name in names]
        if place is not None:
            cells[0] = link(place, page_folder, cells[0])
        shown.append(cells)
    return table(names, shown)


def _short(text: str) -> str:
    """A number with six digits, other texts as they are."""
    try:
        return f"{float(text):.6g}" if len(text) > 8 else text
    except ValueError:
        return text


def _refinement(directory: Path) -> str:
    path, picture = directory / "refinement.csv", directory / "refinement.png"
    if not path.is_file():
        return ""
    names, rows = _table(path)
    shown = table(names, [[_short(row[name]) for name in names] for row in rows])
    if picture.is_file() and picture.stat().st_size <= MOST_PICTURE:
        shown += embedded(picture.read_bytes(), "image/png", "Quantities over the spacing")
    return shown
