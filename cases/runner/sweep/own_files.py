"""Files that sweep, trust and bench write into folders that the user names. Each kind has a signature near its
beginning, by which a later run recognises its own file; nothing else is replaced or removed."""

import io
import os
import stat
from pathlib import Path

HEAD = 1 << 16  # bytes of a file that must contain its signature
PICTURE = b"made by peristat"  # in the metadata of pictures
CASE = b"# written by peristat\n"  # first line of case files
TABLE = b"status,exit_code,"  # in the header of a sweep's table
RECORD = b'"summary_sha256": '  # of a combination of a sweep


class ForeignFile(Exception):
    """A file that would be replaced and is not ours; the message says what to do."""


def require_own(path: Path, sign: bytes) -> None:
    """Raises ForeignFile unless the path is free, an empty file, or a file with the signature."""
    try:
        status = os.lstat(path)
    except FileNotFoundError:
        return
    if not stat.S_ISREG(status.st_mode):
        raise ForeignFile(f"{path} is a link, a folder or a device instead of a file: remove it or name another folder")
    with open(path, "rb") as file:
        head = file.read(HEAD)
    if head and sign not in head:
        raise ForeignFile(f"{path} is not a file of this command and would be replaced: move it or name another folder")


def write_own(path: Path, content: bytes, sign: bytes) -> None:
    """Replaces the file by a complete new one in one rename. Raises ForeignFile, OSError."""
    assert sign in content[:HEAD], f"{path.name} without its sign would be foreign to the next run"
    require_own(path, sign)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")  # another run may write one at the same time
    unfinished.unlink(missing_ok=True)  # a link in its place is not followed
    try:
        with open(os.open(unfinished, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW, 0o666), "wb") as file:
            file.write(content)
        os.replace(unfinished, path)
    except OSError:
        unfinished.unlink(missing_ok=True)
        raise


def remove_own(path: Path, sign: bytes) -> None:
    require_own(path, sign)
    path.unlink(missing_ok=True)


def picture(figure, ending: str, **options) -> bytes:
    """Writes a figure with the signature of pictures: png or svg."""
    sign = PICTURE.decode()
    metadata = {"png": {"Software": sign}, "svg": {"Creator": sign, "Date": None}}[ending]
    file = io.BytesIO()
    figure.savefig(file, format=ending, metadata=metadata, **options)
    return file.getvalue()
