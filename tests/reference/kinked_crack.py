"""Paths of a crack under mixed mode with T-stress by linear elastic fracture mechanics: K_II = 0 at the growing tip.

The main crack lies on the negative x axis and is infinitely long. Its kink is a row of elements with constant jumps of
displacement, that is, of dislocations, each with the field of a dislocation beside a crack without tractions.
Muskhelishvili's potentials Phi and Omega give

    s_yy - i s_xy = Phi(z) + Omega(z*) + (z - z*) Phi'(z)*,  s_xx + s_yy = 4 Re Phi,
    2 mu d(u + i v) = kappa Phi(z) dz - Omega(z*) dz* - (dz - dz*) Phi(z)* - (z - z*) (Phi'(z) dz)*,

where * conjugates. The faces of the main crack are free of tractions if Phi+ + Omega- = Phi- + Omega+ = 0 on it, which
powers z^(n/2 - 1) fulfil with Omega = Phi for odd n and Omega = -Phi for even n. In a disk with a given displacement of
the rim, a series of these powers keeps the rim where it is while the crack grows.

Lengths are in horizons and stresses in K / sqrt(horizon), K^2 = K_I^2 + K_II^2. Nothing here is shared with the program.
`/usr/bin/python3 -BEs -m tests.reference.kinked_crack` prints the references of cases/runner/trust/kink.py.
"""

import math

import numpy

ELEMENTS = 4  # in an increment of the path
POWERS, RIM_POINTS = 30, 120  # of the series in a disk
# Jump of the last of many equal elements over that of the crack at its middle; 1.2514 of 80 elements on a straight crack.
TIP_JUMP = math.sqrt(math.pi / 2)


class Sources:
    """Fields Phi(z), Omega(z*), Phi'(z) of some sources at some places, places x sources. Real factors of the sources
    combine them."""

    def __init__(self, phi, omega, dphi):
        self.phi, self.omega, self.dphi = phi, omega, dphi

    def traction(self, z, angle):
        """s_nn + i s_nt on lines through the places z at angles [rad]."""
        z, turn = z[:, None], numpy.exp(2j * angle)[:, None]
        upright = numpy.conj(self.phi + self.omega + (z - z.conj()) * self.dphi.conj())
        mean = 2 * self.phi.real
        return mean + (upright - mean) * turn

    def stretch(self, z, kappa):
        """2 mu d(u + i v) / d angle on a circle about the origin."""
        z = z[:, None]
        d = 1j * z
        return (kappa * self.phi * d - self.omega * d.conj() - (d - d.conj()) * self.phi.conj()
                - (z - z.conj()) * (self.dphi * d).conj())  # fmt: skip


def powers(z, count, radius):
    """z^(n/2 - 1), n from 1 to count, each with the coefficients 1 and i, over their size at a radius."""
    z = z[:, None] / radius
    n = numpy.repeat(numpy.arange(1, count + 1), 2)
    unit = numpy.tile([1, 1j], count)
    even = numpy.where(n % 2, 1, -1)
    return Sources(unit * z ** (n / 2 - 1), even * unit * z.conj() ** (n / 2 - 1), (n / 2 - 1) * unit * z ** (n / 2 - 2) / radius)


def dislocations(z, at, burgers, field):
    """Dislocations at places, with Burgers vectors in units of (kappa + 1) / mu and the potentials of a field."""
    potentials = lambda z: field(z[:, None], at[None, :], burgers / (1j * math.pi))
    phi, _, dphi = potentials(z)
    return Sources(phi, potentials(z.conj())[1], dphi)


def alone(z, c, a):
    """Phi, Omega, Phi' of a dislocation at c in a plane without the main crack."""
    d = c.conj()
    return a / (z - c), a / (z - d) + a.conj() * (c - d) / (z - d) ** 2, -a / (z - c) ** 2


def _potentials(z, c, a):
    """Phi, Omega, Phi' of a dislocation at c, and of the crack's answer F = -(t - S / sqrt(z)) / 2 in both: t = Phi + Omega
    of the dislocation alone, S the principal parts of sqrt(z) t."""
    d = c.conj()
    b = a.conj() * (c - d)
    phi, omega, dphi = alone(z, c, a)
    t, dt = phi + omega, dphi - a / (z - d) ** 2 - 2 * b / (z - d) ** 3
    root, root_c, root_d = numpy.sqrt(z), numpy.sqrt(c), numpy.sqrt(d)
    simple = a * root_d + b / numpy.where(d == 0, 1, 2 * root_d)  # b is 0 where d is
    s = a * root_c / (z - c) + simple / (z - d) + b * root_d / (z - d) ** 2
    ds = -a * root_c / (z - c) ** 2 - simple / (z - d) ** 2 - 2 * b * root_d / (z - d) ** 3
    f, df = -(t - s / root) / 2, -(dt - ds / root + s / (2 * root * z)) / 2
    return phi + f, omega + f, dphi + df


def elements(z, ends, field=_potentials):
    """Elements between successive ends, with the jumps 1 and i of the upper face relative to the lower one, beside the
    main crack or in another field."""
    # Each begins with a dislocation and ends with the opposite one.
    jumps = [dislocations(z, ends, unit * numpy.ones(len(ends)), field) for unit in (1, 1j)]
    interleave = lambda name: numpy.stack([numpy.diff(getattr(of, name)) for of in jumps], 2).reshape(len(z), -1)
    return Sources(*map(interleave, ("phi", "omega", "dphi")))


class Plate:
    """A plate around the main crack with K_I, K_II and T, infinite or a disk whose rim moves as without a kink."""

    def __init__(self, opening, sliding, stress, radius=math.inf, kappa=2.0):
        """@param kappa of plane stress with Poisson's ratio 1/3, as of bonds"""
        self.factors = opening, sliding, stress
        self.radius, self.kappa = radius, kappa
        if math.isfinite(radius):
            angles = numpy.pi * ((2 * numpy.arange(RIM_POINTS) + 1) / RIM_POINTS - 1)
            self.rim = radius * numpy.exp(1j * angles)
            self.inverse = numpy.linalg.pinv(real(powers(self.rim, POWERS, radius).stretch(self.rim, kappa)))

    def intensities(self, ends):
        """K_I, K_II at the tip of the kink through these ends, which begins at 0."""
        sides = numpy.diff(ends)
        middles, angles = 0.5 * (ends[1:] + ends[:-1]), numpy.angle(sides)
        at_middles = lambda sources: real(sources.traction(middles, angles))
        opening, sliding, stress = self.factors
        given = numpy.array([opening, -sliding, 0, 0]) / (2 * math.sqrt(2 * math.pi)) + numpy.array([0, 0, stress / 4, 0])
        applied = at_middles(powers(middles, 2, 1.0)) @ given
        matrix = at_middles(elements(middles, ends))
        if math.isfinite(self.radius):
            on_rim = real(elements(self.rim, ends).stretch(self.rim, self.kappa))
            matrix = matrix - at_middles(powers(middles, POWERS, self.radius)) @ (self.inverse @ on_rim)
        return of_jump(numpy.linalg.solve(matrix, -applied)[-2:], sides[-1])


def of_jump(jump, side):
    """K_I, K_II from the jump of the last element, whose end minus beginning is `side`."""
    turned = jump @ [1, 1j] / (side / abs(side))
    factor = math.sqrt(2 * math.pi / (0.5 * abs(side))) / TIP_JUMP
    return factor * turned.imag, factor * turned.real


def real(values):
    """Complex rows as two real ones each."""
    return numpy.concatenate([values.real, values.imag])


def straight(angle, length, count):
    """Ends of equal elements of a straight kink."""
    return numpy.linspace(0, 1, count + 1) * length * numpy.exp(1j * angle)


def hoop(opening, sliding):
    """Direction of the largest hoop stress, to which K_II = 0 belongs: K_I sin t + K_II (3 cos t - 1) = 0."""
    angles = numpy.linspace(-1.3, 1.3, 26001)
    return angles[numpy.argmax(numpy.cos(angles / 2) ** 2 * (opening * numpy.cos(angles / 2) - 3 * sliding * numpy.sin(angles / 2)))]


def path(plate, length, increment=0.25):
    """Ends of the elements of a crack that grows until its tip is this far from where it began, by increments in the
    direction of the largest hoop stress at its tip."""
    opening, sliding, _ = plate.factors
    return grow(plate, numpy.zeros(1, complex), hoop(opening, sliding), increment, lambda tip: abs(tip) >= length)


def grow(body, ends, angle, increment, is_enough):
    """The ends of a crack that turns to an angle and grows from there until its tip is far enough."""
    while True:
        ends = numpy.append(ends, ends[-1] + straight(angle, increment, ELEMENTS)[1:])
        if is_enough(ends[-1]):
            return ends
        angle += hoop(*body.intensities(ends))


def chord(ends, near, far):
    """Angle [degrees] from 0 to the mean of the elements' middles from `near` to `far`."""
    middles = 0.5 * (ends[1:] + ends[:-1])
    return math.degrees(numpy.angle(middles[(abs(middles) >= near) & (abs(middles) <= far)].sum()))


# K_II / K_I and T sqrt(pi horizon) / K of the benchmark, the inner radius of the ring that moves, and the chord's range.
LOADINGS = [(0.176, 0.0), (0.364, 0.0), (0.577, 0.0), (0.859, 0.0), (0.364, 0.2), (0.364, -0.1), (0.364, -0.2), (0.577, -0.2)]
RADIUS, NEAR, FAR = 10.5, 2.0, 5.0


def reference(sliding, stress, radius=RADIUS, increment=0.25):
    """Chord [degrees] of the path."""
    opening = 1 / math.hypot(1, sliding)
    plate = Plate(opening, sliding * opening, stress / math.sqrt(math.pi), radius)
    return chord(path(plate, FAR, increment), NEAR, FAR)


if __name__ == "__main__":
    print("K_II/K_I  T*    disk    infinite plate")
    for of in LOADINGS:
        print(f"{of[0]:<8} {of[1]:+.1f} {reference(*of):8.2f} {reference(*of, math.inf):8.2f}", flush=True)
