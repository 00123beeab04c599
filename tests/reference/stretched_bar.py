"""Uniaxial tension of the state-based solid in the continuum, K = 1/r, at any stretch.

With F = diag(a, b, b) and the stretch s = |F n| - 1 of a bond along n, <> the mean over directions, d the dimension,
    W = (lambda - mu) / 2 d^2 <s>^2 + mu d (d + 2) / 2 <s^2>,
b is such that W is least, and the nominal stress is dW/da. The tangent at rest is Young's modulus.
"""

import math

import numpy


def nominal_stress(stretch, poisson_ratio, dimension=2):
    """Nominal stress over Young's modulus, in plane stress or in 3D."""
    nu, d = poisson_ratio, dimension
    mu = 1 / (2 * (1 + nu))
    lam = nu / (1 - nu**2) if d == 2 else nu / ((1 + nu) * (1 - 2 * nu))
    cosine, weight = directions(d)

    def energy(b):
        s = numpy.sqrt((stretch * cosine) ** 2 + b**2 * (1 - cosine**2)) - 1
        return (lam - mu) / 2 * d**2 * (weight @ s) ** 2 + mu * d * (d + 2) / 2 * (weight @ s**2)

    low, high = 0.3, 1.5
    for _ in range(100):  # golden section would do; thirds are simpler
        first, second = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, second) if energy(first) < energy(second) else (first, high)
    b = (low + high) / 2
    current = numpy.sqrt((stretch * cosine) ** 2 + b**2 * (1 - cosine**2))
    s, ds = current - 1, stretch * cosine**2 / current
    return (lam - mu) * d**2 * (weight @ s) * (weight @ ds) + mu * d * (d + 2) * (weight @ (s * ds))


def directions(dimension, count=400):
    """Cosines with the axis, and their weights in a mean over directions."""
    if dimension == 2:
        return numpy.cos(math.pi * (numpy.arange(count) + 0.5) / count), numpy.full(count, 1 / count)
    nodes, weights = numpy.polynomial.legendre.leggauss(count)
    return nodes, weights / 2
