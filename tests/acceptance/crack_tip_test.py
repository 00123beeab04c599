"""J integral, stress intensity factors and T-stress of [[crack_tip]]."""

import json
import math
import re

import h5py
import numpy

from tests.acceptance.constraints_test import plane
from tests.acceptance.programme_test import Programmes
from tests.reference.case import Case
from tests.reference.centre_crack import centre_crack
from tests.reference.crack_tip import CrackTip, Elasticity
from tests.reference.program import ROOT
from tests.reference.verify import Verification

CASES = ROOT / "cases"
E = 200e9

# A square whose rim moves with Williams' fields.
SQUARE = """\
dimension = {dimension}
[lattice]
spacing = 1e-3
horizon_ratio = 3.015
{thickness}
[[lattice.shape]]
add = "box"
min = [-0.02, {low}{bottom}]
max = [0.02, 0.02{top}]
[[set]]
name = "rim"
where = "max(abs(x), abs(y)) > 0.017"
[[crack]]
{crack}
[material]
{material}
[[support]]
set = "rim"
displacement = [{displacement}]
[[crack_tip]]
name = "tip"
at = [0, 0{middle}]
direction = [1, 0{middle}]
[solver]
relative_tolerance = 1e-12
"""


def williams(mode, shear, kolosov):
    """Components as expressions of position for the stress intensity 1e6 Pa m^1/2; the crack lies on negative x."""
    size, half = f"1e6*load*sqrt(sqrt(x^2+y^2)/(2*pi))/(2*{shear})", "(atan2(y,x)/2)"
    if mode == 0:
        return (f"{size}*cos{half}*({kolosov}-1+2*sin{half}^2)", f"{size}*sin{half}*({kolosov}+1-2*cos{half}^2)", "0")
    if mode == 1:
        return (f"{size}*sin{half}*({kolosov}+1+2*cos{half}^2)", f"-{size}*cos{half}*({kolosov}-1-2*sin{half}^2)", "0")
    return ("0", "0", f"4*{size}*sin{half}")


def square(displacement, dimension=2, material=f'youngs_modulus = {E}\n[quadrature]\nvolume_correction = "linear"', low=-0.02, more=""):
    is_plane = dimension == 2
    crack = "from = [-0.03, 0]\nto = [0, 0]" if is_plane else "vertices = [[-0.03, 0, -1], [0, 0, -1], [0, 0, 1], [-0.03, 0, 1]]"
    quoted = ", ".join(f'"{component}"' for component in displacement[:dimension])
    return SQUARE.format(dimension=dimension, thickness="thickness = 1e-3" if is_plane else "", low=low, crack=crack,
                         bottom="" if is_plane else ", 0", top="" if is_plane else ", 5e-3", middle="" if is_plane else ", 0",
                         material=material, displacement=quoted) + more  # fmt: skip


class CrackTips(Programmes):
    def by_reference(self, name, elasticity, ring):
        folder = self.folder / name
        with h5py.File(folder / "results.h5") as file:
            case = Case(file["case/as_resolved"][()].decode(), self.folder)
        judged = Verification(folder, case)
        tip = CrackTip(judged.mechanics, case.get("crack_tip")[0], elasticity, *ring)
        return tip.values(judged.results.steps[-1].displacement)

    def assert_same(self, row, expected):
        largest = max(abs(value) for name, value in expected.items() if name.startswith("K"))
        size = {"J": expected["J"], "T": largest / math.sqrt(2 * math.pi * 6e-3), "T_star": largest / math.hypot(expected["K1"], expected["K2"])}
        for name, value in expected.items():
            self.assertAlmostEqual(row[f"tip_{name}"], value, delta=1e-6 * size.get(name, largest), msg=name)

    def test_williams_fields_have_their_factors(self):
        """Limited by the lattice's moduli, which differ from the continuum's by 2 % in tension and 4 % in shear, and by
        a nonlocal tip."""
        thin = Elasticity(E, 1 / 3, True)
        for mode, (name, other, error) in enumerate((("K1", "K2", 0.02), ("K2", "K1", 0.04))):
            with self.subTest(name):
                row = self.rows(square(williams(mode, thin.shear, thin.kolosov)), "lattice.spacing=5e-4")[-1]
                self.assertAlmostEqual(row[f"tip_{name}"] / 1e6, 1, delta=error)
                self.assertLess(abs(row[f"tip_{other}"]), 1e-3 * 1e6)
                self.assertAlmostEqual(row["tip_J"] / (row[f"tip_{name}"] ** 2 / E), 1, delta=0.03)
                self.assertLess(row["tip_J_spread"], 0.01)

    def test_what_is_told_is_what_the_reference_finds(self):
        thin, ring = Elasticity(E, 1 / 3, True), (2 * 3.015e-3, 4 * 3.015e-3)
        fields = [williams(mode, thin.shear, thin.kolosov) for mode in (0, 1)]
        mixed = [f"{one}+0.5*({other})+1e-5*load*x*{axis == 0:d}" for axis, (one, other) in enumerate(zip(*fields))]
        row = self.rows(square(mixed))[-1]
        self.assert_same(row, self.by_reference("out", thin, ring))

    def test_t_stress_of_a_uniform_field(self):
        """A stress along the crack does not load the tip: T is that stress, and K is zero."""
        strain = 1e-4
        row = self.rows(square([f"{strain}*load*x", f"-{strain}/3*load*y"]))[-1]
        self.assertAlmostEqual(row["tip_T"] / (E * strain), 1, delta=0.02)
        for name in ("K1", "K2"):
            self.assertLess(abs(row[f"tip_{name}"]), 0.01 * E * strain * math.sqrt(math.pi * 0.01))

    def test_t_star_of_every_model(self):
        """A mixed field with a T-stress, given to the rim. K_I, which takes a share of T, and T are within 4 %."""
        mix, horizon = 0.344, 3.015 * 5e-4
        size = 1e6 * math.hypot(1, mix) / math.sqrt(math.pi * horizon)
        for nu, material in (
            (1 / 3, f'youngs_modulus = {E}\n[quadrature]\nvolume_correction = "linear"'),
            (0.4, f'model = "cpd"\nyoungs_modulus = {E}\npoisson_ratio = 0.4'),
            (0.2, f'model = "state"\nyoungs_modulus = {E}\npoisson_ratio = 0.2'),
        ):
            own = Elasticity(E, nu, True)
            fields = [williams(mode, own.shear, own.kolosov) for mode in (0, 1)]
            for t_star in (-0.4, -0.1, 0, 0.4):
                with self.subTest(material=material, t_star=t_star):
                    strain = t_star * size / E
                    field = [f"{fields[0][0]}+{mix}*({fields[1][0]})+{strain}*load*x",
                             f"{fields[0][1]}+{mix}*({fields[1][1]})-{nu * strain}*load*y"]  # fmt: skip
                    row = self.rows(square(field, material=material), "lattice.spacing=5e-4")[-1]
                    self.assertAlmostEqual(row["tip_T_star"], t_star, delta=0.008 + 0.02 * abs(t_star))
                    self.assertAlmostEqual(row["tip_T"] / size, t_star, delta=0.01 + 0.03 * abs(t_star))
                    k = math.hypot(row["tip_K1"], row["tip_K2"])
                    self.assertAlmostEqual(row["tip_T_star"] * k, row["tip_T"] * math.sqrt(math.pi * horizon), delta=1e-6 * k)

    def test_a_crack_in_an_endless_plate(self):
        """Pulled at an angle to the crack (Westergaard's functions): K_I, K_II and T = sigma cos(2 angle)."""
        a, stress, own = 0.025, 1e8, Elasticity(E, 1 / 3, True)
        k = own.kolosov
        # sqrt(z^2 - a^2) and z/sqrt(z^2 - a^2), cut along the crack from x = -2a to 0, whose middle is at -a.
        left, right = f"(x+{2 * a})", "x"
        size = f"sqrt(sqrt(({left}^2+y^2)*({right}^2+y^2)))"
        half = f"((atan2(y,{left})+atan2(y,{right}))/2)"
        root = (f"({size}*cos({half}))", f"({size}*sin({half}))")
        over = (f"(((x+{a})*cos({half})+y*sin({half}))/{size})", f"((y*cos({half})-(x+{a})*sin({half}))/{size})")
        for degrees in (90, 60, 30):
            angle = math.radians(degrees)
            one, two = stress * math.sin(angle) ** 2, stress * math.sin(angle) * math.cos(angle)
            t = stress * math.cos(2 * angle)
            unit = f"load/{2 * own.shear}"
            field = [
                f"{unit}*({one}*({(k - 1) / 2}*{root[0]}-y*{over[1]})+{two}*({(k + 1) / 2}*{root[1]}+y*{over[0]}))+{t / E}*load*x",
                f"{unit}*({one}*({(k + 1) / 2}*{root[1]}-y*{over[0]})+{two}*(-{(k - 1) / 2}*{root[0]}-y*{over[1]}))-{t / 3 / E}*load*y",
            ]
            with self.subTest(degrees):
                row = self.rows(square(field), "lattice.spacing=5e-4")[-1]
                full = stress * math.sqrt(math.pi * a)
                self.assertAlmostEqual(row["tip_K1"] / full, one / stress, delta=0.02)
                self.assertAlmostEqual(row["tip_K2"] / full, two / stress, delta=0.02)
                self.assertAlmostEqual(row["tip_T"] / stress, t / stress, delta=0.03)
                expected = t * math.sqrt(math.pi * 3.015 * 5e-4) / math.hypot(one, two) / math.sqrt(math.pi * a)
                self.assertAlmostEqual(row["tip_T_star"], expected, delta=0.01)

    def test_a_plate_under_tension(self):
        """As wide as high, with free sides: K_I and T of the boundary collocation of tests/reference/centre_crack.py, which
        has the handbook's K_I of a long plate and the T/K of Leevers and Radon (1982), -1 - 0.085 a/W."""
        for share in (0.1, 0.3, 0.5):
            k, t, error = centre_crack(share, 1, 2.5)
            handbook = (1 - 0.025 * share**2 + 0.06 * share**4) / math.sqrt(math.cos(math.pi * share / 2))
            self.assertLess(abs(k / handbook - 1) + error, 6e-3)
            k, t, error = centre_crack(share, 1, 1)
            self.assertLess(abs(t / k + 1 + 0.085 * share) + error, 6e-3)
        k, t, _ = centre_crack(0.3, 1, 1)
        text = """\
dimension = 2
[lattice]
spacing = 5e-4
thickness = 1e-3
[[lattice.shape]]
add = "box"
max = [0.03, 0.03]
min = [0, 0]
[[crack]]
from = [-9e-3, 0]
to = [9e-3, 0]
[material]
youngs_modulus = 200e9
calibration = "lattice"
[quadrature]
volume_correction = "linear"
surface_correction = "energy"
[[symmetry]]
axis = "x"
[[symmetry]]
axis = "y"
[[load]]
side = "y+"
depth = "horizon"
traction = [0, "1e7*load"]
[[crack_tip]]
name = "tip"
at = [9e-3, 0]
direction = [1, 0]
"""
        row = self.rows(text)[-1]
        # Measured 1.019 and 0.982: the horizon is a sixth of the crack's half.
        self.assertAlmostEqual(row["tip_K1"] / (1e7 * math.sqrt(math.pi * 9e-3)) / k, 1, delta=0.025)
        self.assertAlmostEqual(row["tip_T"] / 1e7 / t, 1, delta=0.025)
        self.assertAlmostEqual(row["tip_T_star"] / (t / k * math.sqrt(3.015 * 5e-4 / 9e-3)), 1, delta=0.04)

    def test_factors_do_not_depend_on_the_unit_of_length(self):
        """The same square scaled from 1 m to 1 mm and 1 km: at the same modulus J grows with the length, K with its
        root."""
        thin = Elasticity(E, 1 / 3, True)
        found = []
        for unit in (1.0, 1e3, 1e-3):
            fields = [williams(mode, thin.shear, thin.kolosov) for mode in (0, 1)]
            # Displacements scale with the lengths.
            field = [f"{unit}*({one}+0.5*({other})+1e-5*load*x*{axis == 0:d})" for axis, (one, other) in enumerate(zip(*fields))]
            field = [re.sub(r"\b([xy])\b", rf"(\1/{unit})", component) for component in field]
            text = square(field).replace("max(abs(x), abs(y)) > 0.017", f"max(abs(x), abs(y)) > {0.017 * unit}")
            for length in ("spacing = 1e-3", "thickness = 1e-3", "min = [-0.02, -0.02]", "max = [0.02, 0.02]", "from = [-0.03, 0]"):
                scaled = re.sub(r"-?\d[\d.e-]*", lambda number: repr(float(number.group()) * unit), length)
                self.assertIn(length, text)
                text = text.replace(length, scaled)
            row = self.rows(text)[-1]
            found.append((row["tip_J"] / unit, row["tip_K1"] / unit**0.5, row["tip_K2"] / unit**0.5, row["tip_T"]))
        for values in found[1:]:
            numpy.testing.assert_allclose(values, found[0], rtol=1e-8)

    def test_a_mixed_crack_with_a_negative_t_stress_is_warned_of_where_it_may_lock_to_rows(self):
        own, text = Elasticity(E, 1 / 3, True), {}
        fields = [williams(mode, own.shear, own.kolosov) for mode in (0, 1)]
        law = f'youngs_modulus = {E}\n[material.damage]\nlaw = "critical_stretch"\ncritical = 0.5'
        for name, mix, strain in (("mixed", 0.344, -2e-5), ("low", 0.344, -1e-6), ("positive", 0.344, 2e-5), ("opening", 0.01, -2e-5)):
            text[name] = square([f"{one}+{mix}*({two})+{strain}*load*({axis})" for one, two, axis in zip(*fields, ("x", "-y/3", "0"))],
                                material=law)  # fmt: skip
        for name, warns, *more in (
            ("mixed", True),
            ("low", False),
            ("positive", False),
            ("opening", False),
            ("mixed", False, 'material.damage={law="none"}'),
            ("mixed", False, 'lattice.points="blue_noise"'),
            ("mixed", True, "lattice.angle=18"),
        ):
            with self.subTest(name=name, more=more):
                row = self.rows(text[name], *more)[-1]
                told = json.loads((self.folder / "out/summary.json").read_text())["warnings"]
                told = [warning for warning in told if "locks to a row" in warning]
                self.assertEqual(len(told), warns, (row["tip_T_star"], told))
                if warns:
                    self.assertIn(f"T* = {row['tip_T_star']:.2g}", told[0])
                    self.assertIn("blue_noise", told[0])
                if name == "mixed":
                    self.assertLess(row["tip_T_star"], -0.1)

    def test_half_a_square_is_the_whole(self):
        thin = Elasticity(E, 1 / 3, True)
        field = williams(0, thin.shear, thin.kolosov)
        whole = self.rows(square(field), name="whole")[-1]
        half = self.rows(square(field, low=0, more=plane("y")), name="half")[-1]
        for name in ("J", "J_spread", "K1", "T"):
            self.assertAlmostEqual(half[f"tip_{name}"] / whole[f"tip_{name}"], 1, delta=1e-6, msg=name)
        self.assertEqual(half["tip_K2"], 0)

    def test_in_space(self):
        solid = Elasticity(E, 0.25, False)
        for mode, name in ((0, "K1"), (2, "K3")):
            with self.subTest(name):
                text = square(williams(mode, solid.shear, solid.kolosov), 3)
                row = self.rows(text, name=name)[-1]
                self.assert_same(row, self.by_reference(name, solid, (2 * 3.015e-3, 4 * 3.015e-3)))
                # Its sides are free; one period of a thick plate has the factors of plane strain.
                row = self.rows(text + '[[period]]\naxis = "z"\nfrom = 0\nto = 5e-3\n')[-1]
                self.assertAlmostEqual(row[f"tip_{name}"] / 1e6, 1, delta=0.06)

    def test_the_linear_solid_as_an_energy(self):
        """Its elasticity is that of E and nu in either plane state."""
        for nu, plane_state in ((0.1, "stress"), (0.4, "stress"), (0.1, "strain"), (0.4, "strain")):
            with self.subTest(nu=nu, plane=plane_state):
                own = Elasticity(E, nu, plane_state == "stress")
                material = f'model = "lps"\nyoungs_modulus = {E}\npoisson_ratio = {nu}\nplane = "{plane_state}"\n'
                material += '[quadrature]\nform = "energy"\nvolume_correction = "linear"'
                row = self.rows(square(williams(0, own.shear, own.kolosov), material=material), "lattice.spacing=5e-4")[-1]
                modulus = E if plane_state == "stress" else E / (1 - nu**2)
                self.assertAlmostEqual(row["tip_K1"] / 1e6, 1, delta=0.03)
                self.assertAlmostEqual(row["tip_J"] / (row["tip_K1"] ** 2 / modulus), 1, delta=0.03)

    def test_cpd(self):
        constants = {"c1": 1.2e22, "c2": 2e32}
        told = self.peristat("calibrate", "--dimension", 2, "--spacing", 1e-3, "--horizon-ratio", 3.015,
                             "--thickness", 1e-3, "--c1", constants["c1"], "--c2", constants["c2"]).json()["lattice"]  # fmt: skip
        thin = Elasticity(told["youngs_modulus"], told["poisson_ratio"], True)
        self.assertGreater(told["poisson_ratio"], 0.4)
        material = 'model = "cpd"\n' + "".join(f"{name} = {value}\n" for name, value in constants.items())
        row = self.rows(square(williams(0, thin.shear, thin.kolosov), material=material))[-1]
        self.assert_same(row, self.by_reference("out", thin, (2 * 3.015e-3, 4 * 3.015e-3)))
        self.assertAlmostEqual(row["tip_K1"] / 1e6, 1, delta=0.03)

    def test_a_cut_releases_what_j_says(self):
        """The rates are those of a crack that ends in the middle of the cut, at the same displacement or load."""
        text = (CASES / "three_point_bending/rollers.toml").read_text()
        half = 1.6e-3  # the horizon is 1.5e-3
        for at, cut, name in ((0.01 - half, 2 * half, "cut"), (0.01, 0, "middle")):
            shorter = text.replace("to = [0.0, 0.01]", f"to = [0.0, {at}]")
            tip = f'[[crack_tip]]\nname = "tip"\nat = [0, {at}]\ndirection = [0, 1]\n' + (f"cut = {cut}\n" if cut else "")
            row = self.rows(shorter + tip, name=name)[-1]
            if name == "cut":
                rates = row["tip_G_displacement"], row["tip_G_load"]
                load = row["reaction_y:load"]
        self.assertAlmostEqual(rates[0] / row["tip_J"], 1, delta=0.03)
        self.assertAlmostEqual(rates[1] / (row["tip_J"] * (load / row["reaction_y:load"]) ** 2), 1, delta=0.03)

    def test_a_cut_under_a_load_that_stays(self):
        """With loads only: both rates from the energies at the same load."""
        text = square(["0", "0"]).replace('where = "max(abs(x), abs(y)) > 0.017"', 'where = "x > 0.017"')
        text += '[[set]]\nname = "up"\nwhere = "x < -0.018 && y > 0"\n[[set]]\nname = "down"\nwhere = "x < -0.018 && y < 0"\n'
        text += "".join(f'[[load]]\nset = "{name}"\ntotal_force = [0, "{sign}*load"]\n' for name, sign in (("up", 1), ("down", -1)))
        half = 2e-3
        cut = self.rows(text + "", "crack_tip[0].cut=4e-3", "crack_tip[0].at=[-2e-3, 0]", "crack[0].to=[-2e-3, 0]", name="cut")[-1]
        middle = self.rows(text, name="middle")[-1]
        self.assertAlmostEqual(cut["tip_G_load"] / middle["tip_J"], 1, delta=0.03)
        longer = self.rows(text, f"crack[0].to=[{half}, 0]", f"crack_tip[0].at=[{half}, 0]", name="longer")[-1]
        released = longer["stored_energy"] - cut["stored_energy"]
        self.assertAlmostEqual(cut["tip_G_load"] / (released / (2 * half * 1e-3)), 1, delta=1e-6)

    def test_a_beam_on_rollers_has_the_factor_of_the_handbook(self):
        """ASTM E399; the horizon is 0.15 crack lengths."""
        text = (CASES / "three_point_bending/rollers.toml").read_text()
        row = self.rows(text + '[[crack_tip]]\nname = "tip"\nat = [0, 0.01]\ndirection = [0, 1]\n')[-1]
        a, width, span, thickness = 0.5, 0.02, 0.08, 0.01
        shape = 3 * a**0.5 * (1.99 - a * (1 - a) * (2.15 - 3.93 * a + 2.7 * a**2)) / (2 * (1 + 2 * a) * (1 - a) ** 1.5)
        expected = -row["reaction_y:load"] * span / (thickness * width**1.5) * shape
        self.assertAlmostEqual(row["tip_K1"] / expected, 1, delta=0.05)
        self.assertAlmostEqual(row["tip_K1"] / math.sqrt(E * row["tip_J"]), 1, delta=0.02)
        self.assertLess(row["tip_J_spread"], 0.01)

    def test_slips_are_told(self):
        field = williams(0, 75e9, 2)
        for words, told in (
            ("crack_tip[0].outer=0.0195", "meets the body's edge"),
            ("crack_tip[0].outer=0.018", "holds a point within the ring"),
            ("crack_tip[0].at=[0.012, 0]", "meets the body's edge"),
            ("crack_tip[0].inner=1e-3", "2 horizons"),
            ("crack_tip[0].outer=7e-3", "a horizon larger"),
            ("crack_tip[0].direction=[0, 0]", "zero"),
            ("crack_tip[0].front=[0, 0]", "dimension 3"),
            ("crack_tip[1]={name=\"tip\", at=[0,0], direction=[1,0]}", "has this name"),
            ("temperature={change=1}", "eigenstrains"),
            ("crack_tip[0].cut=1e-3", "at least a horizon"),
        ):
            with self.subTest(words):
                text = square(field, material=f"youngs_modulus = {E}\nthermal_expansion = 1e-5")
                self.assert_refused(self.command("check", text, words), told, "crack_tip")
        half = square(field, low=0, more=plane("y").replace("y", "x") + "at = -0.02\n")
        self.assert_refused(self.command("check", half.replace("at = [0, 0]", "at = [-0.008, 0.01]")))
