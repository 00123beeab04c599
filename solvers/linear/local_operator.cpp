#include "solvers/linear/local_operator.hpp"

#include <algorithm>
#include <new>
#include <stdexcept>

#include "solvers/linear/free_rows.hpp"

namespace peristat {

void LocalOperator::analyze(const BlockPattern& /*pattern*/, const FreeDofs& free) {
  free_ = &free;
  factor_.reset();
}

LinearOutcome LocalOperator::build(const TangentOperator& tangent) {
  const UnsymmetricTangent* const unsymmetric = tangent.as_unsymmetric();
  if (!unsymmetric) throw std::logic_error("LocalOperator is for unsymmetric tangents");
  try {
    const LinearOutcome outcome = factor_.factorize(free_rows(unsymmetric->local_rows(), *free_));
    return outcome == LinearOutcome::singular ? LinearOutcome::inaccurate : outcome;
  } catch (const std::bad_alloc&) {
    factor_.reset();
    return LinearOutcome::out_of_memory;
  }
}

void LocalOperator::apply(std::span<const double> residual, std::span<double> correction) {
  std::copy(residual.begin(), residual.end(), correction.begin());
  factor_.solve(correction);
}

}  // namespace peristat
