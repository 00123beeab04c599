"""Small cases whose answers must agree with one another, whatever the numbers. They find wrong answers with
exit code 0.

Every function takes the input (tests/fuzz/fuzz.py), makes its cases with the input's random generator, runs
them, and raises Finding if a property does not hold. Bodies have some ten points and take milliseconds.
"""

import copy
import csv
import json
import math
import re

MODES = ("newton", "adaptive", "relaxation")
ROUND_OFF = 1e-6  # largest relative difference of two ways to compute a value: solvers stop at 1e-8 or below
# Relative error of a step's work by the trapezoidal rule: strains here are below 1e-3.
ONE_STEP = 1e-2

BAR = """dimension = 1
[lattice]
spacing = {spacing}
horizon_ratio = 2.015
area = {area}
[[lattice.shape]]
add = "box"
min = [0.0]
max = [{length}]
[[set]]
name = "left"
where = "x < 2 * spacing"
[[set]]
name = "right"
where = "x > {length} - spacing"
[material]
youngs_modulus = {modulus}
density = 1000.0
thermal_expansion = 1e-5
[solver]
relative_tolerance = 1e-10
"""
PLATE = """dimension = 2
[lattice]
spacing = {spacing}
horizon_ratio = 2.015
thickness = {area}
[[lattice.shape]]
add = "box"
min = [0.0, 0.0]
max = [{length}, {height}]
[[set]]
name = "left"
where = "x < 2 * spacing"
[[set]]
name = "right"
where = "x > {length} - spacing"
[material]
youngs_modulus = {modulus}
density = 1000.0
thermal_expansion = 1e-5
[solver]
relative_tolerance = 1e-10
"""


class Body:
    """A bar or a plate of random size and stiffness, held on the left."""

    def __init__(self, random):
        self.spacing = 10 ** random.uniform(-4, 1)
        self.dimension = random.choice((1, 1, 2))
        self.count = random.randint(6, 12)
        self.modulus = 10 ** random.uniform(0, 12)
        self.area = 10 ** random.uniform(-6, 1)
        self.strain = 10 ** random.uniform(-6, -4)
        self.held = f'[[support]]\nset = "left"\ndisplacement = {[0.0] * self.dimension}\n'

    @property
    def length(self):
        return self.count * self.spacing

    @property
    def section(self):
        return self.area if self.dimension == 1 else self.area * 4 * self.spacing

    @property
    def text(self):
        numbers = {"spacing": self.spacing, "length": self.length, "height": 4 * self.spacing, "modulus": self.modulus, "area": self.area}
        return (BAR if self.dimension == 1 else PLATE).format(**numbers)

    def in_units(self, length, stress):
        """The same body in units of length and stress that are smaller by these factors."""
        other = copy.copy(self)
        other.spacing, other.modulus = length * self.spacing, stress * self.modulus
        other.area *= length ** (2 if self.dimension == 1 else 1)
        return other

    def along(self, expression):
        """A vector with a component along the bar, given by an expression."""
        return "[" + ", ".join([f'"{expression}"', '"0"'][: self.dimension]) + "]"

    def driven(self, scale):
        """Loadings by name, with their size multiplied by an expression."""
        stress = self.strain * self.modulus
        force, gravity = stress * self.section, stress / (1000.0 * self.length)
        own = {
            "force": f'[[load]]\nset = "right"\ntotal_force = {self.along(f"{force}*{scale}")}\n',
            "gravity": f"[[load]]\ngravity = {self.along(f'{gravity}*{scale}')}\n",
            "displacement": f'[[support]]\nset = "right"\ndisplacement = {self.along(f"{self.strain * self.length}*{scale}")}\n',
            "temperature": f'[temperature]\nchange = "{self.strain / 1e-5}*{scale}"\n',
            "ground": f'[[foundation]]\nname = "ground"\nset = "right"\nstiffness = {[0.1 * self.modulus * self.section / self.length] * self.dimension}\n'
                      f"displacement = {self.along(f'{self.strain * self.length}*{scale}')}\n",  # fmt: skip
        }
        return {name: self.held + text for name, text in own.items()}


def state(made, folder):
    """The end of a run: energies, the largest displacement, reactions."""
    summary = json.loads((made.folder / folder / "summary.json").read_text())
    energy = summary["energy"]
    return {
        "stored": energy["stored"], "displacement": summary["max_displacement"],
        "reaction": max((math.hypot(*reaction) for reaction in summary["reactions"].values()), default=0.0),
        "lost": energy["dissipated"] + energy["drained"], "work": energy["external_work"] + energy["numerical_work"],
    }  # fmt: skip


def run(made, text, folder, *words, codes=(0,)):
    made.write("case.toml", text)
    ended = made.peristat("run", "case.toml", "--quiet", "--threads", "1", "--output", folder, *words)
    if ended.code == 2 and "not known" in ended.errors and 2 not in codes:
        made.finding(f"a case of the fuzzer is refused: {ended.errors.strip()[:200]}", ended)
    if ended.code not in codes:
        made.finding(f"exit code {ended.code} for a case that has an answer: {ended.errors.strip()[:200]}", ended)
    made.assert_numbers(ended)
    return ended


def require_balance(made, ended, found, share):
    """The external work is stored, dissipated or drained."""
    away = abs(found["stored"] + found["lost"] - found["work"])
    if away > share * max(abs(found["stored"]), abs(found["lost"]), abs(found["work"])):
        made.finding(f"stored {found['stored']:.9g} J and lost {found['lost']:.9g} J of {found['work']:.9g} J of work", ended)


def require_same(made, body, ended, one, other, words, share):
    force = body.strain * body.modulus * body.section
    of = {"displacement": body.strain * body.length, "reaction": force, "stored": force * body.strain * body.length}
    for key, size in of.items():
        if abs(one[key] - other[key]) > share * max(abs(one[key]), abs(other[key])) + ROUND_OFF * size:
            made.finding(f"{words}: {key} {one[key]:.9g} and {other[key]:.9g}", ended)


def elastic_in_one_step_and_in_many(made):
    """An elastic body reaches the same state in any number of steps."""
    body = Body(made.random)
    name, load = made.random.choice(sorted(body.driven("load").items()))
    mode, many = made.random.choice(MODES), made.random.randint(2, 9)
    states = []
    for steps in (1, many):
        ended = run(made, f"{body.text}mode = \"{mode}\"\n[loading]\nsteps = {steps}\n{load}", f"out{steps}")
        states.append(state(made, f"out{steps}"))
        require_balance(made, ended, states[-1], ONE_STEP)
    require_same(made, body, ended, *states, f"{name} in 1 and {many} steps of mode {mode}", 1e-4)


def at_once_and_ramped(made):
    """A load that acts from the start leads to the same state, with the same work, as a load that grows."""
    body = Body(made.random)
    name = made.random.choice(sorted(body.driven("")))
    mode, steps = made.random.choice(MODES), made.random.randint(1, 4)
    states = []
    for folder, scale in (("ramped", "load"), ("at_once", "1")):
        text = f"{body.text}mode = \"{mode}\"\n[loading]\nsteps = {steps}\n{body.driven(scale)[name]}"
        ended = run(made, text, folder)
        states.append(state(made, folder))
        require_balance(made, ended, states[-1], ONE_STEP)
    require_same(made, body, ended, *states, f"{name} that grows and at once, mode {mode}", 1e-4)


UNITS = 1e-9  # relative: scaling of units by powers of four changes a state's digits by round-off only


def in_other_units(made):
    """A body carries the same load in metres and in other units of length and stress: the program has no length or
    stress scale of its own."""
    body = Body(made.random)
    name = made.random.choice(sorted(body.driven("load")))
    length, stress = (4.0 ** made.random.randint(-8, 8) for _ in range(2))
    tears, critical = made.random.random() < 0.5, body.strain * made.random.uniform(0.5, 1.5)
    states = []
    for folder, one in (("metres", body), ("others", body.in_units(length, stress))):
        law = f"[material.damage]\nlaw = \"critical_stretch\"\ncritical = {critical}\n" if tears else ""
        mode = f"mode = \"{'adaptive' if tears else 'newton'}\"\n"
        text = one.text.replace("[solver]", law + "[solver]") + mode
        ended = run(made, f"{text}[loading]\nsteps = 3\n{one.driven('load')[name]}", folder, codes=(0, 2, 3))
        states.append((ended.code, state(made, folder) if ended.code == 0 else {}))
    (code, one), (other_code, other) = states
    if code != other_code:
        made.finding(f"ends with {code} in metres and with {other_code} in other units", ended)
    force = stress * length**2
    unit = {"displacement": length, "reaction": force} | dict.fromkeys(("stored", "lost", "work"), force * length)
    size = {key: max(map(abs, (one[k] for k in one if unit[k] == unit[key])), default=0.0) for key in one}
    for key, value in one.items():
        if abs(other[key] / unit[key] - value) > UNITS * size[key]:
            made.finding(f"{name}: {key} {value:.12g} in metres, {other[key] / unit[key]:.12g} in other units", ended)


def dead_load_in_modes_that_find_loads(made):
    """A dead load is applied before a mode that follows a path begins; at the end its work balances."""
    body = Body(made.random)
    force = body.strain * body.modulus * body.section
    mode = made.random.choice(("arc_length", "path"))
    law = f"[material.damage]\nlaw = \"critical_stretch\"\ncritical = {1e3 * body.strain:.6g}\n" if mode == "path" else ""
    load = f'[[load]]\nset = "right"\ntotal_force = {body.along(f"{0.5 * force:.6g} + {0.5 * force:.6g}*load")}\n'
    text = body.text.replace("[solver]", law + "[solver]")
    ended = run(made, f"{text}mode = \"{mode}\"\n[loading]\nsteps = 4\n{body.held}{load}", "out", codes=(0, 2))
    if ended.code == 0:
        require_balance(made, ended, state(made, "out"), ONE_STEP)
        with open(made.folder / "out/history.csv", newline="") as table:
            if not any(float(row["step"]) > 0 for row in csv.DictReader(table)):
                made.finding(f"mode {mode} ends well after no step", ended)


TENSION = """dimension = 2
[lattice]
spacing = 1e-2
[[lattice.shape]]
add = "box"
min = [0, 0]
max = [0.16, 0.08]
[[lattice.layer]]
name = "left"
side = "x-"
[[lattice.layer]]
name = "right"
side = "x+"
[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[material]
youngs_modulus = 30e9
[material.damage]
law = "linear"
fracture_energy = {energy}
strength = {strength}
no_fail = ["left", "right"]
[[set]]
name = "mid"
where = "abs(x - 0.08) < spacing && abs(y - 0.04) < spacing"
[[support]]
set = "left"
displacement = [0, "free"]
[[support]]
set = "right"
displacement = ["{pull}*load", "free"]
[[support]]
set = "mid"
displacement = ["free", 0]
[loading]
steps = 12
[solver]
mode = "adaptive"
"""
STRENGTH = 0.1  # relative: effect of the corners beside the clamped layers


def strength_is_what_the_body_bears(made):
    """A plain plate carries its strength, whatever its fracture energy."""
    strength = 3e6
    energy = made.random.choice((30.0, 60.0, 110.0))
    text = TENSION.format(energy=energy, strength=strength, pull=f"{2.0 * strength / 30e9 * 0.16:.6g}")
    ended = run(made, text, "out", codes=(0, 2, 3))  # 3: past the peak
    if ended.code == 2:  # this lattice does not allow the law
        return
    with open(made.folder / "out/history.csv", newline="") as table:
        borne = max(abs(float(row["reaction_x:right"])) for row in csv.DictReader(table)) / 0.08
    if abs(borne / strength - 1) > STRENGTH:
        made.finding(f"bears {borne:.4g} Pa with a strength of {strength:g} Pa, fracture energy {energy:g} J/m2", ended)


# Keys that have no effect without another one. Tables of modes such as [arc_length] are excluded: a case may have
# them for the mode that --set chooses.
WITHOUT_SWITCH = (
    "[material.damage]\ncritical = 1e-3\n",
    "[material.damage]\nfracture_energy = 10.0\n",
    "[material.damage]\nstrength = 1e6\n",
    "[[region]]\nset = \"right\"\n[region.material.damage]\ncritical = 1e-3\n",
    "[loading]\ntable2 = [0, 1]\n",
    "[dynamics]\nend_time = 1.0\n",
    "[[initial]]\nset = \"right\"\nvelocity = [1.0]\n",
    "[[absorbing]]\nset = \"right\"\nrate = 10.0\n",
    "[[control]]\nset = \"right\"\nweights = [1]\n",
)


def key_without_its_switch(made):
    """A key without effect is refused, or makes a difference that `check` prints."""
    body = Body(made.random)
    added = made.random.choice(WITHOUT_SWITCH)
    if body.dimension == 2:
        added = added.replace("[1.0]", "[1.0, 0.0]").replace("[1]", "[1, 0]")
    plain = body.text + body.driven("load")["displacement"]
    other = plain + added
    made.write("case.toml", plain)
    before = made.peristat("check", "case.toml")
    made.write("case.toml", other)
    after = made.peristat("check", "case.toml")
    if after.code == 0 and after.said == before.said:
        made.finding(f"is not heeded, and not a word is said: {added!r}", after)


def what_misses_the_body(made):
    """A crack that cuts nothing, or a shape or set outside the body, is refused or reported."""
    body = Body(made.random)
    far, size = 3 * body.length, body.length
    missing = {
        1: f'[[lattice.shape]]\nsubtract = "box"\nmin = [{far:.6g}]\nmax = [{far + size:.6g}]\n',
        2: made.random.choice((
            f"[[crack]]\nfrom = [{far:.6g}, 0.0]\nto = [{far + size:.6g}, 0.0]\n",
            f'[[lattice.shape]]\nsubtract = "box"\nmin = [{far:.6g}, 0.0]\nmax = [{far + size:.6g}, {size:.6g}]\n',
            f'[[lattice.shape]]\nsubtract = "disk"\ncentre = [{far:.6g}, 0.0]\nradius = {size:.6g}\n',
        )),
    }[body.dimension]  # fmt: skip
    text = body.text + body.driven("load")["displacement"]
    where = "[[set]]" if "lattice" in missing else "[material]"
    made.write("case.toml", text.replace(where, missing + where, 1))
    ended = made.peristat("check", "case.toml")
    if ended.code == 0 and not re.search(r"no (bond|point)|nothing|not? (cut|meant?)|outside", ended.said):
        made.finding(f"misses the body, and not a word is said: {missing!r}", ended)


def outputs_over_inputs(made):
    """No output replaces an input or another file of the user."""
    body = Body(made.random)
    case = body.text + body.driven("load")["force"]
    made.write("case.toml", case)
    made.write("notes.txt", "mine")
    (made.folder / "link").symlink_to(made.random.choice(("case.toml", "notes.txt")))
    (made.folder / "second").hardlink_to(made.folder / "case.toml")
    log = made.random.choice(("case.toml", "notes.txt", "link", "second", "./case.toml"))
    ended = made.peristat("run", "case.toml", "--quiet", "--output", "out", "--log", log)
    kept = (made.folder / "case.toml").read_text() == case and (made.folder / "notes.txt").read_text() == "mine"
    if not kept or ended.code != 2:
        made.finding(f"--log {log} ends with {ended.code}" + ("" if kept else ", and the file is gone"), ended)
    run(made, case, "out")
    before = (made.folder / "out/history.csv").read_bytes()
    inside = made.random.choice(("out/history.csv", "out/results.h5", "out/summary.json", "out/peristat.json"))
    ended = made.peristat("resume", "out", "--quiet", "--log", inside)
    if ended.code != 2 or (made.folder / "out/history.csv").read_bytes() != before:
        made.finding(f"resume --log {inside} ends with {ended.code}", ended)
    made.write("notes.toml", case)
    ended = made.peristat("run", "notes.toml", "--quiet", "--output", "out")
    if ended.code != 2:
        made.finding(f"results of another case are replaced, exit code {ended.code}", ended)


PROPERTIES = {
    elastic_in_one_step_and_in_many: 3, at_once_and_ramped: 3, dead_load_in_modes_that_find_loads: 2,
    strength_is_what_the_body_bears: 1, key_without_its_switch: 1, what_misses_the_body: 1, in_other_units: 2, outputs_over_inputs: 1,
}  # fmt: skip


def try_property(made):
    chosen = made.random.choices(list(PROPERTIES), weights=PROPERTIES.values())[0]
    chosen(made)
