"""The comparison of a page with a run."""

import unittest

from tests.printed.page import numbers


class PrintedTest(unittest.TestCase):
    """Compares values with the numbers that `self.page` has at the {} of a phrase."""

    page = ""

    def prints(self, phrase, *values, page=None, within=None):
        """The tolerance is half a unit of the last printed digit, because a result repeats itself to round-off.
        `within` widens it to a share of the number; say where the share comes from.
        """
        page = page or self.page
        printed = numbers(page, phrase)
        self.assertEqual(len(printed), len(values), phrase)
        for number, value in zip(printed, values):
            tolerance = max(number.rounding, (within or 0.0) * abs(number.value))
            told = f'{page}: "{phrase}" prints {number.text}, the run gives {value:.8g}'
            self.assertLessEqual(abs(number.value - value), tolerance * (1 + 1e-9), told)

    def prints_range(self, phrase, *values, page=None):
        """The phrase has two numbers, and all values lie between them (to their rounding)."""
        low, high = numbers(page or self.page, phrase)
        self.assertTrue(values)
        for value in values:
            told = f'{page or self.page}: "{phrase}" prints {low.text} to {high.text}, the run gives {value:.8g}'
            self.assertGreaterEqual(value, low.value - low.rounding, told)
            self.assertLessEqual(value, high.value + high.rounding, told)
