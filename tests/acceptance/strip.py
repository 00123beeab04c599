"""The body of most command-line tests: 20 x 10 points between two held layers."""

LATTICE = """\
dimension = 2
[lattice]
spacing = 1e-3
thickness = 1e-3
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [0.02, 0.01]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
"""
# Elastic, and stretched slightly.
PULLED = LATTICE + """\
[material]
youngs_modulus = 200e9
[[support]]
set = "left"
displacement = [0, 0]
[[support]]
set = "right"
displacement = ["1e-5*load", "free"]
"""
