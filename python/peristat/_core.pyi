"""The compiled part of peristat (python/core), as the package uses it. Users see the steps of runs."""

from collections.abc import Callable
from typing import Any

import numpy
from numpy.typing import NDArray

_Reals = NDArray[numpy.float64]

class Step:
    """An accepted step. Its record stays; its fields can be read until the next step is searched."""

    @property
    def number(self) -> int:
        """Number of the step, from 0."""
    @property
    def load(self) -> float:
        """Load factor, the first load parameter."""
    @property
    def stage(self) -> float:
        """Stage of the loading programme; of a motion the time [s]."""
    @property
    def mode(self) -> str:
        """Mode that found the step."""
    @property
    def iterations(self) -> int:
        """Iterations of Newton's method."""
    @property
    def relaxation_iterations(self) -> int:
        """Iterations of dynamic relaxation."""
    @property
    def stored_energy(self) -> float:
        """[J]"""
    @property
    def dissipated_energy(self) -> float:
        """[J]"""
    @property
    def external_work(self) -> float:
        """[J]"""
    @property
    def broken_bonds(self) -> int:
        """Bonds that broke in this step."""
    @property
    def max_damage(self) -> float:
        """Largest damage of a point, from 0 to 1."""
    @property
    def max_stretch(self) -> float:
        """Largest stretch of a bond that is not broken."""
    @property
    def displacement(self) -> _Reals:
        """Displacement of the points [m], points x dimension, a copy."""
    @property
    def reactions(self) -> dict[str, _Reals]:
        """Force of the supports on each set [N], by the set's name."""
    @property
    def probes(self) -> dict[str, float | _Reals]:
        """Values of the probes by name, SI units."""
    def field(self, name: str) -> _Reals:
        """Values of a field at the points, points x components, SI units; a copy."""
    def stop(self, reason: str = "") -> None:
        """Ends the run after this step, which is kept. It can be resumed."""

class Body:
    @property
    def count(self) -> int: ...
    @property
    def dimension(self) -> int: ...
    @property
    def spacing(self) -> float: ...
    @property
    def horizon(self) -> float: ...
    @property
    def bonds(self) -> int: ...
    @property
    def positions(self) -> _Reals: ...
    @property
    def volumes(self) -> _Reals: ...
    @property
    def sets(self) -> dict[str, NDArray[numpy.int32]]: ...
    @property
    def columns(self) -> dict[str, _Reals]: ...
    @property
    def given_numbers(self) -> NDArray[numpy.int32] | None: ...
    def warnings(self) -> list[str]: ...

class Case:
    def __init__(
        self,
        file: str,
        text: str,
        settings: list[tuple[str, str]],
        functions: dict[str, Any],
        points: Any,
    ) -> None: ...
    @property
    def resolved(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def dimension(self) -> int: ...
    @property
    def directory(self) -> str: ...
    def check(self, threads: int) -> str: ...
    def check_tangent(self, deformation: str, threads: int) -> str: ...
    def calibrate(self, strengths: bool) -> str: ...
    def body(self, threads: int) -> Body: ...

class RunEnd:
    @property
    def displacement(self) -> _Reals | None: ...
    @property
    def reason(self) -> str: ...

class Unfinished:
    def __enter__(self) -> None: ...
    def __exit__(self, *_: Any) -> None: ...

def run(
    case: Case,
    body: Body | None,
    on_step: Callable[[Step], Any] | None,
    on_line: Callable[[str, bool], Any],
    is_left: Callable[[], bool] | None,
    threads: int,
    log: str,
    overwrite: bool,
) -> RunEnd: ...
def resume(
    directory: str,
    settings: list[tuple[str, str]],
    functions: dict[str, Any],
    points: Any,
    on_step: Callable[[Step], Any] | None,
    on_line: Callable[[str, bool], Any],
    is_left: Callable[[], bool] | None,
    threads: int,
    log: str,
) -> RunEnd: ...
def versions() -> dict[str, str]: ...
def schema() -> str: ...
def fields() -> list[tuple[str, str, str]]: ...
def case_text(file: str) -> str: ...
