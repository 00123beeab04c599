#include "src/conditions/preload.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

double largest_size(const std::vector<double>& values) {
  double largest = 0.0;
  for (const double value : values) largest = std::max(largest, std::abs(value));
  return largest;
}

/// With six digits, for messages.
std::string short_text(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value, std::chars_format::general, 6);
  return {text, end.ptr};
}

}  // namespace

bool Preload::acts() const {
  return std::max({displacement, force_size, eigenstretch, pressure, traction, ground, obstacles,
                   on_obstacles}) > 0.0;
}

std::string Preload::description() const {
  std::string text;
  const auto add = [&](double size, const std::string& part) {
    if (size > 0.0) text += (text.empty() ? "" : ", ") + part;
  };
  add(force_size, "loads of " + short_text(force_size) + " N (resultant " + short_text(force[0]) +
                      ", " + short_text(force[1]) + ", " + short_text(force[2]) + " N)");
  add(displacement, "prescribed displacements up to " + short_text(displacement) + " m");
  add(eigenstretch, "eigenstrains up to " + short_text(eigenstretch));
  add(pressure, "pressures up to " + short_text(pressure) + " Pa");
  add(traction, "tractions up to " + short_text(traction) + " Pa");
  add(ground, "ground displacements up to " + short_text(ground) + " m");
  add(obstacles, "obstacles displaced by up to " + short_text(obstacles) + " m");
  add(on_obstacles, "forces on obstacles up to " + short_text(on_obstacles) + " N");
  return text;
}

Preload find_preload(const Conditions& conditions, const Communicator& ranks) {
  const auto d = std::size_t(conditions.dimension());
  const std::size_t dofs = conditions.prescribed().size();
  Preload preload;
  std::vector<double> values(dofs, 0.0);
  conditions.prescribe(0.0, values);
  preload.displacement = largest_size(values);
  conditions.external_force(0.0, values);
  for (std::size_t dof = 0; dof < dofs; ++dof) {
    preload.force[dof % d] += values[dof];
    preload.force_size += std::abs(values[dof]);
  }
  if (const SharedEnvironment environment = conditions.environment(0.0)) {
    preload.eigenstretch = largest_size(environment->eigenstretch);
    preload.pressure = largest_size(environment->pressure);
    preload.traction = largest_size(environment->traction);
    preload.ground = largest_size(environment->ground);
    for (std::size_t k = 0; k < environment->obstacles.size(); ++k) {
      const auto& axis = conditions.obstacles().all()[k / d].free_axis;
      double& size = axis == k % d ? preload.on_obstacles : preload.obstacles;
      size = std::max(size, std::abs(environment->obstacles[k]));
    }
  }
  for (double& component : preload.force) component = ranks.sum(component);
  preload.force_size = ranks.sum(preload.force_size);
  for (double* const size :
       {&preload.displacement, &preload.eigenstretch, &preload.pressure, &preload.traction,
        &preload.ground, &preload.obstacles, &preload.on_obstacles}) {
    *size = ranks.max(*size);
  }
  return preload;
}

}  // namespace peristat
