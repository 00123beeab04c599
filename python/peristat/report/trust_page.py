"""The page of a trust suite: its table, and the curves and pictures of its runs."""

import re
from pathlib import Path

from ..errors import InputError
from ..pictures.hdf5_reader import require_plain_file
from .comparison import comparison, embedded, link, pictures, read_runs
from .markup import Raw, escaped, items, paragraph, section, table
from .page import Page

TABLE, PICTURE = "table.md", "entries.svg"
HEADING = "| entry | reference | quantity |"  # the first words of the table
MOST_BYTES = 4 << 20
RED = "**red**"


def trust_page(directory: Path, page_folder: Path) -> Page:
    """Raises InputError if the table is none of a suite."""
    names, rows, remarks = _table(directory / TABLE)
    specimens: dict[str, dict[str, Path]] = {}
    for results in sorted(directory.glob("*/*/out/results.h5")):
        specimen, lattice = results.parts[-4:-2]
        specimens.setdefault(specimen, {})[f"{specimen}, {lattice}"] = results.parent
    curves, places, last, told = [], [], [], []
    for number, (specimen, folders) in enumerate(specimens.items()):
        runs, unread = read_runs(folders)
        told += unread
        last += runs[-1:]
        if together := comparison(f"curve-{number}", specimen, runs):
            curves.append(together)
            places.append(f'<div class="curve" id="curve-{number}"></div>')
    red = sum(RED in row[-1] for row in rows)
    kind = "other" if red else "completed"
    head = (f'<h1>Trust: one setting beside its references</h1><p class="ending {kind}">{len(rows)} quantities: '
            f"{len(rows) - red} agree, {red} do not.</p>")  # fmt: skip
    every = [[link(path, page_folder, label)] for folders in specimens.values() for label, path in folders.items()]
    parts = [
        section("table", "Table", table(names, [list(map(_marked, row)) for row in rows])
                + "".join(map(paragraph, remarks)) + items(told, "warnings")),
        section("entries", "Entries", _entries(directory / PICTURE)),
        section("curves", "Curves", f'<div class="grid two">{"".join(places)}</div>' if places else ""),
        section("pictures", "Last states on the finest lattices", pictures(last) if last else ""),
        section("runs", "Runs", (table(["run"], every)
                + paragraph("A run leads to its page, once ./peristat report has made it.")) if every else "", is_open=False),
    ]  # fmt: skip
    return Page("Trust", head, parts, curves)


def _table(path: Path) -> tuple[list[str], list[list[str]], list[str]]:
    """Names, rows and the remarks below a table in Markdown."""
    if require_plain_file(path) > MOST_BYTES:
        raise InputError(f"{path}: is larger than {MOST_BYTES} bytes")
    lines = path.read_text("utf-8", errors="replace").splitlines()
    if not lines or not lines[0].startswith(HEADING):
        raise InputError(f"{path}: is no table of a trust suite")
    rows = [[cell.strip() for cell in line.strip("| ").split("|")] for line in lines if line.startswith("|")]
    names = [cell.strip() for cell in lines[0].strip().strip("|").split("|")]
    wide = [row + [""] * (len(names) - len(row)) for row in rows[2:]]
    return names, wide, [line for line in lines if line and not line.startswith("|")]


def _marked(cell: str) -> Raw:
    """Bold and code of Markdown, as the suite writes them."""
    text = re.sub(r"\*\*(.+?)\*\*", r'<strong class="warnings">\1</strong>', escaped(cell))
    return Raw(re.sub(r"`(.+?)`", r"<code>\1</code>", text))


def _entries(path: Path) -> str:
    if not path.is_file() or path.stat().st_size > MOST_BYTES:
        return ""
    return embedded(path.read_bytes(), "image/svg+xml", "Ratios of all entries")
