#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "solvers/problem/equilibrium.hpp"
#include "solvers/problem/records.hpp"
#include "src/core/input_error.hpp"

namespace peristat {

struct PathState;

/// An accepted state, besides its record.
struct AcceptedState {
  const Trial& trial;  ///< with its damage committed
  const std::vector<double>& external_force;
  std::span<const std::int32_t> piece;  ///< per point, see Fragments; empty: none
  std::span<const double> velocity{};   ///< of a body in motion, per degree of freedom [m/s]
  /// Remaining lives of the bonds in cycles of the load, see RemainingLives; empty: none.
  std::span<const double> life{};
};

/// An equilibrium whose damage is not committed yet.
struct UncommittedState {
  const Trial& trial;
  const std::vector<double>& external_force;
  const LoadPoint& at;
};

/// Callbacks for what happens on a path; all members may be empty.
struct LoadSteppingObserver {
  std::function<void(const IterationRecord&)> iteration;
  std::function<void(const DecisionRecord&)> decision;
  /// Called before each commit of an implicit step, which may yet be given up.
  std::function<void(const UncommittedState&)> commits;
  /// Called for an accepted state. The record's energies, damage and reactions are set.
  std::function<void(const StepRecord&, const AcceptedState&)> accepted;
  /// Called with the state from which the path can be resumed: after an accepted step, once its
  /// driver has decided what is next.
  std::function<void(const PathState&)> reached;
  std::function<bool()> interrupted;
  /// Describes an error of supports or loads that shows only at some stage.
  std::function<std::string(const InputError&)> describe;
};

}  // namespace peristat
