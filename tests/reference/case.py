"""A case file as docs/case-file.md explains it: defaults, expressions, sets."""

import copy
import math
import pathlib
import tomllib

import numpy

DEFAULTS = {
    "quadrature": {"volume_correction": "none", "weights": "mean", "surface_correction": "none"},
    "material": {"model": "bond", "plane": "stress", "calibration": "lattice"},
    "loading": {"steps": 1, "adaptive": True, "smallest_step": 1e-6},
    "solver": {"mode": "newton", "relative_tolerance": 1e-10, "fragments": "hold"},
    "relaxation": {"load": "fixed", "displacement_tolerance": 0.0},
    "output": {"every": 1, "count_cracks": False},
}


class Case:
    """The tables of a case with the defaults that the reference needs."""

    def __init__(self, text, folder=pathlib.Path(".")):
        self.tables = tomllib.loads(text) if isinstance(text, str) else copy.deepcopy(text)
        self.folder = pathlib.Path(folder)
        self.has_material = "material" in self.tables
        first = self.tables["region"][0]["material"] if "region" in self.tables else {}
        if not self.has_material:  # model and plane are those of the first region
            self.tables["material"] = {key: first[key] for key in ("model", "plane") if key in first}
        for name, defaults in DEFAULTS.items():
            self.tables[name] = defaults | self.tables.get(name, {})
        self.dimension = self.tables["dimension"]
        relaxation = self.tables["relaxation"]
        relaxation.setdefault("breaking", "transient" if relaxation["load"] == "moving" else "at_equilibrium")

    def __getitem__(self, name):
        return self.tables[name]

    def get(self, name, default=()):
        return self.tables.get(name, default)

    @property
    def is_lattice(self):
        return "lattice" in self.tables

    @property
    def place(self):
        """The table that tells where the points come from."""
        return self["lattice"] if self.is_lattice else self["points"]

    @property
    def cross_section(self):
        """Area of a bar [m2], thickness of a plate [m], 1 in space."""
        key = {1: "area", 2: "thickness", 3: None}[self.dimension]
        return float(self.place.get(key, 1.0))

    @property
    def spacings(self):
        """Of the lattice along its axes [m]."""
        return numpy.broadcast_to(numpy.asarray(self["lattice"]["spacing"], float), (self.dimension,))

    def spacing(self, volume):
        """Edge of a square of a lattice's cell's volume, or of a cloud's mean volume [m]."""
        if self.is_lattice:
            return float(numpy.prod(self.spacings) ** (1 / self.dimension))
        return float((numpy.mean(volume) / self.cross_section) ** (1 / self.dimension))

    def horizon(self, ratio=None):
        if not self.is_lattice:
            return float(self["points"]["horizon"])
        lattice = self["lattice"]
        return self.spacing(None) * (lattice.get("horizon_ratio", 3.015) if ratio is None else ratio)

    @property
    def has_damage(self):
        """Whether any of the materials fails."""
        materials = [self["material"]] + [t["material"] for t in self.get("region")]
        materials += [t["material"] for t in self.get("interface") if "material" in t]
        return any(table.get("damage", {}).get("law", "none") != "none" for table in materials)


def read_points(case):
    """Positions, volumes and sets of a file of points."""
    lines = (case.folder / case["points"]["file"]).read_text().splitlines()
    lines = [line for line in lines if line.strip() and not line.startswith("#")]
    rows = [[word.strip() for word in line.split(",")] for line in lines]
    columns = {name: [row[k] if k < len(row) else "" for row in rows[1:]] for k, name in enumerate(rows[0])}
    reference = numpy.array([columns[axis] for axis in "xyz"[: case.dimension]], float).T
    volume = numpy.array(columns["volume"], float)
    sets = {}
    for name in {name for entry in columns.get("set", []) for name in entry.split("|") if name}:
        sets[name] = numpy.array([name in entry.split("|") for entry in columns["set"]])
    return reference, volume, sets


FUNCTIONS = {name: getattr(numpy, name) for name in "sin cos tan sinh cosh tanh exp sqrt abs sign".split()}
FUNCTIONS |= {"ln": numpy.log, "asin": numpy.arcsin, "acos": numpy.arccos, "atan": numpy.arctan}
FUNCTIONS |= {"min": numpy.minimum, "max": numpy.maximum, "pi": math.pi}


def read_neighbours(case):
    """Pairs of points, numbered from 0 as in their file, and the shares that they count of each other."""
    lines = (case.folder / case["points"]["neighbours"]).read_text().splitlines()
    rows = [line.replace(",", " ").split() for line in lines if line.strip() and not line.startswith("#")]
    shares = {}
    for row in rows[1:]:
        i, j, *share = int(row[0]) - 1, int(row[1]) - 1, *map(float, row[2:])
        shares[i, j] = share[0]
        if (j, i) not in shares or len(share) == 2:
            shares[j, i] = share[-1]
    pairs = numpy.array(sorted({tuple(sorted(pair)) for pair in shares}))
    return pairs, numpy.array([[shares[i, j], shares[j, i]] for i, j in pairs.tolist()])


def evaluate(expression, reference, load=0.0, spacing=0.0):
    """An expression of place and load at every point; only what Python and the program share."""
    count = len(reference)
    if not isinstance(expression, str):
        return numpy.full(count, float(expression))
    names = FUNCTIONS | {"load": load, "spacing": spacing} | dict(zip("xyz", reference.T))
    value = eval(expression.replace("^", "**"), {"__builtins__": {}}, names)  # noqa: S307
    return numpy.broadcast_to(numpy.asarray(value, float), (count,)).copy()


class Conditions:
    """What holds and loads the points."""

    def __init__(self, case, reference, volume, sets):
        self.case, self.reference, self.volume, self.sets = case, reference, volume, sets
        self.spacing = case.spacing(volume)
        self.prescribed = numpy.zeros(reference.shape, bool)
        for support in case.get("support"):
            self.prescribed |= self.held_by(support)

    def held_by(self, support):
        """Degrees of freedom that one support prescribes."""
        mask = numpy.zeros(self.reference.shape, bool)
        for axis, component in enumerate(support["displacement"]):
            if component != "free":
                mask[self.sets[support["set"]], axis] = True
        return mask

    def displacement(self, load):
        """Prescribed displacements [m]; zero elsewhere."""
        value = numpy.zeros(self.reference.shape)
        for support in self.case.get("support"):
            for axis, component in enumerate(support["displacement"]):
                if component != "free":
                    inside = self.sets[support["set"]]
                    value[inside, axis] = evaluate(component, self.reference, load, self.spacing)[inside]
        return value

    def force(self, load):
        """Dead loads [N]."""
        value = numpy.zeros(self.reference.shape)
        for table in self.case.get("load"):
            inside = self.sets[table["set"]]
            total = "total_force" in table
            share = self.volume[inside] / self.volume[inside].sum() if total else self.volume[inside]
            for axis, component in enumerate(table["total_force" if total else "body_force"]):
                value[inside, axis] += share * evaluate(component, self.reference, load, self.spacing)[inside]
        return value
