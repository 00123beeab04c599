#include "solvers/observe/observation.hpp"

#include <utility>

#include "assembly/terms/bonds/point_stretches.hpp"
#include "solvers/body/without_equation.hpp"
#include "solvers/observe/internal_force.hpp"
#include "solvers/observe/stress_fields.hpp"
#include "src/core/input_error.hpp"

namespace peristat {

struct Observation::Owned {
  Assembler assembler;
  Trial trial;
  std::vector<double> force;

  Owned(const Body& body, const State& state, int threads)
      : assembler(body.points, body.model, usable_threads(threads), *body.index_map) {
    const Conditions& conditions = *body.conditions;
    const FreeDofs free(without_equation(body), body.points.dimension);
    const EquilibriumProblem problem{assembler, conditions, free};
    const LoadPoint at = load_point(state);
    trial.displacement = state.displacement;
    trial.history = state.history;
    trial.environment = state.environment ? state.environment : problem.environment(at);
    std::vector<double> external_force(state.displacement.size());
    conditions.external_force(at, external_force);
    evaluate(problem, external_force, trial);
    force = internal_force(body, trial, external_force);
  }
};

Observation::Observation(const Body& body, Assembler& assembler, const StateView& at,
                         ObservedExtras extras)
    : body_(body),
      assembler_(assembler),
      at_(at),
      extras_(std::move(extras)),
      points_(body.points, *body.index_map) {}

Observation::Observation(const Body& body, std::unique_ptr<Owned> owned)
    : Observation(body, owned->assembler, owned->trial.at(), {std::move(owned->force)}) {
  owned_ = std::move(owned);
}

Observation::Observation(const Body& body, const State& state, int threads)
    : Observation(body, std::make_unique<Owned>(body, state, threads)) {}

Observation::~Observation() = default;

const std::vector<double>& Observation::values(const std::string& field) {
  const auto known = values_.find(field);
  if (known != values_.end()) return known->second;
  const PointField* const row = point_field(field);
  if (row == nullptr) throw InputError("field", '"' + field + '"', "no field of this name");
  if (row->needs == FieldNeeds::motion && !body_.conditions->programme().is_of_time()) {
    throw InputError("field", '"' + field + '"', "is a field of bodies in motion");
  }
  std::vector<double> computed = row->compute(*this);
  return values_.emplace(field, std::move(computed)).first->second;
}

Observation::Stretches& Observation::stretches() {
  if (!stretches_) {
    stretches_.emplace();
    stretches_->of_points.resize(body_.points.volume.size());
    stretches_->largest = point_stretches(body_.points, body_.model, at_, stretches_->of_points,
                                          assembler_.threads());
    stretches_->of_points.resize(std::size_t(points_.count()));
  }
  return *stretches_;
}

Stress& Observation::stress() {
  if (!stress_) stress_ = stress_of(body_, assembler_, at_);
  return *stress_;
}

}  // namespace peristat
