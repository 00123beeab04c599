"""Largest loads of notched beams with a cohesive crack, by finite elements that share nothing with the program:

    /usr/bin/python3 -BEs -m tests.reference.cohesive_beam

The beams of the trust suite's size effect (size_effect.py): span 4 D, a notch of 0.3 D in the middle, plane stress. The
ligament carries f(w) = f_t g(w / w_c) across its opening w, with w_c = G / (f_t int g); outside it the beam is elastic.
Four-node elements with incompatible modes [Taylor et al. 1976], one half of the beam. The front of the
zone goes from node to node along the ligament; the load of each position follows by Newton's method. With 60 rows of
elements over the depth, ratios are within 0.3 % of those with 40.
"""

from collections.abc import Callable

import numpy

E, FRACTURE_ENERGY, TENSILE = 25.85e9, 89.0, 2.7e6  # Pa, J/m2, Pa
NOTCH, OVERHANG = 0.3, 0.1  # of the depth
RATIO = 1 / 3  # Poisson's, of bonds in plane stress; loads hardly depend on it
DEPTHS = (0.2, 0.32, 0.52, 0.8)  # m

Curve = Callable[[numpy.ndarray], tuple[numpy.ndarray, numpy.ndarray]]


def linear(x: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
    """g and its derivative at shares x of the largest opening."""
    return numpy.clip(1 - x, 0, 1), numpy.where(x < 1, -1.0, 0.0)


def bilinear(x: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Kink at a third of the strength [Petersson 1981]."""
    first, second = x < 2 / 9, x < 1
    return (numpy.where(first, 1 - 3 * x, numpy.where(second, 3 / 7 * (1 - x), 0.0)),
            numpy.where(first, -3.0, numpy.where(second, -3 / 7, 0.0)))  # fmt: skip


def cornelissen(x: numpy.ndarray) -> tuple[numpy.ndarray, numpy.ndarray]:
    """[Cornelissen et al. 1986]"""
    c1, c2 = 3.0, 6.93
    end, fall = (1 + c1**3) * numpy.exp(-c2), numpy.exp(-c2 * x)
    value = (1 + (c1 * x) ** 3) * fall - x * end
    slope = (3 * c1**3 * x**2 - c2 * (1 + (c1 * x) ** 3)) * fall - end
    return numpy.where(x < 1, value, 0.0), numpy.where(x < 1, slope, 0.0)


def element() -> numpy.ndarray:
    """Stiffness of a square of any size and unit thickness (8 x 8), nodes anticlockwise from the lower left."""
    matter = E / (1 - RATIO**2) * numpy.array([[1, RATIO, 0], [RATIO, 1, 0], [0, 0, (1 - RATIO) / 2]])
    whole = numpy.zeros((12, 12))
    for a in (-(3**-0.5), 3**-0.5):
        for b in (-(3**-0.5), 3**-0.5):
            along = numpy.array([-(1 - b), 1 - b, 1 + b, -(1 + b), -4 * a, 0]) / 2  # two incompatible modes at the end
            across = numpy.array([-(1 - a), -(1 + a), 1 + a, 1 - a, 0, -4 * b]) / 2
            strain = numpy.zeros((3, 12))
            strain[0, 0::2], strain[1, 1::2] = along, across
            strain[2, 0::2], strain[2, 1::2] = across, along
            whole += strain.T @ matter @ strain / 4
    return whole[:8, :8] - whole[:8, 8:] @ numpy.linalg.solve(whole[8:, 8:], whole[8:, :8])


def strip(rows: int) -> tuple[numpy.ndarray, ...]:
    """Blocks of a column of elements: left-left, left-right and right-right."""
    one, size = element(), 2 * (rows + 1)
    blocks = numpy.zeros((2, 2, size, size))
    for row in range(rows):
        at = (numpy.arange(2 * row, 2 * row + 4),) * 2
        of = (numpy.array([0, 1, 6, 7]), numpy.array([2, 3, 4, 5]))
        for p in (0, 1):
            for q in (0, 1):
                blocks[p, q][numpy.ix_(at[p], at[q])] += one[numpy.ix_(of[p], of[q])]
    return blocks[0, 0], blocks[0, 1], blocks[1, 1]


def compliance(rows: int) -> tuple[numpy.ndarray, numpy.ndarray]:
    """Half openings of the nodes of the middle plane, from the bottom, as their forces per thickness along the beam (C)
    and the whole load per thickness (b) make them: u = b P - C F [m per N/m]. The two topmost nodes are held, and have no rows."""
    left, across, right = strip(rows)
    size = 2 * (rows + 1)
    last, support = round((2 + OVERHANG) * rows), 2 * rows
    beyond = numpy.zeros((size, size))
    for column in range(last, 0, -1):
        free = numpy.arange(size) if column != support else numpy.delete(numpy.arange(size), 1)
        whole = (right + beyond)[numpy.ix_(free, free)]
        beyond = left - across[:, free] @ numpy.linalg.solve(whole, across[:, free].T)
    free = numpy.delete(numpy.arange(size), [size - 4, size - 2])
    forces = numpy.zeros((size, rows))
    forces[numpy.arange(0, size - 4, 2), numpy.arange(rows - 1)] = 1
    forces[size - 1, rows - 1] = -0.5
    moved = numpy.zeros_like(forces)
    moved[free] = numpy.linalg.solve(beyond[numpy.ix_(free, free)], forces[free])
    openings = moved[0 : size - 4 : 2]
    return openings[:, : rows - 1], openings[:, rows - 1]


def loads(depth: float, rows: int, curve: Curve) -> numpy.ndarray:
    """Loads per thickness [N/m] while the front of the zone goes through the ligament of a beam; the largest is the
    peak."""
    whole_c, whole_b = compliance(rows)
    tip = round(NOTCH * rows)
    c, b, lengths = whole_c[tip:, tip:], whole_b[tip:], numpy.full(rows - 1 - tip, depth / rows)
    lengths[0] *= 0.5
    x = numpy.linspace(0, 1, 100001)
    shares = curve(x)[0]
    critical = FRACTURE_ENERGY / TENSILE / (numpy.sum(shares[1:] + shares[:-1]) * 0.5e-5)
    n, found = len(b), []
    opened, load = numpy.zeros(n), 1.0
    for front in range(n):
        opened, load = _at(front, opened, load, c, b, TENSILE * lengths, critical, curve)
        found.append(load)
        if load < 0.7 * max(found):
            break
    return numpy.array(found)


def _at(front, opened, load, c, b, strengths, critical, curve):
    """Half openings and load with the front at a node: it has its strength, nodes beyond it are closed. Unknowns are the
    openings before it, the load, and the forces beyond it."""
    n = len(b)
    before, beyond = numpy.arange(front), numpy.arange(front + 1, n)
    x = numpy.zeros(n)
    x[before], x[front] = opened[before], load
    for _ in range(200):
        value, slope = curve(2 * x[before] / critical)
        forces = numpy.concatenate([strengths[before] * value, [strengths[front]], x[beyond]])
        half = numpy.concatenate([x[before], numpy.zeros(n - front)])
        off = b * x[front] - c @ forces - half
        tangent = numpy.hstack([-c[:, before] * (strengths[before] * slope * 2 / critical), b[:, None], -c[:, beyond]])
        tangent[before, before] -= 1
        sizes = numpy.linalg.norm(tangent, axis=0)  # of openings and forces, which differ by eleven orders
        step = numpy.linalg.solve(tangent / sizes, -off) / sizes
        x += step
        if abs(step[front]) < 1e-9 * abs(x[front]):
            return numpy.concatenate([x[before], numpy.zeros(n - front)]), x[front]
    raise ArithmeticError(f"no equilibrium with the front at node {front}")


def peak(depth: float, rows: int = 60, curve: Curve = linear) -> float:
    """Load per thickness and depth [Pa]."""
    return float(loads(depth, rows, curve).max()) / depth


def main() -> None:
    print("| curve | rows of elements | " + " | ".join(f"{1000 * depth:.0f} mm [MPa]" for depth in DEPTHS) + " |")
    print("|---|---|" + "---|" * len(DEPTHS))
    for curve in (linear, bilinear, cornelissen):
        for rows in (20, 40, 60):
            values = " | ".join(f"{1e-6 * peak(depth, rows, curve):.4f}" for depth in DEPTHS)
            print(f"| {curve.__name__} | {rows} | {values} |", flush=True)


if __name__ == "__main__":
    main()
