"""The direction in which a crack has left a notch along x, by the bonds that broke."""

import math

import numpy

from tests.reference.results import table


def kink_angle(run, heights):
    """Angle from the x axis [degrees] of the line through the crack's middle in slices one millimetre high [m]."""
    places = run.points("reference")
    broken = table(run.folder / "broken_bonds.csv")
    ends = [(int(row["first_point"]), int(row["second_point"])) for row in broken if row["second_image"] == 0]
    x, y = numpy.array([places[list(pair)].mean(axis=0)[:2] for pair in ends]).T
    slices = [(y >= low) & (y < low + 1e-3) for low in heights]
    middle = [(numpy.median(x[of]), y[of].mean()) for of in slices if of.sum() > 2]
    slope = numpy.polyfit([b for _, b in middle], [a for a, _ in middle], 1)[0]
    return math.degrees(math.atan2(1, slope))
