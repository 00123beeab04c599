"""Checks the accepted steps of a run against its results folder.

The reference alone judges every step: the displacements and the histories of the bonds determine forces,
energies, reactions and damage, and these must agree with the written ones.
"""

import copy

import numpy

from tests.reference import stress
from tests.reference.body import Body
from tests.reference.case import Case, Conditions, NotUnderstood
from tests.reference.events import Events
from tests.reference.foundations import Foundations
from tests.reference.mechanics import STEP, Mechanics
from tests.reference.obstacles import Obstacles
from tests.reference.pieces import unheld_points
from tests.reference.results import Results
from tests.reference.saw_tooth import SAME_STRENGTH, SawTooth
from tests.reference.ties import Ties

UNIT_ROUND_OFF = 2.0**-53
# Sums of energies and forces over up to 10^6 interactions in another order: errors grow with the
# square root of their number, and stretches near 1e-3 have lost three digits before.
AGREEMENT = 1e-10
SHARE_OF_SCALE = 1e-5  # of the largest forces so far: a body torn apart along a path has no forces
# The ends of saw teeth are searched for: both programs know them, and the integrities there, to about 1e-11.
OF_TEETH, OF_INTEGRITY = 1e-9, 1e-10
NEVER_FAILS = -1  # history of a bond of a no-fail set, as it is written

UNLOADED = None  # loads before those at load 0 are applied


class Verification:
    """Complaints about a run, and the largest numbers seen (`worst`)."""

    def __init__(self, folder, case_text, case_folder="."):
        self.case = case_text if isinstance(case_text, Case) else Case(case_text, case_folder)
        self.results = Results(folder)
        if self.case["material"].get("kinematics") == "linear":
            raise NotUnderstood("linear kinematics: tests/acceptance/linear_kinematics_test.py has a reference of its own")
        self.complaints, self.worst, self.bears = [], {}, {}
        self.broken_across = 0  # bonds to points beyond planes and periods that are broken in the end
        self.broken_when_looked_for, self.last_unheld = 0, None
        self.rows = {int(row["step"]): row for row in self.results.table("history")}
        reference, volume, sets = self.results.reference, self.results.volume, self.results.sets
        more = {"sets": sets, "factors": self.results.factors}
        as_given = copy.deepcopy(self.case)  # a body replaces data-sheet values by constants
        self.mechanics = Mechanics(Body(self.case, reference, volume, **more))
        self.mechanics.spare(sets)
        self.listed_steps, self.listed_codes = self.listed_bonds()
        self.conditions = Conditions(self.case, reference, volume, sets)
        self.foundations = Foundations(self.case, self.conditions)
        self.obstacles = Obstacles(self.case, self.conditions)
        self.ties = Ties(self.case, reference, volume, sets, self.conditions.prescribed)
        self.jump_is_free = self.mechanics.body.beyond.given_jump(0.0)[1]
        self.first_real_step = 0
        self.control_at_load_zero = 0.0
        self.events = None
        if self.case["solver"]["mode"] == "path":
            self.mechanics.law = SawTooth(self.mechanics.law, self.case["loading"].get("teeth", 10))
            self.events = Events(self)
        self.stand_in = None
        if "elastic_horizon_ratio" in self.case["solver"]:
            body = Body(as_given, reference, volume, self.case["solver"]["elastic_horizon_ratio"], **more)
            self.stand_in = Mechanics(body, elastic=True)
            handed = [r["step"] for r in self.results.table("decisions") if r["action"] == "hand over to relaxation"]
            self.first_real_step = int(handed[0]) if handed else 10**9

    def complain(self, step, text):
        self.complaints.append(f"step {step.number} (load factor {step.load:.6g}): {text}")

    def compare(self, step, name, written, computed, scale, tolerance=AGREEMENT):
        error = numpy.abs(numpy.asarray(written) - computed).max() / scale if scale > 0 else 0.0
        self.worst[name] = max(self.worst.get(name, 0.0), float(error))
        if not error <= tolerance:
            self.complain(step, f"{name}: {written if numpy.ndim(written) == 0 else 'a field'} is written, "
                                f"{computed if numpy.ndim(computed) == 0 else 'another'} is right "
                                f"({error:.3g} of {scale:.4g})")  # fmt: skip

    # ---- beyond planes and periods ----------------------------------------------------------------

    def number_of(self, source, kind):
        """Number of the image of a kind >= 1 of a point, or (0) of the point itself; None: no own point sees it."""
        if kind == 0:
            return source
        mirror, shift = (numbers[kind - 1] for numbers in self.results.image_kinds)
        return self.mechanics.body.beyond.number(mirror * self.results.reference[source] + shift)

    def jump(self, row):
        return self.mechanics.body.beyond.told_jump(row)

    def listed_bonds(self):
        """Steps and codes of the written broken bonds, ordered by code; -1 is no bond."""
        rows, body = self.results.table("broken_bonds"), self.mechanics.body
        ends = [self.number_of(int(row["second_point"]), int(row.get("second_image", 0))) for row in rows]
        pairs = numpy.sort([[int(row["first_point"]), -1 if end is None else end] for row, end in zip(rows, ends)], axis=-1)
        codes = body.codes(pairs) if rows else numpy.zeros(0, int)
        order = numpy.argsort(codes, kind="stable")
        return numpy.array([row["step"] for row in rows])[order], numpy.where(codes < 0, -1, codes)[order]

    # ---- histories -------------------------------------------------------------------------------

    @property
    def histories_are_known(self):
        """Histories are read if they were written, else derived from the accepted states."""
        steps = self.results.steps
        if not self.case.has_damage or not steps or any(step.history is not None for step in steps):
            return True
        relaxed = self.case["solver"]["mode"] != "newton"
        path_is_written = self.case["output"]["every"] == 1 and not self.mechanics.body.is_cpd
        return path_is_written and not (relaxed and self.case["relaxation"]["breaking"] == "transient")

    def next_history(self, step, history):
        if not self.case.has_damage or step.number < self.first_real_step:
            return history
        if step.history is None:
            return self.mechanics.grown(history, step.displacement)
        history = history.copy()
        body = self.mechanics.body
        first_points, second_points = (step.history[name].astype(int) for name in ("first_point", "second_point"))
        ends = second_points.copy()
        for k in numpy.flatnonzero(step.history.get("second_image", 0)):
            number = self.number_of(second_points[k], step.history["second_image"][k])
            ends[k] = -1 if number is None else number  # the code of no bond
        codes = body.codes(numpy.sort(numpy.stack([first_points, ends], axis=1), axis=1)).tolist()
        columns = first_points.tolist(), second_points.tolist(), step.history["largest_stretch"].tolist(), codes
        for first, second, stretch, code in zip(*columns):
            bond = body.bond_number.get(code)
            if bond is None:
                self.complain(step, f"there is a history of {first}-{second}, which is no bond")
            elif (stretch == NEVER_FAILS) == self.mechanics.fails[bond]:
                self.complain(step, f"bond {first}-{second} is written to fail or not to, and the other is right")
            elif stretch != NEVER_FAILS:
                if self.events:
                    stretch = self.strength_meant(step, bond, stretch)
                elif stretch <= self.mechanics.law.onset[bond]:
                    self.complain(step, f"history {stretch} of bond {first}-{second} up to the onset")
                if stretch < history[bond]:
                    self.complain(step, f"history {stretch} of bond {first}-{second} after {history[bond]}")
                history[bond] = stretch
        self.judge_twins(step, history)
        return history

    def strength_meant(self, step, bond, written):
        """The strength of the secant of that number."""
        right, off = self.mechanics.law.told(numpy.array([bond]), numpy.array([written]))
        self.compare(step, "strength of a tooth", written, right[0], self.mechanics.law.critical[bond], SAME_STRENGTH)
        return right[0]

    def judge_twins(self, step, history):
        """A bond to a point beyond and the same bond seen from the other point have the same history."""
        body = self.mechanics.body
        for bond in numpy.flatnonzero(body.bonds[:, 1] >= body.own):
            twin = body.twin(*body.bonds[bond])
            self.compare(step, "history of a twin", history[bond], history[twin], self.mechanics.law.onset[bond], 1e-9)

    # ---- steps -----------------------------------------------------------------------------------

    def run(self):
        """Checks every written step; returns the complaints."""
        if not self.histories_are_known:
            raise ValueError("the histories of the bonds are not known")
        old = Old(self.results.reference.shape, self.mechanics, self.results.steps)
        for step in self.results.steps:
            mechanics = self.mechanics if step.number >= self.first_real_step else self.stand_in
            step.loads = self.case.loads(self.rows[step.number]["stage"], step.load)
            step.jump = self.jump(self.rows[step.number])
            step.everywhere = mechanics.body.beyond.spread(step.displacement, step.jump)
            history = self.next_history(step, old.history)
            self.judge(mechanics, step, old, history if mechanics is self.mechanics else mechanics.no_history())
            old = old.followed_by(step, history, mechanics, self.rows[step.number])
        self.judge_summary(old)
        return self.complaints

    def judge(self, mechanics, step, old, history):
        row, prescribed = self.rows[step.number], self.conditions.prescribed
        mechanics.eigenstretch = self.eigenstretch(step.loads)
        gradient = mechanics.gradient(step.everywhere, history)
        magnitude = mechanics.gradient(step.everywhere, history, absolute=True)
        largest = magnitude.max() + 1e-4 * self.whole_forces(mechanics, step)
        if "control" in row:
            self.judge_control(step, row)
        self.compare(step, "force", step.force, -gradient, largest)
        target = self.conditions.displacement(step.loads)
        reach = max(numpy.abs(target).max(), 1e-300)
        if prescribed.any():
            self.compare(step, "prescribed displacement", step.displacement[prescribed], target[prescribed], reach, 1e-12)
        size = max(reach, numpy.abs(step.displacement).max(), 1e-4 * self.ties.size)
        self.compare(step, "ties", self.ties.errors(step.displacement, step.loads), 0.0, size, 1e-11)
        self.judge_jump(mechanics, step)
        loads = self.loads(step.loads, step.displacement)
        external = self.external(step.loads, step.displacement)
        unheld = self.unheld(step, old, history)
        before = self.gradient_before(mechanics, step, old)
        self.judge_residual(mechanics, step, row, old, history, before, gradient - external, magnitude, unheld)
        self.judge_reactions(step, row, gradient - external, largest, unheld, external)
        self.judge_beyond(mechanics, step, row, history, gradient, largest)
        self.judge_energies(mechanics, step, row, old, history)
        if mechanics is self.mechanics:
            self.judge_damage(mechanics, step, row, history)
            if self.events:
                self.events.judge(step, row, old, history)
            everywhere = getattr(step, "everywhere", step.displacement)
            stress.judge(self, step, mechanics, everywhere, history, self.whole_force(mechanics, step))
        self.judge_work(mechanics, step, row, old, history, before, gradient, external, loads)

    def gradient_before(self, mechanics, step, old):
        """Forces of the old state, under its own eigenstretch."""
        mechanics.eigenstretch = self.eigenstretch(old.loads)
        gradient = mechanics.gradient(old.everywhere, self.past(mechanics, old))
        mechanics.eigenstretch = self.eigenstretch(step.loads)
        return gradient

    def eigenstretch(self, load):
        return None if load is UNLOADED else self.conditions.eigenstretch(load)

    def past(self, mechanics, old):
        return old.history if mechanics is self.mechanics else mechanics.no_history()

    def loads(self, load, displacement):
        """Dead loads and follower loads [N]."""
        if load is UNLOADED:
            return numpy.zeros(displacement.shape)
        return self.conditions.force(load) + self.conditions.follower_force(load, displacement)

    def external(self, load, displacement):
        """Loads, and foundations and obstacles, whose energy is stored [N]."""
        if load is UNLOADED:  # nothing has moved
            return numpy.zeros(displacement.shape)
        return self.loads(load, displacement) + self.foundations.force(displacement, load) + self.obstacles.force(displacement, load)

    def whole_force(self, mechanics, step):
        """Force of an intact bond at the largest displacement [N]. Rounding of displacements causes errors of a few
        units of round-off of it, even if all bonds are broken or slack."""
        body = mechanics.body
        reach = min(numpy.abs(step.displacement).max() / body.lengths.min(), 1.0)
        return body.constants[1] * body.weight[1].max() * reach

    def reach(self, mechanics, step):
        """Stretch whose round-off equals that of displacements and eigenstrains."""
        reach = numpy.abs(step.everywhere).max() / mechanics.body.lengths.min()
        eigenstretch = 0.0 if mechanics.eigenstretch is None else numpy.abs(mechanics.eigenstretch).max()
        return min(reach, 1.0) + eigenstretch

    def whole_forces(self, mechanics, step):
        """The same for all interactions of a point [N], for sums."""
        if mechanics not in self.bears:
            self.bears[mechanics] = mechanics.bears()
        return self.bears[mechanics] * self.reach(mechanics, step)

    def unheld(self, step, old, history):
        """Points that may be pinned or removed from the equations in this step: those that were not held
        after the last step that broke bonds, or, in mode path, after the breaks at its beginning."""
        broken = self.mechanics.is_broken(history if self.events else old.history)
        if not broken.any() or step.number < self.first_real_step:
            return numpy.zeros(len(self.results.volume), bool)
        if old.number + 1 == step.number and broken.sum() == self.broken_when_looked_for:
            return self.last_unheld
        self.broken_when_looked_for = broken.sum()
        held = self.conditions.prescribed | self.conditions.cell_held | self.ties.held
        body = self.mechanics.body
        sums = [row for _, row, *_ in self.ties.rows]
        everywhere = body.beyond.spread(old.displacement, old.jump)
        self.last_unheld = unheld_points(everywhere, body.bonds[~broken], held, body.beyond, old.jump, self.jump_is_free, sums)
        return self.last_unheld

    def judge_residual(self, mechanics, step, row, old, history, before, out_of_balance, magnitude, unheld):
        cell_held = self.conditions.middle_of_cell(out_of_balance)
        free = ~self.conditions.prescribed & ~unheld[:, None] & ~self.ties.follows & ~cell_held
        if not free.any() and not self.jump_is_free.any():
            return
        jumped = old.displacement.copy()
        prescribed = self.conditions.prescribed
        jumped[prescribed] = self.conditions.displacement(step.loads)[prescribed]
        jumped = self.ties.after_jump(jumped, step.loads)
        past = self.past(mechanics, old)
        external = self.external(step.loads, jumped)
        mechanics.eigenstretch = self.eigenstretch(old.loads)
        reactions = before - self.external(old.loads, old.displacement)
        beyond = self.forces_beyond(mechanics, old, past)
        mechanics.eigenstretch = self.eigenstretch(step.loads)
        # Reactions of both states: the Newton's method that finishes a relaxed step starts from the latter.
        held = prescribed | self.ties.follows
        of_ties = self.norm_of_ties(old, reactions)
        norms = [numpy.linalg.norm(external), numpy.linalg.norm([numpy.linalg.norm(reactions[held]), beyond, of_ties])]
        # Loads on held points may have changed: the program uses the new ones.
        changed = reactions + self.external(old.loads, old.displacement) - external
        norms.append(numpy.linalg.norm([numpy.linalg.norm(changed[held]), beyond, self.norm_of_ties(old, changed)]))
        beyond = self.forces_beyond(mechanics, step, history)
        of_ties = self.norm_of_ties(step, out_of_balance)
        norms.append(numpy.linalg.norm([numpy.linalg.norm(out_of_balance[held]), beyond, of_ties]))
        # The jump at the start of a step is measured with the damage held.
        jump = numpy.where(self.jump_is_free, old.jump, step.jump)
        everywhere = mechanics.body.beyond.spread(jumped, jump)
        # The program counts contacts after the jump as springs; the old state's forces are a scale below.
        after_jump = mechanics.gradient(everywhere, past, held=True) - external + self.obstacles.force(jumped, step.loads)
        along_ties = self.ties.out_of_balance(jumped, after_jump)
        on_points = numpy.concatenate([after_jump[~held], along_ties])
        on_jumps = mechanics.pull_of_periods(everywhere, past, held=True)[self.jump_is_free]
        norms.append(numpy.hypot(numpy.linalg.norm(on_points), numpy.linalg.norm(on_jumps)))
        norms.append(numpy.linalg.norm(self.of_environment(mechanics, step, old, past)))
        if self.events:
            norms += [numpy.linalg.norm(self.loads(at.loads, at.displacement)) for at in (old, step)]
            norms.append(self.events.least_scale)
        scale = max(norms)
        if self.events:
            self.events.least_scale = max(self.events.least_scale, SHARE_OF_SCALE * scale)
            scale += OF_INTEGRITY * magnitude.max() / self.case["solver"]["relative_tolerance"] * self.mechanics.law.is_toothed
        floor = 8 * UNIT_ROUND_OFF * (numpy.linalg.norm(magnitude) + self.whole_force(mechanics, step))
        floor += STEP * mechanics.body.constants[1] * mechanics.body.weight[1].sum()
        along_ties = self.ties.out_of_balance(step.displacement, out_of_balance, unheld)
        on_jumps = mechanics.pull_of_periods(step.everywhere, history)[self.jump_is_free]
        residual = numpy.linalg.norm([numpy.linalg.norm(part) for part in (out_of_balance[free], along_ties, on_jumps)])
        # A tenth more: the program's scale has the same three norms with its own rounding, and with its own
        # value of the jump at the start of a cut or relaxed step.
        allowed = 1.1 * self.case["solver"]["relative_tolerance"] * scale + floor
        self.judge_pins(step, row, self.ties.on_unheld(out_of_balance, unheld), allowed)
        if row["settled"]:  # need not be in equilibrium
            return
        self.worst["residual / allowed"] = max(self.worst.get("residual / allowed", 0.0), residual / allowed)
        on_cell = numpy.linalg.norm(out_of_balance[cell_held])
        if not on_cell <= allowed * len(unheld) ** 0.5:
            self.complain(step, f"{on_cell:.4g} N on the point at which the cell is held, though nothing holds it")
        if not residual <= allowed:
            self.complain(step, f"not in equilibrium: residual {residual:.4g} N, {allowed:.4g} N is allowed "
                                f"(relative {residual / scale if scale else numpy.inf:.3g})")  # fmt: skip

    def norm_of_ties(self, state, forces):
        """Forces of the constraints in their own coordinates [N]; they count as reactions."""
        reactions, moments = self.ties.reactions(state.displacement, forces)
        sizes = {table["set"]: numpy.sqrt((arms**2).sum(axis=1)).max() for table, _, arms in self.ties.rigid}
        turns = [numpy.linalg.norm(about) / sizes[name] for name, about in moments.items()]
        return numpy.linalg.norm([*(numpy.linalg.norm(force) for force in reactions.values()), *turns])

    @staticmethod
    def forces_beyond(mechanics, state, history):
        """Norm of the forces beyond planes and periods; they count as reactions."""
        if mechanics.body.own == len(mechanics.body.volume):
            return 0.0
        on_copies = numpy.linalg.norm(mechanics.gradient_of_shares(state.everywhere, history)[mechanics.body.own :])
        return numpy.hypot(on_copies, numpy.linalg.norm(mechanics.slopes_by_jumps(state.everywhere, history)))

    def of_environment(self, mechanics, step, old, past):
        """The change of forces at the old displacement due to eigenstrains and pressures."""
        added = numpy.zeros(mechanics.body.reference.shape)
        if mechanics.eigenstretch is not None:
            under = mechanics.gradient_of_shares(old.everywhere, past, held=True)
            kept, mechanics.eigenstretch = mechanics.eigenstretch, None
            added = under - mechanics.gradient_of_shares(old.everywhere, past, held=True)
            mechanics.eigenstretch = kept
        added[: mechanics.body.own] -= self.conditions.follower_force(step.loads, old.displacement)
        resting = numpy.zeros(old.displacement.shape)
        added[: mechanics.body.own] -= self.foundations.force(resting, step.loads)  # the ground's part only
        added[: mechanics.body.own] -= self.obstacles.force(old.displacement, old.loads)
        return added

    def judge_pins(self, step, row, on_unheld, allowed):
        """Only pins may carry forces on floating points, and all of these forces are reported."""
        if step.number < self.first_real_step:
            return
        if not row["settled"] and not on_unheld <= row["pin_force"] + allowed:
            self.complain(step, f"{on_unheld:.4g} N on points that nothing holds, pins bear {row['pin_force']:.4g} N")
        if not row["pin_force"] <= on_unheld * (1 + 1e-6) + allowed:
            self.complain(step, f"pins bear {row['pin_force']:.4g} N, points that nothing holds {on_unheld:.4g} N")

    def judge_reactions(self, step, row, reaction, largest, unheld, external):
        total = numpy.zeros(reaction.shape[1])
        for name in dict.fromkeys(support["set"] for support in self.case.get("support")):
            held = numpy.zeros(reaction.shape, bool)
            for support in self.case.get("support"):
                if support["set"] == name:
                    held |= self.conditions.held_by(support)
            for axis in range(reaction.shape[1]):
                computed = reaction[held[:, axis], axis].sum()
                scale = largest * max(1, held[:, axis].sum())
                self.compare(step, "reaction", row[f"reaction_{'xyz'[axis]}:{name}"], computed, scale)
        reactions, moments = self.ties.reactions(step.displacement, reaction)
        scale = largest * max(1, self.ties.follows.any(axis=1).sum())
        for name, force in reactions.items():
            for axis, component in zip("xyz", force):
                self.compare(step, "reaction", row[f"reaction_{axis}:{name}"], component, scale)
        for name, force in self.foundations.forces(step.displacement, step.loads).items():
            scale = max(largest, numpy.abs(force).max()) * len(force)
            for axis, component in zip("xyz", force.sum(axis=0)):
                self.compare(step, "reaction", row[f"reaction_{axis}:{name}"], component, scale)
        size = numpy.abs(self.results.reference).max() + numpy.abs(step.displacement).max()
        self.judge_obstacles(step, row, largest, size)
        for name, about in moments.items():
            for axis, component in zip("z" if len(about) == 1 else "xyz", about):
                self.compare(step, "moment", row[f"moment_{axis}:{name}"], component, scale * size)
        borne = self.conditions.prescribed | unheld[:, None] | self.ties.follows
        total = reaction[borne].sum() + external.sum() + self.sum_beyond(row)
        rest = reaction[~borne]
        allowed = numpy.abs(rest).sum() + AGREEMENT * largest * len(reaction)
        if not abs(total) <= allowed:
            self.complain(step, f"reactions and loads differ by {total:.4g} N")

    def judge_obstacles(self, step, row, largest, size):
        forces = self.obstacles.forces(step.displacement, step.loads)
        for table in self.obstacles.tables:
            name, force = table["name"], forces[table["name"]]
            scale = max(largest, numpy.abs(force).max()) * len(force)
            moved = self.obstacles.moved(table, step.loads, step.displacement)
            moment = self.obstacles.moment(table, force, step.displacement, step.loads)
            reach = size + numpy.abs(numpy.array(table["point"], float) + moved).max()
            for c, (axis, component) in enumerate(zip("xyz", force.sum(axis=0))):
                self.compare(step, "reaction", row[f"reaction_{axis}:{name}"], component, scale)
                self.compare(step, "obstacle", row.get(f"displacement_{axis}:{name}", 0.0), moved[c], size)
            if "force" in table:
                axis, driving = table["displacement"].index("free"), self.obstacles.value(table["force"], step.loads)
                self.compare(step, "force on an obstacle", row[f"reaction_{'xyz'[axis]}:{name}"], driving, scale)
            for axis in {1: "", 2: "z", 3: "xyz"}[force.shape[1]]:
                self.compare(step, "moment", row[f"moment_{axis}:{name}"], moment["xyz".index(axis)], scale * reach)

    def sum_beyond(self, row):
        """Checks the written forces of planes of symmetry."""
        return sum(row[f"reaction_{'xyz'[axis]}:{name}"] for name, axis, _ in self.mechanics.body.beyond.planes())

    def judge_jump(self, mechanics, step):
        """Checks the prescribed jumps of the displacement over the periods."""
        jump, free = mechanics.body.beyond.given_jump(step.loads)
        if free.all():
            return
        reach = max(numpy.abs(jump).max(), numpy.abs(step.jump).max())
        self.compare(step, "jump over a period", step.jump[~free], jump[~free], reach, 1e-12)

    def judge_beyond(self, mechanics, step, row, history, gradient, largest):
        """Checks the forces beyond planes and periods."""
        beyond = mechanics.body.beyond
        scale = largest * len(numpy.unique(beyond.source))
        pull = mechanics.pull_of_periods(step.everywhere, history)
        for axis in beyond.lengths():
            for c, component in enumerate(beyond.axes):
                written = row[f"reaction_{component}:period_{axis}"]
                self.compare(step, "reaction over a period", written, pull[beyond.axes.index(axis), c], scale)
        sums = -gradient.sum(axis=0)
        for name, (force, axis) in mechanics.pull_of_planes(step.everywhere, history).items():
            for component in "xyz":
                right = force if component == "xyz"[axis] else 0.0
                self.compare(step, "reaction of a plane", row[f"reaction_{component}:{name}"], right, scale)
            sums[axis] -= row[f"reaction_{'xyz'[axis]}:{name}"]
        self.compare(step, "forces from beyond", sums, 0.0, scale)

    def judge_energies(self, mechanics, step, row, old, history):
        energies = mechanics.energies(step.everywhere, history)
        of_springs = self.foundations.energy(step.displacement, step.loads) + self.obstacles.energy(step.displacement, step.loads)
        of_contacts = mechanics.contact_energies(step.everywhere, history)
        stored = mechanics.sum_of(energies) + of_springs.sum() + of_contacts.sum()
        scale = max(abs(stored), abs(row["external_work"]), abs(row["dissipated_energy"]))
        scale += 1e-5 * self.whole_forces(mechanics, step) * numpy.abs(step.everywhere).max()
        self.compare(step, "stored energy", row["stored_energy"], stored, scale)
        dissipated = mechanics.dissipated(history)
        brittle_cpd = mechanics.body.is_cpd and mechanics.law.onset.min() < numpy.inf
        has_torn_faces = mechanics.contact and mechanics.contact.faces and dissipated > 0  # they set free what they stored
        if not (brittle_cpd or has_torn_faces):
            tolerance = OF_TEETH if self.events else AGREEMENT
            self.compare(step, "dissipated energy", row["dissipated_energy"], dissipated, scale, tolerance)
        elif row["dissipated_energy"] < dissipated - AGREEMENT * scale and min(mechanics.body.constants.values()) >= 0:
            self.complain(step, f"dissipated {row['dissipated_energy']:.6g} J, its bonds alone {dissipated:.6g} J")
        if row["dissipated_energy"] < old.dissipated - AGREEMENT * scale:
            self.complain(step, f"dissipated energy falls from {old.dissipated:.6g} to {row['dissipated_energy']:.6g} J")
        density = of_springs + of_contacts[: len(of_springs)]
        for order, part in energies.items():
            for k in range(order + 1):
                on_points = numpy.bincount(mechanics.body.tuples[order][:, k], part / (order + 1), minlength=len(density))
                density += on_points[: len(density)]
        if mechanics is self.mechanics:
            self.compare(step, "energy density", step.energy_density * self.results.volume, density, scale)
        rest = row["external_work"] + row["numerical_work"] - row["stored_energy"] - row["dissipated_energy"] - row["drained_energy"]
        scale += abs(row["numerical_work"])
        self.compare(step, "ledger", row["balance_error"], rest, scale, 1e-12)

    def judge_damage(self, mechanics, step, row, history):
        stretch, broken = mechanics.stretch(step.everywhere), mechanics.is_broken(history)
        over = mechanics.fails & ~broken & (stretch > numpy.maximum(history, mechanics.law.onset) * (1 + 1e-12))
        if over.any():
            self.complain(step, f"{over.sum()} bonds are stretched beyond their history and the onset, "
                                f"up to {stretch[over].max():.6g}")  # fmt: skip
        if int(row["broken_bonds"]) != broken.sum():
            self.complain(step, f"{row['broken_bonds']:.0f} broken bonds are written, {broken.sum()} are right")
        self.judge_broken_bonds(step, broken)
        damage = mechanics.damage(history)
        self.compare(step, "damage", step.damage, damage, 1.0)
        self.compare(step, "max_damage", row["max_damage"], damage.max(), 1.0)
        whole = stretch[~broken]
        largest = whole.max() if len(whole) else 0.0
        of_points = numpy.full(len(mechanics.body.volume), -numpy.inf)
        for end in (0, 1):
            numpy.maximum.at(of_points, mechanics.body.bonds[~broken, end], whole)
        of_points = numpy.where(numpy.isfinite(of_points), of_points, 0.0)[: mechanics.body.own]
        scale = max(abs(stretch).max(), 1e-5 * self.reach(mechanics, step), 1e-15)  # round-off of lengths
        self.compare(step, "max_stretch", row["max_stretch"], largest, scale)
        self.compare(step, "stretch", step.stretch, of_points, scale)

    def judge_broken_bonds(self, step, broken):
        """Broken bonds listed so far."""
        bonds = self.mechanics.body.bonds[broken]
        self.broken_across = int((bonds >= self.mechanics.body.own).any(axis=1).sum())
        written = self.listed_codes[self.listed_steps <= step.number]
        if not numpy.array_equal(written, numpy.sort(self.mechanics.body.codes(numpy.sort(bonds, axis=1)))):
            self.complain(step, "the list of broken bonds is not that of bonds whose history has come to an end")

    def judge_work(self, mechanics, step, row, old, history, before, gradient, external, loads):
        """External work by the trapezoidal rule over the accepted steps; implicit steps add no other work."""
        if step.number == 0:
            return self.judge_work_of_preload(mechanics, step, row)
        if old.mechanics not in (None, mechanics) or old.number + 1 != step.number or self.events:
            return  # between two events of a path: see Events
        if step.mode == "newton" and row["numerical_work"] != old.numerical_work:
            self.complain(step, f"numerical work {row['numerical_work']} in an implicit step, {old.numerical_work} before it")
        prescribed = self.conditions.prescribed
        past = self.past(mechanics, old)
        here = self.conditions.eigenstretch(step.loads)
        mechanics.eigenstretch = self.conditions.eigenstretch(old.loads)
        pull = mechanics.pull_of_periods(old.everywhere, past)
        heating = mechanics.heating_work((old.everywhere, past), (step.everywhere, history), mechanics.eigenstretch, here)
        pull = (pull + mechanics.pull_of_periods(step.everywhere, history)) / 2
        over_periods = numpy.where(self.jump_is_free, 0, pull * (step.jump - old.jump))
        at_first, now = (before - self.external(old.loads, old.displacement), gradient - external)
        loads_before = self.loads(old.loads, old.displacement)
        pull = (loads_before + loads + numpy.where(prescribed, at_first + now, 0)) / 2
        work = float((pull * (step.displacement - old.displacement)).sum()) + over_periods.sum() + heating
        work += self.ties.work(old, step, at_first, now) + self.foundations.work(old, step)
        of_obstacles = self.obstacles.work(old, step)
        work += of_obstacles
        scale = max(abs(row["external_work"]), numpy.abs(pull * (step.displacement - old.displacement)).sum())
        scale += numpy.abs(over_periods).sum() + abs(of_obstacles)
        scale += 1e-5 * self.whole_forces(mechanics, step) * numpy.abs(step.everywhere).max()
        self.compare(step, "work", row["external_work"] - old.external_work, work, scale)

    def judge_work_of_preload(self, mechanics, step, row):
        """Loads at load 0 were applied slowly: an elastic body stores all of their work."""
        if row["dissipated_energy"] == 0 and row["drained_energy"] == 0 and not row["settled"]:
            scale = row["stored_energy"] + 1e-5 * self.whole_forces(mechanics, step) * numpy.abs(step.everywhere).max()
            self.compare(step, "work", row["external_work"], row["stored_energy"], scale)

    def judge_summary(self, old):
        summary, rows = self.results.summary, self.rows
        if summary is None:
            self.complaints.append("there is no summary")
            return
        if summary["steps"] != len(rows) - 1 or 0 not in rows:
            self.complaints.append(f"the summary counts {summary['steps']} steps, the history {len(rows)} rows with step 0")
        if summary["status"] == "completed" and not self.is_at_its_end(rows):
            self.complaints.append("completed, but not at its end")
        if summary["bonds"] != len(self.mechanics.body.bonds):
            self.complaints.append(f"{summary['bonds']} bonds are written, {len(self.mechanics.body.bonds)} are right")
        for name, order in (("triangles", 2), ("tetrahedra", 3)):
            tuples = self.mechanics.body.tuples.get(order, ())
            if summary[name] != len(tuples):
                self.complaints.append(f"{summary[name]} {name} are written, {len(tuples)} are right")


    def is_at_its_end(self, rows):
        """A run ends at load factor 1, at the last controlled displacement, or at the limit on steps of the path."""
        if not rows:
            return False
        last = rows[max(rows)]
        table = self.case.get("loading", {}).get("table", [0, 1])
        if self.case.get("control"):
            return isinstance(table, str) or abs(last["control"] - table[-1]) <= 1e-9 * max(numpy.abs(table))
        if self.case["solver"]["mode"] == "arc_length" and len(rows) - 1 == self.case.get("arc_length", {}).get("steps", 0):
            return True
        return isinstance(table, str) or abs(last["load_factor"] - table[-1]) <= 1e-12

    def judge_control(self, step, row):
        """The controlled weighted sum of mean displacements."""
        terms, sets = self.case.get("control"), self.results.sets
        parts = [float(numpy.dot(step.displacement[sets[term["set"]]].mean(axis=0), term["weights"])) for term in terms]
        size = sum(abs(part) for part in parts) + max(abs(step.displacement).max(), 1e-300)
        if step.number == 0:
            self.control_at_load_zero = sum(parts)
        self.compare(step, "control", row["control"], sum(parts) - self.control_at_load_zero, size)


class Old:
    """The last accepted state."""

    def __init__(self, shape, mechanics, steps):
        """The state at rest: without loads if they act at load 0, so that step 0 is written; else it is step 0
        itself."""
        is_written = bool(steps) and steps[0].number == 0
        self.number, self.load, self.mechanics = -1 if is_written else 0, 0.0, None
        self.displacement, self.history = numpy.zeros(shape), mechanics.no_history()
        self.loads = UNLOADED if is_written else {f"load{k}": 0.0 for k in ("", 2, 3, 4)}
        self.everywhere, self.jump = numpy.zeros(mechanics.body.reference.shape), numpy.zeros((shape[1],) * 2)
        self.dissipated = self.external_work = self.numerical_work = 0.0

    def followed_by(self, step, history, mechanics, row):
        new = Old.__new__(Old)
        new.number, new.load, new.mechanics = step.number, step.load, mechanics
        new.displacement, new.history = step.displacement, history
        new.everywhere, new.jump, new.loads = step.everywhere, step.jump, step.loads
        new.dissipated, new.external_work = row["dissipated_energy"], row["external_work"]
        new.numerical_work = row["numerical_work"]
        return new


def verify(folder, case_text, case_folder="."):
    """Complaints about a run, and the largest errors seen."""
    verification = Verification(folder, case_text, case_folder)
    return verification.run(), verification.worst
