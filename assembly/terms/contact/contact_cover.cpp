#include "assembly/terms/contact/contact_cover.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "src/core/coordinates.hpp"
#include "src/core/infinity.hpp"
#include "src/core/vector_verbs.hpp"
#include "src/neighbourhood/cell_list.hpp"
#include "src/parallel/collectives.hpp"

namespace peristat {
namespace {

/// Numbers that are sent of a point: its number, the kind of its image or -1, place and step.
constexpr std::size_t record_size = 8;

Coordinates coordinates_at(const double* numbers) { return {numbers[0], numbers[1], numbers[2]}; }

CellList<3> cells_of(std::span<const double> places, double radius) {
  std::vector<Index> all(places.size() / 3);
  std::iota(all.begin(), all.end(), Index(0));
  return CellList<3>(places, all, radius);
}

/// Least distance of two points while the arm between them changes by a step.
double least_distance(const Coordinates& arm, const Coordinates& step) {
  const double squared = dot(step, step);
  const double time = squared > 0.0 ? std::clamp(-dot(arm, step) / squared, 0.0, 1.0) : 0.0;
  return length(plus(arm, scaled(time, step)));
}

}  // namespace

ContactCover::ContactCover(const Points& points, const IndexMap& index_map, double range,
                           double margin)
    : points_(points),
      index_map_(index_map),
      range_(range),
      margin_(margin),
      has_all_(index_map.ranks().count() == 1 && points.images.kinds.empty()) {
  Index handle = points.count();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const bool repeats = std::ranges::any_of(
        points.images.kinds, [axis](const ImageKind& kind) { return kind.periods[axis] != 0; });
    if (repeats) handle_[axis] = handle++;
  }
  const Index own = points.own();
  has_image_.assign(points.images.kinds.size(), std::vector<char>(std::size_t(own), 0));
  for (Index image = own; image < points.count(); ++image) {
    has_image_[points.images.kind[std::size_t(image - own)]][std::size_t(points.source(image))] = 1;
  }
}

bool ContactCover::holds(std::span<const double> displacement) {
  return has_all_ || room(displacement) > 0.0;
}

double ContactCover::room(std::span<const double> displacement) {
  std::vector<double> since(displacement.begin(), displacement.end());
  if (found_at_) add_scaled(since, -1.0, *found_at_);
  double gone = approach(since);
  if (!std::isfinite(gone)) gone = infinity;
  gone = index_map_.ranks().max(gone);
  if (gone == infinity) return infinity;
  if (found_at_ && gone < room_) return room_ - gone;
  const std::vector<Missing> missing = missing_near(displacement, {}, range_ + margin_);
  double nearest = range_ + margin_;
  if (!missing.empty() && owned() > 0) {
    const CellList<3> cells = cells_of(places(displacement), nearest);
    for (const Missing& of : missing) {
      cells.for_each_run(of.place, nearest, [&](Index first, Index last) {
        for (Index slot = first; slot < last; ++slot) {
          nearest = std::min(nearest, length(minus(of.place, cells.position[slot])));
        }
      });
    }
  }
  room_ = index_map_.ranks().min(nearest) - range_;
  found_at_.emplace(displacement.begin(), displacement.end());
  return room_;
}

bool ContactCover::is_left_by(std::span<const double> displacement, std::span<const double> step) {
  if (has_all_) return false;
  const double left = room(displacement);
  const double most = index_map_.ranks().max(approach(step));
  if (most < left) return false;
  const std::vector<Missing> missing = missing_near(displacement, step, range_ + most);
  bool is_left = false;
  if (!missing.empty() && owned() > 0) {
    const CellList<3> cells = cells_of(places(displacement), range_);
    for (const Missing& of : missing) {
      cells.for_each_run(of.place, range_ + most, [&](Index first, Index last) {
        for (Index slot = first; slot < last && !is_left; ++slot) {
          const Coordinates arm = minus(of.place, cells.position[slot]);
          is_left = least_distance(arm, minus(of.step, moved(cells.point[slot], step))) <= range_;
        }
      });
    }
  }
  return any_of_all(index_map_.ranks(), is_left);
}

double ContactCover::approach(std::span<const double> step) const {
  double longest = 0.0, of_jumps = 0.0;
  bool is_finite = true;
  for (Index i = 0; i < owned(); ++i) {
    const double size = length(moved(i, step));
    is_finite = is_finite && std::isfinite(size);
    longest = std::max(longest, size);
  }
  for (const ImageKind& kind : points_.images.kinds) {
    const double size = length(jump(kind, step));
    is_finite = is_finite && std::isfinite(size);
    of_jumps = std::max(of_jumps, size);
  }
  return is_finite ? 2.0 * longest + of_jumps : infinity;
}

std::vector<ContactCover::Missing> ContactCover::missing_near(std::span<const double> displacement,
                                                              std::span<const double> step,
                                                              double distance) const {
  const Communicator& ranks = index_map_.ranks();
  const std::vector<Box> around = boxes(displacement);
  std::vector<double> mine;
  const auto send = [&](Index point, double kind, const Coordinates& place,
                        const Coordinates& way) {
    mine.push_back(double(index_map_.number_of(point)));
    mine.push_back(kind);
    mine.insert(mine.end(), place.begin(), place.end());
    mine.insert(mine.end(), way.begin(), way.end());
  };
  const auto is_near = [&](const Coordinates& place, int except) {
    for (int rank = 0; rank < ranks.count(); ++rank) {
      if (rank != except && around[std::size_t(rank)].distance(place) <= distance) return true;
    }
    return false;
  };
  const std::vector<ImageKind>& kinds = points_.images.kinds;
  for (Index i = 0; i < owned(); ++i) {
    const Coordinates now = plus(points_.position(i), moved(i, displacement));
    const Coordinates way = moved(i, step);
    if (is_near(now, ranks.rank())) send(i, -1.0, now, way);
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      const Coordinates place = plus(kinds[k].place(now), jump(kinds[k], displacement));
      if (!is_near(place, -1)) continue;
      Coordinates of_image = jump(kinds[k], step);
      for (std::size_t c = 0; c < 3; ++c) of_image[c] += kinds[k].mirror[c] * way[c];
      send(i, double(k), place, of_image);
    }
  }
  const std::vector<double> all = concatenated(ranks, mine);
  const Box& here = around[std::size_t(ranks.rank())];
  std::vector<Missing> missing;
  for (std::size_t first = 0; first < all.size(); first += record_size) {
    const Coordinates place = coordinates_at(&all[first + 2]);
    if (here.distance(place) > distance || is_here(&all[first])) continue;
    missing.push_back({place, coordinates_at(&all[first + 5])});
  }
  return missing;
}

bool ContactCover::is_here(const double* record) const {
  const std::optional<Index> point = index_map_.find(GlobalIndex(record[0]));
  if (!point) return false;
  return record[1] < 0.0 || has_image_[std::size_t(record[1])][std::size_t(*point)] != 0;
}

double ContactCover::Box::distance(const Coordinates& place) const {
  Coordinates beyond{};
  for (std::size_t c = 0; c < 3; ++c) {
    beyond[c] = std::max({0.0, least[c] - place[c], place[c] - most[c]});
  }
  return length(beyond);
}

std::vector<ContactCover::Box> ContactCover::boxes(std::span<const double> displacement) const {
  Box around;
  around.least.fill(infinity);  // a rank without points is far from everything
  around.most.fill(-infinity);
  const std::vector<double> now = places(displacement);
  for (std::size_t k = 0; k < now.size(); ++k) {
    around.least[k % 3] = std::min(around.least[k % 3], now[k]);
    around.most[k % 3] = std::max(around.most[k % 3], now[k]);
  }
  std::vector<double> mine(around.least.begin(), around.least.end());
  mine.insert(mine.end(), around.most.begin(), around.most.end());
  const std::vector<double> all = index_map_.ranks().all_of(mine);
  std::vector<Box> boxes;
  for (std::size_t first = 0; first < all.size(); first += mine.size()) {
    boxes.push_back({coordinates_at(&all[first]), coordinates_at(&all[first + 3])});
  }
  return boxes;
}

std::vector<double> ContactCover::places(std::span<const double> displacement) const {
  std::vector<double> now;
  now.reserve(3 * std::size_t(owned()));
  for (Index i = 0; i < owned(); ++i) {
    const Coordinates place = plus(points_.position(i), moved(i, displacement));
    now.insert(now.end(), place.begin(), place.end());
  }
  return now;
}

Coordinates ContactCover::moved(Index row, std::span<const double> displacement) const {
  Coordinates of_row{};
  const auto d = std::size_t(points_.dimension);
  for (std::size_t c = 0; c < d && !displacement.empty(); ++c) {
    of_row[c] = displacement[std::size_t(row) * d + c];
  }
  return of_row;
}

Coordinates ContactCover::jump(const ImageKind& kind, std::span<const double> displacement) const {
  Coordinates over{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (kind.periods[axis] == 0) continue;
    over = plus(over, scaled(kind.periods[axis], moved(handle_[axis], displacement)));
  }
  return over;
}

}  // namespace peristat
