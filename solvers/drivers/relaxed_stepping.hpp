#pragma once

#include <string>

#include "solvers/drivers/driver.hpp"
#include "solvers/drivers/increment.hpp"
#include "solvers/drivers/relaxed_step.hpp"

namespace peristat {

/// Steps by dynamic relaxation or by the flow. A step that fails is cut and tried again.
class RelaxedStepping : public Driver {
 public:
  /// Method for the last iterations of a step that holds.
  enum class Finish { relaxation, newton };

  explicit RelaxedStepping(Path& path, Finish finish = Finish::relaxation);

  struct Found {
    RelaxedStep step;
    double attempted = 0.0;  ///< increment of the stage
    std::string fault;       ///< details of a failure beside its outcome
  };
  /// Relaxes the next step, commits its damage, and checks it.
  [[nodiscard]] Found search();
  /// @param what further text for its report; may be empty
  [[nodiscard]] Advance accept(Found found, const std::string& what = {});
  /// Cuts the step, or ends the path.
  [[nodiscard]] Advance fail(Found found);

  [[nodiscard]] Increment& increment() { return increment_; }

 protected:
  [[nodiscard]] Advance next() override;

 private:
  Finish finish_;
  Increment increment_;
};

}  // namespace peristat
