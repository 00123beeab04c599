#include "solvers/linear/no_solver.hpp"

#include <stdexcept>

namespace peristat {

LinearOutcome NoSolver::factorize(const TangentOperator&, FactorUse) {
  throw std::logic_error("there is no linear solver to factorise with");
}

LinearOutcome NoSolver::solve(std::span<const double>, std::span<double>, double) {
  throw std::logic_error("there is no linear solver to solve with");
}

}  // namespace peristat
