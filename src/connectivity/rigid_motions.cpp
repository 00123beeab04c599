#include "src/connectivity/rigid_motions.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <Eigen/Core>

#include "src/dense/symmetric_spectrum.hpp"
#include "src/measures/small_algebra.hpp"

namespace peristat {
namespace {

/// Eigenvalues below this fraction of the largest count as zero: motions of the size of round-off.
constexpr double rank_tolerance = 1e-10;

// Matrix products are lazy ones: sizes are at most 6 x 6, and Eigen's others take seconds to
// compile.

/// Motions of one point: at most 3 x 6, without a heap.
using PointMotions = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 6>;

Eigen::Vector3d vector_of(std::span<const double> positions, Index point, int dimension) {
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  for (int c = 0; c < dimension; ++c) at(c) = positions[std::size_t(point) * dimension + c];
  return at;
}

/// Columns: the rigid motions of a point at `arm` from the centre, translations first, then
/// rotations about x, y, z (2D: about z), scaled by 1 / size so that all entries are of order one.
PointMotions rigid_motions(const Eigen::Vector3d& arm, int dimension, double size) {
  if (dimension == 1) return PointMotions::Identity(1, 1);
  const Eigen::Vector3d a = arm / size;
  if (dimension == 2) {
    PointMotions motion(2, 3);
    motion << 1, 0, -a.y(), 0, 1, a.x();
    return motion;
  }
  PointMotions motion(3, 6);
  motion << 1, 0, 0, 0, a.z(), -a.y(),  //
      0, 1, 0, -a.z(), 0, a.x(),        //
      0, 0, 1, a.y(), -a.x(), 0;
  return motion;
}

/// A held motion as a row over the motions about a centre of rigid_motions, normalised.
Eigen::RowVectorXd row_of(const HeldMotion& motion, const Eigen::Vector3d& centre, int dimension,
                          double size) {
  const Coordinates from_centre{centre.x(), centre.y(), centre.z()};
  const Coordinates about =  // r is about the centre
      scaled<3>(1.0 / size, minus<3>(motion.about, cross(from_centre, motion.along)));
  Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(dimension * (dimension + 1) / 2);
  for (int c = 0; c < dimension; ++c) row(c) = motion.along[std::size_t(c)];
  if (dimension == 2) row(2) = about[2];
  for (int c = 0; dimension == 3 && c < 3; ++c) row(3 + c) = about[std::size_t(c)];
  const double norm = row.norm();
  return norm > 0.0 ? Eigen::RowVectorXd(row / norm) : row;
}

/// Orthonormal basis of the vectors that a positive semi-definite matrix maps to zero (or, with
/// `complement`, of the others).
Eigen::MatrixXd null_space(const Eigen::MatrixXd& matrix, double scale, bool complement = false) {
  const SymmetricModes modes =
      symmetric_modes({matrix.data(), std::size_t(matrix.size())}, int(matrix.cols()));
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
    const bool zero = modes.values[std::size_t(k)] <= rank_tolerance * scale;
    if (zero != complement) columns.push_back(k);
  }
  return Eigen::Map<const Eigen::MatrixXd>(modes.vectors.data(), matrix.rows(), matrix.cols())(
      Eigen::all, columns);
}

std::string direction_name(const Eigen::VectorXd& direction) {
  for (Eigen::Index c = 0; c < direction.size(); ++c) {
    if (std::abs(std::abs(direction(c)) - 1.0) < 1e-6) return std::string(1, "xyz"[c]);
  }
  char text[80];
  std::snprintf(text, sizeof text, "(%.2g, %.2g, %.2g)", direction(0), direction(1),
                direction.size() > 2 ? direction(2) : 0.0);
  return text;
}

/// Directions spanning the columns, along the axes where possible.
std::vector<std::string> direction_names(const Eigen::MatrixXd& span) {
  std::vector<std::string> names;
  const Eigen::MatrixXd projector = span.lazyProduct(span.transpose());
  Eigen::MatrixXd rest = projector;
  for (Eigen::Index c = 0; c < span.rows(); ++c) {
    if (std::abs(projector(c, c) - 1.0) > 1e-6) continue;
    names.push_back(std::string(1, "xyz"[c]));
    rest(c, c) -= 1.0;
  }
  const Eigen::MatrixXd others = null_space(rest, 1.0, true);
  for (Eigen::Index k = 0; k < others.cols(); ++k) names.push_back(direction_name(others.col(k)));
  return names;
}

Eigen::Map<const Eigen::MatrixXd> basis_of(const RigidMotions& motions) {
  const int d = motions.dimension;
  return {motions.basis.data(), d * (d + 1) / 2, motions.count};
}

}  // namespace

RigidMotions free_rigid_motions(int dimension, std::span<const double> positions,
                                std::span<const Index> members, const std::vector<char>& prescribed,
                                double smallest_size, std::span<const HeldMotion> held_motions) {
  const int d = dimension;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (Index i : members) centre += vector_of(positions, i, d);
  centre /= double(members.size());
  double size = smallest_size;
  for (Index i : members) size = std::max(size, (vector_of(positions, i, d) - centre).norm());
  const RigidMotions about{d, {centre.x(), centre.y(), centre.z()}, size, 0, {}};
  MotionSums sums(d);
  for (Index i : members) {
    Coordinates place{};
    for (int c = 0; c < d; ++c) place[std::size_t(c)] = positions[std::size_t(i) * d + c];
    add_point(about, place, std::span(prescribed).subspan(std::size_t(i) * d, std::size_t(d)),
              sums);
  }
  for (const HeldMotion& motion : held_motions) {
    if (std::binary_search(members.begin(), members.end(), motion.member)) {
      add_held(about, motion, sums);
    }
  }
  return free_rigid_motions(about, sums);
}

void add_held(const RigidMotions& about, const HeldMotion& motion, MotionSums& sums) {
  const Eigen::Index modes = about.dimension * (about.dimension + 1) / 2;
  Eigen::Map<Eigen::MatrixXd> held(sums.held.data(), modes, modes);
  const Eigen::Vector3d centre(about.centre[0], about.centre[1], about.centre[2]);
  const Eigen::RowVectorXd row = row_of(motion, centre, about.dimension, about.size);
  held += row.transpose() * row;
}

void add_point(const RigidMotions& about, const Coordinates& place,
               std::span<const char> prescribed, MotionSums& sums) {
  const int d = about.dimension;
  const Eigen::Index modes = d * (d + 1) / 2;
  Eigen::Map<Eigen::MatrixXd> moving(sums.moving.data(), modes, modes),
      held(sums.held.data(), modes, modes);
  const Eigen::Vector3d arm(place[0] - about.centre[0], place[1] - about.centre[1],
                            place[2] - about.centre[2]);
  const PointMotions motion = rigid_motions(arm, d, about.size);
  moving.noalias() += motion.transpose() * motion;
  for (int c = 0; c < d; ++c) {
    if (prescribed[std::size_t(c)]) held += motion.row(c).transpose() * motion.row(c);
  }
  sums.points += 1.0;
}

RigidMotions free_rigid_motions(const RigidMotions& about, const MotionSums& sums) {
  const Eigen::Index modes = about.dimension * (about.dimension + 1) / 2;
  const Eigen::Map<const Eigen::MatrixXd> gram(sums.moving.data(), modes, modes),
      held(sums.held.data(), modes, modes);
  // A straight row of points does not move in a rotation about itself: such motions are left out.
  const Eigen::MatrixXd moving = null_space(gram, sums.points, true);
  const Eigen::MatrixXd resisted = moving.transpose().lazyProduct(held);
  const Eigen::MatrixXd free = moving.lazyProduct(null_space(resisted.lazyProduct(moving), 1.0));
  return {about.dimension, about.centre, about.size, static_cast<int>(free.cols()),
          std::vector<double>(free.data(), free.data() + free.size())};
}

std::vector<double> moved_by(const RigidMotions& motions, const Coordinates& place, int axis) {
  const Eigen::Vector3d arm(place[0] - motions.centre[0], place[1] - motions.centre[1],
                            place[2] - motions.centre[2]);
  const Eigen::RowVectorXd row =
      rigid_motions(arm, motions.dimension, motions.size).row(axis) * basis_of(motions);
  return {row.begin(), row.end()};
}

std::vector<double> moved_by(const RigidMotions& motions, const FreeHandle& handle) {
  const Eigen::Vector3d centre(motions.centre[0], motions.centre[1], motions.centre[2]);
  const Eigen::RowVectorXd row =
      row_of(handle.moved_by, centre, motions.dimension, motions.size) * basis_of(motions);
  return {row.begin(), row.end()};
}

std::vector<std::string> motion_names(const RigidMotions& motions) {
  const int dimension = motions.dimension;
  const Eigen::MatrixXd free = basis_of(motions);
  std::vector<std::string> names;
  const Eigen::MatrixXd rotation = free.bottomRows(free.rows() - dimension);
  // Combinations of free motions without rotation are free translations.
  Eigen::MatrixXd still = Eigen::MatrixXd::Identity(free.cols(), free.cols());
  if (rotation.rows() > 0) still = null_space(rotation.transpose().lazyProduct(rotation), 1.0);
  if (still.cols() > 0) {
    const Eigen::MatrixXd translation = free.topRows(dimension).lazyProduct(still);
    for (const std::string& name : direction_names(translation)) {
      names.push_back("move along " + name);
    }
  }
  if (rotation.rows() == 1) {
    if (rotation.norm() > 1e-6) names.push_back("rotate about z");
  } else if (rotation.rows() == 3) {
    const Eigen::MatrixXd axes = null_space(rotation.lazyProduct(rotation.transpose()), 1.0, true);
    if (axes.cols() > 0) {
      for (const std::string& name : direction_names(axes)) {
        names.push_back("rotate about " + name);
      }
    }
  }
  return names;
}

std::vector<std::size_t> determinate_pins(const RigidMotions& motions,
                                          std::span<const double> positions,
                                          std::span<const Index> members,
                                          const std::vector<char>& prescribed,
                                          std::span<const FreeHandle> handles) {
  if (motions.count == 0) return {};
  const int d = motions.dimension;
  const Eigen::Vector3d centre(motions.centre[0], motions.centre[1], motions.centre[2]);
  std::vector<std::size_t> dofs;
  for (Index i : members) {
    for (int c = 0; c < d; ++c) {
      const std::size_t dof = std::size_t(i) * d + c;
      if (!prescribed[dof]) dofs.push_back(dof);
    }
  }
  // Rows: how the free motions move each degree of freedom.
  const Eigen::Index of_points = static_cast<Eigen::Index>(dofs.size());
  std::vector<HeldMotion> of_handles;
  for (const FreeHandle& handle : handles) {
    if (!std::binary_search(members.begin(), members.end(), handle.moved_by.member)) continue;
    dofs.push_back(handle.dof);
    of_handles.push_back(handle.moved_by);
  }
  Eigen::MatrixXd rows(static_cast<Eigen::Index>(dofs.size()), motions.count);
  for (Eigen::Index k = of_points; k < rows.rows(); ++k) {
    rows.row(k) =
        row_of(of_handles[std::size_t(k - of_points)], centre, d, motions.size) * basis_of(motions);
  }
  for (Eigen::Index k = 0; k < of_points; ++k) {
    const std::size_t dof = dofs[std::size_t(k)];
    const Eigen::Vector3d arm = vector_of(positions, static_cast<Index>(dof / d), d) - centre;
    rows.row(k) =
        rigid_motions(arm, d, motions.size).row(Eigen::Index(dof % d)) * basis_of(motions);
  }
  // Gram-Schmidt with pivots: a pinned row is projected out of all rows.
  std::vector<std::size_t> pins;
  for (int pin = 0; pin < motions.count; ++pin) {
    Eigen::Index most = 0;
    for (Eigen::Index k = 1; k < rows.rows(); ++k) {
      if (rows.row(k).norm() > (1.0 + alike_displacements) * rows.row(most).norm()) most = k;
    }
    if (rows.rows() == 0 || !(rows.row(most).norm() > displacement_at_rest)) break;
    pins.push_back(dofs[std::size_t(most)]);
    const Eigen::RowVectorXd direction = rows.row(most).normalized();
    rows -= ((rows * direction.transpose()) * direction).eval();
  }
  return pins;
}

}  // namespace peristat
