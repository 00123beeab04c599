#pragma once

#include <array>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_fields.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "assembly/convolutions/lattice_turn.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {

/// Bonds of the Green stretch e = (l^2 - r^2) / (2 r^2) at any deformation, on a lattice, as
/// convolutions (in the way of [FCBM] app. A; the law is ours): with xi the step to a neighbour, r
/// its length and l that of the deformed bond, eta = u' - u, q in [0, 1] the integrity of a point
/// and k the stiffness at rest,
///
///   g = xi . eta + eta^2 / 2 = r^2 e,   s = k / r^2,
///   w = q sum q' s g^2 / 4  [J],   f = q sum q' s g (xi + eta)  [N].
///
/// A law of l^2 alone is a polynomial of u, cubic in the force: products of u' and kernels, which
/// are convolutions, times products of u. The harmonic law in l is no polynomial. Both laws agree
/// at small strains; at a strain e the Green bond's force is 1 + 3 e / 2 times as large. Forces and
/// energies are frame-indifferent, but differences of numbers as large as s u^3 and s u^4. So sums
/// are those of u without its mean and without the mean rotation of the body (LatticeTurns), which
/// is then applied to the forces. Round-off remains where parts bend or rotate against the rest:
/// parts n spacings wide with strains e have relative errors of 2e-16 n^3 / e and 1e-16 n^4 / e^2,
/// as measured.
///
/// The product with the tangent is exact: it is found from rates of fields and sums.
class GreenBonds : public LatticeForces {
 public:
  /// @param box the points and their sites
  /// @param is_periodic axes with a period: points interact with their images
  /// @param springs one per opposite pair
  /// @throws std::logic_error for a period that is not longer than the bonds
  GreenBonds(const CutLattice& box, const std::array<bool, 3>& is_periodic,
             std::span<const LatticeSpring> springs, int threads);

  /// Costs 7 real transforms in 2D and 11 in 3D.
  void set_integrity(std::span<const double> integrity) override;
  /// Costs 18 and 33.
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  /// Costs two more than forces: the rest of what is quadratic in g is known from these.
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  /// Costs as much as forces if the last forces were found at u; twice as much otherwise.
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Blocks are exact, at the cost of energies; row sums are up to 1.5 times too large.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  /// Uses the kernels times each component of xi, which are made in each call.
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;
  /// Expected memory after products and energies have been found [bytes].
  [[nodiscard]] static double expected_bytes(const LatticeBox& box,
                                             std::span<const LatticeSpring> springs);
  /// Memory in use [bytes].
  [[nodiscard]] double bytes() const;

  [[nodiscard]] const LatticeFields& fields() const { return fields_; }

 private:
  void take_up(std::span<const double> displacement);
  /// @param turn rotation that is taken off u, together with its mean
  void take_off_motion(std::span<const double> displacement, LatticeTurn& turn,
                       std::vector<double>& u) const;
  /// Kernels of the sums.
  struct Kernels {
    std::vector<LatticeSpectrum> square;  // s xi xi = k n n, by pair
    std::vector<LatticeSpectrum> arm;     // s xi, by component
    LatticeSpectrum size;                 // s
  };

  template <class Factor>
  [[nodiscard]] Kernels make_kernels(bool is_odd, const Factor& factor) const;
  template <int D>
  void find_constants(const Kernels& kernels, std::vector<double>& constants);
  template <int D, class Get>
  void find_sums(const Kernels& kernels, const Get& get, std::vector<double>& sums);
  template <int D>
  void add_up(std::span<double> force) const;
  template <int D>
  void find_energies(std::span<double> energy);
  template <int D>
  void find_rates(std::span<double> product);
  template <int D>
  void outline(std::span<double> diagonal, std::span<double> row_sums);
  template <int D>
  void add_virials(const std::vector<double>& u, const LatticeTurn& turn,
                   std::span<double> virials);

  std::vector<LatticeSpring> springs_;
  LatticeFields fields_;
  LatticeTurns turns_;
  LatticeTurn turn_;  // of displacement_
  Kernels kernels_;
  double whole_size_ = 0.0;
  std::vector<double> constants_;     // sums of q' times these kernels, per point
  std::vector<double> state_;         // u that sums_ belong to; empty: none
  std::vector<double> displacement_;  // the same without its mean and turn_
  std::vector<double> direction_;     // v, likewise
  std::vector<double> sums_, rates_;  // those that depend on u' per point, see Sums
};

}  // namespace peristat
