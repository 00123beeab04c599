"""peristat: implicit quasi-static peridynamics.

    import peristat as ps

    run = ps.load_case("cases/plate_with_hole/elastic.toml").solve()
    run.plot("damage")

docs/python.md is the guide. Numbers are in SI units unless a text has its unit.
"""

import importlib

# Public names and their modules, which are loaded when they are first used.
NAMES = {
    "Body": "body",
    "Case": "case",
    "Check": "case",
    "Dial": "dial",
    "Fit": "fitting.api",
    "InputError": "errors",
    "MachineError": "errors",
    "MemoryError": "errors",
    "Points": "points",
    "Results": "results",
    "Run": "run",
    "Step": "steps",
    "Steps": "steps",
    "Sweep": "sweeping",
    "fit": "fitting.api",
    "load_case": "case",
    "open_results": "results",
    "resume": "run",
    "sampled_law": "law",
    "sweep": "sweeping",
}

__all__ = [*NAMES, "versions"]


def versions() -> dict[str, str]:
    """Versions of peristat, its libraries and its compiler, by name."""
    from ._package import load_core

    return load_core().versions()


def __getattr__(name):
    if name not in NAMES:
        raise AttributeError(f"module peristat has no {name!r}; it has {', '.join(sorted(__all__))}")
    return getattr(importlib.import_module(f".{NAMES[name]}", __name__), name)


def __dir__():
    return sorted([*globals(), *__all__])
