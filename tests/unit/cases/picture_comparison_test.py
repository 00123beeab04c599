"""Pictures of small bodies look as they did: their blocks of colours are compared with those in `looks`.

Run with /usr/bin/python3 tests/unit/cases/picture_comparison_test.py. After an intended change look at the new pictures,
then store their blocks with --write.
"""

import sys
import tempfile
import unittest
from functools import partial
from pathlib import Path

import h5py
import numpy as np
from PIL import Image, ImageFilter

sys.path.insert(0, str(Path(__file__).resolve().parent))
from likeness import blocks, differences, drawn, read_blocks  # noqa: E402
from plot_test import SPACING, lattice, write_cracked_folder, write_folder  # noqa: E402

from peristat.pictures.drawing import Drawing  # noqa: E402
from peristat.pictures.field_picture import View, draw_field  # noqa: E402
from peristat.pictures.figures import drawings  # noqa: E402
from peristat.pictures.results_folder import read_results_folder  # noqa: E402
from peristat.pictures.style import PAPER  # noqa: E402

LOOKS = Path(__file__).parent / "looks"
ZOOM = View("x", (12e-3, 28e-3, 8e-3, 22e-3), 20.0)


def torn_solid(folder: Path) -> None:
    """A block of 16 x 8 x 6 cells that is torn in its middle from below, in three steps."""
    reference = lattice(16, 8, 6)
    write_folder(folder, reference, steps=4, damaged=True)
    place = np.rint(reference / SPACING - 0.5).astype(int)
    number = {tuple(index): point for point, index in enumerate(place)}
    with h5py.File(folder / "results.h5", "a") as file:
        rows = [(2 + j // 3, number[7, j, k], number[8, j, k]) for j in range(8) for k in range(6)]
        for name, column in zip(("step", "first_point", "second_point"), np.array(rows).T):
            file[f"broken_bonds/{name}"] = column


class Looks(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        temporary = tempfile.TemporaryDirectory(prefix="peristat_looks_")
        cls.addClassCleanup(temporary.cleanup)
        plate, solid = Path(temporary.name) / "plate", Path(temporary.name) / "solid"
        write_cracked_folder(plate, (40, 30))
        torn_solid(solid)
        cls.plate, cls.solid = read_results_folder(plate), read_results_folder(solid)
        wanted = {"damage", "broken_bonds", "load_displacement", "energies", "sequence", "fields"}
        cls.figures = {drawing.name: drawing.figure for drawing in drawings(cls.plate) if drawing.name in wanted}
        cls.figures |= {f"solid_{drawing.name}": drawing.figure for drawing in drawings(cls.solid)
                        if drawing.name in ("cut", "crack_surface")}  # fmt: skip
        cls.figures["zoom_paper"] = partial(cls.zoomed().figure, PAPER["single"])

    @classmethod
    def zoomed(cls, view: View = ZOOM) -> Drawing:
        return Drawing("zoom", partial(draw_field, cls.plate, cls.plate.step(12), "displacement", view))

    def test_pictures_look_as_stored(self):
        self.assertEqual(len(self.figures), 9)
        for name, figure in self.figures.items():
            with self.subTest(name):
                self.assertEqual(differences(drawn(figure()), read_blocks(LOOKS / f"{name}.png")), [])

    def noticed(self, name: str, figure) -> None:
        self.assertNotEqual(differences(drawn(figure), read_blocks(LOOKS / f"{name}.png")), [])

    def test_other_colours_are_noticed(self):
        figure = self.figures["damage"]()
        figure.axes[0].collections[2].set_cmap("viridis")
        self.noticed("damage", figure)

    def test_a_crack_that_is_elsewhere_is_noticed(self):
        figure = self.figures["broken_bonds"]()
        lines = next(heap for heap in figure.axes[0].collections if heap.get_array() is not None)
        lines.set_segments([segment + [2.0, 0.0] for segment in lines.get_segments()])  # by 2 of 40 mm
        self.noticed("broken_bonds", figure)

    def test_an_axis_that_is_cut_off_is_noticed(self):
        for name in ("load_displacement", "damage"):
            figure = self.figures[name]()
            place = figure.axes[0].get_position()
            figure.axes[0].set_position([place.x0 - 0.05, place.y0, place.width, place.height])
            self.noticed(name, figure)

    def test_a_legend_a_label_or_a_curve_that_is_missing_is_noticed(self):
        figure = self.figures["load_displacement"]()
        figure.legends[0].remove()
        self.noticed("load_displacement", figure)
        figure = self.figures["load_displacement"]()
        figure.axes[0].set_xlabel("")
        self.noticed("load_displacement", figure)
        figure = self.figures["load_displacement"]()
        figure.axes[0].lines[0].remove()
        self.noticed("load_displacement", figure)

    def test_another_part_or_component_is_noticed(self):
        self.noticed("zoom_paper", self.zoomed(View("y", ZOOM.zoom, 20.0)).figure(PAPER["single"]))
        self.noticed("zoom_paper", self.zoomed(View("x", (10e-3, 26e-3, 8e-3, 22e-3), 20.0)).figure(PAPER["single"]))

    def test_what_nobody_sees_is_no_difference(self):
        picture, reference = drawn(self.figures["damage"]()).convert("RGB"), read_blocks(LOOKS / "damage.png")
        noise = np.random.default_rng(2).normal(0.0, 3.0, (picture.height, picture.width, 3))
        for changed in (picture.resize((int(picture.width / 1.7), int(picture.height / 1.7))),
                        picture.transform(picture.size, Image.Transform.AFFINE, (1, 0, 2, 0, 1, 2), fillcolor="white"),
                        picture.filter(ImageFilter.GaussianBlur(1.0)),
                        Image.fromarray(np.clip(np.asarray(picture) + noise, 0, 255).astype(np.uint8))):  # fmt: skip
            self.assertEqual(differences(changed, reference), [])


def write() -> None:
    """Stores how the pictures look now."""
    LOOKS.mkdir(exist_ok=True)
    Looks.setUpClass()
    for name, figure in Looks.figures.items():
        blocks(drawn(figure())).save(LOOKS / f"{name}.png", optimize=True)
    Looks.doClassCleanups()


if __name__ == "__main__":
    write() if sys.argv[1:] == ["--write"] else unittest.main()
