#include "src/transforms/fourier_transform.hpp"

#include <stdexcept>

#include <fftw3.h>

namespace peristat {
namespace {

fftw_complex* amplitudes(double* field) { return reinterpret_cast<fftw_complex*>(field); }

fftw_plan plan_of(void* plan) { return static_cast<fftw_plan>(plan); }

}  // namespace

FourierTransform::FourierTransform(const std::array<Index, 3>& size, int threads)
    : size_(size), threads_(threads) {
  for (const Index count : size) {
    if (count < 1) throw std::logic_error("a transform of no places");
  }
  // The alignment of the field given to the planner decides which instructions are used.
  fftw::Buffer field = make_field();
  double* const data = field.data();
  const fftw::Lines rows{this->rows(), row_modes(), 1};
  const int last = size[2];
  rows_to_modes_ = fftw::AxisPass(rows, [&](int many, int, int distance) -> void* {
    return fftw_plan_many_dft_r2c(1, &last, many, data, nullptr, 1, 2 * distance, amplitudes(data),
                                  nullptr, 1, distance, FFTW_ESTIMATE);
  });
  rows_to_places_ = fftw::AxisPass(rows, [&](int many, int, int distance) -> void* {
    return fftw_plan_many_dft_c2r(1, &last, many, amplitudes(data), nullptr, 1, distance, data,
                                  nullptr, 1, 2 * distance, FFTW_ESTIMATE);
  });
  for (std::size_t axis = 0; axis < 2; ++axis) {
    const fftw::Lines lines{axis == 0 ? 1 : size[0], size[axis],
                            axis == 0 ? size[1] * row_modes() : row_modes()};
    const auto pass = [&](int sign) {
      return fftw::AxisPass(lines, [&](int many, int stride, int distance) -> void* {
        return fftw_plan_many_dft(1, &lines.count, many, amplitudes(data), nullptr, stride,
                                  distance, amplitudes(data), nullptr, stride, distance, sign,
                                  FFTW_ESTIMATE);
      });
    };
    to_modes_[axis] = pass(FFTW_FORWARD);
    to_places_[axis] = pass(FFTW_BACKWARD);
  }
}

std::size_t FourierTransform::places() const {
  return std::size_t(size_[0]) * std::size_t(size_[1]) * std::size_t(size_[2]);
}

void FourierTransform::to_modes(fftw::Buffer& field) const {
  fftw_complex* const data = amplitudes(field.data());
  rows_to_modes_.execute(threads_, [data](void* plan, std::size_t element) {
    fftw_execute_dft_r2c(plan_of(plan), data[element], data + element);
  });
  for (std::size_t axis = 2; axis-- > 0;) {
    if (size_[axis] == 1) continue;
    to_modes_[axis].execute(threads_, [data](void* plan, std::size_t element) {
      fftw_execute_dft(plan_of(plan), data + element, data + element);
    });
  }
}

void FourierTransform::to_places(fftw::Buffer& field) const {
  fftw_complex* const data = amplitudes(field.data());
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (size_[axis] == 1) continue;
    to_places_[axis].execute(threads_, [data](void* plan, std::size_t element) {
      fftw_execute_dft(plan_of(plan), data + element, data + element);
    });
  }
  rows_to_places_.execute(threads_, [data](void* plan, std::size_t element) {
    fftw_execute_dft_c2r(plan_of(plan), data + element, data[element]);
  });
}

}  // namespace peristat
