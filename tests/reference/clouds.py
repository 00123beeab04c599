"""Random clouds of points as cases: a file of points and its case file."""

import json

import numpy

# Stretches of the deformations below reach about 10 %, so that these laws give intact, softening and
# broken bonds.
LAWS = {
    "none": None,
    "critical_stretch": {"law": "critical_stretch", "critical": 0.05},
    "tanh": {"law": "tanh", "onset": 0.02, "critical": 0.09, "rate": 3.0},
    "tanh_continuous": {"law": "tanh_continuous", "onset": 0.03, "critical": 0.08, "rate": 4.5},
    "linear": {"law": "linear", "onset": 0.025, "critical": 0.09},
    "exponential": {"law": "exponential", "onset": 0.02, "critical": 0.1, "rate": 2.5},
    "blended": {"law": "blended", "onset": 0.02, "peak": 0.045, "critical": 0.085, "hardening": 0.4},
    "bilinear": {"law": "bilinear", "onset": 0.02, "critical": 0.09},
    "cornelissen": {"law": "cornelissen", "onset": 0.012, "critical": 0.09},
    "table": {"law": "table", "stretches": [0.02, 0.03, 0.05, 0.09], "forces": [0.02, 0.024, 0.01, 0.003]},
}


def toml_value(value):
    """TOML of strings, numbers, booleans, lists and tables in one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(toml_value(item) for item in value) + "]"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value)
    return repr(float(value)) if isinstance(value, (float, numpy.floating)) else str(int(value))


def toml(tables):
    """A case file: plain keys, then tables, then arrays of tables."""
    plain = [f"{key} = {toml_value(item)}" for key, item in tables.items() if not isinstance(item, (dict, list))]
    for key, item in tables.items():
        if isinstance(item, dict):
            plain += [f"[{key}]"] + [f"{name} = {toml_value(value)}" for name, value in item.items()]
    for key, item in tables.items():
        if isinstance(item, list):
            for entry in item:
                plain += [f"[[{key}]]"] + [f"{name} = {toml_value(value)}" for name, value in entry.items()]
    return "\n".join(plain) + "\n"


def random_places(random, count, dimension):
    """Points with a mean distance of about one: a lattice as square as possible, perturbed, in random order."""
    side = int(numpy.ceil(count ** (1 / dimension)))
    grid = numpy.stack(numpy.meshgrid(*[numpy.arange(side)] * dimension, indexing="ij"), -1).reshape(-1, dimension)
    places = grid[:count] + random.uniform(-0.35, 0.35, (count, dimension))
    return random.permutation(places)


def write_points(path, reference, volume, sets):
    names = list(sets)
    lines = [",".join([*"xyz"[: reference.shape[1]], "volume", "set"])]
    for k, place in enumerate(reference):
        inside = "|".join(name for name in names if sets[name][k])
        lines.append(",".join([*map(repr, place.tolist()), repr(float(volume[k])), inside]))
    path.write_text("\n".join(lines) + "\n")


def random_cloud(random, folder, dimension, *, count, horizon, volumes=(0.7, 1.4), **tables):
    """Writes cloud.csv and cloud.toml into a folder; returns the path of the case.

    The first points along x are the set `left`, the last ones `right`, the others `middle`.
    """
    reference = random_places(random, count, dimension)
    cross_section = 1.0 if dimension == 3 else random.uniform(0.5, 2)
    volume = random.uniform(*volumes, count) * cross_section
    held = dimension + 1
    order = reference[:, 0].argsort()
    sets = {name: numpy.zeros(count, bool) for name in ("left", "right", "middle")}
    sets["left"][order[:held]] = sets["right"][order[-held:]] = sets["middle"][order[held:-held]] = True
    write_points(folder / "cloud.csv", reference, volume, sets)
    points = {"file": "cloud.csv", "horizon": horizon}
    if dimension < 3:
        points[{1: "area", 2: "thickness"}[dimension]] = cross_section
    case = {"dimension": dimension, "points": points, **tables}
    case.setdefault("support", [{"set": "left", "displacement": [0] * dimension}])
    (folder / "cloud.toml").write_text(toml(case))
    return folder / "cloud.toml"


def random_deformation(random, dimension, size, amount):
    """Current coordinates as expressions of x, y, z, linear and quadratic, with about the given stretch."""
    axes = "xyz"[:dimension]
    expressions = []
    for axis in axes:
        linear = " ".join(f"{random.uniform(-amount, amount):+.6f}*{other}" for other in axes)
        square = " ".join(f"{random.uniform(-amount, amount) / size:+.6f}*{other}*{axes[0]}" for other in axes)
        expressions.append(f"{axis} {linear} {square}")
    return expressions
