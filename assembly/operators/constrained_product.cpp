#include "assembly/operators/constrained_product.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "assembly/operators/constrained_row_sums.hpp"
#include "assembly/operators/convolved_tangent.hpp"
#include "src/measures/small_algebra.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

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

}  // namespace

ConstrainedProduct::ConstrainedProduct(std::unique_ptr<TangentOperator> whole, const Points& points,
                                       const Constraints& constraints, const IndexMap& index_map)
    : TangentOperator(BlockPattern::diagonal(Index(constraints.rows())), points.dimension,
                      whole->threads(), {}),
      whole_(std::move(whole)),
      points_(points),
      constraints_(constraints),
      index_map_(index_map),
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
  add_up(index_map_.ranks(), of_dofs.subspan(points_.reference.size()));
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

void ConstrainedProduct::add_block(Index i, const Tensor& block, Index j,
                                   std::vector<SharedBlock>& shared) {
  const std::vector<Dependence> of_i = constraints_.dependences(i, displacement_);
  add_to_diagonal(of_i, block, constraints_.dependences(j, displacement_));
  const auto shared_j = constraints_.shared_dependence(j);
  if (!shared_j) return;  // the row of j has the transposed block
  std::vector<Dependence> masters = constraints_.shared_followers()[shared_j->follower].masters;
  for (Dependence& on : masters) {
    for (std::size_t r = 0; r < 3; ++r) on.block[r] = scaled<3>(shared_j->factor[r], on.block[r]);
  }
  add_to_diagonal(of_i, block, masters);
  add_to_diagonal(masters, transposed(block), of_i);
  const auto shared_i = constraints_.shared_dependence(i);
  if (!shared_i) return;
  SharedBlock between{shared_i->follower, shared_j->follower, block};
  for (std::size_t k = 0; k < 9; ++k) {
    between.block[k / 3][k % 3] *= shared_i->factor[k / 3] * shared_j->factor[k % 3];
  }
  shared.push_back(between);
}

void ConstrainedProduct::add_shared_blocks(const std::vector<SharedBlock>& mine) {
  if (constraints_.shared_followers().empty()) return;
  std::vector<double> flat;
  for (const auto& [i, j, block] : mine) {
    flat.insert(flat.end(), {double(i), double(j)});
    for (const auto& row : block) flat.insert(flat.end(), row.begin(), row.end());
  }
  flat = concatenated(index_map_.ranks(), flat);
  for (std::size_t k = 0; k < flat.size(); k += 11) {
    const auto masters_of = [&](double follower) -> const std::vector<Dependence>& {
      return constraints_.shared_followers()[std::size_t(follower)].masters;
    };
    add_to_diagonal(masters_of(flat[k]), tensor_of(&flat[k + 2], 3), masters_of(flat[k + 1]));
  }
}

void ConstrainedProduct::add_blocks_between_followers(std::vector<SharedBlock>& shared) {
  const auto d = std::size_t(dimension);
  struct Pair {
    Index i, j;
    Tensor block;
  };
  std::vector<std::vector<Pair>> pairs(std::size_t(whole_->parts()));
  const BlockPattern& of = whole_->pattern;
  whole_->for_each_row([&](int part, Index i, std::span<const double> blocks) {
    const double* block = blocks.data();
    for (Offset bond = of.offset[i]; bond < of.offset[i + 1]; ++bond, block += d * d) {
      const Index j = of.partner(i, bond);
      const bool may_share = !constraints_.stands_alone(i) || !constraints_.stands_alone(j);
      if (may_share) pairs[std::size_t(part)].push_back({i, j, tensor_of(block, d)});
    }
  });
  for (const std::vector<Pair>& of_part : pairs) {
    for (const auto& [i, j, block] : of_part) {
      // Each rank adds the row of the end that it owns.
      if (points_.owns(i)) add_block(i, block, j, shared);
      if (points_.owns(j)) add_block(j, transposed(block), i, shared);
    }
  }
}

/// Where K has no rows, blocks between a point and its images (in bodies thinner than the horizon)
/// are left out.
void ConstrainedProduct::linearise(Energy& energy, const StateView& at, double projection) {
  whole_->linearise(energy, at, projection);
  displacement_.assign(at.displacement.begin(), at.displacement.end());
  curvature_.assign(at.curvature.begin(), at.curvature.end());
  std::ranges::fill(diagonal, 0.0);
  const auto d = std::size_t(dimension);
  std::vector<SharedBlock> shared;
  for (Index i = 0; i < points_.count(); ++i) {
    if (!points_.owns(i)) continue;
    add_block(i, tensor_of(&whole_->diagonal[std::size_t(i) * d * d], d), i, shared);
  }
  if (whole_->has_rows()) add_blocks_between_followers(shared);
  add_shared_blocks(shared);
  const std::size_t of_points = std::size_t(points_.count()) * d * d;
  add_up(index_map_.ranks(), std::span(diagonal).subspan(of_points));
  const auto& sets = constraints_.rigid_sets();
  for (std::size_t k = 0; k < curvature_.size(); ++k) {
    double* const to = &diagonal[std::size_t(sets[k].rotation) * d * d];
    for (std::size_t e = 0; e < d * d; ++e) to[e] += curvature_[k][e / d][e % d];
  }
}

template <class Multiply>
void ConstrainedProduct::multiply_by(const Multiply& multiply, std::span<const double> v,
                                     std::span<double> result) const {
  moved_.assign(v.begin(), v.end());
  index_map_.update_ghosts(moved_);
  constraints_.extend(displacement_, moved_);
  const std::size_t of_points = points_.reference.size();
  multiply(std::span<const double>(moved_).first(of_points), result.first(of_points));
  const auto d = std::size_t(dimension);
  for (Index i = 0; i < points_.count(); ++i) {
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

void ConstrainedProduct::multiply(std::span<const double> v, std::span<double> result) const {
  const auto multiply = [&](std::span<const double> moved, std::span<double> product) {
    whole_->multiply(moved, product);
  };
  multiply_by(multiply, v, result);
}

void ConstrainedProduct::multiply_in_single(std::span<const double> v,
                                            std::span<double> result) const {
  const auto multiply = [&](std::span<const double> moved, std::span<double> product) {
    whole_->multiply_in_single(moved, product);
  };
  multiply_by(multiply, v, result);
}

void ConstrainedProduct::for_each_row(const RowVisitor&) const {
  throw std::logic_error("a tangent of products alone has no rows to visit");
}

void ConstrainedProduct::absolute_row_sums(std::span<double> sums) const {
  bound_constrained_row_sums(*whole_, points_, constraints_, displacement_, index_map_, sums);
}

std::unique_ptr<TangentOperator> make_convolved_tangent(Energy& energy,
                                                        const Constraints& constraints) {
  auto whole = std::make_unique<ConvolvedTangent>(energy);
  if (constraints.none()) return whole;
  return std::make_unique<ConstrainedProduct>(std::move(whole), energy.points(), constraints);
}

}  // namespace peristat
