"""Cells for pictures: of clouds of points, at the outlines of bodies, and at the cracks of solids.

Run with /usr/bin/python3 tests/unit/cases/cells_test.py.
"""

import sys
import types
import unittest
import warnings
from pathlib import Path
from unittest import mock

import numpy as np

PYTHON = Path(__file__).resolve().parents[3] / "python"
sys.path.insert(0, str(PYTHON))

from peristat.pictures.cells import Cells, corner_signs  # noqa: E402
from peristat.pictures.cloud_cells import CloudCells  # noqa: E402
from peristat.pictures.crack_surface import crack_surface  # noqa: E402
from peristat.pictures.crossings import inside_polygon  # noqa: E402
from peristat.pictures.images import BrokenBonds, ImageKinds  # noqa: E402
from peristat.pictures.outline import read_outline  # noqa: E402
from peristat.pictures.rim import fitted, rim_offsets  # noqa: E402
from peristat.pictures.voronoi import voronoi_cells  # noqa: E402

ROUND_OFF = 1e-12  # of lengths of some units


def lattice(*counts: int) -> np.ndarray:
    """Centres of cells of size 1 that fill a box at the origin, count x dimension."""
    grid = np.meshgrid(*[np.arange(count) for count in counts], indexing="ij")
    return np.stack(grid, axis=-1).reshape(-1, len(counts)) + 0.5


def cloud(*counts: int) -> np.ndarray:
    """A lattice whose points have been shifted by up to 0.15 in each direction."""
    points = lattice(*counts)
    return points + np.random.default_rng(4).uniform(-0.15, 0.15, points.shape)


def areas(corners: np.ndarray) -> np.ndarray:
    """Areas of anticlockwise polygons, count x corners x 2."""
    x, y = corners[:, :, 0], corners[:, :, 1]
    return 0.5 * (x * np.roll(y, -1, axis=1) - y * np.roll(x, -1, axis=1)).sum(axis=1)


class Clouds(unittest.TestCase):
    def test_cells_of_a_lattice_are_its_squares(self):
        """Cells tile the cloud, also at its rim, in its corners, and around a hole and the gap of a missing point,
        except at their own corners."""
        points = lattice(12, 9)
        points = points[(np.abs(points - [6.5, 4.5]).max(axis=1) > 1.2) & (np.abs(points - [2.5, 8.5]).max(axis=1) > 0.1)]
        cells = voronoi_cells(points, np.ones(len(points)))
        area = areas(cells.corners)
        self.assertEqual((np.abs(area - 1.0) > ROUND_OFF).sum(), 4 * 2 + 3)
        self.assertTrue(0.9 < area.min() and area.max() < 1.1)

    def test_places_belong_to_the_cell_of_the_nearest_point(self):
        points = cloud(12, 9)
        cells = voronoi_cells(points, np.ones(len(points)))
        places = np.random.default_rng(2).uniform([1.0, 1.0], [11.0, 8.0], (400, 2))
        nearest = np.linalg.norm(places[:, None] - points, axis=2).argmin(axis=1)
        for place, point in zip(places, nearest):
            corners = cells.corners[point][cells.is_side[point]]
            self.assertTrue(inside_polygon(place[None], corners)[0])

    def test_sides_know_what_is_beyond_them(self):
        points = cloud(12, 9)
        cells = voronoi_cells(points, np.ones(len(points)))
        cell, side = np.nonzero(cells.is_side & (cells.beyond >= 0))
        begin, end = cells.corners[cell, side], cells.corners[cell, (side + 1) % cells.beyond.shape[1]]
        for corner in (begin, end):  # equally far from both points
            far, as_far = (np.linalg.norm(corner - points[number], axis=1) for number in (cell, cells.beyond[cell, side]))
            np.testing.assert_allclose(far, as_far, rtol=0, atol=1e-9)
        inner = cells.is_side & (cells.before(cells.beyond) >= 0)
        cell, _ = np.nonzero(inner)
        other = cells.before(cells.beyond)[inner]
        self.assertFalse((cell == other).any())
        far, as_far = (np.linalg.norm(cells.corners[inner] - points[number], axis=1) for number in (cell, other))
        np.testing.assert_allclose(far, as_far, rtol=0, atol=1e-9)
        cell, side = np.nonzero(cells.is_side & (cells.beyond >= 0))
        pairs = set(zip(cell, cells.beyond[cell, side]))
        self.assertEqual(pairs, {(other, one) for one, other in pairs})
        self.assertGreater(len(pairs), 400)

    def test_cells_end_half_a_size_beyond_the_outermost_points(self):
        """Also the cell of a point between two such points and slightly inside, whose bisectors meet far outside."""
        points = np.array([[-0.65, 0.0], [0.0, -0.28], [0.65, 0.0], [-0.65, -0.9], [0.0, -1.1], [0.65, -0.9]])
        cells = voronoi_cells(points, np.ones(len(points)))
        self.assertAlmostEqual(cells.corners[:, :, 1].max(), 0.5, delta=ROUND_OFF)
        large = voronoi_cells(points, np.where(np.arange(6) == 0, 1.2, 1.0))
        self.assertAlmostEqual(large.corners[0, :, 1].max(), 0.6, delta=ROUND_OFF)

    def test_points_alone_get_squares_of_their_size(self):
        for points in ([[1.0, 2.0]], [[0.0, 0.0], [9.0, 0.0]], [[0.0, 0.0], [5.0, 5.0], [10.0, 10.0]],
                       [[0.0, 0.0], [9.0, 1.0], [3.0, 8.0]]):  # fmt: skip
            sizes = 1.0 + np.arange(len(points))
            cells = voronoi_cells(np.array(points), sizes)
            np.testing.assert_allclose(areas(cells.corners), sizes**2, rtol=1e-12)

    def test_points_in_one_place_do_no_harm(self):
        points = np.concatenate([lattice(4, 4), [[1.5, 1.5]]])
        cells = voronoi_cells(points, np.ones(17))
        self.assertTrue(np.isfinite(cells.corners).all())

    def cells(self, points) -> CloudCells:
        return CloudCells(voronoi_cells(points, np.ones(len(points))), points, 1.0)

    def test_cells_follow_an_affine_deformation_exactly(self):
        points = cloud(8, 7)
        cells, nobody = self.cells(points), np.zeros(56, dtype=bool)
        gradient = np.array([[0.3, -0.2], [0.4, 0.1]])
        still = cells.outlines(points, np.zeros_like(points), nobody)
        moved = cells.outlines(points, points @ gradient + [1.0, 2.0], nobody)
        np.testing.assert_allclose(moved, still + still @ gradient + [1.0, 2.0], rtol=0, atol=1e-10)

    def test_neighbours_share_corners_unless_they_are_loose(self):
        points = cloud(8, 7)
        cells, displacement = self.cells(points), 0.1 * np.sin(points)
        corners = {}
        for loose in (False, True):
            is_loose = np.zeros(56, dtype=bool)
            is_loose[24] = loose
            corners[loose] = cells.outlines(points, displacement, is_loose)
        still = cells.outlines(points, np.zeros_like(points), is_loose)
        own = [tuple(corner) for corner in corners[False][24].round(9)]
        others = {tuple(corner) for corner in np.delete(corners[False], 24, axis=0).reshape(-1, 2).round(9)}
        self.assertTrue(set(own) <= others)
        np.testing.assert_allclose(corners[True][24], still[24] + displacement[24], rtol=0, atol=ROUND_OFF)
        displacement[24] = 100.0
        others = np.delete(cells.outlines(points, displacement, is_loose), 24, axis=0)
        np.testing.assert_array_equal(others, np.delete(corners[True], 24, axis=0))

    def test_cracks_broken_bonds_and_pieces_part_cells(self):
        points, nobody = cloud(8, 7), np.zeros(56, dtype=bool)
        right = points[:, 0] > 4.0
        displacement = np.where(right[:, None], [1.0, 0.0], [0.0, 0.0])
        bonds = np.array([(one, other) for one in np.flatnonzero(~right) for other in np.flatnonzero(right)])
        none = np.zeros((0, 2), dtype=int)
        cuts = {"crack": ([np.array([[4.0, -1.0], [4.0, 8.0]])], none, nobody), "bonds": ([], bonds[:, ::-1], nobody),
                "pieces": ([], none, right.astype(int))}  # fmt: skip
        whole = self.cells(points)
        whole.part([], none, nobody)
        stretched = whole.outlines(points, displacement, nobody)
        still = whole.outlines(points, np.zeros_like(points), nobody)
        self.assertGreater(np.abs(areas(stretched) - areas(still)).max(), 0.1)
        for name, cut in cuts.items():
            with self.subTest(name):
                cells = self.cells(points)
                cells.part(*cut)
                moved = cells.outlines(points, displacement, nobody)
                np.testing.assert_allclose(moved, still + displacement[:, None], rtol=0, atol=ROUND_OFF)
                parted = sum(part.sum() for _, _, part in cells.sides())
                across = sum(((other >= 0) & (right != right[other])).sum() for _, other, _ in cells.sides())
                self.assertEqual(parted, across)
                self.assertGreater(parted, 10)


PLATE = {"add": "box", "min": [0.0, 0.0], "max": [20.0, 12.0]}
HOLE = {"subtract": "disk", "centre": [10.0, 6.0], "radius": 3.3}


def held(points: np.ndarray) -> np.ndarray:
    return points[np.linalg.norm(points - [10.0, 6.0], axis=1) > 3.3]


class Outlines(unittest.TestCase):
    def test_outline_of_a_plate_with_a_hole(self):
        outline = read_outline([PLATE, HOLE], 1.0, lattice(20, 12))
        length = np.linalg.norm(outline.pieces[:, 1] - outline.pieces[:, 0], axis=1)
        self.assertAlmostEqual(length.sum(), 2 * (20 + 12) + 2 * np.pi * 3.3, delta=0.01)  # the hole is a polygon
        self.assertLess(length.max(), 0.5 + ROUND_OFF)
        self.assertEqual(sorted(map(tuple, outline.corners)), [(0, 0), (0, 12), (20, 0), (20, 12)])
        places = np.array([[1.0, 1.0], [10.0, 6.0], [10.0, 9.0], [10.0, 9.4], [21.0, 6.0],
                           [10.0 + 3.2995 * np.cos(np.pi / 82), 6.0 + 3.2995 * np.sin(np.pi / 82)]])  # fmt: skip
        self.assertEqual(outline.holds(places).tolist(), [True, False, False, True, False, False])

    def test_corners_of_shapes_off_the_outline_are_none_of_it(self):
        step = {"subtract": "box", "min": [15.0, 3.0], "max": [22.0, 8.0]}
        corners = read_outline([PLATE, step], 1.0, lattice(20, 12)).corners
        self.assertEqual(sorted(map(tuple, corners)), [(0, 0), (0, 12), (15, 3), (15, 8), (20, 0), (20, 12)])

    def test_shapes_that_cover_others_hide_their_boundaries(self):
        added = {"add": "polygon", "vertices": [[8.0, 0.0], [12.0, 0.0], [12.0, 12.0], [8.0, 12.0]]}
        points = lattice(20, 12)
        self.assertEqual(len(read_outline([PLATE, HOLE, {**PLATE}], 1.0, points).corners), 4)
        filled = read_outline([PLATE, HOLE, added], 1.0, points)
        self.assertTrue(filled.holds(np.array([[10.0, 6.0]]))[0])
        inside = np.abs(filled.pieces.mean(axis=1) - [10.0, 6.0])
        self.assertFalse(((inside[:, 0] < 1.5) & (inside[:, 1] < 5.9)).any())

    def test_boxes_that_reach_far_are_followed_in_small_pieces(self):
        trim = {"subtract": "box", "min": [15.0, -1e9], "max": [1e9, 1e9]}
        outline = read_outline([PLATE, trim], 1.0, lattice(15, 12))
        np.testing.assert_allclose(outline.pieces.max(axis=(0, 1)), [15.0, 12.0], rtol=0, atol=ROUND_OFF)

    def test_shapes_that_make_no_sense_have_no_outline(self):
        points = lattice(4, 4)
        for tables in ([], [{}], [{"add": "disk"}], [{"add": "box", "min": 3, "max": [1, 1]}], ["box"],
                       [{"add": "sphere", "centre": [0, 0, 0], "radius": 1}], [{**HOLE, "radius": 1e30}],
                       [{"add": "polygon", "vertices": [1, 2]}], [{**HOLE, "centre": [float("nan"), 0]}],
                       [{"add": "polygon", "vertices": [[0, 0, 0]]}], [HOLE],
                       [{"add": "polygon", "vertices": [[0, 0], [float("inf"), 0], [0, 1]]}]):  # fmt: skip
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                self.assertIsNone(read_outline(tables, 1.0, points), tables)

    def offsets(self, tables, points, fixed=None):
        cells = Cells(points, 1.0)
        outline = read_outline(tables, 1.0, points)
        fixed = np.zeros(len(points), dtype=bool) if fixed is None else fixed
        return rim_offsets(cells, cells.centres(points), outline, fixed)

    def test_stairs_become_the_outline(self):
        points = held(lattice(20, 12))
        offsets = self.offsets([PLATE, HOLE], points)
        moved = np.abs(offsets - 0.5 * corner_signs(2)).max(axis=2) > 1e-9
        corners = points[:, None] + offsets
        radius = np.linalg.norm(corners[moved] - [10.0, 6.0], axis=1)
        self.assertGreater(len(radius), 40)
        np.testing.assert_allclose(radius, 3.3, rtol=0, atol=3e-3)  # the hole is a polygon with sides of a quarter
        self.assertGreater(np.linalg.norm(corners - [10.0, 6.0], axis=2).min(), 3.295)  # nothing remains inside it
        area = areas(corners[:, [0, 2, 3, 1]]).sum()
        self.assertTrue(0.0 < area - (240.0 - np.pi * 3.3**2) < 0.7)  # chords of about one

    def test_cells_of_layers_keep_their_corners(self):
        points = held(lattice(20, 12))
        layer = np.array([[-0.5, 3.5], [-0.5, 4.5]])  # outside a part of the side
        fixed = np.arange(len(points) + 2) >= len(points)
        both = np.concatenate([points, layer])
        offsets = self.offsets([PLATE, HOLE], both, fixed)
        np.testing.assert_array_equal(offsets[-2:], np.tile(0.5 * corner_signs(2), (2, 1, 1)))
        self.assertGreater((np.abs(offsets - 0.5 * corner_signs(2)) > 1e-9).any(axis=2).sum(), 40)  # at the hole
        self.assertGreater(np.abs(self.offsets([PLATE, HOLE], both)[-2:] - 0.5 * corner_signs(2)).max(), 0.4)

    def test_corners_on_a_plane_of_symmetry_stay_on_it(self):
        """The shapes continue beyond it: an empty place there is no hole."""
        points = held(lattice(20, 12))
        points = points[points[:, 1] > 6.0]
        corners = points[:, None] + self.offsets([PLATE, HOLE], points)
        self.assertAlmostEqual(corners[:, :, 1].min(), 6.0, delta=0.02)  # the hole is a polygon
        on_plane = corners[np.abs(corners[:, :, 1] - 6.0) < 0.02]
        moved = on_plane[np.abs(on_plane[:, 0] - np.rint(on_plane[:, 0])) > 1e-9][:, 0]
        np.testing.assert_allclose(np.abs(moved - 10.0), 3.3, rtol=0, atol=0.02)
        stayed = set(np.rint(on_plane[:, 0]).astype(int)) - set(np.rint(moved).astype(int))
        self.assertEqual(sorted(stayed), [0, 1, 2, 3, 4, 5, 6, 14, 15, 16, 17, 18, 19, 20])

    def test_a_corner_of_the_outline_is_one_of_cells(self):
        tip = {"subtract": "polygon", "vertices": [[6.3, 0.0], [8.2, 5.3], [10.1, 0.0]]}
        outline = read_outline([PLATE, tip], 1.0, lattice(20, 12))
        points = lattice(20, 12)
        points = points[outline.holds(points)]
        corners = points[:, None] + self.offsets([PLATE, tip], points)
        for corner in tip["vertices"]:
            self.assertGreater((np.linalg.norm(corners - corner, axis=2) < 1e-12).sum(), 0)

    def test_cells_of_a_cloud_end_at_the_outline(self):
        points = held(cloud(20, 12))
        outline = read_outline([PLATE, HOLE], 1.0, points)
        sizes = np.ones(len(points))
        cells = voronoi_cells(points, sizes)
        corners = fitted(cells, outline, sizes).corners
        self.assertTrue(0.0 < areas(corners).sum() - (240.0 - np.pi * 3.3**2) < 0.9)  # chords of about one
        self.assertGreater(abs(areas(cells.corners).sum() - areas(corners).sum()), 0.1)
        for corner in outline.corners:
            self.assertTrue((corners == corner).all(axis=2).any())
        self.assertGreater(np.linalg.norm(corners - [10.0, 6.0], axis=2).min(), 3.28)
        np.testing.assert_array_equal(np.clip(corners, [0.0, 0.0], [20.0, 12.0]), corners)
        self.assertFalse((np.linalg.norm(cells.corners - [10.0, 6.0], axis=2) > 3.28).all())


    def fitted_corners(self, points, tables=(PLATE,)):
        outline = read_outline(list(tables), 1.0, points)
        return fitted(voronoi_cells(points, np.ones(len(points))), outline, np.ones(len(points))).corners

    def test_a_corner_that_the_body_cannot_hold_lies_on_its_outline(self):
        """The corner of a cell between two others, and of the cell of a point in the corner of the body, however far
        outside."""
        points = np.array([[-0.65, 0.0], [0.0, -0.35], [0.65, 0.0], [-0.65, -0.9], [0.0, -1.1], [0.65, -0.9]])
        wide = {"add": "box", "min": [-9.0, -9.0], "max": [9.0, 0.35]}
        self.assertAlmostEqual(voronoi_cells(points, np.ones(6)).corners[1, :, 1].max(), 0.4286, delta=1e-4)
        self.assertLessEqual(self.fitted_corners(points, [wide])[:, :, 1].max(), 0.35)
        points = np.concatenate([lattice(20, 12), [[19.8, 11.9]]])
        corners = self.fitted_corners(points)
        np.testing.assert_array_equal(np.clip(corners, [0.0, 0.0], [20.0, 12.0]), corners)

    def test_a_cloud_that_ends_inside_the_body_keeps_its_end(self):
        """As at a plane of symmetry."""
        points = lattice(20, 12)
        points = points[points[:, 1] > 6.0]
        self.assertAlmostEqual(self.fitted_corners(points)[:, :, 1].min(), 6.0, delta=ROUND_OFF)


class CrackSurfaces(unittest.TestCase):
    COUNTS = (6, 4, 3)

    def results(self, broken=(), cracks=(), kinds=None):
        """A block of cells of size 1, some of whose bonds are broken: (step, first, second, image)."""
        rows = np.array(broken, dtype=int).reshape(-1, 4)
        reference = lattice(*self.COUNTS)
        bonds = BrokenBonds(rows[:, 1:3], rows[:, 3], rows[:, 0])
        return types.SimpleNamespace(
            reference=reference, edges=np.eye(3), spacing=1.0, volume=np.ones(len(reference)), cracks=list(cracks), reach=1,
            listed_reach=1, image_kinds=kinds, outline=None, in_layers=np.zeros(len(reference), dtype=bool), tells_broken_bonds=True,
            broken_bonds=lambda: bonds, drawn={}, dimension=3, elements=None,
        )  # fmt: skip

    def surface(self, results, damage=None, last=9):
        count = len(results.reference)
        step = types.SimpleNamespace(
            number=last, displacement=np.zeros((count, 3)), damage=np.zeros(count) if damage is None else damage,
            floating=np.zeros(count, dtype=bool), fragment=np.zeros(count),
        )  # fmt: skip
        return crack_surface(results, step)

    def number(self, i, j, k):
        return (i * self.COUNTS[1] + j) * self.COUNTS[2] + k

    def torn(self, i=2):
        """Broken bonds between two layers of cells, in the steps 1 to 4 from below."""
        ends = [(self.number(i, j, k), self.number(i + 1, j, k), j) for j in range(4) for k in range(3)]
        return [(j + 1, one, other, 0) if (one % 2) else (j + 1, other, one, 0) for one, other, j in ends]

    def test_faces_lie_where_bonds_broke_and_know_when(self):
        surface = self.surface(self.results(self.torn()), np.where(lattice(*self.COUNTS)[:, 0] < 3.0, 0.1, 0.5))
        self.assertEqual(surface.faces.shape, (12, 4, 3))
        np.testing.assert_array_equal(surface.faces[:, :, 0], 3.0)
        np.testing.assert_array_equal(surface.steps, np.floor(surface.faces[:, :, 1].mean(axis=1)) + 1)
        np.testing.assert_array_equal(surface.damage, 0.5)  # that of the more damaged side
        self.assertTrue(surface.has_grown)
        self.assertEqual(len(surface.body), 2 * (6 * 4 + 4 * 3 + 3 * 6))
        self.assertEqual(len(self.surface(self.results(self.torn()), last=2).faces), 6)

    def test_faces_of_a_pre_crack_have_no_step(self):
        crack = np.array([[1.0, -1.0, -1.0], [1.0, 5.0, -1.0], [1.0, 5.0, 4.0], [1.0, -1.0, 4.0]])
        surface = self.surface(self.results(self.torn(), [crack]))
        self.assertEqual(surface.steps[surface.faces[:, 0, 0] == 1.0].tolist(), [0] * 12)
        self.assertGreater(surface.steps[surface.faces[:, 0, 0] == 3.0].min(), 0)
        before = self.surface(self.results(self.torn(), [crack]), last=0)
        self.assertEqual(before.steps.tolist(), [0] * 12)
        self.assertFalse(before.has_grown)

    def test_faces_lie_on_planes_of_symmetry(self):
        kinds = ImageKinds(np.array([[-1.0, 1.0, 1.0]]), np.zeros((1, 3)))
        own = [self.number(0, 0, k) for k in range(3)]
        next_to_them = [(3, point, point + 12, 0) for point in own]
        surface = self.surface(self.results([*next_to_them, *((7, point, point, 1) for point in own)], kinds=kinds))
        order = np.argsort(surface.steps)
        np.testing.assert_array_equal(surface.faces[order, 0, 0], [1, 1, 1, 0, 0, 0])
        self.assertEqual(surface.steps[order].tolist(), [3, 3, 3, 7, 7, 7])
        self.assertTrue(surface.has_grown)  # whatever the damage

    def test_bonds_of_points_are_none_of_cells_that_stand_for_several(self):
        damage = np.where(lattice(*self.COUNTS)[:, 0] < 2.0, 0.5, 0.0)
        with mock.patch("peristat.pictures.crack_surface.MOST_CELLS", 20):
            surface = self.surface(self.results(self.torn()), damage)
        self.assertEqual(set(surface.steps), {-1})
        self.assertGreater(len(surface.faces), 0)

    def test_without_bonds_damaged_cells_show_their_outer_faces(self):
        damage = np.zeros(72)
        damage[[self.number(2, 1, 1), self.number(2, 2, 1), self.number(5, 3, 2)]] = 0.4
        surface = self.surface(self.results(), damage)
        self.assertEqual(len(surface.faces), 10 + 6)
        self.assertEqual(set(surface.steps), {-1})
        self.assertTrue(surface.has_grown)
        self.assertFalse(self.surface(self.results(), 0.8 * damage).has_grown)
        self.assertEqual(len(self.surface(self.results(self.torn(0)), damage).faces), 12)  # known bonds alone decide


if __name__ == "__main__":
    unittest.main()
