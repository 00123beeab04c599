"""Makes the page of a results folder: ./peristat report DIR -> DIR/report.html

Exit codes: 0 written, 2 if DIR holds no results, damaged ones, or another file in the page's place, 5 if the page can't
be written, 1 for a fault of the program. Needs numpy, h5py and matplotlib, and no display.
"""

import argparse
import os
import sys
import traceback
from pathlib import Path

from ..errors import InputError
from ..pictures.hdf5_reader import Damaged
from . import place
from .make import make_page

DONE, BUG, WRONG_INPUT, MACHINE_FAILED, INTERRUPTED = 0, 1, 2, 5, 130


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="peristat report", allow_abbrev=False,
        description="Makes one page of the results of a run, a sweep or a trust suite (docs/report.md). It needs no network "
        "and replaces only an earlier page.",
        epilog="Exit codes: 0 written, 2 no results or damaged ones, or another file in the place of the page, 5 the page "
        "can't be written, 1 a bug.",
    )  # fmt: skip
    parser.add_argument("directory", metavar="DIR", type=Path, help="folder of a run, a sweep or a trust suite")
    parser.add_argument("--output", metavar="FILE", type=Path, help=f"the page (default: DIR/{place.NAME})")
    return parser


def main(words: list[str]) -> int:
    try:
        arguments = _parser().parse_args(words)
    except SystemExit as ending:
        return DONE if ending.code in (0, None) else WRONG_INPUT
    directory = arguments.directory
    try:
        path, size = make_page(directory, arguments.output)
    except (InputError, Damaged) as error:
        return _told(str(error), WRONG_INPUT)
    except OSError as error:
        return _told(f"{arguments.output or directory}: {error}", MACHINE_FAILED)
    except NameError:  # a fault of the program: no folder's content causes it
        traceback.print_exc()
        return _told(f"{directory}: a fault of the program, which is worth a report", BUG)
    except Exception as error:  # an unforeseen change in a folder that somebody has edited
        return _told(f"{directory}: can't be shown ({type(error).__name__}: {error})", WRONG_INPUT)
    print(f"report: {path}: {size / 1e6:.2f} MB")
    return DONE


def _told(sentence: str, code: int) -> int:
    line = "".join(c if c.isprintable() else " " for c in sentence)
    print(f"report: {line if len(line) < 1000 else line[:1000] + '…'}", file=sys.stderr)
    return code


def guarded(words: list[str]) -> int:
    """Runs `main` in a process of its own, because the HDF5 library may crash on a damaged file."""
    child = os.fork()
    if child == 0:
        try:
            code = main(words)
            sys.stdout.flush()
        except KeyboardInterrupt:
            code = INTERRUPTED
        except OSError:  # nobody reads the output
            code = MACHINE_FAILED
        os._exit(code)
    try:
        code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    except KeyboardInterrupt:  # from the terminal; the child has received it, too
        return INTERRUPTED
    return (
        code if code >= 0 else _told(f"reading {' '.join(words)} ended with signal {-code}: it is damaged", WRONG_INPUT)
    )
