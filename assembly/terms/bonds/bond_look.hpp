#pragma once

#include <span>

#include "assembly/energy/state.hpp"
#include "assembly/terms/bond_drive.hpp"
#include "src/geometry/points.hpp"
#include "src/measures/length.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// The stretch of a bond and its rate along a direction.
struct BondStretch {
  double value = 0.0, rate = 0.0;
};

/// Kinematics of single bonds of a body at a state, which must outlive it.
template <int D, class Measure = Length>
class BondLook {
 public:
  BondLook(const Points& points, const Bonds& bonds, const StateView& at)
      : points_(points), bonds_(bonds), displacement_(at.displacement), free_(at.eigenstretch()) {}

  [[nodiscard]] BondStretch along(Index i, Offset bond, const StateLine& line) const {
    const Index j = bonds_.partner(i, bond);
    const auto found = Measure::template at<D, double>(bonds_.inverse_length(bond),
                                                       {difference(points_.reference, i, j)},
                                                       {difference(displacement_, i, j)});
    BondStretch stretch{found.relative_change - mean(free_, i, bond)};
    if (line.rate.empty()) return stretch;
    stretch.rate =
        dot<D>(found.gradient[0], difference(line.rate, i, j)) * found.inverse_reference -
        mean(line.eigenstretch_rate, i, bond);
    return stretch;
  }
  [[nodiscard]] double stretch(Index i, Offset bond) const { return along(i, bond, {}).value; }

 private:
  [[nodiscard]] Vector<D, double> difference(std::span<const double> field, Index i,
                                             Index j) const {
    Vector<D, double> result;
    for (int c = 0; c < D; ++c) {
      result[c] = field[std::size_t(j) * D + c] - field[std::size_t(i) * D + c];
    }
    return result;
  }
  [[nodiscard]] double mean(std::span<const double> of_point, Index i, Offset bond) const {
    return of_point.empty() ? 0.0 : 0.5 * (of_point[i] + of_point[bonds_.partner(i, bond)]);
  }

  const Points& points_;
  const Bonds& bonds_;
  std::span<const double> displacement_, free_;
};

}  // namespace peristat
