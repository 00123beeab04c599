#pragma once

#include <string>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// "supports[2]"
[[nodiscard]] std::string indexed(const std::string& table, std::size_t number);

/// Returns the points of a set.
/// @param key of the set's name, for the error
/// @throws InputError if there is no such set, or no point in that of a whole body
[[nodiscard]] const std::vector<Index>& points_of_set(const Points& points, const std::string& set,
                                                      const std::string& key);

}  // namespace peristat
