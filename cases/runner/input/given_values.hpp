#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cases/runner/input/case.hpp"

namespace peristat {

/// A value that a case gives as an expression of place and load parameters.
struct GivenValue {
  enum class Kind { displacement, load, strain, expected } kind = Kind::displacement;
  std::string key;   ///< "support[0].displacement[1]"
  std::string text;  ///< the expression
  std::string unit;
  std::string where;                ///< whom it is of, for people; empty: the body
  std::string set;                  ///< whose points have it; empty: none in particular
  bool has_place = false;           ///< whether the expression may ask for a place
  std::optional<Coordinates> at{};  ///< the place that it is for, where that is no set's
};

/// All of them but what is free, in the order of the tables.
[[nodiscard]] std::vector<GivenValue> given_values(const Case& from);

/// Refuses tables of load parameters that no expression names.
/// @throws InputError ("loading.table2") without a place
void refuse_idle_tables(const Case& from);

}  // namespace peristat
