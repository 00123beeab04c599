"""Random but valid cases of several materials, with constraints, planes of symmetry, periods, and loads of all
kinds on lattices of all kinds."""

import numpy

from tests.reference.clouds import random_places, toml, write_points
from tests.torture.generator import Generator

ROWS = 1.05  # spacings; more than one row of points, and less than two


class RichGenerator(Generator):
    """Complements its parent's cases: the same kinds of bodies and laws, with all keys that those lack."""

    def __init__(self, seed, number):
        super().__init__(seed, number)
        self.random = numpy.random.default_rng([seed, number, 1])

    def make(self, folder):
        self.dimension = int(self.choice(1, 2, 3, weights=(0.1, 0.6, 0.3)))
        self.model = "cpd" if self.dimension > 1 and self.chance(0.3) else "bond"
        self.spacing = self.power(-3, 1)
        self.axes = "xyz"[: self.dimension]
        case = {"dimension": self.dimension}
        self.is_cloud = self.chance(0.25)
        self.is_square = True
        case.update(self.cloud(folder) if self.is_cloud else self.lattice())
        case.update(self.beyond())
        case["material"] = self.material(self.is_cloud)
        case["quadrature"] = self.quadrature(case.get("lattice", {}))
        self.several_materials(case)
        self.warmth(case)
        self.hold_and_load(case)
        if self.dimension > 1 and self.chance(0.2):
            case["crack"] = [self.crack()]
        case.update(self.solution())
        if "temperature" in case or "eigenstrain" in case:
            case["solver"]["fragments"] = self.choice("hold", "stop")
        self.path(case)
        path = folder / "case.toml"
        path.write_text(toml(case))
        return path

    # ---- bodies ----------------------------------------------------------------------------------

    def lattice(self):
        counts = self.counts()
        lattice = {"spacing": self.spacing, "horizon_ratio": self.horizon_ratio()}
        self.spacings = numpy.full(self.dimension, self.spacing)
        self.turned = self.cut = False
        if self.model == "bond" and self.dimension > 1:
            if self.chance(0.2):
                self.spacings = self.spacing * self.random.uniform(0.8, 1.25, self.dimension)
                lattice["spacing"], self.is_square = self.spacings.tolist(), False
            self.turned = self.chance(0.15)
            self.cut = self.chance(0.2)
        self.size = [float(n * spacing) for n, spacing in zip(counts, self.spacings)]
        shapes = [{"add": "box", "min": [0.0] * self.dimension, "max": self.size}]
        if self.turned:
            lattice["angle"] = self.between(-60, 60)
        if self.cut:
            lattice["volumes"] = "fractional"
        if self.dimension == 2 and self.chance(0.25):
            centre = [self.between(0.3, 0.7) * side for side in self.size]
            shapes.append({"subtract": "disk", "centre": centre, "radius": self.between(0.1, 0.25) * min(self.size)})
            self.hole = centre, shapes[-1]["radius"]
        lattice["shape"] = shapes
        self.cross_section = self.power(-1, 1) * self.spacing if self.dimension < 3 else 1.0
        if self.dimension < 3:
            lattice[{1: "area", 2: "thickness"}[self.dimension]] = self.cross_section
        if self.chance(0.25):
            lattice.update({"perturbation": self.between(0, 0.25), "seed": int(self.random.integers(1, 1000))})
        self.is_plain = self.is_square and not self.turned and not self.cut
        edge = (1.6 if self.turned else ROWS) * self.spacings[0]
        sets = [{"name": "left", "where": f"x < {edge:.9g}"}, {"name": "right", "where": f"x > {self.size[0] - edge:.9g}"},
                {"name": "half", "where": f"x > {0.45 * self.size[0]:.9g}"}]  # fmt: skip
        return {"lattice": lattice, "set": sets}

    def cloud(self, folder):
        """Points in a box, which may be the continuation of another; with neighbours from a file at times."""
        side = {1: 14, 2: 7, 3: 4}[self.dimension]
        reference = (random_places(self.random, side**self.dimension, self.dimension) + 0.5) * self.spacing
        self.size, self.spacings = [side * self.spacing] * self.dimension, numpy.full(self.dimension, self.spacing)
        self.turned, self.is_plain = False, False
        self.cross_section = self.spacing if self.dimension < 3 else 1.0
        volume = self.random.uniform(0.8, 1.25, len(reference)) * self.spacing**self.dimension * self.cross_section
        x = reference[:, 0] / self.spacing
        write_points(folder / "points.csv", reference, volume, {"left": x < 1.2, "right": x > side - 1.2, "half": x > 0.45 * side})
        points = {"file": "points.csv", "horizon": self.horizon_ratio() * self.spacing * 1.1}
        self.has_list = self.model == "bond" and self.chance(0.3)
        if self.has_list:
            self.write_neighbours(folder, reference, points["horizon"])
            points["neighbours"] = "neighbours.txt"
        if self.dimension < 3:
            points[{1: "area", 2: "thickness"}[self.dimension]] = self.cross_section
        return {"points": points}

    def write_neighbours(self, folder, reference, horizon):
        distance = numpy.sqrt(((reference[:, None] - reference[None]) ** 2).sum(axis=2))
        lines = ["i j w_ij w_ji"]
        for i, j in numpy.argwhere(numpy.triu(distance < horizon, 1)).tolist():
            lines.append(f"{i + 1} {j + 1} {self.between(0.2, 1)} {self.between(0.2, 1)}")
        (folder / "neighbours.txt").write_text("\n".join(lines) + "\n")

    # ---- planes and periods -----------------------------------------------------------------------

    def beyond(self):
        """Planes of symmetry and periods; the body's left end stays free for supports."""
        self.kinds = dict.fromkeys(self.axes, "end")
        found = {"symmetry": [], "period": []}
        if self.turned or getattr(self, "has_list", False) or not self.chance(0.5):
            return {}
        for axis, side in zip(self.axes, self.size):
            kinds = ("end", "high") if axis == "x" else ("end", "low", "high", "both", "period")
            if axis == "x" and self.chance(0.25):
                kinds = ("period",)
            kind = self.kinds[axis] = str(self.choice(*kinds))
            if kind in ("low", "both"):
                found["symmetry"].append({"axis": axis, "at": 0.0})
            if kind in ("high", "both"):
                found["symmetry"].append({"axis": axis, "at": side})
            if kind == "period":
                found["period"].append({"axis": axis, "from": 0.0, "to": side})
        for table in found["period"]:
            table["gradient"] = [self.jump(table["axis"], component) for component in self.axes]
        return {name: tables for name, tables in found.items() if tables}

    def jump(self, axis, component):
        """The shear between two periods is given for one of them only: free shears would let the cell rotate."""
        if self.is_mirrored(component) or axis > component:
            return "0"
        if axis == component and axis != "x" and self.chance(0.5):
            return "free"
        return f"{self.between(-0.01, 0.01) if axis != component else self.between(-0.01, 0.03):.5f}*load"

    def is_mirrored(self, axis):
        return self.kinds[axis] in ("low", "high", "both")

    @property
    def is_continued(self):
        return any(kind != "end" for kind in self.kinds.values())

    # ---- materials -------------------------------------------------------------------------------

    def quadrature(self, place):
        quadrature = super().quadrature(place)
        if not self.is_square or getattr(self, "has_list", False):
            quadrature.pop("volume_correction", None)
        if getattr(self, "has_list", False) and quadrature["surface_correction"] == "volume":
            quadrature["surface_correction"] = "energy"
        return quadrature

    def several_materials(self, case):
        material = case["material"]
        if self.chance(0.15):
            material["scatter"] = [{"of": self.choice("stiffness", "strength") if "damage" in material else "stiffness",
                                    "weibull_modulus": self.between(5, 30), "seed": int(self.random.integers(100)),
                                    "correlation_length": self.choice(0.0, 2 * self.spacing)}]  # fmt: skip
        if self.model == "bond" and self.dimension > 1 and material.get("plane") != "strain" and self.chance(0.2):
            material["fibre"] = self.fibre()
        if not self.chance(0.3):
            return
        other = {key: value for key, value in material.items() if key not in ("scatter", "fibre")}
        for key in ("youngs_modulus", "c1", "c2", "c3"):
            if key in other:
                other[key] *= self.power(-1, 1)
        if "damage" in other and self.chance(0.5):
            other["damage"] = other["damage"] | {"critical": 1.7 * other["damage"]["critical"]}
        case["region"] = [{"set": "half", "material": other}]
        if self.chance(0.5):
            table = {"rule": self.choice("harmonic", "arithmetic", "weaker")}
            if self.chance(0.3):
                own = {key: value for key, value in other.items() if key not in ("density", "plane")}
                table = {"between": ["half", "material"], "material": own}
            case["interface"] = [table]

    def fibre(self):
        along_axis = any(self.is_mirrored(axis) for axis in self.axes)
        fibre = {"transverse_modulus": self.modulus * self.between(0.3, 0.9)}
        if self.dimension == 2:
            fibre["angle"] = self.choice(0, 90) if along_axis else self.between(-90, 90)
        else:
            direction = self.choice([1, 0, 0], [0, 0, 2]) if along_axis else self.random.normal(size=3).tolist()
            fibre["direction"] = list(map(float, direction))
        return fibre

    def choice(self, *options, weights=None):
        return options[self.random.choice(len(options), p=weights)]

    def warmth(self, case):
        strain = self.critical * self.power(-1, 0.3)
        if self.chance(0.12):
            for table in [case, *case.get("region", [])]:
                table["material"]["thermal_expansion"] = self.power(-6, -4)
            expansion = case["material"]["thermal_expansion"]
            case["temperature"] = {"change": f"{strain / expansion:.6g}*load*(1 + 0.2*sin(x/{self.size[0]:.6g}))"}
        if self.chance(0.12):
            case["eigenstrain"] = [{"set": "half", "strain": f"{-strain:.6g}*load"}]

    # ---- conditions ------------------------------------------------------------------------------

    def hold_and_load(self, case):
        """The left end is held, the right one is moved in one of many ways, or the body is loaded; a cell may float."""
        self.reach = min(self.critical * self.power(-0.7, 1.3), 0.5) * self.size[0]
        still = [0] * self.dimension
        floats = self.kinds["x"] == "period" and self.chance(0.6)
        if not floats:
            case["support"] = [{"set": "left", "displacement": still}]
        is_open = self.kinds["x"] == "end"  # the right end can be moved
        ways = ["nothing"] if not is_open else ["pull"]
        if is_open and self.dimension > 1:
            ways += ["rigid", "platen", "slope", "constraint", "touching"]
        getattr(self, f"by_{self.choice(*ways)}")(case)
        self.is_constrained = any(name in case for name in ("rigid", "roller", "constraint")) or self.is_continued
        if not floats and self.chance(0.6):
            self.load(case)

    def by_nothing(self, case):
        pass

    def by_pull(self, case):
        others = ["free" if self.chance(0.5) else 0 for _ in range(self.dimension - 1)]
        case["support"].append({"set": "right", "displacement": [f"{self.reach:.6e}*load", *others]})

    def by_rigid(self, case):
        table = {"set": "right", "displacement": [f"{self.reach:.6e}*load" if self.chance(0.7) else "free"]}
        table["displacement"] += [0 if self.is_mirrored(axis) else self.choice("free", 0) for axis in self.axes[1:]]
        turns = 1 if self.dimension == 2 else 3
        given = any(self.is_mirrored(axis) for axis in self.axes[1:])
        table["rotation"] = ["0" if given or self.chance(0.3) else self.choice("free", f"{self.reach / self.size[0]:.6g}*load")
                             for _ in range(turns)]  # fmt: skip
        case["rigid"] = [table]

    def by_platen(self, case):
        case["roller"] = [{"set": "right", "normal": [1] + [0] * (self.dimension - 1), "displacement": "free"}]

    def by_slope(self, case):
        normal = [1.0, *(0.0 if self.is_mirrored(axis) else self.between(-0.5, 0.5) for axis in self.axes[1:])]
        case["roller"] = [{"set": "right", "normal": normal, "displacement": f"{self.reach:.6e}*load"}]

    def by_constraint(self, case):
        weights = [1.0, *(0.0 if self.is_mirrored(axis) else self.between(-1, 1) for axis in self.axes[1:])]
        case["constraint"] = [{"name": "tie", "displacement": f"{self.reach:.6e}*load",
                               "term": [{"set": "right", "weights": weights}]}]  # fmt: skip
        if self.chance(0.4) and not self.is_cloud:
            case["constraint"][0]["term"].append({"set": "half", "weights": [-0.5] + [0.0] * (self.dimension - 1)})

    def by_touching(self, case):
        if self.is_cloud or not self.is_plain or self.kinds["y"] != "end":
            return self.by_pull(case)
        at = [0.7 * self.size[0], 0.0, 0.5 * (self.size[2] if self.dimension == 3 else 0)][: self.dimension]
        table = {"name": "foot", "at": at, "normal": [0, 1, 0][: self.dimension], "displacement": f"{self.reach:.6e}*load"}
        if self.dimension == 3 and self.chance(0.5):
            table |= {"at": [at[0], 0.0, 0.0], "to": [at[0], 0.0, self.size[2]]}
        case["roller"] = [table]

    def load(self, case):
        """A load of about a share of the strength."""
        stress = self.modulus * self.critical * self.power(-1.5, 0.2)
        density = stress / self.size[0]
        kinds = ["body_force", "total_force", "gravity"]
        if self.is_plain and self.dimension > 1 and self.kinds["y"] in ("end", "low"):
            kinds += ["traction", "traction"]
            if not self.is_constrained:
                kinds += ["pressure", "pressure"]
        kind = self.choice(*kinds)
        direction = [self.choice(0, 1, -1) for _ in self.axes] if self.chance(0.5) else [1] + [0] * (self.dimension - 1)
        direction = [0 if self.is_mirrored(axis) else d for axis, d in zip(self.axes, direction)]
        if kind == "gravity":
            for table in [case, *case.get("region", [])]:
                table["material"]["density"] = density / 9.81
            table = {"gravity": [f"{9.81 * d}*load" for d in direction]}
        elif kind == "total_force":
            area = self.cross_section * (numpy.prod(self.size[1:]) if self.dimension > 1 else 1)
            table = {"set": "half", "total_force": [f"{stress * area * d:.6g}*load" for d in direction]}
        elif kind == "body_force":
            table = {"set": "half", "body_force": [f"{density * d:.6g}*load*(1 + x/{self.size[0]:.6g})" for d in direction]}
        elif kind == "traction":
            table = {"side": "y+", "traction": [f"{stress * d:.6g}*load" for d in direction]}
            if self.kinds["y"] == "end" and self.chance(0.4):
                table["depth"] = "horizon"
        else:
            table = {"side": "y+", "pressure": f"{0.3 * stress:.6g}*load"}
            if hasattr(self, "hole") and self.chance(0.5):
                (x, y), radius = self.hole
                case["set"].append({"name": "rim", "where": f"(x-{x:.9g})^2 + (y-{y:.9g})^2 < {(radius + 1.2 * self.spacing) ** 2:.9g}"})
                table = {"set": "rim", "pressure": f"{0.5 * stress:.6g}*load"}
        case["load"] = [table]

    # ---- the path --------------------------------------------------------------------------------

    def path(self, case):
        kind = self.choice("straight", "cycle", "waves", "control", weights=(0.6, 0.2, 0.1, 0.1))
        loading, relaxation = case["loading"], case["relaxation"]
        steps = loading["steps"] = min(loading["steps"], 8)
        relaxation["steps"] = min(relaxation["steps"], 8)
        if kind == "cycle":
            loading.update({"table": [0, 0.7, 0.1, 1.0], "steps": max(1, steps // 3)})
            loading["table2"] = [0, 1, 1, -0.5]
            self.add_second_load(case)
        elif kind == "waves":
            loading.update({"table": f"sin(pi*step/{steps + 1})", "steps": max(2, steps)})
        elif kind == "control" and case.get("support", [])[1:] and self.kinds["x"] == "end":
            case["solver"].update({"mode": "newton", "linear": "auto"})
            case["solver"].pop("preconditioner", None)
            case["control"] = [{"set": "half", "weights": [1] + [0] * (self.dimension - 1)}]
            loading.update({"table": [0, self.reach], "smallest_step": 0.05})

    def add_second_load(self, case):
        free = next((axis for axis, letter in enumerate(self.axes) if not self.is_mirrored(letter)), None)
        if free is None or "support" not in case:
            return
        force = [0] * self.dimension
        force[free] = f"{self.modulus * self.critical * 0.02 / self.size[0]:.6g}*load2"
        case.setdefault("load", []).append({"set": "half", "body_force": force})
