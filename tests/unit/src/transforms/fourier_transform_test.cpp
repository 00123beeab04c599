#include "src/transforms/fourier_transform.hpp"

#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

using Size = std::array<Index, 3>;

/// Random values, in a field with rows as the transform wants them.
fftw::Buffer random_field(const FourierTransform& transform, std::uint64_t seed) {
  fftw::Buffer field = transform.make_field();
  const std::vector<double> values = tests::Random(seed).vector(transform.places());
  const auto [n0, n1, n2] = transform.size();
  std::size_t next = 0;
  for (Index i = 0; i < n0; ++i) {
    for (Index j = 0; j < n1; ++j) {
      for (Index k = 0; k < n2; ++k) field.data()[transform.at(i, j, k)] = values[next++];
    }
  }
  return field;
}

TEST(FourierTransform, IsTheSumThatItIsToldToBe) {
  for (const Size& size : {Size{1, 1, 9}, Size{1, 6, 5}, Size{5, 1, 4}, Size{4, 3, 6}}) {
    const FourierTransform transform(size, 2);
    fftw::Buffer field = random_field(transform, 3);
    const std::vector<double> values(field.values().begin(), field.values().end());
    transform.to_modes(field);
    const auto [n0, n1, n2] = size;
    for (Index a = 0; a < n0; ++a) {
      for (Index b = 0; b < n1; ++b) {
        for (Index c = 0; c < transform.row_modes(); ++c) {
          std::complex<double> sum = 0.0;
          for (Index i = 0; i < n0; ++i) {
            for (Index j = 0; j < n1; ++j) {
              for (Index k = 0; k < n2; ++k) {
                const double phase = -2.0 * std::numbers::pi *
                                     (double(a * i) / n0 + double(b * j) / n1 + double(c * k) / n2);
                sum += values[transform.at(i, j, k)] * std::polar(1.0, phase);
              }
            }
          }
          const double* const found = field.data() + transform.at(a, b, 0) + 2 * c;
          EXPECT_NEAR(found[0], sum.real(), 1e-12);
          EXPECT_NEAR(found[1], sum.imag(), 1e-12);
        }
      }
    }
  }
}

TEST(FourierTransform, ThereAndBackMultipliesByThePlacesOnAnyNumberOfThreads) {
  for (const Size& size : {Size{1, 1, 64}, Size{1, 35, 18}, Size{20, 21, 22}}) {
    std::vector<double> first;
    for (const int threads : {1, 2, 3}) {
      const FourierTransform transform(size, threads);
      fftw::Buffer field = random_field(transform, 4);
      const fftw::Buffer values = random_field(transform, 4);
      transform.to_modes(field);
      const std::vector<double> modes(field.values().begin(), field.values().end());
      if (first.empty()) first = modes;
      EXPECT_EQ(modes, first) << threads;
      transform.to_places(field);
      const auto [n0, n1, n2] = size;
      for (Index i = 0; i < n0; ++i) {
        for (Index j = 0; j < n1; ++j) {
          for (Index k = 0; k < n2; ++k) {
            const std::size_t at = transform.at(i, j, k);
            EXPECT_NEAR(field.data()[at], double(transform.places()) * values.data()[at],
                        1e-13 * double(transform.places()));
          }
        }
      }
    }
  }
}

TEST(FourierTransform, RefusesABoxWithoutPlaces) {
  EXPECT_THROW(FourierTransform({1, 0, 4}, 1), std::logic_error);
}

}  // namespace
}  // namespace peristat
