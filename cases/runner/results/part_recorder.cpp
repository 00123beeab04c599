#include "cases/runner/results/part_recorder.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "assembly/terms/bonds/point_stretches.hpp"
#include "assembly/terms/damage.hpp"
#include "cases/runner/results/part_probe.hpp"
#include "src/geometry/counts_bond.hpp"

namespace peristat {

StepFields PartRecorder::Fields::view() const {
  return {&displacement,
          &force,
          &damage,
          &energy_density,
          &stretch,
          &fragment,
          histories ? &*histories : nullptr};
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
  constexpr double none = -std::numeric_limits<double>::infinity();
  const std::vector<char> broken = broken_bonds(body_.model, at.history);
  const bool has_bonds =  // of which there may be none on this rank
      body_.model.bonds().count() > 0 && (broken.empty() || std::ranges::count(broken, 0) > 0);
  double largest = none;
  if (has_bonds) largest = point_stretches(body_.points, body_.model, at, stretch);
  largest = gathering_.part().ranks().max(largest);
  return largest == none ? 0.0 : largest;
}

PartRecorder::Fields PartRecorder::fields(const StateView& at, std::vector<double> force,
                                          std::span<const std::int32_t> piece) const {
  const auto owned = std::size_t(gathering_.part().owned());
  const std::size_t dofs = owned * std::size_t(body_.points.dimension);
  Fields made;
  made.displacement.assign(at.displacement.begin(), at.displacement.begin() + std::ptrdiff_t(dofs));
  made.force = std::move(force);
  made.force.resize(dofs);
  made.damage.resize(body_.points.volume.size());
  const auto cut_weight =
      case_.output.count_cracks ? std::span(body_.cut_weight) : std::span<const double>();
  made.max_damage = assembler_.assess(at.history, cut_weight, made.damage).max_damage;
  made.damage.resize(owned);
  made.fragment.assign(owned, 0.0);
  std::copy_n(piece.begin(), std::min(piece.size(), owned), made.fragment.begin());
  const std::span<const double> stretches = bond_stretches(body_.model, at.history);
  const auto changed = written_histories_.changes(body_.points, body_.model.bonds(), stretches);
  if (body_.model.failing_bonds()) {  // of which this rank may have none
    made.histories = histories_of_all(changed.value_or(BondHistories()));
  }
  made.energy_density.resize(body_.points.volume.size());
  assembler_.point_energies(at, made.energy_density);
  made.energy_density.resize(owned);
  for (std::size_t i = 0; i < owned; ++i) made.energy_density[i] /= body_.points.volume[i];
  return made;
}

std::vector<PartRecorder::ToldBond> PartRecorder::of_all(const std::vector<ToldBond>& mine) const {
  std::vector<double> flat;
  for (const ToldBond& bond : mine) {
    const auto [i, j] = bond.ends;
    if (!counts_bond(body_.points, i, j)) continue;
    const double a = whole_number_[std::size_t(i)], b = whole_number_[std::size_t(j)];
    flat.insert(flat.end(), {std::min(a, b), std::max(a, b), bond.stretch});
  }
  flat = numbers_of(gathered(gathering_.part().ranks(), flat));
  std::vector<ToldBond> all;
  for (std::size_t k = 0; k < flat.size(); k += 3) {
    all.push_back({{Index(flat[k]), Index(flat[k + 1])}, flat[k + 2]});
  }
  std::sort(all.begin(), all.end(),
            [](const ToldBond& a, const ToldBond& b) { return a.ends < b.ends; });
  return all;
}

std::optional<BondHistories> PartRecorder::histories_of_all(const BondHistories& mine) const {
  std::vector<ToldBond> changed;
  for (std::size_t k = 0; k < mine.first_point.size(); ++k) {
    changed.push_back({{mine.first_point[k], mine.second_point[k]}, mine.largest_stretch[k]});
  }
  const std::vector<ToldBond> all = of_all(changed);
  if (results_ == nullptr) return std::nullopt;
  BondHistories histories;
  for (const auto& [ends, stretch] : all) {
    histories.first_point.push_back(ends[0]);
    histories.second_point.push_back(ends[1]);
    histories.largest_stretch.push_back(stretch);
  }
  return histories;
}

void PartRecorder::record_broken_bonds(const StepRecord& record, const History& history) {
  if (!body_.model.failing_bonds()) return;
  const std::vector<char> broken = broken_bonds(body_.model, history);
  broken_.resize(broken.size(), 0);
  const Bonds& bonds = body_.model.bonds();
  std::vector<ToldBond> newly;
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const auto b = std::size_t(bond);
      if (broken[b] && !broken_[b] && bonds.weight(bond) != 0.0) {
        newly.push_back({{i, bonds.partner[b]}, 0.0});
      }
    }
  }
  broken_ = broken;
  std::vector<BrokenBondRecord> records;
  for (const ToldBond& bond : of_all(newly)) {
    records.push_back({record.step, record.load_factor, bond.ends[0], bond.ends[1]});
  }
  if (results_ != nullptr) results_->add(records);
}

void PartRecorder::accepted(StepRecord record, const AcceptedState& state) {
  const StateView at = state.trial.at();
  std::vector<double> force = state.trial.gradient;
  for (double& component : force) component = -component;
  Fields made = fields(at, std::move(force), state.piece);
  made.stretch.resize(body_.points.volume.size());
  record.max_stretch = find_stretches(at, made.stretch);
  made.stretch.resize(std::size_t(gathering_.part().owned()));
  record.max_damage = made.max_damage;
  record_broken_bonds(record, at.history);
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
  if (write_fields) written_histories_.tell(bond_stretches(body_.model, at.history));
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
