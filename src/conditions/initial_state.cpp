#include "src/conditions/initial_state.hpp"

#include "src/conditions/field_of_place.hpp"
#include "src/conditions/points_of_set.hpp"

namespace peristat {

InitialState make_initial_state(const Points& points,
                                const std::vector<InitialSpecification>& initial) {
  InitialState state{std::vector<double>(points.reference.size(), 0.0),
                     std::vector<double>(points.reference.size(), 0.0)};
  const auto d = std::size_t(points.dimension);
  for (std::size_t k = 0; k < initial.size(); ++k) {
    const auto add = [&](const auto& components, const std::string& member,
                         std::vector<double>& values) {
      for (std::size_t c = 0; c < d; ++c) {
        add_field_of_place(points, initial[k].set, components[c], indexed("initial", k),
                           indexed(member, c), d, c, values);
      }
    };
    add(initial[k].displacement, "displacement", state.displacement);
    add(initial[k].velocity, "velocity", state.velocity);
  }
  return state;
}

}  // namespace peristat
