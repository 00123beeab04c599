#include "src/conditions/initial_state.hpp"

#include <numeric>

#include "src/conditions/points_of_set.hpp"
#include "src/conditions/with_key.hpp"
#include "src/core/expression.hpp"

namespace peristat {
namespace {

std::vector<Index> members_of(const Points& points, const std::string& set,
                              const std::string& key) {
  if (!set.empty()) return points_of_set(points, set, key);
  std::vector<Index> all(std::size_t(points.own()));
  std::iota(all.begin(), all.end(), Index(0));
  return all;
}

void add(const Points& points, const std::vector<Index>& members, int component,
         const std::string& text, const std::string& key, std::vector<double>& values) {
  with_key(key, [&] {
    const Expression value(text, points.dimension, points.spacing);
    for (const Index point : members) {
      values[std::size_t(point) * std::size_t(points.dimension) + std::size_t(component)] +=
          value(points.position(point));
    }
  });
}

}  // namespace

InitialState make_initial_state(const Points& points,
                                const std::vector<InitialSpecification>& initial) {
  InitialState state{std::vector<double>(points.reference.size(), 0.0),
                     std::vector<double>(points.reference.size(), 0.0)};
  for (std::size_t k = 0; k < initial.size(); ++k) {
    const std::string table = indexed("initial", k);
    const std::vector<Index> members = members_of(points, initial[k].set, table + ".set");
    for (int c = 0; c < points.dimension; ++c) {
      const auto component = std::size_t(c);
      add(points, members, c, initial[k].displacement[component],
          indexed(table + ".displacement", component), state.displacement);
      add(points, members, c, initial[k].velocity[component],
          indexed(table + ".velocity", component), state.velocity);
    }
  }
  return state;
}

}  // namespace peristat
