#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_fields.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/materials/lame_constants.hpp"

namespace peristat {

/// Least eigenvalue of a shape tensor, relative to that of a whole neighbourhood, from which a
/// deformation gradient is computed.
inline constexpr double least_shape = 1e-3;

/// A correspondence material of St. Venant and Kirchhoff at any deformation, in 2D and 3D, on a
/// lattice, as convolutions ([FCBM] ... ): with q in [0, 1] the integrity of a point,
/// xi the step to a neighbour, kappa its share, eta the difference of displacements and sums over
/// neighbours,
///
///   K = sum q' kappa xi xi [m8],   F = 1 + H,   H = (sum q' kappa eta xi) K^-1,
///   E = (F^T F - 1) / 2,   S = lambda tr(E) 1 + 2 mu E,   z = eta - H xi,
///   w = q (V S : E / 2 + beta / 2 sum q' kappa z^2)                                         [J]
///   f = q sum q' (kappa (R + R') xi + 2 beta kappa eta),   R = V F S K^-1 - beta H          [N]
///
/// The stabilising energy of z, the part of eta that H does not represent, keeps points of a
/// lattice from moving against each other at no cost. beta is constant: with one that varies inside
/// the force, as it is printed, forces have no potential.
///
/// K is updated with q. Where its least eigenvalue is not more than `least_shape` of a whole
/// neighbourhood's mean one there is no H: the point has only the stabilising energy with z = eta,
/// which also resists rotations. So a point that loses its neighbours loses its stress in one step.
///
/// The product with the tangent is exact: F S is a polynomial of H, and all else is linear.
class Correspondence : public LatticeForces {
 public:
  struct Setting {
    LamePair constants;          ///< in plane stress those of the plane [Pa]
    double volume = 0.0;         ///< V of each point [m3]
    double stabilisation = 0.0;  ///< beta [N/m7] for shares kappa in m6
    /// Points from this one on are images, whose energy belongs to their sources: they have no H
    /// and no z.
    std::size_t own = std::numeric_limits<std::size_t>::max();
  };

  /// @param box the points and their sites
  /// @param is_periodic axes with a period: points interact with their images
  /// @param arms one per opposite pair
  /// @throws std::logic_error for a period that is not longer than the arms, or another dimension
  Correspondence(const CutLattice& box, const std::array<bool, 3>& is_periodic,
                 std::vector<LatticeArm> arms, const Setting& setting, int threads);

  /// Costs 7 real transforms in 2D and 11 in 3D.
  void set_integrity(std::span<const double> integrity) override;
  /// Costs 12 and 24.
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  /// Costs 4 and 5 more than forces.
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  /// Costs as much as forces if the last forces were found at u; 6 and 12 more otherwise.
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Blocks are those at rest, exact as long as periods are longer than two arms, at the cost of 20
  /// and 53 transforms. Row sums use the triangle inequality over the contributions of each
  /// gradient, and are up to twenty times too large.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  /// V F S, and at points without H the virial of the stabilisation.
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;
  /// Number of points without a gradient: their neighbours, if any, don't determine one.
  [[nodiscard]] std::size_t points_without_gradient() const;
  /// Expected memory after products and energies have been found [bytes].
  [[nodiscard]] static double expected_bytes(const LatticeBox& box,
                                             std::span<const LatticeSpring> springs);
  /// Memory in use [bytes].
  [[nodiscard]] double bytes() const;

  [[nodiscard]] const LatticeFields& fields() const { return fields_; }

 private:
  [[nodiscard]] bool has_images() const { return setting_.own < fields_.points(); }
  /// 1 at points with an energy of their own, 0 at images.
  [[nodiscard]] double share(std::size_t point) const { return point < setting_.own ? 1.0 : 0.0; }
  void take_up(std::span<const double> displacement);
  template <int D>
  void renew_shapes();
  template <int D>
  void find_moments(const std::vector<double>& u, std::vector<double>& moments);
  template <int D>
  void find_gradients(const std::vector<double>& u, std::vector<double>& gradients);
  template <int D>
  void find_stresses();
  template <int D>
  void find_stress_rates();
  /// Sum of q' kappa over the bonds, once for each end that has an energy.
  [[nodiscard]] double sizes_of_ends(std::size_t point) const {
    return shared_sizes_.empty() ? 2.0 * sizes_[point] : shared_sizes_[point];
  }
  template <int D>
  void find_pulls(const std::vector<double>& u, double sign, std::span<double> force);
  template <int D>
  void find_energies(std::span<double> energy);
  template <int D>
  void outline_blocks(std::span<double> diagonal);
  template <int D>
  void add_neighbours_blocks(std::span<double> diagonal);
  template <int D>
  void bound_rows(std::span<double> row_sums);
  template <int D>
  void add_virials(const std::vector<double>& u, std::span<double> virials);

  std::vector<LatticeArm> arms_;
  Setting setting_;
  LatticeFields fields_;
  LatticeSpectrum size_;                // kappa
  std::vector<LatticeSpectrum> arm_;    // kappa xi, by component
  std::vector<LatticeSpectrum> shape_;  // kappa xi xi, by pair
  double whole_size_ = 0.0, whole_shape_ = 0.0;
  // Sums of q' times these kernels, per point, and K^-1, 0 where there is none; matrices row by
  // row.
  std::vector<double> sizes_, arms_left_, shapes_, inverse_shapes_;
  // Sums of q' kappa, once for each end of a bond that has an energy; empty: both have.
  std::vector<double> shared_sizes_;
  std::vector<double> state_;                       // u that gradients_ belong to; empty: none
  std::vector<double> displacement_;                // the same without its mean
  std::vector<double> direction_;                   // v without its mean
  std::vector<double> gradients_, gradient_rates_;  // H
  std::vector<double> stresses_;                    // R, or its rate
};

}  // namespace peristat
