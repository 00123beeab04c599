#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_forces.hpp"
#include "assembly/terms/linear/linear_bond_sums.hpp"
#include "assembly/terms/workspace.hpp"

namespace peristat {

/// Forces of a lattice without those of some of its bonds, which are summed one by one and taken
/// off: the lattice itself goes on through a crack.
class CutForces : public LatticeForces {
 public:
  /// Points and bonds outlive it.
  /// @param whole forces of all bonds
  /// @param cut the bonds that are not there
  CutForces(std::unique_ptr<LatticeForces> whole, const Points& points, const Bonds& cut,
            double micromodulus, int threads);

  void set_integrity(std::span<const double> integrity) override;
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Row sums are those of the whole lattice.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  /// That of the whole lattice.
  [[nodiscard]] LatticeStencil stencil() override { return whole_->stencil(); }
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;

 private:
  /// from -= what find puts into an array of that size.
  template <class Find>
  void take_off(std::span<double> from, const Find& find);

  std::unique_ptr<LatticeForces> whole_;
  Workspace workspace_;
  LinearBondSums cut_;
  std::vector<double> of_cut_;
};

}  // namespace peristat
