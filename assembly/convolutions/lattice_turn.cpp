#include "assembly/convolutions/lattice_turn.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>
#include <Eigen/SVD>

#include "src/dense/least_squares.hpp"

namespace peristat {
namespace {

/// Rotates the vectors of all points: R v or R^T v.
void rotate(const LatticeTurn& turn, bool is_back, int dimension, std::span<double> v) {
  if (turn.is_one) return;
  const auto d = std::size_t(dimension);
  for (std::size_t at = 0; at < v.size(); at += d) {
    std::array<double, 3> result{};
    for (std::size_t r = 0; r < d; ++r) {
      for (std::size_t c = 0; c < d; ++c) {
        result[r] += (is_back ? turn.rotation[c][r] : turn.rotation[r][c]) * v[at + c];
      }
    }
    std::copy_n(result.begin(), d, v.begin() + std::ptrdiff_t(at));
  }
}

/// The lattice's steps in the axes of the body, fitted to springs, which have both; 0 in directions
/// without a spring.
Eigen::Matrix3d cell_of(std::span<const LatticeSpring> springs) {
  Eigen::Matrix3d arms = Eigen::Matrix3d::Zero(), steps = Eigen::Matrix3d::Zero();
  for (const LatticeSpring& spring : springs) {
    const Eigen::Vector3d step(spring.step[0], spring.step[1], spring.step[2]);
    arms += Eigen::Vector3d(spring.arm.data()) * step.transpose();
    steps += step * step.transpose();
  }
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  const std::vector<double> inverse = least_squares({steps.data(), 9}, 3, {one.data(), 9});
  return arms * Eigen::Matrix3d(inverse.data());
}

/// The rotation nearest to a tensor.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& tensor) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> found(tensor, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d signs = Eigen::Matrix3d::Identity();
  signs(2, 2) = (found.matrixU() * found.matrixV().transpose()).determinant() < 0.0 ? -1.0 : 1.0;
  return found.matrixU() * signs * found.matrixV().transpose();
}

/// The same in 2D, in closed form.
Eigen::Matrix3d nearest_rotation_in_plane(const Eigen::Matrix3d& tensor) {
  const double along = tensor(0, 0) + tensor(1, 1), across = tensor(1, 0) - tensor(0, 1);
  const double length = std::hypot(along, across);
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (!(length > 0.0)) return rotation;
  rotation(0, 0) = rotation(1, 1) = along / length;
  rotation(1, 0) = across / length;
  rotation(0, 1) = -rotation(1, 0);
  return rotation;
}

}  // namespace

void LatticeTurn::take_off(int dimension, std::span<double> v) const {
  rotate(*this, true, dimension, v);
}

void LatticeTurn::put_on(int dimension, std::span<double> v) const {
  rotate(*this, false, dimension, v);
}

LatticeTurns::LatticeTurns(const LatticeBox& box, const std::array<bool, 3>& is_periodic,
                           std::span<const LatticeSpring> springs)
    : dimension_(box.dimension) {
  if (dimension_ < 2 || std::ranges::any_of(is_periodic, [](bool is) { return is; })) return;
  const Eigen::Matrix3d cell = cell_of(springs);
  for (const Index place : box.place) {
    const std::array<Index, 3> at = box.numbers(place);
    Eigen::Vector3d steps = Eigen::Vector3d::Zero();
    for (int c = 0; c < dimension_; ++c) {
      steps[c] = double(at[std::size_t(c)]) - 0.5 * double(box.extent[std::size_t(c)] - 1);
    }
    const Eigen::Vector3d from_middle = cell * steps;
    for (int c = 0; c < dimension_; ++c) places_.push_back(from_middle[c]);
    reach_ = std::max(reach_, from_middle.norm());
  }
  for (const LatticeSpring& spring : springs) {
    bond_ = std::max(bond_, Eigen::Vector3d(spring.arm.data()).norm());
  }
}

LatticeTurn LatticeTurns::find(const LatticeFields& fields, std::span<const double> u) const {
  if (places_.empty()) return {};
  const auto d = std::size_t(dimension_);
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero(), squares = Eigen::Matrix3d::Zero();
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  double sum = 0.0;
  for (std::size_t i = 0; i < fields.points(); ++i) {  // in one order: the same bits by threads
    Eigen::Vector3d place = Eigen::Vector3d::Zero(), moved = Eigen::Vector3d::Zero();
    for (std::size_t c = 0; c < d; ++c) {
      place[Eigen::Index(c)] = places_[i * d + c];
      moved[Eigen::Index(c)] = u[i * d + c];
    }
    const double q = fields.integrity(i);
    moments += q * moved * place.transpose();
    squares += q * place * place.transpose();
    mean += q * place;
    sum += q;
  }
  if (!(sum > 0.0) || !moments.allFinite()) return {};
  const Eigen::Matrix3d placed = moments + squares - mean * mean.transpose() / sum;
  const Eigen::Matrix3d rotation =
      dimension_ == 2 ? nearest_rotation_in_plane(placed) : nearest_rotation(placed);
  LatticeTurn turn;
  turn.is_one = (rotation - Eigen::Matrix3d::Identity()).norm() * reach_ < bond_;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) {
      turn.rotation[r][c] = rotation(Eigen::Index(r), Eigen::Index(c));
    }
  }
  return turn;
}

void LatticeTurns::take_off(const LatticeTurn& turn, std::span<double> u) const {
  if (turn.is_one) return;
  for (std::size_t k = 0; k < u.size(); ++k) u[k] += places_[k];
  turn.take_off(dimension_, u);
  for (std::size_t k = 0; k < u.size(); ++k) u[k] -= places_[k];
}

}  // namespace peristat
