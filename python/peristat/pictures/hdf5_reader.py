"""Reads datasets of a results file that may be damaged or malicious.

HDF5 follows links without end, opens pipes, and expands files of a few bytes to gigabytes. So nothing is
read before these checks: it is a plain file, its links are those that a run makes (parts/*.h5), and an array is
no larger than its file can hold.
"""

import contextlib
import os
import re
import stat
from pathlib import Path

# Without locking, a results file can be read on a read-only or shared file system, or while a run writes it.
os.environ.setdefault("HDF5_USE_FILE_LOCKING", "FALSE")

import h5py
import numpy as np

PARTS = re.compile(r"parts/(points|\d{6,})\.h5")
MOST_EXPANSION = 50  # bytes of an array per byte of its file, which allows for compressed files
LEAST_FILE = 200_000  # smallest file size that the limit on expansion assumes [byte]
MOST_TEXT = 16 << 20  # limit on the bytes of a text


class Damaged(Exception):
    """An object that can't be read, with its name."""


def require_plain_file(path: Path) -> int:
    """Size of a regular file [byte]. Raises Damaged for any other kind: reading a pipe may never end."""
    try:
        status = os.stat(path)
    except OSError as error:
        raise Damaged(f"{path}: {error.strerror}") from error
    if not stat.S_ISREG(status.st_mode):
        raise Damaged(f"{path}: is no regular file")
    return status.st_size


class Hdf5Reader(contextlib.AbstractContextManager):
    """A results file open for reading; `path` is "points/volume" and the like, "" is the root.

    A link in a group at the file's root may lead to a file in parts/, as while a run is going; all other
    objects must be stored where they are named.
    """

    def __init__(self, folder: Path):
        self._folder = folder
        self._open = contextlib.ExitStack()
        self._files: dict[Path, h5py.File] = {}
        self._root = self._file(folder / "results.h5")

    def __exit__(self, *_):
        self._open.close()

    def __contains__(self, path: str) -> bool:
        try:
            self._object(path)
        except KeyError:
            return False
        return True

    def names(self, path: str) -> list[str]:
        """Names in a group; none if there is no such group."""
        try:
            group = self._object(path)
        except KeyError:
            return []
        return sorted(group) if isinstance(group, h5py.Group) else []

    def attribute(self, path: str, name: str, default=None):
        """An attribute of an object, or the default if it can't be read."""
        try:
            return self._object(path).attrs.get(name, default)
        except (KeyError, OSError, TypeError, ValueError):
            return default

    def shape(self, path: str) -> tuple[int, ...]:
        """Shape of an array. Raises like `numbers`."""
        return self._dataset(path).shape

    def is_array(self, path: str) -> bool:
        """Whether there is an array of this name, rather than a group."""
        return path in self and isinstance(self._object(path), h5py.Dataset)

    def column(self, path: str) -> np.ndarray:
        """An array as it is stored, of numbers or of texts. Raises like `numbers`."""
        dataset = self._dataset(path)
        if h5py.check_string_dtype(dataset.dtype) is None:
            return self.numbers(path, kind=None)
        return np.array([as_text(entry) for entry in dataset[...].ravel().tolist()], dtype=str)

    def text(self, path: str) -> str:
        value = self._dataset(path)[()]
        value = np.asarray(value).reshape(-1)[:1].tolist()
        text = as_text(value[0]) if value else ""
        if len(text) > MOST_TEXT:
            raise Damaged(f"/{path} has {len(text)} characters")
        return text

    def numbers(self, path: str, shape: tuple | None = None, kind=float) -> np.ndarray:
        """An array of numbers. Raises KeyError if there is none, Damaged if its type or size is wrong."""
        dataset = self._dataset(path)
        if dataset.dtype.kind not in "fiub":
            raise Damaged(f"/{path} holds no numbers but {dataset.dtype}")
        if shape is not None and dataset.shape != shape:
            raise Damaged(f"/{path} has the shape {dataset.shape}, but must have {shape}")
        return np.asarray(dataset[...], dtype=kind)

    def _dataset(self, path: str) -> h5py.Dataset:
        dataset = self._object(path)
        if not isinstance(dataset, h5py.Dataset):
            raise Damaged(f"/{path} is no dataset")
        if dataset.shape is None:
            raise Damaged(f"/{path} is empty")
        if dataset.is_virtual or dataset.external:
            raise Damaged(f"/{path} has its values in other files")
        bytes_told = dataset.size * dataset.dtype.itemsize
        size = os.stat(dataset.file.filename).st_size
        if bytes_told > MOST_EXPANSION * max(size, LEAST_FILE):
            raise Damaged(f"/{path} claims {bytes_told:.3g} bytes in a file of {size}")
        return dataset

    def _object(self, path: str):
        return self._follow(self._root, path, may_leave=True)

    def _follow(self, here, path: str, may_leave: bool):
        """Goes from object to object and follows only the allowed links. Raises KeyError where one is missing."""
        gone = ""
        for name in filter(None, path.split("/")):
            gone += "/" + name
            link = here.get(name, getlink=True) if isinstance(here, h5py.Group) else None
            if link is None:
                raise KeyError(gone)
            if isinstance(link, h5py.ExternalLink) and may_leave and PARTS.fullmatch(link.filename):
                part = self._folder / link.filename
                if not part.exists():
                    raise KeyError(f"{gone}, of {link.filename}")
                here = self._follow(self._file(part), link.path, may_leave=False)
            elif isinstance(link, h5py.HardLink):
                here = here[name]
            else:
                raise Damaged(f"{gone} is a link that no run makes")
        return here

    def _file(self, path: Path) -> h5py.File:
        if path not in self._files:
            require_plain_file(path)
            try:
                self._files[path] = self._open.enter_context(h5py.File(path, "r"))
            except OSError as error:
                raise Damaged(f"{path}: can't be read ({error})") from error
        return self._files[path]


def as_text(value) -> str:
    return value.decode(errors="replace") if isinstance(value, bytes) else str(value)
