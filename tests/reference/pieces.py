"""Points that are no longer held (docs/theory.md, Fragments)."""

import numpy

# Larger than the program's own limit, so that a clearly pinned point counts here as well.
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
    """Own points whose bonds span fewer directions than the dimension, stripped until none is left."""
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


class Copies:
    """Copies of points, one entry each: x' = mirror x + shift + periods . jump."""

    def __init__(self, mirror, shift, periods):
        self.mirror, self.shift, self.periods = mirror, shift, periods

    @property
    def parts(self):
        return self.mirror, self.shift, self.periods

    def of(self, which):
        return Copies(*(part[which] for part in self.parts))

    def put(self, which, copies):
        for part, other in zip(self.parts, copies.parts):
            part[which] = other

    def after(self, first):
        return Copies(self.mirror * first.mirror, self.mirror * first.shift + self.shift,
                      self.mirror * first.periods + self.periods)  # fmt: skip

    def back(self):
        return Copies(self.mirror, -self.mirror * self.shift, -self.mirror * self.periods)

    def and_then(self, others):
        return Copies(*(numpy.concatenate(both) for both in zip(self.parts, others.parts)))

    def are_as(self, other, spacing):
        same = (self.mirror == other.mirror).all(axis=1) & (self.periods == other.periods).all(axis=1)
        return same & (numpy.abs(self.shift - other.shift).max(axis=1) < 0.01 * spacing)


class Links:
    """Directed bonds, ordered by their start: the copy of `end` that an own point `start` sees."""

    def __init__(self, count, bonds, beyond, skip):
        source = beyond.source[bonds[:, 1]]
        keep = ~skip[bonds[:, 0]] & ~skip[source]
        here, there, source = bonds[keep, 0], bonds[keep, 1], source[keep]
        seen = Copies(beyond.mirror, beyond.shift, beyond.periods).of(there)
        start = numpy.concatenate([here, source])
        order = numpy.argsort(start, kind="stable")
        self.start, self.end = start[order], numpy.concatenate([source, here])[order]
        self.copy = seen.and_then(seen.back()).of(order)
        self.first = numpy.searchsorted(self.start, numpy.arange(count + 1))

    def of(self, points):
        """Numbers of the bonds that start at given points."""
        low, many = self.first[points], self.first[points + 1] - self.first[points]
        return numpy.repeat(low - numpy.cumsum(many) + many, many) + numpy.arange(many.sum())


def pieces(count, bonds, beyond, skip):
    """Connected parts of the infinite body: the part number of every own point (-1: skipped), the copy of every own
    point that is in its part, and pairs of copies of one point that are both in it: the point and the other copy."""
    links = Links(count, bonds, beyond, skip)
    still = numpy.zeros((count, beyond.places.shape[1]))
    part, placed, parts = numpy.full(count, -1), Copies(still + 1, still.copy(), still.copy()), 0
    for start in numpy.flatnonzero(~skip).tolist():
        if part[start] >= 0:
            continue
        part[start], front = parts, numpy.array([start])
        while len(front):
            out = links.of(front)
            out = out[part[links.end[out]] < 0]
            front, one = numpy.unique(links.end[out], return_index=True)
            out = out[one]
            placed.put(front, links.copy.of(out).after(placed.of(links.start[out])))
            part[front] = parts
        parts += 1
    again = links.copy.after(placed.of(links.start))
    other = ~again.are_as(placed.of(links.end), beyond.spacing)
    return part, placed, (links.end[other], again.of(other))


def motions_at(places, centre, size):
    """Columns: velocities at positions for the infinitesimal rigid motions."""
    count, dimension = places.shape
    arm = (places - centre) / size
    columns = [numpy.tile(axis, (count, 1)) for axis in numpy.eye(dimension)]
    for a in range(dimension):
        for b in range(a + 1, dimension):
            turn = numpy.zeros((count, dimension))
            turn[:, a], turn[:, b] = -arm[:, b], arm[:, a]
            columns.append(turn)
    return numpy.stack(columns, axis=2)


def may_move(members, copies, twice, places, jump, prescribed, free_jump, sums):
    """Whether a piece has a rigid motion, with changes of the free jumps, that no constraint forbids.

    members: points, ascending; copies: of these; twice: points and other copies of them.
    """

    def now(points, copies):
        return copies.mirror * places[points] + copies.shift + copies.periods @ jump

    held = now(members, copies)
    centre = held.mean(axis=0)
    size = max(numpy.abs(held - centre).max(), 1e-300)
    free = numpy.argwhere(free_jump)

    def own_motions(points, copies):
        """Motion of the own points when these copies move with the piece."""
        of_jumps = numpy.zeros((*copies.periods.shape, len(free)))
        for column, (axis, component) in enumerate(free):
            of_jumps[:, component, column] = -copies.periods[:, axis]
        motions = motions_at(now(points, copies), centre, size)
        return copies.mirror[:, :, None] * numpy.concatenate([motions, of_jumps], axis=2)

    moved = own_motions(members, copies)
    rows = [moved[prescribed[members]]]
    for weights in sums:  # other members may compensate for a piece in a shared sum
        of = numpy.flatnonzero((weights * ~prescribed).any(axis=1))
        if numpy.isin(of, members).all():
            rows.append(numpy.einsum("pa,pam->m", weights[of], moved[numpy.searchsorted(members, of)])[None])
    points, others = twice
    between = moved[numpy.searchsorted(members, points)] - own_motions(points, others)
    rows = numpy.concatenate([*rows, between.reshape(-1, moved.shape[2])])
    everything = numpy.concatenate([moved.reshape(-1, moved.shape[2]), rows])
    held = numpy.linalg.matrix_rank(rows, tol=1e-6) if len(rows) else 0
    return held < numpy.linalg.matrix_rank(everything, tol=1e-6)


def unheld_points(displacement, bonds, prescribed, beyond, jump, free_jump, sums=()):
    """Loose own points, and the points of pieces of the others that can move rigidly.

    displacement: of all points; bonds: intact ones; prescribed: own points x dimension; sums: weights of
    displacements with prescribed sums.
    """
    places = beyond.places + displacement
    unheld = loose_points(places, bonds, prescribed, beyond)
    part, placed, (again, others) = pieces(beyond.own, bonds, beyond, unheld)
    for number in range(part.max() + 1):
        members, of_part = numpy.flatnonzero(part == number), part[again] == number
        twice = again[of_part], others.of(of_part)
        if may_move(members, placed.of(members), twice, places, jump, prescribed, free_jump, sums):
            unheld[members] = True
    return unheld
