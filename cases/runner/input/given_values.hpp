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
  std::string where;                ///< name of what it acts on, for messages; empty: the body
  std::string set;                  ///< set that it acts on; empty: none in particular
  bool has_place = false;           ///< the expression may depend on the place
  std::optional<Coordinates> at{};  ///< place that it acts on, if this is no set
};

/// All given values of a case except free components, in the order of the tables.
[[nodiscard]] std::vector<GivenValue> given_values(const Case& from);

/// Refuses tables of load parameters that no expression names.
/// @throws InputError ("loading.table2") without a place
void refuse_idle_tables(const Case& from);

}  // namespace peristat
