"""A body that was made of a case."""

from typing import TYPE_CHECKING, Any

from ._package import thread_count
from .case import Case, Check, _with_mode

if TYPE_CHECKING:
    import numpy
    from numpy.typing import NDArray

    from .run import Run
    from .steps import Steps


class Body:
    """Points, bonds, material, supports and loads of a case, made and checked; it does not change.

    Arrays are views of the body's own memory, which they keep alive, and can't be written.
    """

    def __init__(self, case, read, core):
        self._case, self._read, self._core = case, read, core

    @property
    def case(self) -> Case:
        """A copy of the case that the body was made of."""
        return self._case.copy()

    @property
    def count(self) -> int:
        """Number of points."""
        return self._core.count

    @property
    def dimension(self) -> int:
        return self._core.dimension

    @property
    def bonds(self) -> int:
        """Number of bonds."""
        return self._core.bonds

    @property
    def spacing(self) -> float:
        """Spacing of the lattice, or the mean spacing of a cloud [m]."""
        return self._core.spacing

    @property
    def horizon(self) -> float:
        """[m]"""
        return self._core.horizon

    @property
    def positions(self) -> "NDArray[numpy.float64]":
        """Reference positions, points x dimension [m]."""
        return self._core.positions

    @property
    def volumes(self) -> "NDArray[numpy.float64]":
        """Volume of each point [m3]."""
        return self._core.volumes

    @property
    def sets(self) -> "dict[str, NDArray[numpy.integer]]":
        """Numbers of the points of each set, from 0, by the set's name."""
        return self._core.sets

    @property
    def columns(self) -> "dict[str, NDArray[numpy.float64]]":
        """Further numbers of each point by name."""
        return self._core.columns

    @property
    def given_numbers(self) -> "NDArray[numpy.integer] | None":
        """Number of each point in the given arrays, or its row in a file of points; or None."""
        return self._core.given_numbers

    def check(self, threads: int = 0) -> Check:
        """Counts, supports, memory and time, and warnings; see `Case.check`."""
        with self._case._located_errors():
            return Check(self._read.check(thread_count(threads)))

    def solve(self, mode: str | None = None, **options: Any) -> "Run":
        """Solves the body along its loading programme.

        Args:
            mode: "newton", "adaptive", ...; the default is the case's `solver.mode`. Another mode
                makes the body anew.
            output: results folder; default results/NAME, a new one for each run of a process.
            on_step: is called with each accepted `Step`; `step.stop()` ends the run. An exception
                ends it after the step and is raised again.
            threads: 0: OMP_NUM_THREADS, else all processors.
            quiet: prints nothing.
            log: file of everything that is told, with the iterations.
            overwrite: replaces results of another case in the folder.

        Returns:
            Run: its results. That it does not converge is its `status`, no exception.

        Raises:
            InputError: before anything is written.
            MachineError, MemoryError: the steps up to there are kept.
            KeyboardInterrupt: after the results have been closed; `resume` goes on.
        """
        from .run import run_case

        if mode is not None and mode != self._case.get("solver.mode", "newton"):
            return _with_mode(self._case, mode).solve(**options)
        return run_case(self._case, self, **options)

    def steps(self, mode: str | None = None, **options: Any) -> "Steps":
        """Solves the body step by step: `for step in body.steps(): ...`.

        The body of the loop sees each accepted `Step` before the next is searched, and may turn a
        `Dial` of its loads. Leaving the loop ends the run after that step. Options as in `solve`.
        """
        from .steps import Steps

        return Steps(lambda on_step: self.solve(mode, on_step=on_step, **options))

    def __repr__(self):
        return f"<Body {self._case.name}: {self.count} points, {self.bonds} bonds>"
