#pragma once

#include <array>
#include <span>
#include <vector>

#include "src/transforms/fourier_transform.hpp"

namespace peristat {

/// A row of places that values stand on, and how far a kernel reaches along it.
struct ConvolutionAxis {
  Index count = 1, reach = 0;
  bool is_periodic = false;

  /// Places that are transformed: `reach` more than there are, so that no value sees itself around
  /// the box, on one side; of a periodic row its own.
  [[nodiscard]] Index size(bool is_last) const;
};

/// Value of a kernel at a step, counted in places.
struct KernelValue {
  std::array<int, 3> step{};
  double value = 0.0;
};

/// Sums over a box of places, [g * b](x) = sum_x' g(x - x') b(x'), as products of amplitudes:
/// exact to round-off, at a cost that does not depend on how many values g has.
class Convolution {
 public:
  /// What a kernel does when the step is turned round: g(-p) = g(p), or -g(p). Amplitudes of even
  /// kernels are real and those of odd ones imaginary, so that each is kept as one number.
  enum class Parity { even, odd };

  Convolution(const std::array<ConvolutionAxis, 3>& axes, int threads);

  [[nodiscard]] const std::array<ConvolutionAxis, 3>& axes() const { return axes_; }
  [[nodiscard]] const FourierTransform& transform() const { return transform_; }

  /// Amplitudes of a kernel, divided by the places of the box: multiplied by those of a field and
  /// brought back they are the convolution.
  /// @param half of the kernel's values, of two opposite steps one; the other one follows
  /// @throws std::logic_error for a step beyond the reach, or none in an odd kernel
  [[nodiscard]] std::vector<double> amplitudes(std::span<const KernelValue> half,
                                               Parity parity) const;

 private:
  std::array<ConvolutionAxis, 3> axes_;
  FourierTransform transform_;
};

}  // namespace peristat
