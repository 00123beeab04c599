"""Writes elliptical_hole.inp, elliptical_hole.vtu and elliptical_hole_half.vtu from meshes of Gmsh."""

import subprocess

import meshio

geo = "elliptical_hole.geo"
subprocess.run(["gmsh", "-2", "-format", "msh41", geo, "-o", "elliptical_hole.msh"], check=True)
mesh = meshio.read("elliptical_hole.msh")
sets = {name: of for name, of in mesh.cell_sets.items() if not name.startswith("gmsh:")}
mesh.cell_sets = {name: [elements.astype(int) for elements in of] for name, of in sets.items()}
mesh.write("elliptical_hole.inp")
groups = {"group": mesh.cell_data["gmsh:physical"]}
meshio.Mesh(mesh.points, mesh.cells, cell_data=groups).write("elliptical_hole.vtu")
half = [*"-setnumber half 1 -setnumber height 40e-3 -setnumber h 1e-3".split()]
subprocess.run(["gmsh", "-2", "-format", "msh41", *half, geo, "-o", "half.msh"], check=True)
mesh = meshio.read("half.msh")
groups = {"group": mesh.cell_data["gmsh:physical"]}
meshio.Mesh(mesh.points, mesh.cells, cell_data=groups).write("elliptical_hole_half.vtu")
