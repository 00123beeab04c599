#include "solvers/drivers/relaxed_stepping.hpp"

#include <utility>

namespace peristat {
namespace {

/// Newton's method finishes the flow, which uses the solver anyway; a step that does not hold has
/// nothing to finish.
RelaxedStepping::Finish finish_of(const RelaxationOptions& options, RelaxedStepping::Finish asked) {
  if (!options.holds) return RelaxedStepping::Finish::relaxation;
  return options.method == RelaxationMethod::flow ? RelaxedStepping::Finish::newton : asked;
}

}  // namespace

RelaxedStepping::RelaxedStepping(Path& path, Finish finish)
    : Driver(path),
      finish_(finish_of(path.options().relaxation, finish)),
      increment_(path.options().relaxation_steps, 0.0,
                 {path.options().adaptive, path.options().smallest_step, path.options().growth},
                 path.state().relaxed.increment) {}

Advance RelaxedStepping::next() {
  if (!path_.goes_on()) return Advance::ended;
  Found found = search();
  return found.step.attempt.has_converged() ? accept(std::move(found)) : fail(std::move(found));
}

RelaxedStepping::Found RelaxedStepping::search() {
  const State& from = path_.state().accepted;
  const LoadPoint target = increment_.next_point(load_point(from));
  Found found{RelaxedStep(from), Increment::length(load_point(from), target), {}};
  RelaxedStep& step = found.step;
  if (const auto refusal = path_.refusal_of_conditions(target)) {
    step.attempt = undefined_attempt(from, target);
    found.fault = *refusal;
    return found;
  }
  const RelaxationMotion motion = path_.state().relaxed.motion;
  const auto equilibrate = [&] {
    if (finish_ == Finish::newton) {
      relax_and_finish(path_, step, target);
    } else {
      relax_towards(path_, step, target, path_.options().relaxation);
    }
    return step.attempt.outcome;
  };
  if (equilibrate() == Outcome::converged && path_.options().relaxation.holds) {
    commit(path_, step.attempt, step.found, equilibrate);
  }
  const bool damages = path_.is_preloading() && step.found.growth.degrading > 0;
  if (damages && increment_.refine_preload(found.attempted)) {
    path_.state().relaxed.motion = motion;
    return search();
  }
  if (step.attempt.has_converged()) found.fault = complete(path_, step.attempt, step.found);
  if (!step.attempt.has_converged()) path_.state().relaxed.motion = motion;
  return found;
}

Advance RelaxedStepping::accept(Found found, const std::string& what) {
  const bool grew = increment_.grow();
  const Attempt& attempt = found.step.attempt;
  path_.tell(attempt.at, {.increment = found.attempted,
                          .outcome = name(attempt.outcome),
                          .action = grew ? Decision::accept_and_grow : Decision::accept,
                          .next_increment = increment_.value(),
                          .reason = std::to_string(found.step.found.record.relaxation_iterations) +
                                    " iterations of relaxation" + what});
  return peristat::accept(path_, std::move(found.step.attempt), std::move(found.step.found),
                          increment_.value());
}

Advance RelaxedStepping::fail(Found found) {
  Attempt& attempt = found.step.attempt;
  const std::string reason = reason_of(attempt, found.fault);
  if (cut(path_, increment_, attempt, found.attempted, reason)) return Advance::goes_on;
  return path_.stop(std::move(attempt), found.attempted, reason);
}

}  // namespace peristat
