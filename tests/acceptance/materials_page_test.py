"""docs/materials.md: its tables are accepted, and its numbers follow from its formulas."""

import re
import tomllib
import unittest

from tests.acceptance.folder import Folder
from tests.reference.program import ROOT

PAGE = (ROOT / "docs/materials.md").read_text()
# A body of a few points, on a lattice that is fine enough for every material's strength.
BODY = """
dimension = {dimension}

[lattice]
spacing = {spacing!r}

[[lattice.shape]]
add = "box"
min = {low}
max = {high}

[[lattice.layer]]
name = "held"
side = "x-"

[[support]]
set = "held"
displacement = {still}

"""


def sheets():
    """Name, text of the table, and K_Ic [Pa m^0.5] or None with Poisson's ratio."""
    for name, text in re.findall(r"^### (.+?)\n.*?```toml\n(.*?)```", PAGE, re.DOTALL | re.MULTILINE):
        toughness, poisson = re.search(r"K_Ic = ([\d.]+)", text), re.search(r"nu = ([\d.]+)", text)
        yield name, text, toughness and float(toughness[1]) * 1e6, float(poisson[1])


def row(name):
    """Cells of the overview table."""
    line = next(line for line in PAGE.splitlines() if line.startswith(f"| [{name}]"))
    return [cell.strip() for cell in line.strip("|").split("|")][1:]


class MaterialsPage(Folder):
    def test_has_a_dozen_materials_with_all_that_a_sheet_has(self):
        names = [name for name, *_ in sheets()]
        self.assertGreaterEqual(len(names), 12)
        self.assertEqual(len(names), PAGE.count("[material]  "))
        for name, text, _, _ in sheets():
            with self.subTest(name):
                tables = tomllib.loads(text)
                self.assertEqual(set(tables["material"]), {"youngs_modulus", "density", "thermal_expansion", "damage"})
                self.assertEqual(set(tables["material"]["damage"]), {"law", "fracture_energy", "strength"})

    def test_every_table_is_accepted(self):
        for name, text, _, _ in sheets():
            largest = float(row(name)[-1]) * 1e-3
            for dimension in (2, 3):
                with self.subTest(name, dimension=dimension):
                    size = largest / 4
                    body = BODY.format(dimension=dimension, spacing=size, low=[0.0] * dimension,
                                       high=[8 * size, 6 * size, 4 * size][:dimension], still=[0.0] * dimension)  # fmt: skip
                    run = self.assert_completed(self.command("check", body + text))
                    told = re.search(r"fracture energy (\S+) J/m2.*strength (\S+) Pa", run.output)
                    material = tomllib.loads(text)["material"]["damage"]
                    self.assertAlmostEqual(float(told[1]) / material["fracture_energy"], 1.0, delta=1e-5)  # as printed
                    self.assertAlmostEqual(float(told[2]) / material["strength"], 1.0, delta=1e-5)

    def test_fracture_energies_are_those_of_the_toughness(self):
        counted = 0
        for name, text, toughness, poisson in sheets():
            material = tomllib.loads(text)["material"]
            if toughness is None:
                continue
            with self.subTest(name):
                energy = toughness**2 * (1 - poisson**2) / material["youngs_modulus"]
                self.assertAlmostEqual(material["damage"]["fracture_energy"] / energy, 1.0, delta=5e-3)  # three digits
                counted += 1
        self.assertGreater(counted, 10)

    def test_the_overview_has_the_numbers_of_the_tables(self):
        for name, text, toughness, poisson in sheets():
            with self.subTest(name):
                material = tomllib.loads(text)["material"]
                damage = material["damage"]
                modulus, nu, of_toughness, strength, energy, length, spacing = row(name)
                self.assertEqual(float(modulus) * 1e9, material["youngs_modulus"])
                self.assertEqual(float(nu), poisson)
                self.assertEqual(float(of_toughness) * 1e6 if of_toughness else None, toughness)
                self.assertAlmostEqual(float(strength) * 1e6, damage["strength"], delta=1.0)
                self.assertEqual(float(energy), damage["fracture_energy"])
                run = self.peristat("calibrate", "--model", "bond", "--dimension", 2, "--spacing", "1e-6",
                                    "--horizon-ratio", 3.015, "--youngs-modulus", material["youngs_modulus"],
                                    "--law", "linear", "--fracture-energy", damage["fracture_energy"],
                                    "--strength", damage["strength"])  # fmt: skip
                told = run.json()["damage"]
                self.assertEqual(f"{told['characteristic_length'] * 1e3:.3g}", length)
                self.assertEqual(f"{told['largest_spacing'] * 1e3:.3g}", spacing)


if __name__ == "__main__":
    unittest.main()
