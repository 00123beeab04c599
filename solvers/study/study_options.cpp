#include "solvers/study/study_options.hpp"

#include <algorithm>
#include <string>

#include "solvers/drivers/drivers.hpp"
#include "src/core/input_error.hpp"
#include "src/core/number_text.hpp"

namespace peristat {
namespace {

void require_within(double value, double least, double most, const std::string& key) {
  if (value >= least && value <= most) return;  // not-a-number is in no range
  throw InputError(key, number_text(value),
                   "must be from " + number_text(least) + " to " + number_text(most));
}

void check_life_law(const LifeLaw& law, const std::string& key) {
  require_within(law.coefficient, 0.0, 1e300, key + ".coefficient");
  require_within(law.exponent, 0.1, 100.0, key + ".exponent");
  require_within(law.limit, 0.0, 1.0, key + ".limit");
}

void check_fatigue_options(const FatigueOptions& options) {
  check_life_law(options.nucleation, "fatigue.nucleation");
  check_life_law(options.growth, "fatigue.growth");
  require_within(options.load_ratio, -1.0, 0.999, "fatigue.load_ratio");
  require_within(options.cycles, 0.0, 1e18, "fatigue.cycles");
  require_within(options.blocks, 0, 1e9, "fatigue.blocks");
  require_within(options.life_tolerance, 0.0, 0.5, "fatigue.life_tolerance");
  require_within(options.crack_damage, 0.01, 1.0, "fatigue.crack_damage");
}

}  // namespace

void check_options(const StudyOptions& options) {
  const LoadSteppingOptions& loading = options.loading;
  const auto& drivers = all_drivers();
  if (std::none_of(drivers.begin(), drivers.end(),
                   [&](const DriverEntry& driver) { return driver.mode == loading.mode; })) {
    throw InputError("loading.mode", '"' + std::string(loading.mode.name) + '"',
                     "no driver of this name");
  }
  require_within(loading.steps, 1, 1'000'000, "loading.steps");
  require_within(loading.relaxation_steps, 1, 1e9, "loading.relaxation_steps");
  const double step = 1.0 / loading.steps;
  require_within(loading.smallest_step, 1e-12, step, "loading.smallest_step");
  if (loading.largest_step != 0.0)
    require_within(loading.largest_step, step, 1.0, "loading.largest_step");
  require_within(loading.stop_below, 0.0, 1.0, "loading.stop_below");
  require_within(options.newton.relative_tolerance, 1e-14, 1e-2, "newton.relative_tolerance");
  require_within(options.newton.linear_tolerance, 1e-14, 1e-1, "newton.linear_tolerance");
  require_within(options.newton.max_iterations, 1, 1000, "newton.max_iterations");
  require_within(loading.relaxation.relative_tolerance, 1e-14, 1e-2,
                 "loading.relaxation.relative_tolerance");
  require_within(loading.relaxation.flow_tolerance, 1e-3, 0.5, "loading.relaxation.flow_tolerance");
  require_within(loading.peak_tolerance, 0.0, 1.0, "loading.peak_tolerance");
  if (loading.relaxation.method == RelaxationMethod::flow && !loading.relaxation.holds)
    throw InputError("loading.relaxation.holds", "false", "is for method \"dynamic\"");
  const DynamicsOptions& dynamics = loading.dynamics;
  require_within(dynamics.time_step, 0.0, 1e30, "dynamics.time_step");
  require_within(dynamics.step_share, 1e-6, 0.99, "dynamics.step_share");
  require_within(dynamics.steps_per_row, 1, 1e9, "dynamics.steps_per_row");
  require_within(dynamics.spectral_radius, 0.0, 1.0, "dynamics.spectral_radius");
  if (dynamics.scheme == MotionScheme::newmark && dynamics.time_step == 0.0) {
    throw InputError("dynamics.time_step", "",
                     "is missing: implicit steps are stable at any length, so there is no stable "
                     "step to take a share of");
  }
  check_fatigue_options(loading.fatigue);
  const LinearSolverOptions& linear = options.linear;
  if ((linear.method == LinearMethod::cholesky || linear.method == LinearMethod::lu) &&
      linear.preconditioner != PreconditionerKind::automatic)
    throw InputError("linear.preconditioner", "", "is for iterative solvers");
  if (options.tangent == TangentStorage::matrix_free && !can_be_matrix_free(linear))
    throw InputError("tangent", "matrix_free",
                     "is not allowed with this linear.method or linear.preconditioner");
}

}  // namespace peristat
