#pragma once

#include <memory>
#include <span>
#include <vector>

#include "assembly/convolutions/lattice_forces.hpp"

namespace peristat {

/// Forces of the bonds of a body whose last points are images of others, beyond planes of symmetry
/// and periods. A bond counts as far as its points are the body's own: one with an image half, as
/// its twin at the other end does, and one between images not at all.
///
/// With m = 1 of own points and 1/2 of images, and all energies products of both points'
/// integrities, that is
///
///   E(q) = E_whole(m q) - E_whole(q of images alone) / 4,
///
/// so that one operator, twice, knows everything: forces on images are what constraints fold onto
/// the sources and onto the jumps over periods. Energies and virials of images belong to sources.
class ForcesWithImages : public LatticeForces {
 public:
  /// @param of_all, of_images the same forces of pairs of points, of all points
  /// @param own the points that are no images, the first ones
  ForcesWithImages(std::unique_ptr<LatticeForces> of_all, std::unique_ptr<LatticeForces> of_images,
                   std::size_t points, std::size_t own);

  void set_integrity(std::span<const double> integrity) override;
  void find_forces(std::span<const double> displacement, std::span<double> force) override;
  void find_forces_and_energies(std::span<const double> displacement, std::span<double> force,
                                std::span<double> energy) override;
  void multiply(std::span<const double> displacement, std::span<const double> v,
                std::span<double> product) override;
  /// Row sums are those without what is taken off.
  void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                       std::span<double> row_sums) override;
  void add_virials(std::span<const double> displacement, std::span<double> virials) override;

 private:
  /// from -= a quarter of what find puts into an array of that size.
  template <class Find>
  void take_off(std::span<double> from, const Find& find);

  std::unique_ptr<LatticeForces> of_all_, of_images_;
  std::size_t own_;
  std::vector<double> integrity_, of_images_found_;
};

}  // namespace peristat
