#include "solvers/drivers/load_stepping.hpp"

#include <utility>

#include "solvers/drivers/drivers.hpp"

namespace peristat {
namespace {

void follow_to_end(Path& path) {
  const std::unique_ptr<Driver> driver = make_driver(path.options().mode, path);
  const auto& reached = path.setting().observer.reached;
  for (Advance advance = Advance::goes_on; advance == Advance::goes_on;) {
    const int before = path.next_step();
    advance = driver->advance();
    // A state whose path failed right after it is not passed on: a resumed path starts from the
    // step before and fails again.
    const bool can_go_on = advance == Advance::goes_on || path.outcome() == Outcome::converged;
    if (reached && can_go_on && path.next_step() > before) reached(path.state());
  }
}

}  // namespace

LoadSteppingResult follow_loading(const PathSetting& setting, const PathState* from) {
  Path path = from ? Path(setting, *from) : Path(setting);
  if (from && path.prepare_solvers() != LinearOutcome::solved) {
    return {Outcome::out_of_memory, from->steps, from->accepted, from->relaxation_seconds, {}};
  }
  follow_to_end(path);
  PathState& reached = path.state();
  return {path.outcome(), reached.steps, std::move(reached.accepted), reached.relaxation_seconds,
          std::move(path.last_attempt())};
}

}  // namespace peristat
