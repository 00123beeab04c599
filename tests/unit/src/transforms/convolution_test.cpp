#include "src/transforms/convolution.hpp"

#include <vector>

#include <gtest/gtest.h>

#include "tests/bodies.hpp"

namespace peristat {
namespace {

using Axes = std::array<ConvolutionAxis, 3>;
using Parity = Convolution::Parity;

std::vector<KernelValue> random_kernel(const Axes& axes, Parity parity) {
  tests::Random random(6);
  std::vector<KernelValue> half;
  for (int x = -axes[0].reach; x <= axes[0].reach; ++x) {
    for (int y = -axes[1].reach; y <= axes[1].reach; ++y) {
      for (int z = -axes[2].reach; z <= axes[2].reach; ++z) {
        const std::array<int, 3> step{x, y, z}, origin{};
        const bool is_in = parity == Parity::even ? step >= origin : step > origin;
        if (is_in) half.push_back({step, random.number()});
      }
    }
  }
  return half;
}

TEST(Convolution, IsTheDirectSum) {
  const std::vector<Axes> boxes{
      Axes{{{1, 0}, {1, 0}, {11, 3}}},
      Axes{{{1, 0}, {8, 2}, {9, 4}}},
      Axes{{{5, 2}, {6, 1}, {7, 3}}},
      Axes{{{1, 0}, {9, 3, true}, {7, 2}}},
      Axes{{{1, 0}, {8, 3, true}, {5, 2, true}}},
      Axes{{{5, 2, true}, {6, 1}, {7, 3, true}}},
      Axes{{{1, 0}, {1, 0}, {4, 9, true}}},  // longer than its period: images add up
  };
  for (const Axes& axes : boxes) {
    for (const Parity parity : {Parity::even, Parity::odd}) {
      const Convolution convolution(axes, 2);
      const FourierTransform& transform = convolution.transform();
      const std::vector<KernelValue> half = random_kernel(axes, parity);
      ASSERT_FALSE(half.empty());
      const std::vector<double> kernel = convolution.amplitudes(half, parity);
      const auto [n0, n1, n2] = std::array{axes[0].count, axes[1].count, axes[2].count};
      const std::vector<double> b = tests::Random(8).vector(std::size_t(n0 * n1 * n2));
      std::vector<double> expected(b.size(), 0.0);
      const auto value_at = [&](std::array<int, 3> at) {
        for (std::size_t a = 0; a < 3; ++a) {
          const int count = axes[a].count;
          if (axes[a].is_periodic) at[a] = (at[a] % count + count) % count;
          if (at[a] < 0 || at[a] >= count) return 0.0;
        }
        return b[std::size_t((at[0] * n1 + at[1]) * n2 + at[2])];
      };
      fftw::Buffer field = transform.make_field();
      for (Index i = 0; i < n0; ++i) {
        for (Index j = 0; j < n1; ++j) {
          for (Index k = 0; k < n2; ++k) {
            const std::size_t place = std::size_t((i * n1 + j) * n2 + k);
            field.data()[transform.at(i, j, k)] = b[place];
            for (const auto& [step, value] : half) {
              // g(p) of a value p back, and g(-p) of one p ahead.
              expected[place] += value * value_at({i - step[0], j - step[1], k - step[2]});
              if (step == std::array<int, 3>{}) continue;
              const double turned = parity == Parity::even ? value : -value;
              expected[place] += turned * value_at({i + step[0], j + step[1], k + step[2]});
            }
          }
        }
      }
      transform.to_modes(field);
      for (std::size_t k = 0; k < transform.modes(); ++k) {
        const double real = field.data()[2 * k], imaginary = field.data()[2 * k + 1];
        field.data()[2 * k] = parity == Parity::even ? kernel[k] * real : -kernel[k] * imaginary;
        field.data()[2 * k + 1] = parity == Parity::even ? kernel[k] * imaginary : kernel[k] * real;
      }
      transform.to_places(field);
      for (std::size_t place = 0; place < b.size(); ++place) {
        const Index at = static_cast<Index>(place);
        EXPECT_NEAR(field.data()[transform.at(at / n2 / n1, at / n2 % n1, at % n2)],
                    expected[place], 1e-13 * tests::norm(expected));
      }
    }
  }
}

TEST(Convolution, IsPaddedOnOneSideToFastSizes) {
  EXPECT_EQ((ConvolutionAxis{100, 3}.size(false)), 104);
  EXPECT_EQ((ConvolutionAxis{94, 3}.size(false)), 98);  // 97 is prime
  EXPECT_EQ((ConvolutionAxis{22, 3}.size(false)), 25);
  EXPECT_EQ((ConvolutionAxis{22, 3}.size(true)), 26);  // even
  EXPECT_EQ((ConvolutionAxis{97, 3, true}.size(true)), 97);
  EXPECT_EQ((ConvolutionAxis{1, 0}.size(true)), 1);
}

TEST(Convolution, RefusesStepsBeyondItsReachAndOddKernelsWithAnOrigin) {
  const Convolution convolution(Axes{{{1, 0}, {5, 1}, {6, 2}}}, 1);
  const std::vector<KernelValue> far{{{0, 2, 0}, 1.0}}, origin{{{0, 0, 0}, 1.0}};
  EXPECT_THROW(static_cast<void>(convolution.amplitudes(far, Parity::even)), std::logic_error);
  EXPECT_THROW(static_cast<void>(convolution.amplitudes(origin, Parity::odd)), std::logic_error);
  EXPECT_EQ(convolution.amplitudes(origin, Parity::even).front(),
            1.0 / double(convolution.transform().places()));
}

}  // namespace
}  // namespace peristat
