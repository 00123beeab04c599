#include "solvers/body/body_memory.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/geometry/mesh_interior.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

namespace {

/// Environments that a step holds: of the old state, of the new one, those of differences.
constexpr double states_with_environment = 4.0;

}  // namespace

double reach_ratio(VolumeCorrection correction, HorizonShape shape, int dimension,
                   double horizon_ratio) {
  const double m = horizon_ratio * farthest_of(shape, dimension), pi = std::numbers::pi;
  if (!Kernel{.volume_correction = correction}.has_exact_shares()) return m;
  if (dimension == 1) return m + 0.5;
  if (dimension == 2) return std::sqrt((pi * m * m + 4.0 * m + 1.0) / pi);
  return std::cbrt(m * m * m + (3.0 * pi * m * m + 6.0 * m + 1.0) * 0.75 / pi);
}

double expected_bonds(double points, int dimension, double horizon_ratio) {
  // No more than there are pairs of points.
  return points * std::min(bonds_per_point(dimension, horizon_ratio), 0.5 * points);
}

bool is_small(const Points& points) { return points.count() <= 100'000; }

BodySize size_of(const Points& points) {
  BodySize size;
  size.dimension = points.dimension;
  size.points = double(points.count());
  size.free_dofs = double(points.reference.size());
  size.places = 1.0;
  for (int c = 0; c < points.dimension; ++c) {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (Index i = 0; i < points.count(); ++i) {
      const double at = points.reference[std::size_t(i) * points.dimension + c];
      least = std::min(least, at);
      most = std::max(most, at);
    }
    size.longest = std::max(size.longest, (most - least) / points.spacing + 1.0);
    size.places *= (most - least) / points.spacing.along(c) + 1.0;
  }
  return size;
}

MemoryEstimate estimate_memory(const Body& body) {
  const auto& prescribed = body.conditions->prescribed();
  BodySize size = size_of(body.points);
  size.horizon_ratio = reach_ratio(body.setting.volume_correction, body.setting.shape,
                                   body.points.dimension, body.horizon_ratio());
  size.bonds = double(body.model.bonds().count());
  const Bonds& bonds = body.model.bonds();
  size.bytes_per_bond = double(bonds.kind.bytes_per_bond()) +
                        double(bonds.partner.bytes()) / std::max(size.bonds, 1.0);
  size.has_history = body.model.has_history();
  size.has_runs =
      !is_small(body.points) && body.points.lattice && body.model.bonds().kind.are_numbered();
  const BondFailure* const failing = body.model.failing_bonds();
  // Onsets and critical stretches, as the history is kept before and after a step, and the drives.
  if (failing && failing->onsets()) {
    size.bytes_per_bond += double(4 * sizeof(double) + sizeof(BondDrive));
  }
  size.is_convolved = body.model.tangent_kind() == TangentKind::products;
  size.has_symmetric_blocks = body.model.has_symmetric_blocks();
  size.is_constrained = !body.conditions->constraints().none();
  size.free_dofs = double(std::count(prescribed.begin(), prescribed.end(), 0));
  if (!body.index_map->is_whole()) {
    size.ranks = body.index_map->ranks().count();
    size.gathered_points = body.index_map->is_first_rank() ? double(body.index_map->whole()) : 0.0;
  }
  double beside_blocks = 0.0;
  for (const auto& term : body.model.terms()) {
    const BlockCount count = term->block_count(body.points.dimension);
    size.blocks = std::max(size.blocks, count.blocks);
    beside_blocks += count.bytes_beside;
  }
  if (body.model.tangent_kind() <= TangentKind::stored &&
      formulation_of(body.specification).couples_second_neighbours) {
    size.coupling_ratio = 2.0 * size.horizon_ratio;
  }
  if (!body.model.balances().potential) {
    // Couplings reach two horizons: 2^d as many points as one.
    const double near = 2.0 * size.bonds / std::max(size.points, 1.0) + 1.0;
    size.entries_per_row =
        size.dimension * std::min(size.points, std::pow(2.0, size.dimension) * near);
  }
  MemoryEstimate estimate = estimate_memory(size);
  estimate.tangent_bytes += beside_blocks;
  for (const auto& term : body.model.terms()) estimate.body_bytes += term->stored_bytes();
  estimate.body_bytes +=
      body.specification.evaluation_bytes_per_point * double(body.points.count());
  if (body.specification.eigenstrains.are_there()) {
    estimate.body_bytes += states_with_environment * sizeof(double) * double(body.points.count());
  }
  if (const Struts* const struts = body.model.struts()) estimate.body_bytes += struts->bytes();
  if (body.points.interior) estimate.body_bytes += body.points.interior->bytes();
  return estimate;
}

}  // namespace peristat
