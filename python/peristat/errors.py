"""The exceptions of peristat. That a run does not converge is no exception: see Run.status."""

import builtins
import difflib
from collections.abc import Iterable


class InputError(ValueError):
    """Wrong input: what is wrong and what is allowed.

    Attributes:
        key: dotted key of the case, such as "support[0].set", or an argument; or empty.
        value: the value that was found, as text, or empty.
        allowed: a sentence that says what is wrong and what is allowed.
        place: where it stands, "plate.toml:12:3", or empty.
    """

    def __init__(self, message: str, key: str = "", value: str = "", allowed: str = "", place: str = "") -> None:
        super().__init__(message)
        self.key = key
        self.value = value
        self.allowed = allowed or message
        self.place = place

    def __reduce__(self):
        return type(self), (str(self), self.key, self.value, self.allowed, self.place)


class MachineError(RuntimeError):
    """The machine fails in a correct run: disk full, folder gone, a limit of the shell."""


class MemoryError(builtins.MemoryError):
    """There is too little memory; told before it is taken."""


def input_error(key: str, value: str, allowed: str, place: str = "") -> InputError:
    """An InputError with the message "key = value: allowed"."""
    head = " = ".join(part for part in (key, value) if part)
    message = f"{head}: {allowed}" if head else allowed
    return InputError(f"{place}: {message}" if place else message, key, value, allowed, place)


def unknown(kind: str, name: object, names: Iterable[str], where: str = "") -> InputError:
    """The refusal of a name that is none of `names`, with the nearest of them and the list."""
    names = list(names)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.5)
    question = f"; did you mean {near[0]}?" if near else ""
    there = f"there are {', '.join(names)}" if names else "there are none"
    return input_error("", "", f"there is no {kind} {name!r}{question} ({there})", where)
