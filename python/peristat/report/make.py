"""Makes the page of a folder, whatever kind it is."""

import os
from pathlib import Path

from ..errors import InputError
from . import place
from .run_page import run_page


def make_page(directory: Path, output: Path | None = None) -> tuple[Path, int]:
    """Writes the page; returns its path and size [byte]. Raises InputError, OSError."""
    path = output or directory / place.NAME
    kind = _kind(directory)
    place.require_free(path)  # before the work, not only after it
    content = kind(directory).text()
    place.write(path, content)
    return path, os.stat(path).st_size


def _kind(directory: Path):
    """The function that makes the page of this folder."""
    if not directory.is_dir():
        raise InputError(f"{directory}: no such folder")
    if (directory / "results.h5").exists():
        return run_page
    raise InputError(f"{directory}: no results of a run (results.h5), of a sweep (sweep.csv) or of a trust suite (table.md)")
