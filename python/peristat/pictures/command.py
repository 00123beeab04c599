"""Draws the pictures of a results folder: ./peristat plot DIR -> DIR/plots/*.png, crack.gif; or one field of a step.

Exit codes: 0 if every possible picture is drawn (missing data is reported), 2 if DIR is no results folder, is
damaged, or its plots are a link or hold an unlisted picture, or for a field or step that is not there, 5 if the pictures
can't be written, 1 for a fault of the program. Needs numpy, h5py and matplotlib, and no display.
"""

import argparse
import io
import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

from .._folder_command import DONE, WRONG_INPUT, exit_code_of
from .drawing import Drawing
from .field_picture import View, draw_field, in_common
from .figures import animate, drawings
from .gallery import SCRIPT, Gallery, NoPlace
from .named_values import named_values
from .processes import results_of
from .results_folder import NotAResultsFolder, read_results_folder
from .steps_by_name import NAMES, steps_named
from .style import COLUMNS, SCREEN, STYLES, Style, style_named

FORMATS = ("png", "pdf", "svg")
DOTS_PER_INCH = 300  # of images within vector pictures
LENGTH_UNITS = {"": 1.0, "m": 1.0, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "µm": 1e-6, "km": 1e3}
MOST_VECTORS = 3000  # number of shapes of one kind above which a vector picture stores them as an image


def encoded(figure, ending: str) -> bytes:
    """A figure as a file; a vector picture holds large numbers of shapes as images, but texts and lines as vectors."""
    if ending != "png":
        for axes in figure.axes:
            for heap in axes.collections:
                heap.set_rasterized(len(heap.get_paths()) > MOST_VECTORS)
    file = io.BytesIO()
    options = {"pil_kwargs": {"compress_level": 4}} if ending == "png" else {}
    dots = figure.style.dots if ending == "png" else DOTS_PER_INCH
    figure.savefig(file, format=ending, dpi=dots, **options)
    return file.getvalue()


def draw(directory: Path, ending: str, style: Style = SCREEN) -> None:
    """Draws everything and prints what was drawn."""
    results = read_results_folder(directory)
    gallery = Gallery(directory)
    gallery.remove_earlier((f".{ending}", ".gif"))
    pictures = list(drawings(results))
    names = [*(f"{drawing.name}.{ending}" for drawing in pictures), "crack.gif"]

    def with_missing(make: Callable[[], bytes | None]) -> tuple[bytes | None, list[str]]:
        return make(), results.missing

    # The animation takes the longest: it begins first.
    tasks = [partial(animate, results), *(partial(_picture, drawing, ending, style) for drawing in pictures)]
    found = list(results_of([partial(with_missing, task) for task in tasks]))
    drawn = []
    for name, (data, missing) in zip(names, [*found[1:], found[0]], strict=True):
        results.missing.extend(sentence for sentence in missing if sentence not in results.missing)
        if data:
            drawn.append(name)
            gallery.add(name, data)
    for sentence in results.missing:
        print(f"plot: {sentence}")
    print(f"plot: {gallery.path}: {', '.join(drawn) if drawn else 'nothing could be drawn'}")


def _picture(drawing: Drawing, ending: str, style: Style) -> bytes:
    return encoded(drawing.figure(style), ending)


def draw_one_field(directory: Path, ending: str, field: str, step: str, view: View, style: Style, column: str | None) -> None:
    """Draws a field at one or all steps, in pictures of their own, and prints what each shows."""
    results = read_results_folder(directory)
    numbers = steps_named(results, step)
    common, whole = view, None
    if len(numbers) > 1:
        common, whole = in_common(results, numbers, field, view)
    gallery = None
    for number in numbers:
        shown = named_values(results, number, field, view.component)
        name = "_".join([shown.file_name, f"step_{number:06d}", *view.name_parts(),
                         *([] if style is SCREEN else [style.name]), *([column] if column else [])])  # fmt: skip
        figure = Drawing(name, partial(draw_field, results, results.step(number), field, common, whole)).figure(style)
        gallery = gallery or Gallery(directory)  # nothing is written if there is nothing to draw
        gallery.add(f"{name}.{ending}", encoded(figure, ending))
        print(f"plot: {gallery.path / name}.{ending}: {figure.caption}")
    for sentence in results.missing:
        print(f"plot: {sentence}")


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
        "pictures of the same format that were drawn before are replaced. With --field one field, in a picture of its "
        "own: DIR/plots/FIELD_step_NNNNNN.png; the other pictures stay.",
        epilog="Exit codes: 0 drawn (what is missing is said), 2 no results folder, a damaged one, or a field or step "
        "that it does not have, 5 the pictures can't be written, 1 a bug.",
    )  # fmt: skip
    parser.add_argument("directory", metavar="DIR", type=Path, help="results folder of a run")
    parser.add_argument("--format", choices=FORMATS, default="png",
                        help="of the pictures (default: png; pdf and svg are vector graphics)")  # fmt: skip
    parser.add_argument("--style", choices=STYLES, default="screen",
                        help="paper: the width of a column of a journal, letters of at least 6 points; talk: a slide")  # fmt: skip
    parser.add_argument("--column", choices=COLUMNS,
                        help="with --style paper: 84 mm (single, the default) or 174 mm wide (double)")  # fmt: skip
    one = parser.add_argument_group("one field")
    one.add_argument("--field", metavar="F", help="name of a field of the step: damage, displacement, von_mises, …")
    one.add_argument("--step", metavar="N", help=f"number of a step, or {', '.join(NAMES)} (default: last; peak: of the "
                     "largest reaction; all: one picture each, with the same colours)")  # fmt: skip
    one.add_argument("--component", metavar="C", help="x, y, z or magnitude of a vector, xx, xy, … of a tensor, "
                     "1, 2, 3 of principal_stress")  # fmt: skip
    one.add_argument("--zoom", metavar="XMIN,XMAX,YMIN,YMAX", type=_lengths,
                     help="what is shown of a plate as it is drawn [m, or with a unit: 2mm]; for a solid six numbers, a box "
                     "of the undeformed body")  # fmt: skip
    one.add_argument("--deform", metavar="S", type=_factor,
                     help="factor of the displacements; none: the undeformed body; auto: chosen from their size (default)")  # fmt: skip
    parser.add_argument("--paraview", action="store_true",
                        help=f"instead of pictures, write DIR/plots/{SCRIPT}, which shows damage and cracks in ParaView")  # fmt: skip
    return parser


def _lengths(text: str) -> tuple[float, ...]:
    """Lengths between commas, each with a unit or in metres."""
    found = []
    for word in text.split(","):
        match = re.fullmatch(r"\s*([-+]?[0-9.]+(?:[eE][-+]?[0-9]+)?)\s*([a-zµ]*)\s*", word)
        if not match or match[2] not in LENGTH_UNITS:
            raise argparse.ArgumentTypeError(f"{word!r} is no length: a number [m], or one with {', '.join(filter(None, LENGTH_UNITS))}")
        found.append(_number(match[1]) * LENGTH_UNITS[match[2]])
    return tuple(found)


def _factor(text: str) -> float | None:
    if text in ("auto", "none"):
        return {"auto": None, "none": 0.0}[text]
    factor = _number(text)
    if not 0.0 <= factor < 1e30:
        raise argparse.ArgumentTypeError(f"{text!r}: a factor from 0 on, none or auto")
    return factor


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is no number") from None


def _check(parser: argparse.ArgumentParser, given: argparse.Namespace) -> None:
    """Refuses options that would have no effect."""
    if given.column and given.style != "paper":
        parser.error("--column needs --style paper")
    alone = [name for name in ("step", "component", "zoom", "deform") if getattr(given, name) is not None]
    if alone and given.field is None:
        parser.error(f"--{alone[0]} needs --field, the name of a field")
    if given.paraview and (given.field is not None or given.style != "screen" or given.format != "png"):
        parser.error("--paraview writes a script and no picture: leave out the other options")


def main(words: list[str]) -> int:
    parser = _parser()
    for place in [place for place, word in enumerate(words[:-1]) if word == "--zoom"]:  # a number below 0 is no option
        words = [*words[:place], f"--zoom={words[place + 1]}", *words[place + 2 :]]
    try:
        given = parser.parse_args(words)
        _check(parser, given)
    except SystemExit as end:
        return DONE if end.code in (0, None) else WRONG_INPUT

    def draw_all() -> None:
        style = style_named(given.style, given.column)
        if given.paraview:
            add_script(given.directory)
        elif given.field is not None:
            view = View(given.component, given.zoom, given.deform)
            draw_one_field(given.directory, given.format, given.field, given.step or "last", view, style, given.column)
        else:
            draw(given.directory, given.format, style)

    return exit_code_of("plot", given.directory, "drawn", (NoPlace,), draw_all)
