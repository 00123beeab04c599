#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_fields.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "src/materials/lame_constants.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {

/// Which forces a linear solid has.
enum class SolidForces {
  energy,   ///< minus the derivative of its energy
  printed,  ///< those of [FCBM] (A-8), which have no potential where neighbourhoods differ
};

/// The linear peridynamic solid on a lattice in 2D and 3D, as convolutions ([FCBM] app. A): with q
/// in [0, 1] the integrity of a point, xi the step to a neighbour, r its length, n = xi / r, kappa
/// its share, eta the difference of displacements, d the dimension, and sums over neighbours,
///
///   M = sum q' kappa r^2 [m8],   theta = (d / M) sum q' kappa xi . eta,
///   w = q V ((lambda - mu) theta^2 / 2 + d (d + 2) mu / (2 M) sum q' kappa (n . eta)^2)     [J]
///
/// and with p = d (lambda - mu) theta / M, b = d (d + 2) mu / M, both 0 for points without
/// neighbours,
///
///   f = q V sum q' kappa ((p + p') xi + (b + b') n n . eta)                                 [N]
///
/// Form `printed` has p + p' = d (lambda - mu) (theta + theta') / M and b + b' = 2 b instead, with
/// M of the point itself for both ends. Where M varies its forces do not add up to zero and do work
/// around closed paths: it is for comparisons alone. Its energies are the same.
///
/// M counts neighbours beyond a pre-crack, too, as that of StateTerm does. On bodies without damage
/// this is StateTerm with moments of the existing neighbours. With damage it is not: StateTerm
/// keeps M of the whole neighbourhood, here M is updated with q as in [FCBM], so that theta of a
/// uniform dilation stays right and points that have lost neighbours are stiffer.
///
/// An integrity q between 0 and 1 is a factor of a point's whole energy and of all bonds to it.
class LinearSolid : public LatticeForces {
 public:
  struct Setting {
    LamePair constants;   ///< in plane stress those of the plane [Pa]
    double volume = 0.0;  ///< V of each point [m3]
    SolidForces form = SolidForces::energy;
    /// Points from this one on are images, whose energy belongs to their sources: they have neither
    /// b nor p. For form `energy`.
    std::size_t own = std::numeric_limits<std::size_t>::max();
  };

  /// @param box the points and their sites
  /// @param is_periodic axes with a period: points interact with their images
  /// @param arms one per opposite pair; a common factor of all shares does not matter
  /// @throws std::logic_error for a period that is not longer than the arms, or another dimension
  LinearSolid(const CutLattice& box, const std::array<bool, 3>& is_periodic,
              std::vector<LatticeArm> arms, const Setting& setting, int threads);

  /// Costs 11 real transforms in 2D and 18 in 3D.
  void set_integrity(std::span<const double> integrity) override;
  /// Costs 10 and 14, in form `printed` 6 and 8.
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  /// Costs 14 and 21, in form `printed` 12 and 18.
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  /// K does not depend on u. In form `printed` it is not symmetric.
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Blocks are exact, as long as periods are longer than two arms; row sums use the triangle
  /// inequality over the contributions of each dilatation and each bond.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  /// Virials of a point's own dilatation and deviatoric state; kernels are made in each call.
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;
  /// Memory in use [bytes].
  [[nodiscard]] double bytes() const;

  [[nodiscard]] const LatticeFields& fields() const { return fields_; }

 private:
  template <int D>
  void renew_sums();
  template <int D>
  void find_dilatations();
  template <int D>
  void find_pulls(bool alone);
  template <int D>
  void add_up(std::span<double> force) const;
  template <int D>
  void find_energies(std::span<double> energy);
  template <int D>
  void outline_blocks(std::span<double> diagonal);
  template <int D>
  void bound_rows(std::span<double> row_sums);
  template <int D>
  void add_virials(std::span<double> virials);
  void find_forces(std::span<const double> displacement, std::span<double> force, bool alone);
  [[nodiscard]] bool is_printed() const { return setting_.form == SolidForces::printed; }
  /// 1 / M' of a neighbour in the forces; 1 in form `printed`, which uses M of the point itself.
  [[nodiscard]] double inverse_moment_beside(std::size_t point) const {
    return is_printed() ? 1.0 : inverse_moment_[point];
  }

  std::vector<LatticeArm> arms_;
  Setting setting_;
  double dilatational_, deviatoric_;  // V d (lambda - mu), V d (d + 2) mu
  LatticeFields fields_;
  LatticeSpectrum moment_;               // kappa r^2
  std::vector<LatticeSpectrum> arm_;     // kappa xi, by component
  std::vector<LatticeSpectrum> square_;  // kappa n n, by pair
  double whole_moment_ = 0.0;
  // Per point, updated with q: 1/M, the sums of q' kappa xi, of q' kappa n n, and of
  // q' kappa n n / M'.
  std::vector<double> inverse_moment_, arms_left_, squares_left_, weighted_squares_;
  std::vector<double> displacement_;  // without its mean
  std::vector<double> dilatation_;    // theta
  // Sums of q' kappa n n . u', and all sums of q' theta' / M' and q' u' / M' in the forces.
  std::vector<double> pulls_, weighted_pulls_;
};

/// Memory that LinearSolid takes.
[[nodiscard]] double convolved_bytes(const LatticeBox& box, std::span<const LatticeArm> arms);

}  // namespace peristat
