#pragma once

#include <span>
#include <string>
#include <vector>

#include "src/geometry/points.hpp"
#include "src/neighbourhood/bonds.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

/// State of a crack when its area last grew.
struct CrackGrowth {
  double area = 0.0;        ///< that has grown since the start [m2]
  double dissipated = 0.0;  ///< [J]
};

/// State of the cracks.
struct CrackState {
  /// Separated bonds that this rank reports: those cut by pre-cracks, then broken ones.
  std::span<const BondEnds> separated;
  std::size_t cut = 0;                      ///< number of them that pre-cracks have cut
  double taken_up = 0.0;                    ///< work that is not stored any more [J]
  double dissipated = 0.0;                  ///< by damage [J]
  CrackGrowth before{};                     ///< when the area through the set last grew
  const Communicator& ranks = sole_rank();  ///< with other separated bonds
  double cross_section = 1.0;               ///< of the body, for sizes of points with own horizons

  /// Values of all ranks. Collective.
  [[nodiscard]] std::vector<double> of_all(std::vector<double> mine) const {
    return concatenated(ranks, mine);
  }
};

/// A quantity of the cracks through a set that a probe can report, from the separated bonds that
/// have an end in the set.
///
/// - crack_length [m]: extent along the axis of the midpoints of bonds that run across it, whose
///   ends are no more than half a spacing apart along it; each represents a strip of one spacing,
///   with horizons of points the mean size of its ends. Inclined bonds are left out: it is not
///   known where along them the crack passes.
/// - crack_begin, crack_end [m]: where that extent begins and ends along the axis.
/// - crack_angle [degree], in 2D: angle from the axis to the crack, towards the other axis, -90 to
///   90: that of the line of least squares through the midpoints of the cell faces below, weighted
///   by their areas; 0 if these have no direction. In a set over a branch, it is the angle of the
///   branch.
/// - crack_area [m2]: area of the cell faces between the points of separated bonds that join next
///   neighbours, the crack's area by its projections on the axes of the lattice.
/// - work_of_fracture [J/m2]: work that is not stored any more over the area that has grown since
///   the start.
/// - crack_resistance [J/m2]: R = dD/dA of an R-curve, the energy dissipated since the area last
///   grew over its present growth; 0 while it does not grow. The sum of R dA over the steps is D
///   when the area last grew.
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

/// Every measure.
[[nodiscard]] const std::vector<CrackMeasure>& crack_measures();

/// Measure of a name, or null.
[[nodiscard]] const CrackMeasure* crack_measure(const std::string& name);

}  // namespace peristat
