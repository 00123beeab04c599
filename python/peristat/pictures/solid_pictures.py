"""Shaded pictures of three-dimensional bodies, drawn without a graphics card or a display.

The body is a set of cubes, one per point. Only faces that have no neighbour and look at the viewer are
drawn: projected, sorted from far to near, shaded by their normal.
"""

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, to_rgba

from .camera import AXES, Camera, darker, draw_directions, lit, normals, stage
from .cells import FACES, Cells, corner_signs
from .ranges import DAMAGE_COLOURS, Shades, beyond, exaggeration, exaggeration_words, held_values, shades, span
from .separations import cells_of
from .state_words import bond_words, piece_words, step_words
from .style import GHOST, PIECE, colour_bar, heading, piece_legend, points
from .units import ENERGY_DENSITIES, LENGTHS, number, unit_for

PALE = LinearSegmentedColormap.from_list("pale", ["#e3e7eb", "#f5d48a", "#ee8a3c", "#c23a5b", "#5b1f86"])
MOST_CELLS = 250_000  # more points are averaged over blocks


def draw_cut_solid(results, step):
    """The half of the deformed body behind its mid-plane, to show the inside: coloured by damage if there is any, else by
    energy density.

    Colours of the energy follow the square root and begin pale: most of the body stores little compared with the regions
    at its supports.
    """
    if step.damage.max() > 0.0:
        colours, words = Shades(step.damage, "damage", 0.0, 1.0, DAMAGE_COLOURS), bond_words(results, step)
    else:
        whole = span(held_values(step.energy_density, step.floating))
        colours, words = shades(step.energy_density, whole, "energy density", ENERGY_DENSITIES, PALE, 0.5), []
    return draw_solid(results, step, exaggeration(results.reference, step), colours, words, is_cut=True)


def draw_damaged_solid(results, step):
    """Deformed body coloured by damage; edges of floating pieces are marked."""
    colours = Shades(step.damage, "damage", 0.0, 1.0, DAMAGE_COLOURS)
    return draw_solid(results, step, exaggeration(results.reference, step), colours, bond_words(results, step))


def draw_solid(results, step, factor: float, colours: Shades, words=(), is_cut=False, window=None):
    """Deformed body coloured by a value per point, with extra words in the heading.

    is_cut  whether the half towards the viewer is left out
    window  low and high corner of a box of the reference body; only points in it are shown [m]
    """
    cells, reference, displacement, floating, loose, values = cells_of(results, step, MOST_CELLS, 1.0, colours.values)
    spacing = cells.spacing
    corners = cells.corners(reference, factor * displacement, loose)
    shown, words = np.ones(len(reference), dtype=bool), list(words)
    if window is not None:
        shown = ((reference >= window[0]) & (reference <= window[1])).all(axis=1)
        camera = Camera(reference[shown], displacement[shown])
    else:
        camera = Camera(reference, displacement)
    if is_cut:
        middle = 0.5 * (reference[:, camera.across].min() + reference[:, camera.across].max())
        side = np.sign(camera.towards[camera.across])
        shown &= side * (reference[:, camera.across] - middle) <= 0.25 * spacing
        place = 0.0 if abs(middle) < 1e-9 * spacing else middle  # removes the round-off of a mid-plane at 0
        words = [f"cut at {AXES[camera.across]} = {length_words(place)}", *words]
    faces, owners = _visible_faces(cells, corners, loose, camera, shown)
    box = _bounding_box(reference if window is None else reference[shown], spacing)
    picture = camera.project(faces)
    frame = np.concatenate([picture.reshape(-1, 2), camera.project(box)])
    unit, size = unit_for(np.ptp(box, axis=0).max(), LENGTHS)
    extent = " × ".join(number(length / size) for length in np.ptp(box, axis=0))
    words = [exaggeration_words(factor), *step_words(results, step), *colours.words, *words,
             f"{number(len(results.volume))} points", f"{extent} {unit}"]  # fmt: skip
    has_pieces = bool(floating.any())
    figure, axes, bar_place, scale = stage(frame.min(axis=0), frame.max(axis=0), words, colours.label, foot=0.3 * has_pieces)
    _draw_box(axes, camera, box)

    face_colours = lit(colormaps.get_cmap(colours.colours)(colours.norm(values[owners])), faces, camera)
    edge = spacing * scale * 72.0 / points(1.0)  # of a cell [point of the code]
    edges, width = (face_colours, 0.3) if edge < 5.0 else (darker(face_colours, 0.84), min(0.07 * edge, 0.8))
    if has_pieces:
        piece_legend(figure, piece_words(step), side="right", hatch=None)
        edges, width = np.where(floating[owners, None], to_rgba(PIECE), edges), max(width, 0.6)
    axes.add_collection(
        PolyCollection(picture, facecolors=face_colours, edgecolors=edges, linewidths=points(width),
                       joinstyle="round", zorder=2), autolim=False,
    )  # fmt: skip
    draw_directions(figure, camera)
    colour_bar(figure, bar_place, ScalarMappable(colours.norm, colours.colours), colours.label,
               extend=beyond(values[shown], colours.low, colours.high))  # fmt: skip
    heading(figure, results, words)
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
        axes.plot(*picture[face + face[:1]].T, color=GHOST, linewidth=points(1.2), zorder=1)


