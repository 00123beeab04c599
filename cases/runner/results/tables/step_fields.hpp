#pragma once

#include <optional>

#include "solvers/observe/point_fields.hpp"
#include "solvers/problem/records.hpp"

namespace peristat {

/// What an accepted step writes.
struct StepFields {
  PointValues values;
  /// Histories that have changed since the last step that was written; none without damage.
  std::optional<BondHistories> histories{};
};

}  // namespace peristat
