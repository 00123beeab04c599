#pragma once

#include <array>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_fields.hpp"
#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/convolutions/lattice_springs.hpp"
#include "assembly/convolutions/lattice_turn.hpp"

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
/// are convolutions, times products of u. The harmonic bond's length l is none. Both are the same
/// at small strains; at a strain e the Green bond's force is 1 + 3 e / 2 times as large. Forces and
/// energies turn with the body, but are differences of numbers as large as s u^3 and s u^4. So sums
/// are those of u without its mean and without the mean rotation of the body (LatticeTurns), which
/// forces get back. Round-off is left of what bends or turns against the rest: of parts n spacings
/// wide with strains e relative errors of 2e-16 n^3 / e and 1e-16 n^4 / e^2, as measured.
///
/// The product with the tangent is exact: rates of fields make rates of sums.
class GreenBonds : public LatticeForces {
 public:
  /// @param box the points and their places
  /// @param is_periodic axes along which the lattice goes on as it began: points see their images
  /// @param springs of two opposite steps one
  /// @throws std::logic_error for a period that is not longer than the bonds
  GreenBonds(const CutLattice& box, const std::array<bool, 3>& is_periodic,
             std::span<const LatticeSpring> springs, int threads);

  /// 7 real transforms in 2D and 11 in 3D.
  void set_integrity(std::span<const double> integrity) override;
  /// 18 and 33.
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  /// Two more: what is quadratic in g needs nothing else that forces have not found.
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  /// As many as for forces, if those at u were the last ones that were found; twice otherwise.
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Blocks are exact, at the cost of energies; sums are up to half as much again as they must be.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  /// By the kernels times each component of xi, which are made and dropped again.
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;
  /// Memory that one holds that has multiplied and told energies.
  [[nodiscard]] static double expected_bytes(const LatticeBox& box,
                                             std::span<const LatticeSpring> springs);
  /// Memory that it holds.
  [[nodiscard]] double bytes() const;

  [[nodiscard]] const LatticeFields& fields() const { return fields_; }

 private:
  void take_up(std::span<const double> displacement);
  /// @param turn that is taken off u, with its mean
  void take_off_motion(std::span<const double> displacement, LatticeTurn& turn,
                       std::vector<double>& u) const;
  /// What sums are made with.
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
  std::vector<double> constants_;     // sums of q' times these three, per point
  std::vector<double> state_;         // u that sums_ belong to; empty: none
  std::vector<double> displacement_;  // the same without its mean and turn_
  std::vector<double> direction_;     // of the rates, likewise
  std::vector<double> sums_, rates_;  // those that depend on u' per point, see Sums
};

}  // namespace peristat
