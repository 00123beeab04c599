"""Lit pictures of three-dimensional bodies, drawn without a graphics card or a display.

The body is a heap of cubes, one per point. Only faces without a neighbour that look at the viewer are
drawn: projected, sorted from far to near, lit by their normal.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize, to_rgba

from cells import Cells, at_the_rim, corner_signs, merged
from field_pictures import (
    DAMAGE_COLOURS, LOOSE_DAMAGE, displacement_magnitude, exaggeration, exaggeration_words,
)  # fmt: skip
from style import (
    DOTS_PER_INCH, GHOST, INK, LENGTHS, PIECE,
    bond_words, colour_bar, heading, new_figure, number, piece_legend, piece_words, step_words, unit_for,
)  # fmt: skip

MOST_CELLS = 250_000  # more points are averaged over blocks
# Corners of the faces of a cube, going round so that the normal points outwards.
FACES = {
    (0, -1): [0, 1, 3, 2],
    (0, 1): [4, 6, 7, 5],
    (1, -1): [0, 4, 5, 1],
    (1, 1): [2, 3, 7, 6],
    (2, -1): [0, 2, 6, 4],
    (2, 1): [1, 5, 7, 3],
}
AXES = "xyz"


class Camera:
    """Parallel projection that lays the body's longest direction across the picture."""

    def __init__(self, reference: np.ndarray, displacement: np.ndarray):
        extent = np.ptp(reference, axis=0)
        across = int(np.argmax(extent))
        others = [axis for axis in range(3) if axis != across]
        motion = np.abs(displacement).max(axis=0)
        # Up is where the body moves most, so that bending is seen; z if there is no difference.
        up = others[0] if motion[others[0]] > 1.01 * motion[others[1]] else others[1]
        a, b = np.eye(3)[across], np.eye(3)[up]
        c = np.cross(a, b)  # out of the picture
        slender = extent[across] > 3.0 * np.sort(extent)[1]
        azimuth, elevation = np.radians((24.0, 20.0) if slender else (33.0, 25.0))
        self.right = np.cos(azimuth) * a - np.sin(azimuth) * c
        self.towards = np.cos(elevation) * (np.sin(azimuth) * a + np.cos(azimuth) * c) + np.sin(elevation) * b
        self.up = np.cross(self.towards, self.right)
        self.light = _unit(self.towards + 0.6 * self.up - 0.5 * self.right)
        self.fill_light = _unit(self.towards + 1.2 * self.right)

    def project(self, places: np.ndarray) -> np.ndarray:
        """Picture coordinates (right, up) of places, whose last axis is x, y, z."""
        return places @ np.stack([self.right, self.up], axis=1)

    def depth(self, places: np.ndarray) -> np.ndarray:
        """Grows towards the viewer."""
        return places @ self.towards


def draw_deformed_solid(results, step):
    """Deformed body coloured by the magnitude of the displacement."""
    values, value_range, label = displacement_magnitude(step.displacement)
    return draw_solid(results, step, values, value_range, label, "viridis")


def draw_damaged_solid(results, step):
    """Deformed body coloured by damage, edges of floating pieces marked."""
    figure = draw_solid(results, step, step.damage, (0.0, 1.0), "damage", DAMAGE_COLOURS, mark_pieces=True)
    if step.floating.any():
        piece_legend(figure, piece_words(step), side="right", hatch=None)
    return figure


def draw_solid(results, step, values, value_range, label, colours, mark_pieces=False):
    """Deformed body coloured by a value per point; damage and pieces in the heading and the picture if wanted."""
    factor = exaggeration(results.reference, step)
    spacing, reference, displacement, damage, floating, values = merged(
        results.reference, results.spacing, MOST_CELLS,
        step.displacement, step.damage, step.floating.astype(float), values,
    )  # fmt: skip
    camera = Camera(reference, displacement)
    cells = Cells(reference, spacing)
    floating = floating > 0.5
    loose = (damage > LOOSE_DAMAGE) | at_the_rim(cells, floating)
    corners = cells.corners(reference, factor * displacement, loose)
    faces, owners = _visible_faces(cells, corners, loose, camera)
    box = _bounding_box(reference, spacing)

    picture = camera.project(faces)
    frame = np.concatenate([picture.reshape(-1, 2), camera.project(box)])
    low, high = frame.min(axis=0), frame.max(axis=0)
    figure, axes, bar_place, scale = _stage(low, high)
    _draw_box(axes, camera, box)

    norm = Normalize(*value_range)
    face_colours = _lit(colormaps.get_cmap(colours)(norm(values[owners])), faces, camera)
    edge = spacing * scale * DOTS_PER_INCH
    edges, width = (face_colours, 0.4) if edge < 7.0 else (_darker(face_colours, 0.84), min(0.07 * edge, 1.0))
    if mark_pieces and floating.any():
        edges, width = np.where(floating[owners, None], to_rgba(PIECE), edges), max(width, 0.8)
    axes.add_collection(
        PolyCollection(picture, facecolors=face_colours, edgecolors=edges, linewidths=width,
                       joinstyle="round", zorder=2), autolim=False,
    )  # fmt: skip
    _draw_directions(figure, camera)
    colour_bar(figure, bar_place, ScalarMappable(norm, colours), label)
    unit, size = unit_for(np.ptp(box, axis=0).max(), LENGTHS)
    extent = " × ".join(number(length / size) for length in np.ptp(box, axis=0))
    heading(figure, results, [exaggeration_words(factor), *step_words(step),
                              *(bond_words(results, step) if mark_pieces else []),
                              f"{number(len(results.volume))} points", f"{extent} {unit}"])  # fmt: skip
    return figure


def _visible_faces(cells: Cells, corners, loose, camera):
    """Outer faces that look at the viewer, far to near, and the cell each belongs to."""
    faces, owners = [], []
    for (axis, sign), order in FACES.items():
        other = cells.neighbours(axis, sign)
        outer = np.flatnonzero((other < 0) | loose | loose[other])
        quadrilaterals = corners[outer][:, order]
        facing = _normals(quadrilaterals) @ camera.towards > 0.0
        faces.append(quadrilaterals[facing])
        owners.append(outer[facing])
    faces, owners = np.concatenate(faces), np.concatenate(owners)
    order = np.argsort(camera.depth(faces.mean(axis=1)), kind="stable")
    return faces[order], owners[order]


def _unit(vector):
    return vector / np.linalg.norm(vector)


def _normals(faces: np.ndarray) -> np.ndarray:
    """Normals of quadrilaterals, not normalised."""
    return np.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1])


def _lit(colours: np.ndarray, faces: np.ndarray, camera) -> np.ndarray:
    """Colours under a main light from the upper left and a weak one from the right."""
    normals = _normals(faces)
    normals /= np.maximum(np.linalg.norm(normals, axis=1), 1e-300)[:, None]
    main = np.clip(normals @ camera.light, 0.0, 1.0)
    fill = np.clip(normals @ camera.fill_light, 0.0, 1.0)
    brightness = np.clip(0.50 + 0.46 * main + 0.16 * fill, 0.0, 1.05)[:, None]
    sheen = 0.10 * (main**12)[:, None]
    lit = colours.copy()
    lit[:, :3] = np.clip(lit[:, :3] * brightness + sheen, 0.0, 1.0)
    return lit


def _darker(colours: np.ndarray, factor: float) -> np.ndarray:
    darker = colours.copy()
    darker[:, :3] *= factor
    return darker


def _stage(low, high):
    """A figure in proportion to the projected body: figure, axes, colour bar's place, inches per metre."""
    left, right, bottom, top = 0.9, 1.95, 0.95, 1.5
    size = np.maximum(high - low, 1e-300)
    scale = min((16.0 - left - right) / size[0], 8.6 / size[1])
    width, height = left + scale * size[0] + right, bottom + max(scale * size[1], 2.2) + top
    total_width = max(width, 10.0)
    figure = new_figure(total_width, height)
    axes = figure.add_axes([0.0, 0.0, 1.0, 1.0], zorder=0)
    axes.axis("off")
    # The axes cover the figure, one unit per metre, so that lengths and labels may use the margins.
    free_left = left + 0.5 * (total_width - width)
    free_bottom = bottom + 0.5 * (height - bottom - top - scale * size[1])
    axes.set_xlim(low[0] - free_left / scale, low[0] + (total_width - free_left) / scale)
    axes.set_ylim(low[1] - free_bottom / scale, low[1] + (height - free_bottom) / scale)
    bar_height = min(height - bottom - top, 4.5)
    bar_bottom = bottom + 0.5 * (height - bottom - top - bar_height)
    bar = [(total_width - 1.3) / total_width, bar_bottom / height, 0.22 / total_width, bar_height / height]
    return figure, axes, bar, scale


def _bounding_box(reference: np.ndarray, spacing: float) -> np.ndarray:
    """Eight corners of the reference body's box, in the order of `corner_signs`."""
    low, high = reference.min(axis=0) - spacing / 2, reference.max(axis=0) + spacing / 2
    return 0.5 * (low + high) + 0.5 * corner_signs(3) * (high - low)


def _draw_box(axes, camera, box) -> None:
    """Outline of the reference body's box behind everything."""
    picture = camera.project(box)
    for face in FACES.values():
        axes.plot(*picture[face + face[:1]].T, color=GHOST, linewidth=1.2, zorder=1)


def _draw_directions(figure, camera) -> None:
    """A small tripod of the coordinate directions in the lower left corner."""
    width, height = figure.get_size_inches()
    side = 1.25
    tripod = figure.add_axes([0.2 / width, 0.15 / height, side / width, side / height], zorder=3)
    tripod.axis("off")
    arrows = camera.project(np.eye(3))
    middle = 0.5 * (np.minimum(arrows.min(axis=0), 0) + np.maximum(arrows.max(axis=0), 0))
    for name, arrow in zip(AXES, arrows):
        tripod.annotate("", arrow, (0, 0), arrowprops={"arrowstyle": "-|>", "color": INK, "lw": 1.3})
        tripod.text(*(1.28 * arrow), name, ha="center", va="center", fontsize=12, color=INK)
    tripod.set_xlim(middle[0] - 1.0, middle[0] + 1.0)
    tripod.set_ylim(middle[1] - 1.0, middle[1] + 1.0)
