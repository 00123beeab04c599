"""Weibull's distribution of peaks: estimates against SciPy's, intervals against their definition."""

import pathlib
import sys
import unittest

import numpy as np
import scipy.stats

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[3] / "cases/runner/sweep"))

from ensemble import Sample, size_effect  # noqa: E402
from weibull import fit_weibull, likeliest, median_ranks  # noqa: E402


class Weibull(unittest.TestCase):
    def test_estimates_are_the_likeliest(self):
        for count, modulus in ((5, 1.5), (40, 12.0), (300, 60.0)):
            values = 3e6 * np.random.default_rng(count).weibull(modulus, count)
            shape, _, scale = scipy.stats.weibull_min.fit(values / 3e6, floc=0)
            found = fit_weibull(values)
            np.testing.assert_allclose([found.modulus, found.scale / 3e6], [shape, scale], rtol=1e-3)

    def test_intervals_contain_the_truth_as_often_as_they_say(self):
        generator, runs = np.random.default_rng(7), 150
        samples = [fit_weibull(2.0 * generator.weibull(8.0, 20)) for _ in range(runs)]
        moduli = sum(of.modulus_ends[0] <= 8.0 <= of.modulus_ends[1] for of in samples)
        scales = sum(of.scale_ends[0] <= 2.0 <= of.scale_ends[1] for of in samples)
        for hits in (moduli, scales):
            self.assertGreater(scipy.stats.binom.cdf(hits, runs, 0.95), 1e-3)
            self.assertGreater(scipy.stats.binom.sf(hits - 1, runs, 0.95), 1e-3)

    def test_powers_do_not_overflow(self):
        (modulus,), (scale,) = likeliest(1e200 * (1.0 + 1e-6 * np.arange(10.0))[None, :])
        self.assertTrue(np.isfinite([modulus, scale]).all())

    def test_median_ranks_are_near_the_medians_of_order_statistics(self):
        for k, rank in enumerate(median_ranks(20), 1):
            self.assertAlmostEqual(rank, scipy.stats.beta(k, 21 - k).median(), delta=1e-3)

    def test_the_weakest_of_many_links_gives_the_modulus_by_sizes(self):
        generator = np.random.default_rng(5)
        samples = []
        for links in (1, 10, 100):
            peaks = generator.weibull(6.0, (400, links)).min(axis=1)
            samples.append(Sample((), peaks, 400, float(links), fit_weibull(peaks)))
        effect = size_effect(samples)
        self.assertLess(abs(effect.exponent + 1.0 / 6.0), 3.0 * effect.error)
        self.assertLess(effect.error, 0.004)
        self.assertIsNone(size_effect(samples[:1]))
        self.assertIsNone(size_effect([samples[0], samples[0]]))


if __name__ == "__main__":
    unittest.main()
