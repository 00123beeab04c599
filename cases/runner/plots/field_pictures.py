"""Pictures of the fields of a step for one- and two-dimensional bodies."""

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize

from cells import Cells, merged
from style import (
    ENERGY_DENSITIES, GHOST, INK, LENGTHS, LINES,
    colour_bar, heading, new_figure, number, round_factor, step_words, unit_for,
)  # fmt: skip

MOST_CELLS = 60_000  # drawn in one panel; more points are averaged over blocks
LOOSE_DAMAGE = 0.35  # a cell this damaged lies at a crack and moves with its point alone
SEAM = 0.75  # width of a cell's own edge [point]: covers the hairline between neighbours
DAMAGE_COLOURS = LinearSegmentedColormap.from_list(  # lightness falls steadily
    "damage", ["#d9dfe5", "#f0b36a", "#d8562f", "#8c1c2b", "#2b0a18"]
)


def exaggeration(reference: np.ndarray, displacement: np.ndarray) -> float:
    """Round factor that makes the largest displacement at most an eighth of the body's size."""
    size = np.linalg.norm(np.ptp(reference, axis=0))
    largest = np.linalg.norm(displacement, axis=1).max()
    return round_factor(size / 8.0 / largest) if largest > 1e-14 * size else 1.0


def exaggeration_words(factor: float) -> str:
    return "deformation to scale" if factor == 1.0 else f"deformation × {number(factor)}"


def limits(values: np.ndarray) -> tuple[float, float]:
    """Smallest and largest value, apart even if the field is constant."""
    low, high = float(values.min()), float(values.max())
    if high - low <= 1e-12 * max(abs(low), abs(high)):
        low, high = min(low, 0.0), max(high, 0.0)
    return (low, high) if high > low else (0.0, 1.0)


def displacement_magnitude(displacement: np.ndarray):
    """Magnitudes in a readable unit, their range from zero, and the colour bar's label."""
    magnitude = np.linalg.norm(displacement, axis=1)
    unit, size = unit_for(magnitude.max(), LENGTHS)
    return magnitude / size, (0.0, magnitude.max() / size or 1.0), f"displacement magnitude [{unit}]"


# ---------------------------------------------------------------------------------------------- 2D


def draw_deformed_plane(results, step):
    """Deformed plate coloured by the magnitude of the displacement."""
    values, value_range, label = displacement_magnitude(step.displacement)
    return _plane(results, step, values, value_range, label, "viridis")


def draw_damaged_plane(results, step):
    """Deformed plate coloured by damage."""
    return _plane(results, step, step.damage, (0.0, 1.0), "damage", DAMAGE_COLOURS)


def _plane(results, step, values, value_range, label, colours):
    factor = exaggeration(results.reference, step.displacement)
    spacing, reference, displacement, damage, values = merged(
        results.reference, results.spacing, MOST_CELLS, step.displacement, step.damage, values
    )
    unit, size = unit_for(np.ptp(reference, axis=0).max(), LENGTHS)
    cells = Cells(reference / size, spacing / size)
    polygons = _quadrilaterals(cells, reference / size, factor * displacement / size, damage)
    still = _quadrilaterals(cells, reference / size, np.zeros_like(reference), damage)

    low = np.minimum(polygons.min(axis=(0, 1)), still.min(axis=(0, 1)))
    high = np.maximum(polygons.max(axis=(0, 1)), still.max(axis=(0, 1)))
    margin = 0.03 * (high - low).max()
    figure, axes, bar_place = _framed(low - margin, high + margin)
    _draw_outline(axes, cells, still)
    collection = PolyCollection(
        polygons, array=values, cmap=colours, norm=Normalize(*value_range),
        edgecolors="face", linewidths=SEAM, zorder=2,
    )  # fmt: skip
    axes.add_collection(collection, autolim=False)
    axes.set_xlabel(f"x [{unit}]")
    axes.set_ylabel(f"y [{unit}]")
    colour_bar(figure, bar_place, collection, label)
    heading(figure, results, [exaggeration_words(factor), *step_words(step),
                              f"{number(len(results.volume))} points"])  # fmt: skip
    return figure


def _quadrilaterals(cells: Cells, reference, displacement, damage) -> np.ndarray:
    """Corners of the deformed squares in the order of going round."""
    return cells.corners(reference, displacement, damage > LOOSE_DAMAGE)[:, [0, 2, 3, 1]]


def _framed(low, high):
    """A figure whose axes show the box in true proportion: figure, axes, place of the colour bar."""
    width_of_body, height_of_body = high - low
    left, right, bottom, top = 1.0, 1.75, 0.75, 1.25  # margins [inch]
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


def _draw_outline(axes, cells: Cells, still: np.ndarray) -> None:
    """Boundary of the reference configuration, filled faintly so that the motion is seen."""
    if cells.is_lattice:
        sides = {(0, -1): [0, 3], (0, 1): [1, 2], (1, -1): [0, 1], (1, 1): [3, 2]}
        edges = [still[cells.neighbours(*side) < 0][:, ends] for side, ends in sides.items()]
        axes.add_collection(
            LineCollection(np.concatenate(edges), colors=GHOST, linewidths=1.4, zorder=3, capstyle="projecting"),
            autolim=False,
        )
    axes.add_collection(PolyCollection(still, facecolors="#f1f3f5", edgecolors="#f1f3f5",
                                       linewidths=SEAM, zorder=0), autolim=False)  # fmt: skip


def draw_plane_fields(results, step):
    """Displacement components and energy density on the reference configuration."""
    spacing, reference, displacement, energy = merged(
        results.reference, results.spacing, MOST_CELLS, step.displacement, step.energy_density
    )
    unit, size = unit_for(np.ptp(reference, axis=0).max(), LENGTHS)
    cells = Cells(reference / size, spacing / size)
    still = _quadrilaterals(cells, reference / size, np.zeros_like(reference), np.zeros(len(reference)))
    length, length_size = unit_for(np.abs(displacement).max(), LENGTHS)
    density, density_size = unit_for(np.percentile(energy, 99.5), ENERGY_DENSITIES)
    panels = [
        (displacement[:, 0] / length_size, f"$u_x$ [{length}]", "displacement in x", None),
        (displacement[:, 1] / length_size, f"$u_y$ [{length}]", "displacement in y", None),
        (energy / density_size, f"[{density}]", "energy density", "inferno"),
    ]

    low, high = still.min(axis=(0, 1)), still.max(axis=(0, 1))
    aspect = (high - low)[1] / (high - low)[0]
    columns = 3 if aspect > 0.8 else 1
    figure, places = _small_multiples(len(panels), columns, aspect)
    for (values, label, title, colours), (place, bar_place) in zip(panels, places):
        axes = figure.add_axes(place)
        norm, colours, extend = _norm(values, colours)
        if cells.is_lattice:
            picture = axes.imshow(cells.image(values), extent=(low[0], high[0], low[1], high[1]), origin="lower",
                                  interpolation="nearest", cmap=colours, norm=norm)  # fmt: skip
        else:
            picture = PolyCollection(still, array=values, cmap=colours, norm=norm)
            axes.add_collection(picture, autolim=False)
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.grid(False)
        axes.set_title(title, loc="left", fontsize=14, color=INK)
        axes.set_ylabel(f"y [{unit}]", labelpad=2)
        if columns > 1 or colours == "inferno":  # the last panel of a column
            axes.set_xlabel(f"x [{unit}]", labelpad=2)
        colour_bar(figure, bar_place, picture, label, extend=extend)
    heading(figure, results, ["fields on the reference configuration", *step_words(step)])
    return figure


def _norm(values: np.ndarray, colours: str | None):
    """Range of colours: diverging about zero if the sign changes; peaks of a few points cut off."""
    low, high = limits(values)
    if colours is None:
        largest = max(abs(low), abs(high))
        if min(abs(low), abs(high)) > 0.02 * largest and low < 0.0 < high:
            return Normalize(-largest, largest), "RdBu_r", "neither"
        return Normalize(low, high), "viridis", "neither"
    peak = float(np.percentile(values, 99.5))
    cut = 0.0 < peak < 0.7 * high
    return Normalize(min(low, 0.0), peak if cut else high), colours, "max" if cut else "neither"


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


def draw_damage_sequence(results, steps):
    """Damage on the deformed plate in up to six steps."""
    factor = exaggeration(results.reference, steps[-1].displacement)
    frames = []
    for step in steps:
        spacing, reference, displacement, damage = merged(
            results.reference, results.spacing, MOST_CELLS // 3, step.displacement, step.damage
        )
        cells = Cells(reference, spacing)
        frames.append((step, _quadrilaterals(cells, reference, factor * displacement, damage), damage))
    low = np.min([polygons.min(axis=(0, 1)) for _, polygons, _ in frames], axis=0)
    high = np.max([polygons.max(axis=(0, 1)) for _, polygons, _ in frames], axis=0)
    aspect = (high - low)[1] / (high - low)[0]
    columns = min(len(frames), 3 if aspect > 0.5 else 2)
    rows = -(-len(frames) // columns)
    panel_width = 14.6 / columns
    panel_height = max(min(panel_width * aspect, 7.5), 0.8)
    width, height = 16.0, 1.5 + rows * (panel_height + 0.45)
    figure = new_figure(width, height)
    for place, (step, polygons, damage) in enumerate(frames):
        x = 0.3 + (place % columns) * panel_width
        y = height - 1.15 - (place // columns + 1) * (panel_height + 0.45)
        axes = figure.add_axes([x / width, y / height, 0.96 * panel_width / width, panel_height / height])
        axes.add_collection(
            PolyCollection(polygons, array=damage, cmap=DAMAGE_COLOURS, norm=Normalize(0, 1),
                           edgecolors="face", linewidths=SEAM), autolim=False,
        )  # fmt: skip
        axes.set_xlim(low[0], high[0])
        axes.set_ylim(low[1], high[1])
        axes.set_aspect("equal")
        axes.axis("off")
        axes.set_title(f"load factor {number(step.load_factor)}", fontsize=13, loc="left")
    mappable = ScalarMappable(Normalize(0, 1), DAMAGE_COLOURS)
    colour_bar(figure, [15.0 / width, 0.3 / height, 0.2 / width, (height - 1.9) / height], mappable, "damage")
    heading(figure, results, ["damage as the load grows", exaggeration_words(factor)])
    return figure


# ---------------------------------------------------------------------------------------------- 1D


def draw_deformed_bar(results, step):
    """Displacement over x, and the bar before and after."""
    factor = exaggeration(results.reference, step.displacement)
    order = np.argsort(results.reference[:, 0])
    x, u = results.reference[order, 0], step.displacement[order, 0]
    damage = step.damage[order]
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
    left, right = _bar_edges(x, u, factor, half, damage)
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


def _bar_edges(x, u, factor, half, damage):
    """Ends of every point's piece of the deformed bar; pieces meet unless the material is broken."""
    places = x + factor * u
    middle = 0.5 * (places[1:] + places[:-1])
    left = np.concatenate([places[:1] - half, middle])
    right = np.concatenate([middle, places[-1:] + half])
    loose = damage > LOOSE_DAMAGE
    return np.where(loose, places - half, left), np.where(loose, places + half, right)


def _draw_bar(axes, left, right, height, size, **looks):
    y = np.full_like(left, height)
    corners = [(left, y - 0.32), (right, y - 0.32), (right, y + 0.32), (left, y + 0.32)]
    pieces = np.stack([np.stack([a / size, b], axis=1) for a, b in corners], axis=1)
    axes.add_collection(PolyCollection(pieces, linewidths=0.5 if len(left) < 400 else 0.0, **looks), autolim=False)
