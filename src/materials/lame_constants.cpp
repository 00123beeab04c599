#include "src/materials/lame_constants.hpp"

#include <numbers>

namespace peristat {

LamePair lame_constants(double youngs_modulus, double poisson_ratio, int dimension,
                        PlaneState plane) {
  const double E = youngs_modulus, nu = poisson_ratio;
  const bool is_plane_stress = dimension == 2 && plane == PlaneState::stress;
  return {is_plane_stress ? E * nu / (1.0 - nu * nu) : E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)),
          0.5 * E / (1.0 + nu)};
}

double crack_energy_of_dilation(const LamePair& constants, double horizon, int dimension) {
  const auto [lambda, mu] = constants;
  return dimension == 2 ? 3.0 * horizon * (lambda + mu) / std::numbers::pi
                        : horizon * (9.0 * lambda + 6.0 * mu) / 5.0;
}

double crack_energy_of_dilation(const LamePair& constants, const Kernel& of_bonds) {
  const double d = of_bonds.dimension;
  return 0.5 * d * (d * constants.lambda + 2.0 * constants.mu) *
         mean_of_magnitude(of_bonds.dimension) * of_bonds.moment(2) / of_bonds.moment(1);
}

}  // namespace peristat
