#include "src/conditions/field_of_place.hpp"

#include <numeric>
#include <vector>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/with_key.hpp"
#include "src/geometry/expression_at_points.hpp"

namespace peristat {
namespace {

std::vector<Index> members_of(const Points& points, const std::string& set,
                              const std::string& key) {
  if (!set.empty()) return points_of_set(points, set, key);
  std::vector<Index> all(std::size_t(points.own()));
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

}  // namespace

void add_field_of_place(const Points& points, const std::string& set, const std::string& text,
                        const std::string& key, const std::string& member, std::size_t stride,
                        std::size_t offset, std::span<double> values) {
  const std::vector<Index> members = members_of(points, set, key + ".set");
  with_key(key + '.' + member, [&] {
    const Expression value = expression_of(text, points);
    const std::vector<double> found = values_at(value, points, members);
    for (std::size_t k = 0; k < members.size(); ++k) {
      values[std::size_t(members[k]) * stride + offset] += found[k];
    }
  });
}

}  // namespace peristat
