#include "assembly/operators/constrained_row_sums.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {
namespace {

/// Sum of the absolute entries of a row of J, that of one component of a point.
double row_sum(const std::vector<Dependence>& masters, std::size_t component, std::size_t d) {
  double sum = 0.0;
  for (const Dependence& on : masters) {
    for (std::size_t c = 0; c < d; ++c) sum += std::abs(on.block[component][c]);
  }
  return sum;
}

/// Distributes a point's row sums of K among its masters by |J|.
void add_row_sums(const std::vector<Dependence>& masters, std::span<const double> of_point,
                  std::size_t d, std::span<double> sums) {
  for (const Dependence& on : masters) {
    for (std::size_t k = 0; k < d * d; ++k) {
      sums[std::size_t(on.master) * d + k % d] +=
          std::abs(on.block[k / d][k % d]) * of_point[k / d];
    }
  }
}

/// Sums of |J| over the masters of all ranks, for each component of the shared followers.
/// Collective.
std::vector<double> row_sums_of_shared(const Constraints& constraints, std::size_t d,
                                       const IndexMap& index_map) {
  std::vector<double> of_rows;
  for (const auto& follower : constraints.shared_followers()) {
    for (std::size_t c = 0; c < 3; ++c) of_rows.push_back(row_sum(follower.masters, c, d));
  }
  add_up(index_map.ranks(), of_rows);
  return of_rows;
}

/// |J| 1, per degree of freedom of the points.
std::vector<double> absolute_followings(const Points& points, const Constraints& constraints,
                                        std::span<const double> displacement,
                                        const IndexMap& index_map) {
  std::vector<double> result(points.reference.size(), 1.0);
  const auto d = std::size_t(points.dimension);
  const std::vector<double> of_shared = row_sums_of_shared(constraints, d, index_map);
  for (Index i = 0; i < points.count(); ++i) {
    if (constraints.stands_alone(i)) continue;
    const std::vector<Dependence> masters = constraints.dependences(i, displacement);
    const auto shared = constraints.shared_dependence(i);
    for (std::size_t c = 0; c < d; ++c) {
      double& of_row = result[std::size_t(i) * d + c];
      of_row = row_sum(masters, c, d);
      if (shared) of_row += std::abs(shared->factor[c]) * of_shared[3 * shared->follower + c];
    }
  }
  return result;
}

/// |K| |J| 1
void multiply_absolute(const TangentOperator& whole, std::span<const double> followings,
                       std::span<double> result) {
  if (whole.has_rows()) {
    whole.multiply_absolute(followings, result);
    return;
  }
  whole.absolute_row_sums(result);
  const double most = *std::ranges::max_element(followings);
  for (double& sum : result) sum *= most;
}

}  // namespace

void bound_constrained_row_sums(const TangentOperator& whole, const Points& points,
                                const Constraints& constraints,
                                std::span<const double> displacement, const IndexMap& index_map,
                                std::span<double> sums) {
  std::ranges::fill(sums, 0.0);
  const std::size_t of_points = points.reference.size();
  multiply_absolute(whole, absolute_followings(points, constraints, displacement, index_map),
                    sums.first(of_points));
  const auto d = std::size_t(points.dimension);
  const auto& all_shared = constraints.shared_followers();
  std::vector<double> of_shared(3 * all_shared.size(), 0.0);
  for (Index i = 0; i < points.count(); ++i) {
    if (!points.owns(i)) std::fill_n(sums.begin() + std::ptrdiff_t(i) * points.dimension, d, 0.0);
    if (constraints.stands_alone(i)) continue;
    const auto shared = constraints.shared_dependence(i);
    std::array<double, 3> of_point{};
    for (std::size_t c = 0; c < d; ++c) {
      of_point[c] = std::exchange(sums[std::size_t(i) * d + c], 0.0);
      if (!shared) continue;
      of_shared[3 * shared->follower + c] += std::abs(shared->factor[c]) * of_point[c];
    }
    add_row_sums(constraints.dependences(i, displacement), of_point, d, sums);
  }
  add_up(index_map.ranks(), of_shared);
  for (std::size_t k = 0; k < all_shared.size(); ++k) {
    add_row_sums(all_shared[k].masters, std::span(of_shared).subspan(3 * k, 3), d, sums);
  }
  add_up(index_map.ranks(), sums.subspan(of_points));
}

}  // namespace peristat
