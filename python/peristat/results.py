"""Results of a run, read from its results folder (docs/results.md): `open_results("results/plate")`.

All numbers are in SI units. Nothing is read before it is asked for.
"""

import fcntl
import html
import json
import operator
import os
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ._names import unknown
from .errors import InputError
from .pictures.hdf5_reader import as_text
from .pictures.results_folder import ResultsFile, ResultsFolder, point_sets, read_results_folder
from .pictures.steps_by_name import ranges, steps_named

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARKER = "peristat.json"  # locked by the run that writes the folder
WITH_STRESS = ("deformation_gradient", "green_lagrange_strain", "first_piola_stress", "cauchy_stress", "strain", "stress",
               "von_mises", "principal_stress", "principal_direction", "missing_neighbourhood")  # fmt: skip


def open_results(folder: str | os.PathLike) -> "Results":
    """The results in a folder, of any run: finished, going, killed, of any mode and dimension.

    Raises InputError if there is no such folder, or if it holds no results or damaged ones.
    """
    return Results(folder)


class Columns(Mapping):
    """Columns of numbers or texts by name, each read when it is asked for: `table["step"]`, an array of rows."""

    def __init__(self, results: "Results", group: str, kind: str):
        self._results, self._group, self._kind = results, group, kind
        with results._file() as file:
            names = [name for name in file.names(group) if file.is_array(f"{group}/{name}")]
            self.units: dict[str, str] = {
                name: as_text(file.attribute(f"{group}/{name}", "unit", "")) for name in names
            }  # unit of each column: "m", "N", ...; "1" for a dimensionless number, "none" for text
        self._columns: dict[str, np.ndarray] = {}

    def __getitem__(self, name: str) -> np.ndarray:
        self._require(name)
        if name not in self._columns:
            with self._results._file() as file:
                self._columns[name] = _constant(file.column(f"{self._group}/{name}"))
        return self._columns[name]

    def unit(self, name: str) -> str:
        """Unit of a column."""
        self._require(name)
        return self.units[name]

    def __contains__(self, name: object) -> bool:
        return name in self.units

    def get(self, name: str, default=None):
        return self[name] if name in self else default

    def __iter__(self) -> Iterator[str]:
        return iter(self.units)

    def __len__(self) -> int:
        return len(self.units)

    def __repr__(self) -> str:
        return f"<{self._group}: {', '.join(self.units) or 'nothing yet'}>"

    def _require(self, name: str) -> None:
        if name not in self:
            raise unknown(self._kind, name, self.units, self._results.path)


class ByName(dict):
    """A dict that refuses a name which it has not with the nearest one and the list."""

    def __init__(self, kind: str, where: Path, found: Mapping):
        super().__init__(found)
        self._kind, self._where = kind, where

    def __missing__(self, name: object):
        raise unknown(self._kind, name, self, self._where)

    def __reduce__(self):
        return ByName, (self._kind, self._where, dict(self))


class Results:
    """A results folder. What has been read stays as it was then, until `reload()`.

    Steps are named by their numbers, which need not be consecutive (`output.every`); a negative number counts from
    the end of `steps`, as in a list. Points are numbered from 0, as rows of `positions`.
    Everything raises InputError for a name or step that is not there, or if the folder is damaged.
    """

    def __init__(self, folder: str | os.PathLike):
        self.path = Path(folder).absolute()
        _require_results(self.path)
        self._session = _session(self.path)
        with self._file() as file:
            shape = file.shape("points/reference")
        if len(shape) != 2 or not shape[0] or shape[1] not in (1, 2, 3):
            raise InputError(f"{self.path}: the points have the shape {shape}")

    # ---- the run ----

    @cached_property
    def summary(self) -> dict:
        """How the run ended (docs/results.md, summary.json); empty before it has."""
        path = self.path / "summary.json"
        try:
            summary = json.loads(path.read_text("utf-8"))
        except FileNotFoundError:
            self._require_same_run()
            return {}
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: can't be read ({error})") from error
        if not isinstance(summary, dict):
            raise InputError(f"{path}: holds no table")
        return summary

    @property
    def status(self) -> str:
        """`completed`, `not_converged`, `inconsistent`, `interrupted` or `failed`; `running` while a program writes."""
        return self.summary.get("status") or ("running" if _is_locked(self.path / MARKER) else "interrupted")

    @property
    def converged(self) -> bool:
        """True if the run reached the end of its load."""
        return self.status == "completed"

    @property
    def reason(self) -> str:
        """Why the run ended, a sentence; empty if its load has reached its end, or if it has not ended."""
        return self.summary.get("reason", "")

    @cached_property
    def title(self) -> str:
        with self._file() as file:
            return as_text(file.attribute("", "title", ""))

    @cached_property
    def case_text(self) -> str:
        """The case file as it was read."""
        with self._file() as file:
            return file.text("case/as_read")

    @cached_property
    def case(self) -> dict:
        """The case with every default and setting in place, as nested tables."""
        with self._file() as file:
            text = file.text("case/as_resolved")
        try:
            return tomllib.loads(text)
        except ValueError as error:
            raise InputError(f"{self.path}: the resolved case can't be read ({error})") from error

    @cached_property
    def settings(self) -> dict[str, str]:
        """What `--set` gave in all sessions of the run: values by key, as text in TOML."""
        with self._file() as file:
            if "case/settings/key" not in file:
                return {}
            return dict(zip(*(file.column(f"case/settings/{name}").tolist() for name in ("key", "value"))))

    # ---- the body ----

    @cached_property
    def positions(self) -> np.ndarray:
        """Reference positions, count x dimension [m]."""
        with self._file() as file:
            return _constant(file.numbers("points/reference"))

    @property
    def dimension(self) -> int:
        return self.positions.shape[1]

    @cached_property
    def points(self) -> Columns:
        """Values of the points by name: "volume" [m3], "neighbours", "region" and so on, each of count rows."""
        return Columns(self, "points", "value of points")

    @cached_property
    def point_sets(self) -> dict[str, np.ndarray]:
        """Numbers of the points of each set, ascending."""
        with self._file() as file:
            found = {name: _constant(numbers) for name, numbers in point_sets(file, len(self.positions)).items()}
        return ByName("set", self.path, found)

    # ---- fields ----

    @cached_property
    def steps(self) -> list[int]:
        """Numbers of the steps with fields, ascending."""
        with self._file() as file:
            return sorted(int(name) for name in file.names("steps"))

    def fields(self, step: int = -1) -> list[str]:
        """Names of the fields of a step."""
        group = self._group(step)
        with self._file() as file:
            return [name for name in file.names(group) if file.is_array(f"{group}/{name}")]

    def field(self, name: str, step: int = -1) -> np.ndarray:
        """A field of a step, count or count x components [its unit: docs/results.md, results.h5]."""
        names = self.fields(step)
        if name not in names:
            error = unknown("field", name, names, f"{self.path}, step {self._number(step)}")
            if name in WITH_STRESS:
                error = InputError(f"{error} A run writes strains and stresses with output.stress = true.")
            raise error
        with self._file() as file:
            return file.numbers(f"{self._group(step)}/{name}")

    def displacement(self, step: int = -1) -> np.ndarray:
        """Displacements of a step, count x dimension [m]."""
        return self.field("displacement", step)

    def load_factor(self, step: int = -1) -> float:
        """Load factor of a step with fields; the time [s] in mode `dynamics`."""
        with self._file() as file:
            return float(file.attribute(self._group(step), "load_factor"))

    # ---- tables ----

    @cached_property
    def history(self) -> Columns:
        """One row per accepted step: energies [J], reactions [N], probes and more (docs/results.md, history.csv)."""
        return Columns(self, "history", "column of the history")

    @cached_property
    def iterations(self) -> Columns:
        """One row per iteration of the searches for equilibrium (docs/results.md, iterations.csv)."""
        return Columns(self, "iterations", "column of the iterations")

    @cached_property
    def decisions(self) -> Columns:
        """One row per decision of the load stepping (docs/results.md, decisions.csv)."""
        return Columns(self, "decisions", "column of the decisions")

    @cached_property
    def broken_bonds(self) -> Columns:
        """One row per broken bond, in the order of breaking (docs/results.md, broken_bonds.csv)."""
        return Columns(self, "broken_bonds", "column of the broken bonds")

    @cached_property
    def probes(self) -> dict[str, np.ndarray]:
        """Values of the probes of a set or a point, by name: steps, or steps x components [the field's unit]."""
        found = {}
        for name in (probe["name"] for probe in self.case.get("probe", [])):
            columns = [f"{name}_{axis}" for axis in "xyz" if f"{name}_{axis}" in self.history]
            if name in self.history:
                found[name] = self.history[name]
            elif columns:
                found[name] = _constant(np.stack([self.history[column] for column in columns], axis=1))
        return ByName("probe of a set or a point", self.path, found)

    @cached_property
    def lines(self) -> dict[str, Columns]:
        """Values along lines, by the name of the probe: one row per point and step (docs/results.md, line_NAME.csv)."""
        with self._file() as file:
            names = file.names("lines")
        found = {name: Columns(self, f"lines/{name}", "column of the line") for name in names}
        return ByName("line", self.path, found)

    def reload(self) -> "Results":
        """Forgets what has been read, so that a run that is going, or has gone on, shows its present state."""
        for name in [name for kind in type(self).__mro__ for name, member in vars(kind).items()
                     if isinstance(member, cached_property)]:  # fmt: skip
            self.__dict__.pop(name, None)
        _require_results(self.path)
        self._session = _session(self.path)
        return self

    # ---- pictures ----

    def plot(self, name: str | None = None, step: int | str = -1, *, component: str | None = None,
             zoom: Sequence[float] | None = None, deform: float | str | None = "auto", style: str = "screen",
             column: str | None = None) -> "Figure":  # fmt: skip
        """A picture as the program draws it (docs/results.md, Pictures), as a matplotlib figure.

        name       of a picture ("deformed", "energies"), or of a field, which colours the deformed body: "stretch". Without
                   a name the first picture that the program draws.
        step       shown by pictures of one step: a number, "last", "first" or "peak" (of the largest reaction); other
                   pictures show the whole run and take no step
        component  of a field: "x", "xy", "magnitude", "1" (docs/results.md)
        zoom       what is shown of a field: xmin, xmax, ymin, ymax [m]; six numbers for a solid
        deform     factor of the displacements in the picture of a field; None: the undeformed body
        style      "screen", "paper" or "talk"; a paper has a column, "single" or "double"
        """
        from .pictures.figures import drawings

        self._require_same_run()
        drawn_in = _style(style, column)
        view = self._view(component, zoom, deform)
        if view is not None:
            if name is None:
                raise InputError("plot: component, zoom and deform are of a field: give its name")
            return self._field_picture(name, step, view, drawn_in, [])
        known = []
        for drawing in drawings(self._folder, self._number(step) if self.steps else None):
            if name not in (None, drawing.name):
                known.append(drawing.name)
                continue
            if step != -1 and not drawing.of_step:
                raise InputError(f"the picture {drawing.name!r} shows the whole run: leave out step")
            return drawing.figure(drawn_in)
        return self._field_picture(name, step, None, drawn_in, known)

    def curve(self, x: str | None = None, y: str | Sequence[str] | None = None) -> "Figure":
        """The load-displacement picture of the run, or columns y of the history over its column x, as a figure.

        x  column; without it the load factor
        y  one column, or several of the same unit
        """
        if y is None:
            if x is not None:
                raise InputError(f"curve: which column is to be drawn over {x!r}? Give y")
            return self.plot("load_displacement")
        from .pictures.column_picture import Column, draw_columns

        self._require_same_run()
        names = [y] if isinstance(y, str) else list(y)
        abscissa, *columns = (Column(name, self._numbers(name), self.history.unit(name)) for name in [x or "load_factor", *names])
        if len({column.unit for column in columns}) != 1:
            told = ", ".join(f"{column.name} [{column.unit}]" for column in columns)
            raise InputError(f"curve: y needs columns of one unit, not {told or 'none'}")
        return draw_columns(self._folder, abscissa, columns)

    def report(self, path: str | os.PathLike | None = None) -> Path:
        """Makes one page of the results, which needs no network (docs/report.md); returns its path.

        path  of the page; without it report.html in the folder. Nothing but an earlier page is replaced.
        """
        from .report.make import make_page

        self._require_same_run()
        return make_page(self.path, None if path is None else Path(path))[0]

    def _field_picture(self, name: str | None, step: int | str, view, style, known: list[str]):
        from .pictures.drawing import Drawing
        from .pictures.field_picture import View, draw_field

        fields = self.fields(step) if self.steps else []
        if name is None or name not in fields:
            raise unknown("picture" if view is None else "field", name, dict.fromkeys([*known, *fields]), self.path)
        drawn = self._folder.step(self._number(step))
        return Drawing(name, lambda: draw_field(self._folder, drawn, name, view or View())).figure(style)

    @staticmethod
    def _view(component: str | None, zoom: Sequence[float] | None, deform: float | str | None):
        """What is shown of a field; None if nothing is chosen."""
        from .pictures.field_picture import View

        if component is None and zoom is None and deform == "auto":
            return None
        if isinstance(deform, str) and deform not in ("auto", "none"):
            raise InputError(f"deform is a factor from 0 on, None or 'auto', not {deform!r}")
        factor = {"auto": None, "none": 0.0, None: 0.0}[deform] if deform is None or isinstance(deform, str) else float(deform)
        if factor is not None and not 0.0 <= factor < 1e30:
            raise InputError(f"deform is a factor from 0 on, None or 'auto', not {deform!r}")
        return View(component, None if zoom is None else tuple(zoom), factor)

    @cached_property
    def _folder(self) -> ResultsFolder:
        return read_results_folder(self.path)

    # ---- how it is shown ----

    def __repr__(self) -> str:
        return f"<results {str(self.path)!r}: {self.status}, {len(self.steps)} steps with fields, {len(self.positions)} points>"

    def _repr_html_(self) -> str:
        rows = {"status": self.status, "reason": self.reason, "points": f"{len(self.positions)} in {self.dimension}D"}
        steps = self.history.get("step", [])
        if len(steps):
            rows |= {"accepted steps": f"{sum(steps > 0)}, with fields {len(self.steps)}",
                     "load factor": f"{self.history['load_factor'][-1]:.6g}"}  # fmt: skip
            peaks = {name: np.abs(self.history[name]).max() for name in self.history if name.startswith("reaction_")}
            if peaks:
                name = max(peaks, key=peaks.get)
                rows["peak"] = f"{peaks[name]:.6g} N ({name})"
            if "broken_bonds" in self.history:
                rows["broken bonds"] = f"{self.history['broken_bonds'][-1]:.0f}"
        cells = "".join(f"<tr><th style='text-align:left'>{name}</th><td style='text-align:left'>{html.escape(str(text))}</td></tr>"
                        for name, text in rows.items() if text)  # fmt: skip
        return f"<table><caption>{html.escape(self.title or str(self.path))}</caption>{cells}</table>"

    # ---- reading ----

    def _require_same_run(self) -> None:
        """What is kept of one run is never mixed with what another one has written."""
        if _session(self.path) != self._session:
            _require_results(self.path)
            raise InputError(f"{self.path}: another run, or a continuation, has written here since these results were opened; "
                             "call reload()")  # fmt: skip

    def _file(self) -> ResultsFile:
        self._require_same_run()
        return ResultsFile(self.path)

    def _number(self, step: int | str) -> int:
        if isinstance(step, str):
            if step == "all":
                raise InputError("step='all' would be many pictures: draw each step of `steps`")
            return steps_named(self._folder, step)[0]
        try:
            step = operator.index(step)
        except TypeError:
            raise InputError(f"a step is a whole number, not {step!r}, or a name such as 'last'") from None
        if not self.steps:
            raise InputError(f"{self.path}: no step has fields")
        if step in self.steps:
            return step
        if -len(self.steps) <= step < 0:
            return self.steps[step]
        raise InputError(f"{self.path}: step {step} has no fields. There are {ranges(self.steps)}.")

    def _group(self, step: int) -> str:
        return f"steps/{self._number(step):06d}"

    def _numbers(self, name: str) -> np.ndarray:
        values = self.history[name]
        if values.dtype.kind not in "fiu":
            raise InputError(f"the column {name!r} of the history holds text")
        return values


def _constant(array: np.ndarray) -> np.ndarray:
    """An array that is kept, and therefore must not be changed."""
    array.flags.writeable = False
    return array


def _style(name: str, column: str | None):
    from .pictures.style import COLUMNS, STYLES, style_named

    if name not in STYLES:
        raise unknown("style", name, STYLES, "plot")
    if column is not None and (name != "paper" or column not in COLUMNS):
        raise InputError(f"plot: column={column!r}: style='paper' has the columns {' and '.join(COLUMNS)}, other styles none")
    return style_named(name, column)


def _require_results(path: Path) -> None:
    """Refuses a path that is no results folder, and names those that are near."""
    if (path / "results.h5").exists():
        return
    what = "no results folder (it has no results.h5)" if path.is_dir() else "no such folder"
    if path.is_file():
        what = "no such folder but a file; name the folder that it is in"
    place = path if path.is_dir() else path.parent
    near = sorted(file.parent.name for file in place.glob("*/results.h5")) if place.is_dir() else []
    there = f"; the results in {place} are {', '.join(near[:20])}{', …' * (len(near) > 20)}" if near else ""
    raise InputError(f"{path}: {what}{there}")


def _session(path: Path) -> int | None:
    """When the present session of the run began to write the folder; None in folders of older versions."""
    try:
        return os.stat(path / MARKER).st_mtime_ns
    except OSError:
        return None


def _is_locked(path: Path) -> bool:
    """Whether a run holds the marker locked."""
    try:
        with open(path, "rb") as marker:
            fcntl.flock(marker, fcntl.LOCK_SH | fcntl.LOCK_NB)  # released when the file is closed
    except BlockingIOError:
        return True
    except OSError:
        return False
    return False
