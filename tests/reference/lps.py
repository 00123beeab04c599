"""The linear peridynamic solid by collocation, with tractions, in NumPy: weights, dilatations, forces, energies.

L u = f - (terms of tractions), linear in u; all in the reference configuration. With xi = x_j - x_i, r = |xi|,
eta = u_j - u_i, d the dimension, K = 1/r up to the horizon, m = int K r^2, k = K weight / m over intact bonds:
    theta_i = d sum k xi.M_i eta,  M_i = [d sum k xi xi]^-1,
    (L u)_i = -sum k [d (lambda - mu) xi (theta_i + theta_j) + 2 d (d + 2) mu xi (xi.eta) / r^2] + theta_i c_theta
The broken bonds are the missing part of the ball, into which u is extrapolated linearly with this theta and the
traction [Yu, You, Trask 2021, 4.1 to 4.9, 5.3 to 5.5, 6.2 to 6.4]. No code is shared with the program.
"""

import itertools
import math

import numpy

CLOSED_BALL = 1 + 1e-8  # includes bonds as long as the horizon
SMALLEST_EIGENVALUE = 1e-11  # relative to the largest; smaller ones of the moment matrix are dropped
CONSTRAINT = 1e-11  # largest error of a moment of the weights
SMALLEST_SHAPE = 1e-10  # relative to the largest eigenvalue; smaller ones are dropped in M
NO_NORMAL = 1e-10  # share of the sum of lengths; shorter sums have no direction


def lame(modulus, poisson, plane="strain"):
    """lambda, mu [Pa] from Young's modulus and Poisson's ratio; plane: "strain" (also 3D) or "stress"."""
    factor = {"strain": 1 - 2 * poisson, "stress": 1 - poisson}[plane]
    return modulus * poisson / ((1 + poisson) * factor), modulus / (2 * (1 + poisson))


def harmonic_mean(first, second):
    """2ab/(a + b), and 0 for two zeros."""
    both = numpy.asarray(first + second, float)
    return numpy.divide(2 * first * second, both, out=numpy.zeros_like(both), where=both != 0)


def critical_stretch(fracture_energy, lame_lambda, mu, horizon):
    """Critical stretch in a plane from the fracture energy [J/m2] (6.3), with beta = beta' = 3 horizon / (4 pi)."""
    return math.sqrt(math.pi * fracture_energy / (3 * horizon * (lame_lambda + mu)))


# Weights of the quadrature


def exponents(dimension, degree):
    """Exponents of the monomials (n, d) that weights integrate exactly: from degree 2 (plane) or 1 (space) to
    `degree`."""
    lowest = 4 - dimension
    every = itertools.product(range(degree + 1), repeat=dimension)
    return numpy.array([power for power in every if lowest <= sum(power) <= degree])


def moment(power):
    """int s^power / |s|^3 ds over the unit ball."""
    if any(exponent % 2 for exponent in power):
        return 0.0
    degree, dimension = sum(power), len(power)
    angles = 2 * math.prod(math.gamma((exponent + 1) / 2) for exponent in power)
    return angles / math.gamma((degree + dimension) / 2) / (degree + dimension - 3)


def quadrature_weights(vectors, horizon, degree=5):
    """Least-norm weights that integrate all s^power / |s|^3 exactly over the ball.

    vectors: (..., neighbours, d), all neighbours in the ball, intact or not. Returns weights (..., neighbours)
    [area or volume], and the largest error of a moment on the unit ball (...)."""
    powers = exponents(vectors.shape[-1], degree)
    scaled = numpy.asarray(vectors) / horizon
    length = numpy.linalg.norm(scaled, axis=-1)[..., None, :]
    matrix = numpy.prod(scaled[..., None, :, :] ** powers[:, None, :], axis=-1) / length**3
    wanted = numpy.array([moment(power) for power in powers])
    left, size, right = numpy.linalg.svd(matrix, full_matrices=False)
    kept = size > math.sqrt(SMALLEST_EIGENVALUE) * size[..., :1]
    amount = numpy.einsum("...nk,n->...k", left, wanted) * kept / numpy.where(kept, size, 1)
    weights = numpy.einsum("...kj,...k->...j", right, amount)
    error = abs(numpy.einsum("...nj,...j->...n", matrix, weights) - wanted).max(axis=-1)
    return weights * horizon ** vectors.shape[-1], error


def weights_of_points(vectors, starts, horizon, degree=5):
    """The same for many points, whose concatenated vectors (bonds, d) begin at `starts`.

    Points with the same neighbours share weights. Returns weights (bonds) and errors (points)."""
    counts = numpy.diff(numpy.append(starts, len(vectors)))
    weights, errors = numpy.zeros(len(vectors)), numpy.zeros(len(starts))
    for count in numpy.unique(counts):
        points = numpy.flatnonzero(counts == count)
        bonds = starts[points, None] + numpy.arange(count)
        rounded = numpy.round(vectors[bonds] / horizon, 12) + 0.0  # no negative zeros
        order = numpy.lexsort(numpy.moveaxis(rounded, -1, 0), axis=-1)
        bonds = numpy.take_along_axis(bonds, order, 1)
        rounded = numpy.take_along_axis(rounded, order[..., None], 1).reshape(len(points), -1)
        _, own, shared = numpy.unique(rounded, axis=0, return_index=True, return_inverse=True)
        for part in numpy.array_split(numpy.arange(len(own)), len(own) // 2000 + 1):
            found, error = quadrature_weights(vectors[bonds[own[part]]], horizon, degree)
            uses = numpy.flatnonzero((shared >= part[0]) & (shared <= part[-1]))
            weights[bonds[uses]] = found[shared[uses] - part[0]]
            errors[points[uses]] = error[shared[uses] - part[0]]
    return weights, errors


def neighbours(places, radius, rows):
    """Bonds (first, second) from each of the rows (point numbers, ascending) to all points in the closed ball."""
    pairs = []
    for block in numpy.array_split(rows, len(rows) // 200 + 1):
        low, high = places[block].min(axis=0) - 1.1 * radius, places[block].max(axis=0) + 1.1 * radius
        near = numpy.flatnonzero(((places >= low) & (places <= high)).all(axis=1))
        squared = ((places[block][:, None] - places[near]) ** 2).sum(axis=-1)
        first, second = numpy.nonzero(squared <= (radius * CLOSED_BALL) ** 2)
        pairs.append(numpy.stack([block[first], near[second]]))
    first, second = numpy.concatenate(pairs, axis=1)
    return first[first != second], second[first != second]


# The missing part of a ball


def missing_ball(vectors, shares, normal, lame_lambda, mu, form="full"):
    """The effect of one point's broken bonds: c_theta (d), and C (d, d), where C T is added to its forces.

    shares: K weight / m of these bonds. normal: outward unit vector; if it is zero, tractions and the stress that
    follows from them are dropped. form: "full", or "paper", which keeps those parts of xi xi xi that are invariant
    under reflection of the ball along its normal: (4.6). In space the two tangential strains are equal."""
    d = len(normal)
    across = numpy.outer(normal, normal)
    along = numpy.eye(d) * (normal @ normal) - across
    odd = _third_moment(vectors, shares)
    if form == "paper":
        mirrored = 2 * (vectors @ normal)[:, None] * normal - vectors
        odd = (odd + _third_moment(mirrored, shares)) / 2
    elif form != "full":
        raise ValueError(f"form is full or paper, not {form}")

    def force(shear_times_strain):
        return -2 * d * (d + 2) * numpy.einsum("abc,bc->a", odd, shear_times_strain)

    # mu E is T_n/2 - lambda theta/2 along the normal; the tangents share the rest of mu theta.
    of_dilatation = -lame_lambda / 2 * across + (mu + lame_lambda / 2) / (d - 1) * along
    of_normal_traction = across / 2 - along / (2 * (d - 1))
    c_theta = -2 * d * (lame_lambda - mu) * (shares @ vectors) + force(of_dilatation)
    c_traction = numpy.zeros((d, d))
    for k, unit in enumerate(numpy.eye(d)):
        tangent = along @ unit
        shear = (numpy.outer(normal, tangent) + numpy.outer(tangent, normal)) / 2
        c_traction[:, k] = force(normal[k] * of_normal_traction + shear)
    return c_theta, c_traction


def _third_moment(vectors, shares):
    return numpy.einsum("j,ja,jb,jc->abc", shares / (vectors**2).sum(axis=1), vectors, vectors, vectors)


class Solid:
    """Points of three kinds: body (with equations), collar (given displacements; 2 horizons deep) and ghosts, which
    only

    contribute weights (1 horizon deep behind surfaces with tractions).
    `points`: numbers of the body's points, which have forces and tractions; `rows`: numbers of all points with a
    dilatation (the body and the ends of its intact bonds), which have bonds."""

    def __init__(self, places, horizon, body, lame_lambda, mu, *, collar=None, broken=(), normals=None, form="full",
                 degree=5, volume=1.0):  # fmt: skip
        """places (n, d); body, collar: masks (n); lame_lambda, mu: numbers or per point [Pa]; broken: pairs of
        points, cut in both directions; normals: (n, d) in place of the numerical ones; volume per point."""
        self.places, self.horizon = numpy.asarray(places, float), horizon
        count, self.dimension = self.places.shape
        body = numpy.asarray(body, bool)
        self.carries = body if collar is None else body | collar
        self.points = numpy.flatnonzero(body)
        self.lame_lambda, self.mu, self.volume = (numpy.broadcast_to(v, count) for v in (lame_lambda, mu, volume))

        cut = self._codes(numpy.reshape(numpy.array(broken, int), (-1, 2)))
        first, second = neighbours(self.places, horizon, self.points)
        self.rows = numpy.unique(numpy.append(self.points, second[self._intact(first, second, cut)]))
        self.first, self.second = neighbours(self.places, horizon, self.rows)
        self.intact = self._intact(self.first, self.second, cut)
        self.row = numpy.full(count, -1)  # of a point
        self.row[self.rows] = numpy.arange(len(self.rows))

        counts = numpy.bincount(self.row[self.first], minlength=len(self.rows))
        if not counts.all():
            raise ValueError(f"point {self.rows[counts == 0][0]} has no neighbours")
        self.starts = numpy.append(0, numpy.cumsum(counts)[:-1])
        self.vectors = self.places[self.second] - self.places[self.first]
        self.weights, self.errors = weights_of_points(self.vectors, self.starts, horizon, degree)
        if self.errors.max() > CONSTRAINT:
            worst = self.errors.argmax()
            told = f"point {self.rows[worst]} with {counts[worst]} neighbours"
            raise ValueError(f"weights of {told} miss a moment by {self.errors[worst]}")

        length = numpy.linalg.norm(self.vectors, axis=1)
        moment = 2 * math.pi / 3 * horizon**3 if self.dimension == 2 else math.pi * horizon**4
        share = self.weights / (length * moment)
        self.share, self.missing = share * self.intact, share * ~self.intact
        self.direction = self.vectors / length[:, None]
        self.shape = self._shape()
        self.normals = self._normals() if normals is None else numpy.asarray(normals, float)[self.rows]
        self.mean_lambda = harmonic_mean(self.lame_lambda[self.first], self.lame_lambda[self.second])
        self.mean_mu = harmonic_mean(self.mu[self.first], self.mu[self.second])
        self._continue_beyond(form)

    def _codes(self, pairs):
        low, high = pairs.min(axis=1), pairs.max(axis=1)
        return numpy.unique(low * len(self.places) + high)

    def _intact(self, first, second, cut):
        codes = numpy.minimum(first, second) * len(self.places) + numpy.maximum(first, second)
        return self.carries[first] & self.carries[second] & ~numpy.isin(codes, cut)

    def _sum(self, values):
        """Sums over the bonds of each row."""
        return numpy.add.reduceat(values, self.starts, axis=0)

    def _shape(self):
        """M of every row (4.8)."""
        outer = self.share[:, None, None] * self.vectors[:, :, None] * self.vectors[:, None, :]
        return numpy.linalg.pinv(self.dimension * self._sum(outer), rcond=SMALLEST_SHAPE, hermitian=True)

    def _normals(self):
        """Normal away from the intact bonds (4.9); zero if their sum has no direction."""
        intact = (self.weights * self.intact)[:, None] * self.vectors
        total, size = -self._sum(intact), self._sum(numpy.linalg.norm(intact, axis=1))
        length = numpy.linalg.norm(total, axis=1)
        directed = length > NO_NORMAL * size
        return total * (directed / numpy.where(directed, length, 1))[:, None]

    def _continue_beyond(self, form):
        """c_theta (points, d) and c_traction (points, d, d) of the body; zero where no bond is broken."""
        d = self.dimension
        self.c_theta, self.c_traction = numpy.zeros((len(self.points), d)), numpy.zeros((len(self.points), d, d))
        ends = numpy.append(self.starts, len(self.first))
        for k, point in enumerate(self.points):
            row = self.row[point]
            bonds = numpy.arange(ends[row], ends[row + 1])
            bonds = bonds[~self.intact[bonds]]
            if len(bonds):
                of_bonds, moduli = (self.vectors[bonds], self.missing[bonds]), (self.lame_lambda[point], self.mu[point])
                self.c_theta[k], self.c_traction[k] = missing_ball(*of_bonds, self.normals[row], *moduli, form)

    @property
    def has_surface(self):
        """For each point of the body, whether any of its bonds is broken."""
        return self._sum((~self.intact).astype(int))[self.row[self.points]] > 0

    @property
    def c_normal(self):
        """Force due to T_n = 1 (points, d)."""
        return numpy.einsum("iab,ib->ia", self.c_traction, self.normals[self.row[self.points]])

    @property
    def c_tangent(self):
        """In a plane: force due to T_p = 1, where p is the normal turned by +90 degrees (points, d)."""
        normal = self.normals[self.row[self.points]]
        return numpy.einsum("iab,ib->ia", self.c_traction, numpy.stack([-normal[:, 1], normal[:, 0]], 1))

    def _relative(self, displacement):
        """eta of intact bonds, 0 of others: displacements of ghosts are never used."""
        displacement = numpy.asarray(displacement, float)
        relative = numpy.zeros_like(self.vectors)
        relative[self.intact] = displacement[self.second[self.intact]] - displacement[self.first[self.intact]]
        return relative

    def gradient(self, displacement):
        """du_a/dx_b of every row (rows, d, d), exact for linear displacements; its trace is theta."""
        outer = self.share[:, None, None] * self._relative(displacement)[:, :, None] * self.vectors[:, None, :]
        return self.dimension * self._sum(outer) @ self.shape

    def dilatation(self, displacement):
        """theta of every row."""
        turned = numpy.einsum("iab,ib->ia", self.shape[self.row[self.first]], self._relative(displacement))
        return self.dimension * self._sum(self.share * (self.vectors * turned).sum(axis=1))

    def strain(self, displacement):
        """Strain of every row (rows, d, d)."""
        gradient = self.gradient(displacement)
        return (gradient + gradient.transpose(0, 2, 1)) / 2

    def stress(self, displacement):
        """lambda theta I + 2 mu E of every row (rows, d, d) [Pa], in the plane."""
        strain = self.strain(displacement)
        pressure = self.lame_lambda[self.rows] * numpy.trace(strain, axis1=1, axis2=2)
        return pressure[:, None, None] * numpy.eye(self.dimension) + 2 * self.mu[self.rows, None, None] * strain

    def forces(self, displacement):
        """L u at the points of the body (points, d) [N/m3], with c_theta, without tractions."""
        d = self.dimension
        theta = self.dilatation(displacement)
        of_second = numpy.where(self.intact, theta[self.row[self.second]], 0)
        both = theta[self.row[self.first]] + of_second
        along = (self.direction * self._relative(displacement)).sum(axis=1)
        volumetric = (d * (self.mean_lambda - self.mean_mu) * both)[:, None] * self.vectors
        bond = (2 * d * (d + 2) * self.mean_mu * along)[:, None] * self.direction
        own = self.row[self.points]
        return -self._sum(self.share[:, None] * (volumetric + bond))[own] + theta[own, None] * self.c_theta

    def traction_terms(self, tractions):
        """T_n c_n + T_p c_p at the points of the body (points, d), from T at each of them (points, d) [Pa]."""
        return numpy.einsum("iab,ib->ia", self.c_traction, tractions)

    def residual(self, displacement, body_force=0.0, tractions=None):
        """L u + T_n c_n + T_p c_p - f at the points of the body (points, d) [N/m3]: zero in equilibrium."""
        of_tractions = 0 if tractions is None else self.traction_terms(tractions)
        return self.forces(displacement) + of_tractions - body_force

    def energy_density(self, displacement):
        """w of every row [J/m3]: half of the printed W_delta.

        Forces are its derivative only on a whole lattice of a single material."""
        d = self.dimension
        along = (self.direction * self._relative(displacement)).sum(axis=1)
        bonds = d * (d + 2) / 2 * self._sum(self.share * self.mean_mu * along**2)
        coefficient = self.lame_lambda[self.rows] - self.mu[self.rows]
        return coefficient / 2 * self.dilatation(displacement) ** 2 + bonds

    def energy(self, displacement):
        """Sum over all rows [J]."""
        return (self.volume[self.rows] * self.energy_density(displacement)).sum()

    def stretches(self, displacement):
        """s of every bond (6.2), 0 for bonds that are not intact."""
        relative, length = self._relative(displacement), numpy.linalg.norm(self.vectors, axis=1)
        moved = numpy.linalg.norm(self.vectors + relative, axis=1)
        return ((2 * self.vectors + relative) * relative).sum(axis=1) / (length * (moved + length))

    def damage(self):
        """Broken share of the bonds between points with displacements, for the points of the body (6.4)."""
        inside = self.carries[self.second]
        broken = self._sum((inside & ~self.intact).astype(float)) / self._sum(inside.astype(float))
        return broken[self.row[self.points]]

    def operators(self):
        """Blocks of forces = A u + B theta, theta = D u: (row, column, value) of each; repeated positions add up.

        A: (points, all points, (d, d)); B: (points, rows, (d)); D: (rows, all points, (d))."""
        d, place = self.dimension, numpy.full(len(self.places), -1)
        place[self.points] = numpy.arange(len(self.points))
        turned = d * self.share[:, None] * numpy.einsum("iab,ib->ia", self.shape[self.row[self.first]], self.vectors)
        on = self.intact
        of_theta = _both_ends(self.row[self.first[on]], self.second[on], self.first[on], turned[on], -1)
        on = self.intact & (place[self.first] >= 0)
        first, own = self.first[on], place[self.first[on]]
        stiffness = -2 * d * (d + 2) * (self.share * self.mean_mu)[on]
        blocks = stiffness[:, None, None] * self.direction[on, :, None] * self.direction[on, None, :]
        of_force = _both_ends(own, self.second[on], first, blocks, -1)
        volumetric = -d * (self.share * (self.mean_lambda - self.mean_mu))[on, None] * self.vectors[on]
        bonds = _both_ends(own, self.row[self.second[on]], self.row[first], volumetric, 1)
        beyond = numpy.arange(len(self.points)), self.row[self.points], self.c_theta
        return of_force, tuple(numpy.concatenate(two) for two in zip(bonds, beyond)), of_theta

    def matrix(self):
        """Dense (d points, d all points): forces.ravel() = matrix @ displacement.ravel()."""
        d, (force, coupling, theta) = self.dimension, self.operators()
        a = numpy.zeros((len(self.points), d, len(self.places), d))
        b = numpy.zeros((len(self.points), d, len(self.rows)))
        t = numpy.zeros((len(self.rows), len(self.places), d))
        numpy.add.at(a, (force[0], slice(None), force[1]), force[2])
        numpy.add.at(b, (coupling[0], slice(None), coupling[1]), coupling[2])
        numpy.add.at(t, theta[:2], theta[2])
        size = d * len(self.places)
        return a.reshape(-1, size) + b.reshape(-1, len(self.rows)) @ t.reshape(-1, size)


def _both_ends(row, second, first, values, sign):
    """Scatters values to the far ends of bonds and, with a sign, to their near ends."""
    return numpy.append(row, row), numpy.append(second, first), numpy.concatenate([values, sign * values])
