"""Pictures of the stress of a step, if the results hold it."""

from functools import partial

from .drawing import Drawing
from .style import STRESSES
from .value_pictures import draw_values


def draw_stresses(results, step):
    """Pictures of the von Mises stress and of the largest principal stress."""
    von_mises = results.field(step.number, "von_mises")
    if von_mises is not None:
        yield Drawing("von_mises", partial(draw_values, results, step, von_mises, "von Mises stress", STRESSES, "inferno"), True)
    principal = results.field(step.number, "principal_stress", results.dimension)
    if principal is not None:
        largest, meaning = principal[:, 0], "largest principal stress"
        yield Drawing("principal_stress", partial(draw_values, results, step, largest, meaning, STRESSES), True)
