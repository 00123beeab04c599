#include "solvers/drivers/path_ledger.hpp"

#include <algorithm>
#include <utility>

#include "src/core/number_text.hpp"

namespace peristat {
namespace {

/// An implicit step that releases more than this fraction of the body's energy has jumped over a
/// limit point.
constexpr double share_of_jump = 5e-3;

}  // namespace

void PathLedger::begin(const Trial& state, std::vector<double> working) {
  force = std::move(working);
  entries = {};
  entries.external_work = entries.stored = state.stored_energy;
}

Ledger PathLedger::with_step(const Sums& sums, std::span<const double> displacement_before,
                             const Trial& state, std::span<const double> working, double dissipated,
                             const StepEnergies& step) const {
  const auto work_of = [&](std::span<const double> force0, std::span<const double> force1,
                           std::span<const double> u0, std::span<const double> u1) {
    return trapezoidal_work(sums, force0, force1, u0, u1);
  };
  const auto work_on_the_way = [&] {
    if (step.is_elastic_preload) return state.stored_energy - entries.stored;
    if (!step.intact) {
      return step.heating + work_of(force, working, displacement_before, state.displacement);
    }
    const auto& [intact_force, intact] = *step.intact;
    return step.heating + work_of(force, intact_force, displacement_before, intact) +
           work_of(intact_force, working, intact, state.displacement);
  };
  const double work = work_on_the_way();
  Ledger after = entries;
  after.stored = state.stored_energy;
  after.dissipated = dissipated + released + step.released;
  after.external_work += work;
  if (step.relaxed) {
    after.numerical_work += step.relaxed->work - work;
    after.drained += step.relaxed->drained;
  }
  if (step.is_avalanche || (step.struts != 0.0 && !step.relaxed)) {
    after.drained += std::max(0.0, after.balance_error() - entries.balance_error());
  }
  return after;
}

void PathLedger::accept(const Ledger& with_step, std::vector<double> working,
                        const StepEnergies& step) {
  force = std::move(working);
  entries = with_step;
  released += step.released;
  struts += step.struts;
}

std::string PathLedger::jump_to(const Ledger& with_step) const {
  const double lost =
      with_step.balance_error() + with_step.drained - entries.balance_error() - entries.drained;
  if (lost <= share_of_jump * std::max(entries.stored, with_step.external_work)) return {};
  return number_text(lost) + " J of " + number_text(with_step.external_work) +
         " J are released that no work or dissipation accounts for: the body has jumped to another "
         "equilibrium";
}

}  // namespace peristat
