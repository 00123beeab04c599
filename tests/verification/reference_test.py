"""The program compared with the reference of tests/reference: energies, forces, tangents, runs."""

import collections
import csv
import itertools
import shutil
import unittest

import h5py
import numpy

from tests.acceptance.folder import Folder
from tests.reference.body import Body
from tests.reference.case import Case, evaluate, read_points
from tests.reference.clouds import LAWS, random_cloud, random_deformation, random_places, toml, write_points
from tests.reference.influence import POWERS
from tests.reference.mechanics import STEP, Mechanics
from tests.reference.verify import Verification

# Both programs sum some 10^2 to 10^4 terms of stretches near 1e-2 in double precision: a term has lost
# two digits of 16, and terms that cancel in a sum lose one or two more.
ROUND_OFF = 1e-12


def mechanics_of(path):
    case = Case(path.read_text(), path.parent)
    reference, volume, sets = read_points(case)
    mechanics = Mechanics(Body(case, reference, volume, sets=sets))
    mechanics.spare(sets)
    return mechanics, sets


class Clouds(Folder):
    threads = 2

    def setUp(self):
        super().setUp()
        self.random = numpy.random.default_rng(20)

    def compare(self, path, amount, size):
        """Compares check-tangent with the reference; returns the reference and the displacements."""
        mechanics, _ = mechanics_of(path)
        reference = mechanics.body.reference
        expressions = random_deformation(self.random, reference.shape[1], size, amount)
        displacement = numpy.stack([evaluate(e, reference) for e in expressions], 1) - reference
        ended = self.command("check-tangent", path, words=("--deformation", "; ".join(expressions)))
        told, tangent = self.assert_completed(ended).json(), mechanics.tangent(displacement)
        forces = mechanics.gradient(displacement)
        for key, value in (("energy", mechanics.energy(displacement)),
                           ("residual_norm", numpy.linalg.norm(forces)),
                           ("tangent_frobenius_norm", numpy.linalg.norm(tangent))):  # fmt: skip
            self.assertGreater(value, 0)
            self.assertAlmostEqual(told[key] / value, 1, delta=ROUND_OFF, msg=f"{key}: {told[key]} and {value}")
        self.assertLess(numpy.abs(tangent - tangent.T).max(), 1e-13 * numpy.abs(tangent).max())
        self.assertLess(told["force_sum"], ROUND_OFF)
        self.assertLess(told["moment_sum"], ROUND_OFF)
        return mechanics, displacement

    def assert_forces_are_derivatives(self, mechanics, displacement):
        """Checks the reference itself: its forces are complex steps of its energy."""
        forces, scale = mechanics.gradient(displacement), mechanics.gradient(displacement, absolute=True).max()
        for place in itertools.islice(numpy.ndindex(displacement.shape), 8):
            moved = displacement.astype(complex)
            moved[place] += 1j * STEP
            self.assertAlmostEqual(mechanics.energy(moved).imag / STEP / scale, forces[place] / scale, delta=1e-13)

    def test_bonds_with_every_correction_and_law(self):
        compared, seen = 0, collections.Counter()
        for dimension, plane in ((1, "stress"), (2, "stress"), (2, "strain"), (3, "stress")):
            corrections = itertools.product(("none", "linear"), ("none", "volume", "energy"))
            for (volume, surface), law in itertools.product(corrections, LAWS):
                with self.subTest(dimension=dimension, plane=plane, volume=volume, surface=surface, law=law):
                    material = {"youngs_modulus": 3e3, **({"plane": plane} if dimension == 2 else {})}
                    if LAWS[law]:
                        material["damage"] = {**LAWS[law], "no_fail": ["left"]}
                    path = random_cloud(self.random, self.folder, dimension, count=(9, 24, 30)[dimension - 1],
                                        horizon=self.random.uniform(2.2, 3.2), material=material,
                                        quadrature={"volume_correction": volume, "surface_correction": surface},
                                        )  # fmt: skip
                    mechanics, displacement = self.compare(path, 0.07, 6.0)
                    history = mechanics.grown(mechanics.no_history(), displacement)
                    seen["stretched"] += int((mechanics.stretch(displacement) > 0).sum())
                    seen["compressed"] += int((mechanics.stretch(displacement) < 0).sum())
                    seen["broken"] += int(mechanics.is_broken(history).sum())
                    seen["softening"] += int(((history > 0) & ~mechanics.is_broken(history)).sum())
                    if (volume, surface) == ("linear", "energy"):
                        self.assert_forces_are_derivatives(mechanics, displacement)
                    compared += 1
        self.assertEqual(compared, 4 * 6 * len(LAWS))
        self.assertGreater(min(seen[kind] for kind in ("stretched", "compressed", "broken", "softening")), 100)

    def test_bonds_with_a_horizon_per_point(self):
        compared = 0
        corrections = itertools.product(("none", "linear"), ("none", "volume", "energy"))
        for (dimension, (volume, surface)), name in zip(itertools.product((1, 2, 3), corrections),
                                                        itertools.cycle(("constant", "linear", "inverse", "gaussian", "septic"))):  # fmt: skip
            with self.subTest(dimension=dimension, influence=name, volume=volume, surface=surface):
                material = {"youngs_modulus": 3e3, "influence": name, "damage": {**LAWS["tanh"], "no_fail": ["left"]}}
                path = random_cloud(self.random, self.folder, dimension, count=(9, 24, 30)[dimension - 1],
                                    horizon={"ratio": self.random.uniform(2.2, 3.2)}, volumes=(0.1, 2.0), material=material,
                                    quadrature={"volume_correction": volume, "surface_correction": surface},
                                    )  # fmt: skip
                mechanics, displacement = self.compare(path, 0.07, 6.0)
                if surface == "energy":
                    self.assert_forces_are_derivatives(mechanics, displacement)
                compared += 1
        self.assertEqual(compared, 3 * 6)

    def test_bonds_with_every_influence(self):
        compared = 0
        for dimension, name in itertools.product((1, 2, 3), (*POWERS, "gaussian")):
            for volume, surface in (("none", "none"), ("linear", "volume"), ("linear", "energy")):
                with self.subTest(dimension=dimension, influence=name, volume=volume, surface=surface):
                    material = {"youngs_modulus": 3e3, "influence": name, "damage": {**LAWS["tanh"], "no_fail": ["left"]}}
                    path = random_cloud(self.random, self.folder, dimension, count=(9, 24, 30)[dimension - 1],
                                        horizon=self.random.uniform(2.2, 3.2), material=material,
                                        quadrature={"volume_correction": volume, "surface_correction": surface},
                                        )  # fmt: skip
                    self.compare(path, 0.07, 6.0)
                    compared += 1
        self.assertEqual(compared, 3 * 8 * 3)

    def test_cpd_with_both_weights(self):
        compared = 0
        for dimension, weights, law in itertools.product((2, 3), ("mean", "bulk"), LAWS):
            with self.subTest(dimension=dimension, weights=weights, law=law):
                material = {"model": "cpd", "c1": 2.0, "c2": 0.7}
                if dimension == 3:
                    material["c3"] = 0.4
                if LAWS[law]:
                    material["damage"] = {**LAWS[law], "no_fail": ["left"]}
                path = random_cloud(self.random, self.folder, dimension, count=(0, 22, 18)[dimension - 1],
                                    horizon=self.random.uniform(2.05, 2.3), material=material,
                                    quadrature={"weights": weights})  # fmt: skip
                mechanics, displacement = self.compare(path, 0.07, 4.0)
                self.assertTrue(all(len(tuples) > 0 for tuples in mechanics.body.tuples.values()))
                self.assert_forces_are_derivatives(mechanics, displacement)
                compared += 1
        self.assertEqual(compared, 4 * len(LAWS))

    def test_cpd_with_every_influence(self):
        compared = 0
        for dimension, name in itertools.product((2, 3), (*POWERS, "gaussian")):
            with self.subTest(dimension=dimension, influence=name):
                material = {"model": "cpd", "c1": 2.0, "c2": 0.7, "influence": name, "damage": {**LAWS["linear"], "no_fail": ["left"]}}
                if dimension == 3:
                    material["c3"] = 0.4
                path = random_cloud(self.random, self.folder, dimension, count=(0, 22, 18)[dimension - 1],
                                    horizon=self.random.uniform(2.05, 2.3), material=material)  # fmt: skip
                self.compare(path, 0.07, 4.0)
                compared += 1
        self.assertEqual(compared, 2 * 8)

    def test_cpd_of_few_and_nearly_flat_points(self):
        """Some flatness factors are between 0 and 1, and those of some points sum up to less than 1."""
        between = below = 0
        for dimension, count in itertools.product((2, 3), (7, 8, 9, 10)):
            with self.subTest(dimension=dimension, count=count):
                material = {"model": "cpd", "c1": 2.0, "c2": 0.7, **({"c3": 0.4} if dimension == 3 else {})}
                path = random_cloud(self.random, self.folder, dimension, count=count, horizon=1.5,
                                    material=material)  # fmt: skip
                if dimension == 3 and not len(mechanics_of(path)[0].body.tuples[3]):
                    self.assert_refused(self.command("check", path), "material.c3")
                    continue
                mechanics, _ = self.compare(path, 0.05, 3.0)
                for factor in mechanics.body.flatness.values():
                    between += int(((factor > 0.01) & (factor < 0.99)).sum())
                below += sum(int(((n > 0) & (n < 1)).sum()) for n in mechanics.body.factor_sums.values())
        self.assertGreater(between, 10)
        self.assertGreater(below, 5)

    def test_accepted_states_of_runs_are_what_they_claim(self):
        judged = 0
        kinds = [("bond", dimension) for dimension in (1, 2, 3)] + [("cpd", 2), ("cpd", 3)]
        for (model, dimension), law in itertools.product(kinds, LAWS):
            with self.subTest(model=model, dimension=dimension, law=law):
                material = {"micromodulus": 50.0} if model == "bond" else {"model": "cpd", "c1": 50.0, "c2": 9.0}
                quadrature = {"volume_correction": "linear", "surface_correction": "energy"} if model == "bond" else {}
                if LAWS[law]:
                    material["damage"] = {**LAWS[law], "no_fail": ["left", "right"]}
                still = [0] * dimension
                pulled = ["0.25*load", *still[1:]]
                path = random_cloud(self.random, self.folder, dimension, count=(10, 28, 36)[dimension - 1], horizon=2.2,
                                    material=material, quadrature=quadrature,
                                    support=[{"set": "left", "displacement": still}, {"set": "right", "displacement": pulled}],
                                    load=[{"set": "middle", "total_force": ["0.3*load", *still[1:]]}],
                                    loading={"steps": 4}, relaxation={"steps": 8},
                                    solver={"mode": "adaptive" if LAWS[law] else "newton"})  # fmt: skip
                output = self.run_case(path, name=f"{model}_{dimension}_{law}", code=(0, 3))
                verification = Verification(output, path.read_text(), self.folder)
                if verification.histories_are_known:
                    self.assertEqual(verification.run(), [])
                    judged += len(verification.results.steps)
        self.assertGreater(judged, 60)


def plane(axis, at):
    return {"axis": axis, "at": float(at)}


def period(axis, length, gradient):
    return {"axis": axis, "from": 0.0, "to": float(length), "gradient": gradient}


class Beyond(Folder):
    """Planes of symmetry and periods: the reference continues the body, the program has images and folds forces."""

    SIDE = {1: 12, 2: 6, 3: 4}  # points
    PULL = {"bond": 0.12, "cpd": 0.1}  # strain

    def setUp(self):
        super().setUp()
        self.random = numpy.random.default_rng(21)

    def arrangements(self, dimension):
        """Tables of planes and periods, by name; the load acts along x, by supports or by the gradient of a period."""
        side, still = self.SIDE[dimension], [0] * (dimension - 1)
        last = "xyz"[dimension - 1]
        found = {"a plane": {"symmetry": [plane("x", side)]}, "a strip": {"symmetry": [plane(last, 0), plane(last, side)]}}
        if dimension > 1:
            found["a quarter"] = {"symmetry": [plane("x", side), plane("y", 0)]}
            found["a band"] = {"period": [period("y", side, ["0", "free", *still[1:]])]}
            found["a half band"] = {"period": [period("y", side, ["0", "-0.02*load", *still[1:]])], "symmetry": [plane("x", side)]}
        pulled = ["{}*load", "0.03*load", "0"][:dimension]
        found["a cell"] = {"period": [period(axis, side, pulled if axis == "x" else ["0", "free", "0"][:dimension])
                                      for axis in "xyz"[:dimension]]}  # fmt: skip
        if dimension == 3:
            found["a cell"]["period"].pop()
            found["an eighth"] = {"symmetry": [plane(axis, side) for axis in "xyz"]}
        return found

    def body(self, dimension, model, law, beyond, is_lattice):
        """Points in a cube, half of which may be the continuation of the other half, stretched along x."""
        side = self.SIDE[dimension]
        case = {"dimension": dimension}
        horizon = {"bond": (2.2, 3.015, 2.015), "cpd": (0, 2.3, 1.75)}[model][dimension - 1]
        if is_lattice:
            shape = [{"add": "box", "min": [0.0] * dimension, "max": [float(side)] * dimension}]
            case["lattice"] = {"spacing": 1.0, "horizon_ratio": horizon, "shape": shape}
            case["set"] = [{"name": "left", "where": "x < 1"}, {"name": "right", "where": f"x > {side - 1}"}]
        else:
            reference = random_places(self.random, side**dimension, dimension) + 0.5
            x = reference[:, 0]
            volume = self.random.uniform(0.7, 1.4, len(x))
            write_points(self.folder / "cloud.csv", reference, volume, {"left": x < 1, "right": x > side - 1})
            case["points"] = {"file": "cloud.csv", "horizon": horizon}
        material = {"micromodulus": 50.0} if model == "bond" else {"model": "cpd", "c1": 50.0, "c2": 9.0}
        if model == "cpd" and dimension == 3:
            material["c3"] = 2.0
        if LAWS[law]:
            material["damage"] = LAWS[law]
        case["material"] = material
        if model == "bond":
            case["quadrature"] = {"volume_correction": "linear", "surface_correction": "energy" if is_lattice else "volume"}
        pull, still = self.PULL[model], [0] * (dimension - 1)
        mirrored = any(table == plane("x", side) for table in beyond.get("symmetry", []))
        is_cell = any(table["axis"] == "x" for table in beyond.get("period", []))
        if not is_cell:
            case["support"] = [{"set": "left", "displacement": [0, *still]}]
            if mirrored:  # away from the plane
                case["support"][0]["displacement"][0] = f"{-pull * side}*load"
            else:
                case["support"].append({"set": "right", "displacement": [f"{pull * side}*load", *still]})
        else:
            beyond["period"][0]["gradient"][0] = f"{pull}*load"
        return case | beyond

    def judged(self, case, name):
        return Verification(self.run_case(case, name=name, code=(0, 3)), toml(case), self.folder)

    def test_runs_are_what_the_continued_body_says(self):
        seen = collections.Counter()
        kinds = [("bond", 1), ("bond", 2), ("bond", 3), ("cpd", 2), ("cpd", 3)]
        for number, (model, dimension) in enumerate(kinds):
            for count, (what, beyond) in enumerate(self.arrangements(dimension).items()):
                for law in ("none", ("tanh_continuous", "critical_stretch")[count % 2]):
                    is_lattice = (number + count + (law == "none")) % 2 == 0
                    name = f"{model}_{dimension}_{what}_{law}".replace(" ", "_")
                    with self.subTest(name, lattice=is_lattice):
                        case = self.body(dimension, model, law, beyond, is_lattice)
                        case["loading"] = {"steps": 3}
                        case["relaxation"] = {"steps": 4, "max_iterations": 3000}
                        case["solver"] = {"mode": "adaptive" if LAWS[law] else "newton", "relative_tolerance": 1e-9}
                        verification = self.judged(case, name)
                        self.assertEqual(verification.run(), [])
                        body = verification.mechanics.body
                        across = body.bonds[:, 1] >= body.own
                        self.assertGreater(across.sum(), 0)
                        seen["steps", model] += len(verification.results.steps)
                        seen["planes"] += verification.worst.get("reaction of a plane") is not None
                        seen["periods"] += verification.worst.get("reaction over a period") is not None
                        seen["broken across", model] += verification.broken_across
                        seen["clouds"] += not is_lattice
        self.assertGreater(min(seen["steps", model] for model in ("bond", "cpd")), 80)
        self.assertGreater(min(seen["broken across", model] for model in ("bond", "cpd")), 100)
        self.assertGreater(min(seen[kind] for kind in ("planes", "periods", "clouds")), 20)

    # ---- errors are detected ----------------------------------------------------------------------

    def changed_rows(self, folder, table, change):
        path = folder / f"{table}.csv"
        with open(path, newline="") as file:
            rows = list(csv.DictReader(file))
        fields = list(rows[0])
        change(rows)
        with open(path, "w", newline="") as file:
            writer = csv.DictWriter(file, fields)
            writer.writeheader()
            writer.writerows(rows)

    def scaled(self, column, factor):
        def change(rows):
            self.assertNotEqual(float(rows[-1][column]), 0)
            rows[-1][column] = repr(float(rows[-1][column]) * factor)

        return lambda folder: self.changed_rows(folder, "history", change)

    def test_what_is_tampered_with_is_found(self):
        case = self.body(2, "bond", "tanh_continuous", {"symmetry": [plane("x", 6)], "period": [period("y", 6, ["0", "free"])]}, True)
        case["support"][0]["displacement"][0] = "-0.28*load"  # some of the bonds break, the rest carry the load
        case["loading"] = {"steps": 3}
        case["solver"] = {"mode": "adaptive"}
        case["relaxation"] = {"steps": 4}
        right = self.judged(case, "right")
        self.assertEqual(right.run(), [])
        self.assertGreater(right.broken_across, 0)

        def in_file(change):
            def apply(folder):
                with h5py.File(folder / "results.h5", "r+") as file:
                    steps = sorted(file["steps"])
                    change(file, file["steps"][steps[-1]])

            return apply

        def field(name, factor):
            def change(_, step):
                values = step[name][...]
                values[numpy.unravel_index(numpy.abs(values).argmax(), values.shape)] *= factor
                step[name][...] = values

            return in_file(change)

        def history_across(_, step):
            """Only one of two twins."""
            image, stretch = step["history/second_image"][...], step["history/largest_stretch"][...]
            stretch[numpy.flatnonzero(image)[0]] *= 1.001
            step["history/largest_stretch"][...] = stretch

        def other_kind(_, step):
            """As if bonds across the plane crossed the period."""
            image = step["history/second_image"][...]
            step["history/second_image"][...] = numpy.where(image > 0, len(step.file["points/images/shift"]) + 1 - image, 0)

        def other_place(file, _):
            """As if the plane were somewhere else."""
            file["points/images/shift"][:, 0] += 0.5

        tampered = {
            "a displacement": (field("displacement", 1 + 1e-6), "force"),
            "a force": (field("force", 1 + 1e-6), "force"),
            "an energy density": (field("energy_density", 1 + 1e-6), "energy density"),
            "a damage": (field("damage", 1 + 1e-6), "damage"),
            "a history across": (in_file(history_across), "twin"),
            "kinds of images": (in_file(other_kind), "no bond"),
            "places of images": (in_file(other_place), "no bond"),
            "the plane's reaction": (self.scaled("reaction_x:symmetry_x", 1 + 1e-6), "reaction of a plane"),
            "the plane's other reaction": (lambda folder: self.changed_rows(folder, "history", lambda rows: rows[-1].update({"reaction_y:symmetry_x": "1e-3"})),
                                           "reaction of a plane"),
            "the free jump": (self.scaled("gradient_y:period_y", 1 + 1e-5), "force"),
            "the given jump": (lambda folder: self.changed_rows(folder, "history", lambda rows: rows[-1].update({"gradient_x:period_y": "1e-6"})),
                               "jump over a period"),
            "the force over a period": (lambda folder: self.changed_rows(folder, "history", lambda rows: rows[-1].update({"reaction_y:period_y": "1e-3"})),
                                        "reaction over a period"),
            "the stored energy": (self.scaled("stored_energy", 1 + 1e-8), "stored energy"),
            "the dissipated energy": (self.scaled("dissipated_energy", 1 + 1e-8), "dissipated energy"),
            "twice the energy": (self.scaled("stored_energy", 2), "stored energy"),
            "the work": (self.scaled("external_work", 1 + 1e-7), "ledger"),
            "a broken bond": (lambda folder: self.changed_rows(folder, "broken_bonds", lambda rows: rows.pop()), "list of broken bonds"),
        }  # fmt: skip
        for what, (tamper, word) in tampered.items():
            with self.subTest(what):
                folder = self.folder / "tampered"
                shutil.copytree(self.folder / "right", folder)
                tamper(folder)
                found = Verification(folder, toml(case), self.folder).run()
                self.assertTrue(any(word in complaint for complaint in found), f"{word} is not among {found[:5]}")
                shutil.rmtree(folder)


if __name__ == "__main__":
    unittest.main()
