"""Picture of a value per point on the deformed body."""

import numpy as np

from .field_pictures import CLIPPED_SHARE, draw_plane, exaggeration, held_values, mark_pieces
from .style import number, unit_for


def draw_values(results, step, values, meaning, units, colours=None):
    """A plane or solid body coloured by values (count) in one of the `units`.

    The colour range ends at a percentile if a few points stand out, which the label says; for stresses of both signs
    it is symmetric about zero, with the default colours.
    """
    held = held_values(values, step.floating)
    low, high = float(held.min()), float(held.max())
    end = float(np.percentile(held, CLIPPED_SHARE))
    end = end if 0.0 < end < 0.7 * high else high
    begin = float(np.percentile(held, 100.0 - CLIPPED_SHARE))
    begin = begin if 0.7 * low < begin < 0.0 else low
    unit, size = unit_for(max(abs(begin), abs(end)), units)
    words = [f"up to {number(high / size)} {unit}"] if end < high else []
    if colours is None:
        largest = max(abs(begin), abs(end))
        if begin < -0.02 * largest and end > 0.02 * largest:
            begin, end, colours = -largest, largest, "RdBu_r"
        else:
            colours = "viridis"
    if colours == "inferno":
        begin = 0.0
    if end <= begin:
        end = begin + size
    value_range, label = (begin / size, end / size), f"{meaning} [{unit}]" if unit else meaning
    if results.dimension == 3:
        from .solid_pictures import draw_solid

        return draw_solid(results, step, values / size, value_range, label, colours, words=words)
    factor = exaggeration(results.reference, step)
    figure, axes, plate = draw_plane(results, step, factor, values / size, value_range, label, colours, words)
    mark_pieces(figure, axes, step, plate)
    return figure
