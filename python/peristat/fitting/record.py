"""Recognises finished runs of a fit by fit_run.json in their folders."""

import hashlib
import json
import os
from collections.abc import Sequence
from pathlib import Path

RECORD = "fit_run.json"
FINISHED = ("completed", "not_converged")


def status_of(folder: Path) -> tuple[str, str]:
    """Status and reason of the run in a folder; empty without a summary."""
    try:
        summary = json.loads((folder / "summary.json").read_bytes())
        return str(summary["status"]), str(summary.get("reason", ""))
    except (OSError, ValueError, KeyError, TypeError):
        return "", ""


def is_finished(folder: Path, case_text: bytes, settings: Sequence[str]) -> bool:
    """Whether the folder has the results of this case text, settings and files, converged or not.

    The checksum of the summary ties the record to its run: a later run in the folder replaces the summary.
    """
    try:
        record = json.loads((folder / RECORD).read_bytes())
        return (
            (folder / "results.h5").is_file()
            and status_of(folder)[0] in FINISHED
            and record["summary_sha256"] == _checksum((folder / "summary.json").read_bytes())
            and record["case_sha256"] == _checksum(case_text)
            and record["settings"] == list(settings)
            and all(value == _checksum(Path(file).read_bytes()) for file, value in record["files"].items())
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False


def record_finished(folder: Path, case_text: bytes, settings: Sequence[str]) -> None:
    """Writes the record of a run that has ended by itself. Without it the run would be run again."""
    import h5py

    with h5py.File(folder / "results.h5", "r") as file:
        told = file["case/files"][()] if "case/files" in file else b""
    lines = (told if isinstance(told, str) else told.decode()).splitlines()
    files = [path for line in lines if os.path.isabs(path := line.split(" ", 1)[1])]
    record = {
        "summary_sha256": _checksum((folder / "summary.json").read_bytes()),
        "case_sha256": _checksum(case_text),
        "settings": list(settings),
        "files": {file: _checksum(Path(file).read_bytes()) for file in files},
    }
    unfinished = folder / f".{RECORD}.{os.getpid()}.tmp"
    unfinished.write_text(json.dumps(record, indent=2) + "\n")
    os.replace(unfinished, folder / RECORD)


def _checksum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
