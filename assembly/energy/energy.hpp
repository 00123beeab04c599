#pragma once

#include <span>
#include <vector>

#include "assembly/energy/state.hpp"
#include "src/geometry/points.hpp"

namespace peristat {

class BlockPattern;
struct RowRange;
enum class TangentKind;
struct TangentForms;

/// An energy E(u) as seen by the operators that are linearised from it; see Assembler.
class Energy {
 public:
  virtual ~Energy() = default;

  [[nodiscard]] virtual const Points& points() const = 0;
  [[nodiscard]] virtual const BlockPattern& pattern() const = 0;
  /// Lets the pattern cover the points that are in contact at a state. Returns the version of the
  /// pattern, which changes with it.
  virtual int cover_contacts(const StateView& /*at*/) { return 0; }
  [[nodiscard]] virtual int threads() const = 0;
  /// Parts of the rows, whose sums are added up in order.
  [[nodiscard]] virtual const std::vector<RowRange>& parts() const = 0;
  /// Whether each off-diagonal block of its tangent is symmetric.
  [[nodiscard]] virtual bool has_symmetric_blocks() const = 0;
  /// True if forces are minus the derivative of the energy. Otherwise the tangent, their derivative
  /// with the other sign, is not symmetric.
  [[nodiscard]] virtual bool has_potential() const = 0;

  [[nodiscard]] virtual TangentKind tangent_kind() const = 0;
  /// Its tangent in the form of its kind and of all later ones.
  [[nodiscard]] virtual TangentForms forms() = 0;

  /// product = d2E/dx2 v, without a stored tangent.
  /// @param projection other than 0 only with TangentKind::visited or products
  virtual void product(const StateView& at, std::span<const double> v, std::span<double> product,
                       double projection) = 0;
  /// True if products are faster where single precision is allowed, see Precision.
  [[nodiscard]] virtual bool has_single_products() const { return false; }
};

}  // namespace peristat
