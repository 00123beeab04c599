"""A sample of the torture cases (tests/torture/torture.py); run all of them by hand."""

import tempfile
import unittest

from tests.torture.torture import torture


# The first 20; a step that ends with the jump (23); a piece that comes off with its support (106).
CASES = (*range(20), 23, 106)


class Torture(unittest.TestCase):
    def test_accepted_steps_of_random_cases_are_what_they_claim(self):
        said = []
        with tempfile.TemporaryDirectory(prefix="peristat_torture_") as keep:
            counts, failures = torture(1, CASES, keep, said.append)
        self.assertEqual(failures, {}, "\n".join(said))
        self.assertGreaterEqual(counts["judged"], 10, "\n".join(said))
        self.assertGreaterEqual(counts["exit 0"], 10, "\n".join(said))


if __name__ == "__main__":
    unittest.main()
