"""Picture of one field of one step: a chosen component, part of the body and deformation."""

import re
from dataclasses import dataclass, replace

import numpy as np

from ..errors import InputError
from .bar_picture import draw_bar
from .fracture_pictures import OPENING
from .named_values import MAGNITUDE, NamedValues, named_values
from .plane import draw_plane
from .ranges import exaggeration, wider
from .solid_pictures import draw_solid
from .state_words import bond_words


@dataclass(frozen=True)
class View:
    """What of a field is shown.

    component  "x", "xy", …; None: the field's first
    zoom       ends of what is shown, xmin, xmax, ymin, ymax [m]: for a plate of the drawn configuration, for a solid a
               box of the reference body; None: everything
    deform     factor of the displacements; 0: reference configuration; None: chosen from their size
    """

    component: str | None = None
    zoom: tuple[float, ...] | None = None
    deform: float | None = None

    def name_parts(self) -> list[str]:
        """What the name of a file tells besides field and step."""
        deform = "" if self.deform is None else "undeformed" if self.deform == 0.0 else f"times_{self.deform:g}"
        return [re.sub(r"[^A-Za-z0-9]+", "_", part) for part in ("zoom" * (self.zoom is not None), deform) if part]

    def window(self, results) -> np.ndarray | None:
        """Low and high corner of the zoom. Raises InputError if it makes no sense for the body."""
        if self.zoom is None:
            return None
        ends = np.asarray(self.zoom, dtype=float)
        needed = 2 * results.dimension
        if ends.shape != (needed,):
            names = ",".join(f"{axis}min,{axis}max" for axis in "xyz"[: results.dimension])
            raise InputError(f"zoom: a body in {results.dimension}D needs {needed} numbers, {names} [m], not {ends.size}")
        low, high = ends.reshape(-1, 2).T
        if not (np.isfinite(ends).all() and (low < high).all()):
            raise InputError(f"zoom: each lower end must be below its upper end, both finite, not {self.zoom}")
        return np.stack([low, high])


def factor_of(results, step, values: NamedValues, view: View) -> float:
    """The factor of the displacements."""
    if view.deform is not None:
        return view.deform
    return exaggeration(results.reference, step, OPENING if values.name == "damage" else 0.125)


def _shown(results, step, factor: float, window) -> np.ndarray | None:
    """Whether each point is in the window."""
    if window is None:
        return None
    places = results.reference + (factor * step.displacement if results.dimension == 2 else 0.0)
    shown = ((places >= window[0]) & (places <= window[1])).all(axis=1)
    if not shown.any():
        low, high = places.min(axis=0), places.max(axis=0)
        body = ",".join(f"{a:.4g},{b:.4g}" for a, b in zip(low, high))
        raise InputError(f"zoom: no point of step {step.number} is there; the body as drawn has {body} m")
    return shown


def draw_field(results, step, name: str, view: View = View(), whole: tuple | None = None):
    """The body coloured by a field. Raises InputError if the step has no such field or component.

    whole  the range of the values of several steps (`in_common`)
    """
    return _draw(results, step, named_values(results, step.number, name, view.component), view, whole)


def _draw(results, step, values: NamedValues, view: View, whole: tuple | None = None):
    window, factor = view.window(results), factor_of(results, step, values, view)
    shades = values.shades(step, whole, _shown(results, step, factor, window))
    if results.dimension == 1:
        return draw_bar(results, step, factor, shades, None if window is None else window[:, 0])
    words = bond_words(results, step) if values.name == "damage" else ()
    draw = draw_plane if results.dimension == 2 else draw_solid
    return draw(results, step, factor, shades, words, window=window)


def draw_displacement(results, step):
    """The deformed body coloured by the magnitude of its displacement; a bar by the displacement itself."""
    component = "x" if results.dimension == 1 else MAGNITUDE
    values = step.displacement[:, 0] if results.dimension == 1 else np.linalg.norm(step.displacement, axis=1)
    found = NamedValues("displacement", component, values, "m")
    return _draw(results, step, found, View())


def in_common(results, numbers: list[int], name: str, view: View) -> tuple[View, tuple]:
    """The view and the range of values that several steps share, so that their pictures can be compared."""
    factors, whole = [], None
    for number in numbers:
        step, values = results.step(number), named_values(results, number, name, view.component)
        if step.displacement.any():
            factors.append(factor_of(results, step, values, view))
    view = replace(view, deform=min(factors, default=1.0) if view.deform is None else view.deform)
    for number in numbers:
        step, values = results.step(number), named_values(results, number, name, view.component)
        whole = wider(values.span(step, _shown(results, step, view.deform, view.window(results))), whole)
    return view, whole
