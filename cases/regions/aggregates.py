"""Draws the section of concrete that cases/regions/aggregates.toml reads: /usr/bin/python3 cases/regions/aggregates.py

50 mm x 50 mm in 250 x 250 pixels: mortar of grey 150, aggregates of grey 230 with radii from 2 to 6 mm, and pores of
grey 20 with radii from 0.6 to 1.2 mm. No two circles touch.
"""

from pathlib import Path

import numpy
from PIL import Image

PIXELS, SIZE = 250, 50.0  # mm
MORTAR, AGGREGATE, PORE = 150, 230, 20


def circles(random, number, radii, others):
    """Circles at random, away from each other and from the edges, the largest first."""
    found = []
    for radius in sorted(random.uniform(*radii, number), reverse=True):
        for _ in range(10000):
            x, y = random.uniform(radius + 0.5, SIZE - radius - 0.5, 2)
            if all(numpy.hypot(x - u, y - v) > radius + r + 0.4 for u, v, r in found + others):
                found.append((x, y, radius))
                break
    return found


random = numpy.random.default_rng(1)
aggregates = circles(random, 26, (2.0, 6.0), [])
pores = circles(random, 25, (0.6, 1.2), aggregates)
middle = (numpy.arange(PIXELS) + 0.5) * SIZE / PIXELS
x, y = numpy.meshgrid(middle, middle)
grey = numpy.full((PIXELS, PIXELS), MORTAR, numpy.uint8)
for value, drawn in ((AGGREGATE, aggregates), (PORE, pores)):
    for u, v, radius in drawn:
        grey[numpy.hypot(x - u, y - v) < radius] = value
Image.fromarray(grey[::-1]).save(Path(__file__).with_suffix(".png"))  # row 0 is at the top
