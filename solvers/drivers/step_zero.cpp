#include "solvers/drivers/step_zero.hpp"

#include <utility>

#include <fmt/format.h>

#include "solvers/drivers/implicit_stepping.hpp"
#include "src/conditions/preload.hpp"

namespace peristat {
namespace {

Preload preload_of(const Path& path) {
  return find_preload(path.setting().conditions, path.body().assembler.index_map().ranks());
}

std::string_view mode_at_rest(const Mode& mode) {
  return mode == Mode::adaptive ? Mode::newton.name : mode.name;
}

}  // namespace

bool rests_at_load_zero(const Path& path) {
  return path.state().accepted.preload == 0.0 && !preload_of(path).acts();
}

Advance accept_rest(Path& path) {
  const State& rest = path.state().accepted;
  const LoadPoint at = LoadPoint::of_preload(1.0);
  Attempt attempt;
  attempt.at = at;
  attempt.state.displacement = rest.displacement;
  attempt.state.history = rest.history;
  attempt.state.environment = path.setting().conditions.environment(at);
  attempt.external_force.resize(rest.displacement.size());
  evaluate(path.problem(), attempt.external_force, attempt.state);
  FoundStep found;
  found.record.mode = mode_at_rest(path.options().mode);
  found.ledger = path.state().ledger.entries;
  return accept(path, std::move(attempt), std::move(found), 0.0);
}

void begin_programme(Path& path, const Attempt& step_zero, const FoundStep& found) {
  PathState& state = path.state();
  state.implicit.increment = state.relaxed.increment = 0.0;
  if (const DisplacementControl* control = path.setting().conditions.control()) {
    state.control_at_load_zero = control->value(step_zero.state.displacement);
  }
  const Preload preload = preload_of(path);
  if (!preload.acts()) return;
  std::string reason = fmt::format("at load 0: {}, applied slowly from rest: work {:.6g} J",
                                   preload.description(), found.ledger.external_work);
  const double dissipated = found.ledger.dissipated;
  if (dissipated > 0.0 || found.record.broken_bonds > 0) {
    reason += fmt::format("; they damage the body: {} broken, {:.6g} J dissipated",
                          bonds_text(found.record.broken_bonds), dissipated);
  }
  path.tell(step_zero.at, {.outcome = name(Outcome::converged),
                           .action = Decision::preload,
                           .reason = std::move(reason)});
}

}  // namespace peristat
