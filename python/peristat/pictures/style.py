"""Style that all pictures share: fonts, colours, units, titles."""

import contextlib
import io

import matplotlib
import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch

INK = "#22282e"  # text and axes
FAINT = "#8a949e"  # secondary text
GHOST = "#c3cad1"  # reference configuration
GRID = "#e6e9ec"
WARNING = "#b4531b"
PIECE = "#1668b8"  # detached pieces
LINES = ["#1f6f9f", "#d1603d", "#3f8f5f", "#7a5aa6", "#b58a1b", "#4d5964"]

DOTS_PER_INCH = 100

SETTINGS = {
    "font.family": "DejaVu Sans",
    "font.size": 13,
    "axes.edgecolor": "#9aa3ab",
    "axes.labelcolor": INK,
    "axes.linewidth": 0.9,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 1.0,
    "text.color": INK,
    "xtick.color": "#9aa3ab",
    "ytick.color": "#9aa3ab",
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "legend.frameon": False,
    "hatch.linewidth": 1.2,
    # Axes show no common factor, which is easily overlooked: each has a unit that suits its values.
    "axes.formatter.limits": (-7, 8),
    "axes.formatter.useoffset": False,
}

PREFIXES = (("T", 1e12), ("G", 1e9), ("M", 1e6), ("k", 1e3), ("", 1.0), ("m", 1e-3), ("µ", 1e-6), ("n", 1e-9),
            ("p", 1e-12), ("f", 1e-15))  # fmt: skip


def scaled(unit: str):
    """The unit with all prefixes and their sizes, the largest first."""
    return tuple((prefix + unit, size) for prefix, size in PREFIXES)


LENGTHS = (("km", 1e3), *scaled("m")[4:])
FORCES, ENERGIES, ENERGY_DENSITIES, STRESSES = scaled("N"), scaled("J"), scaled("J/m³"), scaled("Pa")
UNITS = {"m": LENGTHS, "N": FORCES, "J": ENERGIES, "J/m3": ENERGY_DENSITIES, "Pa": STRESSES}  # as results.h5 spells them


def units_of(unit: str):
    """The units for values that a results folder has in `unit`; a dimensionless number has none."""
    return UNITS.get(unit, (("" if unit == "1" else unit, 1.0),))


def unit_for(largest: float, units, least: float = 0.3) -> tuple[str, float]:
    """Name and size of the largest unit in which the largest value is at least `least`."""
    for name, size in units:
        if largest >= least * size:
            return name, size
    return units[-1] if largest > 1e-30 else next(unit for unit in units if unit[1] == 1.0)


def round_factor(wanted: float) -> float:
    """Largest of 1, 2, 5, 10, 20, 50, ... that does not exceed the wanted factor; at least 1."""
    if not np.isfinite(wanted) or wanted <= 1.0:
        return 1.0
    decade = 10.0 ** np.floor(np.log10(wanted))
    return max(step * decade for step in (1.0, 2.0, 5.0) if step * decade <= wanted * (1 + 1e-12))


def number(value: float, digits: int = 4) -> str:
    """A number in readable form: 7 500, 0.25, 1.2e-7."""
    if value == int(value) and abs(value) < 1e9:
        return f"{int(value):,}".replace(",", "\u2009")
    return f"{value:.{digits}g}"


def load_axis(values) -> tuple[str, float]:
    """Label of an axis of load factors, and the divisor of its values: a load in metres has tiny ones."""
    largest = float(np.abs(values).max(initial=0.0))
    if largest == 0.0 or 1e-2 <= largest < 1e5:
        return "load factor", 1.0
    power = 3 * int(np.floor(np.log10(largest) / 3.0))
    return f"load factor [$10^{{{power}}}$]", 10.0**power


@contextlib.contextmanager
def own_settings():
    """Matplotlib's settings are those of the pictures, whatever the caller's are; its backend stays."""
    with matplotlib.rc_context():
        matplotlib.rcdefaults()
        matplotlib.rcParams.update(SETTINGS)
        yield


class Picture(Figure):
    """A figure that looks the same wherever it is drawn: axes make their ticks when they are drawn, from the settings."""

    def draw(self, renderer):
        with own_settings():
            super().draw(renderer)

    def savefig(self, *words, **options):
        with own_settings():
            super().savefig(*words, **options)

    def _repr_png_(self) -> bytes:
        """Notebooks show the picture, also those that have not loaded pyplot."""
        file = io.BytesIO()
        self.savefig(file, format="png")
        return file.getvalue()


def new_figure(width: float, height: float) -> Picture:
    """An empty white figure; sizes in inches (100 dots each). It is to be filled under `own_settings`."""
    figure = Picture(figsize=(width, height), dpi=DOTS_PER_INCH, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def heading(figure: Figure, results, words: list[str]) -> None:
    """Title and a line of facts below it; an incomplete run is labelled in colour."""
    width, height = figure.get_size_inches()
    completed = results.status == "completed"
    room = int((width - (0.7 if completed else 2.9)) / 0.17)  # characters of 0.17 inch
    title = results.title if len(results.title) <= room else results.title[: room - 1] + "…"
    left = 0.35 / width
    figure.text(left, 1 - 0.30 / height, title, fontsize=19, fontweight="bold", va="top",
                parse_math=False)  # fmt: skip
    figure.text(left, 1 - 0.74 / height, "  ·  ".join(words), fontsize=13, color="#5b656e", va="top")
    if not completed:
        remark = {"not_converged": "did not converge"}.get(results.status, results.status)
        figure.text(1 - left, 1 - 0.36 / height, f"run {remark}", fontsize=13, color=WARNING,
                    va="top", ha="right", fontweight="bold")  # fmt: skip


TIMES = (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6), ("ns", 1e-9))


def time_unit(longest: float) -> tuple[str, float]:
    """The unit for a time [s], and its size."""
    return next(((unit, size) for unit, size in TIMES if abs(longest) >= size), TIMES[-1 if longest else 0])


def load_words(load: float, moves: bool, reach: str = "") -> str:
    """A load factor, or the time of a motion."""
    if not moves:
        return f"load factor {reach}{number(load)}"
    unit, size = time_unit(load)
    return f"time {reach}{number(load / size)} {unit}"


def step_words(step) -> list[str]:
    """Load factor or time and step as facts for a heading."""
    return [load_words(step.load_factor, step.mode == "dynamics"), f"step {step.number}"]


def bond_words(results, step) -> list[str]:
    """Number of bonds broken up to a step as a fact for a heading; nothing if unknown."""
    broken = results.in_history(step.number, "broken_bonds")
    return [] if broken is None else [f"{number(broken)} broken bond{'s' * (broken != 1)}"]


def piece_words(step) -> str:
    """Number of detached pieces, and of their points."""
    pieces = len(np.unique(np.rint(step.fragment[step.floating])))
    points = int(step.floating.sum())
    return f"{number(pieces)} floating piece{'s' * (pieces != 1)}: {number(points)} point{'s' * (points != 1)}"


def piece_legend(figure: Figure, words: str, side: str = "left", hatch: str | None = "////") -> None:
    """Explains the marks of floating pieces in a lower corner."""
    mark = Patch(facecolor="none", edgecolor=PIECE, linewidth=1.4, hatch=hatch, label=words)
    margin = 0.25 / figure.get_size_inches()[0]
    figure.legend(handles=[mark], loc=f"lower {side}", fontsize=12, borderaxespad=0.4,
                  bbox_to_anchor=(margin if side == "left" else 1.0 - margin, 0.0))  # fmt: skip


def colour_bar(figure: Figure, place, mappable, label: str, **options):
    """A slim colour bar in the rectangle `place` (figure fractions)."""
    axes = figure.add_axes(place)
    bar = figure.colorbar(mappable, cax=axes, **options)
    bar.outline.set_visible(False)
    bar.set_label(label, labelpad=10)
    axes.grid(False)
    axes.tick_params(length=4)
    return bar
