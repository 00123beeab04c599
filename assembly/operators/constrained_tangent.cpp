#include "assembly/operators/constrained_tangent.hpp"

#include <algorithm>
#include <utility>

#include "assembly/operators/constrained_row_sums.hpp"
#include "src/core/threads.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

constexpr Offset nowhere = -1;

/// Visits the blocks (i, bond) of a pattern in which at least one point follows others.
template <class Visit>
void for_each_of_followers(const BlockPattern& pattern, const Constraints& constraints,
                           const Visit& visit) {
  for (Index i = 0; i < pattern.points(); ++i) {
    const bool is_alone = constraints.stands_alone(i);
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
      if (!is_alone || !constraints.stands_alone(pattern.partner(i, bond))) visit(i, bond);
    }
  }
}

void make_unique(std::vector<Index>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// True if a row is this rank's: that of an owned point, or its share of a handle's.
bool has_row(const IndexMap& index_map, Index row) {
  return index_map.owns(row) || row >= index_map.count();
}

/// Couples the handles that points of any rank couple, so that their rows have one layout on all
/// ranks. Collective.
/// @param first row of a handle: each rank has as many, after its points
void agree_on_handles(const Communicator& ranks, Index first,
                      std::vector<std::vector<Index>>& columns) {
  std::vector<double> pairs;
  for (auto row = std::size_t(first); row < columns.size(); ++row) {
    for (const Index column : columns[row]) {
      pairs.push_back(double(Index(row) - first));
      pairs.push_back(double(column - first));
    }
  }
  pairs = concatenated(ranks, pairs);
  for (std::size_t k = 0; k < pairs.size(); k += 2) {
    columns[std::size_t(first) + std::size_t(pairs[k])].push_back(first + Index(pairs[k + 1]));
  }
}

}  // namespace

BlockPattern constrained_pattern(const BlockPattern& whole, const Constraints& constraints,
                                 const IndexMap& index_map) {
  std::vector<std::vector<Index>> more(std::size_t(constraints.rows()));
  const std::vector<double> at_rest(constraints.dofs(), 0.0);
  const auto couple = [&](Index a, Index b) {
    const Index row = std::min(a, b);
    if (a != b && has_row(index_map, row)) more[std::size_t(row)].push_back(std::max(a, b));
  };
  std::vector<std::vector<Index>> masters(std::size_t(whole.points()));
  for (Index i = 0; i < whole.points(); ++i) {
    if (constraints.stands_alone(i)) {
      masters[i] = {i};
      continue;
    }
    for (const Dependence& on : constraints.dependences(i, at_rest)) {
      masters[i].push_back(on.master);
    }
    for (const Index a : masters[i]) {
      for (const Index b : masters[i]) couple(a, b);
    }
  }
  for_each_of_followers(whole, constraints, [&](Index i, Offset bond) {
    for (const Index a : masters[i]) {
      for (const Index b : masters[whole.partner(i, bond)]) couple(a, b);
    }
  });
  for (auto row = std::size_t(whole.points()); row < more.size(); ++row) make_unique(more[row]);
  agree_on_handles(index_map.ranks(), whole.points(), more);
  std::vector<Offset> offset{0};
  std::vector<Index> partner;
  for (Index i = 0; i < constraints.rows(); ++i) {
    std::vector<Index>& row = more[std::size_t(i)];
    if (i < whole.points() && constraints.stands_alone(i) && has_row(index_map, i)) {
      for (const Index j : whole.of(i)) {
        if (constraints.stands_alone(j)) row.push_back(j);
      }
    }
    make_unique(row);
    partner.insert(partner.end(), row.begin(), row.end());
    offset.push_back(static_cast<Offset>(partner.size()));
    row = std::vector<Index>();
  }
  return BlockPattern::of_rows(std::move(offset), std::move(partner));
}

ConstrainedTangent::ConstrainedTangent(const Energy& energy, const Constraints& constraints,
                                       const IndexMap& index_map)
    : Tangent(constrained_pattern(energy.pattern(), constraints, index_map),
              energy.points().dimension, energy.threads(), energy.points().own_rows(),
              Blocks::whole),
      points_(energy.points()),
      constraints_(constraints),
      index_map_(index_map),
      whole_(energy),
      reference_(energy.points().reference) {
  for (const Coordinates& handle : constraints.handles()) {
    reference_.insert(reference_.end(), handle.begin(), handle.begin() + dimension);
  }
  reference = reference_;
  find_places();
}

void ConstrainedTangent::find_places() {
  place_.assign(std::size_t(whole_.pattern.blocks()), nowhere);
  for (Index i = 0; i < whole_.pattern.points(); ++i) {
    if (!constraints_.stands_alone(i) || !has_row(index_map_, i)) continue;
    for (Offset bond = whole_.pattern.offset[i]; bond < whole_.pattern.offset[i + 1]; ++bond) {
      const Index j = whole_.pattern.partner(i, bond);
      if (constraints_.stands_alone(j)) place_[std::size_t(bond)] = pattern.find(i, j).value();
    }
  }
}

Couplings ConstrainedTangent::in_place() const {
  const auto own = std::size_t(points_.own());
  return {whole_.pattern.offset.first(own + 1), whole_.pattern.partner};
}

void ConstrainedTangent::linearise(Energy& energy, const StateView& at, double projection) {
  whole_.linearise(energy, at, projection);
  if (whole_.version != version) {
    take_pattern(constrained_pattern(whole_.pattern, constraints_, index_map_), whole_.version);
    find_places();
  }
  for (std::size_t dof = 0; dof < position.size(); ++dof) {
    position[dof] = reference_[dof] + at.displacement[dof];
  }
  clear();
  add_blocks_between_free_points();
  add_blocks_of_followers(at.displacement);
  gather_handles();
  add_curvature(at);
}

void ConstrainedTangent::gather_handles() {
  const std::size_t entries = std::size_t(dimension) * std::size_t(dimension);
  const auto first = std::size_t(points_.count());
  for (const std::span<double> shares :
       {std::span(diagonal).subspan(first * entries),
        std::span(off_diagonal).subspan(std::size_t(pattern.offset[first]) * entries)}) {
    add_up(index_map_.ranks(), shares);
    if (!index_map_.is_first_rank()) std::ranges::fill(shares, 0.0);
  }
}

/// Rows of handles are partial: each rank has the columns of its own points.
void ConstrainedTangent::multiply(std::span<const double> v, std::span<double> result) const {
  factor_.assign(v.begin(), v.end());
  index_map_.update_ghosts(factor_);
  Tangent::multiply(factor_, result);
  add_up(index_map_.ranks(), result.subspan(points_.reference.size()));
}

void ConstrainedTangent::absolute_row_sums(std::span<double> sums) const {
  if (constraints_.couples_points()) {  // as on a part of a body, which lacks rows
    std::vector<double> displacement(position);
    for (std::size_t dof = 0; dof < position.size(); ++dof) displacement[dof] -= reference_[dof];
    bound_constrained_row_sums(whole_, points_, constraints_, displacement, index_map_, sums);
    return;
  }
  Tangent::absolute_row_sums(sums);
  add_up(index_map_.ranks(), sums.subspan(points_.reference.size()));
}

void ConstrainedTangent::add_blocks_between_free_points() {
  const std::size_t entries = std::size_t(dimension) * std::size_t(dimension);
  run_on_parts(threads(), whole_.parts(), [&](int part) {
    const RowRange range = whole_.ranges[std::size_t(part)];
    for (Index i = range.first; i < range.last; ++i) {
      if (!constraints_.stands_alone(i) || !has_row(index_map_, i)) continue;
      std::copy_n(&whole_.diagonal[std::size_t(i) * entries], entries,
                  &diagonal[std::size_t(i) * entries]);
      for (Offset bond = whole_.pattern.offset[i]; bond < whole_.pattern.offset[i + 1]; ++bond) {
        const Offset place = place_[std::size_t(bond)];
        if (place == nowhere) continue;
        double* const to = &off_diagonal[std::size_t(place) * entries];
        for (int r = 0; r < dimension; ++r) {
          for (int c = 0; c < dimension; ++c) to[r * dimension + c] = whole_.entry(bond, r, c);
        }
      }
    }
  });
}

void ConstrainedTangent::add_blocks_of_followers(std::span<const double> displacement) {
  std::vector<std::vector<Dependence>> of_point(std::size_t(whole_.pattern.points()));
  const auto dependences = [&](Index i) -> const std::vector<Dependence>& {
    std::vector<Dependence>& known = of_point[std::size_t(i)];
    if (known.empty()) known = constraints_.dependences(i, displacement);
    return known;
  };
  Tensor block{};
  for (Index i = 0; i < whole_.pattern.points(); ++i) {
    if (constraints_.stands_alone(i) || !points_.owns(i)) continue;
    for (int k = 0; k < dimension * dimension; ++k) {
      block[std::size_t(k / dimension)][std::size_t(k % dimension)] =
          whole_.diagonal[std::size_t(i) * std::size_t(dimension * dimension) + std::size_t(k)];
    }
    const End end{dependences(i), true};
    add_reduced(end, end, block, true);
  }
  for_each_of_followers(whole_.pattern, constraints_, [&](Index i, Offset bond) {
    const Index j = whole_.pattern.partner(i, bond);
    if (!points_.owns(i) && !points_.owns(j)) return;
    for (int r = 0; r < dimension; ++r) {
      for (int c = 0; c < dimension; ++c) {
        block[std::size_t(r)][std::size_t(c)] = whole_.entry(bond, r, c);
      }
    }
    add_reduced({dependences(i), points_.owns(i)}, {dependences(j), points_.owns(j)}, block, false);
  });
}

void ConstrainedTangent::add_reduced(const End& a, const End& b, const Tensor& block,
                                     bool is_diagonal) {
  const std::size_t d = std::size_t(dimension);
  for (const Dependence& left : a.masters) {
    for (const Dependence& right : b.masters) {
      Tensor reduced{};
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          const double entry = block[r][c];
          for (std::size_t m = 0; m < d; ++m) {
            for (std::size_t n = 0; n < d; ++n) {
              reduced[m][n] += left.block[r][m] * entry * right.block[c][n];
            }
          }
        }
      }
      // A point's diagonal block meets both orders of its dependences; an off-diagonal block also
      // represents its transpose. The row that is kept is that of the lower master, and the rank
      // that owns the point which follows this master adds it.
      const bool is_ascending = left.master <= right.master;
      if (is_ascending ? a.is_owned : b.is_owned && !is_diagonal) {
        add(left.master, right.master, reduced);
      }
      if (left.master == right.master && !is_diagonal && b.is_owned) {
        Tensor transposed{};
        for (std::size_t m = 0; m < d; ++m) {
          for (std::size_t n = 0; n < d; ++n) transposed[m][n] = reduced[n][m];
        }
        add(left.master, left.master, transposed);
      }
    }
  }
}

void ConstrainedTangent::add(Index row, Index column, const Tensor& block) {
  const std::size_t d = std::size_t(dimension), entries = d * d;
  const auto pair = [&] {
    return std::size_t(pattern.find(std::min(row, column), std::max(row, column)).value());
  };
  double* to =
      row == column ? &diagonal[std::size_t(row) * entries] : &off_diagonal[pair() * entries];
  for (std::size_t r = 0; r < d; ++r) {
    for (std::size_t c = 0; c < d; ++c) {
      *to++ += row <= column ? block[r][c] : block[c][r];
    }
  }
}

void ConstrainedTangent::add_curvature(const StateView& at) {
  if (!index_map_.is_first_rank()) return;
  const auto& sets = constraints_.rigid_sets();
  for (std::size_t k = 0; k < at.curvature.size(); ++k) {
    add(sets[k].rotation, sets[k].rotation, at.curvature[k]);
  }
}

Couplings couplings_in_place(const TangentOperator& tangent) {
  const auto* const constrained = dynamic_cast<const ConstrainedTangent*>(&tangent);
  if (constrained == nullptr) return tangent.pattern;
  return constrained->in_place();
}

}  // namespace peristat
