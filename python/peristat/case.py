"""A case: what a case file says, as tables of Python."""

import contextlib
import json
import os
import pathlib
import re
import sys
import tomllib
from typing import TYPE_CHECKING, Any

from . import _schema, tables, toml_text
from ._package import load_core, thread_count
from .errors import InputError, input_error
from .functions import GivenFunctions
from .points import Points

if TYPE_CHECKING:
    from .body import Body
    from .case_tables import CaseTable
    from .run import Run
    from .steps import Steps
else:
    CaseTable = tables.Table

_PRIVATE = ("_file", "_text", "_unchanged", "_settings", "_functions", "_points")


class Case(CaseTable):
    """A body, its material, supports, loads and how they are solved; the keys are those of case files.

        case = ps.Case("strip", dimension=2)
        case.lattice.update(spacing="1 mm", thickness="1 mm")
        case.lattice.add_shape(add="box", min=["0 mm", "0 mm"], max=["50 mm", "10 mm"])
        case.material.youngs_modulus = "200 GPa"

    Args:
        name: stands for the case in messages, pictures (as its title) and the default results
            folder, results/NAME; the default is the name of the script.
        given_points: `Points` in the place of a lattice or a file.
        **values: keys and tables of the case.

    Files that the case names are searched from the working folder; of a loaded case from its folder.
    """

    def __init__(self, name: str | None = None, /, given_points: Points | None = None, **values: Any) -> None:
        name = _checked_name(name)
        if given_points is not None and not isinstance(given_points, Points):
            raise input_error("given_points", repr(given_points)[:80], "must be peristat.Points")
        self._start(pathlib.Path.cwd() / f"{name}.toml", given_points)
        super().__init__(_schema.document(), "", {"title": name, **values})

    def _start(self, file, points=None):
        private = dict(_file=file, _text=None, _unchanged=None, _settings=[], _points=points)
        for key, value in private.items():
            object.__setattr__(self, key, value)
        object.__setattr__(self, "_functions", GivenFunctions())

    @property
    def name(self) -> str:
        """Name of the case in messages and in the default results folder."""
        return self._file.stem

    def _place(self):
        """The file that the case stands for: one that is there only if it is still the file's."""
        return self._file if self._is_file() else self._file.with_name(f"{self.name} (Python)")

    def set(self, key: str, value: Any) -> None:
        """Sets the value of a dotted key, as `--set` does: `case.set("loading.steps", 50)`.

        Elements count from 0: "support[0].displacement[1]".

        Raises:
            InputError: there is no such key.
        """
        was_file = self._is_file()
        head, number = tables.parted(key)
        table, last = tables.find(self, head)
        if number is None:
            table[last] = value
        else:
            changed = list(_elements(table, last, number, key))
            changed[number] = value
            table[last] = changed
        if was_file:
            self._settings.append((key, self._value_text(value, key)))
            object.__setattr__(self, "_unchanged", self.plain())

    def get(self, key: str, default: Any = None) -> Any:
        """Value of a dotted key as it was given; `default` where it was not.

        Raises:
            InputError: there is no such key or element.
        """
        head, number = tables.parted(key)
        table, last = tables.find(self, head)
        if number is not None:
            return _elements(table, last, number, key)[number]
        return table._values.get(table._key(last)[0], default)

    def copy(self) -> "Case":
        """A case of its own with the same keys, functions and points."""
        other = type(self).__new__(type(self))
        other._start(self._file, self._points)
        for key in ("_text", "_functions"):
            object.__setattr__(other, key, getattr(self, key))
        object.__setattr__(other, "_unchanged", self._unchanged)
        object.__setattr__(other, "_settings", list(self._settings))
        tables.Table.__init__(other, self._schema, "", self.plain())
        return other

    def text(self) -> str:
        """The case as the text of a case file. Functions are calls in it, `python_pull(load)`."""
        if self._is_file():
            return self._text
        return toml_text.text_of(self._without_functions(self.plain(), ""))

    def save(self, file: str | os.PathLike[str]) -> None:
        """Writes a case file, which the command line runs; refuses to replace another file.

        Raises:
            InputError: the case has functions or points of Python, or the file exists.
        """
        text = self.text()
        if self._points is not None or self._functions.used_in(text):
            raise input_error("", "", "a case with functions or points of Python can't be saved")
        if self._settings and self._is_file():
            text = toml_text.text_of(self.plain())
        try:
            with open(file, "x", encoding="utf-8") as out:
                out.write(text)
        except FileExistsError:
            raise input_error("file", os.fspath(file), "exists; choose another name") from None

    def resolved(self) -> str:
        """All keys and values in force, with defaults, as TOML in SI units.

        Raises:
            InputError: what is wrong with the case.
        """
        return self._read().resolved

    def check(self, threads: int = 0) -> "Check":
        """Builds the body without solving: counts, supports, memory, time; and warnings.

        Raises:
            InputError: what a run would refuse.
        """
        with self._located_errors():
            return Check(self._read().check(thread_count(threads)))

    def check_tangent(self, deformation: str = "", threads: int = 0) -> dict[str, Any]:
        """Compares residual and tangent with finite differences, see `peristat check-tangent`.

        Args:
            deformation: current coordinates as expressions of x, y, z, separated by ";".
        """
        with self._located_errors():
            return json.loads(self._read().check_tangent(deformation, thread_count(threads)))

    def calibrate(self, strengths: bool = False) -> dict[str, Any]:
        """Constants and moduli of the materials, fracture energies, and strengths on request."""
        with self._located_errors():
            return json.loads(self._read().calibrate(strengths))

    def body(self, threads: int = 0) -> "Body":
        """The body: points, bonds, material, supports and loads.

        Raises:
            InputError: what is wrong with the case, or a body that its supports do not hold.
            MemoryError: it would not fit.
        """
        from .body import Body

        with self._located_errors():
            read = self._read()
            return Body(self.copy(), read, read.body(thread_count(threads)))

    def solve(self, mode: str | None = None, **options: Any) -> "Run":
        """Makes the body and solves it; the options are those of `Body.solve`."""
        from .run import run_case

        return run_case(_with_mode(self, mode), None, **options)

    def steps(self, mode: str | None = None, **options: Any) -> "Steps":
        """Makes the body and solves it step by step; see `Body.steps`."""
        from .steps import Steps

        return Steps(lambda on_step: self.solve(mode, on_step=on_step, **options))

    def _read(self):
        """The case as C++ has read and checked it."""
        text = self.text()
        settings = self._settings if self._is_file() else []
        with self._located_errors():
            return load_core().Case(str(self._place()), text, settings, *self._givens())

    def _givens(self):
        """Functions that the case uses, and its points."""
        texts = [self.text(), *(value for _, value in self._settings)]
        return self._functions.used_in(" ".join(texts)), self._points

    @contextlib.contextmanager
    def _located_errors(self):
        """Lines of a text that no person has written mean nothing: errors name the key alone."""
        try:
            yield
        except InputError as error:
            if self._is_file() or not error.place:
                raise
            raise input_error(error.key, error.value, error.allowed) from None

    def _is_file(self):
        """True if the case is still that of its file, with changes by `set`."""
        return self._text is not None and self.plain() == self._unchanged

    def _value_text(self, value, key):
        return toml_text.value_text(self._without_functions(value, key), key)

    def _without_functions(self, value, key):
        if isinstance(value, dict):
            return {
                name: self._without_functions(item, f"{key}.{name}" if key else name)
                for name, item in value.items()
            }
        if isinstance(value, (list, tuple)):
            return [self._without_functions(item, f"{key}[{k}]") for k, item in enumerate(value)]
        return self._functions.call_text(value, key) if callable(value) else value

    def __copy__(self):
        return self.copy()

    if not TYPE_CHECKING:  # for type checkers only the keys are there

        def __setattr__(self, name, value):
            if name in _PRIVATE:
                object.__setattr__(self, name, value)
            else:
                super().__setattr__(name, value)

    def __repr__(self):
        return f"<Case {self.name}>"


class Check(str):
    """What `check` tells, as text, and its warnings."""

    @property
    def warnings(self) -> list[str]:
        mark = "warning: "
        return [line.removeprefix(mark) for line in self.splitlines() if line.startswith(mark)]

    def __repr__(self):
        return str(self)


def load_case(file: str | os.PathLike[str]) -> Case:
    """Reads a case file; `case.set` and the tables may change it afterwards.

    Raises:
        InputError: there is no such file, or it is no TOML.
    """
    file = pathlib.Path(file)
    text = load_core().case_text(str(file))
    with _places_of(file, text):
        try:
            values = tomllib.loads(text)
        except tomllib.TOMLDecodeError as error:
            raise input_error("", "", str(error), str(file)) from None
    case = Case.__new__(Case)
    case._start(file)
    with _places_of(file, text):
        tables.Table.__init__(case, _schema.document(), "", values)
    object.__setattr__(case, "_text", text)
    object.__setattr__(case, "_unchanged", case.plain())
    return case


@contextlib.contextmanager
def _places_of(file, text):
    """Lets the program tell what is wrong with a file: it knows line and column."""
    try:
        yield
    except InputError:
        load_core().Case(str(file), text, [], {}, None)
        raise


def _checked_name(name):
    if name is None:
        script = getattr(sys.modules.get("__main__"), "__file__", None)
        name = pathlib.Path(script).stem if script else "python"
    if not isinstance(name, str) or not re.fullmatch(r"[^/\x00-\x1f]{1,100}", name) or name[0] == ".":
        raise input_error("name", repr(name)[:80], "must be a name without / that begins with no dot")
    return name


def _with_mode(case, mode):
    if mode is None:
        return case
    changed = case.copy()
    changed.set("solver.mode", mode)
    return changed


def _elements(table, name, number, key):
    values = table._values.get(table._key(name)[0])
    if isinstance(values, tables.TableList):
        raise input_error(key, "", "is a table; name a key in it")
    if not isinstance(values, list) or number >= len(values):
        raise input_error(key, "", "there is no such element")
    return values
