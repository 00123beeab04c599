#pragma once

#include "assembly/operators/tangent.hpp"
#include "solvers/linear/free_dofs.hpp"

namespace peristat {

/// Where an entry of K_ff is stored in a tangent: (row, column) of the diagonal block of a point,
/// or of the block of a bond.
struct EntryPlace {
  bool is_on_diagonal;
  Offset block;  ///< number of the point or bond
  int row, column;

  [[nodiscard]] double value(const Tangent& tangent) const {
    const int d = tangent.dimension;
    return is_on_diagonal ? tangent.diagonal[(std::size_t(block) * d + row) * d + column]
                          : tangent.entry(block, row, column);
  }
};

/// Calls visit(row, place) for each stored entry of one column of the lower triangle of K_ff in
/// ascending rows, the diagonal first.
template <class Visit>
void for_each_entry_of_column(const BlockPattern& pattern, const FreeDofs& free, Index equation,
                              const Visit& visit) {
  const int d = free.dimension;
  const Index dof = free.dof[equation];
  const Index i = dof / d;
  const int r = dof % d;
  for (int c = r; c < d; ++c) {
    const Index row = free.equation[std::size_t(i) * d + c];
    if (row != FreeDofs::none) visit(row, EntryPlace{true, i, r, c});
  }
  for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
    const std::size_t j = std::size_t(pattern.partner(i, bond));
    for (int c = 0; c < d; ++c) {
      const Index row = free.equation[j * d + c];
      if (row != FreeDofs::none) visit(row, EntryPlace{false, bond, r, c});
    }
  }
}

}  // namespace peristat
