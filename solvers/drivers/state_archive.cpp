#include "solvers/drivers/state_archive.hpp"

#include <optional>
#include <utility>

namespace peristat {
namespace {

void transfer_optional(StateArchive& archive, const std::string& name,
                       std::optional<double>& value) {
  bool is_there = value.has_value();
  double held = value.value_or(0.0);
  archive.transfer(name + "_is_there", is_there);
  archive.transfer(name, held);
  value = is_there ? std::optional(held) : std::nullopt;
}

void transfer_history(StateArchive& archive, History& history) {
  int terms = static_cast<int>(history.terms());
  archive.transfer("accepted/terms", terms);
  for (int k = 0; k < terms; ++k) {
    const auto term = static_cast<std::size_t>(k);
    std::vector<double> values(history.of(term).begin(), history.of(term).end());
    archive.transfer("accepted/history_" + std::to_string(k), values);
    history.replace(term, std::move(values));
  }
}

void transfer_ledger(StateArchive& archive, PathLedger& ledger) {
  auto& [entries, released, force] = ledger;
  auto& [stored, dissipated, drained, external_work, numerical_work] = entries;
  archive.transfer("ledger/stored", stored);
  archive.transfer("ledger/dissipated", dissipated);
  archive.transfer("ledger/drained", drained);
  archive.transfer("ledger/external_work", external_work);
  archive.transfer("ledger/numerical_work", numerical_work);
  archive.transfer("ledger/released", released);
  archive.transfer("ledger/force", force);
}

void transfer_pins(StateArchive& archive, FragmentPins& pins) {
  auto& [found, pinned] = pins;
  auto& [piece, count, loose, found_pinned] = found;
  archive.transfer("pins/found/piece", piece);
  archive.transfer("pins/found/count", count);
  archive.transfer("pins/found/loose", loose);
  archive.transfer("pins/found/pinned", found_pinned);
  archive.transfer("pins/pinned", pinned);
}

}  // namespace

// The bindings name every member, so that none can be forgotten.
void transfer(StateArchive& archive, PathState& state) {
  auto& [accepted, steps, ledger, pins, stands_in, rungs, relaxation_seconds, implicit, relaxed,
         control_sign, arc, hand_over] = state;
  // Made anew from the stage, see Path.
  [[maybe_unused]] auto& [displacement, stage, history, load, environment] = accepted;
  archive.transfer("accepted/displacement", displacement);
  archive.transfer("accepted/stage", stage);
  transfer_optional(archive, "accepted/load", load);
  transfer_history(archive, history);
  archive.transfer("steps", steps);
  transfer_ledger(archive, ledger);
  transfer_pins(archive, pins);
  archive.transfer("stands_in", stands_in);
  auto& [body_rung, stand_in_rung] = rungs;
  archive.transfer("rungs/body", body_rung);
  archive.transfer("rungs/stand_in", stand_in_rung);
  archive.transfer("relaxation_seconds", relaxation_seconds);
  auto& [implicit_increment] = implicit;
  archive.transfer("implicit/increment", implicit_increment);
  auto& [relaxed_increment, motion] = relaxed;
  auto& [velocity] = motion;
  archive.transfer("relaxed/increment", relaxed_increment);
  archive.transfer("relaxed/velocity", velocity);
  archive.transfer("control_sign", control_sign);
  auto& [arc_increment, direction, stage_direction, displacement_scale, negative_pivots,
         passes_critical_point] = arc;
  archive.transfer("arc/increment", arc_increment);
  archive.transfer("arc/direction", direction);
  archive.transfer("arc/stage_direction", stage_direction);
  archive.transfer("arc/displacement_scale", displacement_scale);
  archive.transfer("arc/negative_pivots", negative_pivots);
  archive.transfer("arc/passes_critical_point", passes_critical_point);
  auto& [relaxes, is_near_onset, force_falls, peak_before] = hand_over;
  archive.transfer("hand_over/relaxes", relaxes);
  archive.transfer("hand_over/is_near_onset", is_near_onset);
  archive.transfer("hand_over/force_falls", force_falls);
  archive.transfer("hand_over/peak_before", peak_before);
}

}  // namespace peristat
