"""How alike two pictures look, tolerant of what nobody sees: other resolutions, shifts by a dot, edges of letters.

Both become a grid of mean colours, GRID blocks wide. Where tiles of TILE blocks differ in structure (SSIM of the
brightness) or in mean colour, the pictures differ.
"""

import io
from pathlib import Path

import numpy as np
from PIL import Image

GRID, TILE = 96, 6
STRUCTURE, COLOUR = 0.60, 14.0  # least likeness of a tile, and largest distance of a tile's mean colours (of 255)
PROPORTIONS = 0.01  # largest relative difference of height over width
C1, C2 = (0.01 * 255) ** 2, (0.03 * 255) ** 2  # constants of SSIM


def blocks(image: Image.Image) -> Image.Image:
    """The mean colours of a picture's blocks."""
    height = max(round(GRID * image.height / image.width), 1)
    return image.convert("RGB").resize((GRID, height), Image.Resampling.BOX)


def drawn(figure) -> Image.Image:
    file = io.BytesIO()
    figure.savefig(file, format="png")
    return Image.open(file)


def _tiles(values: np.ndarray) -> np.ndarray:
    """Overlapping tiles of a grid, rows x columns x TILE x TILE [x channels]."""
    windows = np.lib.stride_tricks.sliding_window_view(values, (TILE, TILE), axis=(0, 1))
    return np.moveaxis(windows, (-2, -1), (2, 3))[:: TILE // 2, :: TILE // 2]


def structure(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """The structural similarity (Wang et al. 2004) of the tiles of two grids of brightness, from -1 to 1."""
    a, b = _tiles(one), _tiles(other)
    mean_a, mean_b = a.mean(axis=(2, 3)), b.mean(axis=(2, 3))
    both = (a * b).mean(axis=(2, 3)) - mean_a * mean_b
    return ((2 * mean_a * mean_b + C1) * (2 * both + C2)
            / ((mean_a**2 + mean_b**2 + C1) * (a.var(axis=(2, 3)) + b.var(axis=(2, 3)) + C2)))  # fmt: skip


def differences(picture: Image.Image, reference: Image.Image) -> list[str]:
    """Where a picture looks different from the blocks of a reference; nothing if they are alike."""
    found = blocks(picture)
    if abs(found.height - reference.height) > 1 + PROPORTIONS * reference.height:
        return [f"the proportions: {found.width} x {found.height} blocks, not {reference.width} x {reference.height}"]
    one, other = (np.asarray(image.resize(reference.size), dtype=float) for image in (found, reference.convert("RGB")))
    alike = structure(one @ [0.299, 0.587, 0.114], other @ [0.299, 0.587, 0.114])
    apart = np.abs(_tiles(one).mean(axis=(2, 3)) - _tiles(other).mean(axis=(2, 3))).max(axis=2)
    words = []
    for what, worst, where in (
        (f"structure {alike.min():.2f} < {STRUCTURE}", alike.min() < STRUCTURE, alike.argmin()),
        (f"colours {apart.max():.0f} > {COLOUR} apart", apart.max() > COLOUR, apart.argmax()),
    ):
        row, column = np.unravel_index(where, alike.shape)
        place = (column * (TILE // 2) + TILE / 2) / reference.width, (row * (TILE // 2) + TILE / 2) / reference.height
        words += [f"{what} at {place[0]:.0%} from the left, {place[1]:.0%} from the top"] if worst else []
    return words


def read_blocks(path: Path) -> Image.Image:
    return Image.open(path).convert("RGB")
