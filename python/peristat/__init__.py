"""peristat: quasi-static peridynamics, solved implicitly, through fracture (docs/python.md)."""

import importlib

# Public names and the modules that define them, each loaded at its first use.
NAMES = {
    "open_results": "results",
    "Results": "results",
    "Table": "results",
    "InputError": "errors",
    "MachineError": "errors",
    "MemoryError": "errors",
}
__all__ = list(NAMES)


def __getattr__(name: str):
    if name not in NAMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{NAMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *NAMES])
