"""The body of a run as the page carries it: cells, displacements and fields of its steps, and broken bonds.

A page has room for a number of bytes. Where it does not suffice, first the numbers get fewer bits, then steps are left
out, then neighbouring points become one cell; `told` says so.
"""

import numpy as np

from ..pictures.cloud_cells import CloudCells
from ..pictures.state_words import progress
from ..pictures.units import number
from .fields import Field
from .frames import Frames, chosen, read_frames
from .packing import Pack, Ranges, quantised

BITS = ((16, 12), (16, 8), (14, 8), (12, 8))  # of displacements, of fields; a smaller page from row to row
LEAST_STEPS = 12  # below which points become fewer, not steps
MOST_STEPS = 400
BYTES_PER_NUMBER = 0.08  # a page with less has not been seen; more numbers than fit with it are not even read
USUAL_FIELDS = 4
MOST_BONDS = 40_000
LEAST_CELLS = 100
POSITION_BITS = 16
SHAPE_BITS = 12


def body_content(results, room: int) -> tuple[dict, str] | None:
    """What the page says about the body, and its numbers as text of at most `room` bytes; None without fields."""
    if not results.step_numbers:
        return None
    steps, limit = _first_guess(results, room)
    while True:
        frames = read_frames(results, chosen(results, steps), limit)
        text = _packed(results, frames, BITS[-1])[1].text()
        if len(text) <= room or limit <= LEAST_CELLS:
            return _best(results, frames, room)
        share = 0.92 * room / len(text)
        if len(frames.numbers) > LEAST_STEPS:
            steps = max(int(share * len(frames.numbers)), LEAST_STEPS)
        else:
            limit = max(int(share * len(frames.places)), LEAST_CELLS)


def _best(results, frames: Frames, room: int) -> tuple[dict, str]:
    """With as many bits as there is room for."""
    for bits in BITS:
        content, pack = _packed(results, frames, bits)
        text = pack.text()
        if len(text) <= room:
            break
    return content | {"told": _told(results, frames, content)}, text


def _first_guess(results, room: int) -> tuple[int, int]:
    """Numbers of steps and of cells with which a page may have room: more are not even read."""
    count, steps = len(results.volume), min(len(results.step_numbers), MOST_STEPS)
    most = int(room / BYTES_PER_NUMBER / (results.dimension + USUAL_FIELDS))
    if count * steps <= most:
        return steps, count
    steps = max(min(steps, LEAST_STEPS), most // count)
    return steps, min(count, max(most // steps, LEAST_CELLS))


def _packed(results, frames: Frames, bits: tuple[int, int]) -> tuple[dict, Pack]:
    pack = Pack()
    of_displacement, of_fields = bits
    pack.add_fields("displacement", *_on_grid(frames, *quantised(frames.displacement, of_displacement)))
    for field, values in frames.fields.items():
        pack.add_fields(field.name, *_on_grid(frames, *_field_numbers(field, values, of_fields)))
    content = {
        "dimension": results.dimension,
        "count": len(frames.places),
        "points": len(results.volume),
        "shape": list(frames.shape),
        "frames": [_frame(results, number) for number in frames.numbers],
        "fields": [{"name": field.name, "label": field.label, "unit": field.unit} for field in frames.fields],
        "loose": frames.loose_damage,
        "size": float(np.ptp(results.reference, axis=0).max()),
        "is_whole": frames.is_whole,
    }
    pack.add_numbers("places", frames.places)
    content |= _geometry(results, frames, pack)
    if frames.is_whole:
        pack.add_numbers("number", frames.order)
    if frames.is_whole and len(results.broken_bonds().steps):
        content |= _bonds(results, frames, pack)
    return content | {"arrays": pack.arrays}, pack


def _on_grid(frames: Frames, numbers: np.ndarray, ranges: Ranges) -> tuple:
    return numbers, frames.places, frames.shape, ranges


def _field_numbers(field: Field, values: np.ndarray, bits: int) -> tuple[np.ndarray, Ranges]:
    if field.name == "fragment":  # whole numbers stay exact
        return _whole_numbers(np.rint(values)[:, None])
    return quantised(values[:, None], bits)


def _whole_numbers(values: np.ndarray) -> tuple[np.ndarray, Ranges]:
    bits = 8 if values.max(initial=0) < 256 else 16
    low = np.zeros(values.shape[:2])
    return np.clip(values, 0, 2**bits - 1).astype(np.uint16), Ranges(low, low + 2**bits - 1, bits)


def _frame(results, number_of_step: int) -> dict:
    load = results.in_history(number_of_step, "load_factor")
    return {
        "step": number_of_step,
        "load": "" if load is None else " ".join(progress(results, number_of_step, load)).strip(),
        "broken": results.in_history(number_of_step, "broken_bonds"),
    }


def _geometry(results, frames: Frames, pack: Pack) -> dict:
    """The cells: boxes of a lattice, polygons of a plane cloud or mesh, or else marks of a size."""
    cells, about = frames.cells, {"kind": "points", "mark": _mark(results, frames)}
    if frames.parted is not None:
        pack.add_fields("parted", *_on_grid(frames, *_whole_numbers(frames.parted[None].astype(float))))
    if frames.is_lattice:
        origin = cells.centres(frames.reference)[0] - cells.index[0] @ cells.edges
        about |= {"kind": "lattice", "edges": cells.edges.tolist(), "origin": origin.tolist()}
        if cells.offsets.ndim == 3:  # fitted to the outline
            _add_shapes(frames, "offsets", cells.offsets, pack)
    elif isinstance(cells, CloudCells):
        about |= {"kind": "polygons"}
        _add_shapes(frames, "corners", cells.polygons.corners - frames.reference[:, None], pack)
        pack.add_numbers("knots", _renumbered(cells.knots[frames.order].ravel()))
    if not frames.stands_on_lattice:
        values = frames.reference[frames.order].T[None]
        pack.add_fields("position", *_on_grid(frames, *quantised(values, POSITION_BITS)))
    return about


def _add_shapes(frames: Frames, name: str, corners: np.ndarray, pack: Pack) -> None:
    values = corners[frames.order].reshape(len(frames.order), -1).T[None]
    pack.add_fields(name, *_on_grid(frames, *quantised(values, SHAPE_BITS)))


def _renumbered(knots: np.ndarray) -> np.ndarray:
    """Numbers in the order of their first appearance, so that those of neighbours are near."""
    _, first, which = np.unique(knots, return_index=True, return_inverse=True)
    rank = np.empty_like(first)
    rank[np.argsort(first)] = np.arange(len(first))
    return rank[which]


def _mark(results, frames: Frames) -> float:
    """Size of a cell that is drawn as a mark [m]."""
    return results.spacing * (len(results.volume) / len(frames.places)) ** (1.0 / results.dimension)


def _bonds(results, frames: Frames, pack: Pack) -> dict:
    """Broken bonds by the numbers of their cells, in the order of breaking."""
    broken = results.broken_bonds()
    shown = np.unique(np.linspace(0, len(broken.steps) - 1, min(len(broken.steps), MOST_BONDS)).astype(int))
    cell = np.empty_like(frames.order)
    cell[frames.order] = np.arange(len(frames.order))
    for name, values in zip(("first", "second"), broken.points[shown].T):
        pack.add_numbers(f"bond_{name}", cell[values])
    pack.add_numbers("bond_step", broken.steps[shown])
    about = {"bonds": len(broken.steps), "bonds_shown": len(shown)}
    if results.image_kinds is not None and broken.image.any():
        pack.add_numbers("bond_image", broken.image[shown])
        about["images"] = {"mirror": results.image_kinds.mirror.tolist(), "shift": results.image_kinds.shift.tolist()}
    return about


def _told(results, frames: Frames, content: dict) -> list[str]:
    """Sentences about what the page leaves out."""
    told, steps, points = [], len(results.step_numbers), len(results.volume)
    if len(frames.numbers) < steps:
        told.append(f"{len(frames.numbers)} of the {number(steps)} steps with fields are shown, to keep the page small.")
    if not frames.is_whole:
        told.append(f"{number(len(frames.order))} cells are shown for {number(points)} points, to keep the page small: "
                    "each is the mean of its points. Single broken bonds are not drawn, and extreme values are smoothed.")  # fmt: skip
    if content.get("bonds_shown", 0) < content.get("bonds", 0):
        told.append(f"{number(content['bonds_shown'])} of the {number(content['bonds'])} broken bonds are drawn.")
    return told
