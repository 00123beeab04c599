#pragma once

#include <span>
#include <string>
#include <vector>

#include "src/core/concatenated.hpp"
#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"

namespace peristat {

/// What a crack had when its area grew last.
struct CrackGrowth {
  double area = 0.0;        ///< that has grown since the start [m2]
  double dissipated = 0.0;  ///< [J]
};

/// How far cracks have come.
struct CrackState {
  /// Bonds that pre-cracks have cut, then those that broke: those that are told here.
  std::span<const BondEnds> separated;
  std::size_t cut = 0;                  ///< how many of them pre-cracks have cut
  double taken_up = 0.0;                ///< work that is not stored any more [J]
  double dissipated = 0.0;              ///< by damage [J]
  CrackGrowth before{};                 ///< when the area through the set grew last
  const Communicator* ranks = nullptr;  ///< that have other separated bonds; null: these are all

  /// What all ranks have, by a call that all make.
  [[nodiscard]] std::vector<double> of_all(std::vector<double> mine) const {
    return ranks ? concatenated(mine, *ranks) : mine;
  }
};

/// What a probe can tell of the cracks through a set: of the separated bonds that have an end in
/// it.
///
/// - crack_length [m]: extent along the axis of the middles of those that run across it, whose ends
///   are no more than half a spacing apart along it; each stands for a strip of one spacing. Only
///   those, because where along an inclined bond the crack passes is not known.
/// - crack_begin, crack_end [m]: where that extent begins and ends along the axis.
/// - crack_angle [degree], in 2D: of the crack to the axis, from there to the other one, -90 to 90:
///   of the line of least squares through the middles of the cell faces below, weighed by their
///   areas; 0 if these have no direction. Over a branch it tells how that runs.
/// - crack_area [m2]: of the cell faces between the points of those that join next neighbours, the
///   crack's area by its projections on the axes of the lattice.
/// - work_of_fracture [J/m2]: work that is not stored any more over the area that has grown since
///   the start.
/// - crack_resistance [J/m2]: energy dissipated since the area grew last over what it has grown by
///   now, R = dD/dA of an R-curve; 0 while it does not grow. The sum of R dA over the steps is D
///   when the area grew last.
///
/// All are 0 without such a bond, work_of_fracture without an area that has grown.
struct CrackMeasure {
  std::string name, unit;
  bool has_axis;
  double (*value)(const Points& points, std::span<const Index> set, int axis,
                  const CrackState& crack);
};

/// Area through a set that has grown since the start, the same whatever the order of the bonds
/// [m2].
[[nodiscard]] double grown_area(const Points& points, std::span<const Index> set,
                                const CrackState& crack);

/// Of a name, or null.
[[nodiscard]] const CrackMeasure* crack_measure(const std::string& name);

}  // namespace peristat
