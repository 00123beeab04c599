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

/// Reactions of the support sets in a state, summed over all ranks [N].
[[nodiscard]] std::map<std::string, Coordinates> reactions(
    const Path& path, const Trial& state, const std::vector<double>& external_force);

/// Commits an equilibrium. Triangles and tetrahedra then lose the integrity that their bonds have
/// lost, so that the body is out of equilibrium again: it is equilibrated at the fixed load and
/// committed until nothing more is damaged.
/// @param equilibrate stores the next equilibrium in `attempt`, and returns its outcome
void commit(Path& path, Attempt& attempt, FoundStep& found,
            const std::function<Outcome()>& equilibrate);

/// Closes the ledger of a step whose damage is committed, and checks its balances.
/// @return why the step is refused, with the attempt's outcome changed accordingly; empty if it is
///         not
[[nodiscard]] std::string complete(Path& path, Attempt& attempt, FoundStep& found);

/// Fills in the row of the history for an attempt that has become the path's last accepted state.
void complete_record(const Path& path, const Attempt& attempt, FoundStep& found);

/// Reports fragments that have come off and are pinned.
/// @param next increment of the stage
void tell_of_fragments(const Path& path, double next);

/// Pins fragments that were found, and reports it; ends the path if they shall end it.
[[nodiscard]] Advance resolve_fragments(Path& path, double next);

/// Cuts the next step after one that failed, and reports it, if a smaller one may help and is
/// allowed.
[[nodiscard]] bool cut(Path& path, Increment& increment, const Attempt& attempt, double attempted,
                       const std::string& reason);

/// Makes an attempt the path's last accepted state, reports it, and pins fragments that have come
/// off.
/// @param next increment of the stage, for the report
[[nodiscard]] Advance accept(Path& path, Attempt attempt, FoundStep found, double next);

}  // namespace peristat
