#include "assembly/terms/contact/local_block.hpp"

#include <algorithm>

#include <Eigen/Eigenvalues>

namespace peristat {

std::size_t LocalBlock::place(Index point) {
  const auto found = std::ranges::find(point_, point);
  if (found != point_.end()) return std::size_t(found - point_.begin());
  const std::size_t before = order();
  point_.push_back(point);
  std::vector<double> larger(order() * order(), 0.0);
  for (std::size_t r = 0; r < before; ++r) {
    std::copy_n(&entry_[r * before], before, &larger[r * order()]);
  }
  entry_.swap(larger);
  return point_.size() - 1;
}

void LocalBlock::project(double share) {
  if (share == 0.0) return;
  using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const auto size = Eigen::Index(order());
  Eigen::Map<Matrix> exact(entry_.data(), size, size);
  const Eigen::SelfAdjointEigenSolver<Matrix> solver(exact);
  const Eigen::VectorXd lost = solver.eigenvalues().cwiseMin(0.0);
  exact -= share * solver.eigenvectors() * lost.asDiagonal() * solver.eigenvectors().transpose();
}

void LocalBlock::add_to(Tangent& tangent, const BlockPattern& pattern) const {
  const std::size_t d = dimension_;
  std::vector<double> block(d * d);
  for (std::size_t a = 0; a < point_.size(); ++a) {
    for (std::size_t b = 0; b < point_.size(); ++b) {
      if (point_[a] > point_[b]) continue;
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) block[r * d + c] = entry(a * d + r, b * d + c);
      }
      if (a == b) {
        double* const own = &tangent.diagonal[std::size_t(point_[a]) * d * d];
        for (std::size_t k = 0; k < d * d; ++k) own[k] += block[k];
      } else {
        tangent.add_to_block(place_of_contact(pattern, point_[a], point_[b]), block);
      }
    }
  }
}

void LocalBlock::add_product(std::span<const double> v, std::span<double> product) const {
  const std::size_t d = dimension_;
  for (std::size_t a = 0; a < point_.size(); ++a) {
    for (std::size_t b = 0; b < point_.size(); ++b) {
      for (std::size_t r = 0; r < d; ++r) {
        for (std::size_t c = 0; c < d; ++c) {
          product[std::size_t(point_[a]) * d + r] +=
              entry(a * d + r, b * d + c) * v[std::size_t(point_[b]) * d + c];
        }
      }
    }
  }
}

}  // namespace peristat
