"""Moduli and fracture data of a material as constants and stretches of its bonds (docs/theory.md)."""

import itertools
import math

import numpy

from tests.reference.influence import influence, relative_moment
from tests.reference.laws import Law
from tests.reference.pull import Pull, uniaxial
from tests.reference.tear import Tear, directions

MEAN_OF_MAGNITUDE = {1: 1.0, 2: 2 / math.pi, 3: 0.5}
MEAN_OF_FOURTH_POWER = {1: 1.0, 2: 3 / 8, 3: 1 / 5}


def bulk_bonds(case, horizon_ratio=None):
    """Directions, lengths and weights over the volume of the bonds of a point deep inside the lattice:
    the centre of a patch that is built like every other body."""
    from tests.reference.body import Body
    from tests.reference.case import Case

    dimension, spacings = case.dimension, case.spacings
    reach = case.horizon(horizon_ratio) + case.spacing(None) / 2
    if case["quadrature"]["surface_correction"] != "none":
        reach *= 2  # the neighbours have to be deep inside, too
    counts = [math.ceil(reach / edge) + 1 for edge in spacings]
    grid = numpy.array(list(itertools.product(*(range(-n, n + 1) for n in counts))), float)
    middle = len(grid) // 2
    places = grid * spacings
    if dimension > 1:
        angle = math.radians(case["lattice"].get("angle", 0.0))
        turned = numpy.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
        places[:, :2] = places[:, :2] @ turned.T
    tables = {name: case[name] for name in ("dimension", "lattice", "quadrature")}
    if horizon_ratio:
        tables["lattice"] = tables["lattice"] | {"horizon_ratio": horizon_ratio}
    tables["material"] = {key: case["material"][key] for key in ("plane", "influence")} | {"youngs_modulus": 1.0}
    volume = numpy.prod(spacings) * case.cross_section
    patch = Body(Case(tables), places, numpy.full(len(places), volume))
    own = (patch.bonds == middle).any(axis=1)
    arm = numpy.diff(places[patch.bonds[own]], axis=1)[:, 0]
    length = numpy.sqrt((arm**2).sum(axis=1))
    return arm / length[:, None], length, patch.weight[1][own] / volume


def cloud_moment(case, k, size):
    """Mean over the points of a cloud of sum nu omega r^k V, corrected, in horizons and sections; size in horizons."""
    d, quadrature = case.dimension, case["quadrature"]
    sphere = {1: 2, 2: 2 * math.pi, 3: 4 * math.pi}[d]
    omega = lambda r: influence(case["material"]["influence"], r)
    ball = lambda power: sphere * relative_moment(case["material"]["influence"], power + d - 1) / (power + d)
    if quadrature["volume_correction"] == "none":
        return ball(k)

    def shares(power):
        """By Gauss quadrature between the kinks of the share that counts of a volume."""
        x, weights = numpy.polynomial.legendre.leggauss(60)
        total = 0.0
        for low, high in itertools.pairwise((0.0, 1 - size / 2, 1.0, 1 + size / 2)):
            r = low + (high - low) * (x + 1) / 2
            share = numpy.clip((1 + size / 2 - r) / size, 0, 1)
            total += (high - low) / 2 * (weights * share * omega(r) * r ** (power + d - 1)).sum()
        return sphere * total

    correction = quadrature["surface_correction"]
    assert correction != "volume", "the reference does not know the sums of a lattice here"
    return shares(k) * (ball(1) / shares(1) if correction == "energy" else 1.0)


class Bulk:
    """c / E and G / (c W), where W is the work of a bond of modulus 1."""

    def __init__(self, case, horizon_ratio=None, spacing=None):
        from tests.reference.body import confined_modulus_factor, micromodulus_factor

        d, horizon, section = case.dimension, case.horizon(horizon_ratio), case.cross_section
        self.of_modulus = micromodulus_factor(d, case["material"], horizon, section)
        if case.has_rows:
            self.direction, self.length, self.weight = bulk_bonds(case, horizon_ratio)
            second = (self.weight * self.length**2).sum()
            stiffness = 2 * confined_modulus_factor(d, case["material"]["plane"])
            self.lattice_of_modulus = stiffness / MEAN_OF_FOURTH_POWER[d] / (self.weight * self.length).sum()
        else:
            size = horizon / case.ratio_to_sizes if case.ratio_to_sizes else spacing
            second = section * horizon ** (d + 2) * cloud_moment(case, 2, size / horizon)
        self.crossing = MEAN_OF_MAGNITUDE[d] * second / 2

    def strength(self, damage):
        """Largest stress over c under uniaxial tension, averaged over directions of a square or cubic lattice."""
        pull, law = Pull.of_bulk(self), Law.of_table(damage)
        return sum(weight * pull.peak(law, uniaxial(normal)) for normal, weight in zip(*sector(len(self.direction[0])), strict=True))

    def crossing_of(self, normal):
        """The same for a plane with a given normal instead of the mean."""
        cosine = self.direction @ (numpy.asarray(normal) / numpy.linalg.norm(normal))
        return (self.weight * self.length**2 * abs(cosine)).sum() / 2


def sector(dimension):
    return directions(dimension) if dimension > 1 else (numpy.ones((1, 1)), numpy.ones(1))


def root(rising, low, high):
    """Bisection to adjacent floating-point numbers."""
    while low < (middle := (low + high) / 2) < high:
        low, high = (middle, high) if rising(middle) < 0 else (low, middle)
    return middle


# Least critical stretch over onset of the laws whose force follows from an opening.
STEEPEST = {"bilinear": 3.0, "cornelissen": 6.93 + 28 * math.exp(-6.93)}


def total_work(damage):
    return float(Law.of_table(damage).moment(numpy.array([float(damage["critical"])]))[0])


def peak_force(damage):
    law = Law.of_table(damage)
    if damage["law"] == "critical_stretch":
        return law.critical
    low, high = law.onset, law.critical
    for _ in range(12):  # successively finer grids around the maximum
        at = numpy.linspace(low, high, 2001)
        force = at * law.integrity(at)
        k = int(force.argmax())
        low, high = at[max(k - 1, 0)], at[min(k + 1, 2000)]
    return float(force.max())


def with_critical(damage, work):
    """The critical stretch at which the law dissipates a given work."""
    start = damage.get("peak", damage["onset"]) * STEEPEST.get(damage["law"], 1.0)
    missing = lambda critical: total_work(damage | {"critical": critical}) - work
    return damage | {"critical": root(missing, start * (1 + 1e-9), 4 * start + 6 * work / damage["onset"])}


def with_stretches(damage, of_work, pull=None):
    """The table with stretches in place of fracture energy and strength.

    of_work: G / W [J/m2]; pull: of the body, for a strength [Pa]."""
    damage = dict(damage)
    strength = damage.pop("strength", 0.0)
    work = damage.pop("fracture_energy", 0.0) / of_work
    if not strength:
        return of_bonds(damage, work, 0.0)
    # Bond force that gives the body its strength, by secant iteration.
    peaks = [strength / pull({"law": "critical_stretch", "critical": 1.0})]
    excess = []
    while True:
        found = of_bonds(damage, work, peaks[-1])
        excess.append(math.log(pull(found) / strength))
        if abs(excess[-1]) < 1e-8:
            return found
        slope = 1.0 if len(peaks) == 1 else (excess[-1] - excess[-2]) / math.log(peaks[-1] / peaks[-2])
        peaks.append(peaks[-1] * math.exp(-excess[-1] / slope))


def of_bonds(damage, work, peak):
    """work: of a bond of modulus 1, peak: its largest force; 0: not required."""
    damage = dict(damage)
    if not work and not peak:
        return damage
    if damage["law"] == "critical_stretch":
        return damage | {"critical": math.sqrt(2 * work) if work else peak}
    if damage["law"] == "blended":
        hardening = damage.setdefault("hardening", 0.5)
        peak = peak or (0.0 if "peak" in damage else math.sqrt(2 * work) / 2)
        damage.setdefault("onset", peak / 2)
        if peak:
            damage["peak"] = damage["onset"] + (peak - damage["onset"]) / hardening
    elif peak and damage["law"] in ("linear", "exponential", "bilinear", "cornelissen"):
        damage["onset"] = peak
    elif peak:
        complete = lambda onset: with_critical(damage | {"onset": onset}, work) if work else damage | {"onset": onset}
        damage = complete(root(lambda onset: peak_force(complete(onset)) - peak, peak * 1e-3, peak))
    else:
        damage.setdefault("onset", math.sqrt(2 * work) / 2)
    return with_critical(damage, work) if work else damage


def resolve_cpd(case, tables, spacing):
    """Stretches of bonds that take G/W each, and the G/W of the resulting law. By release bonds take all of G."""
    for table in tables:
        if "fracture_energy" not in table.get("damage", {}):
            continue
        assert "strength" not in table["damage"], "the reference does not calibrate"
        constants = {n: float(table.get(f"c{n}", 0.0)) for n in range(1, case.dimension + 1)}
        tear = Tear(case.dimension, case.horizon() / spacing, spacing, case.cross_section, constants, case["material"]["influence"])
        wanted = table["damage"]["fracture_energy"]
        brittle = {"law": "critical_stretch", "critical": 1e-6}
        bonds = Tear(case.dimension, case.horizon() / spacing, spacing, case.cross_section, {1: constants[1]}, case["material"]["influence"])
        least = math.log(bonds.mean(brittle) / total_work(brittle))
        law = lambda ratio: with_stretches(table["damage"], math.exp(ratio))
        if table["damage"].get("drive", "release") == "release":
            table["damage"] = law(least)
            continue
        excess = lambda ratio: math.log(tear.mean(law(ratio)) / wanted)
        before, ratio = least, least + excess(least)
        of_before = ratio - least
        while abs(ratio - before) > 1e-13 * abs(ratio):
            of_ratio = excess(ratio)
            slope = (of_ratio - of_before) / (ratio - before)
            before, of_before = ratio, of_ratio
            if abs(of_ratio) < 1e-11:
                break
            ratio -= of_ratio / slope
        table["damage"] = law(ratio)


def resolve(case, spacing=None, horizon_ratio=None):
    """Writes bond parameters into the tables of the materials, in place of data-sheet values.

    horizon_ratio: of an elastic substitute, whose constants belong to its own horizon; stretches stay those of the
    body."""
    tables = [case["material"]] + [t["material"] for t in case.get("region")]
    tables += [t["material"] for t in case.get("interface") if "material" in t]
    asks = lambda t: "calibration" in t or {"fracture_energy", "strength"} & set(t.get("damage", {}))
    tables = [table for table in tables if asks(table)]
    if case["material"].get("model", "bond") == "cpd":
        return resolve_cpd(case, tables, spacing or case.spacing(None))
    bulk = Bulk(case, spacing=spacing) if tables else None
    elastic = Bulk(case, horizon_ratio, spacing) if tables and horizon_ratio else bulk
    for table in tables:
        on_lattice = table.pop("calibration", "continuum") == "lattice"
        c = table.get("micromodulus")
        modulus = table["youngs_modulus"] if c is None else c / bulk.of_modulus
        if c is None:
            c = modulus * (bulk.lattice_of_modulus if on_lattice else bulk.of_modulus)
        if "damage" in table:
            table["damage"] = with_stretches(table["damage"], c * bulk.crossing, lambda of: c * bulk.strength(of))
        if on_lattice:
            table["micromodulus"] = table.pop("youngs_modulus") * elastic.lattice_of_modulus
