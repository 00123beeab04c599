"""The path of the crack in the half disk of `trust inclined_notch` by linear elastic fracture mechanics: K_II = 0 at its
growing tip. Lengths are in radii of the disk.

`/usr/bin/python3 -BEs -m tests.reference.half_disk` prints the reference of cases/runner/trust/inclined_notch.py, and how
increments and sides half as long move it.
"""

import math

import numpy

from tests.reference import kinked_crack
from tests.reference.outlined_crack import Body

SUPPORT, NOTCH, INCLINED = 0.43, 0.3, math.radians(30)
CONTACT = 0.02  # half of the length on which a roller presses
SIDE, FINER, GRADE = 0.02, 8, 0.3  # longest side of the outline; shorter near contacts, corners and mouth, by their distance
INCREMENT, HEIGHT = 0.02, 0.7  # of the path, and up to where it goes
RADIUS = 50.0  # mm


def half_disk(support=SUPPORT, side=SIDE):
    """The body under the load 1 at its top, from the middle of its flat side on."""
    flat = _points([0.0, support - CONTACT, support + CONTACT, 1.0], side)
    arc = numpy.exp(1j * _points([0.0, math.pi / 2 - CONTACT, math.pi / 2 + CONTACT, math.pi], side))
    corners = numpy.concatenate([flat[:-1], arc[:-1], -flat[:0:-1]])
    middles = 0.5 * (corners + numpy.roll(corners, -1))
    is_supported = (abs(abs(middles) - support) < CONTACT) & (abs(middles.imag) < 1e-9)
    is_loaded = (abs(middles.real) < CONTACT) & (middles.imag > 0.5)
    return Body(corners, -(is_loaded + 0.5 * is_supported) / (2 * CONTACT))


def _points(ends, side):
    """Points from end to end, closer together near each of them."""
    found = []
    for a, b in zip(ends, ends[1:]):
        x = numpy.linspace(a, b, 2001)
        lengths = numpy.minimum(side, side / FINER + GRADE * numpy.minimum(x - a, b - x))
        count = numpy.append(0, numpy.cumsum(1 / lengths[1:])) * (x[1] - x[0])
        found.append(numpy.interp(numpy.linspace(0, count[-1], math.ceil(count[-1]) + 1)[:-1], count, x))
    return numpy.append(numpy.concatenate(found), ends[-1])


def notch(inclined=INCLINED, length=NOTCH, increment=INCREMENT):
    """Ends of the elements of a notch from the middle of the flat side towards positive x."""
    return kinked_crack.straight(math.pi / 2 - inclined, length, round(length / increment) * kinked_crack.ELEMENTS)


def path(increment=INCREMENT, side=SIDE):
    """The path from the tip of the notch on, one place per increment."""
    body, ends = half_disk(side=side), notch(increment=increment)
    angle = math.pi / 2 - INCLINED + kinked_crack.hoop(*body.intensities(ends))
    grown = kinked_crack.grow(body, ends, angle, increment, lambda tip: tip.imag >= HEIGHT)
    return grown[len(ends) - 1 :: kinked_crack.ELEMENTS]


def across(places, height):
    """x where a path passes a height."""
    return float(numpy.interp(height, places.imag, places.real))


if __name__ == "__main__":
    opening, sliding = half_disk().intensities(notch())
    print(f"K_II / K_I of the notch {sliding / opening:.3f}")
    print(", ".join(f"({place.real:.2f}e-3, {place.imag:.2f}e-3)" for place in RADIUS * path()))
    for increment, side in ((INCREMENT, SIDE), (INCREMENT / 2, SIDE), (INCREMENT, SIDE / 2)):
        found = RADIUS * path(increment, side)
        print(f"increment {increment:g}, side {side:g}:", *(f"x({y}) = {across(found, y):.2f}" for y in (15, 20, 25, 30, 35)), "mm")
