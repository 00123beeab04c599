#!/usr/bin/env python3
"""Iterations of conjugate gradients by preconditioner and number of MPI ranks.

    benchmarks/preconditioners_on_ranks.py [--side N] [--ranks 1,2,3,4,8] [--kinds NAME,...] [--program FILE]
    benchmarks/preconditioners_on_ranks.py --shipped

Bodies: a cube of N x N x N points (24), a bar of 8 x 8 x 240 points, and a plate of 120 x 120 with a slot half
through that no bond crosses. Each has three layers that are held at one end and three that are pulled at the
other, and is solved for one static step to 1e-8. With --shipped: shipped cases, some of them coarser or shorter,
with triangles, tetrahedra, pressures, planes of symmetry, periods and rigid sets.
"""

import argparse
import json
import os
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
KINDS = ("rigid_pieces", "surrogate", "multigrid", "riluk", "chebyshev", "block_jacobi")
CASE = """
dimension = {dimension}
[lattice]
spacing = 1.0
shape = [{shapes}]
layer = [{{ name = "held", side = "{axis}-" }}, {{ name = "moved", side = "{axis}+" }}]
[material]
youngs_modulus = 1e9
[[support]]
set = "held"
displacement = {held}
[[support]]
set = "moved"
displacement = {moved}
[loading]
steps = 1
[solver]
linear = "pcg"
linear_tolerance = 1e-8
relative_tolerance = 1e-8
"""


def box(action, low, high):
    return f'{{ {action} = "box", min = {list(low)}, max = {list(high)} }}'


def bodies(side):
    """Shapes and the axis along which each is pulled."""
    yield f"cube of {side}³", 3, [box("add", (0, 0, 0), (side,) * 3)]
    yield "bar of 8 × 8 × 240", 3, [box("add", (0, 0, 0), (8, 8, 240))]
    slot = box("subtract", (-1, 58), (60, 62))
    yield "slotted plate of 120²", 2, [box("add", (0, 0), (120, 120)), slot]


SHIPPED = {
    "cpd/square_hole": ("loading.steps=10",),
    "cpd/cube": ("loading.steps=5", "lattice.spacing=0.1", "material.c3=4e4"),
    "pressure/ring": (),
    "plate_with_hole/quarter": ("loading.steps=1",),
    "periodic/holes": ("loading.steps=1",),
    "compact_tension/pins": ("loading.steps=1",),
}


def iterations(program, case, kind, ranks, folder, settings=()):
    """Linear iterations of a run, or its message if it fails."""
    command = [program, "run", case, "--threads", "1", "--no-plots", "--overwrite", "--quiet",
               "--output", folder / "results"]
    for setting in ('solver.linear="pcg"', f'solver.preconditioner="{kind}"', *settings):
        command += ["--set", setting]
    if ranks > 1:
        command += ["--ranks", str(ranks)]
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                          check=False, env=os.environ | {"OMP_WAIT_POLICY": "passive"})
    if done.returncode != 0:
        return (done.stderr.strip().splitlines() or ["failed"])[-1][:40]
    return str(json.loads((folder / "results/summary.json").read_text())["linear_iterations"])


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("--side", type=int, default=24)
    parser.add_argument("--ranks", default="1,2,3,4,8")
    parser.add_argument("--kinds", default=",".join(KINDS))
    parser.add_argument("--shipped", action="store_true")
    parser.add_argument("--program", default=ROOT / "build/release/peristat")
    options = parser.parse_args()
    counts = [int(count) for count in options.ranks.split(",")]
    kinds = options.kinds.split(",")
    print("| body | preconditioner |", " | ".join(str(count) for count in counts), "|")
    print("|---|---" + "|---" * len(counts) + "|")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)

        def table(body, case, settings=()):
            for kind in kinds:
                found = [iterations(options.program, case, kind, count, folder, settings) for count in counts]
                print("|", body, "|", kind, "|", " | ".join(found), "|", flush=True)

        if options.shipped:
            for shipped, settings in SHIPPED.items():
                table(shipped, ROOT / f"cases/{shipped}.toml", settings)
            return
        case = folder / "body.toml"
        for body, dimension, shapes in bodies(options.side):
            still = ["0"] * (dimension - 1)
            case.write_text(CASE.format(
                dimension=dimension, shapes=", ".join(shapes), axis="xyz"[dimension - 1],
                held=[0] * dimension, moved=json.dumps([*still, "1e-3*load"])))
            table(body, case)


if __name__ == "__main__":
    main()
