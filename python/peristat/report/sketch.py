"""A drawing of the model: the body, its supports and loads, and cracks that are there from the start, as SVG."""

import numpy as np

from ..pictures.cells import FACES, Cells, merged
from ..pictures.mesh_cells import element_cells
from ..pictures.voronoi import Polygons
from .conditions import Condition, conditions
from .markup import escaped

WIDTH, MARGIN = 600.0, 70.0  # in units of the drawing
HIGHEST = 1.3  # height over width
MOST_CELLS = {1: 2000, 2: 2500, 3: 1500}
MOST_MARKS = 2000  # points of a cloud
ARROW = 46.0
COLOURS = 6
VIEW = np.array([[0.824, 0.0, -0.566], [-0.196, 0.938, -0.286], [0.531, 0.347, 0.773]])  # right, up, towards the eye


def sketch(results) -> str:
    """The drawing and what it shows in words."""
    acting = conditions(results)
    drawing = _Drawing(results, acting)
    rows = []
    for place, condition in enumerate(acting):
        key = f'<span class="key" style="background:{_colour(place)}"></span>' if len(condition.points) else ""
        rows.append(f"<li>{key}{escaped(condition.words)}</li>")
    cracks = len(results.tables("crack"))
    rows += [f"<li>{cracks} crack{'s' * (cracks != 1)} from the start</li>"] if cracks else []
    words = f'<ul style="list-style:none;padding:0;overflow-wrap:anywhere">{"".join(rows)}</ul>' if rows else ""
    return f'<div class="grid two sketch"><div>{drawing.text()}</div><div>{words}</div></div>'


def _colour(place: int) -> str:
    return f"var(--line-{place % COLOURS + 1})"


class _Drawing:
    def __init__(self, results, acting: list[Condition]):
        self._results, self._acting = results, acting
        masks = []
        for condition in acting:
            mask = np.zeros(len(results.volume))
            mask[condition.points] = 1.0
            masks.append(mask)
        self._edges, self._places, *shares = merged(
            results.reference, results.edges, MOST_CELLS[results.dimension], *masks
        )
        self._members = [share > 0.0 for share in shares]
        if results.dimension == 1:
            height = max(float(self._edges[0, 0]), np.ptp(self._places) / 20.0)
            self._edges = np.array([[self._edges[0, 0], 0.0], [0.0, height]])
            self._places = np.pad(self._places, ((0, 0), (0, 1)))
        self._cells = Cells(self._places, self._edges)
        flat = self._flat(self._places)
        low, high = flat.min(axis=0), flat.max(axis=0)
        half = 0.5 * np.abs(self._flat(self._edges)).sum(axis=0)
        self._low, self._high = low - half, high + half
        size = self._high - self._low
        self._scale = (WIDTH - 2 * MARGIN) / max(size[0], size[1] / HIGHEST)
        self._height = 2 * MARGIN + size[1] * self._scale

    def _flat(self, places: np.ndarray) -> np.ndarray:
        """Places seen from the front, or a solid from a corner."""
        return places @ VIEW[:2].T if places.shape[1] == 3 else places

    def _paper(self, places: np.ndarray) -> np.ndarray:
        """Places of the body in units of the drawing, from the upper left corner."""
        flat = (self._flat(np.atleast_2d(places)) - self._low) * self._scale
        left = 0.5 * (WIDTH - (self._high - self._low)[0] * self._scale)
        return np.stack([left + flat[:, 0], self._height - MARGIN - flat[:, 1]], axis=1)

    def text(self) -> str:
        parts = self._body() + self._outline() + self._sides() + self._cracks() + self._symbols()
        size = f"{WIDTH:.0f} {self._height:.0f}"
        return (f'<svg viewBox="0 0 {size}" role="img" aria-label="The body with its supports, loads and cracks">'
                f"{''.join(parts)}</svg>")  # fmt: skip

    # ---- the body ----

    def _body(self) -> list[str]:
        if self._results.elements is not None:
            return self._mesh()
        if not self._cells.is_lattice:
            return self._marks()
        if self._cells.dimension == 3:
            return self._faces()
        parts = [f'<path class="solid" d="{self._rows(np.ones(len(self._places), dtype=bool))}"/>']
        for place, members in enumerate(self._members):
            if members.any():
                parts.append(f'<path class="set" style="fill:{_colour(place)}" d="{self._rows(members)}"/>')
        return parts

    def _mesh(self) -> list[str]:
        """The boundary of a mesh, filled, and the elements of sets."""
        cells = element_cells(self._results.elements)
        boundary = "".join(_closed(self._paper(loop)) for loop in loops(cells))
        parts = [f'<path class="solid" style="stroke:var(--ink)" fill-rule="evenodd" d="{boundary}"/>']
        for place, condition in enumerate(self._acting):
            members = condition.points[:MOST_MARKS]
            shapes = "".join(_closed(self._paper(cells.corners[member])) for member in members)
            parts += [f'<path class="set" style="fill:{_colour(place)}" d="{shapes}"/>'] if shapes else []
        return parts

    def _rows(self, members: np.ndarray) -> str:
        """The cells as rectangles, each a row of neighbours."""
        chosen = np.flatnonzero(members)
        index = self._cells.index[chosen]
        order = np.lexsort((index[:, 0], index[:, 1]))
        chosen, index = chosen[order], index[order]
        begins = np.concatenate([[True], (np.diff(index[:, 1]) != 0) | (np.diff(index[:, 0]) != 1)])
        ends = np.concatenate([begins[1:], [True]])
        centres = self._cells.centres(self._places)
        first, last = centres[chosen[begins]], centres[chosen[ends]]
        along, across = 0.5 * self._edges
        corners = first - along - across, last + along - across, last + along + across, first - along + across
        return "".join(_closed(row) for row in np.stack([self._paper(corner) for corner in corners], axis=1))

    def _faces(self) -> list[str]:
        """Exposed faces of cubes that look towards the eye, those behind first."""
        centres, found = self._cells.centres(self._places), []
        owner = np.full(len(centres), -1)
        for place, members in enumerate(self._members):
            owner[members] = place
        for (axis, sign), corners in FACES.items():
            normal = sign * np.linalg.det(self._edges) * np.cross(self._edges[axis - 2], self._edges[axis - 1])
            facing = normal @ VIEW[2] / np.linalg.norm(normal)
            if facing <= 0.0:
                continue
            for cell in np.flatnonzero(self._cells.neighbours(axis, sign) < 0):
                places = centres[cell] + self._cells.offsets[corners] @ self._edges
                fill = "var(--line-1)" if owner[cell] < 0 else _colour(owner[cell])
                strength = 100.0 * (0.25 + 0.3 * facing) * (1.0 if owner[cell] < 0 else 1.5)
                style = f"fill:color-mix(in srgb,{fill} {strength:.0f}%,var(--card))"
                depth = places.mean(axis=0) @ VIEW[2]
                found.append((depth, f'<path class="face" style="{style}" d="{_closed(self._paper(places))}"/>'))
        return [path for _, path in sorted(found)]

    def _marks(self) -> list[str]:
        """The points of a cloud, or a sample of them."""
        every = -(-len(self._places) // MOST_MARKS)
        radius = max(0.45 * self._cells.spacing * self._scale, 1.0)
        owner = np.full(len(self._places), -1)
        for place, members in enumerate(self._members):
            owner[members] = place
        of_sets = np.flatnonzero(owner >= 0)[:: max(every // 4, 1)]
        shown = np.unique(np.concatenate([np.arange(0, len(owner), every), of_sets]))
        looks = [f'class="set" style="fill:{_colour(own)}"' if own >= 0 else 'class="solid"' for own in owner[shown]]
        at = self._paper(self._places[shown])
        return [f'<circle {look} cx="{x:.1f}" cy="{y:.1f}" r="{radius:.1f}"/>' for look, (x, y) in zip(looks, at)]

    def _outline(self) -> list[str]:
        if self._results.outline is None:
            return []
        begin, end = (self._paper(side) for side in self._results.outline.pieces.transpose(1, 0, 2))
        lines = "".join(map(_line, np.stack([begin, end], axis=1)))
        return [f'<path class="outline" d="{lines}"/>']

    def _sides(self) -> list[str]:
        """Planes of symmetry and sides of periods."""
        if self._results.dimension != 2:
            return []
        low, high = self._results.reference.min(axis=0), self._results.reference.max(axis=0)
        margin, parts = 0.05 * (high - low).max(), []
        for axis, at in self._results.sides:
            ends = np.stack([low - margin, high + margin])
            ends[:, axis] = at
            parts.append(f'<path class="side" d="{_line(self._paper(ends))}"/>')
        return parts

    def _cracks(self) -> list[str]:
        if self._results.dimension == 1:
            return []
        return [f'<path class="crack" d="{_closed(self._paper(crack))}"/>' for crack in self._results.cracks]

    # ---- supports and loads ----

    def _symbols(self) -> list[str]:
        parts, middle = [], self._results.reference.mean(axis=0)
        for place, condition in enumerate(self._acting):
            if not len(condition.points):
                continue
            members = self._results.reference[condition.points]
            centre = members.mean(axis=0)
            at = self._anchor(members, centre, condition.direction)
            for axis in condition.held:
                parts.append(self._triangle(centre, axis, np.sign(middle[axis] - centre[axis]) or 1.0, place))
            if condition.direction is not None and condition.direction.any():
                parts.append(self._arrow(at, condition.direction[: self._results.dimension], place))
        return parts

    def _anchor(self, members, centre, direction) -> np.ndarray:
        """Where an arrow begins: in the middle of what is driven, at its far end along the arrow."""
        if direction is None:
            return centre
        along = direction[: len(centre)]
        return centre + np.where(
            along > 0, members.max(axis=0) - centre, np.where(along < 0, members.min(axis=0) - centre, 0.0)
        )

    def _towards(self, direction: np.ndarray) -> np.ndarray:
        """A direction of the body on the paper, of length 1."""
        flat = self._flat(np.pad(direction, (0, self._places.shape[1] - len(direction)))[None])[0] * [1.0, -1.0]
        return flat / (np.linalg.norm(flat) or 1.0)

    def _on_paper(self, place: np.ndarray) -> np.ndarray:
        return self._paper(np.pad(place, (0, self._places.shape[1] - len(place))))[0]

    def _arrow(self, place, direction, colour: int) -> str:
        begin, along = self._on_paper(place), self._towards(direction / np.linalg.norm(direction))
        end, aside = begin + ARROW * along, np.array([-along[1], along[0]])
        lines = [begin, end], [end - 12 * along + 7 * aside, end, end - 12 * along - 7 * aside]
        return f'<path class="arrow" style="stroke:{_colour(colour)}" d="{"".join(map(_line, lines))}"/>'

    def _triangle(self, place, axis: int, sign: float, colour: int) -> str:
        """A support that holds an axis: its tip points into the body."""
        tip, along = self._on_paper(place), self._towards(sign * np.eye(self._results.dimension)[axis])
        aside = np.array([-along[1], along[0]])
        corners = np.array([tip, tip - 20 * along + 11 * aside, tip - 20 * along - 11 * aside])
        return f'<path class="arrow" style="stroke:{_colour(colour)};fill:var(--card)" d="{_closed(corners)}"/>'


def loops(cells: Polygons) -> list[np.ndarray]:
    """The boundary of cells that share corners, as closed lines: sides beyond which there is no cell, one after another."""
    cell, side = np.nonzero(cells.beyond == -1)
    last = cells.is_side.sum(axis=1)
    after = np.where(side + 1 < last[cell], side + 1, 0)
    begins = [tuple(corner) for corner in cells.corners[cell, side]]
    follows = dict(zip(begins, (tuple(corner) for corner in cells.corners[cell, after])))
    found = []
    while follows:
        corner, end = follows.popitem()
        loop = [corner]
        while end in follows:
            loop.append(end)
            end = follows.pop(end)
        found.append(np.array(loop))
    return found


def _line(corners) -> str:
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in corners)


def _closed(corners) -> str:
    return _line(corners) + "Z"
