"""Compliance of notched specimens compared with ASTM E399: on ideal rollers, on clamped platens, on rotating pins.

  ./peristat build && /usr/bin/python3 benchmarks/specimens.py
"""

import csv
import pathlib
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
PROGRAM = ROOT / "build/release/peristat"
E, THICKNESS = 200e9, 0.01


def bend_compliance(width=0.02, span=0.08, crack=0.01):
    """Mouth opening over load of a bend specimen, S = 4 W (E399; Tada, Paris and Irwin)."""
    a = crack / width
    shape = 0.76 - 2.28 * a + 3.87 * a**2 - 2.04 * a**3 + 0.66 / (1 - a) ** 2
    stress_per_load = 1.5 * span / (THICKNESS * width**2)
    return 4 * stress_per_load * crack / E * shape


def tension_compliance(a=0.5):
    """Mouth opening over load of a compact-tension specimen at its edge (E399; Saxena and Hudak 1978)."""
    polynomial = 1.6137 + 12.678 * a - 14.231 * a**2 - 16.610 * a**3 + 35.050 * a**4 - 14.494 * a**5
    return (1 + 0.25 / a) * ((1 + a) / (1 - a)) ** 2 * polynomial / (E * THICKNESS)


def run(text, **settings):
    with tempfile.TemporaryDirectory() as folder:
        case = pathlib.Path(folder) / "case.toml"
        case.write_text(text)
        words = [word for key, value in settings.items() for word in ("--set", f"{key.replace('__', '.')}={value}")]
        subprocess.run([PROGRAM, "run", case, "--quiet", "--no-plots", "--output", f"{folder}/out", *words], check=True)
        with open(f"{folder}/out/history.csv", newline="") as table:
            return {key: float(value) for key, value in list(csv.DictReader(table))[-1].items() if key != "mode"}


def on_platens(text):
    """Clamped rows of 4 mm under the body, in place of its rollers."""
    platens = {"left": "y-|abs(x+0.04) < 0.002", "right": "y-|abs(x-0.04) < 0.002", "load": "y+|abs(x) < 0.002"}
    layers = "".join(f'[[lattice.layer]]\nname = "{name}"\nside = "{place.split("|")[0]}"\nwhere = "{place.split("|")[1]}"\n'
                     for name, place in platens.items())  # fmt: skip
    supports = "".join(f'[[support]]\nset = "{name}"\ndisplacement = ["{"free" if name != "load" else 0}", "{"-1e-6*load" if name == "load" else 0}"]\n' for name in platens)
    start, end = text.index("[[roller]]"), text.index("[[probe]]")
    text = text[:start] + supports + text[end:]
    return text.replace("[[set]]", layers + "[[set]]", 1)


def main():
    beam = (ROOT / "cases/three_point_bending/rollers.toml").read_text()
    print("| specimen | W / spacing | mouth opening over load, over E399 |\n|---|---|---|")
    for spacing in (1e-3, 5e-4, 2.5e-4):
        scaled = beam.replace("5e-4 &&", f"{spacing} &&").replace("-5e-4", f"-{spacing}").replace("y < 5e-4", f"y < {spacing}")
        for name, text, loaded in (("beam on rollers", scaled, "load"), ("beam on clamped platens", on_platens(scaled), "load")):
            row = run(text, lattice__spacing=spacing)
            print(f"| {name} | {0.02 / spacing:g} | {row['mouth_x'] / -row[f'reaction_y:{loaded}'] / bend_compliance():.4f} |")
    tension = (ROOT / "cases/compact_tension/pins.toml").read_text()
    for spacing in (1e-3, 5e-4):
        text = tension.replace("y < 5e-4", f"y < {spacing}").replace("y > -5e-4", f"y > -{spacing}").replace("-0.0095", f"{-0.010 + spacing}")
        row = run(text, lattice__spacing=spacing)
        print(f"| compact tension on pins | {0.04 / spacing:g} | {row['mouth_y'] / row['reaction_y:upper'] / tension_compliance():.4f} |")


if __name__ == "__main__":
    main()
