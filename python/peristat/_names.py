"""Refusals of names."""

import difflib
from collections.abc import Iterable

from .errors import InputError


def unknown(kind: str, name: object, names: Iterable[str], where: object) -> InputError:
    """The refusal of a name that is none of `names`, with the nearest of them and the list."""
    names = list(names)
    near = difflib.get_close_matches(str(name), names, n=1, cutoff=0.5)
    question = f" Did you mean {near[0]!r}?" if near else ""
    there = f"There are {', '.join(names)}." if names else "There are none."
    return InputError(f"{where}: there is no {kind} {name!r}.{question} {there}")
