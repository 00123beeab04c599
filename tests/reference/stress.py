"""Strain and stress at the points of a body (docs/theory.md, Strain and stress), independently of the program. Virials
are complex steps of the energy of every interaction along a homogeneous deformation of its arms."""

import numpy

from tests.reference.mechanics import STEP

ROUND_OFF = 1e-10  # relative to the largest stress of an intact bond; see AGREEMENT in verify.py
FLAT = 1e-10  # smallest over largest second moment of a neighbourhood below which it has no gradient


def virials(mechanics, u, history=None):
    """Equal share of dE/dF of its interactions at every point [J], points x dimension x dimension. The reference arms
    of all interactions of a point are present; only those that the body lacks are missing."""
    body = mechanics.body
    history = mechanics.no_history() if history is None else history
    d = body.dimension
    total = numpy.zeros((len(body.volume), d, d))
    for r in range(d):
        for c in range(d):
            moved = u.astype(complex)
            moved[:, r] += 1j * STEP * body.reference[:, c]
            for order, energy in mechanics.energies(moved, history).items():
                tuples = body.tuples[order]
                for k in range(order + 1):
                    share = energy.imag / STEP / (order + 1)
                    total[:, r, c] += numpy.bincount(tuples[:, k], share, minlength=len(body.volume))
            total[:, r, c] += mechanics.contact_energies(moved, history).imag / STEP
    return total


def gradients(mechanics, u, history):
    """Displacement gradient from the unbroken bonds of every point by least squares, and the points that have one."""
    body = mechanics.body
    whole = ~mechanics.is_broken(history)
    bonds, weight = body.bonds[whole], body.weight[1][whole]
    xi, eta = ((field[bonds[:, 1]] - field[bonds[:, 0]]) for field in (body.reference, u))
    count, d = len(body.volume), body.dimension
    second, mixed = numpy.zeros((count, d, d)), numpy.zeros((count, d, d))
    for r in range(d):
        for c in range(d):
            for end in (0, 1):
                second[:, r, c] += numpy.bincount(bonds[:, end], weight * xi[:, r] * xi[:, c], minlength=count)
                mixed[:, r, c] += numpy.bincount(bonds[:, end], weight * eta[:, r] * xi[:, c], minlength=count)
    moments = numpy.linalg.eigvalsh(second)
    known = moments[:, 0] > FLAT * moments[:, -1]
    second[~known] = numpy.eye(d)
    gradient = numpy.linalg.solve(second.transpose(0, 2, 1), mixed.transpose(0, 2, 1)).transpose(0, 2, 1)
    gradient[~known] = 0.0
    return gradient, known


def fields(mechanics, u, history):
    """Strain and stress as results hold them, for the body's own points."""
    body = mechanics.body
    own, d = getattr(body, "own", len(body.volume)), body.dimension
    gradient, known = (values[:own] for values in gradients(mechanics, u, history))
    P = virials(mechanics, u, history)[:own] / body.volume[:own, None, None]
    F = numpy.eye(d) + gradient
    ratio = numpy.linalg.det(F)
    known = known & (ratio > 0)
    F[~known] = numpy.eye(d)
    strain = (gradient + gradient.transpose(0, 2, 1) + gradient.transpose(0, 2, 1) @ gradient) / 2
    sigma = P @ F.transpose(0, 2, 1) / numpy.where(known, ratio, 1.0)[:, None, None]
    strain[~known], sigma[~known] = 0.0, 0.0
    symmetric = (sigma + sigma.transpose(0, 2, 1)) / 2
    return {"deformation_gradient": F, "green_lagrange_strain": strain, "first_piola_stress": P, "cauchy_stress": sigma,
            "strain": halves(strain), "stress": halves(symmetric), "von_mises": von_mises(symmetric, body),
            "principal_stress": numpy.linalg.eigvalsh(symmetric)[:, ::-1]}  # fmt: skip


def halves(tensors):
    order = {1: [(0, 0)], 2: [(0, 0), (1, 1), (0, 1)], 3: [(0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (0, 2)]}
    return numpy.stack([tensors[:, r, c] for r, c in order[tensors.shape[1]]], axis=1)


def von_mises(stress, body):
    inside = numpy.zeros((len(stress), 3, 3))
    d = body.dimension
    inside[:, :d, :d] = stress
    if d == 2 and not body.is_cpd and body.case["material"]["plane"] == "strain":
        inside[:, 2, 2] = (stress[:, 0, 0] + stress[:, 1, 1]) / 4  # Poisson's ratio of bond-based models
    a, b, c = numpy.linalg.eigvalsh(inside).T
    return numpy.sqrt(((a - b) ** 2 + (b - c) ** 2 + (c - a) ** 2) / 2)


def noise(body):
    """Stress of a stretch as small as a complex step [Pa]. The virials err by its square: a body at rest has about
    1e-51 Pa, which would be a relative difference of 1 from zero, or from the remains of an underflow."""
    return STEP * body.constants[1] * body.weight[1].max() * body.horizon / body.volume.min()


def judge(verification, step, mechanics, u, history, force):
    """Compares a step's strain and stress.

    force: of an intact bond [N]; its stress over a cell is the scale of round-off.
    """
    if "first_piola_stress" not in step.fields:
        return
    body = mechanics.body
    found = fields(mechanics, u, history)
    cell = body.volume.min()
    pressure = max(force * body.horizon / cell, noise(body), numpy.abs(found["first_piola_stress"]).max())
    for name, values in found.items():
        is_stress = name.endswith("stress") or name == "von_mises"
        written = step.fields[name]
        size = max(numpy.abs(values).max(), 1e-300) if not is_stress else max(pressure, numpy.abs(values).max())
        verification.compare(step, name, written, values, size, ROUND_OFF)
    directions, principal = step.fields["principal_direction"], step.fields["principal_stress"]
    sigma = (found["cauchy_stress"] + found["cauchy_stress"].transpose(0, 2, 1)) / 2
    back = numpy.einsum("nk,nki,nkj->nij", principal, directions, directions)
    verification.compare(step, "principal directions", back, sigma, max(pressure, numpy.abs(sigma).max()), ROUND_OFF)
