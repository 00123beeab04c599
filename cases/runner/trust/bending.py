"""Common parts of beams in three-point bending."""


def rollers(support: float, depth: float) -> str:
    """Supports under both ends, `support` from the middle, and above it the load, where the beam is also held along its
    axis."""
    return f"""\
[[roller]]
name = "left"
at = [{-support}, 0.0]
normal = [0, 1]

[[roller]]
name = "right"
at = [{support}, 0.0]
normal = [0, 1]

[[roller]]
name = "load"
at = [0.0, {depth}]
normal = [0, 1]
displacement = "-load"

[[roller]]
name = "middle"
at = [0.0, {depth}]
normal = [1, 0]

"""


def mouth_sets(x: float, h: float) -> str:
    """Sets on both sides of a notch at x, beside its mouth."""
    return f"""\
[[set]]
name = "mouth_right"
where = "x > {x} && x < {x + 1.5 * h} && y < {1.5 * h}"

[[set]]
name = "mouth_left"
where = "x < {x} && x > {x - 1.5 * h} && y < {1.5 * h}"

"""
