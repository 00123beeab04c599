#include "assembly/terms/collocation/make_collocation_network.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

#include "src/geometry/lattice_frame.hpp"
#include "src/neighbourhood/optimised_weights.hpp"
#include "src/neighbourhood/search.hpp"

namespace peristat {
namespace {

/// Neighbours of each point among all sites, points first and then ghosts.
struct Neighbourhoods {
  std::vector<Offset> offset;
  std::vector<Index> neighbour;
  std::vector<double> reference;
};

Neighbourhoods find_neighbourhoods(const Points& points, double horizon, int threads) {
  const auto d = std::size_t(points.dimension);
  Points all;
  all.dimension = points.dimension;
  all.spacing = points.spacing;
  all.reference = points.reference;
  all.reference.insert(all.reference.end(), points.ghosts.begin(), points.ghosts.end());
  all.volume.assign(all.reference.size() / d, 1.0);
  const Bonds near = search_bonds(all, horizon, threads);
  const Index count = points.count();
  Neighbourhoods found;
  found.offset.assign(std::size_t(count) + 1, 0);
  const auto for_each = [&](const auto& visit) {
    for (Index i = 0; i < count; ++i) {
      for (Offset pair = near.offset[i]; pair < near.offset[i + 1]; ++pair) {
        const Index j = near.partner(i, pair);
        visit(i, j);
        if (j < count) visit(j, i);
      }
    }
  };
  for_each([&](Index i, Index) { ++found.offset[std::size_t(i) + 1]; });
  for (Index i = 0; i < count; ++i) found.offset[i + 1] += found.offset[i];
  std::vector<Offset> next(found.offset.begin(), found.offset.end() - 1);
  found.neighbour.resize(std::size_t(found.offset.back()));
  // Lower partners of a point come before its upper ones, both ascending.
  for_each([&](Index i, Index j) { found.neighbour[std::size_t(next[i]++)] = j; });
  found.reference = std::move(all.reference);
  return found;
}

/// Per point, whether its states must be right: on a whole body everywhere, on a part at the points
/// that its rank owns and at their neighbours.
std::vector<char> points_with_states(const Points& points, const Bonds& bonds) {
  std::vector<char> have(points.volume.size(), char(points.owned ? 0 : 1));
  if (!points.owned) return have;
  for (Index i = 0; i < *points.owned; ++i) {
    have[std::size_t(i)] = 1;
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      have[std::size_t(bonds.partner(i, bond))] = 1;
    }
  }
  return have;
}

/// Number of the bond between two points; -1: there is none.
Offset bond_between(const Bonds& bonds, Index a, Index b) {
  if (std::max(a, b) >= bonds.points()) return -1;
  return bonds.find(a, b).value_or(-1);
}

/// Appends neighbours point by point.
class Builder {
 public:
  explicit Builder(const Points& points) : d_(std::size_t(points.dimension)) {
    network_.dimension = points.dimension;
    network_.offset.push_back(0);
    network_.missing_first.assign(points.reference.size(), 0.0);
    network_.missing_third.assign(
        points.volume.size() * std::size_t(third_moment_entries(points.dimension)), 0.0);
    network_.is_whole.assign(points.volume.size(), 1);
  }
  void add(Index neighbour, Offset bond, double share) {
    network_.neighbour.push_back(neighbour);
    network_.bond.push_back(bond);
    network_.kernel_share.push_back(share);
  }
  void add_missing(const double* xi, double share) {
    const auto i = network_.offset.size() - 1;
    network_.is_whole[i] = 0;
    double* first = &network_.missing_first[i * d_];
    double* third = &network_.missing_third[i * std::size_t(third_moment_entries(int(d_)))];
    if (d_ == 2) peristat::add_missing<2>(xi, share, first, third);
    if (d_ == 3) peristat::add_missing<3>(xi, share, first, third);
  }
  void add_place(double coordinate) { network_.places.push_back(coordinate); }
  void end_point() { network_.offset.push_back(Offset(network_.neighbour.size())); }
  [[nodiscard]] CollocationNetwork take() { return std::move(network_); }

 private:
  std::size_t d_;
  CollocationNetwork network_;
};

/// m = int K r^2 dV with K = 1/r [m^(d+1)]
double weighted_volume(int dimension, double horizon) {
  const double pi = std::numbers::pi;
  return dimension == 2 ? 2.0 / 3.0 * pi * std::pow(horizon, 3) : pi * std::pow(horizon, 4);
}

}  // namespace

MadeCollocationNetwork make_collocation_network(const Points& points, const Bonds& bonds,
                                                double horizon, int degree, int threads) {
  const Neighbourhoods near = find_neighbourhoods(points, horizon, threads);
  const std::vector<char> has_states = points_with_states(points, bonds);
  const OptimisedWeights weights =
      optimised_weights(points.dimension, horizon, degree,
                        {near.offset, near.neighbour, near.reference, has_states}, threads);
  const double m = weighted_volume(points.dimension, horizon);
  const auto d = std::size_t(points.dimension);
  Builder builder(points);
  for (Index i = 0; i < points.count(); ++i) {
    const Offset last = has_states[std::size_t(i)] ? near.offset[i + 1] : near.offset[i];
    for (Offset e = near.offset[i]; e < last; ++e) {
      const Index j = near.neighbour[std::size_t(e)];
      Coordinates xi{};
      double squared = 0.0;
      for (std::size_t c = 0; c < d; ++c) {
        xi[c] = near.reference[std::size_t(j) * d + c] - near.reference[std::size_t(i) * d + c];
        squared += xi[c] * xi[c];
      }
      const double share = weights.weight[std::size_t(e)] / (std::sqrt(squared) * m);
      const Offset bond = bond_between(bonds, i, j);
      if (bond >= 0) {
        builder.add(j, bond, share);
      } else {
        builder.add_missing(xi.data(), share);
      }
    }
    builder.end_point();
  }
  const double cell = std::pow(points.spacing, points.dimension);
  return {builder.take(), weights.negative, weights.lowest / cell, weights.lowered, weights.solves};
}

CollocationNetwork make_local_network(const Points& points, const Bonds& bonds) {
  if (!points.lattice || !points.spacing.is_square()) {
    throw std::logic_error("a local network needs a lattice of squares or cubes");
  }
  const LatticeFrame frame(points.dimension, {}, 0.0, points.spacing, points.angle);
  const double h = points.spacing, squared = h * h;
  const bool is_plane = points.dimension == 2;
  const double along_axis = is_plane ? 1.0 / (8.0 * squared) : 1.0 / (30.0 * squared);
  const double along_diagonal = is_plane ? 1.0 / (16.0 * squared) : 1.0 / (30.0 * squared);
  const Coordinates origin = frame.spacings_to(points.lattice->origin);
  const auto cell_of = [&](Index i) {
    const Coordinates at = frame.spacings_to(points.position(i));
    Cell cell{};
    for (int c = 0; c < points.dimension; ++c) cell[c] = std::llround(at[c] - origin[c]);
    return cell;
  };
  std::map<Cell, Index> point_at;
  Builder builder(points);
  for (Index i = 0; i < points.count(); ++i) {
    const Cell cell = cell_of(i);
    point_at[cell] = i;
    const Coordinates from_origin =
        frame.turned({double(cell[0]) * h, double(cell[1]) * h, double(cell[2]) * h});
    for (int c = 0; c < points.dimension; ++c) {
      builder.add_place(points.lattice->origin[c] + from_origin[c]);
    }
  }
  const int depth = is_plane ? 0 : 1;
  for (Index i = 0; i < points.count(); ++i) {
    const Cell own = cell_of(i);
    for (int x = -1; x <= 1; ++x) {
      for (int y = -1; y <= 1; ++y) {
        for (int z = -depth; z <= depth; ++z) {
          const int axes = std::abs(x) + std::abs(y) + std::abs(z);
          if (axes == 0 || axes == 3) continue;
          const double share = axes == 1 ? along_axis : along_diagonal;
          const auto found = point_at.find({own[0] + x, own[1] + y, own[2] + z});
          const Offset bond = found == point_at.end() ? -1 : bond_between(bonds, i, found->second);
          if (bond >= 0) {
            builder.add(found->second, bond, share);
          } else {
            const Coordinates xi = frame.turned({x * h, y * h, z * h});
            builder.add_missing(xi.data(), share);
          }
        }
      }
    }
    builder.end_point();
  }
  return builder.take();
}

}  // namespace peristat
