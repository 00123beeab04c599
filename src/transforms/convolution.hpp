#pragma once

#include <array>
#include <span>
#include <vector>

#include "src/transforms/fourier_transform.hpp"

namespace peristat {

/// An axis of a box of places, and how far a kernel reaches along it.
struct ConvolutionAxis {
  Index count = 1, reach = 0;
  bool is_periodic = false;

  /// Number of places that are transformed: `count` padded on one side by `reach` or more, so that
  /// no value sees itself around the box; on a periodic axis `count`.
  [[nodiscard]] Index size(bool is_last) const;
};

/// Value of a kernel at a step, counted in places.
struct KernelValue {
  std::array<int, 3> step{};
  double value = 0.0;
};

/// Sums over a box of places, [g * b](x) = sum_x' g(x - x') b(x'), as products of amplitudes: exact
/// to round-off, at a cost that does not depend on the number of values of g.
class Convolution {
 public:
  /// Symmetry of a kernel when the step is reversed: g(-p) = g(p), or -g(p). Amplitudes of even
  /// kernels are real and those of odd ones imaginary, so that each is kept as one number.
  enum class Parity { even, odd };

  Convolution(const std::array<ConvolutionAxis, 3>& axes, int threads);

  [[nodiscard]] const std::array<ConvolutionAxis, 3>& axes() const { return axes_; }
  [[nodiscard]] const FourierTransform& transform() const { return transform_; }

  /// Amplitudes of a kernel, divided by the number of places of the box: multiplied by those of a
  /// field and transformed back they give the convolution.
  /// @param half the kernel's values at one of each two opposite steps; the other one follows
  /// @throws std::logic_error for a step beyond the reach, or none in an odd kernel
  [[nodiscard]] std::vector<double> amplitudes(std::span<const KernelValue> half,
                                               Parity parity) const;

 private:
  std::array<ConvolutionAxis, 3> axes_;
  FourierTransform transform_;
};

}  // namespace peristat
