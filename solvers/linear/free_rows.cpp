#include "solvers/linear/free_rows.hpp"

#include <stdexcept>
#include <utility>

namespace peristat {

SparseRows free_rows(SparseRows rows, const FreeDofs& free) {
  if (rows.offset.size() != free.equation.size() + 1) {
    throw std::logic_error("free_rows: one row per degree of freedom is needed");
  }
  // Equations ascend with their degrees of freedom, so that nothing is overwritten before it is
  // read, and columns stay in order.
  std::size_t place = 0;
  for (Index e = 0; e < free.count(); ++e) {
    const auto dof = std::size_t(free.dof[std::size_t(e)]);
    const Offset begin = rows.offset[dof], end = rows.offset[dof + 1];
    rows.offset[std::size_t(e)] = Offset(place);
    for (auto k = std::size_t(begin); k < std::size_t(end); ++k) {
      const Index column = free.equation[std::size_t(rows.column[k])];
      if (column == FreeDofs::none) continue;
      rows.column[place] = column;
      rows.value[place++] = rows.value[k];
    }
  }
  rows.offset.resize(std::size_t(free.count()) + 1);
  rows.offset.back() = Offset(place);
  rows.column.resize(place);
  rows.value.resize(place);
  return rows;
}

}  // namespace peristat
