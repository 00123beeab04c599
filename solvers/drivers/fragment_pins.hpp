#pragma once

#include <span>
#include <string>
#include <vector>

#include "solvers/problem/equilibrium.hpp"
#include "src/connectivity/fragments.hpp"

namespace peristat {

/// Treatment of pieces that come off, and of points with too few bonds.
enum class FragmentRemedy {
  hold,    ///< just enough of their degrees of freedom are pinned to prevent free motion
  remove,  ///< all degrees of freedom of a piece leave the equations; loose points are held
  stop,    ///< the run ends
};

/// Auxiliary constraints of fragments that have come off; they are neither supports nor reactions.
/// They do no work: pinned degrees of freedom don't move, and nothing moves when pins are removed.
/// A value, from which the equations are numbered (`free_dofs`).
struct FragmentPins {
  Fragments found;           ///< of the last search; empty before the first
  std::vector<char> pinned;  ///< per degree of freedom; empty before the first pins

  /// Finds fragments that have come off in a state; pins nothing yet. Collective if the body is
  /// partitioned, as are the sums.
  void find(const Assembler& assembler, const State& state, const Conditions& conditions,
            FragmentRemedy remedy);

  /// True if the last search requires other pins than there are.
  [[nodiscard]] bool are_outdated(const Sums& sums) const;

  /// Pins the fragments of the last search.
  void pin() { pinned = found.pinned; }

  /// Returns the equations, without prescribed and pinned degrees of freedom.
  [[nodiscard]] FreeDofs free_dofs(const std::vector<char>& prescribed, int dimension) const;

  /// 2-norm of the forces of the pins [N].
  [[nodiscard]] double force(const Sums& sums, const Trial& state,
                             std::span<const double> external_force) const;

  /// Describes the result of the last search.
  [[nodiscard]] std::string described(const Sums& sums) const;
};

}  // namespace peristat
