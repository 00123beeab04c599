"""A case file as docs/case-file.md defines it: defaults, expressions, sets."""

import copy
import functools
import math
import pathlib
import tomllib

import numpy

DEFAULTS = {
    "quadrature": {"volume_correction": "none", "weights": "mean", "surface_correction": "none"},
    "material": {"model": "bond", "plane": "stress", "influence": "constant"},
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
            self.tables["material"] = {key: first[key] for key in ("model", "plane", "influence") if key in first}
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
        """The table that defines the points."""
        return self["lattice"] if self.is_lattice else self["points"]

    @property
    def cross_section(self):
        """Area of a bar [m2], thickness of a plate [m], 1 in space."""
        key = {1: "area", 2: "thickness", 3: None}[self.dimension]
        return float(self.place.get(key, 1.0))

    @property
    def spacings(self):
        """Spacing of the lattice along its axes [m]."""
        return numpy.broadcast_to(numpy.asarray(self["lattice"]["spacing"], float), (self.dimension,))

    def spacing(self, volume):
        """Edge of a square with the volume of a lattice's cell, or with a cloud's mean volume [m]."""
        if self.has_one_spacing:
            return float(numpy.prod(self.spacings) ** (1 / self.dimension))
        return float((numpy.mean(volume) / self.cross_section) ** (1 / self.dimension))

    @property
    def is_refined(self):
        """True for blue noise with regions of finer points, whose sizes differ."""
        return self.is_lattice and bool(self["lattice"].get("refine"))

    @property
    def has_rows(self):
        return self.is_lattice and self["lattice"].get("points", "lattice") == "lattice"

    @property
    def has_one_spacing(self):
        return self.is_lattice and not self.is_refined

    @property
    def ratio_to_sizes(self):
        """Horizon of each point over its size; None: there is one horizon."""
        if self.is_refined:
            return self["lattice"].get("horizon_ratio", 3.015)
        horizon = None if self.is_lattice else self["points"]["horizon"]
        return float(horizon["ratio"]) if isinstance(horizon, dict) else None

    def sizes(self, volume):
        return (numpy.asarray(volume, float) / self.cross_section) ** (1 / self.dimension)

    def horizon(self, ratio=None, volume=None):
        """The horizon, of points with their own the largest one."""
        if self.ratio_to_sizes:
            return self.ratio_to_sizes * self.sizes(volume).max()
        if not self.is_lattice:
            return float(self["points"]["horizon"])
        lattice = self["lattice"]
        return self.spacing(None) * (lattice.get("horizon_ratio", 3.015) if ratio is None else ratio)

    @property
    def spacing_in_expressions(self):
        """A number, or one per axis if they differ; a cloud's mean spacing is unknown here."""
        spacings = self.spacings
        return spacings if len(set(spacings)) > 1 else float(spacings[0])

    def loads(self, stage, load):
        """Load parameters by name; the first one may have been found by the run."""
        values = {"load": load}
        for name in ("table2", "table3", "table4"):
            if name in self["loading"]:
                values["load" + name[-1]] = self.at_stage(self["loading"][name], stage)
        return values

    def at_stage(self, table, stage):
        """Value of a table with one entry per stage."""
        if isinstance(table, str):
            number = numpy.arange(self["loading"]["steps"] + 1.0)
            table = evaluate(table, numpy.zeros((len(number), 0)), {"step": number})
        return float(numpy.interp(stage, numpy.arange(len(table)), table))

    @property
    def has_damage(self):
        """Whether any of the materials can fail."""
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


class NotUnderstood(Exception):
    """The program can read this input and the reference can't: an expression in muParser syntax only, or cells
    that results do not record."""


FUNCTIONS = {name: getattr(numpy, name) for name in "sin cos tan sinh cosh tanh exp sqrt abs sign log2 log10".split()}
FUNCTIONS |= {"ln": numpy.log, "log": numpy.log, "asin": numpy.arcsin, "acos": numpy.arccos, "atan": numpy.arctan}
FUNCTIONS |= {"min": lambda *values: functools.reduce(numpy.minimum, values), "atan2": numpy.arctan2,
              "max": lambda *values: functools.reduce(numpy.maximum, values), "pi": math.pi}  # fmt: skip


def read_neighbours(case):
    """Pairs of points, numbered from 0 as in their file, and the shares with which they count for each other."""
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


def evaluate(expression, reference, loads=0.0, spacing=0.0):
    """An expression of position and load parameters at every point, in the syntax that Python and the program share.

    loads: values of the load parameters by name, or of `load` alone; spacing: a number, or one per axis
    """
    count = len(reference)
    if not isinstance(expression, str):
        return numpy.full(count, float(expression))
    spacings = numpy.broadcast_to(spacing, 3) if numpy.ndim(spacing) == 0 else spacing
    names = FUNCTIONS | {f"spacing_{axis}": size for axis, size in zip("xyz", spacings)}
    if len(set(spacings)) == 1:
        names["spacing"] = spacings[0]
    names |= (loads if isinstance(loads, dict) else {"load": loads}) | dict(zip("xyz", reference.T))
    try:
        value = eval(expression.replace("^", "**"), {"__builtins__": {}}, names)  # noqa: S307
        return numpy.broadcast_to(numpy.asarray(value, float), (count,)).copy()
    except (SyntaxError, NameError, TypeError, ValueError, AttributeError, ArithmeticError, RecursionError, MemoryError) as error:
        raise NotUnderstood(expression[:100]) from error


def face_forces(places):
    """Area vector of a face, for the normal with sign +, distributed to its corners."""
    if len(places) == 1:
        return [numpy.ones(1)]
    if len(places) == 2:
        along = places[1] - places[0]
        return [numpy.array([along[1], -along[0]]) / 2] * 2
    forces = [0.0, 0.0, 0.0, 0.0]
    for triangle in ((0, 1, 2), (0, 2, 3), (0, 1, 3), (1, 2, 3)):
        a, b, c = places[list(triangle)]
        for corner in triangle:
            forces[corner] = forces[corner] + numpy.cross(b - a, c - a) / 12
    return forces


class Conditions:
    """Supports and loads of the points."""

    def __init__(self, case, reference, volume, sets):
        self.case, self.reference, self.volume, self.sets = case, reference, volume, sets
        self.spacing = case.spacing(volume)
        self.spacings = case.spacing_in_expressions if case.has_one_spacing else self.spacing
        self.prescribed = numpy.zeros(reference.shape, bool)
        for support in case.get("support"):
            self.prescribed |= self.held_by(support)
        self.cell_held = self.middle_of_cell()

    def middle_of_cell(self, forces=None):
        """Degrees of freedom at which an unsupported cell is held: those of the point next to its centre, except those
        that planes of symmetry hold. Among equally near points, the one with the largest force is chosen."""
        mask = numpy.zeros(self.reference.shape, bool)
        is_held = self.prescribed.any() or any(self.case.get(name) for name in ("rigid", "roller", "constraint"))
        if self.case.get("period") and not is_held:
            away = ((self.reference - self.reference.mean(axis=0)) ** 2).sum(axis=1)
            mirrored = [axis in [table["axis"] for table in self.case.get("symmetry")] for axis in "xyz"]
            on_points = numpy.zeros(len(away)) if forces is None else (forces**2).sum(axis=1)
            nearest = numpy.where(away <= away.min() + 1e-6 * self.spacing**2, on_points, -1).argmax()
            mask[nearest] = ~numpy.array(mirrored[: self.reference.shape[1]])
        return mask

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
                    value[inside, axis] = evaluate(component, self.reference, load, self.spacings)[inside]
        return value

    def force(self, load):
        """Dead loads [N]."""
        value = numpy.zeros(self.reference.shape)
        for table in self.case.get("load"):
            if "pressure" in table:
                continue
            key, amount = self.amounts(table)
            for axis, component in enumerate(table[key]):
                value[:, axis] += amount * evaluate(component, self.reference, load, self.spacings)
        return value

    def amounts(self, table):
        """A load's key, and the factor of its value at each point."""
        members = self.sets[table["set"]] if "set" in table else numpy.ones(len(self.volume), bool)
        if "gravity" in table:
            inside = members if "set" in table else self.is_in_body()
            return "gravity", numpy.where(inside, self.of_material("density") * self.volume, 0)
        if "traction" in table:
            return "traction", self.traction_areas(table, members)
        volume = numpy.where(members, self.volume, 0)
        return ("total_force", volume / volume.sum()) if "total_force" in table else ("body_force", volume)

    def follower_force(self, load, displacement):
        """Pressures on the exposed faces of cells [N]: minus the pressure times the gradient of the volume between the
        faces and the origin, less the contribution of the rims of an open boundary. A corner moves with the points
        around it by the least weights that are exact for linear fields."""
        total = numpy.zeros(displacement.shape, numpy.asarray(displacement).dtype)
        for table in self.case.get("load"):
            if "pressure" not in table:
                continue
            corners, faces, around = self.faces(table)
            weights = [self.linear_weights(corner, points) for corner, points in zip(corners, around)]
            places = numpy.array([corner + weight @ displacement[points]
                                  for corner, weight, points in zip(corners, weights, around)])  # fmt: skip
            centres = numpy.array([corners[list(face)].mean(axis=0) for face, _ in faces])
            pressures = evaluate(table["pressure"], centres, load, self.spacings) * self.case.cross_section
            for (face, sign), pressure in zip(faces, pressures):
                for corner, force in zip(face, face_forces(places[list(face)])):
                    total[around[corner]] -= sign * pressure * numpy.outer(weights[corner], force)
        return total

    def linear_weights(self, corner, points):
        sums = numpy.vstack([numpy.ones(len(points)), (self.reference[points] - corner).T / self.spacing])
        return numpy.linalg.pinv(sums)[:, 0]

    def faces(self, table):
        """Reference corners, faces as corner numbers with the sign of their normal, points around corners."""
        dimension = self.reference.shape[1]
        low = self.reference.min(axis=0)
        inside = self.is_in_body()
        cell = numpy.rint((self.reference - low) / self.spacing).astype(int)
        body = {tuple(c): k for k, c in enumerate(cell) if inside[k]}
        sides = [(axis, sign) for axis in range(dimension) for sign in (-1, 1)]
        members = self.sets[table["set"]] if "set" in table else inside
        if "side" in table:
            sides = [("xyz".index(table["side"][0]), 1 if table["side"][1] == "+" else -1)]
            if "set" not in table:
                axis, sign = sides[0]
                along = sign * cell[:, axis]
                members = inside & (along == along[inside].max())
        numbers, faces = {}, []
        for place, k in body.items():
            for axis, sign in sides if members[k] else []:
                beyond = numpy.array(place)
                beyond[axis] += sign
                if tuple(beyond) in body:
                    continue
                others = [c % dimension for c in range(axis + 1, axis + dimension)]
                rounds = {1: [()], 2: [(1,), (-1,)] if axis == 1 else [(-1,), (1,)],
                          3: [(-1, -1), (1, -1), (1, 1), (-1, 1)]}[dimension]  # fmt: skip
                face = []
                for shifts in rounds:
                    corner = 2 * numpy.array(place)
                    corner[axis] += sign
                    corner[others] += numpy.array(shifts, int)
                    face.append(numbers.setdefault(tuple(corner), len(numbers)))
                faces.append((tuple(face), sign))
        corners = low + numpy.array(list(numbers), float) * self.spacing / 2
        around = [[k for place, k in body.items() if (numpy.abs(2 * numpy.array(place) - corner) <= 3).all()]
                  for corner in numbers]  # fmt: skip
        return corners, faces, around

    def of_material(self, quantity):
        """The property of every point's material."""
        values = numpy.full(len(self.volume), float(self.case["material"].get(quantity, numpy.nan)))
        for region in self.case.get("region"):
            values[self.sets[region["set"]]] = region["material"][quantity]
        return values

    def is_in_body(self):
        inside = numpy.ones(len(self.volume), bool)
        for layer in self.case.get("lattice", {}).get("layer", []):
            inside &= ~self.sets[layer["name"]]
        return inside

    def traction_areas(self, table, members):
        """Per point: the loaded faces of cells, each shared by the points below it within the depth."""
        inside = self.is_in_body()
        cell = numpy.rint((self.reference - self.reference.min(axis=0)) / self.spacing).astype(int)
        body = {tuple(c): k for k, c in enumerate(cell) if inside[k]}
        sides = [(axis, sign) for axis in range(cell.shape[1]) for sign in (-1, 1)]
        if "side" in table:
            sides = [("xyz".index(table["side"][0]), 1 if table["side"][1] == "+" else -1)]

        def beside(place, axis, step):
            return (*place[:axis], place[axis] + step, *place[axis + 1 :])

        for axis, sign in sides:
            along = {k: sign * place[axis] for place, k in body.items()}
            row = [k for k in along if members[k] and ("set" in table or along[k] == max(along.values()))]
            if len({along[k] for k in row}) == 1 and not any(beside(cell[k], axis, sign) in body for k in row):
                break
        depth = 1.0
        if table.get("depth") == "horizon":
            depth = max(1.0, self.case.horizon() / self.spacing)
        area = numpy.zeros(len(self.volume))
        for first in row:
            column, place = [], tuple(cell[first])
            while place in body and len(column) < depth - 1e-9:
                column.append((body[place], min(1.0, depth - len(column))))
                place = beside(place, axis, -sign)
            for k, part in column:
                area[k] += self.volume[first] / self.spacing * part / sum(p for _, p in column)
        return area

    def eigenstretch(self, load):
        """Change per point; None if there is none."""
        strained, temperature = self.case.get("eigenstrain"), self.case.get("temperature", {})
        if not strained and not temperature:
            return None
        total = numpy.zeros(len(self.volume))
        for table in strained:
            inside = self.sets[table["set"]] if "set" in table else slice(None)
            total[inside] += evaluate(table["strain"], self.reference, load, self.spacings)[inside]
        if temperature:
            change = evaluate(temperature["change"], self.reference, load, self.spacings)
            total += self.of_material("thermal_expansion") * change
        return total
