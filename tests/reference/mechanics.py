"""Energy, forces and tangent of a body (docs/theory.md, Measure and potential, Damage)."""

import itertools

import numpy

from tests.reference.body import arms_of, measure
from tests.reference.contact import PairContact
from tests.reference.laws import Law

STEP = 1e-30  # of complex steps: its square vanishes relative to 1, so there is no truncation error


def add_at(total, index, values):
    """total[index] += values, also for repeated indices; many times faster than numpy.add.at."""
    for axis in range(total.shape[1]):
        total[:, axis] += numpy.bincount(index, values[:, axis].real, minlength=len(total))
        if total.dtype == complex:
            total[:, axis] += 1j * numpy.bincount(index, values[:, axis].imag, minlength=len(total))


def dot(a, b):
    return (a * b).sum(axis=-1)


def relative_change(reference, change):
    """m/M - 1 of interactions from reference arms and their changes, without cancellation."""
    current = [r + c for r, c in zip(reference, change)]
    if len(reference) == 1:
        length = measure(reference)
        return dot(change[0], 2 * reference[0] + change[0]) / (length * (length + measure(current)))
    if len(reference) == 2:
        if reference[0].shape[-1] == 2:
            return (measure([change[0], current[1]]) + measure([reference[0], change[1]])) / measure(reference)
        vectors = numpy.cross(change[0], current[1]) + numpy.cross(reference[0], change[1])
        old, new = numpy.cross(*reference), numpy.cross(*current)
        area = dot(old, old)
        return dot(vectors, old + new) / (area * (1 + numpy.sqrt(dot(new, new) / area)))
    difference = (dot(change[0], numpy.cross(current[1], current[2]))
                  + dot(reference[0], numpy.cross(change[1], current[2]))
                  + dot(reference[0], numpy.cross(reference[1], change[2])))  # fmt: skip
    return difference / measure(reference)


def measure_gradients(current):
    """Derivatives of the measure with respect to the arms."""
    if len(current) == 1:
        return [current[0] / measure(current)[:, None]]
    if len(current) == 2:
        b, c = current
        if b.shape[-1] == 2:
            return [numpy.stack([c[:, 1], -c[:, 0]], 1), numpy.stack([-b[:, 1], b[:, 0]], 1)]
        normal = numpy.cross(b, c) / measure(current)[:, None]
        return [numpy.cross(c, normal), numpy.cross(normal, b)]
    b, c, d = current
    return [numpy.cross(c, d), numpy.cross(d, b), numpy.cross(b, c)]


class Mechanics:
    """A body with its law of damage. Displacements u cover all of its points, forces only its own points."""

    def __init__(self, body, elastic=False):
        self.body, self.case = body, body.case
        self.eigenstretch = None  # per point; included in every evaluation
        self.reference_arms = {k: arms_of(t, body.reference) for k, t in body.tuples.items()}
        direction = self.reference_arms[1][0] / body.measure[1][:, None]
        law = Law.elastic() if elastic else body.materials.law(body.bonds, direction)
        self.law = law.spread(len(body.bonds))
        tables = [self.case["material"]] + [region["material"] for region in self.case.get("region")]
        self.closes = any(table.get("damage", {}).get("compression") == "kept" for table in tables)
        # If any bond can fail, bonds without a law get one that never fails.
        self.fails = (self.law.name != "none") | ~numpy.full(len(body.bonds), self.case.has_damage and not elastic)
        self.contact = PairContact(body) if self.case.get("contact") else None
        self.told_history, self.told_work = numpy.zeros((2, len(body.bonds)))  # moments of the law at written histories

    def spare(self, sets):
        """Bonds of points in no-fail sets stay elastic."""
        for name in self.body.materials.no_fail:
            self.fails &= ~sets[name][self.body.source][self.body.bonds].any(axis=1)

    def no_history(self):
        return numpy.zeros(len(self.body.bonds))

    def change(self, order, u):
        """m/M - 1 relative to the stress-free state."""
        change = relative_change(self.reference_arms[order], arms_of(self.body.tuples[order], u))
        if self.eigenstretch is None:
            return change
        mean = self.eigenstretch[self.body.source][self.body.tuples[order]].mean(axis=1)
        return change - {1: mean, 2: mean * (2 + mean), 3: mean * (3 + mean * (3 + mean))}[order]

    # ---- bonds and their histories ---------------------------------------------------------------

    def stretch(self, u):
        return self.change(1, u)

    def grown(self, history, u):
        """The histories after this state is accepted."""
        stretch = self.stretch(u)
        return numpy.where(self.fails & (stretch > self.law.onset), numpy.maximum(history, stretch), history)

    def integrity(self, history):
        """T at the histories; 1 before any damage."""
        value = numpy.ones(len(history))
        worn = history > 0
        value[worn] = self.law.of(worn).integrity(history[worn])
        return value

    def is_broken(self, history):
        return history >= self.law.critical

    def _is_loading(self, stretch, history):
        """Whether the bond can damage further; a broken bond can't."""
        return self.fails & ~self.is_broken(history) & (numpy.real(stretch) > numpy.maximum(history, self.law.onset))

    def _is_closed(self, stretch):
        """Whether a bond bears compression as if it were whole."""
        return (numpy.real(stretch) < 0) & self.closes

    def _bond_potential(self, stretch, history, held=False):
        """phi / C1: energy of the bond."""
        value = numpy.where(self._is_closed(stretch), 1.0, self.integrity(history)) * stretch**2 / 2
        if held:
            return value
        loading = self._is_loading(stretch, history)
        if loading.any():
            past = history[loading]
            law = self.law.of(loading)
            base = self.integrity(history)[loading] * past**2 / 2 - law.moment(past)
            value[loading] = base + law.moment(stretch[loading])
        return value

    def _bond_tension(self, stretch, history, held=False):
        """phi' / C1; with held damage every bond follows its secant."""
        value = numpy.where(self._is_closed(stretch), 1.0, self.integrity(history)) * stretch
        if held:
            return value
        loading = self._is_loading(stretch, history)
        if loading.any():
            value[loading] = self.law.of(loading).integrity(stretch[loading]) * stretch[loading]
        return value

    def _kept(self, order, history):
        """Stiffness share that triangles and tetrahedra keep: the product over their bonds."""
        integrity, number = self.integrity(history), self.body.bond_number
        tuples = self.body.tuples[order]
        kept = numpy.ones(len(tuples))
        if (integrity < 1).any():
            for a, b in itertools.combinations(range(order + 1), 2):
                kept *= [integrity[number[code]] for code in self.body.codes(tuples[:, [a, b]]).tolist()]
        return kept

    def equivalent_stretches(self, u, history):
        """Of stretched bonds, by the energy that a loss of their integrity would set free with all that stands on them:
        sqrt(2 max(Y, 0) / (w L C1)), Y = dE/dT at fixed u."""
        stretch, number = self.stretch(u), self.body.bond_number
        integrity, released = self.integrity(history), numpy.zeros(len(self.body.bonds))
        for order in sorted(set(self.reference_arms) - {1}):
            tuples = self.body.tuples[order]
            energy = self.body.constants[order] * self.body.weight[order] * numpy.abs(self.body.measure[order])
            energy = energy * self.change(order, u) ** 2 / 2
            sides = itertools.combinations(range(order + 1), 2)
            bonds = numpy.array([[number[code] for code in self.body.codes(tuples[:, ends]).tolist()] for ends in map(list, sides)])
            for k, bond in enumerate(bonds):
                numpy.add.at(released, bond, energy * integrity[numpy.delete(bonds, k, axis=0)].prod(axis=0))
        squared = stretch**2 + 2 * released / (self.body.constants[1] * self.body.weight[1] * self.body.lengths)
        return numpy.sqrt(numpy.maximum(numpy.where(stretch > 0, squared, 0), 0))

    # ---- sums over the body ----------------------------------------------------------------------

    def energies(self, u, history, held=False):
        """Full energy of every interaction [J], by order."""
        energy = {}
        for order in self.reference_arms:
            change = self.change(order, u)
            scale = self.body.constants[order] * self.body.weight[order] * numpy.abs(self.body.measure[order])
            if order == 1:
                energy[order] = scale * self._bond_potential(change, history, held)
            else:
                energy[order] = scale * self._kept(order, history) * change**2 / 2
        return energy

    def energy(self, u, history=None, held=False):
        history = self.no_history() if history is None else history
        return self.sum_of(self.energies(u, history, held)) + self.contact_energies(u, history).sum()

    def contact_energies(self, u, history):
        """Energy of contact, an equal share for each of its points [J]."""
        if self.contact is None:
            return numpy.zeros(len(self.body.volume))
        return self.contact.point_energies(u, self.integrity(history))

    def sum_of(self, energies):
        """The part of the energy of interactions that belongs to the body [J], by order."""
        return sum((self.body.share[order] * part).sum() for order, part in energies.items())

    def slope(self, u, history, component, rate, held=False):
        """Derivative of the energy along a motion of all points in one component, by a complex step."""
        if not rate.any():
            return 0.0
        moved = u.astype(complex)
        moved[:, component] += 1j * STEP * rate
        return self.energy(moved, history, held).imag / STEP

    def slopes_by_jumps(self, u, history, held=False):
        """Derivative of the energy with respect to the jumps over the periods [N], axes x components."""
        periods, axes = self.body.beyond.periods, range(self.body.dimension)
        return numpy.array([[self.slope(u, history, c, periods[:, axis], held) for c in axes] for axis in axes])

    def pull_of_periods(self, u, history, held=False):
        """Force over each period [N], axes x components."""
        pull = self.slopes_by_jumps(u, history, held)
        pull[:, self.body.beyond.mirrored_axes()] = 0.0  # forces beyond a plane of symmetry are opposite
        return pull

    def pull_of_planes(self, u, history):
        """Force from beyond each plane of symmetry [N] by name, and the plane's axis: the force needed to move the
        plane with everything that is mirrored in it."""
        return {name: (self.slope(u, history, axis, rate), axis) for name, axis, rate in self.body.beyond.planes()}

    def heating_work(self, old, new, before, after):
        """Half of the energy that a change of the eigenstretch adds, in each of two states (u, history)."""
        work = 0.0
        if before is None and after is None:
            return work
        for u, history in (old, new):
            for self.eigenstretch, sign in ((after, 0.5), (before, -0.5)):
                work += sign * self.energy(u, history, held=True)
        self.eigenstretch = after
        return work

    def gradient(self, u, history=None, absolute=False, held=False):
        """Derivative of the energy [N], own points x dimension; or sums of magnitudes, for round-off."""
        return self._sums(u, history, absolute, held)[: self.body.own]

    def gradient_of_shares(self, u, history=None, held=False):
        """Forces on own points and on those beyond [N], of the parts of interactions that belong to the body."""
        return self._sums(u, history, held=held, shared=True)

    def _sums(self, u, history=None, absolute=False, held=False, shared=False):
        history = self.no_history() if history is None else history
        total = numpy.zeros(self.body.reference.shape, numpy.asarray(u).dtype)
        for order, reference in self.reference_arms.items():
            tuples = self.body.tuples[order]
            change = arms_of(tuples, u)
            relative = self.change(order, u)
            if order == 1:
                slope = self._bond_tension(relative, history, held)
            else:
                slope = self._kept(order, history) * relative
            sign = numpy.sign(self.body.measure[order])
            slope = slope * self.body.constants[order] * self.body.weight[order] * sign
            if shared:
                slope = slope * self.body.share[order]
            pulls = measure_gradients([r + c for r, c in zip(reference, change)])
            for k, pull in enumerate(pulls, start=1):
                force = slope[:, None] * pull
                if absolute:
                    force = -numpy.abs(force)
                add_at(total, tuples[:, k], force)
                add_at(total, tuples[:, 0], -force)
        if self.contact is not None:
            i, j, _, force = self.contact.touching(u, self.integrity(history))
            add_at(total, i, -numpy.abs(force) if absolute else force)
            add_at(total, j, -numpy.abs(force) if absolute else -force)
            for point, part, weights, _, force in self.contact.on_faces(u, self.integrity(history)):
                total[point] += -numpy.abs(force) if absolute else -force
                total[list(part)] += weights[:, None] * (-numpy.abs(force) if absolute else force)
        return numpy.abs(total) if absolute else total

    def tangent(self, u, history=None):
        """Second derivative [N/m], a square matrix, by complex steps of the gradient."""
        size = u.size
        matrix = numpy.empty((size, size))
        for column in range(size):
            moved = u.astype(complex).ravel()
            moved[column] += 1j * STEP
            matrix[:, column] = self.gradient(moved.reshape(u.shape), history).imag.ravel() / STEP
        return matrix

    def bears(self):
        """Largest sum over a point of the magnitudes of its forces if all its interactions were intact and changed by 1
        [N]."""
        total = numpy.zeros(self.body.reference.shape)
        for order, reference in self.reference_arms.items():
            slope = (self.body.constants[order] * self.body.weight[order])[:, None]
            for k, pull in enumerate(measure_gradients(reference), start=1):
                add_at(total, self.body.tuples[order][:, k], slope * numpy.abs(pull))
                add_at(total, self.body.tuples[order][:, 0], slope * numpy.abs(pull))
        return total.max()

    # ---- effects of damage ------------------------------------------------------------------------

    def dissipated(self, history):
        """Energy dissipated by bonds [J]; the loss of triangles and tetrahedra depends on its history."""
        grown = (history > 0) & (history != self.told_history)
        self.told_history[grown], self.told_work[grown] = history[grown], self.law.of(grown).moment(history[grown])
        worn = history > 0
        lost = self.told_work[worn] - self.integrity(history)[worn] * history[worn] ** 2 / 2
        weight = (self.body.share[1] * self.body.weight[1])[worn]
        return float((self.body.constants[1] * weight * self.body.lengths[worn] * lost).sum())

    def damage(self, history):
        """Per point: lost share of the weight of its bonds."""
        weight, kept = self.body.weight[1], self.body.weight[1] * self.integrity(history)
        whole, left = numpy.zeros(len(self.body.volume)), numpy.zeros(len(self.body.volume))
        for end in (0, 1):
            whole += self.body._sum_over(self.body.bonds[:, end], weight)
            left += self.body._sum_over(self.body.bonds[:, end], kept)
        if self.case["output"]["count_cracks"]:
            whole = whole + self.body.cut_weight
        return 1 - numpy.divide(left, whole, out=numpy.ones(len(whole)), where=whole > 0)[: self.body.own]
