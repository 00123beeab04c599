#include "src/materials/random_field.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <numbers>

#include "src/core/counter_random.hpp"

namespace peristat {
namespace {

/// The quantile of Weibull's distribution.
/// @param below, above probabilities of smaller and of larger values; each keeps its digits
double quantile(double below, double above, const WeibullField& field) {
  const double exponent = below < 0.5 ? -std::log1p(-below) : -std::log(above);
  return std::pow(exponent, 1.0 / field.modulus) / std::tgamma(1.0 + 1.0 / field.modulus);
}

/// A standard normal number, of two uniform ones (Box and Muller).
double normal(std::uint64_t seed, std::uint64_t counter) {
  const double radius = std::sqrt(-2.0 * std::log(open_unit(random_bits(seed, 2 * counter))));
  return radius * std::cos(2.0 * std::numbers::pi * open_unit(random_bits(seed, 2 * counter + 1)));
}

struct Mode {
  Coordinates wave{};
  double phase = 0.0;
};

std::vector<Mode> modes_of(const WeibullField& field, int dimension) {
  constexpr int numbers_per_mode = 4;  // the same modes, whatever the dimension
  std::vector<Mode> modes(fourier_modes);
  for (std::size_t n = 0; n < modes.size(); ++n) {
    for (int c = 0; c < dimension; ++c) {
      modes[n].wave[c] = std::numbers::sqrt2 / field.correlation_length *
                         normal(field.seed, numbers_per_mode * n + c);
    }
    modes[n].phase =
        2.0 * std::numbers::pi * open_unit(random_bits(field.seed, 2 * (numbers_per_mode * n + 3)));
  }
  return modes;
}

double gaussian(const std::vector<Mode>& modes, const Coordinates& at) {
  double sum = 0.0;
  for (const auto& [wave, phase] : modes) {
    sum += std::cos(wave[0] * at[0] + wave[1] * at[1] + wave[2] * at[2] + phase);
  }
  return std::sqrt(2.0 / double(modes.size())) * sum;
}

/// Uniform number that depends on the seed and the place alone.
double uniform(std::uint64_t seed, const Coordinates& at) {
  std::uint64_t bits = scattered(seed);
  for (const double component : at) {
    // Adding 0 makes both signs of zero the same.
    bits = random_bits(bits, std::bit_cast<std::uint64_t>(component + 0.0));
  }
  return open_unit(bits);
}

}  // namespace

std::vector<double> values_at(const Points& points, const WeibullField& field, int threads) {
  const bool is_correlated = field.correlation_length > 0.0;
  const std::vector<Mode> modes =
      is_correlated ? modes_of(field, points.dimension) : std::vector<Mode>();
  std::vector<double> values(points.volume.size());
#pragma omp parallel for num_threads(threads)
  for (Index i = 0; i < points.count(); ++i) {
    const Coordinates at = points.position(i);
    double below = 0.0, above = 0.0;
    if (is_correlated) {
      const double g = gaussian(modes, at) / std::numbers::sqrt2;
      below = 0.5 * std::erfc(-g);
      above = 0.5 * std::erfc(g);
    } else {
      below = uniform(field.seed, at);
      above = 1.0 - below;
    }
    values[std::size_t(i)] = quantile(below, above, field);
  }
  return values;
}

}  // namespace peristat
