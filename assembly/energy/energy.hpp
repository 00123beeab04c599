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

/// Rows of the derivative of forces: all of them, or those of a stand-in between points that are
/// next to one another.
enum class RowReach { whole, local };

/// An energy E(u) as the operators see it that are linearised from it; see Assembler.
class Energy {
 public:
  virtual ~Energy() = default;

  [[nodiscard]] virtual const Points& points() const = 0;
  [[nodiscard]] virtual const BlockPattern& pattern() const = 0;
  [[nodiscard]] virtual int threads() const = 0;
  /// Whether each off-diagonal block of its tangent is symmetric.
  [[nodiscard]] virtual bool has_symmetric_blocks() const = 0;
  /// Whether its tangent can do without being stored: rows are found one by one, and product and v
  /// may be one array.
  [[nodiscard]] virtual bool visits_rows() const = 0;

  /// Whether its tangent has rows at all: forces by convolutions have products only, and what
  /// `outline_rows` and `stencil` tell.
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

  /// Whether forces are minus the derivative of the energy. Elsewhere there are the rows of their
  /// derivative instead of a tangent, which is not symmetric; `product` is theirs.
  [[nodiscard]] virtual bool has_potential() const { return true; }
  [[nodiscard]] virtual SparseRows rows(const StateView&, RowReach) {
    throw std::logic_error("an energy has a tangent");
  }
  /// What all of them take [bytes].
  [[nodiscard]] virtual double bytes_of_rows() const { return 0.0; }
  /// Of forces by convolutions.
  [[nodiscard]] virtual LatticeStencil stencil(const StateView&) { return {}; }
  /// Diagonal blocks of the rows, points x dimension x dimension, and numbers not less than the
  /// sums of their absolute entries, one per degree of freedom [N/m].
  virtual void outline_rows(const StateView&, std::span<double> /*diagonal*/,
                            std::span<double> /*row_sums*/) {
    throw std::logic_error("an energy has a tangent");
  }
};

}  // namespace peristat
