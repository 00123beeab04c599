"""Lit pictures of three-dimensional bodies, drawn without a graphics card or a display.

The body is a heap of cubes, one per point. Only faces without a neighbour that look at the viewer are
drawn: projected, sorted from far to near, lit by their normal.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize, to_rgba

from cells import Cells, corner_signs
from field_pictures import (
    CLIPPED_SHARE, DAMAGE_COLOURS, beyond, displacement_magnitude, exaggeration, exaggeration_words, held_values,
)  # fmt: skip
from separations import cells_of
from style import (
    DOTS_PER_INCH, ENERGY_DENSITIES, GHOST, INK, LENGTHS, PIECE,
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
        self.across = 3 - across - int(np.argmax(b))  # the axis that points most at the viewer
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
    values, value_range, label = displacement_magnitude(step)
    return draw_solid(results, step, values, value_range, label, "viridis", mark_pieces=True)


def draw_cut_solid(results, step):
    """The half of the deformed body behind its middle plane, coloured by energy density: what is inside is seen."""
    held = held_values(step.energy_density, step.floating)
    low, high, peak = min(float(held.min()), 0.0), float(held.max()), float(np.percentile(held, CLIPPED_SHARE))
    end = peak if 0.0 < peak < 0.7 * high else high
    unit, size = unit_for(end, ENERGY_DENSITIES)
    words = [f"up to {number(high / size)} {unit}"] if end < high else []
    return draw_solid(results, step, step.energy_density / size, (low / size, end / size or 1.0),
                      f"energy density [{unit}]", "inferno", is_cut=True, words=words)  # fmt: skip


def draw_damaged_solid(results, step):
    """Deformed body coloured by damage, edges of floating pieces marked."""
    return draw_solid(results, step, step.damage, (0.0, 1.0), "damage", DAMAGE_COLOURS, mark_pieces=True,
                      words=bond_words(results, step))  # fmt: skip


def draw_solid(results, step, values, value_range, label, colours, mark_pieces=False, is_cut=False, words=()):
    """Deformed body coloured by a value per point, with more words in the heading.

    Pieces are marked if wanted; of a body that is cut the half towards the viewer is left out.
    """
    factor = exaggeration(results.reference, step)
    cells, reference, displacement, floating, loose, values = cells_of(results, step, MOST_CELLS, 1.0, values)
    spacing = cells.spacing
    camera = Camera(reference, displacement)
    corners = cells.corners(reference, factor * displacement, loose)
    shown = np.ones(len(reference), dtype=bool)
    if is_cut:
        middle = 0.5 * (reference[:, camera.across].min() + reference[:, camera.across].max())
        side = np.sign(camera.towards[camera.across])
        shown = side * (reference[:, camera.across] - middle) <= 0.25 * spacing
        words = [f"cut at {AXES[camera.across]} = {length_words(middle)}", *words]
    faces, owners = _visible_faces(cells, corners, loose, camera, shown)
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
        piece_legend(figure, piece_words(step), side="right", hatch=None)
        edges, width = np.where(floating[owners, None], to_rgba(PIECE), edges), max(width, 0.8)
    axes.add_collection(
        PolyCollection(picture, facecolors=face_colours, edgecolors=edges, linewidths=width,
                       joinstyle="round", zorder=2), autolim=False,
    )  # fmt: skip
    _draw_directions(figure, camera)
    colour_bar(figure, bar_place, ScalarMappable(norm, colours), label,
               extend=beyond(values[shown], norm.vmin, norm.vmax))  # fmt: skip
    unit, size = unit_for(np.ptp(box, axis=0).max(), LENGTHS)
    extent = " × ".join(number(length / size) for length in np.ptp(box, axis=0))
    heading(figure, results, [exaggeration_words(factor), *step_words(step), *words,
                              f"{number(len(results.volume))} points", f"{extent} {unit}"])  # fmt: skip
    return figure


def length_words(length: float) -> str:
    unit, size = unit_for(abs(length), LENGTHS)
    return f"{number(length / size)} {unit}"


def _visible_faces(cells: Cells, corners, loose, camera, shown):
    """Outer faces of the shown cells that look at the viewer, far to near, and the cell each belongs to."""
    faces, owners = [], []
    for (axis, sign), order in FACES.items():
        other = cells.joined(axis, sign)
        outer = np.flatnonzero(shown & ((other < 0) | loose | loose[other] | ~shown[other]))
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
