#include "solvers/study/motion.hpp"

#include <algorithm>

#include "solvers/study/point_materials.hpp"
#include "src/conditions/absorption.hpp"
#include "src/conditions/initial_state.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

void refuse_constraints(const ConstraintSpecification& constraints) {
  const auto refuse = [](const std::string& key, const std::string& what) {
    throw InputError(key, "",
                     what +
                         " does not go with mode dynamics: its inertia is not that of single "
                         "points");
  };
  if (!constraints.rigid_sets.empty()) refuse("rigid_sets", "a set that moves as a rigid body");
  if (!constraints.rollers.empty()) refuse("rollers", "a roller");
  if (!constraints.linear.empty()) refuse("linear", "a linear constraint");
  if (!constraints.periods.empty()) refuse("periods", "a period");
}

}  // namespace

std::vector<double> densities_of(const Body& body) {
  const PointMaterials materials(body.specification, body.points);
  for (const PointMaterials::Material& material : materials.all()) {
    if (material.of->density) continue;
    throw InputError(material.key + ".density", "", "is missing; mode dynamics needs it");
  }
  std::vector<double> density;
  for (Index i = 0; i < body.points.own(); ++i) {
    density.push_back(*materials.all()[materials.of(i)].of->density);
  }
  return density;
}

MotionSetting make_motion_setting(const Body& body) {
  refuse_constraints(body.specification.constraints);
  const std::vector<double> density = densities_of(body);
  const auto d = std::size_t(body.points.dimension);
  const std::size_t dofs = body.conditions->constraints().dofs();
  MotionSetting setting;
  setting.mass.assign(dofs, 0.0);
  for (std::size_t i = 0; i < density.size(); ++i) {
    for (std::size_t c = 0; c < d; ++c)
      setting.mass[i * d + c] = density[i] * body.points.volume[i];
  }
  InitialState initial = make_initial_state(body.points, body.specification.initial);
  setting.displacement = std::move(initial.displacement);
  setting.velocity = std::move(initial.velocity);
  setting.displacement.resize(dofs, 0.0);
  setting.velocity.resize(dofs, 0.0);
  const std::vector<double> rates = absorption_rates(body.points, body.specification.absorbing);
  for (std::size_t dof = 0; dof < rates.size() * d; ++dof) {
    setting.absorption.resize(dofs, 0.0);
    setting.absorption[dof] = rates[dof / d];
  }
  setting.most_points =
      body.specification.material.model == MaterialModel::bond ? 2 : body.points.dimension + 1;
  return setting;
}

}  // namespace peristat
