"""Pictures of the stress and of the contact pressure of a step, if the results hold them."""

from functools import partial

from .drawing import Drawing
from .field_picture import draw_field
from .named_values import PRINCIPAL


def draw_stresses(results, step):
    """Pictures of the contact pressure, the von Mises stress and the largest principal stress."""
    pressure = results.field(step.number, "contact_pressure")
    if pressure is not None and pressure.any():
        yield Drawing("contact_pressure", partial(draw_field, results, step, "contact_pressure"), True)
    if results.field(step.number, "von_mises") is not None:
        yield Drawing("von_mises", partial(draw_field, results, step, "von_mises"), True)
    if results.field(step.number, PRINCIPAL, results.dimension) is not None:
        yield Drawing(PRINCIPAL, partial(draw_field, results, step, PRINCIPAL), True)
