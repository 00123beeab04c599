#include "solvers/linear/compressed_rows.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "src/parallel/index_map.hpp"
#include "src/parallel/sums.hpp"

namespace peristat {
namespace {

/// Numbers the columns of the degrees of freedom. Ghosts that the rows reach come last, and
/// rows.ghosts receives their equations in the whole matrix.
std::vector<Index> number_columns(const BlockPattern& pattern, const FreeDofs& free,
                                  const IndexMap& index_map, CompressedRows& rows) {
  const auto d = std::size_t(free.dimension), owned = std::size_t(index_map.owned());
  const double first = double(index_map.ranks().count_all(free.count()).before);
  std::vector<double> number(free.equation.size());
  for (std::size_t k = 0; k < number.size(); ++k) {
    number[k] = free.equation[k] == FreeDofs::none ? -1.0 : first + free.equation[k];
  }
  index_map.update_ghosts(number);
  std::vector<char> is_reached(number.size() / d, 0);
  for (Index i = 0; i < index_map.owned(); ++i) {
    for (const Index j : pattern.of(i)) is_reached[std::size_t(j)] = 1;
  }
  std::vector<Index> column = free.equation;
  for (std::size_t k = owned * d; k < number.size(); ++k) {
    if (!is_reached[k / d] || number[k] < 0.0) continue;
    column[k] = free.count() + Index(rows.ghosts.size());
    rows.ghosts.push_back(static_cast<long long>(number[k]));
  }
  return column;
}

}  // namespace

CompressedRows compressed_rows(const Tangent& tangent, const FreeDofs& free,
                               const IndexMap& index_map) {
  const BlockPattern& pattern = tangent.pattern;
  const Index points = pattern.points();
  const int d = tangent.dimension;

  // Blocks with lower partners, which the pattern stores in the partners' rows; ascending, as i
  // ascends.
  std::vector<Offset> lower_offset(std::size_t(points) + 1, 0);
  for (Index i = 0; i < points; ++i) {
    for (const Index j : pattern.of(i)) ++lower_offset[std::size_t(j) + 1];
  }
  for (Index i = 0; i < points; ++i) lower_offset[i + 1] += lower_offset[i];
  struct Lower {
    Index partner;
    Offset bond;
  };
  std::vector<Lower> lower(std::size_t(pattern.blocks()));
  std::vector<Offset> filled(lower_offset.begin(), lower_offset.end() - 1);
  for (Index i = 0; i < points; ++i) {
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
      lower[filled[pattern.partner(i, bond)]++] = {i, bond};
    }
  }

  CompressedRows rows;
  rows.rows = free.count();
  std::vector<Index> column_of = free.equation;
  if (!index_map.is_whole()) {
    rows.ranks = &index_map.ranks();
    column_of = number_columns(pattern, free, index_map, rows);
  }
  rows.begin.reserve(std::size_t(rows.rows) + 1);
  rows.begin.push_back(0);
  const std::size_t entries =
      std::size_t(2 * pattern.blocks() + points) * std::size_t(d) * std::size_t(d);
  rows.column.reserve(entries);
  rows.value.reserve(entries);
  for (Index i = 0; i < points; ++i) {
    for (int r = 0; r < d; ++r) {
      if (free.equation[std::size_t(i) * d + r] == FreeDofs::none) continue;
      const auto append = [&](Index j, const auto& entry_of_column) {
        for (int c = 0; c < d; ++c) {
          const Index column = column_of[std::size_t(j) * d + c];
          if (column == FreeDofs::none) continue;
          rows.column.push_back(column);
          rows.value.push_back(entry_of_column(c));
        }
      };
      for (Offset k = lower_offset[i]; k < lower_offset[i + 1]; ++k) {
        append(lower[k].partner, [&](int c) { return tangent.entry(lower[k].bond, c, r); });
      }
      append(i, [&](int c) { return tangent.diagonal[(std::size_t(i) * d + r) * d + c]; });
      for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
        append(pattern.partner(i, bond), [&](int c) { return tangent.entry(bond, r, c); });
      }
      rows.begin.push_back(rows.column.size());
    }
  }
  return rows;
}

EquationBlocks equation_blocks(const FreeDofs& free) { return {free.dimension, free.dof}; }

NearNullSpace rigid_motions(std::span<const double> positions, const FreeDofs& free,
                            const IndexMap& index_map) {
  const int d = free.dimension;
  const Sums sums(index_map, d);
  const std::size_t equations = free.dof.size(), dofs = sums.own(positions.size());
  // Centred, so that rotations and translations are far from parallel.
  std::vector<double> centre(4, 0.0);
  for (std::size_t dof = 0; dof < dofs; ++dof) centre[dof % d] += positions[dof];
  centre[3] = double(dofs) / d;
  centre = sums.of_all(std::move(centre));
  for (int c = 0; c < 3; ++c) centre[std::size_t(c)] /= std::max(1.0, centre[3]);
  double size = 0.0;
  for (std::size_t dof = 0; dof < dofs; ++dof) {
    size = std::max(size, std::abs(positions[dof] - centre[dof % d]));
  }
  size = sums.largest_of_all(size);
  if (size == 0.0) size = 1.0;

  NearNullSpace motions;
  const auto add = [&](const auto& displacement) {
    ++motions.count;
    for (std::size_t e = 0; e < equations; ++e) {
      motions.values.push_back(displacement(free.dof[e] / d, free.dof[e] % d));
    }
  };
  for (int axis = 0; axis < d; ++axis) {
    add([axis](Index, int component) { return component == axis ? 1.0 : 0.0; });
  }
  // The rotation in the plane of axes a and b moves x_a by -x_b and x_b by x_a.
  for (int a = 0; a < d; ++a) {
    for (int b = a + 1; b < d; ++b) {
      add([&](Index point, int component) {
        if (component != a && component != b) return 0.0;
        const int other = component == a ? b : a;
        const double arm = (positions[std::size_t(point) * d + other] - centre[other]) / size;
        return component == a ? -arm : arm;
      });
    }
  }
  return motions;
}

}  // namespace peristat
