#include "src/transforms/convolution.hpp"

#include <cstdlib>
#include <stdexcept>

#include "src/transforms/good_size.hpp"

namespace peristat {
namespace {

std::array<Index, 3> sizes_of(const std::array<ConvolutionAxis, 3>& axes) {
  return {axes[0].size(false), axes[1].size(false), axes[2].size(true)};
}

}  // namespace

Index ConvolutionAxis::size(bool is_last) const {
  if (is_periodic) return count;
  Index size = good_size(count + reach);
  // An even real transform is one of half as many complex numbers.
  while (is_last && size > 1 && size % 2 == 1) size = good_size(size + 1);
  return size;
}

Convolution::Convolution(const std::array<ConvolutionAxis, 3>& axes, int threads)
    : axes_(axes), transform_(sizes_of(axes), threads) {}

std::vector<double> Convolution::amplitudes(std::span<const KernelValue> half,
                                            Parity parity) const {
  const std::array<Index, 3>& size = transform_.size();
  fftw::Buffer field = transform_.make_field();
  const auto add = [&](const std::array<int, 3>& step, int sign, double value) {
    std::array<Index, 3> at{};
    for (std::size_t a = 0; a < 3; ++a) {
      const Index along = sign * step[a] % size[a];
      at[a] = along < 0 ? along + size[a] : along;
    }
    field.data()[transform_.at(at[0], at[1], at[2])] += value / double(transform_.places());
  };
  for (const KernelValue& entry : half) {
    for (std::size_t a = 0; a < 3; ++a) {
      if (std::abs(entry.step[a]) > axes_[a].reach) {
        throw std::logic_error("a kernel reaches farther than its box is padded");
      }
    }
    const bool is_origin = entry.step == std::array<int, 3>{};
    if (is_origin && parity == Parity::odd) {
      throw std::logic_error("an odd kernel has no value at the origin");
    }
    add(entry.step, 1, entry.value);
    if (!is_origin) add(entry.step, -1, parity == Parity::even ? entry.value : -entry.value);
  }
  transform_.to_modes(field);
  std::vector<double> amplitudes(transform_.modes());
  const std::size_t part = parity == Parity::even ? 0 : 1;
  for (std::size_t k = 0; k < amplitudes.size(); ++k) {
    amplitudes[k] = field.data()[2 * k + part];
  }
  return amplitudes;
}

}  // namespace peristat
