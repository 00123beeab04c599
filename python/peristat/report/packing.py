"""Numbers as the page carries them: whole numbers of few bits, differences of neighbours, byte planes, gzip.

report/src/unpacking.js is the inverse. All differences are modulo 2^16 (or 2^8), so nothing overflows.
"""

import base64
import gzip
import zlib
from dataclasses import dataclass

import numpy as np

from ..errors import InputError


@dataclass
class Ranges:
    """Lowest and highest values of frames x components; whole numbers run from one to the other."""

    low: np.ndarray
    high: np.ndarray
    bits: int

    @property
    def step(self) -> np.ndarray:
        """Distance between two neighbouring representable values; the error is at most half of it."""
        return (self.high - self.low) / (2**self.bits - 1)

    def __getitem__(self, frames) -> "Ranges":
        return Ranges(self.low[frames], self.high[frames], self.bits)

    def described(self) -> dict:
        return {"bits": self.bits, "low": self.low.tolist(), "high": self.high.tolist()}


def quantised(values: np.ndarray, bits: int) -> tuple[np.ndarray, Ranges]:
    """Whole numbers for values (frames x components x count), each frame and component over its own range.

    Raises InputError if a range is no number: only a damaged folder has such values.
    """
    ranges = Ranges(values.min(axis=2), values.max(axis=2), bits)
    with np.errstate(over="ignore"):
        if not np.isfinite(ranges.step).all():
            raise InputError(f"values from {values.min():.3g} to {values.max():.3g} are too far apart to be shown")
    step = np.where(ranges.step > 0.0, ranges.step, 1.0)[:, :, None]
    return np.rint((values - ranges.low[:, :, None]) / step).astype(np.uint16), ranges


class Pack:
    """Collects arrays; `arrays` says where each is among the bytes and how it was made."""

    def __init__(self):
        self.arrays: dict[str, dict] = {}
        self._bytes: list[bytes] = []
        self._length = 0

    def add_numbers(self, name: str, values: np.ndarray) -> None:
        """Whole numbers from 0 below 2^32, one after another: each as the difference to the one before."""
        change = np.diff(np.asarray(values, dtype=np.int64).ravel(), prepend=0).astype(np.uint32)
        self._add(name, _planes(_zigzag(change, 32), 4), {"kind": "list", "count": int(change.size), "bytes": 4})

    def add_fields(
        self, name: str, numbers: np.ndarray, places: np.ndarray, shape: tuple[int, ...], ranges: Ranges
    ) -> None:
        """Quantised values, frames x components x count.

        places  of the points in a grid of this shape; values are differences along its axes and, if that is smaller, in time
        """
        bits = 8 if ranges.bits <= 8 else 16
        filled = _filled(numbers.astype(np.uint8 if bits == 8 else np.uint16), places, shape)
        in_space = _differences(filled, range(2, filled.ndim))
        ways = {"space": in_space, "space and time": _differences(in_space, [0]), "time": _differences(filled, [0])}
        packed = {way: _planes(_zigzag(values, bits), bits // 8) for way, values in ways.items()}
        way = min(packed, key=lambda way: len(zlib.compress(packed[way], 1)))
        about = {"kind": "field", "shape": list(filled.shape), "bytes": bits // 8, "differences": way}
        self._add(name, packed[way], about | ranges.described())

    def _add(self, name: str, content: bytes, about: dict) -> None:
        self.arrays[name] = about | {"at": self._length}
        self._bytes.append(content)
        self._length += len(content)

    def text(self) -> str:
        """All bytes, compressed, as text."""
        return compressed(b"".join(self._bytes))


def compressed(content: bytes) -> str:
    """Bytes by gzip and base64; equal bytes give equal text."""
    return base64.b64encode(gzip.compress(content, 9, mtime=0)).decode()


def _filled(numbers: np.ndarray, places: np.ndarray, shape: tuple[int, ...]) -> np.ndarray:
    """Numbers on the whole grid; a place without a point repeats the one before, which costs nothing."""
    source = np.zeros(int(np.prod(shape)), dtype=np.int64)
    source[places] = np.arange(len(places))
    return numbers[:, :, np.maximum.accumulate(source)].reshape(*numbers.shape[:2], *shape)


def _differences(numbers: np.ndarray, axes) -> np.ndarray:
    for axis in axes:
        numbers = np.diff(numbers, axis=axis, prepend=np.zeros_like(np.take(numbers, [0], axis=axis)))
    return numbers


def _zigzag(change: np.ndarray, bits: int) -> np.ndarray:
    """0, -1, 1, -2, ... as 0, 1, 2, 3, ...: small differences of either sign have zeros in their high bytes."""
    sign = np.where(change >> (bits - 1), np.array(2**bits - 1, dtype=change.dtype), np.array(0, dtype=change.dtype))
    return (change << 1) ^ sign


def _planes(numbers: np.ndarray, width: int) -> bytes:
    """The lowest bytes of all numbers, then the next ones, and so on."""
    little = np.ascontiguousarray(numbers).astype(f"<u{width}").ravel().view(np.uint8).reshape(-1, width)
    return np.ascontiguousarray(little.T).tobytes()
