#include "src/connectivity/fragments.hpp"

#include <algorithm>
#include <cstddef>
#include <set>
#include <utility>

#include <Eigen/Dense>

#include "src/connectivity/free_motion.hpp"
#include "src/connectivity/rigid_motions.hpp"

namespace peristat {
namespace {

/// The unbroken bonds of a body in its present state.
class Web {
 public:
  Web(const Bonds& bonds, std::span<const char> broken, int dimension,
      std::vector<double> positions)
      : bonds_(bonds), broken_(broken), dimension_(dimension), positions_(std::move(positions)) {}

  [[nodiscard]] int dimension() const { return dimension_; }
  [[nodiscard]] const std::vector<double>& positions() const { return positions_; }

  /// visit(i, j, bond), i < j, for every unbroken bond.
  template <class Visit>
  void for_each_bond(const Visit& visit) const {
    for (Index i = 0; i < bonds_.points(); ++i) for_each_above(i, visit);
  }

  /// Makes for_each_partner ready.
  void find_lower_partners() {
    lower_offset_.assign(std::size_t(bonds_.points()) + 1, 0);
    for_each_bond([&](Index, Index j, Offset) { ++lower_offset_[std::size_t(j) + 1]; });
    for (Index i = 0; i < bonds_.points(); ++i) lower_offset_[i + 1] += lower_offset_[i];
    lower_partner_.resize(std::size_t(lower_offset_.back()));
    std::vector<Offset> end(lower_offset_.begin(), lower_offset_.end() - 1);
    for_each_bond([&](Index i, Index j, Offset) { lower_partner_[end[j]++] = i; });
  }

  /// visit(j) for the points at the other ends of the unbroken bonds of a point.
  template <class Visit>
  void for_each_partner(Index i, const Visit& visit) const {
    for (Offset k = lower_offset_[i]; k < lower_offset_[i + 1]; ++k) visit(lower_partner_[k]);
    for_each_above(i, [&](Index, Index j, Offset) { visit(j); });
  }

  /// n n^T, n the direction from i to j; zero where they lie in one place.
  [[nodiscard]] Eigen::Matrix3d direction(Index i, Index j) const {
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();
    for (int c = 0; c < dimension_; ++c) {
      arm(c) =
          positions_[std::size_t(j) * dimension_ + c] - positions_[std::size_t(i) * dimension_ + c];
    }
    const double squared = arm.squaredNorm();
    if (!(squared > 0.0)) return Eigen::Matrix3d::Zero();
    return arm * (arm.transpose() / squared);
  }

 private:
  template <class Visit>
  void for_each_above(Index i, const Visit& visit) const {
    for (Offset bond = bonds_.offset[i]; bond < bonds_.offset[i + 1]; ++bond) {
      if (broken_.empty() || !broken_[bond]) visit(i, bonds_.partner[bond], bond);
    }
  }

  const Bonds& bonds_;
  std::span<const char> broken_;
  int dimension_;
  std::vector<double> positions_;
  std::vector<Offset> lower_offset_;
  std::vector<Index> lower_partner_;
};

/// Sum of n n^T over the directions n that support a point. Directions beyond the dimension are
/// supported.
using Support = Eigen::Matrix3d;

/// Below this, an eigenvalue of the support counts as zero. As soon as there is one direction, the
/// largest eigenvalue is at least one; less is the round-off of directions that were taken away.
double zero_of(const Eigen::Vector3d& eigenvalues) {
  return independence_tolerance * std::max(1.0, eigenvalues.maxCoeff());
}

bool holds(const Support& support) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(support, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(0) > zero_of(solver.eigenvalues());
}

/// Axes that complete what supports a point, the least covered first; among equals, the lowest.
std::vector<int> missing_axes(const Support& support) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(support);
  Eigen::Matrix3d rest = Eigen::Matrix3d::Zero();  // projects on what is not supported
  int missing = 0;
  for (int k = 0; k < 3; ++k) {
    if (solver.eigenvalues()(k) > zero_of(solver.eigenvalues())) continue;
    rest += solver.eigenvectors().col(k) * solver.eigenvectors().col(k).transpose();
    ++missing;
  }
  std::vector<int> axes;
  while (static_cast<int>(axes.size()) < missing) {
    // The diagonal of a projector on k of three directions has an entry of at least k / 3.
    int least = 0;
    for (int c = 1; c < 3; ++c) {
      if (rest(c, c) > rest(least, least) + 1e-9) least = c;
    }
    axes.push_back(least);
    rest -= (rest.col(least) * rest.row(least) / rest(least, least)).eval();
  }
  return axes;
}

std::vector<Support> supports_of(const Web& web, Index count, const std::vector<char>& prescribed,
                                 const std::vector<FreeHandle>& handles) {
  const int d = web.dimension();
  std::vector<Support> support(std::size_t(count), Support::Zero());
  web.for_each_bond([&](Index i, Index j, Offset) {
    const Eigen::Matrix3d direction = web.direction(i, j);
    support[i] += direction;
    support[j] += direction;
  });
  for (Index i = 0; i < count; ++i) {
    for (int c = 0; c < 3; ++c) {
      if (c >= d || prescribed[std::size_t(i) * d + c]) support[i](c, c) += 1.0;
    }
  }
  for (const FreeHandle& handle : handles) {
    if (!handle.is_slide) continue;
    const Coordinates& along = handle.moved_by.along;
    const Eigen::Vector3d direction(along[0], along[1], along[2]);
    support[handle.moved_by.member] -= direction * direction.transpose();
  }
  return support;
}

/// Strips loose points until none is left, and takes them out of the supports of all points.
/// @return the loose points
std::vector<Index> strip(Web& web, std::vector<Support>& support) {
  std::vector<char> is_loose(support.size(), 0);
  std::vector<Index> loose;
  const auto check = [&](Index i) {
    if (is_loose[i] || holds(support[i])) return;
    is_loose[i] = 1;
    loose.push_back(i);
  };
  for (Index i = 0; i < static_cast<Index>(support.size()); ++i) check(i);
  if (!loose.empty()) web.find_lower_partners();
  for (std::size_t done = 0; done < loose.size(); ++done) {  // grows under way
    const Index i = loose[done];
    web.for_each_partner(i, [&](Index j) {
      support[j] -= web.direction(i, j);
      check(j);
    });
  }
  return loose;
}

/// Degrees of freedom of a point that slides, the least supported first.
std::vector<std::size_t> slides_of(Index point, const std::vector<FreeHandle>& handles,
                                   const Support& support) {
  std::vector<std::pair<double, std::size_t>> found;
  for (const FreeHandle& handle : handles) {
    if (!handle.is_slide || handle.moved_by.member != point) continue;
    const Coordinates& along = handle.moved_by.along;
    const Eigen::Vector3d direction(along[0], along[1], along[2]);
    found.emplace_back(direction.dot(support * direction), handle.dof);
  }
  std::sort(found.begin(), found.end());
  std::vector<std::size_t> dofs;
  for (const auto& [held_by, dof] : found) dofs.push_back(dof);
  return dofs;
}

/// Pins loose points one by one, those that need the fewest pins first (then the lowest); each then
/// supports the others by its bonds. Leaves their support complete but for the pins.
void pin_loose(const Web& web, const std::vector<Index>& loose,
               const std::vector<FreeHandle>& handles, std::vector<Support>& support,
               std::vector<char>& pinned) {
  constexpr std::size_t settled = 0;
  std::vector<std::size_t> rank(support.size(), settled);  // 1 + number of missing axes
  std::set<std::pair<std::size_t, Index>> waiting;
  const auto wait = [&](Index i) {
    rank[i] = 1 + missing_axes(support[i]).size();
    waiting.emplace(rank[i], i);
  };
  for (Index i : loose) wait(i);
  while (!waiting.empty()) {
    const Index i = waiting.begin()->second;
    waiting.erase(waiting.begin());
    rank[i] = settled;
    const std::vector<int> axes = missing_axes(support[i]);
    const std::vector<std::size_t> slides = slides_of(i, handles, support[i]);
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const std::size_t own = std::size_t(i) * std::size_t(web.dimension()) + std::size_t(axes[k]);
      pinned[k < slides.size() ? slides[k] : own] = 1;
    }
    web.for_each_partner(i, [&](Index j) {
      if (rank[j] == settled) return;
      waiting.erase({rank[j], j});
      support[j] += web.direction(i, j);
      wait(j);
    });
  }
}

/// Numbers the pieces that float, in the order of Fragments::piece.
void number_pieces(const std::vector<std::vector<Index>>& pieces, const Points& points,
                   const std::vector<double>& positions, const Holding& holding,
                   Fragments& fragments) {
  std::vector<const std::vector<Index>*> floating;
  for (const std::vector<Index>& piece : pieces) {
    if (points.is_image(piece.front())) continue;  // beyond reach of the body
    const RigidMotions free = free_rigid_motions(
        points.dimension, positions, piece, holding.prescribed, points.spacing, holding.motions);
    if (free.count > 0) floating.push_back(&piece);
  }
  std::stable_sort(floating.begin(), floating.end(),
                   [](const auto* a, const auto* b) { return a->size() > b->size(); });
  fragments.piece.assign(std::size_t(points.count()), 0);
  fragments.count = static_cast<int>(floating.size());
  for (int k = 0; k < fragments.count; ++k) {
    for (Index i : *floating[k]) fragments.piece[i] = k + 1;
  }
}

/// Connected components of the points that are not loose.
std::vector<std::vector<Index>> cores_of(const Web& web, const Bonds& bonds,
                                         const std::vector<char>& is_loose,
                                         const std::vector<BondEnds>& links) {
  std::vector<char> apart(std::size_t(bonds.count()), 1);
  web.for_each_bond(
      [&](Index i, Index j, Offset bond) { apart[bond] = is_loose[i] || is_loose[j]; });
  std::vector<BondEnds> of_cores;
  for (const auto& [i, j] : links) {
    if (!is_loose[i] && !is_loose[j]) of_cores.push_back({i, j});
  }
  std::vector<std::vector<Index>> cores = connected_components(bonds, apart, of_cores).members();
  std::erase_if(cores, [&](const std::vector<Index>& core) { return is_loose[core.front()]; });
  return cores;
}

}  // namespace

Fragments find_fragments(const Points& points, const Bonds& bonds, std::span<const char> broken,
                         const std::vector<char>& prescribed, std::span<const double> displacement,
                         const Holding& of_body) {
  const int d = points.dimension;
  std::vector<double> positions = points.reference;
  for (std::size_t dof = 0; dof < positions.size(); ++dof) positions[dof] += displacement[dof];
  Web web(bonds, broken, d, std::move(positions));

  const Holding holding = with_images(of_body, points, bonds, broken, web.positions());
  std::vector<char> held = prescribed;  // springs of a foundation hold, too
  for (std::size_t dof = 0; dof < holding.prescribed.size(); ++dof) {
    held[dof] |= holding.prescribed[dof];
  }
  Fragments fragments;
  fragments.pinned.assign(prescribed.size(), 0);
  std::vector<std::vector<Index>> cores =
      connected_components(bonds, broken, holding.links).members();
  number_pieces(cores, points, web.positions(), holding, fragments);

  std::vector<Support> support = supports_of(web, points.count(), held, holding.handles);
  fragments.loose = strip(web, support);
  if (!fragments.loose.empty()) {
    std::vector<char> is_loose(std::size_t(points.count()), 0);
    for (Index i : fragments.loose) is_loose[i] = 1;
    pin_loose(web, fragments.loose, holding.handles, support, fragments.pinned);
    std::sort(fragments.loose.begin(), fragments.loose.end());
    cores = cores_of(web, bonds, is_loose, holding.links);
  }
  for (const std::vector<Index>& core : cores) {
    if (points.is_image(core.front())) continue;
    const RigidMotions free = free_rigid_motions(d, web.positions(), core, holding.prescribed,
                                                 points.spacing, holding.motions);
    for (std::size_t dof : determinate_pins(free, web.positions(), core, held, holding.handles)) {
      fragments.pinned[dof] = 1;
    }
  }
  return fragments;
}

}  // namespace peristat
