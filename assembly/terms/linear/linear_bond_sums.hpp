#pragma once

#include <functional>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/energy/tangent_forms.hpp"
#include "assembly/terms/bonds/bond_workspace.hpp"

namespace peristat {

/// Bonds linearised at rest, summed one by one on any points; LinearBonds sums them by
/// convolutions. With the stiffness k = c w / L of a bond, n its direction in the reference and q
/// the integrities of points,
///
///   f_i = q_i sum_j q_j k_ij n (n . (u_j - u_i))                                   [N]
///   w_i = q_i sum_j q_j k_ij (n . (u_j - u_i))^2 / 4                               [J]
class LinearBondSums : public LatticeForces {
 public:
  /// Points, bonds and the workspace outlive it.
  /// @param micromodulus c [N/m6]
  LinearBondSums(const Points& points, const Bonds& bonds, double micromodulus, Workspace& shared);

  void set_integrity(std::span<const double> integrity) override;
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  void find_energies(std::span<const double> displacement, std::span<double> energy);
  /// v and product may be one array.
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;

  /// Visits the rows of the tangent, see RowVisits::visit_tangent.
  void visit_tangent(const RowVisitor& visit, std::span<double> diagonal);

 private:
  template <int D>
  struct Kernels;
  template <class Body>
  void in_dimension(const Body& body);

  double micromodulus_;
  BondWorkspace workspace_;
  std::vector<double> integrity_;
};

}  // namespace peristat
