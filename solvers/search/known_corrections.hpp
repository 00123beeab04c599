#pragma once

#include <span>
#include <utility>
#include <vector>

#include "src/core/types.hpp"

namespace peristat {

/// What the last corrections of an elastic body's displacement have changed of its residual
/// (force). A tangent of another state errs in much the same way again and again: what a residual
/// has in common with these changes is corrected by their own corrections, the rest by the tangent.
class KnownCorrections {
 public:
  /// A correction [m/N] and its change of the residual, at first of norm 1, per equation. In half
  /// the memory: what the body has moved since matters more than the last digits.
  struct Known {
    std::vector<float> correction, change;
  };

  /// Takes what is known off a residual, and adds its correction.
  void take_off(std::span<double> residual, std::span<double> correction) const;

  /// What is in the latest changes is not taken from earlier ones.
  /// @param change that a correction has made of the residual
  void add(std::span<const double> correction, std::span<const double> change);

  /// Subtracts the stiffness k g g^T from the tangent that the corrections belong to.
  /// @param g shares by equation
  void lose(double stiffness, std::span<const std::pair<Index, double>> g);

  void clear() { latest_first_.clear(); }

  [[nodiscard]] const std::vector<Known>& latest_first() const { return latest_first_; }
  [[nodiscard]] std::vector<Known> take_all() { return std::exchange(latest_first_, {}); }
  void restore(std::vector<Known> latest_first) { latest_first_ = std::move(latest_first); }

  /// Largest number of corrections: those of some two events.
  static constexpr std::size_t most = 10;

 private:
  /// Shares of the changes that fit the residual best (least squares).
  [[nodiscard]] std::vector<double> shares_of(std::span<const double> residual) const;

  std::vector<Known> latest_first_;
};

}  // namespace peristat
