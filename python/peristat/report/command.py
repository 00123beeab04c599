"""Makes the page of a results folder: ./peristat report DIR -> DIR/report.html

Exit codes: 0 written, 2 if DIR holds no results, damaged ones, or another file in the page's place, 5 if the page can't
be written, 1 for a fault of the program. Needs numpy, h5py and matplotlib, and no display.
"""

import argparse
from pathlib import Path

from .._folder_command import DONE, WRONG_INPUT, exit_code_of
from ..pictures.hdf5_reader import Damaged
from . import place
from .make import make_page


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
    except SystemExit as end:
        return DONE if end.code in (0, None) else WRONG_INPUT
    directory, output = arguments.directory, arguments.output

    def make() -> None:
        path, size = make_page(directory, output)
        print(f"report: {path}: {size / 1e6:.2f} MB")

    return exit_code_of("report", output or directory, "shown", (Damaged,), make)
