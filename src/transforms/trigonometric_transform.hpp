#pragma once

#include <memory>
#include <span>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// How values on a row of places continue beyond its end: as their mirror image (free), or as that
/// with the opposite sign (held); the mirror stands half a spacing beyond the last place.
enum class RowEnd { free, held };

struct TransformAxis {
  Index count = 1;  ///< places
  RowEnd below = RowEnd::free, above = RowEnd::free;

  bool operator==(const TransformAxis&) const = default;

  /// Wave number of mode j, in radians per spacing: pi j / n between free ends, pi (j + 1) / n
  /// between held ones, pi (j + 1/2) / n between a free and a held one.
  [[nodiscard]] double wave_number(Index mode) const;
};

/// Sines and cosines on a box of places, by FFTW: along an axis with n places the modes
///
///   cos k_j (i + 1/2)  free below,   sin k_j (i + 1/2)  held below,   i, j = 0 ... n-1,
///
/// with k_j from wave_number (discrete cosine and sine transforms of kind II, and of kind IV
/// between a free and a held end). Every operator that commutes with shifts and reflections of the
/// unbounded lattice is diagonal in them. The same axes give the same numbers to the last bit,
/// whatever the number of threads.
class TrigonometricTransform {
 public:
  /// @param axes one to three; places are contiguous along the last one
  TrigonometricTransform(std::span<const TransformAxis> axes, int threads);
  ~TrigonometricTransform();
  TrigonometricTransform(TrigonometricTransform&&) noexcept;
  TrigonometricTransform& operator=(TrigonometricTransform&&) noexcept;

  [[nodiscard]] const std::vector<TransformAxis>& axes() const { return axes_; }
  [[nodiscard]] std::size_t count() const { return count_; }  ///< places of the box
  /// Memory for one value per place, zero at first, on which the transforms work.
  [[nodiscard]] std::span<double> values();

  /// Transform values of places to amplitudes of modes, and back; both together multiply by
  /// `factor`.
  void to_modes();
  void to_places();
  [[nodiscard]] double factor() const;

 private:
  struct Plans;
  std::vector<TransformAxis> axes_;
  std::size_t count_ = 1;
  std::unique_ptr<Plans> plans_;
};

}  // namespace peristat
