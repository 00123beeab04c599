#pragma once

#include <array>
#include <memory>
#include <span>

#include "src/core/types.hpp"
#include "src/transforms/fftw.hpp"

namespace peristat {

/// Discrete Fourier transform of real values on a box of places, in place, by FFTW:
///
///   b^(k) = sum_x b(x) exp(-i k.x),   k_a = 2 pi m_a / M_a.
///
/// A field has a row of values for each line along the last axis, padded to row_length(). After
/// `to_modes` it holds instead the M_last / 2 + 1 complex amplitudes of half of the modes: the
/// others are their conjugates. Sizes may be odd. The same box gives the same bits on any number of
/// threads.
class FourierTransform {
 public:
  /// @param size places along each axis, 1 beyond the dimension; contiguous along the last one
  FourierTransform(const std::array<Index, 3>& size, int threads);

  [[nodiscard]] const std::array<Index, 3>& size() const { return size_; }
  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] std::size_t places() const;
  [[nodiscard]] Index rows() const { return size_[0] * size_[1]; }
  /// Doubles of a row, and complex amplitudes of it.
  [[nodiscard]] Index row_length() const { return 2 * row_modes(); }
  [[nodiscard]] Index row_modes() const { return size_[2] / 2 + 1; }
  [[nodiscard]] std::size_t modes() const { return std::size_t(rows()) * std::size_t(row_modes()); }
  /// Position of a place's value in a field.
  [[nodiscard]] std::size_t at(Index i, Index j, Index k) const {
    return (std::size_t(i) * std::size_t(size_[1]) + std::size_t(j)) * std::size_t(row_length()) +
           std::size_t(k);
  }

  /// A field of zeros.
  [[nodiscard]] fftw::Buffer make_field() const { return fftw::Buffer(2 * modes()); }

  /// Transform values to amplitudes of the modes and back; both together multiply by places().
  void to_modes(fftw::Buffer& field) const;
  void to_places(fftw::Buffer& field) const;

 private:
  std::array<Index, 3> size_;
  int threads_;
  fftw::AxisPass rows_to_modes_, rows_to_places_;
  std::array<fftw::AxisPass, 2> to_modes_, to_places_;  // of the first two axes
};

}  // namespace peristat
