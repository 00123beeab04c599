"""A short run of the fuzzer (tests/fuzz/fuzz.py), always with the same inputs; run more by hand."""

import tempfile
import time
import unittest

from tests.fuzz.fuzz import CORPUS, fuzz
from tests.reference.program import peristat

INPUTS = 160  # about 40 seconds of processor time


class Fuzz(unittest.TestCase):
    def test_what_inputs_start_from_is_right(self):
        cases = sorted(CORPUS.glob("*.toml"))
        self.assertGreater(len(cases), 4)
        for case in cases:
            run = peristat("check", case)
            self.assertEqual(run.code, 0, run.said)

    def test_no_input_gets_more_than_an_answer(self):
        said = []
        with tempfile.TemporaryDirectory(prefix="peristat_fuzz_") as keep:
            tried, findings = fuzz(1, range(INPUTS), keep, time.monotonic() + 600, said.append)
        self.assertEqual(findings, {}, "\n".join(said))
        self.assertGreaterEqual(sum(tried.values()), INPUTS / 2, "the machine is too slow to try much")
        for kind in ("case", "set", "points", "calibrate", "plot"):
            self.assertGreater(tried[kind], 0, kind)


if __name__ == "__main__":
    unittest.main()
