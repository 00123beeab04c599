#include "src/conditions/free_motion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

#include <Eigen/Dense>

namespace peristat {
namespace {

/// Eigenvalues below this fraction of the largest count as zero: motions of the size of round-off.
constexpr double rank_tolerance = 1e-10;

/// Columns: the rigid motions of a point at `arm` from the centre, translations first, then
/// rotations about x, y, z (2D: about z), scaled by 1 / size so that all entries are of order one.
Eigen::MatrixXd rigid_motions(const Eigen::Vector3d& arm, int dimension, double size) {
  if (dimension == 1) return Eigen::MatrixXd::Identity(1, 1);
  const Eigen::Vector3d a = arm / size;
  if (dimension == 2) {
    Eigen::MatrixXd motion(2, 3);
    motion << 1, 0, -a.y(), 0, 1, a.x();
    return motion;
  }
  Eigen::MatrixXd motion(3, 6);
  motion << 1, 0, 0, 0, a.z(), -a.y(),  //
      0, 1, 0, -a.z(), 0, a.x(),        //
      0, 0, 1, a.y(), -a.x(), 0;
  return motion;
}

/// Orthonormal basis of the vectors that a positive semi-definite matrix maps to zero (or, with
/// `complement`, of the others).
Eigen::MatrixXd null_space(const Eigen::MatrixXd& matrix, double scale, bool complement = false) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
  std::vector<Eigen::Index> columns;
  for (Eigen::Index k = 0; k < matrix.cols(); ++k) {
    const bool zero = solver.eigenvalues()(k) <= rank_tolerance * scale;
    if (zero != complement) columns.push_back(k);
  }
  return solver.eigenvectors()(Eigen::all, columns);
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
  const Eigen::MatrixXd projector = span * span.transpose();
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

std::vector<std::string> motion_names(const Eigen::MatrixXd& free, int dimension) {
  std::vector<std::string> names;
  const Eigen::MatrixXd rotation = free.bottomRows(free.rows() - dimension);
  // Combinations of free motions without rotation are free translations.
  Eigen::MatrixXd still = Eigen::MatrixXd::Identity(free.cols(), free.cols());
  if (rotation.rows() > 0) still = null_space(rotation.transpose() * rotation, 1.0);
  if (still.cols() > 0) {
    Eigen::MatrixXd translation = free.topRows(dimension) * still;
    for (const std::string& name : direction_names(translation)) {
      names.push_back("move along " + name);
    }
  }
  if (rotation.rows() == 1) {
    if (rotation.norm() > 1e-6) names.push_back("rotate about z");
  } else if (rotation.rows() == 3) {
    const Eigen::MatrixXd axes = null_space(rotation * rotation.transpose(), 1.0, true);
    if (axes.cols() > 0) {
      for (const std::string& name : direction_names(axes)) {
        names.push_back("rotate about " + name);
      }
    }
  }
  return names;
}

std::vector<std::string> motions_of(const Points& points, const std::vector<Index>& members,
                                    const std::vector<char>& prescribed) {
  const int d = points.dimension;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (Index i : members) {
    const Coordinates at = points.position(i);
    centre += Eigen::Vector3d(at[0], at[1], at[2]);
  }
  centre /= double(members.size());
  double size = points.spacing;
  for (Index i : members) {
    const Coordinates at = points.position(i);
    size = std::max(size, (Eigen::Vector3d(at[0], at[1], at[2]) - centre).norm());
  }
  const Eigen::Index modes = d * (d + 1) / 2;
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(modes, modes);
  Eigen::MatrixXd held = Eigen::MatrixXd::Zero(modes, modes);
  for (Index i : members) {
    const Coordinates at = points.position(i);
    const Eigen::MatrixXd motion =
        rigid_motions(Eigen::Vector3d(at[0], at[1], at[2]) - centre, d, size);
    gram += motion.transpose() * motion;
    for (int c = 0; c < d; ++c) {
      if (prescribed[std::size_t(i) * d + c]) held += motion.row(c).transpose() * motion.row(c);
    }
  }
  // A straight row of points does not move when it turns about itself: such motions do not count.
  const Eigen::MatrixXd moving = null_space(gram, double(members.size()), true);
  const Eigen::MatrixXd free = moving * null_space(moving.transpose() * held * moving, 1.0);
  return free.cols() > 0 ? motion_names(free, d) : std::vector<std::string>{};
}

}  // namespace

Components connected_components(const Bonds& bonds) {
  std::vector<Index> parent(bonds.points());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](Index i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (Index i = 0; i < bonds.points(); ++i) {
    for (Offset bond = bonds.offset[i]; bond < bonds.offset[i + 1]; ++bond) {
      const Index a = root(i), b = root(bonds.partner[bond]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  Components components;
  components.of_point.resize(parent.size());
  for (Index i = 0; i < bonds.points(); ++i) {
    const Index top = root(i);
    if (top == i) {
      components.of_point[i] = static_cast<Index>(components.size.size());
      components.size.push_back(0);
    } else {
      components.of_point[i] = components.of_point[top];
    }
    ++components.size[components.of_point[i]];
  }
  return components;
}

std::vector<FreeMotion> free_motions(const Points& points, const Bonds& bonds,
                                     const std::vector<char>& prescribed) {
  const Components components = connected_components(bonds);
  std::vector<std::vector<Index>> members(components.size.size());
  for (Index i = 0; i < points.count(); ++i) members[components.of_point[i]].push_back(i);
  std::vector<FreeMotion> result;
  for (const std::vector<Index>& component : members) {
    std::vector<std::string> motions = motions_of(points, component, prescribed);
    if (motions.empty()) continue;
    result.push_back({static_cast<Index>(component.size()), component.front(), std::move(motions)});
  }
  std::stable_sort(result.begin(), result.end(),
                   [](const FreeMotion& a, const FreeMotion& b) { return a.points > b.points; });
  return result;
}

}  // namespace peristat
