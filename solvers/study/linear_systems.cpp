#include "solvers/study/linear_systems.hpp"

#include <optional>
#include <string>
#include <utility>

#include "assembly/operators/constrained_product.hpp"
#include "assembly/operators/constrained_tangent.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"
#include "assembly/operators/rows_of_energy.hpp"
#include "assembly/operators/tangent.hpp"
#include "solvers/body/body_memory.hpp"
#include "solvers/linear/available_memory.hpp"
#include "solvers/linear/no_solver.hpp"
#include "solvers/linear/sines_estimate.hpp"
#include "solvers/ranks/part_tangent.hpp"
#include "solvers/search/updated_tangent.hpp"
#include "solvers/study/found_loads.hpp"
#include "src/core/input_error.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Requires LDL^T if loads are found: other solvers fail if the tangent has negative pivots.
void require_ldlt(const StudyOptions& options) {
  const std::string why =
      "a control and mode arc_length need the direct solver that handles negative pivots; it is "
      "chosen automatically";
  const LinearMethod method = options.linear.method;
  if (method != LinearMethod::automatic && method != LinearMethod::ldlt) {
    throw InputError("linear.method", "", why);
  }
  if (options.linear.preconditioner != PreconditionerKind::automatic) {
    throw InputError("linear.preconditioner", "", why);
  }
  if (options.tangent == TangentStorage::matrix_free) {
    throw InputError("tangent", "matrix_free", why);
  }
}

void require_agreement(const LinearSolverOptions& linear, bool is_symmetric) {
  const std::string method = what_is_against(linear.method, is_symmetric);
  if (!method.empty()) throw InputError("linear.method", "", method);
  const std::string preconditioner = what_is_against(linear.preconditioner, is_symmetric);
  if (!preconditioner.empty()) throw InputError("linear.preconditioner", "", preconditioner);
}

/// Options for forces by convolutions, which have no rows to factorise or to aggregate.
LinearSolverOptions options_of_convolutions(const StudyOptions& options, bool has_box) {
  LinearSolverOptions linear = options.linear;
  const auto is_one_of = [](auto value, auto... known) { return ((value == known) || ...); };
  if (!is_one_of(linear.method, LinearMethod::automatic, LinearMethod::conjugate_gradients,
                 LinearMethod::minres, LinearMethod::gmres)) {
    throw InputError("linear.method", "",
                     "needs the entries of the tangent, which operator \"fft\" does not have; take "
                     "\"pcg\"");
  }
  using Kind = PreconditionerKind;
  if (!is_one_of(linear.preconditioner, Kind::automatic, Kind::jacobi, Kind::block_jacobi,
                 Kind::sines)) {
    throw InputError("linear.preconditioner", "",
                     "needs the entries of the tangent, which operator \"fft\" does not have; take "
                     "\"sines\" or \"block_jacobi\"");
  }
  if (options.tangent == TangentStorage::stored) {
    throw InputError("tangent", "stored",
                     "is not allowed with operator \"fft\", which has only products");
  }
  if (linear.method == LinearMethod::automatic) linear.method = LinearMethod::conjugate_gradients;
  if (linear.preconditioner == Kind::automatic) {
    linear.preconditioner = has_box ? Kind::sines : Kind::block_jacobi;
  }
  return linear;
}

/// Vectors of the flow beside those of Newton's search: state, two directions, working forces, load
/// path.
constexpr double vectors_of_flow = 9.0;

/// Mode path: vectors beside those of Newton's search, and numbers per bond: histories of three
/// states, resistances in two. What is known of corrections is in the tangent, in two states of the
/// path and in its checkpoint.
constexpr double vectors_of_events = 12.0, numbers_of_events_per_bond = 5.0, copies_of_known = 4.0;

/// Mode fatigue: lives before and after a block, kinds of laws, rates, borne and present stretches.
constexpr double bytes_of_lives_per_bond = 2.0 * 9.0 + 3.0 * 8.0 + sizeof(BondDrive);

/// Mode dynamics: vectors of mass, its inverse, velocities before and after, and Lanczos' method.
constexpr double vectors_of_motion = 9.0;

/// A rank may have no points; there is no estimate for this case.
MemoryEstimate estimate_memory_of_part(const Body& body) {
  if (body.points.count() > 0) return estimate_memory(body);
  MemoryEstimate nothing;
  nothing.size.dimension = body.points.dimension;
  nothing.size.ranks = body.index_map->ranks().count();
  return nothing;
}

/// True if degrees of freedom and those that they follow are on the same rank, or they follow
/// generalised ones: images are on the rank of their sources, and rigid sets follow generalised
/// ones alone.
bool has_rows_of_part(const Body& body) {
  const ConstraintSpecification& constraints = body.specification.constraints;
  return constraints.rollers.empty() && constraints.linear.empty();
}

/// True if the rows that a preconditioner needs can be visited without storing the tangent.
bool needs_no_storage(TangentKind kind) { return kind <= TangentKind::nearby; }

/// True if a model's tangent has products alone, as by convolutions.
bool has_products_only(const Model& model) { return model.tangent_kind() == TangentKind::products; }

/// True if a preconditioner uses only the diagonal blocks of a tangent.
bool is_of_points(PreconditionerKind kind) {
  return kind == PreconditionerKind::block_jacobi || kind == PreconditionerKind::jacobi;
}

/// Systems for explicit steps, which solve nothing but need products of the tangent now and then.
LinearSystems systems_of_motion(const Body& body) {
  const MemoryEstimate estimate = estimate_memory_of_part(body);
  LinearSystems systems;
  systems.chosen.solver = std::make_unique<NoSolver>();
  systems.chosen.is_direct = false;
  systems.chosen.reason = "explicit time steps solve no equations";
  const bool is_followed = !body.conditions->constraints().none();
  const TangentKind kind = body.model.tangent_kind();
  systems.is_stored = needs_no_storage(kind) ? is_followed : kind != TangentKind::products;
  systems.has_rows = has_rows_of_part(body);
  systems.bytes = estimate.bytes_with(
      systems.is_stored, 8.0 * vectors_of_motion * estimate.size.points * estimate.size.dimension);
  return systems;
}

/// Refuses solvers for one rank: no rank has the whole tangent, or the whole box of a lattice.
void refuse_solvers_without_ranks(const StudyOptions& options, const Body& body) {
  const auto refuse = [](const std::string& key, const std::string& what) {
    throw InputError(key, "", "is for one rank; on several ranks take " + what);
  };
  const LinearMethod method = options.linear.method;
  if (method == LinearMethod::cholesky || method == LinearMethod::ldlt) {
    refuse("linear.method", "\"auto\", \"pcg\", \"minres\" or \"gmres\"");
  }
  if (method == LinearMethod::lu) refuse("linear.method", "\"auto\", \"gmres\" or \"bicgstab\"");
  const PreconditionerKind kind = options.linear.preconditioner;
  if (kind == PreconditionerKind::sines) {
    refuse("linear.preconditioner", "\"rigid_pieces\" or \"surrogate\"");
  }
  if (kind == PreconditionerKind::local_operator) {
    refuse("linear.preconditioner", "\"block_jacobi\" or \"jacobi\"");
  }
  const bool is_simple = kind == PreconditionerKind::automatic || is_of_points(kind);
  if (!has_rows_of_part(body) && !is_simple) {
    refuse("linear.preconditioner",
           "\"block_jacobi\" or \"jacobi\" with rollers and linear constraints");
  }
  const bool has_handles = !body.conditions->constraints().handles().empty();
  if (has_handles && !is_simple && kind != PreconditionerKind::rigid_pieces) {
    refuse("linear.preconditioner",
           "\"rigid_pieces\", \"block_jacobi\" or \"jacobi\" with periods and rigid sets");
  }
  if (finds_loads(options, *body.conditions)) {
    refuse("loading.mode", "given loads: loads that are found need pivots");
  }
  if (has_products_only(body.model)) refuse("force_operator", "\"bonds\"");
}

void refuse_products_with_constraints(const StudyOptions& options, const Body& body) {
  const bool follows = !body.conditions->constraints().none() && !has_products_only(body.model);
  if (!follows || options.tangent != TangentStorage::matrix_free) return;
  throw InputError("tangent", "matrix_free",
                   "is for bodies without rigid sets, rollers, linear constraints, planes of "
                   "symmetry and periods");
}

/// Refuses modes that solve equations for convolutions without a potential: these have neither rows
/// to solve with nor an energy to minimise.
void refuse_to_solve_for(const Body& body, const LoadSteppingOptions& loading) {
  if (!has_products_only(body.model) || body.model.balances().potential) return;
  const std::string why =
      "is for models with an energy; form \"printed\" takes only mode dynamics with scheme "
      "\"verlet\", form \"energy\" takes all modes";
  if (loading.mode == Mode::dynamics) {
    if (loading.dynamics.scheme == MotionScheme::newmark)
      throw InputError("dynamics.scheme", "newmark", why);
    throw InputError("dynamics.start", "equilibrium", why);
  }
  throw InputError("loading.mode", std::string(loading.mode.name), why);
}

/// Lattice box of a body for which sines are estimated to be the best choice, if `automatic` is
/// requested; null otherwise.
std::shared_ptr<const LatticeBox> box_for_choice(const StudyOptions& options, const Body& body) {
  const BodySpecification& of = body.specification;
  const bool is_free = options.linear.method == LinearMethod::automatic &&
                       options.linear.preconditioner == PreconditionerKind::automatic;
  const bool is_whole = !body.model.has_history() && body.cut_bonds.empty();
  if (!is_free || !is_whole || !of.is_uniform() || of.has_inertia ||
      !needs_no_storage(body.model.tangent_kind()) || !body.conditions->constraints().none() ||
      body.points.angle != 0.0) {
    return nullptr;
  }
  std::string why_not;
  std::optional<LatticeBox> box = lattice_box(body.points, why_not);
  if (!box || !suits_sines(*box, body.conditions->prescribed())) return nullptr;
  return std::make_shared<LatticeBox>(std::move(*box));
}

/// Lattice box for convolutions: sines are the first choice if the sides of the box are the body's.
std::shared_ptr<const LatticeBox> box_of_convolutions(const StudyOptions& options,
                                                      const Body& body) {
  const PreconditionerKind asked = options.linear.preconditioner;
  const bool is_wanted =
      asked == PreconditionerKind::automatic || asked == PreconditionerKind::sines;
  if (!is_wanted) return nullptr;
  if (!body.conditions->constraints().none()) {
    if (asked == PreconditionerKind::automatic) return nullptr;
    throw InputError("linear.preconditioner", "sines",
                     "is for bodies without planes of symmetry and periods, whose equations are "
                     "not those of points on a lattice; take \"block_jacobi\"");
  }
  if (body.points.angle != 0.0) {
    if (asked == PreconditionerKind::automatic) return nullptr;
    throw InputError("linear.preconditioner", "sines",
                     "is for lattices along the axes; take \"block_jacobi\"");
  }
  std::string why_not;
  return std::make_shared<LatticeBox>(lattice_box(body.points, why_not).value());
}

/// Bonds that a product of conjugate gradients visits: those of the stored tangent, or where it is
/// not stored, of two sweeps for states.
double bonds_of_product(const StudyOptions& options, const MemoryEstimate& estimate,
                        TangentKind kind) {
  const bool sweeps_twice = kind == TangentKind::nearby && can_be_matrix_free(options.linear) &&
                            options.tangent != TangentStorage::stored;
  return sweeps_twice ? 2.0 * estimate.size.bonds : estimate.size.stored_blocks();
}

bool flows(const StudyOptions& options, const Model& model) {
  const LoadSteppingOptions& loading = options.loading;
  const bool relaxes =
      loading.mode == Mode::relaxation || (loading.mode == Mode::adaptive && model.has_history());
  return relaxes && loading.relaxation.method == RelaxationMethod::flow;
}

}  // namespace

std::shared_ptr<const LatticeBox> box_for_sines(const StudyOptions& options, const Body& body) {
  if (has_products_only(body.model)) return box_of_convolutions(options, body);
  if (options.linear.preconditioner != PreconditionerKind::sines)
    return box_for_choice(options, body);
  const auto refuse = [](const std::string& why) {
    throw InputError("linear.preconditioner", "sines",
                     why + "; take \"rigid_pieces\" or \"surrogate\"");
  };
  if (!body.conditions->constraints().none()) {
    refuse(
        "is for bodies without rigid sets, rollers, linear constraints, planes of symmetry and "
        "periods, whose equations are not those of points on a lattice");
  }
  if (body.points.angle != 0.0) {
    refuse(
        "is for lattices along the axes: the sides of this lattice's box are not those of the "
        "body");
  }
  std::string why_not;
  std::optional<LatticeBox> box = lattice_box(body.points, why_not);
  if (!box) refuse("needs points on a lattice: " + why_not);
  return std::make_shared<LatticeBox>(std::move(*box));
}

LinearSystems choose_linear_systems(const StudyOptions& options, const Model& model,
                                    const MemoryEstimate& estimate,
                                    std::shared_ptr<const LatticeBox> box,
                                    SolverLadder::Reporter tell, const IndexMap& index_map) {
  const TangentKind kind = model.tangent_kind();
  LinearSolverOptions linear = kind == TangentKind::products
                                   ? options_of_convolutions(options, box != nullptr)
                                   : options.linear;
  const bool is_symmetric = model.balances().potential;
  require_agreement(linear, is_symmetric);
  // A named preconditioner must be used.
  if (is_symmetric && linear.method == LinearMethod::automatic &&
      linear.preconditioner != PreconditionerKind::automatic)
    linear.method = LinearMethod::conjugate_gradients;
  if (options.tangent == TangentStorage::matrix_free &&
      (kind == TangentKind::stored || kind == TangentKind::rows))
    throw InputError("tangent", "matrix_free",
                     "is for bonds and states alone: other models need the stored tangent");
  LinearProblem problem;
  problem.is_symmetric = is_symmetric;
  problem.index_map = &index_map;
  problem.unknowns = estimate.size.free_dofs;
  problem.has_inertia = options.loading.mode == Mode::dynamics &&
                        options.loading.dynamics.scheme == MotionScheme::newmark;
  problem.bonds = bonds_of_product(options, estimate, kind);
  problem.factor_flops = estimate.factor_flops;
  problem.factor_bytes = estimate.direct_bytes(linear.method);
  problem.available_bytes = available_memory() - estimate.body_bytes - estimate.tangent_bytes;
  // In other modes damage grows in relaxation, which finds stable states only.
  const bool is_fatigue = options.loading.mode == Mode::fatigue;
  problem.may_soften = model.has_history() && (options.loading.mode == Mode::newton || is_fatigue);
  const bool goes_by_events = options.loading.mode == Mode::path;
  problem.solves_often = flows(options, model) || goes_by_events;
  problem.box = std::move(box);
  problem.is_stored =
      kind != TangentKind::products && options.tangent != TangentStorage::matrix_free;
  LinearSystems systems;
  systems.chosen = make_linear_solver(linear, problem, tell);
  // Matrix-free products take less memory; in 3D they are faster than stored ones, in 2D a sixth
  // slower.
  if (options.tangent == TangentStorage::automatic && !systems.chosen.is_direct &&
      needs_no_storage(kind) && can_be_matrix_free(linear)) {
    problem.is_stored = false;
    systems.chosen = make_linear_solver(linear, problem, std::move(tell));
  }
  systems.is_stored = problem.is_stored;
  systems.precision = options.precision;
  if (problem.box) linear.preconditioner = PreconditionerKind::sines;
  systems.bytes = estimate.bytes(systems.chosen.is_direct, systems.is_stored, linear);
  const double bytes_of_vector = 8.0 * estimate.size.points * estimate.size.dimension;
  if (goes_by_events) {
    // In single precision: the columns, what is known, and the factor.
    const double singles = copies_of_known * 2.0 * KnownCorrections::most +
                           (systems.chosen.is_direct ? UpdatedTangent::most_columns : 0.0);
    if (systems.chosen.is_direct) systems.bytes += 4.0 * estimate.factor_entries;
    systems.bytes += (vectors_of_events + 0.5 * singles) * bytes_of_vector +
                     8.0 * numbers_of_events_per_bond * estimate.size.bonds;
  } else if (problem.solves_often) {
    systems.bytes += vectors_of_flow * bytes_of_vector;
  }
  if (is_fatigue) systems.bytes += bytes_of_lives_per_bond * estimate.size.bonds;
  return systems;
}

LinearSystems choose_linear_systems(const StudyOptions& options, const Body& body,
                                    SolverLadder::Reporter tell) {
  const bool is_explicit = !options.loading.dynamics.searches();
  if (options.loading.mode == Mode::dynamics && is_explicit) return systems_of_motion(body);
  refuse_to_solve_for(body, options.loading);
  refuse_products_with_constraints(options, body);
  if (!body.index_map->is_whole()) {
    refuse_solvers_without_ranks(options, body);
    StudyOptions of_part = options;
    const bool has_rows = has_rows_of_part(body);
    PreconditionerKind& kind = of_part.linear.preconditioner;
    if (!has_rows && kind == PreconditionerKind::automatic) kind = PreconditionerKind::block_jacobi;
    if (!body.conditions->constraints().none() && has_rows) {
      of_part.tangent = TangentStorage::stored;
    }
    LinearSystems systems = choose_linear_systems(
        of_part, body.model, estimate_memory_of_part(body), {}, std::move(tell), *body.index_map);
    systems.has_rows = has_rows;
    return systems;
  }
  StudyOptions chosen = options;
  if (has_products_only(body.model)) {
    const ConstraintSpecification& of = body.specification.constraints;
    if (!of.rigid_sets.empty() || !of.rollers.empty() || !of.linear.empty()) {
      throw InputError("constraints", "",
                       "rigid sets, rollers and linear constraints are not allowed with operator "
                       "\"fft\"; take \"bonds\"");
    }
    if (finds_loads(options, *body.conditions)) {
      throw InputError("force_operator", "fft",
                       "has no pivots, which a control and mode arc_length need; take \"bonds\"");
    }
  }
  if (!body.conditions->constraints().none() && !has_products_only(body.model)) {
    chosen.tangent = TangentStorage::stored;
  }
  if (finds_loads(options, *body.conditions)) {
    require_ldlt(options);
    chosen.linear = {LinearMethod::ldlt, PreconditionerKind::automatic};
    chosen.tangent = TangentStorage::stored;
  }
  return choose_linear_systems(chosen, body.model, estimate_memory(body),
                               box_for_sines(chosen, body), std::move(tell));
}

namespace {

/// Operator of the points of this rank, with the values of ghosts where the body is partitioned.
template <class Operator, class... Options>
std::unique_ptr<TangentOperator> make_plain(Assembler& assembler, Options... options) {
  if (assembler.index_map().is_whole()) return std::make_unique<Operator>(assembler, options...);
  return std::make_unique<PartTangent<Operator>>(assembler, options...);
}

}  // namespace

std::unique_ptr<TangentOperator> LinearSystems::make_tangent(Assembler& assembler,
                                                             const Constraints& constraints) const {
  const TangentKind kind = assembler.tangent_kind();
  if (kind == TangentKind::products) return make_convolved_tangent(assembler, constraints);
  if (kind == TangentKind::rows) return make_plain<RowsOfEnergy>(assembler);
  const IndexMap& index_map = assembler.index_map();
  if (!constraints.none() && (index_map.is_whole() || (is_stored && has_rows))) {
    return std::make_unique<ConstrainedTangent>(assembler, constraints, index_map);
  }
  if (!constraints.none()) {  // which updates the ghosts itself
    std::unique_ptr<TangentOperator> plain;
    if (is_stored) {
      plain = std::make_unique<Tangent>(assembler);
    } else {
      plain = std::make_unique<MatrixFreeTangent>(assembler, precision);
    }
    return std::make_unique<ConstrainedProduct>(std::move(plain), assembler.points(), constraints,
                                                index_map);
  }
  if (is_stored) return make_plain<Tangent>(assembler);
  return make_plain<MatrixFreeTangent>(assembler, precision);
}

}  // namespace peristat
