#include "solvers/path_ledger.hpp"

#include <algorithm>

#include "src/number_text.hpp"

namespace peristat {
namespace {

/// Share of the body's energy whose release in an implicit step is a jump over a limit point.
constexpr double share_of_jump = 5e-3;

double trapezoidal_work(const std::vector<double>& force0, const std::vector<double>& force1,
                        std::span<const double> u0, std::span<const double> u1) {
  double work = 0.0;
  for (std::size_t k = 0; k < u0.size(); ++k)
    work += 0.5 * (force0[k] + force1[k]) * (u1[k] - u0[k]);
  return work;
}

}  // namespace

/// Forces that do work on the body: loads, and on prescribed degrees of freedom what holds them,
/// which is dE/dx there. Pins of fragments do none: they don't move, and when they are taken away
/// nothing follows them.
std::vector<double> PathLedger::working_force(const Trial& state,
                                              std::span<const double> external_force) const {
  std::vector<double> force(external_force.begin(), external_force.end());
  for (std::size_t dof = 0; dof < force.size(); ++dof) {
    if (prescribed_[dof]) force[dof] = state.gradient[dof];
  }
  return force;
}

void PathLedger::begin(const Trial& state, std::span<const double> external_force) {
  force_ = working_force(state, external_force);
  entries_ = {};
  entries_.external_work = entries_.stored = state.stored_energy;
}

Ledger PathLedger::with_step(std::span<const double> displacement_before, const Trial& state,
                             std::span<const double> external_force, double dissipated,
                             const StepEnergies& step) const {
  const double work = trapezoidal_work(force_, working_force(state, external_force),
                                       displacement_before, state.displacement);
  Ledger entries = entries_;
  entries.stored = state.stored_energy;
  entries.dissipated = dissipated + released_ + step.released;
  entries.external_work += work;
  if (step.relaxed) {
    entries.numerical_work += step.relaxed->work - work;
    entries.drained += step.relaxed->drained;
  }
  return entries;
}

void PathLedger::accept(const Ledger& with_step, const Trial& state,
                        std::span<const double> external_force, const StepEnergies& step) {
  force_ = working_force(state, external_force);
  entries_ = with_step;
  released_ += step.released;
}

std::string PathLedger::jump_to(const Ledger& with_step) const {
  const double released = with_step.balance_error() - entries_.balance_error();
  if (released <= share_of_jump * std::max(entries_.stored, with_step.external_work)) return {};
  return number_text(released) + " J of " + number_text(with_step.external_work) +
         " J are released and taken up by nobody: the body has jumped to another equilibrium";
}

}  // namespace peristat
