"""A crack from the edge of a plane body of any outline without holes under given tractions, by displacement discontinuities
[Crouch and Starfield 1983]. Crack and outline are rows of elements in an infinite plane. By Somigliana's formula the body's
field is that of its tractions as forces and of its displacements as jumps across the outline; beyond it there is none.

A force X + iY at c has, with a = -(X + iY) / (2 pi (kappa + 1)) and d = c*,

    Phi = a / (z - c),  Omega(w) = -kappa a / (w - d) + a* (c - d) / (w - d)^2,

in the notation of kinked_crack.py. The jump is constant on elements of the crack. On a side of the outline it is linear,
with the slope of the parabola through three neighbours, so that parts that turn are not under stress. Stress intensity
factors do not depend on kappa, because no displacement of the outline is given. Places and stresses may have any units
that fit together.
"""

import numpy

from tests.reference import kinked_crack
from tests.reference.kinked_crack import Sources, real

SHARP = 0.2  # rad; sides that meet at a larger angle are no neighbours


class Body:
    """A body on the left of an outline through corners, each of which is named once, and the normal stresses of its sides
    (tension is positive; there is no shear stress). The loads must be in equilibrium, and the crack begins at the first
    corner."""

    def __init__(self, corners, stresses, kappa=2.0):
        self.outline, self.kappa = numpy.append(corners, corners[0]), kappa
        self.middles, self.angles = _sides(self.outline)
        self.stresses = numpy.asarray(stresses)
        self.slopes = _slopes(self.middles, self.angles)
        self.own = _of_jumps(self.middles, self.angles, self.outline, self.slopes, own=0)
        self.given = numpy.append(self.stresses, numpy.zeros(len(self.middles))) - self._of_loads(self.middles, self.angles, own=0)

    def intensities(self, ends):
        """K_I, K_II at the last end of a crack without tractions through these ends."""
        middles, angles = _sides(ends)
        places, turns = numpy.append(self.middles, middles), numpy.append(self.angles, angles)
        outline, crack = len(self.middles), len(middles)
        size = 2 * (outline + crack)
        on_outline = numpy.append(numpy.arange(outline), outline + crack + numpy.arange(outline))
        on_crack = numpy.delete(numpy.arange(size), on_outline)
        slopes = _slopes(middles, angles)
        slopes[-2 * kinked_crack.ELEMENTS :] = 0  # the factors are those of constant jumps
        matrix, given = numpy.zeros((size + 3, size + 3)), numpy.zeros(size + 3)
        matrix[on_outline, : 2 * outline], given[on_outline] = self.own, self.given
        matrix[on_crack, : 2 * outline] = _of_jumps(middles, angles, self.outline, self.slopes)
        given[on_crack] = -self._of_loads(middles, angles)
        matrix[:-3, 2 * outline : -3] = _of_jumps(places, turns, ends, slopes, own=outline)
        matrix[-3:, : 2 * outline], matrix[on_outline, -3:] = self._rigid()
        return kinked_crack.of_jump(numpy.linalg.solve(matrix, given)[-5:-3], ends[-1] - ends[-2])

    def _of_loads(self, z, angles, own=None):
        """Tractions of the loads as forces."""
        a = self.stresses * 1j * numpy.exp(1j * self.angles) / (2 * numpy.pi * (self.kappa + 1))
        return real(_Spread(z, self.outline, own).sources(a, -self.kappa).traction(z, angles)).sum(axis=1)

    def _rigid(self):
        """Rows that hold the body in the mean of its outline, and columns of tractions that are not in equilibrium, which
        take up what the elements' errors leave of the loads."""
        shift = self.middles - self.middles.mean()
        modes = numpy.stack([numpy.ones(len(shift)), 1j * numpy.ones(len(shift)), 1j * shift / abs(shift).max()])
        rows = numpy.stack([modes.real, modes.imag], 2) * abs(numpy.diff(self.outline))[None, :, None]
        local = (modes / numpy.exp(1j * self.angles)).T  # tangential + i normal
        return rows.reshape(3, -1), numpy.concatenate([local.imag, local.real])


def _of_jumps(z, angles, ends, slopes, own=None):
    """Tractions at places of jumps 1 and i at the middles of elements, which have slopes along the elements."""
    spread, lengths, turning = _Spread(z, ends, own), abs(numpy.diff(ends)), []
    for unit in (1, 1j):
        # A slope: dislocations a / (z - c), and half of their opposite at each end.
        at_ends = kinked_crack.dislocations(z, ends, numpy.full(len(ends), unit), kinked_crack.alone)
        along = spread.sources(-unit / (1j * numpy.pi), 1)
        turning.append([of + 0.5 * lengths * (end[:, 1:] + end[:, :-1]) for of, end in zip(_fields(along), _fields(at_ends))])
    sloping = Sources(*(numpy.stack(of, 2).reshape(len(z), -1) for of in zip(*turning)))
    constant = kinked_crack.elements(z, ends, kinked_crack.alone)
    return real(constant.traction(z, angles)) + real(sloping.traction(z, angles)) @ slopes


class _Spread:
    """Integrals along sides, whose ends are given, of 1 / (z - c), 1 / (z - c)^2 and, conjugate, (c - c*) / (z - c)*^2. A
    place of its own lies on the left of the side; those of the sides in their order begin at the place `own`."""

    def __init__(self, z, ends, own):
        along = numpy.exp(1j * numpy.angle(numpy.diff(ends)))
        near, far = z[:, None] - ends[None, :-1], z[:, None] - ends[None, 1:]
        log = numpy.log(far / near)
        if own is not None:
            numpy.fill_diagonal(log[own:], 1j * numpy.pi)
        self.inverse, self.inverse_square = -log / along, (1 / far - 1 / near) / along
        turn = 1 - along**2  # along a side c - c* = start + turn (z - c)*
        start = (ends[:-1] - ends[:-1].conj())[None, :] - turn * near.conj()
        self.lever = start * self.inverse_square.conj() + turn * self.inverse.conj()

    def sources(self, a, share):
        """Of dislocations (share 1) or forces (share -kappa) per length."""
        omega = share * a * self.inverse.conj() + numpy.conj(a) * self.lever
        return Sources(a * self.inverse, omega, -a * self.inverse_square)


def _slopes(middles, angles):
    """Slopes of the displacements along the sides from those of the sides' middles."""
    is_break = abs(numpy.angle(numpy.exp(1j * numpy.diff(angles)))) > SHARP
    breaks = [0, *(numpy.flatnonzero(is_break) + 1), len(middles)]
    slopes = numpy.zeros((len(middles), len(middles)))
    for begin, end in zip(breaks, breaks[1:]):
        for side in range(begin, end if end - begin > 2 else begin):
            first = min(max(side - 1, begin), end - 3)
            three = [first, first + 1, first + 2]
            at = ((middles[three] - middles[side]) / numpy.exp(1j * angles[side])).real
            slopes[side, three] = numpy.linalg.inv(numpy.vander(at, 3, increasing=True))[1]
    return numpy.kron(slopes, numpy.eye(2))


def _fields(of):
    return of.phi, of.omega, of.dphi


def _sides(ends):
    """Middles and angles of the elements between ends."""
    return 0.5 * (ends[1:] + ends[:-1]), numpy.angle(numpy.diff(ends))
