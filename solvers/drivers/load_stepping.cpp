#include "solvers/drivers/load_stepping.hpp"

#include <utility>

#include "solvers/drivers/drivers.hpp"

namespace peristat {

LoadSteppingResult follow_loading(const SolvedBody& body, const Conditions& conditions,
                                  const LoadSteppingOptions& options,
                                  const NewtonOptions& newton_options,
                                  const LoadSteppingObserver& observer,
                                  const SolvedBody* stand_in) {
  Path path({body, conditions, options, newton_options, observer, stand_in});
  const std::unique_ptr<Driver> driver = make_driver(options.mode, path);
  while (driver->advance() == Advance::goes_on) {
  }
  PathState& reached = path.state();
  return {path.outcome(), reached.steps, std::move(reached.accepted), reached.relaxation_seconds,
          std::move(path.last_attempt())};
}

}  // namespace peristat
