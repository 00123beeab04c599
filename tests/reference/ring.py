"""A ring under pressure in the continuum limit of bonds in plane stress: Lamé's solution, and for finite strain the
solution of the ring's ordinary differential equation, with the energy of its bonds as an integral over directions.

With the principal stretches (a, b) along radius and circumference, a bond at the angle t to the radius has the
stretch s = sqrt(a2 cos2 t + b2 sin2 t) - 1, and c s2 L / 2 summed over half of all bonds in a plane disk is

    W = 3 E / (4 pi) int_0^2pi s2 dt,

which is 9/16 E e2 for a uniaxial small strain e, as required at Poisson's ratio 1/3.
"""

import numpy

ANGLES = numpy.arange(64) * 2 * numpy.pi / 64  # the trapezoidal rule is exact to round-off for periodic functions
COS, SIN = numpy.cos(ANGLES) ** 2, numpy.sin(ANGLES) ** 2


def lame(radius, inner, outer, pressure, modulus, poisson=1 / 3):
    """Radial displacement, plane stress."""
    factor = pressure * inner**2 / (modulus * (outer**2 - inner**2))
    return factor * ((1 - poisson) * radius + (1 + poisson) * outer**2 / radius)


def stresses(a, b, modulus):
    """dW/da, dW/db and d2W/da2: first Piola-Kirchhoff stresses and the radial stiffness."""
    length = numpy.sqrt(a * a * COS + b * b * SIN)
    scale = 3 * modulus / (4 * numpy.pi) * 2 * numpy.pi / len(ANGLES)
    relative = 1 - 1 / length  # s / (1 + s)
    along = scale * (2 * relative * a * COS).sum()
    around = scale * (2 * relative * b * SIN).sum()
    stiffness = scale * (2 * relative * COS + 2 * (a * COS) ** 2 / length**3).sum()
    return along, around, stiffness


def radial_stretch(stress, b, modulus, start=1.0):
    a = start
    for _ in range(60):
        found, _, stiffness = stresses(a, b, modulus)
        change = (found - stress) / stiffness
        a -= change
        if abs(change) < 1e-14:
            return a
    raise ValueError("no stretch has this stress")


def stress_outside(bore, inner, outer, pressure, modulus, steps):
    """Shoots from the bore's current radius: P at the outer radius, and current radii on the way."""
    radii = numpy.linspace(inner, outer, steps + 1)
    width = radii[1] - radii[0]
    start = 1.0

    def rate(radius, state):
        nonlocal start
        place, stress = state
        around = place / radius
        start = radial_stretch(stress, around, modulus, start)
        return numpy.array([start, (stresses(start, around, modulus)[1] - stress) / radius])

    state = numpy.array([bore, -pressure * bore / inner])
    places = [bore]
    for radius in radii[:-1]:
        k1 = rate(radius, state)
        k2 = rate(radius + width / 2, state + width / 2 * k1)
        k3 = rate(radius + width / 2, state + width / 2 * k2)
        k4 = rate(radius + width, state + width * k3)
        state = state + width / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        places.append(state[0])
    return state[1], radii, numpy.array(places)


def finite_elements(inner, outer, pressure, modulus, elements):
    """The same by linear finite elements along the radius: minimises the energy W 2 pi R dR - p pi r(inner)2 with
    the midpoint rule, by Newton's method. Returns reference radii and displacements of the nodes."""
    radii = numpy.linspace(inner, outer, elements + 1)
    widths, middles = numpy.diff(radii), (radii[1:] + radii[:-1]) / 2
    places = radii + lame(radii, inner, outer, pressure, modulus)

    def forces(left, right, k):
        along, around, _ = stresses((right - left) / widths[k], (right + left) / (2 * middles[k]), modulus)
        weight = 2 * numpy.pi * middles[k] * widths[k]
        return weight * (around / (2 * middles[k]) + numpy.array([-1, 1]) * along / widths[k])

    for _ in range(50):
        gradient, stiffness = numpy.zeros(elements + 1), numpy.zeros((elements + 1, elements + 1))
        for k in range(elements):
            ends = slice(k, k + 2)
            gradient[ends] += forces(places[k], places[k + 1], k)
            for column, step in enumerate(((1e-30j, 0), (0, 1e-30j))):  # exact derivatives by a complex step
                stiffness[ends, k + column] += forces(places[k] + step[0], places[k + 1] + step[1], k).imag / 1e-30
        gradient[0] -= 2 * numpy.pi * pressure * places[0]
        stiffness[0, 0] -= 2 * numpy.pi * pressure
        change = numpy.linalg.solve(stiffness, gradient)
        places -= change
        if numpy.abs(change).max() < 1e-13 * outer:
            return radii, places - radii
    raise ValueError("the finite elements do not converge")


def solve(inner, outer, pressure, modulus, steps=200):
    """Reference radii and displacements of the ring under a pressure that follows its bore."""
    small = lame(inner, inner, outer, pressure, modulus)
    low, high = inner + 0.5 * small, inner + 1.02 * small

    def excess(bore):
        return stress_outside(bore, inner, outer, pressure, modulus, steps)[0]

    at_low, at_high = excess(low), excess(high)
    while at_low * at_high > 0:
        high += 0.1 * small
        at_high = excess(high)
    for _ in range(100):
        middle = (low + high) / 2
        value = excess(middle)
        if value * at_low > 0:
            low, at_low = middle, value
        else:
            high = middle
        if high - low < 1e-14 * inner:
            break
    _, radii, places = stress_outside((low + high) / 2, inner, outer, pressure, modulus, steps)
    return radii, places - radii
