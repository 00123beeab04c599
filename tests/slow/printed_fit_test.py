"""The fit of docs/fit.md: the case, the data and the command of the page, from its printed values on."""

import json
import sys
import unittest

from tests.acceptance.folder import Folder
from tests.printed.fences import blocks, cases, lines
from tests.printed.page import numbers
from tests.reference.program import ROOT

FIT = ROOT / "cases" / "runner" / "fit" / "fit.py"  # reads PERISTAT_PROGRAM, as this test does
PAGE = ROOT / "docs" / "fit.md"
VALUES = "finds a Young's modulus of {} ± {} GPa, a fracture energy of {} ± {} J/m² and a strength of {} ± {} MPa"
UNITS = ("GPa", "J/m2", "MPa")


class Printed(Folder):
    def test_the_beam_of_concrete(self):
        self.write("concrete_beam.toml", cases(PAGE)["concrete_beam.toml"])
        (data,) = (block.text for block in blocks(PAGE) if block.language == "csv")
        self.write("concrete_beam.csv", data)
        words = next(words for words in lines(PAGE) if "concrete_beam.toml" in words)
        printed = numbers("docs/fit.md", VALUES)
        keys = words[words.index("--over") + 1].split(",")
        starts = [f"--start={key}={number.text} {unit}" for key, number, unit in zip(keys, printed[::2], UNITS, strict=True)]
        ended = self.execute([sys.executable, "-BEs", FIT, *words[2:], *starts, "--threads", "1", "--output", "out"])
        self.assert_completed(ended)
        found = json.loads((self.folder / "out/fit.json").read_text())
        # Searches end at a relative step of 3e-4; derivatives, and so the deviations, depend on the place by some per cent.
        for each, value, deviation in zip(found["parameters"], printed[::2], printed[1::2], strict=True):
            self.assertLess(abs(each["value"] - value.value), value.rounding + 2e-3 * each["value"], each["key"])
            self.assertLess(abs(each["standard_deviation"] - deviation.value), deviation.rounding + 0.05 * deviation.value, each["key"])
        (residual,) = numbers("docs/fit.md", "stays within {} standard deviations of the data")
        self.assertLess(abs(found["specimens"][0]["root_mean_square"] - residual.value), residual.rounding)
        correlations = [abs(value) for k, row in enumerate(found["correlation"]) for value in row[:k]]
        (largest,) = numbers("docs/fit.md", "hence correlations below {}.")
        self.assertLess(max(correlations), largest.value)


if __name__ == "__main__":
    unittest.main()
