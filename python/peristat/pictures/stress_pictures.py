"""Pictures of the stress of a step, if the results hold it."""

from functools import partial

from .drawing import Drawing
from .field_picture import draw_field
from .named_values import PRINCIPAL


def draw_stresses(results, step):
    """Pictures of the von Mises stress and of the largest principal stress."""
    if results.field(step.number, "von_mises") is not None:
        yield Drawing("von_mises", partial(draw_field, results, step, "von_mises"), True)
    if results.field(step.number, PRINCIPAL, results.dimension) is not None:
        yield Drawing(PRINCIPAL, partial(draw_field, results, step, PRINCIPAL), True)
