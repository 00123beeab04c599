#pragma once

#include <string>
#include <vector>

#include "src/geometry/points.hpp"

namespace peristat {

/// "supports[2]"
[[nodiscard]] std::string indexed(const std::string& table, std::size_t number);

/// Points of a set that something acts on.
/// @param key of the set's name, for the error
/// @throws InputError if there is no such set, or no point in it
[[nodiscard]] const std::vector<Index>& points_of_set(const Points& points, const std::string& set,
                                                      const std::string& key);

}  // namespace peristat
