#include "solvers/drivers/path.hpp"

#include <stdexcept>
#include <utility>

#include "solvers/drivers/increment.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {

namespace {

/// Returns the message of the first rank that has one. Collective.
std::optional<std::string> first_of_all(const Communicator& ranks,
                                        const std::optional<std::string>& mine) {
  std::string first;
  ranks.gather(mine.value_or(""), [&](int, const std::string& theirs) {
    if (first.empty()) first = theirs;
  });
  ranks.broadcast(first);
  return first.empty() ? std::nullopt : std::optional(first);
}

}  // namespace

Path::Path(const PathSetting& setting) : setting_(setting) {
  state_.stands_in = setting.stand_in != nullptr;
  const Conditions& conditions = setting.conditions;
  Trial reference;
  reference.displacement.assign(conditions.prescribed().size(), 0.0);
  reference.history = damaged().initial_history();
  const double preload = conditions.programme().is_of_time() ? 1.0 : 0.0;
  const LoadPoint begin = LoadPoint::of_preload(preload);
  reference.environment = conditions.environment(begin);
  std::vector<double> external_force(reference.displacement.size());
  conditions.external_force(begin, external_force);
  evaluate(problem(), external_force, reference);
  state_.ledger.begin(reference, working_force(reference, external_force));
  state_.accepted = {reference.displacement, 0.0,    reference.history, {},
                     reference.environment,  preload};
  note_rungs();
}

Path::Path(const PathSetting& setting, PathState from)
    : setting_(setting), state_(std::move(from)) {
  if (state_.stands_in && !setting.stand_in) {
    throw std::logic_error("a path that its stand-in carries goes on with the stand-in");
  }
  state_.accepted.environment = setting.conditions.environment(load_point(state_.accepted));
  if (!setting.body.assembler.index_map().is_whole()) {  // whose states do not include images
    setting.conditions.constraints().move(state_.accepted.displacement);
  }
  number_equations();
}

LinearOutcome Path::prepare_solvers() {
  const auto prepare = [&](const SolvedBody& solved, int rung) {
    if (rung == solved.solver.rung() && !own_free_) return LinearOutcome::solved;
    solved.solver.start_at(rung);
    return solved.solver.analyze(solved.tangent.pattern, free());
  };
  const LinearOutcome outcome = prepare(setting_.body, state_.rungs.body);
  if (outcome != LinearOutcome::solved || !state_.stands_in) return outcome;
  return prepare(*setting_.stand_in, state_.rungs.stand_in);
}

void Path::note_rungs() {
  state_.rungs.body = setting_.body.solver.rung();
  if (setting_.stand_in) state_.rungs.stand_in = setting_.stand_in->solver.rung();
}

bool Path::goes_on() const {
  return !has_fallen() && setting_.conditions.programme().has_rest(state_.accepted.stage);
}

bool Path::has_fallen() const {
  const auto& [present, largest, top] = state_.force;
  return present < options().stop_below * largest &&
         setting_.conditions.programme().is_at_new_load(top);
}

const SolvedBody& Path::body() const {
  return state_.stands_in ? *setting_.stand_in : setting_.body;
}

const FreeDofs& Path::free() const { return own_free_ ? *own_free_ : setting_.body.free; }

EquilibriumProblem Path::problem() const { return {body().assembler, setting_.conditions, free()}; }

std::vector<double> Path::working_force(const Trial& state,
                                        std::span<const double> external_force) const {
  return peristat::working_force(setting_.conditions, state, external_force);
}

std::optional<std::string> Path::refusal_of_conditions(const LoadPoint& at) const {
  if (setting_.conditions.control()) return std::nullopt;  // the load is not known yet
  std::vector<double> values(setting_.conditions.prescribed().size());
  std::optional<std::string> refusal;
  try {
    setting_.conditions.prescribe(at, values);
    setting_.conditions.external_force(at, values);
    static_cast<void>(setting_.conditions.environment(at));
  } catch (const InputError& error) {
    refusal = description(error);
  }
  return first_of_all(body().assembler.index_map().ranks(), refusal);
}

std::string Path::description(const InputError& error) const {
  return setting_.observer.describe ? setting_.observer.describe(error) : error.what();
}

Attempt Path::search(const State& from, const LoadPoint& target, const NewtonOptions& options) {
  const bool is_controlled = setting_.conditions.control() && !is_preloading();
  if (is_controlled) return search_by_control(from, target.stage, options);
  return to_attempt(newton(problem(), body().solver, body().tangent, from, target, options,
                           [this](const IterationRecord& row) { return iterated(row); }),
                    target);
}

Attempt Path::search_by_control(const State& from, double target, const NewtonOptions& options) {
  const Conditions& conditions = setting_.conditions;
  BorderedStep step;
  step.loads = [target](double load) { return LoadPoint(target, load); };
  step.border = {conditions.control()->weights(), 0.0,
                 state_.control_at_load_zero + conditions.programme().at(target).front()};
  step.unknown = from.load.value_or(0.0);
  if (state_.control_sign == 0) find_control_sign();
  return search(from, step, options);
}

void Path::find_control_sign() {
  const SolvedBody& solved = body();
  const State& from = state_.accepted;  // step 0, unless the rate could not be found there
  std::vector<double> rate;
  const auto loads = [&](double load) { return LoadPoint(from.stage, load); };
  StateView at(from);
  if (solved.assembler.has_contacts()) at.foreseen = from.displacement;  // those that touch press
  if (find_rate(problem(), solved.solver, solved.tangent, at, loads, from.load.value_or(0.0),
                rate) != LinearOutcome::solved) {
    return;  // the search reports the failure
  }
  const double answer = setting_.conditions.control()->value(rate);
  const bool is_odd = solved.solver.inertia()->negative % 2 == 1;
  state_.control_sign = (answer < 0.0) == is_odd ? 1 : -1;
}

void Path::judge_stability_under_control(Attempt& found, const LoadPath& loads) {
  const SolvedBody& solved = body();
  std::vector<double> rate;
  if (find_rate(problem(), solved.solver, solved.tangent, found.state.at(), loads, *found.at.load,
                rate) != LinearOutcome::solved) {
    found.outcome = Outcome::degenerate;
    return;
  }
  found.inertia = solved.solver.inertia();
  const int negative = found.inertia->negative;
  found.has_negative_pivots = negative > 0;
  const bool has_turned = setting_.conditions.control()->value(rate) * state_.control_sign < 0.0;
  if (negative > 1 || (negative == 1 && !has_turned)) {
    found.outcome = Outcome::not_positive_definite;
  }
}

Attempt Path::search(const State& from, const BorderedStep& step, const NewtonOptions& options) {
  try {
    BorderedResult found =
        bordered_newton(problem(), body().solver, body().tangent, from, step, options,
                        [this](const IterationRecord& row) { return iterated(row); });
    Attempt attempt = to_attempt(std::move(found.newton), step.loads(found.unknown));
    // States within an avalanche, with held damage, need not be stable.
    const bool may_stay = setting_.conditions.control() && options.damage == Damage::grows;
    if (may_stay && attempt.has_converged()) judge_stability_under_control(attempt, step.loads);
    return attempt;
  } catch (const InputError& error) {
    Attempt attempt = undefined_attempt(from, load_point(from));
    attempt.note = description(error);
    return attempt;
  }
}

void Path::number_equations() {
  own_free_.reset();
  if (state_.pins.pinned.empty()) return;
  const FreeDofs& held_by_supports = setting_.body.free;
  std::vector<char> without_equation;
  for (const Index equation : held_by_supports.equation) {
    without_equation.push_back(equation == FreeDofs::none);
  }
  own_free_ = std::make_unique<FreeDofs>(
      state_.pins.free_dofs(without_equation, held_by_supports.dimension));
}

Advance Path::pin() {
  state_.pins.pin();
  number_equations();
  return analyze();
}

Advance Path::pin_as_before(FragmentPins pins) {
  state_.pins = std::move(pins);
  number_equations();
  return analyze();
}

Advance Path::analyze() {
  if (body().solver.analyze(body().tangent.pattern, free()) == LinearOutcome::solved) {
    return Advance::goes_on;
  }
  Attempt attempt = std::move(last_attempt_);
  attempt.outcome = Outcome::out_of_memory;
  return stop(std::move(attempt), 0.0, explanation(Outcome::out_of_memory));
}

bool Path::iterated(IterationRecord row) const {
  const LoadSteppingObserver& observer = setting_.observer;
  row.step = next_step();
  if (observer.iteration) observer.iteration(row);
  return observer.interrupted && observer.interrupted();
}

void Path::tell(const LoadPoint& at, DecisionRecord decision) const {
  if (!setting_.observer.decision) return;
  decision.step = next_step();
  decision.stage = at.stage;
  decision.load_factor = setting_.conditions.load_factor(at);
  setting_.observer.decision(decision);
}

void Path::count_pivots(Attempt& attempt) const {
  const auto& [assembler, solver, tangent, free] = body();
  tangent.linearise(assembler, attempt.state.at(), 0.0);
  solver.count_pivots(true);
  static_cast<void>(solver.factorize(tangent, FactorUse::factorize_now));
  attempt.inertia = solver.inertia();
}

void Path::tell_commit(const Attempt& attempt) const {
  const auto& tell = setting_.observer.commits;
  if (tell) tell({attempt.state, attempt.external_force, attempt.at});
}

Advance Path::stop(Attempt attempt, double attempted, const std::string& reason) {
  if (!attempt.inertia && attempt.has_negative_pivots) count_pivots(attempt);
  tell(attempt.at, {.increment = attempted,
                    .outcome = name(attempt.outcome),
                    .action = Decision::stop,
                    .reason = reason});
  outcome_ = attempt.outcome;
  last_attempt_ = std::move(attempt);
  return Advance::ended;
}

}  // namespace peristat
