"""Headers are self-contained: each compiles without the includes of a source before it."""

import os
import re
import subprocess
import unittest

from tests.unit.architecture_test import ROOT, in_parallel, sources


def leads_its_source(header):
    """Whether the build already compiles it alone, because its own source includes it first."""
    source = header.with_suffix(".cpp")
    if not source.exists():
        return False
    first = re.search(r'^#include "(.*)"$|^#include <', source.read_text("utf-8"), re.MULTILINE)
    return first is not None and first.group(1) == header.relative_to(ROOT).as_posix()


def compile_alone(header):
    """The compiler's messages; empty if there are none."""
    name = header.relative_to(ROOT).as_posix()
    result = subprocess.run(
        [os.environ.get("PERISTAT_CXX", "c++"), "-std=c++20", "-fsyntax-only", "-fopenmp", "-I", ROOT]
        + ['-DPERISTAT_SOURCE_DIR=""', "-Wall", "-Wextra", "-Wpedantic", "-Wshadow", "-Wno-psabi", "-Werror", "-x", "c++", "-"],
        input=f'#include "{name}"\n',
        capture_output=True,
        text=True,
    )
    return result.stderr if result.returncode else ""


class Headers(unittest.TestCase):
    def test_every_header_compiles_alone(self):
        headers = [path for path in sources(".hpp") if not leads_its_source(path)]
        wrong = in_parallel(compile_alone, headers)
        self.assertFalse(wrong, "\n".join(wrong))


if __name__ == "__main__":
    unittest.main()
