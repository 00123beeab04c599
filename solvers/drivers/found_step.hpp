#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "solvers/drivers/increment.hpp"
#include "solvers/drivers/path.hpp"

namespace peristat {

/// A step that was found and may be accepted.
struct FoundStep {
  StepRecord record;
  DamageGrowth growth;
  StepEnergies energies;
  Ledger ledger;  ///< with the step
};

/// Reactions of the support sets in a state, of all ranks [N].
[[nodiscard]] std::map<std::string, Coordinates> reactions(
    const Path& path, const Trial& state, const std::vector<double>& external_force);

/// Commits an equilibrium. Triangles and tetrahedra then lose what their bonds have lost, so that
/// the body is out of equilibrium again: it is equilibrated at the fixed load and committed until
/// nothing more is damaged.
/// @param equilibrate leaves the next equilibrium in `attempt`, and its outcome
void commit(Path& path, Attempt& attempt, FoundStep& found,
            const std::function<Outcome()>& equilibrate);

/// Closes the ledger of a step whose damage is committed, and checks what it owes.
/// @return what is wrong with it; the attempt's outcome is then inconsistent
[[nodiscard]] std::string complete(Path& path, Attempt& attempt, FoundStep& found);

/// Fills in what a row of the history tells of an attempt that has become the path's last accepted
/// state.
void complete_record(const Path& path, const Attempt& attempt, FoundStep& found);

/// Tells what has come off and is pinned.
/// @param next increment of the stage
void tell_of_fragments(const Path& path, double next);

/// Pins what was found to have come off, and tells it; ends the path if that is to end it.
[[nodiscard]] Advance resolve_fragments(Path& path, double next);

/// Cuts the next step after one that failed, and tells it, if a smaller one may help and is
/// allowed.
[[nodiscard]] bool cut(Path& path, Increment& increment, const Attempt& attempt, double attempted,
                       const std::string& reason);

/// Makes an attempt the path's last accepted state, tells it, and pins what has come free in it.
/// @param next increment of the stage, for what is told
[[nodiscard]] Advance accept(Path& path, Attempt attempt, FoundStep found, double next);

}  // namespace peristat
