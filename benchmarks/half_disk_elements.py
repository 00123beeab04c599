"""The crack of `trust inclined_notch` by finite elements: the largest hoop stress from increment to increment, beside the
path of tests/reference/half_disk.py, with which it shares nothing.

    /usr/bin/python3 -m benchmarks.half_disk_elements [INCREMENT in mm, default 1]

Triangles of second order on meshes of gmsh around the growing crack, which is a wedge 4 micrometres wide at its mouth;
stress intensity factors by the interaction integral over a ring. Needs python3-scipy and python3-gmsh.
"""

import cmath
import math
import sys

import gmsh
import numpy
import scipy.sparse
import scipy.sparse.linalg

RADIUS, SUPPORT, NOTCH, INCLINED, HEIGHT = 50.0, 21.5, 15.0, math.radians(30), 31.0  # mm
POISSON_RATIO = 1 / 3
SHEAR, KAPPA = 1 / (2 * (1 + POISSON_RATIO)), (3 - POISSON_RATIO) / (1 + POISSON_RATIO)  # of the modulus 1, plane stress
STIFFNESS = numpy.array([[1, POISSON_RATIO, 0], [POISSON_RATIO, 1, 0], [0, 0, (1 - POISSON_RATIO) / 2]]) / (1 - POISSON_RATIO**2)
FINEST, GROWTH, COARSEST, CONTACT, HALF_MOUTH = 0.12, 0.12, 2.5, 0.3, 2e-3  # mm, -, mm, mm, mm
AT = [(1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)]  # of the triangle's quadrature, each with the weight 1/6


def mesh(crack):
    """Nodes and triangles with six nodes each."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Terminal", 0)
    geometry = gmsh.model.geo
    point = lambda z, size: geometry.addPoint(z.real, z.imag, 0, size)
    by_tip = lambda z: min(COARSEST, FINEST + GROWTH * abs(z - crack[-1]))
    across = 1j * numpy.gradient(crack) / abs(numpy.gradient(crack)) * HALF_MOUTH * numpy.linspace(1, 0, len(crack))
    across[0] = -HALF_MOUTH
    left, right = ([point(z, by_tip(z)) for z in (crack + side * across)[:-1]] for side in (1, -1))
    tip, centre, top = point(crack[-1], 0.5 * FINEST), point(0j, COARSEST), point(1j * RADIUS, CONTACT)
    ends = [point(complex(x, 0), CONTACT if abs(x) < RADIUS else COARSEST) for x in (SUPPORT, RADIUS, -RADIUS, -SUPPORT)]
    chains = [[right[0], *ends[:2]], [*ends[2:], *left, tip, *right[::-1]]]
    lines = [[geometry.addLine(a, b) for a, b in zip(chain, chain[1:])] for chain in chains]
    arcs = [geometry.addCircleArc(ends[1], centre, top), geometry.addCircleArc(top, centre, ends[2])]
    geometry.addPlaneSurface([geometry.addCurveLoop([*lines[0], *arcs, *lines[1]])])
    geometry.synchronize()
    gmsh.option.setNumber("Mesh.Algorithm", 5)
    gmsh.model.mesh.generate(2)
    gmsh.model.mesh.setOrder(2)
    tags, places, _ = gmsh.model.mesh.getNodes()
    number = numpy.zeros(int(tags.max()) + 1, int)
    number[tags.astype(int)] = numpy.arange(len(tags))
    triangles = number[gmsh.model.mesh.getElements(2)[2][0].astype(int)].reshape(-1, 6)
    gmsh.finalize()
    used, renumbered = numpy.unique(triangles, return_inverse=True)
    return places.reshape(-1, 3)[used, :2], renumbered.reshape(-1, 6)


def gradients(places, a, b):
    """Shape functions, their gradients in each triangle, and the weights of a point of the quadrature."""
    c = 1 - a - b
    shape = numpy.array([c * (2 * c - 1), a * (2 * a - 1), b * (2 * b - 1), 4 * a * c, 4 * a * b, 4 * b * c])
    local = numpy.array([[1 - 4 * c, 1 - 4 * c], [4 * a - 1, 0], [0, 4 * b - 1], [4 * (c - a), -4 * a], [4 * b, 4 * a], [-4 * b, 4 * (c - b)]])
    jacobian = numpy.einsum("eni,nj->eij", places, local)
    return shape, numpy.einsum("nj,eji->eni", local, numpy.linalg.inv(jacobian)), numpy.linalg.det(jacobian) / 6


def solve(nodes, triangles):
    """Displacements under the load 1."""
    stiffness = numpy.zeros((len(triangles), 12, 12))
    for at in AT:
        _, gradient, weight = gradients(nodes[triangles], *at)
        strain = numpy.zeros((len(triangles), 3, 12))
        strain[:, 0, 0::2], strain[:, 1, 1::2] = gradient[:, :, 0], gradient[:, :, 1]
        strain[:, 2, 0::2], strain[:, 2, 1::2] = gradient[:, :, 1], gradient[:, :, 0]
        stiffness += numpy.einsum("eki,kl,elj,e->eij", strain, STIFFNESS, strain, weight)
    of = numpy.stack([2 * triangles, 2 * triangles + 1], 2).reshape(-1, 12)
    rows, columns = numpy.repeat(of, 12, 1).ravel(), numpy.tile(of, (1, 12)).ravel()
    matrix = scipy.sparse.coo_matrix((stiffness.ravel(), (rows, columns)), shape=(2 * len(nodes),) * 2).tocsc()
    nearest = lambda x, y: int(numpy.argmin(abs(nodes - [x, y]).sum(axis=1)))
    top, left, right = nearest(0, RADIUS), nearest(-SUPPORT, 0), nearest(SUPPORT, 0)
    free = numpy.setdiff1d(numpy.arange(2 * len(nodes)), [2 * left + 1, 2 * right + 1, 2 * top])
    force = numpy.zeros(2 * len(nodes))
    force[2 * top + 1] = -1
    moved = numpy.zeros(2 * len(nodes))
    moved[free] = scipy.sparse.linalg.spsolve(matrix[free][:, free], force[free])
    return moved.reshape(-1, 2)


def williams(mode, x, y):
    """Displacements around the tip with K = 1."""
    r, t = numpy.hypot(x, y), numpy.arctan2(y, x)
    parts = [(KAPPA - numpy.cos(t)) * numpy.array([numpy.cos(t / 2), numpy.sin(t / 2)]),
             numpy.array([(KAPPA + 2 + numpy.cos(t)) * numpy.sin(t / 2), (2 - KAPPA - numpy.cos(t)) * numpy.cos(t / 2)])]  # fmt: skip
    return numpy.sqrt(r / (2 * math.pi)) / (2 * SHEAR) * parts[mode]


def factors(nodes, triangles, moved, tip, angle, inner, outer):
    """K_I, K_II by the interaction integral over the ring between two radii around the tip."""
    turn = numpy.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    x, u = (nodes - [tip.real, tip.imag]) @ turn.T, moved @ turn.T
    q = numpy.clip((outer - numpy.hypot(*x.T)) / (outer - inner), 0, 1)[triangles]
    ring = (q.max(axis=1) > 0) & (q.min(axis=1) < 1)
    found = numpy.zeros(2)
    for at in AT:
        shape, gradient, weight = gradients(x[triangles][ring], *at)
        own = numpy.einsum("eni,enj->eij", u[triangles][ring], gradient)
        along = numpy.einsum("en,enj->ej", q[ring], gradient)
        places, step = numpy.einsum("n,eni->ie", shape, x[triangles][ring]), 1e-5
        for mode in (0, 1):
            field = lambda dx, dy: williams(mode, places[0] + dx, places[1] + dy)
            other = numpy.stack([field(step, 0) - field(-step, 0), field(0, step) - field(0, -step)], 1).T / (2 * step)
            other = other.transpose(0, 2, 1)
            of_own, of_other = stress(own), stress(other)
            both = numpy.einsum("eij,ei->ej", of_own, other[:, :, 0]) + numpy.einsum("eij,ei->ej", of_other, own[:, :, 0])
            both[:, 0] -= numpy.einsum("eij,eij->e", of_own, other)
            found[mode] += numpy.einsum("ej,ej,e->", both, along, weight) / 2
    return found


def stress(gradient):
    xx, yy, xy = STIFFNESS @ numpy.array([gradient[:, 0, 0], gradient[:, 1, 1], gradient[:, 0, 1] + gradient[:, 1, 0]])
    return numpy.array([[xx, xy], [xy, yy]]).transpose(2, 0, 1)


def hoop(opening, sliding):
    """Direction of the largest hoop stress."""
    t = numpy.linspace(-1.3, 1.3, 26001)
    return t[numpy.argmax(numpy.cos(t / 2) ** 2 * (opening * numpy.cos(t / 2) - 3 * sliding * numpy.sin(t / 2)))]


def main(increment):
    angle = math.pi / 2 - INCLINED
    crack = [0j, cmath.rect(NOTCH / 2, angle), cmath.rect(NOTCH, angle)]
    print("| x [mm] | y [mm] | K_II / K_I |\n|---|---|---|")
    while True:
        tip, outer = crack[-1], 0.8 * increment
        nodes, triangles = mesh(numpy.array(crack))
        opening, sliding = factors(nodes, triangles, solve(nodes, triangles), tip, angle, 0.4 * outer, outer)
        print(f"| {tip.real:.2f} | {tip.imag:.2f} | {sliding / opening:.3f} |", flush=True)
        if tip.imag > HEIGHT:
            return
        angle += hoop(opening, sliding)
        crack.append(tip + cmath.rect(increment, angle))


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 1.0)
