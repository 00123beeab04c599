"""Bodies of meshes beside lattices: ./peristat build && /usr/bin/python3 benchmarks/meshes.py

Prints two tables, in markdown.

1. The stress concentration at an elliptical hole (cases/mesh/elliptical_hole.toml) on meshes of Gmsh and on lattices,
   each refined twice, over Inglis' 1 + 2 a/b = 5 with the factor of Tan for the plate's width. "largest" is the largest
   stress of a point, without extrapolation: points stand half a spacing off the rim, and the layer of a horizon beside
   it is softer. "fitted" is the amplitude of Inglis' stresses along the axis from one to four horizons off the tip.
2. The moduli of a cube of tetrahedra: a layer of one horizon at its sides has the displacements of a homogeneous
   strain, and in the middle, two horizons off the sides, the mean stress is divided by the mean strain. The nominal
   E is 100 GPa and nu 1/4.

Gmsh is needed (Debian: gmsh); --quick leaves the second refinement out.
"""

import argparse
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))
from tests.reference.elliptical_hole import factor_of_width, fitted_concentration  # noqa: E402

PROGRAM = os.environ.get("PERISTAT_PROGRAM", str(ROOT / "build/release/peristat"))
GEO = ROOT / "cases/mesh/elliptical_hole.geo"
A, B, WIDTH, HEIGHT = 10e-3, 5e-3, 0.1, 0.15  # m
SIZES = (1.25e-3, 0.625e-3, 0.3125e-3)  # of elements, and spacings of lattices [m]
RATIO = 3.015
STRAIN = 1e-6
CUBE = """\
SetFactory("OpenCASCADE");
Box(1) = {0, 0, 0, 1, 1, 1};
Mesh.MeshSizeMin = h;
Mesh.MeshSizeMax = h;
Physical Volume("cube", 1) = {1};
"""
SOLID = """\
dimension = 3
[points]
file = "cube.msh"
horizon = HORIZON
[material]
youngs_modulus = 100e9
[[set]]
name = "rim"
where = "min(min(min(x, 1 - x), min(y, 1 - y)), min(z, 1 - z)) < HORIZON"
[[support]]
set = "rim"
displacement = [MOTION]
[solver]
linear = "cholesky"
[output]
stress = true
"""


def execute(folder: Path, *words) -> str:
    ended = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True)
    if ended.returncode != 0:
        sys.exit(f"{' '.join(map(str, words))}: {ended.stderr}")
    return ended.stdout


def last_step(folder: Path):
    """Positions, volumes, and stress and strain of the last step."""
    with h5py.File(folder / "results.h5") as file:
        step = file["steps"][max(file["steps"])]
        return tuple(of[...] for of in (file["points/reference"], file["points/volume"], step["stress"], step["strain"]))


def spacing_of(folder: Path, mesh: str) -> tuple[int, float]:
    said = execute(folder, PROGRAM, "points", mesh)
    return int(re.search(r"points +(\d+)", said)[1]), float(re.search(r"spacing +(\S+)", said)[1])


def lattice_case(spacing: float) -> str:
    angle = np.linspace(0.0, 2.0 * np.pi, 721)[:-1]
    vertices = ", ".join(f"[{A * np.cos(t)!r}, {B * np.sin(t)!r}]" for t in angle.tolist())
    text = (ROOT / "cases/mesh/elliptical_hole.toml").read_text()
    lattice = f"[lattice]\nspacing = {spacing!r}\nthickness = 1e-3\n"
    lattice += f'[[lattice.shape]]\nadd = "box"\nmin = [0, 0]\nmax = [{WIDTH / 2}, {HEIGHT / 2}]\n'
    lattice += f'[[lattice.shape]]\nsubtract = "polygon"\nvertices = [{vertices.replace("np.float64", "")}]\n'
    lattice += '[[set]]\nname = "ligament"\nwhere = "y < spacing"\n'
    text = re.sub(r"\[points\].*?\n\n", lattice + "\n", text, flags=re.DOTALL)
    return text.replace('set = "top" ', 'side = "y+"')


def concentrations(folder: Path, sizes) -> None:
    expected = (1 + 2 * A / B) * factor_of_width(A, B, WIDTH)
    print(f"expected: {expected:.3f}\n\n| body | points | spacing [mm] | largest | of 5 | fitted | of 5 |\n|---|---|---|---|---|---|---|")
    for body in ("mesh", "lattice"):
        for size in sizes:
            case = folder / "hole.toml"
            if body == "mesh":
                execute(folder, "gmsh", "-2", "-format", "msh41", "-setnumber", "h", size, GEO, "-o", "hole.msh")
                count, spacing = spacing_of(folder, "hole.msh")
                text = (ROOT / "cases/mesh/elliptical_hole.toml").read_text().replace("elliptical_hole.msh", "hole.msh")
                case.write_text(re.sub(r"horizon = \S+", f"horizon = {RATIO * spacing!r}", text))
            else:
                spacing = size
                case.write_text(lattice_case(spacing))
            execute(folder, PROGRAM, "run", case, "--output", folder / "out", "--overwrite", "--quiet")
            places, _, stress, _ = last_step(folder / "out")
            along = stress[:, 1] / 1e6 / factor_of_width(A, B, WIDTH)
            fitted = fitted_concentration(places, along, A, B, RATIO * spacing, spacing)
            values = " | ".join(f"{value:.3f} | {100 * (value / 5 - 1):+.1f} %" for value in (along.max(), fitted))
            print(f"| {body} | {len(places)} | {1e3 * spacing:.3f} | {values} |", flush=True)


def moduli(folder: Path) -> None:
    (folder / "cube.geo").write_text(CUBE)
    execute(folder, "gmsh", "-3", "-format", "msh41", "-setnumber", "h", 0.09, "cube.geo", "-o", "cube.msh")
    count, spacing = spacing_of(folder, "cube.msh")
    horizon = RATIO * spacing
    motions = {
        "Young's modulus": [f"{-STRAIN / 4}*x", f"{-STRAIN / 4}*y", f"{STRAIN}*z"],
        "bulk modulus": [f"{STRAIN}*{axis}" for axis in "xyz"],
        "shear modulus xy": [f"{STRAIN}*y", "0", "0"],
        "shear modulus yz": ["0", f"{STRAIN}*z", "0"],
    }
    print(f"\n{count} tetrahedra\n\n| | GPa | nominal | |\n|---|---|---|---|")
    for name, motion in motions.items():
        text = SOLID.replace("HORIZON", repr(horizon)).replace("MOTION", ", ".join(f'"({u})*load"' for u in motion))
        (folder / "cube.toml").write_text(text)
        execute(folder, PROGRAM, "run", "cube.toml", "--output", folder / "cube", "--overwrite", "--quiet")
        places, volume, stress, strain = last_step(folder / "cube")
        inside = ((places > 2 * horizon) & (places < 1 - 2 * horizon)).all(axis=1)
        sigma, epsilon = (np.average(of[inside], axis=0, weights=volume[inside]) for of in (stress, strain))
        value, nominal = {
            "Young's modulus": (sigma[2] / epsilon[2], 100e9),
            "bulk modulus": (sigma[:3].mean() / epsilon[:3].sum(), 100e9 / 1.5),
            "shear modulus xy": (sigma[3] / epsilon[3] / 2, 40e9),
            "shear modulus yz": (sigma[4] / epsilon[4] / 2, 40e9),
        }[name]
        print(f"| {name} | {value / 1e9:.2f} | {nominal / 1e9:.2f} | {100 * (value / nominal - 1):+.2f} % |", flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--quick", action="store_true")
    sizes = SIZES[:2] if parser.parse_args().quick else SIZES
    with tempfile.TemporaryDirectory() as name:
        concentrations(Path(name), sizes)
        moduli(Path(name))
