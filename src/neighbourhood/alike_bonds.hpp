#pragma once

#include <cstddef>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// Bonds that are one, beyond planes of symmetry and periods: a bond i-j' with an image j' of j,
/// the other half of it, that of j with the image i' of i that lies to j as i lies to j', and the
/// bonds between two images, which have no weight. Without images every bond is alone.
class AlikeBonds {
 public:
  AlikeBonds() = default;
  /// @throws std::logic_error if a bond lacks its other half, or one between images shows none
  AlikeBonds(const Points& points, const Bonds& bonds);

  /// The first bond that is one with this one.
  [[nodiscard]] Offset first(Offset bond) const {
    return first_.empty() ? bond : first_[std::size_t(bond)];
  }
  [[nodiscard]] bool none() const { return first_.empty(); }

  /// Calls visit(bond) for the bonds that are one with this one, ascending, itself included.
  template <class Visit>
  void for_each(Offset bond, const Visit& visit) const {
    if (first_.empty()) return visit(bond);
    for (Offset one = first(bond); one >= 0; one = next_[std::size_t(one)]) visit(one);
  }

 private:
  std::vector<Offset> first_, next_;  // per bond; the last one has no next, -1
};

}  // namespace peristat
