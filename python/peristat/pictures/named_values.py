"""Fields of a step by name and component, as values to colour a body by."""

from dataclasses import dataclass

import numpy as np

from .._names import unknown
from ..errors import InputError
from .hdf5_reader import as_text
from .ranges import DAMAGE_COLOURS, Shades, held_values, shades, span
from .results_folder import ResultsFile
from .units import units_of

AXES = "xyz"
PRINCIPAL = "principal_stress"
MAGNITUDE = "magnitude"
VOIGT = {1: ("xx",), 3: ("xx", "yy", "xy"), 6: ("xx", "yy", "zz", "xy", "yz", "xz")}  # of `strain` and `stress`
MEANINGS = {"von_mises": "von Mises stress", PRINCIPAL: "principal stress", "cauchy_stress": "Cauchy stress",
            "first_piola_stress": "first Piola–Kirchhoff stress", "green_lagrange_strain": "Green–Lagrange strain"}  # fmt: skip
UNITS = {"displacement": "m", "energy_density": "J/m3"}  # of results without the attribute
COLOURS = {"energy_density": "inferno", "von_mises": "inferno", "contact_pressure": DAMAGE_COLOURS}  # of fields that begin at zero


@dataclass
class NamedValues:
    """A component of a field of one step."""

    name: str
    component: str | None
    values: np.ndarray  # count, as in results.h5
    unit: str  # as in results.h5

    @property
    def meaning(self) -> str:
        meaning = MEANINGS.get(self.name, self.name.replace("_", " "))
        if self.name == PRINCIPAL:
            return {"1": "largest principal stress"}.get(self.component, f"{self.component}. principal stress")
        if self.component is None:
            return meaning
        is_axis = self.component in tuple(AXES)
        return f"{meaning} in {self.component}" if is_axis else f"{meaning} {self.component}"

    @property
    def file_name(self) -> str:
        return self.name if self.component in (None, MAGNITUDE) else f"{self.name}_{self.component}"

    def shades(self, step, whole: tuple | None = None, shown: np.ndarray | None = None) -> Shades:
        """Their colours; of the held body's points that are shown, or for a given span."""
        if self.name == "damage":
            return Shades(self.values, "damage", 0.0, 1.0, DAMAGE_COLOURS)
        whole = whole or self.span(step, shown)
        if self.component == MAGNITUDE:
            whole = (0.0, whole[3], 0.0, whole[3])
        return shades(self.values, whole, self.meaning, units_of(self.unit), COLOURS.get(self.name))

    def span(self, step, shown: np.ndarray | None = None) -> tuple:
        """The range of the values of the points that are shown, if any of the held body is."""
        there = np.ones(len(self.values), dtype=bool) if shown is None or not shown.any() else shown
        return span(held_values(self.values[there], step.floating[there]))


def field_names(results, number: int) -> list[str]:
    """Names of the fields of a step."""
    with ResultsFile(results.path) as file:
        group = f"steps/{number:06d}"
        return [name for name in file.names(group) if file.is_array(f"{group}/{name}")]


def components(name: str, shape: tuple[int, ...], dimension: int) -> list[str]:
    """Components of a field of a shape (without the count of points), the one drawn without a choice first."""
    if shape == ():
        return []
    if name == PRINCIPAL:
        return [str(place + 1) for place in range(*shape)]
    if name in ("strain", "stress") and len(shape) == 1:
        return list(VOIGT.get(shape[0], ()))
    if shape == (dimension,):
        return [MAGNITUDE, *AXES[:dimension]]
    if shape == (dimension, dimension):
        rows = [str(row + 1) for row in range(dimension)] if name == "principal_direction" else AXES[:dimension]
        return [row + axis for row in rows for axis in AXES[:dimension]]
    return []


def named_values(results, number: int, name: str, component: str | None = None) -> NamedValues:
    """A field's component at a step. Raises InputError for names that are not there."""
    names = field_names(results, number)
    if name not in names:
        raise unknown("field", name, names, f"{results.path}, step {number}")
    with ResultsFile(results.path) as file:
        path = f"steps/{number:06d}/{name}"
        values, unit = file.numbers(path), as_text(file.attribute(path, "unit", UNITS.get(name, "")))
    if len(values) != len(results.volume):
        raise InputError(f"the field {name!r} of step {number} has {len(values)} rows for {len(results.volume)} points")
    if not np.isfinite(values).all():
        raise InputError(f"the field {name!r} of step {number} has values that are not finite")
    there = components(name, values.shape[1:], results.dimension)
    if not there:
        if values.ndim > 1:
            raise InputError(f"the field {name!r} has the shape {values.shape}: only numbers, vectors and tensors are drawn")
        if component is not None:
            raise InputError(f"the field {name!r} has one value per point: leave out the component ({component!r})")
        return NamedValues(name, None, values, unit)
    if component is None and there[0] not in (MAGNITUDE, "1") and len(there) > 1:
        raise InputError(f"the field {name!r} is a tensor: choose a component. There are {', '.join(there)}.")
    component = component or there[0]
    if component not in there:
        raise unknown("component", component, there, f"field {name!r}")
    if component == MAGNITUDE:
        return NamedValues(name, component, np.linalg.norm(values, axis=1), unit)
    return NamedValues(name, component, values.reshape(len(values), -1)[:, _column(there, component)], unit)


def _column(there: list[str], component: str) -> int:
    return [name for name in there if name != MAGNITUDE].index(component)
