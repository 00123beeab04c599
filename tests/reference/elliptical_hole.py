"""Stress beside an elliptical hole in a plate under tension across its semi-axis a [Inglis 1913] [Tan 1988]."""

import numpy as np


def stress_beside(x, a, b):
    """Stress along y on the x axis, at x >= a, over that far away along y, in an infinite plate.

    By Muskhelishvili's potentials of the map z = R (w + m/w), R = (a + b)/2, m = (a - b)/(a + b):

        phi = R/4 (w - (2 + m)/w),   psi' = -R/2 (-1 + 1/(m w^2) + (1 + m^2) (1 + m)/m d/dw (w/(w^2 - m)))
    """
    size, m = (a + b) / 2, (a - b) / (a + b)
    z = np.asarray(x, dtype=float)
    w = (z + np.sqrt(z * z - 4 * size**2 * m)) / (2 * size)
    map_1, map_2 = size * (1 - m / w**2), size * 2 * m / w**3
    phi_1, phi_2 = size / 4 * (1 + (2 + m) / w**2), -size / 2 * (2 + m) / w**3
    last = (1 + m * m) * (1 + m) / m * (-(w**2) - m) / (w**2 - m) ** 2
    psi_1 = -size / 2 * (-1 + 1 / (m * w**2) + last)
    curvature = (phi_2 * map_1 - phi_1 * map_2) / map_1**3
    return 2 * phi_1 / map_1 + z * curvature + psi_1 / map_1


def factor_of_width(a, b, width):
    """Stress at the hole in a strip of a width over that in an infinite plate, both over the gross stress."""
    ratio, share = b / a, 2 * a / width
    root = np.sqrt(1 + (ratio**2 - 1) * share**2)
    inverse = ratio**2 + (1 - 2 * ratio) * root - ratio**2 * (1 - ratio) * share**2 / root
    return (1 - ratio) ** 2 / inverse


def fitted_concentration(places, stress, a, b, horizon, spacing):
    """Concentration by the amplitude of Inglis' stresses that fits points beside the axis, from one to four horizons
    off the tip, where the layer of softer surface has ended: 1 + 2 a/b times the mean ratio."""
    x, y = np.asarray(places)[:, :2].T
    near = (np.abs(y) < spacing) & (x > a + horizon) & (x < a + 4 * horizon)
    return (1 + 2 * a / b) * float(np.mean(np.asarray(stress)[near] / stress_beside(x[near], a, b)))
