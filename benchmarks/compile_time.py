#!/usr/bin/env python3
"""Compile time: seconds of processor time of each object of a release build in a temporary folder.

    benchmarks/compile_time.py [CMAKE OPTION]...     e.g. -DPERISTAT_TOGETHER=OFF

Prints the sum, the minutes that passed on all processors, and the longest objects. Compare builds on a
quiet machine: processor time grows by half if other work runs at the same time.
"""

import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LOG = "PERISTAT_COMPILE_LOG"


def compile_one(command):
    """Runs a compiler and records its time; CMake puts this file as the launcher before each compiler call."""
    child = os.spawnvp(os.P_NOWAIT, command[0], command)
    _, status, used = os.wait4(child, 0)
    if "-o" in command:
        with open(os.environ[LOG], "a") as log:
            log.write(f"{used.ru_utime + used.ru_stime} {command[command.index('-o') + 1]}\n")
    return os.waitstatus_to_exitcode(status)


def build(options):
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder, "compile.log")
        launcher = f"{sys.executable};-BES;{Path(__file__).resolve()};--one"
        environment = os.environ | {LOG: str(log)}
        configure = ["cmake", "-G", "Ninja", "-S", ROOT, "-B", folder, "-DCMAKE_BUILD_TYPE=Release", "-DPERISTAT_TESTS=OFF"]
        configure += [f"-DCMAKE_CXX_COMPILER_LAUNCHER={launcher}", *options]
        subprocess.run(configure, env=environment, check=True, stdout=subprocess.DEVNULL)
        log.write_text("")  # drops the entries of the configuration, which compiles, too
        began = time.monotonic()
        subprocess.run(["cmake", "--build", folder], env=environment, check=True, stdout=subprocess.DEVNULL)
        passed = time.monotonic() - began
        objects = sorted((line.split() for line in log.read_text().splitlines()), key=lambda words: -float(words[0]))
    print(f"{' '.join(options) or 'default'}: {len(objects)} objects, {sum(float(words[0]) for words in objects):.0f} s of processor time,"
          f" {passed / 60:.1f} min on {os.cpu_count()} processors")  # fmt: skip
    for seconds, name in objects[:12]:
        print(f"{float(seconds):6.1f} s  {name.split('.dir/', 1)[-1].removesuffix('.o')}")


if __name__ == "__main__":
    if sys.argv[1:2] == ["--one"]:
        sys.exit(compile_one(sys.argv[2:]))
    build(sys.argv[1:])
