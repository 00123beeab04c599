#pragma once

#include <functional>
#include <span>
#include <vector>

namespace peristat {

/// How a run of conjugate gradients ended.
enum class GradientsOutcome { converged, iteration_limit, negative_curvature, not_finite };

struct GradientsResult {
  GradientsOutcome outcome = GradientsOutcome::converged;
  int iterations = 0;
};

/// result = A v
using LinearMap = std::function<void(std::span<const double> v, std::span<double> result)>;

/// Preconditioned conjugate gradients for A x = b from x = 0, until ||b - A x|| <= tolerance ||b||
/// (2-norm of the recursive residual). A direction p with p.A p <= 0 ends the run as
/// negative_curvature: A is not positive definite.
class ConjugateGradients {
 public:
  [[nodiscard]] GradientsResult solve(const LinearMap& matrix, const LinearMap& preconditioner,
                                      std::span<const double> b, std::span<double> x,
                                      double tolerance, int max_iterations);

 private:
  std::vector<double> residual_, preconditioned_, direction_, image_;
};

}  // namespace peristat
