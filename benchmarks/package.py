"""The package's two libraries compared with a native build, in turns: CPU seconds of whole runs on one thread,
and the median of their pairwise ratios.

    benchmarks/package.py PACKAGE.deb [--native PROGRAM] [--repetitions N]
"""

import argparse
import pathlib
import resource
import statistics
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[1]
JACOBI = ["solver.linear=pcg", "solver.preconditioner=jacobi"]
# Dominant parts of the run time: case, settings.
RUNS = {
    "products with bonds, 3D": ("cantilever/beam.toml", [*JACOBI, "solver.tangent=matrix_free", "loading.steps=1"]),
    "products with a stored tangent, 3D": ("cantilever/beam.toml", [*JACOBI, "solver.tangent=stored", "loading.steps=2"]),
    "relaxation with damage, 2D": ("plate_with_hole/square.toml", ["solver.mode=relaxation", "relaxation.steps=2"]),
    "triangles and tetrahedra, 3D": ("cpd/cube.toml", ["loading.steps=1"]),
    "Cholesky, 3D": ("cantilever/beam.toml", ["solver.linear=cholesky", "loading.steps=4"]),
}


def cpu_seconds(command, case, settings, folder):
    words = [*command, "run", ROOT / "cases" / case, "--quiet", "--overwrite", "--threads", "1", "--output", folder / "results"]
    words += [word for setting in settings for word in ("--set", setting)]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("package")
    parser.add_argument("--native", default=ROOT / "build/release/peristat")
    parser.add_argument("--repetitions", type=int, default=7)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="peristat_package_") as name:
        folder = pathlib.Path(name)
        subprocess.run(["dpkg", "-x", options.package, folder], check=True)
        packaged = folder / "usr/libexec/peristat/peristat"
        any_processor = ["env", "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2", packaged]  # hides AVX2 from the loader
        commands = {"native": [options.native], "AVX2": [packaged], "any": any_processor}
        print("| run | native, s | package, AVX2 | package, any processor | AVX2 / native | any / native |")
        print("|---|---|---|---|---|---|")
        for run, (case, settings) in RUNS.items():
            seconds = {library: [] for library in commands}
            for _ in range(options.repetitions):
                for library, command in commands.items():
                    seconds[library].append(cpu_seconds(command, case, settings, folder))
            ratio = lambda library: statistics.median(a / b for a, b in zip(seconds[library], seconds["native"]))
            medians = " | ".join(f"{statistics.median(values):.2f}" for values in seconds.values())
            print(f"| {run} | {medians} | {ratio('AVX2'):.3f} | {ratio('any'):.3f} |", flush=True)


if __name__ == "__main__":
    main()
