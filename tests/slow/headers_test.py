"""Headers are self-contained: each compiles without the includes of a source before it."""

import os
import re
import subprocess
import sysconfig
import unittest

from tests.unit.architecture_test import ROOT, in_parallel, sources


def first_of(file):
    """The header that a file begins with; none if it begins with one that is not ours."""
    first = re.search(r'^#include "(.*)"$|^#include <', file.read_text("utf-8"), re.MULTILINE)
    return ROOT / first.group(1) if first and first.group(1) else None


def leads_its_source(header):
    """Whether the build already compiles it alone, because its own source includes it first."""
    source = header.with_suffix(".cpp")
    return source.exists() and first_of(source) == header


def compile_alone(header):
    """The compiler's messages; empty if there are none."""
    name = header.relative_to(ROOT).as_posix()
    result = subprocess.run(
        [os.environ.get("PERISTAT_CXX", "c++"), "-std=c++20", "-fsyntax-only", "-fopenmp", "-I", ROOT, "-isystem", sysconfig.get_path("include")]
        + ['-DPERISTAT_SOURCE_DIR=""', "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wno-psabi", "-Werror", "-x", "c++", "-"],
        input=f'#include "{name}"\n',
        capture_output=True,
        text=True,
    )
    return result.stderr if result.returncode else ""


class Headers(unittest.TestCase):
    def test_every_header_compiles_alone(self):
        headers = sources(".hpp")
        proven = {first_of(path) for path in headers}  # by a header that begins with it and compiles alone
        headers = [path for path in headers if path not in proven and not leads_its_source(path)]
        self.assertGreater(len(headers), 50)
        wrong = in_parallel(compile_alone, headers)
        self.assertFalse(wrong, "\n".join(wrong))


if __name__ == "__main__":
    unittest.main()
