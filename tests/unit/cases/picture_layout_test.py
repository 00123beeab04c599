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
from plot_test import lattice, write_cracked_folder, write_folder  # noqa: E402

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


class Layout(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="peristat_layout_")
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name) / "results"

    def judge(self, least: int) -> None:
        results = read_results_folder(self.folder)
        self.assertGreaterEqual(len(list(drawings(results))), least)
        self.assertEqual(all_faults(results), {})

    def test_a_cracked_plate_with_a_long_title(self):
        write_cracked_folder(self.folder, (24, 16), steps=8)
        with h5py.File(self.folder / "results.h5", "a") as file:
            file.attrs["title"] = "A plate with a crack, which somebody has described at length: " + "and more " * 12
        self.judge(8)

    def test_a_slender_plate(self):
        write_folder(self.folder, lattice(60, 6))
        self.judge(4)

    def test_a_bar(self):
        write_folder(self.folder, lattice(20))
        self.judge(3)

    def test_a_damaged_solid(self):
        write_folder(self.folder, lattice(12, 6, 6), damaged=True)
        self.judge(5)

    def test_letters_of_a_field_are_legible_in_a_column(self):
        write_cracked_folder(self.folder, (24, 16), steps=8)
        results = read_results_folder(self.folder)
        step = results.step(8)
        drawing = Drawing("field", lambda: draw_field(results, step, "displacement", View("y", (2e-3, 9e-3, 2e-3, 9e-3))))
        for size in PAPER.values():
            figure = drawing.figure(size)
            self.assertEqual(faults(figure), [])
            self.assertGreaterEqual(min(text.get_fontsize() for text in texts_of(figure)), LEAST_LETTERS)
            self.assertAlmostEqual(figure.get_size_inches()[0] * 25.4, {PAPER["single"]: 84, PAPER["double"]: 174}[size])


class Faults(unittest.TestCase):
    """The judge of layouts sees what is wrong."""

    def figure(self):
        with own_settings():
            figure = new_figure(6.0, 4.0)
            axes = figure.add_axes([0.2, 0.2, 0.7, 0.7])
            axes.set_ylabel("reaction [kN]")
        return figure, axes

    def test_a_sound_figure_has_none(self):
        self.assertEqual(faults(self.figure()[0]), [])

    def test_an_axis_that_is_cut_off(self):
        figure, axes = self.figure()
        axes.set_position([0.05, 0.2, 0.7, 0.7])
        self.assertTrue(any("'reaction [kN]' is cut off" in fault for fault in faults(figure)))

    def test_ticks_over_each_other(self):
        figure, axes = self.figure()
        axes.set_xticks([0.5, 0.51], ["0.500", "0.510"])
        self.assertTrue(any("'0.500' lies over '0.510'" in fault for fault in faults(figure)))

    def test_letters_that_are_too_small(self):
        figure, axes = self.figure()
        axes.set_title("a title", fontsize=5.9)
        self.assertTrue(any("letters of 5.90 points" in fault for fault in faults(figure)))


if __name__ == "__main__":
    unittest.main()
