#include "cases/runner/results/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "assembly/terms/bonds/point_stretches.hpp"
#include "assembly/terms/damage.hpp"
#include "cases/runner/results/constraint_columns.hpp"
#include "cases/runner/results/crack_tip_columns.hpp"
#include "cases/runner/results/motion_columns.hpp"
#include "cases/runner/results/record_tables.hpp"
#include "src/geometry/image_number.hpp"

namespace peristat {

StepFields Recorder::Fields::view(bool with_stress) const {
  StepFields fields{&displacement,
                    &force,
                    &damage,
                    &energy_density,
                    &stretch,
                    &fragment,
                    histories ? &*histories : nullptr};
  if (stress && with_stress) stress->show_in(fields);
  if (velocity) {
    fields.velocity = &*velocity;
    fields.kinetic_energy_density = &kinetic_energy_density;
  }
  return fields;
}

void Recorder::iteration(const IterationRecord& record) {
  relative_residual_ = record.relative_residual;
  results_.add(record);
  progress_.iteration(record);
}

Recorder::Fields Recorder::fields(const StateView& at, std::vector<double> force,
                                  std::span<const std::int32_t> piece,
                                  std::span<const double> velocity) const {
  const std::size_t points = points_.volume.size();
  const std::ptrdiff_t dofs = std::ptrdiff_t(own_) * points_.dimension;
  force.resize(std::size_t(dofs));
  Fields made;
  made.displacement.assign(at.displacement.begin(), at.displacement.begin() + dofs);
  made.force = std::move(force);
  for (auto* field : {&made.damage, &made.energy_density, &made.stretch}) field->resize(points);
  made.fragment.assign(own_, 0.0);
  if (body_.model.failing_bonds()) {
    made.histories = written_histories_.changes(recorded_, body_.model.bonds(),
                                                bond_stretches(body_.model, at.history));
  }
  assembler_.point_energies(at, made.energy_density);
  for (auto i = std::size_t(points_.own()); i < points; ++i) {
    made.energy_density[std::size_t(points_.source(Index(i)))] += made.energy_density[i];
  }
  for (std::size_t i = 0; i < own_; ++i) made.energy_density[i] /= points_.volume[i];
  const double largest =
      recorded_.ranks().max(point_stretches(points_, body_.model, at, made.stretch));
  made.max_stretch = std::isfinite(largest) ? largest : 0.0;
  const auto cut_weight =
      case_.output.count_cracks ? std::span(body_.cut_weight) : std::span<const double>();
  static_cast<void>(assess_damage(body_.model, at.history, cut_weight, made.damage, &points_));
  for (auto* field : {&made.damage, &made.energy_density, &made.stretch}) field->resize(own_);
  for (const double damage : made.damage) made.max_damage = std::max(made.max_damage, damage);
  made.max_damage = recorded_.ranks().max(made.max_damage);
  std::copy_n(piece.begin(), std::min(piece.size(), own_), made.fragment.begin());
  if (tells_stress(case_)) made.stress = make_stress_fields(body_, assembler_, at);
  if (case_.dynamics.is_asked_for) add_motion(velocity, made);
  return made;
}

void Recorder::add_motion(std::span<const double> velocity, Fields& made) const {
  const auto d = std::size_t(points_.dimension);
  made.velocity.emplace(velocity.begin(), velocity.begin() + std::ptrdiff_t(own_ * d));
  made.kinetic_energy_density.assign(own_, 0.0);
  for (std::size_t k = 0; k < made.velocity->size(); ++k) {
    made.kinetic_energy_density[k / d] += 0.5 * density_[k / d] * velocity[k] * velocity[k];
  }
}

void Recorder::accepted(StepRecord record, const AcceptedState& state) {
  unwritten_.reset();  // freed before new fields are made
  const StateView at = state.trial.at();
  std::vector<double> force = state.trial.gradient;
  const Constraints& constraints = body_.conditions->constraints();
  constraints.unfold(state.external_force, force);
  for (double& component : force) component = -component;
  std::vector<double> follower_force = state.trial.follower_force;
  if (!follower_force.empty()) constraints.fold_images(follower_force);
  for (std::size_t k = 0; k < follower_force.size(); ++k) force[k] -= follower_force[k];
  body_.conditions->foundations().add_force(at.displacement, at.environment, -1.0, force);
  Fields made = fields(at, std::move(force), state.piece, state.velocity);
  record.max_stretch = made.max_stretch;
  record.max_damage = made.max_damage;
  record_broken_bonds(record, at.history);
  const StepFields all = made.view(true), view = made.view(case_.output.stress);
  const LoadingProgramme& programme = body_.conditions->programme();
  LoadValues loads{programme.names(), programme.at(record.stage)};
  if (body_.conditions->control()) loads.values.front() = record.load_factor;
  for (const ProbeSpecification& probe : case_.probes) {
    if (probe.from) continue;
    record.probes[probe.name] =
        probe_values(probe, recorded_, all, crack_state(record, probe.name), loads);
  }
  note_growth(record);
  const std::string without_release = add_crack_tip_values(
      case_, crack_tips_, assembler_, state.trial, record.stage, record.probes);
  if (!without_release.empty()) {
    progress_.problem("step " + std::to_string(record.step) +
                      ": the body has no equilibrium with the cut ahead of " + without_release +
                      "; its energy release rates are reported as 0");
  }
  add_constraint_values(*body_.conditions, state.trial, state.external_force, recorded_.ranks(),
                        record.probes);
  add_motion_values(record, points_.dimension, record.probes);
  const bool is_at_rest = record.step == 0 && !record.motion && !moves(made.displacement);
  for (const LineProbe& line : lines_) {
    if (!is_at_rest) results_.add_line(line.table().name, line.rows(record, all));
  }
  const bool write_fields = record.step % case_.output.every == 0 && !is_at_rest;
  results_.add(record, write_fields ? std::optional(view) : std::nullopt);
  if (write_fields) written_histories_.tell(bond_stretches(body_.model, at.history));
  if (!is_at_rest) progress_.accepted(record, relative_residual_);
  last_ = std::move(record);
  if (!write_fields && !is_at_rest) unwritten_ = std::move(made);
}

bool Recorder::moves(std::span<const double> displacement) const {
  double largest = 0.0;
  for (const double component : displacement) largest = std::max(largest, std::abs(component));
  return recorded_.ranks().max(largest) > 0.0;
}

CrackState Recorder::crack_state(const StepRecord& record, const std::string& probe) const {
  const auto before = growth_.find(probe);
  return {separated_,
          cut_,
          record.external_work + record.numerical_work - record.stored_energy -
              (record.motion ? record.motion->kinetic_energy : 0.0),
          record.dissipated_energy,
          before == growth_.end() ? CrackGrowth{} : before->second,
          recorded_.ranks()};
}

void Recorder::note_growth(const StepRecord& record) {
  for (const ProbeSpecification& probe : case_.probes) {
    if (probe.field != "crack_resistance") continue;
    CrackGrowth& last = growth_[probe.name];
    const double grown =
        grown_area(points_, points_.sets.at(probe.set), crack_state(record, probe.name));
    if (grown > last.area) last = {grown, record.dissipated_energy};
  }
}

Checkpoint Recorder::checkpoint(const PathState& path) const {
  Checkpoint made{path, {}, 0, {}, {}};
  made.path.accepted.history = own_history(path.accepted.history, assembler_);
  if (!unwritten_) return made;
  made.unwritten.force = unwritten_->force;
  if (unwritten_->histories) {
    made.unwritten.told_stretches = written_histories_.told(body_.model.bonds().count());
  }
  return made;
}

void Recorder::go_on(const Checkpoint& checkpoint, const EarlierResults& earlier,
                     const std::vector<std::string>& support_sets,
                     const std::vector<ProbeColumns>& probes) {
  const PathState& path = checkpoint.path;
  for (const Row& row : earlier.decisions) decisions_.push_back(read_decision(row));
  if (!earlier.history.empty()) last_ = read_step(earlier.history.back(), support_sets, probes);
  for (const BondEnds& ends : newly_broken(path.accepted.history)) separated_.push_back(ends);
  find_growth(earlier, support_sets, probes);
  const bool is_unwritten =  // a rank may own no point
      recorded_.ranks().max(double(!checkpoint.unwritten.force.empty())) > 0.0;
  written_histories_.tell(is_unwritten ? std::span(checkpoint.unwritten.told_stretches)
                                       : bond_stretches(body_.model, path.accepted.history));
  if (is_unwritten) {
    State accepted = path.accepted;
    accepted.environment = body_.conditions->environment({accepted.stage, accepted.load});
    unwritten_ = fields(StateView(accepted), checkpoint.unwritten.force, path.pins.found.piece,
                        path.dynamics.velocity);
  }
}

void Recorder::find_growth(const EarlierResults& earlier,
                           const std::vector<std::string>& support_sets,
                           const std::vector<ProbeColumns>& probes) {
  if (!last_) return;
  for (const ProbeSpecification& probe : case_.probes) {
    if (probe.field != "crack_resistance") continue;
    // A step that grew without dissipation has the value 0, too, but does not change the result.
    double dissipated = 0.0;
    for (const Row& row : earlier.history) {
      const StepRecord record = read_step(row, support_sets, probes);
      if (record.probes.at(probe.name).front() != 0.0) dissipated = record.dissipated_energy;
    }
    const CrackState crack = crack_state(*last_, probe.name);
    growth_[probe.name] = {grown_area(points_, points_.sets.at(probe.set), crack), dissipated};
  }
}

void Recorder::decided(DecisionRecord record) {
  const bool finds_loads =
      body_.conditions->control() != nullptr || case_.solver.mode == Mode::arc_length;
  const bool has_failed = record.outcome != name(Outcome::converged) &&
                          (record.action == Decision::cut || record.action == Decision::stop);
  // A failed search may have left any value of the load.
  if (finds_loads && has_failed) record.load_factor = last_ ? last_->load_factor : 0.0;
  decisions_.push_back(record);
  results_.add(record);
  progress_.decision(record);
}

void Recorder::changed_solver(const std::string& reason) {
  DecisionRecord record;
  record.step = last_ ? last_->step + 1 : 1;
  record.stage = last_ ? last_->stage : 0.0;
  record.load_factor = last_ ? last_->load_factor : 0.0;
  record.action = Decision::change_linear_solver;
  record.reason = reason;
  decided(record);
}

void Recorder::finish() {
  if (unwritten_) results_.add_fields(*last_, unwritten_->view(case_.output.stress));
}

std::vector<BondEnds> Recorder::newly_broken(const History& history) {
  std::vector<char> broken = broken_bonds(body_.model, history);
  std::vector<BondEnds> ends;
  if (broken.empty()) return ends;
  broken_.resize(broken.size(), 0);
  const Bonds& bonds = body_.model.bonds();
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken[bond] || broken_[bond] || bonds.weight(bond) == 0.0) continue;
      if (!recorded_.tells(i, bonds.partner[bond])) continue;
      ends.push_back({i, bonds.partner[bond]});
    }
  }
  broken_ = std::move(broken);
  return ends;
}

void Recorder::record_broken_bonds(const StepRecord& record, const History& history) {
  std::vector<BrokenBondRecord> records;
  for (const BondEnds& ends : newly_broken(history)) {
    const auto [i, j] = ends;
    records.push_back({record.step, record.broke_at.value_or(record.load_factor),
                       recorded_.number(i), recorded_.number(j), image_number(points_, j)});
    separated_.push_back(ends);
  }
  results_.add(records);
}

}  // namespace peristat
