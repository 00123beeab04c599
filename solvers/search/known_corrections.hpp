#pragma once

#include <span>
#include <vector>

namespace peristat {

/// What earlier corrections of an elastic body's displacement have changed of its residual (force).
/// A tangent of another state errs in much the same way again and again: what a residual has in
/// common with these changes is corrected by their own corrections, the rest by the tangent.
class KnownCorrections {
 public:
  /// Takes what is known off a residual.
  /// @return its correction
  [[nodiscard]] std::vector<double> take_off(std::span<double> residual) const;

  /// @param change that a correction has made of the residual
  void add(std::vector<double> correction, std::vector<double> change);

  void clear() { known_.clear(); }

 private:
  struct Known {
    std::vector<double> correction, change;  ///< changes are orthonormal
  };
  std::vector<Known> known_;
};

}  // namespace peristat
