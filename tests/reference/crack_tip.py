"""J, stress intensity factors and T-stress at a crack tip (docs/theory.md, Fracture quantities)."""

import numpy

STEP = 1e-3  # shift for the derivative of the energies, over the spacing


class Elasticity:
    """Elastic constants for plane stress, or for plane strain and space."""

    def __init__(self, modulus, poisson, is_thin):
        self.shear = modulus / (2 * (1 + poisson))
        self.kolosov = (3 - poisson) / (1 + poisson) if is_thin else 3 - 4 * poisson
        self.plane = modulus if is_thin else modulus / (1 - poisson**2)


def frame(tip, dimension):
    ahead = numpy.zeros(3)
    ahead[:dimension] = tip["direction"]
    front = numpy.array(tip.get("front", [0, 0, 1]), float)
    ahead, front = ahead / numpy.linalg.norm(ahead), front / numpy.linalg.norm(front)
    return numpy.stack([ahead, numpy.cross(front, ahead), front])


def displacement(mode, at, elasticity, still):
    """Fields of the modes 0, 1, 2 with the factor 1, or (3) of a force of 1 N/m on the tip, in the tip's frame."""
    x, y = at[:, 0], at[:, 1]
    r, angle = numpy.hypot(x, y), numpy.arctan2(y, x)
    sine, cosine, k = numpy.sin(angle / 2), numpy.cos(angle / 2), elasticity.kolosov
    size = numpy.sqrt(r / (2 * numpy.pi)) / (2 * elasticity.shear)
    zero = numpy.zeros(len(at))
    if mode == 0:
        return numpy.stack([size * cosine * (k - 1 + 2 * sine**2), size * sine * (k + 1 - 2 * cosine**2), zero], 1)
    if mode == 1:
        return numpy.stack([size * sine * (k + 1 + 2 * cosine**2), -size * cosine * (k - 1 - 2 * sine**2), zero], 1)
    if mode == 2:
        return numpy.stack([zero, zero, 4 * size * sine], 1)
    nu = (3 - k) / (1 + k)
    along = numpy.log(r / still) + (1 + nu) / 2 * numpy.sin(angle) ** 2
    across = ((1 - nu) * angle - (1 + nu) * numpy.sin(angle) * numpy.cos(angle)) / 2
    return -numpy.stack([along, across, zero], 1) / (numpy.pi * elasticity.plane)


class CrackTip:
    def __init__(self, mechanics, tip, elasticity, inner, outer, history=None):
        body = mechanics.body
        self.mechanics, self.body, self.elasticity = mechanics, body, elasticity
        self.history = mechanics.no_history() if history is None else history
        self.outer = outer
        self.dimension = body.reference.shape[1]
        self.frame = frame(tip, self.dimension)
        places = numpy.zeros((len(body.reference), 3))
        places[:, : self.dimension] = body.reference - numpy.array(tip["at"])
        self.at = places @ self.frame.T
        r = numpy.hypot(self.at[:, 0], self.at[:, 1])
        fraction = numpy.clip((r - inner) / (outer - inner), 0, 1)
        self.q = 1 - fraction**2 * (3 - 2 * fraction)
        self.slope = -6 * fraction * (1 - fraction) / (outer - inner) * self.at[:, 0] / r
        self.spacing = mechanics.case.spacing(body.volume)
        near = r < outer
        self.length = mechanics.case.cross_section if self.dimension == 2 else numpy.ptp(self.at[near, 2]) + self.spacing

    def energies(self, u):
        """Energy density per point."""
        shares = numpy.zeros(len(u))
        for order, part in self.mechanics.energies(u, self.history).items():
            for k in range(order + 1):
                shares += numpy.bincount(self.body.tuples[order][:, k], part / (order + 1), len(u))
        return shares

    def translation(self, u):
        """(F - I) e1 by least squares over unbroken bonds."""
        i, j = self.body.bonds[~self.mechanics.is_broken(self.history)].T
        weight = self.body.weight[1][~self.mechanics.is_broken(self.history)]
        arm, change = self.body.reference[j] - self.body.reference[i], u[j] - u[i]
        d, n = self.dimension, len(u)
        moments, products = numpy.zeros((n, d, d)), numpy.zeros((n, d, d))
        for a in range(d):
            for b in range(d):
                for total, left in ((moments, arm), (products, change)):
                    part = weight * left[:, a] * arm[:, b]
                    total[:, a, b] = numpy.bincount(i, part, n) + numpy.bincount(j, part, n)
        return products @ numpy.linalg.inv(moments) @ self.frame[0, :d]

    def flux(self, u):
        along = self.translation(u)
        shift = STEP * self.spacing
        ahead, behind = self.energies(u + shift * along), self.energies(u - shift * along)
        work = (self.mechanics.gradient(u, self.history, held=True) * along).sum(axis=1)
        return ((self.q * (work - (ahead - behind) / (2 * shift))).sum() - (self.slope * self.energies(u)).sum()) / self.length

    def interaction(self, u, mode):
        field = (displacement(mode, self.at, self.elasticity, self.outer) @ self.frame)[:, : self.dimension]
        size = numpy.abs(u).max() / numpy.abs(field).max()
        return (self.flux(u + size * field) - self.flux(u - size * field)) / (2 * size)

    def values(self, u):
        factor = [self.elasticity.plane / 2, self.elasticity.plane / 2, self.elasticity.shear, self.elasticity.plane]
        names = ["K1", "K2", "K3", "T"] if self.dimension == 3 else ["K1", "K2", None, "T"]
        found = {name: factor[mode] * self.interaction(u, mode) for mode, name in enumerate(names) if name}
        k = numpy.hypot(found["K1"], found["K2"])
        found["T_star"] = found["T"] * numpy.sqrt(numpy.pi * self.mechanics.case.horizon()) / k
        return {"J": self.flux(u)} | found
