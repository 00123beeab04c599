#pragma once

#include <functional>
#include <span>
#include <stdexcept>

#include "assembly/convolutions/lattice_stencil.hpp"
#include "assembly/energy/sparse_rows.hpp"
#include "assembly/energy/state.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

class BlockPattern;
struct Tangent;

/// Called with the off-diagonal blocks (i, partner) of row i of a tangent, each dimension x
/// dimension, row major, in the order of its pattern. Rows of a thread come in ascending order.
using RowVisitor = std::function<void(int thread, Index i, std::span<const double> blocks)>;

/// Rows of the derivative of forces: the whole operator, or its short-range surrogate between
/// adjacent points.
enum class RowReach { whole, local };

/// An energy E(u) as seen by the operators that are linearised from it; see Assembler.
class Energy {
 public:
  virtual ~Energy() = default;

  [[nodiscard]] virtual const Points& points() const = 0;
  [[nodiscard]] virtual const BlockPattern& pattern() const = 0;
  [[nodiscard]] virtual int threads() const = 0;
  /// Whether each off-diagonal block of its tangent is symmetric.
  [[nodiscard]] virtual bool has_symmetric_blocks() const = 0;
  /// True if the tangent need not be stored: rows are computed one by one, and product and v may be
  /// one array.
  [[nodiscard]] virtual bool visits_rows() const = 0;

  /// True if the tangent has rows. Forces by convolutions have none, only products, `outline_rows`
  /// and `stencil`.
  [[nodiscard]] virtual bool has_rows() const { return true; }

  /// d2E/dx2 [N/m], every entry overwritten.
  /// @param projection share in [0, 1] by which the relative Hessian of every interaction moves
  ///        towards its positive semidefinite part: 0 is exact, 1 gives a positive semidefinite
  ///        tangent
  virtual void tangent(const StateView& at, Tangent& tangent, double projection) = 0;

  /// product = d2E/dx2 v, without a stored tangent.
  /// @param projection other than 0 only if it visits_rows
  virtual void product(const StateView& at, std::span<const double> v, std::span<double> product,
                       double projection) = 0;

  /// Visits the rows of the tangent, without storing it; only if it visits_rows.
  /// @param diagonal blocks, overwritten; empty: not wanted
  virtual void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                             std::span<double> diagonal) = 0;

  /// True if forces are minus the derivative of the energy. Otherwise the rows of their derivative
  /// replace the tangent: they are not symmetric, and `product` multiplies by them.
  [[nodiscard]] virtual bool has_potential() const { return true; }
  [[nodiscard]] virtual SparseRows rows(const StateView&, RowReach) {
    throw std::logic_error("an energy has a tangent");
  }
  /// Memory that all rows take [bytes].
  [[nodiscard]] virtual double bytes_of_rows() const { return 0.0; }
  /// Stencil of forces by convolutions; empty for others.
  [[nodiscard]] virtual LatticeStencil stencil(const StateView&) { return {}; }
  /// Diagonal blocks of the rows, points x dimension x dimension, and upper bounds of the sums of
  /// their absolute entries, one per degree of freedom [N/m].
  virtual void outline_rows(const StateView&, std::span<double> /*diagonal*/,
                            std::span<double> /*row_sums*/) {
    throw std::logic_error("an energy has a tangent");
  }
};

}  // namespace peristat
