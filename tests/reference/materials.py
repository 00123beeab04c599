"""Materials of points and of the bonds between them (docs/theory.md, Regions)."""

import itertools
import math

import numpy

from tests.reference.laws import Law, curve_of, ends_of

BETWEEN = {
    "harmonic": lambda values: 0.0 * values[0] if (numpy.array(values) == 0).any() else len(values) / sum(1 / v for v in values),
    "arithmetic": lambda values: sum(values) / len(values),
    "weaker": lambda values: numpy.minimum.reduce(values),
}


class Materials:
    """Tables of the materials, each point's material number, and the rules between materials."""

    def __init__(self, case, sets, count, factors=None):
        self.case, self.factors = case, factors or {}
        self.tables, self.names = [], []
        if case.has_material:
            self.tables.append(case["material"])
            self.names.append("material")
        self.number = numpy.zeros(count, int)
        for region in case.get("region"):
            self.number[sets[region["set"]]] = len(self.tables)
            self.tables.append(region["material"])
            self.names.append(region["set"])

    @property
    def are_one(self):
        return len(self.tables) == 1 and not self.factors and "fibre" not in self.tables[0]

    def interface(self, a, b):
        """The table for the interface between two materials, by their numbers."""
        of_all = {}
        for table in self.case.get("interface"):
            if "between" not in table:
                of_all = table
            elif set(table["between"]) == {self.names[a], self.names[b]}:
                return table
        return of_all

    def _by_pair(self, pairs, value):
        """value(table) of bonds within a material, combined by the rule for bonds between two."""
        first, second = numpy.sort(self.number[pairs], axis=1).T
        result = numpy.empty(len(pairs))
        for a, b in itertools.combinations_with_replacement(range(len(self.tables)), 2):
            mask = (first == a) & (second == b)
            if a == b:
                result[mask] = value(self.tables[a])[mask]
                continue
            table = self.interface(a, b)
            if "material" in table:
                result[mask] = value(table["material"])[mask]
            else:
                both = [value(self.tables[k])[mask] for k in (a, b)]
                if mask.any():
                    result[mask] = BETWEEN[table.get("rule", "harmonic")](both)
        return result

    def factor(self, name, tuples):
        """Mean of the random factors of a tuple's points."""
        return self.factors[name][tuples].mean(axis=1) if name in self.factors else 1.0

    # ---- bonds -----------------------------------------------------------------------------------

    def bond_constants(self, pairs, direction, of_modulus):
        """c of bonds; of_modulus is c / E for isotropic bonds."""

        def value(table):
            if "fibre" in table:
                return directed_constant(table, direction, of_modulus)
            c = table["micromodulus"] if "micromodulus" in table else table["youngs_modulus"] * of_modulus
            return numpy.full(len(pairs), float(c))

        return self._by_pair(pairs, value) * self.factor("stiffness", pairs)

    def constants(self, tuples, name):
        """C1, C2 or C3 of interactions. For points of two materials it is their mean by the rule; for points of more,
        the mean over all pairs of points."""
        kinds = numpy.sort(self.number[tuples], axis=1)
        result = numpy.empty(len(tuples))
        for row in numpy.unique(kinds, axis=0):
            mask, present = (kinds == row).all(axis=1), sorted(set(row.tolist()))
            values = []
            for a, b in itertools.combinations(present, 2):
                table = self.interface(a, b)
                if "material" in table:
                    values.append(table["material"].get(name, 0.0))
                else:
                    of_points = [float(self.tables[k].get(name, 0.0)) for k in row if k in (a, b)]
                    values.append(BETWEEN[table.get("rule", "harmonic")](of_points))
            result[mask] = numpy.mean(values) if values else self.tables[present[0]].get(name, 0.0)
        return result

    # ---- damage ----------------------------------------------------------------------------------

    def law(self, pairs, direction):
        """The laws of bonds, and the mask of bonds without a law."""
        first, second = numpy.sort(self.number[pairs], axis=1).T
        count = len(pairs)
        law = Law(numpy.full(count, "none", "U20"), *(numpy.full(count, value) for value in (numpy.inf, numpy.inf, 3.0, 0.0, 0.0)))

        def put(mask, table, onset, critical):
            law.name[mask], law.rate[mask] = table["law"], table["rate"]
            law.onset[mask], law.critical[mask] = onset[mask], critical[mask]
            law.hardening[mask] = table["hardening"]
            if table["law"] == "table":
                assert law.curve is None or str(law.curve) == str(curve_of(table)), "one curve for all"
                law.curve = curve_of(table)
            if table["law"] == "blended":
                law.peak[mask] = law.onset[mask] + rise(table) * (critical - onset)[mask]

        for a, b in itertools.combinations_with_replacement(range(len(self.tables)), 2):
            mask, interface = (first == a) & (second == b), self.interface(a, b) if a != b else {}
            tables = [self.tables[k] for k in ((a, b) if a != b else (a,))]
            if "material" in interface:
                tables = [interface["material"]]
            failing = [(damage_of(t), *self._stretches(t, direction)) for t in tables if damage_of(t)]
            if len(failing) == 2 and like(failing[0][0], failing[1][0]):
                rule = BETWEEN[interface.get("rule", "harmonic")]
                put(mask, failing[0][0], rule([failing[0][1], failing[1][1]]), rule([failing[0][2], failing[1][2]]))
            elif len(failing) == 2:
                one_is_weaker = failing[0][2] <= failing[1][2]
                put(mask & one_is_weaker, *failing[0])
                put(mask & ~one_is_weaker, *failing[1])
            elif failing:
                put(mask, *failing[0])
        factor = self.factor("strength", pairs)
        law.onset, law.critical, law.peak = law.onset * factor, law.critical * factor, law.peak * factor
        return law

    @staticmethod
    def _stretches(table, direction):
        damage = damage_of(table)
        share = numpy.ones(len(direction))
        if "transverse_critical" in table.get("fibre", {}):
            along = alignment(table["fibre"], direction)
            share = along + (1 - along) * table["fibre"]["transverse_critical"] / damage["critical"]
        onset = damage["critical"] if damage["law"] == "critical_stretch" else damage["onset"]
        return share * onset, share * damage["critical"]

    @property
    def no_fail(self):
        """Sets whose points' bonds never fail, over all materials."""
        tables = self.tables + [t["material"] for t in self.case.get("interface") if "material" in t]
        return [name for table in tables if damage_of(table) for name in damage_of(table)["no_fail"]]


def damage_of(table):
    damage = table.get("damage", {})
    if damage.get("law", "none") == "none":
        return None
    ends = ends_of(damage) if damage["law"] == "table" else {}
    return {"rate": 3.0, "hardening": 0.5, "no_fail": []} | ends | damage


def rise(damage):
    """Share of the range from onset to critical over which the force of the blended law rises."""
    return (damage["peak"] - damage["onset"]) / (damage["critical"] - damage["onset"])


def like(one, other):
    if one["law"] != other["law"]:
        return False
    if one["law"] == "blended":
        return one["hardening"] == other["hardening"] and rise(one) == rise(other)
    if one["law"] == "table":
        return one["stretches"] == other["stretches"] and one["forces"] == other["forces"]
    return one["law"] in ("critical_stretch", "linear") or one["rate"] == other["rate"]


def alignment(fibre, direction):
    """Squared cosines of the angle to the fibres."""
    if "angle" in fibre:
        angle = math.radians(fibre["angle"])
        along = numpy.array([math.cos(angle), math.sin(angle)])
    else:
        along = numpy.array(fibre["direction"], float)
        along /= numpy.linalg.norm(along)
    return (direction @ along) ** 2


def directed_constant(table, direction, of_modulus):
    """A polynomial of the squared cosine, found by quadrature from the required stiffness."""
    fibre, plane = table["fibre"], direction.shape[1] == 2
    e1, e2 = float(table["youngs_modulus"]), float(fibre["transverse_modulus"])
    poisson = 1 / 3 if plane else 1 / 4
    g = float(fibre.get("shear_modulus", math.sqrt(e1 * e2) / 2 / (1 + poisson)))
    c11, c22 = e1, e2
    for _ in range(200):  # compliance = 1 / E, by iteration
        if plane:
            c11, c22 = e1 + g * g / c22, e2 + g * g / c11
        else:
            c11, c22 = e1 + 1.5 * g * g / c22, 9 / 8 * e2 * (1 + g * g / (2 * e1 * c22))
    if plane:
        angle = (numpy.arange(64) + 0.5) * math.pi / 32
        cosine, mean = numpy.cos(angle), lambda values: values.mean()
        across, mixed = 1.0, 1.0
    else:
        cosine, weights = numpy.polynomial.legendre.leggauss(16)
        mean, (across, mixed) = (lambda values: values @ weights / 2), (3 / 8, 1 / 2)
    t = cosine**2
    # isotropic bonds with E = 1 have the constant of_modulus and the stiffness iso
    iso = 9 / 8 if plane else 6 / 5
    unit = iso / mean(t**2)
    matrix = [[unit * mean(t**k * weight) for k in range(3)]
              for weight in (t**2, across * (1 - t) ** 2, mixed * t * (1 - t))]  # fmt: skip
    coefficients = numpy.linalg.solve(matrix, [c11, c22, g]) * of_modulus
    along = alignment(fibre, direction)
    return coefficients[0] + along * (coefficients[1] + along * coefficients[2])
