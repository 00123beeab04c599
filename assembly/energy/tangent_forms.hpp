#pragma once

#include <functional>
#include <span>

#include "assembly/convolutions/lattice_stencil.hpp"
#include "assembly/energy/sparse_rows.hpp"
#include "assembly/energy/state.hpp"
#include "assembly/energy/write.hpp"

namespace peristat {

struct Tangent;

/// What a tangent is made of. Each kind can be turned into the later ones, so that a sum has the
/// last kind of its terms.
enum class TangentKind {
  visited,   ///< blocks of a symmetric matrix, computed row by row: they need not be stored
  nearby,    ///< blocks of a symmetric matrix, which can be stored; products need no storage, and
             ///< rows of a simpler matrix near it can be visited to precondition them
  stored,    ///< blocks of a symmetric matrix, which have to be stored
  rows,      ///< sparse rows of an unsymmetric matrix
  products,  ///< products with vectors, without blocks or rows
};

/// A tangent that can be stored in blocks.
class BlockTangent {
 public:
  virtual ~BlockTangent() = default;

  /// d2E/dx2 [N/m], in the blocks of the pattern.
  /// @param projection share in [0, 1] by which the relative Hessian of every interaction moves
  ///        towards its positive semidefinite part: 0 is exact, 1 gives a positive semidefinite
  ///        tangent
  virtual void tangent(const StateView& at, Tangent& tangent, double projection, Write how) = 0;
};

/// Called with the off-diagonal blocks (i, partner) of row i of a tangent, each dimension x
/// dimension, row major, in the order of its pattern. Rows of a part come in ascending order.
using RowVisitor = std::function<void(int part, Index i, std::span<const double> blocks)>;

/// A tangent whose rows are computed one by one, or a matrix near it (TangentKind::nearby), with
/// its diagonal. Its product and v may be one array.
class RowVisits {
 public:
  virtual ~RowVisits() = default;

  /// Visits the rows of d2E/dx2 [N/m].
  /// @param projection see BlockTangent::tangent
  /// @param diagonal blocks, overwritten; empty: not wanted
  virtual void visit_tangent(const StateView& at, double projection, const RowVisitor& visit,
                             std::span<double> diagonal) = 0;
  /// The diagonal blocks alone, overwritten.
  virtual void find_diagonal(const StateView& at, double projection, std::span<double> diagonal) {
    visit_tangent(
        at, projection, [](int, Index, std::span<const double>) {}, diagonal);
  }
  /// Factor c such that c times the matrix whose rows are visited is no less than the tangent.
  [[nodiscard]] virtual double most_over_visited() const { return 1.0; }
};

/// What is known of a tangent without blocks, beside its products with vectors.
class ProductOperator {
 public:
  virtual ~ProductOperator() = default;

  /// Adds to both arrays.
  /// @param diagonal blocks, points x dimension x dimension [N/m]
  /// @param row_sums upper bounds of the sums of the absolute entries of rows, per degree of
  ///        freedom [N/m]
  virtual void outline(const StateView& at, std::span<double> diagonal,
                       std::span<double> row_sums) = 0;

  /// The tangent by steps along a lattice; empty where there is none.
  [[nodiscard]] virtual LatticeStencil stencil(const StateView& at) = 0;
};

/// Rows of the derivative of forces: the whole operator, or its short-range surrogate between
/// adjacent points.
enum class RowReach { whole, local };

/// A tangent that has sparse rows, which need not be symmetric.
class RowOperator : public ProductOperator {
 public:
  [[nodiscard]] virtual SparseRows rows(const StateView& at, RowReach reach) = 0;
  /// Memory that all rows take [bytes].
  [[nodiscard]] virtual double bytes_of_rows() const = 0;
};

/// The forms in which a tangent is available; null: not in this one.
struct TangentForms {
  BlockTangent* blocks = nullptr;
  RowVisits* visits = nullptr;
  RowOperator* rows = nullptr;
  ProductOperator* products = nullptr;
};

}  // namespace peristat
