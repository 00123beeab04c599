#include "solvers/linear/free_dofs.hpp"

#include <algorithm>

namespace peristat {

FreeDofs::FreeDofs(const std::vector<char>& prescribed, int dimension_of_points)
    : dimension(dimension_of_points), equation(prescribed.size(), none) {
  dof.reserve(std::size_t(std::count(prescribed.begin(), prescribed.end(), 0)));
  for (std::size_t k = 0; k < prescribed.size(); ++k) {
    if (prescribed[k]) continue;
    equation[k] = static_cast<Index>(dof.size());
    dof.push_back(static_cast<Index>(k));
  }
}

void FreeDofs::restrict_to_free(std::span<const double> full, std::span<double> free,
                                int threads) const {
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::size_t e = 0; e < dof.size(); ++e) free[e] = full[dof[e]];
}

void FreeDofs::extend_by_zero(std::span<const double> free, std::span<double> full,
                              int threads) const {
#pragma omp parallel for num_threads(threads) schedule(static)
  for (std::size_t k = 0; k < full.size(); ++k) {
    full[k] = equation[k] == none ? 0.0 : free[std::size_t(equation[k])];
  }
}

}  // namespace peristat
