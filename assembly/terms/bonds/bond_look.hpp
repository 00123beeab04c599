#pragma once

#include <span>

#include "assembly/energy/state.hpp"
#include "src/geometry/points.hpp"
#include "src/measures/length.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Kinematics of single bonds of a body at a state, which must outlive it.
template <int D>
class BondLook {
 public:
  BondLook(const Points& points, const Bonds& bonds, const StateView& at)
      : points_(points), bonds_(bonds), displacement_(at.displacement), free_(at.eigenstretch()) {}

  struct Stretch {
    double value, rate;
  };

  [[nodiscard]] double stretch(Index i, Offset bond) const {
    return measure(i, bond).relative_change - mean(free_, i, bond);
  }
  [[nodiscard]] Stretch along(Index i, Offset bond, std::span<const double> direction,
                              std::span<const double> free_rate) const {
    const auto found = measure(i, bond);
    const Vector<D, double> moved = difference(direction, i, bonds_.partner[bond]);
    return {found.relative_change - mean(free_, i, bond),
            dot<D>(found.gradient[0], moved) * found.inverse_reference - mean(free_rate, i, bond)};
  }

 private:
  [[nodiscard]] Vector<D, double> difference(std::span<const double> field, Index i,
                                             Index j) const {
    Vector<D, double> result;
    for (int c = 0; c < D; ++c) {
      result[c] = field[std::size_t(j) * D + c] - field[std::size_t(i) * D + c];
    }
    return result;
  }
  [[nodiscard]] auto measure(Index i, Offset bond) const {
    const Index j = bonds_.partner[bond];
    return Length::at<D, double>(bonds_.inverse_length(bond), {difference(points_.reference, i, j)},
                                 {difference(displacement_, i, j)});
  }
  [[nodiscard]] double mean(std::span<const double> of_point, Index i, Offset bond) const {
    return of_point.empty() ? 0.0 : 0.5 * (of_point[i] + of_point[bonds_.partner[bond]]);
  }

  const Points& points_;
  const Bonds& bonds_;
  std::span<const double> displacement_, free_;
};

}  // namespace peristat
