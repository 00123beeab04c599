"""Pictures of a plate in motion: speeds of its points, and logarithmic energy density, as in [GPMB] fig. 12."""

import numpy as np

from .drawing import Drawing
from .plane import draw_plane
from .ranges import CLIPPED_SHARE, Shades, held_values

DECADES = 3.5  # range of the colours below the largest energy density


def draw_motion(results, step):
    """Pictures of the speed and of the energy density."""

    def plane(name, *shades):
        return Drawing(name, lambda: draw_plane(results, step, 1.0, Shades(*shades)), True)

    velocity = results.field(step.number, "velocity", results.dimension)
    if velocity is not None:
        speed = np.linalg.norm(velocity, axis=1)
        top = float(np.percentile(held_values(speed, step.floating), CLIPPED_SHARE)) or 1.0
        yield plane("speed", speed, "speed [m/s]", 0.0, top)
    energy = step.energy_density
    largest = float(np.percentile(held_values(energy, step.floating), CLIPPED_SHARE))
    if largest > 0.0:
        top = np.ceil(2.0 * np.log10(largest)) / 2.0  # rounded up to half a decade
        decades = np.log10(np.maximum(energy, 10.0 ** (top - 2 * DECADES)))
        label = "log₁₀ of the energy density in J/m³"
        yield plane("energy_decades", decades, label, top - DECADES, top, "turbo")
