"""A plate with a crack in its middle, pulled at right angles to it: stress intensity factor and T-stress.

Potentials of Muskhelishvili that leave the crack free of stress, Phi = f(z)/sqrt(z^2 - a^2) + g(z) and Omega =
f/sqrt(z^2 - a^2) - g with an odd f and an even g, fitted to the stresses of the edges (boundary collocation). Then
K_I = 2 f(a) sqrt(pi/a) and T = 4 g(a)."""

import numpy


def centre_crack(half_length, half_width, half_height, terms=20, places=400):
    """K_I over (stress times the root of pi a), T over the stress, and the largest error of an edge's stress."""
    a, reach = half_length, abs(complex(half_width, half_height))
    along = (numpy.arange(places) + 0.5) / places
    z = numpy.concatenate([half_width + 1j * half_height * along, half_width * along + 1j * half_height])
    is_pulled = numpy.arange(2 * places) >= places
    root = lambda x: numpy.sqrt(x - a) * numpy.sqrt(x + a)
    columns, tips = [], []
    for sign, first in ((1, 1), (-1, 0)):  # f and g
        for power in range(first, first + 2 * terms, 2):
            term = lambda x: (x / reach) ** power
            slope = lambda x: power / reach * (x / reach) ** (power - 1) if power else 0 * x
            value = (lambda x: term(x) / root(x)) if sign > 0 else term
            rise = (lambda x: slope(x) / root(x) - term(x) * x / root(x) ** 3) if sign > 0 else slope
            across = value(z) + sign * value(z.conj()) + (z - z.conj()) * rise(z).conj()  # sigma_yy - i sigma_xy
            along_x = 4 * value(z).real - across.real
            columns.append(numpy.concatenate([numpy.where(is_pulled, across.real, along_x), across.imag]))
            tips.append((2 / a * term(a), 0.0) if sign > 0 else (0.0, 4 * term(a)))
    wanted = numpy.concatenate([is_pulled, 0 * is_pulled]).astype(float)
    columns = numpy.array(columns).T
    shares = numpy.linalg.lstsq(columns, wanted, rcond=None)[0]
    return (*(shares @ numpy.array(tips)), abs(columns @ shares - wanted).max())
