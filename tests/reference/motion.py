"""Independent time integration: velocity Verlet and generalised alpha on the reference's own bonds (docs/theory.md,
Motion in time)."""

import numpy

from tests.reference.body import Body
from tests.reference.case import Case, Conditions, evaluate
from tests.reference.mechanics import Mechanics
from tests.reference.results import Results


class Motion:
    """States of a body of one material, without images, at the time steps recorded in a results folder."""

    def __init__(self, folder, case_text):
        self.case, self.results = Case(case_text), Results(folder)
        reference, self.volume, sets = self.results.reference, self.results.volume, self.results.sets
        self.conditions = Conditions(self.case, reference, self.volume, sets)
        self.mechanics = Mechanics(Body(self.case, reference, self.volume, sets=sets))
        self.mechanics.spare(sets)
        self.free = ~self.conditions.prescribed
        self.mass = (self.case["material"]["density"] * self.volume)[:, None] * self.free
        self.time, self.number, self.work = 0.0, 0, 0.0
        self.u, self.v = (self.initial(key, sets) for key in ("displacement", "velocity"))
        self.u = numpy.where(self.free, self.u, self.conditions.displacement({"t": 0.0}))
        self.v = self.v * self.free
        self.history = self.mechanics.grown(self.mechanics.no_history(), self.u)
        self.find_force()

    def initial(self, key, sets):
        value = numpy.zeros(self.results.reference.shape)
        for table in self.case.get("initial"):
            inside = sets[table["set"]] if "set" in table else numpy.ones(len(value), bool)
            for axis, component in enumerate(table.get(key, [0] * value.shape[1])):
                here = evaluate(component, self.results.reference, {}, self.conditions.spacings)
                value[inside, axis] += here[inside]
        return value

    def find_force(self):
        self.load = self.conditions.force({"t": self.time})
        self.gradient = self.mechanics.gradient(self.u, self.history)
        self.force = (self.load - self.gradient) * self.free

    def acceleration(self):
        return numpy.divide(self.force, self.mass, out=numpy.zeros_like(self.force), where=self.free)

    def step(self, dt, time, rate=0.0):
        """
        :param rate: of a drag, per component [1/s]
        """
        before, load, gradient = self.u, self.load, self.gradient
        # Means over the step of e^(-rate s) and of its integral: 1 and 1/2 without drag.
        x = numpy.broadcast_to(numpy.asarray(rate * dt, float), self.u.shape)
        dragged = numpy.where(x > 0, x, 1.0)
        phi1 = numpy.where(x > 0, -numpy.expm1(-dragged) / dragged, 1.0)
        phi2 = numpy.where(x > 0, (1 - phi1) / dragged, 0.5)
        a = self.acceleration()
        half = phi1 * self.v + dt * phi2 * a
        self.time, self.number = time, self.number + 1
        prescribed = self.conditions.displacement({"t": time})
        self.u = numpy.where(self.free, self.u + dt * half, prescribed)
        self.history = self.mechanics.grown(self.history, self.u)
        self.find_force()
        self.v = numpy.exp(-x) * self.v + dt * ((phi1 - phi2) * a + phi2 * self.acceleration())
        pull = numpy.where(self.free, (load + self.load) / 2, (gradient + self.gradient) / 2)
        self.work += (pull * (self.u - before)).sum()

    def follow(self, dt, end):
        """Yields itself at every step of a constant size; the last step may be shorter."""
        yield self
        while self.time < end:
            is_last = end - self.time <= dt * (1 + 1e-9)
            self.step(end - self.time if is_last else dt, end if is_last else self.time + dt)
            yield self

    @property
    def kinetic(self):
        return (self.mass * self.v**2).sum() / 2

    @property
    def stored(self):
        return self.mechanics.energy(self.u, self.history)

    @property
    def modified(self):
        """The energy that the scheme conserves for linear forces, up to its dt^2/8 term."""
        return (self.force * self.acceleration()).sum()


class ImplicitMotion(Motion):
    """Checks the positions found by implicit steps, and continues from them [Chung and Hulbert 1993]."""

    def __init__(self, folder, case_text, spectral_radius):
        super().__init__(folder, case_text)
        self.of_inertia = (2 * spectral_radius - 1) / (spectral_radius + 1)
        self.of_force = spectral_radius / (spectral_radius + 1)
        self.gamma = 0.5 - self.of_inertia + self.of_force
        self.beta = (1 - self.of_inertia + self.of_force) ** 2 / 4
        self.a = self.acceleration()

    def take(self, u, dt):
        """Advances to a position, and returns the largest residual force over the largest force."""
        before, force, load, gradient = self.u, self.force, self.load, self.gradient
        self.time, self.number = self.time + dt, self.number + 1
        self.u, self.history = u, self.mechanics.grown(self.history, u)
        self.find_force()
        a = (u - before - dt * self.v - dt**2 * (0.5 - self.beta) * self.a) / (self.beta * dt**2) * self.free
        inertia = self.mass * ((1 - self.of_inertia) * a + self.of_inertia * self.a)
        mean = (1 - self.of_force) * self.force + self.of_force * force
        lacks = abs(inertia - mean).max() / max(abs(mean).max(), abs(inertia).max())
        self.v, self.a = self.v + dt * ((1 - self.gamma) * self.a + self.gamma * a), a
        pull = numpy.where(self.free, (load + self.load) / 2, (gradient + self.gradient) / 2)
        self.work += (pull * (u - before)).sum()
        return lacks
