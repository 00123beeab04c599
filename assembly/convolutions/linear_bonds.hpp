#pragma once

#include <array>
#include <span>
#include <vector>

#include "assembly/convolutions/cut_lattice.hpp"
#include "assembly/convolutions/lattice_fields.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"

namespace peristat {

/// Bonds linearised at rest, on a lattice, as convolutions ([FCBM] app. A): with q in [0, 1] the
/// integrity of a point, a factor of all its bonds, and C = k n n of each step,
///
///   v_i = [C_ij * q u_j],   P_ij = [C_ij * q],
///   f_i = q (v_i - P_ij u_j)                                                    [N]
///   w   = q ([C_ij * q u_i u_j] - 2 u_i v_i + P_ij u_i u_j) / 4                 [J]
///
/// (sums over repeated j; w is half of each bond's energy k (n.(u' - u))^2 / 2, and -f the
/// derivative of the total energy). Sites without a point have q = 0. No bond is stored: four real
/// transforms in 2D and six in 3D give the forces, four and seven more the energies, whatever the
/// horizon. The mean of u is subtracted first: a free translation would cost digits of w.
class LinearBonds : public LatticeForces {
 public:
  /// @param box the points and their sites
  /// @param is_periodic axes with a period: points interact with their images
  /// @param springs one per opposite pair
  /// @throws std::logic_error for a period that is not longer than the bonds
  LinearBonds(const CutLattice& box, const std::array<bool, 3>& is_periodic,
              std::span<const LatticeSpring> springs, int threads);

  void set_integrity(std::span<const double> integrity) override;
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  /// K is symmetric and the same in all states.
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Beside the diagonal block the absolute entries of the row of component a sum to no more than
  /// q (tr P + d P_aa) / 2, since |n_a n_b| <= (n_a^2 + n_b^2) / 2.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  /// Uses the numbers of pairs, a convolution of q with itself.
  [[nodiscard]] LatticeStencil stencil() override;
  /// Uses kernels k n_a n_b xi_c / 2, which are made in each call.
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;

  [[nodiscard]] const FourierTransform& transform() const { return fields_.transform(); }
  [[nodiscard]] const LatticeFields& fields() const { return fields_; }

 private:
  template <int D>
  void find_forces(std::span<const double> displacement, double sign, std::span<double> force);
  template <int D>
  void find_energies(std::span<const double> displacement, std::span<const double> force,
                     std::span<double> energy);

  std::vector<LatticeSpring> springs_;
  LatticeFields fields_;
  std::vector<LatticeSpectrum> square_;  // C, by pair
  std::vector<double> sums_;             // P, points x pairs
};

/// Minus the sums of the diagonal components of the springs' blocks over all pairs of points.
[[nodiscard]] LatticeStencil lattice_stencil(const LatticeBox& box,
                                             std::span<const LatticeSpring> springs,
                                             std::span<const double> integrity, int threads);

/// Memory that LinearBonds take.
[[nodiscard]] double convolved_bytes(const LatticeBox& box, std::span<const LatticeSpring> springs);

/// sum_j g(x_j - x_i) b_j per point of a lattice, for each of some even kernels g, whose values are
/// given per spring.
[[nodiscard]] std::vector<std::vector<double>> lattice_sums(
    const CutLattice& box, std::span<const LatticeSpring> springs,
    std::span<const std::vector<double>> kernels, std::span<const double> field, int threads);

}  // namespace peristat
