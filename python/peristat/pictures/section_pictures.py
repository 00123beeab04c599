"""Lateral displacement of solids that deform visibly, and the points of their mid-plane."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize

from .camera import AXES, Camera
from .framing import framed
from .ranges import Shades, exaggeration
from .solid_pictures import draw_solid
from .state_words import step_words
from .style import GHOST, colour_bar, heading, points
from .units import LENGTHS, number, unit_for

VISIBLE = 0.1  # smallest displacement over the body's size for which lateral pictures are drawn
COLOURS = "coolwarm"


def moves_visibly(results, step) -> bool:
    size = np.ptp(results.reference, axis=0).max()
    return bool(np.abs(step.displacement).max() > VISIBLE * size)


def _axes_of(results, step):
    """The axis along which the body moves most, and the one of the other two that is drawn upwards."""
    camera = Camera(results.reference, step.displacement)
    along = int(np.argmax(np.ptp(step.displacement, axis=0)))
    others = [axis for axis in range(3) if axis != along]
    up = max(others, key=lambda axis: (abs(camera.up[axis]), axis))
    return along, up, next(axis for axis in others if axis != up)


def _range(values):
    largest = np.abs(values).max() or 1.0
    return -largest, largest


def draw_lateral_solid(results, step):
    """Deformed body coloured by its displacement transverse to its main direction ([CPD] Figs 14 and 15)."""
    _, up, _ = _axes_of(results, step)
    values = step.displacement[:, up]
    unit, size = unit_for(np.abs(values).max(), LENGTHS)
    shades = Shades(values / size, f"displacement in {AXES[up]} [{unit}]", *_range(values / size), COLOURS)
    return draw_solid(results, step, exaggeration(results.reference, step), shades)


def draw_middle_plane(results, step):
    """Points of the plane through the body's middle, deformed and undeformed, coloured by their lateral
    displacement."""
    along, up, across = _axes_of(results, step)
    depth = results.reference[:, across]
    middle = 0.5 * (depth.min() + depth.max())
    nearest = np.abs(depth - middle)
    plane = nearest < nearest.min() + 0.1 * results.spacing
    # With an even number of planes two are equally near; one of them is shown.
    plane &= depth >= middle - 0.1 * results.spacing
    reference = results.reference[plane][:, [along, up]]
    moved = reference + step.displacement[plane][:, [along, up]]
    values = step.displacement[plane, up]
    unit, size = unit_for(np.abs(values).max(), LENGTHS)

    place_unit, place_size = unit_for(np.ptp(np.concatenate([reference, moved]), axis=0).max(), LENGTHS)
    reference, moved, spacing = reference / place_size, moved / place_size, results.spacing / place_size
    both = np.concatenate([reference, moved])
    low, high = both.min(axis=0) - spacing, both.max(axis=0) + spacing
    where = number(float(depth[plane].mean()) / place_size)
    words = [f"points of the middle plane, {AXES[across]} = {where} {place_unit}", *step_words(results, step),
             f"{number(int(plane.sum()))} points"]  # fmt: skip
    label = f"displacement in {AXES[up]} [{unit}]"
    figure, axes, bar = framed(low, high, words, label)
    scale = axes.get_position().width * figure.get_size_inches()[0] / (high - low)[0]
    dot = min(0.55 * scale * spacing * 72.0, points(12.0)) ** 2
    axes.scatter(*reference.T, s=0.5 * dot, color=GHOST, linewidths=0, zorder=2)
    norm = Normalize(*_range(values / size))
    axes.scatter(*moved.T, s=dot, c=values / size, cmap=COLOURS, norm=norm, edgecolors="#5b656e",
                 linewidths=points(0.3), zorder=3)  # fmt: skip
    axes.set_xlabel(f"{AXES[along]} [{place_unit}]")
    axes.set_ylabel(f"{AXES[up]} [{place_unit}]")
    colour_bar(figure, bar, ScalarMappable(norm, COLOURS), label)
    heading(figure, results, words)
    return figure
