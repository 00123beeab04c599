#pragma once

#include <limits>
#include <memory>

#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Size and cost of the factor, known after the symbolic factorisation.
struct FactorEstimate {
  double entries = 0.0;  ///< of the factor
  double flops = 0.0;    ///< of one factorisation
  std::string ordering;  ///< "natural", "AMD", "METIS"
  [[nodiscard]] double bytes() const { return 8.0 * entries; }
};

/// Limits on the reuse of a factorisation as preconditioner for later tangents.
struct FactorReuse {
  /// Largest number of conjugate-gradient iterations per solve; 0 factorises every tangent. The
  /// actual limit is lower where so many iterations would cost more than half a factorisation.
  int max_iterations = 12;
  double tolerance = 1e-12;  ///< relative residual of these solves, even where the caller accepts
                             ///< more
};

/// Direct solver: CHOLMOD's supernodal LL^T with 64-bit indices, analysed once per pattern.
///
/// The fill-reducing order is found on the graph of points, d times smaller than that of the
/// degrees of freedom, as the cheapest of natural (points are numbered along the body), AMD and
/// METIS.
///
/// Where reuse is allowed, a new tangent is solved by conjugate gradients preconditioned with the
/// last factor; only when that takes too many iterations, or meets negative curvature, is the new
/// tangent factorised. Solutions still belong to the new tangent, so Newton stays quadratic.
///
/// A tangent that is not positive definite is factorised a second time as LDL^T for its inertia,
/// where that costs no more than `largest_inertia_flops`.
class Cholesky : public LinearSolver {
 public:
  /// @param largest_factor [bytes]; analyze returns out_of_memory for a larger one, before it is
  ///        allocated
  explicit Cholesky(FactorReuse reuse = {},
                    double largest_factor = std::numeric_limits<double>::infinity());
  ~Cholesky() override;

  LinearOutcome analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  void count_pivots(bool counts) override;
  /// @throws std::logic_error for a tangent without stored blocks
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override;
  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override;
  [[nodiscard]] LinearStatistics statistics() const override;
  [[nodiscard]] int last_iterations() const override;
  [[nodiscard]] std::string describe() const override;

  [[nodiscard]] const FactorEstimate& estimate() const;

  /// Version of CHOLMOD.
  [[nodiscard]] static std::string library_version();

  /// The simplicial LDL^T, some twenty times slower than LL^T, is not tried above this cost.
  static constexpr double largest_inertia_flops = 2e10;

 private:
  struct Cholmod;
  std::unique_ptr<Cholmod> cholmod_;
};

}  // namespace peristat
