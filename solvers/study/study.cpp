#include "solvers/study/study.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/body/require_memory_for.hpp"
#include "solvers/body/unheld_body.hpp"
#include "solvers/body/without_equation.hpp"
#include "solvers/formulations/specification/for_each_material.hpp"
#include "solvers/motion/stable_step.hpp"
#include "solvers/study/fatigue.hpp"
#include "solvers/study/found_loads.hpp"
#include "solvers/study/motion.hpp"
#include "solvers/study/rest_stability.hpp"
#include "src/conditions/points_of_set.hpp"
#include "src/core/number_text.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Shortest implicit step, relative to the stable explicit one. The inertia of shorter ones is
/// stiffer than the body by the inverse square of this, and its round-off as large as the residual
/// that a search must reach.
constexpr double shortest_implicit_step = 1e-3;

/// Refuses modes that need a potential. Forces without one are balanced in one step: there is no
/// energy from which stability, a direction of descent or the energy release of a crack could
/// follow.
void refuse_modes_without_potential(const Body& body, const StudyOptions& options) {
  if (body.model.balances().potential) return;
  const bool is_explicit = options.loading.mode == Mode::dynamics &&
                           options.loading.dynamics.scheme == MotionScheme::verlet;
  if (body.specification.is_convolved()) return;  // choose_linear_systems refuses their modes
  if (is_explicit) {
    throw InputError("dynamics.scheme", "verlet",
                     "is for models with an energy; this model takes \"newmark\"");
  }
  if (options.loading.mode != Mode::newton && options.loading.mode != Mode::dynamics) {
    throw InputError("loading.mode", std::string(options.loading.mode.name),
                     "is for models with an energy; this model takes mode newton or dynamics");
  }
  if (body.conditions->control()) {
    throw InputError("controls", "", "a control is for models with an energy");
  }
  if (!body.conditions->constraints().none()) {
    throw InputError("constraints", "",
                     "rigid sets, rollers and linear constraints are for models with an energy");
  }
}

/// Refuses mode path for bodies whose points have states and whose bonds break by their stretch: a
/// bond's strength then does not say what the body loses with it. By release it does.
void refuse_events_of_states(const Body& body, const StudyOptions& options) {
  if (options.loading.mode != Mode::path) return;
  const OptionSet can = options_of(body.specification);
  const bool loses_more = can.has(Option::critical_stretch) && !can.has(Option::events);
  if (!loses_more || body.model.fails_by_release()) return;
  throw InputError(
      "loading.mode", std::string(options.loading.mode.name),
      is_for(Option::events) +
          ": a bond of this model breaks by its stretch, and its points lose dilatation "
          "with it; take damage.drive = \"release\"");
}

/// Refuses struts in modes whose steps are no equilibria between commits.
void refuse_modes_with_struts(const Body& body, const StudyOptions& options) {
  const Mode mode = options.loading.mode;
  const bool is_known = mode == Mode::newton || mode == Mode::adaptive || mode == Mode::relaxation;
  if (is_known || !body.model.struts()) return;
  throw InputError("loading.mode", std::string(mode.name),
                   "can't cut struts; take newton, adaptive or relaxation, or damage.struts = "
                   "\"keep\"");
}

/// Refuses mode path for bonds that close: it follows bonds whose force is proportional to their
/// stretch.
void refuse_events_of_closing_bonds(const Body& body, const StudyOptions& options) {
  if (options.loading.mode != Mode::path) return;
  for_each_material(
      body.specification, [](const MaterialSpecification& material, const std::string& key) {
        if (material.damage.compression == Compression::lost) return;
        throw InputError(key + ".damage.compression", "kept",
                         "is not for mode path, whose bonds lose tension and compression alike");
      });
}

/// Refuses friction, whose rounds of normal forces are at a given load, and obstacles that a force
/// drives.
void refuse_contacts_where_loads_are_found(const Body& body, Mode mode) {
  const std::string by = mode == Mode::arc_length || mode == Mode::path
                             ? "mode " + std::string(mode.name)
                             : "a control";
  const auto refuse = [&](const std::string& key, const std::string& value) {
    throw InputError(
        key, value,
        "is for prescribed displacements and loads, not for loads that are found by " + by);
  };
  for (const Obstacles::Obstacle& of : body.conditions->obstacles().all()) {
    if (of.friction > 0.0) refuse(of.table + ".friction", number_text(of.friction));
    if (of.free_axis) refuse(of.table + ".force", "");
  }
  const std::vector<ContactSpecification>& contacts = body.specification.contacts;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    if (contacts[k].friction == 0.0) continue;
    refuse(indexed("contacts", k) + ".friction", number_text(contacts[k].friction));
  }
}

/// Refuses what does not follow contacts that close and open.
void refuse_modes_with_contacts(const Body& body, const StudyOptions& options) {
  const bool has_obstacles = !body.conditions->obstacles().none();
  if (body.specification.contacts.empty() && !has_obstacles) return;
  const std::string with = has_obstacles ? " with an [[obstacle]]" : " with a [[contact]]";
  const std::string cannot = "does not follow contacts that close and open," + with + "; take ";
  const LoadSteppingOptions& loading = options.loading;
  const Mode mode = loading.mode;
  const bool relaxes = mode == Mode::relaxation || mode == Mode::adaptive;
  if (relaxes && loading.relaxation.method == RelaxationMethod::flow) {
    throw InputError("loading.relaxation.method", "flow", cannot + "\"dynamic\"");
  }
  const bool is_explicit =
      mode == Mode::dynamics && loading.dynamics.scheme == MotionScheme::verlet;
  if (is_explicit && loading.dynamics.time_step > 0.0) {
    throw InputError("dynamics.time_step", number_text(loading.dynamics.time_step),
                     "is constant, while contacts make the stable step shorter," + with +
                         "; take dynamics.step_share");
  }
  if (mode == Mode::path || finds_loads(options, *body.conditions)) {
    refuse_contacts_where_loads_are_found(body, mode);
  }
}

/// Points that fail one by one have no strength that a step could be led to, and what follows one
/// has no stand-in.
void refuse_modes_of_failing_points(const Body& body, const StudyOptions& options) {
  const Mode mode = options.loading.mode;
  if (takes(body.specification, Option::critical_stretch)) return;
  if (options.loading.max_broken_bonds > 0 && body.model.fails_in_avalanches()) {
    throw InputError(
        "loading.max_broken_bonds", std::to_string(options.loading.max_broken_bonds),
        "counts bonds that break one by one; a point that fails loses all its bonds at once");
  }
  if (mode == Mode::relaxation && body.model.fails_in_avalanches() &&
      options.loading.relaxation.method == RelaxationMethod::flow) {
    throw InputError("loading.relaxation.method", "flow",
                     "follows bonds that break one by one; a point that fails loses all its bonds "
                     "at once: take \"dynamic\"");
  }
  const bool is_known = mode == Mode::newton || mode == Mode::dynamics || mode == Mode::relaxation;
  if (is_known || (mode != Mode::path && !body.model.has_history())) return;
  throw InputError("loading.mode", std::string(mode.name),
                   "is for bonds that break one by one; with kinematics \"linear\" or operator "
                   "\"fft\" take newton, relaxation or dynamics");
}

/// Refuses initial displacements for a motion that begins in equilibrium, which determines them.
void refuse_initial_displacements(const Body& body) {
  const auto& initial = body.specification.initial;
  for (std::size_t k = 0; k < initial.size(); ++k) {
    for (const std::string& component : initial[k].displacement) {
      if (component == "0") continue;
      throw InputError(indexed("initial", k) + ".displacement", '"' + component + '"',
                       "is not allowed with a start in equilibrium, which finds the displacements");
    }
  }
}

/// Refuses modes that have no sums over ranks.
void refuse_modes_without_ranks(const Body& body, const StudyOptions& options) {
  const Mode mode = options.loading.mode;
  const ConstraintSpecification& constraints = body.specification.constraints;
  const bool slides = !constraints.rollers.empty() || !constraints.linear.empty();
  const bool flows = (mode == Mode::relaxation || mode == Mode::adaptive) &&
                     options.loading.relaxation.method == RelaxationMethod::flow;
  if (slides && flows) {
    throw InputError("loading.relaxation.method", "flow",
                     "is not for more than one rank together with rollers and linear constraints; "
                     "take \"dynamic\"");
  }
  if (mode != Mode::path && mode != Mode::arc_length && mode != Mode::fatigue) return;
  throw InputError("loading.mode", std::string(mode.name),
                   "is not for more than one rank; take newton, adaptive, relaxation or dynamics");
}

}  // namespace

void check_study(const Body& body, const StudyOptions& options) {
  check_options(options);
  if (!body.index_map->is_whole()) refuse_modes_without_ranks(body, options);
  const bool moves = options.loading.mode == Mode::dynamics;
  if (moves != body.conditions->programme().is_of_time()) {
    throw InputError(
        "end_time", "",
        moves ? "is missing; mode dynamics needs it" : "is for a motion in time, mode dynamics");
  }
  refuse_modes_without_potential(body, options);
  refuse_events_of_states(body, options);
  refuse_modes_with_struts(body, options);
  refuse_modes_with_contacts(body, options);
  refuse_events_of_closing_bonds(body, options);
  refuse_modes_of_failing_points(body, options);
  if (options.loading.mode == Mode::fatigue) check_fatigue(body, options);
  const bool is_implicit = moves && options.loading.dynamics.scheme == MotionScheme::newmark;
  if (is_implicit != body.specification.has_inertia) {
    throw InputError("has_inertia", "",
                     is_implicit ? "must be set: implicit steps need a body with inertia"
                                 : "is for implicit steps only");
  }
  const bool begins_in_equilibrium =
      moves && options.loading.dynamics.start == MotionStart::equilibrium;
  if (begins_in_equilibrium) refuse_initial_displacements(body);
  if (!moves || begins_in_equilibrium) refuse_unheld_bodies(body);
  refuse_unstable_rest(body, options);
}

SolvedModel::SolvedModel(const Points& points, const Model& model, const Constraints& constraints,
                         const FreeDofs& free, LinearSystems systems, int threads,
                         const IndexMap& index_map)
    : systems_(std::move(systems)),
      free_(free),
      assembler_(points, model, threads, index_map, systems_.pattern_of()),
      tangent_(systems_.make_tangent(assembler_, constraints)) {}

LinearOutcome SolvedModel::analyze() { return solver().analyze(tangent_->pattern, free_); }

Study::Study(const Body& body, StudyOptions options, SolverLadder::Reporter tell)
    : body_(body),
      options_(std::move(options)),
      free_(without_equation(body), body.points.dimension) {
  check_study(body_, options_);
  options_.threads = usable_threads(options_.threads);
  if (options_.loading.mode == Mode::dynamics) motion_ = make_motion_setting(body);
  LinearSystems systems = choose_linear_systems(options_, body, std::move(tell));
  require_memory_for(body, systems.bytes);
  equations_ =
      std::make_unique<SolvedModel>(body.points, body.model, body.conditions->constraints(), free_,
                                    std::move(systems), options_.threads, *body.index_map);
}

LinearOutcome Study::analyze() {
  if (analysis_) return *analysis_;
  analysis_ = equations_->analyze();
  if (*analysis_ == LinearOutcome::solved && finds_loads(options_, *body_.conditions)) {
    const auto& [assembler, solver, tangent, free] = equations_->solved();
    refuse_unanswered_loads(body_, free, assembler, solver, tangent);
  }
  return *analysis_;
}

const Stiffness& Study::find_initial_stiffness() {
  if (motion_->at_start) return *motion_->at_start;
  const auto& [assembler, solver, tangent, free] = equations_->solved();
  const Conditions& conditions = *body_.conditions;
  std::vector<double> displacement = motion_->displacement;
  displacement.resize(motion_->mass.size());
  conditions.prescribe(0.0, displacement);
  conditions.constraints().move(displacement);
  const History history = assembler.initial_history();
  StateView at_start(displacement, history, Damage::grows, conditions.environment(0.0));
  at_start.has_contacts = false;  // see Dynamics::step_with_contacts
  tangent.linearise(assembler, at_start, projection_for_stiffness(assembler));
  motion_->at_start =
      find_stiffness(tangent, free, motion_->mass, motion_->most_points, assembler.index_map());
  const double step = options_.loading.dynamics.time_step;
  const double stable = motion_->at_start->stable_step();
  if (options_.loading.dynamics.scheme == MotionScheme::newmark) {
    if (step < shortest_implicit_step * stable && std::isfinite(stable)) {
      throw InputError("dynamics.time_step", number_text(step),
                       "is shorter than a thousandth of the stable explicit step, " +
                           number_text(stable) +
                           " s: round-off of the inertia would hide the forces; take a longer one, "
                           "or dynamics.scheme = \"verlet\"");
    }
    return *motion_->at_start;
  }
  if (step > stable) {
    throw InputError("dynamics.time_step", number_text(step),
                     "is longer than the stable step, " + number_text(stable) +
                         " s; take a shorter one, or dynamics.step_share");
  }
  if (step == 0.0 && !std::isfinite(stable)) {
    throw InputError(
        "dynamics.step_share", number_text(options_.loading.dynamics.step_share),
        "needs a stable step, but nothing that moves has a stiffness; give dynamics.time_step");
  }
  return *motion_->at_start;
}

LoadSteppingResult Study::follow(const LoadSteppingObserver& observer, const SolvedBody* stand_in,
                                 const PathState* from) {
  if (analyze() != LinearOutcome::solved) {
    LoadSteppingResult result;
    result.outcome = Outcome::out_of_memory;
    return result;
  }
  if (motion_ && !from) find_initial_stiffness();
  return follow_loading({equations_->solved(), *body_.conditions, options_.loading, options_.newton,
                         observer, stand_in, motion_ ? &*motion_ : nullptr, initial_cuts(body_)},
                        from);
}

StudyResult solve(const Body& body, const StudyOptions& options,
                  const LoadSteppingObserver& observer) {
  StudyResult result;
  LoadSteppingObserver told = observer;
  told.decision = [&](const DecisionRecord& record) {
    result.decisions.push_back(record);
    if (observer.decision) observer.decision(record);
  };
  told.accepted = [&](const StepRecord& record, const AcceptedState& state) {
    result.steps.push_back(record);
    if (observer.accepted) observer.accepted(record, state);
  };
  LoadSteppingResult reached = Study(body, options).follow(told);
  result.outcome = reached.outcome;
  result.state = std::move(reached.state);
  result.last_attempt = std::move(reached.last_attempt);
  return result;
}

Coordinates mean_displacement(const Points& points, const State& state, const std::string& set) {
  const auto found = points.sets.find(set);
  if (found == points.sets.end()) throw InputError("set", '"' + set + '"', "no set of this name");
  Coordinates mean{};
  for (const Index point : found->second) {
    for (int c = 0; c < points.dimension; ++c)
      mean[c] += state.displacement[std::size_t(point) * points.dimension + c];
  }
  for (double& component : mean) component /= double(found->second.size());
  return mean;
}

}  // namespace peristat
