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


def loose_points(places, bonds, prescribed, beyond):
    """Own points on fewer independent directions than the dimension, stripped until none is left."""
    count = beyond.own
    is_shifted = (beyond.source[bonds[:, 1]] == bonds[:, 0]) & (beyond.mirror[bonds[:, 1]] == 1).all(axis=1)
    bonds = bonds[~is_shifted]  # a point and its own copy move alike
    loose = numpy.zeros(count, bool)
    arms = places[bonds[:, 1]] - places[bonds[:, 0]]
    arms = arms / numpy.sqrt((arms**2).sum(axis=1))[:, None]
    while True:
        total = numpy.einsum("pa,ab->pab", prescribed.astype(float), numpy.eye(places.shape[1]))
        for here, there in ((0, 1), (1, 0)):
            keep = (bonds[:, here] < count) & ~loose[beyond.source[bonds[:, there]]]
            total += symmetric_sums(bonds[keep, here], arms[keep], count)
        values = numpy.linalg.eigvalsh(total)
        stripped = values[:, 0] <= DEPENDENT * values[:, -1]
        if not (stripped & ~loose).any():
            return loose
        loose |= stripped


class Copy:
    """One of the copies of the body: x' = mirror x + shift + periods . jump."""

    def __init__(self, mirror, shift, periods):
        self.mirror, self.shift, self.periods = mirror, shift, periods

    def after(self, first):
        return Copy(self.mirror * first.mirror, self.mirror * first.shift + self.shift,
                    self.mirror * first.periods + self.periods)  # fmt: skip

    def is_as(self, other, spacing):
        same = (self.mirror == other.mirror).all() and (self.periods == other.periods).all()
        return same and numpy.abs(self.shift - other.shift).max() < 0.01 * spacing


def pieces(count, bonds, beyond, skip):
    """Connected parts of what is there without bounds: for each the copy of every own point that is in it, and pairs of
    copies of one point that are both in it."""
    neighbours = [[] for _ in range(count)]
    for i, j in bonds.tolist():
        s = int(beyond.source[j])
        if skip[i] or skip[s]:
            continue
        there = Copy(beyond.mirror[j], beyond.shift[j], beyond.periods[j])
        back = Copy(there.mirror, -there.mirror * there.shift, -there.mirror * there.periods)
        neighbours[i].append((s, there))
        neighbours[s].append((i, back))
    placed, found = {}, []
    still = numpy.zeros(beyond.places.shape[1])
    for start in range(count):
        if skip[start] or start in placed:
            continue
        placed[start] = Copy(still + 1, still, still)
        members, twice, waiting = [start], [], [start]
        while waiting:
            i = waiting.pop()
            for s, step in neighbours[i]:
                copy = placed[i].after(step)
                if s not in placed:
                    placed[s] = copy
                    members.append(s)
                    waiting.append(s)
                elif not copy.is_as(placed[s], beyond.spacing):
                    twice.append((s, copy))
        found.append(({m: placed[m] for m in members}, twice))
    return found


def motions_at(place, centre, size):
    """Columns: velocities of a place by the infinitesimal rigid motions."""
    dimension = len(place)
    arm = (place - centre) / size
    columns = list(numpy.eye(dimension))
    for a in range(dimension):
        for b in range(a + 1, dimension):
            turn = numpy.zeros(dimension)
            turn[a], turn[b] = -arm[b], arm[a]
            columns.append(turn)
    return numpy.array(columns).T


def may_move(members, twice, places, jump, prescribed, free_jump, sums):
    """Whether a piece has a rigid motion, with changes of the jumps that are free, that nothing forbids."""
    dimension = places.shape[1]

    def now(point, copy):
        return copy.mirror * places[point] + copy.shift + copy.periods @ jump

    held = {point: now(point, copy) for point, copy in members.items()}
    centre = numpy.mean(list(held.values()), axis=0)
    size = max(numpy.abs(numpy.array(list(held.values())) - centre).max(), 1e-300)
    free = numpy.argwhere(free_jump)

    def own_motion(point, copy):
        """Of the own point, when this copy moves with the piece."""
        of_jumps = numpy.zeros((dimension, len(free)))
        for column, (axis, component) in enumerate(free):
            of_jumps[component, column] = -copy.periods[axis]
        return copy.mirror[:, None] * numpy.hstack([motions_at(now(point, copy), centre, size), of_jumps])

    moved = {point: own_motion(point, copy) for point, copy in members.items()}
    rows = [moved[point][c] for point in members for c in numpy.flatnonzero(prescribed[point])]
    for weights in sums:  # what a piece shares with others may be made up by these
        of = numpy.flatnonzero((weights * ~prescribed).any(axis=1))
        if all(point in members for point in of.tolist()):
            rows.append(sum(weights[point] @ moved[point] for point in of.tolist()))
    for point, copy in twice:
        rows += list(moved[point] - own_motion(point, copy))
    everything = numpy.vstack([*moved.values(), *rows])
    held = numpy.linalg.matrix_rank(numpy.array(rows), tol=1e-6) if rows else 0
    return held < numpy.linalg.matrix_rank(everything, tol=1e-6)


def unheld_points(displacement, bonds, prescribed, beyond, jump, free_jump, sums=()):
    """Own points that are loose, and those of pieces of the others that may move rigidly.

    displacement: of all points; bonds: those that are whole; prescribed: own points x dimension; sums: weights of
    displacements, sums of which are given.
    """
    places = beyond.places + displacement
    unheld = loose_points(places, bonds, prescribed, beyond)
    for members, twice in pieces(beyond.own, bonds, beyond, unheld.copy()):
        if may_move(members, twice, places, jump, prescribed, free_jump, sums):
            unheld[list(members)] = True
    return unheld
