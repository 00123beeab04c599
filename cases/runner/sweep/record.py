"""Records the inputs of a combination's results in its folder as sweep.json.

As a script it writes the record, python3 record.py FOLDER [key=value]..., or checks whether results belong to a
case, python3 record.py --is-of FOLDER CHECKSUM [key=value]...
"""

import hashlib
import json
import subprocess
import sys
from pathlib import Path

from own_files import RECORD, write_own


def is_done(folder: Path, case_text: bytes, settings: list[str]) -> bool:
    """Whether the folder holds the completed results of this case text, settings and points.

    The checksum of the summary ties the record to its run: a later run in the same folder, by whatever command,
    replaces the summary.
    """
    try:
        record = json.loads((folder / "sweep.json").read_bytes())
        summary = (folder / "summary.json").read_bytes()
        return (
            (folder / "results.h5").is_file()
            and json.loads(summary)["status"] == "completed"
            and record["summary_sha256"] == _checksum(summary)
            and record["case_sha256"] == _checksum(case_text)
            and record["settings"] == settings
            and all(value == _checksum(Path(file).read_bytes()) for file, value in record["files"].items())
        )
    except (OSError, ValueError, KeyError, TypeError, AttributeError):
        return False


def can_go_on(folder: Path, case_text: bytes, settings: list[str]) -> bool:
    """Whether the folder holds a run of this case text and these settings that was interrupted, killed, or
    failed because of the machine."""
    if not (folder / "results.h5").is_file():
        return False
    try:
        status = json.loads((folder / "summary.json").read_bytes())["status"]
    except FileNotFoundError:
        status = "killed"
    except (OSError, ValueError, KeyError, TypeError):
        return False
    if status not in ("killed", "interrupted", "failed"):
        return False
    # In a process of its own, for the same reason as record_done, and because HDF5 may crash on a damaged file.
    command = [sys.executable, "-BEs", __file__, "--is-of", str(folder), _checksum(case_text), *settings]
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, process_group=0).returncode == 0


def _is_of(folder: Path, checksum: str, settings: list[str]) -> bool:
    import h5py

    with h5py.File(folder / "results.h5", "r") as file:
        pairs = zip(*(map(_text, file[f"case/settings/{name}"][()]) for name in ("key", "value")))
        given = [f"{key}={value}" for key, value in pairs if key != "output.directory"]
        return _checksum(_bytes(file["case/as_read"][()])) == checksum and given == settings


def record_done(folder: Path, settings: list[str]) -> bool:
    """Writes the record of a completed run; returns false if it can't be written.

    In a process of its own, because the memory used to read HDF5 would count as the next run's.
    """
    command = [sys.executable, "-BEs", __file__, str(folder), *settings]
    return subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, process_group=0).returncode == 0


def _write(folder: Path, settings: list[str]) -> None:
    import h5py

    with h5py.File(folder / "results.h5", "r") as file:
        as_read = _bytes(file["case/as_read"][()])
        lines = _text(file["case/files"][()]).splitlines() if "case/files" in file else []
    record = {
        "case_sha256": _checksum(as_read),
        "settings": settings,
        "files": {file: _checksum(Path(file).read_bytes()) for file in (line.split(" ", 1)[1] for line in lines)},
        "summary_sha256": _checksum((folder / "summary.json").read_bytes()),
    }
    write_own(folder / "sweep.json", (json.dumps(record, indent=2) + "\n").encode(), RECORD)


def _bytes(value) -> bytes:
    return value if isinstance(value, bytes) else str(value).encode()


def _text(value) -> str:
    return _bytes(value).decode()


def _checksum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


if __name__ == "__main__":
    if sys.argv[1] == "--is-of":
        sys.exit(0 if _is_of(Path(sys.argv[2]), sys.argv[3], sys.argv[4:]) else 1)
    _write(Path(sys.argv[1]), sys.argv[2:])
