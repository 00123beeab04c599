#pragma once

#include <span>

#include "assembly/convolutions/lattice_stencil.hpp"

namespace peristat {

/// Forces that points of a lattice exert on one another, each with an integrity q in [0, 1] that
/// all it takes part in has as a factor. Arrays are points x dimension, row major.
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

  /// Adds to both.
  /// @param diagonal blocks of K at u, or at rest, points x dimension x dimension [N/m]
  /// @param row_sums numbers not less than the sums of the absolute entries of each row of K at u
  ///                 [N/m]
  virtual void outline_tangent(std::span<const double> displacement, std::span<double> diagonal,
                               std::span<double> row_sums) = 0;

  /// The same by steps along the lattice.
  [[nodiscard]] virtual LatticeStencil stencil() { return {}; }

  /// Adds each point's half of what its forces times their reference arms are, see
  /// TermPasses::add_virials.
  /// @param virials points x dimension x dimension [J]
  virtual void add_virials(std::span<const double> displacement, std::span<double> virials) = 0;
};

}  // namespace peristat
