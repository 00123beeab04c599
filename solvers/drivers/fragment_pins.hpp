#pragma once

#include <span>
#include <string>
#include <vector>

#include "solvers/problem/equilibrium.hpp"
#include "src/connectivity/fragments.hpp"

namespace peristat {

/// What becomes of pieces that come off, and of points that hang on too few bonds.
enum class FragmentRemedy {
  hold,    ///< just enough of their degrees of freedom are pinned that they can't move freely
  remove,  ///< all degrees of freedom of a piece leave the equations; loose points are held
  stop,    ///< the run ends
};

/// Pins that hold what has come off: no support, and no reaction. They do no work: what they hold
/// doesn't move, and when they are taken away nothing follows them. A value, from which the
/// equations are numbered (`free_dofs`).
struct FragmentPins {
  Fragments found;           ///< looked for last; empty before anything was
  std::vector<char> pinned;  ///< per degree of freedom; empty before anything was

  /// Looks for what has come off in a state; nothing is pinned yet. Of a shared body this and the
  /// sums are calls that all ranks make.
  void find(const Assembler& assembler, const State& state, const Conditions& conditions,
            FragmentRemedy remedy);

  /// Whether what was found last asks for other pins than there are.
  [[nodiscard]] bool are_outdated(const Sums& sums) const;

  /// Pins what was found last.
  void pin() { pinned = found.pinned; }

  /// The equations, without what is prescribed or pinned.
  [[nodiscard]] FreeDofs free_dofs(const std::vector<char>& prescribed, int dimension) const;

  /// Forces of the pins, their 2-norm [N].
  [[nodiscard]] double force(const Sums& sums, const Trial& state,
                             std::span<const double> external_force) const;

  /// What was found last, for a person.
  [[nodiscard]] std::string described(const Sums& sums) const;
};

}  // namespace peristat
