#include "src/transforms/trigonometric_transform.hpp"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "src/transforms/good_size.hpp"
#include "tests/bodies.hpp"

namespace peristat {
namespace {

constexpr RowEnd ends[] = {RowEnd::free, RowEnd::held};

/// The modes as the header tells them.
double mode(const TransformAxis& axis, Index j, Index i) {
  const double phase = axis.wave_number(j) * (double(i) + 0.5);
  return axis.below == RowEnd::free ? std::cos(phase) : std::sin(phase);
}

TEST(TrigonometricTransform, ModesAreThoseThatAreTold) {
  // A mode has an amplitude of its own alone, for all ends, odd and even counts, and one place.
  for (const Index count : {1, 2, 7, 12}) {
    for (const RowEnd below : ends) {
      for (const RowEnd above : ends) {
        const std::vector<TransformAxis> axes{{count, below, above}};
        TrigonometricTransform transform(axes, 1);
        for (Index j = 0; j < count; ++j) {
          for (Index i = 0; i < count; ++i) transform.values()[i] = mode(axes[0], j, i);
          transform.to_modes();
          for (Index k = 0; k < count; ++k) {
            if (k == j) {
              EXPECT_GE(std::abs(transform.values()[k]), 0.9 * count);
            } else {
              EXPECT_NEAR(transform.values()[k], 0.0, 1e-12 * count);
            }
          }
        }
      }
    }
  }
}

TEST(TrigonometricTransform, ThereAndBackMultipliesByItsFactor) {
  const std::vector<std::vector<TransformAxis>> boxes{
      {{9, RowEnd::held, RowEnd::free}},
      {{6, RowEnd::free, RowEnd::free}, {5, RowEnd::held, RowEnd::held}},
      {{4, RowEnd::free, RowEnd::held},
       {3, RowEnd::free, RowEnd::free},
       {8, RowEnd::held, RowEnd::held}}};
  for (const auto& axes : boxes) {
    std::vector<double> first;
    for (const int threads : {1, 2}) {
      TrigonometricTransform transform(axes, threads);
      for (const double value : transform.values()) EXPECT_EQ(value, 0.0);
      const std::vector<double> from = tests::Random(5).vector(transform.count());
      std::copy(from.begin(), from.end(), transform.values().begin());
      transform.to_modes();
      const std::vector<double> modes(transform.values().begin(), transform.values().end());
      EXPECT_GT(tests::distance(modes, from), 0.1 * tests::norm(from));
      if (first.empty()) first = modes;
      EXPECT_EQ(modes, first);
      transform.to_places();
      for (std::size_t k = 0; k < from.size(); ++k) {
        EXPECT_NEAR(transform.values()[k], transform.factor() * from[k],
                    1e-14 * transform.factor());
      }
    }
  }
}

TEST(TrigonometricTransform, TheLastAxisIsTheFastest) {
  const std::vector<TransformAxis> axes{{4, RowEnd::held, RowEnd::held},
                                        {6, RowEnd::free, RowEnd::held}};
  TrigonometricTransform transform(axes, 1);
  for (Index i = 0; i < 4; ++i) {
    for (Index k = 0; k < 6; ++k) {
      transform.values()[i * 6 + k] = mode(axes[0], 2, i) * mode(axes[1], 3, k);
    }
  }
  transform.to_modes();
  for (Index place = 0; place < 24; ++place) {
    if (place == 2 * 6 + 3) {
      EXPECT_GE(std::abs(transform.values()[place]), 20.0);
    } else {
      EXPECT_NEAR(transform.values()[place], 0.0, 1e-12);
    }
  }
}

TEST(TrigonometricTransform, SpringsBetweenNeighboursAreDiagonal) {
  // u_i+1 - u_i with the mirror images that the ends stand for: 2 - 2 cos k times the mode.
  for (const RowEnd below : ends) {
    for (const RowEnd above : ends) {
      const TransformAxis axis{10, below, above};
      for (Index j = 0; j < axis.count; ++j) {
        for (Index i = 0; i < axis.count; ++i) {
          const double here = mode(axis, j, i);
          const auto image = [&](RowEnd end) { return end == RowEnd::free ? here : -here; };
          const double before = i > 0 ? mode(axis, j, i - 1) : image(below);
          const double after = i + 1 < axis.count ? mode(axis, j, i + 1) : image(above);
          EXPECT_NEAR(2.0 * here - before - after,
                      (2.0 - 2.0 * std::cos(axis.wave_number(j))) * here, 1e-13);
        }
      }
    }
  }
}

TEST(TrigonometricTransform, ManyLinesOfAllAxesAreTransformed) {
  // More lines than a batch has, with a rest: against sums over the modes.
  const std::vector<TransformAxis> axes{{19, RowEnd::held, RowEnd::free},
                                        {3, RowEnd::free, RowEnd::free},
                                        {37, RowEnd::held, RowEnd::held}};
  TrigonometricTransform transform(axes, 2);
  const std::vector<double> amplitudes = tests::Random(9).vector(3);
  const std::vector<std::array<Index, 3>> modes{{18, 2, 0}, {0, 0, 36}, {7, 1, 20}};
  for (Index place = 0; place < 19 * 3 * 37; ++place) {
    const Index i = place / 37 / 3, j = place / 37 % 3, k = place % 37;
    for (std::size_t m = 0; m < 3; ++m) {
      transform.values()[place] += amplitudes[m] * mode(axes[0], modes[m][0], i) *
                                   mode(axes[1], modes[m][1], j) * mode(axes[2], modes[m][2], k);
    }
  }
  transform.to_modes();
  std::vector<Index> found;
  for (Index place = 0; place < 19 * 3 * 37; ++place) {
    if (std::abs(transform.values()[place]) > 1e-9) found.push_back(place);
  }
  EXPECT_EQ(found, (std::vector<Index>{36, (7 * 3 + 1) * 37 + 20, (18 * 3 + 2) * 37}));
}

TEST(GoodSize, HasSmallPrimeFactorsAlone) {
  EXPECT_EQ(good_size(1), 1);
  EXPECT_EQ(good_size(17), 18);
  EXPECT_EQ(good_size(997), 1000);
  EXPECT_EQ(good_size(1000), 1000);
  for (Index n = 20; n < 3000; n += 7) EXPECT_LE(good_size(n), n + n / 16) << n;
}

TEST(TrigonometricTransform, RefusesABoxWithoutPlaces) {
  const std::vector<TransformAxis> axes{{4}, {0}};
  EXPECT_THROW(TrigonometricTransform(axes, 1), std::logic_error);
}

}  // namespace
}  // namespace peristat
