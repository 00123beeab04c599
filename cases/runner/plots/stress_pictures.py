"""Pictures of the stress of a step, if the results hold it."""

import numpy as np

from field_pictures import CLIPPED_SHARE, draw_plane, exaggeration, held_values, mark_pieces
from style import STRESSES, number, unit_for


def draw_stresses(results, step):
    """Name and figure of the von Mises stress and of the largest principal stress."""
    von_mises = results.field(step.number, "von_mises")
    if von_mises is not None:
        yield "von_mises", _draw(results, step, von_mises, "von Mises stress", "inferno")
    principal = results.field(step.number, "principal_stress", results.dimension)
    if principal is not None:
        yield "principal_stress", _draw(results, step, principal[:, 0], "largest principal stress", None)


def _draw(results, step, values, meaning, colours):
    """The colour range ends at a percentile if a few points stand out, which the label says; for stresses of both signs
    it is symmetric about zero."""
    held = held_values(values, step.floating)
    low, high = float(held.min()), float(held.max())
    end = float(np.percentile(held, CLIPPED_SHARE))
    end = end if 0.0 < end < 0.7 * high else high
    begin = float(np.percentile(held, 100.0 - CLIPPED_SHARE))
    begin = begin if 0.7 * low < begin < 0.0 else low
    unit, size = unit_for(max(abs(begin), abs(end)), STRESSES)
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
    value_range, label = (begin / size, end / size), f"{meaning} [{unit}]"
    if results.dimension == 3:
        from solid_pictures import draw_solid

        return draw_solid(results, step, values / size, value_range, label, colours, words=words)
    factor = exaggeration(results.reference, step)
    figure, axes, plate = draw_plane(results, step, factor, values / size, value_range, label, colours, words)
    mark_pieces(figure, axes, step, plate)
    return figure
