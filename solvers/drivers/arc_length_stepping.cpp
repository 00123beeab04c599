#include "solvers/drivers/arc_length_stepping.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/search/foreseen_contacts.hpp"
#include "solvers/search/linearisation.hpp"
#include "solvers/search/softest_mode.hpp"
#include "src/core/number_text.hpp"
#include "src/core/vector_verbs.hpp"

namespace peristat {
namespace {

/// Least cosine between a step and the tangent along which it goes, and between the tangents at its
/// ends.
constexpr double least_cosine = 0.9;
/// Least cosine at which an easy step lets the next one grow.
constexpr double straight_cosine = 0.99;

/// A critical point is located to this fraction of the step, the onset of damage to this fraction
/// of the first step.
constexpr double share_of_located = 1e-4, share_of_onset = 1e-3;

/// Contacts that close within this fraction of the first step count as closed at its begin.
constexpr double share_of_closed = 1e-3;

/// Steps shorter than this fraction of the first one that fail may turn where a contact closes. The
/// next step is longer by a factor.
constexpr double share_of_turn = 1e-3, growth_at_turn = 16.0;

/// Largest number of steps of a path for which none is given.
constexpr int most_steps = 10'000;

/// First step on a path that branches off: largest displacement over the body's extent. Nearer to
/// the bifurcation the two paths can hardly be distinguished.
constexpr double share_of_branch = 1e-3;

constexpr const char* follows_no_damage =
    "solver.mode = \"arc_length\" does not follow damage; a [[control]] does";

double extent(const Points& points) {
  double largest = 0.0;
  for (int c = 0; c < points.dimension; ++c) {
    double low = points.reference[std::size_t(c)], high = low;
    for (Index i = 0; i < points.count(); ++i) {
      low = std::min(low, points.position(i)[c]);
      high = std::max(high, points.position(i)[c]);
    }
    largest = std::max(largest, high - low);
  }
  return largest;
}

double largest_size(const std::vector<double>& entries) {
  double largest = 0.0;
  for (const double entry : entries) largest = std::max(largest, std::abs(entry));
  return largest;
}

/// A step that ends this near to the end of the load, relative to the rest before it, or beyond the
/// end, is made to end there.
constexpr double share_of_end = 1e-3;

LoadPoint at_stage(double stage) { return stage; }

NewtonOptions held(NewtonOptions options) {
  options.damage = Damage::held;
  return options;
}

}  // namespace

ArcLengthStepping::ArcLengthStepping(Path& path)
    : Driver(path),
      implicit_(path),
      increment_(path.options().steps, path.options().arc_length.largest_step,
                 {path.options().adaptive, path.options().smallest_step, path.options().growth},
                 path.state().arc.increment) {}

Advance ArcLengthStepping::next() {
  if (const auto ended = end()) return *ended;
  if (path_.is_preloading()) return put_on_preload();
  if (path_.state().arc.direction.empty() && begin() == Advance::ended) return Advance::ended;
  Step step = search(increment_.value());
  if (!step.attempt.has_converged()) return fail(std::move(step));
  const PathState::Arc& arc = path_.state().arc;
  if (step.negative_pivots != arc.negative_pivots && !arc.passes_critical_point) {
    return locate(std::move(step));
  }
  return accept(std::move(step), {});
}

std::optional<Advance> ArcLengthStepping::end() const {
  const int asked_for = path_.options().arc_length.steps, taken = path_.state().steps;
  if (!path_.goes_on() || (asked_for > 0 && taken >= asked_for)) return Advance::ended;
  if (taken < most_steps || asked_for > 0) return std::nullopt;
  Attempt attempt;
  attempt.outcome = Outcome::step_limit;
  attempt.at = load_point(path_.state().accepted);
  return path_.stop(std::move(attempt), increment_.value(), explanation(Outcome::step_limit));
}

Advance ArcLengthStepping::put_on_preload() {
  ImplicitStep step = implicit_.search(Damage::held);
  if (step.attempt.has_converged() && step.growth.utilisation > 1.0) {
    step.attempt.outcome = Outcome::damage_begins;
    step.fault = follows_no_damage;
  }
  if (step.attempt.has_converged()) implicit_.establish(step);
  return step.attempt.has_converged() ? implicit_.accept(std::move(step))
                                      : implicit_.fail(std::move(step));
}

Advance ArcLengthStepping::begin() {
  PathState& state = path_.state();
  const SolvedBody& body = path_.body();
  std::vector<double> rate, foreseen;
  if (body.assembler.has_contacts()) foreseen = state.accepted.displacement;
  const double closes = share_of_closed * increment_.value();
  const SharedEnvironment environment =
      path_.setting().conditions.environment(at_stage(state.accepted.stage + closes));
  const auto start = [&] {
    StateView at(state.accepted);
    at.foreseen = foreseen;
    if (!foreseen.empty()) at.environment = environment;
    return at;
  };
  const auto solve = [&](std::vector<double>& next) {
    const LinearOutcome found = find_rate(path_.problem(), body.solver, body.tangent, start(),
                                          at_stage, state.accepted.stage, rate);
    next = state.accepted.displacement;
    if (found == LinearOutcome::solved) add_scaled(next, closes, rate);
    return found;
  };
  const LinearOutcome outcome = predict_with_contacts(path_.problem(), foreseen, start, solve);
  if (outcome != LinearOutcome::solved) {
    Attempt attempt = undefined_attempt(state.accepted, load_point(state.accepted));
    attempt.outcome = outcome_of(outcome);
    return path_.stop(std::move(attempt), 0.0, explanation(outcome_of(outcome)));
  }
  state.arc.displacement_scale = norm(rate);
  state.arc.direction = std::move(rate);
  state.arc.stage_direction = 1.0;
  state.arc.negative_pivots = body.solver.inertia()->negative;
  return Advance::goes_on;
}

double ArcLengthStepping::product(std::span<const double> du, double dl, std::span<const double> dv,
                                  double dm) const {
  const double scale = path_.state().arc.displacement_scale;
  return 0.5 * (dot(du, dv) / (scale * scale) + dl * dm);
}

ArcLengthStepping::Step ArcLengthStepping::search(double length) {
  const State& from = path_.state().accepted;
  const PathState::Arc& arc = path_.state().arc;
  const double end = path_.setting().conditions.programme().end(), rest = end - from.stage;
  length = std::min(length, arc.stage_direction > 0.0 ? rest / arc.stage_direction : length);
  Step step;
  step.attempted = length;
  step.attempt = search_across(length);
  const double beyond_end = step.attempt.at.stage - end;
  if (step.attempt.has_converged() && beyond_end > -share_of_end * rest) {
    step.attempt = search_end(step.attempt);
  }
  if (step.attempt.outcome == Outcome::undefined_condition) step.fault = step.attempt.note;
  if (step.attempt.has_converged()) find_direction(step);
  if (step.attempt.has_converged()) judge(step);
  return step;
}

Attempt ArcLengthStepping::search_across(double length) {
  const State& from = path_.state().accepted;
  const PathState::Arc& arc = path_.state().arc;
  std::vector<double> weights = arc.direction;
  for (double& weight : weights) weight *= 0.5 / (arc.displacement_scale * arc.displacement_scale);
  const double stage_weight = 0.5 * arc.stage_direction;
  const double here = dot(weights, from.displacement) + stage_weight * from.stage;
  Prediction prediction{from.displacement, from.stage + length * arc.stage_direction, foreseen_};
  add_scaled(prediction.displacement, length, arc.direction);
  return path_.search(
      from, {at_stage, {weights, stage_weight, here + length}, from.stage, std::move(prediction)},
      held(path_.setting().newton_options));
}

Attempt ArcLengthStepping::search_end(const Attempt& near) {
  const State& from = path_.state().accepted;
  const double end = path_.setting().conditions.programme().end();
  const double share = (end - from.stage) / (near.at.stage - from.stage);
  Prediction prediction{from.displacement, end};
  for (double& entry : prediction.displacement) entry *= 1.0 - share;
  add_scaled(prediction.displacement, share, near.state.displacement);
  return path_.search(from, {at_stage, {{}, 1.0, end}, from.stage, std::move(prediction)},
                      held(path_.setting().newton_options));
}

void ArcLengthStepping::find_direction(Step& step) {
  const SolvedBody& body = path_.body();
  const State& from = path_.state().accepted;
  const Attempt& attempt = step.attempt;
  std::vector<double> rate;
  const LinearOutcome outcome =
      find_rate(path_.problem(), body.solver, body.tangent, attempt.state.at(Damage::held),
                at_stage, attempt.at.stage, rate);
  if (outcome != LinearOutcome::solved) {
    step.attempt.outcome = outcome_of(outcome);
    return;
  }
  step.negative_pivots = body.solver.inertia()->negative;
  std::vector<double> gone = attempt.state.displacement;
  add_scaled(gone, -1.0, from.displacement);
  const double gone_stage = attempt.at.stage - from.stage;
  const double sign = product(gone, gone_stage, rate, 1.0) < 0.0 ? -1.0 : 1.0;
  const double size = sign * std::sqrt(product(rate, 1.0, rate, 1.0));
  for (double& entry : rate) entry /= size;
  step.direction = std::move(rate);
  step.stage_direction = 1.0 / size;
}

void ArcLengthStepping::judge(Step& step) const {
  const PathState& state = path_.state();
  Attempt& attempt = step.attempt;
  const PathState::Arc& arc = state.arc;
  std::vector<double> gone = attempt.state.displacement;
  add_scaled(gone, -1.0, state.accepted.displacement);
  const double gone_stage = attempt.at.stage - state.accepted.stage;
  const double length = std::sqrt(product(gone, gone_stage, gone, gone_stage));
  const double along = product(gone, gone_stage, arc.direction, arc.stage_direction);
  const double turned =
      product(arc.direction, arc.stage_direction, step.direction, step.stage_direction);
  if (!(along >= least_cosine * length) || !(turned >= least_cosine)) {
    attempt.outcome = Outcome::sharp_turn;
    return;
  }
  if (path_.damaged().growth(attempt.state.at()).utilisation > 1.0) {
    attempt.outcome = Outcome::damage_begins;
    step.fault = follows_no_damage;
  }
}

Advance ArcLengthStepping::accept(Step step, const std::string& reason) {
  PathState& state = path_.state();
  step.found.record.mode = Mode::arc_length.name;
  step.found.record.newton_iterations = step.attempt.iterations;
  step.found.record.negative_pivots = step.negative_pivots;
  step.fault = complete(path_, step.attempt, step.found);
  if (!step.attempt.has_converged()) return fail(std::move(step));
  const double turned =
      product(state.arc.direction, state.arc.stage_direction, step.direction, step.stage_direction);
  const bool grows = reason.empty() && turned >= straight_cosine &&
                     step.attempt.iterations <= path_.options().easy_iterations &&
                     increment_.grow();
  path_.tell(step.attempt.at,
             {.increment = step.attempted,
              .outcome = name(step.attempt.outcome),
              .action = !step.attempt.note.empty() ? Decision::accept_at_round_off
                        : grows                    ? Decision::accept_and_grow
                                                   : Decision::accept,
              .next_increment = increment_.value(),
              .reason = !step.attempt.note.empty() ? step.attempt.note
                        : reason.empty() ? std::to_string(step.attempt.iterations) + " iterations"
                                         : reason});
  const bool has_branched = state.arc.stage_direction == 0.0;
  if (has_branched || step.negative_pivots != state.arc.negative_pivots) {
    state.arc.passes_critical_point = false;
  }
  state.arc.direction = std::move(step.direction);
  state.arc.stage_direction = step.stage_direction;
  state.arc.negative_pivots = step.negative_pivots;
  foreseen_.clear();
  return peristat::accept(path_, std::move(step.attempt), std::move(step.found),
                          increment_.value());
}

Advance ArcLengthStepping::locate(Step beyond) {
  const std::int64_t before_pivots = path_.state().arc.negative_pivots;
  double low = 0.0, high = beyond.attempted;
  const double resolution = share_of_located * high;
  std::optional<Step> before;
  while (high - low > resolution) {
    Step middle = search(0.5 * (low + high));
    if (!middle.attempt.has_converged()) return fail(std::move(middle));
    const bool is_before = middle.negative_pivots == before_pivots;
    (is_before ? low : high) = middle.attempted;
    if (is_before) {
      before = std::move(middle);
    } else {
      beyond = std::move(middle);
    }
  }
  const PathState::Arc& arc = path_.state().arc;
  const double stage_direction = before ? before->stage_direction : arc.stage_direction;
  const bool turns = stage_direction * beyond.stage_direction < 0.0;
  const LoadPoint at = before ? before->attempt.at : load_point(path_.state().accepted);
  const Conditions& conditions = path_.setting().conditions;
  path_.tell(at, {.increment = high,
                  .outcome = name(Outcome::converged),
                  .action = Decision::locate,
                  .next_increment = increment_.value(),
                  .reason = std::string(turns ? "a limit point" : "a bifurcation") +
                            " between load factors " + number_text(conditions.load_factor(at)) +
                            " and " + number_text(conditions.load_factor(beyond.attempt.at)) +
                            ": negative pivots from " + std::to_string(before_pivots) + " to " +
                            std::to_string(beyond.negative_pivots)});
  if (before && accept(std::move(*before), "just before it") == Advance::ended) {
    return Advance::ended;
  }
  path_.state().arc.passes_critical_point = true;
  const bool branches = !turns && before_pivots == 0 && path_.options().arc_length.branches_off;
  return branches ? branch_off(beyond.negative_pivots) : Advance::goes_on;
}

Advance ArcLengthStepping::branch_off(std::int64_t modes) {
  PathState& state = path_.state();
  std::vector<double> mode;
  const SolvedBody& body = path_.body();
  const LinearOutcome outcome =
      find_softest_mode(path_.problem(), body.solver, body.tangent, {state.accepted}, mode);
  if (outcome != LinearOutcome::solved) {
    Attempt attempt = undefined_attempt(state.accepted, load_point(state.accepted));
    attempt.outcome = outcome_of(outcome);
    return path_.stop(std::move(attempt), 0.0, explanation(outcome_of(outcome)));
  }
  const double size = std::sqrt(product(mode, 0.0, mode, 0.0));
  for (double& entry : mode) entry /= size;
  state.arc.direction = std::move(mode);
  state.arc.stage_direction = 0.0;
  increment_.enlarge_to(share_of_branch * extent(body.assembler.points()) /
                        largest_size(state.arc.direction));
  path_.tell(
      load_point(state.accepted),
      {.outcome = name(Outcome::converged),
       .action = Decision::branch_off,
       .next_increment = increment_.value(),
       .reason = modes == 1
                     ? "along the eigenvector of the vanishing pivot; the path straight on is "
                       "unstable from here"
                     : "along one of " + std::to_string(modes) +
                           " eigenvectors whose pivots vanish together; their combinations need "
                           "not be paths, so choose one with a small load or a perturbed lattice"});
  return Advance::goes_on;
}

bool ArcLengthStepping::turn(const Step& step) {
  PathState& state = path_.state();
  PathState::Arc& arc = state.arc;
  const SolvedBody& body = path_.body();
  const bool is_short = step.attempted < share_of_turn / path_.options().steps;
  if (!is_short || !worth_cutting(step.attempt) || !body.assembler.has_contacts() ||
      !foreseen_.empty() || arc.stage_direction == 0.0) {
    return false;
  }
  std::vector<double> ahead = state.accepted.displacement;
  add_scaled(ahead, growth_at_turn * step.attempted, arc.direction);
  move_followers(path_.problem(), ahead);
  StateView at(state.accepted, Damage::held);
  at.foreseen = state.accepted.displacement;
  const std::vector<Index> closed = body.assembler.closed_contacts(at);
  at.foreseen = ahead;
  at.environment = path_.setting().conditions.environment(
      at_stage(state.accepted.stage + growth_at_turn * step.attempted * arc.stage_direction));
  if (body.assembler.closed_contacts(at) == closed) return false;
  std::vector<double> rate;
  if (find_rate(path_.problem(), body.solver, body.tangent, at, at_stage, state.accepted.stage,
                rate) != LinearOutcome::solved) {
    return false;
  }
  const std::int64_t before = arc.negative_pivots, behind = body.solver.inertia()->negative;
  const bool turns = (before - behind) % 2 != 0;
  const double sign = (arc.stage_direction > 0.0) == turns ? -1.0 : 1.0;
  const double size = sign * std::sqrt(product(rate, 1.0, rate, 1.0));
  for (double& entry : rate) entry /= size;
  arc.direction = std::move(rate);
  arc.stage_direction = 1.0 / size;
  arc.negative_pivots = behind;
  foreseen_ = std::move(ahead);
  increment_.enlarge_to(growth_at_turn * step.attempted);
  path_.tell(load_point(state.accepted),
             {.increment = step.attempted,
              .outcome = name(step.attempt.outcome),
              .action = Decision::locate,
              .next_increment = increment_.value(),
              .reason = std::string("a contact closes, and the path turns") +
                        (turns ? ", a limit point: negative pivots from " + std::to_string(before) +
                                     " to " + std::to_string(behind)
                               : "")});
  return true;
}

Advance ArcLengthStepping::fail(Step step) {
  Attempt& attempt = step.attempt;
  const std::string reason = reason_of(attempt, step.fault);
  const bool is_located = attempt.outcome == Outcome::damage_begins &&
                          step.attempted < share_of_onset / path_.options().steps;
  if (turn(step)) return Advance::goes_on;
  if (!is_located && cut(path_, increment_, attempt, step.attempted, reason)) {
    return Advance::goes_on;
  }
  return path_.stop(std::move(attempt), step.attempted, reason);
}

}  // namespace peristat
