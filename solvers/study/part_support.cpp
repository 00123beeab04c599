#include "solvers/study/part_support.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "src/connectivity/fragments.hpp"
#include "src/connectivity/free_motion.hpp"
#include "src/connectivity/rigid_motions.hpp"
#include "src/core/input_error.hpp"

namespace peristat {
namespace {

/// Per point, the lowest number of those that bonds join it to: each rank knows its own points'
/// pieces, and ghosts tell which of them are one.
std::vector<double> lowest_joined(const Body& body) {
  const Communicator& ranks = body.part->ranks();
  const Components here = connected_components(body.model.bonds());
  const auto d = std::size_t(body.points.dimension);
  const auto count = body.points.volume.size();
  std::vector<double> lowest(count * d, double(body.part->whole()));  // of a point, the first entry
  for (std::size_t i = 0; i < body.part->number().size(); ++i) {
    lowest[i * d] = double(body.part->number()[i]);
  }
  for (double changes = 1.0; changes > 0.0;) {
    body.part->update_ghosts(lowest);
    std::vector<double> of_piece(here.size.size(), double(body.part->whole()));
    for (std::size_t i = 0; i < count; ++i) {
      double& least = of_piece[std::size_t(here.of_point[i])];
      least = std::min(least, lowest[i * d]);
    }
    bool has_changed = false;
    for (std::size_t i = 0; i < count; ++i) {
      const double least = of_piece[std::size_t(here.of_point[i])];
      has_changed = has_changed || least < lowest[i * d];
      lowest[i * d] = least;
    }
    changes = ranks.max(double(has_changed));
  }
  return lowest;
}

GlobalIndex count_pieces(const Body& body) {
  const std::vector<double> lowest = lowest_joined(body);
  const auto d = std::size_t(body.points.dimension);
  std::int64_t pieces = 0;  // whose lowest point is this rank's
  for (std::size_t i = 0; i < body.part->number().size(); ++i) {
    if (lowest[i * d] == double(body.part->number()[i])) ++pieces;
  }
  return body.part->ranks().count_all(pieces).all;
}

/// Sum of n n^T over what supports each owned point: its bonds, and prescribed components.
std::vector<Eigen::Matrix3d> supports_of(const Body& body) {
  const Points& points = body.points;
  const Bonds& bonds = body.model.bonds();
  std::vector<Eigen::Matrix3d> support(points.volume.size(), Eigen::Matrix3d::Zero());
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Coordinates from = points.position(i), to = points.position(bonds.partner[bond]);
      Eigen::Vector3d along(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
      along.normalize();
      support[std::size_t(i)] += along * along.transpose();
      support[std::size_t(bonds.partner[bond])] += along * along.transpose();
    }
  }
  const auto d = std::size_t(points.dimension);
  for (std::size_t i = 0; i < support.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) {
      const bool holds = c >= d || body.conditions->prescribed()[i * d + c];
      if (holds) support[i](Eigen::Index(c), Eigen::Index(c)) += 1.0;
    }
  }
  return support;
}

GlobalIndex count_loose_points(const Body& body) {
  const std::vector<Eigen::Matrix3d> support = supports_of(body);
  std::int64_t loose = 0;
  for (Index i = 0; i < body.part->owned(); ++i) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(support[std::size_t(i)],
                                                                Eigen::EigenvaluesOnly);
    const Eigen::Vector3d& values = solver.eigenvalues();
    if (!(values(0) > independence_tolerance * std::max(1.0, values.maxCoeff()))) ++loose;
  }
  return body.part->ranks().count_all(loose).all;
}

/// The rigid motions of a body, all of which are free; see free_rigid_motions.
RigidMotions rigid_motions_of(const Body& body) {
  const Communicator& ranks = body.part->ranks();
  const Points& points = body.points;
  const auto d = std::size_t(points.dimension);
  RigidMotions motions;
  motions.dimension = points.dimension;
  std::vector<double> sum(3, 0.0);
  for (Index i = 0; i < body.part->owned(); ++i) {
    const Coordinates at = points.position(i);
    for (std::size_t c = 0; c < d; ++c) sum[c] += at[c] / double(body.part->whole());
  }
  sum = ranks.sum(sum);
  std::copy(sum.begin(), sum.end(), motions.centre.begin());
  double size = points.spacing.largest();
  for (Index i = 0; i < body.part->owned(); ++i) {
    const Coordinates at = points.position(i);
    size = std::max(size, std::hypot(at[0] - sum[0], at[1] - sum[1], at[2] - sum[2]));
  }
  motions.size = ranks.max(size);
  motions.count = points.dimension * (points.dimension + 1) / 2;
  return motions;
}

/// How far each motion moves a point along an axis.
std::vector<double> moved_by(const RigidMotions& motions, const Coordinates& place,
                             std::size_t axis) {
  std::array<double, 3> arm{};
  for (std::size_t c = 0; c < 3; ++c) arm[c] = (place[c] - motions.centre[c]) / motions.size;
  std::vector<double> row(std::size_t(motions.count), 0.0);
  row[axis] = 1.0;
  if (motions.dimension == 2) row[2] = axis == 0 ? -arm[1] : arm[0];
  if (motions.dimension == 3) {
    row[3 + (axis + 1) % 3] = arm[(axis + 2) % 3];
    row[3 + (axis + 2) % 3] = -arm[(axis + 1) % 3];
  }
  return row;
}

/// The motions that no prescribed component hinders.
RigidMotions free_motions_of(const Body& body) {
  constexpr double rank_tolerance = 1e-10;  // as free_rigid_motions
  RigidMotions motions = rigid_motions_of(body);
  const auto d = std::size_t(body.points.dimension), n = std::size_t(motions.count);
  std::vector<double> sum(n * n, 0.0);
  for (Index i = 0; i < body.part->owned(); ++i) {
    for (std::size_t axis = 0; axis < d; ++axis) {
      if (!body.conditions->prescribed()[std::size_t(i) * d + axis]) continue;
      const std::vector<double> row = moved_by(motions, body.points.position(i), axis);
      for (std::size_t k = 0; k < n * n; ++k) sum[k] += row[k / n] * row[k % n];
    }
  }
  sum = body.part->ranks().sum(sum);
  const Eigen::Map<const Eigen::MatrixXd> held(sum.data(), Eigen::Index(n), Eigen::Index(n));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(held);
  const double largest = std::max(1.0, solver.eigenvalues().maxCoeff());
  motions.count = 0;
  for (Eigen::Index k = 0; k < Eigen::Index(n); ++k) {
    if (solver.eigenvalues()(k) > rank_tolerance * largest) continue;
    ++motions.count;
    const Eigen::VectorXd motion = solver.eigenvectors().col(k);
    motions.basis.insert(motions.basis.end(), motion.begin(), motion.end());
  }
  return motions;
}

}  // namespace

void refuse_unheld_part(const Body& body) {
  const GlobalIndex pieces = count_pieces(body);
  if (pieces > 1) {
    throw InputError("points", "",
                     fmt::format("more than one rank is for bodies of one piece so far; no bond "
                                 "joins the {} of this one",
                                 pieces));
  }
  const RigidMotions free = free_motions_of(body);
  if (free.count > 0) {
    std::string text;
    for (const std::string& name : motion_names(free)) text += (text.empty() ? "" : ", ") + name;
    throw InputError("supports", "",
                     "the supports do not hold the body: the whole body may " + text +
                         ". Prescribe displacements that prevent this");
  }
  const GlobalIndex loose = count_loose_points(body);
  if (loose == 0) return;
  throw InputError("points", "",
                   fmt::format("{} points hang on too few bonds to be held by them. Take such "
                               "points away, or give them more bonds (a larger horizon)",
                               loose));
}

}  // namespace peristat
