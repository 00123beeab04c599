#include "solvers/ranks/distribute.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solvers/ranks/point_records.hpp"
#include "solvers/ranks/ranks.hpp"
#include "src/core/infinity.hpp"
#include "src/neighbourhood/horizon.hpp"
#include "src/neighbourhood/search.hpp"
#include "src/parallel/communicator.hpp"

namespace peristat {
namespace {

/// Bounding box of points; without points its bounds are infinite and reversed.
class PointBox {
 public:
  explicit PointBox(int dimension)
      : low_(std::size_t(dimension), infinity), high_(std::size_t(dimension), -infinity) {}
  explicit PointBox(std::span<const double> low_and_high)
      : low_(low_and_high.begin(), low_and_high.begin() + std::ptrdiff_t(low_and_high.size() / 2)),
        high_(low_and_high.begin() + std::ptrdiff_t(low_and_high.size() / 2), low_and_high.end()) {}

  void add(const double* at) {
    for (std::size_t c = 0; c < low_.size(); ++c) {
      low_[c] = std::min(low_[c], at[c]);
      high_[c] = std::max(high_[c], at[c]);
    }
  }
  [[nodiscard]] bool is_empty() const { return low_[0] > high_[0]; }
  [[nodiscard]] std::vector<double> low_and_high() const {
    std::vector<double> both = low_;
    both.insert(both.end(), high_.begin(), high_.end());
    return both;
  }
  /// True if the gap to the other box is at most `reach` along each axis.
  [[nodiscard]] bool is_near(const PointBox& other, double reach) const {
    for (std::size_t c = 0; c < low_.size(); ++c) {
      if (low_[c] - reach > other.high_[c] || high_[c] + reach < other.low_[c]) return false;
    }
    return !is_empty() && !other.is_empty();
  }
  [[nodiscard]] bool is_near(const double* at, double reach) const {
    for (std::size_t c = 0; c < low_.size(); ++c) {
      if (low_[c] - reach > at[c] || high_[c] + reach < at[c]) return false;
    }
    return true;
  }

 private:
  std::vector<double> low_, high_;
};

const double* place_of(const Points& points, Index point) {
  return &points.reference[std::size_t(point) * std::size_t(points.dimension)];
}

/// Points sorted into cells as long as the reach, to test whether a place is within reach of one.
class NearPoints {
 public:
  NearPoints(const Points& points, Index count, double reach)
      : points_(points), squared_(reach * reach), cell_(reach) {
    for (Index i = 0; i < count; ++i) cells_.emplace_back(cell_of(place_of(points, i)), i);
    std::sort(cells_.begin(), cells_.end());
  }

  [[nodiscard]] bool has_near(const double* at) const {
    const Cell middle = cell_of(at);
    const int last = points_.dimension - 1;
    Cell from = middle;
    const int runs = points_.dimension == 1 ? 1 : points_.dimension == 2 ? 3 : 9;
    for (int run = 0; run < runs; ++run) {  // three cells of a run follow one another
      if (last > 0) from[0] = middle[0] + run % 3 - 1;
      if (last > 1) from[1] = middle[1] + run / 3 - 1;
      from[std::size_t(last)] = middle[std::size_t(last)] - 1;
      Cell to = from;
      to[std::size_t(last)] += 2;
      auto entry = std::lower_bound(cells_.begin(), cells_.end(), std::pair(from, Index(0)));
      for (; entry != cells_.end() && entry->first <= to; ++entry) {
        if (is_near(at, place_of(points_, entry->second))) return true;
      }
    }
    return false;
  }

 private:
  using Cell = std::array<std::int64_t, 3>;

  [[nodiscard]] Cell cell_of(const double* at) const {
    Cell cell{};
    for (int c = 0; c < points_.dimension; ++c) {
      cell[std::size_t(c)] = std::int64_t(std::floor(at[c] / cell_));
    }
    return cell;
  }
  [[nodiscard]] bool is_near(const double* a, const double* b) const {
    double squared = 0.0;
    for (int c = 0; c < points_.dimension; ++c) squared += (a[c] - b[c]) * (a[c] - b[c]);
    return squared <= squared_;
  }

  const Points& points_;
  double squared_, cell_;
  std::vector<std::pair<Cell, Index>> cells_;  // ascending
};

/// True if is_near(place) holds for a point or for one of its images.
template <class IsNear>
bool is_any_near(const Coordinates& at, const std::vector<ImageKind>& images,
                 const IsNear& is_near) {
  return is_near(at.data()) || std::any_of(images.begin(), images.end(), [&](const auto& kind) {
           return is_near(kind.place(at).data());
         });
}

/// Offers points to the ranks that may need them as ghosts; returns those offered here. Collective.
Records offered_points(const Part& part, const PointRecords& format, double reach,
                       const Communicator& ranks) {
  const Points& points = part.points;
  PointBox mine(points.dimension);
  for (Index i = 0; i < part.owned; ++i) mine.add(place_of(points, i));
  const std::vector<double> boxes = ranks.all_of(mine.low_and_high());
  const std::size_t width = 2 * std::size_t(points.dimension);
  PointRecords offered = format;
  std::vector<int> to;
  for (int other = 0; other < ranks.count(); ++other) {
    const std::span<const double> of_other{&boxes[std::size_t(other) * width], width};
    const PointBox theirs(of_other);
    const bool may_be_near = part.images.empty() ? mine.is_near(theirs, reach) : !theirs.is_empty();
    if (other == ranks.rank() || !may_be_near) continue;
    for (Index i = 0; i < part.owned; ++i) {
      const auto is_near = [&](const double* at) { return theirs.is_near(at, reach); };
      if (!is_any_near(points.position(i), part.images, is_near)) continue;
      offered.add(part, i, ranks.rank());
      to.push_back(other);
    }
  }
  return exchange(ranks, to, offered.records());
}

/// Records of offered points that are within reach of this rank's own.
Records wanted_of(const Part& part, const Records& offered, double reach) {
  const NearPoints near(part.points, part.owned, reach);
  const auto doubles = std::size_t(offered.doubles), integers = std::size_t(offered.integers);
  Records wanted{offered.doubles, offered.integers, {}, {}};
  for (std::size_t record = 0; record * integers < offered.numbers.size(); ++record) {
    const double* const value = &offered.values[record * doubles];
    Coordinates at{};
    std::copy_n(value, part.points.dimension, at.begin());
    const auto is_near = [&](const double* place) { return near.has_near(place); };
    if (!is_any_near(at, part.images, is_near)) continue;
    const long long* const number = &offered.numbers[record * integers];
    wanted.values.insert(wanted.values.end(), value, value + doubles);
    wanted.numbers.insert(wanted.numbers.end(), number, number + integers);
  }
  return wanted;
}

}  // namespace

Part with_ghosts(Part part, double reach, const Communicator& ranks,
                 std::vector<ImageKind> images) {
  if (part.ghosts() > 0) throw std::logic_error("with_ghosts: the part has some already");
  part.reach = reach;
  part.images = std::move(images);
  if (ranks.count() == 1) return part;
  const double distance = inclusive_radius(reach);
  const PointRecords format(part);
  const Records offered = offered_points(part, format, distance, ranks);
  format.append_to(part, wanted_of(part, offered, distance), true);
  part.points.owned = part.owned;
  return part;
}

Part distribute(Part slab, double horizon, double reach, const Communicator& ranks, int threads,
                std::vector<ImageKind> images) {
  if (ranks.count() == 1) return with_ghosts(std::move(slab), reach, ranks, std::move(images));
  const Part seeing = with_ghosts(std::move(slab), horizon, ranks);
  const std::vector<std::int32_t> neighbours =
      count_neighbours(seeing.points, seeing.owned, horizon, threads);
  // Points without neighbours are work, too, and Zoltan2 needs positive weights.
  std::vector<double> weights(neighbours.size());
  std::transform(neighbours.begin(), neighbours.end(), weights.begin(),
                 [](std::int32_t count) { return 1.0 + count; });
  const auto owned = std::ptrdiff_t(seeing.owned);
  const std::vector<double> positions(
      seeing.points.reference.begin(),
      seeing.points.reference.begin() + owned * seeing.points.dimension);
  const std::vector<GlobalIndex> numbers(seeing.number.begin(), seeing.number.begin() + owned);
  const std::vector<int> to =
      partition(ranks, seeing.points.dimension, positions, numbers, weights);

  PointRecords leaving(seeing);
  for (Index i = 0; i < seeing.owned; ++i) leaving.add(seeing, i, to[std::size_t(i)]);
  Part part = empty_part(seeing);
  leaving.append_to(part, exchange(ranks, to, leaving.records()), false);
  return with_ghosts(std::move(part), reach, ranks, std::move(images));
}

}  // namespace peristat
