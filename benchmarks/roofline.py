#!/usr/bin/env python3
"""Passes over bonds beside what the machine can do at best: flops and bytes per bond, and the share of DGEMM and STREAM.

    ./peristat bench --roofline [--picture FILE.svg] [--store FILE.json] [--against FILE.json]

Runs the passes over bonds, DGEMM and the STREAM triad on one thread, in turns, and prints a row for each pass. Flops are
those of the code, a square root and a division counting as one each, for harmonic bonds. Bytes are what has to come
from memory at least if neighbours stay in a cache: lists and blocks of bonds, and the vectors of points over the bonds of a
point. `--store` writes each pass's rate over those of DGEMM and STREAM. `--against` compares with such a file and ends with
exit code 1 if a pass has lost more than a tenth in both ratios. The file holds for one kind of processor.
"""

import argparse
import json
import pathlib
import sys

from run import measure

ROOT = pathlib.Path(__file__).resolve().parents[1]
LARGEST_LOSS = 0.1
BONDS_PER_POINT = {2: 14, 3: 61}  # unique, horizon 3.015 spacings

# Pass: flops per bond, bytes per bond, vectors of a point that are read or written; by dimension d.
ALONG_ROWS = 6 / 128  # of the list, read once for a piece
PASSES = {
    "energy": (lambda d: 8 * d + 14, lambda d: ALONG_ROWS, 6),
    "gradient": (lambda d: 11 * d + 16, lambda d: ALONG_ROWS, 12),
    "matrix_free_product": (lambda d: 11 * d + 10, lambda d: ALONG_ROWS, 12),
    "listed_energy": (lambda d: 9 * d + 16, lambda d: 6, 4),
    "listed_gradient": (lambda d: 12 * d + 16, lambda d: 6, 8),
    "listed_product": (lambda d: 15 * d + 7, lambda d: 6, 8),
    "stored_product": (lambda d: 4 * d * d, lambda d: 4 + 8 * d * (d + 1) / 2, 4),
}


class Point:
    """A pass on the roofline."""

    def __init__(self, name, dimension, rate):
        flops, bytes_of_bond, vectors = PASSES[name]
        self.name, self.dimension, self.rate = name, dimension, rate
        self.flops = flops(dimension)
        self.bytes = bytes_of_bond(dimension) + 8 * dimension * vectors / BONDS_PER_POINT[dimension]

    def __str__(self):
        return f"{self.name.replace('_', ' ')}, {self.dimension}D"

    @property
    def intensity(self):
        return self.flops / self.bytes


def points_of(rates):
    for name in PASSES:
        for dimension in BONDS_PER_POINT:
            yield Point(name, dimension, rates[f"{name}/{dimension}"])


def print_table(rates, points):
    dgemm, triad = rates["dgemm"], rates["stream_triad"]
    print(f"DGEMM {dgemm / 1e9:.1f} GF/s, STREAM triad {triad / 1e9:.1f} GB/s, one thread\n")
    print("| pass | flops per bond | bytes per bond | M bonds/s | GF/s | of DGEMM | GB/s | of STREAM |\n|---|---|---|---|---|---|---|---|")
    for point in points:
        flops, moved = point.rate * point.flops, point.rate * point.bytes
        print(f"| {point} | {point.flops} | {point.bytes:.1f} | {point.rate / 1e6:.1f} | {flops / 1e9:.2f} | {flops / dgemm:.0%} "
              f"| {moved / 1e9:.2f} | {moved / triad:.0%} |")  # fmt: skip


def draw(rates, points, file):
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    from matplotlib.ticker import ScalarFormatter

    dgemm, triad = rates["dgemm"] / 1e9, rates["stream_triad"] / 1e9
    figure, axes = pyplot.subplots(figsize=(9, 4.8), layout="constrained")
    low, corner, high = 0.3, dgemm / triad, 40
    axes.plot([low, corner, high], [triad * low, dgemm, dgemm], color="black", label="DGEMM and STREAM triad")
    kinds = {"energy": "tab:green", "gradient": "tab:blue", "product": "tab:red"}
    for point in points:
        color = kinds[point.name.split("_")[-1]]
        kind = "hollow" if point.name.startswith("listed") else "stored" if point.name.startswith("stored") else "full"
        axes.plot(point.intensity, point.rate * point.flops / 1e9, "os"[point.dimension - 2], label=str(point),
                  color=color, markersize=9, fillstyle={"hollow": "none", "stored": "bottom", "full": "full"}[kind])  # fmt: skip
    axes.set_xscale("log")
    axes.set_yscale("log")
    for axis in (axes.xaxis, axes.yaxis):
        for number in (axis.set_major_formatter, axis.set_minor_formatter):
            number(ScalarFormatter())
    axes.set_xticks([0.3, 1, 3, 10, 30])
    axes.set_yticks([number for number in (1, 2, 5, 10, 20, 50, 100) if number < 1.2 * dgemm])
    axes.minorticks_off()
    axes.grid(alpha=0.3)
    axes.set_xlabel("flops per byte that has to come from memory")
    axes.set_ylabel("GF/s on one thread")
    axes.set_title("Passes over bonds: full along rows of a lattice, hollow bond by bond")
    axes.legend(loc="center left", bbox_to_anchor=(1.01, 0.5), fontsize=8)
    figure.savefig(file)


def ratios(rates, points):
    return {str(point): [point.rate / rates["dgemm"], point.rate / rates["stream_triad"]] for point in points}


def losses(now, before):
    """Passes that are slower by more than LARGEST_LOSS beside DGEMM and beside STREAM, with the smaller loss."""
    for name, old in before.items():
        if name not in now:
            yield name, 1.0
            continue
        lost = min(1 - new / stored for new, stored in zip(now[name], old))
        if lost > LARGEST_LOSS:
            yield name, lost


def stored_ratios(file):
    """Those of an earlier run, read before anything is measured."""
    try:
        before = json.loads(file.read_text())
        if all(len(pair) == 2 and all(ratio > 0 for ratio in pair) for pair in before.values()):
            return before
    except (OSError, ValueError, AttributeError, TypeError) as error:
        raise ValueError(f"{file}: cannot be read: {error}") from None
    raise ValueError(f"{file}: needs two ratios above 0 for each pass, as --store writes them")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--picture", type=pathlib.Path)
    parser.add_argument("--store", type=pathlib.Path)
    parser.add_argument("--against", type=pathlib.Path)
    asked = parser.parse_args()
    try:
        before = stored_ratios(asked.against) if asked.against else {}
    except ValueError as error:
        parser.error(str(error))
    program = ROOT / "build/release/peristat_bench"
    rates = measure(program, 1, [f"--benchmark_filter=^(dgemm|stream_triad|{'|'.join(PASSES)})(/|$)"])
    points = list(points_of(rates))
    print_table(rates, points)
    if asked.picture:
        draw(rates, points, asked.picture)
    now = ratios(rates, points)
    if asked.store:
        asked.store.write_text(json.dumps(now, indent=1) + "\n")
    lost = list(losses(now, before))
    for name, share in lost:
        print(f"{name}: {share:.0%} slower beside DGEMM and STREAM than in {asked.against}", file=sys.stderr)
    return 1 if lost else 0


if __name__ == "__main__":
    sys.exit(main())
