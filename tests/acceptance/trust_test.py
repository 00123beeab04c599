"""The suite of known answers, by the coarsest lattice of two of its entries."""

import os
import re
import subprocess
import tempfile
import unittest
from pathlib import Path

from tests.reference.program import PROGRAM, ROOT


class Trust(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="peristat_trust_")
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def trust(self, *words):
        command = ["/usr/bin/python3", "-BEs", ROOT / "cases/runner/trust/trust.py", *map(str, words), "--output", self.folder]
        return subprocess.run(command, capture_output=True, text=True, env=os.environ | {"PERISTAT_PROGRAM": str(PROGRAM)})

    def test_a_steady_crack_resists_with_what_it_was_given(self):
        """A law whose force falls linearly: within 2 % of G_c; and nothing is run twice."""
        ended = self.trust("surfing", "--quick", "--threads", 1)
        self.assertEqual(ended.returncode, 0, ended.stdout + ended.stderr)
        value = float(re.search(r"surfing h1_m3.015_0: ([0-9.]+) of the reference", ended.stdout)[1])
        self.assertAlmostEqual(value, 1, delta=0.02)
        self.assertIn("| pass |", (self.folder / "table.md").read_text())
        again = self.trust("surfing", "--quick", "--threads", 1)
        self.assertIn(", 0 s", again.stdout)

    def test_a_coarse_beam_is_red(self):
        """20 spacings are too few for a peak within 2 %: it says so, with exit code 3."""
        ended = self.trust("senb_05", "--quick", "--threads", 1)
        self.assertEqual(ended.returncode, 3, ended.stdout + ended.stderr)
        self.assertIn("**red**", (self.folder / "table.md").read_text())

    def test_bad_input(self):
        ended = self.trust("surfing", "--threads", 0)
        self.assertEqual(ended.returncode, 2)
        self.assertIn("argument --threads", ended.stderr)
        self.folder /= "a file"
        self.folder.write_text("")
        ended = self.trust("surfing", "--quick")
        self.assertEqual(ended.returncode, 5)
        self.assertIn("a file", ended.stderr)
        self.assertNotIn("Traceback", ended.stderr)

    def test_no_such_entry(self):
        ended = self.trust("nonsense")
        self.assertEqual(ended.returncode, 2)
        self.assertIn("no entry nonsense; there are surfing", ended.stderr)


if __name__ == "__main__":
    unittest.main()
