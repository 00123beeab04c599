"""Closed surfaces of triangles, and STL files of them."""

import itertools
import math
import struct

import numpy


def sphere(radius=0.5, rings=40):
    """Triangles of a sphere by rings of latitude; the poles are one vertex each."""

    def place(i, k):
        if i in (0, rings):
            return numpy.array([0.0, 0.0, radius if i == 0 else -radius])
        polar, azimuth = math.pi * i / rings, math.pi * (k % (2 * rings)) / rings
        return radius * numpy.array([math.sin(polar) * math.cos(azimuth), math.sin(polar) * math.sin(azimuth), math.cos(polar)])

    for i, k in itertools.product(range(rings), range(2 * rings)):
        a, b, c, d = place(i, k), place(i + 1, k), place(i + 1, k + 1), place(i, k + 1)
        if i < rings - 1:
            yield a, b, c
        if i > 0:
            yield a, c, d


def volume_of(triangles):
    return abs(sum(numpy.dot(a, numpy.cross(b, c)) for a, b, c in triangles)) / 6


def binary(triangles, header=b"solid by chance"):
    """An STL file; single precision rounds shared vertices alike."""
    triangles = list(triangles)
    parts = [header.ljust(80, b" "), struct.pack("<I", len(triangles))]
    parts += [struct.pack("<12fH", 0, 0, 0, *numpy.ravel(triangle), 0) for triangle in triangles]
    return b"".join(parts)


def ascii_text(triangles, name="body"):
    facets = "".join(
        "facet normal 0 0 0\nouter loop\n" + "".join("vertex {!r} {!r} {!r}\n".format(*map(float, v)) for v in triangle)
        + "endloop\nendfacet\n" for triangle in triangles)  # fmt: skip
    return f"solid {name}\n{facets}endsolid {name}\n"
