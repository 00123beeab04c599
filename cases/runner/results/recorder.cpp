#include "cases/runner/results/recorder.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "assembly/terms/bonds/point_stretches.hpp"
#include "assembly/terms/damage.hpp"

namespace peristat {

StepFields Recorder::Fields::view() const {
  return {&displacement,
          &force,
          &damage,
          &energy_density,
          &stretch,
          &fragment,
          histories ? &*histories : nullptr};
}

void Recorder::iteration(const IterationRecord& record) {
  relative_residual_ = record.relative_residual;
  results_.add(record);
  progress_.iteration(record);
}

void Recorder::accepted(StepRecord record, const AcceptedState& state) {
  const std::size_t points = points_.volume.size();
  const StateView at = state.trial.at();
  const std::span<const double> stretches = bond_stretches(body_.model, at.history);
  Fields made{state.trial.displacement,
              state.trial.gradient,
              std::vector<double>(points),
              std::vector<double>(points),
              std::vector<double>(points),
              std::vector<double>(points, 0.0),
              written_histories_.changes(body_.model.bonds(), stretches)};
  for (double& force : made.force) force = -force;
  assembler_.point_energies(at, made.energy_density);
  point_stretches(points_, body_.model, at, made.stretch);
  record.max_stretch = *std::max_element(made.stretch.begin(), made.stretch.end());
  const auto cut_weight =
      case_.output.count_cracks ? std::span(body_.cut_weight) : std::span<const double>();
  record.max_damage = assess_damage(body_.model, at.history, cut_weight, made.damage).max_damage;
  std::copy(state.piece.begin(), state.piece.end(), made.fragment.begin());
  record_broken_bonds(record, at.history);
  for (std::size_t i = 0; i < points; ++i) made.energy_density[i] /= points_.volume[i];
  const StepFields fields = made.view();
  for (const ProbeSpecification& probe : case_.probes) {
    record.probes[probe.name] = probe_values(probe, points_, fields, separated_);
  }
  const bool write_fields = record.step % case_.output.every == 0;
  results_.add(record, write_fields ? std::optional(fields) : std::nullopt);
  if (write_fields) written_histories_.tell(stretches);
  progress_.accepted(record, relative_residual_);
  last_ = std::move(record);
  unwritten_.reset();
  if (!write_fields) unwritten_ = std::move(made);
}

void Recorder::decided(const DecisionRecord& record) {
  decisions_.push_back(record);
  results_.add(record);
  progress_.decision(record);
}

void Recorder::changed_solver(const std::string& reason) {
  DecisionRecord record;
  record.step = last_ ? last_->step + 1 : 1;
  record.load_factor = last_ ? last_->load_factor : 0.0;
  record.action = Decision::change_linear_solver;
  record.reason = reason;
  decided(record);
}

void Recorder::finish() {
  if (unwritten_) results_.add_fields(*last_, unwritten_->view());
}

void Recorder::record_broken_bonds(const StepRecord& record, const History& history) {
  std::vector<char> broken = broken_bonds(body_.model, history);
  if (broken.empty()) return;
  broken_.resize(broken.size(), 0);
  std::vector<BrokenBondRecord> records;
  const Bonds& bonds = body_.model.bonds();
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      if (!broken[bond] || broken_[bond]) continue;
      records.push_back({record.step, record.load_factor, i, bonds.partner[bond]});
      separated_.push_back({i, bonds.partner[bond]});
    }
  }
  broken_ = std::move(broken);
  results_.add(records);
}

}  // namespace peristat
