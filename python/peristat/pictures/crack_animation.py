"""An animation of the damage on the deformed plate beside the load-displacement curve."""

import io

import numpy as np
from matplotlib.animation import PillowWriter
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PathCollection
from matplotlib.colors import Normalize
from matplotlib.path import Path as Outline
from PIL import Image

from .abscissa import abscissas
from .curve_page import wrap_labels
from .fracture_pictures import OPENING
from .plane import crack_lines, deformed_plate, rims
from .ranges import DAMAGE_COLOURS, exaggeration, exaggeration_words
from .reactions import has_reactions, reactions
from .state_words import bond_words, piece_words, step_words
from .style import FACTS, GHOST, INK, LINES, PIECE, colour_bar, heading, new_figure
from .units import FORCES, unit_for

MOST_FRAMES = 60
MOST_INTACT_FRAMES = 12  # frames before the first damage
MOST_CELLS = 20_000
MOST_BYTES = 950_000
COLOURS = 64  # colours for damage, and the same number for everything else
LEVELS = np.linspace(0.0, 1.0, COLOURS)
SECONDS = 7.0
SECONDS_AT_THE_END = 2.0


def crack_animation(results) -> bytes:
    """The steps with fields as a GIF of less than a megabyte."""
    numbers = animated_steps(results)
    last = results.step(numbers[-1])
    stage = _Stage(results, last)
    writer = _SmallGif(fps=max(len(numbers) / SECONDS, 3.0))
    with writer.saving(stage.figure, "crack.gif", stage.figure.dpi):
        for step_number in numbers:
            stage.show(last if step_number == last.number else results.step(step_number))
            writer.grab_frame()
    return writer.content


def animated_steps(results) -> list[int]:
    """At most sixty of the steps with fields, most of them after the first damage, always including the last."""
    numbers = results.step_numbers
    first = next((place for place, step in enumerate(numbers) if results.has_damage(step)), len(numbers) - 1)
    intact = _spread(numbers[:first], MOST_INTACT_FRAMES)
    return intact + _spread(numbers[first:], MOST_FRAMES - len(intact))


def _spread(numbers: list[int], most: int) -> list[int]:
    count = min(len(numbers), most)
    return [numbers[round(i * (len(numbers) - 1) / max(count - 1, 1))] for i in range(count)]


def _by_colour(cells: np.ndarray, damage: np.ndarray) -> list[Outline]:
    """Draws the cells (count x corners x 2) of each colour as one outline, which is much faster than cell by cell."""
    level = np.rint(np.clip(damage, 0.0, 1.0) * (len(LEVELS) - 1)).astype(int)
    closed = np.concatenate([cells, cells[:, :1]], axis=1)
    codes = np.full(closed.shape[1], Outline.LINETO, np.uint8)
    codes[0], codes[-1] = Outline.MOVETO, Outline.CLOSEPOLY
    outlines = []
    for number in range(len(LEVELS)):
        own = closed[level == number].reshape(-1, 2)
        outlines.append(Outline(own, np.resize(codes, len(own))))
    return outlines


class _SmallGif(PillowWriter):
    """All frames share one small palette. Every second frame is dropped as long as the file is too large.

    The palette is white, the damage colours, and the colours of the figure at the start.
    """

    def setup(self, fig, outfile, dpi=None):
        super().setup(fig, outfile, dpi)
        scenery = self._image().quantize(COLOURS, dither=Image.Dither.NONE).getpalette()[: 3 * COLOURS]
        scenery = np.reshape(scenery, (-1, 3))
        scenery = scenery[scenery.min(axis=1) < 248]  # near-white would replace white
        damage = DAMAGE_COLOURS(LEVELS, bytes=True)[:, :3]
        self._palette = Image.new("P", (1, 1))
        self._palette.putpalette(np.concatenate([[[255, 255, 255]], damage, scenery]).ravel().tolist())

    def _image(self) -> Image.Image:
        return Image.fromarray(np.asarray(self.fig.canvas.buffer_rgba())[:, :, :3].copy())

    def grab_frame(self, **_):
        self._frames.append(self._image().quantize(palette=self._palette, dither=Image.Dither.NONE))

    def finish(self):
        frames, duration = self._frames, 1000.0 / self.fps
        while True:
            durations = [round(duration)] * (len(frames) - 1) + [round(1000 * SECONDS_AT_THE_END)]
            file = io.BytesIO()
            frames[0].save(file, format="GIF", save_all=True, append_images=frames[1:], duration=durations, loop=0)
            if file.tell() <= MOST_BYTES or len(frames) <= 2:
                break
            frames, duration = frames[::-1][::2][::-1], 2.0 * duration  # keeps the last frame
        self.content = file.getvalue()


class _Stage:
    """A figure whose fixed parts are drawn once; each step adds the plate, the curve and a line of facts."""

    def __init__(self, results, last):
        self.results = results
        self.factor = exaggeration(results.reference, last, OPENING)
        low, high = self._plate(last).frame()
        width, height = high - low
        scale = min(5.4 / width, 4.2 / height)
        width, height = scale * (high - low)
        has_curve = has_reactions(results)
        total_width = max(0.4 + width + (5.0 if has_curve else 0.4), 8.6)
        total_height = 1.25 + max(height, 2.6) + 1.05
        self.figure = new_figure(total_width, total_height)
        left = 0.4 + 0.5 * (total_width - 5.4 - width) if has_curve else 0.5 * (total_width - width)
        bottom = 1.05 + 0.5 * max(2.6 - height, 0.0)
        self.axes = self.figure.add_axes([left / total_width, bottom / total_height,
                                          width / total_width, height / total_height])  # fmt: skip
        self.axes.set_xlim(low[0], high[0])
        self.axes.set_ylim(low[1], high[1])
        self.axes.axis("off")
        norm = Normalize(0.0, 1.0)
        bar_width = min(width, 3.6)
        bar = [(left + 0.5 * (width - bar_width)) / total_width, 0.68 / total_height, bar_width / total_width,
               0.14 / total_height]  # fmt: skip
        colour_bar(self.figure, bar, ScalarMappable(norm, DAMAGE_COLOURS), "damage")

        self.cells = PathCollection([], facecolors=DAMAGE_COLOURS(LEVELS), linewidths=0.0, antialiased=False,
                                    animated=True)  # fmt: skip
        self.cracks = LineCollection([], colors=INK, linewidths=0.8, animated=True, zorder=3)
        self.pieces = LineCollection([], colors=PIECE, linewidths=1.4, animated=True, zorder=4)
        for collection in (self.cells, self.cracks, self.pieces):
            self.axes.add_collection(collection, autolim=False)
        self.artists = [self.cells, self.cracks, self.pieces]
        if has_curve:
            x = (left + width + 1.25) / total_width
            self._set_the_curve([x, 1.05 / total_height, 3.4 / total_width, max(height, 2.6) / total_height])
        heading(self.figure, results, [])
        self.facts = self.figure.text(0.3 / total_width, 1 - 0.65 / total_height, "", fontsize="small", color=FACTS,
                                      va="top", animated=True)  # fmt: skip
        self.remark = self.figure.text(0.3 / total_width, 1 - 0.92 / total_height, "", fontsize="small", color=PIECE,
                                       va="top", animated=True)  # fmt: skip
        self.figure.canvas.draw()
        self.scenery = self.figure.canvas.copy_from_bbox(self.figure.bbox)
        self.show(last)

    def _plate(self, step):
        return deformed_plate(self.results, step, self.factor, step.damage, limit=MOST_CELLS)

    def _set_the_curve(self, place) -> None:
        """Draws the whole curve faintly and creates the artists for the part up to the current step."""
        axes = self.figure.add_axes(place)
        everything = reactions(self.results)
        over = abscissas(self.results, everything)[0]
        curve = max(over.curves(everything), key=lambda curve: curve.values.max())
        unit, size = unit_for(np.abs(curve.values).max(), FORCES, 1.0)
        self.x, self.y = np.concatenate([[0.0], over.values]), np.concatenate([[0.0], curve.values / size])
        axes.plot(self.x, self.y, color=GHOST, linewidth=1.4, zorder=2)
        axes.set_xlabel(over.label, fontsize="small")
        axes.set_ylabel(f"reaction of {curve.own_label} [{unit}]".replace("$", r"\$"), fontsize="small")
        axes.locator_params(nbins=5)
        wrap_labels(axes)
        (self.line,) = axes.plot([], [], color=LINES[0], linewidth=2.2, animated=True, zorder=3)
        (self.point,) = axes.plot([], [], "o", color=LINES[1], markersize=8, markeredgecolor="white",
                                  markeredgewidth=1.0, animated=True, zorder=4)  # fmt: skip
        self.artists += [self.line, self.point]

    def show(self, step) -> None:
        """Draws a step over the fixed parts."""
        plate = self._plate(step)
        self.cells.set_paths(_by_colour(plate.moved, plate.values))
        self.cracks.set_segments(crack_lines(plate.cells, plate.moved).get_segments())
        self.pieces.set_segments(rims(plate.cells, plate.moved, plate.floating))
        if len(self.artists) > 3:
            steps = self.results.history.get("step", [])
            reached = 1 + np.searchsorted(steps, step.number, side="right")
            self.line.set_data(self.x[:reached], self.y[:reached])
            self.point.set_data(self.x[reached - 1 : reached], self.y[reached - 1 : reached])
        mode = {"newton": "Newton's method", "relaxation": "relaxation"}.get(step.mode)
        words = [exaggeration_words(self.factor), step_words(self.results, step)[0], *bond_words(self.results, step)]
        self.facts.set_text("  ·  ".join(words + ([mode] if mode else [])))
        self.remark.set_text(piece_words(step) if step.floating.any() else "")
        canvas = self.figure.canvas
        canvas.restore_region(self.scenery)
        for artist in self.artists:
            artist.axes.draw_artist(artist)
        for text in (self.facts, self.remark):
            self.figure.draw_artist(text)
