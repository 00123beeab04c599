#include "solvers/study/motion.hpp"

#include <algorithm>
#include <cmath>

#include "assembly/terms/points/point_term.hpp"
#include "assembly/terms/states/state_term.hpp"
#include "solvers/formulations/formulations.hpp"
#include "src/conditions/absorption.hpp"
#include "src/conditions/initial_state.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/geometry/squared_distance.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

void refuse_constraints(const ConstraintSpecification& constraints, int dimension) {
  const auto refuse = [](const std::string& key, const std::string& what) {
    throw InputError(
        key, "",
        what + " is not allowed in mode dynamics: its inertia is not that of individual points");
  };
  if (!constraints.rigid_sets.empty()) refuse("rigid_sets", "a set that moves as a rigid body");
  if (!constraints.rollers.empty()) refuse("rollers", "a roller");
  if (!constraints.linear.empty()) refuse("linear", "a linear constraint");
  for (const PeriodSpecification& period : constraints.periods) {
    const auto last = period.gradient.begin() + dimension;
    const bool is_given = std::all_of(period.gradient.begin(), last,
                                      [](const auto& component) { return component.has_value(); });
    if (!is_given) refuse("periods", "a period with a free gradient");
  }
}

/// Largest length of a bond in the initial state, over its own length: a longer one is a typing
/// error, with so much energy that nothing else can be seen beside it.
constexpr double longest_bond = 100.0;

void refuse_wild_start(const Body& body, const std::vector<double>& displacement) {
  const Bonds& bonds = body.model.bonds();
  const int d = body.points.dimension;
  std::vector<double> places = body.points.reference;
  add_scaled(places, 1.0, displacement);
  for (Index i = 0; i < body.points.own(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index j = bonds.partner(i, bond);
      if (j >= body.points.own()) continue;  // images follow their sources
      const double times = std::sqrt(squared_distance(places, d, i, j)) / bonds.length(bond);
      if (times <= longest_bond) continue;
      throw InputError("initial", "",
                       "stretches a bond at " + place_text(body.points.position(i), d) + " m to " +
                           number_text(times) + " times its length; at most " +
                           number_text(longest_bond) + " are allowed");
    }
  }
}

/// MotionSetting::most_points for the states of the whole body.
int most_points_of_states(const StateTerm& states, const Body& body) {
  StateRatios ratios = state_ratios(states.shares().constants, body.points.dimension);
  const Communicator& ranks = body.index_map->ranks();
  ratios = {ranks.max(ratios.most), ranks.min(ratios.least)};
  return int(std::ceil(ratios.bound_over_blocks()));
}

}  // namespace

std::vector<double> densities_of(const Body& body) {
  const PointMaterials materials(body.specification, body.points);
  for (const PointMaterials::Material& material : materials.all()) {
    if (material.of->density) continue;
    throw InputError(material.key + ".density", "", "is missing; mode dynamics needs it");
  }
  std::vector<double> density;
  density.reserve(std::size_t(body.points.own()));
  for (Index i = 0; i < body.points.own(); ++i) {
    density.push_back(*materials.all()[materials.of(i)].of->density);
  }
  return density;
}

MotionSetting make_motion_setting(const Body& body) {
  refuse_constraints(body.specification.constraints, body.points.dimension);
  const std::vector<double> density = densities_of(body);
  const auto d = std::size_t(body.points.dimension);
  const std::size_t dofs = body.conditions->constraints().dofs();
  MotionSetting setting;
  setting.mass.assign(dofs, 0.0);
  for (std::size_t i = 0; i < density.size(); ++i) {
    for (std::size_t c = 0; c < d; ++c)
      setting.mass[i * d + c] = density[i] * body.points.volume[i];
  }
  if (!body.specification.initial.empty()) {
    InitialState initial = make_initial_state(body.points, body.specification.initial);
    refuse_wild_start(body, initial.displacement);
    setting.displacement = std::move(initial.displacement);
    setting.velocity = std::move(initial.velocity);
  }
  const std::vector<double> rates = absorption_rates(body.points, body.specification.absorbing);
  for (std::size_t dof = 0; dof < rates.size() * d; ++dof) {
    setting.absorption.resize(dofs, 0.0);
    setting.absorption[dof] = rates[dof / d];
  }
  setting.most_points = formulation_of(body.specification).most_points(body.points.dimension);
  if (const auto* states = body.model.find<StateTerm>()) {
    setting.most_points = most_points_of_states(*states, body);
  } else if (const auto* of_points = body.model.find<PointTerm>()) {
    setting.most_points = int(std::ceil(of_points->bound_over_blocks(body.points.dimension)));
  }
  return setting;
}

}  // namespace peristat
