#include "solvers/linear/make_linear_solver.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "solvers/linear/assembled_preconditioner.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/linear/ldlt.hpp"
#include "solvers/linear/local_operator.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/linear/sines.hpp"
#include "solvers/linear/sparse_lu.hpp"
#include "solvers/linear/speeds.hpp"
#include "solvers/linear/surrogate.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Products with the tangent in a load step by conjugate gradients with rigid pieces: some four
/// solves of 15 iterations, and builds of the preconditioner, each worth 30.
constexpr double products_of_a_step = 120.0;

/// The same with sines: some four solves of 12 iterations, and builds worth 2 products each.
constexpr double iterations_of_a_step_with_sines = 48.0, products_of_builds_of_sines = 4.0;

/// Iterations after which sines give way to the next solver.
constexpr int patience_with_sines = 100;

/// Factorisations up to the first limit [flop] are done whatever the alternative; up to the second
/// if pivots are needed or many systems share a tangent.
constexpr double small_factorisation = 1e8, affordable_factorisation = 2e10;

/// Iterations in one solve where no other solver takes over.
constexpr int most_iterations = 20'000;

/// Products per solve by GMRES with the local operator, and by BiCGStab where masses dominate; and
/// solves per load step, which share one factorisation if the tangent stays the same.
constexpr double products_of_gmres = 70.0, products_with_inertia = 10.0, solves_of_a_step = 3.0;

/// Most and fewest vectors that GMRES keeps, and the fraction of the available memory for them.
constexpr double most_vectors = 200.0, least_vectors = 30.0, share_of_vectors = 0.25;

/// Iterations after which GMRES with the local operator gives way to the next solver.
constexpr int patience_of_gmres = 600;

/// Iterations in one solve of a ladder on several ranks, where no factorisation takes over.
constexpr int patience_on_ranks = 2000;

/// Iterations for a system of masses with a little stiffness: two to five are typical.
constexpr int patience_with_inertia = 100;

using SharedBox = std::shared_ptr<const LatticeBox>;

std::unique_ptr<Preconditioner> make_preconditioner(PreconditionerKind kind, const SharedBox& box,
                                                    const IndexMap& index_map) {
  switch (kind) {
    case PreconditionerKind::jacobi:
      return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::entries);
    case PreconditionerKind::block_jacobi:
      return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points);
    case PreconditionerKind::surrogate:
      return std::make_unique<Surrogate>(index_map);
    case PreconditionerKind::sines:
      if (!box) throw std::logic_error("sines need the box of a lattice");
      return std::make_unique<Sines>(box);
    case PreconditionerKind::riluk:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::riluk, index_map);
    case PreconditionerKind::chebyshev:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::chebyshev,
                                                       index_map);
    case PreconditionerKind::multigrid:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::multigrid,
                                                       index_map);
    case PreconditionerKind::local_operator:
      return std::make_unique<LocalOperator>();
    case PreconditionerKind::rigid_pieces:
    case PreconditionerKind::automatic:
      break;
  }
  return std::make_unique<RigidPieces>(index_map);
}

std::unique_ptr<LinearSolver> make_iterative(
    PreconditionerKind kind, int max_iterations, const SharedBox& box = {},
    KrylovMethod method = KrylovMethod::conjugate_gradients,
    const IndexMap& index_map = whole_body()) {
  return std::make_unique<IterativeSolver>(method, make_preconditioner(kind, box, index_map),
                                           max_iterations, KrylovOptions{}.restart,
                                           index_map.ranks());
}

KrylovMethod krylov_method(LinearMethod method) {
  if (method == LinearMethod::minres) return KrylovMethod::minres;
  if (method == LinearMethod::bicgstab) return KrylovMethod::bicgstab;
  return method == LinearMethod::gmres ? KrylovMethod::gmres : KrylovMethod::conjugate_gradients;
}

/// Estimated seconds of a factorisation, of a product, and of a load step by iterations.
struct Seconds {
  double direct, product, iterative;
  explicit Seconds(const LinearProblem& problem)
      : direct(problem.factor_flops / speeds::factorisation +
               problem.factor_bytes / speeds::fresh_memory),
        product(problem.bonds / speeds::product),
        iterative(products_of_a_step * product) {
    if (!problem.box) return;
    const double transforms =
        2.0 * problem.box->dimension * double(problem.box->count()) / speeds::transform;
    iterative = iterations_of_a_step_with_sines * (product + transforms) +
                products_of_builds_of_sines * product;
  }
};

ChosenSolver choose(const LinearProblem& problem, SolverLadder::Reporter tell) {
  const auto [direct, product, iterative] = Seconds(problem);
  // The iterations of a solve may take three times the estimated time of a factorisation.
  const int patience =
      static_cast<int>(std::clamp(3.0 * direct / std::max(product, 1e-9), 200.0, 2000.0));
  const SolverLadder::Rung cholesky{"cholesky", [available = problem.available_bytes] {
                                      return std::make_unique<Cholesky>(FactorReuse{}, available);
                                    }};
  const SolverLadder::Rung pieces{
      "pcg with rigid_pieces",
      [patience] { return make_iterative(PreconditionerKind::rigid_pieces, patience); }};
  const SolverLadder::Rung sines{"pcg with sines", [box = problem.box] {
                                   return make_iterative(PreconditionerKind::sines,
                                                         patience_with_sines, box);
                                 }};
  const SolverLadder::Rung surrogate{
      "pcg with surrogate",
      [patience] { return make_iterative(PreconditionerKind::surrogate, patience); }};
  const SolverLadder::Rung patient{
      "pcg with block_jacobi",
      [] { return make_iterative(PreconditionerKind::block_jacobi, most_iterations); }};
  const bool fits = problem.is_stored && problem.factor_bytes <= problem.available_bytes;
  const bool is_small = problem.factor_flops <= small_factorisation;
  const bool for_stability = problem.may_soften && problem.factor_flops <= affordable_factorisation;
  const bool for_many = problem.solves_often && problem.factor_flops <= affordable_factorisation;
  std::vector<SolverLadder::Rung> rungs;
  std::string reason;
  const bool is_direct = fits && (is_small || for_stability || for_many || direct <= iterative);
  if (is_direct) {
    rungs = {cholesky, pieces, surrogate, patient};
    reason =
        is_small ? fmt::format("a factorisation of {:.2g} flops is small", problem.factor_flops)
        : for_stability ? std::string("its pivots show whether the softening body is stable")
        : for_many
            ? std::string("each factor is used for many solutions")
            : fmt::format("a factorisation is estimated at {:.2g} s, iterations at {:.2g} s a step",
                          direct, iterative);
  } else {
    rungs = {pieces, surrogate, fits ? cholesky : patient};
    reason =
        direct > iterative
            ? fmt::format("a factorisation is estimated at {:.2g} s, iterations at {:.2g} s a step",
                          direct, iterative)
        : !problem.is_stored
            ? std::string("a factorisation needs the stored tangent")
            : fmt::format("a factor would need about {:.2g} GB of {:.2g} GB available",
                          problem.factor_bytes / 1e9, problem.available_bytes / 1e9);
    if (problem.box) rungs.insert(rungs.begin(), sines);
  }
  return {std::make_unique<SolverLadder>(std::move(rungs), std::move(tell)), is_direct,
          is_direct ? direct : iterative, fmt::format("auto: {}", reason)};
}

ChosenSolver choose_on_ranks(const LinearProblem& problem, SolverLadder::Reporter tell) {
  const auto rung = [&index_map = *problem.index_map](const char* name, PreconditionerKind kind,
                                                      int most) {
    return SolverLadder::Rung{name, [=, &index_map] {
                                return make_iterative(kind, most, {},
                                                      KrylovMethod::conjugate_gradients, index_map);
                              }};
  };
  std::vector<SolverLadder::Rung> rungs{
      rung("pcg with rigid_pieces", PreconditionerKind::rigid_pieces, patience_on_ranks),
      rung("pcg with surrogate", PreconditionerKind::surrogate, patience_on_ranks),
      rung("pcg with block_jacobi", PreconditionerKind::block_jacobi, most_iterations)};
  return {std::make_unique<SolverLadder>(std::move(rungs), std::move(tell)), false,
          Seconds(problem).iterative, "auto: factorisations and sines are for one rank"};
}

/// Number of vectors that GMRES keeps before it restarts.
int restart_for(const LinearProblem& problem) {
  const double vector = 8.0 * std::max(problem.unknowns, 1.0);
  const double room =
      problem.index_map->ranks().min(share_of_vectors * problem.available_bytes / vector);
  return static_cast<int>(std::clamp(room, least_vectors, most_vectors));
}

std::unique_ptr<LinearSolver> make_unsymmetric(LinearMethod method, PreconditionerKind kind,
                                               const LinearProblem& problem, int max_iterations) {
  if (method == LinearMethod::lu) return std::make_unique<SparseLu>(problem.available_bytes);
  if (kind == PreconditionerKind::automatic) {
    kind = problem.index_map->is_whole() ? PreconditionerKind::local_operator
                                         : PreconditionerKind::block_jacobi;
  }
  auto preconditioner = kind == PreconditionerKind::local_operator
                            ? std::make_unique<LocalOperator>(problem.available_bytes)
                            : make_preconditioner(kind, {}, *problem.index_map);
  return std::make_unique<IterativeSolver>(krylov_method(method), std::move(preconditioner),
                                           max_iterations, restart_for(problem),
                                           problem.index_map->ranks());
}

/// Estimated seconds of a load step with an unsymmetric tangent, whose product visits every bond
/// twice.
struct UnsymmetricSeconds {
  double direct, iterative;
  explicit UnsymmetricSeconds(const LinearProblem& problem)
      : direct(problem.factor_flops / speeds::unsymmetric_factorisation +
               problem.factor_bytes / speeds::fresh_memory),
        iterative(solves_of_a_step *
                  (problem.has_inertia ? products_with_inertia : products_of_gmres) * 2.0 *
                  problem.bonds / speeds::product) {}
};

ChosenSolver choose_unsymmetric(const LinearProblem& problem, SolverLadder::Reporter tell) {
  const auto rung = [problem](const char* name, LinearMethod method, PreconditionerKind kind,
                              int most) {
    return SolverLadder::Rung{name, [=] { return make_unsymmetric(method, kind, problem, most); }};
  };
  const auto lu = rung("lu", LinearMethod::lu, PreconditionerKind::automatic, 0);
  const auto gmres = rung("gmres with local_operator", LinearMethod::gmres,
                          PreconditionerKind::local_operator, patience_of_gmres);
  const auto patient = rung("gmres with block_jacobi", LinearMethod::gmres,
                            PreconditionerKind::block_jacobi, most_iterations);
  const auto light = rung("bicgstab with block_jacobi", LinearMethod::bicgstab,
                          PreconditionerKind::block_jacobi, patience_with_inertia);
  const auto [direct, iterative] = UnsymmetricSeconds(problem);
  const bool fits = problem.factor_bytes <= problem.available_bytes;
  const bool is_small = problem.factor_flops <= small_factorisation;
  const bool is_direct = problem.index_map->is_whole() && !problem.has_inertia && fits &&
                         (is_small || direct <= iterative);
  std::vector<SolverLadder::Rung> rungs;
  std::string reason;
  if (!problem.index_map->is_whole()) {
    rungs = {patient};
    if (problem.has_inertia) rungs.insert(rungs.begin(), light);
    reason = "factorisations are for one rank";
  } else if (problem.has_inertia) {
    rungs = {light, gmres, fits ? lu : patient};
    reason = "masses dominate";
  } else if (is_direct) {
    rungs = {lu, gmres, patient};
    reason =
        is_small
            ? fmt::format("a factorisation of {:.2g} flops is small", problem.factor_flops)
            : fmt::format("a factorisation is estimated at {:.2g} s, iterations at {:.2g} s a step",
                          direct, iterative);
  } else {
    rungs = {gmres, fits ? lu : patient};
    reason = fits ? fmt::format(
                        "a factorisation is estimated at {:.2g} s, iterations at {:.2g} s a step",
                        direct, iterative)
                  : fmt::format("a factor would need about {:.2g} GB of {:.2g} GB available",
                                problem.factor_bytes / 1e9, problem.available_bytes / 1e9);
  }
  return {std::make_unique<SolverLadder>(std::move(rungs), std::move(tell)), is_direct,
          is_direct ? direct : iterative,
          fmt::format("auto: {}, the tangent is not symmetric", reason)};
}

ChosenSolver make_unsymmetric_solver(const LinearSolverOptions& options,
                                     const LinearProblem& problem, SolverLadder::Reporter tell) {
  const auto& [method, preconditioner] = options;
  for (const std::string& why :
       {what_is_against(method, false), what_is_against(preconditioner, false)}) {
    if (!why.empty()) throw std::logic_error("make_linear_solver: " + why);
  }
  const auto [direct, iterative] = UnsymmetricSeconds(problem);
  if (method != LinearMethod::automatic) {
    const bool is_direct = method == LinearMethod::lu;
    return {make_unsymmetric(method, preconditioner, problem, most_iterations), is_direct,
            is_direct ? direct : iterative, "as the case asks"};
  }
  if (preconditioner != PreconditionerKind::automatic) {
    return {make_unsymmetric(LinearMethod::gmres, preconditioner, problem, most_iterations), false,
            iterative, "as the case asks"};
  }
  return choose_unsymmetric(problem, std::move(tell));
}

}  // namespace

std::string what_is_against(LinearMethod method, bool is_symmetric) {
  switch (method) {
    case LinearMethod::automatic:
    case LinearMethod::gmres:
      return "";
    case LinearMethod::lu:
    case LinearMethod::bicgstab:
      if (!is_symmetric) return "";
      return "is for models whose tangent is not symmetric; take cholesky, pcg, minres or gmres";
    case LinearMethod::cholesky:
    case LinearMethod::ldlt:
    case LinearMethod::conjugate_gradients:
    case LinearMethod::minres:
      break;
  }
  if (is_symmetric) return "";
  return "is for symmetric tangents, and this model's is not; take lu, gmres or bicgstab";
}

std::string what_is_against(PreconditionerKind preconditioner, bool is_symmetric) {
  switch (preconditioner) {
    case PreconditionerKind::automatic:
    case PreconditionerKind::jacobi:
    case PreconditionerKind::block_jacobi:
      return "";
    case PreconditionerKind::local_operator:
      return is_symmetric ? "is for models whose tangent is not symmetric; take rigid_pieces" : "";
    case PreconditionerKind::rigid_pieces:
    case PreconditionerKind::surrogate:
    case PreconditionerKind::sines:
    case PreconditionerKind::riluk:
    case PreconditionerKind::chebyshev:
    case PreconditionerKind::multigrid:
      break;
  }
  if (is_symmetric) return "";
  return "is for symmetric tangents, but the tangent of this model is not symmetric; take "
         "local_operator, block_jacobi or jacobi";
}

bool can_be_matrix_free(const LinearSolverOptions& options) {
  return options.method != LinearMethod::cholesky && options.method != LinearMethod::ldlt &&
         options.preconditioner != PreconditionerKind::riluk &&
         options.preconditioner != PreconditionerKind::chebyshev &&
         options.preconditioner != PreconditionerKind::multigrid;
}

namespace {

/// The solver that is asked for, on a ladder without others: contacts change the pattern, which is
/// then analysed anew.
std::unique_ptr<LinearSolver> alone(std::function<std::unique_ptr<LinearSolver>()> make) {
  return std::make_unique<SolverLadder>(
      std::vector<SolverLadder::Rung>{{"the solver", std::move(make)}}, nullptr);
}

}  // namespace

ChosenSolver make_linear_solver(const LinearSolverOptions& options, const LinearProblem& problem,
                                SolverLadder::Reporter tell) {
  if (!problem.is_symmetric) return make_unsymmetric_solver(options, problem, std::move(tell));
  for (const std::string& why :
       {what_is_against(options.method, true), what_is_against(options.preconditioner, true)}) {
    if (!why.empty()) throw std::logic_error("make_linear_solver: " + why);
  }
  switch (options.method) {
    case LinearMethod::cholesky:
      return {alone([available = problem.available_bytes] {
                return std::make_unique<Cholesky>(FactorReuse{}, available);
              }),
              true, Seconds(problem).direct, "as the case asks"};
    case LinearMethod::ldlt:
      return {alone([] { return std::make_unique<Ldlt>(); }), true, Seconds(problem).direct,
              "it handles the negative pivots beyond a limit point, and counts them"};
    case LinearMethod::conjugate_gradients:
    case LinearMethod::minres:
    case LinearMethod::gmres:
      return {alone([options, box = problem.box, &index_map = *problem.index_map] {
                return make_iterative(options.preconditioner, most_iterations, box,
                                      krylov_method(options.method), index_map);
              }),
              false, Seconds(problem).iterative, "as the case asks"};
    case LinearMethod::automatic:
    case LinearMethod::lu:
    case LinearMethod::bicgstab:
      break;
  }
  if (!problem.index_map->is_whole()) return choose_on_ranks(problem, std::move(tell));
  return choose(problem, std::move(tell));
}

}  // namespace peristat
