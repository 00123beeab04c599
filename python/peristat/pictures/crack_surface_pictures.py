"""Pictures of the cracks inside a solid, drawn transparently in its reference configuration."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize, to_rgba

from .camera import Camera, darker, draw_directions, lit, normals, stage
from .crack_surface import crack_surface
from .panels import step_panels
from .ranges import DAMAGE_COLOURS
from .state_words import bond_words, step_words
from .step_colours import STEP_COLOURS, ranks_of_steps, step_bar
from .style import PIECE, colour_bar, heading, points

GLASS = 0.5  # strength of the shades of a transparent white body
AZIMUTH = 52.0  # degrees; most cracks run across the body


def draw_crack_surface(results, step, surface):
    """Crack surface of a step (crack_surface.CrackSurface), coloured by the steps in which it grew or, if these are
    unknown, by damage."""
    camera = Camera(results.reference, step.displacement, AZIMUTH)
    grown, colours = surface.steps > 0, _by_damage(surface)
    distinct, rank, norm = ranks_of_steps(surface.steps[grown])
    kind = "crack faces" if grown.any() else "damaged cells"
    words = [f"{kind} in the reference configuration", *_pre_crack_words([surface]), *step_words(results, step),
             *bond_words(results, step)]  # fmt: skip
    bar = "damage" if not grown.any() else "step at which it broke" if len(distinct) > 1 else None
    figure, axes, bar_place, _ = stage(*_frame(camera, surface), words, bar, 1.5)
    if not grown.any():
        colour_bar(figure, bar_place, ScalarMappable(Normalize(0.0, 1.0), DAMAGE_COLOURS), "damage")
    else:
        colours[grown] = STEP_COLOURS(norm(rank))
        if len(distinct) > 1:
            step_bar(figure, bar_place, results, distinct, norm)
    _draw(axes, camera, surface, colours)
    draw_directions(figure, camera)
    heading(figure, results, words)
    return figure


def draw_crack_surface_sequence(results, steps):
    """Crack surface, coloured by damage, in up to six steps."""
    camera = Camera(results.reference, steps[-1].displacement, AZIMUTH)
    surfaces = [crack_surface(results, step) for step in steps]
    low, high = _frame(camera, surfaces[0])
    words = ["cracks in the reference configuration", *_pre_crack_words(surfaces)]
    figure, panels = step_panels(results, steps, low, high, DAMAGE_COLOURS, words)
    for axes, surface in zip(panels, surfaces):
        _draw(axes, camera, surface, _by_damage(surface))
    return figure


def _by_damage(surface) -> np.ndarray:
    """Colours of damage; faces of pre-cracks have a colour of their own."""
    return np.where((surface.steps == 0)[:, None], to_rgba(PIECE), DAMAGE_COLOURS(surface.damage))


def _pre_crack_words(surfaces) -> list[str]:
    return ["blue: pre-crack"] * any((surface.steps == 0).any() for surface in surfaces)


def _frame(camera, surface):
    """Corners of a box around the projected body."""
    picture = camera.project(surface.body).reshape(-1, 2)
    return picture.min(axis=0), picture.max(axis=0)


def _draw(axes, camera, surface, colours) -> None:
    """Draws the body and over it the faces of its cracks, which are visible from both sides."""
    body = surface.body[normals(surface.body) @ camera.towards > 0.0]
    body = body[camera.far_to_near(body)]
    glass = lit(np.ones((len(body), 4)), body, camera)
    glass[:, :3] = 1.0 - GLASS * (1.0 - glass[:, :3])
    _add(axes, camera, body, glass, glass, 1)
    order = camera.far_to_near(surface.faces)
    faces = surface.faces[order]
    away = normals(faces) @ camera.towards < 0.0
    faces[away] = faces[away][:, ::-1]
    colours = lit(colours[order], faces, camera)
    _add(axes, camera, faces, colours, darker(colours, 0.8), 2)


def _add(axes, camera, faces, colours, edges, zorder) -> None:
    axes.add_collection(
        PolyCollection(camera.project(faces), facecolors=colours, edgecolors=edges, linewidths=points(0.4), joinstyle="round",
                       zorder=zorder), autolim=False,
    )  # fmt: skip
