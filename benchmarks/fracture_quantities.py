"""J, K and G of notched bodies over those of handbooks, for two or three horizons.

  ./peristat build && /usr/bin/python3 -m benchmarks.fracture_quantities [SPECIMEN ...]

References: E399; Tada, Paris and Irwin; Isida in Murakami's handbook; NAFEMS R0020 test 1.1.
"""

import csv
import math
import pathlib
import subprocess
import sys
import tempfile

from tests.reference.program import PROGRAM

E, B = 200e9, 0.01
A = 0.01  # crack length of most specimens [m]
HEAD = """\
dimension = 2
[lattice]
spacing = {spacing}
thickness = 0.01
[material]
plane = "{plane}"
youngs_modulus = {modulus}
calibration = "lattice"
[quadrature]
surface_correction = "energy"
volume_correction = "linear"
"""


def box(low, high):
    return f'[[lattice.shape]]\nadd = "box"\nmin = {list(low)}\nmax = {list(high)}\n'


def crack(start, end):
    return f"[[crack]]\nfrom = {list(start)}\nto = {list(end)}\n"


def tip(at, direction, name="tip", more=""):
    return f'[[crack_tip]]\nname = "{name}"\nat = {list(at)}\ndirection = {list(direction)}\n{more}'


def plane(axis):
    return f'[[symmetry]]\naxis = "{axis}"\n'


def pulled(stress):
    return f'[[load]]\nside = "y+"\ntraction = [0, "{stress}*load"]\n'


def head(spacing, modulus=E, state="stress"):
    return HEAD.format(spacing=spacing, modulus=modulus, plane=state)


def run(text):
    with tempfile.TemporaryDirectory() as folder:
        case = pathlib.Path(folder) / "case.toml"
        case.write_text(text)
        subprocess.run([PROGRAM, "run", case, "--quiet", "--no-plots", "--output", f"{folder}/out"], check=True)
        with open(f"{folder}/out/history.csv", newline="") as table:
            return {key: float(value) for key, value in list(csv.DictReader(table))[-1].items() if key != "mode"}


def bend(spacing, length=A, cut=""):
    """Three-point bend specimen, W = 2 a, S = 4 W, on rollers."""
    width, span = 0.02, 0.08
    rollers = "".join(
        f'[[roller]]\nname = "{name}"\nat = {at}\nnormal = {normal}\n' + (f'displacement = "{moved}"\n' if moved else "")
        for name, at, normal, moved in (("left", [-0.04, 0.0], [0, 1], ""), ("right", [0.04, 0.0], [0, 1], ""),
                                        ("load", [0.0, 0.02], [0, 1], "-1e-6*load"), ("middle", [0.0, 0.02], [1, 0], "")))  # fmt: skip
    text = head(spacing) + box((-0.045, 0), (0.045, width)) + crack((0, -0.01), (0, length)) + rollers + tip((0, length), (0, 1), more=cut)
    row = run(text)
    a = length / width
    shape = 3 * a**0.5 * (1.99 - a * (1 - a) * (2.15 - 3.93 * a + 2.7 * a**2)) / (2 * (1 + 2 * a) * (1 - a) ** 1.5)
    return row, -row["reaction_y:load"] * span / (B * width**1.5) * shape, 0.0


def tension(spacing, length=A, cut=""):
    """Compact tension specimen, W = 2 a, its upper half."""
    width = 0.02
    text = head(spacing) + box((-0.005, 0), (width, 0.012)) + plane("y") + crack((-0.006, 0), (length, 0))
    text += f'[[lattice.shape]]\nsubtract = "disk"\ncentre = [0, 0.0055]\nradius = 0.0025\n'
    text += f'[[set]]\nname = "pin"\nwhere = "y > 0.0055 && sqrt(x^2+(y-0.0055)^2) < 0.0025+1.5*{spacing}"\n'
    text += '[[load]]\nset = "pin"\ntotal_force = [0, "1e3*load"]\n'
    text += f'[[set]]\nname = "far"\nwhere = "x > {width} - spacing"\n[[constraint]]\nname = "held"\n[[constraint.term]]\nset = "far"\nweights = [1, 0]\n'
    row = run(text + tip((length, 0), (1, 0), more=cut))
    a = length / width
    shape = (2 + a) * (0.886 + 4.64 * a - 13.32 * a**2 + 14.72 * a**3 - 5.6 * a**4) / (1 - a) ** 1.5
    return row, 1e3 / (B * math.sqrt(width)) * shape, 0.0


def centre(spacing, length=A, cut=""):
    """Centre crack 2 a in a square of half width and half height W = 2 a, a quarter; Tada's formula, 0.1 %."""
    width, stress = 0.02, 1e6
    text = head(spacing) + box((0, 0), (width, 0.06)) + plane("x") + plane("y") + crack((-0.001, 0), (length, 0)) + pulled(stress)
    a = length / width
    shape = (1 - 0.025 * a**2 + 0.06 * a**4) * math.sqrt(1 / math.cos(math.pi * a / 2))
    return run(text + tip((length, 0), (1, 0), more=cut)), stress * math.sqrt(math.pi * length) * shape, 0.0


def nafems(spacing, length=A, cut=""):
    """NAFEMS R0020 test 1.1: 40 x 40 mm, 2 a = 20 mm, 100 MPa, plane strain, J = 2.425 N/mm with E = 207 GPa and
    nu = 0.3. The bonds have nu = 1/4, and E is chosen for the same E/(1 - nu2)."""
    stress, plane_modulus = 100e6, 207e9 / (1 - 0.09)
    text = head(spacing, plane_modulus * (1 - 1 / 16), "strain") + box((0, 0), (0.02, 0.02)) + plane("x") + plane("y")
    text += crack((-0.001, 0), (length, 0)) + pulled(stress)
    return run(text + tip((length, 0), (1, 0), more=cut)), math.sqrt(2425 * plane_modulus), 0.0


def cantilevers(spacing, length=4 * A, cut=""):
    """Double cantilever, arms of 10 mm and a = 40 mm, its upper half; G = 12 P2 (a + 0.64 h)2 / (B2 h3 E)."""
    height, force = 0.01, 100
    text = head(spacing) + box((0, 0), (0.09, height)) + plane("y") + crack((-0.001, 0), (length, 0))
    text += f'[[set]]\nname = "end"\nwhere = "x < spacing"\n[[load]]\nset = "end"\ntotal_force = [0, "{force}*load"]\n'
    text += '[[set]]\nname = "far"\nwhere = "x > 0.09 - spacing"\n[[constraint]]\nname = "held"\n[[constraint.term]]\nset = "far"\nweights = [1, 0]\n'
    released = 12 * force**2 * (length + 0.64 * height) ** 2 / (B**2 * height**3 * E)
    return run(text + tip((length, 0), (1, 0), more=cut)), math.sqrt(released * E), 0.0


def inclined(spacing, length=A, cut=""):
    """Crack 2 a at 45 degrees between the diagonals of the lattice, in a plate ten times as large under tension:
    K_I = K_II = s sqrt(pi a)/2 of the infinite plate."""
    stress, half = 1e6, 0.1
    end, shift = length / math.sqrt(2), spacing / 2
    text = head(spacing) + box((-half, -half), (half, half)) + crack((-end, -end + shift), (end, end + shift))
    text += pulled(stress) + f'[[load]]\nside = "y-"\ntraction = [0, "-{stress}*load"]\n'
    for name, where in (("right", f"x > {half} - spacing"), ("left", f"x < spacing - {half}")):
        text += f'[[set]]\nname = "{name}"\nwhere = "{where}"\n'
    for name, terms in (("x", (("right", [1, 0]), ("left", [1, 0]))), ("y", (("right", [0, 1]), ("left", [0, 1]))),
                        ("turn", (("right", [0, 1]), ("left", [0, -1])))):  # fmt: skip
        text += f'[[constraint]]\nname = "held_{name}"\n'
        text += "".join(f'[[constraint.term]]\nset = "{set}"\nweights = {weights}\n' for set, weights in terms)
    single = stress * math.sqrt(math.pi * length) / 2
    return run(text + tip((end, end + shift), (1, 1), more=cut)), single, single


SPECIMENS = {"three-point bend": bend, "compact tension": tension, "centre crack": centre, "NAFEMS 1.1": nafems,
             "double cantilever": cantilevers, "inclined crack": inclined}  # fmt: skip


def release(specimen, spacing, length):
    """G from a cut of one and a half horizons over J at the middle of the cut; fixed supports or fixed loads, as the
    specimen has."""
    cut = 1.5 * 3.015 * spacing
    row, *_ = specimen(spacing, length, f"cut = {cut}\n")
    # The middle of the cut. The inclined crack has two tips that move with its length, and is cut at one of them.
    middle, *_ = specimen(spacing, length + cut / (4 if specimen is inclined else 2))
    kind = "displacement" if specimen is bend else "load"
    return row[f"tip_G_{kind}"] / middle["tip_J"]


def main():
    print("| specimen | horizon / a | K_I | K_II | J | spread of J | G by a cut, over J |\n|---|---|---|---|---|---|---|")
    for name in sys.argv[1:] or SPECIMENS:
        specimen = SPECIMENS[name]
        length = 4 * A if specimen is cantilevers else A
        for spacing in (1e-3 / 3, 1e-3 / 6, 1e-3 / 12)[: 1 if specimen is inclined else 3]:
            row, first, second = specimen(spacing)
            modulus = E if specimen is not nafems else 207e9 / (1 - 0.09)
            expected = (first**2 + second**2) / modulus
            k2 = f"{row['tip_K2'] / second:.4f}" if second else f"{abs(row['tip_K2']) / first:.0e} of K_I"
            print(f"| {name} | {3.015 * spacing / A:.2f} | {row['tip_K1'] / first:.4f} | {k2} | {row['tip_J'] / expected:.4f} | "
                  f"{row['tip_J_spread']:.4f} | {release(specimen, spacing, length):.4f} |", flush=True)  # fmt: skip


if __name__ == "__main__":
    main()
