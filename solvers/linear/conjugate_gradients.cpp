#include "solvers/linear/conjugate_gradients.hpp"

#include <algorithm>
#include <cmath>

#include "solvers/vector_verbs.hpp"

namespace peristat {

GradientsResult ConjugateGradients::solve(const LinearMap& matrix, const LinearMap& preconditioner,
                                          std::span<const double> b, std::span<double> x,
                                          double tolerance, int max_iterations) {
  residual_.assign(b.begin(), b.end());
  preconditioned_.resize(b.size());
  image_.resize(b.size());
  std::fill(x.begin(), x.end(), 0.0);
  const double target = tolerance * norm(b);
  if (norm(b) == 0.0) return {};

  preconditioner(residual_, preconditioned_);
  direction_ = preconditioned_;
  double weight = dot(residual_, preconditioned_);
  for (int iteration = 1; iteration <= max_iterations; ++iteration) {
    matrix(direction_, image_);
    const double curvature = dot(direction_, image_);
    if (!std::isfinite(curvature)) return {GradientsOutcome::not_finite, iteration};
    if (curvature <= 0.0) return {GradientsOutcome::negative_curvature, iteration};
    const double step = weight / curvature;
    add_scaled(x, step, direction_);
    add_scaled(residual_, -step, image_);
    if (norm(residual_) <= target) return {GradientsOutcome::converged, iteration};
    preconditioner(residual_, preconditioned_);
    const double next_weight = dot(residual_, preconditioned_);
    const double ratio = next_weight / weight;
    for (std::size_t k = 0; k < direction_.size(); ++k) {
      direction_[k] = preconditioned_[k] + ratio * direction_[k];
    }
    weight = next_weight;
  }
  return {GradientsOutcome::iteration_limit, max_iterations};
}

}  // namespace peristat
