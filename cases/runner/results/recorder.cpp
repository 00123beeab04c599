#include "cases/runner/results/recorder.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "assembly/terms/damage.hpp"
#include "cases/runner/results/state_values.hpp"
#include "cases/runner/results/tables/fatigue_columns.hpp"
#include "cases/runner/results/tables/motion_columns.hpp"
#include "cases/runner/results/tables/record_tables.hpp"
#include "solvers/observe/internal_force.hpp"
#include "src/geometry/image_number.hpp"

namespace peristat {
namespace {

/// True for fields of steps of the results, and of probes.
bool is_recorded(const PointField& field, const Case& from, bool has_contacts) {
  const bool is_probed = std::ranges::any_of(
      from.probes, [&](const ProbeSpecification& probe) { return probe.field == field.name; });
  if (is_probed || field.shown_by == ShownBy::probes) return is_probed;
  if (field.needs == FieldNeeds::stress) return from.output.stress;
  if (field.needs == FieldNeeds::contacts) return has_contacts;
  if (field.needs == FieldNeeds::fatigue) return from.solver.mode == Mode::fatigue;
  return field.needs == FieldNeeds::nothing || from.dynamics.is_asked_for;
}

}  // namespace

void Recorder::iteration(const IterationRecord& record) {
  relative_residual_ = record.relative_residual;
  results_.add(record);
  progress_.iteration(record);
}

Recorder::Fields Recorder::fields(const StateView& at, ObservedExtras extras) const {
  extras.count_cracks = case_.output.count_cracks;
  Observation observed(body_, assembler_, at, std::move(extras));
  Fields made;
  if (body_.model.failing_bonds()) {
    made.histories = written_histories_.changes(recorded_, body_.model.bonds(),
                                                bond_stretches(body_.model, at.history));
  }
  const double largest = recorded_.ranks().max(observed.stretches().largest);
  made.max_stretch = std::isfinite(largest) ? largest : 0.0;
  for (const PointField& field : point_fields()) {
    if (is_recorded(field, case_, assembler_.has_contacts()))
      static_cast<void>(observed.values(field.name));
  }
  made.values = observed.release();
  for (const double damage : made.values.at("damage")) {
    made.max_damage = std::max(made.max_damage, damage);
  }
  made.max_damage = recorded_.ranks().max(made.max_damage);
  return made;
}

void Recorder::accepted(StepRecord record, const AcceptedState& state) {
  unwritten_.reset();  // freed before new fields are made
  const StateView at = state.trial.at();
  Fields made = fields(at, {internal_force(body_, state.trial, state.external_force), state.piece,
                            state.velocity, state.life});
  record.max_stretch = made.max_stretch;
  record.max_damage = made.max_damage;
  record_broken_bonds(record, at.history);
  const std::string without_release = add_state_values(
      {case_, body_, assembler_, recorded_, driven_, crack_tips_}, state.trial,
      state.external_force, made.values,
      [&](const std::string& probe) { return crack_state(record, probe); }, record);
  note_growth(record);
  note_pressed(record);
  if (!without_release.empty()) {
    progress_.problem("step " + std::to_string(record.step) +
                      ": the body has no equilibrium with the cut ahead of " + without_release +
                      "; its energy release rates are reported as 0");
  }
  add_motion_values(record, points_.dimension, record.probes);
  add_fatigue_values(record, case_, record.probes);
  const bool is_at_rest =
      record.step == 0 && !record.motion && !moves(made.values.at("displacement"));
  for (const ProbeSpecification& probe : case_.probes) {
    if (is_at_rest || !probe.from) continue;
    const std::vector<LineValues> line = line_values(probe, recorded_, made.values);
    results_.add_line(probe.name, line_rows(line, points_.dimension, record));
  }
  const bool write_fields = record.step % case_.output.every == 0 && !is_at_rest;
  const StepFields none;
  results_.add(record, write_fields ? made : none);
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
  return separated_.cracks(record, before == growth_.end() ? CrackGrowth{} : before->second);
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
  made.unwritten.force = unwritten_->values.at("force");
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
  separated_.add_broken(path.accepted.history);
  find_growth(earlier, support_sets, probes);
  if (!case_.obstacles.empty()) {
    for (const Row& row : earlier.history) note_pressed(read_step(row, support_sets, probes));
  }
  const bool is_unwritten =  // a rank may own no point
      recorded_.ranks().max(double(!checkpoint.unwritten.force.empty())) > 0.0;
  written_histories_.tell(is_unwritten ? std::span(checkpoint.unwritten.told_stretches)
                                       : bond_stretches(body_.model, path.accepted.history));
  if (is_unwritten) {
    State accepted = path.accepted;
    accepted.environment = body_.conditions->environment({accepted.stage, accepted.load});
    unwritten_ = fields(StateView(accepted), {checkpoint.unwritten.force, path.pins.found.piece,
                                              path.dynamics.velocity, path.fatigue.lives.life});
  }
}

void Recorder::note_pressed(const StepRecord& record) {
  for (const ObstacleSpecification& obstacle : case_.obstacles) {
    const auto reaction = record.reactions.find(obstacle.name);
    if (reaction != record.reactions.end() && reaction->second != Coordinates{}) {
      pressed_.insert(obstacle.name);
    }
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
  if (unwritten_) results_.add_fields(*last_, *unwritten_);
}

void Recorder::record_broken_bonds(const StepRecord& record, const History& history) {
  std::vector<BrokenBondRecord> records;
  for (const BondEnds& ends : separated_.add_broken(history)) {
    const auto [i, j] = ends;
    records.push_back({record.step, record.broke_at.value_or(record.load_factor),
                       recorded_.number(i), recorded_.number(j), image_number(points_, j)});
  }
  results_.add(records);
}

}  // namespace peristat
