#include "cases/runner/input/solver_keys.hpp"

#include <algorithm>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cases/runner/input/key_kinds.hpp"
#include "solvers/drivers/drivers.hpp"
#include "solvers/formulations/formulations.hpp"

namespace peristat {
namespace {

/// True if any of the materials has a law of damage.
bool may_fail(const Case& from) {
  const auto fails = [](const MaterialSpecification& material) {
    return material.damage.law != DamageLaw::none;
  };
  return fails(from.material) ||
         std::ranges::any_of(from.regions, fails, &RegionSpecification::material) ||
         std::ranges::any_of(from.interfaces, [&](const InterfaceSpecification& interface) {
           return interface.material && fails(*interface.material);
         });
}

/// True if the model's tangent is symmetric, as that of an energy is.
bool has_symmetric_tangent(const Case& from) { return formulation_of(from).has_potential; }

void check_linear(const Entry& at, const SolverSpecification& solver) {
  const std::string why = what_is_against(solver.linear, has_symmetric_tangent(at.so_far));
  if (!why.empty()) at.refuse(why);
}

void check_preconditioner(const Entry& at, SolverSpecification& solver) {
  if (solver.preconditioner == PreconditionerKind::automatic) return;
  const bool is_symmetric = has_symmetric_tangent(at.so_far);
  const std::string why = what_is_against(solver.preconditioner, is_symmetric);
  if (!why.empty()) at.refuse(why);
  if (solver.linear == LinearMethod::cholesky || solver.linear == LinearMethod::lu)
    at.refuse("is for iterative solvers, not for solver.linear = \"cholesky\" and \"lu\"");
  // A preconditioner that is named is used, by an iterative solver.
  if (solver.linear == LinearMethod::automatic) {
    solver.linear = is_symmetric ? LinearMethod::conjugate_gradients : LinearMethod::gmres;
  }
}

void check_tangent(const Entry& at, const SolverSpecification& solver) {
  if (solver.tangent != TangentStorage::matrix_free) return;
  if (!can_be_matrix_free({solver.linear, solver.preconditioner}))
    at.refuse(
        "is not allowed with this solver.linear or solver.preconditioner, which need the stored "
        "tangent");
  if (!at.so_far.foundations.empty())
    at.refuse("is not allowed with a [[foundation]], which needs the stored tangent");
  if (!at.so_far.contacts.empty())
    at.refuse("is not allowed with a [[contact]], which needs the stored tangent");
  if (!at.so_far.obstacles.empty())
    at.refuse("is not allowed with an [[obstacle]], which needs the stored tangent");
  for (const LoadSpecification& load : at.so_far.loads) {
    if (load.kind == LoadSpecification::Kind::pressure)
      at.refuse("is not allowed with a [[load]] pressure, whose stiffness has to be stored");
  }
}

/// Refuses to remove pieces under eigenstrains: a removed piece can't grow or shrink.
void check_fragments(const Entry& at, const SolverSpecification& solver) {
  if (solver.fragments == FragmentRemedy::remove && at.so_far.eigenstrains.are_there())
    at.refuse(
        "is not allowed with eigenstrains or a temperature: a piece that has left the equations "
        "can't grow or shrink; take \"hold\"");
}

void check_stand_in(const Entry& at, const SolverSpecification& solver) {
  if (solver.elastic_horizon_ratio > 0.0 && !may_fail(at.so_far))
    at.refuse(
        "is for bodies with damage: the stand-in replaces the body until damage begins, so without "
        "damage it would replace the body to the end");
  const std::string own = key_of_own_horizons(at.so_far);
  if (solver.elastic_horizon_ratio > 0.0 && !own.empty())
    at.refuse("gives the stand-in one horizon, but " + own + " gives every point its own");
}

Kind<Mode> mode() {
  std::vector<std::string> names;
  for (const DriverEntry& driver : all_drivers()) names.emplace_back(driver.mode.name);
  const Kind<std::string> name = one_of(names);
  const auto read = [name](const Entry& at) {
    const std::string chosen = name.read(at);
    return std::ranges::find(all_drivers(), chosen,
                             [](const DriverEntry& driver) { return driver.mode.name; })
        ->mode;
  };
  return {read, [](const Mode& mode, const Case&) { return toml_string(std::string(mode.name)); },
          name.schema, name.allowed};
}

}  // namespace

Table<SolverSpecification> solver_keys() {
  using Spec = SolverSpecification;
  using K = Key<Spec>;
  const auto searches = [](auto&, auto& from) {
    return !from.dynamics.is_asked_for || from.dynamics.searches();
  };
  const auto is_static = [](auto&, auto& from) { return !from.dynamics.is_asked_for; };
  return {
      "solver",
      {K("mode", &Spec::mode, mode(),
         "`\"newton\"`: all steps implicit; `\"relaxation\"`: all steps by dynamic relaxation; "
         "`\"adaptive\"`: implicit steps while no damage grows, relaxation while it does; "
         "`\"arc_length\"`: steps along the equilibrium path, through limit points and "
         "bifurcations, without damage; `\"path\"`: sequentially linear analysis, from one "
         "breaking bond to the next; `\"dynamics\"`: the motion in time, by explicit or implicit "
         "steps; `\"fatigue\"`: [cycles of the load](fatigue.md), from one bond at the end of its "
         "life to the next")
           .extends()
           .on_ranks(),
       K("linear", &Spec::linear,
         choice<LinearMethod>({{"auto", LinearMethod::automatic},
                               {"cholesky", LinearMethod::cholesky},
                               {"pcg", LinearMethod::conjugate_gradients},
                               {"minres", LinearMethod::minres},
                               {"gmres", LinearMethod::gmres},
                               {"lu", LinearMethod::lu},
                               {"bicgstab", LinearMethod::bicgstab}}),
         "solver of the linear systems ([linear-solvers.md](linear-solvers.md)). `\"auto\"`: "
         "chooses one, reports why, and takes another one if it fails; `\"cholesky\"`: direct, for "
         "symmetric tangents; `\"pcg\"`: conjugate gradients, for symmetric tangents; "
         "`\"minres\"`: "
         "minimal residuals, for symmetric tangents; `\"gmres\"`: iterative, for all models; "
         "`\"lu\"`: "
         "direct, for tangents that are not symmetric; `\"bicgstab\"`: iterative, for tangents "
         "that are not symmetric")
           .written_if(searches)
           .extends()
           .then(check_linear)
           .on_ranks(),
       K("preconditioner", &Spec::preconditioner,
         choice<PreconditionerKind>({{"auto", PreconditionerKind::automatic},
                                     {"jacobi", PreconditionerKind::jacobi},
                                     {"block_jacobi", PreconditionerKind::block_jacobi},
                                     {"rigid_pieces", PreconditionerKind::rigid_pieces},
                                     {"surrogate", PreconditionerKind::surrogate},
                                     {"sines", PreconditionerKind::sines},
                                     {"riluk", PreconditionerKind::riluk},
                                     {"chebyshev", PreconditionerKind::chebyshev},
                                     {"multigrid", PreconditionerKind::multigrid},
                                     {"local_operator", PreconditionerKind::local_operator}}),
         "preconditioner of iterative solvers, not for `\"cholesky\"` and `\"lu\"`. Symmetric "
         "tangent: `\"auto\"` means `\"rigid_pieces\"`, and with a preconditioner that is given "
         "`linear = \"auto\"` means `\"pcg\"`; `\"sines\"` is for points on a lattice along the "
         "axes, without constraints and images. Unsymmetric tangent: `\"local_operator\"`, "
         "`\"jacobi\"` and `\"block_jacobi\"` are allowed, `\"auto\"` means `\"local_operator\"`, "
         "and `linear = \"auto\"` then means `\"gmres\"`")
           .written_if(searches)
           .extends()
           .then(check_preconditioner)
           .on_ranks(),
       K("tangent", &Spec::tangent,
         choice<TangentStorage>({{"auto", TangentStorage::automatic},
                                 {"stored", TangentStorage::stored},
                                 {"matrix_free", TangentStorage::matrix_free}}),
         "`\"auto\"`: stored for direct solvers; `\"stored\"`: the tangent's blocks are stored; "
         "`\"matrix_free\"`: they are computed anew "
         "in each product, which takes a third of the memory in 3D, for `material.model = "
         "\"bond\"`, `\"state\"` and `\"lps\"` as an energy, without `\"cholesky\"`, "
         "`\"riluk\"`, `\"chebyshev\"` and `\"multigrid\"`")
           .written_if(searches)
           .then(check_tangent)
           .on_ranks(),
       K("precision", &Spec::precision,
         choice<Precision>({{"single", Precision::single}, {"double", Precision::full}}),
         "of matrix-free products of bonds along rows of a lattice inside conjugate gradients. "
         "`\"single\"`: parts of the bonds are rounded to single precision, which nearly halves "
         "the time; the residual of every solution is computed in double precision, and iterations "
         "go on until it is small enough; `\"double\"`: nothing is rounded")
           .written_if(searches)
           .on_ranks(),
       K("operator", &Spec::force_operator,
         choice<ForceOperator>({{"auto", ForceOperator::automatic},
                                {"bonds", ForceOperator::bonds},
                                {"stencil", ForceOperator::stencil},
                                {"fft", ForceOperator::fft}}),
         "how forces are summed. "
         "`\"auto\"`: by the faster way, where possible `fft` for motions by explicit steps of "
         "`material.kinematics = \"linear\"`, and of `lps` as an energy, with a "
         "horizon of 2.5 spacings or more; `\"bonds\"`: bond by bond, for bonds and states along "
         "rows of a lattice where consecutive points have alike bonds, for whole "
         "rows at once; `\"stencil\"`: like `\"bonds\"`, refused if less than half of the bonds "
         "are in such rows; `\"fft\"`: by fast Fourier "
         "transforms, which store no bonds "
         "and take the same time whatever the horizon, for one material on points of a lattice "
         "with equal volumes, without a `surface_correction`. All give the same results to "
         "round-off. Models `green_bond` and "
         "`correspondence`, and `lps` as printed, have only `fft`")
           .on_ranks(),
       K("predictor", &Spec::predictor,
         choice<Predictor>({{"consistent", Predictor::consistent}, {"none", Predictor::none}}),
         "state about which the first iteration of a step linearises. `\"consistent\"`: the old "
         "state, spreading the jump of the supports; `\"none\"`: the state after the jump, as in "
         "[CPD]")
           .written_if(searches)
           .on_ranks(),
       K("projection", &Spec::projection,
         choice<Projection>({{"auto", Projection::automatic},
                             {"never", Projection::never},
                             {"always", Projection::always}}),
         "when the tangents of interactions are projected to their positive semidefinite part. "
         "`\"auto\"`: if the exact tangent has negative pivots or the search fails with it; "
         "`\"never\"`: not even then; `\"always\"`: in every iteration")
           .written_if(searches)
           .on_ranks(),
       K("relative_tolerance", &Spec::relative_tolerance, between(1e-14, 1e-2),
         "relative tolerance of the residual")
           .written_if(searches)
           .on_ranks(),
       K("linear_tolerance", &Spec::linear_tolerance, between(1e-14, 1e-1),
         "largest relative residual allowed in the linear system of a Newton iteration")
           .written_if(searches)
           .on_ranks(),
       K("max_iterations", &Spec::max_iterations, integer(1, 1000),
         "largest number of iterations of Newton's method in one step")
           .written_if(searches)
           .extends()
           .on_ranks(),
       K("fragments", &Spec::fragments,
         choice<FragmentRemedy>({{"hold", FragmentRemedy::hold},
                                 {"remove", FragmentRemedy::remove},
                                 {"stop", FragmentRemedy::stop}}),
         "what happens to pieces that come off. `\"hold\"`: as many of their degrees of freedom "
         "are pinned as are needed to prevent free motions; `\"remove\"`: they leave the equations "
         "and stay where they are; `\"stop\"`: the run ends with outcome `fragmented`")
           .written_if(is_static)
           .then(check_fragments)
           .moreover("not `\"remove\"` with eigenstrains or a temperature")
           .on_ranks(),
       K("elastic_horizon_ratio", &Spec::elastic_horizon_ratio, between(1.0, 1e3),
         "mode `adaptive`: horizon / spacing of an elastic stand-in that replaces the body until "
         "damage begins; needs model `bond`, `youngs_modulus` and a damage law")
           .then(check_stand_in)
           .written_if([](auto& solver, auto&) { return solver.elastic_horizon_ratio > 0.0; })
           .moreover("in 3D to 100")
           .default_words("no stand-in")
           .on_ranks()}};
}

Table<SolverSpecification> arc_length_keys() {
  using Spec = SolverSpecification;
  using K = Key<Spec>;
  constexpr auto arc_length = &Spec::arc_length;
  return {"arc_length",
          {K("steps", in(arc_length, &ArcLengthOptions::steps), count_from(0, "steps"),
             "number of steps after which the path ends, unless the load reaches its end before. "
             "0: the load must reach its end within 10 000 steps")
               .extends(),
           K("largest_step", in(arc_length, &ArcLengthOptions::largest_step), between(1e-12, 1e6),
             "largest step of the arc length. Steps grow up to it where the path is straight. The "
             "first step is 1/`loading.steps`; at first this is a step of the load factor")
               .extends(),
           K("bifurcation", in(arc_length, &ArcLengthOptions::branches_off),
             choice<bool>({{"branch", true}, {"straight", false}}),
             "what to do at a bifurcation of a stable path. `\"branch\"`: follow the other path; "
             "`\"straight\"`: continue on the same path, where states are unstable")}};
}

namespace {

/// Refuses settings of the solver that a control and mode arc_length would ignore.
void check_heeded(const Entry& at, const std::string& who) {
  if (!at.from.has("solver")) return;
  const TomlTable solver = at.from.table("solver");
  const std::vector<std::pair<std::string, std::string>> heeded{{"linear", "auto"},
                                                                {"preconditioner", "auto"},
                                                                {"tangent", "auto"},
                                                                {"projection", "auto"},
                                                                {"predictor", "consistent"}};
  for (const auto& [key, value] : heeded) {
    if (solver.has(key) && solver.string(key) != value)
      solver.refuse(key, "must be \"" + value + "\" with " + who +
                             ", which has a solver and a search of its own");
  }
}

}  // namespace

void check_found_loads(const Entry& at, const Case& result) {
  const bool is_controlled = !result.controls.empty();
  const bool is_arc_length = result.solver.mode == Mode::arc_length;
  const auto& tables = result.loading.tables;
  if (is_controlled && result.solver.mode != Mode::newton)
    throw InputError("solver.mode", '"' + std::string(result.solver.mode.name) + '"',
                     "must be \"newton\" with [[control]]");
  if (is_controlled && (!at.from.has("loading") || !at.from.table("loading").has("table")))
    throw InputError("control", "",
                     "needs loading.table, the values of the controlled displacement [m] along the "
                     "path, such as [0, 1e-4]");
  if (is_arc_length && !tables.empty() && tables.front().entries.size() != 2)
    throw InputError(
        "loading.table", "",
        "must have two entries in mode arc_length, which follows one line of the load");
  if (is_arc_length && at.from.has("loading") && at.from.table("loading").has("largest_step"))
    throw InputError("loading.largest_step", "",
                     "has no effect in mode arc_length; give arc_length.largest_step");
  const bool is_path = result.solver.mode == Mode::path;
  if (is_path && !may_fail(result))
    throw InputError("solver.mode", "\"path\"",
                     "is for bodies with damage: it goes from one breaking bond to the next");
  if (is_path && result.solver.elastic_horizon_ratio > 0.0)
    throw InputError("solver.elastic_horizon_ratio", "", "is for mode adaptive");
  if (is_path && at.from.has("loading")) {
    for (const char* key : {"largest_step", "max_broken_bonds"}) {
      if (at.from.table("loading").has(key))
        throw InputError(std::string("loading.") + key, "",
                         "has no effect in mode path, which goes from event to event");
    }
  }
  if (!is_path && at.from.has("loading")) {
    for (const char* key : {"event_tolerance", "teeth"}) {
      if (at.from.table("loading").has(key))
        throw InputError(std::string("loading.") + key, "", "is for solver.mode = \"path\"");
    }
  }
  if (is_controlled) check_heeded(at, "[[control]]");
  if (is_arc_length) check_heeded(at, "mode arc_length");
}

namespace {

/// Default number of steps; larger if damage may grow, which needs smaller steps.
int default_relaxation_steps(const Case& from) {
  constexpr int steps_of_damage = 50;
  const bool hands_over = from.solver.mode == Mode::adaptive && may_fail(from);
  const int steps = from.loading.steps_to_entry();
  if (!hands_over) return steps;
  const int entries = from.loading.steps / steps;  // number of entries of an expression, else 1
  return std::max(steps, (steps_of_damage + entries - 1) / entries);
}

void check_iterations(const Entry& at, const RelaxationSpecification& relaxation) {
  if (relaxation.iterations < relaxation.steps)
    at.refuse("must not be fewer than relaxation.steps");
  if (relaxation.iterations % relaxation.steps != 0)
    at.refuse("must be a multiple of relaxation.steps, " + std::to_string(relaxation.steps));
}

}  // namespace

Table<RelaxationSpecification> relaxation_keys() {
  using Spec = RelaxationSpecification;
  using Options = RelaxationOptions;
  using K = Key<Spec>;
  const auto options = &Spec::options;
  const auto moves = [](auto& relaxation, auto&) { return relaxation.moving; };
  const auto rests = [](auto& relaxation, auto&) { return !relaxation.moving; };
  const auto flows = [](auto& relaxation, auto&) {
    return relaxation.options.method == RelaxationMethod::flow;
  };
  const auto is_dynamic = [flows](auto& relaxation, auto& from) {
    return !flows(relaxation, from);
  };
  const std::string for_dynamic = "is for method = \"dynamic\"";
  return {
      "relaxation",
      {K("steps", &Spec::steps, count_from(1),
         "number of equal steps of the *whole* load, or from one entry of `loading.table` to the "
         "next; the first step is 1/steps, whatever part of the load the implicit steps have left")
           .extends()
           .otherwise([](auto& relaxation,
                         auto& from) { relaxation.steps = default_relaxation_steps(from); },
                      "`loading.steps`; in mode `adaptive` with damage at least 50. If the table "
                      "is an expression, which has an entry for each step: 1, in mode `adaptive` "
                      "with damage at least 50 in all"),
       K("method", in(options, &Options::method),
         choice<RelaxationMethod>(
             {{"dynamic", RelaxationMethod::dynamic}, {"flow", RelaxationMethod::flow}}),
         "`\"dynamic\"`: dynamic relaxation, a motion with a pseudo inertia; `\"flow\"`: the flow "
         "without inertia, whose directions are solutions of linear systems")
           .early(),
       K("flow_tolerance", in(options, &Options::flow_tolerance), between(1e-3, 0.5),
         "method `flow`: largest deviation of a step from the path of the flow, relative to the "
         "length of the step")
           .unless(is_dynamic, "is for method = \"flow\""),
       K("peak_tolerance", &Spec::peak_tolerance, between(0.0, 1.0),
         "mode `adaptive`: a relaxed step in which the force begins to fall is halved until it is "
         "no longer than this share of the whole load; the decision that accepts it names the load "
         "factors between which the peak lies. 0: no search")
           .unless([](auto&, auto& from) { return from.solver.mode != Mode::adaptive; },
                   "is for mode \"adaptive\"")
           .extends(),
       K("load", &Spec::moving, choice<bool>({{"fixed", false}, {"moving", true}}),
         "`\"fixed\"`: the load is constant after the ramp until the body is in equilibrium; "
         "`\"moving\"`: it changes in every iteration")
           .unless(flows, for_dynamic)
           .early(),
       K("iterations", &Spec::iterations, count_from(1),
         "load `moving`: iterations over the whole load, or from one entry of `loading.table` to "
         "the next, shared equally among the steps")
           .unless(rests, "is for load = \"moving\"")
           .then(check_iterations)
           .moreover("a multiple of `steps`"),
       K("ramp", in(options, &Options::ramp), count_from(1),
         "load `fixed`: iterations over which supports and loads move to their new values")
           .unless(flows, for_dynamic)
           .unless(moves, "is for load = \"fixed\""),
       K("quiet_iterations", in(options, &Options::quiet_iterations), count_from(0),
         "load `fixed`: iterations without a further bond breaking before a state may be accepted")
           .unless(flows, for_dynamic)
           .unless(moves, "is for load = \"fixed\""),
       K("breaking", in(options, &Options::breaking),
         choice<Breaking>(
             {{"at_equilibrium", Breaking::at_equilibrium}, {"transient", Breaking::transient}}),
         "when damage becomes permanent. `\"at_equilibrium\"`: only in accepted states, so an "
         "overshoot breaks nothing; `\"transient\"`: in every iteration, as published")
           .otherwise(
               [](auto& relaxation, auto&) {
                 if (relaxation.moving) relaxation.options.breaking = Breaking::transient;
               },
               "`\"at_equilibrium\"`; `\"transient\"` if the load is `moving`"),
       K("damping", in(options, &Options::damping),
         choice<Damping>({{"adaptive", Damping::adaptive}, {"kinetic", Damping::kinetic}}),
         "`\"adaptive\"`: a coefficient from the Rayleigh quotient of the present motion, as "
         "published; `\"kinetic\"`: no damping coefficient, but all motion is stopped whenever the "
         "kinetic energy has passed a peak")
           .unless(flows, for_dynamic)
           .otherwise(
               [](auto& relaxation, auto&) {
                 if (relaxation.moving) relaxation.options.damping = Damping::adaptive;
               },
               "`\"kinetic\"`; `\"adaptive\"` if the load is `moving`"),
       K("mass_factor", in(options, &Options::mass_factor), between(1.0, 1e6),
         "pseudo density relative to the smallest stable one: larger is slower and safer")
           .unless(flows, for_dynamic)
           .otherwise(
               [](auto& relaxation, auto&) {
                 if (relaxation.options.damping == Damping::adaptive)
                   relaxation.options.mass_factor = 1.0;
               },
               "2; 1 with adaptive damping"),
       K("max_iterations", in(options, &Options::max_iterations), count_from(1),
         "load `fixed`: largest number of iterations after the ramp. A step that needs more fails "
         "and is cut")
           .extends(),
       K("displacement_tolerance", in(options, &Options::displacement_tolerance), between(0.0, 1.0),
         "load `fixed`: also accepts a state whose displacements changed by less than this in an "
         "iteration, ‖Δu‖/‖u‖, as published (10⁻⁹). 0: never")
           .unless(flows, for_dynamic)},
      {},
      [](auto& at, auto& relaxation) {
        relaxation.options.holds = !relaxation.moving;
        if (relaxation.moving) relaxation.options.ramp = relaxation.iterations / relaxation.steps;
        relaxation.options.relative_tolerance = at.so_far.solver.relative_tolerance;
      }};
}

}  // namespace peristat
