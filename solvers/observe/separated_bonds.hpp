#pragma once

#include <span>
#include <vector>

#include "solvers/body/body.hpp"
#include "solvers/observe/crack_measures.hpp"
#include "solvers/observe/recorded_points.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// Bonds of a body that this rank reports as separated: those that pre-cracks have cut, then those
/// that break, in the order in which states show it. The body must outlive it.
class SeparatedBonds {
 public:
  explicit SeparatedBonds(const Body& body);

  /// Adds the bonds that are broken in a state's history.
  /// @return those that are new; valid until the next call
  std::span<const BondEnds> add_broken(const History& history);

  /// State of the cracks, for crack measures.
  /// @param record of the state, whose energies work_of_fracture and crack_resistance need
  /// @param before when the area through the probe's set last grew, for crack_resistance
  [[nodiscard]] CrackState cracks(const StepRecord& record = {},
                                  const CrackGrowth& before = {}) const;

 private:
  const Body& body_;
  RecordedPoints points_;
  std::vector<BondEnds> ends_;
  std::size_t cut_ = 0;       // number of these cut by pre-cracks
  std::vector<char> broken_;  // per bond, so far
};

}  // namespace peristat
