#pragma once

#include <span>
#include <vector>

#include "assembly/assembler.hpp"
#include "assembly/operators/matrix_free_tangent.hpp"

namespace peristat {

/// The tangent of a part of a body: rows of owned points are the whole body's, for products bring
/// ghosts what their owners multiply by. Rows and diagonal blocks of ghosts are parts of theirs,
/// and mean nothing. All ranks make the same calls.
struct PartTangent : TangentOperator {
  /// @throws std::logic_error unless the energy visits_rows, and is of a part
  explicit PartTangent(Assembler& energy);

  [[nodiscard]] std::vector<double> positions() const override { return tangent_.positions(); }
  void linearise(Energy& energy, const StateView& at, double projection) override;
  /// What v has for ghosts does not count; what the result has for them means nothing.
  void multiply(std::span<const double> v, std::span<double> result) const override;
  [[nodiscard]] bool multiplies_in_place() const override { return true; }
  void for_each_row(const RowVisitor& visit) const override { tangent_.for_each_row(visit); }

 private:
  const Assembler& energy_;
  MatrixFreeTangent tangent_;
  mutable std::vector<double> factor_;  // with the ghosts' values
};

/// Flags of degrees of freedom without an equation on this rank: all of ghosts, and those that are
/// prescribed.
/// @param prescribed one flag per degree of freedom of all points here
[[nodiscard]] std::vector<char> without_ghosts(const Sharing& sharing, std::vector<char> prescribed,
                                               int dimension);

}  // namespace peristat
