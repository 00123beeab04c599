"""Where the parts of the package are: in the sources, or installed."""

import importlib.machinery
import importlib.util
import operator
import os
import pathlib
import sys
from typing import Any

from .errors import input_error

HERE = pathlib.Path(__file__).resolve().parent
SOURCES = HERE.parents[1]
IN_SOURCES = (SOURCES / "CMakeLists.txt").is_file()


def load_core() -> Any:
    """Loads the compiled module `peristat._core`; once."""
    name = "peristat._core"
    if name in sys.modules:
        return sys.modules[name]
    file = _core_file()
    loader = importlib.machinery.ExtensionFileLoader(name, str(file))
    spec = importlib.util.spec_from_file_location(name, file, loader=loader)
    core = importlib.util.module_from_spec(spec)
    loader.exec_module(core)
    sys.modules[name] = core
    if IN_SOURCES:  # builds modules that are missing
        os.environ.setdefault("PERISTAT_LAUNCHER", str(SOURCES / "peristat"))
    return core


def _core_file():
    suffix = importlib.machinery.EXTENSION_SUFFIXES[0]
    folders = [HERE]
    if IN_SOURCES:
        folders = [pathlib.Path(os.environ.get("PERISTAT_BUILD", SOURCES / "build/release"))]
    for folder in folders:
        file = folder / f"_core{suffix}"
        if file.is_file():
            return file
    if IN_SOURCES:
        raise ImportError(
            f"the compiled part of peristat is missing in {folders[0]}: type ./peristat python, "
            "which builds it. It is for Debian's /usr/bin/python3"
        )
    raise ImportError(
        f"the compiled part of peristat is for another Python than {sys.executable} "
        f"({sys.version.split()[0]}): there is no _core{suffix} in {HERE}"
    )


def thread_count(threads):
    """A number of threads for C++, which refuses one that is too large.

    Raises:
        InputError: it is no whole number.
    """
    try:
        return operator.index(threads)
    except TypeError:
        raise input_error("threads", repr(threads)[:80], "must be a whole number; 0: all") from None
