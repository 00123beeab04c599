"""Every picture in every style: no text is cut off or covered by another, and all letters are legible.

Run with /usr/bin/python3 tests/unit/cases/picture_layout_test.py; it builds its own folders.
"""

import sys
import tempfile
import unittest
from itertools import combinations
from pathlib import Path
from unittest import mock

import h5py
import numpy as np
from matplotlib.text import Text

sys.path.insert(0, str(Path(__file__).resolve().parent))
import plot_test  # noqa: E402
from plot_test import SPACING, lattice, write_cracked_folder, write_folder  # noqa: E402

from peristat.pictures.drawing import Drawing  # noqa: E402
from peristat.pictures.field_picture import View, draw_field  # noqa: E402
from peristat.pictures.figures import drawings  # noqa: E402
from peristat.pictures.results_folder import read_results_folder  # noqa: E402
from peristat.pictures.style import PAPER, SCREEN, TALK, new_figure, own_settings  # noqa: E402

STYLES = {"screen": SCREEN, "talk": TALK, **PAPER}
SLACK = 1.5  # dots by which boxes around letters may lie outside or over each other
LEAST_LETTERS = 6.0  # points; smaller ones can't be read in print


def texts_of(figure) -> list[Text]:
    """The texts that are drawn, which leaves out ticks beyond the ends of an axis."""
    drawn, draw = [], Text.draw

    def noted(text, renderer, *more, **options):
        if text.get_visible() and text.get_text().strip():
            drawn.append(text)
        return draw(text, renderer, *more, **options)

    with mock.patch.object(Text, "draw", noted):
        figure.draw(figure.canvas.get_renderer())
    return list(dict.fromkeys(drawn))


def faults(figure) -> list[str]:
    """What is wrong with the texts of a figure."""
    texts = texts_of(figure)
    if not texts:
        return ["no text"]
    renderer, (width, height) = figure.canvas.get_renderer(), figure.bbox.size
    boxes = [text.get_window_extent(renderer) for text in texts]
    found = []
    for text, box in zip(texts, boxes):
        if min(box.x0, box.y0, width - box.x1, height - box.y1) < -SLACK:
            found.append(f"{text.get_text()!r} is cut off: {np.round(box.extents)} of {width:.0f} x {height:.0f}")
        if text.get_fontsize() < LEAST_LETTERS:
            found.append(f"{text.get_text()!r} has letters of {text.get_fontsize():.2f} points")
    for (one, a), (other, b) in combinations(zip(texts, boxes), 2):
        if min(a.x1, b.x1) - max(a.x0, b.x0) > SLACK and min(a.y1, b.y1) - max(a.y0, b.y0) > SLACK:
            found.append(f"{one.get_text()!r} lies over {other.get_text()!r}")
    for axes in figure.axes:
        box = axes.get_window_extent()
        if min(box.x0, box.y0, width - box.x1, height - box.y1) < -SLACK:
            found.append(f"axes are cut off: {np.round(box.extents)}")
    return found


def all_faults(results) -> dict[str, list[str]]:
    """The faults of all pictures of a folder in all styles."""
    found = {}
    for drawing in drawings(results):
        for style, size in STYLES.items():
            if wrong := faults(drawing.figure(size)):
                found[f"{drawing.name}, {style}"] = wrong
    return found
