#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_forces.hpp"

namespace peristat {

/// Forces of the bonds of a body whose last points are images beyond planes of symmetry and
/// periods. A bond counts by the share of its points that are the body's own: half if one is an
/// image, as its twin at the other end counts the other half, and not at all if both are.
///
/// With m = 1 at own points and 1/2 at images, and energies that are products of both points'
/// integrities, that is
///
///   E(q) = E_whole(m q) - E_whole(q of images alone) / 4,
///
/// so that two evaluations of one operator suffice. Constraints fold the forces on images onto the
/// sources and onto the jumps over periods. Energies and virials of images belong to their sources.
class ForcesWithImages : public LatticeForces {
 public:
  /// @param of_all, of_images two instances of the same forces between all points
  /// @param own number of points that are no images; they come first
  ForcesWithImages(std::unique_ptr<LatticeForces> of_all, std::unique_ptr<LatticeForces> of_images,
                   std::size_t points, std::size_t own);

  void set_integrity(std::span<const double> integrity) override;
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Row sums are bounds, from which nothing is subtracted.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;

 private:
  /// Subtracts from `from` a quarter of what find writes into an array of that size.
  template <class Find>
  void take_off(std::span<double> from, const Find& find);

  std::unique_ptr<LatticeForces> of_all_, of_images_;
  std::size_t own_;
  std::vector<double> integrity_, of_images_found_;
};

}  // namespace peristat
