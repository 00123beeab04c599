"""Rigid obstacles (docs/contact.md): energies of points by their depth, forces as complex steps of these."""

import numpy

from tests.reference.case import evaluate

STEP = 1e-30  # of the complex steps, relative to half a spacing


def law(x, bend):
    """b(x), of which b' is s / (1 - s): s = x^2 / 2 x0 up to x0, x - x0 / 2 beyond. By antiderivatives: with q = sqrt(2 x0),
    b = q artanh(x / q) - x in the onset."""
    q = numpy.sqrt(2 * bend)

    def onset(x):
        t = x / q
        series = q * (t**3 / 3 + t**5 / 5 + t**7 / 7 + t**9 / 9)
        small = abs(t) < 0.05
        return numpy.where(small, series, q * numpy.arctanh(numpy.where(small | (abs(t) >= 1), 0.01, t)) - x)

    def line(s):
        series = s**2 / 2 + s**3 / 3 + s**4 / 4 + s**5 / 5 + s**6 / 6 + s**7 / 7
        small = abs(s) < 0.005
        return numpy.where(small, series, -s - numpy.log(1 - numpy.where(small, 0.01, s)))

    beyond = onset(bend + 0 * x) + line(x - bend / 2) - line(bend / 2 + 0 * x)
    return numpy.where(x.real <= 0, 0, numpy.where(x.real <= bend, onset(numpy.where(x.real <= bend, x, 0)), beyond))


class Obstacles:
    def __init__(self, case, conditions):
        self.case, self.conditions, self.tables = case, conditions, case.get("obstacle")
        self.places = {}  # of obstacles that a force drives, which are costly to find
        if not self.tables:
            return
        dimension = conditions.reference.shape[1]
        if case.is_lattice and not case.is_refined:
            size = numpy.full(len(conditions.volume), conditions.spacing)
        else:
            size = (conditions.volume / case.cross_section) ** (1 / dimension)
        self.distance = size / 2
        modulus = numpy.full(len(size), float(case["material"].get("youngs_modulus", 0)))
        for region in case.get("region"):
            modulus[conditions.sets[region["set"]]] = region["material"]["youngs_modulus"]
        self.stiffness = modulus * case.cross_section * size ** (dimension - 1) / self.distance

    def value(self, text, load):
        if load is None:  # before the loads at load 0 are applied
            return 0.0
        place = numpy.zeros((1, self.conditions.reference.shape[1]))
        return float(numpy.ravel(evaluate(text, place, load, self.conditions.spacing))[0])

    def given(self, table, load):
        components = table.get("displacement", [0] * self.conditions.reference.shape[1])
        return numpy.array([0.0 if c == "free" else self.value(c, load) for c in components])

    def moved(self, table, load, displacement):
        """Displacement of the obstacle, which depends on that of the points where a force drives it."""
        given = self.given(table, load)
        if "force" not in table:
            return given
        key = table["name"], displacement.real.tobytes(), self.value(table["force"], load), given.tobytes()
        if key not in self.places:
            self.places = dict(list(self.places.items())[-50:]) | {key: self.driven(table, displacement.real, load, given)[0]}
        return self.places[key]

    def driven(self, table, displacement, load, given):
        """Place at which the points bear the force, and where it touches them under a force of this sign. By steps of an
        eighth of the distance of contact from the start on, then by bisection."""
        axis = numpy.eye(len(given))[table["displacement"].index("free")]
        force = self.value(table["force"], load)
        members = self.conditions.sets[table["set"]] if "set" in table else slice(None)
        depth = lambda o: self.depth_at(table, displacement, given + o * axis)[members].max()  # noqa: E731
        step = self.distance.min() / 8

        def borne(o):
            energy = self.energies_at(table, displacement, given + (o + 1j * STEP * step) * axis).sum()
            return energy.imag / (STEP * step)

        def end_of(is_beyond, sign):
            inside = 0.0
            while is_beyond(inside):
                inside -= sign * step
            outside = inside + sign * step
            while not is_beyond(outside):
                inside, outside = outside, outside + sign * step
            for _ in range(100):
                middle = (inside + outside) / 2
                inside, outside = (inside, middle) if is_beyond(middle) else (middle, outside)
            return inside

        def touch(sign):
            return end_of(lambda o: depth(o) > 0, sign)

        if force == 0:
            if depth(0.0) <= 0:
                return given, touch
            return given + touch(1.0 if depth(step) > depth(-step) else -1.0) * axis, touch
        sign = numpy.sign(force)
        return given + end_of(lambda o: depth(o) >= 1 or sign * borne(o) > sign * force, sign) * axis, touch

    def gap(self, table, displacement, load):
        """Signed distance of the points."""
        return self.gap_at(table, displacement, self.moved(table, load, displacement))

    def gap_at(self, table, displacement, moved):
        arm = self.conditions.reference + displacement - numpy.array(table["point"], float) - moved
        if table["shape"] == "plane":
            return arm @ (numpy.array(table["normal"], float) / numpy.linalg.norm(table["normal"]))
        if table["shape"] == "cylinder" and arm.shape[1] == 3:
            axis = numpy.array(table["axis"], float) / numpy.linalg.norm(table["axis"])
            arm = arm - numpy.outer(arm @ axis, axis)
        rho = numpy.sqrt((arm**2).sum(axis=1))
        return table["radius"] - rho if table.get("inside") else rho - table["radius"]

    def energies(self, table, displacement, load):
        """Energy of each point [J]."""
        return self.energies_at(table, displacement, self.moved(table, load, displacement))

    def energies_at(self, table, displacement, moved):
        depth, softness, alpha = table.get("depth", 0.25), table.get("softness", 1e-4), table.get("stiffness", 1.0)
        scale = depth * self.distance
        x = (self.distance - self.gap_at(table, displacement, moved)) / scale
        members = self.conditions.sets[table["set"]] if "set" in table else numpy.ones(len(x), bool)
        return numpy.where(members, alpha * self.stiffness * scale**2 * law(x, softness / depth), 0)

    def energy(self, displacement, load):
        return sum((self.energies(table, displacement, load) for table in self.tables), numpy.zeros(len(displacement)))

    def forces(self, displacement, load):
        """Force on each point, by name [N]: no difference, but a complex step of its energy."""
        forces = {}
        for table in self.tables:
            force = numpy.zeros(displacement.shape)
            for c in range(displacement.shape[1]):
                shifted = displacement.astype(complex)
                shifted[:, c] += 1j * STEP * self.distance
                force[:, c] = -self.energies(table, shifted, load).imag / (STEP * self.distance)
            forces[table["name"]] = force
        return forces

    def force(self, displacement, load):
        return sum(self.forces(displacement, load).values(), numpy.zeros(displacement.shape))

    def moment(self, table, force, displacement, load):
        """About the point of the obstacle, which has moved with it; of all axes [N m]."""
        arm = self.conditions.reference + displacement - numpy.array(table["point"], float) - self.moved(table, load, displacement)
        pad = [(0, 0), (0, 3 - arm.shape[1])]
        return numpy.cross(numpy.pad(arm, pad), numpy.pad(force, pad)).sum(axis=0)

    def depth(self, table, displacement, load):
        return (self.distance - self.gap(table, displacement, load)) / (table.get("depth", 0.25) * self.distance)

    def depth_at(self, table, displacement, moved):
        return (self.distance - self.gap_at(table, displacement, moved)) / (table.get("depth", 0.25) * self.distance)

    def work_of_force(self, table, old, new):
        """Mean of the force times the way; from rest, from where contact sets in, and to rest, to where it ends."""
        axis = table["displacement"].index("free")
        given = [self.given(table, step.loads) for step in (old, new)]
        (start, touch_old), (end, touch_new) = (self.driven(table, step.displacement, step.loads, at)
                                                for step, at in zip((old, new), given))  # fmt: skip
        before, after = self.value(table["force"], old.loads), self.value(table["force"], new.loads)
        forces = [self.forces(step.displacement, step.loads)[table["name"]].sum(axis=0) for step in (old, new)]
        work = (forces[0] + forces[1]) @ (given[1] - given[0]) / 2
        if before * after > 0:
            return work + (before + after) / 2 * (end - start)[axis]
        if before != 0:
            work += before / 2 * (touch_new(numpy.sign(before)) - start[axis])
        if after != 0:
            work += after / 2 * (end[axis] - touch_old(numpy.sign(after)))
        return work

    def work(self, old, new):
        """Mean of the forces in both states times the motion, for contacts that begin or end times the share of the motion
        in which they touch if the point is where it was before, or is in the end [J]."""
        work = 0.0
        for table in self.tables:
            if "force" in table:
                work += self.work_of_force(table, old, new)
                continue
            before, after = (self.forces(step.displacement, step.loads)[table["name"]] for step in (old, new))
            depths = [[self.depth(table, step.displacement, at.loads) for at in (old, new)] for step in (old, new)]
            (x00, x01), (x10, x11) = depths
            with numpy.errstate(divide="ignore", invalid="ignore"):
                begins, ends = x01 / (x01 - x00), x10 / (x10 - x11)
            share = numpy.where((x00 <= 0) & (x11 > 0) & (x01 > 0), begins, 1.0)
            share = numpy.where((x00 > 0) & (x11 <= 0) & (x10 > 0), ends, share)
            work += ((before + after) / 2 * share[:, None]).sum(axis=0) @ (self.moved(table, new.loads, new.displacement) - self.moved(table, old.loads, old.displacement))
        return work
