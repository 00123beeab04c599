#include "src/connectivity/loose_points.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>

#include <Eigen/Core>
#include <Eigen/LU>

#include "src/connectivity/fragments.hpp"
#include "src/dense/symmetric_spectrum.hpp"
#include "src/parallel/collectives.hpp"
#include "src/parallel/index_map.hpp"

namespace peristat {

Coordinates Web::position(Index i) const {
  Coordinates at{};
  const auto d = std::size_t(dimension_);
  for (std::size_t c = 0; c < d; ++c) at[c] = positions_[std::size_t(i) * d + c];
  return at;
}

void Web::find_lower_partners() {
  lower_offset_.assign(std::size_t(bonds_.points()) + 1, 0);
  for_each_bond([&](Index, Index j, Offset) { ++lower_offset_[std::size_t(j) + 1]; });
  for (Index i = 0; i < bonds_.points(); ++i) lower_offset_[i + 1] += lower_offset_[i];
  lower_partner_.resize(std::size_t(lower_offset_.back()));
  std::vector<Offset> end(lower_offset_.begin(), lower_offset_.end() - 1);
  for_each_bond([&](Index i, Index j, Offset) { lower_partner_[end[j]++] = i; });
}

namespace {

Eigen::Map<Eigen::Matrix3d> matrix(Support& support) {
  return Eigen::Map<Eigen::Matrix3d>(support[0].data());
}

/// n n^T, n the direction from i to j; zero if they coincide.
Eigen::Matrix3d direction(const Web& web, Index i, Index j) {
  const Coordinates from = web.position(i), to = web.position(j);
  const Eigen::Vector3d arm(to[0] - from[0], to[1] - from[1], to[2] - from[2]);
  const double squared = arm.squaredNorm();
  if (!(squared > 0.0)) return Eigen::Matrix3d::Zero();
  return arm * (arm.transpose() / squared);
}

/// Eigenvalues of a support below this count as zero. With one direction or more the largest
/// eigenvalue is at least one; less is the round-off of directions that were subtracted.
double zero_of(const std::array<double, 3>& eigenvalues) {
  return independence_tolerance * std::max(1.0, eigenvalues.back());
}

bool holds(const Eigen::Matrix3d& support) {
  const std::array<double, 3> eigenvalues = symmetric_eigenvalues<3>(support.data());
  return eigenvalues.front() > zero_of(eigenvalues);
}

/// Axes that complete the support of a point, the least covered first; among equals, the lowest.
std::vector<int> missing_axes(const Eigen::Matrix3d& support) {
  const SymmetricSpectrum<3> spectrum = symmetric_spectrum<3>(support.data());
  Eigen::Matrix3d rest = Eigen::Matrix3d::Zero();  // projector on the unsupported directions
  int missing = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    if (spectrum.values[k] > zero_of(spectrum.values)) continue;
    const Eigen::Vector3d vector(spectrum.vectors[k].data());
    rest += vector * vector.transpose();
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

/// Degrees of freedom along which a point slides, the least supported first.
std::vector<std::size_t> slides_of(Index point, const std::vector<FreeHandle>& handles,
                                   const Eigen::Matrix3d& support) {
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

/// Same as pin_loose_points, for all loose points of the body.
void pin_all(const Web& web, const std::vector<Index>& loose,
             const std::vector<FreeHandle>& handles, std::vector<Support> support,
             std::vector<char>& pinned) {
  constexpr std::size_t settled = 0;
  std::vector<std::size_t> rank(support.size(), settled);  // 1 + number of missing axes
  std::set<std::pair<std::size_t, Index>> waiting;
  const auto wait = [&](Index i) {
    rank[i] = 1 + missing_axes(matrix(support[i])).size();
    waiting.emplace(rank[i], i);
  };
  for (Index i : loose) wait(i);
  while (!waiting.empty()) {
    const Index i = waiting.begin()->second;
    waiting.erase(waiting.begin());
    rank[i] = settled;
    const std::vector<int> axes = missing_axes(matrix(support[i]));
    const std::vector<std::size_t> slides = slides_of(i, handles, matrix(support[i]));
    for (std::size_t k = 0; k < axes.size(); ++k) {
      const std::size_t own = std::size_t(i) * std::size_t(web.dimension()) + std::size_t(axes[k]);
      pinned[k < slides.size() ? slides[k] : own] = 1;
    }
    web.for_each_partner(i, [&](Index j) {
      if (rank[j] == settled) return;
      waiting.erase({rank[j], j});
      matrix(support[j]) += direction(web, i, j);
      wait(j);
    });
  }
}

/// Loose points of a partitioned body, in the order of their numbers, with the bonds among them:
/// the same on all ranks.
struct LooseWeb {
  std::vector<double> number;  // in the whole body
  std::vector<double> positions;
  std::vector<Support> support;
  std::vector<FreeHandle> slides;  // numbered after the components of the points
  Bonds bonds;

  [[nodiscard]] Index row_of(double of_body) const {
    return Index(std::lower_bound(number.begin(), number.end(), of_body) - number.begin());
  }
};

/// Slides of the loose points that this rank owns.
std::vector<FreeHandle> own_slides(const std::vector<Index>& loose,
                                   const std::vector<FreeHandle>& handles) {
  std::vector<FreeHandle> found;
  for (const FreeHandle& handle : handles) {
    const bool is_own = std::binary_search(loose.begin(), loose.end(), handle.moved_by.member);
    if (handle.is_slide && is_own) found.push_back(handle);
  }
  return found;
}

LooseWeb gather_loose_points(const Web& web, const std::vector<Index>& loose,
                             const std::vector<FreeHandle>& slides_of_rank,
                             const std::vector<Support>& support, const IndexMap& index_map) {
  constexpr std::size_t width = 13;  // number, place, support
  const std::vector<double> number = index_map.numbers(support.size());
  std::vector<double> points, ends;
  for (const Index i : loose) {
    const Coordinates at = web.position(i);
    points.push_back(number[std::size_t(i)]);
    points.insert(points.end(), at.begin(), at.end());
    for (const auto& row : support[std::size_t(i)])
      points.insert(points.end(), row.begin(), row.end());
    web.for_each_partner(i, [&](Index j) {
      if (j >= index_map.first_image()) return;  // images are never loose
      ends.push_back(number[std::size_t(i)]);
      ends.push_back(number[std::size_t(j)]);
    });
  }
  std::vector<double> slides;  // number of the point, direction
  for (const FreeHandle& slide : slides_of_rank) {
    slides.push_back(number[std::size_t(slide.moved_by.member)]);
    slides.insert(slides.end(), slide.moved_by.along.begin(), slide.moved_by.along.end());
  }
  points = concatenated(index_map.ranks(), points);
  ends = concatenated(index_map.ranks(), ends);
  slides = concatenated(index_map.ranks(), slides);
  std::vector<const double*> rows;
  for (std::size_t k = 0; k < points.size(); k += width) rows.push_back(&points[k]);
  std::sort(rows.begin(), rows.end(), [](const double* a, const double* b) { return *a < *b; });
  LooseWeb found;
  for (const double* row : rows) {
    found.number.push_back(row[0]);
    found.positions.insert(found.positions.end(), row + 1, row + 1 + web.dimension());
    Support of_point;
    std::copy_n(row + 4, 9, of_point[0].data());
    found.support.push_back(of_point);
  }
  for (std::size_t k = 0; k < slides.size(); k += 4) {
    const HeldMotion along{found.row_of(slides[k]), {slides[k + 1], slides[k + 2], slides[k + 3]}};
    found.slides.push_back({found.positions.size() + k / 4, along, true});
  }
  std::set<BondEnds> bonds;
  for (std::size_t k = 0; k < ends.size(); k += 2) {
    const Index a = found.row_of(ends[k]), b = found.row_of(ends[k + 1]);
    const bool is_loose = b < Index(rows.size()) && found.number[std::size_t(b)] == ends[k + 1];
    if (is_loose) bonds.insert({std::min(a, b), std::max(a, b)});
  }
  found.bonds.offset.assign(rows.size() + 1, 0);
  std::vector<Index> upper;
  for (const auto& [a, b] : bonds) {
    ++found.bonds.offset[std::size_t(a) + 1];
    upper.push_back(b);
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    found.bonds.offset[i + 1] += found.bonds.offset[i];
  }
  found.bonds.partner = Partners(found.bonds.offset, upper);
  return found;
}

}  // namespace

namespace {

/// The support of a point without its bonds.
Support support_by_itself(const Web& web, Index i, const std::vector<char>& prescribed) {
  const int d = web.dimension();
  Support support{};
  for (int c = 0; c < 3; ++c) {
    if (c >= d || prescribed[std::size_t(i) * d + c]) support[c][c] += 1.0;
  }
  return support;
}

/// Subtracts the direction in which a handle lets its member slide.
void let_slide(const FreeHandle& handle, Support& support) {
  const Coordinates& along = handle.moved_by.along;
  const Eigen::Vector3d slide(along[0], along[1], along[2]);
  matrix(support) -= slide * slide.transpose();
}

/// A lower bound of the smallest eigenvalue of a support: the product of the other two is at most
/// the square of half the trace.
double least_eigenvalue_bound(const Eigen::Matrix3d& support) {
  const double half_trace = 0.5 * support.trace();
  return support.determinant() / (half_trace * half_trace);
}

/// True if upper bonds of a point hold it whatever its other bonds are.
bool is_held_from_above(const Web& web, Index i, Support support) {
  // More directions only add to an eigenvalue. They raise the threshold, but not up to this.
  constexpr double plenty = 0.01;
  int bonds = 0, next_look = 4;
  bool is_held = false;
  web.for_each_above_while(i, [&](Index j) {
    matrix(support) += direction(web, i, j);
    if (++bonds < next_look) return true;
    next_look *= 2;
    is_held = least_eigenvalue_bound(matrix(support)) > plenty;
    return !is_held;
  });
  return is_held;
}

}  // namespace

bool hold_all(const Web& web, Index own, const std::vector<char>& prescribed,
              const std::vector<FreeHandle>& handles) {
  std::vector<char> slides(std::size_t(own), 0);
  for (const FreeHandle& handle : handles) {
    if (handle.is_slide && handle.moved_by.member < own) slides[handle.moved_by.member] = 1;
  }
  std::vector<char> needs_all(std::size_t(own), 0);  // of its bonds
#pragma omp parallel for schedule(static)
  for (Index i = 0; i < own; ++i) {
    const Support itself = support_by_itself(web, i, prescribed);
    needs_all[i] = slides[i] || !is_held_from_above(web, i, itself);
  }
  constexpr Index none = -1;
  std::vector<Index> number(std::size_t(own), none);
  std::vector<Support> support;
  for (Index i = 0; i < own; ++i) {
    if (!needs_all[i]) continue;
    number[i] = Index(support.size());
    support.push_back(support_by_itself(web, i, prescribed));
  }
  web.for_each_bond([&](Index i, Index j, Offset) {
    for (const Index end : {i, j}) {
      if (end >= own || number[end] == none) continue;
      matrix(support[number[end]]) += direction(web, i, j);
    }
  });
  for (const FreeHandle& handle : handles) {
    const Index member = handle.moved_by.member;
    if (handle.is_slide && member < own) let_slide(handle, support[number[member]]);
  }
  return std::ranges::all_of(support, [](Support& of) { return holds(matrix(of)); });
}

std::vector<Support> supports_of(const Web& web, Index count, const std::vector<char>& prescribed,
                                 const std::vector<FreeHandle>& handles) {
  std::vector<Support> support(std::size_t(count), Support{});
  for (Index i = 0; i < count; ++i) support[i] = support_by_itself(web, i, prescribed);
  web.for_each_bond([&](Index i, Index j, Offset) {
    const Eigen::Matrix3d along = direction(web, i, j);
    matrix(support[i]) += along;
    matrix(support[j]) += along;
  });
  for (const FreeHandle& handle : handles) {
    if (handle.is_slide) let_slide(handle, support[handle.moved_by.member]);
  }
  return support;
}

std::vector<char> strip_loose_points(Web& web, std::vector<Support>& support,
                                     const IndexMap& index_map) {
  const Index own = std::min(index_map.owned(), Index(support.size()));
  std::vector<char> is_loose(support.size(), 0);
  std::vector<Index> loose;
  const auto check = [&](Index i) {
    if (i >= own || is_loose[i] || holds(matrix(support[i]))) return;
    is_loose[i] = 1;
    loose.push_back(i);
  };
  for (Index i = 0; i < own; ++i) check(i);
  if (any_of_all(index_map.ranks(), !loose.empty())) web.find_lower_partners();
  std::size_t done = 0;
  for (bool goes_on = true; goes_on;) {
    for (; done < loose.size(); ++done) {  // grows in the loop
      const Index i = loose[done];
      web.for_each_partner(i, [&](Index j) {
        matrix(support[j]) -= direction(web, i, j);
        check(j);
      });
    }
    std::vector<double> told(is_loose.begin(), is_loose.end());
    index_map.update_ghost_values(told);
    for (std::size_t ghost = std::size_t(own); ghost < told.size(); ++ghost) {
      if (told[ghost] == 0.0 || is_loose[ghost]) continue;
      is_loose[ghost] = 1;
      loose.push_back(Index(ghost));
    }
    goes_on = index_map.ranks().max(double(done < loose.size())) > 0.0;
  }
  return is_loose;
}

void pin_loose_points(const Web& web, const std::vector<Index>& loose,
                      const std::vector<FreeHandle>& handles, std::vector<Support> support,
                      const IndexMap& index_map, std::vector<char>& pinned) {
  if (index_map.is_whole()) return pin_all(web, loose, handles, std::move(support), pinned);
  const std::vector<FreeHandle> mine = own_slides(loose, handles);
  const LooseWeb all = gather_loose_points(web, loose, mine, support, index_map);
  if (all.number.empty()) return;
  const auto d = std::size_t(web.dimension());
  Web among(all.bonds, {}, web.dimension(), all.positions);
  among.find_lower_partners();
  std::vector<Index> rows(all.number.size());
  std::iota(rows.begin(), rows.end(), Index(0));
  std::vector<char> pins(all.positions.size() + all.slides.size(), 0);
  pin_all(among, rows, all.slides, all.support, pins);
  for (const Index i : loose) {
    const auto row = std::size_t(all.row_of(double(index_map.number_of(i))));
    std::copy_n(pins.begin() + std::ptrdiff_t(row * d), d,
                pinned.begin() + std::ptrdiff_t(std::size_t(i) * d));
  }
  // The slides of a point, which are all of one rank, keep their order.
  std::map<Index, std::size_t> first;  // per row, to be looked at
  for (const FreeHandle& slide : mine) {
    const Index row = all.row_of(double(index_map.number_of(slide.moved_by.member)));
    std::size_t k = first[row];
    while (all.slides[k].moved_by.member != row) ++k;
    pinned[slide.dof] = pins[all.slides[k].dof];
    first[row] = k + 1;
  }
}

}  // namespace peristat
