"""Style that all pictures share: sizes, letters, colours, headings.

The code of a picture measures in inches of a page on which normal letters have LETTERS points. A style says how wide
that page is, and how large its letters become when it is printed; lines and marks shrink with them. So one code draws a
picture for the screen, for a column of a paper and for a slide.
"""

import contextlib
import io
from collections.abc import Iterator
from contextvars import ContextVar
from dataclasses import dataclass

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Patch
from matplotlib.textpath import TextToPath
from matplotlib.ticker import MaxNLocator

INK = "#22282e"  # text and axes
FACTS = "#5b656e"
FAINT = "#8a949e"  # secondary text
GHOST = "#c3cad1"  # reference configuration
GRID = "#e6e9ec"
WARNING = "#b4531b"
PIECE = "#1668b8"  # detached pieces
LINES = ["#1f6f9f", "#d1603d", "#3f8f5f", "#7a5aa6", "#b58a1b", "#4d5964"]

LETTERS = 13.0  # points of normal letters on the page of the code; small ones have five sixths of it
MILLIMETRE = 1.0 / 25.4  # [inch]


@dataclass(frozen=True)
class Style:
    """Size of a page, and of the letters on it."""

    name: str
    width: float  # [inch]
    height: float  # most of a picture [inch]
    letters: float  # size of normal letters [point]
    dots: int  # per inch
    has_title: bool = False
    has_facts: bool = False
    may_be_narrower: bool = False  # a picture of a tall body has not the whole width

    @property
    def scale(self) -> float:
        return self.letters / LETTERS


SCREEN = Style("screen", 16.0, 14.0, 17.0, 100, has_title=True, has_facts=True, may_be_narrower=True)
WIDE = Style("wide", 16.0, 30.0, LETTERS, 100, has_title=True, has_facts=True)  # small letters, for many panels
TALK = Style("talk", 13.33, 7.5, 20.0, 120, has_facts=True)  # a slide
# 84 mm and 174 mm are the widths of most journals, or a little below. The smallest letters have 6.25 points.
PAPER = {"single": Style("paper", 84.0 * MILLIMETRE, 150.0 * MILLIMETRE, 7.5, 500),
         "double": Style("paper", 174.0 * MILLIMETRE, 180.0 * MILLIMETRE, 7.5, 500)}  # fmt: skip
STYLES = ("screen", "paper", "talk")
COLUMNS = tuple(PAPER)

_style: ContextVar[Style] = ContextVar("style", default=SCREEN)


def style_named(name: str, column: str | None = None) -> Style:
    """The style of a name and, for a paper, of a column: one of STYLES and COLUMNS."""
    return {"screen": SCREEN, "talk": TALK, "paper": PAPER[column or "single"]}[name]


def present_style() -> Style:
    return _style.get()


def page_width() -> float:
    """Width of the page of the present style [inch of the code]."""
    return _style.get().width / _style.get().scale


def page_height() -> float:
    """Largest height of a picture in the present style [inch of the code]."""
    return _style.get().height / _style.get().scale


def is_narrow() -> bool:
    """Whether two panels do not fit side by side."""
    return page_width() < 8.0


def points(size: float) -> float:
    """Width of a line, or size of a mark, in the present style [point]."""
    return size * _style.get().scale


def _settings(style: Style) -> dict:
    scale = style.scale
    return {
        "font.family": "DejaVu Sans",
        "font.size": style.letters,
        "axes.titlesize": "medium",
        "axes.edgecolor": "#9aa3ab",
        "axes.labelcolor": INK,
        "axes.labelpad": 4.0 * scale,
        "axes.linewidth": 0.9 * scale,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": GRID,
        "grid.linewidth": scale,
        "lines.linewidth": 1.8 * scale,
        "text.color": INK,
        "xtick.color": "#9aa3ab",
        "ytick.color": "#9aa3ab",
        "xtick.labelcolor": INK,
        "ytick.labelcolor": INK,
        **{f"{axis}tick.{kind}.{what}": size * scale for axis in "xy" for kind, what, size in (
            ("major", "size", 4.0), ("major", "width", 0.9), ("major", "pad", 4.0),
            ("minor", "size", 2.0), ("minor", "width", 0.7))},
        "legend.frameon": False,
        "legend.fontsize": "small",
        "hatch.linewidth": 1.2 * scale,
        # Axes show no common factor, which is easily overlooked: each has a unit that suits its values.
        "axes.formatter.limits": (-7, 8),
        "axes.formatter.useoffset": False,
        "pdf.fonttype": 42,  # journals refuse others
        "svg.hashsalt": "peristat",
    }  # fmt: skip


@contextlib.contextmanager
def own_settings(style: Style = SCREEN) -> Iterator[None]:
    """Matplotlib's settings are those of the pictures, whatever the caller's are; its backend stays."""
    before = _style.set(style)
    try:
        with matplotlib.rc_context():
            matplotlib.rcdefaults()
            matplotlib.rcParams.update(_settings(style))
            yield
    finally:
        _style.reset(before)


class Picture(Figure):
    """A figure that looks the same wherever it is drawn: axes make their ticks when they are drawn, from the settings.

    caption  title and facts, which a style without a heading leaves to the text around the picture
    """

    def __init__(self, *words, style: Style = SCREEN, **options):
        super().__init__(*words, **options)
        self.style = style
        self.caption = ""

    def draw(self, renderer):
        with own_settings(self.style):
            super().draw(renderer)

    def savefig(self, *words, **options):
        with own_settings(self.style):
            super().savefig(*words, **options)

    def _repr_png_(self) -> bytes:
        """Notebooks show the picture, also those that have not loaded pyplot."""
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def new_figure(width: float, height: float) -> Picture:
    """An empty white figure in the present style [inches of the code]. It is to be filled under `own_settings`."""
    style = _style.get()
    figure = Picture(figsize=(width * style.scale, height * style.scale), dpi=style.dots, facecolor="white", style=style)
    FigureCanvasAgg(figure)
    return figure


def size_of(figure: Figure) -> np.ndarray:
    """Width and height of a figure [inches of the code]."""
    return figure.get_size_inches() / _style.get().scale


def text_width(text: str, size: str = "medium", weight: str = "normal") -> float:
    """Width of a line of text [inches of the code]."""
    font = FontProperties(size=size, weight=weight)
    return TextToPath().get_text_width_height_descent(text, font, ismath=False)[0] / 72.0 / _style.get().scale


# ---------------------------------------------------------------------------------------- headings

MARGIN = 0.3  # beside a heading
LINE = 0.27  # height of a line of facts
SEPARATOR = "  ·  "


def _lines(words: list[str], width: float) -> list[str]:
    """Facts in as few lines as fit the width."""
    lines: list[str] = []
    for word in words:
        longer = SEPARATOR.join([*lines[-1:], word])
        if lines and text_width(longer, "small") <= width:
            lines[-1] = longer
        else:
            lines.append(word)
    return lines


def room_above(words: list[str], width: float) -> float:
    """Height that the heading of a figure takes, with the space below it."""
    style = _style.get()
    facts = len(_lines(words, width - 2 * MARGIN)) * LINE if style.has_facts else 0.0
    return 0.2 + 0.45 * style.has_title + facts + 0.2 * style.has_facts


def heading(figure: Picture, results, words: list[str]) -> None:
    """Title and lines of facts below it, as far as the style has them; an incomplete run is labelled in colour."""
    style, (width, height) = _style.get(), size_of(figure)
    remark = {"completed": "", "not_converged": "run did not converge"}.get(results.status, f"run {results.status}")
    figure.caption = SEPARATOR.join([results.title, *words, *([remark] if remark else [])])
    left, top = MARGIN / width, 0.2
    if style.has_title:
        room = width - 2 * MARGIN - (text_width(remark, weight="bold") + 0.3 if remark else 0.0)
        title = results.title
        while len(title) > 1 and text_width(title, "x-large", "bold") > room:
            title = title[: int(0.95 * len(title))].rstrip("… ") + "…"
        figure.text(left, 1 - top / height, title, fontsize="x-large", fontweight="bold", va="top", parse_math=False)
        if remark:
            figure.text(1 - left, 1 - (top + 0.06) / height, remark, color=WARNING, va="top", ha="right",
                        fontweight="bold")  # fmt: skip
        top += 0.45
    for line in _lines(words, width - 2 * MARGIN) if style.has_facts else []:
        figure.text(left, 1 - top / height, line.replace("$", r"\$"), fontsize="small", color=FACTS, va="top")
        top += LINE


# ------------------------------------------------------------------------------ legends, colour bars


def piece_legend(figure: Figure, words: str, side: str = "left", hatch: str | None = "////") -> None:
    """Explains the marks of floating pieces in a lower corner."""
    mark = Patch(facecolor="none", edgecolor=PIECE, linewidth=points(1.4), hatch=hatch, label=words)
    margin = 0.25 / size_of(figure)[0]
    figure.legend(handles=[mark], loc=f"lower {side}", borderaxespad=0.4,
                  bbox_to_anchor=(margin if side == "left" else 1.0 - margin, 0.0))  # fmt: skip


def colour_bar(figure: Figure, place, mappable, label: str, **options):
    """A slim colour bar in the rectangle `place` (figure fractions), upright or lying as the rectangle is."""
    axes = figure.add_axes(place)
    width, height = np.array(place[2:]) * size_of(figure)
    if "ticks" not in options:
        room = width / 0.8 if width > height else height / 0.35  # of a tick's label
        options["ticks"] = MaxNLocator(nbins=int(np.clip(room, 1, 8)), steps=[1, 2, 2.5, 5, 10])
    bar = figure.colorbar(mappable, cax=axes, orientation="horizontal" if width > height else "vertical", **options)
    bar.outline.set_visible(False)
    bar.set_label(label, labelpad=points(6))
    axes.grid(False)
    return bar
