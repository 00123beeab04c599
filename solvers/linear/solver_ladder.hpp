#pragma once

#include <algorithm>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "solvers/linear/linear_solver.hpp"

namespace peristat {

/// Chain of solvers in the order in which they are tried. A solver that fails for a reason of its
/// own (too many iterations, a preconditioner that cannot be built, memory) is replaced by the next
/// one for good, and the system is solved again. Findings about the tangent (negative curvature)
/// are passed on to the caller.
class SolverLadder : public LinearSolver {
 public:
  struct Rung {
    std::string name;
    std::function<std::unique_ptr<LinearSolver>()> make;
  };
  /// Receives the reason of every change to the next solver, as text.
  using Reporter = std::function<void(const std::string& reason)>;

  SolverLadder(std::vector<Rung> rungs, Reporter tell);

  LinearOutcome analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  void count_pivots(bool counts) override;
  LinearOutcome factorize(const TangentOperator& tangent, FactorUse use) override;
  LinearOutcome solve(std::span<const double> b, std::span<double> x, double tolerance) override;
  [[nodiscard]] std::optional<Inertia> inertia() const override;
  [[nodiscard]] LinearStatistics statistics() const override;
  [[nodiscard]] int last_iterations() const override;
  [[nodiscard]] std::string describe() const override;
  [[nodiscard]] int rung() const override { return int(rung_); }
  void start_at(int rung) override { rung_ = std::min(std::size_t(rung), rungs_.size() - 1); }

 private:
  /// Moves to the next rung that can be analysed.
  LinearOutcome climb_down(LinearOutcome why);
  LinearOutcome stand_on(std::size_t rung);

  std::vector<Rung> rungs_;
  Reporter report_;
  std::size_t rung_ = 0;
  std::unique_ptr<LinearSolver> solver_;
  std::optional<BlockPattern> pattern_;
  const FreeDofs* free_ = nullptr;
  const TangentOperator* tangent_ = nullptr;
  int version_ = 0;          // of the pattern
  LinearStatistics before_;  // of the earlier rungs
  bool counts_pivots_ = true;
};

}  // namespace peristat
