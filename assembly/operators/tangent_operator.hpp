#pragma once

#include <span>
#include <vector>

#include "assembly/convolutions/lattice_stencil.hpp"
#include "assembly/energy/energy.hpp"
#include "assembly/energy/tangent_forms.hpp"
#include "assembly/operators/row_ranges.hpp"

namespace peristat {

struct Tangent;
struct UnsymmetricTangent;

/// Tangent K = d2E/dx2 [N/m] of the stored energy over all degrees of freedom, as solvers see it:
/// they multiply by it, and read its blocks (i, j), i <= j, each dimension x dimension, row major;
/// block (j, i) is the transpose of block (i, j). An UnsymmetricTangent has products and sparse
/// rows only.
struct TangentOperator {
  /// @param parts of the rows that are visited
  TangentOperator(const BlockPattern& of, int dimension_of_points, int threads,
                  std::vector<RowRange> parts);
  virtual ~TangentOperator() = default;

  BlockPattern pattern;
  int version = 0;  ///< of the pattern, see Energy::cover_contacts
  int dimension;
  std::vector<RowRange> ranges;       ///< rows of each part
  std::vector<double> diagonal;       ///< points x d x d
  std::span<const double> reference;  ///< positions of the undeformed body, which outlives it

  [[nodiscard]] Offset dofs() const { return Offset(pattern.points()) * dimension; }
  [[nodiscard]] int threads() const { return threads_; }
  [[nodiscard]] int parts() const { return static_cast<int>(ranges.size()); }

  /// Current positions, where K is linearised; points x d [m].
  [[nodiscard]] virtual std::vector<double> positions() const = 0;

  /// Linearises at a state.
  /// @param projection see BlockTangent::tangent
  virtual void linearise(Energy& energy, const StateView& at, double projection) = 0;

  /// result = K v; both have one entry per degree of freedom. They may be one array if
  /// multiplies_in_place; otherwise they must not overlap.
  virtual void multiply(std::span<const double> v, std::span<double> result) const = 0;
  [[nodiscard]] virtual bool multiplies_in_place() const { return false; }

  /// True if multiply_in_single is faster than multiply.
  [[nodiscard]] virtual bool multiplies_in_single() const { return false; }
  /// As `multiply`, with parts that are rounded to single precision: result = (K + R) v, where R is
  /// of the size of 1e-7 K.
  virtual void multiply_in_single(std::span<const double> v, std::span<double> result) const {
    multiply(v, result);
  }

  /// True if there are rows to visit: products by convolutions have none.
  [[nodiscard]] virtual bool has_rows() const { return true; }
  /// Visits all rows, the parts in parallel, and the rows of a part in ascending order.
  virtual void for_each_row(const RowVisitor& visit) const = 0;

  /// Sums of the absolute entries of each row, sum_j |K_ij| [N/m]: Gershgorin's bound of the
  /// largest eigenvalue, per degree of freedom.
  virtual void absolute_row_sums(std::span<double> sums) const;

  /// result_i = sum_j |K_ij| weight_j; only for a tangent with rows to visit.
  void multiply_absolute(std::span<const double> weight, std::span<double> result) const;

  /// Stencil of a tangent on a lattice that has no rows to visit; empty for others.
  [[nodiscard]] virtual LatticeStencil stencil() const { return {}; }

  /// This tangent if its blocks are stored; null if they are computed anew each time.
  [[nodiscard]] virtual const Tangent* as_tangent() const { return nullptr; }
  [[nodiscard]] virtual Tangent* as_tangent() { return nullptr; }

  [[nodiscard]] virtual bool is_symmetric() const { return true; }

  /// This tangent if it is not symmetric and has sparse rows, otherwise null: `pattern` then has no
  /// blocks, and there are no rows to visit.
  [[nodiscard]] virtual const UnsymmetricTangent* as_unsymmetric() const { return nullptr; }

 private:
  int threads_;
};

}  // namespace peristat
