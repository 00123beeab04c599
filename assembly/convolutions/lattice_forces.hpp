#pragma once

#include <span>

#include "assembly/convolutions/lattice_stencil.hpp"

namespace peristat {

/// Forces between the points of a lattice. Each point has an integrity q in [0, 1], a factor of all
/// its interactions. Arrays are points x dimension, row major.
class LatticeForces {
 public:
  virtual ~LatticeForces() = default;

  /// @param integrity q per point; 1 at first
  virtual void set_integrity(std::span<const double> integrity) = 0;

  /// @param displacement u [m]
  /// @param force f [N]
  virtual void find_forces(std::span<const double> displacement, std::span<double> force) = 0;

  /// @param energy w per point, whose sum has the derivative -f [J]
  virtual void find_forces_and_energies(std::span<const double> displacement,
                                        std::span<double> force, std::span<double> energy) = 0;

  /// product = K v with the tangent K = -df/du at u [N/m].
  virtual void multiply(std::span<const double> displacement, std::span<const double> v,
                        std::span<double> product) = 0;

  /// Adds to both arrays.
  /// @param diagonal blocks of K at u, or at rest, points x dimension x dimension [N/m]
  /// @param row_sums upper bounds of the sums of the absolute entries of each row of K at u [N/m]
  virtual void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                               std::span<double> row_sums) = 0;

  /// The tangent by steps along the lattice; empty if it is not known.
  [[nodiscard]] virtual LatticeStencil stencil() { return {}; }

  /// Adds each point's half of the products of its forces with their reference arms, see
  /// TermPasses::add_virials.
  /// @param virials points x dimension x dimension [J]
  virtual void add_virials(std::span<const double> displacement, std::span<double> virials) = 0;
};

}  // namespace peristat
