"""Pictures of the fields of a step for one- and two-dimensional bodies."""

from dataclasses import dataclass

import numpy as np
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize

from .cells import Cells
from .cloud_cells import CloudCells
from .separations import cells_of
from .style import (
    ENERGY_DENSITIES, FAINT, GHOST, INK, LENGTHS, LINES, PIECE,
    colour_bar, heading, new_figure, number, piece_legend, piece_words, round_factor, step_words, unit_for,
)  # fmt: skip

MOST_CELLS = 60_000  # drawn in one panel; more points are averaged over blocks
CLIPPED_SHARE = 99.5  # percentile of the energy density at which its colour range may end
FLIGHT = 0.25  # distance, as a share of the body's size, that floating pieces may lie outside it in a picture
SEAM = 0.75  # width of a cell's own edge [point]; it covers the hairline between neighbours
DAMAGE_COLOURS = LinearSegmentedColormap.from_list(  # lightness decreases monotonically
    "damage", ["#d9dfe5", "#f0b36a", "#d8562f", "#8c1c2b", "#2b0a18"]
)


def exaggeration(reference: np.ndarray, step, share: float = 0.125) -> float:
    """Round factor that limits the largest displacement of the held body to a share of its size."""
    held = step.displacement if step.floating.all() else step.displacement[~step.floating]
    size = np.linalg.norm(np.ptp(reference, axis=0))
    largest = np.linalg.norm(held, axis=1).max()
    return round_factor(size * share / largest) if largest > 1e-14 * size else 1.0


def exaggeration_words(factor: float) -> str:
    return "deformation to scale" if factor == 1.0 else f"deformation × {number(factor)}"


def limits(values: np.ndarray) -> tuple[float, float]:
    """Smallest and largest value, widened if the field is constant."""
    low, high = float(values.min()), float(values.max())
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        low, high = min(low, 0.0), max(high, 0.0)
    return (low, high) if high > low else (0.0, 1.0)


def held_values(values: np.ndarray, floating: np.ndarray) -> np.ndarray:
    """Values of the held body alone, which set the scale; all values if the whole body floats."""
    return values if floating.all() else values[~floating]


def displacement_magnitude(step):
    """Magnitudes in a readable unit, their range from zero to the held body's largest, and the colour bar's label."""
    magnitude = np.linalg.norm(step.displacement, axis=1)
    largest = held_values(magnitude, step.floating).max()
    unit, size = unit_for(largest, LENGTHS)
    return magnitude / size, (0.0, largest / size or 1.0), f"displacement magnitude [{unit}]"


def beyond(values: np.ndarray, low: float, high: float) -> str:
    """The ends of a colour bar at which values lie outside its range, apart from round-off."""
    slack = 1e-9 * (high - low)
    ends = (bool(values.min() < low - slack), bool(values.max() > high + slack))
    return {(False, False): "neither", (True, False): "min", (False, True): "max", (True, True): "both"}[ends]


# ---------------------------------------------------------------------------------------------- 2D


@dataclass
class Plate:
    """The cells of a deformed plate; fewer than the points if these are too many to draw."""

    cells: Cells | CloudCells
    still: np.ndarray  # corners in the reference configuration: count x most x 2
    moved: np.ndarray  # corners after the deformation
    floating: np.ndarray  # whether the cell belongs to a detached piece
    values: np.ndarray  # values that colour the cells

    def frame(self) -> tuple[np.ndarray, np.ndarray]:
        """Corners of a box around the plate in both configurations; pieces that flew far stay outside."""
        low, high = self.still.min(axis=(0, 1)), self.still.max(axis=(0, 1))
        air = FLIGHT * (high - low).max()
        shown = self.moved
        if self.floating.any():
            near = ((self.moved > low - air) & (self.moved < high + air)).all(axis=(1, 2))
            shown = self.moved[~self.floating | near]
        both = np.concatenate([self.still, shown])
        return both.min(axis=(0, 1)), both.max(axis=(0, 1))


def deformed_plate(results, step, factor: float, values: np.ndarray, size: float = 1.0,
                   limit: int = MOST_CELLS) -> Plate:  # fmt: skip
    """Cells with displacements times a factor; lengths are in units of `size` metres."""
    cells, reference, displacement, floating, loose, values = cells_of(results, step, limit, size, values)
    still = cells.outlines(reference, np.zeros_like(reference), loose)
    moved = cells.outlines(reference, factor * displacement, loose)
    return Plate(cells, still, moved, floating, values)


def draw_deformed_plane(results, step):
    """Deformed plate coloured by the magnitude of the displacement."""
    values, value_range, label = displacement_magnitude(step)
    factor = exaggeration(results.reference, step)
    figure, axes, plate = draw_plane(results, step, factor, values, value_range, label, "viridis")
    mark_pieces(figure, axes, step, plate)
    return figure


def draw_plane(results, step, factor, values, value_range, label, colours, words=()):
    """Deformed plate coloured by a value per point, with extra words in the heading: figure, axes, plate."""
    unit, size = unit_for(np.ptp(results.reference, axis=0).max(), LENGTHS)
    plate = deformed_plate(results, step, factor, values, size)
    low, high = plate.frame()
    margin = 0.03 * (high - low).max()
    figure, axes, bar_place = framed(low - margin, high + margin)
    _draw_outline(axes, plate)
    collection = PolyCollection(
        plate.moved, array=plate.values, cmap=colours, norm=Normalize(*value_range),
        edgecolors="face", linewidths=SEAM, zorder=2,
    )  # fmt: skip
    axes.add_collection(collection, autolim=False)
    axes.add_collection(crack_lines(plate.cells, plate.moved), autolim=False)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    colour_bar(figure, bar_place, collection, label, extend=beyond(plate.values, *value_range))
    heading(figure, results, [exaggeration_words(factor), *step_words(step), *words,
                              f"{number(len(results.volume))} points"])  # fmt: skip
    return figure, axes, plate


def framed(low, high, right: float = 1.75):
    """A figure whose axes show the box in true proportion: figure, axes, place of the colour bar.

    right  margin for the colour bar [inch]
    """
    width_of_body, height_of_body = high - low
    left, bottom, top = 1.0, 0.75, 1.25  # margins [inch]
    width = 16.0 - left - right
    height = width * height_of_body / width_of_body
    if height > 9.5:
        width, height = width * 9.5 / height, 9.5
    total_width = max(left + width + right, 9.0)
    total_height = bottom + max(height, 1.2) + top
    figure = new_figure(total_width, total_height)
    body_left = left + 0.5 * (total_width - left - width - right)
    axes = figure.add_axes([body_left / total_width, bottom / total_height,
                            width / total_width, max(height, 1.2) / total_height])  # fmt: skip
    axes.set_aspect("equal")
    axes.set_xlim(low[0], high[0])
    axes.set_ylim(low[1], high[1])
    axes.grid(False)
    bar = [(body_left + width + 0.3) / total_width, (bottom + 0.03 * height) / total_height,
           0.22 / total_width, max(0.94 * height, 1.2) / total_height]  # fmt: skip
    return figure, axes, bar


def _draw_outline(axes, plate: Plate) -> None:
    """Outline of the reference configuration, filled faintly so that the motion is visible."""
    everybody = np.ones(len(plate.still), dtype=bool)
    axes.add_collection(
        LineCollection(rims(plate.cells, plate.still, everybody), colors=GHOST, linewidths=1.4, zorder=3,
                       capstyle="projecting"), autolim=False,
    )  # fmt: skip
    axes.add_collection(PolyCollection(plate.still, facecolors="#f1f3f5", edgecolors="#f1f3f5",
                                       linewidths=SEAM, zorder=0), autolim=False)  # fmt: skip


def rims(cells: Cells | CloudCells, corners: np.ndarray, members: np.ndarray) -> np.ndarray:
    """Sides between member cells and the rest or the outside: count x 2 ends x 2."""
    outer = lambda other: members & ((other < 0) | ~members[other])
    return np.concatenate([corners[outer(other)][:, ends] for ends, other, _ in cells.sides()])


def crack_lines(cells: Cells | CloudCells, corners: np.ndarray, colour: str = INK) -> LineCollection:
    """Both faces of every crack: sides between cells that have been parted."""
    edges = [corners[parted][:, ends] for ends, _, parted in cells.sides()]
    return LineCollection(np.concatenate(edges), colors=colour, linewidths=0.9, capstyle="projecting", zorder=3)


def mark_pieces(figure, axes, step, plate: Plate) -> None:
    """Hatches and outlines detached pieces, and prints their number."""
    if not plate.floating.any():
        return
    axes.add_collection(
        PolyCollection(plate.moved[plate.floating], facecolors="none", edgecolors=PIECE, hatch="////",
                       linewidths=0.0, zorder=4), autolim=False,
    )  # fmt: skip
    axes.add_collection(
        LineCollection(rims(plate.cells, plate.moved, plate.floating), colors=PIECE, linewidths=1.6,
                       capstyle="projecting", zorder=5), autolim=False,
    )  # fmt: skip
    low, high = np.array([axes.get_xlim(), axes.get_ylim()]).T
    outside = ((plate.moved < low) | (plate.moved > high)).any()
    piece_legend(figure, piece_words(step) + ", in part outside the picture" * bool(outside))


def displacement_panels(displacement, floating):
    """Values, label, title and colours of each component in its own unit; 0 for components that are round-off."""
    largest = np.abs(held_values(displacement, floating)).max()
    panels = []
    for axis, values in zip("xy", displacement.T):
        own = np.abs(held_values(values, floating)).max()
        if own < 1e-9 * largest:
            values, own = np.zeros_like(values), largest
        length, size = unit_for(own, LENGTHS)
        panels.append((values / size, f"$u_{axis}$ [{length}]", f"displacement in {axis}", None))
    return panels


def draw_plane_fields(results, step):
    """Displacement components and energy density on the reference configuration."""
    unit, size = unit_for(np.ptp(results.reference, axis=0).max(), LENGTHS)
    cells, reference, displacement, floating, loose, energy = cells_of(
        results, step, MOST_CELLS, size, step.energy_density
    )
    displacement = displacement * size
    still = cells.outlines(reference, np.zeros_like(reference), loose)
    density, density_size = unit_for(np.percentile(held_values(energy, floating), CLIPPED_SHARE), ENERGY_DENSITIES)
    panels = [
        *displacement_panels(displacement, floating),
        (energy / density_size, f"[{density}]", "energy density", "inferno"),
    ]

    low, high = still.min(axis=(0, 1)), still.max(axis=(0, 1))
    aspect = (high - low)[1] / (high - low)[0]
    columns = 3 if aspect > 0.8 else 1
    figure, places = _small_multiples(len(panels), columns, aspect)
    for (values, label, title, colours), (place, bar_place) in zip(panels, places):
        axes = figure.add_axes(place)
        held = held_values(values, floating)
        norm, colours = _norm(held, colours)
        extend = beyond(values, norm.vmin, norm.vmax)
        if cells.is_image:
            picture = axes.imshow(cells.image(values), extent=(low[0], high[0], low[1], high[1]), origin="lower",
                                  interpolation="nearest", cmap=colours, norm=norm)  # fmt: skip
        else:
            picture = PolyCollection(still, array=values, cmap=colours, norm=norm, edgecolors="face", linewidths=SEAM)
            axes.add_collection(picture, autolim=False)
        axes.add_collection(crack_lines(cells, still, FAINT if colours == "inferno" else INK), autolim=False)
        if floating.any():
            axes.add_collection(LineCollection(rims(cells, still, floating), colors=PIECE, linewidths=1.4, zorder=4),
                                autolim=False)  # fmt: skip
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.grid(False)
        note = f" (up to {number(float(held.max()))}, colours end at {number(norm.vmax)})" if held.max() > norm.vmax else ""
        axes.set_title(title + note, loc="left", fontsize=14 if not note else 12, color=INK)
        axes.set_ylabel(f"y [{unit}]", labelpad=2)
        if columns > 1 or colours == "inferno":  # the last panel of a column
            axes.set_xlabel(f"x [{unit}]", labelpad=2)
        colour_bar(figure, bar_place, picture, label, extend=extend)
    if floating.any():
        piece_legend(figure, piece_words(step) + ", loose: outside the scale of colours", hatch=None)
    heading(figure, results, ["fields on the reference configuration", *step_words(step)])
    return figure


def _norm(values: np.ndarray, colours: str | None):
    """Colour range and map: diverging about zero if the sign changes; peaks of a few points are cut off."""
    low, high = limits(values)
    if colours is None:
        largest = max(abs(low), abs(high))
        if min(abs(low), abs(high)) > 0.02 * largest and low < 0.0 < high:
            return Normalize(-largest, largest), "RdBu_r"
        return Normalize(low, high), "viridis"
    peak = float(np.percentile(values, CLIPPED_SHARE))
    return Normalize(min(low, 0.0), peak if 0.0 < peak < 0.7 * high else high), colours


def _small_multiples(count: int, columns: int, aspect: float):
    """A figure and the places of `count` panels with their colour bars."""
    rows = -(-count // columns)
    left, bar_space, bottom, top, gap = 0.85, 1.45, 0.45 if columns == 1 else 0.65, 0.45, 1.15
    panel_width = 16.0 / columns - left - bar_space
    panel_height = panel_width * aspect
    most = 9.0 if rows == 1 else 3.8
    if panel_height > most:
        panel_width, panel_height = panel_width * most / panel_height, most
    panel_height = max(panel_height, 0.8)
    cell_width, cell_height = left + panel_width + bar_space, bottom + panel_height + top
    width, height = max(columns * cell_width, 9.0), gap + 0.15 + rows * cell_height
    figure = new_figure(width, height)
    places = []
    for panel in range(count):
        x = (panel % columns) * cell_width + left
        y = height - gap - (panel // columns + 1) * cell_height + bottom
        places.append(([x / width, y / height, panel_width / width, panel_height / height],
                       [(x + panel_width + 0.2) / width, y / height, 0.18 / width, panel_height / height]))  # fmt: skip
    return figure, places


# ---------------------------------------------------------------------------------------------- 1D


def draw_deformed_bar(results, step):
    """Displacement over x, and the bar before and after."""
    factor = exaggeration(results.reference, step)
    order = np.argsort(results.reference[:, 0])
    x, u = results.reference[order, 0], step.displacement[order, 0]
    cells, *_, loose = cells_of(results, step, len(x), 1.0)
    unit, size = unit_for(np.ptp(x), LENGTHS)
    length, length_size = unit_for(np.abs(u).max(), LENGTHS)
    half = 0.5 * results.spacing

    figure = new_figure(16.0, 7.6)
    curve = figure.add_axes([0.075, 0.42, 0.895, 0.41])
    curve.axhline(0.0, color=GHOST, linewidth=1.4, zorder=1)
    curve.plot(x / size, u / length_size, color=LINES[0], linewidth=1.6, zorder=2)
    if len(x) <= 400:
        curve.plot(x / size, u / length_size, "o", color=LINES[0], markersize=np.clip(500 / len(x), 3, 7),
                   markeredgecolor="white", markeredgewidth=0.6, zorder=3)  # fmt: skip
    curve.set_ylabel(f"displacement [{length}]")
    curve.tick_params(labelbottom=False)

    bars = figure.add_axes([0.075, 0.11, 0.895, 0.26], sharex=curve)
    free = [(cells.parted(0, sign) | loose)[order] for sign in (-1, 1)]
    left, right = _bar_edges(x, u, factor, half, *free)
    magnitude = np.abs(u) / length_size
    norm = Normalize(0.0, magnitude.max() or 1.0)
    _draw_bar(bars, x - half, x + half, 1.0, size, facecolors="#e9ecef", edgecolors="#c3cad1")
    _draw_bar(bars, left, right, 0.0, size, array=magnitude, cmap="viridis", norm=norm, edgecolors="white")
    bars.set_ylim(-0.5, 1.5)
    bars.set_yticks([1.0, 0.0], ["reference", "deformed"])
    bars.grid(False)
    bars.spines["left"].set_visible(False)
    bars.tick_params(axis="y", length=0)
    bars.set_xlabel(f"x [{unit}]")
    lowest, highest = min(left.min(), x[0] - half), max(right.max(), x[-1] + half)
    margin = 0.015 * (highest - lowest)
    bars.set_xlim((lowest - margin) / size, (highest + margin) / size)
    heading(figure, results, [exaggeration_words(factor), *step_words(step), f"{number(len(x))} points"])
    return figure


def _bar_edges(x, u, factor, half, free_left, free_right):
    """Ends of every point's piece of the deformed bar; pieces meet unless they have been parted."""
    places = x + factor * u
    middle = 0.5 * (places[1:] + places[:-1])
    left = np.concatenate([places[:1] - half, middle])
    right = np.concatenate([middle, places[-1:] + half])
    return np.where(free_left, places - half, left), np.where(free_right, places + half, right)


def _draw_bar(axes, left, right, height, size, **looks):
    y = np.full_like(left, height)
    corners = [(left, y - 0.32), (right, y - 0.32), (right, y + 0.32), (left, y + 0.32)]
    pieces = np.stack([np.stack([a / size, b], axis=1) for a, b in corners], axis=1)
    axes.add_collection(PolyCollection(pieces, linewidths=0.5 if len(left) < 400 else 0.0, **looks), autolim=False)
