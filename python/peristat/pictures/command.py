"""Draws the pictures of a results folder: ./peristat plot DIR -> DIR/plots/*.png, crack.gif

Exit codes: 0 if every possible picture is drawn (missing data is reported), 2 if DIR is no results folder, is
damaged, or its plots are a link or hold an unlisted picture, 5 if the pictures can't be written, 1 for a fault of
the program. Needs numpy, h5py and matplotlib, and no display.
"""

import argparse
import io
import os
import sys
import traceback
from pathlib import Path

from .figures import animate, drawings
from .gallery import SCRIPT, Gallery, NoPlace
from .results_folder import NotAResultsFolder, read_results_folder

DONE, BUG, WRONG_INPUT, MACHINE_FAILED, INTERRUPTED = 0, 1, 2, 5, 130
FORMATS = ("png", "pdf", "svg")
DOTS_PER_INCH = {"png": 100, "pdf": 200, "svg": 200}  # resolution of images within vector pictures
MOST_VECTORS = 3000  # number of shapes of one kind above which a vector picture stores them as an image


def encoded(figure, ending: str) -> bytes:
    """A figure as a file; a vector picture holds large numbers of shapes as images, but texts and lines as vectors."""
    if ending != "png":
        for axes in figure.axes:
            for heap in axes.collections:
                heap.set_rasterized(len(heap.get_paths()) > MOST_VECTORS)
    file = io.BytesIO()
    options = {"pil_kwargs": {"compress_level": 4}} if ending == "png" else {}
    figure.savefig(file, format=ending, dpi=DOTS_PER_INCH[ending], **options)
    return file.getvalue()


def draw(directory: Path, ending: str) -> None:
    """Draws everything and prints what was drawn."""
    results = read_results_folder(directory)
    gallery = Gallery(directory)
    gallery.remove_earlier((f".{ending}", ".gif"))
    drawn = []
    for drawing in drawings(results):
        drawn.append(f"{drawing.name}.{ending}")
        gallery.add(drawn[-1], encoded(drawing.figure(), ending))
    animation = animate(results)
    if animation:
        drawn.append("crack.gif")
        gallery.add(drawn[-1], animation)
    for sentence in results.missing:
        print(f"plot: {sentence}")
    print(f"plot: {gallery.path}: {', '.join(drawn) if drawn else 'nothing could be drawn'}")


def add_script(directory: Path) -> None:
    """Puts the script for ParaView into `plots`, and prints how to start it."""
    read_results_folder(directory)
    if not (directory / "results.xdmf").is_file():
        raise NotAResultsFolder(f"{directory}: no step has fields, so that there is no results.xdmf to show")
    text = (Path(__file__).parent / SCRIPT).read_text()
    known = text.replace("FOLDER = None", f"FOLDER = {str(directory.resolve())!r}", 1)
    gallery = Gallery(directory)
    gallery.add(SCRIPT, known.encode())
    print(f"plot: paraview --script={gallery.path / SCRIPT}")


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="peristat plot", allow_abbrev=False,
        description="Draws the pictures of a results folder into DIR/plots (docs/results.md, Pictures); "
        "pictures of the same format that were drawn before are replaced.",
        epilog="Exit codes: 0 drawn (what is missing is said), 2 no results folder, or a damaged one, "
        "5 the pictures can't be written, 1 a bug.",
    )  # fmt: skip
    parser.add_argument("directory", metavar="DIR", type=Path, help="results folder of a run")
    parser.add_argument("--format", choices=FORMATS, default="png",
                        help="of the pictures (default: png; pdf and svg are vector graphics)")  # fmt: skip
    parser.add_argument("--paraview", action="store_true",
                        help=f"instead of pictures, write DIR/plots/{SCRIPT}, which shows damage and cracks in ParaView")  # fmt: skip
    return parser


def main(words: list[str]) -> int:
    try:
        arguments = _parser().parse_args(words)
    except SystemExit as ending:
        return DONE if ending.code in (0, None) else WRONG_INPUT
    try:
        if arguments.paraview:
            add_script(arguments.directory)
        else:
            draw(arguments.directory, arguments.format)
    except (NotAResultsFolder, NoPlace) as error:
        return _told(str(error), WRONG_INPUT)
    except OSError as error:
        return _told(f"{arguments.directory}: {error}", MACHINE_FAILED)
    except NameError:  # a fault of the program: no folder's content causes it
        traceback.print_exc()
        return _told(f"{arguments.directory}: a fault of the program, which is worth a report", BUG)
    except Exception as error:  # an unforeseen change in a folder that somebody has edited
        return _told(f"{arguments.directory}: can't be drawn ({type(error).__name__}: {error})", WRONG_INPUT)
    return DONE


def _told(sentence: str, code: int) -> int:
    line = "".join(c if c.isprintable() else " " for c in sentence)
    print(f"plot: {line if len(line) < 1000 else line[:1000] + '…'}", file=sys.stderr)
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
    return code if code >= 0 else _told(f"reading {' '.join(words)} ended with signal {-code}: it is damaged", WRONG_INPUT)

