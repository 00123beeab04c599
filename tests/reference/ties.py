"""Rigid sets, rollers and linear constraints (docs/theory.md), checked without generalised degrees of freedom: whether
the displacements satisfy them, and whether the constraint forces are of the allowed kind."""

import numpy

from tests.reference.case import evaluate

WITHOUT_PLACE = numpy.zeros((1, 3))


class RigidMotion:
    """The rigid motion closest to the displacements of some points, about a centre (Kabsch)."""

    def __init__(self, arms, displacement):
        moved = arms + displacement
        middle, moved_middle = arms.mean(axis=0), moved.mean(axis=0)
        left, _, right = numpy.linalg.svd((arms - middle).T @ (moved - moved_middle))
        mirror = numpy.diag([1.0] * (arms.shape[1] - 1) + [numpy.sign(numpy.linalg.det(left @ right))])
        self.turn = (left @ mirror @ right).T
        self.centre = moved_middle - self.turn @ middle  # displacement of the centre
        self.error = numpy.abs(self.centre + arms @ self.turn.T - moved).max()

    def rotation(self):
        """Rotation vector of less than half a turn; in a plane its one component."""
        if len(self.turn) == 2:
            return numpy.array([numpy.arctan2(self.turn[1, 0], self.turn[0, 0])])
        axis = numpy.array([self.turn[2, 1] - self.turn[1, 2], self.turn[0, 2] - self.turn[2, 0], self.turn[1, 0] - self.turn[0, 1]])
        sine, cosine = numpy.linalg.norm(axis) / 2, (numpy.trace(self.turn) - 1) / 2
        return axis / 2 if sine == 0 else axis / (2 * sine) * numpy.arctan2(sine, cosine)


def spin_rates(rotation):
    """Columns: the spin for the rate of each component of a rotation vector."""
    if len(rotation) == 1:
        return numpy.eye(1)
    angle = numpy.linalg.norm(rotation)
    if angle == 0:
        return numpy.eye(3)
    x, y, z = rotation
    skew = numpy.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return (numpy.eye(3) + (1 - numpy.cos(angle)) / angle**2 * skew + (angle - numpy.sin(angle)) / angle**3 * skew @ skew)


def moment(arms, forces):
    turned = numpy.cross(arms, forces)
    return numpy.atleast_1d(turned.sum(axis=0))


class Ties:
    """The constraints of a case. Computes work for dead loads and for any state; `follows` marks degrees of freedom
    without an equation."""

    def __init__(self, case, reference, volume, sets, prescribed):
        self.case, self.reference, self.sets, self.prescribed = case, reference, sets, prescribed
        self.spacing = case.spacing(volume)
        self.spacings = case.spacing_in_expressions if case.has_one_spacing else self.spacing
        self.volume = volume
        self.follows, self.held = numpy.zeros(reference.shape, bool), numpy.zeros(reference.shape, bool)
        self.rigid, self.slopes, self.rows = [], [], []
        for table in case.get("rigid"):
            members = numpy.flatnonzero(sets[table["set"]])
            centre = table.get("centre", numpy.average(reference[members], axis=0, weights=volume[members]))
            self.rigid.append((table, members, reference[members] - numpy.asarray(centre)))
            self.follows[members] = True
        for table in case.get("roller"):
            normal = numpy.asarray(table["normal"], float) / numpy.linalg.norm(table["normal"])
            if "set" in table:
                members = numpy.flatnonzero(sets[table["set"]])
                self.slopes.append((table, members, normal))
                self.follows[members] = True
            else:
                self.add_touching(table, normal)
        for table in case.get("constraint"):
            row = numpy.zeros(reference.shape)
            for term in table["term"]:
                inside = sets[term["set"]]
                row[inside] += numpy.asarray(term["weights"], float) / inside.sum()
            self.rows.append((table["name"], row, table.get("displacement", 0), None, None))
        self.held |= self.follows  # independent of the state of a piece; sums only contain displacements
        self.in_rows = numpy.zeros(reference.shape, bool)
        if self.rows:
            self.eliminate()
            self.follows |= self.in_rows

    @property
    def size(self):
        """Round-off of rigid sets [m], from the rounding of their positions."""
        return max((numpy.abs(arms).max() for _, _, arms in self.rigid), default=0.0)

    def add_touching(self, table, normal):
        start = numpy.asarray(table["at"], float)
        along = numpy.asarray(table.get("to", start), float) - start
        stations = max(1, round(numpy.linalg.norm(along) / self.spacing))
        for station in range(stations):
            place = start + (station + 0.5) / stations * along
            arm = self.reference - place
            across = numpy.abs(arm @ normal)
            weight = numpy.ones(len(arm))
            for tangent in self.tangents(normal):
                weight *= numpy.clip(1 - numpy.abs(arm @ tangent) / self.spacing, 0, None)
            near = (weight > 1e-9) & (across <= 2 * self.spacing)
            weight[~near | (across > across[near].min() + self.spacing / 2)] = 0
            row = numpy.outer(weight / weight.sum(), normal)
            self.rows.append((table["name"], row, table.get("displacement", 0), place, normal))

    def tangents(self, normal):
        if len(normal) == 2:
            return [numpy.array([-normal[1], normal[0]])]
        axis = numpy.eye(3)[numpy.abs(normal).argmin()]
        first = numpy.cross(normal, axis) / numpy.linalg.norm(numpy.cross(normal, axis))
        return [first, numpy.cross(normal, first)]

    def value(self, expression, load, place=None):
        return float(evaluate(expression, WITHOUT_PLACE if place is None else place[None], load, self.spacings)[0])

    def errors(self, displacement, load):
        """Errors of the displacements with respect to the constraints [m]."""
        found = [0.0]
        for table, members, arms in self.rigid:
            motion = RigidMotion(arms, displacement[members])
            found.append(motion.error)
            for given, is_now in ((table.get("displacement", ()), motion.centre),):
                found += [abs(is_now[c] - self.value(e, load)) for c, e in enumerate(given) if e != "free"]
            turns = table.get("rotation", ())
            if turns and all(e != "free" for e in turns):
                wanted = [self.value(e, load) for e in turns]
                found.append(numpy.abs(rotated(arms, wanted) - arms @ motion.turn.T).max())
        for table, members, normal in self.slopes:
            along = displacement[members] @ normal
            wanted = table.get("displacement", 0)
            target = along.mean() if wanted == "free" else evaluate(wanted, self.reference[members], load, self.spacings)
            found.append(numpy.abs(along - target).max())
        for _, row, wanted, place, _ in self.rows:
            found.append(abs((row * displacement).sum() - self.value(wanted, load, place)))
        return max(found)

    def after_jump(self, displacement, loads):
        """The displacement with all prescribed values moved to their new values and everything else kept; prescribed
        sums by the least change of their displacements."""
        moved = displacement.copy()
        for table, members, arms in self.rigid:
            motion = RigidMotion(arms, displacement[members])
            centre = self.given(table.get("displacement", ()), loads, motion.centre)
            turn = self.given(table.get("rotation", ()), loads, motion.rotation())
            moved[members] = centre + rotated(arms, turn) - arms
        for table, members, normal in self.slopes:
            wanted = table.get("displacement", 0)
            if wanted != "free":
                target = evaluate(wanted, self.reference[members], loads, self.spacings)
                moved[members] += numpy.outer(target - moved[members] @ normal, normal)
        if self.rows:
            free = self.in_rows
            wanted = numpy.array([self.value(value, loads, place) for _, _, value, place, _ in self.rows])
            lacking = wanted - numpy.array([(row * moved).sum() for _, row, *_ in self.rows])
            moved[free] += numpy.linalg.lstsq(self.coefficients, lacking, rcond=None)[0]
        return moved

    def given(self, expressions, loads, now):
        """Prescribed components, and the current values of the others."""
        expressions = expressions or ["free"] * len(now)
        return numpy.array([is_now if e == "free" else self.value(e, loads) for e, is_now in zip(expressions, now)])

    def out_of_balance(self, displacement, forces, unheld=None):
        """Unbalanced forces [N]: the forces along directions that the constraints leave free. Pins may carry forces on
        floating points."""
        left = []
        for table, members, arms in self.rigid:
            motion = RigidMotion(arms, displacement[members])
            given, turns = table.get("displacement", ()), table.get("rotation", ())
            size = numpy.sqrt((arms**2).sum(axis=1)).max()
            left += [r for c, r in enumerate(forces[members].sum(axis=0)) if not given or given[c] == "free"]
            rates = spin_rates(motion.rotation()).T @ moment(arms @ motion.turn.T, forces[members])
            left += [m / size for c, m in enumerate(rates) if not turns or turns[c] == "free"]
        for table, members, normal in self.slopes:
            along = forces[members] @ normal
            left += list((forces[members] - numpy.outer(along, normal)).ravel())
            if table.get("displacement", 0) == "free":
                left.append(along.sum())
        if self.rows:
            left += list((self.slides.T @ forces[self.in_rows])[~self.are_of(unheld)])
        return numpy.array(left)

    def are_of(self, unheld):
        """Whether slides are those of displacements of floating points."""
        unheld = numpy.zeros(len(self.reference), bool) if unheld is None else unheld
        return numpy.broadcast_to(unheld[:, None], self.reference.shape)[self.in_rows][self.others]

    def on_unheld(self, forces, unheld):
        """Norm of the forces that only pins can carry [N]."""
        loose = numpy.broadcast_to(unheld[:, None], forces.shape) & ~self.prescribed & ~self.in_rows
        along = (self.slides.T @ forces[self.in_rows])[self.are_of(unheld)] if self.rows else []
        return numpy.hypot(numpy.linalg.norm(forces[loose]), numpy.linalg.norm(along))

    def eliminate(self):
        """Each row has a pivot, the displacement with its largest coefficient, which depends on the others. `slides`
        are motions of one of the others and of the pivots that keep all rows satisfied; `leans` are motions of
        pivots that change one row alone."""
        self.in_rows = numpy.any([row != 0 for _, row, *_ in self.rows], axis=0) & ~self.prescribed
        self.coefficients = numpy.array([row[self.in_rows] for _, row, *_ in self.rows])
        solved, pivots = self.coefficients.copy(), []
        for k in range(len(solved)):
            pivots.append(int(numpy.abs(solved[k] * (1 - 1e-9 * numpy.arange(solved.shape[1]) / solved.shape[1])).argmax()))
            solved[k] /= solved[k, pivots[k]]
            for other in range(len(solved)):
                if other != k:
                    solved[other] -= solved[other, pivots[k]] * solved[k]
        self.others = others = numpy.setdiff1d(numpy.arange(solved.shape[1]), pivots)
        self.slides = numpy.zeros((solved.shape[1], len(others)))
        self.slides[others, numpy.arange(len(others))] = 1
        self.slides[pivots] = -solved[:, others]
        self.leans = numpy.linalg.inv(self.coefficients[:, pivots])
        self.pivots = pivots

    def multipliers(self, forces):
        """Force of each row [N]: the work per change of its value while the pivots follow."""
        return self.leans.T @ forces[self.in_rows][self.pivots]

    def work(self, old, new, before, after):
        """Work of the motion of the constraints, by the trapezoidal rule in their own coordinates [J]: centres and
        rotation vectors of rigid sets, displacements along normals, values of linear constraints."""
        work = 0.0
        for table, members, arms in self.rigid:
            one, other = (RigidMotion(arms, state.displacement[members]) for state in (old, new))
            sums = before[members].sum(axis=0) + after[members].sum(axis=0)
            pulls = [spin_rates(motion.rotation()).T @ moment(arms @ motion.turn.T, forces[members])
                     for motion, forces in ((one, before), (other, after))]  # fmt: skip
            for given, pull, moved in ((table.get("displacement", ()), sums, other.centre - one.centre),
                                       (table.get("rotation", ()), sum(pulls), other.rotation() - one.rotation())):  # fmt: skip
                work += sum(pull[c] * moved[c] / 2 for c, e in enumerate(given) if e != "free")
        for table, members, normal in self.slopes:
            if table.get("displacement", 0) == "free":
                continue
            moved = (new.displacement - old.displacement)[members]
            work += ((before + after)[members] @ normal) @ (moved @ normal) / 2
        if self.rows:
            forces = self.multipliers(before) + self.multipliers(after)
            moved = new.displacement - old.displacement
            work += sum(force * (row * moved).sum() for force, (_, row, *_) in zip(forces, self.rows)) / 2
        return work

    def reactions(self, displacement, forces):
        """Reactions by name, and moments of rigid sets about their current centres."""
        reactions, moments = {}, {}
        for table, members, arms in self.rigid:
            motion = RigidMotion(arms, displacement[members])
            reactions[table["set"]] = forces[members].sum(axis=0)
            moments[table["set"]] = moment(arms @ motion.turn.T, forces[members])
        for table, members, normal in self.slopes:
            reactions[table["set"]] = (forces[members] @ normal).sum() * normal
        if self.rows:
            found = self.multipliers(forces)
            for (name, row, _, _, normal), force in zip(self.rows, found):
                direction = numpy.eye(row.shape[1])[0] if normal is None else normal
                reactions[name] = reactions.get(name, 0) + force * direction
        return reactions, moments


def rotated(arms, rotation):
    if len(rotation) == 1:
        sine, cosine = numpy.sin(rotation[0]), numpy.cos(rotation[0])
        return arms @ numpy.array([[cosine, -sine], [sine, cosine]]).T
    angle = numpy.linalg.norm(rotation)
    if angle == 0:
        return arms
    axis = numpy.asarray(rotation) / angle
    return (arms * numpy.cos(angle) + numpy.cross(axis, arms) * numpy.sin(angle)
            + numpy.outer(arms @ axis, axis) * (1 - numpy.cos(angle)))  # fmt: skip
