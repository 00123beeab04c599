#include "solvers/linear/iterative_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "solvers/linear/worst_outcome.hpp"
#include "src/core/stopwatch.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

constexpr double worn_out = 1.5;

/// Round-off of b - K x, in units of epsilon times the largest diagonal entry of K times ||x||. The
/// displacements of a slender body are so large that no solver reduces the residual further.
constexpr double round_off = 20.0 * std::numeric_limits<double>::epsilon();

const char* words_for(KrylovMethod method) {
  switch (method) {
    case KrylovMethod::conjugate_gradients:
      break;
    case KrylovMethod::minres:
      return "MINRES";
    case KrylovMethod::gmres:
      return "GMRES";
    case KrylovMethod::bicgstab:
      return "BiCGStab";
  }
  return "conjugate gradients";
}

}  // namespace

IterativeSolver::IterativeSolver(KrylovMethod method,
                                 std::unique_ptr<Preconditioner> preconditioner, int max_iterations,
                                 int restart, const Communicator& ranks)
    : method_(method),
      preconditioner_(std::move(preconditioner)),
      max_iterations_(max_iterations),
      restart_(restart),
      ranks_(ranks) {}

double IterativeSolver::norm_of_all(std::span<const double> v) const {
  return peristat::norm_of_all(ranks_, norm(v));
}

bool IterativeSolver::is_empty(std::size_t equations) const {
  return ranks_.max(double(equations)) == 0.0;
}

LinearOutcome IterativeSolver::analyze(const BlockPattern& pattern, const FreeDofs& free) {
  const Stopwatch watch(statistics_.seconds);
  free_ = &free;
  full_.resize(free.equation.size());
  built_ = false;
  preconditioner_->analyze(pattern, free);
  return LinearOutcome::solved;
}

LinearOutcome IterativeSolver::build() {
  built_ = built_now_ = false;
  worn_ = false;
  iterations_per_digit_ = 0.0;
  ++statistics_.factorisations;
  const LinearOutcome outcome = worst_outcome(ranks_, preconditioner_->build(*tangent_));
  built_ = built_now_ = outcome == LinearOutcome::solved;
  return outcome;
}

LinearOutcome IterativeSolver::look_at(const TangentOperator& tangent) {
  for (const double entry : tangent.diagonal) {
    if (!std::isfinite(entry)) return LinearOutcome::singular;
    largest_diagonal_ = std::max(largest_diagonal_, std::abs(entry));
  }
  const std::size_t d = std::size_t(tangent.dimension);
  for (const Index dof : free_->dof) {
    // The point has no stiffness. In an unsymmetric tangent other points may hold it.
    if (!tangent.as_unsymmetric() &&
        tangent.diagonal[std::size_t(dof) * d + std::size_t(dof) % d] == 0.0) {
      return LinearOutcome::singular;
    }
  }
  return LinearOutcome::solved;
}

LinearOutcome IterativeSolver::factorize(const TangentOperator& tangent, FactorUse use) {
  const Stopwatch watch(statistics_.seconds);
  tangent_ = &tangent;
  built_now_ = false;
  if (is_empty(std::size_t(free_->count()))) return LinearOutcome::solved;
  largest_diagonal_ = 0.0;
  const LinearOutcome outcome = worst_outcome(ranks_, look_at(tangent));
  if (outcome != LinearOutcome::solved) return outcome;
  largest_diagonal_ = ranks_.max(largest_diagonal_);
  if (use == FactorUse::may_reuse && built_ && !worn_) return LinearOutcome::solved;
  return build();
}

void IterativeSolver::multiply(std::span<const double> v, std::span<double> product,
                               Precision precision) {
  free_->extend_by_zero(v, full_, tangent_->threads());
  std::vector<double>& result = tangent_->multiplies_in_place() ? full_ : full_result_;
  result.resize(full_.size());
  if (precision == Precision::single) {
    tangent_->multiply_in_single(full_, result);
  } else {
    tangent_->multiply(full_, result);
  }
  free_->restrict_to_free(result, product, tangent_->threads());
}

LinearOutcome IterativeSolver::iterate(std::span<const double> b, std::span<double> x,
                                       double tolerance) {
  const std::size_t size = b.size();
  KrylovOptions options;
  options.method = method_;
  options.tolerance = tolerance;
  options.max_iterations = max_iterations_;
  options.restart = restart_;
  options.ranks = &ranks_;
  const auto products_in = [&](Precision precision) {
    return [this, size, precision](const double* v, double* product) {
      multiply({v, size}, {product, size}, precision);
    };
  };
  if (method_ == KrylovMethod::conjugate_gradients &&
      ranks_.max(double(tangent_->multiplies_in_single())) > 0.0) {
    options.rough_matrix = products_in(Precision::single);
  }
  const KrylovResult result = solve_krylov(
      int(size), products_in(Precision::full),
      [&](const double* v, double* product) {
        preconditioner_->apply({v, size}, {product, size});
      },
      b.data(), x.data(), options);
  last_iterations_ += result.iterations;
  statistics_.iterations += result.iterations;
  if (result.outcome == KrylovOutcome::converged) return LinearOutcome::solved;
  if (result.outcome == KrylovOutcome::negative_curvature) {
    return LinearOutcome::not_positive_definite;
  }
  const double attainable = round_off * largest_diagonal_ * norm_of_all(x);
  return result.relative_residual * norm_of_all(b) <= attainable ? LinearOutcome::solved
                                                                 : LinearOutcome::inaccurate;
}

LinearOutcome IterativeSolver::solve(std::span<const double> b, std::span<double> x,
                                     double tolerance) {
  const Stopwatch watch(statistics_.seconds);
  last_iterations_ = 0;
  if (is_empty(b.size())) return LinearOutcome::solved;
  if (!built_) return LinearOutcome::singular;
  LinearOutcome outcome = iterate(b, x, tolerance);
  if (outcome == LinearOutcome::inaccurate && !built_now_) {
    outcome = build();
    if (outcome == LinearOutcome::solved) outcome = iterate(b, x, tolerance);
  }
  if (outcome == LinearOutcome::solved && last_iterations_ > 0) {
    const double per_digit = last_iterations_ / std::max(0.5, -std::log10(tolerance));
    if (iterations_per_digit_ == 0.0) iterations_per_digit_ = per_digit;
    worn_ = per_digit > worn_out * iterations_per_digit_;
  }
  return outcome;
}

std::string IterativeSolver::describe() const {
  return fmt::format("{} preconditioned by {}", words_for(method_), preconditioner_->describe());
}

}  // namespace peristat
