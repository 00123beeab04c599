#include "solvers/linear/make_linear_solver.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "solvers/linear/assembled_preconditioner.hpp"
#include "solvers/linear/block_jacobi.hpp"
#include "solvers/linear/cholesky.hpp"
#include "solvers/linear/iterative_solver.hpp"
#include "solvers/linear/ldlt.hpp"
#include "solvers/linear/rigid_pieces.hpp"
#include "solvers/linear/sines.hpp"
#include "solvers/linear/speeds.hpp"
#include "solvers/linear/surrogate.hpp"

namespace peristat {
namespace {

/// Products that a load step takes by conjugate gradients with rigid pieces: some four solves of
/// 15 iterations, and builds of the preconditioner, each worth 30.
constexpr double products_of_a_step = 120.0;

/// With sines some four solves of 12 iterations, and builds worth 2.
constexpr double iterations_of_a_step_with_sines = 48.0, products_of_builds_of_sines = 4.0;

/// Iterations after which sines were the wrong choice.
constexpr int patience_with_sines = 100;

/// Factorisations up to this are done whatever the alternative [flop], and up to the second for the
/// sake of pivots.
constexpr double small_factorisation = 1e8, affordable_factorisation = 2e10;

/// Iterations in one solve that no choice of the user's own should exceed.
constexpr int most_iterations = 20'000;

using SharedBox = std::shared_ptr<const LatticeBox>;

std::unique_ptr<Preconditioner> make_preconditioner(PreconditionerKind kind, const SharedBox& box) {
  switch (kind) {
    case PreconditionerKind::jacobi:
      return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::entries);
    case PreconditionerKind::block_jacobi:
      return std::make_unique<BlockJacobi>(BlockJacobi::Blocks::points);
    case PreconditionerKind::surrogate:
      return std::make_unique<Surrogate>();
    case PreconditionerKind::sines:
      if (!box) throw std::logic_error("sines need the box of a lattice");
      return std::make_unique<Sines>(box);
    case PreconditionerKind::riluk:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::riluk);
    case PreconditionerKind::chebyshev:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::chebyshev);
    case PreconditionerKind::multigrid:
      return std::make_unique<AssembledPreconditioner>(MatrixPreconditionerKind::multigrid);
    case PreconditionerKind::rigid_pieces:
    case PreconditionerKind::automatic:
      break;
  }
  return std::make_unique<RigidPieces>();
}

std::unique_ptr<LinearSolver> make_iterative(
    PreconditionerKind kind, int max_iterations, const SharedBox& box = {},
    KrylovMethod method = KrylovMethod::conjugate_gradients) {
  return std::make_unique<IterativeSolver>(method, make_preconditioner(kind, box), max_iterations);
}

KrylovMethod krylov_method(LinearMethod method) {
  if (method == LinearMethod::minres) return KrylovMethod::minres;
  return method == LinearMethod::gmres ? KrylovMethod::gmres : KrylovMethod::conjugate_gradients;
}

/// Estimated seconds of a load step.
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
  // A solve by iterations may take three times what factorising is estimated at.
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
        : for_stability ? std::string("its pivots tell whether the softening body is stable")
        : for_many
            ? std::string("each factor serves many solves")
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

}  // namespace

bool can_be_matrix_free(const LinearSolverOptions& options) {
  return options.method != LinearMethod::cholesky && options.method != LinearMethod::ldlt &&
         options.preconditioner != PreconditionerKind::riluk &&
         options.preconditioner != PreconditionerKind::chebyshev &&
         options.preconditioner != PreconditionerKind::multigrid;
}

ChosenSolver make_linear_solver(const LinearSolverOptions& options, const LinearProblem& problem,
                                SolverLadder::Reporter tell) {
  switch (options.method) {
    case LinearMethod::cholesky:
      return {std::make_unique<Cholesky>(FactorReuse{}, problem.available_bytes), true,
              Seconds(problem).direct, "as the case asks"};
    case LinearMethod::ldlt:
      return {std::make_unique<Ldlt>(), true, Seconds(problem).direct,
              "it bears the negative pivots beyond a limit point, and counts them"};
    case LinearMethod::conjugate_gradients:
    case LinearMethod::minres:
    case LinearMethod::gmres:
      return {make_iterative(options.preconditioner, most_iterations, problem.box,
                             krylov_method(options.method)),
              false, Seconds(problem).iterative, "as the case asks"};
    case LinearMethod::automatic:
      break;
  }
  return choose(problem, std::move(tell));
}

}  // namespace peristat
