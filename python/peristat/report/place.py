"""Where a page is written: nothing is replaced but an earlier page."""

import os
import stat
from pathlib import Path

from ..errors import InputError
from .page import SIGN

NAME = "report.html"
HEAD = 200  # bytes of a file within which the sign must be


def require_free(path: Path) -> None:
    """Raises InputError unless the path is free, or a page that this command has made."""
    try:
        status = os.lstat(path)
    except FileNotFoundError:
        if not path.parent.is_dir():
            raise InputError(f"{path}: there is no folder {path.parent}") from None
        return
    except NotADirectoryError:
        raise InputError(f"{path}: {path.parent} is no folder") from None
    if not stat.S_ISREG(status.st_mode):
        raise InputError(
            f"{path} is no plain file but a link, a folder or a device: remove it, or name another file by --output"
        )
    with open(path, "rb") as file:
        head = file.read(HEAD)
    if head and SIGN.encode() not in head:
        raise InputError(
            f"{path} is no page of this command and would be replaced: move it, or name another file by --output"
        )


def write(path: Path, content: str) -> None:
    """Replaces the file by a complete new one in one rename. Raises InputError, OSError."""
    require_free(path)
    unfinished = path.with_name(f".{path.name}.{os.getpid()}.tmp")
    flags = os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_NOFOLLOW
    try:
        with os.fdopen(os.open(unfinished, flags, 0o666), "wb") as file:
            file.write(content.encode("utf-8", errors="replace"))
        os.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)
