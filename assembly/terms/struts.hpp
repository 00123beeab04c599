#pragma once

#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "assembly/terms/failure/bond_failure.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/alike_bonds.hpp"
#include "src/neighbourhood/lower_neighbours.hpp"

namespace peristat {

/// Finds struts: bonds, whole or softened, that still join the two faces of an open crack.
///
/// A way round the bond i-j goes by a third point p that has bonds with both. It is cut if one of
/// these two is broken, and open if none is. With both broken p is beyond either end and tells
/// nothing. The bond is a strut if
///
///   cut + open >= 3,   cut >= 0.6 (cut + open),   mean_cut(s L) >= 2 s_c L_ij,
///
/// s L the elongation of the broken bond of a cut way, s_c L_ij that at which the bond itself
/// breaks: the faces have parted by more than it bears, and only its slant has kept it. Bonds that
/// never fail are none. The rule knows no direction, and no order of the bonds.
class Struts {
 public:
  /// @param bonds which must outlive it
  Struts(const Points& points, const Bonds& bonds)
      : bonds_(bonds), below_(bonds), alike_(points, bonds) {}

  /// Ascending; a bond with an image and its other half are found together.
  /// @param failure of the same bonds
  /// @param history of these bonds
  [[nodiscard]] std::vector<Offset> find(const BondFailure& failure, const Points& points,
                                         const StateView& at, std::span<const double> history,
                                         int threads) const;

  [[nodiscard]] double bytes() const { return below_.bytes(); }

 private:
  template <int D>
  [[nodiscard]] std::vector<Offset> find_in(const BondFailure& failure, const Points& points,
                                            const StateView& at, std::span<const double> history,
                                            int threads) const;

  const Bonds& bonds_;
  LowerNeighbours below_;
  AlikeBonds alike_;
};

}  // namespace peristat
