#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/search/dynamic_relaxation.hpp"
#include "solvers/search/newton.hpp"

namespace peristat {

/// Last search for equilibrium, with the data to report if it has failed.
struct Attempt {
  Outcome outcome = Outcome::converged;
  int iterations = 0;
  LoadPoint at = 0.0;
  double scale = 0.0;  ///< norm that the residual was measured against [N]
  std::optional<Inertia> inertia;
  bool has_negative_pivots = false;
  bool unstable_start = false;
  double largest_residual = 0.0;  ///< that counts as equilibrium [N]; negative: none required
  std::string note;               ///< remark to report if it is accepted
  Trial state;
  std::vector<double> external_force;

  [[nodiscard]] bool has_converged() const { return outcome == Outcome::converged; }
};

[[nodiscard]] Attempt to_attempt(NewtonResult result, const LoadPoint& at);
[[nodiscard]] Attempt to_attempt(RelaxationResult result, const LoadPoint& at);

/// Attempt that can't begin, since supports or loads have no value there.
[[nodiscard]] Attempt undefined_attempt(const State& from, const LoadPoint& at);

[[nodiscard]] State state_of(const Attempt& attempt);

/// True if a smaller step can help.
[[nodiscard]] bool worth_cutting(const Attempt& attempt);

/// True if relaxation may succeed where an implicit search has failed.
[[nodiscard]] bool worth_relaxing(const Attempt& attempt);

/// Describes why an attempt has failed.
/// @param what further details; may be empty
[[nodiscard]] std::string reason_of(const Attempt& attempt, const std::string& what);

}  // namespace peristat
