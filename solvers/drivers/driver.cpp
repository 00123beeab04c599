#include "solvers/drivers/driver.hpp"

#include "solvers/drivers/step_zero.hpp"

namespace peristat {

Advance Driver::advance() {
  path_.forget_last_attempt();
  const Advance result = rests_at_load_zero(path_) ? accept_rest(path_) : next();
  path_.note_rungs();
  return result;
}

}  // namespace peristat
