"""Moving bodies that several tests use, and readers of their results."""

import random

import h5py
import numpy

from tests.reference.results import Results


def columns(folder):
    rows = Results(folder).table("history")
    return {name: numpy.array([row[name] for row in rows]) for name in rows[0]}


def fields(folder):
    """By step: the fields of a results file, and their time."""
    with h5py.File(folder / "results.h5") as file:
        return {int(group.attrs["step"]): {"time": group.attrs["time"]} | {
            name: item[...] for name, item in group.items() if name != "history"} for group in file["steps"].values()}  # fmt: skip


BAR = """\
dimension = 1
[lattice]
spacing = 0.1
horizon_ratio = 3.015
area = 0.5
[[lattice.shape]]
add = "box"
min = [0]
max = [3]
[material]
youngs_modulus = 4.0
density = 2.0
[[initial]]
displacement = ["1e-3*exp(-(x - 1.4)^2/0.09)"]
velocity = ["1e-3*sin(x)"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 4.0
time_step = 0.02
[output]
every = 20
"""


def random_case(seed):
    """A small body with random features, and its time step and end."""
    rng = random.Random(seed)
    d = rng.choice([1, 2, 3])
    extent = {1: [1.2], 2: [0.9, 0.6], 3: [0.5, 0.4, 0.4]}[d]
    axes = "xyz"[:d]
    number = lambda low, high: f"{rng.uniform(low, high):.6g}"
    wave = lambda size: f"{number(-size, size)}*sin({number(1, 5)}*{rng.choice(axes)} + {number(0, 3)})"
    vector = lambda entry: "[" + ", ".join(f'"{entry()}"' for _ in range(d)) + "]"
    law = rng.choice(["none", "critical_stretch", "tanh_continuous", "linear", "exponential", "blended"])
    if d == 1:
        law = rng.choice(["none", "critical_stretch", "linear"])
    text = [f"dimension = {d}", "[lattice]", "spacing = 0.1", f"horizon_ratio = {rng.choice([1.5, 2.015, 3.015])}",
            "[[lattice.shape]]", 'add = "box"', f"min = {[0.0] * d}", f"max = {extent}",
            "[[set]]", 'name = "left"', 'where = "x < 0.1"', "[[set]]", 'name = "right"',
            f'where = "x > {extent[0] - 0.15}"', "[material]", f"youngs_modulus = {number(1, 3)}",
            f"density = {number(0.5, 2)}"]  # fmt: skip
    if law != "none":
        text += ["[material.damage]", f'law = "{law}"', "critical = 0.05"]
        text += ["onset = 0.02"] if law != "critical_stretch" else []
        text += ["peak = 0.03"] if law == "blended" else []
        text += ['no_fail = ["left"]'] if rng.random() < 0.5 else []
    if rng.random() < 0.6:
        text += ["[[support]]", 'set = "left"', f"displacement = {vector(lambda: f'{number(-0.02, 0.02)}*sin({number(1, 8)}*t)')}"]
    if rng.random() < 0.5:
        text += ["[[load]]", 'set = "right"', f"body_force = {vector(lambda: f'{wave(0.05)}*({number(0, 1)} + t)')}"]
    if rng.random() < 0.5:
        text += ["[[load]]", 'set = "left"', f"total_force = {vector(lambda: number(-1e-4, 1e-4))}"]
    text += ["[[initial]]", f"displacement = {vector(lambda: wave(0.01))}", f"velocity = {vector(lambda: wave(0.1))}"]
    if rng.random() < 0.5:
        text += ["[[initial]]", 'set = "right"', f"velocity = {vector(lambda: number(-0.1, 0.1))}"]
    dt, end = rng.choice([0.01, 0.013]), 0.5
    text += ["[solver]", 'mode = "dynamics"', "[dynamics]", f"end_time = {end}", f"time_step = {dt}",
             "history_every = 5", "[output]", "every = 10"]  # fmt: skip
    return "\n".join(text) + "\n", dt, end


SQUARE = """\
dimension = 2
[lattice]
spacing = 0.1
[[lattice.shape]]
add = "box"
min = [-0.8, -0.8]
max = [0.8, 0.8]
[material]
youngs_modulus = 1.0
density = 1.0
[[initial]]
displacement = ["0.05*x*exp(-(x^2 + y^2)/0.1)", "0.05*y*exp(-(x^2 + y^2)/0.1)"]
[solver]
mode = "dynamics"
[dynamics]
end_time = 2.0
step_share = 0.5
[output]
every = 10
"""
BREAKING = SQUARE.replace("density = 1.0", """density = 1.0
[material.damage]
law = "critical_stretch"
critical = 0.015""") + """[[crack]]
from = [-1, 0.01]
to = [0, 0.01]
[[support]]
set = "top"
displacement = ["free", "0.05*t"]
[[set]]
name = "top"
where = "y > 0.7"
[[probe]]
name = "speed"
set = "top"
field = "velocity"
component = "y"
"""  # fmt: skip
