"""Shaded pictures of three-dimensional bodies, drawn without a graphics card or a display.

The body is a set of cubes, one per point. Only faces that have no neighbour and look at the viewer are
drawn: projected, sorted from far to near, shaded by their normal.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize, PowerNorm, to_rgba

from .camera import AXES, Camera, darker, draw_directions, lit, normals, stage
from .cells import FACES, Cells, corner_signs
from .field_pictures import (
    CLIPPED_SHARE, DAMAGE_COLOURS, beyond, displacement_magnitude, exaggeration, exaggeration_words, held_values,
)  # fmt: skip
from .separations import cells_of
from .style import (
    DOTS_PER_INCH, ENERGY_DENSITIES, GHOST, LENGTHS, PIECE,
    bond_words, colour_bar, heading, number, piece_legend, piece_words, step_words, unit_for,
)  # fmt: skip

PALE = LinearSegmentedColormap.from_list("pale", ["#e3e7eb", "#f5d48a", "#ee8a3c", "#c23a5b", "#5b1f86"])
MOST_CELLS = 250_000  # more points are averaged over blocks


def draw_deformed_solid(results, step):
    """Deformed body coloured by the magnitude of the displacement."""
    values, value_range, label = displacement_magnitude(step)
    return draw_solid(results, step, values, value_range, label, "viridis", mark_pieces=True)


def draw_cut_solid(results, step):
    """The half of the deformed body behind its mid-plane, coloured by energy density, to show the inside.

    Colours follow the square root and begin pale: most of the body stores little compared with the regions at its
    supports.
    """
    held = held_values(step.energy_density, step.floating)
    low, high, peak = min(float(held.min()), 0.0), float(held.max()), float(np.percentile(held, CLIPPED_SHARE))
    end = peak if 0.0 < peak < 0.7 * high else high
    unit, size = unit_for(end, ENERGY_DENSITIES)
    words = [f"up to {number(high / size)} {unit}"] if end < high else []
    return draw_solid(results, step, step.energy_density / size, (low / size, end / size or 1.0),
                      f"energy density [{unit}]", PALE, is_cut=True, words=words)  # fmt: skip


def draw_damaged_solid(results, step):
    """Deformed body coloured by damage; edges of floating pieces are marked."""
    return draw_solid(results, step, step.damage, (0.0, 1.0), "damage", DAMAGE_COLOURS, mark_pieces=True,
                      words=bond_words(results, step))  # fmt: skip


def draw_solid(results, step, values, value_range, label, colours, mark_pieces=False, is_cut=False, words=()):
    """Deformed body coloured by a value per point, with extra words in the heading.

    Pieces are marked on request; for a cut, the half towards the viewer is left out.
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
        place = 0.0 if abs(middle) < 1e-9 * spacing else middle  # removes the round-off of a mid-plane at 0
        words = [f"cut at {AXES[camera.across]} = {length_words(place)}", *words]
    faces, owners = _visible_faces(cells, corners, loose, camera, shown)
    box = _bounding_box(reference, spacing)

    picture = camera.project(faces)
    frame = np.concatenate([picture.reshape(-1, 2), camera.project(box)])
    low, high = frame.min(axis=0), frame.max(axis=0)
    figure, axes, bar_place, scale = stage(low, high)
    _draw_box(axes, camera, box)

    norm = PowerNorm(0.5, *value_range) if is_cut else Normalize(*value_range)
    face_colours = lit(colormaps.get_cmap(colours)(norm(values[owners])), faces, camera)
    edge = spacing * scale * DOTS_PER_INCH
    edges, width = (face_colours, 0.4) if edge < 7.0 else (darker(face_colours, 0.84), min(0.07 * edge, 1.0))
    if mark_pieces and floating.any():
        piece_legend(figure, piece_words(step), side="right", hatch=None)
        edges, width = np.where(floating[owners, None], to_rgba(PIECE), edges), max(width, 0.8)
    axes.add_collection(
        PolyCollection(picture, facecolors=face_colours, edgecolors=edges, linewidths=width,
                       joinstyle="round", zorder=2), autolim=False,
    )  # fmt: skip
    draw_directions(figure, camera)
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
    """Outer faces of the shown cells that look at the viewer, far to near, and the cell of each."""
    faces, owners = [], []
    for (axis, sign), order in FACES.items():
        other = cells.joined(axis, sign)
        outer = np.flatnonzero(shown & ((other < 0) | loose | loose[other] | ~shown[other]))
        quadrilaterals = corners[outer][:, order]
        facing = normals(quadrilaterals) @ camera.towards > 0.0
        faces.append(quadrilaterals[facing])
        owners.append(outer[facing])
    faces, owners = np.concatenate(faces), np.concatenate(owners)
    order = camera.far_to_near(faces)
    return faces[order], owners[order]


def _bounding_box(reference: np.ndarray, spacing: float) -> np.ndarray:
    """Eight corners of the reference body's box, in the order of `corner_signs`."""
    low, high = reference.min(axis=0) - spacing / 2, reference.max(axis=0) + spacing / 2
    return 0.5 * (low + high) + 0.5 * corner_signs(3) * (high - low)


def _draw_box(axes, camera, box) -> None:
    """Draws the outline of the reference body's box behind everything."""
    picture = camera.project(box)
    for face in FACES.values():
        axes.plot(*picture[face + face[:1]].T, color=GHOST, linewidth=1.2, zorder=1)


