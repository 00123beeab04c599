#include "cases/runner/results/part_recorder.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "assembly/terms/bonds/point_stretches.hpp"
#include "cases/runner/results/motion_columns.hpp"
#include "cases/runner/results/part_probe.hpp"

namespace peristat {

StepFields PartRecorder::Fields::view() const {
  StepFields fields{&displacement, &force, &damage, &energy_density, &stretch, &fragment, nullptr};
  if (is_motion) {
    fields.velocity = &velocity;
    fields.kinetic_energy_density = &kinetic_energy_density;
  }
  return fields;
}

void PartRecorder::iteration(const IterationRecord& record) {
  relative_residual_ = record.relative_residual;
  if (results_) results_->add(record);
  progress_.iteration(record);
}

void PartRecorder::decided(const DecisionRecord& record) {
  if (results_) results_->add(record);
  progress_.decision(record);
}

double PartRecorder::find_stretches(const StateView& at, std::vector<double>& stretch) const {
  double largest = -std::numeric_limits<double>::infinity();  // of a rank without points
  if (!stretch.empty()) largest = point_stretches(body_.points, body_.model, at, stretch);
  return gathering_.part().ranks().max(largest);
}

PartRecorder::Fields PartRecorder::fields(const StateView& at, std::vector<double> force) const {
  const auto owned = std::size_t(gathering_.part().owned());
  const std::size_t dofs = owned * std::size_t(body_.points.dimension);
  Fields made;
  made.displacement.assign(at.displacement.begin(), at.displacement.begin() + std::ptrdiff_t(dofs));
  made.force = std::move(force);
  made.force.resize(dofs);
  made.damage.assign(owned, 0.0);
  made.fragment.assign(owned, 0.0);
  made.energy_density.resize(body_.points.volume.size());
  assembler_.point_energies(at, made.energy_density);
  made.energy_density.resize(owned);
  for (std::size_t i = 0; i < owned; ++i) made.energy_density[i] /= body_.points.volume[i];
  return made;
}

void PartRecorder::add_motion(std::span<const double> velocity, Fields& made) const {
  const auto d = std::size_t(body_.points.dimension);
  made.is_motion = true;
  made.velocity.assign(velocity.begin(), velocity.begin() + std::ptrdiff_t(made.force.size()));
  made.kinetic_energy_density.assign(made.damage.size(), 0.0);
  for (std::size_t k = 0; k < made.velocity.size(); ++k) {
    made.kinetic_energy_density[k / d] += 0.5 * density_[k / d] * velocity[k] * velocity[k];
  }
}

void PartRecorder::accepted(StepRecord record, const AcceptedState& state) {
  const StateView at = state.trial.at();
  std::vector<double> force = state.trial.gradient;
  for (double& component : force) component = -component;
  Fields made = fields(at, std::move(force));
  made.stretch.resize(body_.points.volume.size());
  record.max_stretch = find_stretches(at, made.stretch);
  made.stretch.resize(std::size_t(gathering_.part().owned()));
  if (case_.dynamics.is_asked_for) add_motion(state.velocity, made);
  add_motion_values(record, body_.points.dimension, record.probes);
  const LoadingProgramme& programme = body_.conditions->programme();
  const LoadValues loads{programme.names(), programme.at(record.stage)};
  for (const ProbeSpecification& probe : case_.probes) {
    record.probes[probe.name] =
        part_probe_values(probe, body_.points, made.view(), loads, gathering_.part().ranks());
  }
  const bool write_fields = record.step % case_.output.every == 0;
  if (results_) {
    results_->add(record, write_fields ? std::optional(made.view()) : std::nullopt);
  } else if (write_fields) {
    send(made);
  }
  progress_.accepted(record, relative_residual_);
  last_ = std::move(record);
  unwritten_.reset();
  if (!write_fields) unwritten_ = std::move(made);
}

void PartRecorder::send(const Fields& fields) const {
  const StepShape shape{Index(gathering_.rows()), body_.points.dimension};
  const StepFields view = fields.view();
  StepPart(shape, view, &gathering_).send();
}

void PartRecorder::finish() {
  if (!unwritten_) return;
  if (results_) return results_->add_fields(*last_, unwritten_->view());
  send(*unwritten_);
}

}  // namespace peristat
