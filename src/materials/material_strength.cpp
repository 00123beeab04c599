#include "src/materials/material_strength.hpp"

namespace peristat {

std::array<double, 3> MaterialStrength::stresses(const std::array<double, 3>& strains) const {
  std::array<double, 3> found{};
  double trace = 0.0;
  for (int k = 0; k < dimension; ++k) trace += strains[std::size_t(k)];
  for (int k = 0; k < dimension; ++k) {
    found[std::size_t(k)] = elastic.lambda * trace + 2.0 * elastic.mu * strains[std::size_t(k)];
  }
  if (dimension == 2) found[2] = across * (found[0] + found[1]);
  return found;
}

}  // namespace peristat
