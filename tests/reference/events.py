"""Checks that a run of mode `path` goes from event to event as docs/theory.md defines it.

The last state and the history of its bonds determine the bonds that drop next. For a plain body
(bonds, supports and dead loads) the state is also solved for here, by a separate Newton's method. This gives the
drained energy, the load at which the next strength is reached, and the bonds that an avalanche breaks."""

import numpy

TIE = 1e-7  # utilisations that differ by less are tied
AT_STRENGTH = 1 - 1e-9  # share of the strength at which a state is accepted
SHARE = 2e-9  # relative difference allowed between both programs, including the saw teeth
# Relative error of energies: residuals are 1e-10 of the loads, and energies err by its square, except for the work
# of supports.
OF_ENERGY = 1e-8
OF_RELEASED = 1e-7
PLAIN_TABLES = {"support", "load", "lattice", "points", "material", "crack", "set", "probe"}
SETTINGS = {"title", "dimension", "quadrature", "loading", "solver", "relaxation", "output", "arc_length"}


class Events:
    """Checks the rows of a run; complaints go to its verification."""

    def __init__(self, verification):
        self.of, self.mechanics, self.case = verification, verification.mechanics, verification.case
        self.broken_at = {}  # load factors of the listed bonds, by the step that they led to
        for row in verification.results.table("broken_bonds"):
            self.broken_at.setdefault(int(row["step"]), []).append(row["load_factor"])
        self.top = self.stage = self.load = 0.0
        self.least_scale = self.released = self.batch_work = 0.0
        self.response = None  # row of the last state on the response, and its energy
        self.drained = 0.0
        self.is_whole = True  # every row since the start is known
        self.settled_here = self.avalanches = self.unknown = 0

    # ---- events from states -----------------------------------------------------------------------

    def utilisation(self, everywhere, history):
        mechanics = self.mechanics
        bears = mechanics.fails & ~mechanics.is_broken(history) & (mechanics.body.weight[1] != 0)
        borne = numpy.where(bears, numpy.maximum(history, mechanics.law.onset), numpy.inf)
        return mechanics.stretch(everywhere) / borne

    def batch(self, utilisation):
        """Bonds that drop together, and by how much the gap to the next one exceeds a tie."""
        tolerance = self.case["loading"].get("event_tolerance", 0.002)
        order = numpy.argsort(-utilisation, kind="stable")
        sorted_down = utilisation[order]
        gaps = sorted_down[:-1] - sorted_down[1:]
        count = int((sorted_down >= (1 - tolerance) * sorted_down[0]).sum())
        while count < len(order) and gaps[count - 1] <= TIE:
            count += 1
        return order[:count]

    def dropped(self, history, bonds):
        after = history.copy()
        law = self.mechanics.law.of(bonds)
        after[bonds] = law.after(numpy.maximum(history[bonds], law.onset))
        return after

    # ---- rows ------------------------------------------------------------------------------------

    def judge(self, step, row, old, history):
        """Checks a row against the previous one."""
        self.judge_strengths(step, row, history)
        follows = old.number + 1 == step.number
        self.is_whole &= follows
        if follows:
            self.judge_drops(step, row, old, history)
        if self.is_whole:
            if self.is_plain:
                self.judge_settling(step, row, old, history)
            self.judge_response(step, row)
        on_response = row["stage"] >= self.top
        if self.is_whole and bool(row["on_response"]) != on_response:
            self.of.complain(step, f"on_response is {row['on_response']:.0f} at {row['stage']}, the highest was {self.top}")
        self.top, self.stage = max(self.top, row["stage"]), row["stage"]
        self.load = row["load_factor"]
        self.released, self.drained = row["released_energy"], row["drained_energy"]

    def judge_strengths(self, step, row, history):
        most = self.utilisation(step.everywhere, history).max()
        self.of.worst["utilisation - 1"] = max(self.of.worst.get("utilisation - 1", -1.0), most - 1)
        if most > AT_STRENGTH + SHARE:
            self.of.complain(step, f"a bond is utilised by {most!r}")
        if row["stability"] not in (1, 0, -1, -2):
            self.of.complain(step, f"stability {row['stability']}")

    def judge_drops(self, step, row, old, history):
        """The bonds dropped since then are those tied with the most utilised bond."""
        utilisation = self.utilisation_of_old(old)
        most = utilisation.max()
        changed = numpy.flatnonzero(history != old.history)
        for load in self.broken_at.get(step.number, ()):
            if abs(load - self.load) > 1e-14:
                self.of.complain(step, f"a bond broke at {load}, the state before was at {self.load}")
        if most < 1 - TIE:
            if len(changed):
                self.of.complain(step, f"{len(changed)} bonds drop, the most utilised one was at {most}")
            return
        self.of.worst["strength"] = max(self.of.worst.get("strength", 0.0), abs(most - AT_STRENGTH))
        if abs(most - AT_STRENGTH) > SHARE:
            self.of.complain(step, f"bonds drop at the share {most!r} of what they bear")
        batch = self.batch(utilisation)
        after = self.dropped(old.history, batch)
        wrong = numpy.flatnonzero((history < after) | ((history != after) & (row["stage"] != self.stage)))
        if len(wrong):
            self.of.complain(step, f"{len(batch)} bonds should drop, {len(changed)} do; {len(wrong)} are another's")

    def utilisation_of_old(self, old):
        kept, self.mechanics.eigenstretch = self.mechanics.eigenstretch, self.of.eigenstretch(old.loads)
        utilisation = self.utilisation(old.everywhere, old.history)
        self.mechanics.eigenstretch = kept
        return utilisation

    # ---- a plain body, solved here ----------------------------------------------------------------

    @property
    def is_plain(self):
        plain = self.case["material"]["model"] == "bond" and not any("pressure" in t for t in self.case.get("load"))
        return plain and set(self.case.tables) <= PLAIN_TABLES | SETTINGS and not self.of.ties.follows.any()

    def energy(self, u, history):
        return self.mechanics.energy(u, history, held=True)

    def tangent(self, u, history):
        """Stiffness of the bonds with the damage held [N/m], a square matrix."""
        body = self.mechanics.body
        arms = self.mechanics.reference_arms[1][0] + u[body.bonds[:, 1]] - u[body.bonds[:, 0]]
        lengths = numpy.sqrt((arms**2).sum(axis=1))
        weight = body.constants[1] * body.weight[1] * self.mechanics.integrity(history)
        across = weight * self.mechanics.stretch(u) / lengths
        normal = arms / lengths[:, None]
        blocks = (weight / body.lengths - across)[:, None, None] * normal[:, :, None] * normal[:, None, :]
        blocks += across[:, None, None] * numpy.eye(u.shape[1])
        size, dimension = u.size, u.shape[1]
        total = numpy.zeros(size * size)
        for a, b, sign in ((0, 0, 1), (1, 1, 1), (0, 1, -1), (1, 0, -1)):
            rows = body.bonds[:, a, None, None] * dimension + numpy.arange(dimension)[:, None]
            columns = body.bonds[:, b, None, None] * dimension + numpy.arange(dimension)[None, :]
            total += numpy.bincount((rows * size + columns).ravel(), (sign * blocks).ravel(), minlength=size * size)
        return total.reshape(size, size)

    def solve(self, matrix, right, free):
        """Keeps floating parts about where they are."""
        part = matrix[numpy.ix_(free, free)]
        return numpy.linalg.solve(part + 1e-11 * numpy.abs(numpy.diag(part)).max() * numpy.eye(len(part)), right)

    def settle(self, u, past, history, loads):
        """The equilibrium under the same loads, or None if Newton's method does not find it.

        A state that was stable before bonds dropped does not end in an unstable one; if Newton's method leads there,
        the energy is followed downhill.
        """
        free = (~self.of.conditions.prescribed).ravel()
        near = self.settle_nearby(u, history, loads)
        if near is not None and self.spectrum(near, history, free)[0][0] < 0 <= self.spectrum(u, past, free)[0][0]:
            return self.settle_downhill(u, history, loads)
        return near

    def spectrum(self, u, history, free):
        """Eigenvalues, with round-off set to zero, and eigenvectors of the tangent."""
        values, vectors = numpy.linalg.eigh(self.tangent(u, history)[numpy.ix_(free, free)])
        return numpy.where(numpy.abs(values) < 1e-9 * values[-1], 0.0, values), vectors

    def settle_downhill(self, u, history, loads):
        """Newton's method with the moduli of the eigenvalues; steps are halved until the energy decreases."""
        free = (~self.of.conditions.prescribed).ravel()
        external = self.of.conditions.force(loads)
        potential = lambda at: self.energy(at, history) - (external * at).sum()
        for _ in range(200):
            gradient = self.mechanics.gradient(u, history, held=True)
            rest = (external - gradient).ravel()[free]
            if numpy.linalg.norm(rest) <= 1e-11 * (numpy.linalg.norm(gradient) + numpy.linalg.norm(external)):
                return u
            values, vectors = self.spectrum(u, history, free)
            values = numpy.maximum(numpy.abs(values), 1e-9 * values[-1])
            step, length = numpy.zeros(u.size), 1.0
            step[free] = vectors @ (vectors.T @ rest / values)
            while potential(u + length * step.reshape(u.shape)) > potential(u) * (1 + 1e-14) and length > 1e-10:
                length /= 2
            u = u + length * step.reshape(u.shape)
        return None

    def settle_nearby(self, u, history, loads):
        free = (~self.of.conditions.prescribed).ravel()
        external = self.of.conditions.force(loads)
        u, scale = u.copy(), None
        for _ in range(30):
            gradient = self.mechanics.gradient(u, history, held=True)
            rest = (external - gradient).ravel()[free]
            scale = scale or numpy.linalg.norm(gradient) + numpy.linalg.norm(external)
            if numpy.linalg.norm(rest) <= 1e-11 * scale:
                return u
            u.ravel()[free] += self.solve(self.tangent(u, history), rest, free)
        return None

    def way(self, u, history, stage):
        """Lowest and highest stage at which all bonds are admissible, by linear extrapolation."""
        conditions, free = self.of.conditions, (~self.of.conditions.prescribed).ravel()
        step = 2.0**-13
        ahead = stage + step if stage + step <= numpy.floor(stage) + 1 else stage - step
        here, there = self.case_loads(stage), self.case_loads(ahead)
        rate = (conditions.displacement(there) - conditions.displacement(here)) / (ahead - stage)
        force = (conditions.force(there) - conditions.force(here)) / (ahead - stage)
        matrix = self.tangent(u, history)
        rate.ravel()[free] = self.solve(matrix, (force.ravel() - matrix @ rate.ravel())[free], free)
        utilisation = self.utilisation(u, history)
        small = 1e-6
        speed = (self.utilisation(u + small * rate, history) - utilisation) / small
        with numpy.errstate(all="ignore"):
            ways = (AT_STRENGTH - utilisation) / speed
        high = ways[speed > 0].min(initial=numpy.inf)
        low = ways[speed < 0].max(initial=-numpy.inf)
        return low, high

    def case_loads(self, stage):
        table = self.case["loading"].get("table", [0, 1])
        return self.case.loads(stage, self.case.at_stage(table, stage))

    def judge_settling(self, step, row, old, history):
        u, past, drained, batch_work, dead_work, events = old.displacement, old.history, 0.0, 0.0, 0.0, 0
        external = self.of.loads(old.loads, old.displacement)
        is_held = row["stage"] == self.stage and old.number > 0
        utilisation = self.utilisation(u, past)
        while utilisation.max() >= 1 - TIE and (events == 0 or utilisation.max() > AT_STRENGTH + 0.25e-9):
            if events and not is_held:
                break
            batch = self.batch(utilisation)
            after = self.dropped(past, batch)
            lost = self.energy(u, past) - self.energy(u, after)
            batch_work += self.mechanics.dissipated(after) - self.mechanics.dissipated(past) - lost
            settled = self.settle(u, past, after, old.loads)
            if settled is None:
                self.unknown += 1
                self.is_whole = False  # the drained energy is unknown from here on
                return
            work = float((external * (settled - u)).sum())
            drained += work + self.energy(u, after) - self.energy(settled, after)
            dead_work += work
            u, past, events = settled, after, events + 1
            utilisation = self.utilisation(u, past)
        self.settled_here += events > 0
        self.batch_work += batch_work
        scale = row["stored_energy"] + abs(row["dissipated_energy"]) + abs(row["external_work"])
        self.of.compare(step, "drained in an event", row["drained_energy"] - self.drained, drained, scale, OF_ENERGY)
        if is_held:
            self.avalanches += 1
            self.judge_avalanche(step, row, old, past, history, batch_work, scale)
            return
        self.judge_ledger(step, row, old, (u, past), external, batch_work + dead_work, dead_work)
        if events:
            self.judge_way(step, row, u, past, utilisation)

    def judge_ledger(self, step, row, old, settled, external, others, dead_work):
        """Work by the trapezoidal rule from the settled state, and its error as numerical work."""
        u, history = settled
        loads = self.of.conditions.force(step.loads)
        forces = [self.mechanics.gradient(v, history, held=True) - f for v, f in ((u, external), (step.displacement, loads))]
        pull = (external + loads) / 2 + numpy.where(self.of.conditions.prescribed, sum(forces) / 2, 0.0)
        work = float((pull * (step.displacement - u)).sum())
        stored = self.energy(step.displacement, history) - self.energy(u, history)
        scale = row["stored_energy"] + abs(row["dissipated_energy"]) + abs(row["external_work"])
        # A strongly curved path is taken in several steps, whose sum has a smaller error.
        written = row["external_work"] - old.external_work - dead_work
        if abs(written - stored) > 1.1 * abs(work - stored) + OF_ENERGY * scale:
            self.of.complain(step, f"work of {written:.8g} J, by the trapezoidal rule {work:.8g}, stored are {stored:.8g}")
        self.of.worst["work"] = max(self.of.worst.get("work", 0.0), abs(written - work) / scale)
        both = row["external_work"] + row["numerical_work"] - old.external_work - old.numerical_work
        self.of.compare(step, "work and numerical work", both, stored + others, scale, OF_ENERGY)

    def judge_avalanche(self, step, row, old, past, history, batch_work, scale):
        if (past != history).any():
            self.of.complain(step, f"an avalanche has other bonds: {(past != history).sum()}")
        self.of.compare(step, "numerical work", row["numerical_work"] - old.numerical_work, batch_work, scale, OF_ENERGY)

    def judge_way(self, step, row, u, past, utilisation):
        """The next strength is reached above, or else at the nearer end of the admissible range."""
        begin = numpy.ceil(self.stage) - 1 if self.stage > 0 else 0.0
        low, high = self.way(u, past, self.stage)
        change = row["stage"] - self.stage
        if abs(utilisation.max() - 1) < 1e-4 or begin > self.stage + low:
            return  # near a turning point, or the start of a segment of the programme
        if low > high:
            self.of.complain(step, "no load is admissible here, but the path goes on")
            return
        expected = high if low <= 0 or high < 0 else low
        bent = 0.1 * abs(expected) + 0.01
        if change > expected + bent or (expected < 0) != (change < 0):
            self.of.complain(step, f"the stage changes by {change:.4g}, strength is met by {expected:.4g} linearly")

    # ---- under the given loads -------------------------------------------------------------------

    def judge_response(self, step, row):
        """Energy released by the response: the decrease of its potential at constant load."""
        if not row["stage"] >= self.top:
            if row["released_energy"] != self.released:
                self.of.complain(step, "energy is released off the response")
            return
        potential = row["stored_energy"] - float((self.of.conditions.force(step.loads) * step.displacement).sum())
        potential += row["dissipated_energy"] - self.batch_work
        if self.response is not None and self.is_plain and self.is_whole:
            before, old_drained = self.response
            held = row["stage"] == self.top
            fallen = before - potential if held else row["drained_energy"] - old_drained
            scale = row["stored_energy"] + abs(row["dissipated_energy"]) + abs(row["external_work"])
            self.of.compare(step, "released energy", row["released_energy"] - self.released, fallen, scale, OF_RELEASED)
        self.response = potential, row["drained_energy"]
