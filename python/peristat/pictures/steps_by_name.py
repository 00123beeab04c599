"""Steps with fields by number or name: last, first, peak, all."""

import numpy as np

from ..errors import InputError
from .reactions import has_reactions, reactions

NAMES = ("last", "first", "peak", "all")


def steps_named(results, choice: str) -> list[int]:
    """Numbers of the steps of a choice. Raises InputError for a step without fields."""
    there = results.step_numbers
    if not there:
        raise InputError(f"{results.path}: no step has fields")
    if choice == "all":
        return there
    if choice in ("last", "first"):
        return [there[-1 if choice == "last" else 0]]
    if choice == "peak":
        return [_peak(results)]
    if not choice.isdecimal():
        raise InputError(f"step: {choice!r} is neither a number nor one of {', '.join(NAMES)}")
    if int(choice) not in there:
        raise InputError(f"{results.path}: step {choice} has no fields. There are {ranges(there)}.")
    return [int(choice)]


def _peak(results) -> int:
    """The step with the largest reaction."""
    if not has_reactions(results):
        raise InputError(f"{results.path}: no support has a reaction, so that there is no peak; choose a step by number")
    largest = max(reactions(results), key=lambda curve: curve.values.max())
    number = int(results.history["step"][int(np.argmax(largest.values))])
    if number not in results.step_numbers:
        raise InputError(f"{results.path}: the peak is at step {number}, which has no fields (output.every). "
                         f"There are {ranges(results.step_numbers)}.")  # fmt: skip
    return number


def ranges(numbers: list[int]) -> str:
    """1 to 4, 6, 8: whole numbers, ascending, in short."""
    parts: list[list[int]] = []
    for number in numbers:
        if parts and number == parts[-1][-1] + 1:
            parts[-1].append(number)
        else:
            parts.append([number])
    words = [str(part[0]) if len(part) == 1 else f"{part[0]} to {part[-1]}" for part in parts]
    return ", ".join(words if len(words) <= 20 else [*words[:10], "…", *words[-9:]])
