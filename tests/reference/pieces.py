"""Points that nothing holds any more (docs/theory.md, Fragments)."""

import numpy

# Above the program's own limit, so that a point that is pinned for sure counts here as well.
DEPENDENT = 1e-5


def symmetric_sums(index, direction, count):
    """Sum of n n^T per point."""
    dimension = direction.shape[1]
    total = numpy.empty((count, dimension, dimension))
    for a in range(dimension):
        for b in range(dimension):
            total[:, a, b] = numpy.bincount(index, direction[:, a] * direction[:, b], minlength=count)
    return total


def loose_points(places, bonds, prescribed):
    """Points on fewer independent directions than the dimension, stripped until none is left."""
    count = len(places)
    loose = numpy.zeros(count, bool)
    arms = places[bonds[:, 1]] - places[bonds[:, 0]]
    arms = arms / numpy.sqrt((arms**2).sum(axis=1))[:, None]
    while True:
        total = numpy.einsum("pa,ab->pab", prescribed.astype(float), numpy.eye(places.shape[1]))
        for here, there in ((0, 1), (1, 0)):
            keep = ~loose[bonds[:, there]]
            total += symmetric_sums(bonds[keep, here], arms[keep], count)
        values = numpy.linalg.eigvalsh(total)
        stripped = values[:, 0] <= DEPENDENT * values[:, -1]
        if not (stripped & ~loose).any():
            return loose
        loose |= stripped


def pieces_of(count, bonds):
    """A label per point, the same for points that bonds connect."""
    label = numpy.arange(count)
    while True:
        least = label.copy()
        numpy.minimum.at(least, bonds[:, 0], label[bonds[:, 1]])
        numpy.minimum.at(least, bonds[:, 1], label[bonds[:, 0]])
        least = least[least]
        if (least == label).all():
            return label
        label = least


def rigid_motions(places):
    """Columns: the infinitesimal rigid motions, count x dimension x motions."""
    count, dimension = places.shape
    centred = places - places.mean(axis=0)
    motions = [numpy.tile(axis, (count, 1)) for axis in numpy.eye(dimension)]
    for a in range(dimension):
        for b in range(a + 1, dimension):
            turn = numpy.zeros((count, dimension))
            turn[:, a], turn[:, b] = -centred[:, b], centred[:, a]
            motions.append(turn / max(numpy.abs(centred).max(), 1e-300))
    return numpy.stack(motions, axis=-1)


def unheld_points(places, bonds, prescribed):
    """Loose points, and the pieces among the others that may move rigidly."""
    loose = loose_points(places, bonds, prescribed)
    keep = ~loose[bonds].any(axis=1)
    label = pieces_of(len(places), bonds[keep])
    unheld = loose.copy()
    for piece in numpy.unique(label[~loose]):
        inside = numpy.flatnonzero((label == piece) & ~loose)
        motions = rigid_motions(places[inside])
        held = motions[prescribed[inside]]
        needed = numpy.linalg.matrix_rank(motions.reshape(-1, motions.shape[-1]))
        if len(held) == 0 or numpy.linalg.matrix_rank(held, tol=1e-6) < needed:
            unheld[inside] = True
    return unheld
