"""Bodies of all kinds on several MPI ranks are those of one."""

import unittest

import h5py

from tests.acceptance.on_ranks import PLATE, ROOT, Comparison, objects, rows


class Bodies(Comparison):
    """Shipped cases, coarser, and small bodies: what they are made of is the same on all ranks."""

    def compare_shipped(self, case, *settings, ranks=(2, 3)):
        text = (ROOT / "cases" / f"{case}.toml").read_text()
        words = ('solver.linear="pcg"', 'solver.preconditioner="block_jacobi"', "solver.linear_tolerance=1e-9", *settings)
        options = [word for setting in words for word in ("--set", setting)]
        one = self.results(1, text, *options)
        for count in ranks:
            several = self.results(count, text, *options)
            with self.subTest(case=case, ranks=count):
                self.expect_same(one, several)
                self.expect_same_iterations(one, several)
        return one

    def compare_settings(self, text, *settings, ranks=(3,)):
        with self.subTest(settings=settings):
            return self.compare(text, ranks, *(word for setting in settings for word in ("--set", setting)))

    def test_several_materials(self):
        self.compare_shipped("regions/bimaterial", "lattice.spacing=0.01")
        # A third solution would be of round-off, with as many iterations as that gives.
        self.compare_shipped("regions/composite", "lattice.spacing=1e-3", "solver.relative_tolerance=1e-7")

    def test_interfaces_and_random_fields(self):
        two = ('region=[{set="corner", material={youngs_modulus=1e8, scatter=[{of="stiffness", distribution="weibull", '
               'weibull_modulus=5, correlation_length=0.2, seed=3}]}}]',)  # fmt: skip
        one = self.compare_settings(PLATE, *two, 'interface=[{between=["corner", "material"], rule="arithmetic"}]')
        with h5py.File(one / "results.h5") as file:
            self.assertIn("stiffness_factor", "".join(objects(file)))
        self.compare_settings(PLATE, *two, 'interface=[{between=["corner", "material"], material={youngs_modulus=5e8}}]')

    def test_influences_shares_and_shapes(self):
        self.compare_settings(PLATE, 'material.influence="gaussian"', 'material.calibration="lattice"',
                              'quadrature.volume_correction="exact"', 'quadrature.surface_correction="energy"')  # fmt: skip
        self.compare_settings(PLATE, 'quadrature.horizon_shape="box"', 'quadrature.surface_correction="energy"')
        self.compare_settings(PLATE, 'material.potential="harmonic"', 'quadrature.volume_correction="exact_centroids"')

    def test_lattices(self):
        self.compare_settings(PLATE, "lattice.angle=20", 'quadrature.surface_correction="volume"', ranks=(2, 3))
        self.compare_settings(PLATE, "lattice.angle=20", 'lattice.volumes="fractional"',
                              'quadrature.volume_correction="linear"', ranks=(2, 4))  # fmt: skip
        self.compare_settings(PLATE, "lattice.cell_perturbation=0.2", 'quadrature.volume_correction="exact"')

    def test_points_from_a_file(self):
        rows = ["x, y, volume, set"]
        for k in range(20):
            for j in range(9):
                name = "bottom" if k < 3 else "top" if k > 16 else ""
                rows.append(f"{0.05*j + 0.01*((7*k + 3*j) % 5)}, {0.05*k + 0.004*((5*k + j) % 7)}, {2.5e-5*(1 + 0.1*(k % 3))}, {name}")
        rows[1:] = rows[:0:-1]
        (self.folder / "points.csv").write_text("\n".join(rows))
        text = PLATE.split("[lattice]")[0] + '[points]\nfile = "points.csv"\nthickness = 0.01\nhorizon = 0.16\n' + \
            "[[set]]\nname = \"corner\"\nwhere = \"x > 0.2 && y > 0.5\"\n[material]" + PLATE.split("[material]")[1]
        self.compare_settings(text, 'quadrature.volume_correction="linear"', ranks=(2, 3))

    def test_loads(self):
        side = 'load=[{side="x+", traction=["1e5*load*y", "2e5"]}]'
        self.compare_settings(PLATE, side, ranks=(2, 3))
        self.compare_settings(PLATE, side.replace('"2e5"]', '"2e5"], depth="horizon"'))
        self.compare_settings(PLATE, 'set=[{name="corner", where="y > 1.45 && y < 1.5"}]', 'load=[{set="corner", traction=["1e5*load", "0"]}]')

    def test_temperatures(self):
        case = (ROOT / "cases/thermal/bimetal.toml").read_text()
        held = '[[support]]\nset = "steel"\ndisplacement = [0, "free"]\n[[support]]\nset = "middle"\ndisplacement = ["free", 0]\n[[support]]\nset = "tip"\ndisplacement = [0, "free"]\n'
        case = case.split("[[symmetry]]")[0] + held + "[[probe]]" + case.split("[[probe]]")[1]
        case = case.replace("0.04", "0.02").replace("spacing = 1e-4", "spacing = 5e-4")
        one = self.compare(case, (2, 3), "--set", "loading.table=[0, 1, 0.5]")
        self.assertGreater(float(rows(one, "history.csv")[0]["max_stretch"]), 1e-4)
        self.compare_settings(PLATE, 'eigenstrain=[{set="corner", strain="0.01*load*x"}]')


if __name__ == "__main__":
    unittest.main()
