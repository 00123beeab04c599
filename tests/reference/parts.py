"""Parts of boxes within balls by nested integrals, and the volume shares of a lattice's bonds (docs/theory.md)."""

import functools
import itertools
import math

import numpy

NODES, WEIGHTS = numpy.polynomial.legendre.leggauss(40)


def part(lower, upper, radius):
    """Measure and first moments of the part of a box within a ball about the origin."""
    if len(lower) == 1:
        low, high = max(lower[0], -radius), min(upper[0], radius)
        return (high - low, numpy.array([(high**2 - low**2) / 2])) if low < high else (0.0, numpy.zeros(1))
    # Sections across the last axis have kinks where their radius meets a corner, an edge or a side.
    choices = [[low**2, high**2] + ([0.0] if low <= 0 <= high else []) for low, high in zip(lower[:-1], upper[:-1])]
    squares = [sum(of_axes) for of_axes in itertools.product(*choices)] + [0.0]
    heights = [sign * math.sqrt(radius**2 - square) for square in squares if square <= radius**2 for sign in (-1, 1)]
    first, last = max(lower[-1], -radius), min(upper[-1], radius)
    kinks = sorted({first, last, *(height for height in heights if first < height < last)})
    measure, moment = 0.0, numpy.zeros(len(lower))
    for low, high in itertools.pairwise(kinks) if first < last else ():
        for angle, weight in zip((NODES + 1) * math.pi / 2, WEIGHTS * math.pi / 2):
            height = (low + high) / 2 - (high - low) / 2 * math.cos(angle)
            area, of_section = part(lower[:-1], upper[:-1], math.sqrt(max(radius**2 - height**2, 0.0)))
            scale = weight * (high - low) / 2 * math.sin(angle)
            measure += scale * area
            moment += scale * numpy.append(of_section, height * area)
    return measure, moment


@functools.cache
def part_of_cell(step, edges, ratio):
    """Share of the cell at a lattice offset, and distance of that part's centroid over the horizon; lengths in the edge
    of a square or cube of the same volume."""
    middle, half = numpy.array(step) * edges, numpy.array(edges) / 2
    if numpy.linalg.norm(middle + half) <= ratio:
        return 1.0, float(numpy.linalg.norm(middle)) / ratio
    if numpy.linalg.norm(numpy.maximum(middle - half, 0)) >= ratio:
        return 0.0, 1.0
    measure, moment = part(tuple(middle - half), tuple(middle + half), ratio)
    share = measure / numpy.prod(edges)
    return (share, float(numpy.linalg.norm(moment / measure)) / ratio) if share > 1e-8 else (0.0, 1.0)


def lattice_shares(arms, spacings, angle, horizon):
    """Shares and relative distances of the cells at the ends of a lattice's bonds."""
    arms = numpy.array(arms)
    if arms.shape[1] > 1:
        cosine, sine = math.cos(math.radians(angle)), math.sin(math.radians(angle))
        arms[:, :2] = arms[:, :2] @ numpy.array([[cosine, -sine], [sine, cosine]])
    steps = numpy.rint(abs(arms) / spacings).astype(int)
    edge = float(numpy.prod(spacings)) ** (1 / len(spacings))
    edges = tuple(float(spacing) / edge for spacing in spacings)
    if len(set(spacings)) == 1:
        steps = -numpy.sort(-steps, axis=1)
        edges = (1.0,) * len(edges)
    found = [part_of_cell(tuple(map(int, step)), edges, horizon / edge) for step in steps]
    return numpy.array(found).reshape(-1, 2).T
