"""Random but valid cases: bodies, materials, supports and loads, solution methods."""

import numpy

from tests.reference.clouds import random_places, toml, write_points
from tests.reference.influence import POWERS

PRECONDITIONERS = ("auto", "jacobi", "block_jacobi", "rigid_pieces", "surrogate", "riluk", "chebyshev", "multigrid")


class Generator:
    """Makes the case for a seed and a number, reproducibly."""

    def __init__(self, seed, number):
        self.random = numpy.random.default_rng([seed, number])
        self.of_kernel = numpy.random.default_rng([seed, number, 2])  # keeps the rest of a case unchanged

    def choice(self, *options, weights=None):
        return options[self.random.choice(len(options), p=weights)]

    def chance(self, probability):
        return self.random.random() < probability

    def between(self, low, high):
        return float(self.random.uniform(low, high))

    def power(self, low, high):
        """Between 10^low and 10^high, log-uniform."""
        return float(10 ** self.random.uniform(low, high))

    def make(self, folder):
        self.dimension = int(self.choice(1, 2, 3, weights=(0.15, 0.5, 0.35)))
        self.model = "cpd" if self.dimension > 1 and self.chance(0.3) else "bond"
        self.spacing = self.power(-4, 1)
        case = {"dimension": self.dimension}
        from_file = self.chance(0.2)
        case.update(self.cloud(folder) if from_file else self.lattice())
        if not from_file and self.dimension > 1 and self.chance(0.25):
            case["crack"] = [self.crack()]
        case["material"] = self.material(from_file)
        case["quadrature"] = self.quadrature(case.get("lattice", {}))
        self.supports_and_loads(case, from_file)
        case.update(self.solution())
        path = folder / "case.toml"
        path.write_text(toml(case))
        return path

    # ---- bodies ----------------------------------------------------------------------------------

    def counts(self):
        if self.model == "cpd":
            ranges = {2: ((5, 12), (4, 8)), 3: ((4, 6), (3, 5), (3, 4))}[self.dimension]
        else:
            ranges = {1: ((6, 60),), 2: ((6, 24), (4, 12)), 3: ((4, 9), (3, 6), (3, 5))}[self.dimension]
        return [int(self.random.integers(low, high)) for low, high in ranges]

    def horizon_ratio(self):
        if self.model == "cpd" and self.dimension == 3:
            return self.choice(1.5, 1.75, 2.015)
        return self.choice(1.5, 2.015, 3.015, 3.0, self.between(1.45, 3.3))

    def lattice(self):
        self.size = [n * self.spacing for n in self.counts()]
        shapes = [{"add": "box", "min": [0.0] * self.dimension, "max": self.size}]
        if self.dimension > 1 and self.chance(0.35):
            centre = [self.between(0.3, 0.7) * side for side in self.size]
            radius = self.between(0.1, 0.3) * min(self.size)
            kind = self.choice("disk", "ellipse") if self.dimension == 2 else self.choice("sphere", "cylinder")
            size = {"radius": radius}
            if kind == "ellipse":
                size = {"radii": [radius, self.between(0.3, 1) * radius], "angle": self.between(-180, 180)}
            shapes.append({"subtract": kind, "centre": centre} | size)
        thickness = int(self.random.integers(1, 4))
        layers = [{"name": name, "side": side, "thickness": thickness} for name, side in (("left", "x-"), ("right", "x+"))]
        lattice = {"spacing": self.spacing, "horizon_ratio": self.horizon_ratio(), "shape": shapes, "layer": layers}
        if self.dimension < 3:
            self.cross_section = self.power(-1, 1) * self.spacing
            lattice[{1: "area", 2: "thickness"}[self.dimension]] = self.cross_section
        if self.chance(0.4):
            lattice["perturbation"] = self.between(0, 0.3)
            lattice["seed"] = int(self.random.integers(1, 1000))
        return {"lattice": lattice}

    def cloud(self, folder):
        count = {1: 30, 2: 90, 3: 100}[self.dimension] if self.model == "bond" else {2: 50, 3: 40}[self.dimension]
        reference = random_places(self.random, count, self.dimension) * self.spacing
        self.size = list(reference.max(axis=0) - reference.min(axis=0))
        self.cross_section = self.spacing if self.dimension < 3 else 1.0
        volume = self.random.uniform(0.8, 1.25, count) * self.spacing**self.dimension * self.cross_section
        x = reference[:, 0] / self.spacing
        sets = {"left": x < x.min() + 1.2, "right": x > x.max() - 1.2}
        write_points(folder / "points.csv", reference, volume, sets)
        points = {"file": "points.csv", "horizon": self.horizon_ratio() * self.spacing * 1.1}
        if self.dimension < 3:
            points[{1: "area", 2: "thickness"}[self.dimension]] = self.cross_section
        return {"points": points}

    def crack(self):
        """A pre-crack across the body, between two planes of points."""
        x = round(self.between(0.3, 0.7) * self.size[0] / self.spacing) * self.spacing + 0.013 * self.spacing
        depth = self.between(0.1, 0.6) * self.size[1] + 0.007 * self.spacing
        low = -0.53 * self.spacing
        if self.dimension == 2:
            return {"from": [x, low], "to": [x, depth]}
        high = self.size[2] + 0.53 * self.spacing
        return {"vertices": [[x, low, low], [x, depth, low], [x, depth, high], [x, low, high]]}

    def material(self, from_file):
        self.modulus = self.power(0, 11)
        material = {"model": self.model}
        if self.model == "bond":
            material["youngs_modulus"] = self.modulus
            if self.dimension == 2:
                material["plane"] = self.choice("stress", "strain")
        else:
            # Constants with stiffnesses of the same order: bonds, triangles and tetrahedra with a horizon
            # of two spacings all contribute.
            horizon = 2 * self.spacing
            unit = self.cross_section * horizon**3 if self.dimension == 2 else horizon**4
            plane = horizon**6 * self.cross_section**2 if self.dimension == 2 else horizon**8
            material["c1"] = 8 * self.modulus / unit
            material["c2"] = self.choice(0.0, 0.3, 3.0) * self.modulus / plane
            if self.dimension == 3:
                material["c3"] = self.choice(0.0, 0.5, 5.0) * self.modulus / horizon**12
        if self.of_kernel.random() < 0.3:
            material["influence"] = str(self.of_kernel.choice([*POWERS, "gaussian"]))
        law = self.choice("none", "critical_stretch", "tanh", "tanh_continuous", "linear", "exponential", "blended",
                          "table", "bilinear", "cornelissen",
                          weights=(0.2, 0.2, 0.15, 0.2, 0.07, 0.04, 0.04, 0.04, 0.03, 0.03))  # fmt: skip
        self.critical = self.power(-4, -1)
        if law != "none":
            damage = {"law": law, "critical": self.critical}
            if law != "critical_stretch":
                damage["onset"] = self.critical * self.between(0.2, 0.95)
            if law in ("bilinear", "cornelissen"):
                damage["onset"] *= {"bilinear": 1 / 3, "cornelissen": 1 / 7}[law]
            if law in ("tanh", "tanh_continuous", "exponential"):
                damage["rate"] = self.power(-0.5, 1)
            if law == "blended":
                damage["peak"] = damage["onset"] + self.between(0.1, 0.9) * (self.critical - damage["onset"])
                damage["hardening"] = self.between(0.1, 0.9)
            if law == "table":
                onset, fallen = damage["onset"], self.between(0.05, 0.95)
                damage = {"law": law, "stretches": [onset, (onset + self.critical) / 2, self.critical],
                          "forces": [onset, onset * fallen, onset * fallen * self.between(0.0, 1.0)]}  # fmt: skip
            if self.chance(0.6):
                damage["no_fail"] = ["left", "right"]
            material["damage"] = damage
        return material

    def quadrature(self, place):
        """place: the table that defines the points."""
        if self.model == "cpd":
            return {"weights": self.choice("mean", "bulk")}
        has_whole_cells = "spacing" in place and not {"perturbation", "volumes"} & set(place)
        quadrature = {"volume_correction": self.choice("none", "linear"),
                      "surface_correction": self.choice("none", "volume", "energy")}  # fmt: skip
        if has_whole_cells and self.of_kernel.random() < 0.3:
            quadrature["volume_correction"] = str(self.of_kernel.choice(["exact", "exact_centroids"]))
        elif self.dimension > 1 and quadrature["volume_correction"] == "none" and self.of_kernel.random() < 0.3:
            quadrature["horizon_shape"] = str(self.of_kernel.choice(["box", "diamond"]))
        return quadrature

    # ---- conditions and solution -----------------------------------------------------------------

    def supports_and_loads(self, case, from_file):
        strain = self.critical * self.power(-0.7, 2)
        reach = min(strain, 3.0) * self.size[0]
        still = [0] * self.dimension
        case["support"] = [{"set": "left", "displacement": still}]
        kind = self.choice("pull", "shear", "wave", "force", "confined", weights=(0.4, 0.1, 0.2, 0.2, 0.1))
        if kind == "force":
            side = numpy.prod(self.size[1:]) if self.dimension > 1 else 1.0
            area = side * (self.cross_section if self.dimension < 3 else 1.0)
            force = self.modulus * area * strain
            direction = int(self.random.integers(self.dimension)) if self.chance(0.3) else 0
            components = [f"{force if axis == direction else 0:.6e}*load" for axis in range(self.dimension)]
            case["load"] = [{"set": "right", "total_force": components}]
            return
        along = f"{reach:.6e}*load"
        if kind == "wave":
            along = f"{reach:.6e}*sin({self.between(2, 12):.4f}*load)"
        axis = 1 if kind == "shear" and self.dimension > 1 else 0
        other = "free" if kind in ("pull", "wave") and self.chance(0.5) else 0
        displacement = [along if k == axis else other for k in range(self.dimension)]
        case["support"].append({"set": "right", "displacement": displacement})

    def solution(self):
        solver = {"mode": self.choice("newton", "relaxation", "adaptive", weights=(0.35, 0.25, 0.4)),
                  "relative_tolerance": self.power(-10, -5), "fragments": self.choice("hold", "remove", "stop"),
                  "linear": self.choice("auto", "cholesky", "pcg")}  # fmt: skip
        if solver["linear"] == "pcg":
            solver["preconditioner"] = self.choice(*PRECONDITIONERS)
        steps = int(self.random.integers(1, 31))
        relaxation = {"steps": int(self.random.integers(1, 31)), "max_iterations": 4000,
                      "ramp": int(self.power(0.5, 2.3)), "breaking": self.choice("at_equilibrium", "transient"),
                      "damping": self.choice("adaptive", "kinetic"), "mass_factor": self.choice(1.0, 2.0, 5.0)}  # fmt: skip
        loading = {"steps": steps, "smallest_step": 0.02, "adaptive": self.chance(0.8)}
        return {"solver": solver, "relaxation": relaxation, "loading": loading}
