#include "assembly/operators/constrained_product.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "assembly/operators/convolved_tangent.hpp"

namespace peristat {
namespace {

Tensor tensor_of(const double* entries, std::size_t d) {
  Tensor block{};
  for (std::size_t k = 0; k < d * d; ++k) block[k / d][k % d] = entries[k];
  return block;
}

Tensor transposed(const Tensor& block) {
  Tensor result{};
  for (std::size_t k = 0; k < 9; ++k) result[k / 3][k % 3] = block[k % 3][k / 3];
  return result;
}

/// Absolute entries of a row of J, added up: of one component of a point.
double row_sum(const std::vector<Dependence>& masters, std::size_t component, std::size_t d) {
  double sum = 0.0;
  for (const Dependence& on : masters) {
    for (std::size_t c = 0; c < d; ++c) sum += std::abs(on.block[component][c]);
  }
  return sum;
}

/// L^T block R
Tensor reduced(const Tensor& left, const Tensor& block, const Tensor& right, std::size_t d) {
  Tensor result{};
  for (std::size_t m = 0; m < d; ++m) {
    for (std::size_t n = 0; n < d; ++n) {
      for (std::size_t k = 0; k < d * d; ++k) {
        result[m][n] += left[k / d][m] * block[k / d][k % d] * right[k % d][n];
      }
    }
  }
  return result;
}

}  // namespace

ConstrainedProduct::ConstrainedProduct(std::unique_ptr<TangentOperator> whole, const Points& points,
                                       const Constraints& constraints, const Sharing* sharing)
    : TangentOperator(
          BlockPattern::of_rows(std::vector<Offset>(std::size_t(constraints.rows()) + 1, 0), {}),
          points.dimension, whole->threads()),
      whole_(std::move(whole)),
      points_(points),
      constraints_(constraints),
      sharing_(sharing),
      reference_(points.reference),
      no_force_(constraints.dofs(), 0.0) {
  for (const Coordinates& handle : constraints.handles()) {
    reference_.insert(reference_.end(), handle.begin(), handle.begin() + dimension);
  }
  reference = reference_;
}

std::vector<double> ConstrainedProduct::positions() const {
  std::vector<double> at = reference_;
  for (std::size_t k = 0; k < displacement_.size(); ++k) at[k] += displacement_[k];
  return at;
}

void ConstrainedProduct::sum_handles(std::span<double> of_dofs) const {
  if (sharing_) add_up(sharing_->ranks(), of_dofs.subspan(points_.reference.size()));
}

void ConstrainedProduct::add_to_diagonal(const std::vector<Dependence>& of_i, const Tensor& block,
                                         const std::vector<Dependence>& of_j) {
  const auto d = std::size_t(dimension);
  for (const Dependence& left : of_i) {
    for (const Dependence& right : of_j) {
      if (left.master != right.master) continue;
      double* const to = &diagonal[std::size_t(left.master) * d * d];
      for (std::size_t m = 0; m < d; ++m) {
        for (std::size_t n = 0; n < d; ++n) {
          for (std::size_t k = 0; k < d * d; ++k) {
            to[m * d + n] += left.block[k / d][m] * block[k / d][k % d] * right.block[k % d][n];
          }
        }
      }
    }
  }
}

void ConstrainedProduct::add_blocks_between_followers() {
  const auto d = std::size_t(dimension);
  struct Pair {
    Index i, j;
    Tensor block;
  };
  std::vector<std::vector<Pair>> pairs(ranges.size());
  const BlockPattern& of = whole_->pattern;
  whole_->for_each_row([&](int thread, Index i, std::span<const double> blocks) {
    const double* block = blocks.data();
    for (Offset bond = of.offset[i]; bond < of.offset[i + 1]; ++bond, block += d * d) {
      const Index j = of.partner[std::size_t(bond)];
      const bool may_share = !constraints_.stands_alone(i) || !constraints_.stands_alone(j);
      if (may_share) pairs[std::size_t(thread)].push_back({i, j, tensor_of(block, d)});
    }
  });
  for (const std::vector<Pair>& of_thread : pairs) {
    for (const auto& [i, j, block] : of_thread) {
      const auto of_i = constraints_.dependences(i, displacement_),
                 of_j = constraints_.dependences(j, displacement_);
      // Each of two ranks has the row of its own end.
      if (points_.owns(i)) add_to_diagonal(of_i, block, of_j);
      if (points_.owns(j)) add_to_diagonal(of_j, transposed(block), of_i);
    }
  }
}

/// Where K has no rows, blocks between a point and its images, in bodies thinner than the horizon,
/// are left out.
void ConstrainedProduct::linearise(Energy& energy, const StateView& at, double projection) {
  whole_->linearise(energy, at, projection);
  displacement_.assign(at.displacement.begin(), at.displacement.end());
  curvature_.assign(at.curvature.begin(), at.curvature.end());
  std::ranges::fill(diagonal, 0.0);
  const auto d = std::size_t(dimension);
  for (Index i = 0; i < points_.count(); ++i) {
    if (!points_.owns(i)) continue;
    const std::vector<Dependence> masters = constraints_.dependences(i, at.displacement);
    add_to_diagonal(masters, tensor_of(&whole_->diagonal[std::size_t(i) * d * d], d), masters);
  }
  if (whole_->has_rows()) add_blocks_between_followers();
  const std::size_t of_points = std::size_t(points_.count()) * d * d;
  if (sharing_) add_up(sharing_->ranks(), std::span(diagonal).subspan(of_points));
  const auto& sets = constraints_.rigid_sets();
  for (std::size_t k = 0; k < curvature_.size(); ++k) {
    double* const to = &diagonal[std::size_t(sets[k].rotation) * d * d];
    for (std::size_t e = 0; e < d * d; ++e) to[e] += curvature_[k][e / d][e % d];
  }
}

void ConstrainedProduct::multiply(std::span<const double> v, std::span<double> result) const {
  moved_.assign(v.begin(), v.end());
  if (sharing_) sharing_->update_ghosts(moved_);
  constraints_.extend(displacement_, moved_);
  const std::size_t of_points = points_.reference.size();
  whole_->multiply(std::span<const double>(moved_).first(of_points), result.first(of_points));
  const auto d = std::size_t(dimension);
  for (Index i = 0; sharing_ && i < points_.count(); ++i) {
    if (!points_.owns(i)) std::fill_n(result.begin() + std::ptrdiff_t(i) * dimension, d, 0.0);
  }
  constraints_.fold(displacement_, no_force_, result);
  sum_handles(result);
  const auto& sets = constraints_.rigid_sets();
  for (std::size_t k = 0; k < curvature_.size(); ++k) {
    const std::size_t first = std::size_t(sets[k].rotation) * d;
    for (std::size_t e = 0; e < d * d; ++e) {
      result[first + e / d] += curvature_[k][e / d][e % d] * moved_[first + e % d];
    }
  }
  const std::vector<char>& follows = constraints_.dependent();
  for (std::size_t k = 0; k < follows.size(); ++k) {
    if (follows[k]) result[k] = 0.0;
  }
}

void ConstrainedProduct::for_each_row(const RowVisitor&) const {
  throw std::logic_error("a tangent of products alone has no rows to visit");
}

void ConstrainedProduct::absolute_row_sums(std::span<double> sums) const {
  std::ranges::fill(sums, 0.0);
  whole_->absolute_row_sums(sums.first(points_.reference.size()));
  if (whole_->has_rows()) return replace_merged_rows(sums);
  const auto d = std::size_t(dimension);
  double most = 1.0;
  for (Index i = 0; i < points_.count(); ++i) {
    if (constraints_.stands_alone(i)) continue;
    const std::vector<Dependence> masters = constraints_.dependences(i, displacement_);
    std::array<double, 3> of_point{};
    for (std::size_t c = 0; c < d; ++c) {
      most = std::max(most, row_sum(masters, c, d));
      of_point[c] = std::exchange(sums[std::size_t(i) * d + c], 0.0);
    }
    for (const Dependence& on : masters) {
      for (std::size_t k = 0; k < d * d; ++k) {
        sums[std::size_t(on.master) * d + k % d] +=
            std::abs(on.block[k / d][k % d]) * of_point[k / d];
      }
    }
  }
  for (double& sum : sums) sum *= most;
}

std::vector<ConstrainedProduct::Block> ConstrainedProduct::added_up(std::vector<Block> blocks) {
  const auto place = [](const Block& block) { return std::pair(block.row, block.column); };
  std::ranges::stable_sort(blocks, {}, place);
  std::vector<Block> sums;
  for (const Block& block : blocks) {
    if (sums.empty() || place(sums.back()) != place(block)) {
      sums.push_back(block);
      continue;
    }
    for (std::size_t k = 0; k < 9; ++k) {
      sums.back().entries[k / 3][k % 3] += block.entries[k / 3][k % 3];
    }
  }
  return sums;
}

std::vector<char> ConstrainedProduct::merged_rows() const {
  std::vector<char> is_merged(std::size_t(constraints_.rows()), 0);
  std::fill(is_merged.begin() + points_.count(), is_merged.end(), char(1));
  const auto mark = [&](Index i) {
    for (const Dependence& on : constraints_.dependences(i, displacement_)) {
      is_merged[std::size_t(on.master)] = 1;
    }
  };
  const BlockPattern& of = whole_->pattern;
  for (Index i = 0; i < points_.count(); ++i) {
    const bool is_alone = constraints_.stands_alone(i);
    if (!is_alone) mark(i);
    for (const Index j : of.of(i)) {
      if (is_alone == constraints_.stands_alone(j)) continue;
      is_merged[std::size_t(is_alone ? i : j)] = 1;
    }
  }
  return is_merged;
}

std::vector<ConstrainedProduct::Block> ConstrainedProduct::merged_blocks(
    const std::vector<char>& is_merged) const {
  const auto d = std::size_t(dimension);
  std::vector<std::vector<Block>> of_threads(ranges.size());
  const auto add = [&](std::vector<Block>& blocks, Index i, const Tensor& block, Index j) {
    if (!points_.owns(i)) return;
    for (const Dependence& left : constraints_.dependences(i, displacement_)) {
      if (!is_merged[std::size_t(left.master)]) continue;
      for (const Dependence& right : constraints_.dependences(j, displacement_)) {
        // The rank that owns a point has its block beside a handle.
        if (left.master >= points_.count() && right.master < points_.count()) continue;
        blocks.push_back({left.master, right.master, reduced(left.block, block, right.block, d)});
      }
    }
  };
  const auto may_merge = [&](Index i) {
    return !constraints_.stands_alone(i) || is_merged[std::size_t(i)];
  };
  const BlockPattern& of = whole_->pattern;
  whole_->for_each_row([&](int thread, Index i, std::span<const double> blocks) {
    std::vector<Block>& found = of_threads[std::size_t(thread)];
    const double* block = blocks.data();
    for (Offset bond = of.offset[i]; bond < of.offset[i + 1]; ++bond, block += d * d) {
      const Index j = of.partner[std::size_t(bond)];
      const Tensor of_bond = tensor_of(block, d);
      if (may_merge(i)) add(found, i, of_bond, j);
      if (may_merge(j)) add(found, j, transposed(of_bond), i);
    }
  });
  std::vector<Block> all;
  for (const auto& found : of_threads) all.insert(all.end(), found.begin(), found.end());
  for (Index i = 0; i < points_.count(); ++i) {
    if (may_merge(i)) add(all, i, tensor_of(&whole_->diagonal[std::size_t(i) * d * d], d), i);
  }
  return all;
}

std::vector<ConstrainedProduct::Block> ConstrainedProduct::of_all(
    const std::vector<Block>& mine) const {
  if (!sharing_) return mine;
  // Ranks have other numbers of points before the handles.
  const double first = double(points_.count());
  std::vector<double> flat;
  for (const Block& block : mine) {
    flat.insert(flat.end(), {double(block.row) - first, double(block.column) - first});
    for (const auto& row : block.entries) flat.insert(flat.end(), row.begin(), row.end());
  }
  std::vector<Block> all;
  flat = all_together(sharing_->ranks(), flat);
  for (auto next = flat.begin(); next != flat.end(); next += 11) {
    Block& block = all.emplace_back();
    block.row = Index(next[0] + first);
    block.column = Index(next[1] + first);
    for (std::size_t k = 0; k < 9; ++k) {
      block.entries[k / 3][k % 3] = next[2 + std::ptrdiff_t(k)];
    }
  }
  return all;
}

void ConstrainedProduct::replace_merged_rows(std::span<double> sums) const {
  const auto d = std::size_t(dimension);
  const std::vector<char> is_merged = merged_rows();
  for (std::size_t dof = 0; dof < sums.size(); ++dof) {
    const auto row = Index(dof / d);
    const bool is_plain =
        row < points_.count() && points_.owns(row) && constraints_.stands_alone(row);
    if (!is_plain || is_merged[std::size_t(row)]) sums[dof] = 0.0;
  }
  std::vector<Block> blocks = merged_blocks(is_merged), between_handles;
  std::erase_if(blocks, [&](const Block& block) {
    const bool is_between = block.row >= points_.count() && block.column >= points_.count();
    if (is_between) between_handles.push_back(block);
    return is_between;
  });
  for (const Block& block : added_up(std::move(blocks))) {
    for (std::size_t k = 0; k < d * d; ++k) {
      const double entry = std::abs(block.entries[k / d][k % d]);
      sums[std::size_t(block.row) * d + k / d] += entry;
      if (block.column < points_.count()) continue;
      sums[std::size_t(block.column) * d + k % d] += entry;
    }
  }
  sum_handles(sums);
  const auto& sets = constraints_.rigid_sets();
  between_handles = of_all(added_up(std::move(between_handles)));
  for (std::size_t k = 0; k < curvature_.size(); ++k) {
    between_handles.push_back({sets[k].rotation, sets[k].rotation, curvature_[k]});
  }
  for (const Block& block : added_up(std::move(between_handles))) {
    for (std::size_t k = 0; k < d * d; ++k) {
      sums[std::size_t(block.row) * d + k / d] += std::abs(block.entries[k / d][k % d]);
    }
  }
}

std::unique_ptr<TangentOperator> make_convolved_tangent(Energy& energy,
                                                        const Constraints& constraints) {
  auto whole = std::make_unique<ConvolvedTangent>(energy);
  if (constraints.none()) return whole;
  return std::make_unique<ConstrainedProduct>(std::move(whole), energy.points(), constraints);
}

}  // namespace peristat
