#include "src/conditions/points_of_set.hpp"

#include "src/core/input_error.hpp"

namespace peristat {

std::string indexed(const std::string& table, std::size_t number) {
  return table + "[" + std::to_string(number) + "]";
}

const std::vector<Index>& points_of_set(const Points& points, const std::string& set,
                                        const std::string& key) {
  const auto found = points.sets.find(set);
  if (found == points.sets.end()) {
    std::string known;
    for (const auto& [name, members] : points.sets) known += (known.empty() ? "" : ", ") + name;
    throw InputError(key, "\"" + set + "\"", "no set of this name; the sets are " + known);
  }
  if (found->second.empty() && !points.owned) {
    throw InputError(key, "\"" + set + "\"", "the set selects no point");
  }
  return found->second;
}

}  // namespace peristat
