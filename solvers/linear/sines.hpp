#pragma once

#include <memory>

#include "solvers/linear/preconditioner.hpp"
#include "src/geometry/lattice_box.hpp"

namespace peristat {

/// Inverse of the lattice's own operator on the box around the free points, by sines and cosines,
///
///   M^-1 = R^T  T^-1 S^-1 T  R   for each component of the displacement,
///
/// R puts the equations of a component into the box around them, with zeros at sites without one, T
/// is the transform by cosines along axes whose ends are free and by sines along those that
/// supports hold (TrigonometricTransform), and
///
///   S(k) = s - (1/N) sum_i sum_j K_ij (1 - prod_a cos k_a xi_a),   xi = x_j - x_i,
///
/// is the symbol of the mean stencil of the tangent's diagonal components over the N points, s the
/// mean stiffness against a translation, from foundations and the inertia of a time step. Holes,
/// notches and cracks are filled, and the coupling of the components is neglected. The condition
/// number depends on neither size nor horizon in compact bodies; in slender ones, whose bending
/// couples the components, it grows with the square of their length (Korn's inequality): see
/// RigidPieces.
class Sines : public Preconditioner {
 public:
  /// @param box lattice box of the points; its axes are those of the displacements
  explicit Sines(std::shared_ptr<const LatticeBox> box);
  ~Sines() override;

  /// @throws std::logic_error if there are degrees of freedom other than those of the points
  void analyze(const BlockPattern& pattern, const FreeDofs& free) override;
  /// @return inaccurate where the mean stencil has no stiffness
  [[nodiscard]] LinearOutcome build(const TangentOperator& tangent) override;
  void apply(std::span<const double> residual, std::span<double> correction) override;
  [[nodiscard]] std::string describe() const override;

 private:
  struct Symbols;
  std::unique_ptr<Symbols> symbols_;
};

}  // namespace peristat
