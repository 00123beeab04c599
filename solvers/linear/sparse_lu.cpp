#include "solvers/linear/sparse_lu.hpp"

#include <new>
#include <stdexcept>

#include "solvers/linear/free_rows.hpp"
#include "solvers/linear/refinement.hpp"
#include "src/core/stopwatch.hpp"

namespace peristat {

SparseLu::SparseLu(double most_bytes) : most_bytes_(most_bytes), factor_(most_bytes) {}

LinearOutcome SparseLu::analyze(const BlockPattern& /*pattern*/, const FreeDofs& free) {
  free_ = &free;
  tangent_ = nullptr;
  factor_.reset();
  return LinearOutcome::solved;
}

LinearOutcome SparseLu::factorize(const TangentOperator& tangent, FactorUse /*use*/) {
  const Stopwatch watch(statistics_.seconds);
  const UnsymmetricTangent* const unsymmetric = tangent.as_unsymmetric();
  if (!unsymmetric) throw std::logic_error("SparseLu is for unsymmetric tangents");
  tangent_ = &tangent;
  if (free_->count() == 0) return LinearOutcome::solved;
  if (unsymmetric->bytes_of_rows() > most_bytes_) {
    factor_.reset();
    return LinearOutcome::out_of_memory;
  }
  try {
    const int before = factor_.factorisations();
    const LinearOutcome outcome = factor_.factorize(free_rows(unsymmetric->rows(), *free_));
    statistics_.factorisations += factor_.factorisations() - before;
    return outcome;
  } catch (const std::bad_alloc&) {
    factor_.reset();
    return LinearOutcome::out_of_memory;
  }
}

LinearOutcome SparseLu::solve(std::span<const double> b, std::span<double> x,
                              double /*tolerance*/) {
  const Stopwatch watch(statistics_.seconds);
  if (b.empty()) return LinearOutcome::solved;
  if (!factor_.is_ready()) return LinearOutcome::singular;
  const FactorSolve by_factor{[&](std::span<double> v) { factor_.solve(v); },
                              [&] { return factor_.largest_row_sum(); }};
  return solve_refined(*tangent_, *free_, by_factor, b, x);
}

std::string SparseLu::describe() const {
  return "UMFPACK L U with pivoting, " + factor_.describe();
}

}  // namespace peristat
