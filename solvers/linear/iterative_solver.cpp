#include "solvers/linear/iterative_solver.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "solvers/vector_verbs.hpp"
#include "src/stopwatch.hpp"

namespace peristat {
namespace {

constexpr double worn_out = 1.5;

/// Runs of refinement; each gains at least a digit, or the tolerance is beyond round-off.
constexpr int most_runs = 4;

/// What the true residual may exceed the tolerance by.
constexpr double slack = 1.1;

/// Round-off of b - K x, in units of epsilon times the largest diagonal entry of K times ||x||. A
/// slender body's displacements are so large that no solver's residual goes below.
constexpr double round_off = 20.0 * std::numeric_limits<double>::epsilon();

}  // namespace

IterativeSolver::IterativeSolver(std::unique_ptr<Preconditioner> preconditioner, int max_iterations)
    : preconditioner_(std::move(preconditioner)), max_iterations_(max_iterations) {}

LinearOutcome IterativeSolver::analyze(const Pattern& pattern, const FreeDofs& free) {
  const Stopwatch watch(statistics_.seconds);
  free_ = &free;
  full_in_.resize(free.equation.size());
  full_out_.resize(free.equation.size());
  residual_.resize(std::size_t(free.count()));
  refinement_.resize(std::size_t(free.count()));
  built_ = false;
  preconditioner_->analyze(pattern, free);
  return LinearOutcome::solved;
}

LinearOutcome IterativeSolver::build() {
  built_ = built_now_ = false;
  worn_ = false;
  iterations_per_digit_ = 0.0;
  ++statistics_.factorisations;
  const LinearOutcome outcome = preconditioner_->build(*tangent_);
  built_ = built_now_ = outcome == LinearOutcome::solved;
  return outcome;
}

LinearOutcome IterativeSolver::factorize(const TangentOperator& tangent, FactorUse use) {
  const Stopwatch watch(statistics_.seconds);
  tangent_ = &tangent;
  built_now_ = false;
  if (free_->count() == 0) return LinearOutcome::solved;
  largest_diagonal_ = 0.0;
  for (const double entry : tangent.diagonal) {
    if (!std::isfinite(entry)) return LinearOutcome::singular;
    largest_diagonal_ = std::max(largest_diagonal_, std::abs(entry));
  }
  if (use == FactorUse::may_reuse && built_ && !worn_) return LinearOutcome::solved;
  return build();
}

void IterativeSolver::multiply(std::span<const double> v, std::span<double> product) {
  free_->extend_by_zero(v, full_in_);
  tangent_->multiply(full_in_, full_out_);
  free_->restrict_to_free(full_out_, product);
}

LinearOutcome IterativeSolver::iterate(std::span<const double> b, std::span<double> x,
                                       double tolerance) {
  const double target = slack * tolerance * norm(b);
  const int before = last_iterations_;
  std::fill(x.begin(), x.end(), 0.0);
  std::copy(b.begin(), b.end(), residual_.begin());
  double reached = norm(b);
  for (int run = 0; run < most_runs && reached > target; ++run) {
    const GradientsResult result = gradients_.solve(
        [&](std::span<const double> v, std::span<double> product) { multiply(v, product); },
        [&](std::span<const double> v, std::span<double> product) {
          preconditioner_->apply(v, product);
        },
        residual_, refinement_, std::min(0.5, tolerance * norm(b) / reached),
        max_iterations_ - (last_iterations_ - before));
    last_iterations_ += result.iterations;
    statistics_.iterations += result.iterations;
    if (result.outcome == GradientsOutcome::negative_curvature) {
      return LinearOutcome::not_positive_definite;
    }
    if (result.outcome == GradientsOutcome::not_finite) return LinearOutcome::singular;
    add_scaled(x, 1.0, refinement_);
    multiply(x, residual_);
    for (std::size_t e = 0; e < b.size(); ++e) residual_[e] = b[e] - residual_[e];
    const double now = norm(residual_);
    const bool stalls = !(now < 0.1 * reached);
    reached = now;
    if (result.outcome == GradientsOutcome::iteration_limit || stalls) break;
  }
  const double attainable = round_off * largest_diagonal_ * norm(x);
  return reached <= std::max(target, attainable) ? LinearOutcome::solved
                                                 : LinearOutcome::inaccurate;
}

LinearOutcome IterativeSolver::solve(std::span<const double> b, std::span<double> x,
                                     double tolerance) {
  const Stopwatch watch(statistics_.seconds);
  last_iterations_ = 0;
  if (b.empty()) return LinearOutcome::solved;
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
  return fmt::format("conjugate gradients preconditioned by {}", preconditioner_->describe());
}

}  // namespace peristat
