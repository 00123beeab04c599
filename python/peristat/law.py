"""A law of bonds from a function of NumPy."""

from collections.abc import Callable
from typing import Any

import numpy
from numpy.typing import ArrayLike

from ._numbers import real_number, real_numbers
from .errors import input_error


def sampled_law(
    force: Callable[[numpy.ndarray], ArrayLike], elastic_until: float, breaks_at: float, samples: int = 200
) -> dict[str, Any]:
    """The keys of `material.damage` for a law that is given as a function: law "table".

        case.material.damage = ps.sampled_law(lambda s: 1e-4 * numpy.exp(-(s - 1e-4) / 3e-4), 1e-4, 2e-3)

    The force of a bond at the stretch s is its stiffness times force(s), where force(s) = s up to
    `elastic_until`. Between the samples it is linear; unloading follows the secant to the origin.

    Args:
        force: function of an array of stretches that returns an array of their shape, so that
            force(s) / s does not increase.
        elastic_until: largest stretch without damage.
        breaks_at: stretch at which a bond breaks, and its force drops to 0 if it is not 0 there.
        samples: number of pairs, 2 to 1000, at equal distances.

    Returns:
        dict: law, stretches, forces.

    Raises:
        InputError: force(elastic_until) is another one, or the values are no such array.
    """
    first, last = real_number("elastic_until", elastic_until), real_number("breaks_at", breaks_at)
    if not 0.0 < first < last:
        raise input_error("breaks_at", repr(last), f"must be a larger stretch than elastic_until, {first!r}, and both positive")
    if not isinstance(samples, (int, numpy.integer)) or not 2 <= samples <= 1000:
        raise input_error("samples", repr(samples)[:80], "must be a whole number from 2 to 1000")
    if not callable(force):
        raise input_error("force", repr(force)[:80], "must be a function of an array of stretches")
    stretches = numpy.linspace(first, last, samples)
    forces = real_numbers("force", force(stretches.copy()))
    if forces.shape != stretches.shape:
        raise input_error("force", str(forces.shape), f"must have the shape {stretches.shape} of the stretches")
    if not numpy.isclose(forces[0], stretches[0], rtol=1e-6, atol=0.0):
        raise input_error(
            "force", repr(float(forces[0])), f"must be {stretches[0]!r} at this stretch, where the elastic part ends"
        )
    forces[0] = stretches[0]
    return {"law": "table", "stretches": stretches.tolist(), "forces": forces.tolist()}
