"""Makes the page of a folder, whatever kind it is."""

import os
from pathlib import Path

from ..errors import InputError
from . import place, sweep_page, trust_page
from .run_page import run_page


# By the file that a folder of this kind has.
MAKERS = {"results.h5": run_page, sweep_page.TABLE: sweep_page.sweep_page, trust_page.TABLE: trust_page.trust_page}


def make_page(directory: Path, output: Path | None = None) -> tuple[Path, int]:
    """Writes the page; returns its path and size [byte]. Raises InputError, OSError."""
    path = output or directory / place.NAME
    make = _maker(directory)
    place.require_free(path)  # before the work, not only after it
    content = make(directory, path.parent).text()
    place.write(path, content)
    return path, os.stat(path).st_size


def _maker(directory: Path):
    """The function that makes the page of this folder."""
    if not directory.is_dir():
        raise InputError(f"{directory}: no such folder")
    for name, make in MAKERS.items():
        if (directory / name).exists():
            return make
    raise InputError(
        f"{directory}: no results of a run (results.h5), of a sweep (sweep.csv) or of a trust suite (table.md)"
    )
