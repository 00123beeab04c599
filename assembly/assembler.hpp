#pragma once

#include <span>
#include <vector>

#include "assembly/bond_term.hpp"
#include "assembly/tangent.hpp"
#include "src/aligned_vector.hpp"
#include "src/points/points.hpp"

namespace peristat {

/// What a pass over the interactions finds besides what it adds up.
struct Stored {
  double energy = 0.0;  ///< [J]
  bool degenerate =
      false;  ///< a measure has reached zero or a value is not finite: reject the state
};

/// Energy, gradient, tangent and matrix-free product of the discrete energy
/// E(u) = sum over bonds of w psi(|xi0 + eta|; L), visiting each unique bond once, on several
/// threads.
///
/// All arrays are points x dimension, row major. No call allocates. For a given number of threads
/// every result is reproducible to the last bit.
class Assembler {
 public:
  /// Points and term must outlive the assembler.
  Assembler(const Points& points, const BondTerm& term, int threads);

  /// E [J]
  [[nodiscard]] Stored energy(std::span<const double> displacement);

  /// E [J] and dE/dx [N] (minus the internal force).
  [[nodiscard]] Stored gradient(std::span<const double> displacement, std::span<double> gradient);

  /// d2E/dx2 [N/m], every entry overwritten.
  void tangent(std::span<const double> displacement, Tangent& tangent);

  /// product = d2E/dx2(displacement) v, without a stored tangent.
  void product(std::span<const double> displacement, std::span<const double> v,
               std::span<double> product);

  /// Energy of each point, half of its bonds' [J], and the largest stretch l/L - 1 of a bond.
  double point_energies(std::span<const double> displacement, std::span<double> energies);

  [[nodiscard]] int threads() const { return static_cast<int>(ranges_.size()); }
  [[nodiscard]] const Points& points() const { return points_; }
  [[nodiscard]] const BondTerm& term() const { return term_; }
  [[nodiscard]] double seconds_spent() const { return seconds_; }  ///< wall time of all calls [s]

 private:
  template <int D>
  struct Kernels;

  const Points& points_;
  const BondTerm& term_;
  std::vector<RowRange> ranges_;
  AlignedVector<double> rows_;               // per point, what kernels gather; see Kernels::pack
  std::vector<AlignedVector<double>> sums_;  // per thread, rows first..reach of what it adds up
  std::vector<Stored> stored_;               // per thread
  std::vector<double> longest_;              // per thread, largest stretch
  double seconds_ = 0.0;
};

}  // namespace peristat
