#include "assembly/operators/constrained_tangent.hpp"

#include <algorithm>
#include <utility>

#include "src/core/threads.hpp"

namespace peristat {
namespace {

constexpr Offset nowhere = -1;

/// Visits the blocks (i, bond) of a pattern with a point that follows.
template <class Visit>
void for_each_of_followers(const BlockPattern& pattern, const Constraints& constraints,
                           const Visit& visit) {
  for (Index i = 0; i < pattern.points(); ++i) {
    const bool is_alone = constraints.stands_alone(i);
    for (Offset bond = pattern.offset[i]; bond < pattern.offset[i + 1]; ++bond) {
      if (!is_alone || !constraints.stands_alone(pattern.partner[bond])) visit(i, bond);
    }
  }
}

Offset place_of(const BlockPattern& pattern, Index row, Index column) {
  const Index* const first = pattern.partner.data() + pattern.offset[row];
  const Index* const last = pattern.partner.data() + pattern.offset[row + 1];
  return std::lower_bound(first, last, column) - pattern.partner.data();
}

}  // namespace

BlockPattern constrained_pattern(const BlockPattern& whole, const Constraints& constraints) {
  std::vector<std::vector<Index>> more(std::size_t(constraints.rows()));
  const std::vector<double> at_rest(constraints.dofs(), 0.0);
  const auto couple = [&](Index a, Index b) {
    if (a != b) more[std::size_t(std::min(a, b))].push_back(std::max(a, b));
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
      for (const Index b : masters[whole.partner[bond]]) couple(a, b);
    }
  });
  std::vector<Offset> offset{0};
  std::vector<Index> partner;
  for (Index i = 0; i < constraints.rows(); ++i) {
    std::vector<Index>& row = more[std::size_t(i)];
    if (i < whole.points() && constraints.stands_alone(i)) {
      for (const Index j : whole.of(i)) {
        if (constraints.stands_alone(j)) row.push_back(j);
      }
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    partner.insert(partner.end(), row.begin(), row.end());
    offset.push_back(static_cast<Offset>(partner.size()));
    row = std::vector<Index>();
  }
  return BlockPattern::of_rows(std::move(offset), std::move(partner));
}

ConstrainedTangent::ConstrainedTangent(const Energy& energy, const Constraints& constraints)
    : Tangent(constrained_pattern(energy.pattern(), constraints), energy.points().dimension,
              energy.threads(), Blocks::whole),
      constraints_(constraints),
      whole_(energy),
      place_(std::size_t(whole_.pattern.blocks()), nowhere),
      reference_(energy.points().reference) {
  for (const Coordinates& handle : constraints.handles()) {
    reference_.insert(reference_.end(), handle.begin(), handle.begin() + dimension);
  }
  reference = reference_;
  for (Index i = 0; i < whole_.pattern.points(); ++i) {
    if (!constraints.stands_alone(i)) continue;
    for (Offset bond = whole_.pattern.offset[i]; bond < whole_.pattern.offset[i + 1]; ++bond) {
      const Index j = whole_.pattern.partner[bond];
      if (constraints.stands_alone(j)) place_[std::size_t(bond)] = place_of(pattern, i, j);
    }
  }
}

void ConstrainedTangent::linearise(Energy& energy, const StateView& at, double projection) {
  energy.tangent(at, whole_, projection);
  for (std::size_t dof = 0; dof < position.size(); ++dof) {
    position[dof] = reference_[dof] + at.displacement[dof];
  }
  clear();
  add_blocks_between_free_points();
  add_blocks_of_followers(at.displacement);
  add_curvature(at);
}

void ConstrainedTangent::add_blocks_between_free_points() {
  const std::size_t entries = std::size_t(dimension) * std::size_t(dimension);
  run_on_threads(threads(), [&](int thread) {
    const RowRange range = whole_.ranges[std::size_t(thread)];
    for (Index i = range.first; i < range.last; ++i) {
      if (!constraints_.stands_alone(i)) continue;
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
    if (constraints_.stands_alone(i)) continue;
    for (int k = 0; k < dimension * dimension; ++k) {
      block[std::size_t(k / dimension)][std::size_t(k % dimension)] =
          whole_.diagonal[std::size_t(i) * std::size_t(dimension * dimension) + std::size_t(k)];
    }
    add_reduced(dependences(i), dependences(i), block, true);
  }
  for_each_of_followers(whole_.pattern, constraints_, [&](Index i, Offset bond) {
    for (int r = 0; r < dimension; ++r) {
      for (int c = 0; c < dimension; ++c) {
        block[std::size_t(r)][std::size_t(c)] = whole_.entry(bond, r, c);
      }
    }
    add_reduced(dependences(i), dependences(whole_.pattern.partner[bond]), block, false);
  });
}

void ConstrainedTangent::add_reduced(const std::vector<Dependence>& a,
                                     const std::vector<Dependence>& b, const Tensor& block,
                                     bool is_diagonal) {
  const std::size_t d = std::size_t(dimension);
  for (const Dependence& left : a) {
    for (const Dependence& right : b) {
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
      // The diagonal block of a point has both orders of its dependences; a block beside it stands
      // for its transpose, too.
      if (left.master <= right.master || !is_diagonal) add(left.master, right.master, reduced);
      if (left.master == right.master && !is_diagonal) {
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
  const std::size_t d = std::size_t(dimension);
  double* to = row == column ? &diagonal[std::size_t(row) * d * d]
                             : &off_diagonal[std::size_t(place_of(pattern, std::min(row, column),
                                                                  std::max(row, column))) *
                                             d * d];
  for (std::size_t r = 0; r < d; ++r) {
    for (std::size_t c = 0; c < d; ++c) {
      *to++ += row <= column ? block[r][c] : block[c][r];
    }
  }
}

void ConstrainedTangent::add_curvature(const StateView& at) {
  const auto& sets = constraints_.rigid_sets();
  for (std::size_t k = 0; k < at.curvature.size(); ++k) {
    add(sets[k].rotation, sets[k].rotation, at.curvature[k]);
  }
}

}  // namespace peristat
