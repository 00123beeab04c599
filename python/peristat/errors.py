"""Exceptions of the package. A search that does not converge is none: it is a value."""

import builtins
import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """The input is wrong: a name, a value, a shape, a file. The message says which, and what is allowed."""


class MachineError(RuntimeError):
    """The machine failed the run: a full disk, a folder that is gone, a limit of the shell."""


class MemoryError(builtins.MemoryError):
    """The case does not fit into memory. The message has the estimate."""


def unknown(kind: str, name: object, names: Iterable[str], where: str = "") -> InputError:
    """The refusal of a name that is none of `names`, with the nearest of them and the list."""
    names = list(names)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.5)
    question = f" Did you mean {near[0]!r}?" if near else ""
    there = f"There are {', '.join(names)}" if names else "There are none"
    return InputError(f"{where and where + ': '}there is no {kind} {name!r}.{question} {there}.")
