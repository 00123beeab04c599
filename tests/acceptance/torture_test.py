"""A sample of the torture cases (tests/torture/torture.py); all of them are run by hand."""

import tempfile
import unittest

from tests.torture.torture import torture


class Torture(unittest.TestCase):
    def test_accepted_steps_of_random_cases_are_what_they_claim(self):
        said = []
        with tempfile.TemporaryDirectory(prefix="peristat_torture_") as keep:
            counts, failures = torture(1, range(20), keep, said.append)
        self.assertEqual(failures, {}, "\n".join(said))
        self.assertGreaterEqual(counts["judged"], 10, "\n".join(said))
        self.assertGreaterEqual(counts["exit 0"], 10, "\n".join(said))


if __name__ == "__main__":
    unittest.main()
